//! Lateral buckling: a strip on edge, clamped at one end, buckles sideways beyond a critical weight.

use crate::rest::Scene;
use crate::sheet::{SheetModels, quads, spaced};
use crease_geometry::math::Vec3;

const G: f64 = 9.81;
const DENSITY: f64 = 0.2;
/// Y L² / B: so stiff that the strip does not sag in its own plane (0.1 % of L; at 1e5 it would by 11 %).
const STRETCH: f64 = 1e7;
/// Gamma = rho g L³ / B at which this mesh buckles, width 0.05 L, four elements across: an independent solution of the
/// eigenproblem (`lateral_buckling_mesh_face.csv`); the theory of narrow strips gives 18.18.
const CRITICAL: f64 = 18.3976;

/// Lateral displacement of the tip over L after a seed of 1e-3 L, at `fraction` of the critical Gamma.
fn lean(fraction: f64) -> f64 {
    let (length, along, across) = (0.2, 80, 4);
    let width = 0.05 * length;
    let mut xs = vec![-length / along as f64];
    xs.extend(spaced(0.0, length, along));
    let sheet = quads(&xs, &spaced(-0.5 * width, 0.5 * width, across), false);
    let held: Vec<bool> = sheet.flat.iter().map(|p| p.x < 1e-9).collect();
    let rigidity = DENSITY * G * length.powi(3) / (fraction * CRITICAL);
    let mut scene = Scene::clamped(&sheet, DENSITY, STRETCH * rigidity / (length * length), rigidity, held);
    // On edge: its plane is upright, z is aside.
    scene.gravity = Vec3::new(0.0, -G, 0.0);
    let mut x = sheet.laid();
    for x in &mut x {
        x.z = 1e-3 * length * (x.x.max(0.0) / length).powi(2);
    }
    for _ in 0..8 {
        scene.settle(&mut x, 0.05, 1e-9 * length);
    }
    x.iter().map(|x| x.z.abs()).fold(0.0, f64::max) / length
}

/// Property: the strip leans over by more than 0.05 L at 1.10 of the critical weight and does not at 0.90.
#[test]
fn a_strip_on_edge_leans_over_at_its_critical_weight() {
    let (below, above) = (lean(0.9), lean(1.1));
    println!("tip aside by {below:.4} L at 0.90 of the critical weight, {above:.4} L at 1.10");
    assert!(below < 0.05 && above > 0.05);
}
