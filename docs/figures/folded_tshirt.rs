//! The T-shirt figure of Kim, Oh, Wohn, "Persistent Wrinkles and Folds of Clothes": a T-shirt folded three times and
//! opened again, without and with memory, and what it remembers: rest angle and curvature beside each other.
//!
//! ```text
//! cargo run --release --example folded_tshirt -- garments/tshirt.glb docs/tshirt-figure.png
//! ```
//!
//! Both bakes run here, through the library; without arguments the T-shirt of 2,000 points is taken.

use crease::bake::{BakeOptions, Observer, Progress, bake};
use crease::fabric::{DEFAULT_FABRIC, Fabric};
use crease::format::gltf::write_worn_glb;
use crease::format::{ReadOptions, SourceAsset, read_asset};
use crease::garment::Garment;
use crease::report::render::{Camera, encode_png, one_above_the_other, side_by_side};
use crease::report::{Portrait, Show};
use crease::wear::WearScript;
use crease::{Error, Result};
use serde_json::json;

const WEAR: &str = "garments/wear/fold-thrice.json";
/// Width and height of each of the four pictures [pixels].
const SIZE: [usize; 2] = [640, 480];

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let mut arguments = std::env::args().skip(1);
    let mesh = arguments.next().unwrap_or_else(|| "garments/tshirt-draft.glb".into());
    let picture = arguments.next().unwrap_or_else(|| "tshirt-figure.png".into());
    let (bytes, script) = (std::fs::read(&mesh)?, std::fs::read_to_string(WEAR)?);
    std::fs::write(picture, figure(&mesh, &bytes, &script)?)?;
    Ok(())
}

fn figure(mesh: &str, bytes: &[u8], script: &str) -> Result<Vec<u8>> {
    let (asset, garment) = read(mesh, bytes)?;
    let script = WearScript::parse(WEAR, script)?;
    let without = worn(&asset, &garment, &script, false)?;
    let with = worn(&asset, &garment, &script, true)?;
    let draw = |portrait: &Portrait, show| portrait.draw(show, &Camera::default(), SIZE);
    let shapes = side_by_side(
        &draw(&without, Show::Shape)?,
        &draw(&with, Show::Shape)?,
        ["folded thrice, without memory", "with memory"],
    );
    let remembered = side_by_side(
        &draw(&with, Show::RestAngle)?,
        &draw(&with, Show::Curvature)?,
        ["what it remembers", "how it lies"],
    );
    encode_png(&one_above_the_other(&shapes, &remembered))
}

fn read(file: &str, bytes: &[u8]) -> Result<(SourceAsset, Garment)> {
    let mut no_other_file =
        |name: &str| Err(Error::fault(file, name, "another file", "a file that holds all it needs"));
    let (asset, _) = read_asset(file, bytes, &ReadOptions::default(), &mut no_other_file)?;
    let (garment, _) = Garment::from_asset(&asset)?;
    Ok((asset, garment))
}

/// The garment after the wear, as its own GLB shows it.
fn worn(asset: &SourceAsset, garment: &Garment, script: &WearScript, memory: bool) -> Result<Portrait> {
    let fabric = Fabric::preset(DEFAULT_FABRIC)?;
    let options = BakeOptions { memory, ..BakeOptions::default() };
    let baked = bake(garment, &fabric, script, WEAR, &options, &mut Lines { stage: String::new(), memory })?;
    let glb = write_worn_glb(asset, garment, &baked.worn, &json!({}))?;
    Portrait::of_asset(read("worn.glb", &glb)?.0)
}

/// Says which action is under way.
struct Lines {
    stage: String,
    memory: bool,
}

impl Observer for Lines {
    fn progress(&mut self, now: &Progress) {
        if self.stage != now.stage {
            self.stage = now.stage.to_owned();
            eprintln!("memory {}: {} at {:.1} of {:.1} s", self.memory, now.stage, now.time, now.total);
        }
    }
}
