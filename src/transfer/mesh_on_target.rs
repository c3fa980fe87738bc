//! Correspondence of a mesh on the surface of a target with a source: that of the target's own triangles.

use crease_geometry::math::Vec3;
use crease_geometry::mesh::SurfaceWalk;
use crease_geometry::mesh::distance::barycentric;
use crease_model::remesh::{Correspondence, GarmentSurface, Match, Query, SimulationMesh, smallest_rotation};

/// A mesh whose points are matched as the triangles of the target that they lie in.
pub(super) struct MeshOnTarget<'a, C> {
    /// Correspondence of the target.
    inner: &'a C,
    target: &'a GarmentSurface,
    mesh: &'a SimulationMesh,
    walk: SurfaceWalk,
    /// +1 if the normals of the target point out of it, else -1.
    outward: f64,
}

impl<'a, C: Correspondence> MeshOnTarget<'a, C> {
    /// Points of `mesh`, which lies on `target`, matched by `inner`.
    pub fn new(inner: &'a C, target: &'a GarmentSurface, mesh: &'a SimulationMesh) -> Self {
        let walk = SurfaceWalk::new(target.points.len(), &target.triangles);
        Self { inner, target, mesh, walk, outward: target.orientation_sign() }
    }
}

impl<C> MeshOnTarget<'_, C> {
    /// Per point of the mesh at `points` [m], in the pose of the target: the triangle of the target that it lies in, with the weights of its corners.
    pub fn places(&self, points: &[Vec3]) -> Vec<(usize, [f64; 3])> {
        let GarmentSurface { points: own, triangles, .. } = self.target;
        let place = |(x, start): (&Vec3, &u32)| {
            let face = self.walk.closest(own, triangles, *start, x) as usize;
            (face, barycentric(x, &self.target.corners(face)))
        };
        points.iter().zip(&self.mesh.source_triangle).map(place).collect()
    }

    /// The `values` of the points of the target at a place of it.
    pub fn interpolated(&self, (face, weights): &(usize, [f64; 3]), values: &[f64]) -> f64 {
        let parts = self.target.triangles[*face].iter().zip(weights);
        // Values that are not known count where the place is not on the opposite side.
        parts.filter(|(_, weight)| weight.abs() > 1e-9).map(|(p, weight)| values[p.at()] * weight).sum()
    }
}

impl<C: Correspondence> Correspondence for MeshOnTarget<'_, C> {
    fn source(&self) -> &GarmentSurface {
        self.inner.source()
    }

    fn find(&self, f: usize, query: &Query) -> Option<Match> {
        let GarmentSurface { points, triangles, .. } = self.target;
        let containing = self.mesh.garment.triangles[f].map(|p| self.mesh.source_triangle[p.at()]);
        let (_, start) = self.walk.nearest_around(points, triangles, &containing, &query.position)?;
        // Between the corners of a large triangle lie others of the target.
        let face = self.walk.closest(points, triangles, start, &query.position) as usize;
        let normal = self.outward * self.target.normal(face).try_normalize(0.0)?;
        let uv = self.target.uvs.as_ref().map(|uvs| {
            let weights = barycentric(&query.position, &self.target.corners(face));
            uvs[face].iter().zip(weights).map(|(uv, weight)| uv * weight).sum()
        });
        let gradient = self.target.texture_gradient(face);
        let found = self.inner.find(face, &Query { position: query.position, uv, normal, gradient })?;
        Some(Match { map: smallest_rotation(&normal, &query.normal) * found.map, ..found })
    }
}
