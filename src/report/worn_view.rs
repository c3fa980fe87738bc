//! The worn surface as a picture shows it: a finer mesh with the normals that the wear turns, from what a sidecar holds.

use crate::report::render::{Field, Values, smooth_corner_normals};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_io::gltf::{
    DetailInput, FINE_EDGE, FineOutput, FlatNormals, WRINKLES_NAME, has_worn_target, write_fine_glb,
};
use crease_io::{Sidecar, sidecar_surface};
use crease_model::error::Result;
use crease_model::fabric::{DEFAULT_FABRIC, Fabric};
use crease_model::garment::{Garment, SourceAsset, WornGarment};
use crease_model::remesh::{FileMesh, FileTriangle, FineMesh, FineVertex, WornSurface};

/// A worn surface to be drawn.
#[derive(Debug, Clone)]
pub struct WornView {
    /// Position per point, those of the garment first [m].
    pub points: Vec<Vec3>,
    /// Triangles over the points.
    pub triangles: Vec<[PointIndex; 3]>,
    /// Unit normals per triangle and corner.
    pub normals: Vec<[Vec3; 3]>,
    /// Per triangle: the triangle of the garment that it is a part of.
    parent: Vec<u32>,
    /// Per point beyond those of the garment: the mean of them that it is.
    means: Vec<FineVertex>,
}

impl WornView {
    /// The worn surface that `sidecar` holds; `file` is its name in messages.
    ///
    /// # Errors
    /// Those of [`sidecar_surface`].
    pub fn of_sidecar(file: &str, sidecar: &Sidecar) -> Result<Self> {
        let surface = worn_surface(file, sidecar)?;
        let (points, triangles) = (sidecar.mesh_points(), sidecar.mesh_triangles());
        let after: Vec<Vec3> = points.iter().zip(&sidecar.worn().displacement).map(|(x, d)| x + d).collect();
        let starts = surface.starts(&points, &triangles);
        let of_file = triangles.iter().zip(starts).map(|(t, start)| {
            let points = t.map(|p| p.0);
            FileTriangle { points, vertices: points, start }
        });
        let of_file: Vec<FileTriangle> = of_file.collect();
        let file =
            FileMesh { points: &points, after: &after, vertex_count: points.len(), triangles: &of_file };
        let fine = FineMesh::new(&file, &surface, FINE_EDGE);
        let normals = corner_normals(&file, &triangles, &fine);
        Ok(Self {
            points: fine.points.iter().map(|point| point.position).collect(),
            triangles: fine.triangles.iter().map(|t| t.map(PointIndex)).collect(),
            normals,
            parent: fine.parent,
            means: fine.vertices,
        })
    }

    /// The field of the garment on the finer mesh, with the limits of its legend.
    pub fn carried(&self, field: &Field) -> Field {
        let values = match &field.values {
            Values::PerPoint(values) => {
                let mean = |vertex: &FineVertex| -> f64 {
                    let parts = vertex.of.iter().zip(vertex.weights);
                    parts.map(|(p, w)| if w > 0.0 { values[*p as usize] * w } else { 0.0 }).sum()
                };
                Values::PerPoint(values.iter().copied().chain(self.means.iter().map(mean)).collect())
            }
            Values::PerTriangle(values) => {
                let of_parent = |f: &u32| values.get(*f as usize).copied().unwrap_or(f64::NAN);
                Values::PerTriangle(self.parent.iter().map(of_parent).collect())
            }
        };
        Field { values, range: Some(field.limits()), ..field.clone() }
    }
}

/// The worn surface that `sidecar` holds; `file` is its name in messages.
fn worn_surface(file: &str, sidecar: &Sidecar) -> Result<WornSurface> {
    let of = sidecar.simulated.as_deref().unwrap_or(sidecar);
    let (mesh, memory) = sidecar_surface(file, of)?;
    let displacement = of.worn().displacement;
    let fabric = serde_json::from_value::<Fabric>(sidecar.fabric.clone());
    let fabric = fabric.or_else(|_| Fabric::preset(DEFAULT_FABRIC))?;
    Ok(WornSurface::new(&mesh, &WornGarment { displacement, memory }, fabric.crease_width()))
}

/// The worn file `glb`, which was read as `asset`, with the worn surface that its `sidecar` holds in place of its own triangles; `None` for one that shows
/// it already, by a map or as its base shape.
///
/// # Errors
/// Those of [`sidecar_surface`] and [`write_fine_glb`].
pub fn fine_worn_glb(glb: &[u8], asset: &SourceAsset, sidecar: &Sidecar) -> Result<Option<FineOutput>> {
    let Some(document) = &asset.document else { return Ok(None) };
    let is_named = |list: &str, name: &str| {
        document.json[list].as_array().is_some_and(|all| all.iter().any(|one| one["name"] == name))
    };
    if is_named("images", WRINKLES_NAME) || !has_worn_target(document) {
        return Ok(None);
    }
    let surface = worn_surface(&asset.file, sidecar)?;
    let triangles: Vec<[u32; 3]> = sidecar.mesh_triangles().iter().map(|t| t.map(|p| p.0)).collect();
    let mut coarse = Garment::of_triangles(sidecar.mesh_points(), &triangles);
    coarse.source_point = sidecar.mesh.source_point.iter().map(|&p| PointIndex(p)).collect();
    let displacement = sidecar.worn().displacement;
    let detail = DetailInput {
        coarse: &coarse,
        displacement: &displacement,
        surface: &surface,
        flat_normals: FlatNormals::default(),
    };
    write_fine_glb(glb, asset, &detail, FINE_EDGE).map(Some)
}

/// Normals of the corners of `fine`: those of the garment, smooth but for sharp edges, turned by the wear.
fn corner_normals(file: &FileMesh, triangles: &[[PointIndex; 3]], fine: &FineMesh) -> Vec<[Vec3; 3]> {
    let [before, after] = [file.points, file.after].map(|points| smooth_corner_normals(points, triangles));
    let count = file.points.len();
    let corner = |normals: &[[Vec3; 3]], parent: u32, v: u32| -> Vec3 {
        let of_file = |v: u32| {
            let t = &triangles[parent as usize];
            t.iter().position(|p| p.0 == v).map_or_else(Vec3::zeros, |k| normals[parent as usize][k])
        };
        match (v as usize).checked_sub(count).and_then(|k| fine.vertices.get(k)) {
            Some(vertex) => vertex.of.iter().zip(vertex.weights).map(|(v, w)| of_file(*v) * w).sum(),
            None => of_file(v),
        }
    };
    let all = fine.triangles.iter().zip(&fine.parent).map(|(t, parent)| {
        t.map(|v| {
            let normal = match fine.points.get(v as usize).and_then(|point| point.turn) {
                Some(turn) => turn * corner(&before, *parent, v),
                None => corner(&after, *parent, v),
            };
            normal.try_normalize(f64::MIN_POSITIVE).unwrap_or_else(Vec3::y)
        })
    });
    all.collect()
}
