//! Transfer between tessellations of one garment, against a memory that is known exactly.
//!
//! The memory is not baked here (minutes) but made: every layer of the T-shirt is rolled along the three lines of
//! `fold-thrice`, and the angles its hinges then have are what it remembers. That is exact on any tessellation, so what is
//! carried from one to another can be judged against what would be there, with no noise of a simulation in between.

use crease::format::{ReadOptions, SourceAsset, read_asset};
use crease::garment::{Garment, RestShape};
use crease::math::Vec3;
use crease::mesh::hinge_angle;
use crease::transfer::{By, Carried, Sheet, Source, TransferOptions, transfer};
use std::path::Path;

/// A fold: axis across it (0 = x, 2 = z), place on it [m], total angle [rad], half width [m].
#[derive(Clone, Copy)]
struct Fold {
    axis: usize,
    at: f64,
    angle: f64,
    width: f64,
}

/// Where `fold-thrice` folds the T-shirt of 0.892 x 0.7 m.
const FOLDS: [Fold; 3] = [
    Fold { axis: 0, at: -0.178, angle: 1.2, width: 0.02 },
    Fold { axis: 0, at: 0.178, angle: -0.9, width: 0.02 },
    Fold { axis: 2, at: 0.0, angle: 0.7, width: 0.02 },
];

fn load(name: &str) -> (SourceAsset, Garment) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("garments").join(name);
    let bytes = std::fs::read(&path).expect("a garment of the repository");
    let mut nothing = |_: &str| Ok(Vec::new());
    let (asset, _) = read_asset(name, &bytes, &ReadOptions::default(), &mut nothing).expect("reads");
    let (garment, _) = Garment::from_asset(&asset).expect("is a garment");
    (asset, garment)
}

/// The sheet rolled flat and then along the folds of `axis`: the surface turns by the fold's angle over its width.
fn rolled(sheet: &Sheet, fold: &Fold) -> Vec<Vec3> {
    let (half, total) = (fold.width, fold.angle);
    let bent = |s: f64| {
        // Turning angle rises evenly from 0 to the total over [-half, half].
        let inside = s.clamp(-half, half) + half;
        let rate = total / (2.0 * half);
        let phi = rate * inside;
        let arc = Vec3::new(phi.sin(), 0.0, 1.0 - phi.cos()) / rate;
        let before = Vec3::new(s.min(-half), 0.0, 0.0);
        let after = Vec3::new(phi.cos(), 0.0, phi.sin()) * (s - half).max(0.0);
        before + arc + after
    };
    let place = |p: &Vec3| {
        let b = bent(p[fold.axis] - fold.at);
        let other = p[2 - fold.axis];
        // Height is y; the sense of the roll is the same on both layers.
        if fold.axis == 0 { Vec3::new(b.x, b.z, other) } else { Vec3::new(other, b.z, b.x) }
    };
    sheet.points.iter().map(place).collect()
}

fn made_memory(sheet: &Sheet) -> RestShape {
    let angles = |x: &[Vec3]| -> Vec<f64> {
        sheet.topology.hinges.iter().map(|h| hinge_angle(&h.points.map(|p| x[p.at()]))).collect()
    };
    let mut memory = RestShape::new(angles(&sheet.points), sheet.triangles.len());
    let flat: Vec<Vec3> = sheet.points.iter().map(|p| Vec3::new(p.x, 0.0, p.z)).collect();
    let flat_angle = angles(&flat);
    for fold in &FOLDS {
        for (h, angle) in angles(&rolled(sheet, fold)).into_iter().enumerate() {
            // At the seams the flat layers lie face to face: that half turn is no fold.
            let change = angle - flat_angle[h];
            memory.rest_angle[h] += if change.abs() < 2.0 { change } else { 0.0 };
        }
    }
    memory
}

/// Sum of (change x length x (across)²) over the hinges of one layer within reach of a fold, per length of the fold:
/// the angle by which the cloth turns there [rad].
fn total(sheet: &Sheet, memory: &RestShape, fold: &Fold, front: bool) -> f64 {
    let other = 2 - fold.axis;
    let (mut sum, reach) = (0.0, 4.0 * fold.width);
    // Away from borders and from the other folds.
    let along = if fold.axis == 0 { 0.05..0.25 } else { -0.1..0.1 };
    for (h, hinge) in sheet.topology.hinges.iter().enumerate() {
        let [a, b] = [hinge.points[0], hinge.points[1]].map(|p| sheet.points[p.at()]);
        let (middle, edge) = (0.5 * (a + b), b - a);
        let up = sheet.normal(hinge.triangles[0] as usize).y > 0.0;
        if up == front && (middle[fold.axis] - fold.at).abs() < reach && along.contains(&middle[other]) {
            let across = edge[other] / edge.norm();
            sum += (memory.rest_angle[h] - memory.source_angle[h]) * edge.norm() * across * across;
        }
    }
    sum / (along.end - along.start)
}

/// Change of curvature of every triangle as (area, xx, zz, sqrt2 xz), from its hinges.
fn tensors(sheet: &Sheet, memory: &RestShape) -> Vec<[f64; 4]> {
    let one = |f: usize| {
        let area = 0.5 * sheet.normal(f).norm();
        let corners = sheet.corners(f);
        let mut out = [area, 0.0, 0.0, 0.0];
        for k in 0..3 {
            let edge = corners[(k + 1) % 3] - corners[k];
            let Some(h) = sheet.topology.edge_hinge[sheet.topology.triangle_edges[f][k] as usize] else { continue };
            let h = h as usize;
            let weight = (memory.rest_angle[h] - memory.source_angle[h]) / (2.0 * area * edge.norm());
            out[1] += weight * edge.z * edge.z;
            out[2] += weight * edge.x * edge.x;
            out[3] -= weight * edge.x * edge.z * 2f64.sqrt();
        }
        out
    };
    (0..sheet.triangles.len()).map(one).collect()
}

/// Correlation of the change of curvature over the surface of one mesh.
fn correlation(a: &[[f64; 4]], b: &[[f64; 4]]) -> f64 {
    let dot = |a: &[[f64; 4]], b: &[[f64; 4]]| -> f64 {
        a.iter().zip(b).map(|(a, b)| a[0] * (1..4).map(|c| a[c] * b[c]).sum::<f64>()).sum()
    };
    dot(a, b) / (dot(a, a) * dot(b, b)).sqrt()
}

fn carry(from: &Sheet, memory: &RestShape, to: &Sheet, by: By) -> Carried {
    let source = Source { file: "made".into(), sheet: from.clone(), memory: memory.clone() };
    let options = TransferOptions { by, ..TransferOptions::full(to.points.len()) };
    transfer(&[source], to, &options).expect("carries")
}

#[test]
fn folds_survive_finer_and_coarser_tessellations_and_the_way_back() {
    let sheets = ["tshirt-draft.glb", "tshirt.glb"].map(|name| {
        let (asset, garment) = load(name);
        Sheet::of_garment(&garment, &asset)
    });
    let memories = [made_memory(&sheets[0]), made_memory(&sheets[1])];
    for (from, to) in [(0, 1), (1, 0)] {
        for by in [By::Surface, By::Uv] {
            let there = carry(&sheets[from], &memories[from], &sheets[to], by);
            let back = carry(&sheets[to], &there.memory, &sheets[from], by);
            let fits = correlation(&tensors(&sheets[to], &there.memory), &tensors(&sheets[to], &memories[to]));
            let returns = correlation(&tensors(&sheets[from], &back.memory), &tensors(&sheets[from], &memories[from]));
            println!(
                "{} -> {} points by {}: correlation {fits:.3}, back {returns:.3}, confidence {:.3}",
                sheets[from].points.len(),
                sheets[to].points.len(),
                by.name(),
                there.confidence.iter().sum::<f64>() / there.confidence.len() as f64
            );
            for fold in &FOLDS {
                for front in [true, false] {
                    let made = total(&sheets[from], &memories[from], fold, front);
                    let got = total(&sheets[to], &there.memory, fold, front);
                    let again = total(&sheets[from], &back.memory, fold, front);
                    println!("  fold of {:+.2}: {made:+.4} -> {got:+.4} -> {again:+.4} rad", fold.angle);
                    assert!((got - made).abs() < 0.1 * made.abs());
                    assert!((again - made).abs() < 0.15 * made.abs());
                }
            }
            assert!(fits > 0.9 && returns > 0.9);
        }
    }
}
