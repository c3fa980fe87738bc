//! Garments that are worn again: what they remember is carried on, on the shape before any wear.

#[path = "common/tool.rs"]
mod tool;

use crease::internal::files::memory_of_earlier_run;
use crease::{
    Bake, BakeOptions, Fabric, GarmentFile, Quality, ReadOptions, RestState, WearScript, WornGarment,
};
use crease_geometry::math::Rng;
use crease_io::gltf::{Accessors, WORN_TARGET};
use crease_model::garment::Garment;
use serde_json::Value;
use std::path::Path;
use tool::{Pose, crease_in, wavy_sheet};

const LAY: &str = r#"{"lay": {"facing": "front", "over": 0.2}}"#;
const FOLD_ACROSS: &str = r#"{"fold": {"line": [[0.5, 0], [0.5, 1]], "side": "left", "over": 0.5, "hold": 4}},
    {"unfold": {"all": true, "over": 0.5}}"#;
const FOLD_ALONG: &str = r#"{"fold": {"line": [[0, 0.5], [1, 0.5]], "side": "lower", "over": 0.5, "hold": 4}},
    {"unfold": {"all": true, "over": 0.5}}"#;

fn script(actions: &[&str]) -> WearScript {
    let text = format!(r#"{{"format": "crease-wear/1", "actions": [{}]}}"#, actions.join(", "));
    WearScript::parse("wear.json", &text).expect("is a script")
}

fn bake(
    garment: &Garment,
    actions: &[&str],
    own_triangles: bool,
    earlier: Option<&RestState>,
) -> WornGarment {
    let fabric = Fabric::preset("kow-tshirt").expect("is a fabric");
    let script = script(actions);
    let options = BakeOptions { own_triangles, quality: Quality::Draft, ..BakeOptions::default() };
    let mut bake = Bake::new(garment, &fabric, &script).options(options);
    if let Some(earlier) = earlier {
        bake = bake.earlier_memory(earlier);
    }
    bake.run().expect("runs").worn
}

/// Change of rest angle times length of hinge, summed over the hinges within 3 cm of the line x = 0.1 m or z = 0.1 m [rad m].
fn crease(garment: &Garment, memory: &RestState, axis: usize) -> f64 {
    let hinges = garment.topology.hinges.iter().enumerate();
    let near = hinges
        .filter(|(_, h)| h.points[..2].iter().all(|p| (garment.points[p.at()][axis] - 0.1).abs() < 0.03));
    near.map(|(h, hinge)| {
        let [a, b] = [0, 1].map(|k| garment.points[hinge.points[k].at()]);
        // Only what runs along the line: hinges across it belong to the other fold.
        let along = (b - a)[2 - axis].abs();
        (memory.rest_angle[h] - memory.source_angle[h]) * along
    })
    .sum()
}

/// The creases of two bakes in a row are those of one bake of both scripts, on the file's triangles and on a mesh made for each script.
/// Compared are means of three starts 20 micrometres apart: how many hinges take one more step of the law differs from start to start.
#[test]
fn a_second_bake_leaves_what_both_scripts_leave() {
    for own_triangles in [true, false] {
        let mut creases = [[0.0; 3]; 2];
        for start in 0..3u64 {
            let mut sheet = GarmentFile::sheet([0.2, 0.2], [10, 10]).expect("is a sheet").garment;
            if start > 0 {
                let mut rng = Rng::from_seed(start);
                sheet.points.iter_mut().for_each(|x| *x += rng.in_cube() * 2e-5);
            }
            let first = bake(&sheet, &[LAY, FOLD_ACROSS], own_triangles, None);
            let second = bake(&sheet, &[LAY, FOLD_ALONG], own_triangles, Some(&first.memory));
            let both = bake(&sheet, &[LAY, FOLD_ACROSS, LAY, FOLD_ALONG], own_triangles, None);
            for (of_axis, axis) in creases.iter_mut().zip([0, 2]) {
                let of_all = [&first, &second, &both].map(|worn| crease(&sheet, &worn.memory, axis));
                of_axis.iter_mut().zip(of_all).for_each(|(mean, of_start)| *mean += of_start / 3.0);
            }
            if own_triangles && start == 0 {
                let largest = |of: &dyn Fn(usize) -> f64| (0..sheet.points.len()).map(of).fold(0.0, f64::max);
                let height = largest(&|p| both.displacement[p].norm());
                let apart = largest(&|p| (both.displacement[p] - second.displacement[p]).norm());
                assert!(apart < 0.25 * height, "{apart} m of {height} m");
            }
        }
        for [of_first, in_a_row, at_once] in creases {
            // A mesh made for the second script has no edges along the first fold, and unbends it less.
            let strongest = of_first.abs().max(at_once.abs());
            let tolerance = if own_triangles { 0.15 } else { 0.35 };
            assert!(
                (in_a_row - at_once).abs() < tolerance * strongest,
                "{of_first} {in_a_row} {at_once} rad m"
            );
            assert!(at_once.abs() > 0.02, "{at_once} rad m");
        }
    }
}

/// What the second script does not touch stays as it was, bit for bit or nearly.
#[test]
fn what_is_not_worn_again_is_kept() {
    let sheet = GarmentFile::sheet([0.2, 0.2], [10, 10]).expect("is a sheet").garment;
    let first = bake(&sheet, &[LAY, FOLD_ACROSS], false, None).memory;
    let second = bake(&sheet, &[LAY, r#"{"settle": {"for": 0.2}}"#], false, Some(&first)).memory;
    for (h, (a, b)) in first.rest_angle.iter().zip(&second.rest_angle).enumerate() {
        assert!((a - b).abs() < 1e-9, "hinge {h}: {a} {b}");
    }
    assert_eq!(first.stiffness_ratio, second.stiffness_ratio);
}

#[test]
fn memory_of_another_garment_is_refused() {
    let [sheet, other] = [4, 5].map(|n| GarmentFile::sheet([0.2, 0.2], [n, n]).expect("is a sheet").garment);
    let memory = RestState::flat(other.topology.hinges.len(), other.triangles.len());
    let (fabric, script) = (Fabric::preset("denim").expect("is a fabric"), script(&[LAY]));
    let error = Bake::new(&sheet, &fabric, &script).earlier_memory(&memory).run().expect_err("is refused");
    assert!(error.to_string().contains("other hinges or triangles"), "{error}");
}

fn report(folder: &Path, name: &str) -> Value {
    let text = std::fs::read_to_string(folder.join(name)).expect("is there");
    serde_json::from_str(&text).expect("is JSON")
}

/// Positions of the base shape, and displacements of the worn target.
fn shapes(folder: &Path, name: &str) -> [Vec<f64>; 2] {
    let file = GarmentFile::load(folder.join(name), &ReadOptions::default()).expect("reads");
    let document = file.asset.document.as_ref().expect("is glTF");
    let mesh = &document.json["meshes"][0];
    let names = mesh["extras"]["targetNames"].as_array().expect("are named");
    assert_eq!(names.iter().filter(|name| *name == WORN_TARGET).count(), 1, "{names:?}");
    assert_eq!(mesh["weights"], serde_json::json!([1.0]));
    let primitive = &mesh["primitives"][0];
    [&primitive["attributes"]["POSITION"], &primitive["targets"][0]["POSITION"]].map(|accessor| {
        let index = accessor.as_u64().expect("is an index") as usize;
        Accessors::new(document).table(index, "test").expect("reads").values
    })
}

#[test]
fn the_tool_carries_memory_on_unless_told_to_forget() {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("writes");
    let wear =
        |actions: &[&str]| format!(r#"{{"format": "crease-wear/1", "actions": [{}]}}"#, actions.join(", "));
    write("sheet.obj", &wavy_sheet(8, 0.0, Pose::Lying));
    write("across.json", &wear(&[LAY, FOLD_ACROSS]));
    write("along.json", &wear(&[LAY, FOLD_ALONG]));
    let bake =
        |line: &str| crease_in(folder.path(), &format!("bake {line} --fabric kow-tshirt --quality draft"));
    let (_, err, code) = bake("sheet.obj --wear across.json -o first.glb");
    assert_eq!(code, 0, "{err}");
    let (_, err, code) = bake("first.glb --wear along.json -o second.glb");
    assert_eq!(code, 0, "{err}");
    assert!(
        err.contains("goes on with the memory in first.crease.json") && !err.contains("warning"),
        "{err}"
    );
    let (_, err, code) = bake("first.glb --wear along.json -o forgot.glb --forget");
    assert!(code == 0 && !err.contains("goes on"), "{err}");

    let read = |name: &str| {
        let file = GarmentFile::load(folder.path().join(name), &ReadOptions::default()).expect("reads");
        let sidecar = name.replace(".glb", ".crease.json");
        let text = std::fs::read(folder.path().join(&sidecar)).expect("is there");
        let sidecar = crease::format::read_sidecar(&sidecar, &text).expect("reads");
        let memory =
            memory_of_earlier_run(name, &sidecar, &file.garment, &file.asset).expect("reads").expect("fits");
        (file.garment, memory)
    };
    let creases = |name: &str| {
        let (garment, memory) = read(name);
        [0, 2].map(|axis| crease(&garment, &memory, axis))
    };
    let [first, second, forgot] = ["first.glb", "second.glb", "forgot.glb"].map(creases);
    assert!(first[0].abs() > 0.02 && first[1].abs() < 0.002, "{first:?}");
    assert!((second[0] - first[0]).abs() < 0.2 * first[0].abs(), "{first:?} {second:?}");
    assert!(second[1].abs() > 0.02 && forgot[1].abs() > 0.02, "{second:?} {forgot:?}");
    assert!(forgot[0].abs() < 0.002, "{forgot:?}");

    // The base stays the shape before any wear, and the one worn target leads to what both leave.
    let [[base, _], [base_again, worn]] = ["first.glb", "second.glb"].map(|name| shapes(folder.path(), name));
    assert_eq!(base, base_again);
    assert!(worn.iter().fold(0.0, |max: f64, d| max.max(d.abs())) > 0.005);
    assert!(base.iter().skip(1).step_by(3).all(|y| y.abs() < 1e-6), "the base is flat");
    let sidecar = report(folder.path(), "second.crease.json");
    assert_eq!(sidecar["run"]["earlier"]["sidecar"], "first.crease.json");
    let models = &report(folder.path(), "second.report.json")["models"];
    assert!(
        models.as_array().expect("a list").iter().any(|model| model["name"] == "earlier memory"),
        "{models}"
    );
}

/// A lost sidecar, that of another mesh, an applied file: the wear begins anew, with the reason and the cure.
#[test]
fn memory_that_cannot_be_carried_on_is_told() {
    let folder = tempfile::tempdir().expect("a folder");
    let path = |name: &str| folder.path().join(name);
    std::fs::write(path("sheet.obj"), wavy_sheet(4, 0.0, Pose::Lying)).expect("writes");
    std::fs::write(path("fine.obj"), wavy_sheet(5, 0.0, Pose::Lying)).expect("writes");
    let wear = format!(r#"{{"format": "crease-wear/1", "actions": [{LAY}, {FOLD_ACROSS}]}}"#);
    std::fs::write(path("wear.json"), wear).expect("writes");
    let bake = |line: &str| {
        crease_in(folder.path(), &format!("bake {line} --wear wear.json --fabric kow-tshirt --quality draft"))
    };
    for (line, name) in [("sheet.obj", "worn"), ("fine.obj", "fine"), ("sheet.obj --apply", "applied")] {
        let (_, err, code) = bake(&format!("{line} -o {name}.glb"));
        assert_eq!(code, 0, "{err}");
    }
    // The sheet that was made its own worn shape is folded so sharply that it does not lie: exit code 3.
    let told = |line: &str, what: &str| {
        let (_, err, code) = bake(&format!("{line} -o again.glb"));
        assert!(
            code != 1 && err.contains("worn already, and that is left out") && err.contains(what),
            "{err}"
        );
    };
    told("applied.glb", "before --apply");
    std::fs::rename(path("worn.crease.json"), path("kept.json")).expect("moves");
    told("worn.glb", "is not beside it");
    std::fs::copy(path("fine.crease.json"), path("worn.crease.json")).expect("copies");
    told("worn.glb", "is for a mesh of 36 vertices");
    std::fs::copy(path("kept.json"), path("worn.crease.json")).expect("copies");
    let (_, err, code) = bake("worn.glb -o again.glb --fabric denim");
    assert!(code != 0 || err.contains("was earned on"), "{err}");
}

/// Mesh and sidecar that were renamed together, to plain names and to names with a dot: what is remembered is carried on.
#[test]
fn a_renamed_pair_keeps_its_memory() {
    let folder = tempfile::tempdir().expect("a folder");
    tool::write(folder.path(), "sheet.obj", wavy_sheet(10, 0.0, Pose::Lying));
    tool::write_script(folder.path(), "fold.json", &format!("{LAY}, {FOLD_ACROSS}"));
    tool::write_script(folder.path(), "rest.json", &format!("{LAY}, {}", r#"{"settle": {"for": 0.2}}"#));
    let bake = "bake sheet.obj --wear fold.json --fabric kow-tshirt --quality draft -o worn.glb";
    let (_, error, code) = crease_in(folder.path(), bake);
    assert_eq!(code, 0, "{error}");
    let mut name = "worn".to_owned();
    for renamed in ["shirt", "shirt.v2"] {
        for ending in ["glb", "crease.json"] {
            let [from, to] = [&*name, renamed].map(|stem| folder.path().join(format!("{stem}.{ending}")));
            std::fs::rename(from, to).expect("renames");
        }
        name = renamed.to_owned();
        let line =
            format!("bake {name}.glb --wear rest.json --fabric kow-tshirt --quality draft -o again.glb");
        let (_, error, code) = crease_in(folder.path(), &line);
        assert!(code == 0 && !error.contains("worn already, and that is left out"), "{renamed}: {error}");
        let report = std::fs::read(folder.path().join("again.report.json")).expect("reads");
        let report: Value = serde_json::from_slice(&report).expect("is JSON");
        assert!(
            report["max_rest_angle_change_deg"].as_f64().is_some_and(|d| d > 20.0),
            "{renamed}: {report}"
        );
    }
}

/// A patch that stands through the sheet, and a second one: the summary counts what is in the file written, not what is new alone.
#[test]
fn crossings_of_the_file_written_are_told() {
    let folder = tempfile::tempdir().expect("a folder");
    tool::write_script(folder.path(), "rest.json", r#"{"settle": {"for": 0.1}}"#);
    let mut sheet = wavy_sheet(10, 0.0, Pose::Lying);
    let mut before = 0;
    for (k, x) in [0.051, 0.131].into_iter().enumerate() {
        sheet += &format!("v {x} -0.02 0.031\nv {x} -0.02 0.173\nv {x} 0.02 0.173\nv {x} 0.02 0.031\n");
        let first = 121 + 4 * k + 1;
        sheet += &format!("f {first} {} {} {}\n", first + 1, first + 2, first + 3);
        tool::write(folder.path(), "sheet.obj", &sheet);
        let line = "bake sheet.obj --wear rest.json --quality draft -o out.glb";
        let (_, error, code) = crease_in(folder.path(), line);
        assert_eq!(code, 0, "{error}");
        let report = std::fs::read(folder.path().join("out.report.json")).expect("reads");
        let report: Value = serde_json::from_slice(&report).expect("is JSON");
        let [at_start, in_result, added] = ["crossings_at_start", "crossings_in_result", "crossings"]
            .map(|key| report[key].as_u64().expect("is a count"));
        assert!(at_start > before && in_result == at_start && added == 0, "{report}");
        before = at_start;
        let told = format!("0 new crossings, {in_result} in the file written ({at_start} in the input)");
        assert!(error.contains(&told), "{error}");
    }
}
