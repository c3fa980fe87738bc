//! Relaxation of a garment with a rest state that it did not earn in a simulation: one that was transferred or edited.
//!
//! The second phase of a bake on its own. The cloth relaxes to its source pose with the rest state in it, under
//! self-contact; no script is run and the memory law is not applied. Beside it the rest mesh: the shape of the same topology
//! that carries the rest angles best, free of pose and contact, for programs that take rest angles from a shape.

use crate::bake::relax::relax_to_source::{RelaxOptions, RelaxResult, relax_to_source_pose};
use crate::bake::tuning::TUNING;
use crate::bake::{BakeOptions, ModelPlan, Quality};
use crate::wear::{WearFormat, WearScript};
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, RestState, RigidParts};
use crease_solver::contact::Contact;
use crease_solver::sim::{Cloth, GRAVITY, Sewing, Stepper};

/// Relaxes `garment` of `fabric` to its source pose with the rest state `rest` (one entry per hinge and triangle of it).
///
/// ```
/// use crease::{Fabric, GarmentFile, RestState, relax};
/// let sheet = GarmentFile::sheet([0.1, 0.1], [4, 4])?.garment;
/// let mut rest = RestState::flat(sheet.topology.hinges.len(), sheet.triangles.len());
/// rest.rest_angle.iter_mut().for_each(|angle| *angle = 0.2);
/// let relaxed = relax(&sheet, &Fabric::preset("denim")?, &rest);
/// assert_eq!(relaxed.unconverged_reason, None);
/// assert!(relaxed.displacement.iter().any(|d| d.norm() > 1e-4));
/// # Ok::<(), crease::Error>(())
/// ```
pub fn relax(garment: &Garment, fabric: &Fabric, rest: &RestState) -> RelaxResult {
    relax_at_strength(garment, fabric, rest, 1.0)
}

/// Relaxes `garment` as [`relax`] does; `rest` is `strength` times what was earned.
pub(crate) fn relax_at_strength(
    garment: &Garment,
    fabric: &Fabric,
    rest: &RestState,
    strength: f64,
) -> RelaxResult {
    let on_cloth = |cloth: &Garment, rest: &RestState| {
        relax_to_show(cloth, fabric, rest, &RelaxOptions::visible_on(cloth, fabric, strength))
    };
    let Some(rigid) = RigidParts::find(garment) else { return on_cloth(garment, rest) };
    let relaxed = on_cloth(rigid.cloth(), &rigid.cloth_memory(rest));
    RelaxResult { displacement: rigid.displacement(&relaxed.displacement), ..relaxed }
}

/// Relaxes `garment`, with layers kept apart.
pub(crate) fn relax_to_show(
    garment: &Garment,
    fabric: &Fabric,
    rest: &RestState,
    options: &RelaxOptions,
) -> RelaxResult {
    let (cloth, plan) = cloth_and_plan(garment, fabric);
    let settings = plan.contact_settings(fabric);
    let area = cloth.area.clone();
    let contact = Contact::new(settings, &garment.points, &garment.triangles, &garment.topology, area);
    relax_with(garment, fabric, rest, cloth, contact, options)
}

/// The mesh of `garment`'s topology that best carries the rest angles of `rest`, as displacements from the source pose.
/// Layers may cross in it: it is a shape to measure angles on.
pub fn rest_mesh(garment: &Garment, fabric: &Fabric, rest: &RestState) -> RelaxResult {
    let (mut cloth, plan) = cloth_and_plan(garment, fabric);
    cloth.membrane.set_stiffness(plan.stretch.map(|k| k * TUNING.relax.rest_mesh_stretch));
    let contact = Contact::none(garment.points.len());
    let options = RelaxOptions {
        tether_scale: TUNING.relax.rest_mesh_tether,
        free_shift: f64::INFINITY,
        max_stretch: f64::INFINITY,
        max_angle: None,
    };
    relax_with(garment, fabric, rest, cloth, contact, &options)
}

/// The elastic model and the plan, with the stretch stiffness of a bake.
fn cloth_and_plan(garment: &Garment, fabric: &Fabric) -> (Cloth, ModelPlan) {
    let empty = WearScript { format: WearFormat::V1, name: String::new(), actions: Vec::new() };
    let plan = ModelPlan::new(garment, fabric, &empty, &BakeOptions::default());
    let mut cloth = Cloth::sewn(garment, fabric, Sewing::ALL);
    cloth.membrane.set_stiffness(plan.stretch);
    (cloth, plan)
}

fn relax_with(
    garment: &Garment,
    fabric: &Fabric,
    rest: &RestState,
    cloth: Cloth,
    contact: Contact,
    options: &RelaxOptions,
) -> RelaxResult {
    let step = Quality::Standard.step_options_for(cloth.mass.iter().sum::<f64>() * GRAVITY);
    let mut stepper = Stepper::new(cloth, contact, step);
    relax_to_source_pose(garment, fabric, &mut stepper, rest, options, None)
}
