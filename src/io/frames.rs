//! Writes one state of the simulated mesh as Wavefront OBJ text: a frame of `--frames`.
//!
//! Positions are in metres, y up, one `v` line per point in point order, one `f` line per triangle. Numbers are the
//! shortest decimal text that reads back to the same f64 (at most 17 significant digits), so a run can be judged from
//! its frames without loss. No normals, no texture coordinates, no materials: this is the solver's mesh, not the file's.

use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use std::fmt::Write;

/// Typical bytes of a vertex line, to reserve about the right capacity once.
const VERTEX_LINE_BYTES: usize = 64;
/// Typical bytes of a face line.
const FACE_LINE_BYTES: usize = 24;

/// Writes `triangles` over `points` \[m\] as OBJ text. Points that are not finite are written as `NaN` or `inf`, which every
/// reader rejects: a diverged run must not look like a good one.
pub fn write_frame_obj(points: &[Vec3], triangles: &[[PointIndex; 3]]) -> Vec<u8> {
    let capacity = points.len() * VERTEX_LINE_BYTES + triangles.len() * FACE_LINE_BYTES;
    let mut text = String::with_capacity(capacity);
    for p in points {
        // `{:?}` and not `{}`: both read back exactly, but `{}` spells 1e-300 out with 300 zeros.
        // Writing to a string cannot fail.
        let _ = writeln!(text, "v {:?} {:?} {:?}", p.x, p.y, p.z);
    }
    for t in triangles {
        // OBJ counts from 1; in 64 bits the last u32 still has a successor.
        let [a, b, c] = t.map(|corner| u64::from(corner.0) + 1);
        let _ = writeln!(text, "f {a} {b} {c}");
    }
    text.into_bytes()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_exact_text_of_one_triangle() {
        let points =
            [Vec3::new(0.0, -1.5, 1e-9), Vec3::new(0.1, 2.0, 1.0 / 3.0), Vec3::new(-0.0, 1e300, 3.0)];
        let triangles = [[PointIndex(0), PointIndex(2), PointIndex(1)]];
        let expected = "v 0.0 -1.5 1e-9\nv 0.1 2.0 0.3333333333333333\nv -0.0 1e300 3.0\nf 1 3 2\n";
        assert_eq!(String::from_utf8(write_frame_obj(&points, &triangles)).unwrap(), expected);
    }

    #[test]
    fn every_double_reads_back_to_the_same_bits() {
        let mut bits = 0x9E37_79B9_7F4A_7C15u64;
        let mut next = || {
            bits = bits.wrapping_mul(0x5851_F42D_4C95_7F2D).wrapping_add(0x1405_7B7E_F767_814F);
            f64::from_bits(bits)
        };
        let points: Vec<Vec3> = std::iter::repeat_with(|| Vec3::new(next(), next(), next()))
            .filter(|p| p.iter().all(|x| x.is_finite()))
            .take(2000)
            .collect();
        let text = String::from_utf8(write_frame_obj(&points, &[])).unwrap();
        let read: Vec<u64> = text
            .lines()
            .flat_map(|line| line.split(' ').skip(1).map(|x| x.parse::<f64>().unwrap().to_bits()))
            .collect();
        let written: Vec<u64> = points.iter().flat_map(|p| p.iter().map(|x| x.to_bits())).collect();
        assert_eq!(read, written);
    }
}
