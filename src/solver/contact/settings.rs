//! Settings of contact that follow from the fabric and the model.

use crate::contact::tuning::TUNING;
use crease_model::fabric::Fabric;

/// Distances, stiffness and friction of the contact of one garment.
#[derive(Debug, Clone, PartialEq)]
pub struct ContactSettings {
    /// Activation distance d-hat of the barrier [m]: cloth nearer to cloth than this is pushed apart. The thickness of one layer.
    pub dhat: f64,
    /// Stiffness per area [N/m³]: pressure per metre of approach.
    pub stiffness: f64,
    /// Friction coefficient, cloth on cloth [-].
    pub friction: f64,
    /// Friction coefficient, cloth on ground [-].
    pub friction_ground: f64,
    /// Friction coefficient, cloth on body [-].
    pub friction_body: f64,
    /// Static over kinetic friction [-]; 1 for plain Coulomb friction.
    pub static_ratio: f64,
    /// Speed below which a contact counts as sticking (eps_v of IPC) [m/s].
    pub slip_velocity_tol: f64,
    /// Whether cloth collides with cloth.
    pub self_contact: bool,
}

impl ContactSettings {
    /// Settings for cloth of `fabric` with plain Coulomb friction; on a body the coefficient is that on the ground.
    ///
    /// `dhat`: activation distance [m]; `stiffness` per area [N/m³]; `self_contact`: whether cloth collides with cloth.
    pub fn for_fabric(fabric: &Fabric, dhat: f64, stiffness: f64, self_contact: bool) -> Self {
        Self {
            friction: fabric.friction,
            friction_ground: fabric.friction_ground,
            friction_body: fabric.friction_ground,
            self_contact,
            ..Self::uniform(dhat, stiffness, 0.0)
        }
    }

    /// Settings with the same coefficient of plain Coulomb `friction` on cloth, ground and body.
    ///
    /// `dhat`: activation distance [m]; `stiffness` per area [N/m³].
    pub fn uniform(dhat: f64, stiffness: f64, friction: f64) -> Self {
        Self {
            dhat,
            stiffness,
            friction,
            friction_ground: friction,
            friction_body: friction,
            static_ratio: 1.0,
            slip_velocity_tol: TUNING.friction.slip_velocity_tol,
            self_contact: true,
        }
    }
}

/// Distances, stiffness and friction of a body under cloth.
#[derive(Debug, Clone, PartialEq)]
pub struct BodyContactSettings {
    /// Activation distances of points of the cloth on the surface of the body [m], one per point.
    pub point_dhat: Vec<f64>,
    /// Activation distance of points and edges of the body on triangles and edges of the cloth [m].
    pub edge_dhat: f64,
    /// Stiffness per area [Pa/m].
    pub stiffness: f64,
    /// Areas of the points of the cloth [m²], one per point.
    pub areas: Vec<f64>,
    /// Friction coefficient [-].
    pub friction: f64,
    /// Speed below which a contact counts as sticking (eps_v of IPC) [m/s].
    pub slip_velocity_tol: f64,
}

impl BodyContactSettings {
    /// Returns the mean activation distance of points of the cloth [m].
    pub fn mean_point_dhat(&self) -> f64 {
        self.point_dhat.iter().sum::<f64>() / self.point_dhat.len().max(1) as f64
    }
}
