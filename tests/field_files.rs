//! Mesh files as people bring them: each test states what a user would see if the file were misread.

#[path = "export/document.rs"]
mod document;
#[path = "field/shapes.rs"]
mod shapes;

use crease_geometry::math::Vec3;
use crease_geometry::mesh::hinge_angle;
use crease_io::gltf::{file_contents, join_glb, split_glb, write_worn_glb};
use crease_io::{FrameRow, FrameRows, ReadOptions, read_asset, write_shape_obj};
use crease_model::garment::{ImportDiagnostic, RestState, Severity, SourceAsset, WornGarment};
use document::Document;
use serde_json::{Value, json};
use shapes::*;

fn warnings(diagnostics: &[ImportDiagnostic]) -> Vec<&str> {
    let doubtful = diagnostics.iter().filter(|d| d.severity == Severity::Warning);
    doubtful.map(|d| d.message.as_str()).collect()
}

/// A sleeve shown by nodes that the caller makes.
fn sleeve(outwards: bool, nodes: impl FnOnce(&mut Document, usize)) -> SourceAsset {
    let mut document = empty();
    let mesh = add_tube(&mut document, &tube(0.1, 0.5), outwards);
    nodes(&mut document, mesh);
    read_with("sleeve.glb", &document.glb(), &ReadOptions::default()).expect("is read").0
}

/// A mirror modifier that was not applied, a component mirrored by a matrix above it, a mirrored copy below a mirrored copy, and
/// faces that look inwards: in all of them outside stays outside, and a tube bends away from it.
#[test]
fn the_outside_of_a_garment_is_outside() {
    let mirrored = json!([-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1]);
    let below = |document: &mut Document, mesh: usize, own: Value, above: Value| {
        let mut own = own;
        own["mesh"] = json!(mesh);
        let child = document.push("nodes", own);
        let mut above = above;
        above["children"] = json!([child]);
        add_node(document, above);
    };
    let files = [
        ("plain", sleeve(true, |d, mesh| below(d, mesh, json!({}), json!({})))),
        ("scale", sleeve(true, |d, mesh| below(d, mesh, json!({"scale": [1, -1, 1]}), json!({})))),
        ("matrix", sleeve(true, |d, mesh| below(d, mesh, json!({}), json!({"matrix": mirrored})))),
        (
            "twice",
            sleeve(true, |d, mesh| {
                below(d, mesh, json!({"scale": [-1, 1, 1]}), json!({"scale": [1, 1, -1]}))
            }),
        ),
        ("inwards", sleeve(false, |d, mesh| below(d, mesh, json!({}), json!({})))),
    ];
    for (name, asset) in files {
        let (garment, _) = garment_of(&asset);
        assert_eq!(outward_fraction(&garment.points, &garment.triangles), 1.0, "{name}");
        let angle = |h: &crease_geometry::mesh::Hinge| hinge_angle(&h.points.map(|p| garment.points[p.at()]));
        assert!(garment.topology.hinges.iter().map(angle).sum::<f64>() > 0.0, "{name}");
        let shape = write_shape_obj(&asset, &garment, &vec![Vec3::zeros(); garment.points.len()]);
        let (again, _) = read_with("a.obj", &shape, &ReadOptions::default()).expect("is read");
        let (again, _) = garment_of(&again);
        assert_eq!(outward_fraction(&again.points, &again.triangles), 1.0, "{name} as OBJ");
    }
}

/// A skin mirrors its vertices by a joint of negative scale.
#[test]
fn a_mirrored_joint_mirrors_the_triangles() {
    let mut document = empty();
    let positions = tube(0.1, 0.5);
    let mesh = add_tube(&mut document, &positions, true);
    let skin = add_arm(&mut document, [Some("upper"), Some("lower")], "arm");
    bind(&mut document, mesh, &positions);
    add_node(&mut document, json!({"mesh": mesh, "skin": skin}));
    document.json["nodes"][2]["scale"] = json!([1, 1, -1]);
    let (asset, _) = read_with("a.glb", &document.glb(), &ReadOptions::default()).expect("is read");
    let (garment, _) = garment_of(&asset);
    assert_eq!(outward_fraction(&garment.points, &garment.triangles), 1.0);
}

/// A sleeve with a morph target that makes it wider by half, and one that moves it along x.
fn morphed(mesh_weights: Value, node_weights: Option<Value>) -> Vec<u8> {
    let mut document = empty();
    let positions = tube(0.1, 0.5);
    let mesh = add_tube(&mut document, &positions, true);
    let wider: Vec<[f32; 3]> = positions.iter().map(|[_, y, z]| [0.0, 0.5 * y, 0.5 * z]).collect();
    let aside: Vec<[f32; 3]> = positions.iter().map(|_| [1.0, 0.0, 0.0]).collect();
    let targets = [wider, aside].map(|target| json!({"POSITION": document.positions(&target)}));
    document.json["meshes"][mesh]["primitives"][0]["targets"] = json!(targets);
    document.json["meshes"][mesh]["weights"] = mesh_weights;
    document.json["meshes"][mesh]["extras"] = json!({"targetNames": ["wider", "aside"]});
    let mut node = json!({"mesh": mesh});
    if let Some(weights) = node_weights {
        node["weights"] = weights;
    }
    add_node(&mut document, node);
    document.glb()
}

#[test]
fn the_shape_that_the_file_shows_is_worn() {
    for (mesh, node, radius, x) in [
        (json!([0, 0]), None, 0.1, 0.0),
        (json!([1, 0]), None, 0.15, 0.0),
        (json!([1, 0]), Some(json!([0.5, 1])), 0.125, 1.0),
        (json!([1, 1]), Some(json!([0, 0])), 0.1, 0.0),
    ] {
        let bytes = morphed(mesh, node);
        let (asset, _) = read_with("a.glb", &bytes, &ReadOptions::default()).expect("is read");
        let (garment, _) = garment_of(&asset);
        let first = garment.points[0];
        assert!((first - Vec3::new(x - 0.25, radius, 0.0)).norm() < 1e-6, "{first}");
        let worn = WornGarment {
            displacement: vec![Vec3::new(0.0, 0.01, 0.0); garment.points.len()],
            memory: RestState::flat(garment.topology.hinges.len(), garment.triangles.len()),
        };
        let glb = write_worn_glb(&asset, &garment, &worn, &json!({"crease": {"sidecar": "a.crease.json"}}));
        let glb = glb.expect("is written");
        let (again, diagnostics) = read_with("worn.glb", &glb, &ReadOptions::default()).expect("is read");
        let unworn = again.pieces[0].scene_position(0).expect("has it");
        assert!((unworn - first).norm() < 1e-6, "the shape before the wear: {unworn}");
        let told = |d: &ImportDiagnostic| d.severity == Severity::Note && d.message.contains("a.crease.json");
        assert!(diagnostics.iter().any(told), "{diagnostics:?}");
        let contents = file_contents(&again).expect("is read");
        let targets: Vec<(&str, f64)> =
            contents.piece_attributes[0].morph_targets.iter().map(|t| (t.name.as_str(), t.weight)).collect();
        assert_eq!(targets[2], ("worn", 1.0), "{targets:?}");
        let shown = crease_io::gltf::read_worn(&again).expect("is worn").positions[0];
        assert!((shown - first - Vec3::new(0.0, 0.01, 0.0)).norm() < 1e-6, "{shown}");
    }
}

/// A shirt beside a part that nobody asked for.
fn shirt_and(damage: impl FnOnce(&mut Document, usize)) -> Vec<u8> {
    let mut document = empty();
    let shirt = add_tube(&mut document, &tube(0.2, 0.6), true);
    add_node(&mut document, json!({"name": "shirt", "mesh": shirt}));
    let watch = add_tube(&mut document, &tube(0.05, 0.1), true);
    damage(&mut document, watch);
    document.glb()
}

#[test]
fn a_part_that_nobody_asked_for_blocks_nothing() {
    let hidden = |node: Value| {
        shirt_and(|document, watch| {
            let mut node = node;
            node["name"] = json!("watch");
            node["mesh"] = json!(watch);
            add_node(document, node);
        })
    };
    let files = [
        ("scale 0", hidden(json!({"scale": [0, 0, 0]}))),
        ("flattened", hidden(json!({"scale": [1, 0, 1]}))),
        ("no rotation", hidden(json!({"rotation": [0, 0, 0, 0]}))),
        ("no such skin", hidden(json!({"skin": 7}))),
        (
            "not a number",
            shirt_and(|document, watch| {
                let mut positions = tube(0.05, 0.1);
                positions[3][1] = f32::NAN;
                let bad = document.floats("VEC3", 3, positions.as_flattened());
                document.json["meshes"][watch]["primitives"][0]["attributes"]["POSITION"] = json!(bad);
                add_node(document, json!({"name": "watch", "mesh": watch}));
            }),
        ),
    ];
    for (name, bytes) in files {
        let (asset, diagnostics) = read_with("a.glb", &bytes, &named("shirt")).expect(name);
        assert_eq!(garment_of(&asset).0.points.len(), usize::from(AROUND * RINGS), "{name}");
        let told = warnings(&diagnostics);
        assert!(told.iter().any(|w| w.contains("watch") && w.contains("left as it is")), "{name}: {told:?}");
        for options in [named("watch"), ReadOptions::default()] {
            let error = read_with("a.glb", &bytes, &options).expect_err(name).to_string();
            assert!(error.starts_with("a.glb"), "{name}: {error}");
        }
        let error = read_with("a.glb", &bytes, &ReadOptions::default()).expect_err(name).to_string();
        assert!(error.contains("ReadOptions::garment"), "{name}: {error}");
    }
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 1 nan 0\ng shirt\nf 1 2 3\ng watch\nf 1 2 4\n";
    let (asset, diagnostics) = read_with("a.obj", obj.as_bytes(), &named("shirt")).expect("is read");
    assert_eq!(asset.pieces.len(), 1);
    assert!(warnings(&diagnostics)[0].contains("a coordinate is not a finite number"), "{diagnostics:?}");
    let error =
        read_with("a.obj", obj.as_bytes(), &ReadOptions::default()).expect_err("is damaged").to_string();
    assert!(error.contains("line 4: a coordinate"), "{error}");
}

#[test]
fn a_garment_is_several_parts_by_name_material_or_number() {
    let obj = "v 0 0 0\nv 1 0 0\nv 1 1 0\no Body\nusemtl Purple\nf 1 2 3\nusemtl Skin\nf 1 2 3\no Hat, red\nusemtl Felt\nf 1 2 3\n";
    for (label, worn) in [
        ("Body", [true, true, false]),
        ("Body:Purple", [true, false, false]),
        ("Hat, red", [false, false, true]),
        ("Body:Skin,Felt", [false, true, true]),
        ("piece#0, piece#2", [true, false, true]),
    ] {
        let (asset, _) = read_with("a.obj", obj.as_bytes(), &named(label)).expect(label);
        assert_eq!(asset.pieces.iter().map(|p| p.worn).collect::<Vec<_>>(), worn, "{label}");
    }
    let error = read_with("a.obj", obj.as_bytes(), &named("Body,Shoe")).expect_err("no shoe").to_string();
    assert!(error.contains("\"Shoe\"") && error.contains("Felt"), "{error}");
}

/// Colours of exporters: fractions, bytes in OBJ, bytes as floats, words.
#[test]
fn whole_numbers_of_a_mask_are_bytes_or_words() {
    let obj = |f: &dyn Fn(f64) -> String| {
        let v = |x: u32, c: f64| format!("v {x} {} 0 {} 0 0\n", x * x, f(c));
        format!("{}{}{}f 1 2 3\n", v(0, 0.2), v(1, 1.0), v(2, 0.6))
    };
    let options = ReadOptions { mask: Some("COLOR_0.r".into()), any_size: true, ..ReadOptions::default() };
    for (name, text, told) in [
        ("fractions", obj(&|c| c.to_string()), 0),
        ("bytes", obj(&|c| (255.0 * c).round().to_string()), 1),
        ("words", obj(&|c| (65_535.0 * c).round().to_string()), 1),
    ] {
        let (asset, diagnostics) = read_with("a.obj", text.as_bytes(), &options).expect(name);
        let mask = asset.pieces[0].mask.clone().expect("has it");
        for (value, expected) in mask.iter().zip([0.2, 1.0, 0.6]) {
            assert!((value - expected).abs() < 1e-3, "{name}: {mask:?}");
        }
        assert_eq!(warnings(&diagnostics).len(), told, "{name}: {diagnostics:?}");
    }
}

#[test]
fn an_obj_shape_has_the_lines_of_its_file() {
    // Lines in another order than the faces use them, a seam, a quad, a part that is not worn, a vertex of no face.
    let obj = "v 0 0 9\nv 30 30 0\nv 0 30 0\nv 30 0 0\nv 0 0 0\nv 60 0 0\nv 60 30 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0.5 0.5\n\
        g shirt\nf 5/1 4/2 2/3 3/4\nf 4/5 6/2 7/3\ng hat\nf 4 7 2\n";
    let options = ReadOptions { unit_m: Some(0.01), ..named("shirt") };
    let (asset, _) = read_with("a.obj", obj.as_bytes(), &options).expect("is read");
    let (garment, _) = garment_of(&asset);
    let displacement: Vec<Vec3> = (0..garment.points.len()).map(|_| Vec3::new(0.0, 0.0, 0.02)).collect();
    let text = String::from_utf8(write_shape_obj(&asset, &garment, &displacement)).expect("is text");
    let rows = |key: &str| -> Vec<Vec<f64>> {
        let lines = text.lines().filter_map(|line| line.strip_prefix(key)?.strip_prefix(' '));
        lines.map(|line| line.split(' ').map(|word| word.parse().unwrap()).collect()).collect()
    };
    let expected: [[f64; 3]; 7] = [
        [0.0, 0.0, 0.09],
        [0.3, 0.3, 0.02],
        [0.0, 0.3, 0.02],
        [0.3, 0.0, 0.02],
        [0.0, 0.0, 0.02],
        [0.6, 0.0, 0.02],
        [0.6, 0.3, 0.02],
    ];
    let found = rows("v");
    assert_eq!(found.len(), 7);
    for (row, expected) in found.iter().zip(expected) {
        assert!(row.iter().zip(expected).all(|(a, b)| (a - b).abs() < 1e-12), "{row:?} {expected:?}");
    }
    assert_eq!(rows("vt").len(), 5);
    let faces: Vec<&str> = text.lines().filter(|line| line.starts_with('f')).collect();
    assert_eq!(faces, ["f 5/1 4/2 2/3 3/4", "f 4/5 6/2 7/3", "f 4 7 2"]);
}

#[test]
fn other_chunks_and_addresses_of_any_spelling_are_kept() {
    let mut glb = morphed(json!([0, 0]), None);
    let (json, binary) = split_glb(&glb).expect("is a GLB");
    for (kind, data) in [(b"XMPD", b"<x/>"), (b"BIN\0", b"more")] {
        glb.extend_from_slice(&4u32.to_le_bytes());
        glb.extend_from_slice(kind);
        glb.extend_from_slice(data);
    }
    let length = (glb.len() as u32).to_le_bytes();
    glb[8..12].copy_from_slice(&length);
    let (asset, _) = read_with("a.glb", &glb, &ReadOptions::default()).expect("is read");
    let (garment, _) = garment_of(&asset);
    let worn = WornGarment {
        displacement: vec![Vec3::zeros(); garment.points.len()],
        memory: RestState::flat(garment.topology.hinges.len(), garment.triangles.len()),
    };
    let written = write_worn_glb(&asset, &garment, &worn, &Value::Null).expect("is written");
    assert!(written.ends_with(b"\x04\0\0\0XMPD<x/>\x04\0\0\0BIN\0more"), "both come out again");
    assert!(split_glb(&written).is_ok());

    let bytes = binary.expect("has bytes");
    let escaped: String = bytes.iter().map(|byte| format!("%{byte:02X}")).collect();
    for (name, uri) in [
        ("percent signs", format!("data:application/octet-stream,{escaped}")),
        ("backslash", "maps\\my%20shirt.bin".to_owned()),
        ("as it is", "my shirt 10%25.bin".to_owned()),
    ] {
        let mut json = json.clone();
        json["buffers"][0]["uri"] = json!(uri);
        let text = json.to_string();
        let files = ["maps/my shirt.bin", "my shirt 10%25.bin"];
        let (asset, _) = read_asset("a.gltf", text.as_bytes(), &ReadOptions::default(), &mut |file| {
            if files.contains(&file) {
                Ok(bytes.clone())
            } else {
                Err(crease::Error::input(file, "", "missing", ""))
            }
        })
        .expect(name);
        assert_eq!(asset.pieces[0].positions.len(), usize::from(AROUND * RINGS), "{name}");
    }
}

/// A damaged list would read as empty, and the only error would be that there are no triangles.
#[test]
fn faults_of_the_document_are_named_first() {
    let (json, _) = split_glb(&morphed(json!([0, 0]), None)).expect("is a GLB");
    for (key, value, expected) in [
        ("nodes", json!({"0": {}}), "nodes: is not a list"),
        ("meshes", json!([7]), "meshes[0]: is not an object"),
        ("meshes", json!([]), "meshes: there are none"),
        ("nodes", json!([{"name": "empty"}]), "nodes: none of them shows a mesh"),
    ] {
        let mut json = json.clone();
        json[key] = value;
        let bytes = json.to_string();
        let error =
            read_with("a.gltf", bytes.as_bytes(), &ReadOptions::default()).expect_err(key).to_string();
        assert!(error.contains(expected), "{expected}: {error}");
    }
}

#[test]
fn a_size_that_no_garment_has_is_refused_whatever_the_unit() {
    let scarf = |side: f64| format!("v 0 0 0\nv {side} 0 0\nv {side} {side} 0\nf 1 2 3\n");
    let centimetres = ReadOptions { unit_m: Some(0.01), ..ReadOptions::default() };
    for side in [0.4, 4000.0] {
        let text = scarf(side);
        let error = read_with("a.obj", text.as_bytes(), &centimetres).expect_err("no garment").to_string();
        assert!(error.contains("ReadOptions::unit_m") && error.contains("ReadOptions::any_size"), "{error}");
        let forced = ReadOptions { any_size: true, ..centimetres.clone() };
        assert!(read_with("a.obj", text.as_bytes(), &forced).is_ok());
    }
    for (side, told) in [(0.07, true), (0.7, false), (4.0, true)] {
        let text = scarf(side);
        let (_, diagnostics) = read_with("a.obj", text.as_bytes(), &ReadOptions::default()).expect("is read");
        assert_eq!(
            warnings(&diagnostics).iter().any(|w| w.contains("ReadOptions::unit_m")),
            told,
            "{side}: {diagnostics:?}"
        );
        let stated = ReadOptions { unit_m: Some(1.0), ..ReadOptions::default() };
        let (_, diagnostics) = read_with("a.obj", text.as_bytes(), &stated).expect("is read");
        assert!(warnings(&diagnostics).is_empty(), "a stated unit is not questioned");
    }
}

/// A garment modelled where its place in a landscape is: single precision would round its positions to half a millimetre.
#[test]
fn a_garment_far_from_the_origin_keeps_its_shape() {
    let far = [5_000.0, 20.0, -8_000.0];
    let v = |x: f64, z: f64| format!("v {} {} {}\n", far[0] + x, far[1], far[2] + z);
    let text = [v(0.0, 0.0), v(0.3001, 0.0), v(0.3001, 0.3001), "f 1 3 2\n".to_owned()].concat();
    let (asset, _) = read_with("a.obj", text.as_bytes(), &ReadOptions::default()).expect("is read");
    let (garment, _) = garment_of(&asset);
    let worn = WornGarment { displacement: vec![Vec3::zeros(); 3], memory: RestState::flat(0, 1) };
    let glb = write_worn_glb(&asset, &garment, &worn, &Value::Null).expect("is written");
    let (again, _) = read_with("a.glb", &glb, &ReadOptions::default()).expect("is read");
    for point in 0..3 {
        let there = again.pieces[0].scene_position(point).expect("has it");
        let own = asset.pieces[0].scene_position(point).expect("has it");
        assert!((there - own).norm() < 1e-6, "{there} {own}");
    }
}

/// A glTF garment far away: by its node, it keeps its shape; by its positions, it has the shape that single precision left, and
/// the wear is added to that without further rounding.
#[test]
fn a_gltf_far_from_the_origin_keeps_what_its_file_has() {
    let far = [10_000.0f32, 20.0, -8_000.0];
    let shape = tube(0.1, 0.5);
    let moved: Vec<[f32; 3]> = shape.iter().map(|p| std::array::from_fn(|k| p[k] + far[k])).collect();
    for (by_node, positions, node) in
        [(true, &shape, json!({"translation": far})), (false, &moved, json!({}))]
    {
        let mut document = empty();
        let mesh = add_tube(&mut document, positions, true);
        let mut node = node;
        node["mesh"] = json!(mesh);
        add_node(&mut document, node);
        let (asset, _) = read_with("a.glb", &document.glb(), &ReadOptions::default()).expect("is read");
        let (garment, _) = garment_of(&asset);
        assert_eq!(garment.points.len(), shape.len());
        let rounding = if by_node { 1e-6 } else { 1e-3 };
        let own = |k: usize| Vec3::from(shape[k].map(f64::from)) - Vec3::from(shape[0].map(f64::from));
        for k in 0..shape.len() {
            let point = |k: usize| garment.points[garment.source_point[k].at()];
            let error = (point(k) - point(0) - own(k)).norm();
            assert!(error < rounding, "{by_node}: {error}");
        }
        let up = Vec3::new(0.0, 1.234_567e-3, 0.0);
        let worn = WornGarment {
            displacement: vec![up; garment.points.len()],
            memory: RestState::flat(garment.topology.hinges.len(), garment.triangles.len()),
        };
        let glb = write_worn_glb(&asset, &garment, &worn, &json!({"crease": {"sidecar": "a.crease.json"}}))
            .expect("is written");
        let (again, _) = read_with("a.glb", &glb, &ReadOptions::default()).expect("is read");
        let shown = crease_io::gltf::read_worn(&again).expect("is worn");
        for (k, there) in shown.positions.iter().enumerate() {
            let before = asset.pieces[0].scene_position(k).expect("has it");
            let error = (there - before - up).norm();
            assert!(error < 1e-8, "{by_node}: {error}");
        }
    }
}

/// A sheet of 4 x 4 squares whose corners are (0.05 i, 0.01 i j, 0.05 j), compressed by meshoptimizer: positions, normals on an
/// octahedron, triangles.
const PACKED: [(&str, usize, usize, &str, &str); 3] = [
    (
        "ATTRIBUTES",
        12,
        25,
        "NONE",
        "a00700650065666665006566666500656666cff3c000656566666565660700670065666867006566686700656668cff3c000\
    67656668676566070098ff9a669798ff9a669798ff9a6697ffffc00098ff9a669798ff9a6605323c8f237a7b7a7b7a7bc8f2\
    00007a7b7a05000cff3f14f5f61314f5f613cff3c000e1bab9e214f5f605000cff3f51292a5251292a52cff3c0007be1e27c\
    51292a05000fffff46ffa45c45b9ffa45cbaffffc00015ff867a1646ffa45c05000c2f8378797879e0f0800078797a050030\
    0003656500c00000660500300003676500c00000660500300c0398ff9a00c000006601003000027a00000000000000000000\
    00000000000000000000000000000000000000000000",
    ),
    (
        "ATTRIBUTES",
        4,
        25,
        "OCTAHEDRAL",
        "a00000000000000000000000000000000000000000000000000000000000000000007f7f00",
    ),
    (
        "TRIANGLES",
        2,
        96,
        "NONE",
        "e1fe001e001e001e00fe0a1e091e081e07ff061e061e061e06ff061e061e061e06ff0a02ff0202ff070a02ff070a02007687\
    566778a9866589689801690000",
    ),
];

/// A document of the compressed sheet, edited.
fn packed_sheet(edit: impl FnOnce(&mut Value)) -> Vec<u8> {
    let (mut binary, mut views, mut plain) = (Vec::new(), Vec::new(), 0);
    for (mode, stride, count, filter, hex) in PACKED {
        let start = binary.len();
        binary.extend((0..hex.len()).step_by(2).map(|i| u8::from_str_radix(&hex[i..i + 2], 16).unwrap()));
        let packed = json!({"buffer": 0, "byteOffset": start, "byteLength": binary.len() - start, "byteStride": stride,
            "count": count, "mode": mode, "filter": filter});
        views.push(json!({"buffer": 1, "byteOffset": plain, "byteLength": stride * count,
            "extensions": {"EXT_meshopt_compression": packed}}));
        plain += stride * count;
        binary.resize(binary.len().next_multiple_of(4), 0);
    }
    (views[0]["byteStride"], views[1]["byteStride"]) = (json!(12), json!(4));
    let mut json = json!({
        "asset": {"version": "2.0"},
        "extensionsUsed": ["EXT_meshopt_compression", "KHR_mesh_quantization"],
        "extensionsRequired": ["EXT_meshopt_compression", "KHR_mesh_quantization"],
        "buffers": [{"byteLength": binary.len()},
            {"byteLength": plain, "extensions": {"EXT_meshopt_compression": {"fallback": true}}}],
        "bufferViews": views,
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 25, "type": "VEC3", "min": [0, 0, 0], "max": [0.2, 0.16, 0.2]},
            {"bufferView": 1, "componentType": 5120, "count": 25, "type": "VEC3", "normalized": true},
            {"bufferView": 2, "componentType": 5123, "count": 96, "type": "SCALAR"}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2}]}],
        "nodes": [{"mesh": 0}],
        "scenes": [{"nodes": [0]}],
    });
    edit(&mut json);
    join_glb(&json, &binary)
}

#[test]
fn compressed_buffer_views_are_decoded() {
    let (asset, _) =
        read_with("packed.glb", &packed_sheet(|_| ()), &ReadOptions::default()).expect("is read");
    let piece = &asset.pieces[0];
    for (v, x) in piece.positions.iter().enumerate() {
        let (i, j) = ((v % 5) as f64, (v / 5) as f64);
        assert!((x - Vec3::new(0.05 * i, 0.01 * i * j, 0.05 * j)).norm() < 1e-6, "vertex {v}: {x}");
    }
    assert_eq!((piece.triangles.len(), piece.positions.len()), (32, 25));
    let normals = piece.normals.as_ref().expect("has normals");
    assert!(normals.iter().all(|n| (n - Vec3::y()).norm() < 1e-2));

    // What is written is not compressed, and reads back the same.
    let (garment, _) = garment_of(&asset);
    let displacement = vec![Vec3::new(0.0, 0.01, 0.0); garment.points.len()];
    let memory = RestState::flat(garment.topology.hinges.len(), garment.triangles.len());
    let worn = write_worn_glb(
        &asset,
        &garment,
        &WornGarment { displacement, memory },
        &json!({"crease": {"sidecar": "a.crease.json"}}),
    )
    .expect("writes");
    let (json, _) = split_glb(&worn).expect("is a GLB");
    assert!(!json.to_string().contains("meshopt"), "{json}");
    assert_eq!(json["extensionsRequired"], json!(["KHR_mesh_quantization"]));
    let (again, _) = read_with("worn.glb", &worn, &ReadOptions::default()).expect("reads back");
    assert_eq!(again.pieces[0].positions, piece.positions);
}

/// A file that states more than its data can hold, names what does not exist, or is damaged is refused with its place.
#[test]
fn damaged_compression_is_refused() {
    let packed = |json: &mut Value, key: &str, value: Value| {
        json["bufferViews"][0]["extensions"]["EXT_meshopt_compression"][key] = value;
    };
    type Edit<'a> = &'a dyn Fn(&mut Value);
    let cases: [(&str, Edit); 6] = [
        ("cannot be in", &|json| {
            packed(json, "count", json!(1_000_000));
            json["bufferViews"][0]["byteLength"] = json!(12_000_000);
        }),
        ("lie outside of buffers[0]", &|json| packed(json, "byteLength", json!(1_000_000))),
        ("are damaged", &|json| packed(json, "mode", json!("TRIANGLES"))),
        ("are damaged", &|json| packed(json, "filter", json!("COLOR"))),
        ("states 288 bytes", &|json| json["bufferViews"][0]["byteLength"] = json!(288)),
        ("lies outside of buffers[1]", &|json| json["buffers"][1]["byteLength"] = json!(100)),
    ];
    for (what, edit) in cases {
        let error = read_with("packed.glb", &packed_sheet(edit), &ReadOptions::default()).expect_err(what);
        let error = error.to_string();
        assert!(error.contains("bufferViews[") && error.contains(what), "{what}: {error}");
    }
    let draco = packed_sheet(|json| {
        json["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
        json["meshes"][0]["primitives"][0]["extensions"] = json!({"KHR_draco_mesh_compression": {}});
    });
    let error = read_with("draco.glb", &draco, &ReadOptions::default()).expect_err("is refused").to_string();
    assert!(
        error.contains("requires KHR_draco_mesh_compression") && error.contains("gltf-transform"),
        "{error}"
    );
}

/// Frames of an OBJ have all of its `v` lines in their order, those of other parts and of no face where they are.
#[test]
fn frames_of_an_obj_have_its_lines() {
    let obj = "v 0 0 9\nv 30 30 0\nv 0 30 0\nv 30 0 0\nv 0 0 0\nv 60 0 0\nv 60 30 0\nvt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\nvt 0.5 0.5\n\
        g shirt\nf 5/1 4/2 2/3 3/4\nf 4/5 6/2 7/3\ng hat\nf 4 7 2\n";
    let options = ReadOptions { unit_m: Some(0.01), ..named("shirt") };
    let (asset, _) = read_with("a.obj", obj.as_bytes(), &options).expect("is read");
    let (garment, _) = garment_of(&asset);
    let rows = FrameRows::of_file(&asset, &garment);
    let positions: Vec<Vec3> = rows
        .rows
        .iter()
        .map(|row| match row {
            FrameRow::Point(p) => garment.points[p.at()],
            FrameRow::Fixed(x) => *x,
        })
        .collect();
    let lines = obj.lines().filter_map(|line| line.strip_prefix("v "));
    let own: Vec<Vec3> = lines
        .map(|line| Vec3::from_iterator(line.split(' ').map(|x| 0.01 * x.parse::<f64>().unwrap())))
        .collect();
    assert_eq!(positions.len(), 7);
    assert!(positions.iter().zip(&own).all(|(a, b)| (a - b).norm() < 1e-12), "{positions:?}");
    let moving = rows.rows.iter().map(|row| matches!(row, FrameRow::Point(_))).collect::<Vec<_>>();
    assert_eq!(moving, [false, true, true, true, true, true, true]);
    let vertices: Vec<Vec3> = asset.pieces[0].positions.clone();
    for (v, row) in rows.row_of_vertex.iter().take(vertices.len()).enumerate() {
        assert!((0.01 * vertices[v] - own[*row as usize]).norm() < 1e-12, "vertex {v} is line {row}");
    }
}
