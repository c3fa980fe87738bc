//! The mesh that is simulated: the garment's own where the script creases it, and fewer points elsewhere.
//!
//! The cost of a bake grows with its points, and creases lie where the script makes them: along its fold lines, through all
//! layers, at the sides of a garment that lies, and where it is pressed on a crease ([`crate::wear::predict_creases`]). There every
//! point of the garment is simulated, and edges grow with the distance from there. Afterwards the memory is carried back to
//! every hinge of the garment, unchanged where both meshes are the same and resampled elsewhere
//! ([`crate::transfer::prolongate`]), and the whole garment is relaxed to its source pose.
//!
//! Where a script may crease the cloth anywhere (crumpling, a body that moves) every point is simulated.
//! `docs/validation/accuracy.md` has the error of adaptive meshes.

use crate::bake::aligned_mesh::aligned_mesh;
use crate::bake::tuning::TUNING;
use crate::bake::{BakeOptions, ModelDecision};
use crate::fabric::Fabric;
use crate::garment::{CoarseMesh, Garment};
use crate::mesh::intersections::self_intersections;
use crate::remesh::AlignedMesh;
use crate::wear::{WearScript, predict_creases};

/// A mesh that is simulated instead of a garment.
#[derive(Debug, Clone)]
pub enum OtherMesh {
    /// Fewer points of the garment.
    Coarse(CoarseMesh),
    /// Edges along fold lines.
    Aligned(AlignedMesh),
}

impl OtherMesh {
    /// The mesh as a garment of its own.
    pub fn garment(&self) -> &Garment {
        match self {
            Self::Coarse(mesh) => &mesh.garment,
            Self::Aligned(mesh) => &mesh.garment,
        }
    }
}

/// The mesh that is simulated instead of a garment, if any.
#[derive(Debug, Clone)]
pub struct SimulationMesh {
    /// The other mesh; `None` to simulate the garment itself.
    pub mesh: Option<OtherMesh>,
    /// The decision, with its reason.
    pub decision: ModelDecision,
}

impl SimulationMesh {
    /// Chooses the mesh for a bake of `garment`.
    pub fn choose(garment: &Garment, fabric: &Fabric, script: &WearScript, options: &BakeOptions) -> Self {
        let (name, made) = if options.aligned_mesh {
            let made = aligned_mesh(garment, script, options);
            ("aligned mesh", made.map(|(mesh, why)| (OtherMesh::Aligned(mesh), why)))
        } else {
            let made = coarsened(garment, fabric, script, options);
            ("adaptive mesh", made.map(|(mesh, why)| (OtherMesh::Coarse(mesh), why)))
        };
        let (mesh, why) = match made {
            Ok((mesh, why)) => (Some(mesh), why),
            Err(why) => (None, why),
        };
        Self { decision: ModelDecision { name, on: mesh.is_some(), why }, mesh }
    }
}

/// The coarser mesh with the reason for it; or the reason why there is none.
fn coarsened(
    garment: &Garment,
    fabric: &Fabric,
    script: &WearScript,
    options: &BakeOptions,
) -> Result<(CoarseMesh, String), String> {
    let tuning = &TUNING.adaptive_mesh;
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
    let [folds, sides] = [(tuning.fold_margin * length).max(own), tuning.side_margin * length];
    let longest = tuning.max_edge_bending_lengths * length;
    let Some(near) = predict_creases(garment, script, folds + longest / tuning.edge_growth) else {
        return Err("the script may crease the cloth anywhere".into());
    };
    let wanted: Vec<f64> = near
        .iter()
        .map(|near| {
            let beyond = (near.fold - folds).min(near.side - sides);
            if beyond < 0.0 { 0.0 } else { (own + tuning.edge_growth * beyond).min(longest) }
        })
        .collect();
    let mesh = garment.coarsen(&wanted);
    let (left, all) = (mesh.source_point.len(), garment.points.len());
    if left as f64 > tuning.max_kept_fraction * all as f64 {
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
