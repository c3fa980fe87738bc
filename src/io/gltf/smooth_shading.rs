//! Normals that no reader takes for those of a flat-shaded surface.
//!
//! Blender's importer shades a face flat where the normals of all of its corners are that of the face, within 0.03 degrees: so they are
//! on cloth that lies or hangs straight, which then shows its facets when the wear bends it. One corner of such a triangle is tilted by an angle that no eye
//! sees.

use crease_geometry::math::Vec3;
use crease_geometry::mesh::triangle;

/// Cosine of the angle between normals of a corner and of its triangle above which they are taken for one \[-\]: 0.06 degrees.
const MAX_FLAT_COSINE: f64 = 0.999_999_5;
/// Tilt of a normal \[rad\]: 0.1 degrees.
const TILT: f64 = 1.75e-3;

/// Tilts `normals`, one per vertex in the coordinates of `positions`, until no triangle has its own normal at all of its corners;
/// `triangles` have the order of the file. The vertices before `first` stay as they are. Returns whether any was tilted.
pub(super) fn tilt_flat_normals(
    positions: &[Vec3],
    triangles: &[[u32; 3]],
    normals: &mut [Vec3],
    first: usize,
) -> bool {
    let mut is_changed = false;
    for t in triangles.iter().map(|t| t.map(|v| v as usize)) {
        let Some(own) = triangle::normal(&t.map(|v| positions[v])) else { continue };
        if t.iter().any(|v| normals[*v].dot(&own) < MAX_FLAT_COSINE) {
            continue;
        }
        let Some(k) = (0..3).find(|k| t[*k] >= first) else { continue };
        let side = positions[t[(k + 1) % 3]] - positions[t[k]];
        let Some(along) = (side - own * own.dot(&side)).try_normalize(0.0) else { continue };
        normals[t[k]] = (normals[t[k]] + along * TILT).normalize();
        is_changed = true;
    }
    is_changed
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Blender's test of a face, in single precision.
    fn is_flat(positions: &[Vec3], t: &[u32; 3], normals: &[Vec3]) -> bool {
        let own = triangle::normal(&t.map(|v| positions[v as usize])).unwrap().map(|x| x as f32);
        t.iter().all(|v| normals[*v as usize].map(|x| x as f32).dot(&own) > 0.999_999_9)
    }

    #[test]
    fn no_triangle_of_a_level_sheet_is_taken_for_flat() {
        let count = 9;
        let at = |k: u32| Vec3::new(f64::from(k % count), 0.3, f64::from(k / count)) * 0.01;
        let positions: Vec<Vec3> = (0..count * count).map(at).collect();
        let squares = (0..count - 1).flat_map(|j| (0..count - 1).map(move |i| j * count + i));
        let triangles: Vec<[u32; 3]> =
            squares.flat_map(|a| [[a, a + count, a + 1], [a + 1, a + count, a + count + 1]]).collect();
        let mut normals = vec![Vec3::y(); positions.len()];
        assert!(triangles.iter().all(|t| is_flat(&positions, t, &normals)));
        assert!(tilt_flat_normals(&positions, &triangles, &mut normals, 0));
        assert!(!triangles.iter().any(|t| is_flat(&positions, t, &normals)));
        assert!(normals.iter().all(|n| n.dot(&Vec3::y()) > 0.2f64.to_radians().cos()));
        assert!(!tilt_flat_normals(&positions, &triangles, &mut normals, 0), "once is enough");
    }
}
