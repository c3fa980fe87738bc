//! The draft T-shirt that is folded thrice, baked in every quality and by every method: the product itself on the chart.
//!
//! Steps are chosen by error here, as in a bake, so that a setting is a quality (`bake::Quality`). The reference is backward
//! Euler with a sixth of the standard error per step and steps down to 1/240 s. Folds that start in contact are decided by
//! little: this is a band, not a line.

use crate::chart::accuracy::Point;
use crate::bake::{Bake, BakeOptions, BakeResult, Quality};
use crate::error::{Error, Result};
use crate::fabric::{DEFAULT_FABRIC, Fabric};
use crate::garment::{Garment, SourceAsset};
use crate::io::{ReadOptions, read_asset};
use crate::math::{Rng, bounds};
use crate::mesh::intersections::self_intersections;
use crate::sim::Method;
use crate::wear::WearScript;
use std::time::Instant;

pub(super) const NAME: &str = "fold-thrice";

const MESH: (&str, &[u8]) =
    ("tshirt-draft.glb", include_bytes!("../../../garments/tshirt-draft.glb"));
const FULL_MESH: (&str, &[u8]) = ("tshirt.glb", include_bytes!("../../../garments/tshirt.glb"));
const SCRIPT: (&str, &str) =
    ("fold-thrice.json", include_str!("../../../garments/wear/fold-thrice.json"));

/// Share of the mean edge by which starts are shaken.
const SHAKE: f64 = 0.02;

/// The garment and what is done to it.
pub struct FoldThrice {
    garment: Garment,
    fabric: Fabric,
    script: WearScript,
}

/// A bake, with its cost.
pub struct Run {
    /// Wall time [s].
    pub wall: f64,
    /// Linear systems solved, of the whole and of parts.
    pub linear_solves: u64,
    /// What came out.
    pub baked: BakeResult,
}

/// Reads a mesh that comes along, by name and bytes.
///
/// # Errors
/// Where it is no such mesh or needs a file beside it, which does not happen.
pub(in crate::chart) fn read_own((file, bytes): (&str, &[u8]), reading: &ReadOptions) -> Result<SourceAsset> {
    let nothing = |name: &str| Err(Error::input(file, name, "refers to another file", ""));
    Ok(read_asset(file, bytes, reading, &mut |name| nothing(name))?.0)
}

impl FoldThrice {
    /// The draft T-shirt that comes along, in the default fabric.
    pub fn new() -> Result<Self> {
        Self::of(MESH)
    }

    /// The T-shirt of 13,863 points.
    pub fn full() -> Result<Self> {
        Self::of(FULL_MESH)
    }

    fn of(mesh: (&str, &[u8])) -> Result<Self> {
        let asset = read_own(mesh, &ReadOptions::default())?;
        Ok(Self {
            garment: Garment::from_asset(&asset)?.0,
            fabric: Fabric::preset(DEFAULT_FABRIC)?,
            script: WearScript::parse(SCRIPT.0, SCRIPT.1)?,
        })
    }

    /// Number of points.
    pub fn points(&self) -> usize {
        self.garment.points.len()
    }

    /// The same garment with edges halved down to `edge` [m].
    #[must_use]
    pub fn refine(&self, edge: f64) -> Self {
        let garment = self.garment.refine(edge, &[]).garment;
        Self { garment, fabric: self.fabric.clone(), script: self.script.clone() }
    }

    /// The same garment with its points moved by up to a fiftieth of an edge along every axis, one way for each `seed`: folds
    /// that begin in contact are decided by little, so that one bake says little.
    #[must_use]
    pub fn shaken(&self, seed: u64) -> Self {
        let mut garment = self.garment.clone();
        let mut rng = Rng::from_seed(seed);
        let most = SHAKE * garment.mean_edge();
        garment.points.iter_mut().for_each(|x| *x += rng.in_cube() * most);
        Self { garment, fabric: self.fabric.clone(), script: self.script.clone() }
    }

    /// Bakes it.
    pub fn run(&self, options: &BakeOptions) -> Result<Run> {
        let clock = Instant::now();
        let bake = Bake::new(&self.garment, &self.fabric, &self.script).script_name(SCRIPT.0);
        let baked = bake.options(options.clone()).run()?;
        let linear_solves = baked.report.solves + baked.report.local_solves;
        Ok(Run { wall: clock.elapsed().as_secs_f64(), linear_solves, baked })
    }

    /// Root mean square over the hinges, by the area they stand for, of the difference of two memories' rest angles [rad].
    pub fn rest_angle_error(&self, a: &BakeResult, b: &BakeResult) -> f64 {
        let rest = a.worn.memory.rest_angle.iter().zip(&b.worn.memory.rest_angle);
        self.mean_by_area(rest.map(|(a, b)| (a - b) * (a - b))).sqrt()
    }

    /// Root mean square of the rest angles themselves, by area [rad]: what errors compare with.
    pub fn rest_angle_size(&self, a: &BakeResult) -> f64 {
        let mut flat = a.clone();
        flat.worn.memory.rest_angle.clone_from(&a.worn.memory.source_angle);
        self.rest_angle_error(a, &flat)
    }

    /// Mean magnitude of what wear changed the rest angles by, by area [rad]: how much the garment remembers.
    pub fn rest_angle_mean(&self, a: &BakeResult) -> f64 {
        let memory = &a.worn.memory;
        let changed = memory.rest_angle.iter().zip(&memory.source_angle);
        self.mean_by_area(changed.map(|(rest, source)| (rest - source).abs()))
    }

    /// Mean of one value per hinge, by the area each stands for.
    fn mean_by_area(&self, values: impl Iterator<Item = f64>) -> f64 {
        let area: Vec<f64> =
            self.garment.material.iter().map(|m| 0.5 * (m[1] - m[0]).perp(&(m[2] - m[0])).abs()).collect();
        let (mut sum, mut whole) = (0.0, 0.0);
        for (value, hinge) in values.zip(&self.garment.topology.hinges) {
            let weight: f64 = hinge.triangles.iter().map(|f| area[*f as usize] / 3.0).sum();
            sum += weight * value;
            whole += weight;
        }
        sum / whole
    }

    fn position_error(&self, a: &BakeResult, b: &BakeResult) -> f64 {
        let (low, high) = bounds(&self.garment.points);
        let size = (high - low).max();
        let moved = a.worn.displacement.iter().zip(&b.worn.displacement);
        moved.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max) / size
    }

    fn crosses(&self, baked: &BakeResult) -> bool {
        let home: Vec<_> =
            self.garment.points.iter().zip(&baked.worn.displacement).map(|(x, d)| x + d).collect();
        !self_intersections(&home, &self.garment.triangles).is_empty()
    }
}

/// Cloth that is drawn out by more than any fabric bears.
const DRAWN_OUT: &str = "drawn out";

/// All points of the chart.
pub(super) fn points(notes: &mut Vec<String>) -> Result<Vec<Point>> {
    let scene = FoldThrice::new()?;
    let reference = scene.run(&reference_options())?;
    notes.push(format!(
        "{NAME}: the reference took {:.0} s, {} steps; its rest angles are {:.2} degrees, root mean square",
        reference.wall,
        reference.baked.report.steps,
        scene.rest_angle_size(&reference.baked).to_degrees()
    ));
    let mut all = Vec::new();
    for (name, options) in settings() {
        let run = scene.run(&options)?;
        let drawn_out = run.baked.report.warnings.iter().any(|w| w.contains("stretched by"));
        let failed =
            if scene.crosses(&run.baked) { Some("layers cross") } else { drawn_out.then_some(DRAWN_OUT) };
        all.push(Point {
            method: options.step.method,
            setting: name,
            knobs: [options.step.min_dt, options.step.newton.displacement_tol],
            wall: run.wall,
            linear_solves: run.linear_solves,
            position: scene.position_error(&run.baked, &reference.baked),
            angle: f64::NAN,
            rest_angle: Some(scene.rest_angle_error(&run.baked, &reference.baked)),
            strain: f64::NAN,
            failed,
        });
    }
    Ok(all)
}

/// Every quality, and every other method in the standard quality.
fn settings() -> Vec<(String, BakeOptions)> {
    let qualities = Quality::ALL.map(|quality| {
        let options = BakeOptions::for_quality(quality);
        (format!("quality {}", quality.name()), options)
    });
    let taken: Vec<Method> = qualities.iter().map(|(_, options)| options.step.method).collect();
    let others = Method::ALL.iter().filter(|method| !taken.contains(method)).map(|&method| {
        let mut options = BakeOptions::for_quality(Quality::Standard);
        options.step.method = method;
        ("steps of quality standard".to_owned(), options)
    });
    qualities.into_iter().chain(others).collect()
}

/// How the reference is baked.
pub fn reference_options() -> BakeOptions {
    let mut options = BakeOptions::for_quality(Quality::Reference);
    options.step.local_error_tol *= 0.5;
    options.step.min_dt *= 0.5;
    options
}
