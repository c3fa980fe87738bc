//! Bringing the garment back to its own pose with its memory.
//!
//! What is baked is not the pose the cloth happened to end in but the source pose plus what the memory does to it:
//! the equilibrium of the elastic energy with the remembered rest shape, held to the source positions by springs
//! about as soft as gravity is on a wrinkle,
//!
//! ```text
//! E = E_membrane + E_bending + sum A_i t/2 |x_i - X_i|²,     t = rho g / c     (c: bending length)
//! ```
//!
//! so that a crease stands out as it would in cloth that lies, and nothing larger moves. Without memory the source
//! pose itself is the equilibrium. Layers are kept apart on the way as in any other step.

use crate::bake::BakeReport;
use crate::energy::{Energy, TargetSpring, TargetSprings};
use crate::fabric::Fabric;
use crate::garment::{Garment, RestState};
use crate::math::Vec3;
use crate::sim::GRAVITY;
use crate::sim::{NewtonOptions, Stepper};

/// The memory is let in by this many equal shares: a crease of 170 degrees at once would be a jump.
const SHARES: u32 = 6;

/// Converged, too, when what energy is left to gain would not lift the garment by this [m]: a tenth of what a step
/// asks for, far below what shows.
const SLACK: f64 = 3e-7;

/// How a garment is brought home.
pub(super) struct Homeward {
    /// Scales the springs: 1 for a garment at home.
    pub(super) hold: f64,
    /// Solves of the whole for each share but the last, at most: what is left of one the next finds.
    pub(super) on_the_way: usize,
}

impl Homeward {
    /// Every share solved for to its end.
    pub(super) const STEADILY: Self = Self { hold: 1.0, on_the_way: MOST_ITERATIONS };
    /// One solve of the whole a share: for a garment of which fewer points were worn, whose way home is the longest part.
    pub(super) const SWIFTLY: Self = Self { hold: 1.0, on_the_way: 1 };
}

/// Solves of the whole for a share, at most.
const MOST_ITERATIONS: usize = 60;

/// Displacement of every point from the source pose [m].
pub(super) fn bring_home(
    garment: &Garment,
    fabric: &Fabric,
    stepper: &mut Stepper,
    memory: &RestState,
    how: &Homeward,
    report: &mut BakeReport,
) -> Vec<Vec3> {
    let changed = memory.rest_angle != memory.source_angle
        || memory.rest_stretch_warp.iter().chain(&memory.rest_stretch_weft).any(|r| *r != 1.0);
    if !changed {
        return vec![Vec3::zeros(); garment.points.len()];
    }
    let tether = how.hold * fabric.area_density() * GRAVITY / fabric.bending_length();
    let guides: Vec<TargetSpring> = garment
        .points
        .iter()
        .zip(&stepper.cloth.area)
        .enumerate()
        .map(|(p, (x, area))| TargetSpring::isotropic(p as u32, *x, area * tether))
        .collect();
    let mut x = garment.points.clone();
    let mut angle = memory.source_angle.clone();
    let weight = stepper.cloth.mass.iter().sum::<f64>() * GRAVITY;
    let newton = NewtonOptions {
        displacement_tol: 1e-5,
        decrement_tol: SLACK * weight,
        rel_decrement_tol: 0.0,
        max_iterations: MOST_ITERATIONS,
    };
    let passing = NewtonOptions { max_iterations: how.on_the_way, ..newton };
    for share in 1..=SHARES {
        let part = f64::from(share) / f64::from(SHARES);
        let partial = share_of(memory, part);
        // The models are cloned so that their terms may live beside the stepper they are given to.
        let (membrane, bending) = (stepper.cloth.membrane.clone(), stepper.cloth.bending.clone());
        let membrane = membrane.term(&partial, &[], f64::INFINITY);
        let last = angle.clone();
        let bending_term = bending.term(&partial, &last, f64::INFINITY);
        let springs = TargetSprings(&guides);
        let terms: [&dyn Energy; 3] = [&membrane, &bending_term, &springs];
        let own = if share < SHARES { &passing } else { &newton };
        let solved = stepper.equilibrium(&mut x, &terms, own);
        report.solves += solved.global_iterations as u64;
        report.local_solves += solved.local_iterations as u64;
        if !solved.converged && share == SHARES {
            let what = format!(
                "home: the equilibrium did not converge in {} iterations (last move {:.1e} m)",
                newton.max_iterations, solved.max_displacement
            );
            report.warnings.push(what.clone());
            report.unconverged_reason = Some(what);
        }
        angle = stepper.cloth.bending.angles(&x, &angle);
    }
    x.iter().zip(&garment.points).map(|(x, home)| x - home).collect()
}

/// The memory with only `part` of what changed.
fn share_of(memory: &RestState, part: f64) -> RestState {
    let towards = |from: f64, to: f64| from + part * (to - from);
    RestState {
        source_angle: memory.source_angle.clone(),
        rest_angle: memory
            .source_angle
            .iter()
            .zip(&memory.rest_angle)
            .map(|(s, r)| towards(*s, *r))
            .collect(),
        stiffness_ratio: memory.stiffness_ratio.clone(),
        rest_stretch_warp: memory.rest_stretch_warp.iter().map(|r| towards(1.0, *r)).collect(),
        rest_stretch_weft: memory.rest_stretch_weft.iter().map(|r| towards(1.0, *r)).collect(),
    }
}
