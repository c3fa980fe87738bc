//! Paints the worn surface into texture space, texel by texel, in the frames of the file's worn triangles.

use crate::gltf::detail::input::DetailInput;
use crate::gltf::detail::material::TextureTransform;
use crate::gltf::detail::surface::ShownSurface;
use crate::gltf::detail::texels::{DetailOf, TexelSample, Texels};
use crease_geometry::math::{Mat3, Vec3};
use crease_geometry::mesh::{PointIndex, triangle_key};
use crease_model::remesh::{CreaseDistances, NearCrease};
use rustc_hash::FxHashMap;
use std::cell::Cell;
use std::f64::consts::PI;

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
    /// Creases of the mask, if it is painted.
    creases: Option<&'a CreaseDistances<'a>>,
    of: DetailOf,
    /// Per triangle of the garment: the vertices of its corners, those of the first side before those of the other sides of
    /// double-sided cloth.
    pub(super) corners: Vec<Vec<SurfaceCorners>>,
    /// Per triangle of the garment: a triangle of the worn surface from which its places are searched.
    starts: Vec<Option<u32>>,
    /// Per surface and vertex: unit normal before the wear, smooth where the vertex is flat-shaded and has a smooth one after it.
    unworn: Vec<Vec<Vec3>>,
}

impl<'a> Painter<'a> {
    pub(super) fn new(
        detail: &'a DetailInput,
        surfaces: &'a [ShownSurface],
        creases: Option<&'a CreaseDistances<'a>>,
        of: DetailOf,
    ) -> Self {
        let mut found: FxHashMap<[PointIndex; 3], Vec<(usize, [usize; 3])>> = FxHashMap::default();
        for (s, surface) in surfaces.iter().enumerate() {
            for t in &surface.piece.triangles {
                let vertices = t.map(|v| v as usize);
                if vertices.iter().all(|&v| v < surface.points.len()) {
                    found
                        .entry(triangle_key(vertices.map(|v| surface.points[v])))
                        .or_default()
                        .push((s, vertices));
                }
            }
        }
        let corners = detail.coarse.triangles.iter().map(|t| {
            let in_order = |&(s, vertices): &(usize, [usize; 3])| {
                let points = surfaces[s].points;
                let mut corners = [0; 3];
                for (corner, p) in corners.iter_mut().zip(t) {
                    *corner = *vertices.iter().find(|&&v| points[v] == *p)?;
                }
                Some(SurfaceCorners { surface: s, vertices: corners })
            };
            found.get(&triangle_key(*t)).into_iter().flatten().filter_map(in_order).collect()
        });
        let unworn = surfaces
            .iter()
            .map(|surface| detail.unworn_normals(surface.points, &surface.unworn, &surface.piece.triangles));
        Self {
            detail,
            surfaces,
            creases,
            of,
            corners: corners.collect(),
            starts: detail.surface.starts(&detail.coarse.points, &detail.coarse.triangles),
            unworn: unworn.collect(),
        }
    }

    /// Paints one map of the surfaces with the indices `painted`, whose texture coordinates `transform` takes to the map.
    pub(super) fn paint(&self, painted: &[usize], transform: TextureTransform, side: usize) -> Texels {
        let mut texels = Texels::new(side);
        for (k, sides) in self.corners.iter().enumerate() {
            for corners in sides.iter().filter(|corners| painted.contains(&corners.surface)) {
                self.paint_triangle(k, corners, transform, &mut texels);
            }
        }
        texels
    }

    /// Paints triangle `k` of the garment with the vertices `corners`.
    fn paint_triangle(
        &self,
        k: usize,
        corners: &SurfaceCorners,
        transform: TextureTransform,
        texels: &mut Texels,
    ) {
        let DetailInput { coarse, displacement, surface: worn, .. } = *self.detail;
        let (surface, unworn) = (&self.surfaces[corners.surface], &self.unworn[corners.surface]);
        let vertices = corners.vertices;
        let before = coarse.triangles[k].map(|p| coarse.points[p.at()]);
        let after = match self.of {
            DetailOf::Rest => coarse.triangles[k].map(|p| coarse.points[p.at()] + displacement[p.at()]),
            DetailOf::All => before,
        };
        let blend = |of: &[Vec3; 3], b: &[f64; 3]| of[0] * b[0] + of[1] * b[1] + of[2] * b[2];
        let own = vertices.map(|v| unworn[v]);
        let normals = vertices.map(|v| surface.worn[v].normal);
        let tangents = vertices.map(|v| surface.worn[v].tangent.direction);
        let handedness = surface.worn[vertices[0]].tangent.handedness;
        // The search for a texel begins where that for the last one ended.
        let Some(start) = self.starts[k] else { return };
        let last = Cell::new(start);
        texels.fill(vertices.map(|v| transform.apply(surface.uvs[v])), &|b| {
            let x = blend(&before, &b);
            let place = worn.at(last.get(), &x);
            last.set(place.face);
            let n = blend(&normals, &b).try_normalize(1e-9)?;
            let t = blend(&tangents, &b).try_normalize(1e-9)?;
            let frame = Mat3::from_columns(&[t, n.cross(&t) * handedness, n]);
            let shown = (place.turn * blend(&own, &b)).try_normalize(1e-9)?;
            let direction = (frame.try_inverse()? * shown).try_normalize(1e-9)?;
            // A map cannot point below its surface.
            (direction.z > 0.0).then(|| TexelSample {
                direction,
                height_m: n.dot(&(place.position - blend(&after, &b))),
                crease: self
                    .creases
                    .and_then(|all| all.at(place.face, &x))
                    .map_or(0.0, |crease| mask(&crease)),
            })
        });
    }
}

/// Angle of a crease as a fraction of half a turn: as it is within its width, from its border down to none over as much again.
fn mask(crease: &NearCrease) -> f64 {
    let beyond = crease.distance / crease.half_width.max(f64::MIN_POSITIVE) - 1.0;
    crease.angle / PI * (1.0 - beyond).clamp(0.0, 1.0)
}
