//! Terms that depend on who is near: candidates, response, friction, and the bound that keeps layers apart.
//!
//! The promise: if no two triangles cross at the start of a step, none do at any position the solver accepts.
//! It is kept by [`Contact::bound_motion`], which cuts every move short of the first touch by continuous collision
//! detection; the barrier makes such cuts rare, and friction rides on the barrier's forces.
//! The ground is the half space y >= height, seen by points only.

mod barrier;
pub mod bound;
pub mod candidates;
mod friction;
mod pairs;

use crate::energy::BlockSink;
use crate::math::{Mat3, Vec3};
use crate::mesh::{PointIndex, Topology};
use friction::{Friction, Slider};
use pairs::{PairContact, Touch};

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
    /// Slip velocity below which contacts stick [m/s].
    pub creep: f64,
    /// Whether cloth can meet cloth.
    pub between_layers: bool,
}

/// Contact of one garment with itself and with the ground.
pub struct Contact {
    settings: ContactSettings,
    /// Per point: area it stands for [m²].
    area: Vec<f64>,
    layers: Option<PairContact>,
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
        let layers =
            settings.between_layers.then(|| PairContact::new(&settings, rest, triangles, topology, &area));
        Self { settings, area, layers, ground: None, ceiling: None, friction: Friction::default() }
    }

    /// No contact at all.
    pub fn none(point_count: usize) -> Self {
        let settings = ContactSettings {
            distance: 1e-3,
            stiffness: 0.0,
            friction: 0.0,
            friction_ground: 0.0,
            creep: 1e-3,
            between_layers: false,
        };
        Self {
            settings,
            area: vec![0.0; point_count],
            layers: None,
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

    /// Distance of a point to the plane and +1 for the ground, -1 for the ceiling [m].
    fn planes(&self) -> impl Iterator<Item = (f64, f64)> + use<> {
        [(self.ground, 1.0), (self.ceiling, -1.0)].into_iter().filter_map(|(h, side)| h.map(|h| (h, side)))
    }

    /// Starts a step of `h` seconds at `x`, before any value is asked for: finds who is near; normal forces for friction are taken here. Without slip velocity
    /// (equilibria) pass an infinite step and there is no friction. `share` scales the friction coefficients. Points that
    /// are `held` do not move during the step: pairs of such points only do not count.
    pub fn begin_step(&mut self, x: &[Vec3], h: f64, share: f64, held: &[bool]) {
        if let Some(layers) = &mut self.layers {
            layers.asleep.clear();
            layers.asleep.extend_from_slice(held);
            layers.look_around(x);
        }
        self.friction.sliders.clear();
        if !h.is_finite() || share <= 0.0 {
            return;
        }
        self.friction.start = x.to_vec();
        self.friction.stick = self.settings.creep * h;
        if let (Some(ground), true) = (self.ground, self.settings.friction_ground > 0.0) {
            for (p, x) in x.iter().enumerate() {
                let force = -barrier::slope(x.y - ground, self.settings.distance, self.ground_stiffness(p));
                if force > 0.0 {
                    self.friction.sliders.push(Slider {
                        points: [p as u32; 4],
                        weights: [1.0, 0.0, 0.0, 0.0],
                        normal: Vec3::y(),
                        limit: share * self.settings.friction_ground * force,
                    });
                }
            }
        }
        if self.settings.friction > 0.0
            && let Some(layers) = &self.layers
        {
            let limit = share * self.settings.friction;
            self.friction.sliders.extend(layers.touches(x).into_iter().map(|t| Slider {
                points: t.points,
                weights: t.weights,
                normal: t.normal,
                limit: -limit * barrier::slope(t.distance, t.reach, t.stiffness),
            }));
        }
    }

    /// Shortens the moves `d` of single points until the way from `x` to `x + d` (and to every share of it) keeps
    /// all pairs apart. Afterwards values may be asked for anywhere on that way.
    pub fn bound_motion(&mut self, x: &[Vec3], d: &mut [Vec3]) {
        for (height, side) in self.planes() {
            for (x, d) in x.iter().zip(d.iter_mut()) {
                *d *= self.plane_share(x, d, height, side);
            }
        }
        if let Some(layers) = &mut self.layers {
            layers.bound_motion(x, d);
        }
    }

    /// The same with one share for all points: the direction stays what it was.
    pub fn bound_together(&mut self, x: &[Vec3], d: &mut [Vec3]) {
        let mut share: f64 = 1.0;
        for (height, side) in self.planes() {
            for (x, d) in x.iter().zip(d.iter()) {
                share = share.min(self.plane_share(x, d, height, side));
            }
        }
        d.iter_mut().for_each(|d| *d *= share);
        if let Some(layers) = &mut self.layers {
            layers.bound_together(x, d);
        }
    }

    /// Share of the move `d` from `x` that stays off a plane.
    fn plane_share(&self, x: &Vec3, d: &Vec3, height: f64, side: f64) -> f64 {
        let (gap, way) = (side * (x.y - height), side * d.y);
        let floor = barrier::floor(gap, self.settings.distance);
        if way < 0.0 && gap + way < floor { ((gap - floor) / -way).clamp(0.0, 1.0) } else { 1.0 }
    }

    /// Per point: the part of its area that nothing covers from above, as seen from above [m²].
    pub fn uncovered_area(&self, x: &[Vec3]) -> Vec<f64> {
        match &self.layers {
            Some(layers) => layers.uncovered_area(x),
            None => vec![0.0; x.len()],
        }
    }

    fn ground_stiffness(&self, p: usize) -> f64 {
        self.settings.stiffness * self.area[p]
    }

    /// Energy of all contacts and the dissipation potential of friction [J]; infinite beyond ground or ceiling.
    pub fn value(&self, x: &[Vec3]) -> f64 {
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
        if let Some(layers) = &self.layers {
            sum += layers
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
                g.y += side * barrier::slope(gap, self.settings.distance, self.ground_stiffness(p));
            }
        }
        if let Some(layers) = &self.layers {
            for t in layers.touches(x) {
                let force = t.normal * barrier::slope(t.distance, t.reach, t.stiffness);
                for (&p, &w) in t.points.iter().zip(&t.weights) {
                    out[p as usize] += force * w;
                }
            }
        }
        self.friction.add_gradient(x, out);
    }

    /// Adds a positive Hessian: the barrier's curvature along the normal (its tangential part is negative).
    pub fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink) {
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
        if let Some(layers) = &self.layers {
            for t in layers.touches(x) {
                let k = barrier::curvature(t.distance, t.reach, t.stiffness);
                friction::add_weighted(out, &t.points, &t.weights, &(t.normal * t.normal.transpose() * k));
            }
        }
        self.friction.add_hessian(x, out);
    }

    /// Visits the groups of points that the Hessian at `x` couples, and those within `margin` times the contact
    /// distance.
    pub fn visit_stencils(&self, x: &[Vec3], margin: f64, visit: &mut dyn FnMut(&[u32])) {
        if let Some(layers) = &self.layers {
            layers.touches_within(x, margin).iter().for_each(|t: &Touch| visit(&t.points));
        }
        for s in self.friction.sliders.iter().filter(|s| s.weights[1] != 0.0 || s.weights[2] != 0.0) {
            visit(&s.points);
        }
    }
}
