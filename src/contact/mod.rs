//! Terms that depend on who is near: candidates, response, friction, and the bound that keeps layers apart.
//!
//! The promise: if no two triangles cross at the start of a step, none do at any position the solver accepts, cloth
//! with cloth or cloth with body; what crosses at the start never becomes more (`contact::entangled`).
//! It is kept by [`Contact::bound_motion`], which cuts every move short of the first touch by continuous collision
//! detection; the barrier makes such cuts rare, and friction rides on the barrier's forces.
//! The ground is the half space y >= height, seen by points only. A body of triangles moves as it is told, as far as
//! the cloth leaves it room ([`Contact::advance`]).

mod barrier;
mod body_edges;
mod body_planes;
pub mod broad_phase;
mod collision_set;
mod friction;
mod initial_intersections;
mod stacked_positions;
pub mod step_bounds;
mod two_way_body;

pub use body_planes::{BodyField, FOLD_RIM, FieldSettings, KeptField};
pub use two_way_body::Body;

use crate::contact::collision_set::{PairContact, Touch};
use crate::contact::stacked_positions::Places;
use crate::energy::BlockSink;
use crate::math::{Mat3, Vec3};
use crate::mesh::{PointIndex, Topology};
pub use friction::KeptStretch;
use friction::{Friction, Slider, spread};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// What contact there is in a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSettings {
    /// Distance within which cloth pushes cloth apart [m]: the thickness of one layer.
    pub distance: f64,
    /// Stiffness per area [N/m³]: pressure per metre of approach.
    pub stiffness: f64,
    /// Friction coefficient, cloth on cloth.
    pub friction: f64,
    /// Friction coefficient, cloth on ground.
    pub friction_ground: f64,
    /// Friction coefficient, cloth on body.
    pub friction_body: f64,
    /// What a contact that sticks bears, as a multiple of what it bears while it slides; 1 for plain Coulomb friction.
    pub stiction: f64,
    /// A contact gives by up to this times the step before it slides [m/s].
    pub creep: f64,
    /// Whether cloth can meet cloth.
    pub between_layers: bool,
}

/// Forces of contact on the cloth, friction included [N].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Reactions {
    /// Of the ground.
    pub ground: Vec3,
    /// Of the ceiling.
    pub ceiling: Vec3,
    /// Of the body.
    pub body: Vec3,
}

/// The pair that is nearest for its contact distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tightest {
    /// Its gap as a share of its contact distance.
    pub share: f64,
    /// A point between the two pieces [m].
    pub place: Vec3,
}

/// What crossed at the start and still does.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Crossing<'a> {
    /// Pairs of the cloth's triangles, lower first, sorted.
    pub layers: &'a [[u32; 2]],
    /// (triangle of the cloth, triangle of the body), sorted.
    pub with_body: &'a [[u32; 2]],
}

/// Contact of one garment with itself, with the ground and with a body.
pub struct Contact {
    settings: ContactSettings,
    /// Per point: area it stands for [m²].
    area: Vec<f64>,
    pairs: Option<PairContact>,
    ground: Option<f64>,
    ceiling: Option<f64>,
    friction: Friction,
    /// Time spent here so far [ns].
    spent: AtomicU64,
}

/// Adds the time until it goes out of scope.
struct Spending<'a>(&'a AtomicU64, Instant);

impl Drop for Spending<'_> {
    fn drop(&mut self) {
        self.0.fetch_add(self.1.elapsed().as_nanos() as u64, Ordering::Relaxed);
    }
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
        Self {
            settings,
            area,
            pairs,
            ground: None,
            ceiling: None,
            friction: Friction::default(),
            spent: AtomicU64::new(0),
        }
    }

    /// No contact at all.
    pub fn none(point_count: usize) -> Self {
        let settings = ContactSettings {
            distance: 1e-3,
            stiffness: 0.0,
            friction: 0.0,
            friction_ground: 0.0,
            friction_body: 0.0,
            stiction: 1.0,
            creep: 1e-3,
            between_layers: false,
        };
        Self {
            settings,
            area: vec![0.0; point_count],
            pairs: None,
            ground: None,
            ceiling: None,
            friction: Friction::default(),
            spent: AtomicU64::new(0),
        }
    }

    /// Time spent on contact so far: search, bound, value, gradient and Hessian.
    pub fn time_spent(&self) -> Duration {
        Duration::from_nanos(self.spent.load(Ordering::Relaxed))
    }

    fn spending(&self) -> Spending<'_> {
        Spending(&self.spent, Instant::now())
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

    /// Brings a body in, or takes it away. It takes part in steps that aim it ([`Self::aim_body`]).
    pub fn set_body(&mut self, body: Option<Body>) {
        if let Some(pairs) = &mut self.pairs {
            pairs.set_body(body);
        }
    }

    /// The body.
    pub fn body(&self) -> Option<&Body> {
        self.pairs.as_ref().and_then(PairContact::body)
    }

    /// Before a step begins: where the points of the body should be at its end [m], one per point; `None` when it
    /// takes no part. It goes there from where the last accepted step left it, and only as far as
    /// [`Self::advance`] moves it.
    pub fn aim_body(&mut self, target: Option<&[Vec3]>) {
        if let Some(pairs) = &mut self.pairs {
            pairs.aim_body(target);
        }
    }

    /// Whether the body takes part and is not where it should be.
    pub fn body_lags(&self) -> bool {
        self.body_acts() && self.body().is_some_and(|body| body.lag().0 > 0.0)
    }

    fn body_acts(&self) -> bool {
        self.pairs.as_ref().is_some_and(PairContact::body_acts)
    }

    /// What crossed at the start and did when the last step began.
    pub fn crossing(&self) -> Crossing<'_> {
        let (layers, with_body) = self.pairs.as_ref().map_or((&[][..], &[][..]), PairContact::entangled);
        Crossing { layers, with_body }
    }

    /// The cloth has been put somewhere else (its source pose, say), and what crosses there shall stay as it is: nothing
    /// passes, not even what could come apart.
    pub fn keep_crossings(&mut self) {
        if let Some(pairs) = &mut self.pairs {
            pairs.keep_crossings();
        }
    }

    /// Forgets what is kept between steps for speed alone.
    pub fn forget(&mut self) {
        if let Some(pairs) = &mut self.pairs {
            pairs.forget();
        }
    }

    /// Where cloth and body are.
    fn places<'a>(&'a self, x: &'a [Vec3]) -> Places<'a> {
        self.pairs.as_ref().map_or(Places { cloth: x, body: &[] }, |pairs| pairs.places(x))
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
        let clock = Instant::now();
        if let Some(pairs) = &mut self.pairs {
            pairs.begin(x, held);
        }
        let mut friction = std::mem::take(&mut self.friction);
        let stick = friction::stick(self.settings.creep, h);
        friction.begin(self.places(x), stick, self.settings.stiction);
        if h.is_finite() && share > 0.0 {
            self.add_sliders(x, share, &mut friction);
        }
        self.friction = friction;
        *self.spent.get_mut() += clock.elapsed().as_nanos() as u64;
    }

    fn add_sliders(&self, x: &[Vec3], share: f64, friction: &mut Friction) {
        let settings = &self.settings;
        if let (Some(ground), true) = (self.ground, settings.friction_ground > 0.0) {
            for (p, x) in x.iter().enumerate() {
                let force = -barrier::slope(x.y - ground, settings.distance, self.ground_stiffness(p));
                if force > 0.0 {
                    friction.add(Slider {
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
        if settings.friction <= 0.0 && settings.friction_body <= 0.0 {
            return;
        }
        for t in self.touches(x).iter() {
            let with_body = is_with_body(&t.points, x.len());
            let coefficient = if with_body { settings.friction_body } else { settings.friction };
            if coefficient > 0.0 {
                friction.add(Slider {
                    kind: Some(t.kind),
                    points: t.points,
                    weights: t.weights,
                    normal: t.normal,
                    limit: -share * coefficient * barrier::slope(t.distance, t.reach, t.stiffness),
                    stretch: Vec3::zeros(),
                });
            }
        }
    }

    /// What friction keeps from step to step.
    pub fn kept_friction(&self) -> Vec<KeptStretch> {
        self.friction.kept()
    }

    /// Goes on with what friction kept.
    pub fn restore_friction(&mut self, kept: &[KeptStretch]) {
        self.friction.restore(kept);
    }

    /// The step of `h` seconds is accepted at `x`: the body stays where it has come to, friction keeps its stretch.
    pub fn accept(&mut self, x: &[Vec3], h: f64) {
        let clock = Instant::now();
        let mut friction = std::mem::take(&mut self.friction);
        friction.accept(self.places(x));
        self.friction = friction;
        if let Some(pairs) = &mut self.pairs {
            pairs.accept(x, h);
        }
        *self.spent.get_mut() += clock.elapsed().as_nanos() as u64;
    }

    /// From here on only the points for which `moving` is set move, one flag per point: contacts of all others with one another
    /// and with the body are left out of value, gradient and Hessian, and no move is bounded by them.
    pub fn focus(&mut self, x: &[Vec3], moving: &[bool]) {
        let clock = Instant::now();
        if let Some(pairs) = &mut self.pairs {
            pairs.focus(x, moving);
        }
        self.friction.focus(moving);
        *self.spent.get_mut() += clock.elapsed().as_nanos() as u64;
    }

    /// All points move again, and all contacts count.
    pub fn unfocus(&mut self) {
        let clock = Instant::now();
        if let Some(pairs) = &mut self.pairs {
            pairs.unfocus();
        }
        self.friction.unfocus();
        *self.spent.get_mut() += clock.elapsed().as_nanos() as u64;
    }

    /// Shortens the moves `d` of single points until the way from `x` to `x + d` (and to every share of it) keeps
    /// all pairs apart. Afterwards values may be asked for anywhere on that way.
    pub fn bound_motion(&mut self, x: &[Vec3], d: &mut [Vec3]) {
        let clock = Instant::now();
        for (height, side) in self.planes() {
            for (x, d) in x.iter().zip(d.iter_mut()) {
                *d *= self.plane_share(x, d, height, side);
            }
        }
        if let Some(pairs) = &mut self.pairs {
            pairs.bound_motion(x, d);
        }
        *self.spent.get_mut() += clock.elapsed().as_nanos() as u64;
    }

    /// The same with one share for all points: the direction stays what it was.
    pub fn bound_together(&mut self, x: &[Vec3], d: &mut [Vec3]) {
        let clock = Instant::now();
        let mut share: f64 = 1.0;
        for (height, side) in self.planes() {
            for (x, d) in x.iter().zip(d.iter()) {
                share = share.min(self.plane_share(x, d, height, side));
            }
        }
        d.iter_mut().for_each(|d| *d *= share);
        if let Some(pairs) = &mut self.pairs {
            pairs.bound_together(x, d);
        }
        *self.spent.get_mut() += clock.elapsed().as_nanos() as u64;
    }

    /// Moves the body towards its target and the cloth by `d`, each point as far as all stay apart; a body presses
    /// no layer below the inner part of its contact distance. Afterwards values may be asked for at the new places.
    pub fn advance(&mut self, x: &mut [Vec3], d: &[Vec3]) {
        let clock = Instant::now();
        let mut d = d.to_vec();
        for (height, side) in self.planes() {
            for (x, d) in x.iter().zip(d.iter_mut()) {
                *d *= self.plane_share(x, d, height, side);
            }
        }
        if let Some(pairs) = &mut self.pairs {
            pairs.advance(x, &d);
        }
        *self.spent.get_mut() += clock.elapsed().as_nanos() as u64;
    }

    /// Adds what the gradient will gain [N], to first order, when the body goes the rest of its way: to be solved for
    /// the motion of cloth that is led by it. Returns whether any cloth is.
    pub fn add_pull(&self, x: &[Vec3], out: &mut [Vec3]) -> bool {
        let Some(pairs) = self.pairs.as_ref().filter(|_| self.body_acts()) else { return false };
        let body_way = self.body().map(Body::way).unwrap_or_default();
        let still = vec![Vec3::zeros(); x.len()];
        let ways = Places { cloth: &still, body: &body_way };
        let motion = |points: &[u32; 4], weights: &[f64; 4]| {
            points.iter().zip(weights).map(|(&p, &w)| ways.at(p) * w).sum::<Vec3>()
        };
        let mut pulled = false;
        for t in pairs.touches(x).iter().filter(|t| is_with_body(&t.points, x.len())) {
            let k = barrier::curvature(t.distance, t.reach, t.stiffness);
            let gain = t.normal * (k * t.normal.dot(&motion(&t.points, &t.weights)));
            spread(out, &t.points, &t.weights, &gain);
            pulled = true;
        }
        for s in self.friction.sliders.iter().filter(|s| is_with_body(&s.points, x.len())) {
            let gain = self.friction.block(s, self.places(x)) * motion(&s.points, &s.weights);
            spread(out, &s.points, &s.weights, &gain);
        }
        pulled
    }

    /// Share of the move `d` from `x` that stays off a plane.
    fn plane_share(&self, x: &Vec3, d: &Vec3, height: f64, side: f64) -> f64 {
        let (gap, way) = (side * (x.y - height), side * d.y);
        let floor = barrier::floor(gap, self.settings.distance);
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
        let _spending = self.spending();
        let mut sum = 0.0;
        for (height, side) in self.planes() {
            for (p, x) in x.iter().enumerate() {
                let gap = side * (x.y - height);
                if gap <= 0.0 {
                    return f64::INFINITY;
                }
                sum += barrier::value(gap, self.settings.distance, self.ground_stiffness(p));
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
        sum + self.friction.value(self.places(x))
    }

    /// Adds the gradient [N].
    pub fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        let _spending = self.spending();
        for (height, side) in self.planes() {
            for (p, (x, g)) in x.iter().zip(out.iter_mut()).enumerate() {
                let gap = side * (x.y - height);
                g.y += side * barrier::slope(gap, self.settings.distance, self.ground_stiffness(p));
            }
        }
        if let Some(pairs) = &self.pairs {
            for t in pairs.touches(x).iter() {
                let force = t.normal * barrier::slope(t.distance, t.reach, t.stiffness);
                spread(out, &t.points, &t.weights, &force);
            }
        }
        self.friction.add_gradient(self.places(x), out);
    }

    /// Adds a positive Hessian: the barrier's curvature along the normal (its tangential part is negative).
    pub fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
        let _spending = self.spending();
        // Those of friction stay the same for a step, and the order of all before them: a filling goes faster so.
        self.friction.add_hessian(self.places(x), out);
        let up = Mat3::from_diagonal(&Vec3::y());
        for (height, side) in self.planes() {
            for (p, x) in x.iter().enumerate() {
                let gap = side * (x.y - height);
                let k = barrier::curvature(gap, self.settings.distance, self.ground_stiffness(p));
                if k > 0.0 {
                    out.add(p as u32, p as u32, &(up * k));
                }
            }
        }
        if let Some(pairs) = &self.pairs {
            for t in pairs.touches(x).iter() {
                if !out.wants(&t.points) {
                    continue;
                }
                let k = barrier::curvature(t.distance, t.reach, t.stiffness);
                let block = t.normal * t.normal.transpose() * k;
                friction::add_weighted(out, x.len(), &t.points, &t.weights, &block);
            }
        }
    }

    /// Visits the groups of points that the Hessian at `x` couples, and those within `margin` (at least 1) times the
    /// contact distance.
    pub fn visit_stencils(&self, x: &[Vec3], margin: f64, visit: &mut dyn FnMut(&[u32])) {
        let _spending = self.spending();
        let mut cloth = Vec::with_capacity(4);
        let mut visit_cloth = |points: &[u32; 4]| {
            cloth.clear();
            cloth.extend(points.iter().filter(|p| (**p as usize) < x.len()));
            visit(&cloth);
        };
        if let Some(pairs) = &self.pairs {
            pairs.touches_within(x, margin).iter().for_each(|t| visit_cloth(&t.points));
        }
        for s in self.friction.sliders.iter().filter(|s| s.kind.is_some()) {
            visit_cloth(&s.points);
        }
    }

    /// Forces of ground, ceiling and body on the cloth at `x` [N], friction included.
    pub fn reactions(&self, x: &[Vec3]) -> Reactions {
        let mut forces = Reactions { ground: Vec3::zeros(), ceiling: Vec3::zeros(), body: Vec3::zeros() };
        for (height, side) in self.planes() {
            let push = |(p, x): (usize, &Vec3)| {
                let gap = side * (x.y - height);
                -side * barrier::slope(gap, self.settings.distance, self.ground_stiffness(p))
            };
            let sum = Vec3::y() * x.iter().enumerate().map(push).sum::<f64>();
            if side > 0.0 { forces.ground += sum } else { forces.ceiling += sum }
        }
        let on_cloth = |points: &[u32; 4], weights: &[f64; 4]| {
            let cloth = points.iter().zip(weights).filter(|(p, _)| (**p as usize) < x.len());
            cloth.map(|(_, w)| w).sum::<f64>()
        };
        for t in self.touches(x).iter() {
            if is_with_body(&t.points, x.len()) {
                let force = t.normal * barrier::slope(t.distance, t.reach, t.stiffness);
                forces.body -= force * on_cloth(&t.points, &t.weights);
            }
        }
        for s in &self.friction.sliders {
            let force = self.friction.force(s, self.places(x)) * on_cloth(&s.points, &s.weights);
            if s.kind.is_none() {
                forces.ground -= force;
            } else if is_with_body(&s.points, x.len()) {
                forces.body -= force;
            }
        }
        forces
    }

    /// The tightest of all pairs within their contact distance at `x`.
    pub fn tightest(&self, x: &[Vec3]) -> Option<Tightest> {
        let touches = self.pairs.as_ref()?.touches(x);
        let share = |t: &Touch| t.distance / t.reach;
        let tightest = touches.iter().min_by(|a, b| share(a).total_cmp(&share(b)))?;
        let places = self.places(x);
        let place = tightest.points.iter().map(|p| places.at(*p)).sum::<Vec3>() / 4.0;
        Some(Tightest { share: share(tightest), place })
    }
}

/// Whether one of the points is the body's: they follow the `count` points of the cloth.
fn is_with_body(points: &[u32; 4], count: usize) -> bool {
    points.iter().any(|p| *p as usize >= count)
}
