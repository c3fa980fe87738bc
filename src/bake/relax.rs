//! A garment settled with a memory that it did not earn here: one that was carried over, or edited.
//!
//! The last stage of a bake on its own. The cloth comes to rest in its own pose with the memory in it, layers kept
//! apart as ever; nothing is worn and nothing is remembered. Beside it, the rest mesh: the shape of the same topology
//! that carries the rest angles best, free of pose and contact, for programs that take rest angles from a shape.

use crate::bake::relax_to_source::{Homeward, bring_home};
use crate::bake::{BakeOptions, BakeReport, ModelPlan, Quality};
use crate::contact::{Contact, ContactSettings};
use crate::fabric::Fabric;
use crate::garment::{Garment, RestState};
use crate::math::Vec3;
use crate::sim::GRAVITY;
use crate::sim::{Cloth, Stepper};
use crate::wear::{WearFormat, WearScript};

/// A garment at rest with its memory.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct RelaxResult {
    /// One per point: displacement from the source pose [m].
    pub displacement: Vec<Vec3>,
    /// Linear solves it took.
    pub solves: u64,
    /// What went less well.
    pub warnings: Vec<String>,
    /// Why it is not at rest, if it is not.
    pub unconverged_reason: Option<String>,
}

/// Tether of a rest mesh, as a share of that of a garment at home: only where it stays in space is held.
const LOOSE: f64 = 1e-4;
/// Stretch stiffness of a rest mesh, as a share of a draft's: a memory is seldom the angles of a surface that exists,
/// and lengths may give way by parts of a per cent before angles do.
const SOFT: f64 = 0.1;

/// Settles `garment` of `fabric` in its own pose with `memory` (one entry per hinge and triangle of it).
pub fn settle(garment: &Garment, fabric: &Fabric, memory: &RestState) -> RelaxResult {
    let (cloth, plan) = cloth_and_plan(garment, fabric, Quality::Standard);
    let (dhat, stiffness) = (plan.contact_distance, plan.contact_stiffness);
    let settings = ContactSettings::for_fabric(fabric, dhat, stiffness, plan.layers_meet);
    let area = cloth.area.clone();
    let contact = Contact::new(settings, &garment.points, &garment.triangles, &garment.topology, area);
    rest(garment, fabric, memory, cloth, contact, &Homeward::STEADILY)
}

/// The mesh of `garment`'s topology that best carries the rest angles of `memory`: displacements from the source pose.
/// Layers may cross in it, as it is a shape to measure angles on and not to be seen.
pub fn rest_mesh(garment: &Garment, fabric: &Fabric, memory: &RestState) -> RelaxResult {
    let (mut cloth, plan) = cloth_and_plan(garment, fabric, Quality::Draft);
    cloth.membrane.set_stiffness(plan.stretch.map(|k| k * SOFT));
    let contact = Contact::none(garment.points.len());
    let how = Homeward { hold: LOOSE, ..Homeward::STEADILY };
    rest(garment, fabric, memory, cloth, contact, &how)
}

/// The elastic model and the plan, as stiff in stretch as a bake of that quality.
fn cloth_and_plan(garment: &Garment, fabric: &Fabric, quality: Quality) -> (Cloth, ModelPlan) {
    let nothing = WearScript { format: WearFormat::V1, name: String::new(), actions: Vec::new() };
    let plan = ModelPlan::new(garment, fabric, &nothing, &BakeOptions::for_quality(quality));
    let mut cloth = Cloth::new(garment, fabric);
    cloth.membrane.set_stiffness(plan.stretch);
    (cloth, plan)
}

fn rest(
    garment: &Garment,
    fabric: &Fabric,
    memory: &RestState,
    cloth: Cloth,
    contact: Contact,
    how: &Homeward,
) -> RelaxResult {
    let options = Quality::Standard.step_for(cloth.mass.iter().sum::<f64>() * GRAVITY);
    let mut report = BakeReport::default();
    let mut stepper = Stepper::new(cloth, contact, options);
    let displacement = bring_home(garment, fabric, &mut stepper, memory, how, &mut report);
    let BakeReport { solves, warnings, unconverged_reason, .. } = report;
    RelaxResult { displacement, solves, warnings, unconverged_reason }
}
