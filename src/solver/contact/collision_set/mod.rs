//! Collision set: point-triangle and edge-edge pairs of the cloth that may come near, and the limit on displacements.

mod active_pairs;
mod candidate_pair;
mod ccd_problem;
mod far_clearance;
mod local_dhat;

pub(super) use active_pairs::ActivePair;

use crate::contact::broad_phase::{
    CandidateFinder, Candidates, MovingSubset, PairKind, PrimitivePair, SearchQuery,
};
use crate::contact::collision_set::active_pairs::{ActivePairCache, active_pairs_within};
use crate::contact::collision_set::candidate_pair::CandidatePair;
use crate::contact::collision_set::ccd_problem::{CcdMode, CcdProblem};
use crate::contact::collision_set::far_clearance::{FarClearance, mean};
use crate::contact::collision_set::local_dhat::LocalDhat;
use crate::contact::initial_intersections::{InitialIntersections, MeshView};
use crate::contact::settings::ContactSettings;
use crate::contact::step_bounds::StepFractions;
use crate::contact::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::{PointIndex, Topology, edge_key};
use rayon::prelude::*;
use std::sync::Arc;

/// Pairs of one garment with itself.
pub(super) struct CollisionSet {
    dhat: f64,
    /// Stiffness per area [N/m³].
    stiffness: f64,
    self_contact: bool,
    mesh: RestMesh,
    finder: CandidateFinder,
    pairs: Vec<CandidatePair>,
    active: ActivePairCache,
    /// Points that stay where they are during the step, one flag per point; empty for none.
    fixed: Vec<bool>,
    /// Set while only a subset of points moves.
    restriction: Option<Restriction>,
    local_dhat: LocalDhat,
    /// The query at rest that the pairs come from; `None` once they are those of a motion.
    cached_rest_query: Option<RestQuery>,
    far_clearance: FarClearance,
    /// Whether points that would hit one another may move as zones.
    pub zones: bool,
    /// Intersections since the start; `None` before the first step.
    initial: Option<InitialIntersections>,
}

/// The mesh at rest.
struct RestMesh {
    /// Rest positions [m], one per point.
    x: Vec<Vec3>,
    triangles: Vec<[PointIndex; 3]>,
    triangle_edges: Vec<[u32; 3]>,
    edges: Vec<[u32; 2]>,
    /// Areas [m²], one per point.
    point_area: Vec<f64>,
    /// Areas [m²], one per edge.
    edge_area: Vec<f64>,
}

impl RestMesh {
    /// Whether an edge joins the two primitives of a pair. Where such primitives touch at rest, as the diagonals of a square that a pocket
    /// is sewn onto with its corner, neither has a side of the other to stay on.
    fn are_joined(&self, kind: PairKind, [a, b, c, d]: [u32; 4]) -> bool {
        let (first, second): (&[u32], &[u32]) = match kind {
            PairKind::PointTriangle => (&[a], &[b, c, d]),
            PairKind::EdgeEdge => (&[a, b], &[c, d]),
        };
        let is_edge = |p: &u32, q: &u32| self.edges.binary_search(&edge_key(*p, *q)).is_ok();
        first.iter().any(|p| second.iter().any(|q| is_edge(p, q)))
    }
}

/// What decides between two ways to limit a displacement.
#[derive(Clone, Copy)]
pub(super) struct LimitCriteria<'a> {
    /// Returns the decrease of the energy that is predicted for a displacement [J].
    pub decrease: &'a dyn Fn(&[Vec3]) -> f64,
    /// Returns the step size that all else allows for a displacement, such as the ground [-].
    pub allowed: &'a dyn Fn(&[Vec3]) -> f64,
}

/// Positions [m] and fixed points of a query at rest.
struct RestQuery {
    x: Vec<Vec3>,
    fixed: Vec<bool>,
}

/// Restriction to a moving subset of points, with the state that is set aside.
struct Restriction {
    subset: MovingSubset,
    /// Pairs of points that all rest.
    others: Vec<CandidatePair>,
    /// Fixed points of the step.
    fixed: Vec<bool>,
}

impl CollisionSet {
    /// Pairs of a mesh of `triangles` at `rest` [m] with its `topology`; `area` [m²] has one entry per point.
    pub fn new(
        settings: &ContactSettings,
        rest: &[Vec3],
        triangles: &[[PointIndex; 3]],
        topology: &Topology,
        area: &[f64],
    ) -> Self {
        let edges: Vec<[u32; 2]> = topology.edges.iter().map(|e| e.map(|p| p.0)).collect();
        Self {
            dhat: settings.dhat,
            stiffness: settings.stiffness,
            self_contact: settings.self_contact,
            mesh: RestMesh {
                x: rest.to_vec(),
                triangles: triangles.to_vec(),
                triangle_edges: topology.triangle_edges.clone(),
                edge_area: edge_areas(&edges, area),
                edges,
                point_area: area.to_vec(),
            },
            finder: CandidateFinder::new(rest, triangles, topology),
            pairs: Vec::new(),
            active: ActivePairCache::default(),
            fixed: Vec::new(),
            restriction: None,
            local_dhat: LocalDhat::new(settings.dhat, rest.len()),
            cached_rest_query: None,
            far_clearance: FarClearance::default(),
            zones: false,
            initial: None,
        }
    }

    /// See [`crate::contact::Contact::freeze_initial_intersections`].
    pub fn freeze_initial_intersections(&mut self) {
        self.active.clear();
        self.cached_rest_query = None;
        self.initial = Some(InitialIntersections::default());
        self.local_dhat.reset();
    }

    /// See [`crate::contact::Contact::clear_caches`].
    pub fn clear_caches(&mut self) {
        self.cached_rest_query = None;
        self.finder.clear_caches();
    }

    // ---- Steps ----

    /// Starts a step at `x` [m] in which the `fixed` points do not move: counts intersections and finds the pairs.
    pub fn begin_step(&mut self, x: &[Vec3], fixed: &[bool]) {
        self.active.clear();
        self.fixed.clear();
        self.fixed.extend_from_slice(fixed);
        let first = self.initial.is_none();
        let at_rest = vec![Vec3::zeros(); x.len()];
        if self.initial.as_ref().is_some_and(|initial| !initial.is_empty()) {
            self.update_pairs(x, &at_rest, true);
            let before: Vec<bool> = self.pairs.iter().map(|pair| pair.ignored).collect();
            self.count_intersections(x);
            self.update_pairs(x, &at_rest, true);
            // The same pairs in the same order: those that have come apart start with the distance they have.
            let parted = self.pairs.iter().zip(before).filter(|(pair, ignored)| *ignored && !pair.ignored);
            let parted: Vec<CandidatePair> = parted.map(|(pair, _)| *pair).collect();
            self.reduce_local_dhat(x, &parted);
            return;
        }
        if first {
            self.count_intersections(x);
        }
        // During a hold almost nothing moves, and often nothing at all.
        let is_cached = |query: &RestQuery| query.x == x && query.fixed == fixed;
        if !first && self.cached_rest_query.as_ref().is_some_and(is_cached) {
            return;
        }
        let any_near = self.update_pairs(x, &at_rest, true);
        self.update_far_clearance(x, any_near);
        self.cached_rest_query = Some(RestQuery { x: x.to_vec(), fixed: fixed.to_vec() });
    }

    /// Accepts the step of `h` seconds at `x` [m].
    pub fn end_step(&mut self, x: &[Vec3], h: f64) {
        self.active.clear();
        if self.local_dhat.is_reduced() {
            self.cached_rest_query = None;
            self.local_dhat.grow(x, h, &self.pairs);
        }
    }

    fn mesh_at<'a>(&'a self, x: &'a [Vec3]) -> MeshView<'a> {
        MeshView {
            x,
            triangles: &self.mesh.triangles,
            triangle_edges: &self.mesh.triangle_edges,
            edge_count: self.mesh.edges.len(),
        }
    }

    fn count_intersections(&mut self, x: &[Vec3]) {
        let found = InitialIntersections::find(self.mesh_at(x), self.initial.as_ref());
        self.initial = Some(found);
    }

    /// Whether more triangles intersect at `x` [m] than at the start.
    pub fn adds_intersections(&self, x: &[Vec3]) -> bool {
        self.initial.as_ref().is_some_and(|initial| initial.adds_intersections(self.mesh_at(x)))
    }

    /// Reduces the activation distances of the points of `parted` pairs below their distance at `x`.
    fn reduce_local_dhat(&mut self, x: &[Vec3], parted: &[CandidatePair]) {
        self.local_dhat.reduce(x, parted);
        let local_dhat = &self.local_dhat;
        self.pairs.iter_mut().for_each(|pair| pair.dhat = pair.dhat.min(local_dhat.of_pair(&pair.points)));
    }

    // ---- Search ----

    /// Distance of queries [m].
    fn search_distance(&self) -> f64 {
        TUNING.search.candidate_margin * self.dhat
    }

    /// Makes a far query if one is due, unless `any_near`.
    fn update_far_clearance(&mut self, x: &[Vec3], any_near: bool) {
        let at_rest = vec![Vec3::zeros(); x.len()];
        let distance = self.search_distance();
        if !self.self_contact || self.far_clearance.covers(x, &at_rest, distance, true) {
            return;
        }
        if self.far_clearance.is_due() {
            let distance = TUNING.search.far_query_factor * distance;
            let query = SearchQuery { start: x, end: x, distance, uniform_step: true, skip: &|_| false };
            if !any_near && self.finder.find(query).is_empty() {
                self.far_clearance.set_clear(x, distance);
            } else {
                self.far_clearance.set_near();
            }
        }
    }

    /// Sets the pairs to those that may come near during the displacement `d` from `x`. Returns whether there are any.
    fn update_pairs(&mut self, x: &[Vec3], d: &[Vec3], uniform_step: bool) -> bool {
        if self.restriction.is_some() {
            return self.update_pairs_of_subset(x, d, uniform_step);
        }
        // For a uniform step only relative motion matters: cloth that falls as a whole sweeps nothing.
        let common = if uniform_step { mean(d) } else { Vec3::zeros() };
        let end: Vec<Vec3> = x.iter().zip(d).map(|(x, d)| x + (d - common)).collect();
        let distance = self.search_distance();
        let found = if self.self_contact && !self.far_clearance.covers(x, d, distance, uniform_step) {
            let skip = all_fixed(&self.fixed);
            self.finder.find_cached(SearchQuery { start: x, end: &end, distance, uniform_step, skip: &skip })
        } else {
            Candidates::default()
        };
        self.set_pairs(found)
    }

    /// Updates the pairs while only a subset of points moves and all else rests. Returns whether there are any.
    fn update_pairs_of_subset(&mut self, x: &[Vec3], d: &[Vec3], uniform_step: bool) -> bool {
        let Some(restriction) = self.restriction.take() else { return false };
        let end: Vec<Vec3> = x.iter().zip(d).map(|(x, d)| x + d).collect();
        let distance = self.search_distance();
        let found = if self.self_contact {
            let skip = all_fixed(&self.fixed);
            let query = SearchQuery { start: x, end: &end, distance, uniform_step, skip: &skip };
            self.finder.find_around(&restriction.subset, query)
        } else {
            Candidates::default()
        };
        self.restriction = Some(restriction);
        self.set_pairs(found)
    }

    /// Makes candidates the pairs of the set. Returns whether there are any.
    fn set_pairs(&mut self, found: Candidates) -> bool {
        self.cached_rest_query = None;
        let mesh = &self.mesh;
        let initial = self.initial.as_ref().filter(|initial| !initial.is_empty());
        let pair = |kind: PairKind, points: [u32; 4], area: f64, ignored: bool| -> Option<CandidatePair> {
            let mut dhat = self.local_dhat.of_pair(&points);
            // Few pairs are near at rest, and their boxes say so.
            let rest = points.map(|p| mesh.x[p as usize]);
            let max_ratio = TUNING.search.max_dhat_over_rest_distance;
            if !kind.apart_on_an_axis(&rest, dhat / max_ratio) {
                let distance = kind.closest_points(&rest).distance;
                if distance < TUNING.search.touching_fraction * dhat && mesh.are_joined(kind, points) {
                    return None;
                }
                dhat = dhat.min(max_ratio * distance);
            }
            Some(CandidatePair { points, kind, dhat, area, ignored })
        };
        let point = |&[p, f]: &[u32; 2]| {
            let [a, b, c] = mesh.triangles[f as usize].map(|c| c.0);
            let area = 0.5 * mesh.point_area[p as usize];
            let ignored = initial.is_some_and(|initial| initial.ignores_point_triangle(p, f));
            pair(PairKind::PointTriangle, [p, a, b, c], area, ignored)
        };
        let edges = |&[e, f]: &[u32; 2]| {
            let ([a, b], [c, d]) = (mesh.edges[e as usize], mesh.edges[f as usize]);
            let area = 0.25 * (mesh.edge_area[e as usize] + mesh.edge_area[f as usize]);
            let ignored = initial.is_some_and(|initial| initial.ignores_edges(e, f));
            pair(PairKind::EdgeEdge, [a, b, c, d], area, ignored)
        };
        let points = found.point_triangle.par_iter().filter_map(point);
        let pairs: Vec<CandidatePair> = points.chain(found.edge_edge.par_iter().filter_map(edges)).collect();
        self.pairs = pairs;
        !found.is_empty()
    }

    // ---- Subsets of points ----

    /// Restricts the set to pairs of points for which `moving` is set, one flag per point; all others rest at `x` [m].
    pub fn restrict_to(&mut self, x: &[Vec3], moving: &[bool]) {
        self.active.clear();
        self.cached_rest_query = None;
        let subset = self.finder.moving_subset(moving, x, self.search_distance());
        let moves =
            |pair: &CandidatePair| pair.points.iter().any(|p| moving.get(*p as usize).is_some_and(|m| *m));
        let (pairs, others) = std::mem::take(&mut self.pairs).into_iter().partition(moves);
        self.pairs = pairs;
        let fixed = std::mem::replace(&mut self.fixed, moving.iter().map(|moving| !moving).collect());
        self.restriction = Some(Restriction { subset, others, fixed });
    }

    /// Ends the restriction.
    pub fn unrestrict(&mut self) {
        if let Some(Restriction { mut others, fixed, .. }) = self.restriction.take() {
            self.active.clear();
            others.append(&mut self.pairs);
            self.pairs = others;
            self.fixed = fixed;
        }
    }

    // ---- Response ----

    /// Returns all pairs within their activation distance at `x` [m], in a fixed order.
    pub fn active_pairs(&self, x: &[Vec3]) -> Arc<Vec<ActivePair>> {
        self.active.get(x, || self.active_pairs_within(x, 1.0))
    }

    /// Returns the pairs within `margin` times their activation distance, as far as they are candidates.
    pub fn active_pairs_within(&self, x: &[Vec3], margin: f64) -> Vec<ActivePair> {
        active_pairs_within(&self.pairs, self.stiffness, x, margin)
    }

    // ---- Limits on displacements ----

    /// See [`crate::contact::Contact::limit_displacement`].
    ///
    /// Most long displacements bring nothing together: they are found free with one step size for all points, which needs only the pairs that
    /// come near in that motion, or are made together as far as possible, if that is far enough (`min_uniform_step`). Otherwise candidates hold
    /// for any fractions of the displacements, and every point gets the fraction that keeps its pairs apart (`contact::step_bounds`), or all
    /// get the one step size that does, whichever predicts more decrease: layers that move along with one another are torn by the first. Where
    /// both leave little of the predicted decrease, layers that move along with one another have stopped each other; then points that would
    /// hit one another move as zones (`contact::impact_zones`), if they may and that is better. A pair may use up most of its gap in one step
    /// but not all of it: the barrier must act before layers come really near, or a decrease of energy elsewhere would press them to
    /// nothing.
    pub fn limit_displacement(&mut self, x: &[Vec3], d: &mut [Vec3], criteria: LimitCriteria) {
        let far = TUNING.step.long_step_distances * TUNING.search.candidate_margin * self.dhat;
        let is_long = self.far_clearance.is_clear() || d.iter().any(|d| d.norm_squared() > far * far);
        if is_long {
            let mode = CcdMode { per_point: false, carry: false, allow_initial: true };
            let step_size = self.ccd_problem(x, d, mode).uniform_step_size();
            if step_size >= TUNING.step.min_uniform_step {
                d.iter_mut().for_each(|d| *d *= step_size);
                return;
            }
        }
        let mode = CcdMode { per_point: true, carry: false, allow_initial: true };
        let problem = self.ccd_problem(x, d, mode);
        let limited = better_step(&problem.local_step_sizes(d), d, criteria);
        let zones = if self.zones { self.better_zones(&problem, d, &limited, criteria) } else { None };
        if let Some(zones) = zones {
            // Zones move along other lines than the pairs of the problem were found for.
            let mode = CcdMode { per_point: false, ..mode };
            if self.ccd_problem(x, &zones, mode).uniform_step_size() >= 1.0 {
                d.copy_from_slice(&zones);
                return;
            }
            self.update_pairs(x, d, false);
        }
        d.copy_from_slice(&limited);
    }

    /// Returns the displacement by zones [m], if it decreases the energy more than `limited` does, which leaves little of the
    /// decrease by `d`.
    fn better_zones(
        &self,
        problem: &CcdProblem,
        d: &[Vec3],
        limited: &[Vec3],
        LimitCriteria { decrease, allowed }: LimitCriteria,
    ) -> Option<Vec<Vec3>> {
        let reached = decrease(limited);
        if reached >= TUNING.step.min_decrease_fraction * decrease(d) {
            return None;
        }
        let mut zones = problem.zone_displacement(&self.fixed)?;
        let step_size = allowed(&zones);
        zones.iter_mut().for_each(|d| *d *= step_size);
        (decrease(&zones) > reached.max(0.0)).then_some(zones)
    }

    /// See [`crate::contact::Contact::limit_displacement_uniform`].
    pub fn limit_displacement_uniform(&mut self, x: &[Vec3], d: &mut [Vec3]) {
        let mode = CcdMode { per_point: false, carry: false, allow_initial: false };
        let step_size = self.ccd_problem(x, d, mode).uniform_step_size();
        d.iter_mut().for_each(|d| *d *= step_size);
    }

    /// Moves the cloth at `x` by `d` [m], each point as far as all stay apart, and presses no layer any farther.
    ///
    /// First all points move by the same step size, so that layers that move along with one another do, then each by what is left of its
    /// displacement. The points around a limited one stay behind with it: alone it would be drawn out of them.
    pub fn carry(&mut self, x: &mut [Vec3], d: &[Vec3]) {
        self.active.clear();
        let mut d = d.to_vec();
        let mode = CcdMode { per_point: false, carry: true, allow_initial: false };
        let step_size = self.ccd_problem(x, &d, mode).uniform_step_size();
        x.iter_mut().zip(&d).for_each(|(x, d)| *x += d * step_size);
        d.iter_mut().for_each(|d| *d *= 1.0 - step_size);
        if step_size >= 1.0 {
            return;
        }
        for allow_initial in [true, false] {
            let mode = CcdMode { per_point: true, carry: true, allow_initial };
            let problem = self.ccd_problem(x, &d, mode);
            let fractions = self.limit_neighbours(problem.local_step_sizes(&d).fraction);
            let motion: Vec<Vec3> = d.iter().zip(fractions).map(|(d, f)| d * f).collect();
            let limited = problem.local_step_sizes(&motion).apply(&motion);
            let end: Vec<Vec3> = x.iter().zip(&limited).map(|(x, d)| x + d).collect();
            if !allow_initial || !self.adds_intersections(&end) {
                x.copy_from_slice(&end);
                return;
            }
        }
    }

    /// Limits step sizes, one per point, so that they differ by no more than `neighbour_step_limit` from point to point.
    fn limit_neighbours(&self, mut step_sizes: Vec<f64>) -> Vec<f64> {
        let limit = TUNING.step.neighbour_step_limit;
        for _ in 0..(1.0 / limit).ceil() as usize {
            let before = step_sizes.clone();
            for &[a, b] in &self.mesh.edges {
                let [a, b] = [a as usize, b as usize];
                step_sizes[a] = step_sizes[a].min(before[b] + limit);
                step_sizes[b] = step_sizes[b].min(before[a] + limit);
            }
        }
        step_sizes
    }

    /// Finds the pairs of the displacement `d` from `x` and how near each may come.
    fn ccd_problem<'a>(&mut self, x: &'a [Vec3], d: &'a [Vec3], mode: CcdMode) -> CcdProblem<'a> {
        self.update_pairs(x, d, !mode.per_point);
        CcdProblem::new(&self.pairs, x, d, mode)
    }
}

/// Returns the displacement `d` [m] limited point by point, or by one step size for all where its predicted decrease is larger.
fn better_step(fractions: &StepFractions, d: &[Vec3], criteria: LimitCriteria) -> Vec<Vec3> {
    let limited = fractions.apply(d);
    let uniform_step = fractions.uniform_step;
    if fractions.min_fraction < 1.0 && uniform_step * (criteria.decrease)(d) >= (criteria.decrease)(&limited)
    {
        return d.iter().map(|d| d * uniform_step).collect();
    }
    limited
}

/// Whether all points of a pair are fixed; `fixed` is empty for none.
fn all_fixed(fixed: &[bool]) -> impl Fn(PrimitivePair) -> bool + Sync + '_ {
    |pair| !fixed.is_empty() && pair.points.iter().all(|p| fixed[p.at()])
}

/// Returns the areas of edges [m²], parts of the areas of their two ends: the sum over edges is that over points.
fn edge_areas(edges: &[[u32; 2]], point_area: &[f64]) -> Vec<f64> {
    let mut degree = vec![0.0f64; point_area.len()];
    edges.iter().flatten().for_each(|&p| degree[p as usize] += 1.0);
    let part = |p: u32| point_area[p as usize] / degree[p as usize].max(1.0);
    edges.iter().map(|e| part(e[0]) + part(e[1])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A pocket begins at two sides of a square of the cloth below: its diagonal lies on the other one of the square, and on neither side
    /// of it. Guarded, the pair would hold its four points for ever.
    #[test]
    fn joined_edges_that_touch_at_rest_stop_nothing() {
        let corners =
            [[0.0, 0.0, 0.0], [0.02, 0.0, 0.0], [0.02, 0.0, 0.02], [0.0, 0.0, 0.02], [0.02, 3e-3, 0.02]];
        let points: Vec<Vec3> = corners.into_iter().map(Vec3::from).collect();
        let triangles = [[0, 2, 1], [0, 3, 2], [0, 3, 1], [1, 3, 4]].map(|t| t.map(PointIndex));
        let topology = Topology::new(points.len(), &triangles);
        let settings = ContactSettings::uniform(1e-3, 1e6, 0.0);
        let mut set = CollisionSet::new(&settings, &points, &triangles, &topology, &[1e-4; 5]);
        set.freeze_initial_intersections();
        set.begin_step(&points, &[false; 5]);
        let wanted: Vec<Vec3> = (0..5).map(|p| Vec3::y() * if p % 2 == 1 { 1e-3 } else { 0.0 }).collect();
        let mut d = wanted.clone();
        set.limit_displacement(&points, &mut d, LimitCriteria { decrease: &|_| 1.0, allowed: &|_| 1.0 });
        assert_eq!(d, wanted);
    }

    /// Of two points one is stopped; what that leaves of the decrease decides whether the other moves on alone.
    #[test]
    fn points_are_limited_one_by_one_only_where_that_decreases_more() {
        let d = [Vec3::x(), Vec3::x() * 2.0];
        let pulls = |of: [f64; 2]| move |d: &[Vec3]| d.iter().zip(of).map(|(d, of)| d.x * of).sum::<f64>();
        let limited = |uniform_step: f64, of: [f64; 2]| {
            let fractions = StepFractions {
                fraction: vec![uniform_step, 1.0],
                min_fraction: uniform_step,
                uniform_step,
                limited_points: 1,
                rounds: 2,
                fallback_points: 0,
            };
            let decrease = pulls(of);
            better_step(&fractions, &d, LimitCriteria { decrease: &decrease, allowed: &|_| 1.0 })
        };
        assert_eq!(limited(0.25, [1.0, 1.0]), [Vec3::x() * 0.25, Vec3::x() * 2.0]);
        // What moves on alone increases the energy.
        assert_eq!(limited(0.25, [4.0, -1.0]), [Vec3::x() * 0.25, Vec3::x() * 0.5]);
    }
}
