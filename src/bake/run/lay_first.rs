//! A garment that does not lie in its file is laid once, to learn where fold lines run on it.
//!
//! The first action of the script, `lay`, lays it out on a uniform mesh, with an edge where the cloth turns over; cloth that is crumpled, but no
//! higher than a few layers, is laid in a run without memory. The lines are then drawn where the garment lies, the mesh for the whole script is made with
//! them, and the run begins.

use crate::bake::choose_mesh::MeshChoice;
use crate::bake::run::setup::BakeSetup;
use crate::bake::run::simulate::simulate;
use crate::bake::{BakeOptions, BakeProgress, BakeReport, Observer};
use crate::wear::{ActionContext, PersistentState, WearScript};
use crease_geometry::math::Vec3;
use crease_model::error::Result;
use crease_model::remesh::SimulationMesh;
use std::borrow::Cow;

/// The mesh for the garment and the script of `setup`; the garment is laid first if that is needed.
pub(in crate::bake) fn mesh_for(setup: &BakeSetup, observer: &mut dyn Observer) -> Result<MeshChoice> {
    let choice = MeshChoice::new(setup.garment, setup.fabric, setup.script, None, setup.options);
    if !choice.lays_first {
        return Ok(choice);
    }
    let first = setup.script.flatten().take(1).map(Cow::into_owned).collect();
    let script = WearScript { actions: first, ..setup.script.clone() };
    let options = BakeOptions { memory: false, frames_per_second: 0.0, ..setup.options.clone() };
    let lay = BakeSetup { script: &script, options: &options, ..*setup };
    let laid = match laid_out(&choice.mesh, &lay)? {
        Some(positions) => choice.mesh.to_source(&positions),
        None => {
            let laid = simulate(None, choice, &lay, &mut LayObserver(observer))?;
            laid.mesh.to_source(&laid.positions)
        }
    };
    Ok(MeshChoice::new(setup.garment, setup.fabric, setup.script, Some(&laid), setup.options))
}

/// Positions of `mesh`, one per point [m], as the first action of `lay` lays it out; `None` where it does not.
fn laid_out(mesh: &SimulationMesh, lay: &BakeSetup) -> Result<Option<Vec<Vec3>>> {
    let Some(action) = lay.script.flatten().next() else { return Ok(None) };
    let context = ActionContext {
        positions: &mesh.garment.points,
        source_positions: &mesh.garment.points,
        triangles: &mesh.garment.triangles,
        masses: &[],
        thickness: lay.fabric.thickness(),
        script_file: lay.script_name,
        location: "actions[0]",
    };
    let start = action.as_wear_action().start_action(&context, &mut PersistentState::default())?;
    Ok(start.start_positions.filter(|_| start.laid_out.is_some()))
}

/// Passes on progress and the request to stop, and nothing of the mesh.
struct LayObserver<'a>(&'a mut dyn Observer);

impl Observer for LayObserver<'_> {
    fn progress(&mut self, progress: &BakeProgress) {
        self.0.progress(&BakeProgress { stage: "lay, to draw lines", ..progress.clone() });
    }

    fn on_early_stop(&mut self, report: &BakeReport) {
        self.0.on_early_stop(report);
    }

    fn should_stop(&mut self) -> bool {
        self.0.should_stop()
    }
}
