//! Transfer between sizes of one garment, and what a transfer says of its own doubts.

use crate::made::{load, made_memory, sleeve};
use crate::measure::{FOLDS, carry};
use crease::GarmentFile;
use crease::internal::transfer::{
    Align, AlignedBy, MatchBy, TransferOptions, TransferResult, TransferSource, transfer,
};
use crease_geometry::math::Vec3;
use crease_model::garment::RestState;
use crease_model::remesh::GarmentSurface;

/// `surface` scaled along x and z, as another size of it that lies in the same place.
fn size_of(surface: &GarmentSurface, [x, z]: [f64; 2]) -> GarmentSurface {
    let points = surface.points.iter().map(|p| Vec3::new(p.x * x, p.y, p.z * z)).collect();
    GarmentSurface { points, uvs: None, ..surface.clone() }
}

/// Memory of `surface` with the changes that `angle` gives for the middles of its hinges [rad].
fn memory_of(surface: &GarmentSurface, angle: impl Fn(Vec3) -> f64) -> RestState {
    let mut memory = RestState::new(made_memory(surface).source_angle, surface.triangles.len());
    for (h, hinge) in surface.topology.hinges.iter().enumerate() {
        memory.rest_angle[h] +=
            angle(0.5 * (surface.points[hinge.points[0].at()] + surface.points[hinge.points[1].at()]));
    }
    memory
}

/// Fraction of the box along `axis` at which the changes of `memory` lie, in the mean.
fn fraction(surface: &GarmentSurface, memory: &RestState, axis: usize) -> f64 {
    let low = surface.points.iter().map(|p| p[axis]).fold(f64::INFINITY, f64::min);
    let high = surface.points.iter().map(|p| p[axis]).fold(f64::NEG_INFINITY, f64::max);
    let (mut sum, mut place) = (0.0, 0.0);
    for (hinge, change) in surface.topology.hinges.iter().zip(memory.angle_changes()) {
        let [a, b] = [0, 1].map(|k| surface.points[hinge.points[k].at()]);
        let weight = change.abs() * (b - a).norm();
        sum += weight;
        place += weight * 0.5 * (a + b)[axis];
    }
    (place / sum - low) / (high - low)
}

fn aligned_by(carried: &TransferResult) -> Option<AlignedBy> {
    carried.sources[0].aligned_by
}

/// A T-shirt that lies, and the same in XS, XL and without 3 % of it: the fold keeps its fraction, where "in place" would leave it where it
/// was in metres. A handkerchief of another size, too; a pocket that is cut out of it keeps its place.
#[test]
fn a_fold_keeps_its_fraction_on_another_size() {
    let (asset, garment) = load("tshirt-draft.glb");
    let shirt = GarmentSurface::from_garment(&garment, &asset);
    let fold = FOLDS[0];
    let memory = memory_of(&shirt, |x| if (x[fold.axis] - fold.at).abs() < fold.width { 0.4 } else { 0.0 });
    let own = fraction(&shirt, &memory, fold.axis);
    for scale in [[0.82, 0.9], [1.32, 1.12], [1.2, 1.2]] {
        let target = size_of(&shirt, scale);
        let carried = carry(&shirt, &memory, &target, MatchBy::Auto);
        let off = fraction(&target, &carried.memory, fold.axis) - own;
        println!("{scale:?}: {:+.2} % off, {:?}", 100.0 * off, carried.sources[0]);
        assert!(off.abs() < 0.01 && carried.sources[0].losses.unmatched_target_fraction < 0.02);
    }
    let sheet = |size: [f64; 2], cells: [u32; 2], shift: f64| {
        let file = GarmentFile::sheet(size, cells).expect("is a sheet");
        let mut surface = GarmentSurface::without_texture(&file.garment);
        surface.points.iter_mut().for_each(|p| *p += Vec3::new(shift, 0.0, shift));
        surface
    };
    let cloth = sheet([0.4, 0.4], [32, 32], 0.0);
    let memory = memory_of(&cloth, |x| if (x.x - 0.12).abs() < 0.01 { 0.6 } else { 0.0 });
    let smaller = sheet([0.3, 0.3], [30, 30], 0.05);
    let carried = carry(&cloth, &memory, &smaller, MatchBy::Auto);
    assert!((fraction(&smaller, &carried.memory, 0) - 0.3).abs() < 0.02);
    let pocket = sheet([0.1, 0.1], [20, 20], 0.06);
    let carried = carry(&cloth, &memory, &pocket, MatchBy::Auto);
    assert_eq!(aligned_by(&carried), Some(AlignedBy::InPlace));
    assert!((fraction(&pocket, &carried.memory, 0) - 0.6).abs() < 0.04);
}

/// A sleeve that follows the shoulder and the elbow only, and one with two of its joints that are no bone.
#[test]
fn two_joints_that_are_a_bone_align_a_shorter_sleeve() {
    let ((straight, from), (bent, to)) = (sleeve(0.0), sleeve(1.2));
    let (surface, target) =
        (GarmentSurface::from_garment(&from, &straight), GarmentSurface::from_garment(&to, &bent));
    let memory = memory_of(&surface, |x| if (0.3..0.34).contains(&x.x) { 0.5 } else { 0.0 });
    let source = TransferSource {
        file: "made".into(),
        surface,
        memory,
        joints: straight.worn_joints(),
        simulated: None,
    };
    let joints = bent.worn_joints();
    let with = |kept: &[usize], align| {
        let options = TransferOptions {
            joints: kept.iter().map(|k| joints[*k].clone()).collect(),
            align,
            match_by: MatchBy::Surface,
            ..TransferOptions::full(target.points.len())
        };
        transfer(std::slice::from_ref(&source), &target, &options)
    };
    let is_bone = |a: usize, b: usize| joints[b].parent.as_ref() == Some(&joints[a].name);
    let pairs = [[0, 1], [1, 2], [0, 2]];
    let bone = pairs.into_iter().find(|[a, b]| is_bone(*a, *b)).expect("an arm has a bone");
    let apart =
        pairs.into_iter().find(|[a, b]| !is_bone(*a, *b) && !is_bone(*b, *a)).expect("ends of the arm");
    let carried = with(&bone, Align::Auto).expect("carries");
    assert_eq!(aligned_by(&carried), Some(AlignedBy::Joints));
    assert!(carried.sources[0].losses.lost_crease_fraction < 0.05, "{:?}", carried.sources[0]);
    let refusal = with(&apart, Align::Joints).expect_err("no bone").to_string();
    assert!(refusal.contains("no bone in common"), "{refusal}");
}

/// A strength of 50, the same memory three times, and a target that lacks most of the worn cloth: told, and no confidence.
#[test]
fn doubts_are_told_and_lower_the_confidence() {
    let sheet = |size: f64, cells: u32| {
        let file = GarmentFile::sheet([size, 0.4], [cells, 32]).expect("is a sheet");
        GarmentSurface::without_texture(&file.garment)
    };
    let (cloth, narrow) = (sheet(0.4, 32), sheet(0.15, 14));
    // Worn at x = 0.1 m, and twice as much where the narrow one has no cloth.
    let memory = memory_of(&cloth, |x| match x.x {
        x if (x - 0.1).abs() < 0.01 => 0.4,
        x if (x - 0.3).abs() < 0.02 => 0.4,
        _ => 0.0,
    });
    let source = TransferSource {
        file: "made".into(),
        surface: cloth.clone(),
        memory,
        joints: Vec::new(),
        simulated: None,
    };
    let carried = |count: usize, strength: f64, target: &GarmentSurface| {
        let options =
            TransferOptions { strength, align: Align::InPlace, ..TransferOptions::full(target.points.len()) };
        transfer(&vec![source.clone(); count], target, &options).expect("carries")
    };
    let told = |result: &TransferResult, what: &str| {
        result.warnings.iter().any(|warning| warning.to_string().contains(what))
    };
    let other = sheet(0.4, 27);
    let once = carried(1, 1.0, &other);
    assert!(once.warnings.is_empty(), "{:?}", once.warnings);
    assert!(told(&carried(3, 1.0, &other), "is given 3 times"));
    assert!(told(&carried(1, 50.0, &other), "a strength of 50"));
    let part = carried(1, 1.0, &narrow);
    let mean =
        |result: &TransferResult| result.confidence.iter().sum::<f64>() / result.confidence.len() as f64;
    let lost = part.sources[0].losses.lost_crease_fraction;
    println!("{:.2} lost, confidence {:.2}; whole {:.2}", lost, mean(&part), mean(&once));
    assert!(lost > 0.5 && mean(&part) < 1.0 - lost + 0.01 && mean(&once) > 0.9);
    let nothing = TransferSource { memory: memory_of(&cloth, |_| 0.0), ..source.clone() };
    let options = TransferOptions::full(other.points.len());
    let empty = transfer(&[nothing], &other, &options).expect("carries");
    assert!(empty.empty_reason.is_some() && mean(&empty) == 0.0);
}
