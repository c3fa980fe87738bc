//! `crease chart loop`: moment over curvature of a strip in cyclic bending, as on a KES-FB2 tester.
//!
//! A strip of 1 cm between two jaws is bent into circular arcs, 0 -> 2.5 -> -2.5 -> 0 per cm at 0.5 per cm and
//! second, 20 s a cycle; the moment is proportional to its width. The mesh is placed on the arc, the memory is
//! advanced with every step, and the moment per width follows from the bending energy. B is the mean slope between
//! 0.5 and 1.5 per cm of both sides, 2HB the width of the loop at 1 per cm. The loop of this law is due to memory
//! alone: the law has no friction between yarns, so the loop of a fabric whose thresholds are not reached has no area
//! (`docs/theory/memory.md`).

use crate::test_sheet::TestSheet;
use crate::{Axis, Chart, ChartOptions, Figure, GREY, Mark, Panel, Series, Table};
use crease_geometry::math::Vec3;
use crease_model::error::Result;
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, RestState};
use crease_solver::energy::Bending;
use crease_solver::memory::{Memory, MemoryModel, Strains};

/// Length between the jaws [m].
const SPAN: f64 = 0.01;
/// Width of the strip [m].
const WIDTH: f64 = 0.02;
/// Elements along the span.
const ELEMENTS: usize = 4;
/// Largest curvature [1/m].
const MAX_CURVATURE: f64 = 250.0;
/// Rate of change of the curvature [1/(m s)].
const CURVATURE_RATE: f64 = 50.0;
/// Number of cycles.
const CYCLES: usize = 3;
/// Steps per second [1/s].
const STEPS_PER_SECOND: usize = 20;
/// 1 gf cm/cm in N.
const GF_CM_PER_CM: f64 = 9.806_65e-3;
/// 1 gf cm²/cm in N m.
const GF_CM2_PER_CM: f64 = 98.0665e-6;

/// State of the strip at one time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopSample {
    /// Time [s].
    pub time: f64,
    /// Curvature of the strip [1/m].
    pub curvature: f64,
    /// Moment per width [N].
    pub moment: f64,
    /// Mean rest curvature [1/m].
    pub rest_curvature: f64,
    /// Mean stiffness ratio [-].
    pub stiffness_ratio: f64,
}

/// The strip between the jaws.
struct JawStrip {
    sheet: TestSheet,
    garment: Garment,
    bending: Bending,
}

impl JawStrip {
    fn of(fabric: &Fabric) -> Self {
        // One element more at each end, inside the jaws, so that the ends of the span are hinges like the others.
        let step = SPAN / ELEMENTS as f64;
        let lines: Vec<f64> = (0..=ELEMENTS + 1).map(|k| (k as f64 - 0.5) * step).collect();
        let sheet = TestSheet::strip(&lines, WIDTH, (WIDTH / step).round() as usize);
        let garment = sheet.flat_garment();
        let bending = Bending::new(&garment, fabric);
        Self { sheet, garment, bending }
    }

    /// Points of the strip on an arc of `curvature` [1/m].
    fn bent(&self, curvature: f64) -> Vec<Vec3> {
        let arc = |s: f64| {
            // Chords as long as the elements: without stretch.
            let step = SPAN / ELEMENTS as f64;
            let turn = curvature * step;
            let count = (s / step + 0.5).round() as i64;
            (0..count).fold((0.0, 0.0), |(x, y), k| {
                let direction = turn * k as f64;
                (x + step * direction.cos(), y + step * direction.sin())
            })
        };
        self.sheet.flat.iter().map(|p| (arc(p.x), p.y)).map(|((x, y), w)| Vec3::new(x, -y, -w)).collect()
    }

    /// Mean of `value` (one per hinge) over the lines across the strip; its other hinges are flat.
    fn mean_over_lines(&self, value: &[f64]) -> f64 {
        let mut sum = 0.0;
        for (hinge, value) in self.garment.topology.hinges.iter().zip(value) {
            let [a, b] = [hinge.points[0], hinge.points[1]].map(|p| self.garment.points[p.at()]);
            if (a.x - b.x).abs() < 1e-9 {
                sum += value * (a.z - b.z).abs();
            }
        }
        sum / (WIDTH * ELEMENTS as f64)
    }
}

/// Curvature at `time` [s] [1/m].
fn curvature(time: f64) -> f64 {
    let quarter = MAX_CURVATURE / CURVATURE_RATE;
    let phase = (time / quarter).rem_euclid(4.0);
    MAX_CURVATURE
        * match phase {
            p if p < 1.0 => p,
            p if p < 3.0 => 2.0 - p,
            p => p - 4.0,
        }
}

/// Bends a strip of `fabric`, `steps_per_second` steps a second, for `cycles` cycles.
pub fn bend(fabric: &Fabric, cycles: usize, steps_per_second: usize) -> Vec<LoopSample> {
    let strip = JawStrip::of(fabric);
    let law =
        MemoryModel::new(&strip.garment, fabric, strip.bending.width(), fabric.memory.reference_length());
    let flat = strip.bending.angles(&strip.garment.points, &[]);
    let unstretched = vec![[1.0, 1.0, 0.0]; strip.garment.triangles.len()];
    let mut memory = Memory::new(RestState::new(flat.clone(), strip.garment.triangles.len()));
    let mut angle = flat;
    let step = SPAN / ELEMENTS as f64;
    let period = 4.0 * MAX_CURVATURE / CURVATURE_RATE;
    let count = (period * cycles as f64).round() as usize * steps_per_second;
    let mut samples = Vec::with_capacity(count + 1);
    for k in 0..=count {
        let time = k as f64 / steps_per_second as f64;
        let x = strip.bent(curvature(time));
        let next = strip.bending.angles(&x, &angle);
        if k > 0 {
            let [before, after] = [&angle, &next].map(|angle| Strains { angle, stretch: &unstretched });
            memory.commit(&law, &before, &after, 1.0 / steps_per_second as f64);
        }
        angle = next;
        let torques = strip.bending.term(&memory.rest, &angle, f64::INFINITY).torques(&x);
        // The torque of a line is the sum over its hinges; per width it is the moment.
        let lines: Vec<f64> = torques
            .iter()
            .zip(&strip.garment.topology.hinges)
            .map(|(t, h)| {
                let [a, b] = [h.points[0], h.points[1]].map(|p| strip.garment.points[p.at()]);
                t / (a - b).norm()
            })
            .collect();
        samples.push(LoopSample {
            time,
            curvature: curvature(time),
            moment: strip.mean_over_lines(&lines),
            rest_curvature: strip.mean_over_lines(&memory.rest.rest_angle) / step,
            stiffness_ratio: strip.mean_over_lines(&memory.rest.stiffness_ratio),
        });
    }
    samples
}

/// Results that the tester reports for one cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct LoopReading {
    /// B [N m]: mean slope between 0.5 and 1.5 per cm, both sides.
    pub bending: f64,
    /// 2HB [N]: width of the loop at 1 per cm, both sides.
    pub hysteresis: f64,
    /// Area of the loop [N/m]: work per area and cycle.
    pub area: f64,
}

/// Reads one cycle of samples (one period, both ends included).
pub fn read(cycle: &[LoopSample]) -> LoopReading {
    let crossings = |at: f64| -> Vec<f64> {
        let between = |w: &[LoopSample]| {
            let (a, b) = (w[0], w[1]);
            let fraction = (at - a.curvature) / (b.curvature - a.curvature);
            ((0.0..1.0).contains(&fraction)).then_some(a.moment + fraction * (b.moment - a.moment))
        };
        cycle.windows(2).filter_map(between).collect()
    };
    // Moments of the rising and of the falling branch at a curvature; the negative side mirrored.
    let at = |curvature: f64| -> [f64; 2] {
        let moments = crossings(curvature);
        [moments.first().copied().unwrap_or(f64::NAN), moments.last().copied().unwrap_or(f64::NAN)]
    };
    let slope = |side: f64| {
        let (low, high) = (at(50.0 * side), at(150.0 * side));
        0.5 * ((high[0] - low[0]) + (high[1] - low[1])) / (100.0 * side)
    };
    let width = |side: f64| {
        let [first, last] = at(100.0 * side);
        (first - last) * side
    };
    let area =
        cycle.windows(2).map(|w| 0.5 * (w[0].moment + w[1].moment) * (w[1].curvature - w[0].curvature));
    LoopReading {
        bending: 0.5 * (slope(1.0) + slope(-1.0)),
        hysteresis: 0.5 * (width(1.0) + width(-1.0)),
        area: area.sum(),
    }
}

pub(super) fn make(options: &ChartOptions) -> Result<Chart> {
    let fabric = &options.fabric;
    let mut table = Table::new(&[
        "fabric",
        "cycle",
        "time_s",
        "curvature_per_cm",
        "moment_gf_cm_per_cm",
        "rest_curvature_per_cm",
        "stiffness_ratio",
    ]);
    let samples = bend(fabric, CYCLES, STEPS_PER_SECOND);
    let period = (4.0 * MAX_CURVATURE / CURVATURE_RATE) as usize * STEPS_PER_SECOND;
    let mut series = Vec::new();
    let mut notes = Vec::new();
    for cycle in 0..CYCLES {
        let Some(part) = samples.get(cycle * period..=(cycle + 1) * period) else { continue };
        let points: Vec<[f64; 2]> =
            part.iter().map(|s| [s.curvature / 100.0, s.moment / GF_CM_PER_CM]).collect();
        series.push(Series::new(&format!("cycle {}", cycle + 1), cycle, Mark::Line, points));
        let reading = read(part);
        notes.push(format!(
            "{}, cycle {}: B {:.4} gf cm2/cm, 2HB {:.4} gf cm/cm, loop area {:.4} gf cm/cm2",
            fabric.name,
            cycle + 1,
            reading.bending / GF_CM2_PER_CM,
            reading.hysteresis / GF_CM_PER_CM,
            reading.area / (100.0 * GF_CM_PER_CM),
        ));
        for s in part {
            table.push([
                fabric.name.as_str().into(),
                (cycle as u64 + 1).into(),
                s.time.into(),
                (s.curvature / 100.0).into(),
                (s.moment / GF_CM_PER_CM).into(),
                (s.rest_curvature / 100.0).into(),
                s.stiffness_ratio.into(),
            ]);
        }
    }
    let elastic = |c: f64| [c / 100.0, fabric.bend_warp() * c / GF_CM_PER_CM];
    let line = vec![elastic(-MAX_CURVATURE), elastic(MAX_CURVATURE)];
    series.push(Series::new("without memory", GREY, Mark::Dashed, line));
    Ok(Chart {
        name: "loop",
        table,
        figure: Figure {
            title: format!("Bending loop of {} (KES-FB2)", fabric.name),
            panels: vec![Panel {
                title: String::new(),
                x: Axis::linear("curvature [1/cm]"),
                y: Axis::linear("moment per width [gf cm/cm]"),
                series,
            }],
        },
        notes,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A fabric whose thresholds the test does not reach: B is the fabric's, and no work is dissipated.
    #[test]
    fn below_the_thresholds_the_loop_is_the_fabric_s_own_stiffness() {
        let mut fabric = Fabric::preset("cotton-poplin").expect("exists");
        let read_last = |fabric: &Fabric| read(&bend(fabric, 1, STEPS_PER_SECOND));
        let reading = read_last(&fabric);
        println!("B {:e} of {:e}, 2HB {:e}", reading.bending, fabric.bend_warp(), reading.hysteresis);
        assert!((reading.bending / fabric.bend_warp() - 1.0).abs() < 0.01);
        assert!(reading.hysteresis.abs() < 1e-12 && reading.area.abs() < 1e-12);
        fabric.bend_warp_un_m *= 2.0;
        assert!((read_last(&fabric).bending / reading.bending - 2.0).abs() < 0.01);
    }

    /// The paper's T-shirt is bent beyond both thresholds: its loop has area, is closed once the stiffness reaches
    /// its maximum, and does not depend on the step.
    #[test]
    fn the_t_shirt_has_a_loop_independent_of_the_step() {
        let fabric = Fabric::preset("kow-tshirt").expect("exists");
        let [coarse, fine] = [20, 40].map(|steps| {
            let samples = bend(&fabric, 2, steps);
            read(&samples[20 * steps..])
        });
        println!("second cycle, 20 and 40 steps a second: {coarse:?} {fine:?}");
        assert!(coarse.area > 0.0 && coarse.hysteresis > 0.0);
        for (a, b) in [(coarse.bending, fine.bending), (coarse.area, fine.area)] {
            assert!((a / b - 1.0).abs() < 0.005, "{a} {b}");
        }
    }
}
