//! Transfer between tessellations of one garment, against a memory that is known exactly.
//!
//! The memory is not baked here (that takes minutes) but made: every layer of the T-shirt is rolled along the three lines of
//! `fold-thrice`, and the angles of its hinges are its memory. That is exact on any tessellation, so a transferred memory can
//! be compared with the one made there, without the noise of a simulation.

#[path = "transfer/alignment.rs"]
mod alignment;
#[path = "transfer/creases.rs"]
mod creases;
#[path = "reference/external.rs"]
mod external;
#[path = "common/glb.rs"]
mod glb;
#[path = "transfer/limbs.rs"]
mod limbs;
#[path = "transfer/made.rs"]
mod made;
#[path = "transfer/measure.rs"]
mod measure;
#[path = "transfer/sizes.rs"]
mod sizes;
#[path = "transfer/textures.rs"]
mod textures;
#[path = "transfer/tool.rs"]
mod tool;

use crease::internal::bake::{BakeOptions, MeshChoice};
use crease::internal::transfer::{MatchBy, Transfer, TransferOptions, TransferSource, transfer};
use crease::internal::wear::WearScript;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::hinge_angle;
use crease_io::Sidecar;
use crease_model::fabric::{DEFAULT_FABRIC, Fabric};
use crease_model::garment::{RestState, WornGarment};
use crease_model::remesh::{GarmentSurface, prolongate};
use made::{load, made_memory};
use measure::{FOLDS, Fold, carry, correlation, tensors, total};
use serde_json::Value;
use std::path::Path;

#[test]
fn folds_survive_finer_and_coarser_tessellations_and_the_return() {
    // Other tessellations of the same T-shirt, made with `generate_garments -- --tshirt-edge MM`: TWO PATHS, comma between.
    let others = std::env::var("CREASE_TESSELLATIONS").unwrap_or_default();
    let (first, second) = others.split_once(',').unwrap_or(("tshirt-draft.glb", "tshirt.glb"));
    let surfaces = [first, second].map(|name| {
        let (asset, garment) = load(name);
        GarmentSurface::from_garment(&garment, &asset)
    });
    let memories = [made_memory(&surfaces[0]), made_memory(&surfaces[1])];
    for (from, to) in [(0, 1), (1, 0)] {
        for by in [MatchBy::Surface, MatchBy::Uv] {
            let there = carry(&surfaces[from], &memories[from], &surfaces[to], by);
            let back = carry(&surfaces[to], &there.memory, &surfaces[from], by);
            let fits =
                correlation(&tensors(&surfaces[to], &there.memory), &tensors(&surfaces[to], &memories[to]));
            let returns = correlation(
                &tensors(&surfaces[from], &back.memory),
                &tensors(&surfaces[from], &memories[from]),
            );
            println!(
                "{} -> {} points by {}: correlation {fits:.3}, back {returns:.3}, confidence {:.3}",
                surfaces[from].points.len(),
                surfaces[to].points.len(),
                by.name(),
                there.confidence.iter().sum::<f64>() / there.confidence.len() as f64
            );
            for fold in &FOLDS {
                for front in [true, false] {
                    let made = total(&surfaces[from], &memories[from], fold, front);
                    let got = total(&surfaces[to], &there.memory, fold, front);
                    let again = total(&surfaces[from], &back.memory, fold, front);
                    println!("  fold of {:+.2}: {made:+.4} -> {got:+.4} -> {again:+.4} rad", fold.angle);
                    assert!((got - made).abs() < 0.1 * made.abs());
                    assert!((again - made).abs() < 0.15 * made.abs());
                }
            }
            assert!(fits > 0.9 && returns > 0.9);
        }
    }
}

/// As much memory of a simulation mesh lies across each fold of the garment.
#[test]
fn memory_of_a_simulation_mesh_is_prolongated_to_the_garment() {
    let (_, garment) = load("tshirt.glb");
    let path =
        Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("garments/wear/fold-thrice.json");
    let text = std::fs::read_to_string(path).expect("a script of the repository");
    let script = WearScript::parse("fold-thrice.json", &text).expect("is a script");
    let fabric = Fabric::preset(DEFAULT_FABRIC).expect("exists");
    let MeshChoice { mesh, .. } = MeshChoice::new(&garment, &fabric, &script, None, &BakeOptions::default());
    assert!(mesh.garment.points.len() < garment.points.len() / 3, "{} points", mesh.garment.points.len());
    let (own, whole) =
        (GarmentSurface::without_texture(&mesh.garment), GarmentSurface::without_texture(&garment));
    let (earned, there) = (made_memory(&own), made_memory(&whole));
    let back = prolongate(&mesh, &earned, &garment);
    let fits = correlation(&tensors(&whole, &back), &tensors(&whole, &there));
    println!("{} -> {} points: correlation {fits:.3}", own.points.len(), whole.points.len());
    assert!(fits > 0.8);
    for fold in &FOLDS {
        for front in [true, false] {
            let [made, got] = [&there, &back].map(|memory| total(&whole, memory, fold, front));
            println!("  fold of {:+.2}: {made:+.4} -> {got:+.4} rad", fold.angle);
            assert!((got - made).abs() < 0.1 * made.abs());
        }
    }
}

/// On the same mesh not even the last bit may change; and no memory changes nothing.
#[test]
fn the_same_mesh_keeps_every_bit_and_no_memory_changes_nothing() {
    let (asset, garment) = load("tshirt-draft.glb");
    let surface = GarmentSurface::from_garment(&garment, &asset);
    let memory = made_memory(&surface);
    let same = carry(&surface, &memory, &surface, MatchBy::Auto);
    assert_eq!(same.memory, memory);
    assert!(same.unchanged);
    let (asset, other) = load("handkerchief.glb");
    let target = GarmentSurface::from_garment(&other, &asset);
    let angles = |s: &GarmentSurface| -> Vec<f64> {
        s.topology.hinges.iter().map(|h| hinge_angle(&h.points.map(|p| s.points[p.at()]))).collect()
    };
    let nothing = RestState::new(angles(&surface), surface.triangles.len());
    for by in [MatchBy::Auto, MatchBy::Surface, MatchBy::Uv] {
        let new = carry(&surface, &nothing, &target, by).memory;
        assert_eq!(new, RestState::new(angles(&target), target.triangles.len()), "{by:?}");
    }
    let refused = {
        let source =
            TransferSource { file: "made".into(), surface, memory, joints: Vec::new(), simulated: None };
        let options =
            TransferOptions { match_by: MatchBy::Same, ..TransferOptions::full(target.points.len()) };
        transfer(&[source], &target, &options).expect_err("another mesh").to_string()
    };
    assert!(refused.contains("is not the mesh it is to go to"), "{refused}");
}

/// The front door gives what the function gives.
#[test]
fn the_builder_transfers_a_sidecar_as_the_function_does() {
    let (asset, garment) = load("tshirt-draft.glb");
    let memory = made_memory(&GarmentSurface::from_garment(&garment, &asset));
    let worn = WornGarment { displacement: vec![Vec3::zeros(); garment.points.len()], memory };
    let null = Value::Null;
    let sidecar = Sidecar::new(&asset, &garment, &worn, null.clone(), null.clone(), null).expect("is sound");
    let same = Transfer::new(crease::transfer_source("sidecar", &sidecar).expect("is sound"), &garment)
        .run()
        .expect("transfers");
    assert!(same.unchanged && same.memory == worn.memory);
    let (_, other) = load("handkerchief.glb");
    let built = Transfer::new(crease::transfer_source("sidecar", &sidecar).expect("is sound"), &other)
        .match_by(MatchBy::Surface)
        .strength(0.5)
        .run()
        .expect("transfers");
    let target = GarmentSurface::without_texture(&other);
    let source = crease::transfer_source("sidecar", &sidecar).expect("is sound");
    let options = TransferOptions {
        match_by: MatchBy::Surface,
        strength: 0.5,
        mask: other.memory_mask.clone(),
        ..TransferOptions::full(target.points.len())
    };
    let called = transfer(&[source], &target, &options).expect("transfers");
    assert_eq!((built.memory, built.sources), (called.memory, called.sources));
}

#[test]
fn strength_mask_channels_layers_and_mirror_act_as_documented() {
    let (asset, garment) = load("tshirt-draft.glb");
    let surface = GarmentSurface::from_garment(&garment, &asset);
    let mut memory = made_memory(&surface);
    memory.stiffness_ratio.iter_mut().for_each(|s| *s = 3.0);
    memory.rest_stretch_warp.iter_mut().for_each(|r| *r = 1.02);
    let source = TransferSource {
        file: "made".into(),
        surface: surface.clone(),
        memory: memory.clone(),
        joints: Vec::new(),
        simulated: None,
    };
    let with = |change: &dyn Fn(&mut TransferOptions), sources: &[TransferSource]| {
        let mut options =
            TransferOptions { match_by: MatchBy::Surface, ..TransferOptions::full(surface.points.len()) };
        change(&mut options);
        transfer(sources, &surface, &options).expect("carries").memory
    };
    let one = std::slice::from_ref(&source);
    let full = with(&|_| {}, one);
    // Constants are transferred exactly, whatever the directions.
    assert!(full.stiffness_ratio.iter().all(|s| (s - 3.0).abs() < 1e-9));
    assert!(full.rest_stretch_warp.iter().all(|r| (r - 1.02).abs() < 1e-3));
    let half = with(&|o| o.strength = 0.5, one);
    let twice = with(&|_| {}, &[source.clone(), source.clone()]);
    for h in 0..surface.topology.hinges.len() {
        let change = |m: &RestState| m.rest_angle[h] - m.source_angle[h];
        assert!((2.0 * change(&half) - change(&full)).abs() < 1e-9);
        assert!((change(&twice) - 2.0 * change(&full)).abs() < 1e-9);
        assert!(
            (half.stiffness_ratio[h] - 2.0).abs() < 1e-9 && (twice.stiffness_ratio[h] - 3.0).abs() < 1e-9
        );
    }
    let bagging = with(&|o| o.channels.creases = false, one);
    assert_eq!(bagging.rest_angle, bagging.source_angle);
    assert!(bagging.rest_stretch_warp.iter().all(|r| (r - 1.02).abs() < 1e-3));
    let creases = with(&|o| o.channels.bagging = false, one);
    assert_eq!(creases.rest_angle, full.rest_angle);
    assert!(creases.rest_stretch_warp.iter().all(|r| *r == 1.0));
    let left: Vec<f64> = surface.points.iter().map(|p| if p.x > 0.0 { 1.0 } else { 0.0 }).collect();
    let masked = with(&|o| o.mask = left.clone(), one);
    for (h, hinge) in surface.topology.hinges.iter().enumerate() {
        let inside = hinge.points[..2].iter().all(|p| left[p.at()] == 1.0);
        let wanted = if inside { full.rest_angle[h] } else { full.source_angle[h] };
        assert_eq!(masked.rest_angle[h], wanted);
    }
    // Mirrored, the folds of both sides are exchanged and keep their sign.
    let mirrored = with(&|o| o.mirror_x = true, one);
    for (i, j) in [(0, 1), (1, 0), (2, 2)] {
        let there = Fold { at: FOLDS[j].at, ..FOLDS[i] };
        for front in [true, false] {
            let (made, got) =
                (total(&surface, &memory, &FOLDS[i], front), total(&surface, &mirrored, &there, front));
            assert!((made - got).abs() < 0.05 * made.abs(), "{made} {got}");
        }
    }
}
