//! Reads a sidecar and lists its sharpest creases.
//!
//! `cargo run --release --example sidecar -- OUT.crease.json`

use crease::{Load, Sidecar};

fn main() -> crease::Result<()> {
    let Some(path) = std::env::args().nth(1) else {
        eprintln!("usage: sidecar OUT.crease.json");
        std::process::exit(2);
    };
    let sidecar = Sidecar::load(&path)?;
    let hinges = &sidecar.hinges;
    println!(
        "{}: {} points, {} hinges",
        sidecar.source.file,
        sidecar.mesh.points_m.len(),
        hinges.points.len()
    );
    let mut changes: Vec<(f64, usize)> = (0..hinges.points.len())
        .map(|h| (hinges.rest_angle_rad[h] - hinges.source_angle_rad[h], h))
        .collect();
    changes.sort_by(|a, b| b.0.abs().total_cmp(&a.0.abs()));
    for (change, h) in changes.into_iter().take(10) {
        let [a, b, ..] = hinges.points[h];
        println!(
            "points {a} to {b}: {:+.1} degrees, stiffness x {:.2}",
            change.to_degrees(),
            hinges.stiffness_ratio[h]
        );
    }
    Ok(())
}
