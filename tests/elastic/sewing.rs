//! The sewing mask: where the file says 0 the simulated cloth is single.

use crease::internal::bake::{BakeOptions, MeshChoice};
use crease::{Fabric, GarmentFile, ReadOptions, WearScript};
use crease_solver::sim::{Cloth, Sewing};

/// A sheet of 0.4 m as an OBJ in metres, white in its right half, black in its left one.
fn painted_sheet() -> String {
    const CELLS: usize = 20;
    let row = CELLS + 1;
    let mut text = String::new();
    for k in 0..row * row {
        let [x, z] = [k % row, k / row].map(|i| 0.02 * i as f64);
        let white = u8::from(k % row >= CELLS / 2);
        text += &format!("v {x} 0 {z} {white} {white} {white}\n");
    }
    for cell in 0..CELLS * CELLS {
        let first = cell % CELLS + row * (cell / CELLS) + 1;
        text += &format!("f {first} {} {} {}\n", first + row, first + row + 1, first + 1);
    }
    text
}

#[test]
fn a_sewing_mask_of_the_file_reaches_the_simulated_mesh() {
    let fabric = Fabric::preset("cotton-jersey").unwrap();
    let script = r#"{"format": "crease-wear/1", "name": "", "actions": [
        {"fold": {"line": [[0.0, 0.4], [1.0, 0.4]], "side": "upper", "angle": 180, "over": 1.0}}]}"#;
    let script = WearScript::parse("wear.json", script).unwrap();
    let hem_masses = |sewing_mask: Option<&str>| {
        let options = ReadOptions { sewing_mask: sewing_mask.map(str::to_owned), ..ReadOptions::default() };
        let file = GarmentFile::parse("sheet.obj", painted_sheet().as_bytes(), &options).unwrap();
        let mesh = MeshChoice::new(&file.garment, &fabric, &script, None, &BakeOptions::default()).mesh;
        assert!(!mesh.is_source, "a mesh with fold lines");
        let [sewn, single] = [Sewing::ALL, Sewing::NONE].map(|s| Cloth::sewn(&mesh.garment, &fabric, s).mass);
        // The hem's second layer weighs as much as the cloth of it: a strip of 20 mm.
        let points = mesh.garment.points.iter();
        points.zip(sewn.iter().zip(single)).fold([0.0; 2], |[left, right], (p, (sewn, single))| {
            let added = sewn - single;
            // Within an edge of the middle both halves have some of it.
            if p.x < 0.2 { [left + added, right] } else { [left, right + added] }
        })
    };
    let hem = 0.02 * (0.4 + 2.0 * 0.19) * fabric.area_density();
    let [left, right] = hem_masses(None);
    assert!((left / hem - 1.0).abs() < 0.1 && (right / hem - 1.0).abs() < 0.1, "{left} {right} {hem}");
    let [left, right] = hem_masses(Some("COLOR_0.r"));
    assert!(left < 0.05 * hem && (right / hem - 1.0).abs() < 0.1, "{left} {right} {hem}");
}
