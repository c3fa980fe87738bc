//! Terms that depend on who is near: candidates, response, friction, and the bound that keeps layers apart.
//!
//! The promise: if no two triangles of the cloth cross at the start of a step, none do at any position the solver accepts;
//! what crosses at the start never becomes more (`contact::initial_intersections`).
//! It is kept by [`Contact::limit_displacement`], which cuts every move short of the first touch by continuous collision
//! detection; the barrier makes such cuts rare, and friction rides on the barrier's forces.
//! The ground is the half space y >= height, seen by points only. A body of triangles is met from one side ([`BodyPlanes`]).

mod barrier;
mod body_edges;
mod body_planes;
pub mod broad_phase;
mod collision_set;
mod friction;
mod initial_intersections;
pub mod step_bounds;
mod uncovered_area;

pub use body_planes::{BodyContactSettings, BodyContactState, BodyPlanes, SELF_FOLD_MARGIN};

use crate::contact::collision_set::{PairContact, Touch};
use crate::energy::BlockSink;
use crate::fabric::Fabric;
use crate::math::{Mat3, Vec3};
use crate::mesh::{PointIndex, Topology};
pub use friction::TangentialState;
use friction::{Friction, FrictionContact, spread};
use std::sync::Arc;

/// What contact there is in a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSettings {
    /// Activation distance d-hat of the barrier [m]: cloth nearer to cloth than this is pushed apart. The thickness of one layer.
    pub dhat: f64,
    /// Stiffness per area [N/m³]: pressure per metre of approach.
    pub stiffness: f64,
    /// Friction coefficient, cloth on cloth.
    pub friction: f64,
    /// Friction coefficient, cloth on ground.
    pub friction_ground: f64,
    /// Friction coefficient, cloth on body.
    pub friction_body: f64,
    /// What a contact that sticks bears, as a multiple of what it bears while it slides; 1 for plain Coulomb friction.
    pub static_ratio: f64,
    /// A contact gives by up to this times the step before it slides [m/s].
    pub slip_velocity_tol: f64,
    /// Whether cloth can meet cloth.
    pub self_contact: bool,
}

impl ContactSettings {
    /// Cloth of `fabric`: plain Coulomb friction by its coefficients, that of the ground on a body, too. `dhat` [m], `stiffness`
    /// [N/m³]; `self_contact`: whether cloth can meet cloth.
    pub fn for_fabric(fabric: &Fabric, dhat: f64, stiffness: f64, self_contact: bool) -> Self {
        Self {
            friction: fabric.friction,
            friction_ground: fabric.friction_ground,
            friction_body: fabric.friction_ground,
            self_contact,
            ..Self::uniform(dhat, stiffness, 0.0)
        }
    }

    /// Cloth that meets itself, the ground and a body with the same coefficient of plain Coulomb `friction`. `dhat` [m], `stiffness`
    /// [N/m³].
    pub fn uniform(dhat: f64, stiffness: f64, friction: f64) -> Self {
        Self {
            dhat,
            stiffness,
            friction,
            friction_ground: friction,
            friction_body: friction,
            static_ratio: 1.0,
            slip_velocity_tol: SLIP_VELOCITY_TOL,
            self_contact: true,
        }
    }
}

/// Default of [`ContactSettings::slip_velocity_tol`] [m/s].
const SLIP_VELOCITY_TOL: f64 = 1e-3;

/// The pair that is nearest for its contact distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TightestPair {
    /// Distance over activation distance.
    pub gap_ratio: f64,
    /// A point between the two primitives [m].
    pub position: Vec3,
}

/// Contact of one garment with itself, the ground and a ceiling.
pub struct Contact {
    settings: ContactSettings,
    /// Per point: area it stands for [m²].
    area: Vec<f64>,
    pairs: Option<PairContact>,
    ground: Option<f64>,
    ceiling: Option<f64>,
    friction: Friction,
}

impl Contact {
    /// Contact for the mesh of `rest` points [m]. `area` per point [m²].
    pub fn new(
        settings: ContactSettings,
        rest: &[Vec3],
        triangles: &[[PointIndex; 3]],
        topology: &Topology,
        area: Vec<f64>,
    ) -> Self {
        let pairs = Some(PairContact::new(&settings, rest, triangles, topology, &area));
        Self { settings, area, pairs, ground: None, ceiling: None, friction: Friction::default() }
    }

    /// No contact at all.
    pub fn none(point_count: usize) -> Self {
        let settings = ContactSettings { self_contact: false, ..ContactSettings::uniform(1e-3, 0.0, 0.0) };
        Self {
            settings,
            area: vec![0.0; point_count],
            pairs: None,
            ground: None,
            ceiling: None,
            friction: Friction::default(),
        }
    }

    /// What contact there is.
    pub fn settings(&self) -> &ContactSettings {
        &self.settings
    }

    /// Puts ground and ceiling at these heights [m], or takes them away.
    pub fn set_planes(&mut self, ground: Option<f64>, ceiling: Option<f64>) {
        self.ground = ground;
        self.ceiling = ceiling;
    }

    /// The cloth has been put somewhere else (its source pose, say), and what crosses there shall stay as it is: nothing
    /// passes, not even what could come apart.
    pub fn freeze_initial_intersections(&mut self) {
        if let Some(pairs) = &mut self.pairs {
            pairs.freeze_initial_intersections();
        }
    }

    /// Forgets what is kept between steps for speed alone.
    pub fn clear_caches(&mut self) {
        if let Some(pairs) = &mut self.pairs {
            pairs.clear_caches();
        }
    }

    /// Distance of a point to the plane and +1 for the ground, -1 for the ceiling [m].
    fn planes(&self) -> impl Iterator<Item = (f64, f64)> + use<> {
        [(self.ground, 1.0), (self.ceiling, -1.0)].into_iter().filter_map(|(h, side)| h.map(|h| (h, side)))
    }

    /// Starts a step of `h` seconds at `x`, before any value is asked for: finds who is near; normal forces for
    /// friction are taken here. Without slip velocity (equilibria) pass an infinite step and there is no friction.
    /// `share` scales the friction coefficients. Points that are `held` do not move during the step: pairs of such
    /// points only do not count.
    pub fn begin_step(&mut self, x: &[Vec3], h: f64, share: f64, held: &[bool]) {
        if let Some(pairs) = &mut self.pairs {
            pairs.begin(x, held);
        }
        let mut friction = std::mem::take(&mut self.friction);
        let stick = friction::stick(self.settings.slip_velocity_tol, h);
        friction.begin(x, stick, self.settings.static_ratio);
        if h.is_finite() && share > 0.0 {
            self.add_sliders(x, share, &mut friction);
        }
        self.friction = friction;
    }

    fn add_sliders(&self, x: &[Vec3], share: f64, friction: &mut Friction) {
        let settings = &self.settings;
        if let (Some(ground), true) = (self.ground, settings.friction_ground > 0.0) {
            for (p, x) in x.iter().enumerate() {
                let force = -barrier::slope(x.y - ground, settings.dhat, self.ground_stiffness(p));
                if force > 0.0 {
                    friction.add(FrictionContact {
                        kind: None,
                        points: [p as u32; 4],
                        weights: [1.0, 0.0, 0.0, 0.0],
                        normal: Vec3::y(),
                        limit: share * settings.friction_ground * force,
                        stretch: Vec3::zeros(),
                    });
                }
            }
        }
        if settings.friction <= 0.0 {
            return;
        }
        for t in self.touches(x).iter() {
            friction.add(FrictionContact {
                kind: Some(t.kind),
                points: t.points,
                weights: t.weights,
                normal: t.normal,
                limit: -share * settings.friction * barrier::slope(t.distance, t.reach, t.stiffness),
                stretch: Vec3::zeros(),
            });
        }
    }

    /// What friction keeps from step to step.
    pub fn friction_state(&self) -> Vec<TangentialState> {
        self.friction.kept()
    }

    /// Goes on with what friction kept.
    pub fn restore_friction_state(&mut self, kept: &[TangentialState]) {
        self.friction.restore(kept);
    }

    /// The step of `h` seconds is accepted at `x`: friction keeps its stretch.
    pub fn accept(&mut self, x: &[Vec3], h: f64) {
        self.friction.accept(x);
        if let Some(pairs) = &mut self.pairs {
            pairs.accept(x, h);
        }
    }

    /// From here on only the points for which `moving` is set move, one flag per point: contacts of all others with one another
    /// are left out of value, gradient and Hessian, and no move is bounded by them.
    pub fn restrict_to(&mut self, x: &[Vec3], moving: &[bool]) {
        if let Some(pairs) = &mut self.pairs {
            pairs.restrict_to(x, moving);
        }
        self.friction.restrict_to(moving);
    }

    /// All points move again, and all contacts count.
    pub fn unrestrict(&mut self) {
        if let Some(pairs) = &mut self.pairs {
            pairs.unrestrict();
        }
        self.friction.unrestrict();
    }

    /// Shortens the moves `d` of single points until the way from `x` to `x + d` (and to every share of it) keeps
    /// all pairs apart. Afterwards values may be asked for anywhere on that way.
    pub fn limit_displacement(&mut self, x: &[Vec3], d: &mut [Vec3]) {
        for (height, side) in self.planes() {
            for (x, d) in x.iter().zip(d.iter_mut()) {
                *d *= self.plane_share(x, d, height, side);
            }
        }
        if let Some(pairs) = &mut self.pairs {
            pairs.limit_displacement(x, d);
        }
    }

    /// The same with one share for all points: the direction stays what it was.
    pub fn limit_displacement_uniform(&mut self, x: &[Vec3], d: &mut [Vec3]) {
        let mut share: f64 = 1.0;
        for (height, side) in self.planes() {
            for (x, d) in x.iter().zip(d.iter()) {
                share = share.min(self.plane_share(x, d, height, side));
            }
        }
        d.iter_mut().for_each(|d| *d *= share);
        if let Some(pairs) = &mut self.pairs {
            pairs.limit_displacement_uniform(x, d);
        }
    }

    /// Moves the cloth by `d`, each point as far as all stay apart and presses no layer below the inner part of its contact
    /// distance. Afterwards values may be asked for at the new positions.
    pub fn carry(&mut self, x: &mut [Vec3], d: &[Vec3]) {
        let mut d = d.to_vec();
        for (height, side) in self.planes() {
            for (x, d) in x.iter().zip(d.iter_mut()) {
                *d *= self.plane_share(x, d, height, side);
            }
        }
        if let Some(pairs) = &mut self.pairs {
            pairs.carry(x, &d);
        }
    }

    /// Share of the move `d` from `x` that stays off a plane.
    fn plane_share(&self, x: &Vec3, d: &Vec3, height: f64, side: f64) -> f64 {
        let (gap, way) = (side * (x.y - height), side * d.y);
        let floor = barrier::floor(gap, self.settings.dhat);
        if way < 0.0 && gap + way < floor { ((gap - floor) / -way).clamp(0.0, 1.0) } else { 1.0 }
    }

    /// Per point: the part of its area that nothing covers from above, as seen from above [m²].
    pub fn uncovered_area(&mut self, x: &[Vec3]) -> Vec<f64> {
        match &mut self.pairs {
            Some(pairs) => pairs.uncovered_area(x),
            None => vec![0.0; x.len()],
        }
    }

    fn touches(&self, x: &[Vec3]) -> Arc<Vec<Touch>> {
        self.pairs.as_ref().map(|pairs| pairs.touches(x)).unwrap_or_default()
    }

    fn ground_stiffness(&self, p: usize) -> f64 {
        self.settings.stiffness * self.area[p]
    }

    /// Energy of all contacts and the dissipation potential of friction [J]; infinite beyond ground or ceiling, and
    /// where more crosses than when the step began.
    pub fn value(&self, x: &[Vec3]) -> f64 {
        let mut sum = 0.0;
        for (height, side) in self.planes() {
            for (p, x) in x.iter().enumerate() {
                let gap = side * (x.y - height);
                if gap <= 0.0 {
                    return f64::INFINITY;
                }
                sum += barrier::value(gap, self.settings.dhat, self.ground_stiffness(p));
            }
        }
        if let Some(pairs) = &self.pairs {
            if pairs.is_worse_at(x) {
                return f64::INFINITY;
            }
            sum += pairs
                .touches(x)
                .iter()
                .map(|t| barrier::value(t.distance, t.reach, t.stiffness))
                .sum::<f64>();
        }
        sum + self.friction.value(x)
    }

    /// Adds the gradient [N].
    pub fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        for (height, side) in self.planes() {
            for (p, (x, g)) in x.iter().zip(out.iter_mut()).enumerate() {
                let gap = side * (x.y - height);
                g.y += side * barrier::slope(gap, self.settings.dhat, self.ground_stiffness(p));
            }
        }
        if let Some(pairs) = &self.pairs {
            for t in pairs.touches(x).iter() {
                let force = t.normal * barrier::slope(t.distance, t.reach, t.stiffness);
                spread(out, &t.points, &t.weights, &force);
            }
        }
        self.friction.add_gradient(x, out);
    }

    /// Adds a positive Hessian: the barrier's curvature along the normal (its tangential part is negative).
    pub fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
        // Those of friction stay the same for a step, and the order of all before them: a filling goes faster so.
        self.friction.add_hessian(x, out);
        let up = Mat3::from_diagonal(&Vec3::y());
        for (height, side) in self.planes() {
            for (p, x) in x.iter().enumerate() {
                let gap = side * (x.y - height);
                let k = barrier::curvature(gap, self.settings.dhat, self.ground_stiffness(p));
                if k > 0.0 {
                    out.add(p as u32, p as u32, &(up * k));
                }
            }
        }
        if let Some(pairs) = &self.pairs {
            for t in pairs.touches(x).iter() {
                if !out.is_relevant(&t.points) {
                    continue;
                }
                let k = barrier::curvature(t.distance, t.reach, t.stiffness);
                let block = t.normal * t.normal.transpose() * k;
                friction::add_weighted(out, &t.points, &t.weights, &block);
            }
        }
    }

    /// Visits the groups of points that the Hessian at `x` couples, and those within `margin` (at least 1) times the
    /// contact distance.
    pub fn visit_stencils(&self, x: &[Vec3], margin: f64, visit: &mut dyn FnMut(&[u32])) {
        if let Some(pairs) = &self.pairs {
            pairs.touches_within(x, margin).iter().for_each(|t| visit(&t.points));
        }
        for s in self.friction.sliders.iter().filter(|s| s.kind.is_some()) {
            visit(&s.points);
        }
    }

    /// The tightest of all pairs within their contact distance at `x`.
    pub fn tightest_pair(&self, x: &[Vec3]) -> Option<TightestPair> {
        let touches = self.pairs.as_ref()?.touches(x);
        let ratio = |t: &Touch| t.distance / t.reach;
        let tightest = touches.iter().min_by(|a, b| ratio(a).total_cmp(&ratio(b)))?;
        let position = tightest.points.iter().map(|p| &x[*p as usize]).sum::<Vec3>() / 4.0;
        Some(TightestPair { gap_ratio: ratio(tightest), position })
    }
}
