//! Transfers a crease from one sheet to another with other triangles, and relaxes that sheet with it.
//!
//! `cargo run --release --example transfer`

use crease::{
    Fabric, GarmentFile, MatchBy, RestState, Transfer, Vec3, WearScript, WornGarment, relax, transfer_source,
};

fn main() -> crease::Result<()> {
    let (from, to) = (GarmentFile::sheet([0.2, 0.2], [8, 8])?, GarmentFile::sheet([0.2, 0.2], [11, 11])?);
    // A crease of 1 rad along the middle of the first sheet.
    let hinges = &from.garment.topology.hinges;
    let mut memory = RestState::flat(hinges.len(), from.garment.triangles.len());
    for (angle, hinge) in memory.rest_angle.iter_mut().zip(hinges) {
        let on_middle = hinge.points[..2].iter().all(|p| (from.garment.points[p.at()].x - 0.1).abs() < 1e-9);
        *angle = if on_middle { 1.0 } else { 0.0 };
    }
    let worn = WornGarment { displacement: vec![Vec3::zeros(); from.garment.points.len()], memory };
    let fabric = Fabric::preset("denim")?;
    let script =
        WearScript::parse("none", r#"{"format": "crease-wear/1", "actions": [{"settle": {"for": 1}}]}"#)?;
    let source = transfer_source("sheet.crease.json", &from.sidecar(&worn, &fabric, &script)?)?;

    let carried = Transfer::new(source, &to.garment).match_by(MatchBy::Surface).run()?;
    let relaxed = relax(&to.garment, &fabric, &carried.memory);
    let highest = relaxed.displacement.iter().fold(0.0, |max: f64, d| max.max(d.norm()));
    println!("the other sheet moves by up to {:.1} mm", 1000.0 * highest);
    Ok(())
}
