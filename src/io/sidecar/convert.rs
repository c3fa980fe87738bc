//! Conversions between a sidecar and the garment, its worn result and its source asset.

use crate::sidecar::format::{
    SIDECAR_FORMAT, Sidecar, SidecarCrease, SidecarHinges, SidecarJoint, SidecarMesh, SidecarPoints,
    SidecarSource, SidecarTriangles, SidecarUp,
};
use crate::tuning::TUNING;
use crease_geometry::math::{Mat3, Vec2, Vec3, bounds};
use crease_geometry::mesh::PointIndex;
use crease_model::error::Result;
use crease_model::garment::{
    Garment, RestState, SourceAsset, SourceFormat, SourceJoint, UpAxis, WornGarment, corner_vertices,
};
use crease_model::remesh::Crease;
use serde_json::{Map, Value};

impl Sidecar {
    /// Creates the sidecar of `worn`, the result of wearing `garment`, which was built from `asset`. `fabric`, `wear` and
    /// `run` are stored as they are. Fails if the parts do not belong together or a number is not finite.
    pub fn new(
        asset: &SourceAsset,
        garment: &Garment,
        worn: &WornGarment,
        fabric: Value,
        wear: Value,
        run: Value,
    ) -> Result<Self> {
        let memory = &worn.memory;
        let mut sidecar = Self {
            format: SIDECAR_FORMAT.to_owned(),
            source: SidecarSource {
                file: asset.file.clone(),
                sha256: asset.sha256.clone(),
                unit_m: asset.unit_m,
                up: match asset.up {
                    UpAxis::Y => SidecarUp::Y,
                    UpAxis::Z => SidecarUp::Z,
                },
                extra: Map::new(),
            },
            mesh: SidecarMesh {
                points_m: garment.points.iter().map(|&p| p.into()).collect(),
                triangles: garment.triangles.iter().map(|t| t.map(|p| p.0)).collect(),
                source_point: garment.source_point.iter().map(|p| p.0).collect(),
                source_uv: source_uv(asset),
                triangle_vertices: corner_vertices(asset, garment),
                fold_line_points: garment.on_fold_line.as_deref().map(indices_of),
                joints: source_joints(asset),
                extra: Map::new(),
            },
            hinges: SidecarHinges {
                points: garment.topology.hinges.iter().map(|h| h.points.map(|p| p.0)).collect(),
                source_angle_rad: memory.source_angle.clone(),
                rest_angle_rad: memory.rest_angle.clone(),
                stiffness_ratio: memory.stiffness_ratio.clone(),
                extra: Map::new(),
            },
            triangles: SidecarTriangles {
                rest_stretch_warp: memory.rest_stretch_warp.clone(),
                rest_stretch_weft: memory.rest_stretch_weft.clone(),
                warp_angle_rad: Some(garment.material.iter().map(warp_angle).collect()),
                confidence: None,
                extra: Map::new(),
            },
            points: SidecarPoints {
                displacement_m: worn.displacement.iter().map(|&d| d.into()).collect(),
                extra: Map::new(),
            },
            checksums: None,
            fabric,
            wear,
            run,
            simulated: None,
            creases: None,
            extra: Map::new(),
        };
        sidecar.checksums = Some(sidecar.compute_checksums());
        sidecar.validate(&asset.file)?;
        Ok(sidecar)
    }

    /// Adds the mesh that was simulated, with its displacement and memory.
    ///
    /// # Errors
    /// [`crease_model::error::Error::Input`] if `worn` does not fit `mesh` or holds a number that is not finite.
    pub fn with_simulated(self, mesh: &Garment, worn: &WornGarment) -> Result<Self> {
        // Of the file nothing but its name and frame belongs to the mesh.
        let SidecarSource { file, sha256, unit_m, up, .. } = self.source.clone();
        let up = if up == SidecarUp::Y { UpAxis::Y } else { UpAxis::Z };
        let (format, document, pieces) = (SourceFormat::Obj, None, Vec::new());
        let bare = SourceAsset {
            file,
            sha256,
            format,
            unit_m,
            unit_is_known: true,
            up,
            document,
            obj: None,
            pieces,
        };
        let mesh = Garment { source_point: Vec::new(), ..mesh.clone() };
        let mut own = Self::new(&bare, &mesh, worn, Value::Null, Value::Null, Value::Null)?;
        own.mesh.source_uv = None;
        own.mesh.triangle_vertices = None;
        Ok(Self { simulated: Some(Box::new(own)), ..self })
    }

    /// Adds the creases of the garment.
    ///
    /// # Errors
    /// [`crease_model::error::Error::Input`] for one that does not lie on its mesh or holds a number that is not finite.
    pub fn with_creases(self, creases: &[Crease]) -> Result<Self> {
        let of = |crease: &Crease| SidecarCrease {
            triangles: crease.places.iter().map(|at| at.face).collect(),
            weights: crease.places.iter().map(|at| at.weights).collect(),
            angle_rad: crease.angle.clone(),
            stiffness_ratio: crease.stiffness_ratio.clone(),
            width_m: crease.width,
            extra: Map::new(),
        };
        let sidecar = Self { creases: Some(creases.iter().map(of).collect()), ..self };
        sidecar.validate(&sidecar.source.file)?;
        Ok(sidecar)
    }

    /// Returns the points of the mesh in metres, y up.
    pub fn mesh_points(&self) -> Vec<Vec3> {
        self.mesh.points_m.iter().map(|&p| p.into()).collect()
    }

    /// Returns the triangles of the mesh.
    pub fn mesh_triangles(&self) -> Vec<[PointIndex; 3]> {
        self.mesh.triangles.iter().map(|t| t.map(PointIndex)).collect()
    }

    /// Returns the joints that move the garment.
    pub fn joints(&self) -> Vec<SourceJoint> {
        let joint = |j: &SidecarJoint| SourceJoint {
            name: j.name.clone(),
            position: j.position_m.into(),
            axes: Mat3::from_columns(&j.axes.map(Vec3::from)),
            parent: j.parent.clone(),
        };
        self.mesh.joints.iter().flatten().map(joint).collect()
    }

    /// Returns displacement and memory, with entries as in the lists of this sidecar.
    pub fn worn(&self) -> WornGarment {
        WornGarment {
            displacement: self.points.displacement_m.iter().map(|&d| d.into()).collect(),
            memory: RestState {
                source_angle: self.hinges.source_angle_rad.clone(),
                rest_angle: self.hinges.rest_angle_rad.clone(),
                stiffness_ratio: self.hinges.stiffness_ratio.clone(),
                rest_stretch_warp: self.triangles.rest_stretch_warp.clone(),
                rest_stretch_weft: self.triangles.rest_stretch_weft.clone(),
            },
        }
    }

    /// Returns the reason why this is not the sidecar of `asset`, if it is not: other worn vertices, or other positions. The
    /// positions of `asset` are those before the wear or those after it.
    pub fn mesh_mismatch(&self, asset: &SourceAsset) -> Option<String> {
        let count: usize = asset.worn_pieces().map(|piece| piece.positions.len()).sum();
        let listed = self.mesh.source_point.len();
        if count != listed {
            return Some(format!("is for a mesh of {listed} vertices, this one has {count}"));
        }
        let points = self.mesh_points();
        let (low, high) = bounds(&points);
        let tolerance = TUNING.vertex_position_tol * (high - low).norm() + TUNING.layer_position_tol_m;
        let off = |points: &[Vec3]| {
            let vertices =
                asset.worn_pieces().flat_map(|p| (0..p.positions.len()).map(|v| p.scene_position(v)));
            // A point lies where its first vertex does; others may have been joined to it over a distance.
            let mut is_known = vec![false; points.len()];
            vertices.zip(&self.mesh.source_point).position(|(x, &point)| {
                // The points of a validated sidecar exist.
                let is_first =
                    is_known.get_mut(point as usize).is_none_or(|known| !std::mem::replace(known, true));
                let is_off = |(x, own): (Vec3, &Vec3)| (x - own).norm() > tolerance;
                is_first && x.zip(points.get(point as usize)).is_none_or(is_off)
            })
        };
        let worn = || -> Vec<Vec3> {
            points.iter().zip(&self.points.displacement_m).map(|(x, d)| x + Vec3::from(*d)).collect()
        };
        let off = off(&points).filter(|_| off(&worn()).is_some());
        off.map(|v| format!("is for another mesh: vertex {v} is elsewhere"))
    }
}

/// Returns the texture coordinates of all worn vertices in file order, if every worn piece has them.
fn source_uv(asset: &SourceAsset) -> Option<Vec<[f64; 2]>> {
    let mut all = Vec::new();
    for piece in asset.pieces.iter().filter(|piece| piece.worn) {
        all.extend(piece.uvs.as_ref()?.iter().map(|uv| [uv.x, uv.y]));
    }
    Some(all)
}

/// Returns the joints of the worn pieces, if there are any.
fn source_joints(asset: &SourceAsset) -> Option<Vec<SidecarJoint>> {
    let axis = |axes: &Mat3, k: usize| axes.column(k).into_owned().into();
    let joint = |joint: SourceJoint| SidecarJoint {
        name: joint.name,
        position_m: joint.position.into(),
        axes: [0, 1, 2].map(|k| axis(&joint.axes, k)),
        parent: joint.parent,
        extra: Map::new(),
    };
    let all: Vec<SidecarJoint> = asset.worn_joints().into_iter().map(joint).collect();
    (!all.is_empty()).then_some(all)
}

/// Returns the numbers of those points of which `on` holds.
fn indices_of(on: &[bool]) -> Vec<u32> {
    (0..on.len() as u32).filter(|p| on[*p as usize]).collect()
}

/// Returns the angle of the first side of a flattened triangle, warp along x [rad].
fn warp_angle(flat: &[Vec2; 3]) -> f64 {
    let side = flat[1] - flat[0];
    side.y.atan2(side.x)
}
