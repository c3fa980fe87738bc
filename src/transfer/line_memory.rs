//! Memory of crease lines on a mesh with edges along them: every edge on a line takes the angle of the source's hinge there.
//!
//! As a field over triangles a fold would be spread over the strips beside it, whose triangles are not those of the source.

use crate::transfer::crease_drawing::point_matches;
use crate::transfer::crease_lines::CreaseLine;
use crate::transfer::tuning::TUNING;
use crease_model::garment::RestState;
use crease_model::remesh::{Correspondence, GarmentSurface, Match};

/// Memory that lies on crease lines.
pub(super) struct LineMemory {
    /// Change of rest angle [rad], one per hinge of the mesh.
    pub angle: Vec<f64>,
    /// Hinges of the source whose memory is in it.
    pub carried: Vec<u32>,
}

impl LineMemory {
    /// What `memory` of the source of `correspondence` has on `lines`, on the edges of `mesh` along them. `orientation` is -1 where one of
    /// both has its normals inside, else 1.
    pub fn new(
        lines: &[CreaseLine],
        memory: &RestState,
        correspondence: &impl Correspondence,
        mesh: &GarmentSurface,
        orientation: f64,
    ) -> Self {
        let source = correspondence.source();
        let matches = point_matches(correspondence, mesh);
        let mut all = Self { angle: vec![0.0; mesh.topology.hinges.len()], carried: Vec::new() };
        for line in lines {
            let place = |found: &Match| line.locate(source, found.triangle, &found.position);
            let is_on = |found: &Option<Match>| {
                let place = found.as_ref().and_then(place);
                place.is_some_and(|(level, _)| level.abs() < TUNING.crease_line_tol * line.row)
            };
            let on: Vec<bool> = matches.iter().map(is_on).collect();
            // Hinges of the mesh on the line, with the number of the line's hinge there and their length.
            let mut found: Vec<(usize, usize, f64)> = Vec::new();
            for (h, hinge) in mesh.topology.hinges.iter().enumerate() {
                let ends = [hinge.points[0].at(), hinge.points[1].at()];
                let [Some(a), Some(b)] = ends.map(|p| matches[p].filter(|_| on[p])) else { continue };
                let middle = Match { position: 0.5 * (a.position + b.position), ..a };
                let there = place(&middle).or_else(|| place(&Match { triangle: b.triangle, ..middle }));
                if let Some((_, k)) = there {
                    found.push((h, k, (mesh.points[ends[1]] - mesh.points[ends[0]]).norm()));
                }
            }
            let mut covered = vec![0.0; line.hinges.len()];
            found.iter().for_each(|(_, k, length)| covered[*k] += length);
            let is_drawn: Vec<bool> = (0..covered.len()).map(|k| is_covered(line, &covered, k)).collect();
            for (h, k, _) in found.into_iter().filter(|(_, k, _)| is_drawn[*k]) {
                let own = line.hinges[k] as usize;
                all.angle[h] = orientation * (memory.rest_angle[own] - memory.source_angle[own]);
            }
            let drawn = line.hinges.iter().zip(&is_drawn).filter(|(_, drawn)| **drawn);
            all.carried.extend(drawn.map(|(h, _)| h));
        }
        all
    }
}

/// Whether the mesh has edges along hinge `k` of `line` and those next to it, of which `covered` has the lengths [m].
fn is_covered(line: &CreaseLine, covered: &[f64], k: usize) -> bool {
    let near = k.saturating_sub(1)..(k + 2).min(covered.len());
    let length: f64 = near.clone().map(|k| line.hinge_length(k)).sum();
    near.map(|k| covered[k]).sum::<f64>() >= TUNING.min_crease_line_coverage * length
}
