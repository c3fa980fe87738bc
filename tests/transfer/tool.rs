//! The command `crease transfer`.

use crate::made::rolled;
use crate::measure::Fold;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::hinge_angle;
use crease_io::{ReadOptions, read_asset};
use crease_model::garment::{Garment, RestState};
use crease_model::remesh::GarmentSurface;

/// A sheet of n x n points, 0.2 m wide, lying; `skew` moves the inner points so that no edge coincides with one of another grid.
fn grid(n: usize, skew: f64) -> String {
    use std::fmt::Write;
    let mut text = String::new();
    for (row, column) in (0..n * n).map(|i| (i / n, i % n)) {
        let inner = |i: usize| if i == 0 || i + 1 == n { 0.0 } else { skew / n as f64 };
        let coordinate = |i: usize, j: usize| i as f64 / (n - 1) as f64 + inner(i) * ((7 * j) % 3) as f64;
        let (u, v) = (coordinate(column, row), coordinate(row, column));
        let _ = writeln!(text, "v {} 0 {}\nvt {} {}", 0.2 * u, 0.2 * v, u, 1.0 - v);
    }
    for (row, column) in (0..n * n).map(|i| (i / n, i % n)).filter(|(r, c)| r + 1 < n && c + 1 < n) {
        let a = row * n + column + 1;
        let (b, c, d) = (a + 1, a + n, a + n + 1);
        let _ = writeln!(text, "f {a}/{a} {c}/{c} {d}/{d}\nf {a}/{a} {d}/{d} {b}/{b}");
    }
    text
}

/// A folder with a folded source, `from.crease.json`, and a target mesh, `to.obj`, to run the tool in.
struct Workshop {
    folder: tempfile::TempDir,
}

impl Workshop {
    fn new() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let path = |name: &str| folder.path().join(name);
        std::fs::write(path("to.obj"), grid(14, 0.2)).expect("writes");
        let text = grid(18, 0.0);
        let options = ReadOptions::default();
        let (asset, _) =
            read_asset("from.obj", text.as_bytes(), &options, &mut |_| Ok(Vec::new())).expect("reads");
        let (garment, _) = Garment::from_asset(&asset).expect("is a garment");
        let surface = GarmentSurface::from_garment(&garment, &asset);
        let fold = Fold { axis: 0, at: 0.1, angle: 1.5, width: 0.02 };
        let angles = |x: &[Vec3]| -> Vec<f64> {
            surface.topology.hinges.iter().map(|h| hinge_angle(&h.points.map(|p| x[p.at()]))).collect()
        };
        let mut memory = RestState::new(angles(&surface.points), surface.triangles.len());
        memory.rest_angle = angles(&rolled(&surface, &fold));
        let worn = crease_model::garment::WornGarment {
            displacement: vec![Vec3::zeros(); garment.points.len()],
            memory,
        };
        let null = serde_json::Value::Null;
        let sidecar = crease_io::Sidecar::new(&asset, &garment, &worn, null.clone(), null.clone(), null)
            .expect("is sound");
        std::fs::write(path("from.crease.json"), crease_io::write_sidecar(&sidecar)).expect("writes");
        Self { folder }
    }

    fn path(&self, name: &str) -> std::path::PathBuf {
        self.folder.path().join(name)
    }

    /// Runs the tool; stdout, stderr and the exit code.
    fn run(&self, arguments: &str) -> (String, String, Option<i32>) {
        let mut command = assert_cmd::Command::new(env!("CARGO_BIN_EXE_crease"));
        let output =
            command.current_dir(self.folder.path()).args(arguments.split(' ')).output().expect("runs");
        let text = |bytes: Vec<u8>| String::from_utf8(bytes).expect("is text");
        (text(output.stdout), text(output.stderr), output.status.code())
    }

    fn read(&self, name: &str) -> crease_io::Sidecar {
        let bytes = std::fs::read(self.path(name)).expect("is there");
        crease_io::read_sidecar(name, &bytes).expect("reads")
    }
}

/// From a sidecar to every file, and all errors a user may meet; later parts read the files of earlier ones.
#[test]
fn the_tool_transfers_relaxes_and_writes_readable_files() {
    let workshop = Workshop::new();
    every_export_carries_the_memory(&workshop);
    landmarks_align_source_and_target(&workshop);
    the_same_mesh_keeps_its_memory_and_a_refined_one_agrees(&workshop);
    ready_memories_go_by_name_plain_and_compressed(&workshop);
    unfit_files_are_refused(&workshop);
}

fn every_export_carries_the_memory(workshop: &Workshop) {
    let (out, err, code) = workshop.run(
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
        let error = number("rms_difference") / number("rms_without").max(1.0);
        println!("{}: {} off by {} of 1", also["file"], also["compared"], error);
        // A map per vertex cannot tell an edge along a crease from one across it: it keeps a part only.
        let threshold =
            if also["compared"].as_str().is_some_and(|c| c.contains("both ends")) { 0.8 } else { 0.35 };
        assert!(error < threshold, "{also}");
    }
    for name in
        ["out.worn.obj", "out.rest.obj", "out.rest-angle.glb", "out.usda", "out.crease.json", "out.glb"]
    {
        assert!(workshop.path(name).is_file(), "{name}");
    }
}

fn ready_memories_go_by_name_plain_and_compressed(workshop: &Workshop) {
    for example in ["tshirt-draft", "fold-thrice.crease.json"] {
        let (_, err, code) = workshop.run(&format!("example {example}"));
        assert_eq!(code, Some(0), "{err}");
    }
    let own = concat!(env!("CARGO_MANIFEST_DIR"), "/../../garments/memories/fold-thrice.crease.json.gz");
    std::fs::copy(own, workshop.path("packed.crease.json.gz")).expect("copies");
    let plain = workshop.read("fold-thrice.crease.json");
    assert_eq!(workshop.read("packed.crease.json.gz"), plain);
    for source in ["fold-thrice", "fold-thrice.crease.json", "packed.crease.json.gz"] {
        let (_, err, code) = workshop.run(&format!("transfer {source} --to tshirt-draft.glb -o ready.glb"));
        assert_eq!(code, Some(0), "{source}: {err}");
        assert!(err.contains(&format!("{source}: matched by same")), "{err}");
        assert!(workshop.read("ready.crease.json").hinges == plain.hinges, "{source}");
    }
    let (_, err, code) = workshop.run("transfer fold-trice --to to.obj -o none.glb");
    assert!(code == Some(1) && err.contains("did you mean `fold-thrice`?"), "{err}");
}

fn landmarks_align_source_and_target(workshop: &Workshop) {
    let pair = |x: f64, z: f64| format!(r#"{{"source_m": [{x}, 0, {z}], "target_m": [{x}, 0, {z}]}}"#);
    let marks = [pair(0.0, 0.0), pair(0.2, 0.0), pair(0.1, 0.2)].join(", ");
    let text = format!(r#"{{"format": "crease-landmarks/1", "pairs": [{marks}]}}"#);
    std::fs::write(workshop.path("marks.json"), &text).expect("writes");
    let (out, err, code) = workshop.run(
        "transfer from.crease.json --to to.obj --match surface --landmarks marks.json --json -o marked.glb",
    );
    assert_eq!(code, Some(0), "{err}");
    let report: serde_json::Value = serde_json::from_str(&out).expect("is JSON");
    assert_eq!(
        (&report["sources"][0]["by"], &report["sources"][0]["aligned"]),
        (&"surface".into(), &"landmarks".into())
    );
    assert!(report["sources"][0]["crease_left_behind"].as_f64() < Some(0.05), "{report}");
    std::fs::write(workshop.path("marks.json"), text.replace("target_m", "targets")).expect("writes");
    let (_, err, code) =
        workshop.run("transfer from.crease.json --to to.obj --landmarks marks.json -o no.glb");
    assert!(code == Some(1) && err.contains("targets") && err.contains("target_m"), "{err}");
}

fn the_same_mesh_keeps_its_memory_and_a_refined_one_agrees(workshop: &Workshop) {
    let (_, err, code) =
        workshop.run("transfer out.crease.json --to to.obj -o again.glb --match same --quiet");
    assert_eq!(code, Some(0), "{err}");
    let (first, again) = (workshop.read("out.crease.json"), workshop.read("again.crease.json"));
    assert_eq!((&first.hinges, &first.points), (&again.hinges, &again.points));
    // The worn file names its sidecar.
    let (_, err, code) = workshop.run("transfer out.glb --to to.obj -o named.glb --match same --quiet");
    assert_eq!(code, Some(0), "{err}");
    assert_eq!(workshop.read("named.crease.json").hinges, first.hinges);
    let (_, err, code) = workshop.run("render out.glb --show confidence --size 64 -o out.png");
    assert_eq!(code, Some(0), "{err}");
    // Finer than the file: its own points first, by texture as before, what they cannot show in a map.
    let (out, err, code) = workshop
        .run("transfer from.crease.json --to to.obj -o fine.glb --resolution 8 --detail-map=256 --json");
    assert_eq!(code, Some(0), "{err}");
    let report: serde_json::Value = serde_json::from_str(&out).expect("is JSON");
    assert_eq!((&report["sources"][0]["by"], &report["crossings"]), (&"uv".into(), &0.into()));
    assert!(report["detail_maps"].as_array().is_some_and(|maps| maps.len() == 1), "{report}");
    let fine = workshop.read("fine.crease.json");
    let own = first.mesh.points_m.len();
    assert!(fine.mesh.points_m.len() > 2 * own && fine.mesh.points_m[..own] == first.mesh.points_m);
    assert!(fine.mesh.triangle_vertices.is_none() && first.mesh.triangle_vertices.is_some());
    // Both stand as high.
    let height = |sidecar: &crease_io::Sidecar| {
        sidecar.points.displacement_m.iter().map(|d| d[1].abs()).fold(0.0, f64::max)
    };
    println!("height of the fold {:.4} m, finer {:.4} m", height(&first), height(&fine));
    assert!((height(&fine) / height(&first) - 1.0).abs() < 0.25);
}

fn unfit_files_are_refused(workshop: &Workshop) {
    let whole = std::fs::read_to_string(workshop.path("from.crease.json")).expect("is text");
    let refused = |name: &str, text: &str, arguments: &str, expected: &str| {
        std::fs::write(workshop.path(name), text).expect("writes");
        let (_, err, code) = workshop.run(arguments);
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
    assert!(!workshop.path("no.glb").exists() && !workshop.path("no.png").exists());
}
