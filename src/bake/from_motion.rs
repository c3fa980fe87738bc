//! Memory from a motion that already exists: no simulation.
//!
//! The paper's hybrid with captured cloth: positions come from elsewhere (an animation, a capture, another simulator, a
//! run of ours), the law is applied to their angles and stretches as it is after a step, and at the end the garment
//! settles once in its own pose with what it has earned. Between two frames angles move linearly, as within a step.
//! Does not do: forces, contact on the way, repair of a motion.

use crate::bake::{BakeReport, BakeResult, settle};
use crate::fabric::Fabric;
use crate::garment::{Garment, RestState, WornGarment};
use crate::math::Vec3;
use crate::memory::{Memory, MemoryModel, Strains};
use crate::sim::Cloth;
use std::time::Instant;

/// A motion of a garment.
pub struct GarmentMotion<'a> {
    /// Frames.
    pub frame_count: usize,
    /// Time between two of them [s].
    pub interval: f64,
    /// How often it is gone through.
    pub repetitions: u32,
    /// Positions of a frame, one per point [m].
    pub frame: &'a mut dyn FnMut(usize) -> Vec<Vec3>,
}

/// What `motion` leaves in `garment` of `fabric`.
pub fn memory_from_motion(garment: &Garment, fabric: &Fabric, motion: &mut GarmentMotion) -> BakeResult {
    let clock = Instant::now();
    let cloth = Cloth::new(garment, fabric);
    let source_angle = cloth.bending.angles(&garment.points, &[]);
    let law = MemoryModel::new(garment, fabric, cloth.bending.width());
    let mut memory = Memory::new(RestState::new(source_angle.clone(), garment.triangles.len()));
    let measure = |x: &[Vec3]| if law.remembers_length() { cloth.membrane.measure(x) } else { Vec::new() };
    let mut angle = source_angle;
    let mut first_angle: Option<Vec<f64>> = None;
    let mut stretch: Option<Vec<[f64; 3]>> = None;
    let mut x = garment.points.clone();
    let mut time = 0.0;
    for round in 0..motion.repetitions {
        for k in 0..motion.frame_count {
            let next = (motion.frame)(k);
            // Back at the first frame every angle is what it was there: a jump of more than half a turn has no other sign.
            let next_angle = match &first_angle {
                Some(first) if k == 0 => first.clone(),
                _ => cloth.bending.angles(&next, &angle),
            };
            first_angle.get_or_insert_with(|| next_angle.clone());
            let next_stretch = measure(&next);
            // The first frame only says where the motion begins; a later round comes back to it.
            if let Some(stretch) = stretch.as_ref().filter(|_| round > 0 || k > 0) {
                let before = Strains { angle: &angle, stretch };
                let after = Strains { angle: &next_angle, stretch: &next_stretch };
                memory.commit(&law, &before, &after, motion.interval);
                time += motion.interval;
            }
            (x, angle, stretch) = (next, next_angle, Some(next_stretch));
        }
    }
    let remembered = clock.elapsed().as_secs_f64();
    let settled = settle(garment, fabric, &memory.rest);
    let home = clock.elapsed().as_secs_f64() - remembered;
    let report = BakeReport {
        simulated: time,
        events: memory.events,
        solves: settled.solves,
        warnings: settled.warnings,
        unconverged_reason: settled.unconverged_reason,
        stages: vec![("remember", remembered), ("home", home)],
        ..BakeReport::default()
    };
    BakeResult {
        worn: WornGarment { displacement: settled.displacement, memory: memory.rest },
        end: x,
        report,
    }
}
