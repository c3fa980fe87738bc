//! A memory baked on one tessellation of the T-shirt and transferred to another, against one that was baked there:
//!
//! ```text
//! cargo run --release --example transfer_bakes -- FROM.crease.json TO.crease.json
//! ```
//!
//! Both from `fold-thrice`, or both from `press-crease`, whose one fold lies in the middle. With two bakes of one mesh from
//! perturbed initial conditions the output is the correlation of replicates.

// The angle of a made fold is used by the test only.
#[allow(dead_code)]
#[path = "measure.rs"]
mod measure;

use crease::internal::transfer::MatchBy;
use crease_io::read_sidecar;
use crease_model::garment::RestState;
use crease_model::remesh::GarmentSurface;
use measure::{FOLDS, Fold, carry, correlation, tensors, total, turns};

/// Widths over which curvature is averaged before it is compared [m]: none, an edge of 5,000 points, a narrow fold.
const WIDTHS: [f64; 4] = [0.0, 0.01, 0.02, 0.04];

/// The fold of `press-crease`.
const MIDDLE: Fold = Fold { axis: 0, at: 0.0, ..FOLDS[0] };

fn main() {
    let paths: Vec<String> = std::env::args().skip(1).collect();
    let [from, to] = paths.as_slice() else {
        eprintln!("two sidecars are needed: FROM.crease.json TO.crease.json");
        std::process::exit(1)
    };
    let [(from, earned), (to, baked)] = [from, to].map(|path| match load(path) {
        Ok(loaded) => loaded,
        Err(error) => {
            eprintln!("{error}");
            std::process::exit(1)
        }
    });
    let there = carry(&from, &earned, &to, MatchBy::Surface);
    let back = carry(&to, &there.memory, &from, MatchBy::Surface);
    let [carried, wanted] = [&there.memory, &baked].map(|memory| tensors(&to, memory));
    println!("{} -> {} points", from.points.len(), to.points.len());
    for width in WIDTHS {
        let [a, b] = [&carried, &wanted].map(|t| averaged(&to, t, width));
        println!("  correlation, averaged over {:.0} mm: {:.3}", 1e3 * width, correlation(&a, &b));
    }
    for fold in FOLDS.iter().chain([&MIDDLE]) {
        for front in [true, false] {
            let each = [(&from, &earned), (&to, &there.memory), (&to, &baked), (&from, &back.memory)];
            let [own, got, wanted, again] = each.map(|(surface, memory)| total(surface, memory, fold, front));
            let [crease, come, made, home] = each.map(|(surface, memory)| {
                let [one, other] = turns(surface, memory, fold, front);
                if one > -other { one } else { other }
            });
            println!(
                "  fold across {} at {:+.3} m, {}: {own:+.4} carried {got:+.4}, baked there {wanted:+.4}, back {again:+.4} rad; without what bends \
                 back beside it {crease:+.4}, {come:+.4}, {made:+.4}, {home:+.4} rad",
                ["x", "y", "z"][fold.axis],
                fold.at,
                if front { "front" } else { "back" }
            );
        }
    }
}

fn load(path: &str) -> Result<(GarmentSurface, RestState), Box<dyn std::error::Error>> {
    let sidecar = read_sidecar(path, &std::fs::read(path)?)?;
    Ok(crease_io::sidecar_surface(path, &sidecar)?)
}

/// Every triangle's curvature averaged with its neighbours on the same side by a bell of standard deviation `width` [m].
fn averaged(surface: &GarmentSurface, tensors: &[[f64; 4]], width: f64) -> Vec<[f64; 4]> {
    if width == 0.0 {
        return tensors.to_vec();
    }
    let centres: Vec<_> = (0..tensors.len())
        .map(|f| surface.corners(f).iter().sum::<crease_geometry::math::Vec3>() / 3.0)
        .collect();
    let up: Vec<bool> = (0..tensors.len()).map(|f| surface.normal(f).y > 0.0).collect();
    let one = |f: usize| {
        let mut out = [tensors[f][0], 0.0, 0.0, 0.0];
        let mut sum = 0.0;
        for g in 0..tensors.len() {
            let apart = (centres[g] - centres[f]).norm_squared() / (width * width);
            if up[g] == up[f] && apart < 9.0 {
                let weight = tensors[g][0] * (-0.5 * apart).exp();
                sum += weight;
                (1..4).for_each(|c| out[c] += weight * tensors[g][c]);
            }
        }
        (1..4).for_each(|c| out[c] /= sum);
        out
    };
    (0..tensors.len()).map(one).collect()
}
