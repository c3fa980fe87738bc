//! Runs every reader on a damaged file as the tool does: used by the fuzz targets and by `tests/mutated_inputs.rs`. A
//! reader may accept or reject; it may not panic, and an accepted file must be usable.

use crease::internal::bake::Checkpoint;
use crease::internal::report::GarmentView;
use crease::internal::wear::WearScript;
use crease::{Error, Result};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::intersections::self_intersections;
use crease_io::gltf::write_worn_glb;
use crease_io::{Landmarks, ReadOptions, Sidecar, read_asset, read_sidecar, write_sidecar};
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, RestState, WornGarment, inspect};
use crease_model::remesh::SimulationMesh;
use serde_json::Value;

/// Reads a mesh file as `crease inspect` does and writes it as `crease bake` does. `resolve` returns the files it refers to.
pub fn mesh(name: &str, bytes: &[u8], resolve: &mut dyn FnMut(&str) -> Result<Vec<u8>>) -> Result<()> {
    // With a stated unit sizes are not checked and more of the file is read.
    let options = ReadOptions { unit_m: Some(1.0), any_size: true, ..ReadOptions::default() };
    let (asset, diagnostics) = read_asset(name, bytes, &options, resolve)?;
    let (garment, more) = Garment::from_asset(&asset)?;
    let _ = inspect(&asset, &garment, &[diagnostics, more].concat()).to_text();
    self_intersections(&garment.points, &garment.triangles);
    let worn = WornGarment {
        displacement: vec![Vec3::zeros(); garment.points.len()],
        memory: RestState::flat(garment.topology.hinges.len(), garment.triangles.len()),
    };
    let glb = write_worn_glb(&asset, &garment, &worn, &Value::Null)?;
    let sidecar = Sidecar::new(&asset, &garment, &worn, Value::Null, Value::Null, Value::Null)?;
    let again = read_sidecar("out.crease.json", &write_sidecar(&sidecar)).expect("our own sidecar is read");
    assert_eq!(again, sidecar);
    read_asset("out.glb", &glb, &options, resolve).expect("our own worn glTF is read");
    Ok(())
}

/// Reads a mesh file without external files.
pub fn lone_mesh(name: &str, bytes: &[u8]) -> Result<()> {
    mesh(name, bytes, &mut |file| Err(Error::input(file, "", "there is no such file", "")))
}

/// Reads a glTF whose every file has the bytes after the first zero byte, or as many of them as are needed.
pub fn mesh_with_file(bytes: &[u8]) -> Result<()> {
    let (text, file) = bytes.split_at(bytes.iter().position(|byte| *byte == 0).unwrap_or(bytes.len()));
    mesh("garment.gltf", text, &mut |_| Ok(file.to_vec()))
}

/// Reads a wear script.
pub fn wear(bytes: &[u8]) -> Result<()> {
    let script = WearScript::parse("wear.json", &text(bytes)?)?;
    script.errors_without_body("wear.json");
    assert!(script.flatten().take(100_000).count() <= 100_000 && script.duration().is_finite());
    Ok(())
}

/// Reads a fabric.
pub fn fabric(bytes: &[u8]) -> Result<()> {
    let fabric = Fabric::parse("fabric.json", &text(bytes)?)?;
    let again = Fabric::parse("again.json", &fabric.to_json()).expect("our own fabric is read");
    assert_eq!(again, fabric);
    assert!(fabric.bending_length().is_finite() && fabric.area_density() > 0.0);
    Ok(())
}

/// Reads a sidecar, also as `crease render` does.
pub fn sidecar(bytes: &[u8]) -> Result<()> {
    let sidecar = read_sidecar("out.crease.json", bytes)?;
    let view = GarmentView::of_sidecar("out.glb", &sidecar);
    assert_eq!(view.before.len(), view.after.len());
    let again = read_sidecar("again.json", &write_sidecar(&sidecar)).expect("our own sidecar is read");
    assert_eq!(again, sidecar);
    Ok(())
}

/// Reads landmarks, also as `crease transfer` does.
pub fn landmarks(bytes: &[u8]) -> Result<()> {
    let landmarks = Landmarks::parse("landmarks.json", &text(bytes)?)?;
    assert!(landmarks.position_pairs().iter().flatten().all(|place| place.iter().all(|x| x.is_finite())));
    let again = serde_json::to_string(&landmarks).expect("is plain data");
    assert_eq!(Landmarks::parse("again.json", &again).expect("our own landmarks are read"), landmarks);
    Ok(())
}

/// Reads a checkpoint, with and without its hash.
pub fn checkpoint(bytes: &[u8]) -> Result<()> {
    let body = text(bytes)?;
    let (garment, script) = small_run();
    let whole = Checkpoint::parse("out.checkpoint", bytes);
    let bare =
        Checkpoint::parse_body("out.checkpoint", body.split_once('\n').map_or(body.as_str(), |(_, b)| b));
    for read in [&whole, &bare].into_iter().flatten() {
        let _ = read.refined_mesh("out.checkpoint", SimulationMesh::of_source(&garment), &read.fingerprint);
        let _ = read.check("out.checkpoint", &garment, &script, None);
        let bytes = read.to_bytes();
        assert_eq!(Checkpoint::parse("again", &bytes).expect("our own checkpoint is read"), *read);
    }
    whole.map(|_| ())
}

/// Returns a checkpoint of two triangles and one action.
fn small_run() -> (Garment, WearScript) {
    let square = b"v 0 0 0\nv 0.2 0 0\nv 0.2 0.2 0\nv 0 0.2 0\nf 1 2 3\nf 1 3 4\n";
    let options = ReadOptions::default();
    let (asset, _) = read_asset("square.obj", square, &options, &mut |_| Ok(Vec::new())).expect("a square");
    let (garment, _) = Garment::from_asset(&asset).expect("a garment");
    let script = WearScript::parse("w", r#"{"format": "crease-wear/1", "actions": [{"lay": {}}]}"#);
    (garment, script.expect("a script"))
}

fn text(bytes: &[u8]) -> Result<String> {
    String::from_utf8(bytes.to_vec()).map_err(|_| Error::input("file", "", "is not UTF-8 text", ""))
}
