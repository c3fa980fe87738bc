//! Files for other programs (`--export`). Each is written, read back, and compared with the worn garment.
//!
//! | kind | file | read by |
//! |---|---|---|
//! | `obj` | `OUT.worn.obj`, the worn shape | any program |
//! | `rest-mesh` | `OUT.rest.obj`, the shape that best carries the rest angles | Maya, Blender, Vellum, ppf, Newton: rest shapes |
//! | `rest-angle-map` | `OUT.rest-angle.glb`, rest angles per vertex | Unreal Chaos |
//! | `usd` | `OUT.usda`: meshes with the wear as blend shape, skeleton, materials, frames; rest angles of a deformable | Blender, Maya, Unreal, Houdini; USD physics |
//!
//! The formats are in `io`. A new kind needs a format there and a line in each list of [`Export`].

use crate::bake::rest_mesh;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::{hinge_angle, unwrap_angle};
use crease_io::gltf::write_rest_angle_map;
use crease_io::{
    ReadOptions, UsdFrames, UsdScene, read_asset, read_shape_obj, read_usda, usd_textures, wrapped_deg,
    write_shape_obj, write_usda,
};
use crease_model::error::{Error, Result};
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, SourceAsset, WornGarment};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Kind of a file for other programs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
#[non_exhaustive]
pub enum Export {
    /// Worn shape as OBJ.
    Obj,
    /// Rest mesh as OBJ.
    RestMesh,
    /// Rest angles per vertex as GLB.
    RestAngleMap,
    /// USD scene.
    Usd,
}

/// A written file with its checks.
#[derive(Debug, Clone)]
pub struct ExportFile {
    /// Content of the file.
    pub bytes: Vec<u8>,
    /// Files that it refers to: the ends of their names after that of the garment, and their content.
    pub beside: Vec<(String, Vec<u8>)>,
    /// Comparisons with the worn garment, without the name of the file.
    pub checks: Vec<ExportCheck>,
}

/// Comparison of an exported file, read back, with the worn garment.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExportCheck {
    /// Name of the file.
    pub file: String,
    /// Compared quantity.
    pub compared: String,
    /// Maximum difference, in `unit`.
    pub largest_difference: f64,
    /// Root mean square difference (of angles: weighted by edge length).
    pub rms_difference: f64,
    /// Root mean square difference of the garment before the wear, for comparison.
    pub rms_without: f64,
    /// Unit of the differences.
    pub unit: String,
}

impl Export {
    /// All kinds with their names on the command line.
    pub const ALL: [(&str, Self); 4] = [
        ("obj", Self::Obj),
        ("rest-mesh", Self::RestMesh),
        ("rest-angle-map", Self::RestAngleMap),
        ("usd", Self::Usd),
    ];

    /// Returns the extension of the file.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Obj => "worn.obj",
            Self::RestMesh => "rest.obj",
            Self::RestAngleMap => "rest-angle.glb",
            Self::Usd => "usda",
        }
    }

    /// Writes the file of `worn` and reads it back; `name` is its name without the ending. `garment`, of the fabric `fabric`, was made
    /// from `asset`. A USD scene holds the `frames`, too.
    pub fn make(
        self,
        name: &str,
        asset: &SourceAsset,
        garment: &Garment,
        worn: &WornGarment,
        fabric: &Fabric,
        frames: Option<UsdFrames>,
    ) -> Result<ExportFile> {
        let exporter = Exporter { asset, garment, worn };
        let beside = match self {
            Self::Usd => {
                usd_textures(asset).into_iter().map(|texture| (texture.ending, texture.bytes)).collect()
            }
            _ => Vec::new(),
        };
        let (bytes, checks) = match self {
            Self::Obj => exporter.worn_obj()?,
            Self::RestMesh => exporter.rest_obj(fabric)?,
            Self::RestAngleMap => exporter.rest_angle_map()?,
            Self::Usd => exporter.usd(name, fabric, frames)?,
        };
        Ok(ExportFile { bytes, beside, checks })
    }
}

struct Exporter<'a> {
    asset: &'a SourceAsset,
    garment: &'a Garment,
    worn: &'a WornGarment,
}

impl Exporter<'_> {
    fn worn_obj(&self) -> Result<(Vec<u8>, Vec<ExportCheck>)> {
        let bytes = write_shape_obj(self.asset, self.garment, &self.worn.displacement);
        let back = self.points_of(&read_shape_obj("OUT.worn.obj", &bytes, self.asset)?)?;
        let expected: Vec<Vec3> = add(&self.garment.points, &self.worn.displacement);
        let distances =
            |a: &[Vec3]| a.iter().zip(&expected).map(|(a, b)| 1e3 * (a - b).norm()).collect::<Vec<_>>();
        let weights = vec![1.0; expected.len()];
        Ok((
            bytes,
            vec![compare(
                Quantity::new("positions", "mm"),
                &distances(&back),
                &distances(&self.garment.points),
                &weights,
            )],
        ))
    }

    fn rest_obj(&self, fabric: &Fabric) -> Result<(Vec<u8>, Vec<ExportCheck>)> {
        let shape = rest_mesh(self.garment, fabric, &self.worn.memory);
        let bytes = write_shape_obj(self.asset, self.garment, &shape.displacement);
        let back = self.points_of(&read_shape_obj("OUT.rest.obj", &bytes, self.asset)?)?;
        Ok((bytes, self.shape_checks(&back)))
    }

    fn usd(
        &self,
        name: &str,
        fabric: &Fabric,
        frames: Option<UsdFrames>,
    ) -> Result<(Vec<u8>, Vec<ExportCheck>)> {
        let shape = rest_mesh(self.garment, fabric, &self.worn.memory);
        let memory = &self.worn.memory;
        let &Self { asset, garment, worn } = self;
        let bytes =
            write_usda(&UsdScene { name, asset, garment, worn, rest: &shape.displacement, fabric, frames })?;
        let back = read_usda("OUT.usda", &bytes)?;
        let hinges = &self.garment.topology.hinges;
        if back.rest_points.len() != self.garment.points.len() {
            return Err(Error::input("OUT.usda", "physics:restShapePoints", "did not read back", ""));
        }
        let same = back.pairs.iter().zip(hinges).filter(|(pair, h)| **pair == h.triangles).count();
        if same != hinges.len() || back.pairs.len() != hinges.len() || back.angles_deg.len() != hinges.len() {
            return Err(Error::input("OUT.usda", "physics:restAdjTriPairs", "did not read back", ""));
        }
        let differences = |angles: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let difference = |h: usize| {
                let turns = angles(h) - memory.rest_angle[h].to_degrees();
                (turns - 360.0 * (turns / 360.0).round()).abs()
            };
            (0..hinges.len()).map(difference).collect()
        };
        let with = differences(&|h| back.angles_deg[h]);
        let without = differences(&|h| wrapped_deg(memory.source_angle[h]));
        let pairs = Quantity::new("rest angles of the pairs", "degrees");
        let mut checks = vec![compare(pairs, &with, &without, &self.edge_lengths())];
        checks.extend(self.shape_checks(&back.rest_points));
        Ok((bytes, checks))
    }

    fn rest_angle_map(&self) -> Result<(Vec<u8>, Vec<ExportCheck>)> {
        let memory = &self.worn.memory;
        let bytes = write_rest_angle_map(self.asset, self.garment, memory)?;
        let options = ReadOptions {
            unit_m: Some(1.0),
            any_size: true,
            mask: Some("COLOR_0".to_owned()),
            ..ReadOptions::default()
        };
        let (back, _) = read_asset("OUT.rest-angle.glb", &bytes, &options, &mut |_| Ok(Vec::new()))?;
        let mut read = back.pieces.iter().flat_map(|piece| piece.mask.iter().flatten());
        let mut per_point = vec![0.0; self.garment.points.len()];
        let mut points = self.garment.source_point.iter();
        for piece in self.asset.worn_pieces() {
            for _ in 0..piece.positions.len() {
                let (Some(point), false) = (points.next(), piece.triangles.is_empty()) else { continue };
                let Some(grey) = read.next() else {
                    return Err(Error::input("OUT.rest-angle.glb", "COLOR_0", "did not read back", ""));
                };
                per_point[point.at()] = 360.0 * grey - 180.0;
            }
        }
        // Chaos uses the end of the edge with the smaller magnitude.
        let of_edge = |h: &crease_geometry::mesh::Hinge| {
            let [a, b] = [per_point[h.points[0].at()], per_point[h.points[1].at()]];
            if f64::abs(a) < f64::abs(b) { a } else { b }
        };
        let hinges = self.garment.topology.hinges.iter();
        let with: Vec<f64> =
            hinges.zip(&memory.rest_angle).map(|(h, rest)| (of_edge(h) - rest.to_degrees()).abs()).collect();
        let quantity = Quantity::new("rest angles, of both ends of an edge the smaller magnitude", "degrees");
        let without = self.angle_differences(&self.garment.points);
        Ok((bytes, vec![compare(quantity, &with, &without, &self.edge_lengths())]))
    }

    /// Compares the angles of a rest shape with the rest angles, and its lengths with those of the garment.
    fn shape_checks(&self, points: &[Vec3]) -> Vec<ExportCheck> {
        let (with, without) = (self.angle_differences(points), self.angle_differences(&self.garment.points));
        let lengths = self.edge_lengths();
        let length =
            |h: &crease_geometry::mesh::Hinge| (points[h.points[1].at()] - points[h.points[0].at()]).norm();
        let strain: Vec<f64> = self
            .garment
            .topology
            .hinges
            .iter()
            .zip(&lengths)
            .map(|(h, own)| 100.0 * (length(h) / own.max(f64::MIN_POSITIVE) - 1.0).abs())
            .collect();
        let none = vec![0.0; strain.len()];
        vec![
            compare(Quantity::new("hinge angles of the rest shape", "degrees"), &with, &without, &lengths),
            compare(Quantity::new("edge lengths of the rest shape", "per cent"), &strain, &none, &lengths),
        ]
    }

    /// Returns per hinge the difference between its angle at `points` and its rest angle, modulo full turns [degrees].
    fn angle_differences(&self, points: &[Vec3]) -> Vec<f64> {
        let hinges = self.garment.topology.hinges.iter().zip(&self.worn.memory.rest_angle);
        let difference = |(h, rest): (&crease_geometry::mesh::Hinge, &f64)| {
            let angle = unwrap_angle(hinge_angle(&h.points.map(|p| points[p.at()])), *rest);
            (angle - rest).abs().to_degrees()
        };
        hinges.map(difference).collect()
    }

    /// Returns the length of the edge of every hinge [m].
    fn edge_lengths(&self) -> Vec<f64> {
        let x = &self.garment.points;
        let length = |h: &crease_geometry::mesh::Hinge| (x[h.points[1].at()] - x[h.points[0].at()]).norm();
        self.garment.topology.hinges.iter().map(length).collect()
    }

    /// Returns the points of the garment from positions per vertex. As on import, the first vertex of a point counts.
    fn points_of(&self, vertices: &[Vec3]) -> Result<Vec<Vec3>> {
        if vertices.len() != self.garment.source_point.len() {
            return Err(Error::input("OUT.obj", "", "did not read back: vertices are missing", ""));
        }
        let mut points = self.garment.points.clone();
        for (point, x) in self.garment.source_point.iter().zip(vertices).rev() {
            points[point.at()] = *x;
        }
        Ok(points)
    }
}

fn add(x: &[Vec3], d: &[Vec3]) -> Vec<Vec3> {
    x.iter().zip(d).map(|(x, d)| x + d).collect()
}

/// A compared quantity and its unit.
#[derive(Debug, Clone, Copy)]
struct Quantity {
    name: &'static str,
    unit: &'static str,
}

impl Quantity {
    const fn new(name: &'static str, unit: &'static str) -> Self {
        Self { name, unit }
    }
}

/// Summarises differences `with` the file and `without` it, each with its `weight`.
fn compare(quantity: Quantity, with: &[f64], without: &[f64], weight: &[f64]) -> ExportCheck {
    let rms = |differences: &[f64]| {
        let sum: f64 = differences.iter().zip(weight).map(|(d, w)| d * d * w).sum();
        (sum / weight.iter().sum::<f64>().max(f64::MIN_POSITIVE)).sqrt()
    };
    ExportCheck {
        file: String::new(),
        compared: quantity.name.to_owned(),
        largest_difference: with.iter().copied().fold(0.0, f64::max),
        rms_difference: rms(with),
        rms_without: rms(without),
        unit: quantity.unit.to_owned(),
    }
}
