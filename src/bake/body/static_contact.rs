//! Contact with a body that does not move, for solves without time: dressing, and the relaxation to the source pose.
//!
//! The same planes and edges as in a step (`contact::body_planes`), without friction. Contact may be limited to the gaps of a shape of the
//! cloth: nothing is pushed farther out than it lies there, over whatever place of the body it lay.

use crate::bake::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_model::body::AnimatedBody;
use crease_model::garment::Garment;
use crease_solver::contact::{BodyContactSettings, BodyIntersections, BodyPlanes, ContactSettings};
use crease_solver::energy::{EdgeContact, PlaneContact};
use rustc_hash::FxHashMap;

/// Settings of the contact of `garment`, whose points stand for `areas` [m²], with a body.
pub(in crate::bake) fn body_contact_settings(
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
pub(in crate::bake) struct StaticContact<'a> {
    planes: &'a mut BodyPlanes,
    positions: &'a [Vec3],
    normals: Vec<Vec3>,
    garment: &'a Garment,
    /// Gaps that contact is limited to, if it is.
    limits: Option<GapLimits>,
}

/// Contacts of the cloth where it was when they were found.
pub(in crate::bake) struct FoundContacts {
    /// Points of the cloth on the body.
    pub planes: Vec<PlaneContact>,
    /// Points and edges of the body under the cloth.
    pub edges: Vec<EdgeContact>,
}

impl<'a> StaticContact<'a> {
    /// The contact of `garment` with `body` by `planes`.
    pub fn new(planes: &'a mut BodyPlanes, garment: &'a Garment, body: &'a AnimatedBody) -> Self {
        let positions = body.rest_points();
        Self { normals: planes.normals(positions), planes, positions, garment, limits: None }
    }

    /// The same, with nothing pushed farther out of the body than it lies in the source shape of the garment.
    pub fn limited_to_source(mut self) -> Self {
        let x = &self.garment.points;
        let found = self.find(x);
        self.limits = Some(GapLimits::new(&found, x));
        self
    }

    /// The contacts of the cloth at `x` [m].
    pub fn find(&mut self, x: &[Vec3]) -> FoundContacts {
        self.planes.begin_step(x, &self.garment.triangles, &self.garment.topology, &[]);
        let target = self.planes.resolve_self_contact(self.positions);
        let planes = self.planes.plane_contacts(x, &target, &self.normals, 1.0, 0.0);
        let edges = self.planes.edge_contacts(&target, &self.normals);
        let mut found = FoundContacts { planes, edges };
        if let Some(limits) = &self.limits {
            limits.apply(&mut found, &self.garment.points);
        }
        found
    }

    /// Accepts the cloth at `x` [m], solved with `found`. Where it still intersects the body, contacts act from farther away
    /// from then on.
    pub fn accept(&mut self, x: &[Vec3], found: &FoundContacts) -> BodyIntersections {
        self.planes.end_step(x, self.positions, &found.planes, &found.edges);
        self.planes.raise_offsets(x, &self.garment.triangles, false)
    }
}

/// Heights of the cloth over a body in a shape of it.
struct GapLimits {
    /// Per point that is near the body: its height [m].
    points: FxHashMap<u32, f64>,
    /// Per edge and triangle of the cloth over points and edges of the body, by their points: the lowest height [m].
    over: FxHashMap<[u32; 3], f64>,
}

impl GapLimits {
    /// Those of the contacts `found` with the cloth at `x` [m].
    fn new(found: &FoundContacts, x: &[Vec3]) -> Self {
        let mut over: FxHashMap<[u32; 3], f64> = FxHashMap::default();
        for contact in &found.edges {
            let lowest = over.entry(contact.points).or_insert(f64::INFINITY);
            *lowest = lowest.min(contact.gap(x));
        }
        let points = found.planes.iter().map(|c| (c.point, c.gap(&x[c.point as usize]))).collect();
        Self { points, over }
    }

    /// Lets contacts act no farther out than the cloth lay in the shape, where it was at `x` [m]. What was not over the body there is
    /// measured over the place where it is now.
    fn apply(&self, found: &mut FoundContacts, x: &[Vec3]) {
        for c in &mut found.planes {
            let limit = self.points.get(&c.point).copied();
            c.dhat = c.dhat.min(limit.unwrap_or_else(|| c.gap(&x[c.point as usize])));
        }
        for c in &mut found.edges {
            let limit = self.over.get(&c.points).copied();
            c.dhat = c.dhat.min(limit.unwrap_or_else(|| c.gap(x)));
        }
    }
}
