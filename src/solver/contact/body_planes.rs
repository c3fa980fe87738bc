//! One-sided contact of cloth with a body: every point of the cloth rests on a plane of the surface nearest to it.
//!
//! The body moves as prescribed, whatever is in between. (A guarantee that no triangles of cloth and body ever
//! intersect cannot hold in an elbow, where skin folds into itself.) At the beginning of a step each point of the cloth gets its footpoint, the position on
//! the surface nearest to it. The footpoint at the end of the step, with the normal there, is a plane that the point rests on
//! (`energy::PlaneContact`). Surface and cloth are followed together, so a fast body does not pass its cloth; a point that is inside, by an
//! error of the file or caught in a crease, is pushed out.
//!
//! Where the body folds into itself its two sides are moved apart (`contact::self_fold`).
//!
//! Points alone do not keep triangles out: between three points outside, a corner of the body would still poke through. So points and edges of
//! the body carry the cloth over them, too (`contact::body_edges`). Where cloth intersects the body after a step all the same, the planes of its
//! points are offset outwards, step by step until it no longer does ([`BodyPlanes::raise_offsets`]).
//!
//! Friction is that of `contact::friction`: Coulomb, with a tangential stretch kept from step to step. Nothing is guaranteed: cloth may
//! intersect a body until it is offset, and where it does not fit.

use crate::contact::body_edges::BodyEdges;
use crate::contact::friction::slip_tolerance;
use crate::contact::self_fold::{BodySurface, ClothSurface, SelfFold};
use crate::contact::settings::BodyContactSettings;
use crate::contact::tuning::TUNING;
use crate::energy::{EdgeContact, PlaneContact};
use crease_geometry::math::{Mat3, Vec3};
use crease_geometry::mesh::intersections::IntersectionSearch;
use crease_geometry::mesh::point_in_solid::point_normals;
use crease_geometry::mesh::triangle_bvh::TriangleBvh;
use crease_geometry::mesh::{PointIndex, Topology};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Distance from a self fold within which intersections count as those of the fold [m].
pub const SELF_FOLD_MARGIN: f64 = TUNING.body.self_fold_margin;

/// A body and its contact with the cloth.
pub struct BodyPlanes {
    triangles: Vec<[PointIndex; 3]>,
    bvh: TriangleBvh,
    /// Search for triangles of the cloth that intersect it.
    intersections: IntersectionSearch,
    self_fold: SelfFold,
    /// Positions at the beginning of the step [m], one per point.
    positions: Vec<Vec3>,
    /// Unit normals there, one per point.
    normals: Vec<Vec3>,
    settings: BodyContactSettings,
    /// Whether a point of the body is near a footpoint of this step, one flag per point.
    covered: Vec<bool>,
    /// Footpoints of this step, one per point of the cloth.
    footpoints: Vec<Option<Footpoint>>,
    /// Its points and edges under triangles and edges of the cloth.
    edges: BodyEdges,
    /// Offsets of the planes [m], one per point of the cloth.
    offsets: Vec<f64>,
    /// Tangential stretch over slip tolerance [-], one per point of the cloth.
    stretch_ratios: Vec<Vec3>,
}

/// State of a [`BodyPlanes`] that the next step depends on.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyContactState {
    /// Positions of the body [m], one per point.
    #[serde(with = "crease_geometry::math::serde_vec::vectors")]
    positions: Vec<Vec3>,
    /// Offsets of the planes [m], one per point of the cloth.
    offsets: Vec<f64>,
    /// Offsets of the points of the body [m], one per point.
    edge_offsets: Vec<f64>,
    /// Tangential stretch over slip tolerance [-], one per point of the cloth.
    #[serde(with = "crease_geometry::math::serde_vec::vectors")]
    stretch_ratios: Vec<Vec3>,
}

impl BodyContactState {
    /// The state on a refined cloth, whose values `on_points` gives from those of the points of this one.
    pub fn on_points(&self, on_points: impl Fn(&[Vec3]) -> Vec<Vec3>) -> Self {
        let offsets: Vec<Vec3> = self.offsets.iter().map(|offset| Vec3::repeat(*offset)).collect();
        Self {
            offsets: on_points(&offsets).into_iter().map(|offset| offset.x).collect(),
            stretch_ratios: on_points(&self.stretch_ratios),
            ..self.clone()
        }
    }

    /// Whether it is of a body and a cloth of so many points.
    pub fn fits(&self, body: usize, cloth: usize) -> bool {
        [self.positions.len(), self.edge_offsets.len()] == [body; 2]
            && [self.offsets.len(), self.stretch_ratios.len()] == [cloth; 2]
    }
}

/// Position on the surface nearest to a point at the beginning of a step.
#[derive(Debug, Clone, Copy)]
struct Footpoint {
    triangle: u32,
    /// Barycentric coordinates in the triangle.
    weights: [f64; 3],
    /// [m].
    position: Vec3,
    /// Height of the point over it [m].
    gap: f64,
}

/// Numbers of pairs of triangles of cloth and body that intersect.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct BodyIntersections {
    /// Pairs outside self folds.
    pub open: usize,
    /// Pairs in self folds of the body and within [`SELF_FOLD_MARGIN`] of them.
    pub self_fold: usize,
    /// Middle of the triangles of the cloth in pairs outside self folds [m].
    pub position: Vec3,
}

/// A point of the cloth inside the body.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Penetration {
    /// The point of the cloth.
    pub point: u32,
    /// Depth under its plane [m].
    pub depth: f64,
}

impl BodyPlanes {
    /// A body of `triangles`, at `points` [m] now. Triangles that repeat a point have no area and are left out.
    pub fn new(points: &[Vec3], triangles: &[[PointIndex; 3]], settings: BodyContactSettings) -> Self {
        let triangles: Vec<_> =
            triangles.iter().filter(|[a, b, c]| a != b && b != c && c != a).copied().collect();
        let cloth_count = settings.areas.len();
        let normals = point_normals(points, &triangles);
        Self {
            bvh: TriangleBvh::new(points, &triangles, 0.0),
            intersections: IntersectionSearch::default(),
            self_fold: SelfFold::new(points, normals.clone()),
            normals,
            positions: points.to_vec(),
            covered: vec![false; points.len()],
            footpoints: vec![None; cloth_count],
            edges: BodyEdges::new(points, &triangles),
            offsets: vec![0.0; cloth_count],
            triangles,
            settings,
            stretch_ratios: vec![Vec3::zeros(); cloth_count],
        }
    }

    /// Its positions [m], one per point.
    pub fn points(&self) -> &[Vec3] {
        &self.positions
    }

    /// Its triangles.
    pub fn triangles(&self) -> &[[PointIndex; 3]] {
        &self.triangles
    }

    /// Returns what the next step depends on, besides the body itself.
    pub fn state(&self) -> BodyContactState {
        BodyContactState {
            positions: self.positions.clone(),
            offsets: self.offsets.clone(),
            edge_offsets: self.edges.offsets.clone(),
            stretch_ratios: self.stretch_ratios.clone(),
        }
    }

    /// Continues from `state`. Returns false and changes nothing where it is of another body or cloth.
    pub fn restore(&mut self, state: &BodyContactState) -> bool {
        let fits = state.fits(self.positions.len(), self.stretch_ratios.len());
        if fits {
            self.positions.clone_from(&state.positions);
            self.normals = point_normals(&self.positions, &self.triangles);
            self.offsets.clone_from(&state.offsets);
            self.edges.offsets.clone_from(&state.edge_offsets);
            self.stretch_ratios.clone_from(&state.stretch_ratios);
            self.clear_caches();
        }
        fits
    }

    /// Drops what is kept for speed alone: the hierarchy is refitted as the body moves, and which of two equally near positions is found first
    /// depends on its history.
    pub fn clear_caches(&mut self) {
        self.bvh = TriangleBvh::new(&self.positions, &self.triangles, 0.0);
    }

    /// Starts a step with the cloth at `x` [m], of triangles `cloth` and their `topology`: finds the footpoints of points that are not `fixed`
    /// (one flag per point; empty for none).
    pub fn begin_step(&mut self, x: &[Vec3], cloth: &[[PointIndex; 3]], topology: &Topology, fixed: &[bool]) {
        let is_fixed = |p: usize| fixed.get(p).copied().unwrap_or(false);
        let body = BodySurface {
            x: &self.positions,
            normals: &self.normals,
            triangles: &self.triangles,
            bvh: &self.bvh,
        };
        self.edges.begin_step(x, cloth, topology, &is_fixed, body);
        let find = |(p, x): (usize, &Vec3)| {
            if is_fixed(p) {
                return None;
            }
            let nearest = self.bvh.nearest(&self.positions, *x, TUNING.body.search_distance)?;
            let weights = nearest.weights();
            let (position, normal) = self.surface(&self.positions, &self.normals, nearest.triangle, &weights);
            Some(Footpoint {
                triangle: nearest.triangle,
                weights,
                position,
                gap: normal.dot(&(x - position)),
            })
        };
        self.footpoints = x.par_iter().enumerate().map(find).collect();
        self.covered.fill(false);
        for footpoint in self.footpoints.iter().flatten() {
            self.triangles[footpoint.triangle as usize].iter().for_each(|p| self.covered[p.at()] = true);
        }
        // Normals there need their neighbours.
        let near: Vec<usize> = (0..self.triangles.len())
            .filter(|f| self.triangles[*f].iter().any(|p| self.covered[p.at()]))
            .collect();
        for f in near {
            self.triangles[f].iter().for_each(|p| self.covered[p.at()] = true);
        }
    }

    /// Returns whether the body is near the point `p` of the cloth in this step.
    pub fn is_near(&self, p: usize) -> bool {
        self.footpoints[p].is_some()
    }

    /// Returns outward unit normals with the body at `target` [m], one per point.
    pub fn normals(&self, target: &[Vec3]) -> Vec<Vec3> {
        point_normals(target, &self.triangles)
    }

    /// Returns position and unit normal of the surface at barycentric coordinates of a triangle.
    fn surface(&self, points: &[Vec3], normals: &[Vec3], triangle: u32, weights: &[f64; 3]) -> (Vec3, Vec3) {
        let corners = self.triangles[triangle as usize].map(PointIndex::at);
        let (mut position, mut normal) = (Vec3::zeros(), Vec3::zeros());
        for (corner, weight) in corners.iter().zip(weights) {
            position += points[*corner] * *weight;
            normal += normals[*corner] * *weight;
        }
        (position, normal.try_normalize(1e-9).unwrap_or_else(Vec3::y))
    }

    /// Returns the planes under the cloth, which began at `x` [m], at the end of a step of `h` seconds that moves the body to `target` [m] with
    /// `normals`. `friction_scale` multiplies the friction coefficient [-].
    pub fn plane_contacts(
        &self,
        x: &[Vec3],
        target: &[Vec3],
        normals: &[Vec3],
        h: f64,
        friction_scale: f64,
    ) -> Vec<PlaneContact> {
        let settings = &self.settings;
        let slip_tol = slip_tolerance(settings.slip_velocity_tol, h);
        let contact = |(p, footpoint): (usize, &Option<Footpoint>)| {
            let footpoint = (*footpoint)?;
            let (anchor, normal) = self.surface(target, normals, footpoint.triangle, &footpoint.weights);
            let dhat = settings.point_dhat[p] + self.offsets[p];
            let stiffness = settings.stiffness * settings.areas[p];
            // At most the depth of a point at rest: friction must not hold a point that starts deep inside.
            let depth = (dhat - footpoint.gap).clamp(0.0, dhat);
            Some(PlaneContact {
                point: p as u32,
                anchor,
                normal,
                dhat,
                stiffness,
                stick_point: x[p] + (anchor - footpoint.position),
                max_friction: friction_scale * settings.friction * stiffness * depth,
                slip_tol,
                stretch: self.stretch_ratios[p] * slip_tol,
            })
        };
        self.footpoints.par_iter().enumerate().filter_map(contact).collect()
    }

    /// Returns the contacts of the body's points and edges with the cloth over them, for a step that moves the body to `target` [m] with
    /// `normals`. In a self fold there are none: what is over one side is under the other.
    pub fn edge_contacts(&self, target: &[Vec3], normals: &[Vec3]) -> Vec<EdgeContact> {
        self.edges.edge_contacts(target, normals, self.self_fold.flags(), &self.settings)
    }

    /// Goes back to the contacts of the body's points and edges of the beginning of the step, for another attempt at it.
    pub fn restart_edges(&mut self) {
        self.edges.restart();
    }

    /// Returns the contacts of the body's points and edges, where with `cloth` and
    /// the body at `target` [m] with `normals` the `pairs` of [`Self::open_pairs`] intersect although there were `contacts`: with those
    /// that were missing, and from farther away where they were too weak. `None` where that changes nothing.
    pub fn revised_edge_contacts(
        &mut self,
        cloth: ClothSurface,
        target: &[Vec3],
        normals: &[Vec3],
        contacts: &[EdgeContact],
        mut pairs: Vec<[u32; 2]>,
    ) -> Option<Vec<EdgeContact>> {
        // Cloth that has no footpoint is out of reach of the contacts of this step.
        pairs.retain(|[f, _]| cloth.triangles[*f as usize].iter().any(|p| self.is_near(p.at())));
        if pairs.is_empty() {
            return None;
        }
        let body = BodySurface { x: target, normals, triangles: &self.triangles, bvh: &self.bvh };
        let is_changed = self.edges.revise(cloth, body, &pairs, contacts, &self.settings);
        is_changed.then(|| self.edge_contacts(target, normals))
    }

    /// Returns the intersecting pairs of triangles of `cloth` at `x` and of the body at `target` [m] away from where the body folds into itself.
    pub fn open_pairs(&mut self, x: &[Vec3], cloth: &[[PointIndex; 3]], target: &[Vec3]) -> Vec<[u32; 2]> {
        let mut pairs = self.intersections.pairs([(x, cloth), (target, &self.triangles)]).to_vec();
        let mut near_fold = self.near_self_fold(target, &pairs).into_iter();
        pairs.retain(|_| near_fold.next() == Some(false));
        pairs
    }

    /// Returns `target` [m] with the two sides of each self fold under cloth moved apart, so that the cloth between them fits.
    pub fn resolve_self_contact(&mut self, target: &[Vec3]) -> Vec<Vec3> {
        let normals = point_normals(target, &self.triangles);
        self.bvh.refit(target, target, 0.0);
        let body = BodySurface { x: target, normals: &normals, triangles: &self.triangles, bvh: &self.bvh };
        let min_gap = TUNING.body.self_fold_gap * self.settings.mean_point_dhat();
        self.self_fold.resolve(body, &self.covered, min_gap)
    }

    /// Returns the displacement of each point of the cloth at `x` [m] that is carried along as the body moves to `target` [m], with the surface
    /// under it, as a rigid piece; `None` for a point without a surface under it.
    pub fn carried_displacement(&self, x: &[Vec3], target: &[Vec3]) -> Vec<Option<Vec3>> {
        let carried = |(x, footpoint): (&Vec3, &Option<Footpoint>)| {
            let footpoint = footpoint.as_ref()?;
            let corners = self.triangles[footpoint.triangle as usize].map(PointIndex::at);
            let (from, to) = (frame(&self.positions, corners)?, frame(target, corners)?);
            let goal: Vec3 = corners.iter().zip(&footpoint.weights).map(|(c, w)| target[*c] * *w).sum();
            let height = x - footpoint.position;
            Some(goal + to * from.transpose() * height - x)
        };
        x.par_iter().zip(&self.footpoints).map(carried).collect()
    }

    /// Per triangle of the body in `pairs` with those of the cloth: whether it is within [`SELF_FOLD_MARGIN`] of a self fold, with the body
    /// at `x` [m].
    fn near_self_fold(&self, x: &[Vec3], pairs: &[[u32; 2]]) -> Vec<bool> {
        let fold = self.self_fold.positions(x);
        let is_near = |[_, f]: &[u32; 2]| {
            let corners = self.triangles[*f as usize].map(|p| x[p.at()]);
            corners.iter().any(|at| fold.iter().any(|f| (f - at).norm() < SELF_FOLD_MARGIN))
        };
        pairs.iter().map(is_near).collect()
    }

    /// Raises the offsets of the points of the cloth's triangles that intersect the body at the end of a step, and lets others decay if the body
    /// `moves`. Returns the numbers of pairs that intersect.
    pub fn raise_offsets(&mut self, x: &[Vec3], cloth: &[[PointIndex; 3]], moves: bool) -> BodyIntersections {
        let pairs = self.intersections.pairs([(x, cloth), (&self.positions, &self.triangles)]).to_vec();
        // In a self fold cloth cannot be offset.
        let is_folded = |f: u32| self.self_fold.has_corner_of(&self.triangles[f as usize]);
        let near_fold = self.near_self_fold(&self.positions, &pairs);
        let mut intersects = vec![false; x.len()];
        let (mut open, mut sum) = (0, Vec3::zeros());
        let found = pairs.iter().zip(near_fold).filter(|([_, of_body], _)| !is_folded(*of_body));
        for ([of_cloth, _], near_fold) in found {
            if !near_fold {
                open += 1;
                sum += x[cloth[*of_cloth as usize][0].at()];
            }
            cloth[*of_cloth as usize].iter().for_each(|p| intersects[p.at()] = true);
        }
        let over_fold = |p: usize| self.footpoints[p].is_some_and(|footpoint| is_folded(footpoint.triangle));
        for (p, offset) in self.offsets.iter_mut().enumerate() {
            let [step, max_offset] = [TUNING.body.offset_step, TUNING.body.max_offset]
                .map(|factor| factor * self.settings.point_dhat[p]);
            if over_fold(p) {
                *offset = (*offset - step).max(0.0);
            } else if intersects[p] {
                *offset = (*offset + step).min(max_offset);
            } else if moves {
                *offset *= 1.0 - TUNING.body.offset_decay;
            }
        }
        BodyIntersections { open, self_fold: pairs.len() - open, position: sum / open.max(1) as f64 }
    }

    /// Returns whether the body moves in a step that ends with it at `target` [m].
    pub fn moves_to(&self, target: &[Vec3]) -> bool {
        target.len() == self.positions.len() && target != self.positions
    }

    /// Accepts the step with the cloth at `x` and the body at `target` [m]; `planes` and `edges` were the contacts of the step. Returns whether
    /// the body has moved in it.
    pub fn end_step(
        &mut self,
        x: &[Vec3],
        target: &[Vec3],
        planes: &[PlaneContact],
        edges: &[EdgeContact],
    ) -> bool {
        self.edges.end_step(x, edges, &self.settings);
        self.stretch_ratios.fill(Vec3::zeros());
        for c in planes.iter().filter(|c| c.max_friction > 0.0 && c.gap(&x[c.point as usize]) < c.dhat) {
            let ratio = c.stretch_at(&x[c.point as usize]) / c.slip_tol;
            self.stretch_ratios[c.point as usize] = ratio / ratio.norm().max(1.0);
        }
        let moved = self.moves_to(target);
        if moved {
            self.positions.copy_from_slice(target);
            self.normals = point_normals(target, &self.triangles);
        }
        self.bvh.refit(&self.positions, &self.positions, 0.0);
        moved
    }

    /// Returns the deepest point of the cloth at `x` [m] under its own plane; `None` where all are outside.
    pub fn deepest_penetration(x: &[Vec3], planes: &[PlaneContact]) -> Option<Penetration> {
        let pushing = planes.iter().filter(|c| c.stiffness > 0.0);
        let depths = pushing.map(|c| Penetration { point: c.point, depth: -c.gap(&x[c.point as usize]) });
        depths.filter(|p| p.depth > 0.0).max_by(|a, b| a.depth.total_cmp(&b.depth))
    }
}

/// Returns right-handed axes of a triangle: along its first edge, along its normal, and across both; `None` where it has no area.
fn frame(points: &[Vec3], [a, b, c]: [usize; 3]) -> Option<Mat3> {
    let along = (points[b] - points[a]).try_normalize(0.0)?;
    let normal = along.cross(&(points[c] - points[a])).try_normalize(0.0)?;
    Some(Mat3::from_columns(&[along, normal, along.cross(&normal)]))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::{Energy, PlaneContacts};

    fn plate() -> (Vec<Vec3>, Vec<[PointIndex; 3]>) {
        let points = [[-1.0, 0.0, -1.0], [1.0, 0.0, -1.0], [1.0, 0.0, 1.0], [-1.0, 0.0, 1.0]].map(Vec3::from);
        (points.to_vec(), [[0, 2, 1], [0, 3, 2]].map(|t| t.map(PointIndex)).to_vec())
    }

    fn settings() -> BodyContactSettings {
        BodyContactSettings {
            point_dhat: vec![1e-3; 2],
            edge_dhat: 5e-4,
            stiffness: 1e6,
            areas: vec![1e-4; 2],
            friction: 0.5,
            slip_velocity_tol: 1e-3,
        }
    }

    fn body() -> BodyPlanes {
        let (points, triangles) = plate();
        BodyPlanes::new(&points, &triangles, settings())
    }

    #[test]
    fn a_fast_body_does_not_get_past_its_cloth() {
        let mut body = body();
        let x = [Vec3::new(0.1, 0.0005, 0.2), Vec3::new(0.3, 0.5, 0.0)];
        body.begin_step(&x, &[], &Topology::new(2, &[]), &[]);
        // Upwards by twenty times d-hat and sideways by thirty.
        let target: Vec<Vec3> = body.points().iter().map(|p| p + Vec3::new(0.03, 0.02, 0.0)).collect();
        let contacts = body.plane_contacts(&x, &target, &body.normals(&target), 0.1, 1.0);
        assert_eq!(contacts.len(), 1, "the other is far");
        assert!((contacts[0].gap(&x[0]) + 0.0195).abs() < 1e-15, "it is inside by what the body moved");
        let mut g = [Vec3::zeros(); 2];
        PlaneContacts(&contacts).add_gradient(&x, &mut g);
        assert!(
            g[0].y < 0.0 && g[0].x < 0.0 && g[1] == Vec3::zeros(),
            "pushed out and dragged along: {}",
            g[0]
        );
        assert!((contacts[0].stick_point - (x[0] + Vec3::new(0.03, 0.02, 0.0))).norm() < 1e-15);
    }

    /// Two plates that face each other, near, then laid through each other; and the far side of a plate with two sides.
    #[test]
    fn the_sides_of_a_self_fold_are_moved_apart() {
        let (low, mut triangles) = plate();
        let high = low.iter().map(|p| p + 0.02 * Vec3::y());
        let points: Vec<Vec3> = low.iter().copied().chain(high).collect();
        triangles.extend([[4, 5, 6], [4, 6, 7]].map(|t| t.map(PointIndex)));
        let x = [Vec3::new(0.1, 0.0005, 0.2), Vec3::new(-0.1, 0.0005, -0.2)];
        let heights = |height: f64, turned: bool| {
            let mut triangles = triangles.clone();
            if turned {
                triangles.iter_mut().for_each(|t| t.swap(0, 1));
            }
            let mut body = BodyPlanes::new(&points, &triangles, settings());
            body.begin_step(&x, &[], &Topology::new(2, &[]), &[]);
            let mut target = points.clone();
            target[4..].iter_mut().for_each(|p| p.y = height);
            body.resolve_self_contact(&target)[0].y
        };
        assert_eq!(heights(0.02, false), 0.0, "wide open");
        assert!((heights(0.004, false) + 0.0005).abs() < 1e-15, "half of what is missing to 5 mm");
        assert!(
            (heights(-0.01, false) + 0.0075).abs() < 1e-15,
            "through each other: {}",
            heights(-0.01, false)
        );
        assert_eq!(heights(0.004, true), 0.0, "the far side of a thin part");
    }

    #[test]
    fn the_kept_stretch_is_that_of_a_sticking_contact() {
        let mut body = body();
        let x = [Vec3::new(0.1, 0.0005, 0.2), Vec3::new(0.3, 0.5, 0.0)];
        let target = body.points().to_vec();
        body.begin_step(&x, &[], &Topology::new(2, &[]), &[]);
        let contacts = body.plane_contacts(&x, &target, &body.normals(&target), 0.1, 1.0);
        let half = Vec3::new(0.5 * contacts[0].slip_tol, 0.0, 0.0);
        body.end_step(&[x[0] + half, x[1]], &target, &contacts, &[]);
        assert!((body.stretch_ratios[0] - Vec3::new(0.5, 0.0, 0.0)).norm() < 1e-12);
        body.end_step(&[x[0] + half * 9.0, x[1]], &target, &contacts, &[]);
        assert!((body.stretch_ratios[0] - Vec3::x()).norm() < 1e-12);
        body.begin_step(&x, &[], &Topology::new(2, &[]), &[true, false]);
        assert!(
            body.plane_contacts(&x, &target, &body.normals(&target), 0.1, 1.0).is_empty(),
            "fixed points have no contacts"
        );
    }
}
