//! Refinement of the simulated mesh during a run, where hinges bend more than their length can show.
//!
//! Triangles are bisected ([`crease_model::remesh::Refinement`]); the surface, its motion and its memory stay what they are. The
//! current action is begun again on the finer mesh, as after a checkpoint.

use crate::bake::run::checkpoint::ActionProgress;
use crate::bake::run::running_bake::Run;
use crate::bake::tuning::TUNING;
use crate::wear::{PersistentState, TurnRecord};
use crease_geometry::mesh::triangle;
use crease_model::remesh::Refinement;
use crease_solver::sim::{Loads, State};

impl Run<'_> {
    /// Triangles to bisect now, during the action of that number; empty for none.
    pub(in crate::bake) fn triangles_to_bisect(&self, action: usize) -> Vec<u32> {
        let tuning = TUNING.simulation_mesh;
        let Some(rule) = self.refinement.filter(|rule| action >= rule.from_action) else { return Vec::new() };
        let finest = rule.finest_edge;
        if !self.report.steps.is_multiple_of(tuning.refinement_steps) {
            return Vec::new();
        }
        let garment = &self.mesh.garment;
        let limit = tuning.max_hinge_deg.to_radians();
        let source = &self.memory.rest.source_angle;
        let mut marked = vec![false; garment.triangles.len()];
        for (h, hinge) in garment.topology.hinges.iter().enumerate() {
            if (self.state.angle[h] - source[h]).abs() > limit {
                hinge.triangles.iter().for_each(|&f| marked[f as usize] = true);
            }
        }
        let is_long = |f: &u32| {
            let x = triangle::corners(&garment.points, &garment.triangles[*f as usize]);
            triangle::longest_side(&x) > tuning.max_finest_factor * finest
        };
        let all = 0..garment.triangles.len() as u32;
        let wanted: Vec<u32> = all.filter(|f| marked[*f as usize]).filter(is_long).collect();
        // Few are left for a while, so that not every fourth step has a new linear system.
        let all_now = self.report.steps.is_multiple_of(4 * tuning.refinement_steps);
        let enough = if all_now { 0.0 } else { tuning.min_refined_fraction * garment.triangles.len() as f64 };
        if wanted.len() as f64 > enough { wanted } else { Vec::new() }
    }

    /// Goes on with the mesh of `refinement`, from `progress` of the current action, before which the persistent state was
    /// `before`. Returns the progress on that mesh.
    pub(in crate::bake) fn refine(
        &mut self,
        refinement: Refinement,
        progress: ActionProgress,
        before: &PersistentState,
    ) -> ActionProgress {
        self.persistent = persistent_on(before, &refinement);
        self.memory = self.memory.on_refined(&refinement.hinge_parent, &refinement.triangle_parent);
        let angle = |parent: &Option<u32>| parent.map_or(0.0, |h| self.state.angle[h as usize]);
        self.state = State {
            time: self.state.time,
            x: refinement.points(&self.state.x),
            v: refinement.points(&self.state.v),
            angle: refinement.hinge_parent.iter().map(angle).collect(),
            previous: None,
        };
        let progress = ActionProgress { start: refinement.points(&progress.start), ..progress };
        self.splits.extend(&refinement.splits);
        let friction = self.stepper.contact.friction_state();
        self.set_mesh(refinement.mesh.clone());
        self.stepper.contact.restore_friction_state(&friction);
        if let (Some(body), Some(standing)) = (&mut self.body, &self.persistent.body) {
            let (settings, areas) = (self.stepper.contact.settings(), self.stepper.cloth.area.clone());
            *body = body.on_refined(&refinement, &standing.body, settings, areas);
        }
        progress
    }
}

/// The persistent state `coarse` on the mesh of `refinement`.
fn persistent_on(coarse: &PersistentState, refinement: &Refinement) -> PersistentState {
    let mut persistent = coarse.clone();
    let first = refinement.mesh.garment.points.len() - refinement.splits.len();
    for turn in &mut persistent.turns {
        match turn {
            TurnRecord::Fold(fold) => {
                let mut in_flap = vec![false; first];
                fold.flap.iter().for_each(|p| in_flap[*p as usize] = true);
                let in_flap = refinement.flags(&in_flap);
                if !fold.panel.is_empty() {
                    fold.panel = refinement.flags(&fold.panel);
                }
                fold.flap = (0..in_flap.len() as u32).filter(|p| in_flap[*p as usize]).collect();
            }
            TurnRecord::Roll(roll) => roll.add_middles(&refinement.splits),
        }
    }
    if !persistent.laid_bend.is_empty() {
        let bend = |parent: &Option<u32>| parent.map_or(0.0, |h| coarse.laid_bend[h as usize]);
        persistent.laid_bend = refinement.hinge_parent.iter().map(bend).collect();
    }
    if !persistent.cut.is_empty() {
        persistent.cut = refinement.triangle_parent.iter().map(|f| coarse.cut[*f as usize]).collect();
    }
    if let Some(loads) = &mut persistent.held_loads {
        *loads = loads_on(loads, refinement);
    }
    persistent
}

/// The loads `coarse` on the mesh of `refinement`: new points hang between their neighbours without springs of their own.
fn loads_on(coarse: &Loads, refinement: &Refinement) -> Loads {
    let flags = |list: &Vec<bool>| if list.is_empty() { Vec::new() } else { refinement.flags(list) };
    Loads { fixed: flags(&coarse.fixed), pressed: flags(&coarse.pressed), ..coarse.clone() }
}
