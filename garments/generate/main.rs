//! Makes the garments that ship with the project, `garments/*.glb`, from sewing patterns.
//!
//! ```text
//! outline (lines and arcs) -> panel (near-equilateral triangles) -> front and back sewn -> glb
//! ```
//!
//! Run `cargo run --example generate_garments`; add `-- --out DIR` to write elsewhere, `--obj DIR` to write an
//! OBJ of each garment too, and `--tshirt-edge MM` for the T-shirt at another edge length, alone (`tshirt-other.glb`). Nothing here is random and nothing is copied from anywhere: the same bytes come out
//! every time on one machine. The numbers printed are measured on what was made, not promised.
//!
//! A garment lies on the ground: y up, metres, x to the right, its length along z with the upper end towards -z,
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

/// A mesh as it goes into a file: vertices are split where the panels meet.
#[derive(Debug, Clone, Default)]
pub struct Mesh {
    /// One per vertex [m].
    pub positions: Vec<crease::math::Vec3>,
    /// One per vertex, unit length.
    pub normals: Vec<crease::math::Vec3>,
    /// One per vertex, glTF's convention (v grows downward in the picture).
    pub uvs: Vec<crease::math::Vec2>,
    /// Corners, counter-clockwise seen from outside.
    pub triangles: Vec<[u32; 3]>,
}

/// A garment ready to be written.
pub struct Product {
    /// File name without extension.
    pub name: &'static str,
    /// The cloth itself.
    pub cloth: Mesh,
    /// The whole file.
    pub glb: Vec<u8>,
}

/// 0 below 0, 1 above 1, and in between without a kink.
fn smooth(t: f64) -> f64 {
    let t = t.clamp(0.0, 1.0);
    t * t * (3.0 - 2.0 * t)
}

/// Every garment, in the order they are written.
fn products() -> Vec<Product> {
    let mut all: Vec<Product> = patterns::all().into_iter().map(product).collect();
    let (arm, cloth) = (arm::arm(), arm::sleeve());
    let glb = glb::dressed(glb::Dressed {
        names: ["arm", "sleeve"],
        meshes: [&arm, &cloth],
        joints: &arm::joints(),
        weights: &|x| (0..).zip(arm::weights(x.x)).collect(),
        clip_name: "elbow",
        clip: arm::elbow(),
        colour: [0.62, 0.35, 0.25],
    });
    all.push(Product { name: "sleeve", glb, cloth });
    let (body, cloth) = (legs::body(), legs::trousers());
    let glb = glb::dressed(glb::Dressed {
        names: ["legs", "trousers"],
        meshes: [&body, &cloth],
        joints: &legs::joints(),
        weights: &legs::weights,
        clip_name: "sit-down",
        clip: legs::sit_down(),
        colour: [0.25, 0.31, 0.42],
    });
    all.push(Product { name: "trousers-on-legs", glb, cloth });
    all
}

fn product(pattern: patterns::Pattern) -> Product {
    let cloth = sew::make(&pattern);
    let glb = glb::flat_garment(pattern.name, &cloth, pattern.colour);
    Product { name: pattern.name, cloth, glb }
}

fn obj(mesh: &Mesh) -> String {
    use std::fmt::Write;
    let mut text = String::new();
    for p in &mesh.positions {
        // The file holds f32: the check must see the same numbers.
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
    // Another tessellation of the T-shirt is made alone: it is not one of the garments that ship.
    let products = match tshirt_edge_m {
        Some(edge_m) => vec![product(patterns::tshirt("tshirt-other", edge_m))],
        None => products(),
    };
    for product in products {
        println!("{}: {}, {} bytes", product.name, quality::measure(&product.cloth), product.glb.len());
        std::fs::write(out.join(format!("{}.glb", product.name)), &product.glb)?;
        if let Some(folder) = &obj_folder {
            std::fs::write(folder.join(format!("{}.obj", product.name)), obj(&product.cloth))?;
        }
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use quality::Quality;

    /// Made once for all tests.
    fn made() -> &'static [Product] {
        static MADE: std::sync::OnceLock<Vec<Product>> = std::sync::OnceLock::new();
        MADE.get_or_init(products)
    }

    fn of(name: &str) -> Quality {
        let product = made().iter().find(|p| p.name == name).expect("a garment of that name");
        quality::measure(&product.cloth)
    }

    #[test]
    fn point_counts_are_the_promised_ones() {
        for (name, points, tolerance) in [
            ("tshirt-14k", 13_867.0, 0.01), // the paper's T-shirt
            ("tshirt-2k", 2_000.0, 0.05),
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
            [("tshirt-14k", 4), ("tshirt-2k", 4), ("handkerchief", 1), ("trousers", 3), ("sleeve", 2)]
        {
            let q = of(name);
            assert!(q.min_angle_deg > 25.0, "{name}: {q}");
            assert!(q.mean_shape > 0.95, "{name}: {q}");
            assert_eq!(q.opening_count, openings, "{name}");
            assert_eq!(q.part_count, 1, "{name} falls apart");
            assert_eq!(q.bad_edge_count, 0, "{name} is not an oriented manifold");
        }
    }

    /// Where the legs part triangles are less even.
    #[test]
    fn trousers_on_legs_are_one_piece_with_three_openings() {
        let q = of("trousers-on-legs");
        assert!(q.min_angle_deg > 12.0 && q.mean_shape > 0.95, "{q}");
        assert_eq!((q.opening_count, q.part_count, q.bad_edge_count), (3, 1, 0));
    }

    #[test]
    fn making_twice_gives_the_same_bytes() {
        for (a, b) in made().iter().zip(&products()) {
            assert!(a.glb == b.glb, "{} differs", a.name);
        }
    }

    /// A garment that was edited by hand, or a pattern that was changed without writing the garments again.
    #[test]
    fn garments_in_the_repository_are_the_ones_made_here() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("garments");
        for product in made() {
            let stored = std::fs::read(folder.join(format!("{}.glb", product.name))).expect("garment file");
            // On another machine the last bit of a sine may differ, and with it how long a bound is when written.
            assert!(stored.len().abs_diff(product.glb.len()) < 64, "{}", product.name);
        }
    }
}
