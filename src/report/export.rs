//! Files for other programs (`--export`): each is made, read back, and what it says then compared with what it should.
//!
//! | kind | file | who takes it |
//! |---|---|---|
//! | `obj` | `OUT.worn.obj`, the worn shape | anything |
//! | `rest-mesh` | `OUT.rest.obj`, the shape that best carries the rest angles | Maya, Blender, Vellum, ppf, Newton: rest shapes |
//! | `rest-angle-map` | `OUT.rest-angle.glb`, rest angles per vertex | Unreal Chaos |
//! | `usda` | `OUT.usda`, pairs of triangles and their angles in degrees | USD physics |
//!
//! The formats are in `format/`; a new kind is one of those and a line in each list here.

use crate::bake::rest_mesh;
use crate::fabric::Fabric;
use crate::garment::{Garment, SourceAsset, WornGarment};
use crate::io::gltf::write_rest_angle_map;
use crate::io::{
    ReadOptions, read_asset, read_shape_obj, read_usda, wrapped_deg, write_shape_obj, write_usda,
};
use crate::math::Vec3;
use crate::mesh::{hinge_angle, unwrap_angle};
use crate::{Error, Result};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// A kind of file for other programs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Export {
    /// The worn shape as OBJ.
    Obj,
    /// The rest mesh as OBJ.
    RestMesh,
    /// Rest angles per vertex as GLB.
    RestAngleMap,
    /// A USD surface deformable.
    Usda,
}

/// A file made and read back.
#[derive(Debug, Clone)]
pub struct ExportFile {
    /// What its name ends in, behind that of the main output: `rest.obj`.
    pub ending: &'static str,
    /// Its bytes.
    pub bytes: Vec<u8>,
    /// What it said when read back; the caller puts the file's name in.
    pub checks: Vec<ExportCheck>,
}

/// A file written on the side, as it was found when read back.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ExportCheck {
    /// The file.
    pub file: String,
    /// What was compared.
    pub compared: String,
    /// Largest difference to what it should carry, in `unit`.
    pub largest_difference: f64,
    /// The same, root mean square (of angles: weighted by length).
    pub rms_difference: f64,
    /// The same for the garment as it came: what would be missing without the file.
    pub rms_without: f64,
    /// Unit of the differences.
    pub unit: String,
}

impl Export {
    /// Every kind, by its name on the command line.
    pub const ALL: [(&str, Self); 4] = [
        ("obj", Self::Obj),
        ("rest-mesh", Self::RestMesh),
        ("rest-angle-map", Self::RestAngleMap),
        ("usda", Self::Usda),
    ];

    /// What the file's name ends in.
    pub fn ending(self) -> &'static str {
        match self {
            Self::Obj => "worn.obj",
            Self::RestMesh => "rest.obj",
            Self::RestAngleMap => "rest-angle.glb",
            Self::Usda => "usda",
        }
    }

    /// Makes the file of `worn`, which is `garment` of `fabric`, made of `asset`, and reads it back.
    pub fn make(
        self,
        asset: &SourceAsset,
        garment: &Garment,
        worn: &WornGarment,
        fabric: &Fabric,
    ) -> Result<ExportFile> {
        let scene = Scene { asset, garment, worn };
        let (bytes, checks) = match self {
            Self::Obj => scene.worn_obj()?,
            Self::RestMesh => scene.rest_obj(fabric)?,
            Self::RestAngleMap => scene.rest_angle_map()?,
            Self::Usda => scene.usda(fabric)?,
        };
        Ok(ExportFile { ending: self.ending(), bytes, checks })
    }
}

struct Scene<'a> {
    asset: &'a SourceAsset,
    garment: &'a Garment,
    worn: &'a WornGarment,
}

impl Scene<'_> {
    fn worn_obj(&self) -> Result<(Vec<u8>, Vec<ExportCheck>)> {
        let bytes = write_shape_obj(self.asset, self.garment, &self.worn.displacement);
        let back = self.points_of(&read_shape_obj("OUT.worn.obj", &bytes)?)?;
        let should: Vec<Vec3> = add(&self.garment.points, &self.worn.displacement);
        let off = |a: &[Vec3]| a.iter().zip(&should).map(|(a, b)| 1e3 * (a - b).norm()).collect::<Vec<_>>();
        let even = vec![1.0; should.len()];
        Ok((bytes, vec![report("positions", "mm", &off(&back), &off(&self.garment.points), &even)]))
    }

    fn rest_obj(&self, fabric: &Fabric) -> Result<(Vec<u8>, Vec<ExportCheck>)> {
        let shape = rest_mesh(self.garment, fabric, &self.worn.memory);
        let bytes = write_shape_obj(self.asset, self.garment, &shape.displacement);
        let back = self.points_of(&read_shape_obj("OUT.rest.obj", &bytes)?)?;
        Ok((bytes, self.shape_reports(&back)))
    }

    fn usda(&self, fabric: &Fabric) -> Result<(Vec<u8>, Vec<ExportCheck>)> {
        let shape = rest_mesh(self.garment, fabric, &self.worn.memory);
        let memory = &self.worn.memory;
        let bytes =
            write_usda(self.garment, &self.worn.displacement, &shape.displacement, &memory.rest_angle);
        let back = read_usda("OUT.usda", &bytes)?;
        let hinges = &self.garment.topology.hinges;
        if back.rest_points.len() != self.garment.points.len() {
            return Err(Error::input("OUT.usda", "physics:restShapePoints", "did not read back", ""));
        }
        let same = back.pairs.iter().zip(hinges).filter(|(pair, h)| **pair == h.triangles).count();
        if same != hinges.len() || back.pairs.len() != hinges.len() || back.angles_deg.len() != hinges.len() {
            return Err(Error::input("OUT.usda", "physics:restAdjTriPairs", "did not read back", ""));
        }
        let off = |angles: &dyn Fn(usize) -> f64| -> Vec<f64> {
            let gap = |h: usize| {
                let gap = angles(h) - memory.rest_angle[h].to_degrees();
                (gap - 360.0 * (gap / 360.0).round()).abs()
            };
            (0..hinges.len()).map(gap).collect()
        };
        let with = off(&|h| back.angles_deg[h]);
        let without = off(&|h| wrapped_deg(memory.source_angle[h]));
        let mut reports =
            vec![report("rest angles of the pairs", "degrees", &with, &without, &self.lengths())];
        reports.extend(self.shape_reports(&back.rest_points));
        Ok((bytes, reports))
    }

    fn rest_angle_map(&self) -> Result<(Vec<u8>, Vec<ExportCheck>)> {
        let memory = &self.worn.memory;
        let bytes = write_rest_angle_map(self.asset, self.garment, memory)?;
        let options =
            ReadOptions { unit_m: Some(1.0), mask: Some("COLOR_0".to_owned()), ..ReadOptions::default() };
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
        // As Chaos reads it: of both ends, the lesser magnitude.
        let of_edge = |h: &crate::mesh::Hinge| {
            let [a, b] = [per_point[h.points[0].at()], per_point[h.points[1].at()]];
            if f64::abs(a) < f64::abs(b) { a } else { b }
        };
        let hinges = self.garment.topology.hinges.iter();
        let with: Vec<f64> =
            hinges.zip(&memory.rest_angle).map(|(h, rest)| (of_edge(h) - rest.to_degrees()).abs()).collect();
        let what = "rest angles, of both ends of an edge the lesser magnitude";
        let without = self.angles_off(&self.garment.points);
        Ok((bytes, vec![report(what, "degrees", &with, &without, &self.lengths())]))
    }

    /// Of a rest shape: angles against the rest angles, lengths against those of the garment.
    fn shape_reports(&self, points: &[Vec3]) -> Vec<ExportCheck> {
        let (with, without) = (self.angles_off(points), self.angles_off(&self.garment.points));
        let lengths = self.lengths();
        let length = |h: &crate::mesh::Hinge| (points[h.points[1].at()] - points[h.points[0].at()]).norm();
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
            report("hinge angles of the rest shape", "degrees", &with, &without, &lengths),
            report("edge lengths of the rest shape", "per cent", &strain, &none, &lengths),
        ]
    }

    /// Per hinge: difference of its angle at `points` to its rest angle (degrees), whole turns left out.
    fn angles_off(&self, points: &[Vec3]) -> Vec<f64> {
        let hinges = self.garment.topology.hinges.iter().zip(&self.worn.memory.rest_angle);
        let off = |(h, rest): (&crate::mesh::Hinge, &f64)| {
            let angle = unwrap_angle(hinge_angle(&h.points.map(|p| points[p.at()])), *rest);
            (angle - rest).abs().to_degrees()
        };
        hinges.map(off).collect()
    }

    /// Per hinge: length of its edge [m].
    fn lengths(&self) -> Vec<f64> {
        let x = &self.garment.points;
        let length = |h: &crate::mesh::Hinge| (x[h.points[1].at()] - x[h.points[0].at()]).norm();
        self.garment.topology.hinges.iter().map(length).collect()
    }

    /// Points of the garment from positions per vertex: the first vertex of a point decides, as it did on import.
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

fn report(compared: &str, unit: &str, with: &[f64], without: &[f64], weight: &[f64]) -> ExportCheck {
    let rms = |off: &[f64]| {
        let sum: f64 = off.iter().zip(weight).map(|(o, w)| o * o * w).sum();
        (sum / weight.iter().sum::<f64>().max(f64::MIN_POSITIVE)).sqrt()
    };
    ExportCheck {
        file: String::new(),
        compared: compared.to_owned(),
        largest_difference: with.iter().copied().fold(0.0, f64::max),
        rms_difference: rms(with),
        rms_without: rms(without),
        unit: unit.to_owned(),
    }
}
