//! Generator of the project's garments, `garments/*.glb`, from sewing patterns.
//!
//! ```text
//! outline (lines and arcs) -> panel (near-equilateral triangles) -> front and back sewn -> glb
//! ```
//!
//! `cargo run --example generate_garments` writes all of them; `-- --out DIR` writes elsewhere, `--obj DIR` also
//! writes an OBJ of each garment, and `--tshirt-edge MM` writes only the T-shirt with another edge length
//! (`tshirt-other.glb`). The output is deterministic on one machine. The printed numbers are measured on the meshes.
//!
//! A flat garment lies on the ground: y up, metres, x to the right, its length along z with the upper end towards -z,
//! its front up. Texture: +u along the garment's length (warp), +v across it (weft), one scale for all panels.

mod arm;
mod glb;
mod legs;
mod outline;
mod patterns;
mod quality;
mod sew;
mod triangulate;

use std::error::Error;
use std::path::{Path, PathBuf};

/// A mesh of vertices, which are split at the seams.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    /// Positions, one per vertex [m].
    pub positions: Vec<crease_geometry::math::Vec3>,
    /// Unit normals, one per vertex.
    pub normals: Vec<crease_geometry::math::Vec3>,
    /// Texture coordinates, one per vertex, with v downwards as in glTF.
    pub uvs: Vec<crease_geometry::math::Vec2>,
    /// Triangles over the vertices, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// A garment with its file.
pub struct GarmentFile {
    /// File name without extension.
    pub name: &'static str,
    /// Mesh of the cloth.
    pub cloth: Mesh,
    /// Content of the file.
    pub glb: Vec<u8>,
}

/// 0 below 0, 1 above 1, with a continuous derivative between.
fn smoothstep(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// All garments, in the order of writing.
fn garments() -> Vec<GarmentFile> {
    let mut all: Vec<GarmentFile> = patterns::all().into_iter().map(flat_garment).collect();
    let (arm, cloth) = (arm::arm(), arm::sleeve());
    let glb = glb::dressed_body(&glb::DressedBody {
        body_name: "arm",
        body: &arm,
        garment_name: "sleeve",
        garment: &cloth,
        joints: &arm::joints(),
        weights: &|x| (0..).zip(arm::weights(x.x)).collect(),
        clip: arm::elbow(),
        colour: [0.62, 0.35, 0.25],
    });
    all.push(GarmentFile { name: "sleeve", glb, cloth });
    let (body, cloth) = (legs::body(), legs::trousers());
    let glb = glb::dressed_body(&glb::DressedBody {
        body_name: "legs",
        body: &body,
        garment_name: "trousers",
        garment: &cloth,
        joints: &legs::joints(),
        weights: &legs::weights,
        clip: legs::sit_down(),
        colour: [0.25, 0.31, 0.42],
    });
    all.push(GarmentFile { name: "trousers-on-legs", glb, cloth });
    all
}

fn flat_garment(pattern: patterns::Pattern) -> GarmentFile {
    let cloth = sew::make(&pattern);
    let glb = glb::flat_garment(pattern.name, &cloth, pattern.colour);
    GarmentFile { name: pattern.name, cloth, glb }
}

/// Formats the mesh as OBJ.
fn obj(mesh: &Mesh) -> String {
    use std::fmt::Write;
    let mut text = String::new();
    for p in &mesh.positions {
        // The GLB stores f32: the same numbers here.
        let _ = writeln!(text, "v {} {} {}", p.x as f32, p.y as f32, p.z as f32);
    }
    for t in &mesh.triangles {
        let _ = writeln!(text, "f {} {} {}", t[0] + 1, t[1] + 1, t[2] + 1);
    }
    text
}

fn main() -> Result<(), Box<dyn Error>> {
    let mut out = Path::new(env!("CARGO_MANIFEST_DIR")).join("garments");
    let mut obj_folder: Option<PathBuf> = None;
    let mut tshirt_edge_m: Option<f64> = None;
    let mut arguments = std::env::args().skip(1);
    while let Some(word) = arguments.next() {
        let mut value = || arguments.next().ok_or(format!("{word} needs a value"));
        match word.as_str() {
            "--out" => out = value()?.into(),
            "--obj" => obj_folder = Some(value()?.into()),
            "--tshirt-edge" => tshirt_edge_m = Some(1e-3 * value()?.parse::<f64>()?),
            other => {
                let options = "--out DIR, --obj DIR and --tshirt-edge MM";
                return Err(format!("unknown option {other}: there are {options}").into());
            }
        }
    }
    // The T-shirt with another edge length is not one of the project's garments.
    let files = match tshirt_edge_m {
        Some(edge_m) => vec![flat_garment(patterns::tshirt("tshirt-other", edge_m))],
        None => garments(),
    };
    for file in files {
        println!("{}: {}, {} bytes", file.name, quality::measure(&file.cloth), file.glb.len());
        std::fs::write(out.join(format!("{}.glb", file.name)), &file.glb)?;
        if let Some(folder) = &obj_folder {
            std::fs::write(folder.join(format!("{}.obj", file.name)), obj(&file.cloth))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use quality::Quality;

    /// All garments, made once for all tests.
    fn made() -> &'static [GarmentFile] {
        static MADE: std::sync::OnceLock<Vec<GarmentFile>> = std::sync::OnceLock::new();
        MADE.get_or_init(garments)
    }

    fn of(name: &str) -> Quality {
        let file = made().iter().find(|file| file.name == name).expect("a garment of that name");
        quality::measure(&file.cloth)
    }

    #[test]
    fn point_counts_are_the_documented_ones() {
        for (name, points, tolerance) in [
            ("tshirt", 13_867.0, 0.01), // the paper's T-shirt
            ("tshirt-draft", 2_000.0, 0.05),
            ("handkerchief", 2_500.0, 0.05),
            ("trousers", 6_000.0, 0.05),
            ("sleeve", 3_000.0, 0.05),
            ("trousers-on-legs", 3_170.0, 0.05),
        ] {
            let made = of(name).point_count as f64;
            assert!((made - points).abs() <= tolerance * points, "{name}: {made} points, not {points}");
        }
    }

    #[test]
    fn triangles_are_near_equilateral_and_every_opening_is_there() {
        for (name, openings) in
            [("tshirt", 4), ("tshirt-draft", 4), ("handkerchief", 1), ("trousers", 3), ("sleeve", 2)]
        {
            let q = of(name);
            assert!(q.min_angle_deg > 25.0, "{name}: {q}");
            assert!(q.mean_shape > 0.95, "{name}: {q}");
            assert_eq!(q.opening_count, openings, "{name}");
            assert_eq!(q.part_count, 1, "{name} falls apart");
            assert_eq!(q.bad_edge_count, 0, "{name} is not an oriented manifold");
        }
    }

    /// Triangles are less regular at the crotch.
    #[test]
    fn trousers_on_legs_are_one_piece_with_three_openings() {
        let q = of("trousers-on-legs");
        assert!(q.min_angle_deg > 12.0 && q.mean_shape > 0.95, "{q}");
        assert_eq!((q.opening_count, q.part_count, q.bad_edge_count), (3, 1, 0));
    }

    #[test]
    fn making_twice_gives_the_same_bytes() {
        for (a, b) in made().iter().zip(&garments()) {
            assert!(a.glb == b.glb, "{} differs", a.name);
        }
    }

    /// Detects garments edited by hand, and patterns changed without writing the garments again.
    #[test]
    fn garments_in_the_repository_are_up_to_date() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("garments");
        for file in made() {
            let stored = std::fs::read(folder.join(format!("{}.glb", file.name))).expect("garment file");
            // On another machine the last bit of a sine may differ, and with it the number of digits of a bound.
            assert!(stored.len().abs_diff(file.glb.len()) < 64, "{}", file.name);
        }
    }
}
