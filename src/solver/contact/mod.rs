//! Contact of cloth with itself, ground, ceiling and a body: barrier, friction, and the limit that keeps layers apart.
//!
//! If no two triangles of the cloth intersect at the start of a step, none do at any position the solver accepts; the number of those that
//! intersect at the start never grows (`contact::initial_intersections`). [`Contact::limit_displacement`] ensures it: continuous collision
//! detection cuts every displacement short of the first touch. The barrier makes such cuts rare, and friction depends on the barrier's
//! forces. Terms follow Li et al., "Incremental Potential Contact" (2020; IPC).
//!
//! The ground is the half space y >= height, seen by points only. A body of triangles is met from one side ([`BodyPlanes`]).

mod barrier;
mod body_edges;
mod body_planes;
pub mod broad_phase;
mod collision_set;
mod friction;
mod impact_zones;
mod initial_intersections;
mod planes;
mod self_fold;
mod settings;
pub mod step_bounds;
mod tuning;
mod uncovered_area;

pub use body_planes::{BodyContactState, BodyIntersections, BodyPlanes, Penetration, SELF_FOLD_MARGIN};
pub use friction::TangentialState;
pub use self_fold::ClothSurface;
pub use settings::{BodyContactSettings, ContactSettings};

use crate::contact::collision_set::{ActivePair, CollisionSet, LimitCriteria};
use crate::contact::friction::{
    Friction, FrictionContact, add_weighted_gradient, add_weighted_hessian, slip_tolerance,
};
use crate::contact::planes::HorizontalPlanes;
use crate::contact::uncovered_area::UncoveredArea;
use crease_geometry::math::{Vec3, dot};
use crease_geometry::mesh::{PointIndex, Topology};
use crease_linear::BlockSink;
use std::sync::Arc;

/// The pair that is nearest for its activation distance.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TightestPair {
    /// Distance over activation distance [-].
    pub gap_ratio: f64,
    /// A point between the two primitives [m].
    pub position: Vec3,
}

/// Contact of one garment with itself, the ground and a ceiling.
pub struct Contact {
    settings: ContactSettings,
    planes: HorizontalPlanes,
    /// Contact of the cloth with itself; `None` for none at all.
    layers: Option<LayerContact>,
    friction: Friction,
}

/// Contact of layers with one another.
struct LayerContact {
    collisions: CollisionSet,
    uncovered: UncoveredArea,
}

impl Contact {
    /// Contact for a mesh of `triangles` at `rest` [m] with its `topology`; `area` [m²] has one entry per point.
    pub fn new(
        settings: ContactSettings,
        rest: &[Vec3],
        triangles: &[[PointIndex; 3]],
        topology: &Topology,
        area: Vec<f64>,
    ) -> Self {
        let collisions = CollisionSet::new(&settings, rest, triangles, topology, &area);
        let layers = LayerContact { collisions, uncovered: UncoveredArea::new(rest, triangles) };
        Self { layers: Some(layers), ..Self::without_layers(settings, &area) }
    }

    /// No contact at all.
    pub fn none(point_count: usize) -> Self {
        let settings = ContactSettings { self_contact: false, ..ContactSettings::uniform(1e-3, 0.0, 0.0) };
        Self::without_layers(settings, &vec![0.0; point_count])
    }

    fn without_layers(settings: ContactSettings, area: &[f64]) -> Self {
        let stiffness = area.iter().map(|area| settings.stiffness * area).collect();
        let planes = HorizontalPlanes::new(settings.dhat, stiffness);
        Self { settings, planes, layers: None, friction: Friction::default() }
    }

    fn collisions(&self) -> Option<&CollisionSet> {
        self.layers.as_ref().map(|layers| &layers.collisions)
    }

    fn collisions_mut(&mut self) -> Option<&mut CollisionSet> {
        self.layers.as_mut().map(|layers| &mut layers.collisions)
    }

    /// Returns the settings.
    pub fn settings(&self) -> &ContactSettings {
        &self.settings
    }

    /// Puts ground and ceiling at these heights [m], or removes them.
    pub fn set_planes(&mut self, ground: Option<f64>, ceiling: Option<f64>) {
        self.planes.set(ground, ceiling);
    }

    /// Lets points that would hit one another move as zones from here on (`contact::impact_zones`), or not.
    pub fn set_zones(&mut self, zones: bool) {
        if let Some(collisions) = self.collisions_mut() {
            collisions.zones = zones;
        }
    }

    /// Guards all pairs from here on, also those that intersect, for cloth that has been put somewhere else (its source pose, say): what
    /// intersects there stays as it is and nothing passes, not even what could come apart.
    pub fn freeze_initial_intersections(&mut self) {
        if let Some(collisions) = self.collisions_mut() {
            collisions.freeze_initial_intersections();
        }
    }

    /// Drops what is kept between steps for speed alone.
    pub fn clear_caches(&mut self) {
        if let Some(collisions) = self.collisions_mut() {
            collisions.clear_caches();
        }
    }

    // ---- Steps ----

    /// Starts a step of `h` seconds at `x` [m], before any value is asked for: finds the pairs and lags the normal forces of friction. For
    /// equilibria, which have no slip velocity, `h` is infinite and there is no friction.
    ///
    /// `friction_scale` multiplies the friction coefficients [-]. The `fixed` points, one flag per point, do not move during the step, and
    /// pairs of such points only are left out.
    pub fn begin_step(&mut self, x: &[Vec3], h: f64, friction_scale: f64, fixed: &[bool]) {
        if let Some(collisions) = self.collisions_mut() {
            collisions.begin_step(x, fixed);
        }
        let settings = &self.settings;
        let slip_tol = slip_tolerance(settings.slip_velocity_tol, h);
        self.friction.begin_step(x, slip_tol, settings.static_ratio);
        if h.is_finite() && friction_scale > 0.0 {
            self.add_friction(x, friction_scale);
        }
    }

    /// Adds the friction contacts of a step that starts at `x`.
    fn add_friction(&mut self, x: &[Vec3], friction_scale: f64) {
        let Self { settings, planes, layers, friction } = self;
        if settings.friction_ground > 0.0 {
            for (p, force) in planes.ground_forces(x).into_iter().flatten().enumerate() {
                if force > 0.0 {
                    friction.add(FrictionContact {
                        kind: None,
                        points: [p as u32; 4],
                        weights: [1.0, 0.0, 0.0, 0.0],
                        normal: Vec3::y(),
                        max_force: friction_scale * settings.friction_ground * force,
                        stretch: Vec3::zeros(),
                    });
                }
            }
        }
        let Some(layers) = layers.as_ref().filter(|_| settings.friction > 0.0) else { return };
        for pair in layers.collisions.active_pairs(x).iter() {
            let slope = barrier::derivative(pair.distance, pair.dhat, pair.stiffness);
            friction.add(FrictionContact {
                kind: Some(pair.kind),
                points: pair.points,
                weights: pair.weights,
                normal: pair.normal,
                max_force: -friction_scale * settings.friction * slope,
                stretch: Vec3::zeros(),
            });
        }
    }

    /// Accepts the step of `h` seconds at `x` [m].
    pub fn end_step(&mut self, x: &[Vec3], h: f64) {
        self.friction.end_step(x);
        if let Some(collisions) = self.collisions_mut() {
            collisions.end_step(x, h);
        }
    }

    /// Returns what friction keeps from step to step.
    pub fn friction_state(&self) -> Vec<TangentialState> {
        self.friction.state()
    }

    /// Continues with what friction kept.
    pub fn restore_friction_state(&mut self, state: &[TangentialState]) {
        self.friction.restore(state);
    }

    /// Restricts contact to the points for which `moving` is set, one flag per point: contacts of all others, at rest at `x` [m], with one
    /// another are left out of value, gradient and Hessian, and limit no displacement.
    pub fn restrict_to(&mut self, x: &[Vec3], moving: &[bool]) {
        if let Some(collisions) = self.collisions_mut() {
            collisions.restrict_to(x, moving);
        }
        self.friction.restrict_to(moving);
    }

    /// Ends the restriction: all points may move again, and all contacts count.
    pub fn unrestrict(&mut self) {
        if let Some(collisions) = self.collisions_mut() {
            collisions.unrestrict();
        }
        self.friction.unrestrict();
    }

    // ---- Limits on displacements ----

    /// Changes the displacements `d` until the motion from `x` to `x + d` [m] (and to every fraction of it) keeps all pairs apart: those of
    /// single points become shorter, or points move together. `gradient` is that of the energy to decrease, one per point [N]. Afterwards
    /// values may be asked for anywhere on that motion.
    pub fn limit_displacement(&mut self, x: &[Vec3], d: &mut [Vec3], gradient: &[Vec3]) {
        self.planes.limit_displacement(x, d);
        let Some(layers) = &mut self.layers else { return };
        let criteria = LimitCriteria {
            decrease: &|d| -dot(gradient, d),
            allowed: &|d| self.planes.uniform_step_size(x, d),
        };
        layers.collisions.limit_displacement(x, d, criteria);
    }

    /// Does the same with one step size for all points, so that the direction does not change.
    pub fn limit_displacement_uniform(&mut self, x: &[Vec3], d: &mut [Vec3]) {
        let step_size = self.planes.uniform_step_size(x, d);
        d.iter_mut().for_each(|d| *d *= step_size);
        if let Some(collisions) = self.collisions_mut() {
            collisions.limit_displacement_uniform(x, d);
        }
    }

    /// Moves the cloth at `x` by `d` [m], each point as far as all stay apart; presses no layer below the inner part of its activation
    /// distance. Afterwards values may be asked for at the new positions.
    pub fn carry(&mut self, x: &mut [Vec3], d: &[Vec3]) {
        let mut d = d.to_vec();
        self.planes.limit_displacement(x, &mut d);
        if let Some(collisions) = self.collisions_mut() {
            collisions.carry(x, &d);
        }
    }

    // ---- Response ----

    /// Returns the part of each point's area that nothing covers from above at `x`, projected onto the ground [m²].
    pub fn uncovered_area(&mut self, x: &[Vec3]) -> Vec<f64> {
        match &mut self.layers {
            Some(layers) => layers.uncovered.at(x),
            None => vec![0.0; x.len()],
        }
    }

    fn active_pairs(&self, x: &[Vec3]) -> Arc<Vec<ActivePair>> {
        self.collisions().map(|collisions| collisions.active_pairs(x)).unwrap_or_default()
    }

    /// Returns the energy of all contacts and the dissipation potential of friction at `x` [J]; infinite beyond ground or ceiling, and where
    /// more triangles intersect than when the step began.
    pub fn value(&self, x: &[Vec3]) -> f64 {
        let mut sum = self.planes.value(x);
        if sum == f64::INFINITY {
            return sum;
        }
        if let Some(collisions) = self.collisions() {
            if collisions.adds_intersections(x) {
                return f64::INFINITY;
            }
            let energy = |pair: &ActivePair| barrier::value(pair.distance, pair.dhat, pair.stiffness);
            sum += collisions.active_pairs(x).iter().map(energy).sum::<f64>();
        }
        sum + self.friction.value(x)
    }

    /// Adds the gradient at `x` [N].
    pub fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        self.planes.add_gradient(x, out);
        for pair in self.active_pairs(x).iter() {
            let gradient = pair.normal * barrier::derivative(pair.distance, pair.dhat, pair.stiffness);
            add_weighted_gradient(out, &pair.points, &pair.weights, &gradient);
        }
        self.friction.add_gradient(x, out);
    }

    /// Adds a positive semidefinite Hessian at `x` [N/m]: the barrier's second derivative along the normal (its tangential part is negative).
    pub fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
        // The contacts of friction stay the same during a step, and with them the order of blocks before all others: assembly is faster so.
        self.friction.add_hessian(x, out);
        self.planes.add_hessian(x, out);
        for pair in self.active_pairs(x).iter() {
            if !out.is_relevant(&pair.points) {
                continue;
            }
            let curvature = barrier::second_derivative(pair.distance, pair.dhat, pair.stiffness);
            let block = pair.normal * pair.normal.transpose() * curvature;
            add_weighted_hessian(out, &pair.points, &pair.weights, &block);
        }
    }

    /// Visits the groups of points that the Hessian at `x` couples, and those of pairs within `margin` (at least 1) times their activation
    /// distance.
    pub fn visit_stencils(&self, x: &[Vec3], margin: f64, visit: &mut dyn FnMut(&[u32])) {
        if let Some(collisions) = self.collisions() {
            collisions.active_pairs_within(x, margin).iter().for_each(|pair| visit(&pair.points));
        }
        for contact in self.friction.contacts.iter().filter(|contact| contact.kind.is_some()) {
            visit(&contact.points);
        }
    }

    /// Returns the pair that is nearest for its activation distance at `x`; `None` where no pair is active.
    pub fn tightest_pair(&self, x: &[Vec3]) -> Option<TightestPair> {
        let active = self.active_pairs(x);
        let ratio = |pair: &ActivePair| pair.distance / pair.dhat;
        let tightest = active.iter().min_by(|a, b| ratio(a).total_cmp(&ratio(b)))?;
        let position = tightest.points.iter().map(|p| &x[*p as usize]).sum::<Vec3>() / 4.0;
        Some(TightestPair { gap_ratio: ratio(tightest), position })
    }
}
