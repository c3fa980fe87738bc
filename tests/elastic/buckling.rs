//! A compressed strip: from flat, past the point where the Hessian becomes indefinite.

use crate::rest::{Scene, forces};
use crate::sheet::{SheetModels, quads, spaced};

/// End shortening, rise of the middle over L, end force over pi² B w / L² (`buckled_strip.csv`, elliptic integrals).
const TABLE: [(f64, f64, f64); 4] = [
    (0.05, 0.140_110_61, 1.025_724_3),
    (0.1, 0.194_924_31, 1.052_986_9),
    (0.2, 0.266_318_59, 1.112_738_7),
    (0.3, 0.314_312_61, 1.180_698_8),
];

/// Property: compressed from flat, with a perturbation of 1e-4 L, a strip pinned at both ends rises within 1 % of the
/// elastica, and its end force is within 3 % of it.
#[test]
fn a_compressed_strip_buckles_as_the_elastica() {
    let (length, width, along, rigidity) = (0.2, 0.02, 40, 1e-5);
    let sheet = quads(&spaced(0.0, length, along), &spaced(0.0, width, 4), false);
    let held: Vec<bool> = sheet.flat.iter().map(|p| p.x < 1e-9 || p.x > length - 1e-9).collect();
    let stretch = 1e5 * rigidity / (length * length);
    let mut scene = Scene::clamped(&sheet, 0.2, stretch, rigidity, held);
    scene.memory = sheet.memory();
    let mut x = sheet.laid();
    for (x, p) in x.iter_mut().zip(&sheet.flat) {
        x.z = 1e-4 * length * (std::f64::consts::PI * p.x / length).sin();
    }
    let mut checked = 0;
    for shortening in [0.001, 0.005, 0.02, 0.05, 0.1, 0.15, 0.2, 0.25, 0.3] {
        for (x, p) in x.iter_mut().zip(&sheet.flat).filter(|(_, p)| p.x > length - 1e-9) {
            x.x = p.x - shortening * length;
        }
        let report = scene.settle(&mut x, 0.02, 1e-12 * length);
        assert!(x.iter().all(|x| x.iter().all(|c| c.is_finite())));
        let Some((_, rise, push)) = TABLE.iter().find(|row| row.0 == shortening) else { continue };
        let top = x.iter().map(|x| x.z.abs()).fold(0.0, f64::max) / length;
        let at_end = |p: &nalgebra::Vector2<f64>| p.x < 1e-9;
        let held_back = scene.terms(&x, |terms| forces(terms, &x));
        let force: f64 = held_back.iter().zip(&sheet.flat).filter(|(_, p)| at_end(p)).map(|(f, _)| f.x).sum();
        let critical = std::f64::consts::PI.powi(2) * rigidity * width / (length * length);
        let (off_rise, off_push) = (top / rise - 1.0, force.abs() / critical / push - 1.0);
        println!(
            "shortened by {shortening}: rise {:+.3} %, force {:+.3} %, {} iterations",
            100.0 * off_rise,
            100.0 * off_push,
            report.global_iterations
        );
        assert!(off_rise.abs() <= 0.01 && off_push.abs() <= 0.03);
        checked += 1;
    }
    assert_eq!(checked, TABLE.len());
}
