//! Bake of a garment with trims: its cloth is baked, and the trims follow it.

use crate::bake::{BakeProgress, BakeReport, BakeResult, Checkpoint, Observer};
use crease_geometry::math::Vec3;
use crease_model::error::Result;
use crease_model::garment::{Garment, RigidParts};

/// Runs `bake` on the cloth of `garment`, whose trims are `rigid`; frames show the whole garment, unless they are those of the
/// simulated mesh.
pub(in crate::bake) fn bake_cloth(
    garment: &Garment,
    rigid: &RigidParts,
    frames_of_simulated: bool,
    observer: &mut dyn Observer,
    bake: impl FnOnce(&Garment, &mut dyn Observer) -> Result<BakeResult>,
) -> Result<BakeResult> {
    let mut whole = WholeGarment { garment, rigid, frames_of_simulated, observer };
    let baked = bake(rigid.cloth(), &mut whole)?;
    let mut report = baked.report;
    report.warn(rigid.notes());
    Ok(BakeResult { worn: rigid.worn(&baked.worn), end: rigid.positions(&baked.end), report, ..baked })
}

/// Observer that shows the whole garment where its cloth is baked.
struct WholeGarment<'a> {
    garment: &'a Garment,
    rigid: &'a RigidParts,
    frames_of_simulated: bool,
    observer: &'a mut dyn Observer,
}

impl Observer for WholeGarment<'_> {
    fn progress(&mut self, progress: &BakeProgress) {
        self.observer.progress(progress);
    }

    fn on_mesh(&mut self, mesh: &Garment) {
        self.observer.on_mesh(if self.frames_of_simulated { mesh } else { self.garment });
    }

    fn frame(&mut self, x: &[Vec3]) -> Result<()> {
        match self.frames_of_simulated {
            true => self.observer.frame(x),
            false => self.observer.frame(&self.rigid.positions(x)),
        }
    }

    fn on_early_stop(&mut self, report: &BakeReport) {
        let mut report = report.clone();
        report.warn(self.rigid.notes());
        self.observer.on_early_stop(&report);
    }

    fn wants_checkpoints(&self) -> bool {
        self.observer.wants_checkpoints()
    }

    fn checkpoint(&mut self, now: Checkpoint) -> Result<()> {
        self.observer.checkpoint(now)
    }

    fn should_stop(&mut self) -> bool {
        self.observer.should_stop()
    }
}
