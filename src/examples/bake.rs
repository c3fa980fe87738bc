//! Bakes a fold into a generated sheet and writes sheet.glb and sheet.crease.json into a folder.
//!
//! `cargo run --release --example bake -- FOLDER`

use crease::{Bake, Fabric, GarmentFile, Quality, Save, WearScript};
use std::path::PathBuf;

const SCRIPT: &str = r#"{"format": "crease-wear/1", "actions": [
    {"lay": {"facing": "front", "over": 0.2}},
    {"fold": {"line": [[0.5, 0], [0.5, 1]], "side": "left", "over": 0.5, "hold": 3}},
    {"unfold": {"all": true, "over": 0.5}}]}"#;

fn main() -> crease::Result<()> {
    let folder = PathBuf::from(std::env::args().nth(1).unwrap_or_else(|| ".".to_owned()));
    let sheet = GarmentFile::sheet([0.2, 0.2], [8, 8])?;
    let script = WearScript::parse("fold.json", SCRIPT)?;
    let fabric = Fabric::preset("kow-tshirt")?;
    let result = Bake::new(&sheet.garment, &fabric, &script).quality(Quality::Draft).run()?;
    sheet.save_glb(&result.worn, folder.join("sheet.glb"))?;
    sheet.sidecar(&result.worn, &fabric, &script)?.save(folder.join("sheet.crease.json"))?;
    println!("{} steps, {} critical events", result.report.steps, result.report.events.critical);
    Ok(())
}
