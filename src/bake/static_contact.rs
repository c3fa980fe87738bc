//! Contact with a body that does not move, for solves without time: dressing, and the relaxation to the source pose.
//!
//! The same planes and edges as in a step (`contact::body_planes`), without friction. Contact may be limited to a shape of
//! the cloth that is allowed: nothing is pushed farther out than it lies there.

use crate::bake::tuning::TUNING;
use crate::body::AnimatedBody;
use crate::contact::{BodyContactSettings, BodyIntersections, BodyPlanes, ContactSettings};
use crate::energy::{EdgeContact, PlaneContact};
use crate::garment::Garment;
use crate::math::Vec3;

/// Settings of the contact of `garment`, whose points stand for `areas` [m²], with a body.
pub(super) fn body_contact_settings(
    garment: &Garment,
    settings: &ContactSettings,
    areas: Vec<f64>,
) -> BodyContactSettings {
    BodyContactSettings {
        point_dhat: mean_square_edges(garment)
            .into_iter()
            .map(|square| settings.dhat + square / (8.0 * TUNING.body.limb_radius))
            .collect(),
        edge_dhat: settings.dhat,
        stiffness: TUNING.body.contact_stiffness,
        areas,
        friction: settings.friction_body,
        slip_velocity_tol: settings.slip_velocity_tol,
    }
}

/// Means of the squared lengths of the edges at every point of `garment` [m²].
fn mean_square_edges(garment: &Garment) -> Vec<f64> {
    let mut sum = vec![[0.0, 0.0]; garment.points.len()];
    for &[a, b] in &garment.topology.edges {
        let square = (garment.points[a.at()] - garment.points[b.at()]).norm_squared();
        for p in [a, b] {
            sum[p.at()][0] += square;
            sum[p.at()][1] += 1.0;
        }
    }
    sum.into_iter().map(|[square, count]| square / f64::max(count, 1.0)).collect()
}

/// A body in the pose of its file, and its contact with the cloth.
pub(super) struct StaticContact<'a> {
    planes: &'a mut BodyPlanes,
    positions: &'a [Vec3],
    normals: Vec<Vec3>,
    garment: &'a Garment,
}

/// Contacts of the cloth where it was when they were found.
pub(super) struct FoundContacts {
    /// Points of the cloth on the body.
    pub planes: Vec<PlaneContact>,
    /// Points and edges of the body under the cloth.
    pub edges: Vec<EdgeContact>,
}

impl<'a> StaticContact<'a> {
    /// The contact of `garment` with `body` by `planes`.
    pub fn new(planes: &'a mut BodyPlanes, garment: &'a Garment, body: &'a AnimatedBody) -> Self {
        let positions = body.rest_points();
        Self { normals: planes.normals(positions), planes, positions, garment }
    }

    /// The contacts of the cloth at `x` [m], no farther out than it lies in the shape `allowed` [m], if there is one.
    pub fn find(&mut self, x: &[Vec3], allowed: Option<&[Vec3]>) -> FoundContacts {
        self.planes.begin_step(x, &self.garment.triangles, &self.garment.topology, &[]);
        let target = self.planes.resolve_self_contact(self.positions);
        let mut planes = self.planes.plane_contacts(x, &target, &self.normals, 1.0, 0.0);
        let mut edges = self.planes.edge_contacts(&target, &self.normals);
        if let Some(allowed) = allowed {
            planes.iter_mut().for_each(|c| c.dhat = c.dhat.min(c.gap(&allowed[c.point as usize])));
            edges.iter_mut().for_each(|c| c.dhat = c.dhat.min(c.gap(allowed)));
        }
        FoundContacts { planes, edges }
    }

    /// Accepts the cloth at `x` [m], solved with `found`. Where it still intersects the body, contacts act from farther away
    /// from then on.
    pub fn accept(&mut self, x: &[Vec3], found: &FoundContacts) -> BodyIntersections {
        self.planes.end_step(x, self.positions, &found.planes, &found.edges);
        self.planes.raise_offsets(x, &self.garment.triangles, false)
    }
}
