//! Paints the fine surface into texture space, triangle by triangle, in the frames of the coarse surface.

use crate::gltf::detail::input::DetailInput;
use crate::gltf::detail::material::TextureTransform;
use crate::gltf::detail::surface::{ShownSurface, unit_or};
use crate::gltf::detail::texels::{TexelSample, Texels};
use crate::gltf::worn_target::{LinearPart, WornShape};
use crease_geometry::math::{Mat3, Vec2, Vec3};
use crease_geometry::mesh::PointIndex;
use crease_geometry::mesh::distance::barycentric;
use rustc_hash::FxHashMap;

/// Corners of a coarse triangle.
#[derive(Debug, Clone, Copy)]
pub(super) struct SurfaceCorners {
    /// Index of the surface.
    pub(super) surface: usize,
    /// Vertices of that surface.
    pub(super) vertices: [usize; 3],
}

/// Painter of the maps.
pub(super) struct Painter<'a> {
    detail: &'a DetailInput<'a>,
    surfaces: &'a [ShownSurface<'a>],
    /// Per triangle of the coarse garment: the vertices of its corners.
    pub(super) corners: Vec<Option<SurfaceCorners>>,
    shape: WornShape<'a>,
    /// Per surface and vertex: whether it is flat-shaded and has smooth normals after the wear.
    flat: Vec<Vec<bool>>,
}

impl<'a> Painter<'a> {
    pub(super) fn new(detail: &'a DetailInput, surfaces: &'a [ShownSurface]) -> Self {
        let sorted = |mut points: [PointIndex; 3]| {
            points.sort_unstable();
            points
        };
        let mut found = FxHashMap::default();
        for (s, surface) in surfaces.iter().enumerate() {
            for t in &surface.piece.triangles {
                let vertices = t.map(|v| v as usize);
                if vertices.iter().all(|&v| v < surface.points.len()) {
                    found.entry(sorted(vertices.map(|v| surface.points[v]))).or_insert((s, vertices));
                }
            }
        }
        let corners = detail.coarse.triangles.iter().map(|t| {
            let &(s, vertices) = found.get(&sorted(*t))?;
            let points = surfaces[s].points;
            let mut corners = [0; 3];
            for (corner, p) in corners.iter_mut().zip(t) {
                *corner = *vertices.iter().find(|&&v| points[v] == *p)?;
            }
            Some(SurfaceCorners { surface: s, vertices: corners })
        });
        let shape = WornShape::new(detail.fine, detail.worn, detail.flat_normals);
        // The corners of the file's triangles are points of the fine garment, too.
        let flat = |s: &ShownSurface| shape.flat_vertices(s.points, &s.unworn, &s.piece.triangles);
        let flat = surfaces.iter().map(flat).collect();
        Self { detail, surfaces, corners: corners.collect(), shape, flat }
    }

    /// Paints one map of the surfaces with the indices `painted`, whose texture coordinates `transform` takes to the map.
    pub(super) fn paint(&self, painted: &[usize], transform: TextureTransform, side: usize) -> Texels {
        let mut texels = Texels::new(side);
        let DetailInput { coarse, fine, parent, worn, .. } = *self.detail;
        for (triangle, &k) in fine.triangles.iter().zip(parent) {
            let Some(SurfaceCorners { surface, vertices }) = self.corners[k as usize] else { continue };
            if !painted.contains(&surface) {
                continue;
            }
            let is_flat = vertices.iter().all(|&v| self.flat[surface][v]);
            let surface = &self.surfaces[surface];
            let corners = coarse.triangles[k as usize].map(|p| coarse.points[p.at()]);
            let weights = triangle.map(|p| barycentric(&fine.points[p.at()], &corners));
            let mix = |weights: &[f64; 3], of: &dyn Fn(usize) -> Vec3| -> Vec3 {
                weights.iter().zip(vertices).map(|(w, v)| of(v) * *w).sum()
            };
            let normals: [Vec3; 3] = std::array::from_fn(|i| {
                let base = unit_or(mix(&weights[i], &|v| surface.unworn[v]), Vec3::z());
                let smooth = is_flat.then(|| self.shape.smooth_normal(triangle[i], base)).flatten();
                let rotated = || self.shape.worn_normal(triangle[i], base, LinearPart::identity());
                smooth.or_else(rotated).unwrap_or(base)
            });
            let position = |p: PointIndex, points: &[Vec3]| points[p.at()] + worn.displacement[p.at()];
            let above = triangle.map(|p| position(p, &fine.points));
            let below = coarse.triangles[k as usize].map(|p| position(p, &coarse.points));
            let uv = |w: &[f64; 3]| w.iter().zip(vertices).map(|(w, v)| surface.uvs[v] * *w).sum::<Vec2>();
            let uvs = weights.each_ref().map(|w| transform.apply(uv(w)));
            texels.fill(uvs, &|b| {
                let blend = |of: &[Vec3; 3]| of[0] * b[0] + of[1] * b[1] + of[2] * b[2];
                let on_parent: [f64; 3] = std::array::from_fn(|j| (0..3).map(|i| b[i] * weights[i][j]).sum());
                let n = mix(&on_parent, &|v| surface.worn[v].normal).try_normalize(1e-9)?;
                let t = mix(&on_parent, &|v| surface.worn[v].tangent.direction).try_normalize(1e-9)?;
                let bitangent = n.cross(&t) * surface.worn[vertices[0]].tangent.handedness;
                let frame = Mat3::from_columns(&[t, bitangent, n]);
                let direction =
                    (frame.try_inverse()? * blend(&normals).try_normalize(1e-9)?).try_normalize(1e-9)?;
                let on_coarse: Vec3 = below.iter().zip(on_parent).map(|(x, s)| x * s).sum();
                // A map cannot point below its surface.
                (direction.z > 0.0)
                    .then(|| TexelSample { direction, height_m: n.dot(&(blend(&above) - on_coarse)) })
            });
        }
        texels
    }
}
