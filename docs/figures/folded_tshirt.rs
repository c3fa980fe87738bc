//! Figure of a T-shirt folded three times and unfolded, as in Kim, Oh, Wohn, "Persistent Wrinkles and Folds of
//! Clothes": without and with memory, and with memory the change of rest angles and the curvature.
//!
//! ```text
//! crease bake garments/tshirt.glb --wear garments/wear/fold-thrice.json --memory off -o without.glb
//! crease bake garments/tshirt.glb --wear garments/wear/fold-thrice.json -o with.glb
//! cargo run --release --example folded_tshirt -- without.crease.json with.crease.json docs/figures/tshirt-figure.png
//! ```

use crease::Result;
use crease::internal::report::render::{Camera, encode_png, one_above_the_other, side_by_side};
use crease::internal::report::{ColorBy, GarmentView};
use crease_io::read_sidecar;

/// Width and height of each of the four pictures [pixels].
const SIZE: [usize; 2] = [640, 480];

fn main() -> std::result::Result<(), Box<dyn std::error::Error>> {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    let [without, with, picture] = paths.as_slice() else {
        eprintln!("three paths are required: WITHOUT.crease.json WITH.crease.json OUT.png");
        std::process::exit(1)
    };
    let view = |path: &String| -> std::result::Result<GarmentView, Box<dyn std::error::Error>> {
        Ok(GarmentView::of_sidecar(path, &read_sidecar(path, &std::fs::read(path)?)?))
    };
    std::fs::write(picture, figure(&view(without)?, &view(with)?)?)?;
    Ok(())
}

fn figure(without: &GarmentView, with: &GarmentView) -> Result<Vec<u8>> {
    let draw = |view: &GarmentView, show| view.draw(show, &Camera::default(), SIZE);
    let shapes = side_by_side(
        &draw(without, ColorBy::Shape)?,
        &draw(with, ColorBy::Shape)?,
        ["folded thrice, without memory", "with memory"],
    );
    let colourings = side_by_side(
        &draw(with, ColorBy::RestAngleChange)?,
        &draw(with, ColorBy::Curvature)?,
        ["change of rest angle", "curvature"],
    );
    encode_png(&one_above_the_other(&shapes, &colourings))
}
