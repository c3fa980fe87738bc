//! Surface of a garment as the transfer sees it: triangles in space with texture coordinates and warp direction on each.
//!
//! A surface is made from a garment, or from the mesh of a sidecar (`crease_io::sidecar_surface`).

use crate::garment::{Garment, RestState, RigidParts, SourceAsset, corner_uvs, corner_vertices};
use crate::remesh::carry::tuning::TUNING;
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::distance::barycentric;
use crease_geometry::mesh::{PointIndex, Topology, triangle};
use nalgebra::{Matrix2, Matrix3x2};

/// A triangulated garment surface.
#[derive(Debug, Clone)]
pub struct GarmentSurface {
    /// Positions, one per point [m], y up.
    pub points: Vec<Vec3>,
    /// Corners of every triangle.
    pub triangles: Vec<[PointIndex; 3]>,
    /// Edges and hinges of the triangles.
    pub topology: Topology,
    /// Per triangle: texture coordinates of its corners.
    pub uvs: Option<Vec<[Vec2; 3]>>,
    /// Per triangle: unit direction of the warp in its plane.
    pub warp: Option<Vec<Vec3>>,
    /// Per point: whether it lies on a line that was drawn for a fold, or on a row beside one; `None` where that is not known.
    pub on_fold_line: Option<Vec<bool>>,
}

impl GarmentSurface {
    /// The surface of `garment`, which was made from `asset`, with its texture coordinates.
    pub fn from_garment(garment: &Garment, asset: &SourceAsset) -> Self {
        let uvs = corner_vertices(asset, garment).and_then(|corners| corner_uvs(asset, &corners));
        Self { uvs, ..Self::without_texture(garment) }
    }

    /// The surface of `garment` without texture coordinates.
    pub fn without_texture(garment: &Garment) -> Self {
        let warp = garment.triangles.iter().zip(&garment.material).map(|(t, flat)| {
            let edge = flat[1] - flat[0];
            warp_direction(&t.map(|p| garment.points[p.at()]), edge.y.atan2(edge.x))
        });
        Self {
            points: garment.points.clone(),
            triangles: garment.triangles.clone(),
            topology: garment.topology.clone(),
            uvs: None,
            warp: Some(warp.collect()),
            on_fold_line: garment.on_fold_line.clone(),
        }
    }

    /// The part of the surface, that of a garment, that belongs to the cloth of `rigid`.
    pub fn of_cloth(&self, rigid: &RigidParts) -> Self {
        let cloth = rigid.cloth();
        let own = || rigid.cloth_triangles().iter().map(|f| *f as usize);
        Self {
            points: cloth.points.clone(),
            triangles: cloth.triangles.clone(),
            topology: cloth.topology.clone(),
            uvs: self.uvs.as_ref().map(|uvs| own().map(|f| uvs[f]).collect()),
            warp: self.warp.as_ref().map(|warp| own().map(|f| warp[f]).collect()),
            on_fold_line: cloth.on_fold_line.clone(),
        }
    }

    /// The surface of `garment`, a refinement of `coarse`. `parent` holds, per triangle, the coarse triangle it lies on;
    /// texture coordinates are interpolated there.
    pub fn from_refined(coarse: &Self, garment: &Garment, asset: &SourceAsset, parent: &[u32]) -> Self {
        let mut surface = Self::from_garment(garment, asset);
        surface.uvs = coarse.uvs.as_ref().map(|uvs| {
            let each = garment.triangles.iter().zip(parent);
            each.map(|(t, &f)| {
                let (whole, uv) = (coarse.corners(f as usize), &uvs[f as usize]);
                t.map(|p| {
                    let weights = barycentric(&garment.points[p.at()], &whole);
                    uv[0] * weights[0] + uv[1] * weights[1] + uv[2] * weights[2]
                })
            })
            .collect()
        });
        surface
    }

    /// Corners of triangle `f` [m].
    pub fn corners(&self, f: usize) -> [Vec3; 3] {
        self.triangles[f].map(|p| self.points[p.at()])
    }

    /// Centroid of triangle `f` [m].
    pub fn centroid(&self, f: usize) -> Vec3 {
        self.corners(f).iter().sum::<Vec3>() / 3.0
    }

    /// Twice the area of triangle `f` times its unit normal [m²].
    pub fn normal(&self, f: usize) -> Vec3 {
        triangle::area_vector(&self.corners(f))
    }

    /// Texture gradient dX/d(u, v) of triangle `f`, if it has texture coordinates of some area.
    pub fn texture_gradient(&self, f: usize) -> Option<Matrix3x2<f64>> {
        self.uvs.as_ref().and_then(|uvs| texture_gradient(&self.corners(f), &uvs[f]))
    }

    /// Whether `other` has exactly the same points and triangles.
    pub fn is_same_mesh(&self, other: &Self) -> bool {
        self.points == other.points && self.triangles == other.triangles
    }

    /// Reflection of x at the centre of the bounding box.
    pub fn reflection(&self) -> impl Fn(&Vec3) -> Vec3 + use<> {
        let (low, high) = crease_geometry::math::bounds(&self.points);
        move |p| Vec3::new(low.x + high.x - p.x, p.y, p.z)
    }

    /// The surface and its memory reflected in x at the centre of the bounding box, triangles reversed so that normals
    /// stay outside. Texture coordinates are dropped: they are those of the other side.
    pub fn mirrored(&self, memory: &RestState) -> (Self, RestState) {
        let points: Vec<Vec3> = self.points.iter().map(self.reflection()).collect();
        let triangles: Vec<[PointIndex; 3]> = self.triangles.iter().map(|t| [t[0], t[2], t[1]]).collect();
        let topology = Topology::new(points.len(), &triangles);
        // The edges are the same, and so are the hinges edge by edge. Reflection and reversal together keep angle signs.
        let of_edge = |values: &[f64]| -> Vec<f64> {
            let own = |h: &crease_geometry::mesh::Hinge| self.topology.edge_hinge[h.edge as usize];
            topology.hinges.iter().map(|h| own(h).map_or(0.0, |i| values[i as usize])).collect()
        };
        let memory = RestState {
            source_angle: of_edge(&memory.source_angle),
            rest_angle: of_edge(&memory.rest_angle),
            stiffness_ratio: of_edge(&memory.stiffness_ratio),
            rest_stretch_warp: memory.rest_stretch_warp.clone(),
            rest_stretch_weft: memory.rest_stretch_weft.clone(),
        };
        let warp = self.warp.as_ref().map(|all| all.iter().map(|w| Vec3::new(-w.x, w.y, w.z)).collect());
        (
            Self { points, triangles, topology, uvs: None, warp, on_fold_line: self.on_fold_line.clone() },
            memory,
        )
    }

    /// +1 if the normals point out of the garment, -1 if into it; +1 for a surface that encloses next to no volume.
    pub fn orientation_sign(&self) -> f64 {
        let centre = self.points.iter().sum::<Vec3>() / self.points.len().max(1) as f64;
        let (mut volume, mut area) = (0.0, 0.0);
        for f in 0..self.triangles.len() {
            let normal = self.normal(f);
            volume += normal.dot(&(self.centroid(f) - centre));
            area += normal.norm();
        }
        let (low, high) = crease_geometry::math::bounds(&self.points);
        if volume < -TUNING.min_enclosed_volume_ratio * area * (high - low).norm() { -1.0 } else { 1.0 }
    }
}

/// Unit warp direction of a triangle whose first side is at `angle` [rad] to it, counter-clockwise seen from outside.
pub fn warp_direction(corners: &[Vec3; 3], angle: f64) -> Vec3 {
    let side = (corners[1] - corners[0]).try_normalize(0.0).unwrap_or_else(Vec3::x);
    let normal = triangle::normal(corners).unwrap_or_else(Vec3::z);
    side * angle.cos() - normal.cross(&side) * angle.sin()
}

/// dX/d(u, v) of a triangle; `None` where the texture has no area.
pub fn texture_gradient(x: &[Vec3; 3], uv: &[Vec2; 3]) -> Option<Matrix3x2<f64>> {
    let edges = Matrix3x2::from_columns(&[x[1] - x[0], x[2] - x[0]]);
    let texture = Matrix2::from_columns(&[uv[1] - uv[0], uv[2] - uv[0]]);
    let gradient = edges * texture.try_inverse()?;
    gradient.iter().all(|g| g.is_finite()).then_some(gradient)
}
