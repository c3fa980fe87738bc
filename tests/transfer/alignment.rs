//! Transfer between garments of different shape: other cuts, other poses, garments of one body.

use crate::external::external;
use crate::made::{load, made_memory, sleeve};
use crate::measure::{FOLDS, carry};
use crease::internal::transfer::{Align, MatchBy, PointPair, TransferOptions, TransferSource, transfer};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::hinge_angle;
use crease_io::{ReadOptions, read_asset};
use crease_model::garment::{Garment, RestState};
use crease_model::remesh::GarmentSurface;
use std::path::Path;
use test_attributes::needs_data;

/// On garments of another cut folds keep their positions, front on front and back on back: in the box where the cuts are nearly alike,
/// across the torso and below the armholes where sleeves are nearly three times as long.
#[needs_data("garments/diffavatar-tshirt")]
#[test]
fn folds_keep_their_position_on_garments_of_another_cut() {
    let (asset, garment) = load("tshirt-draft.glb");
    let surface = GarmentSurface::from_garment(&garment, &asset);
    let folder = external("garments/diffavatar-tshirt");
    for name in ["tshirt.obj", "shirt_initial.obj"] {
        let bytes = std::fs::read(folder.join(name)).expect(name);
        let options = ReadOptions { unit_m: Some(0.01), any_size: true, ..ReadOptions::default() };
        let (asset, _) = read_asset(name, &bytes, &options, &mut |_| Ok(Vec::new())).expect("reads");
        let (garment, _) = Garment::from_asset(&asset).expect("is a garment");
        let target = GarmentSurface::from_garment(&garment, &asset);
        let low = target.points.iter().fold(target.points[0], |a, b| a.inf(b));
        let high = target.points.iter().fold(target.points[0], |a, b| a.sup(b));
        for (i, fold) in FOLDS.iter().enumerate() {
            let mut memory = RestState::new(made_memory(&surface).source_angle, surface.triangles.len());
            let all = made_memory(&surface);
            for (h, hinge) in surface.topology.hinges.iter().enumerate() {
                let middle =
                    0.5 * (surface.points[hinge.points[0].at()] + surface.points[hinge.points[1].at()]);
                if (middle[fold.axis] - fold.at).abs() < 1.5 * fold.width {
                    memory.rest_angle[h] = all.rest_angle[h];
                }
            }
            let carried = carry(&surface, &memory, &target, MatchBy::Auto);
            // The lying shirt's x is the standing one's; its z is downwards.
            let axis = if fold.axis == 0 { 0 } else { 1 };
            let long_sleeves = name == "shirt_initial.obj";
            let wanted = match fold.axis {
                0 if long_sleeves => {
                    let [_, own] = span(surface.points.iter().filter(|p| p.z > 0.1));
                    let [middle, half] =
                        span(target.points.iter().filter(|p| p.y < 0.7 * low.y + 0.3 * high.y));
                    (middle + fold.at / own * half - low.x) / (high.x - low.x)
                }
                0 => fold.at / 0.892 + 0.5,
                // Its armholes are 0.435 m above the hem, those of the target 0.503 m.
                _ if long_sleeves => (0.35 - fold.at) / 0.435 * 0.503 / (high.y - low.y),
                _ => 0.5 - fold.at / 0.7,
            };
            for front in [true, false] {
                let (mut sum, mut position) = (0.0, 0.0);
                for (h, hinge) in target.topology.hinges.iter().enumerate() {
                    let [a, b] = [hinge.points[0], hinge.points[1]].map(|p| target.points[p.at()]);
                    let normal = target.normal(hinge.triangles[0] as usize).normalize();
                    if (normal.z > 0.3) == front && normal.z.abs() > 0.3 {
                        let weight = (carried.memory.rest_angle[h] - carried.memory.source_angle[h]).abs()
                            * (b - a).norm();
                        sum += weight;
                        position += weight * ((0.5 * (a + b))[axis] - low[axis]) / (high[axis] - low[axis]);
                    }
                }
                let off = position / sum - wanted;
                println!("{name}: fold {i}, front {front}: {:+.1} % of the garment off", 100.0 * off);
                assert!(off.abs() < 0.03);
            }
        }
    }
}

/// Middle and half width across of points [m].
fn span<'a>(points: impl Iterator<Item = &'a Vec3>) -> [f64; 2] {
    let (low, high) = points.fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), p| (a.min(p.x), b.max(p.x)));
    [0.5 * (low + high), 0.5 * (high - low)]
}

/// Trousers on legs to trousers that lie flat: in front view edge-on triangles have next to no area, and their angles as
/// curvature would become thousands of degrees.
#[test]
fn edge_on_triangles_do_not_amplify_angles() {
    let path = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("garments/trousers-on-legs.glb");
    let bytes = std::fs::read(path).expect("a garment of the repository");
    let options = ReadOptions { garment: Some("trousers".into()), ..ReadOptions::default() };
    let (asset, _) = read_asset("legs", &bytes, &options, &mut |_| Ok(Vec::new())).expect("reads");
    let (garment, _) = Garment::from_asset(&asset).expect("is a garment");
    let round = GarmentSurface::from_garment(&garment, &asset);
    let (asset, garment) = load("trousers.glb");
    let flat = GarmentSurface::from_garment(&garment, &asset);
    let source = round.topology.hinges.iter().map(|h| hinge_angle(&h.points.map(|p| round.points[p.at()])));
    let mut memory = RestState::new(source.collect(), round.triangles.len());
    memory.rest_angle.iter_mut().for_each(|angle| *angle += 0.3);
    let carried = carry(&round, &memory, &flat, MatchBy::Surface).memory;
    let changes =
        carried.rest_angle.iter().zip(&carried.source_angle).map(|(rest, source)| (rest - source).abs());
    let (largest, sum) = changes.fold((0.0f64, 0.0), |(max, sum), c| (max.max(c), sum + c));
    let mean = sum / carried.rest_angle.len() as f64;
    println!("0.3 rad everywhere: largest {largest:.2} rad, mean {mean:.3} rad");
    assert!(largest < 1.2 && mean > 0.05);
}

/// Rings of creases around the lower arm of a straight sleeve are transferred to the lower arm of a bent one, where bounding
/// boxes would leave them in the air.
#[test]
fn joints_and_landmarks_align_a_straight_sleeve_with_a_bent_one() {
    let ((straight, from), (bent, to)) = (sleeve(0.0), sleeve(1.2));
    let (surface, target) =
        (GarmentSurface::from_garment(&from, &straight), GarmentSurface::from_garment(&to, &bent));
    assert_eq!(straight.worn_joints().len(), 3, "{:?}", straight.worn_joints());
    let mut memory = RestState::new(vec![0.0; surface.topology.hinges.len()], surface.triangles.len());
    let length = |s: &GarmentSurface, h: &crease_geometry::mesh::Hinge| {
        (s.points[h.points[0].at()] - s.points[h.points[1].at()]).norm()
    };
    for (h, hinge) in surface.topology.hinges.iter().enumerate() {
        let [a, b] = [hinge.points[0], hinge.points[1]].map(|p| surface.points[p.at()]);
        let middle = 0.5 * (a + b).x;
        if (0.4..0.42).contains(&middle) || (0.47..0.49).contains(&middle) {
            memory.rest_angle[h] = 0.5 * (1.0 - ((b - a).x / (b - a).norm()).powi(2));
        }
    }
    // Fraction of the transferred creases within a few elements of the rings, and their amount relative to the source.
    let hits = |carried: &RestState| {
        let (mut on, mut all) = (0.0, 0.0);
        for (h, hinge) in target.topology.hinges.iter().enumerate() {
            let weight = (carried.rest_angle[h] - carried.source_angle[h]).abs() * length(&target, hinge);
            let middle =
                0.5 * (surface.points[hinge.points[0].at()] + surface.points[hinge.points[1].at()]).x;
            all += weight;
            if (0.385..0.435).contains(&middle) || (0.455..0.505).contains(&middle) {
                on += weight;
            }
        }
        let made: f64 = surface
            .topology
            .hinges
            .iter()
            .zip(&memory.rest_angle)
            .map(|(h, a)| a.abs() * length(&surface, h))
            .sum();
        (on / all, all / made)
    };
    let source = TransferSource {
        file: "made".into(),
        surface: surface.clone(),
        memory: memory.clone(),
        joints: straight.worn_joints(),
        simulated: None,
    };
    let with = |change: &dyn Fn(&mut TransferOptions)| {
        let mut options = TransferOptions {
            match_by: MatchBy::Surface,
            joints: bent.worn_joints(),
            ..TransferOptions::full(target.points.len())
        };
        change(&mut options);
        transfer(std::slice::from_ref(&source), &target, &options)
    };
    // Every 37th point is marked.
    let pair = |p: usize| PointPair { source: surface.points[p], target: target.points[p] };
    let marked: Vec<PointPair> = (0..surface.points.len()).step_by(37).map(pair).collect();
    type Change<'a> = &'a dyn Fn(&mut TransferOptions);
    let cases: [(&str, Change, f64); 3] = [
        ("joints", &|_| {}, 0.98),
        ("landmarks", &|o| o.landmarks = marked.clone(), 0.98),
        ("box", &|o| o.align = Align::Box, 0.0),
    ];
    let mut found = Vec::new();
    for (name, change, threshold) in cases {
        let carried = with(change).expect("carries");
        let (fraction, amount) = hits(&carried.memory);
        println!("{name}: {:.1} % where it belongs, {:.2} of it", 100.0 * fraction, amount);
        assert_eq!(carried.sources[0].aligned_by.map(|by| by.name()), Some(name));
        assert!(fraction >= threshold);
        found.push(fraction);
    }
    assert!(found[2] < 0.5, "boxes need no help");
    let refused =
        with(&|o| (o.align, o.joints) = (Align::Joints, Vec::new())).expect_err("no joints").to_string();
    assert!(refused.contains("Transfer::landmarks"), "{refused}");
    let twice = with(&|o| o.landmarks = vec![PointPair::from([Vec3::zeros(), Vec3::x()]); 2])
        .expect_err("no map")
        .to_string();
    assert!(twice.contains("apart"), "{twice}");
}

/// Garments of one body stay in place: knees match knees although the boxes differ, and creases at the elbows of a sweater
/// are reported as lost on a tee, which has none.
#[needs_data("garments/makehuman-body-sweater/derived")]
#[test]
fn garments_of_one_body_stay_in_place_and_losses_are_reported() {
    let folder = external("garments/makehuman-body-sweater/derived");
    let read = |name: &str| {
        let bytes = std::fs::read(folder.join(name)).expect(name);
        let options = ReadOptions { unit_m: Some(0.1), any_size: true, ..ReadOptions::default() };
        let (asset, _) = read_asset(name, &bytes, &options, &mut |_| Ok(Vec::new())).expect("reads");
        let (garment, _) = Garment::from_asset(&asset).expect("is a garment");
        GarmentSurface::from_garment(&garment, &asset)
    };
    let (sweater, tee) = (read("male_casualsuit02_fitted.obj"), read("male_casualsuit04_fitted.obj"));
    let middle = |s: &GarmentSurface, h: usize| {
        let hinge = &s.topology.hinges[h];
        0.5 * (s.points[hinge.points[0].at()] + s.points[hinge.points[1].at()])
    };
    // Hinges inside a region get a memory of half a radian.
    let made = |s: &GarmentSurface, inside: &dyn Fn(Vec3) -> bool| {
        let angle = |h: &crease_geometry::mesh::Hinge| hinge_angle(&h.points.map(|p| s.points[p.at()]));
        let mut memory = RestState::new(s.topology.hinges.iter().map(angle).collect(), s.triangles.len());
        for h in 0..memory.rest_angle.len() {
            memory.rest_angle[h] += if inside(middle(s, h)) { 0.5 } else { 0.0 };
        }
        memory
    };
    let centre_of = |s: &GarmentSurface, m: &RestState| {
        let (mut sum, mut centre) = (0.0, Vec3::zeros());
        for h in 0..m.rest_angle.len() {
            let weight = (m.rest_angle[h] - m.source_angle[h]).abs();
            sum += weight;
            centre += weight * middle(s, h);
        }
        centre / sum
    };
    let low = sweater.points.iter().fold(sweater.points[0], |a, b| a.inf(b));
    let high = sweater.points.iter().fold(sweater.points[0], |a, b| a.sup(b));
    let size = (high - low).norm();
    let knee = |p: Vec3| p.x > 0.0 && (p.y - (low.y + 0.22 * (high.y - low.y))).abs() < 0.06;
    for (from, to) in [(&sweater, &tee), (&tee, &sweater)] {
        let memory = made(from, &knee);
        let carried = carry(from, &memory, to, MatchBy::Surface);
        let off = (centre_of(to, &carried.memory) - centre_of(from, &memory)).norm();
        println!("knee {:.1} % of the garment off, {:?}", 100.0 * off / size, carried.sources[0].losses);
        assert!(off < 0.03 * size);
    }
    let reach = high.x - 0.5 * (high.x - low.x) * 0.35;
    let elbow = made(&sweater, &|p: Vec3| p.x > reach);
    let carried = carry(&sweater, &elbow, &tee, MatchBy::Surface);
    println!("elbow: {:?}", carried.sources[0].losses);
    assert!(carried.sources[0].losses.lost_crease_fraction > 0.9);
}
