//! The worn shape as the base shape of a file: what a viewer shows of it, at every moment of its clips, is what the worn file
//! shows with its target at weight 1; and flat-shaded files get smooth wrinkles.

#[path = "export/document.rs"]
mod document;

use crease_geometry::math::Vec3;
use crease_io::gltf::{
    Accessors, FlatNormals, SourceShape, apply_worn, keep_worn_pieces, read_worn, split_glb, write_worn_glb,
    write_worn_glb_with,
};
use crease_io::{ReadOptions, read_asset};
use crease_model::garment::{Garment, RestState, SourceAsset, WornGarment};
use document::*;
use serde_json::{Value, json};

fn read(bytes: &[u8]) -> SourceAsset {
    let options = ReadOptions { unit_m: Some(1.0), ..Default::default() };
    read_asset("file.glb", bytes, &options, &mut |uri| panic!("asks for {uri}")).unwrap().0
}

/// A strip of `n` squares along x, 0.1 m wide; every triangle with vertices of its own if `flat`.
fn strip(d: &mut Document, n: usize, flat: bool) -> Value {
    let at = |i: usize, j: usize| [i as f32 * 0.1, 0.0, j as f32 * 0.1];
    let mut rows: Vec<[f32; 3]> = Vec::new();
    let mut corners = Vec::new();
    for i in 0..n {
        for t in [[(i, 0), (i, 1), (i + 1, 0)], [(i + 1, 0), (i, 1), (i + 1, 1)]] {
            for (k, j) in t {
                let known = rows.iter().position(|row| *row == at(k, j)).filter(|_| !flat);
                corners.push(known.unwrap_or_else(|| {
                    rows.push(at(k, j));
                    rows.len() - 1
                }) as u16);
            }
        }
    }
    let normals: Vec<f32> = rows.iter().flat_map(|_| [0.0, 1.0, 0.0]).collect();
    let position = d.positions(&rows);
    let normal = d.floats("VEC3", 3, &normals);
    let indices = d.indices(&corners);
    json!({"attributes": {"POSITION": position, "NORMAL": normal}, "indices": indices})
}

/// Waves along x.
fn worn(garment: &Garment) -> WornGarment {
    let wave = |x: &Vec3| Vec3::new(0.0, 0.03 * (x.x * 25.0).sin(), 0.004 * x.x);
    WornGarment {
        displacement: garment.points.iter().map(wave).collect(),
        memory: RestState::flat(garment.topology.hinges.len(), garment.triangles.len()),
    }
}

fn wear(bytes: &[u8], flat_normals: FlatNormals) -> Vec<u8> {
    let asset = read(bytes);
    let (garment, _) = Garment::from_asset(&asset).unwrap();
    let extras = json!({"crease": {"sidecar": "OUT.crease.json"}});
    write_worn_glb_with(&asset, &garment, &worn(&garment), &extras, flat_normals).unwrap()
}

/// Numbers of an attribute as shown with these weights: base plus targets.
fn shown(glb: &[u8], name: &str, weights: &[f64]) -> Vec<f64> {
    let asset = read(glb);
    let document = asset.document.as_ref().unwrap();
    let primitive = &document.json["meshes"][0]["primitives"][0];
    let numbers = |index: &Value| {
        let index = index.as_u64().unwrap() as usize;
        Accessors::new(document).table(index, "test").unwrap().values
    };
    let mut sum = numbers(&primitive["attributes"][name]);
    for (target, weight) in primitive["targets"].as_array().into_iter().flatten().zip(weights) {
        if target.get(name).is_some() {
            sum.iter_mut().zip(numbers(&target[name])).for_each(|(a, d)| *a += weight * d);
        }
    }
    sum
}

fn largest_difference(a: &[f64], b: &[f64]) -> f64 {
    assert_eq!(a.len(), b.len());
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
}

/// A document of one mesh with another target, weights on the node, and clips of all kinds of interpolation.
fn animated(flat: bool) -> Vec<u8> {
    let mut d = Document::new();
    let mut primitive = strip(&mut d, 8, flat);
    let count = if flat { 48 } else { 18 };
    let puff: Vec<f32> = (0..count).flat_map(|k| [0.0, 0.001 * k as f32, 0.0]).collect();
    let puff = d.floats("VEC3", 3, &puff);
    primitive["targets"] = json!([{"POSITION": puff}]);
    d.push("meshes", json!({"primitives": [primitive], "extras": {"targetNames": ["puff"]}}));
    d.push("nodes", json!({"mesh": 0, "weights": [0.25]}));
    let times = d.floats("SCALAR", 1, &[0.0, 1.0]);
    let linear = d.floats("SCALAR", 1, &[0.0, 1.0]);
    let cubic = d.floats("SCALAR", 1, &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6]);
    let target = json!({"node": 0, "path": "weights"});
    for (output, interpolation) in [(linear, "LINEAR"), (cubic, "CUBICSPLINE")] {
        d.push(
            "animations",
            json!({"channels": [{"sampler": 0, "target": target}],
                   "samplers": [{"input": times, "output": output, "interpolation": interpolation}]}),
        );
    }
    d.glb()
}

#[test]
fn the_applied_file_shows_the_worn_shape_and_leads_back() {
    for flat in [false, true] {
        let source = animated(flat);
        let worn_glb = wear(&source, FlatNormals::Smoothed);
        let applied = apply_worn("worn.glb", &worn_glb, SourceShape::Target).unwrap();
        let (json, _) = split_glb(&applied).unwrap();
        assert_eq!(json["meshes"][0]["extras"]["targetNames"], json!(["puff", "unworn"]));
        assert_eq!(json["meshes"][0]["weights"], json!([0.0, 0.0]));
        assert_eq!(json["nodes"][0]["weights"], json!([0.25, 0.0]));
        for puff in [0.0, 0.7] {
            for (name, tolerance) in [("POSITION", 1e-7), ("NORMAL", 1e-5)] {
                let wanted = shown(&worn_glb, name, &[puff, 1.0]);
                assert!(
                    largest_difference(&shown(&applied, name, &[puff, 0.0]), &wanted) < tolerance,
                    "{name}"
                );
                let back = shown(&source, name, &[puff]);
                assert!(largest_difference(&shown(&applied, name, &[puff, 1.0]), &back) < 1e-6, "{name}");
            }
        }
        // Only the weights of the clips were appended: all other numbers replaced the old ones.
        assert!(applied.len() <= worn_glb.len() + 400, "{} bytes from {}", applied.len(), worn_glb.len());
    }
}

/// Clips have a weight per target at every key: that of the worn target becomes its opposite, tangents change their sign.
#[test]
fn clips_show_the_same_as_before() {
    let applied =
        apply_worn("w", &wear(&animated(false), FlatNormals::Smoothed), SourceShape::Target).unwrap();
    let dropped =
        apply_worn("w", &wear(&animated(false), FlatNormals::Smoothed), SourceShape::Dropped).unwrap();
    let outputs = |glb: &[u8]| -> Vec<Vec<f64>> {
        let asset = read(glb);
        let document = asset.document.as_ref().unwrap();
        let clips = document.json["animations"].as_array().unwrap();
        let output = |clip: &Value| clip["samplers"][0]["output"].as_u64().unwrap() as usize;
        clips.iter().map(|c| Accessors::new(document).table(output(c), "test").unwrap().values).collect()
    };
    let close = |a: &[f64], b: &[f64]| assert!(largest_difference(a, b) < 1e-6, "{a:?} is not {b:?}");
    let with = outputs(&applied);
    close(&with[0], &[0.0, 0.0, 1.0, 0.0]);
    close(&with[1], &[0.1, 0.0, 0.2, 0.0, 0.3, 0.0, 0.4, 0.0, 0.5, 0.0, 0.6, 0.0]);
    let without = outputs(&dropped);
    close(&without[0], &[0.0, 1.0]);
    close(&without[1], &[0.1, 0.2, 0.3, 0.4, 0.5, 0.6]);
    let (json, _) = split_glb(&dropped).unwrap();
    assert_eq!(json["meshes"][0]["extras"]["targetNames"], json!(["puff"]));
    assert_eq!(json["nodes"][0]["weights"], json!([0.25]));
}

/// Without any target left, weights and their clips go: the specification allows none without targets.
#[test]
fn the_last_target_goes_with_its_weights_and_clips() {
    let mut d = Document::new();
    let primitive = strip(&mut d, 4, false);
    d.push("meshes", json!({"primitives": [primitive]}));
    d.push("nodes", json!({"mesh": 0}));
    let glb = wear(&d.glb(), FlatNormals::Smoothed);
    let applied = apply_worn("w", &glb, SourceShape::Dropped).unwrap();
    let (json, _) = split_glb(&applied).unwrap();
    let mesh = json["meshes"][0].as_object().unwrap();
    assert!(!mesh.contains_key("weights") && mesh["primitives"][0].get("targets").is_none());
    assert!(mesh["extras"].get("targetNames").is_none() && json.get("animations").is_none());
    // It is still known as worn.
    let mut asset = read(&applied);
    assert!(keep_worn_pieces(&mut asset));
    let wear = read_worn(&asset).unwrap();
    assert!(wear.positions.iter().any(|x| x.y > 0.02));
    assert_eq!(wear.positions, wear.source_positions);
}

#[test]
fn an_applied_file_is_read_with_both_shapes() {
    let source = animated(false);
    let glb = wear(&source, FlatNormals::Smoothed);
    let applied = apply_worn("w", &glb, SourceShape::Target).unwrap();
    let [before, after] = [&glb, &applied].map(|bytes| {
        let mut asset = read(bytes);
        assert!(keep_worn_pieces(&mut asset));
        read_worn(&asset).unwrap()
    });
    for (a, b) in [(&before.positions, &after.positions), (&before.source_positions, &after.source_positions)]
    {
        assert!(a.iter().zip(b).all(|(a, b)| (a - b).norm() < 1e-6));
    }
    assert!((before.positions[3] - before.source_positions[3]).norm() > 1e-3);
}

/// Angle between the normals of vertices at one position, at most [degrees].
fn largest_split(glb: &[u8]) -> f64 {
    let (x, n) = (shown(glb, "POSITION", &[]), shown(glb, "NORMAL", &[]));
    let row = |list: &[f64], v: usize| Vec3::from_row_slice(&list[3 * v..3 * v + 3]);
    let mut most = 0.0f64;
    for a in 0..x.len() / 3 {
        for b in 0..a {
            if (row(&x, a) - row(&x, b)).norm() < 1e-6 {
                most = most.max(row(&n, a).angle(&row(&n, b)));
            }
        }
    }
    most.to_degrees()
}

#[test]
fn flat_shaded_files_get_smooth_wrinkles_unless_they_keep_their_normals() {
    let mut d = Document::new();
    let primitive = strip(&mut d, 8, true);
    d.push("meshes", json!({"primitives": [primitive]}));
    d.push("nodes", json!({"mesh": 0, "rotation": [0.0, 0.6, 0.0, 0.8], "scale": [2.0, 1.0, 0.5]}));
    let source = d.glb();
    let split = |flat_normals| {
        largest_split(&apply_worn("w", &wear(&source, flat_normals), SourceShape::Dropped).unwrap())
    };
    assert!(split(FlatNormals::Smoothed) < 0.1, "{}", split(FlatNormals::Smoothed));

    // A roof of two flat-shaded slopes at 100 degrees keeps its ridge.
    let (mut d, s) = (Document::new(), 50f32.to_radians());
    let (c, s) = (s.cos() * 0.1, s.sin() * 0.1);
    let (a, b) = ([-c, -s, 0.0], [-c, -s, 0.1]);
    let (e, f) = ([c, -s, 0.0], [c, -s, 0.1]);
    let (r, q) = ([0.0, 0.0, 0.0], [0.0, 0.0, 0.1]);
    let position = d.positions(&[a, b, r, q, r, q, e, f]);
    let (nx, ny) = (s * 10.0, c * 10.0);
    let normals = [[-nx, ny, 0.0], [nx, ny, 0.0]].map(|n| n.repeat(4)).concat();
    let normal = d.floats("VEC3", 3, &normals);
    let indices = d.indices(&[0, 1, 2, 2, 1, 3, 4, 5, 6, 6, 5, 7]);
    d.push(
        "meshes",
        json!({"primitives": [{"attributes": {"POSITION": position, "NORMAL": normal}, "indices": indices}]}),
    );
    d.push("nodes", json!({"mesh": 0}));
    let applied = apply_worn("w", &wear(&d.glb(), FlatNormals::Smoothed), SourceShape::Dropped).unwrap();
    assert!(largest_split(&applied) > 60.0, "{}", largest_split(&applied));
}

/// A file without normals is shaded flat by viewers; the applied one has smooth normals.
#[test]
fn a_file_without_normals_gets_smooth_ones() {
    let mut d = Document::new();
    let mut primitive = strip(&mut d, 8, true);
    primitive["attributes"].as_object_mut().unwrap().remove("NORMAL");
    d.push("meshes", json!({"primitives": [primitive]}));
    d.push("nodes", json!({"mesh": 0}));
    let glb = wear(&d.glb(), FlatNormals::Smoothed);
    let applied = apply_worn("w", &glb, SourceShape::Target).unwrap();
    let normals = shown(&applied, "NORMAL", &[0.0]);
    assert!(normals.chunks(3).all(|n| (Vec3::from_row_slice(n).norm() - 1.0).abs() < 1e-6));
    assert!(largest_split(&applied) < 0.1);
    let back = shown(&applied, "NORMAL", &[1.0]);
    assert!(back.chunks(3).all(|n| (n[1] - 1.0).abs() < 1e-6), "the source is flat");
}

/// Two primitives on one list of positions, of which each has a target of its own: neither is changed by the other.
#[test]
fn primitives_that_share_positions_are_moved_once() {
    let mut d = Document::new();
    let primitive = strip(&mut d, 4, false);
    let (first, second) = (d.indices(&[0, 1, 2, 2, 1, 3]), d.indices(&[2, 3, 4, 4, 3, 5]));
    let of = |indices| json!({"attributes": primitive["attributes"], "indices": indices});
    d.push("meshes", json!({"primitives": [of(first), of(second)]}));
    d.push("nodes", json!({"mesh": 0}));
    let glb = wear(&d.glb(), FlatNormals::Smoothed);
    let applied = apply_worn("w", &glb, SourceShape::Target).unwrap();
    let wanted = shown(&glb, "POSITION", &[1.0]);
    assert!(largest_difference(&shown(&applied, "POSITION", &[0.0]), &wanted) < 1e-7);
}

#[test]
fn a_file_without_a_worn_target_is_refused() {
    let source = animated(false);
    let message = apply_worn("plain.glb", &source, SourceShape::Target).unwrap_err().to_string();
    assert!(message.contains("plain.glb") && message.contains("worn"), "{message}");
    let twice = apply_worn("w", &wear(&source, FlatNormals::Smoothed), SourceShape::Target).unwrap();
    assert!(apply_worn("twice.glb", &twice, SourceShape::Target).is_err());
    assert!(apply_worn("no.glb", b"no glTF", SourceShape::Target).is_err());
    let asset = read(&source);
    let (garment, _) = Garment::from_asset(&asset).unwrap();
    assert!(write_worn_glb(&asset, &garment, &worn(&garment), &Value::Null).is_ok());
}

/// Runs the tool in `folder`; returns its exit code and what it wrote on both streams.
fn run(folder: &std::path::Path, words: &str) -> (i32, String) {
    let out = std::process::Command::new(env!("CARGO_BIN_EXE_crease"))
        .args(words.split(' '))
        .current_dir(folder)
        .output()
        .expect("runs");
    let text = String::from_utf8_lossy(&out.stdout).into_owned() + &String::from_utf8_lossy(&out.stderr);
    (out.status.code().unwrap_or(-1), text)
}

/// The garments and scripts of the program, the option, the command, and that pictures and pages take what both write.
#[test]
fn the_tool_applies_and_reads_what_it_applied() {
    let folder = tempfile::tempdir().unwrap();
    let folder = folder.path();
    assert!(run(folder, "example").1.contains("fold-thrice"));
    assert_eq!(run(folder, "example handkerchief -o .").0, 0);
    let (code, text) = run(folder, "example handkerchief -o .");
    assert!(code == 1 && text.contains("is there already"), "{text}");
    assert_eq!(run(folder, "example fold-thrice").0, 0);
    assert_eq!(run(folder, "example elbow").0, 0);
    assert!(folder.join("fold-thrice.json").exists() && folder.join("elbow.crease.json").exists());
    let (code, text) = run(folder, "example elbwo");
    assert!(code == 1 && text.contains("did you mean `elbow`?"), "{text}");
    let (code, text) = run(folder, "example shirt -o .");
    assert!(code == 1 && text.contains("crease example"), "{text}");

    let square = |k: usize| (0.02 * (k % 13) as f64, 0.02 * (k / 13) as f64);
    let points = (0..13 * 13).map(square).map(|(x, z)| format!("v {x} 0 {z}\n"));
    let cells = (0..12 * 12).map(|k| k / 12 * 13 + k % 12 + 1);
    let faces = cells.map(|a| format!("f {a} {} {} {}\n", a + 13, a + 14, a + 1));
    std::fs::write(folder.join("sheet.obj"), points.chain(faces).collect::<String>()).unwrap();
    let bake = "bake sheet.obj --unit m --quality draft --export usd --wear";
    let (code, text) = run(folder, &format!("{bake} press-crase -o worn.glb"));
    assert!(code == 1 && text.contains("did you mean `press-crease`?"), "{text}");
    let (code, text) = run(folder, &format!("{bake} press-crease -o worn.glb"));
    assert_eq!(code, 0, "{text}");
    assert_eq!(run(folder, &format!("{bake} press-crease --apply -o applied.glb")).0, 0);
    assert_eq!(run(folder, "apply worn.glb -o later.glb").0, 0);
    let bytes = |name: &str| std::fs::read(folder.join(name)).unwrap();
    // The name of the sidecar in the extras is all that differs.
    let [at_once, later] = ["applied.glb", "later.glb"].map(|name| shown(&bytes(name), "POSITION", &[0.0]));
    assert_eq!(at_once, later);
    let wanted = shown(&bytes("worn.glb"), "POSITION", &[1.0]);
    assert!(largest_difference(&at_once, &wanted) < 1e-7);
    // The sidecar belongs to the applied file, too; without it the file itself has both shapes.
    assert_eq!(
        run(folder, "render applied.glb --show rest-angle-change --before-after -o a.png --size 64").0,
        0
    );
    std::fs::remove_file(folder.join("applied.crease.json")).unwrap();
    assert_eq!(run(folder, "render applied.glb --focus memory --view top -o b.png --size 64").0, 0);
    assert_eq!(run(folder, "view applied.glb later.glb -o both.html").0, 0);
    let (code, text) = run(folder, "apply later.glb -o again.glb");
    assert!(code == 1 && text.contains("worn"), "{text}");
    assert!(!folder.join("again.glb").exists());
    let usd = String::from_utf8(bytes("worn.usda")).unwrap();
    assert!(
        usd.starts_with("#usda 1.0")
            && usd.contains("def BlendShape \"worn\"")
            && usd.contains("physics:density")
    );
}
