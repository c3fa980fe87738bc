//! Panels of a folded garment: cloth that lies flat away from its fold lines, which no load moves any more.

use crate::wear::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;

/// Flags the points of lying cloth at `x` [m] that are not `near_line` and lie flat: those of no triangle that is steeper than a limit.
///
/// The map of a fold has the cloth away from its line where equilibrium has it, up to the thickness by which layers close under load.
/// Steeper cloth is a rim, a bulge or a wrinkle, and settles.
pub(in crate::wear) fn panel(
    x: &[Vec3],
    triangles: &[[PointIndex; 3]],
    near_line: impl Fn(&Vec3) -> bool,
) -> Vec<bool> {
    let mut panel: Vec<bool> = x.iter().map(|p| !near_line(p)).collect();
    let min_level = TUNING.fold.max_panel_tilt.cos();
    for triangle in triangles {
        let [a, b, c] = triangle.map(|p| x[p.at()]);
        let normal = (b - a).cross(&(c - a));
        if normal.y.abs() < min_level * normal.norm() {
            triangle.iter().for_each(|p| panel[p.at()] = false);
        }
    }
    panel
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cloth_near_the_line_and_steep_cloth_are_no_panel() {
        // A strip along x of squares of 0.1 m, the last of them upright.
        let x: Vec<Vec3> = [[0.0, 0.0], [0.1, 0.0], [0.2, 0.0], [0.3, 0.0], [0.3, 0.1]]
            .iter()
            .flat_map(|&[x, y]| [0.0, 0.1].map(|z| Vec3::new(x, y, z)))
            .collect();
        let square = |k: u32| [[k, k + 1, k + 2], [k + 1, k + 3, k + 2]].map(|t| t.map(PointIndex));
        let triangles: Vec<_> = (0..4).flat_map(|k| square(2 * k)).collect();
        let panel = panel(&x, &triangles, |p| p.x < 0.05);
        let columns: Vec<bool> = panel.into_iter().step_by(2).collect();
        assert_eq!(columns, [false, true, true, false, false]);
    }
}
