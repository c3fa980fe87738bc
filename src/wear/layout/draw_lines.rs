//! The fold lines of a script, drawn on the surface of a garment before anything is simulated.

use crate::wear::layout::flat_layout::LayoutQuality;
use crate::wear::layout::fold_layout::{FoldLayout, Foresight};
use crate::wear::script::WearScript;
use crease_geometry::math::Vec3;
use crease_model::garment::Garment;
use crease_model::remesh::SurfaceMesh;

/// The surface of a garment with fold lines.
#[derive(Debug, Clone)]
pub struct DrawnLines<'a> {
    /// The garment's surface with edges along every fold line, through every layer that it passes, and a row of edges on
    /// either side.
    pub mesh: SurfaceMesh<'a>,
    /// How far ahead creases are known.
    pub foresight: Foresight,
    /// How good the layout in the plane is, of a garment that does not lie in its file.
    pub layout: Option<LayoutQuality>,
}

/// Draws the fold lines of `script` on `garment`, as far as they can be told, with a row of edges at `row` [m] on either side of
/// each. `laid` are the positions of the garment after it was laid, one per point [m], needed where it does not lie in its file;
/// `thickness` is that of a layer [m], round which outer layers of a stack bend later than inner ones.
pub fn draw_fold_lines<'a>(
    garment: &'a Garment,
    script: &WearScript,
    laid: Option<&'a [Vec3]>,
    thickness: f64,
    row: f64,
) -> DrawnLines<'a> {
    let mut layout = FoldLayout::new(garment, laid, thickness, row);
    for (index, action) in script.flatten().enumerate() {
        if !layout.begin_action(index) {
            break;
        }
        action.as_wear_action().predict_creases(&mut layout);
    }
    let (mut lines, foresight, layout) = layout.finish();
    lines.draw_rows();
    DrawnLines { mesh: lines.into_mesh(), foresight, layout }
}

#[cfg(test)]
mod tests {
    use super::*;

    use crease_model::remesh::Curve;

    const STEP: f64 = 0.01;
    /// Of a layer: half of the distance of the two [m].
    const THICKNESS: f64 = 5e-4;
    /// So narrow that rows lie at the line.
    const NO_ROW: f64 = 1e-3;

    /// Two layers of 0.2 x 0.2 m, level or bulged by `bulge` [m], joined along the left and the right side.
    fn sleeve(bulge: f64) -> Garment {
        let row = 21u32;
        let mut points = Vec::new();
        for side in [-1.0, 1.0] {
            for k in 0..row * row {
                let x = STEP * f64::from(k % row);
                let height = side * (5e-4 + bulge * (x / 0.2 * std::f64::consts::PI).sin());
                points.push(Vec3::new(x, height, STEP * f64::from(k / row)));
            }
        }
        // The side points of the upper layer are those of the lower one.
        let name = |layer: u32, i: u32, j: u32| {
            let side = i == 0 || i == row - 1;
            (if side { 0 } else { layer * row * row }) + j * row + i
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
        Garment::of_triangles(points, &triangles)
    }

    fn script(actions: &str) -> WearScript {
        let text = format!(r#"{{"format": "crease-wear/1", "name": "", "actions": [{actions}]}}"#);
        WearScript::parse("wear.json", &text).expect("is a script")
    }

    /// Columns of drawn lines [steps] and their layer (0 below, 1 above), and the foresight.
    fn drawn(garment: &Garment, actions: &str, laid: Option<&[Vec3]>) -> (Vec<(i64, usize)>, Foresight) {
        let script = script(actions);
        let DrawnLines { mesh, foresight, .. } = draw_fold_lines(garment, &script, laid, THICKNESS, NO_ROW);
        let lines = mesh
            .edges()
            .into_iter()
            .filter(|[a, b]| matches!(mesh.curve(*a, *b), Some(Curve::Line(_) | Curve::Rim)));
        let place = |[a, b]: [u32; 2]| {
            let middle = 0.5 * (mesh.x[a as usize] + mesh.x[b as usize]);
            ((middle.x / STEP).round() as i64, usize::from(middle.y > 0.0))
        };
        let mut found: Vec<(i64, usize)> = lines.map(place).collect();
        found.sort_unstable();
        found.dedup();
        (found, foresight)
    }

    const LAY: &str = r#"{"lay": {"facing": "up"}}"#;
    const LEFT: &str = r#"{"fold": {"line": [[0.25, 0.0], [0.25, 1.0]], "side": "left"}}"#;

    #[test]
    fn a_later_fold_goes_through_all_layers() {
        // The left quarter over the second; then what is left of 0.4 (of the whole width) over the rest.
        let second = LEFT.replace("0.25", "0.4");
        let found = drawn(&sleeve(0.0), &format!("{LAY}, {LEFT}, {second}"), None);
        // The second line lies at column 8, and on the flap at column 2.
        let lines = vec![(2, 0), (2, 1), (5, 0), (5, 1), (8, 0), (8, 1)];
        assert_eq!(found, (lines, Foresight::Whole));
    }

    #[test]
    fn an_opened_fold_is_flat_again() {
        let unfold = r#"{"unfold": {"all": true}}"#;
        let second = LEFT.replace("0.25", "0.4");
        let (found, _) = drawn(&sleeve(0.0), &format!("{LAY}, {LEFT}, {unfold}, {second}"), None);
        assert_eq!(found, [(5, 0), (5, 1), (8, 0), (8, 1)]);
    }

    #[test]
    fn a_prediction_ends_where_the_cloth_may_crease_anywhere() {
        for action in [
            r#"{"crumple": {"to": 0.3}}"#,
            r#"{"hang": {}}"#,
            r#"{"fold": {"line": [[0.25, 0.0], [0.25, 1.0]], "side": "left", "angle": 90}}"#,
        ] {
            let actions = format!("{LAY}, {LEFT}, {action}");
            let lines = vec![(5, 0), (5, 1)];
            assert_eq!(drawn(&sleeve(0.0), &actions, None), (lines, Foresight::Until(2)), "{action}");
        }
        assert_eq!(drawn(&sleeve(0.0), LEFT, None).1, Foresight::Until(0), "nothing lies yet");
    }

    #[test]
    fn a_garment_that_does_not_lie_is_laid_first() {
        let actions = format!("{LAY}, {LEFT}");
        let garment = sleeve(0.15);
        // Edges where the cloth turns over, to lay it on.
        let rims = vec![(0, 0), (20, 0)];
        assert_eq!(drawn(&garment, &actions, None), (rims, Foresight::NeedsLaying));
        let laid = sleeve(0.0).points;
        let lines = vec![(0, 0), (5, 0), (5, 1), (20, 0)];
        assert_eq!(drawn(&garment, &actions, Some(&laid)), (lines, Foresight::Whole));
    }
}
