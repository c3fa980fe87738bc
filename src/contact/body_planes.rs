//! A body that cloth rests on, seen from one side: every point of the cloth meets the surface it is nearest to.
//!
//! [`crate::contact::Body`] lets cloth and body share one guarantee: no triangle of either ever crosses the other. An elbow breaks
//! it: where skin folds into itself there is no room for cloth, the arm is held up by its sleeve, and every step is a struggle
//! (`docs/validation/bodies.md` has the figures). Here the body goes where it is told, whatever is in between. At the beginning of a step
//! each point of cloth is given the place of the surface nearest to it; where that place is at the end of the step, with its
//! normal, is a plane that the point rests on (`energy::PlaneContact`). Surface and cloth are followed together, so a fast
//! body does not get past its cloth; a point that is inside, by a fault of the file or caught in a crease, is pushed out.
//!
//! Where the body folds into itself (an elbow's crease) real flesh gives way and a skinned one does not: its two sides would
//! press the cloth between them to nothing. There both are flattened ([`BodyPlanes::resolve_self_contact`]).
//!
//! Points alone do not keep triangles out: between three points outside a corner of the body would still poke through. So its
//! points and edges hold up the cloth over them, too (`contact::body_support`). Where cloth is found to cross the body after a step all the
//! same its points are lifted higher over it, step by step until it no longer does ([`BodyPlanes::raise_offsets`]).
//!
//! Friction is that of `contact::friction`: Coulomb, with a tangential stretch kept from step to step. Does not do:
//! a promise; cloth may cross a body for the moments until it is lifted, and where there is no room for it.

use crate::contact::body_edges::BodyEdges;
use crate::contact::friction::stick;
use crate::energy::{EdgeContact, PlaneContact};
use crate::math::{Mat3, Vec3};
use crate::mesh::intersections::intersections_between;
use crate::mesh::point_in_solid::point_normals;
use crate::mesh::triangle_bvh::TriangleBvh;
use crate::mesh::{PointIndex, Topology};
use rayon::prelude::*;
use serde::{Deserialize, Serialize};

/// Surface farther from a point than this does not matter in a step [m].
const SEARCH: f64 = 0.03;

/// How far a body may fold into itself [m].
const FOLDED: f64 = 0.03;
/// Two parts face each other when the cosine between their normals is below this.
const FACING: f64 = -0.2;
/// What is within this of where it lies on itself counts as its fold, too [m]: cloth that is caught there reaches as far.
pub const SELF_FOLD_MARGIN: f64 = 0.015;
/// Room between two parts of a body that lie on each other, in reaches: two layers on each, and one to move.
const LAYERS: f64 = 5.0;

/// Cloth that crosses the body is lifted by this share of the reach in each step [-],
const RISE: f64 = 0.25;
/// to at most this many reaches,
const HIGHEST: f64 = 6.0;
/// and sinks by this share of its lift in each step in which the body moves on and it does not cross.
pub(super) const SINKING: f64 = 0.02;

/// A body and what the cloth has to do with it.
pub struct BodyPlanes {
    triangles: Vec<[PointIndex; 3]>,
    tree: TriangleBvh,
    /// Where nothing of it is folded into itself [m]: as its file has it, with normals.
    open: Vec<Vec3>,
    open_normals: Vec<Vec3>,
    /// At the beginning of the step [m], with normals.
    now: Vec<Vec3>,
    normals: Vec<Vec3>,
    settings: BodyContactSettings,
    /// Per point: whether it is near what lies under cloth in this step.
    covered: Vec<bool>,
    /// Per point: whether the body lies on itself there, when last asked.
    folded: Vec<bool>,
    /// Per point of the cloth: what is under it in this step.
    under: Vec<Option<Under>>,
    /// Its points and edges under triangles and edges of the cloth.
    support: BodyEdges,
    /// Per point of the cloth: how much higher than the reach it is held [m].
    lifted: Vec<f64>,
    /// Per point of the cloth: tangential stretch as a share of what sticks.
    kept: Vec<Vec3>,
}

/// What a [`BodyPlanes`] keeps from step to step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyContactState {
    /// Where the body is, one per point [m].
    #[serde(with = "crate::math::serde_vec::vectors")]
    now: Vec<Vec3>,
    /// How much higher than the reach it is held, per point of the cloth [m].
    lifted: Vec<f64>,
    /// How much higher than its reach it holds cloth up, per point of the body [m].
    raised: Vec<f64>,
    /// Tangential stretch as a share of what sticks, per point of the cloth.
    #[serde(with = "crate::math::serde_vec::vectors")]
    stretch: Vec<Vec3>,
}

impl BodyContactState {
    /// Whether it is of a body and a cloth of so many points.
    pub fn fits(&self, body: usize, cloth: usize) -> bool {
        [self.now.len(), self.raised.len()] == [body; 2]
            && [self.lifted.len(), self.stretch.len()] == [cloth; 2]
    }
}

/// How a body pushes.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyContactSettings {
    /// Activation distance of points of the cloth on its surface [m].
    pub point_dhat: f64,
    /// Activation distance of its points and edges on triangles and edges of the cloth [m].
    pub edge_dhat: f64,
    /// [Pa/m].
    pub stiffness: f64,
    /// Per point of the cloth: its area [m²].
    pub areas: Vec<f64>,
    /// Friction coefficient.
    pub friction: f64,
    /// A contact gives by up to this times the step before it slides [m/s].
    pub slip_velocity_tol: f64,
}

/// The surface under a point at the beginning of a step.
#[derive(Debug, Clone, Copy)]
struct Under {
    triangle: u32,
    /// Of its corners.
    weights: [f64; 3],
    place: Vec3,
    /// Height over it [m].
    gap: f64,
}

impl BodyPlanes {
    /// A body of `triangles`, at `points` [m] now, under cloth of `cloth_count` points.
    pub fn new(points: &[Vec3], triangles: &[[PointIndex; 3]], settings: BodyContactSettings) -> Self {
        let triangles: Vec<_> =
            triangles.iter().filter(|[a, b, c]| a != b && b != c && c != a).copied().collect();
        let kept = vec![Vec3::zeros(); settings.areas.len()];
        Self {
            tree: TriangleBvh::new(points, &triangles, 0.0),
            normals: point_normals(points, &triangles),
            open_normals: point_normals(points, &triangles),
            open: points.to_vec(),
            now: points.to_vec(),
            covered: vec![false; points.len()],
            folded: vec![false; points.len()],
            under: vec![None; kept.len()],
            support: BodyEdges::new(points, &triangles),
            lifted: vec![0.0; kept.len()],
            triangles,
            settings,
            kept,
        }
    }

    /// Where it is [m], one per point.
    pub fn points(&self) -> &[Vec3] {
        &self.now
    }

    /// Its triangles.
    pub fn triangles(&self) -> &[[PointIndex; 3]] {
        &self.triangles
    }

    /// What the next step depends on, besides the body itself.
    pub fn state(&self) -> BodyContactState {
        BodyContactState {
            now: self.now.clone(),
            lifted: self.lifted.clone(),
            raised: self.support.raised.clone(),
            stretch: self.kept.clone(),
        }
    }

    /// Goes on with what another such field kept; false, and nothing is changed, where it is of another body or cloth.
    pub fn restore(&mut self, kept: &BodyContactState) -> bool {
        let fits = kept.fits(self.now.len(), self.kept.len());
        if fits {
            self.now.clone_from(&kept.now);
            self.normals = point_normals(&self.now, &self.triangles);
            self.lifted.clone_from(&kept.lifted);
            self.support.raised.clone_from(&kept.raised);
            self.kept.clone_from(&kept.stretch);
            self.clear_caches();
        }
        fits
    }

    /// Forgets what is kept for speed alone: the tree grows with the body, and which of two equally near places is found first
    /// depends on how it grew.
    pub fn clear_caches(&mut self) {
        self.tree = TriangleBvh::new(&self.now, &self.triangles, 0.0);
    }

    /// A step begins with the cloth at `x`, of triangles `cloth` and their `topology`: what is under each point that is not `held`
    /// (empty for none).
    pub fn begin_step(&mut self, x: &[Vec3], cloth: &[[PointIndex; 3]], topology: &Topology, held: &[bool]) {
        let is_held = |p: usize| held.get(p).copied().unwrap_or(false);
        self.support.begin_step(x, cloth, topology, &is_held, (&self.now, &self.tree, &self.normals));
        let look = |(p, x): (usize, &Vec3)| {
            if is_held(p) {
                return None;
            }
            let nearest = self.tree.nearest(&self.now, *x, SEARCH)?;
            // From the closest place to the point: weights 1, -wa, -wb, -wc.
            let [_, a, b, c] = nearest.gap.weights;
            let weights = [-a, -b, -c];
            let (place, normal) = self.surface(&self.now, &self.normals, nearest.triangle, &weights);
            Some(Under { triangle: nearest.triangle, weights, place, gap: normal.dot(&(x - place)) })
        };
        self.under = x.par_iter().enumerate().map(look).collect();
        self.covered.fill(false);
        for under in self.under.iter().flatten() {
            self.triangles[under.triangle as usize].iter().for_each(|p| self.covered[p.at()] = true);
        }
        // Normals there need their neighbours.
        let near: Vec<usize> = (0..self.triangles.len())
            .filter(|f| self.triangles[*f].iter().any(|p| self.covered[p.at()]))
            .collect();
        for f in near {
            self.triangles[f].iter().for_each(|p| self.covered[p.at()] = true);
        }
    }

    /// What of the body's points and edges is under the cloth, for a step that leads the body to `target` with `normals`. Where
    /// it lies on itself there is none: what is over one side is under the other.
    pub fn edge_contacts(&self, target: &[Vec3], normals: &[Vec3]) -> Vec<EdgeContact> {
        self.support.edge_contacts(target, normals, &self.folded, &self.settings)
    }

    /// Outward unit normals with the body at `target`, one per point.
    pub fn normals(&self, target: &[Vec3]) -> Vec<Vec3> {
        point_normals(target, &self.triangles)
    }

    fn surface(&self, points: &[Vec3], normals: &[Vec3], triangle: u32, weights: &[f64; 3]) -> (Vec3, Vec3) {
        let corners = self.triangles[triangle as usize].map(PointIndex::at);
        let (mut place, mut normal) = (Vec3::zeros(), Vec3::zeros());
        for (corner, weight) in corners.iter().zip(weights) {
            place += points[*corner] * *weight;
            normal += normals[*corner] * *weight;
        }
        (place, normal.try_normalize(1e-9).unwrap_or_else(Vec3::y))
    }

    /// What is under the cloth, which began at `x`, at the end of a step of `h` seconds that leads the body to `target` with
    /// `normals`.
    pub fn plane_contacts(
        &self,
        x: &[Vec3],
        target: &[Vec3],
        normals: &[Vec3],
        h: f64,
        friction: f64,
    ) -> Vec<PlaneContact> {
        let BodyContactSettings {
            point_dhat,
            stiffness,
            ref areas,
            friction: coefficient,
            slip_velocity_tol,
            ..
        } = self.settings;
        let slip = stick(slip_velocity_tol, h);
        let each = |(p, under): (usize, &Option<Under>)| {
            let under = (*under)?;
            let (place, normal) = self.surface(target, normals, under.triangle, &under.weights);
            let reach = point_dhat + self.lifted[p];
            let stiffness = stiffness * areas[p];
            // Pressed as deep as it may be at rest: a point that starts inside must not be nailed down there.
            let press = (reach - under.gap).clamp(0.0, reach);
            Some(PlaneContact {
                point: p as u32,
                anchor: place,
                normal,
                dhat: reach,
                stiffness,
                stick_point: x[p] + (place - under.place),
                max_friction: friction * coefficient * stiffness * press,
                slip_tol: slip,
                stretch: self.kept[p] * slip,
            })
        };
        self.under.par_iter().enumerate().filter_map(each).collect()
    }

    /// `target` with its flesh flattened where the body lies on itself: there both sides give way, half each, so far that the cloth
    /// between them has room. Only parts that face each other across air where the body is open count, not the far side of a
    /// hand; only what lies under cloth is looked at.
    pub fn resolve_self_contact(&mut self, target: &[Vec3]) -> Vec<Vec3> {
        let normals = point_normals(target, &self.triangles);
        self.tree.refit(target, target, 0.0);
        let triangle_normals: Vec<Vec3> = self
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|p| target[p.at()]);
                (b - a).cross(&(c - a)).try_normalize(0.0).unwrap_or_else(Vec3::zeros)
            })
            .collect();
        let need = LAYERS * self.settings.point_dhat;
        let give = |(p, at): (usize, &Vec3)| {
            if !self.covered[p] {
                return *at;
            }
            let facing = |f: u32| {
                triangle_normals[f as usize].dot(&normals[p]) < FACING
                    && (self.open[self.triangles[f as usize][0].at()] - self.open[p])
                        .dot(&self.open_normals[p])
                        > 0.0
            };
            let Some(nearest) = self.tree.nearest_where(target, *at, FOLDED, facing) else { return *at };
            let other = triangle_normals[nearest.triangle as usize];
            let height = (at - target[self.triangles[nearest.triangle as usize][0].at()]).dot(&other);
            if height < need { at + other * (0.5 * (need - height).min(2.0 * FOLDED)) } else { *at }
        };
        let flattened: Vec<Vec3> = target.par_iter().enumerate().map(give).collect();
        self.folded.iter_mut().zip(target.iter().zip(&flattened)).for_each(|(f, (a, b))| *f = a != b);
        flattened
    }

    /// Where the body takes the cloth along on its way to `target`: with the surface under it, as a rigid piece, less and
    /// less with the height over it. One move per point [m].
    pub fn carried_displacement(&self, x: &[Vec3], target: &[Vec3]) -> Vec<Vec3> {
        let each = |(x, under): (&Vec3, &Option<Under>)| {
            let Some(under) = under else { return Vec3::zeros() };
            let corners = self.triangles[under.triangle as usize].map(PointIndex::at);
            let (Some(from), Some(to)) = (frame(&self.now, corners), frame(target, corners)) else {
                return Vec3::zeros();
            };
            let goal: Vec3 = corners.iter().zip(&under.weights).map(|(c, w)| target[*c] * *w).sum();
            let far = ((x - under.place).norm() / SEARCH).clamp(0.0, 1.0);
            let share = (2.0 - 2.0 * far).min(1.0);
            (goal + to * from.transpose() * (x - under.place) - x) * share
        };
        x.par_iter().zip(&self.under).map(each).collect()
    }

    /// Lifts the points of the cloth's triangles that cross the body now, and lets others sink if the body `moves`. The
    /// number of pairs of triangles that cross: where the body is open, and where it lies on itself or within [`SELF_FOLD_MARGIN`] of that.
    pub fn raise_offsets(&mut self, x: &[Vec3], cloth: &[[PointIndex; 3]], moves: bool) -> [usize; 2] {
        let crossing = intersections_between(x, cloth, &self.now, &self.triangles);
        // Where the body lies on itself there is no room to lift cloth into.
        let folded = |f: u32| self.triangles[f as usize].iter().any(|p| self.folded[p.at()]);
        let open = crossing.iter().filter(|[_, of_body]| !folded(*of_body));
        let fold: Vec<Vec3> =
            self.now.iter().zip(&self.folded).filter(|(_, folded)| **folded).map(|(at, _)| *at).collect();
        let near_fold = |f: u32| {
            let corners = self.triangles[f as usize].map(|p| self.now[p.at()]);
            corners.iter().any(|at| fold.iter().any(|f| (f - at).norm() < SELF_FOLD_MARGIN))
        };
        let mut crosses = vec![false; x.len()];
        let mut count = 0;
        for [of_cloth, of_body] in open {
            count += usize::from(!near_fold(*of_body));
            cloth[*of_cloth as usize].iter().for_each(|p| crosses[p.at()] = true);
        }
        let over_fold = |p: usize| self.under[p].is_some_and(|under| folded(under.triangle));
        let (rise, highest) = (RISE * self.settings.point_dhat, HIGHEST * self.settings.point_dhat);
        for (p, lifted) in self.lifted.iter_mut().enumerate() {
            if over_fold(p) {
                *lifted = (*lifted - rise).max(0.0);
            } else if crosses[p] {
                *lifted = (*lifted + rise).min(highest);
            } else if moves {
                *lifted *= 1.0 - SINKING;
            }
        }
        [count, crossing.len() - count]
    }

    /// The step is over with the cloth at `x` and the body at `target`; `cushions` and `supports` were those of the step.
    /// Whether the body has moved in it.
    pub fn accept(
        &mut self,
        x: &[Vec3],
        target: &[Vec3],
        cushions: &[PlaneContact],
        supports: &[EdgeContact],
    ) -> bool {
        self.support.accept(x, supports, &self.settings);
        self.kept.fill(Vec3::zeros());
        for c in cushions.iter().filter(|c| c.max_friction > 0.0 && c.gap(&x[c.point as usize]) < c.dhat) {
            let share = c.stretch_at(&x[c.point as usize]) / c.slip_tol;
            self.kept[c.point as usize] = share / share.norm().max(1.0);
        }
        let moved = target.len() == self.now.len() && target != self.now;
        if moved {
            self.now.copy_from_slice(target);
            self.normals = point_normals(target, &self.triangles);
        }
        self.tree.refit(&self.now, &self.now, 0.0);
        moved
    }

    /// The deepest point of the cloth at `x` under its own plane, and how deep [m].
    pub fn deepest_penetration(x: &[Vec3], cushions: &[PlaneContact]) -> Option<(u32, f64)> {
        let pushing = cushions.iter().filter(|c| c.stiffness > 0.0);
        let depths = pushing.map(|c| (c.point, -c.gap(&x[c.point as usize])));
        depths.filter(|(_, depth)| *depth > 0.0).max_by(|a, b| a.1.total_cmp(&b.1))
    }
}

/// Right-handed axes of a triangle: along its first edge, along its normal.
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
            point_dhat: 1e-3,
            edge_dhat: 5e-4,
            stiffness: 1e6,
            areas: vec![1e-4; 2],
            friction: 0.5,
            slip_velocity_tol: 1e-3,
        }
    }

    fn field() -> BodyPlanes {
        let (points, triangles) = plate();
        BodyPlanes::new(&points, &triangles, settings())
    }

    #[test]
    fn a_fast_body_does_not_get_past_its_cloth() {
        let mut field = field();
        let x = [Vec3::new(0.1, 0.0005, 0.2), Vec3::new(0.3, 0.5, 0.0)];
        field.begin_step(&x, &[], &Topology::new(2, &[]), &[]);
        // Upwards by twenty times the reach and sideways by thirty.
        let target: Vec<Vec3> = field.points().iter().map(|p| p + Vec3::new(0.03, 0.02, 0.0)).collect();
        let cushions = field.plane_contacts(&x, &target, &field.normals(&target), 0.1, 1.0);
        assert_eq!(cushions.len(), 1, "the other is far");
        assert!((cushions[0].gap(&x[0]) + 0.0195).abs() < 1e-15, "it is inside by what the body moved");
        let mut g = [Vec3::zeros(); 2];
        PlaneContacts(&cushions).add_gradient(&x, &mut g);
        assert!(
            g[0].y < 0.0 && g[0].x < 0.0 && g[1] == Vec3::zeros(),
            "pushed out and dragged along: {}",
            g[0]
        );
        assert!((cushions[0].stick_point - (x[0] + Vec3::new(0.03, 0.02, 0.0))).norm() < 1e-15);
    }

    /// Two plates that face each other, near, then laid through each other; and the far side of a plate with two sides.
    #[test]
    fn a_fold_of_the_body_makes_room_for_the_cloth() {
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
            let mut field = BodyPlanes::new(&points, &triangles, settings());
            field.begin_step(&x, &[], &Topology::new(2, &[]), &[]);
            let mut target = points.clone();
            target[4..].iter_mut().for_each(|p| p.y = height);
            field.resolve_self_contact(&target)[0].y
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
    fn what_stretch_is_kept_is_what_sticks() {
        let mut field = field();
        let x = [Vec3::new(0.1, 0.0005, 0.2), Vec3::new(0.3, 0.5, 0.0)];
        let target = field.points().to_vec();
        field.begin_step(&x, &[], &Topology::new(2, &[]), &[]);
        let cushions = field.plane_contacts(&x, &target, &field.normals(&target), 0.1, 1.0);
        let half = Vec3::new(0.5 * cushions[0].slip_tol, 0.0, 0.0);
        field.accept(&[x[0] + half, x[1]], &target, &cushions, &[]);
        assert!((field.kept[0] - Vec3::new(0.5, 0.0, 0.0)).norm() < 1e-12);
        field.accept(&[x[0] + half * 9.0, x[1]], &target, &cushions, &[]);
        assert!((field.kept[0] - Vec3::x()).norm() < 1e-12);
        field.begin_step(&x, &[], &Topology::new(2, &[]), &[true, false]);
        assert!(
            field.plane_contacts(&x, &target, &field.normals(&target), 0.1, 1.0).is_empty(),
            "held points meet nothing"
        );
    }
}
