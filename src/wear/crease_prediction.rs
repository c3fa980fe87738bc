//! Prediction of where a script creases a garment, before anything is simulated.
//!
//! Every action of the script is applied in turn to a [`FoldLayout`]. Layers have no thickness there, and nothing is known
//! of how sharp a crease becomes. If an action may crease the cloth anywhere, there is no prediction.

use crate::garment::Garment;
use crate::remesh::SurfaceMesh;
use crate::wear::fold_layout::{CreaseDistance, FoldLayout};
use crate::wear::script::WearScript;

/// Distances of the points of `garment` from the creases that `script` makes, one per point, up to `reach` [m]; `None` where
/// it may crease anywhere.
pub fn predict_creases(garment: &Garment, script: &WearScript, reach: f64) -> Option<Vec<CreaseDistance>> {
    let mut layout = FoldLayout::new(garment, reach);
    for action in script.flatten() {
        action.as_wear_action().predict_creases(&mut layout);
        if layout.is_unpredictable() {
            return None;
        }
    }
    Some(layout.into_distances())
}

/// The surface of `garment` with the fold lines of `script` drawn on it, through every layer that they pass, and a row of edges
/// at `row` [m] on either side of each; `None` where the script may crease the cloth anywhere.
pub fn draw_fold_lines<'a>(garment: &'a Garment, script: &WearScript, row: f64) -> Option<SurfaceMesh<'a>> {
    let mut layout = FoldLayout::new(garment, row);
    layout.draw_lines();
    for action in script.flatten() {
        action.as_wear_action().predict_creases(&mut layout);
        if layout.is_unpredictable() {
            return None;
        }
    }
    let mut lines = layout.into_lines()?;
    lines.draw_rows(row);
    Some(lines.into_mesh())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::garment::Garment;
    use crate::math::{Vec2, Vec3};
    use crate::mesh::{PointIndex, Topology};

    const STEP: f64 = 0.01;

    /// Two level layers of 0.2 x 0.2 m, one 1 mm over the other, joined along the left and the right side.
    fn sleeve() -> Garment {
        let row = 21u32;
        let mut points = Vec::new();
        for height in [0.0, 1e-3] {
            for k in 0..row * row {
                points.push(Vec3::new(STEP * f64::from(k % row), height, STEP * f64::from(k / row)));
            }
        }
        // The side points of the upper layer are those of the lower one.
        let name = |layer: u32, i: u32, j: u32| {
            let side = i == 0 || i == row - 1;
            PointIndex(if side { 0 } else { layer * row * row } + j * row + i)
        };
        let mut triangles = Vec::new();
        for layer in [0, 1] {
            for (i, j) in (0..row - 1).flat_map(|i| (0..row - 1).map(move |j| (i, j))) {
                let corner = |di: u32, dj: u32| name(layer, i + di, j + dj);
                let two =
                    [[corner(0, 0), corner(0, 1), corner(1, 1)], [corner(0, 0), corner(1, 1), corner(1, 0)]];
                triangles.extend(two.map(|[a, b, c]| if layer == 1 { [a, b, c] } else { [a, c, b] }));
            }
        }
        Garment {
            material: vec![[Vec2::zeros(); 3]; triangles.len()],
            material_from_uv: false,
            source_point: Vec::new(),
            memory_mask: vec![1.0; points.len()],
            triangle_part: vec![0; triangles.len()],
            topology: Topology::new(points.len(), &triangles),
            triangles,
            points,
        }
    }

    fn near(actions: &str) -> Option<Vec<CreaseDistance>> {
        let text = format!(r#"{{"format": "crease-wear/1", "name": "", "actions": [{actions}]}}"#);
        predict_creases(&sleeve(), &WearScript::parse("wear.json", &text).expect("is a script"), 0.03)
    }

    /// Columns (0 to 20) and layer (0 below, 1 above) of the points whose distance by `pick` is less than half a step.
    fn marked(near: &[CreaseDistance], pick: fn(&CreaseDistance) -> f64) -> Vec<(usize, usize)> {
        let hit = |p: &usize| pick(&near[*p]) < 0.5 * STEP;
        let mut found: Vec<(usize, usize)> = (0..near.len()).filter(hit).map(|p| (p % 21, p / 441)).collect();
        found.sort_unstable();
        found.dedup();
        found
    }

    const LAY: &str = r#"{"lay": {"facing": "up"}}"#;
    const LEFT: &str = r#"{"fold": {"line": [[0.25, 0.0], [0.25, 1.0]], "side": "left"}}"#;

    #[test]
    fn a_later_fold_goes_through_all_layers() {
        // The left quarter over the second; then what is left of 0.4 (of the whole width) over the rest.
        let second = LEFT.replace("0.25", "0.4");
        let near = near(&format!("{LAY}, {LEFT}, {second}")).expect("is predictable");
        // The second line lies at column 8, and on the flap at column 2.
        assert_eq!(marked(&near, |n| n.fold), [(2, 0), (2, 1), (5, 0), (5, 1), (8, 0), (8, 1)]);
    }

    #[test]
    fn an_opened_fold_is_flat_again() {
        let unfold = r#"{"unfold": {"all": true}}"#;
        let second = LEFT.replace("0.25", "0.4");
        let near = near(&format!("{LAY}, {LEFT}, {unfold}, {second}")).expect("is predictable");
        assert_eq!(marked(&near, |n| n.fold), [(5, 0), (5, 1), (8, 0), (8, 1)]);
    }

    #[test]
    fn sides_show_in_what_is_pressed_on_them() {
        let press = r#"{"press": {"pressure": 200, "for": 1}}"#;
        let sides = |actions: String| marked(&near(&actions).expect("is predictable"), |n| n.side);
        let own = [(0, 0), (0, 1), (20, 0), (20, 1)];
        assert_eq!(sides(format!("{LAY}, {LEFT}")), own);
        // Folded, the left side lies on columns 10 of the rest: cloth under a side stays flat.
        assert_eq!(sides(format!("{LAY}, {LEFT}, {press}")), own);
        // Vice versa, the rest is turned onto the narrower part, whose side then lies under columns 10.
        let right = LEFT.replace("left", "right");
        assert_eq!(
            sides(format!("{LAY}, {right}, {press}")),
            [(0, 0), (0, 1), (10, 0), (10, 1), (20, 0), (20, 1)]
        );
    }

    #[test]
    fn unpredictable_actions_have_no_prediction() {
        for action in [
            r#"{"crumple": {"to": 0.3}}"#,
            r#"{"hang": {}}"#,
            r#"{"fold": {"line": [[0.25, 0.0], [0.25, 1.0]], "side": "left", "angle": 90}}"#,
        ] {
            assert_eq!(near(&format!("{LAY}, {action}")), None, "{action}");
        }
        assert_eq!(near(LEFT), None, "nothing lies yet");
    }
}
