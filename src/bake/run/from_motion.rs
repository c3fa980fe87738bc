//! Memory from an existing motion, without simulation.
//!
//! The paper's hybrid with captured cloth: positions come from elsewhere (an animation, a capture, another simulator, an
//! earlier run), the memory law is applied to their angles and stretches as it is after a step, and at the end the garment
//! relaxes once to its source pose with the rest state that it earned. Between two frames angles move linearly, as within a
//! step. Does not do: forces, contact during the motion, repair of a motion.

use crate::bake::plan::reference_length;
use crate::bake::run::findings::empty_reason;
use crate::bake::{BakeReport, BakeResult, SimulatedGarment, StageSeconds, relax};
use crease_geometry::math::Vec3;
use crease_model::error::{Message, Setting};
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, RestState, WornGarment};
use crease_solver::memory::{Memory, MemoryModel, Strains};
use crease_solver::sim::Cloth;
use std::time::Instant;

/// A motion of a garment.
pub struct GarmentMotion<'a> {
    /// Number of frames.
    pub frame_count: usize,
    /// Time between two frames [s].
    pub interval: f64,
    /// Number of times that the motion is repeated.
    pub repetitions: u32,
    /// Returns the positions of a frame, one per point of the garment [m].
    pub frame: &'a mut dyn FnMut(usize) -> Vec<Vec3>,
}

/// Angles and stretches of a frame.
struct FrameStrains {
    angle: Vec<f64>,
    stretch: Vec<[f64; 3]>,
}

impl FrameStrains {
    fn strains(&self) -> Strains<'_> {
        Strains { angle: &self.angle, stretch: &self.stretch }
    }
}

/// Applies the memory law to `motion` of `garment`, and relaxes the garment to its source pose.
///
/// ```
/// use crease::{Fabric, GarmentFile, GarmentMotion, memory_from_motion};
/// let sheet = GarmentFile::sheet([0.1, 0.1], [2, 2])?.garment;
/// // Eleven frames in which the half x > 0.05 m turns up by 160 degrees about the line x = 0.05 m, and twenty of rest.
/// let mut frame = |k: usize| {
///     let angle = (16.0 * k.min(10) as f64).to_radians();
///     let mut points = sheet.points.clone();
///     for p in points.iter_mut().filter(|p| p.x > 0.05) {
///         let arm = p.x - 0.05;
///         (p.x, p.y) = (0.05 + arm * angle.cos(), arm * angle.sin());
///     }
///     points
/// };
/// let mut motion = GarmentMotion { frame_count: 31, interval: 0.2, repetitions: 1, frame: &mut frame };
/// let result = memory_from_motion(&sheet, &Fabric::preset("kow-tshirt")?, &mut motion);
/// assert!(result.report.events.critical > 0);
/// # Ok::<(), crease::Error>(())
/// ```
pub fn memory_from_motion(garment: &Garment, fabric: &Fabric, motion: &mut GarmentMotion) -> BakeResult {
    let clock = Instant::now();
    let cloth = Cloth::new(garment, fabric);
    let source_angle = cloth.bending.angles(&garment.points, &[]);
    let model = MemoryModel::new(garment, fabric, cloth.bending.width(), reference_length(garment, fabric));
    let mut memory = Memory::new(RestState::new(source_angle.clone(), garment.triangles.len()));
    let measure = |x: &[Vec3]| if model.remembers_length() { cloth.membrane.measure(x) } else { Vec::new() };
    let mut first_angle: Option<Vec<f64>> = None;
    let mut last: Option<FrameStrains> = None;
    let mut x = garment.points.clone();
    let mut time = 0.0;
    for round in 0..motion.repetitions {
        for k in 0..motion.frame_count {
            x = (motion.frame)(k);
            // Back at the first frame every angle is what it was there: a jump of more than half a turn has no other sign.
            let angle = match &first_angle {
                Some(first) if k == 0 => first.clone(),
                _ => cloth.bending.angles(&x, last.as_ref().map_or(&source_angle, |last| &last.angle)),
            };
            first_angle.get_or_insert_with(|| angle.clone());
            let now = FrameStrains { angle, stretch: measure(&x) };
            // The first frame is only the start of the motion; a later round comes back to it.
            if let Some(last) = last.as_ref().filter(|_| round > 0 || k > 0) {
                memory.commit(&model, &last.strains(), &now.strains(), motion.interval);
                time += motion.interval;
            }
            last = Some(now);
        }
    }
    let memory_s = clock.elapsed().as_secs_f64();
    let empty = Message::from("no hinge bends enough for that in this motion: repeat it with ")
        + Setting::Repeat
        + ", or play it slower";
    let empty_reason = empty_reason(&memory.rest, None, empty);
    let relaxed = relax(garment, fabric, &memory.rest);
    let relax_s = clock.elapsed().as_secs_f64() - memory_s;
    let seconds = StageSeconds { memory: memory_s, relax: relax_s, ..StageSeconds::default() };
    let report = BakeReport {
        simulated: time,
        events: memory.events,
        solves: relaxed.solves,
        warnings: relaxed.warnings.into_iter().map(Message::from).collect(),
        unconverged_reason: relaxed.unconverged_reason,
        empty_reason,
        stages: seconds.named().into_iter().filter(|(_, seconds)| *seconds > 0.0).collect(),
        ..BakeReport::default()
    };
    let worn = WornGarment { displacement: relaxed.displacement, memory: memory.rest };
    let simulated = SimulatedGarment { garment: garment.clone(), worn: worn.clone() };
    BakeResult { worn, end: x, simulated, report }
}
