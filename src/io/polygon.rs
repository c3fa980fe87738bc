//! Triangulates faces of any number of corners, keeping every corner.
//!
//! A quad is cut along its better diagonal, larger faces by ear clipping (`earcut`) in the plane of their Newell normal.
//! Ear clipping omits corners that are collinear with their neighbours; an omitted corner would tear the cloth there, as
//! the neighbouring face uses it. So they are inserted again. A face of n corners always gives n - 2 triangles, oriented
//! like the face.

use crate::tuning::TUNING;
use crease_geometry::math::{Vec2, Vec3};
use earcut::Earcut;

/// Triangulator of faces; keeps its working memory.
pub(super) struct Triangulator {
    clipper: Earcut<f64>,
    flat: Vec<[f64; 2]>,
    ears: Vec<u32>,
    /// Number of faces that could only be cut as a fan: no area, or an outline that intersects itself.
    pub(super) fan_count: usize,
}

impl Triangulator {
    pub(super) fn new() -> Self {
        Self { clipper: Earcut::new(), flat: Vec::new(), ears: Vec::new(), fan_count: 0 }
    }

    /// Returns the triangles of the face with these corner positions, as indices into `corners`.
    pub(super) fn triangulate(&mut self, corners: &[Vec3]) -> Vec<[u32; 3]> {
        match corners.len() {
            0..3 => Vec::new(),
            3 => vec![[0, 1, 2]],
            4 => cut_quad(corners),
            _ => self.cut_large(corners).unwrap_or_else(|| {
                self.fan_count += 1;
                fan(corners.len())
            }),
        }
    }

    /// Triangulates by ear clipping; `None` where the outline intersects itself or has no area.
    fn cut_large(&mut self, corners: &[Vec3]) -> Option<Vec<[u32; 3]>> {
        self.flat.clear();
        self.flat.extend(project_to_plane(corners)?.iter().map(|p| [p.x, p.y]));
        self.clipper.earcut_slice(&self.flat, &[], &mut self.ears);
        // Ascending corner numbers have the orientation of the face, whatever order the clipper gives.
        let mut triangles: Vec<[u32; 3]> = Vec::with_capacity(corners.len() - 2);
        for ear in self.ears.chunks_exact(3) {
            let mut triangle = [ear[0], ear[1], ear[2]];
            triangle.sort_unstable();
            triangles.push(triangle);
        }
        insert_collinear(&mut triangles, corners.len() as u32)?;
        (triangles.len() == corners.len() - 2).then_some(triangles)
    }
}

/// Returns Newell's normal: twice the area vector, also valid for concave and slightly bent faces.
pub(super) fn newell_normal(corners: &[Vec3]) -> Vec3 {
    let Some(&origin) = corners.first() else { return Vec3::zeros() };
    // Relative to a corner, as garments may lie far from the origin.
    let next = corners.iter().cycle().skip(1);
    corners.iter().zip(next).map(|(a, b)| (a - origin).cross(&(b - origin))).sum()
}

/// Projects the corners to the plane of the face, counter-clockwise.
fn project_to_plane(corners: &[Vec3]) -> Option<Vec<Vec2>> {
    let normal = newell_normal(corners).try_normalize(0.0)?;
    let axis = if normal.x.abs() < 0.6 { Vec3::x() } else { Vec3::y() };
    let x = axis.cross(&normal).try_normalize(0.0)?;
    let y = normal.cross(&x);
    let &origin = corners.first()?;
    let flat: Vec<Vec2> =
        corners.iter().map(|p| Vec2::new((p - origin).dot(&x), (p - origin).dot(&y))).collect();
    flat.iter().all(|p| p.x.is_finite() && p.y.is_finite()).then_some(flat)
}

/// Inserts omitted corners: a run of them between a and c lies on the edge a-c of some triangle (a, c, d), which becomes
/// the fan from d.
fn insert_collinear(triangles: &mut Vec<[u32; 3]>, corner_count: u32) -> Option<()> {
    let mut used: Vec<u32> = triangles.iter().flatten().copied().collect();
    used.sort_unstable();
    used.dedup();
    if used.len() as u32 == corner_count {
        return Some(());
    }
    for (i, &a) in used.iter().enumerate() {
        let c = *used.get(i + 1).or(used.first())?;
        let run = (c + corner_count - a) % corner_count;
        if run < 2 {
            continue;
        }
        let found = triangles.iter().position(|t| t.contains(&a) && t.contains(&c))?;
        let d = triangles[found].iter().copied().find(|&x| x != a && x != c)?;
        let mut fan: Vec<[u32; 3]> = (0..run)
            .map(|k| [(a + k) % corner_count, (a + k + 1) % corner_count, d])
            .map(|mut t| {
                t.sort_unstable();
                t
            })
            .collect();
        triangles[found] = fan.pop()?;
        triangles.append(&mut fan);
    }
    Some(())
}

fn fan(corner_count: usize) -> Vec<[u32; 3]> {
    (1..corner_count as u32 - 1).map(|k| [0, k, k + 1]).collect()
}

/// Cuts a quad along the diagonal that lies inside it; along the shorter one if both do.
fn cut_quad(corners: &[Vec3]) -> Vec<[u32; 3]> {
    let normal = newell_normal(corners);
    let min_area = |cut: [[usize; 3]; 2]| {
        cut.iter()
            .map(|t| {
                let (a, b, c) = (corners[t[0]], corners[t[1]], corners[t[2]]);
                (b - a).cross(&(c - a)).dot(&normal)
            })
            .fold(f64::INFINITY, f64::min)
    };
    let (first, second) = ([[0, 1, 2], [0, 2, 3]], [[0, 1, 3], [1, 2, 3]]);
    // A triangle with hardly any area counts as outside: it is a sliver.
    let inside = |cut| min_area(cut) > TUNING.min_quad_area_fraction * normal.norm_squared();
    let (diagonal_first, diagonal_second) =
        ((corners[2] - corners[0]).norm(), (corners[3] - corners[1]).norm());
    let take_second = match (inside(first), inside(second)) {
        (true, false) => false,
        (false, true) => true,
        _ => diagonal_second < diagonal_first * (1.0 - TUNING.equal_diagonal_tol),
    };
    let cut = if take_second { second } else { first };
    cut.iter().map(|t| t.map(|k| k as u32)).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn area(corners: &[Vec3], t: &[u32; 3]) -> f64 {
        let [a, b, c] = t.map(|k| corners[k as usize]);
        0.5 * (b - a).cross(&(c - a)).dot(&newell_normal(corners).normalize())
    }

    fn check(corners: &[Vec3]) -> Vec<[u32; 3]> {
        let triangles = Triangulator::new().triangulate(corners);
        assert_eq!(triangles.len(), corners.len() - 2);
        let total: f64 = triangles.iter().map(|t| area(corners, t)).sum();
        let expected = 0.5 * newell_normal(corners).norm();
        assert!((total - expected).abs() < 1e-9 * expected, "{total} {expected}");
        for t in &triangles {
            assert!(area(corners, t) > -1e-9 * expected, "no triangle turned over: {t:?}");
        }
        for k in 0..corners.len() as u32 {
            let next = (k + 1) % corners.len() as u32;
            let on_edge = triangles.iter().filter(|t| t.contains(&k) && t.contains(&next)).count();
            assert_eq!(on_edge, 1, "outline edge {k} belongs to one triangle");
        }
        triangles
    }

    fn tilted(outline: &[[f64; 2]]) -> Vec<Vec3> {
        let turn = nalgebra::Rotation3::from_euler_angles(0.4, 1.1, -2.0);
        outline.iter().map(|p| turn * Vec3::new(p[0], p[1], 0.0) + Vec3::new(14678.0, 3.0, 9605.0)).collect()
    }

    #[test]
    fn a_concave_quad_is_cut_inside() {
        for start in 0..4 {
            let mut arrow = [[0.0, 0.0], [1.0, -1.0], [0.0, 2.0], [-1.0, -1.0]];
            arrow.rotate_left(start);
            check(&tilted(&arrow));
        }
    }

    #[test]
    fn a_grid_of_squares_is_cut_one_way() {
        let square = tilted(&[[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
        assert_eq!(check(&square), [[0, 1, 2], [0, 2, 3]]);
    }

    #[test]
    fn concave_outlines_keep_their_area_and_edges() {
        check(&tilted(&[[0.0, 0.0], [3.0, 0.0], [3.0, 1.0], [1.0, 1.0], [1.0, 3.0], [0.0, 3.0]]));
        let star: Vec<[f64; 2]> = (0..14)
            .map(|k| {
                let (angle, radius) =
                    (k as f64 * std::f64::consts::TAU / 14.0, if k % 2 == 0 { 2.0 } else { 0.7 });
                [radius * angle.cos(), radius * angle.sin()]
            })
            .collect();
        check(&tilted(&star));
    }

    /// Found in issue-319-003: ear clipping leaves out corners on a straight edge, and the neighbour's edges there
    /// would hang in the air.
    #[test]
    fn straight_corners_are_kept() {
        let square =
            [[0.0, 0.0], [1.0, 0.0], [2.0, 0.0], [2.0, 1.0], [2.0, 1.5], [2.0, 2.0], [0.0, 2.0], [0.0, 0.5]];
        for start in 0..square.len() {
            let mut turned = square;
            turned.rotate_left(start);
            let flat: Vec<Vec3> = turned.iter().map(|p| Vec3::new(p[0], p[1], 0.0)).collect();
            check(&flat);
        }
    }

    #[test]
    fn a_face_without_area_is_a_fan() {
        let line: Vec<Vec3> = (0..6).map(|k| Vec3::new(k as f64, 0.0, 0.0)).collect();
        assert_eq!(Triangulator::new().triangulate(&line).len(), 4);
        let point = vec![Vec3::zeros(); 7];
        assert_eq!(Triangulator::new().triangulate(&point).len(), 5);
    }
}
