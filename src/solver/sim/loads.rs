//! External loads on the cloth during one step: gravity, springs, pressure, planes, fixed points and the body.

use crate::energy::{EdgeContact, Leash, PlaneContact, TargetSpring};
use crate::sim::state::State;
use crease_geometry::math::Vec3;
use crease_model::body::PosedBody;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// Source of the loads on the cloth over a step.
pub trait LoadSource {
    /// The loads at `time` [s] in a step that begins at `state`.
    fn loads_at(&mut self, time: f64, state: &State) -> Loads;

    /// All contacts with points and edges of the body, where the solved positions `x` [m] of a step under `loads` show that some were
    /// missing or too weak; `None` where they do not.
    fn revised_contacts(&mut self, x: &[Vec3], loads: &Loads) -> Option<Arc<[EdgeContact]>> {
        let _ = (x, loads);
        None
    }

    /// Whether at the solved positions `x` [m] of a step under `loads` more of the cloth crosses an obstacle than a step may add.
    fn crosses_more(&mut self, x: &[Vec3], loads: &Loads) -> bool {
        let _ = (x, loads);
        false
    }
}

impl<F: FnMut(f64, &State) -> Loads> LoadSource for F {
    fn loads_at(&mut self, time: f64, state: &State) -> Loads {
        self(time, state)
    }
}

/// A shrinking sphere that encloses the cloth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SphereLoad {
    /// Centre of the sphere [m].
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    pub centre: Vec3,
    /// Radius of the sphere [m].
    pub radius: f64,
    /// Maximum pressure on the cloth outside the sphere [Pa].
    pub pressure: f64,
}

/// External loads on the cloth at the end of a step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Loads {
    /// Acceleration of gravity [m/s²].
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    pub gravity: Vec3,
    /// Height of the ground [m], if there is one.
    pub ground: Option<f64>,
    /// Height of a ceiling that presses from above [m], if there is one.
    pub ceiling: Option<f64>,
    /// The body in its pose; `None` without a body.
    // Actions set it again when a run is resumed.
    #[serde(skip)]
    pub body: Option<PosedBody>,
    /// Contacts of single points of the cloth with the body, which a bake finds from `body` in every step.
    #[serde(skip)]
    pub plane_contacts: Arc<[PlaneContact]>,
    /// Contacts of triangles of the cloth with the body, found together with them.
    #[serde(skip)]
    pub edge_contacts: Arc<[EdgeContact]>,
    /// Leashes of points of the cloth to their skinned positions, which a bake finds from the pose of `body`.
    #[serde(skip)]
    pub leashes: Arc<[Leash]>,
    /// Displacements with which the body carries the cloth along in this step, one per point [m]: the initial guess of
    /// the solver. Empty for none.
    #[serde(skip)]
    pub body_displacement: Arc<[Vec3]>,
    /// Factor on the friction coefficients of the fabric [-]: 0 for none.
    pub friction: f64,
    /// Springs that pull points towards targets.
    pub springs: Vec<TargetSpring>,
    /// Whether springs or a moving body guide the cloth along a prescribed path.
    pub guided: bool,
    /// Whether the loads are in transition, so that the positions of this step are solved for again right after it.
    pub transient: bool,
    /// Points with prescribed positions, one flag per point; empty for none.
    pub fixed: Vec<bool>,
    /// Pressure from above on every uncovered triangle [Pa].
    pub pressure: f64,
    /// Points on which the pressure acts, one flag per point; empty for all.
    pub pressed: Vec<bool>,
    /// A shrinking sphere, if there is one.
    pub sphere: Option<SphereLoad>,
    /// Rate of linear air drag [1/s].
    pub drag: f64,
    /// Maximum time step that resolves the motion of the loads [s].
    #[serde(with = "crease_geometry::math::serde_vec::limit")]
    pub max_dt: f64,
}

/// Standard gravity, y up [m/s²].
pub const GRAVITY: f64 = 9.81;

impl Loads {
    /// Whether only gravity, the ground and drag act: no springs, fixed points, pressure or body.
    pub fn is_unloaded(&self) -> bool {
        let constrained = self.fixed.contains(&true) || !self.springs.is_empty();
        let pressed = self.pressure > 0.0 || self.sphere.is_some() || self.ceiling.is_some();
        // A bake replaces the body by its contacts and displacements.
        let on_body = self.body.is_some() || !self.body_displacement.is_empty();
        !constrained && !pressed && !on_body
    }

    /// Returns gravity and still air, with the ground at height `ground` [m] if there is one.
    pub fn gravity_only(ground: Option<f64>) -> Self {
        Self {
            gravity: Vec3::new(0.0, -GRAVITY, 0.0),
            ground,
            ceiling: None,
            body: None,
            plane_contacts: Arc::new([]),
            edge_contacts: Arc::new([]),
            leashes: Arc::new([]),
            body_displacement: Arc::new([]),
            friction: 1.0,
            springs: Vec::new(),
            guided: false,
            transient: false,
            fixed: Vec::new(),
            pressure: 0.0,
            pressed: Vec::new(),
            sphere: None,
            drag: 1.0,
            max_dt: f64::INFINITY,
        }
    }
}
