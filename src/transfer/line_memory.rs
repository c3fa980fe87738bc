//! Memory of crease lines on a mesh with edges along them: every edge on a line takes the angle of the source's crease there.
//!
//! As a field over triangles a fold would be spread over the strips beside it, whose triangles are not those of the source.

use crate::transfer::crease_lines::CreaseLine;
use crate::transfer::line_levels::LineLevels;
use crate::transfer::mesh_on_target::MeshOnTarget;
use crate::transfer::tuning::TUNING;
use crease_model::remesh::{Correspondence, GarmentSurface};

/// Memory that lies on crease lines.
pub(super) struct LineMemory {
    /// Change of rest angle [rad], one per hinge of the mesh.
    pub angle: Vec<f64>,
    /// Hinges of the source whose memory is in it.
    pub carried: Vec<u32>,
}

impl LineMemory {
    /// What a source has on `lines`, with their `levels` at the points of the target, on the edges of `mesh` along them. `orientation` is -1 where
    /// one of both has its normals inside, else 1.
    pub fn new<C: Correspondence>(
        lines: &[CreaseLine],
        levels: &[LineLevels],
        on_target: &MeshOnTarget<C>,
        mesh: &GarmentSurface,
        orientation: f64,
    ) -> Self {
        let places = on_target.places(&mesh.points);
        let mut all = Self { angle: vec![0.0; mesh.topology.hinges.len()], carried: Vec::new() };
        for (line, levels) in lines.iter().zip(levels) {
            // Per point of the mesh: the length of the line up to there, where it lies on it.
            let along: Vec<Option<f64>> = places
                .iter()
                .map(|place| {
                    let level = on_target.interpolated(place, &levels.level);
                    let is_on = level.abs() < TUNING.crease_line_tol * line.row;
                    is_on.then(|| on_target.interpolated(place, &levels.along))
                })
                .collect();
            // Hinges of the mesh on the line, with the part of the line there and their length.
            let mut found: Vec<(usize, usize, f64)> = Vec::new();
            for (h, hinge) in mesh.topology.hinges.iter().enumerate() {
                let ends = [hinge.points[0].at(), hinge.points[1].at()];
                let [Some(a), Some(b)] = ends.map(|p| along[p]) else { continue };
                let middle = 0.5 * (a + b);
                if middle >= 0.0 && middle <= line.length() {
                    found.push((
                        h,
                        line.part_at(middle),
                        (mesh.points[ends[1]] - mesh.points[ends[0]]).norm(),
                    ));
                }
            }
            let mut covered = vec![0.0; line.angle.len()];
            found.iter().for_each(|(_, k, length)| covered[*k] += length);
            let is_drawn: Vec<bool> = (0..covered.len()).map(|k| is_covered(line, &covered, k)).collect();
            for (h, k, _) in found.into_iter().filter(|(_, k, _)| is_drawn[*k]) {
                all.angle[h] = orientation * line.angle[k];
            }
            let drawn = line.hinges.iter().zip(&is_drawn).filter(|(_, drawn)| **drawn);
            all.carried.extend(drawn.flat_map(|(hinges, _)| hinges));
        }
        all
    }
}

/// Whether the mesh has edges along part `k` of `line` and those next to it, of which `covered` has the lengths [m].
fn is_covered(line: &CreaseLine, covered: &[f64], k: usize) -> bool {
    let near = k.saturating_sub(1)..(k + 2).min(covered.len());
    let length: f64 = near.clone().map(|k| line.part_length(k)).sum();
    near.map(|k| covered[k]).sum::<f64>() >= TUNING.min_crease_line_coverage * length
}
