//! Inputs of a bake, checked before the run: the stepper of a mesh, and the body against garment and script.

use crate::bake::body::active_region::active_points_on;
use crate::bake::body::depenetration::penetration_depths;
use crate::bake::body::leash::GarmentLeash;
use crate::bake::{BakeOptions, ModelPlan};
use crate::wear::WearScript;
use crease_model::body::AnimatedBody;
use crease_model::error::{Error, Result};
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, RestState};
use crease_model::remesh::{SimulationMesh, restrict};
use crease_solver::contact::Contact;
use crease_solver::memory::Memory;
use crease_solver::sim::{Cloth, GRAVITY, Stepper};
use std::sync::Arc;

/// Inputs of a bake beside the mesh.
pub(in crate::bake) struct BakeSetup<'a> {
    pub fabric: &'a Fabric,
    pub script: &'a WearScript,
    /// Name of the script in messages.
    pub script_name: &'a str,
    pub options: &'a BakeOptions,
    /// The garment without its trims.
    pub garment: &'a Garment,
    /// The memory that it begins with, where it is not new.
    pub earlier: Option<&'a RestState>,
}

impl BakeSetup<'_> {
    /// The memory that `mesh` begins with; its hinges have the angles `source_angle` [rad] in the source shape.
    pub fn start_memory(&self, mesh: &SimulationMesh, source_angle: Vec<f64>) -> Memory {
        match self.earlier {
            None => Memory::new(RestState::new(source_angle, mesh.garment.triangles.len())),
            Some(earlier) => Memory::of_worn(restrict(self.garment, earlier, mesh).on_source(source_angle)),
        }
    }

    /// The stepper of `garment` with the models of `plan`.
    pub fn stepper(&self, garment: &Garment, plan: &ModelPlan) -> Stepper {
        let (fabric, options) = (self.fabric, self.options);
        let mut cloth = Cloth::sewn(garment, fabric, options.sewing);
        cloth.membrane.set_stiffness(plan.stretch);
        if plan.min_bending_edges > 0.0 {
            cloth.bending.reinforce(&plan.bending_factors(garment, fabric));
        }
        if plan.layers_meet {
            cloth.bending.keep_apart();
        }
        let settings = plan.contact_settings(fabric);
        let area = cloth.area.clone();
        let contact = Contact::new(settings, &garment.points, &garment.triangles, &garment.topology, area);
        let mut step = options.effective_step();
        step.newton.decrement_tol = options.effective_energy_tol() * cloth.mass.iter().sum::<f64>() * GRAVITY;
        Stepper::new(cloth, contact, step)
    }
}

/// The body that wears the garment, checked against garment and script.
pub(in crate::bake) struct BodySetup {
    pub animated: Arc<AnimatedBody>,
    /// Per point of the garment: depth inside the body [m].
    pub depths: Vec<f64>,
    /// Per point of the garment: whether the body cannot affect it; empty when all can be affected.
    pub inactive: Vec<bool>,
    /// What holds the garment to its skin, if it has one.
    pub leash: Option<GarmentLeash>,
}

impl BodySetup {
    /// The body of the options, if there is one. Fails for joints and clips that it lacks and for a garment that does not
    /// fit it, with all faults at once.
    pub fn prepare(garment: &Garment, setup: &BakeSetup) -> Result<Option<Self>> {
        let Some(animated) = &setup.options.body else { return Ok(None) };
        let mut faults = setup.script.body_errors(setup.script_name, animated);
        let depths = match penetration_depths(&garment.points, animated) {
            Ok(depths) => depths,
            Err(Error::Input(more)) => {
                faults.extend(more);
                Vec::new()
            }
            Err(other) => return Err(other),
        };
        if !faults.is_empty() {
            return Err(Error::Input(faults));
        }
        let leash = GarmentLeash::new(garment, setup.options);
        let active = active_points_on(garment, leash.as_ref(), setup.script, setup.options);
        let inactive = active.iter().map(|active| !active).collect();
        Ok(Some(Self { animated: animated.clone(), depths, inactive, leash }))
    }
}
