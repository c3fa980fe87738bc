//! Displacements held back where the triangles of the garment cannot follow those of the simulation mesh without crossing.
//!
//! The shape is found on the simulation mesh, where layers do not cross. Read off at the points of the garment, whose triangles
//! are others, layers that lie close may cross. There the displacement is scaled down, round by round, until no pair of triangles
//! crosses that does not cross in the source pose.

use crate::bake::ModelDecision;
use crate::bake::tuning::TUNING;
use crate::garment::Garment;
use crate::math::Vec3;
use crate::mesh::intersections::self_intersections;
use rustc_hash::FxHashSet;

/// Scales `displacement` (one per point [m]) down where triangles would cross. Reports the number of points held back, if any.
pub(super) fn hold_back(garment: &Garment, displacement: &mut [Vec3]) -> Option<ModelDecision> {
    let relax = TUNING.relax;
    let own: FxHashSet<[u32; 2]> =
        self_intersections(&garment.points, &garment.triangles).into_iter().collect();
    let mut held = vec![false; garment.points.len()];
    for round in 0..relax.max_hold_back_rounds {
        let shape: Vec<Vec3> = garment.points.iter().zip(displacement.iter()).map(|(x, d)| x + d).collect();
        let mut crossing = self_intersections(&shape, &garment.triangles);
        crossing.retain(|pair| !own.contains(pair));
        if crossing.is_empty() {
            break;
        }
        let mut marked = vec![false; garment.points.len()];
        let corners = crossing.iter().flatten().flat_map(|&f| garment.triangles[f as usize]);
        corners.for_each(|p| marked[p.at()] = true);
        // Neighbours follow, so that no step is left; more of them the longer it takes.
        for _ in 0..1 + round / 8 {
            let before = marked.clone();
            for [a, b] in &garment.topology.edges {
                marked[a.at()] |= before[b.at()];
                marked[b.at()] |= before[a.at()];
            }
        }
        let last = round + 1 == relax.max_hold_back_rounds;
        for (p, displacement) in displacement.iter_mut().enumerate().filter(|(p, _)| marked[*p]) {
            *displacement *= if last { 0.0 } else { relax.hold_back_factor };
            held[p] = true;
        }
    }
    let count = held.iter().filter(|held| **held).count();
    let why = format!("{count} of {} points, where layers would cross", garment.points.len());
    (count > 0).then_some(ModelDecision { name: "held back", on: true, why })
}
