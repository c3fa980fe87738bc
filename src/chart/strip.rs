//! `crease chart strip`: the paper's Table 1, with and without memory.
//!
//! A strip of 32 x 44 cm of KOW's T-shirt, unstructured meshes of 156, 603 and 2306 points (within 2 %), hangs upright
//! with its short edge over the ground, a little askew and a little bowed, and falls. It has come to rest when the
//! residual, the force that is out of balance over the weight (root mean square over the mass), stays below a
//! hundredth for a quarter of a second. All of it goes through the solver of a bake: self-contact, friction, ground,
//! fixed steps of 1/60 s, so that steps and simulated seconds say the same. (`crease chart speed` lets the solver choose them.)
//!
//! A falling strip is chaotic: a degree more of tilt changes the time to rest by a third, memory or not. So every run
//! starts from a tilt of its own, the same ones with and without memory, and the chart gives medians.

use crate::chart::draw::BLACK;
use crate::chart::test_sheet::Sheet;
use crate::chart::{Axis, Chart, ChartOptions, Figure, Mark, Panel, Series, Table, median};
use crate::bake::Quality;
use crate::contact::{Contact, ContactSettings};
use crate::error::Result;
use crate::fabric::{DEFAULT_FABRIC, Fabric};
use crate::garment::{Garment, RestState};
use crate::math::Vec3;
use crate::memory::{Memory, Strains, MemoryModel};
use crate::sim::{NewtonSeconds, Cloth, StepRelaxation, SolveCost, State, StepOptions, Stepper};
use crate::sim::{Loads, GRAVITY};
use std::time::Instant;

/// Height and width of the strip as it hangs [m].
const STRIP: (f64, f64) = (0.44, 0.32);
/// Points of the paper's meshes, and seconds to stabilisation without and with memory where we know them.
const MESHES: [(usize, Option<[f64; 2]>); 3] =
    [(156, Some([9.0, 7.0])), (603, None), (2306, Some([94.0, 83.0]))];
/// Length of an even step, and of the first of others [s].
const STEP: f64 = 1.0 / 60.0;
/// Residual below which the strip is at rest, as a share of its weight [-].
const RESIDUAL: f64 = 1e-2;
/// Time for which the residual must stay there [s].
const STAYS: f64 = 0.25;
/// Steps in that time, at least.
const STEPS_OF_STAY: f64 = 4.0;
/// The run is given up after this time [s].
const LONGEST: f64 = 20.0;
/// Height of the lower edge over the ground at the start [m].
const DROP: f64 = 0.02;
/// Tilt of the strip in the first run [rad]: upright it would not know which way to fall.
const TILT: f64 = 0.10;
/// What every further run is tilted more [rad].
const TILT_MORE: f64 = 0.01;
/// Depth of the strip's bow [m].
const BOW: f64 = 0.01;
/// Strain that the strip's weight may cost: stretch is as soft as that allows, as in a bake.
const SAG: f64 = 0.005;
/// Most of a mean edge that the contact distance may be.
const MOST_OF_EDGE: f64 = 0.2;

/// How steps are made.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Pace {
    /// All of one length and each solved as strictly as the default quality says, so that steps of two falls compare.
    Even,
    /// By error, as a bake of the default quality makes them, but for those that memory keeps short there after an event; a few at
    /// least in the time for which a strip must be calm.
    Own,
}

/// What a fall took.
#[derive(Debug, Clone, PartialEq)]
pub struct Fall {
    /// Time at which the strip had come to rest [s]; `None` if it had not within the longest time.
    pub stabilised: Option<f64>,
    /// Wall time [s].
    pub wall: f64,
    /// Steps made until then.
    pub steps: u64,
    /// Linear systems of the whole solved until then.
    pub iterations: u64,
    /// Of a few places.
    pub local_iterations: u64,
    /// What they took.
    pub cost: SolveCost,
    /// Seconds spent: assembling, factorising and solving, contact search and bounds.
    pub seconds: NewtonSeconds,
    /// Memory events.
    pub events: u64,
    /// Time [s] and residual [-] of every step.
    pub residuals: Vec<[f64; 2]>,
}

/// A strip of about `points` points before its fall, tilted by `tilt` [rad].
fn strip(points: usize, tilt: f64) -> Result<Garment> {
    let sheet = Sheet::unstructured(STRIP.0, STRIP.1, points)?;
    let (sin, cos) = tilt.sin_cos();
    let place = |along: f64, across: f64| {
        let height = along + 0.5 * STRIP.0;
        let bow = BOW * (std::f64::consts::PI * height / STRIP.0).sin() * (1.0 + across / STRIP.1);
        Vec3::new(height * sin + bow * cos, DROP + height * cos - bow * sin + BOW, across)
    };
    let points = sheet.flat.iter().map(|p| place(p.x, p.y)).collect();
    Ok(sheet.garment(points))
}

fn stepper(garment: &Garment, fabric: &Fabric, pace: Pace) -> Stepper {
    let mut cloth = Cloth::new(garment, fabric);
    let enough = fabric.area_density() * GRAVITY * STRIP.0 / SAG;
    let stiffness = fabric.stretch_warp().min(enough);
    cloth.membrane.set_stiffness([stiffness, stiffness, fabric.shear().min(enough)]);
    let area: f64 = cloth.area.iter().sum();
    let edge = (area / garment.points.len() as f64).sqrt();
    let dhat = fabric.thickness().min(MOST_OF_EDGE * edge);
    let contact_stiffness = stiffness / (area / garment.points.len() as f64);
    let settings = ContactSettings::for_fabric(fabric, dhat, contact_stiffness, true);
    let contact =
        Contact::new(settings, &garment.points, &garment.triangles, &garment.topology, cloth.area.clone());
    // Steps are solved as far as a bake of the default quality solves them.
    let step = Quality::Standard.step_options_for(cloth.mass.iter().sum::<f64>() * GRAVITY);
    let options = match pace {
        Pace::Even => StepOptions { min_dt: STEP, max_dt: STEP, relaxation: StepRelaxation::OFF, ..step },
        Pace::Own => StepOptions { max_dt: STAYS / STEPS_OF_STAY, ..step },
    };
    Stepper::new(cloth, contact, options)
}

/// Points of the paper's three meshes.
pub(super) fn points_of_meshes() -> [usize; 3] {
    MESHES.map(|(points, _)| points)
}

/// Lets a strip of about `points` points fall, in the `run`-th of the starts, until it has come to rest.
pub fn fall(points: usize, fabric: &Fabric, remember: bool, run: usize, pace: Pace) -> Result<Fall> {
    let garment = strip(points, TILT + TILT_MORE * run as f64)?;
    let mut stepper = stepper(&garment, fabric, pace);
    let flat = vec![0.0; garment.topology.hinges.len()];
    let angle = stepper.cloth.bending.angles(&garment.points, &flat);
    let law = remember.then(|| MemoryModel::new(&garment, fabric, stepper.cloth.bending.width()));
    let mut memory = Memory::new(RestState::new(flat, garment.triangles.len()));
    let mut state = State::at_rest(garment.points.clone(), angle);
    let mut fall = Fall {
        stabilised: None,
        wall: 0.0,
        steps: 0,
        iterations: 0,
        local_iterations: 0,
        cost: SolveCost::default(),
        seconds: NewtonSeconds::default(),
        events: 0,
        residuals: Vec::new(),
    };
    let mass: f64 = stepper.cloth.mass.iter().sum();
    let drive = Loads { drag: 0.5, ..Loads::gravity_only(Some(0.0)) };
    let clock = Instant::now();
    let mut calm_since = None;
    let mut wished = STEP;
    while state.time < LONGEST && fall.stabilised.is_none() {
        let (angle, velocity) = (state.angle.clone(), state.v.clone());
        let step = stepper.advance(&mut state, &memory.effective_rest, &mut |_, _| drive.clone(), wished);
        wished = step.next_dt;
        fall.steps += 1;
        fall.iterations += step.newton.global_iterations as u64;
        fall.local_iterations += step.newton.local_iterations as u64;
        fall.cost += step.newton.cost;
        fall.seconds += step.newton.seconds;
        if let Some(law) = &law {
            let seen = |angle| Strains { angle, stretch: &[] };
            memory.commit(law, &seen(&angle), &seen(&state.angle), step.dt);
        }
        let out_of_balance = state
            .v
            .iter()
            .zip(&velocity)
            .zip(&stepper.cloth.mass)
            .map(|((now, before), m)| m * ((now - before) / step.dt).norm_squared())
            .sum::<f64>();
        let residual = (out_of_balance / mass).sqrt() / GRAVITY;
        fall.residuals.push([state.time, residual]);
        // In free fall only the weight is out of balance, so the strip is never calm before it has landed.
        calm_since = if residual < RESIDUAL { calm_since.or(Some(state.time)) } else { None };
        if calm_since.is_some_and(|since| state.time - since >= STAYS) {
            fall.stabilised = calm_since;
        }
    }
    fall.wall = clock.elapsed().as_secs_f64();
    fall.events = memory.events.gradual + memory.events.critical;
    Ok(fall)
}

/// The falls of all starts, the soonest at rest first.
fn falls(points: usize, fabric: &Fabric, remember: bool, runs: usize) -> Result<Vec<Fall>> {
    let mut falls: Vec<Fall> =
        (0..runs.max(1)).map(|run| fall(points, fabric, remember, run, Pace::Even)).collect::<Result<_>>()?;
    falls.sort_by_key(|f| f.steps);
    Ok(falls)
}

pub(super) fn make(options: &ChartOptions) -> Result<Chart> {
    let fabric = Fabric::preset(DEFAULT_FABRIC)?;
    let mut table = Table::new(&[
        "points",
        "memory",
        "stabilised_s",
        "wall_s",
        "steps",
        "steps_fewest",
        "steps_most",
        "iterations",
        "events",
        "paper_s",
    ]);
    let mut times = [("without memory", Mark::Rings), ("with memory", Mark::Crosses)]
        .map(|(name, mark)| Series::new(name, usize::from(mark == Mark::Rings), mark, Vec::new()));
    let mut courses = Vec::new();
    let mut notes = Vec::new();
    for (wanted, paper) in MESHES {
        let points = strip(wanted, TILT)?.points.len();
        let mut steps = [0, 0];
        for k in [0, 1] {
            let falls = falls(wanted, &fabric, k == 1, options.runs)?;
            let stabilised = falls.iter().map(|f| f.stabilised).collect::<Option<Vec<f64>>>();
            let stabilised = stabilised.and_then(|all| median(all.into_iter()));
            steps[k] = median(falls.iter().map(|f| f.steps)).unwrap_or(0);
            table.push([
                (points as u64).into(),
                (k == 1).into(),
                stabilised.into(),
                median(falls.iter().map(|f| f.wall)).into(),
                steps[k].into(),
                falls.first().map(|f| f.steps).into(),
                falls.last().map(|f| f.steps).into(),
                median(falls.iter().map(|f| f.iterations)).into(),
                median(falls.iter().map(|f| f.events)).into(),
                paper.map(|p| p[k]).into(),
            ]);
            times[k].points.extend(stabilised.map(|s| [points as f64, s]));
            if wanted == MESHES[2].0 {
                courses.push(Series::new("", 1 - k, Mark::Line, falls[falls.len() / 2].residuals.clone()));
            }
        }
        let [off, on] = steps;
        let theirs = paper.map_or(String::new(), |[off, on]| format!(", the paper's {:.2}", on / off));
        notes.push(format!(
            "{points} points: {off} steps without memory, {on} with: ratio {:.2}{theirs}",
            on as f64 / off as f64
        ));
    }
    notes.push(format!(
        "at rest: residual over weight below {RESIDUAL} for {STAYS} s; all figures are medians of {} runs from different tilts; the paper's seconds are as printed there",
        options.runs
    ));
    let latest = times.iter().flat_map(|t| &t.points).map(|p| p[1]).fold(0.1, f64::max);
    let largest = courses.iter().flat_map(|c| &c.points).map(|p| p[0]).fold(0.0, f64::max);
    courses.push(Series::new("at rest below", BLACK, Mark::Dashed, vec![[0.0, RESIDUAL], [largest, RESIDUAL]]));
    Ok(Chart {
        name: "strip",
        table,
        figure: Figure {
            title: "Falling strips of 32 x 44 cm come to rest".into(),
            panels: vec![
                Panel {
                    title: "time to come to rest".into(),
                    x: Axis::decades("points").between(100.0, 4000.0),
                    y: Axis::of("time to rest [s]").between(0.0, 1.2 * latest),
                    series: times.into(),
                },
                Panel {
                    title: format!("residual of the strip of {} points", MESHES[2].0),
                    x: Axis::of("time [s]"),
                    y: Axis::decades("force out of balance over weight [-]"),
                    series: courses,
                },
            ],
        },
        notes,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn meshes_have_the_points_of_the_paper() {
        for (wanted, _) in MESHES {
            let garment = strip(wanted, TILT).expect("meshes");
            let share = garment.points.len() as f64 / wanted as f64;
            assert!((share - 1.0).abs() <= 0.02, "{wanted}: {}", garment.points.len());
            // One sheet: Euler's number of a disc.
            let [v, e, f] = [garment.points.len(), garment.topology.edges.len(), garment.triangles.len()];
            assert_eq!(v + f - e, 1, "{wanted}");
            let area: f64 =
                garment.material.iter().map(|m| 0.5 * (m[1] - m[0]).perp(&(m[2] - m[0]))).sum();
            assert!((area / (STRIP.0 * STRIP.1) - 1.0).abs() < 1e-9, "{wanted}: {area}");
        }
    }

    /// The bar of Table 1 on the two smaller strips; all three are the chart's.
    #[test]
    fn strips_come_to_rest_no_later_with_memory() {
        let fabric = Fabric::preset(DEFAULT_FABRIC).expect("exists");
        let mut acted = Vec::new();
        for points in [156, 603] {
            let [off, on] = [false, true].map(|remember| {
                let fall = |run| fall(points, &fabric, remember, run, Pace::Even).expect("fall");
                (0..11).map(fall).collect::<Vec<_>>()
            });
            assert!(off.iter().chain(&on).all(|f| f.stabilised.is_some()), "{points}: all come to rest");
            assert!(off.iter().all(|f| f.events == 0));
            let steps = [&off, &on].map(|falls| falls.iter().map(|f| f.steps).collect::<Vec<_>>());
            println!("{points}: steps {:?} without memory, {:?} with", steps[0], steps[1]);
            let [without, with] = steps.map(|steps| median(steps.into_iter()));
            assert!(with <= without, "{points}: {with:?} against {without:?}");
            for (off, on) in off.iter().zip(&on) {
                // A strip at rest within its first second has no event yet, and some falls take longer.
                if on.events > 0 {
                    acted.push([off.steps as f64, on.steps as f64]);
                } else {
                    assert_eq!(off.residuals, on.residuals, "{points}: what has no event yet changes nothing");
                }
            }
        }
        // The median knows little of falls with events where those are few, and falls are chaotic: single ones come to
        // rest a fifth later or sooner. So all with events count together.
        let [off, on] = [0, 1].map(|k| acted.iter().map(|steps| steps[k]).sum::<f64>());
        println!("memory acted in {} of 22 falls, which took {on} steps, {off} without it", acted.len());
        assert!(acted.len() >= 6);
        assert!(on <= 1.15 * off, "{on} steps against {off}");
    }
}
