//! The energy terms of one stage of a step.

use crate::energy::{
    BendingTerm, Drag, EdgeContacts, Energy, Gravity, Leashes, MembraneTerm, PlaneContacts, Pressure,
    ShrinkingSphere, TargetSprings,
};
use crate::sim::cloth::Cloth;
use crate::sim::integrator::Stage;
use crate::sim::loads::Loads;

/// Arrays that the energy terms of a step borrow.
pub(super) struct LoadBuffers {
    /// Fixed points, one flag per point.
    pub fixed: Vec<bool>,
    /// Downward force of the pressure, one per point [N]; empty without pressure.
    pub pressure_force: Vec<f64>,
    /// Stiffness of the shrinking sphere, one per point [N/m]; empty without a sphere.
    pub sphere_stiffness: Vec<f64>,
    /// Maximum force of the shrinking sphere, one per point [N]; empty without a sphere.
    pub sphere_max_force: Vec<f64>,
}

/// Returns the energies of a stage in their fixed order; those of absent loads are left out.
pub(super) fn stage_terms<'a>(
    cloth: &'a Cloth,
    loads: &'a Loads,
    buffers: &'a LoadBuffers,
    stage: &'a Stage,
    membrane: MembraneTerm<'a>,
    bending: BendingTerm<'a>,
) -> Vec<Box<dyn Energy + 'a>> {
    let gravity = Gravity { mass: &cloth.mass, acceleration: loads.gravity };
    let mut terms: Vec<Box<dyn Energy + 'a>> = vec![Box::new(membrane), Box::new(bending), Box::new(gravity)];
    if !cloth.junctions.is_empty() {
        terms.push(Box::new(cloth.junctions.clone()));
    }
    if !loads.springs.is_empty() {
        terms.push(Box::new(TargetSprings(&loads.springs)));
    }
    if !loads.plane_contacts.is_empty() {
        terms.push(Box::new(PlaneContacts(&loads.plane_contacts)));
    }
    if !loads.edge_contacts.is_empty() {
        terms.push(Box::new(EdgeContacts(&loads.edge_contacts)));
    }
    if !loads.leashes.is_empty() {
        terms.push(Box::new(Leashes(&loads.leashes)));
    }
    if loads.drag > 0.0 {
        let rate = loads.drag / stage.effective_dt;
        terms.push(Box::new(Drag { mass: &cloth.mass, start: &stage.base_positions, rate }));
    }
    if loads.pressure > 0.0 {
        terms.push(Box::new(Pressure { force: &buffers.pressure_force }));
    }
    if let Some(sphere) = &loads.sphere {
        terms.push(Box::new(ShrinkingSphere {
            centre: sphere.centre,
            radius: sphere.radius,
            stiffness: &buffers.sphere_stiffness,
            max_force: &buffers.sphere_max_force,
        }));
    }
    terms
}
