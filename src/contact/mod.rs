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

use candidates::{CandidateFinder, Candidates, PairKind};

use crate::energy::BlockSink;
use crate::math::{Mat3, Vec3};
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

/// The ground: the half space above a height.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Ground {
    height: f64,
}

/// Contact of one garment with itself and with the ground.
pub struct Contact {
    settings: ContactSettings,
    /// Per point: area it stands for [m²].
    area: Vec<f64>,
    layers: Option<PairContact>,
    ground: Option<Ground>,
    friction: Friction,
}

/// Share of the contact distance that no motion may undercut in one go.
const FLOOR: f64 = 0.1;

impl Contact {
    /// Contact for the mesh of `rest` points [m]. `area` per point [m²].
    pub fn new(
        settings: ContactSettings,
        rest: &[Vec3],
        triangles: &[[u32; 3]],
        edges: &[[u32; 2]],
        area: Vec<f64>,
    ) -> Self {
        let layers = settings.between_layers.then(|| PairContact::new(&settings, rest, triangles, edges, &area));
        Self { settings, area, layers, ground: None, friction: Friction::default() }
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
        Self { settings, area: vec![0.0; point_count], layers: None, ground: None, friction: Friction::default() }
    }

    /// What contact there is.
    pub fn settings(&self) -> &ContactSettings {
        &self.settings
    }

    /// Puts the ground at `height` [m], or takes it away.
    pub fn set_ground(&mut self, height: Option<f64>) {
        self.ground = height.map(|height| Ground { height });
    }

    /// Sets the stiffness per area [N/m³].
    pub fn set_stiffness(&mut self, stiffness: f64) {
        self.settings.stiffness = stiffness;
        if let Some(layers) = &mut self.layers {
            layers.set_stiffness(stiffness);
        }
    }

    /// Starts a step of `h` seconds at `x`: normal forces for friction are taken here. Without slip velocity
    /// (equilibria) pass an infinite step and there is no friction.
    pub fn begin_step(&mut self, x: &[Vec3], h: f64) {
        self.friction.sliders.clear();
        if !h.is_finite() {
            return;
        }
        self.friction.start = x.to_vec();
        self.friction.stick = self.settings.creep * h;
        if let (Some(ground), true) = (self.ground, self.settings.friction_ground > 0.0) {
            for (p, x) in x.iter().enumerate() {
                let force = -barrier::slope(x.y - ground.height, self.settings.distance, self.ground_stiffness(p));
                if force > 0.0 {
                    self.friction.sliders.push(Slider {
                        points: [p as u32; 4],
                        weights: [1.0, 0.0, 0.0, 0.0],
                        normal: Vec3::y(),
                        limit: self.settings.friction_ground * force,
                    });
                }
            }
        }
        if self.settings.friction > 0.0
            && let Some(layers) = &mut self.layers
        {
            layers.look_around(x);
            let limit = self.settings.friction;
            self.friction.sliders.extend(layers.touches(x).into_iter().map(|t| Slider {
                points: t.points,
                weights: t.weights,
                normal: t.normal,
                limit: -limit * barrier::slope(t.distance, t.reach, t.stiffness),
            }));
        }
    }

    /// Finds who is near at `x`. Needed once before values are asked for.
    pub fn look_around(&mut self, x: &[Vec3]) {
        if let Some(layers) = &mut self.layers {
            layers.look_around(x);
        }
    }

    /// Shortens the moves `d` of single points until the way from `x` to `x + d` (and to every share of it) keeps
    /// all pairs apart. Afterwards values may be asked for anywhere on that way.
    pub fn bound_motion(&mut self, x: &[Vec3], d: &mut [Vec3]) {
        if let Some(ground) = self.ground {
            for (x, d) in x.iter().zip(d.iter_mut()) {
                let gap = x.y - ground.height;
                let floor = (FLOOR * self.settings.distance).min(0.5 * gap);
                if gap + d.y < floor && d.y < 0.0 {
                    *d *= ((gap - floor) / -d.y).clamp(0.0, 1.0);
                }
            }
        }
        if let Some(layers) = &mut self.layers {
            layers.bound_motion(x, d);
        }
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

    /// Energy of all contacts and the dissipation potential of friction [J]; infinite below the ground.
    pub fn value(&self, x: &[Vec3]) -> f64 {
        let mut sum = 0.0;
        if let Some(ground) = self.ground {
            for (p, x) in x.iter().enumerate() {
                let gap = x.y - ground.height;
                if gap <= 0.0 {
                    return f64::INFINITY;
                }
                sum += barrier::value(gap, self.settings.distance, self.ground_stiffness(p));
            }
        }
        if let Some(layers) = &self.layers {
            sum += layers.touches(x).iter().map(|t| barrier::value(t.distance, t.reach, t.stiffness)).sum::<f64>();
        }
        sum + self.friction.value(x)
    }

    /// Adds the gradient [N].
    pub fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]) {
        if let Some(ground) = self.ground {
            for (p, (x, g)) in x.iter().zip(out.iter_mut()).enumerate() {
                g.y += barrier::slope(x.y - ground.height, self.settings.distance, self.ground_stiffness(p));
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
        if let Some(ground) = self.ground {
            let up = Mat3::from_diagonal(&Vec3::y());
            for (p, x) in x.iter().enumerate() {
                let k = barrier::curvature(x.y - ground.height, self.settings.distance, self.ground_stiffness(p));
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

    /// Visits the groups of points that the Hessian at `x` couples.
    pub fn visit_stencils(&self, x: &[Vec3], visit: &mut dyn FnMut(&[u32])) {
        if let Some(layers) = &self.layers {
            layers.touches(x).iter().for_each(|t: &Touch| visit(&t.points));
        }
        for s in self.friction.sliders.iter().filter(|s| s.weights[1] != 0.0 || s.weights[2] != 0.0) {
            visit(&s.points);
        }
    }
}
