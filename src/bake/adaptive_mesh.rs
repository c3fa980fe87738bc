//! The mesh that is simulated: the garment's own where the script creases it, and fewer points where it creases nothing.
//!
//! What a bake costs goes with its points, and creases lie where the script makes them: along its fold lines, through all layers, at
//! the sides of a garment that lies, and where it is pressed on one ([`crate::wear::FoldLayout`]). There every point of the garment is
//! simulated, and away from there edges grow. Afterwards the memory is carried back to every hinge of the garment, number by
//! number where both meshes are one and spread elsewhere ([`crate::transfer::prolongate`]), and the garment is brought home as a
//! whole.
//!
//! Where a script may crease the cloth anywhere (crumpling, a body that moves) every point is simulated. docs/validation/accuracy.md has
//! what grading changes.

use crate::bake::{BakeOptions, ModelDecision};
use crate::fabric::Fabric;
use crate::garment::{CoarseMesh, Garment};
use crate::mesh::intersections::self_intersections;
use crate::wear::{FoldLayout, WearScript};

/// How far from a fold line every point is kept, in bending lengths; an edge if that is more.
const ALONG_FOLDS: f64 = 0.8;
/// The same from a side.
const ALONG_SIDES: f64 = 0.3;
/// Longest edges, in bending lengths.
const LONGEST: f64 = 4.0;
/// By how much edges may be longer for every metre farther away [-].
const GROWTH: f64 = 0.8;
/// Not worth it if more than this share of the points is left [-].
const WORTH: f64 = 0.75;

/// Whether a garment is simulated on fewer points.
#[derive(Debug, Clone)]
pub struct SimulationMesh {
    /// What is simulated instead of the garment.
    pub mesh: Option<CoarseMesh>,
    /// Why.
    pub choice: ModelDecision,
}

impl SimulationMesh {
    /// For wearing `garment` of `fabric` through `script`.
    pub fn choose(garment: &Garment, fabric: &Fabric, script: &WearScript, options: &BakeOptions) -> Self {
        let (mesh, why) = match graded(garment, fabric, script, options) {
            Ok((mesh, why)) => (Some(mesh), why),
            Err(why) => (None, why),
        };
        Self { choice: ModelDecision { name: "grading", on: mesh.is_some(), why }, mesh }
    }
}

/// The mesh, and what was made of it; or why there is none.
fn graded(
    garment: &Garment,
    fabric: &Fabric,
    script: &WearScript,
    options: &BakeOptions,
) -> Result<(CoarseMesh, String), String> {
    if !options.adaptive_mesh || options.full_fidelity {
        return Err("switched off".into());
    }
    if options.body.is_some() {
        return Err("a body creases the cloth where it moves".into());
    }
    let (own, length) = (garment.mean_edge(), fabric.bending_length());
    if own > length {
        let [own, length] = [own, length].map(|l| 1e3 * l);
        return Err(format!("elements of {own:.1} mm are no finer than the bending length, {length:.1} mm"));
    }
    let [folds, sides] = [(ALONG_FOLDS * length).max(own), ALONG_SIDES * length];
    let longest = LONGEST * length;
    let Some(near) = FoldLayout::crease_distances(garment, script, folds + longest / GROWTH) else {
        return Err("the script may crease the cloth anywhere".into());
    };
    let wanted: Vec<f64> = near
        .iter()
        .map(|near| {
            let beyond = (near.fold - folds).min(near.side - sides);
            if beyond < 0.0 { 0.0 } else { (own + GROWTH * beyond).min(longest) }
        })
        .collect();
    let mesh = garment.coarsen(&wanted);
    let (left, all) = (mesh.source_point.len(), garment.points.len());
    if left as f64 > WORTH * all as f64 {
        return Err(format!("{left} of {all} points are needed"));
    }
    let cross = |garment: &Garment| !self_intersections(&garment.points, &garment.triangles).is_empty();
    if cross(garment) || cross(&mesh.garment) {
        return Err("layers cross at the start: on fewer points they would elsewhere".into());
    }
    let why = format!(
        "{left} of {all} points: all within {:.0} mm of fold lines and {:.0} mm of sides, edges up to {:.0} mm elsewhere",
        1e3 * folds,
        1e3 * sides,
        1e3 * longest
    );
    Ok((mesh, why))
}
