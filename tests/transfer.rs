//! Transfer between tessellations of one garment, against a memory that is known exactly.
//!
//! The memory is not baked here (minutes) but made: every layer of the T-shirt is rolled along the three lines of
//! `fold-thrice`, and the angles its hinges then have are what it remembers. That is exact on any tessellation, so what is
//! carried from one to another can be judged against what would be there, with no noise of a simulation in between.

#[path = "reference/external.rs"]
mod external;
#[path = "transfer/measure.rs"]
mod measure;

use crease::bake::{BakeOptions, SimulationMesh};
use crease::fabric::{DEFAULT_FABRIC, Fabric};
use crease::garment::{Garment, RestState, SourceAsset};
use crease::io::{ReadOptions, read_asset};
use crease::math::Vec3;
use crease::mesh::hinge_angle;
use crease::transfer::{
    Align, GarmentSurface, MatchBy, PointPair, TransferOptions, TransferSource, prolongate, transfer,
};
use crease::wear::WearScript;
use external::external;
use measure::{FOLDS, Fold, carry, correlation, tensors, total};
use std::path::Path;

fn load(name: &str) -> (SourceAsset, Garment) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("garments").join(name);
    let bytes = std::fs::read(&path).expect("a garment of the repository");
    let mut nothing = |_: &str| Ok(Vec::new());
    let (asset, _) = read_asset(name, &bytes, &ReadOptions::default(), &mut nothing).expect("reads");
    let (garment, _) = Garment::from_asset(&asset).expect("is a garment");
    (asset, garment)
}

/// The sheet rolled flat and then along the folds of `axis`: the surface turns by the fold's angle over its width.
fn rolled(sheet: &GarmentSurface, fold: &Fold) -> Vec<Vec3> {
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

fn made_memory(sheet: &GarmentSurface) -> RestState {
    let angles = |x: &[Vec3]| -> Vec<f64> {
        sheet.topology.hinges.iter().map(|h| hinge_angle(&h.points.map(|p| x[p.at()]))).collect()
    };
    let mut memory = RestState::new(angles(&sheet.points), sheet.triangles.len());
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

#[test]
fn folds_survive_finer_and_coarser_tessellations_and_the_way_back() {
    // Other tessellations of the same T-shirt, made with `generate_garments -- --tshirt-edge MM`: TWO PATHS, comma between.
    let others = std::env::var("CREASE_TESSELLATIONS").unwrap_or_default();
    let (first, second) = others.split_once(',').unwrap_or(("tshirt-2k.glb", "tshirt-14k.glb"));
    let sheets = [first, second].map(|name| {
        let (asset, garment) = load(name);
        GarmentSurface::from_garment(&garment, &asset)
    });
    let memories = [made_memory(&sheets[0]), made_memory(&sheets[1])];
    for (from, to) in [(0, 1), (1, 0)] {
        for by in [MatchBy::Surface, MatchBy::Uv] {
            let there = carry(&sheets[from], &memories[from], &sheets[to], by);
            let back = carry(&sheets[to], &there.memory, &sheets[from], by);
            let fits =
                correlation(&tensors(&sheets[to], &there.memory), &tensors(&sheets[to], &memories[to]));
            let returns =
                correlation(&tensors(&sheets[from], &back.memory), &tensors(&sheets[from], &memories[from]));
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

/// What the mesh remembers that is simulated instead of the whole garment comes back to it: bit for bit where both are one, and as
/// much of it across each fold.
#[test]
fn what_a_graded_mesh_remembers_comes_back_to_the_whole() {
    let (_, garment) = load("tshirt-14k.glb");
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("garments/wear/fold-thrice.json");
    let text = std::fs::read_to_string(path).expect("a script of the repository");
    let script = WearScript::parse("fold-thrice.json", &text).expect("is a script");
    let fabric = Fabric::preset(DEFAULT_FABRIC).expect("exists");
    let mesh =
        SimulationMesh::choose(&garment, &fabric, &script, &BakeOptions::default()).mesh.expect("is graded");
    assert!(mesh.source_point.len() < garment.points.len() / 2, "{} points", mesh.source_point.len());
    let (coarse, whole) =
        (GarmentSurface::without_texture(&mesh.garment), GarmentSurface::without_texture(&garment));
    let (earned, there) = (made_memory(&coarse), made_memory(&whole));
    let back = prolongate(&mesh, &earned, &garment);
    let mut same = 0;
    for (h, hinge) in coarse.topology.hinges.iter().enumerate() {
        let [Some(a), Some(b)] = hinge.triangles.map(|f| mesh.unchanged_from[f as usize]) else { continue };
        let is_it = |whole: &&crease::mesh::Hinge| whole.triangles == [a.min(b), a.max(b)];
        if same % 20 == 0 {
            let own = whole.topology.hinges.iter().position(|hinge| is_it(&hinge)).expect("is in both");
            assert!((back.rest_angle[own] - earned.rest_angle[h]).abs() < 1e-15);
        }
        same += 1;
    }
    assert!(same > 5_000, "{same} hinges are in both");
    let fits = correlation(&tensors(&whole, &back), &tensors(&whole, &there));
    println!(
        "{} -> {} points: correlation {fits:.3}, {same} hinges",
        mesh.source_point.len(),
        whole.points.len()
    );
    assert!(fits > 0.9);
    for fold in &FOLDS {
        for front in [true, false] {
            let [made, got] = [&there, &back].map(|memory| total(&whole, memory, fold, front));
            println!("  fold of {:+.2}: {made:+.4} -> {got:+.4} rad", fold.angle);
            assert!((got - made).abs() < 0.1 * made.abs());
        }
    }
}

/// Onto the same mesh nothing may change, not even the last bit; and what remembers nothing leaves nothing.
#[test]
fn the_same_mesh_keeps_every_bit_and_no_memory_changes_nothing() {
    let (asset, garment) = load("tshirt-2k.glb");
    let sheet = GarmentSurface::from_garment(&garment, &asset);
    let memory = made_memory(&sheet);
    let same = carry(&sheet, &memory, &sheet, MatchBy::Auto);
    assert_eq!(same.memory, memory);
    assert!(same.unchanged);
    let (asset, other) = load("handkerchief.glb");
    let target = GarmentSurface::from_garment(&other, &asset);
    let angles = |s: &GarmentSurface| -> Vec<f64> {
        s.topology.hinges.iter().map(|h| hinge_angle(&h.points.map(|p| s.points[p.at()]))).collect()
    };
    let nothing = RestState::new(angles(&sheet), sheet.triangles.len());
    for by in [MatchBy::Auto, MatchBy::Surface, MatchBy::Uv] {
        let new = carry(&sheet, &nothing, &target, by).memory;
        assert_eq!(new, RestState::new(angles(&target), target.triangles.len()), "{by:?}");
    }
    let refused = {
        let source = TransferSource { file: "made".into(), surface: sheet, memory, joints: Vec::new() };
        let options =
            TransferOptions { match_by: MatchBy::Same, ..TransferOptions::full(target.points.len()) };
        transfer(&[source], &target, &options).expect_err("another mesh").to_string()
    };
    assert!(refused.contains("is not the mesh it is to go to"), "{refused}");
}

#[test]
fn strength_mask_parts_layers_and_mirror_do_what_they_say() {
    let (asset, garment) = load("tshirt-2k.glb");
    let sheet = GarmentSurface::from_garment(&garment, &asset);
    let mut memory = made_memory(&sheet);
    memory.stiffness_ratio.iter_mut().for_each(|s| *s = 3.0);
    memory.rest_stretch_warp.iter_mut().for_each(|r| *r = 1.02);
    let source = TransferSource {
        file: "made".into(),
        surface: sheet.clone(),
        memory: memory.clone(),
        joints: Vec::new(),
    };
    let with = |change: &dyn Fn(&mut TransferOptions), sources: &[TransferSource]| {
        let mut options =
            TransferOptions { match_by: MatchBy::Surface, ..TransferOptions::full(sheet.points.len()) };
        change(&mut options);
        transfer(sources, &sheet, &options).expect("carries").memory
    };
    let one = std::slice::from_ref(&source);
    let full = with(&|_| {}, one);
    // Constants come over exactly, whatever the directions.
    assert!(full.stiffness_ratio.iter().all(|s| (s - 3.0).abs() < 1e-9));
    assert!(full.rest_stretch_warp.iter().all(|r| (r - 1.02).abs() < 1e-3));
    let half = with(&|o| o.strength = 0.5, one);
    let twice = with(&|_| {}, &[source.clone(), source.clone()]);
    for h in 0..sheet.topology.hinges.len() {
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
    let left: Vec<f64> = sheet.points.iter().map(|p| if p.x > 0.0 { 1.0 } else { 0.0 }).collect();
    let masked = with(&|o| o.mask = left.clone(), one);
    for (h, hinge) in sheet.topology.hinges.iter().enumerate() {
        let inside = hinge.points[..2].iter().all(|p| left[p.at()] == 1.0);
        let wanted = if inside { full.rest_angle[h] } else { full.source_angle[h] };
        assert_eq!(masked.rest_angle[h], wanted);
    }
    // Mirrored, the folds of both sides change places and keep their sign.
    let mirrored = with(&|o| o.mirror_x = true, one);
    for (i, j) in [(0, 1), (1, 0), (2, 2)] {
        let there = Fold { at: FOLDS[j].at, ..FOLDS[i] };
        for front in [true, false] {
            let (made, got) =
                (total(&sheet, &memory, &FOLDS[i], front), total(&sheet, &mirrored, &there, front));
            assert!((made - got).abs() < 0.05 * made.abs(), "{made} {got}");
        }
    }
}

/// Cuts of others: the folds must lie where they were in the box, front on front and back on back.
#[test]
fn folds_land_where_they_were_on_garments_of_another_cut() {
    let (asset, garment) = load("tshirt-2k.glb");
    let sheet = GarmentSurface::from_garment(&garment, &asset);
    let Some(folder) = external("garments/diffavatar-tshirt") else { return };
    for name in ["tshirt.obj", "shirt_initial.obj"] {
        let Ok(bytes) = std::fs::read(folder.join(name)) else {
            println!("not checked, not there: {name}");
            return;
        };
        let options = ReadOptions { unit_m: Some(0.01), ..ReadOptions::default() };
        let (asset, _) = read_asset(name, &bytes, &options, &mut |_| Ok(Vec::new())).expect("reads");
        let (garment, _) = Garment::from_asset(&asset).expect("is a garment");
        let target = GarmentSurface::from_garment(&garment, &asset);
        let low = target.points.iter().fold(target.points[0], |a, b| a.inf(b));
        let high = target.points.iter().fold(target.points[0], |a, b| a.sup(b));
        for (i, fold) in FOLDS.iter().enumerate() {
            let mut memory = RestState::new(made_memory(&sheet).source_angle, sheet.triangles.len());
            let all = made_memory(&sheet);
            for (h, hinge) in sheet.topology.hinges.iter().enumerate() {
                let middle = 0.5 * (sheet.points[hinge.points[0].at()] + sheet.points[hinge.points[1].at()]);
                if (middle[fold.axis] - fold.at).abs() < 1.5 * fold.width {
                    memory.rest_angle[h] = all.rest_angle[h];
                }
            }
            let carried = carry(&sheet, &memory, &target, MatchBy::Auto);
            // The lying shirt's x is the standing one's; its z is downwards.
            let axis = if fold.axis == 0 { 0 } else { 1 };
            let wanted = match fold.axis {
                0 => fold.at / 0.892 + 0.5,
                _ => 0.5 - fold.at / 0.7,
            };
            for front in [true, false] {
                let (mut sum, mut place) = (0.0, 0.0);
                for (h, hinge) in target.topology.hinges.iter().enumerate() {
                    let [a, b] = [hinge.points[0], hinge.points[1]].map(|p| target.points[p.at()]);
                    let normal = target.normal(hinge.triangles[0] as usize).normalize();
                    if (normal.z > 0.3) == front && normal.z.abs() > 0.3 {
                        let weight = (carried.memory.rest_angle[h] - carried.memory.source_angle[h]).abs()
                            * (b - a).norm();
                        sum += weight;
                        place += weight * ((0.5 * (a + b))[axis] - low[axis]) / (high[axis] - low[axis]);
                    }
                }
                let off = place / sum - wanted;
                println!("{name}: fold {i}, front {front}: {:+.1} % of the garment off", 100.0 * off);
                assert!(off.abs() < 0.03);
            }
        }
    }
}

/// Trousers with legs in them onto trousers that lie flat: where the round ones are seen edge-on, their triangles have next to no
/// area from the front, and angles taken for so much curvature came out as thousands of degrees.
#[test]
fn what_is_seen_edge_on_does_not_grow() {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("garments/trousers-on-legs.glb");
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
    let (largest, sum) = changes.fold((0.0f64, 0.0), |(most, sum), c| (most.max(c), sum + c));
    let mean = sum / carried.rest_angle.len() as f64;
    println!("0.3 rad everywhere: largest {largest:.2} rad, mean {mean:.3} rad");
    assert!(largest < 1.2 && mean > 0.05);
}

/// A sleeve of the repository, its elbow bent by `angle` [rad] in the file.
fn sleeve(angle: f64) -> (SourceAsset, Garment) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("garments/sleeve.glb");
    let bytes = std::fs::read(path).expect("a garment of the repository");
    let length = u32::from_le_bytes(bytes[12..16].try_into().expect("four bytes")) as usize;
    let mut json: serde_json::Value = serde_json::from_slice(&bytes[20..20 + length]).expect("is JSON");
    let elbow = json["nodes"].as_array().and_then(|nodes| nodes.iter().position(|n| n["name"] == "elbow"));
    json["nodes"][elbow.expect("has an elbow")]["rotation"] =
        serde_json::json!([0.0, (0.5 * angle).sin(), 0.0, (0.5 * angle).cos()]);
    let mut text = serde_json::to_vec(&json).expect("is JSON");
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut file = bytes[..12].to_vec();
    file.extend((text.len() as u32).to_le_bytes());
    file.extend(&bytes[16..20]);
    file.extend(text);
    file.extend(&bytes[20 + length..]);
    let all = file.len() as u32;
    file[8..12].copy_from_slice(&all.to_le_bytes());
    let options = ReadOptions { garment: Some("sleeve".into()), ..ReadOptions::default() };
    let (asset, _) = read_asset("sleeve.glb", &file, &options, &mut |_| Ok(Vec::new())).expect("reads");
    let (garment, _) = Garment::from_asset(&asset).expect("is a garment");
    (asset, garment)
}

/// Rings of crease around the lower arm of a straight sleeve must be on the lower arm of a bent one, where boxes would leave
/// them hanging in the air.
#[test]
fn joints_and_landmarks_lay_a_straight_sleeve_over_a_bent_one() {
    let ((straight, from), (bent, to)) = (sleeve(0.0), sleeve(1.2));
    let (sheet, target) =
        (GarmentSurface::from_garment(&from, &straight), GarmentSurface::from_garment(&to, &bent));
    assert_eq!(straight.worn_joints().len(), 3, "{:?}", straight.worn_joints());
    let mut memory = RestState::new(vec![0.0; sheet.topology.hinges.len()], sheet.triangles.len());
    let length = |s: &GarmentSurface, h: &crease::mesh::Hinge| {
        (s.points[h.points[0].at()] - s.points[h.points[1].at()]).norm()
    };
    for (h, hinge) in sheet.topology.hinges.iter().enumerate() {
        let [a, b] = [hinge.points[0], hinge.points[1]].map(|p| sheet.points[p.at()]);
        let middle = 0.5 * (a + b).x;
        if (0.4..0.42).contains(&middle) || (0.47..0.49).contains(&middle) {
            memory.rest_angle[h] = 0.5 * (1.0 - ((b - a).x / (b - a).norm()).powi(2));
        }
    }
    // Share of what came over that lies within a few elements of where it belongs.
    let hits = |carried: &RestState| {
        let (mut on, mut all) = (0.0, 0.0);
        for (h, hinge) in target.topology.hinges.iter().enumerate() {
            let weight = (carried.rest_angle[h] - carried.source_angle[h]).abs() * length(&target, hinge);
            let middle = 0.5 * (sheet.points[hinge.points[0].at()] + sheet.points[hinge.points[1].at()]).x;
            all += weight;
            if (0.385..0.435).contains(&middle) || (0.455..0.505).contains(&middle) {
                on += weight;
            }
        }
        let made: f64 = sheet
            .topology
            .hinges
            .iter()
            .zip(&memory.rest_angle)
            .map(|(h, a)| a.abs() * length(&sheet, h))
            .sum();
        (on / all, all / made)
    };
    let source = TransferSource {
        file: "made".into(),
        surface: sheet.clone(),
        memory: memory.clone(),
        joints: straight.worn_joints(),
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
    // Marked: every 37th point.
    let pair = |p: usize| PointPair { source: sheet.points[p], target: target.points[p] };
    let marked: Vec<PointPair> = (0..sheet.points.len()).step_by(37).map(pair).collect();
    type Change<'a> = &'a dyn Fn(&mut TransferOptions);
    let cases: [(&str, Change, f64); 3] = [
        ("joints", &|_| {}, 0.98),
        ("landmarks", &|o| o.landmarks = marked.clone(), 0.98),
        ("box", &|o| o.align = Align::Box, 0.0),
    ];
    let mut found = Vec::new();
    for (name, change, bar) in cases {
        let carried = with(change).expect("carries");
        let (share, amount) = hits(&carried.memory);
        println!("{name}: {:.1} % where it belongs, {:.2} of it", 100.0 * share, amount);
        assert_eq!(carried.sources[0].aligned_by.map(|by| by.name()), Some(name));
        assert!(share >= bar);
        found.push(share);
    }
    assert!(found[2] < 0.5, "boxes need no help");
    let refused =
        with(&|o| (o.align, o.joints) = (Align::Joints, Vec::new())).expect_err("no joints").to_string();
    assert!(refused.contains("--landmarks"), "{refused}");
    let twice = with(&|o| o.landmarks = vec![PointPair::from([Vec3::zeros(), Vec3::x()]); 2])
        .expect_err("no map")
        .to_string();
    assert!(twice.contains("apart"), "{twice}");
}

/// A sheet of n x n points, 0.2 m wide, lying; `skew` moves the inner points so that no edge is where another's is.
fn grid(n: usize, skew: f64) -> String {
    use std::fmt::Write;
    let mut text = String::new();
    for (row, column) in (0..n * n).map(|i| (i / n, i % n)) {
        let inner = |i: usize| if i == 0 || i + 1 == n { 0.0 } else { skew / n as f64 };
        let share = |i: usize, j: usize| i as f64 / (n - 1) as f64 + inner(i) * ((7 * j) % 3) as f64;
        let (u, v) = (share(column, row), share(row, column));
        let _ = writeln!(text, "v {} 0 {}\nvt {} {}", 0.2 * u, 0.2 * v, u, 1.0 - v);
    }
    for (row, column) in (0..n * n).map(|i| (i / n, i % n)).filter(|(r, c)| r + 1 < n && c + 1 < n) {
        let a = row * n + column + 1;
        let (b, c, d) = (a + 1, a + n, a + n + 1);
        let _ = writeln!(text, "f {a}/{a} {c}/{c} {d}/{d}\nf {a}/{a} {d}/{d} {b}/{b}");
    }
    text
}

/// From a sidecar to every file, and all refusals a user may meet.
#[test]
fn the_tool_carries_settles_and_writes_what_others_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("to.obj"), grid(14, 0.2)).expect("writes");
    let text = grid(18, 0.0);
    let options = ReadOptions::default();
    let (asset, _) =
        read_asset("from.obj", text.as_bytes(), &options, &mut |_| Ok(Vec::new())).expect("reads");
    let (garment, _) = Garment::from_asset(&asset).expect("is a garment");
    let sheet = GarmentSurface::from_garment(&garment, &asset);
    let fold = Fold { axis: 0, at: 0.1, angle: 1.5, width: 0.02 };
    let angles = |x: &[Vec3]| -> Vec<f64> {
        sheet.topology.hinges.iter().map(|h| hinge_angle(&h.points.map(|p| x[p.at()]))).collect()
    };
    let mut memory = RestState::new(angles(&sheet.points), sheet.triangles.len());
    memory.rest_angle = angles(&rolled(&sheet, &fold));
    let worn =
        crease::garment::WornGarment { displacement: vec![Vec3::zeros(); garment.points.len()], memory };
    let null = serde_json::Value::Null;
    let sidecar = crease::io::Sidecar::new(&asset, &garment, &worn, null.clone(), null.clone(), null)
        .expect("is sound");
    std::fs::write(path("from.crease.json"), crease::io::write_sidecar(&sidecar)).expect("writes");

    let run = |arguments: &str| {
        let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_crease"));
        let output = command.current_dir(folder.path()).args(arguments.split(' ')).output().expect("runs");
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("is text");
        (text(output.stdout), text(output.stderr), output.status.code())
    };
    let (out, err, code) = run(
        "transfer from.crease.json --to to.obj -o out.glb --json --export obj,rest-mesh,rest-angle-map,usda",
    );
    assert_eq!(code, Some(0), "{err}");
    let report: serde_json::Value = serde_json::from_str(&out).expect("is JSON");
    assert_eq!(report["crossings"], 0);
    assert_eq!(report["sources"][0]["by"], "uv");
    assert!(report["confidence"].as_f64() > Some(0.8), "{report}");
    // Every file carries most of what it is there to carry.
    for also in report["also"].as_array().expect("a list") {
        let number = |name: &str| also[name].as_f64().expect("a number");
        let share = number("rms_difference") / number("rms_without").max(1.0);
        println!("{}: {} off by {} of 1", also["file"], also["compared"], share);
        // A map per vertex cannot tell an edge along a crease from one across it: it keeps a part only.
        let bar = if also["compared"].as_str().is_some_and(|c| c.contains("both ends")) { 0.8 } else { 0.35 };
        assert!(share < bar, "{also}");
    }
    for name in
        ["out.worn.obj", "out.rest.obj", "out.rest-angle.glb", "out.usda", "out.crease.json", "out.glb"]
    {
        assert!(path(name).is_file(), "{name}");
    }
    // Laid over by places that a person marked.
    let pair = |x: f64, z: f64| format!(r#"{{"source_m": [{x}, 0, {z}], "target_m": [{x}, 0, {z}]}}"#);
    let marks = [pair(0.0, 0.0), pair(0.2, 0.0), pair(0.1, 0.2)].join(", ");
    let text = format!(r#"{{"format": "crease-landmarks/1", "pairs": [{marks}]}}"#);
    std::fs::write(path("marks.json"), &text).expect("writes");
    let (out, err, code) = run(
        "transfer from.crease.json --to to.obj --match surface --landmarks marks.json --json -o marked.glb",
    );
    assert_eq!(code, Some(0), "{err}");
    let report: serde_json::Value = serde_json::from_str(&out).expect("is JSON");
    assert_eq!(
        (&report["sources"][0]["by"], &report["sources"][0]["aligned"]),
        (&"surface".into(), &"landmarks".into())
    );
    assert!(report["sources"][0]["lost_crease_fraction"].as_f64() < Some(0.05), "{report}");
    std::fs::write(path("marks.json"), text.replace("target_m", "targets")).expect("writes");
    let (_, err, code) = run("transfer from.crease.json --to to.obj --landmarks marks.json -o no.glb");
    assert!(code == Some(1) && err.contains("targets") && err.contains("target_m"), "{err}");
    // Onto the very mesh it now is for: the same memory, bit for bit.
    let (_, err, code) = run("transfer out.crease.json --to to.obj -o again.glb --match same --quiet");
    assert_eq!(code, Some(0), "{err}");
    let read = |name: &str| {
        let bytes = std::fs::read(path(name)).expect("is there");
        crease::io::read_sidecar(name, &bytes).expect("reads")
    };
    let (first, again) = (read("out.crease.json"), read("again.crease.json"));
    assert_eq!((&first.hinges, &first.points), (&again.hinges, &again.points));
    let (_, err, code) = run("render out.glb --show confidence --size 64 -o out.png");
    assert_eq!(code, Some(0), "{err}");
    // Finer than the file: its own points first, by texture as before, what they cannot show in a map.
    let (out, err, code) =
        run("transfer from.crease.json --to to.obj -o fine.glb --resolution 8 --detail-map=256 --json");
    assert_eq!(code, Some(0), "{err}");
    let report: serde_json::Value = serde_json::from_str(&out).expect("is JSON");
    assert_eq!((&report["sources"][0]["by"], &report["crossings"]), (&"uv".into(), &0.into()));
    assert!(report["detail_maps"].as_array().is_some_and(|maps| maps.len() == 1), "{report}");
    let fine = read("fine.crease.json");
    let own = first.mesh.points_m.len();
    assert!(fine.mesh.points_m.len() > 2 * own && fine.mesh.points_m[..own] == first.mesh.points_m);
    assert!(fine.mesh.triangle_vertices.is_none() && first.mesh.triangle_vertices.is_some());
    // Both stand as high.
    let height = |sidecar: &crease::io::Sidecar| {
        sidecar.points.displacement_m.iter().map(|d| d[1].abs()).fold(0.0, f64::max)
    };
    println!("height of the fold {:.4} m, finer {:.4} m", height(&first), height(&fine));
    assert!((height(&fine) / height(&first) - 1.0).abs() < 0.25);

    let whole = std::fs::read_to_string(path("from.crease.json")).expect("is text");
    let refused = |name: &str, text: &str, arguments: &str, expected: &str| {
        std::fs::write(path(name), text).expect("writes");
        let (_, err, code) = run(arguments);
        assert!(code == Some(1) && err.contains(expected), "{err}");
    };
    refused("cut.json", &whole[..whole.len() / 2], "transfer cut.json --to to.obj -o no.glb", "EOF");
    let edited = whole.replacen("\"stiffness_ratio\":[1.0", "\"stiffness_ratio\":[1.5", 1);
    refused("edited.json", &edited, "transfer edited.json --to to.obj -o no.glb", "checksums.");
    let by_same = "transfer from.crease.json --to to.obj -o no.glb --match same";
    refused("unused", "", by_same, "is not the mesh it is to go to");
    refused(
        "out.crease.json",
        &whole,
        "render out.glb -o no.png",
        "is for a mesh of 324 vertices, this one has 196",
    );
    assert!(!path("no.glb").exists() && !path("no.png").exists());
}

/// Garments of one body stay where they are: knees go to knees although the boxes differ, and what the elbows of a sweater
/// remember is left behind by a tee, which has none.
#[test]
fn on_one_body_places_stay_and_what_has_no_place_is_told() {
    let Some(folder) = external("garments/makehuman-body-sweater/derived") else { return };
    let read = |name: &str| {
        let bytes = std::fs::read(folder.join(name)).ok()?;
        let options = ReadOptions { unit_m: Some(0.1), ..ReadOptions::default() };
        let (asset, _) = read_asset(name, &bytes, &options, &mut |_| Ok(Vec::new())).expect("reads");
        let (garment, _) = Garment::from_asset(&asset).expect("is a garment");
        Some(GarmentSurface::from_garment(&garment, &asset))
    };
    let (Some(sweater), Some(tee)) =
        (read("male_casualsuit02_fitted.obj"), read("male_casualsuit04_fitted.obj"))
    else {
        println!("not checked, not there: {}", folder.display());
        return;
    };
    let middle = |s: &GarmentSurface, h: usize| {
        let hinge = &s.topology.hinges[h];
        0.5 * (s.points[hinge.points[0].at()] + s.points[hinge.points[1].at()])
    };
    // What lies inside a ball remembers half a radian.
    let made = |s: &GarmentSurface, inside: &dyn Fn(Vec3) -> bool| {
        let angle = |h: &crease::mesh::Hinge| hinge_angle(&h.points.map(|p| s.points[p.at()]));
        let mut memory = RestState::new(s.topology.hinges.iter().map(angle).collect(), s.triangles.len());
        for h in 0..memory.rest_angle.len() {
            memory.rest_angle[h] += if inside(middle(s, h)) { 0.5 } else { 0.0 };
        }
        memory
    };
    let heart = |s: &GarmentSurface, m: &RestState| {
        let (mut sum, mut place) = (0.0, Vec3::zeros());
        for h in 0..m.rest_angle.len() {
            let weight = (m.rest_angle[h] - m.source_angle[h]).abs();
            sum += weight;
            place += weight * middle(s, h);
        }
        place / sum
    };
    let low = sweater.points.iter().fold(sweater.points[0], |a, b| a.inf(b));
    let high = sweater.points.iter().fold(sweater.points[0], |a, b| a.sup(b));
    let size = (high - low).norm();
    let knee = |p: Vec3| p.x > 0.0 && (p.y - (low.y + 0.22 * (high.y - low.y))).abs() < 0.06;
    for (from, to) in [(&sweater, &tee), (&tee, &sweater)] {
        let memory = made(from, &knee);
        let carried = carry(from, &memory, to, MatchBy::Surface);
        let off = (heart(to, &carried.memory) - heart(from, &memory)).norm();
        println!("knee {:.1} % of the garment off, {:?}", 100.0 * off / size, carried.sources[0].losses);
        assert!(off < 0.03 * size);
    }
    let reach = high.x - 0.5 * (high.x - low.x) * 0.35;
    let elbow = made(&sweater, &|p: Vec3| p.x > reach);
    let carried = carry(&sweater, &elbow, &tee, MatchBy::Surface);
    println!("elbow: {:?}", carried.sources[0].losses);
    assert!(carried.sources[0].losses.lost_crease_fraction > 0.9);
}
