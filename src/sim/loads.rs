//! What a wear action does to the cloth during one step: the forces and guides that the solver adds.

use crate::energy::{EdgeContact, PlaneContact, TargetSpring};
use crate::math::Vec3;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A ball that closes around the cloth.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct SphereLoad {
    /// Centre [m].
    #[serde(with = "crate::math::serde_vec::vector")]
    pub centre: Vec3,
    /// Radius [m].
    pub radius: f64,
    /// What the hands that close it can press with at most, on every piece of cloth that is outside [Pa].
    pub pressure: f64,
}

/// Everything that acts on the cloth from outside, as it is at the end of a step.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct Loads {
    /// Acceleration of gravity [m/s²].
    #[serde(with = "crate::math::serde_vec::vector")]
    pub gravity: Vec3,
    /// Height of the ground [m], if there is one.
    pub ground: Option<f64>,
    /// Height of a ceiling that presses from above [m], if there is one.
    pub ceiling: Option<f64>,
    /// Where the points of the body are [m], one per point, where there is a body.
    // Gestures put it there anew when a run is taken up.
    #[serde(skip)]
    pub body: Option<Arc<[Vec3]>>,
    /// What of a body is under single points of the cloth: a bake makes it from `body`, step by step.
    #[serde(skip)]
    pub plane_contacts: Arc<[PlaneContact]>,
    /// What of it is under triangles and edges of the cloth, made with them.
    #[serde(skip)]
    pub edge_contacts: Arc<[EdgeContact]>,
    /// Where the body takes the cloth along in this step, one move per point [m]: a guess to start from. Empty for none.
    #[serde(skip)]
    pub body_displacement: Arc<[Vec3]>,
    /// Share of the fabric's friction that acts: 0 where hands let the cloth slide.
    pub friction: f64,
    /// Springs that draw points along.
    #[serde(rename = "guides")]
    pub springs: Vec<TargetSpring>,
    /// Whether hands lead the cloth along a way of theirs by these.
    #[serde(rename = "leads")]
    pub guided: bool,
    /// Whether what acts is on its way from one thing to another, so that where the cloth is now is gone over again.
    #[serde(default, rename = "passing")]
    pub transient: bool,
    /// Points that are held where they are, one flag per point; empty for none.
    #[serde(rename = "held")]
    pub fixed: Vec<bool>,
    /// Pressure from above on every uncovered part [Pa].
    pub pressure: f64,
    /// Points that it acts on, one flag per point; empty for all.
    pub pressed: Vec<bool>,
    /// A closing ball.
    #[serde(rename = "ball")]
    pub sphere: Option<SphereLoad>,
    /// Air drag [1/s].
    pub drag: f64,
    /// Longest step that still follows the motion [s].
    #[serde(rename = "longest_step", with = "crate::math::serde_vec::limit")]
    pub max_dt: f64,
}

/// Standard gravity, y up [m/s²].
pub const GRAVITY: f64 = 9.81;

impl Loads {
    /// Whether the cloth is on its own: nobody leads, holds or presses it, and it is on no body.
    pub fn is_unloaded(&self) -> bool {
        let held = self.fixed.contains(&true) || !self.springs.is_empty();
        let pressed = self.pressure > 0.0 || self.sphere.is_some() || self.ceiling.is_some();
        // What a bake makes of a body takes its place.
        let worn = self.body.is_some() || !self.body_displacement.is_empty();
        !held && !pressed && !worn
    }

    /// Nothing but gravity, the ground and still air.
    pub fn gravity_only(ground: Option<f64>) -> Self {
        Self {
            gravity: Vec3::new(0.0, -GRAVITY, 0.0),
            ground,
            ceiling: None,
            body: None,
            plane_contacts: Arc::new([]),
            edge_contacts: Arc::new([]),
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
