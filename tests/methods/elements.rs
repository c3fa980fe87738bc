//! Degenerate elements: slivers and obtuse triangles.

use crease_geometry::math::{Mat3, Vec2, Vec3};
use crease_geometry::mesh::{PointIndex, Topology};
use crease_linear::BlockSink;
use crease_model::garment::RestState;
use crease_solver::energy::{Bending, Energy, Membrane};

/// Two triangles on an edge of length 1, apices `height` from it on both sides at `position` along it.
fn pair(position: f64, height: f64) -> (Vec<Vec2>, Vec<[u32; 3]>) {
    let flat = vec![
        Vec2::new(0.0, 0.0),
        Vec2::new(1.0, 0.0),
        Vec2::new(position, height),
        Vec2::new(1.0 - position, -height),
    ];
    (flat, vec![[0, 1, 2], [1, 0, 3]])
}

struct Dense(nalgebra::DMatrix<f64>);

impl BlockSink for Dense {
    fn add(&mut self, i: u32, j: u32, block: &Mat3) {
        let (i, j) = (3 * i as usize, 3 * j as usize);
        let (mut at, turned) = (self.0.view_mut((i, j), (3, 3)), block.transpose());
        at += block;
        if i != j {
            let mut at = self.0.view_mut((j, i), (3, 3));
            at += turned;
        }
    }
}

/// Smallest and largest eigenvalue of membrane (Y = 1) and bending (B = 1) of a pair, in a slightly bent and
/// stretched pose, and its smallest point mass over the largest.
fn stiffness(position: f64, height: f64) -> ([[f64; 2]; 2], f64) {
    let (flat, triangles) = pair(position, height);
    let material: Vec<[Vec2; 3]> = triangles.iter().map(|t| t.map(|p| flat[p as usize])).collect();
    let topology = Topology::new(4, &triangles.iter().map(|t| t.map(PointIndex)).collect::<Vec<_>>());
    let membrane = Membrane::from_parts(&triangles, &material, [1.0, 1.0, 0.5], 0.0);
    let bending = Bending::from_parts(&topology, &material, [1.0; 2], 0.0);
    let memory = RestState::flat(1, 2);
    let x: Vec<Vec3> =
        flat.iter().map(|p| Vec3::new(1.02 * p.x, p.y, 0.2 * p.y.abs() + 0.01 * p.x * p.y)).collect();
    let last = bending.angles(&x, &[]);
    let ends = |term: &dyn Energy| {
        let mut dense = Dense(nalgebra::DMatrix::zeros(12, 12));
        term.add_hessian(&x, &mut dense);
        assert!(dense.0.iter().all(|h| h.is_finite()), "{}: not finite", term.name());
        let eigen = dense.0.symmetric_eigenvalues();
        [eigen.min(), eigen.max()]
    };
    let mut mass = [0.0; 4];
    for (t, area) in triangles.iter().zip(membrane.area()) {
        t.iter().for_each(|&p| mass[p as usize] += area / 3.0);
    }
    let mass = mass.iter().fold((f64::INFINITY, 0.0f64), |(l, h), m| (l.min(*m), h.max(*m)));
    let both = [
        ends(&membrane.term(&memory, &[], f64::INFINITY)),
        ends(&bending.term(&memory, &last, f64::INFINITY)),
    ];
    (both, mass.0 / mass.1)
}

/// Property: slivers are finite and positive semi-definite down to altitudes of 1e-6 of the edge; below 1e-3 the
/// membrane clamps the altitude to 1e-3, which bounds its stiffness.
#[test]
fn slivers_stay_finite_and_positive() {
    let mut last = 0.0;
    for height in [1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6] {
        let ([membrane, bending], _) = stiffness(0.5, height);
        println!(
            "altitude {height:.0e}: membrane {:.2e} to {:.2e} Y (table {:.2e}), bending to {:.2e} B",
            membrane[0],
            membrane[1],
            0.75 / height,
            bending[1]
        );
        assert!(membrane[0] >= -1e-10 * membrane[1] && bending[0] >= -1e-10 * bending[1]);
        if height < 0.9e-3 {
            assert!(membrane[1] <= 1.01 * last, "the altitude is not clamped");
        }
        last = membrane[1];
    }
}

/// Property: obtuse triangles (170 degrees) have positive masses and positive semi-definite stiffness.
#[test]
fn obtuse_triangles_have_mass_and_positive_stiffness() {
    for position in [0.5, 0.9, 1.5, 3.0] {
        // The angle at the apex is 170 degrees where the apex projects onto the edge.
        let ([membrane, bending], mass) = stiffness(position, 0.0875 * position.min(1.0) * 0.5);
        println!(
            "apex at {position}: masses {mass:.2}, eigenvalues from {:.1e} and {:.1e}",
            membrane[0], bending[0]
        );
        assert!(mass > 0.0 && membrane[0] >= -1e-10 * membrane[1] && bending[0] >= -1e-10 * bending[1]);
    }
}
