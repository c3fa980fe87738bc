//! Verlet list: candidates of a wider search at rest, valid while points stay within a skin of their positions then.
//!
//! A point within the skin at the start and at the end of its displacement has come nearer to anything by no more than the skin on each
//! side: all its candidates are in the list. Only around points outside the skin the bounding-volume hierarchy is searched.

use crate::contact::broad_phase::candidates::Candidates;
use crate::contact::broad_phase::primitives::MeshPrimitives;
use crate::contact::tuning::TUNING;
use crease_geometry::math::Vec3;
use rayon::prelude::*;

/// Points that one task checks.
const POINTS_PER_TASK: usize = 512;

/// Candidates of a mesh at rest within the search distance and twice the skin.
#[derive(Debug, Clone, Default)]
pub(super) struct VerletList {
    /// Positions of the mesh when the list was made \[m\].
    positions: Vec<Vec3>,
    /// Distance of the queries that the list serves \[m\].
    distance: f64,
    pub candidates: Candidates,
    /// Whether the list has served a query besides the one it was made for.
    has_served: bool,
    /// Queries at rest until another list is made.
    pause: u32,
}

impl VerletList {
    /// A list of `candidates` of a mesh at `positions` \[m\] for queries of `distance` \[m\].
    pub fn new(positions: &[Vec3], distance: f64, candidates: Candidates) -> Self {
        Self { positions: positions.to_vec(), distance, candidates, has_served: false, pause: 0 }
    }

    /// Returns the distance within which a list for queries of `distance` has its candidates \[m\].
    pub fn list_distance(distance: f64) -> f64 {
        (1.0 + 2.0 * TUNING.search.verlet_skin) * distance
    }

    /// Whether a point moves farther than the list covers.
    pub fn is_outside_skin(&self, p: usize, start: &[Vec3], end: &[Vec3]) -> bool {
        let (at, skin) = (&self.positions[p], TUNING.search.verlet_skin * self.distance);
        let farthest = (start[p] - at).norm_squared().max((end[p] - at).norm_squared());
        // A position that is not finite is outside.
        !(farthest <= skin * skin && end[p].x.is_finite())
    }

    /// Returns whether the list says nothing of a triangle during this motion, one flag per triangle; `None` where the list is of another
    /// distance or mesh or too few triangles are within the skin.
    pub fn outside_skin(
        &self,
        mesh: &MeshPrimitives,
        start: &[Vec3],
        end: &[Vec3],
        distance: f64,
    ) -> Option<Vec<bool>> {
        if self.distance != distance || self.positions.len() != start.len() {
            return None;
        }
        let points: Vec<bool> = (0..start.len())
            .into_par_iter()
            .with_min_len(POINTS_PER_TASK)
            .map(|p| self.is_outside_skin(p, start, end))
            .collect();
        let outside: Vec<bool> =
            mesh.triangles.iter().map(|t| t.corners.iter().any(|c| points[*c as usize])).collect();
        let count = outside.iter().filter(|outside| **outside).count();
        (count as f64 <= TUNING.search.max_outside_skin_fraction * outside.len() as f64).then_some(outside)
    }

    /// Notes that the list has served a query.
    pub fn note_use(&mut self) {
        self.has_served = true;
    }

    /// Drops the list. Returns whether another should be made for queries of `distance` \[m\]: not directly after one that served no other
    /// query.
    pub fn should_rebuild(&mut self, distance: f64) -> bool {
        if self.pause > 0 {
            self.pause -= 1;
            return false;
        }
        let was_of_no_use = self.distance == distance && !self.has_served;
        *self = Self::default();
        if was_of_no_use {
            self.pause = TUNING.search.verlet_rebuild_pause;
        }
        !was_of_no_use
    }

    /// Returns the candidates with one of the marked triangles, where the mesh is at rest at `x` \[m\] and the list knows all of it.
    pub fn around(
        &self,
        mesh: &MeshPrimitives,
        marked: &[bool],
        x: &[Vec3],
        distance: f64,
    ) -> Option<Candidates> {
        let outside = self.outside_skin(mesh, x, x, distance)?;
        if outside.contains(&true) {
            return None;
        }
        let has = |f: u32| marked[f as usize];
        let point = |[p, f]: [u32; 2]| has(mesh.point_owner[p as usize]) || has(f);
        let edge = |[e, f]: [u32; 2]| has(mesh.edge_owner[e as usize]) || has(mesh.edge_owner[f as usize]);
        Some(self.candidates.filter(point, edge))
    }
}
