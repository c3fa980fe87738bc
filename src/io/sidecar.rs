//! The sidecar, `OUT.crease.json`, format `crease-sidecar/1`: the memory of a worn garment as an open file.
//!
//! Last stage of a bake, first stage of a transfer. It holds the welded mesh the solver saw, what every hinge and
//! triangle of it remembers, the displacement that went into the glTF, and what was done (fabric, wear script, run).
//! Units stand in the names; points are in metres, y up; hinges are counted as in [`crate::mesh::Topology`]
//! (x0 x1 the shared edge, x2 x3 opposite; 0 rad is flat). Fields this version does not know are kept and written again,
//! so a later tool's notes survive an earlier one.
//! Reading checks everything the rest of the crate relies on: version, lengths, index ranges, finite numbers.
//! Checksums over the numbers tell an edited file from the one that was written; a file without them is taken as it is.
//! It does not check that the hinges are those of the triangles (`transfer` does), nor that texture coordinates make sense.

use crate::garment::{Garment, RestState, SourceAsset, SourceJoint, UpAxis, WornGarment, corner_vertices};
use crate::math::{Mat3, Vec2, Vec3, bounds};
use crate::mesh::PointIndex;
use crate::{Diagnostic, Error, Result};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};

use crate::io::checksum::SidecarChecksums;

/// The format and version this module writes and reads.
pub const SIDECAR_FORMAT: &str = "crease-sidecar/1";

/// Cure for a sidecar that contradicts itself.
const CURE: &str = "use the sidecar as crease wrote it, or bake again";

/// A worn garment's memory, with the mesh it belongs to and how it came about.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct Sidecar {
    /// Always `crease-sidecar/1`.
    pub format: String,
    /// The file the garment came from.
    pub source: SidecarSource,
    /// The welded mesh the solver saw.
    pub mesh: SidecarMesh,
    /// What every hinge remembers.
    pub hinges: SidecarHinges,
    /// What every triangle remembers.
    pub triangles: SidecarTriangles,
    /// What happened to every point.
    pub points: SidecarPoints,
    /// Tells whether the numbers are those that were written. Whoever changes a number on purpose leaves this out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub checksums: Option<SidecarChecksums>,
    /// The fabric, as `crease schema fabric` describes it.
    #[serde(default)]
    pub fabric: Value,
    /// The wear script, as `crease schema wear` describes it.
    #[serde(default)]
    pub wear: Value,
    /// What the run was: tool, method, settings.
    #[serde(default)]
    pub run: Value,
    /// Fields this version does not know.
    #[serde(flatten)]
    pub extra: Map<String, Value>,
}

/// Where the garment came from.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SidecarSource {
    /// File name as the user gave it.
    pub file: String,
    /// SHA-256 of its bytes, lower-case hex.
    pub sha256: String,
    /// Metres per unit of that file.
    pub unit_m: f64,
    /// Axis that points up in that file.
    pub up: SidecarUp,
    /// Fields this version does not know.
    #[serde(flatten)]
    pub extra: Map<String, Value>,
}

/// Up axis of a source file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "lowercase")]
pub enum SidecarUp {
    /// y up.
    Y,
    /// z up: (x, y, z) of the file is (x, z, -y) here.
    Z,
}

/// The welded mesh, in its own pose.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SidecarMesh {
    /// One per point: position in metres, y up.
    pub points_m: Vec<[f64; 3]>,
    /// One per triangle: its three points.
    pub triangles: Vec<[u32; 3]>,
    /// One per vertex of the worn pieces of the source file, in file order: its point.
    pub source_point: Vec<u32>,
    /// One per vertex like `source_point`: first texture coordinates, v downward as in glTF. Left out when a worn piece
    /// has none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub source_uv: Option<Vec<[f64; 2]>>,
    /// One per triangle: the source vertices at its corners, which tell its texture coordinates at seams. Left out where the
    /// mesh is finer than its file, and by versions before 0.1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub triangle_vertices: Option<Vec<[u32; 3]>>,
    /// Joints of the skeleton that moves the worn pieces, as they stand in the pose of the file: garments that follow joints
    /// of the same names can be laid over one another by them. Left out without any.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub joints: Option<Vec<SidecarJoint>>,
    /// Fields this version does not know.
    #[serde(flatten)]
    pub extra: Map<String, Value>,
}

/// A joint of a skeleton.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SidecarJoint {
    /// Name of its node.
    pub name: String,
    /// Where it stands, in metres, y up.
    pub position_m: [f64; 3],
    /// Unit vectors along its own x, y and z, y up.
    pub axes: [[f64; 3]; 3],
    /// Name of the next joint above it.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub parent: Option<String>,
    /// Fields this version does not know.
    #[serde(flatten)]
    pub extra: Map<String, Value>,
}

/// What every hinge remembers; all lists have one entry per hinge.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SidecarHinges {
    /// x0 x1 the shared edge, x2 and x3 opposite.
    pub points: Vec<[u32; 4]>,
    /// Angle of the garment as it came, in radians; 0 is flat.
    pub source_angle_rad: Vec<f64>,
    /// Angle it now takes for its own, in radians.
    pub rest_angle_rad: Vec<f64>,
    /// Bend stiffness over that of new cloth [-], 1 when new.
    pub stiffness_ratio: Vec<f64>,
    /// Fields this version does not know.
    #[serde(flatten)]
    pub extra: Map<String, Value>,
}

/// What every triangle remembers; both lists have one entry per triangle.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SidecarTriangles {
    /// Rest length over that of new cloth along warp (+u) [-], 1 when new.
    pub rest_stretch_warp: Vec<f64>,
    /// Rest length over that of new cloth along weft (+v) [-], 1 when new.
    pub rest_stretch_weft: Vec<f64>,
    /// Angle from the warp to the side between the first two corners, in radians, counter-clockwise seen from where the
    /// corners run counter-clockwise.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub warp_angle_rad: Option<Vec<f64>>,
    /// After a transfer: how sure it is that the memory belongs there, 0 to 1.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub confidence: Option<Vec<f64>>,
    /// Fields this version does not know.
    #[serde(flatten)]
    pub extra: Map<String, Value>,
}

/// What happened to every point; one entry per point.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct SidecarPoints {
    /// Displacement from `points_m` in metres, y up: what the morph target `worn` shows.
    pub displacement_m: Vec<[f64; 3]>,
    /// Fields this version does not know.
    #[serde(flatten)]
    pub extra: Map<String, Value>,
}

impl Sidecar {
    /// The sidecar of `worn`, which is `garment`, which came from `asset`. `fabric`, `wear` and `run` go in as they are.
    /// Refused when the parts do not belong together or a number is not finite, as JSON cannot say so.
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
            extra: Map::new(),
        };
        sidecar.checksums = Some(sidecar.compute_checksums());
        sidecar.check(&asset.file)?;
        Ok(sidecar)
    }

    /// Every point of the mesh in metres, y up.
    pub fn mesh_points(&self) -> Vec<Vec3> {
        self.mesh.points_m.iter().map(|&p| p.into()).collect()
    }

    /// Every triangle of the mesh.
    pub fn mesh_triangles(&self) -> Vec<[PointIndex; 3]> {
        self.mesh.triangles.iter().map(|t| t.map(PointIndex)).collect()
    }

    /// Joints that move the garment, as it came.
    pub fn joints(&self) -> Vec<SourceJoint> {
        let joint = |j: &SidecarJoint| SourceJoint {
            name: j.name.clone(),
            position: j.position_m.into(),
            axes: Mat3::from_columns(&j.axes.map(Vec3::from)),
            parent: j.parent.clone(),
        };
        self.mesh.joints.iter().flatten().map(joint).collect()
    }

    /// Displacement and memory, as a bake left them; entries as in the lists of this sidecar.
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

    /// Why this is not the sidecar of `asset`, if it is not: its worn vertices are others, or elsewhere.
    pub fn mesh_mismatch(&self, asset: &SourceAsset) -> Option<String> {
        let count: usize = asset.worn_pieces().map(|piece| piece.positions.len()).sum();
        let listed = self.mesh.source_point.len();
        if count != listed {
            return Some(format!("is for a mesh of {listed} vertices, this one has {count}"));
        }
        let points = self.mesh_points();
        let (low, high) = bounds(&points);
        let slack = SAME_PLACE * (high - low).norm();
        let vertices = asset.worn_pieces().flat_map(|p| (0..p.positions.len()).map(|v| p.scene_position(v)));
        let off = vertices.zip(&self.mesh.source_point).position(|(x, &point)| {
            // A sidecar that was checked names existing points only.
            x.zip(points.get(point as usize)).is_none_or(|(x, own)| (x - own).norm() > slack)
        });
        off.map(|v| format!("is for another mesh: vertex {v} is elsewhere"))
    }

    /// Every way in which the lists contradict each other, one fault for each list.
    fn check(&self, file: &str) -> Result<()> {
        let mut check = Check { file, faults: Vec::new() };
        if self.format != SIDECAR_FORMAT {
            check.faults.push(wrong_format(file, &self.format));
        }
        let (points, triangles) = (self.mesh.points_m.len(), self.mesh.triangles.len());
        let hinges = self.hinges.points.len();
        let vertices = self.mesh.source_point.len();

        check.unit(self.source.unit_m);
        check.finite("mesh.points_m", &self.mesh.points_m);
        check.indices("mesh.triangles", &self.mesh.triangles, points);
        check.indices("mesh.source_point", self.mesh.source_point.as_chunks::<1>().0, points);
        if let Some(uv) = &self.mesh.source_uv {
            check.length("mesh.source_uv", uv.len(), vertices, "source vertices");
            check.finite("mesh.source_uv", uv);
        }
        if let Some(corners) = &self.mesh.triangle_vertices {
            check.length("mesh.triangle_vertices", corners.len(), triangles, "triangles");
            check.indices("mesh.triangle_vertices", corners, vertices);
        }
        for (i, joint) in self.mesh.joints.iter().flatten().enumerate() {
            check.finite(&format!("mesh.joints[{i}].position_m"), &[joint.position_m]);
            check.finite(&format!("mesh.joints[{i}].axes"), &joint.axes);
        }
        for (place, values) in [
            ("triangles.warp_angle_rad", &self.triangles.warp_angle_rad),
            ("triangles.confidence", &self.triangles.confidence),
        ] {
            if let Some(values) = values {
                check.length(place, values.len(), triangles, "triangles");
                check.finite(place, values.as_chunks::<1>().0);
            }
        }
        check.indices("hinges.points", &self.hinges.points, points);
        for (place, angles) in [
            ("hinges.source_angle_rad", &self.hinges.source_angle_rad),
            ("hinges.rest_angle_rad", &self.hinges.rest_angle_rad),
        ] {
            check.length(place, angles.len(), hinges, "hinges");
            check.finite(place, angles.as_chunks::<1>().0);
        }
        check.length("hinges.stiffness_ratio", self.hinges.stiffness_ratio.len(), hinges, "hinges");
        check.positive("hinges.stiffness_ratio", &self.hinges.stiffness_ratio);
        for (place, stretch) in [
            ("triangles.rest_stretch_warp", &self.triangles.rest_stretch_warp),
            ("triangles.rest_stretch_weft", &self.triangles.rest_stretch_weft),
        ] {
            check.length(place, stretch.len(), triangles, "triangles");
            check.positive(place, stretch);
        }
        check.length("points.displacement_m", self.points.displacement_m.len(), points, "points");
        check.finite("points.displacement_m", &self.points.displacement_m);
        if check.faults.is_empty() {
            check.faults.extend(self.checksum_faults(file));
        }
        if check.faults.is_empty() { Ok(()) } else { Err(Error::Input(check.faults)) }
    }
}

/// Vertices this close, as a share of the garment's diagonal, are at the same place: a hundred times the rounding of
/// single precision, and what welding may move one.
const SAME_PLACE: f64 = 2e-5;

/// A sidecar as JSON text, one line, read back bit for bit by [`read_sidecar`].
pub fn write_sidecar(sidecar: &Sidecar) -> Vec<u8> {
    // Plain lists and maps with text keys always serialise, and writing to memory cannot fail.
    let mut text = serde_json::to_vec(sidecar).unwrap_or_default();
    text.push(b'\n');
    text
}

/// A sidecar from JSON text; `file` names it in faults.
///
/// ```
/// let error = crease::read_sidecar("x.crease.json", b"{}").unwrap_err().to_string();
/// assert!(error.starts_with("x.crease.json"), "{error}");
/// ```
pub fn read_sidecar(file: &str, bytes: &[u8]) -> Result<Sidecar> {
    let bytes = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let mut reader = serde_json::Deserializer::from_slice(bytes);
    let sidecar: Sidecar = serde_path_to_error::deserialize(&mut reader).map_err(|error| {
        // Another version, or another kind of file, is the better explanation of a missing field.
        stated_format(bytes).filter(|format| format != SIDECAR_FORMAT).map_or_else(
            || unreadable(file, &error.path().to_string(), error.inner()),
            |format| Error::Input(vec![wrong_format(file, &format)]),
        )
    })?;
    reader.end().map_err(|error| unreadable(file, "", &error))?;
    sidecar.check(file)?;
    Ok(sidecar)
}

/// Texture coordinates of all worn vertices in file order, if every worn piece has them.
fn source_uv(asset: &SourceAsset) -> Option<Vec<[f64; 2]>> {
    let mut all = Vec::new();
    for piece in asset.pieces.iter().filter(|piece| piece.worn) {
        all.extend(piece.uvs.as_ref()?.iter().map(|uv| [uv.x, uv.y]));
    }
    Some(all)
}

/// Joints of the worn pieces, if there are any.
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

/// Angle of the first side of a triangle laid flat, warp along x [rad].
fn warp_angle(flat: &[Vec2; 3]) -> f64 {
    let side = flat[1] - flat[0];
    side.y.atan2(side.x)
}

/// What `format` a JSON text states, if it is an object that states one.
fn stated_format(bytes: &[u8]) -> Option<String> {
    #[derive(Deserialize)]
    struct Stated {
        format: String,
    }
    serde_json::from_slice::<Stated>(bytes).ok().map(|stated| stated.format)
}

fn wrong_format(file: &str, format: &str) -> Diagnostic {
    let cure = if format.starts_with("crease-sidecar/") {
        "use the version of crease that wrote it"
    } else {
        "give the OUT.crease.json that `crease bake` wrote beside OUT.glb"
    };
    Diagnostic::new(file, "format", format!("is {format:?}, not {SIDECAR_FORMAT:?}"), cure)
}

fn unreadable(file: &str, path: &str, error: &serde_json::Error) -> Error {
    // serde_json ends its message with line and column; they belong to the place.
    let message = error.to_string();
    let what = message.rsplit_once(" at line ").map_or(message.as_str(), |(what, _)| what);
    let spot = format!("line {}, column {}", error.line(), error.column());
    let place = if path.is_empty() || path == "." { spot } else { format!("{spot}, {path}") };
    Error::input(file, place, what, CURE)
}

/// Collects faults; each list is reported once, at its first bad entry.
struct Check<'a> {
    file: &'a str,
    faults: Vec<Diagnostic>,
}

impl Check<'_> {
    fn add(&mut self, place: String, what: String) {
        self.faults.push(Diagnostic::new(self.file, place, what, CURE));
    }

    fn length(&mut self, place: &str, found: usize, wanted: usize, of: &str) {
        if found != wanted {
            self.add(place.to_owned(), format!("has {found} entries for {wanted} {of}"));
        }
    }

    fn finite<const N: usize>(&mut self, place: &str, rows: &[[f64; N]]) {
        if let Some(i) = rows.iter().position(|row| row.iter().any(|x| !x.is_finite())) {
            self.add(format!("{place}[{i}]"), "is not a finite number".to_owned());
        }
    }

    fn unit(&mut self, unit_m: f64) {
        if !(unit_m.is_finite() && unit_m > 0.0) {
            self.add("source.unit_m".to_owned(), format!("is {unit_m}, but must be a number above 0"));
        }
    }

    fn positive(&mut self, place: &str, values: &[f64]) {
        if let Some((i, x)) = values.iter().enumerate().find(|(_, x)| !(x.is_finite() && **x > 0.0)) {
            self.add(format!("{place}[{i}]"), format!("is {x}, but must be a number above 0"));
        }
    }

    fn indices<const N: usize>(&mut self, place: &str, rows: &[[u32; N]], count: usize) {
        if let Some(i) = rows.iter().position(|row| row.iter().any(|&p| p as usize >= count)) {
            self.add(format!("{place}[{i}]"), format!("names one beyond the last of {count}"));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::garment::{Placement, SourceFormat, SourcePiece};
    use crate::math::{Mat4, Vec2};
    use crate::mesh::Topology;
    use serde_json::json;

    /// Two triangles over four points; five source vertices, as one is split at a seam.
    fn example() -> Sidecar {
        let positions = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
        let piece = SourcePiece {
            name: "cloth".into(),
            material: None,
            mesh: 0,
            primitive: 0,
            node: None,
            positions: positions.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec(),
            normals: None,
            uvs: Some(positions.map(|[x, y]| Vec2::new(x, y)).to_vec()),
            mask: None,
            triangles: vec![[0, 1, 2], [2, 4, 3]],
            placement: Placement::Rigid(Mat4::identity()),
            joints: Vec::new(),
            worn: true,
        };
        let asset = SourceAsset {
            file: "cloth.obj".into(),
            sha256: "00ff".into(),
            format: SourceFormat::Obj,
            unit_m: 0.01,
            up: UpAxis::Z,
            document: None,
            pieces: vec![piece],
        };
        let triangles =
            vec![[0, 1, 2], [2, 1, 3]].into_iter().map(|t: [u32; 3]| t.map(PointIndex)).collect::<Vec<_>>();
        let garment = Garment {
            points: positions[..4].iter().map(|[x, y]| Vec3::new(*x, *y, 1.0 / 3.0)).collect(),
            material: vec![[Vec2::zeros(); 3]; 2],
            material_from_uv: true,
            source_point: [0, 1, 2, 3, 1].map(PointIndex).to_vec(),
            memory_mask: vec![1.0; 4],
            triangle_part: vec![0; 2],
            topology: Topology::new(4, &triangles),
            triangles,
        };
        let worn = WornGarment {
            displacement: vec![Vec3::new(0.1, -2e-17, 3.0); 4],
            memory: RestState {
                source_angle: vec![0.0],
                rest_angle: vec![-0.7],
                stiffness_ratio: vec![1.3],
                rest_stretch_warp: vec![1.0, 1.01],
                rest_stretch_weft: vec![1.02, 1.0],
            },
        };
        Sidecar::new(
            &asset,
            &garment,
            &worn,
            json!({"name": "cotton"}),
            json!({"actions": []}),
            json!({"seed": 7}),
        )
        .unwrap()
    }

    fn example_json() -> Value {
        serde_json::from_slice(&write_sidecar(&example())).unwrap()
    }

    fn fault_of(json: &Value) -> String {
        read_sidecar("a.crease.json", json.to_string().as_bytes()).unwrap_err().to_string()
    }

    /// The names are a contract with other tools: any change here is a new version of the format.
    #[test]
    fn the_field_names_and_values_of_the_contract() {
        let expected = json!({
            "format": "crease-sidecar/1",
            "source": {"file": "cloth.obj", "sha256": "00ff", "unit_m": 0.01, "up": "z"},
            "mesh": {
                "points_m": [[0.0, 0.0, 1.0 / 3.0], [1.0, 0.0, 1.0 / 3.0], [0.0, 1.0, 1.0 / 3.0], [1.0, 1.0, 1.0 / 3.0]],
                "triangles": [[0, 1, 2], [2, 1, 3]],
                "source_point": [0, 1, 2, 3, 1],
                "source_uv": [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]],
                "triangle_vertices": [[0, 1, 2], [2, 4, 3]],
            },
            "hinges": {
                "points": [[1, 2, 0, 3]],
                "source_angle_rad": [0.0], "rest_angle_rad": [-0.7], "stiffness_ratio": [1.3],
            },
            "triangles": {
                "rest_stretch_warp": [1.0, 1.01], "rest_stretch_weft": [1.02, 1.0], "warp_angle_rad": [0.0, 0.0],
            },
            "points": {"displacement_m": vec![[0.1, -2e-17, 3.0]; 4]},
            // Worked out by another program (hashlib, struct).
            "checksums": {
                "mesh_sha256": "2e8741ed2bf166c98ebce1061d9a2510c24c2c794eb09eca4df5546056cbd41d",
                "memory_sha256": "630fe8d1864e50bbad107f8045bdcaccda590a42aec99985587fa8bdfcefaf18",
            },
            "fabric": {"name": "cotton"}, "wear": {"actions": []}, "run": {"seed": 7},
        });
        assert_eq!(example_json(), expected);
    }

    #[test]
    fn read_is_the_inverse_of_write_and_keeps_unknown_fields() {
        let mut json = example_json();
        json["studio"] = json!({"ticket": [1, 0.25]});
        json["hinges"]["confidence"] = json!([0.5]);
        json["source"]["author"] = json!("somebody");
        let text = json.to_string();
        let read = read_sidecar("a", text.as_bytes()).unwrap();
        assert_eq!(read.extra["studio"], json["studio"]);
        let again: Value = serde_json::from_slice(&write_sidecar(&read)).unwrap();
        assert_eq!(again, json);
        assert_eq!(read.worn().memory.rest_angle, [-0.7]);
        assert_eq!(read.worn().displacement[3].y, -2e-17);
        assert_eq!(read.mesh_triangles()[1], [2, 1, 3].map(PointIndex));
        assert_eq!(read.mesh_points()[3].z, 1.0 / 3.0);
    }

    #[test]
    fn a_type_error_names_line_column_and_path() {
        let text = serde_json::to_string_pretty(&example_json()).unwrap().replace("-0.7", "null");
        let line = text.lines().position(|l| l.contains("null")).unwrap() + 1;
        let message = read_sidecar("a.crease.json", text.as_bytes()).unwrap_err().to_string();
        assert!(message.starts_with(&format!("a.crease.json: line {line}, column ")), "{message}");
        assert!(message.contains("hinges.rest_angle_rad[0]"), "{message}");
        assert!(!message.contains(" at line "), "said once: {message}");
    }

    #[test]
    fn another_version_is_named_even_when_its_fields_differ() {
        let mut json = example_json();
        json["format"] = json!("crease-sidecar/2");
        assert!(fault_of(&json).contains("crease-sidecar/2"));
        let message = fault_of(&json!({"format": "crease-wear/1", "actions": []}));
        assert!(message.contains("crease-wear/1") && message.contains("OUT.crease.json"), "{message}");
        assert!(fault_of(&json!({"actions": []})).contains("format"));
        assert!(fault_of(&json!([1, 2])).contains("line 1"));
    }

    #[test]
    fn every_contradiction_is_reported_in_one_go() {
        let mut json = example_json();
        json["source"]["unit_m"] = json!(0.0);
        json["mesh"]["triangles"][1][2] = json!(4);
        json["mesh"]["source_point"][4] = json!(9);
        json["mesh"]["source_uv"] = json!([[0.0, 0.0]]);
        json["hinges"]["points"][0][3] = json!(u32::MAX);
        json["hinges"]["source_angle_rad"] = json!([0.0, 0.0]);
        json["hinges"]["rest_angle_rad"] = json!([]);
        json["hinges"]["stiffness_ratio"][0] = json!(-1.0);
        json["triangles"]["rest_stretch_warp"] = json!([1.0]);
        json["triangles"]["rest_stretch_weft"][1] = json!(0.0);
        json["points"]["displacement_m"] = json!([]);
        let message = fault_of(&json);
        for place in [
            "source.unit_m",
            "mesh.triangles[1]",
            "mesh.source_point[4]",
            "mesh.source_uv",
            "hinges.points[0]",
            "hinges.source_angle_rad",
            "hinges.rest_angle_rad",
            "hinges.stiffness_ratio[0]",
            "triangles.rest_stretch_warp",
            "triangles.rest_stretch_weft[1]",
            "points.displacement_m",
        ] {
            assert!(message.contains(&format!(": {place}: ")), "{place} missing in\n{message}");
        }
        assert_eq!(message.lines().count(), 11, "{message}");
    }

    /// An edit by hand or by a program that does not know the format must not pass for the bake; one that is meant may.
    #[test]
    fn edited_numbers_are_refused_unless_the_checksums_go_too() {
        let mut json = example_json();
        json["hinges"]["rest_angle_rad"][0] = json!(-0.71);
        let message = fault_of(&json);
        assert!(message.contains("checksums.memory_sha256: does not fit"), "{message}");
        assert!(message.contains("delete \"checksums\"") && message.lines().count() == 1, "{message}");
        json["mesh"]["points_m"][0][0] = json!(0.5);
        assert_eq!(fault_of(&json).lines().count(), 2);
        json.as_object_mut().unwrap().remove("checksums");
        assert!(read_sidecar("a", json.to_string().as_bytes()).is_ok());
        // Layout is no content.
        let pretty = serde_json::to_string_pretty(&example_json()).unwrap();
        assert!(read_sidecar("a", pretty.as_bytes()).is_ok());
    }

    #[test]
    fn a_sidecar_knows_its_mesh_from_another() {
        let read = |text: &str| {
            let options = crate::io::ReadOptions::default();
            let mut nothing = |_: &str| Ok(Vec::new());
            crate::io::read_asset("m.obj", text.as_bytes(), &options, &mut nothing).unwrap().0
        };
        let own = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
        let (garment, _) = Garment::from_asset(&own).unwrap();
        let worn = WornGarment { displacement: vec![Vec3::zeros(); 3], memory: RestState::flat(0, 1) };
        let sidecar = Sidecar::new(&own, &garment, &worn, Value::Null, Value::Null, Value::Null).unwrap();
        assert_eq!(sidecar.mesh_mismatch(&own), None);
        let moved = read("v 0 0 0\nv 1 0 0\nv 0 1.01 0\nf 1 2 3\n");
        assert!(sidecar.mesh_mismatch(&moved).unwrap().contains("vertex 2 is elsewhere"));
        let more = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n");
        assert!(sidecar.mesh_mismatch(&more).unwrap().contains("3 vertices, this one has 4"));
    }

    #[test]
    fn numbers_that_json_cannot_say_are_refused_on_both_sides() {
        let huge = example_json().to_string().replace("1.3", "1e999");
        assert!(read_sidecar("a", huge.as_bytes()).is_err());
        let mut sidecar = example();
        sidecar.hinges.rest_angle_rad[0] = f64::NAN;
        assert!(sidecar.check("a").unwrap_err().to_string().contains("rest_angle_rad[0]"));
    }

    #[test]
    fn truncated_or_mutated_text_is_a_fault_never_a_panic() {
        let text = write_sidecar(&example());
        for end in 0..text.len() - 2 {
            assert!(read_sidecar("a", &text[..end]).is_err(), "cut at {end}");
        }
        for i in 0..text.len() {
            for bit in 0..8 {
                let mut bent = text.clone();
                bent[i] ^= 1 << bit;
                let _ = read_sidecar("a", &bent);
            }
        }
        let mut longer = text.clone();
        longer.extend_from_slice(b"{}");
        assert!(read_sidecar("a", &longer).is_err(), "something after the end");
    }

    #[test]
    fn the_schema_names_every_field_of_the_contract() {
        let schema = serde_json::to_string(&schemars::schema_for!(Sidecar)).unwrap();
        for field in
            ["points_m", "source_point", "source_angle_rad", "stiffness_ratio", "displacement_m", "sha256"]
        {
            assert!(schema.contains(field), "{field}");
        }
    }
}
