//! Properties of one hinge of two triangles: geometry and memory together.

use crate::law::{PATHS, random};
use crease_geometry::math::{Vec2, Vec3};

use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, RestState};
use crease_solver::energy::Bending;
use crease_solver::memory::{ElementParams, HysteresisState, Memory, MemoryLaw, MemoryModel, Strains};

/// Two triangles on a common edge of `size` [m], flat.
pub fn pair(size: f64) -> Garment {
    let points = [[0.0, 0.0], [1.0, 0.0], [0.5, 1.0], [0.5, -1.0]].map(|[x, y]| Vec2::new(x, y) * size);
    let triangles = [[0, 1, 2], [1, 0, 3]];
    let pair = Garment::of_triangles(points.map(|p| Vec3::new(p.x, p.y, 0.0)).into(), &triangles);
    Garment {
        material: triangles.map(|t| t.map(|p| points[p as usize])).into(),
        material_from_uv: true,
        ..pair
    }
}

/// The pair with its second triangle turned by `angle` [rad].
pub fn folded(garment: &Garment, angle: f64) -> Vec<Vec3> {
    let mut x = garment.points.clone();
    let arm = x[3].y;
    x[3] = Vec3::new(x[3].x, arm * angle.cos(), arm.abs() * angle.sin());
    x
}

/// A hinge under observation.
pub struct Watched {
    pub bending: Bending,
    pub law: MemoryModel,
    pub memory: Memory,
    pub angle: Vec<f64>,
}

impl Watched {
    pub fn new(garment: &Garment, fabric: &Fabric) -> Self {
        let bending = Bending::new(garment, fabric);
        let law = MemoryModel::new(garment, fabric, bending.width(), fabric.memory.reference_length());
        let angle = bending.angles(&garment.points, &[]);
        let memory = Memory::new(RestState::new(angle.clone(), garment.triangles.len()));
        Self { bending, law, memory, angle }
    }

    /// One accepted step that ends at `x`.
    pub fn step(&mut self, x: &[Vec3], duration: f64) {
        let next = self.bending.angles(x, &self.angle);
        let seen = |angle| Strains { angle, stretch: &[] };
        self.memory.commit(&self.law, &seen(&self.angle), &seen(&next), duration);
        self.angle = next;
    }
}

fn t_shirt() -> Fabric {
    Fabric::preset("kow-tshirt").expect("exists")
}

/// Property: a hinge may be turned beyond half a turn and back; its angle never jumps, and its memory is that of the
/// smooth path.
#[test]
fn beyond_half_a_turn_nothing_jumps() {
    let garment = pair(0.02);
    let law = MemoryLaw::for_angles(&t_shirt().memory);
    // The sense of the angle is the mesh's; turn the way it counts up.
    let sense = {
        let mut watched = Watched::new(&garment, &t_shirt());
        watched.step(&folded(&garment, 0.1), 0.1);
        watched.angle[0].signum()
    };
    let degrees: Vec<f64> = (0..=190).chain((-190..190).rev()).map(f64::from).collect();
    let mut watched = Watched::new(&garment, &t_shirt());
    let mut state = HysteresisState::new(0.0);
    for ends in degrees.windows(2) {
        let [from, to] = [ends[0].to_radians(), ends[1].to_radians()];
        watched.step(&folded(&garment, sense * to), 0.1);
        law.advance(&mut state, from, to, 0.1, &ElementParams::FLAT);
        assert!((watched.angle[0] - to).abs() < 1e-12, "{} is not {to}", watched.angle[0]);
    }
    let rest = watched.memory.rest.rest_angle[0];
    println!("rest angle {rest:.6} rad, by the law {:.6}", state.rest);
    assert!((rest - state.rest).abs() < 1e-9 && rest != 0.0);
    assert!((watched.memory.rest.stiffness_ratio[0] / state.stiffness_ratio - 1.0).abs() < 1e-9);
}

/// Property: carried about and turned as a whole, cloth remembers the same to the last bit of its rest angle.
#[test]
fn rigid_motion_changes_nothing() {
    let garment = pair(0.02);
    let mut seed = 3;
    for (name, path) in PATHS {
        let (mut still, mut moved) = (Watched::new(&garment, &t_shirt()), Watched::new(&garment, &t_shirt()));
        for ends in path.windows(2) {
            let steps = ((ends[1].0 - ends[0].0) / 0.1).round() as usize;
            for k in 1..=steps {
                let angle = ends[0].1 + (ends[1].1 - ends[0].1) * k as f64 / steps as f64;
                let x = folded(&garment, angle);
                let mut number = || 2.0 * random(&mut seed) - 1.0;
                let turn = nalgebra::Rotation3::new(Vec3::new(number(), number(), number()) * 3.0);
                let shift = Vec3::new(number(), number(), number());
                still.step(&x, 0.1);
                moved.step(&x.iter().map(|p| turn * p + shift).collect::<Vec<_>>(), 0.1);
            }
        }
        let [a, b] =
            [&still, &moved].map(|w| (w.memory.rest.rest_angle[0], w.memory.rest.stiffness_ratio[0]));
        assert_eq!(a.0.to_bits(), b.0.to_bits(), "{name}: {a:?} {b:?}");
        assert!((a.1 / b.1 - 1.0).abs() < 1e-9 && a.0 != 0.0, "{name}: {a:?} {b:?}");
    }
}

/// Property: the memory can be read and reset through the library.
#[test]
fn memory_is_read_and_reset() {
    let garment = pair(0.02);
    let mut watched = Watched::new(&garment, &t_shirt());
    let new = watched.memory.clone();
    let bent = folded(&garment, 2.5);
    watched.step(&bent, 1.0);
    watched.step(&bent, 60.0);
    watched.step(&bent, 60.0);
    let shape = &watched.memory.rest;
    assert!(shape.rest_angle[0].abs() > 1.3 && shape.stiffness_ratio[0] > 2.0);
    assert!(watched.memory.events.critical >= 1 && watched.memory.events.gradual >= 1);
    assert!(
        (watched.memory.effective_rest.rest_angle[0] - shape.rest_angle[0]).abs() < 1e-9,
        "all has entered"
    );
    watched.memory.reset();
    assert_eq!(watched.memory, new);
}

/// Property: a mask from 0 to 1 scales what is remembered.
#[test]
fn masks_scale_what_is_remembered() {
    let left = [0.0, 0.25, 0.5, 1.0].map(|mask| {
        let mut garment = pair(0.02);
        garment.memory_mask = vec![mask; 4];
        let mut watched = Watched::new(&garment, &t_shirt());
        let bent = folded(&garment, 1.6);
        watched.step(&bent, 1.0);
        watched.step(&bent, 0.9);
        watched.memory.rest.rest_angle[0].abs()
    });
    println!("{left:.3?}");
    assert_eq!(left[0], 0.0);
    assert!((left[1] / left[3] - 0.25).abs() < 1e-9 && (left[2] / left[3] - 0.5).abs() < 1e-9, "{left:?}");
}
