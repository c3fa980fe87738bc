//! Finder of candidate pairs of one mesh as it moves.

use crate::contact::broad_phase::candidates::Candidates;
use crate::contact::broad_phase::pair_filter::PairFilter;
use crate::contact::broad_phase::primitive_pair::PrimitivePair;
use crate::contact::broad_phase::primitives::{MeshPrimitives, PointSubset, PrimitiveBoxes};
use crate::contact::broad_phase::search_query::SearchQuery;
use crate::contact::broad_phase::verlet_list::VerletList;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::aabb::SweptBox;
use crease_geometry::mesh::static_bvh::{StaticBvh, TrianglePairs};
use crease_geometry::mesh::{PointIndex, Topology};

/// Finds candidates of one mesh; keeps its hierarchy, boxes and a Verlet list from query to query.
#[derive(Clone)]
pub struct CandidateFinder {
    pub(super) mesh: MeshPrimitives,
    bvh: StaticBvh,
    boxes: PrimitiveBoxes,
    pub(super) verlet_list: VerletList,
}

/// A subset of points that moves while the rest of the mesh stays, prepared for queries of one distance.
#[derive(Debug, Clone, Default)]
pub struct MovingSubset {
    points: PointSubset,
    /// Candidates around the subset from the Verlet list, if that knows them all.
    pub(super) cached: Option<Candidates>,
}

impl CandidateFinder {
    /// A finder for a mesh of `triangles` with their `topology`, at first at `points` \[m\].
    pub fn new(points: &[Vec3], triangles: &[[PointIndex; 3]], topology: &Topology) -> Self {
        Self {
            mesh: MeshPrimitives::new(triangles, topology),
            bvh: StaticBvh::new(points, triangles),
            boxes: PrimitiveBoxes::default(),
            verlet_list: VerletList::default(),
        }
    }

    /// Returns all pairs that may come within the distance of the query during its motion.
    pub fn find(&mut self, query: SearchQuery) -> Candidates {
        let query = query.widened();
        self.boxes.fit(&self.mesh, &query);
        let pairs = self.overlapping_triangles(&query, None);
        PairFilter::new(&self.mesh, &self.boxes, query).compare(&pairs)
    }

    /// Returns candidates as their points: point-triangle pairs first, then edge-edge pairs, in order.
    pub fn pairs<'a>(&'a self, found: &'a Candidates) -> impl Iterator<Item = PrimitivePair> + 'a {
        let points = found.point_triangle.iter().map(|&[p, f]| self.mesh.point_triangle_pair(p, f));
        let edges = found.edge_edge.iter().map(|&[e, f]| self.mesh.edge_edge_pair(e, f));
        points.chain(edges)
    }

    /// Returns what [`Self::find`] does, for a mesh that is searched again and again as it moves.
    pub fn find_cached(&mut self, query: SearchQuery) -> Candidates {
        let SearchQuery { start, end, distance, .. } = query;
        let outside = match self.verlet_list.outside_skin(&self.mesh, start, end, distance) {
            Some(outside) => {
                self.verlet_list.note_use();
                outside
            }
            None if query.is_at_rest() && self.rebuild(start, distance) => {
                vec![false; self.mesh.triangles.len()]
            }
            None => return self.find(query),
        };
        let query = query.widened();
        self.boxes.fit(&self.mesh, &query);
        let is_inside = |a: u32, b: u32| !outside[a as usize] && !outside[b as usize];
        let filter = PairFilter::new(&self.mesh, &self.boxes, query);
        let known = filter.filter(&self.verlet_list.candidates, &is_inside);
        if !outside.contains(&true) {
            return known;
        }
        let pairs = self.overlapping_triangles(&query, Some(&outside));
        known.union(PairFilter::new(&self.mesh, &self.boxes, query).compare(&pairs))
    }

    /// Drops the Verlet list.
    pub fn clear_caches(&mut self) {
        self.verlet_list = VerletList::default();
    }

    /// Returns the points for which `moving` is set, one flag per point, prepared for [`Self::find_around`]. Everything else rests at `x`
    /// \[m\]; `distance` \[m\] is that of the queries to come.
    pub fn moving_subset(&mut self, moving: &[bool], x: &[Vec3], distance: f64) -> MovingSubset {
        let at_rest = SearchQuery { start: x, end: x, distance, uniform_step: true, skip: &|_| false };
        self.boxes.fit(&self.mesh, &at_rest);
        let points = self.mesh.subset(moving);
        let cached = self.verlet_list.around(&self.mesh, &points.has_triangle, x, distance);
        MovingSubset { points, cached }
    }

    /// Returns what [`Self::find`] does where only the points of a subset move and all others are where they were when the subset was made:
    /// the pairs with a triangle of the subset.
    pub fn find_around(&mut self, subset: &MovingSubset, query: SearchQuery) -> Candidates {
        let query = query.widened();
        self.boxes.fit_subset(&self.mesh, &subset.points, &query);
        let leaves_skin = |p: &u32| self.verlet_list.is_outside_skin(*p as usize, query.start, query.end);
        if let Some(cached) = &subset.cached
            && !subset.points.points.iter().any(leaves_skin)
        {
            return PairFilter::new(&self.mesh, &self.boxes, query).filter(cached, &|_, _| true);
        }
        let pairs = self.overlapping_triangles(&query, Some(&subset.points.has_triangle));
        PairFilter::new(&self.mesh, &self.boxes, query).compare(&pairs)
    }

    /// Makes a Verlet list at `x` \[m\] for queries of `distance` \[m\], unless the last was of no use. Returns whether it did.
    fn rebuild(&mut self, x: &[Vec3], distance: f64) -> bool {
        if !self.verlet_list.should_rebuild(distance) {
            return false;
        }
        let list_distance = VerletList::list_distance(distance);
        let wide =
            SearchQuery { start: x, end: x, distance: list_distance, uniform_step: true, skip: &|_| false };
        let candidates = self.find(wide);
        self.verlet_list = VerletList::new(x, distance, candidates);
        true
    }

    /// Returns the pairs of triangles whose boxes, fitted to the query, come near; with `marked` only those with a marked one.
    fn overlapping_triangles(&mut self, query: &SearchQuery, marked: Option<&[bool]>) -> Vec<TrianglePairs> {
        let is_static = !query.uniform_step || query.is_at_rest();
        let limit = SweptBox::limit(query.distance);
        self.bvh.overlapping_triangles(&self.boxes.triangles, limit, is_static, marked)
    }
}
