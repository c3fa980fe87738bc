//! Second phase of a bake: quasi-static relaxation to the source pose.
//!
//! The result of a bake is not the pose in which the script ended but the source pose with the wrinkles that the memory
//! makes in it: the minimum of the elastic energy with the remembered rest state plus a weak tether to the source positions
//! X,
//!
//! ```text
//! E = E_membrane + E_bending + sum A_i t/2 |x_i - X_i|²,     t = B / l^4
//! ```
//!
//! that acts over the length l of a panel, so that the cloth beside a crease stays flat and the pose is kept by what is larger. A crease
//! of the angle a moves its line by a l / (2 sqrt 2): a beam of the stiffness B on this foundation, with a kink in it. Weight and body
//! open it: what is remembered is applied up to an angle that is an assumption, as no load of the pose is known ([`WornGarment::OPENED_ANGLE`]). Where
//! creases cross or end at a hem their shifts add up: beyond a free distance the tether is stiffer. Without memory the source pose
//! itself is the minimum. Cloth as stiff as it is against stretch cannot crease across a curved surface (a garment in the shape of
//! a body) without moving as a whole, which the tether forbids: here it stretches more easily. The rest state is applied in equal
//! load increments; self-contact acts as in any other step, and what crosses in the source pose stays where it is. Beside a body the cloth is kept out of it as far as it is out of it in the
//! source pose (`static_contact`).

use crate::bake::body::static_contact::{FoundContacts, StaticContact, body_contact_settings};
use crate::bake::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::intersections::self_intersections;
use crease_model::body::AnimatedBody;
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, RestState, WornGarment};
use crease_model::remesh::{GarmentSurface, opened_memory};
use crease_solver::contact::BodyPlanes;
use crease_solver::energy::{EdgeContacts, Energy, PlaneContacts, PoseTether};
use crease_solver::sim::{GRAVITY, NewtonOptions, Stepper};

/// Result of a relaxation.
#[derive(Debug, Clone, PartialEq, Default)]
#[non_exhaustive]
pub struct RelaxResult {
    /// One per point: displacement from the source pose [m].
    pub displacement: Vec<Vec3>,
    /// Displacement of the points of the mesh that the garment was relaxed on [m], if that is another one.
    pub on_mesh: Option<Vec<Vec3>>,
    /// Linear solves of global Newton iterations.
    pub solves: u64,
    /// Linear solves of local Newton iterations.
    pub local_solves: u64,
    /// Warnings.
    pub warnings: Vec<String>,
    /// Reason why the result is no equilibrium, if it is none.
    pub unconverged_reason: Option<String>,
}

/// Options of a relaxation.
pub(crate) struct RelaxOptions {
    /// Factor on the stiffness of the tether [-].
    pub tether_scale: f64,
    /// Displacement up to which the tether is a linear spring [m].
    pub free_shift: f64,
    /// Stretch stiffness at most [N/m].
    pub max_stretch: f64,
    /// Angle to which the pose opens a crease that remembers any more [rad]; `None` for all that is remembered.
    pub max_angle: Option<f64>,
}

impl RelaxOptions {
    /// The options with which `garment` shows a memory of `strength` times what was earned. A crease decays over 5 cm, over some edges or
    /// over the bending length, whichever is most: the tether is the bending stiffness over the fourth power of this length. The cloth stretches as
    /// easily as a sheet so thick that a crease can run across a curved surface.
    pub fn visible_on(garment: &Garment, fabric: &Fabric, strength: f64) -> Self {
        let own = fabric.bending_length();
        let decay = own.max(TUNING.relax.min_decay).max(TUNING.relax.decay_edges * garment.mean_edge());
        let panel = garment.mean_edge().max(TUNING.relax.panel_width);
        let thickness = panel * panel / TUNING.relax.surface_radius;
        Self {
            tether_scale: (own / decay).powi(4),
            free_shift: strength * TUNING.relax.free_shift,
            max_stretch: 12.0 * fabric.bend_mean() / (thickness * thickness),
            max_angle: Some(strength * WornGarment::OPENED_ANGLE * TUNING.relax.min_decay / decay),
        }
    }
}

/// Relaxes `garment` of `fabric` with the rest state `rest`, by the solver and contact of `stepper`, beside `body` if it is worn
/// on one.
pub(in crate::bake) fn relax_to_source_pose(
    garment: &Garment,
    fabric: &Fabric,
    stepper: &mut Stepper,
    rest: &RestState,
    options: &RelaxOptions,
    body: Option<&AnimatedBody>,
) -> RelaxResult {
    let mut result = RelaxResult::default();
    let changed = rest.rest_angle != rest.source_angle
        || rest.rest_stretch_warp.iter().chain(&rest.rest_stretch_weft).any(|r| *r != 1.0);
    if !changed {
        result.displacement = vec![Vec3::zeros(); garment.points.len()];
        return result;
    }
    let mesh = options.max_angle.map(|_| GarmentSurface::without_texture(garment));
    let opened = mesh.zip(options.max_angle).map(|(mesh, limit)| opened_memory(&mesh, rest, limit));
    let rest = opened.as_ref().unwrap_or(rest);
    let tether = options.tether_scale * fabric.area_density() * GRAVITY / fabric.bending_length();
    let stiffness: Vec<f64> = stepper.cloth.area.iter().map(|area| area * tether).collect();
    let tethers = PoseTether {
        source: &garment.points,
        stiffness: &stiffness,
        free: options.free_shift,
        growth: TUNING.relax.tether_growth,
    };
    let crossing = match stepper.contact.settings().self_contact {
        true => crossing_points(garment),
        false => vec![false; garment.points.len()],
    };
    let mut x = garment.points.clone();
    let mut angle = rest.source_angle.clone();
    let weight = stepper.cloth.mass.iter().sum::<f64>() * GRAVITY;
    let newton = NewtonOptions {
        displacement_tol: TUNING.relax.displacement_tol,
        decrement_tol: TUNING.relax.energy_tol_m * weight,
        rel_decrement_tol: 0.0,
        max_iterations: TUNING.relax.max_iterations,
    };
    let increments = TUNING.relax.load_increments;
    // The models are cloned so that their terms may live beside the stepper they are given to.
    let (mut model, bending) = (stepper.cloth.membrane.clone(), stepper.cloth.bending.clone());
    let junctions = stepper.cloth.junctions.clone();
    model.limit_stiffness(options.max_stretch);
    let mut planes = body.map(|body| {
        let settings = body_contact_settings(garment, stepper.contact.settings(), stepper.cloth.area.clone());
        BodyPlanes::new(body.rest_points(), body.triangles(), settings)
    });
    let mut beside = planes
        .as_mut()
        .zip(body)
        .map(|(planes, body)| StaticContact::new(planes, garment, body).limited_to_source());
    // Where triangles still intersect the body, contact acts from farther away in the next round.
    let rounds = increments + if body.is_some() { TUNING.relax.body_rounds } else { 0 };
    for round in 1..=rounds {
        let partial = rest.with_changes_times(f64::from(round.min(increments)) / f64::from(increments));
        let membrane = model.term(&partial, &[], f64::INFINITY);
        let last_angle = angle.clone();
        let bending_term = bending.term(&partial, &last_angle, f64::INFINITY);
        let found = match &mut beside {
            Some(beside) => beside.find(&x),
            None => FoundContacts { planes: Vec::new(), edges: Vec::new() },
        };
        let (on_planes, on_edges) = (PlaneContacts(&found.planes), EdgeContacts(&found.edges));
        let terms: [&dyn Energy; 6] = [&membrane, &bending_term, &junctions, &tethers, &on_planes, &on_edges];
        let solved = stepper.equilibrium(&mut x, &crossing, &terms, &newton);
        if let Some(beside) = &mut beside {
            beside.accept(&x, &found);
        }
        result.solves += solved.global_iterations as u64;
        result.local_solves += solved.local_iterations as u64;
        if !solved.converged && round == rounds {
            let what = format!(
                "relaxation: the equilibrium did not converge in {} iterations (last displacement {:.1e} m)",
                newton.max_iterations, solved.max_displacement
            );
            result.warnings.push(what.clone());
            result.unconverged_reason = Some(what);
        }
        angle = stepper.cloth.bending.angles(&x, &angle);
    }
    result.displacement = x.iter().zip(&garment.points).map(|(x, source)| x - source).collect();
    result
}

/// Per point of `garment`: whether it belongs to a triangle that crosses another one in the source pose. No side of it is the right one,
/// and contact would hook it: it stays where it is.
fn crossing_points(garment: &Garment) -> Vec<bool> {
    let mut crossing = vec![false; garment.points.len()];
    for f in self_intersections(&garment.points, &garment.triangles).into_iter().flatten() {
        garment.triangles[f as usize].iter().for_each(|p| crossing[p.at()] = true);
    }
    crossing
}
