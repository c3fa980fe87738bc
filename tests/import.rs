//! Reading mesh files through the public interface: foreign files, each with a defined outcome; two other parsers as
//! oracles; damaged bytes.

#[path = "reference/external.rs"]
mod external;

use crease_io::gltf::join_glb;
use crease_io::{ReadOptions, read_asset};
use crease_model::garment::{Garment, ImportDiagnostic, Inspection, SourceAsset, inspect};
use external::external;
use serde_json::json;
use std::path::{Path, PathBuf};
use test_attributes::needs_data;

fn mesh_files(folder: &Path) -> Vec<PathBuf> {
    let mut files: Vec<PathBuf> =
        std::fs::read_dir(folder).unwrap().map(|entry| entry.unwrap().path()).collect();
    files.retain(|path| {
        path.extension()
            .is_some_and(|extension| ["obj", "glb", "gltf"].iter().any(|known| extension == *known))
    });
    files.sort();
    files
}

fn read(path: &Path, options: &ReadOptions) -> crease::Result<(SourceAsset, Vec<ImportDiagnostic>)> {
    let bytes = std::fs::read(path).unwrap();
    let name = path.file_name().unwrap().to_string_lossy().into_owned();
    read_asset(&name, &bytes, options, &mut |uri| {
        std::fs::read(path.with_file_name(uri))
            .map_err(|source| crease::Error::File { file: uri.to_owned(), source })
    })
}

fn import(path: &Path, options: &ReadOptions) -> crease::Result<(Garment, Inspection)> {
    let (asset, mut diagnostics) = read(path, options)?;
    let (garment, more) = Garment::from_asset(&asset)?;
    diagnostics.extend(more);
    let inspection = inspect(&asset, &garment, &diagnostics);
    Ok((garment, inspection))
}

fn in_unit(unit_m: f64) -> ReadOptions {
    ReadOptions { unit_m: Some(unit_m), any_size: true, ..ReadOptions::default() }
}

/// Expected outcome of a file.
enum Outcome {
    /// Accepted, with vertices, points and triangles, in its own unit.
    Imported(usize, usize, usize),
    /// Accepted only if the unit is given.
    Sized(usize, usize, usize),
    /// Rejected with a message that contains this.
    Refused(&'static str),
}

#[needs_data("garments")]
#[test]
fn every_odd_file_has_a_decided_outcome() {
    use Outcome::{Imported, Refused, Sized};
    let root = external("garments");
    let table = [
        ("cornell_box.obj", Sized(72, 28, 36)),
        ("cube-vertex-w-component.obj", Imported(24, 8, 12)),
        ("cube-vertexcol.obj", Imported(24, 8, 12)),
        ("invalid-face-definition.obj", Refused("2 faces of fewer than 3 corners dropped")),
        ("invalid-relative-texture-index.obj", Refused("line 2: corner \"1/-2\"")),
        ("invalid-relative-vertex-index.obj", Refused("line 1: corner \"-4\": relative vertex index")),
        ("issue-140-zero-face-idx.obj", Refused("line 17: corner \"1/1/0\" has normal index 0")),
        ("issue-161-inconsistent-f.obj", Imported(22, 8, 12)),
        ("issue-235-usemtl-then-o.obj", Imported(6, 6, 2)),
        ("issue-246-usemtl-whitespace.obj", Imported(3, 3, 1)),
        ("issue-295-trianguation-failure.obj", Imported(44, 16, 28)),
        ("issue-319-002.obj", Sized(20, 19, 13)),
        ("issue-319-003.obj", Sized(10, 10, 8)),
        ("issue-356-leading-spaces-newmtl.obj", Refused("no triangles")),
        ("leading-decimal-dot-issue-201.obj", Sized(3, 3, 1)),
        ("leading-zero-in-exponent-notation-issue-210.obj", Sized(3, 3, 1)),
        ("line-prim.obj", Refused("2 \"l\" statements skipped")),
        ("missing_material_file.obj", Sized(72, 28, 36)),
        ("mtl filename with whitespace issue46.obj", Imported(24, 8, 12)),
        ("points-prim.obj", Refused("1 \"p\" statements skipped")),
        ("skin-weight.obj", Imported(24, 8, 12)),
        (
            "smoothing-group-two-squares.obj",
            Refused("line 21: index 1 is out of range: the file has 0 normals"),
        ),
        ("test-nan.obj", Refused("line 15: a coordinate is not a finite number")),
        ("texture-filename-with-whitespace.obj", Imported(24, 8, 12)),
        ("usemtl-issue-104.obj", Sized(12, 12, 6)),
        ("AnimatedMorphCube.glb", Imported(24, 8, 12)),
        ("BoxInterleaved.glb", Imported(24, 8, 12)),
        ("BoxMeshopt.glb", Imported(24, 8, 12)),
        ("Box_Draco.glb", Refused("KHR_draco_mesh_compression")),
        ("RiggedFigure.glb", Imported(370, 130, 256)),
        ("SimpleSkin.gltf", Imported(10, 10, 8)),
        ("SimpleSparseAccessor.gltf", Sized(14, 14, 12)),
    ];
    let mut files = mesh_files(&root.join("obj-oddities-tinyobj"));
    files.extend(mesh_files(&root.join("khronos-small")));
    assert_eq!(files.len(), table.len(), "every file is in the table");
    for path in files {
        let name = path.file_name().unwrap().to_str().unwrap();
        let (_, outcome) =
            table.iter().find(|(known, _)| *known == name).unwrap_or_else(|| panic!("{name}: undecided"));
        let counts = |result: crease::Result<(Garment, Inspection)>| {
            let (_, seen) = result.unwrap_or_else(|error| panic!("{name}: {error}"));
            (seen.vertices, seen.points, seen.triangles)
        };
        let refusal =
            |options: &ReadOptions| import(&path, options).err().map_or(String::new(), |e| e.to_string());
        match *outcome {
            Imported(vertices, points, triangles) => {
                assert_eq!(
                    counts(import(&path, &ReadOptions::default())),
                    (vertices, points, triangles),
                    "{name}"
                );
            }
            Sized(vertices, points, triangles) => {
                let message = refusal(&ReadOptions::default());
                assert!(message.contains("ReadOptions::unit_m cm, mm, dm, in"), "{name}: {message}");
                assert_eq!(counts(import(&path, &in_unit(0.01))), (vertices, points, triangles), "{name}");
            }
            Refused(what) => {
                let message = refusal(&in_unit(1.0));
                assert!(message.starts_with(name) && message.contains(what), "{name}: {message}");
            }
        }
    }
}

/// Relations of counts: edges = hinges + openings, and the Euler characteristic of a T-shirt.
#[needs_data("garments")]
#[test]
fn real_garments_come_in_whole() {
    let root = external("garments");
    // file, unit, vertices, points, triangles, openings, widest opening [m], box's largest side [m]
    let table = [
        ("diffavatar-tshirt/tshirt.obj", 0.01, 2929, 2799, 5483, 4, 1.015, 0.766),
        ("diffavatar-tshirt/shirt_initial.obj", 0.01, 3891, 3717, 7326, 4, 1.052, 0.895),
        ("diffcloth-tshirt-folds/tshirt1900-flattened.obj", 0.065, 1921, 1921, 3726, 4, 0.844, 0.546),
        ("diffcloth-tshirt-folds/tshirt1900.obj", 0.065, 8177, 1921, 3726, 4, 1.202, 0.740),
        (
            "makehuman-body-sweater/derived/male_casualsuit02_fitted.obj",
            0.1,
            2349,
            2136,
            4120,
            7,
            1.091,
            1.340,
        ),
        ("smpl-average-body/f_smpl_average_A40.obj", 1.0, 7576, 6890, 13776, 0, 0.0, 1.658),
    ];
    for (name, unit_m, vertices, points, triangles, openings, widest, side) in table {
        let (garment, seen) = import(&root.join(name), &in_unit(unit_m)).unwrap();
        assert_eq!((seen.vertices, seen.points, seen.triangles), (vertices, points, triangles), "{name}");
        assert_eq!(seen.boundary_loops_m.len(), openings, "{name}");
        assert!(
            (seen.boundary_loops_m.first().unwrap_or(&0.0) - widest).abs() < 2e-3,
            "{name}: {:?}",
            seen.boundary_loops_m
        );
        assert!((seen.box_m.into_iter().fold(0.0, f64::max) - side).abs() < 1e-3, "{name}: {:?}", seen.box_m);
        assert_eq!(
            (seen.non_manifold_edges, seen.misoriented_edges, seen.repaired.len()),
            (0, 0, 0),
            "{name}"
        );
        let characteristic = points as i64 - garment.topology.edges.len() as i64 + triangles as i64;
        let spheres = 2 * seen.parts.len() as i64 - openings as i64;
        assert_eq!(characteristic, spheres, "{name}: every part is a sphere with holes");
        for (t, flat) in garment.triangles.iter().zip(&garment.material) {
            for k in 0..3 {
                let length = (garment.points[t[(k + 1) % 3].at()] - garment.points[t[k].at()]).norm();
                let laid = (flat[(k + 1) % 3] - flat[k]).norm();
                assert!((length - laid).abs() < 1e-9, "{name}: laid flat at true size");
            }
            assert!((flat[1] - flat[0]).perp(&(flat[2] - flat[0])) > 0.0, "{name}");
        }
    }
}

#[needs_data("garments")]
#[test]
fn warp_follows_texture_only_where_it_follows_the_panels() {
    let root = external("garments");
    for (name, unit_m, from_uv) in [
        ("diffavatar-tshirt/tshirt.obj", 0.01, true),
        ("diffcloth-tshirt-folds/tshirt1900.obj", 0.065, false),
        ("diffcloth-tshirt-folds/tshirt1900-flattened.obj", 0.065, false),
    ] {
        assert_eq!(import(&root.join(name), &in_unit(unit_m)).unwrap().0.material_from_uv, from_uv, "{name}");
    }
}

#[needs_data("garments")]
#[test]
fn a_garment_is_chosen_beside_its_body() {
    let root = external("garments");
    let path = root.join("makehuman-body-sweater/derived/mh_sweater_left_elbow.glb");
    let (all, _) = read(&path, &ReadOptions::default()).unwrap();
    let names: Vec<&str> = all.pieces.iter().map(|piece| piece.name.as_str()).collect();
    assert_eq!(names, ["body", "male_casualsuit02"]);
    assert!(all.pieces.iter().all(|piece| piece.worn), "everything, unless chosen");
    let options = ReadOptions { garment: Some("male_casualsuit02".into()), ..ReadOptions::default() };
    let (_, seen) = import(&path, &options).unwrap();
    assert_eq!((seen.vertices, seen.points, seen.triangles), (2314, 2136, 4120));
    assert_eq!(seen.pieces.iter().map(|piece| piece.worn).collect::<Vec<_>>(), [false, true]);
    assert!(
        seen.to_text().contains(
            "\"body\": 14517 vertices, 26756 triangles, material \"body_mat\", UV, skinned, not worn"
        )
    );
    let options = ReadOptions { garment: Some("sweater".into()), ..ReadOptions::default() };
    let message = import(&path, &options).unwrap_err().to_string();
    assert!(message.contains("one of: body") && message.contains("male_casualsuit02"), "{message}");
    // In bind pose the skin must put the sweater where the unskinned file has it: decimetres there, metres here.
    let (plain, _) =
        import(&root.join("makehuman-body-sweater/derived/male_casualsuit02_fitted.obj"), &in_unit(0.1))
            .unwrap();
    let (skinned, _) =
        import(&path, &ReadOptions { garment: Some("male_casualsuit02".into()), ..ReadOptions::default() })
            .unwrap();
    let centre = |garment: &Garment| {
        garment.points.iter().sum::<nalgebra::Vector3<f64>>() / garment.points.len() as f64
    };
    assert!((centre(&plain) - centre(&skinned)).norm() < 0.05, "{} {}", centre(&plain), centre(&skinned));
}

/// Every face as obj-rs reads it, against our triangles: the corners of each face, orientation and area.
#[needs_data("garments")]
#[test]
fn obj_agrees_with_obj_rs_where_that_can_read() {
    let root = external("garments");
    let folders = [
        "obj-oddities-tinyobj",
        "diffavatar-tshirt",
        "diffcloth-tshirt-folds",
        "makehuman-body-sweater",
        "makehuman-body-sweater/derived",
        "smpl-average-body",
    ];
    let mut compared = 0;
    for path in folders.iter().flat_map(|folder| mesh_files(&root.join(folder))) {
        let bytes = std::fs::read(&path).unwrap();
        // The oracle panics on some keywords.
        let theirs = std::panic::catch_unwind(|| obj::raw::parse_obj(&bytes[..]).ok()).ok().flatten();
        // Its groups alternate, so that its faces are not in the order of the pieces; body_only.obj is a part of it.
        if path.ends_with("base.obj") {
            continue;
        }
        let (Some(theirs), Ok((ours, _))) = (theirs, read(&path, &in_unit(1.0))) else { continue };
        compare_faces(&path.display().to_string(), &theirs, &ours);
        compared += 1;
    }
    assert!(compared >= 15, "only {compared} files could be compared");
}

fn compare_faces(name: &str, theirs: &obj::raw::RawObj, ours: &SourceAsset) {
    use nalgebra::Vector3;
    let position = |index: usize| {
        let (x, y, z, _) = theirs.positions[index];
        Vector3::new(f64::from(x), f64::from(y), f64::from(z))
    };
    let mut triangles = ours
        .pieces
        .iter()
        .flat_map(|piece| piece.triangles.iter().map(|t| t.map(|v| piece.positions[v as usize])));
    for polygon in &theirs.polygons {
        use obj::raw::object::Polygon;
        let corners: Vec<Vector3<f64>> = match polygon {
            Polygon::P(corners) => corners.iter().map(|&p| position(p)).collect(),
            Polygon::PT(corners) => corners.iter().map(|&(p, _)| position(p)).collect(),
            Polygon::PN(corners) => corners.iter().map(|&(p, _)| position(p)).collect(),
            Polygon::PTN(corners) => corners.iter().map(|&(p, ..)| position(p)).collect(),
        };
        if corners.len() < 3 {
            continue;
        }
        let area = |points: &[Vector3<f64>]| -> Vector3<f64> {
            (1..points.len() - 1)
                .map(|k| 0.5 * (points[k] - points[0]).cross(&(points[k + 1] - points[0])))
                .sum()
        };
        let cut: Vec<[Vector3<f64>; 3]> = triangles.by_ref().take(corners.len() - 2).collect();
        assert_eq!(cut.len(), corners.len() - 2, "{name}");
        // The oracle keeps single precision only.
        let size = corners.iter().map(|p| p.norm()).fold(1e-3, f64::max);
        for corner in cut.iter().flatten() {
            assert!(
                corners.iter().any(|p| (p - corner).norm() < 1e-6 * size),
                "{name}: a corner of the face"
            );
        }
        let ours: Vector3<f64> = cut.iter().map(|t| area(t)).sum();
        assert!((ours - area(&corners)).norm() < 1e-5 * size * size, "{name}: {ours} {}", area(&corners));
    }
    assert_eq!(triangles.count(), 0, "{name}: no triangle more");
}

/// Positions, normals, texture coordinates and corners of every primitive, against the gltf crate.
#[needs_data("garments")]
#[test]
fn gltf_agrees_with_the_gltf_crate_where_that_can_read() {
    let root = external("garments");
    let folders = ["khronos-small", "makehuman-body-sweater/derived"];
    let mut compared = 0;
    for path in folders.iter().flat_map(|folder| mesh_files(&root.join(folder))) {
        if path.extension().is_some_and(|extension| extension == "obj") {
            continue;
        }
        let Ok((ours, _)) = read(&path, &in_unit(1.0)) else { continue };
        let Ok(theirs) = gltf::Gltf::from_slice(&std::fs::read(&path).unwrap()) else { continue };
        let buffers = &ours.document.as_ref().unwrap().buffers;
        for piece in &ours.pieces {
            let mesh = theirs.meshes().nth(piece.mesh).unwrap();
            let primitive = mesh.primitives().nth(piece.primitive).unwrap();
            let reader = primitive.reader(|buffer| buffers.get(buffer.index()).map(Vec::as_slice));
            let same = |what: &str, theirs: Vec<f32>, ours: Vec<f64>| {
                assert_eq!(theirs.len(), ours.len(), "{what} of {}", path.display());
                for (a, b) in theirs.iter().zip(&ours) {
                    assert!(
                        (f64::from(*a) - b).abs() < 1e-6 * b.abs().max(1.0),
                        "{what} of {}: {a} {b}",
                        path.display()
                    );
                }
            };
            let flat3 = |list: &[nalgebra::Vector3<f64>]| list.iter().flat_map(|p| [p.x, p.y, p.z]).collect();
            same("positions", reader.read_positions().unwrap().flatten().collect(), flat3(&piece.positions));
            let normals = reader.read_normals().map(|list| list.flatten().collect()).unwrap_or_default();
            same("normals", normals, piece.normals.as_deref().map(flat3).unwrap_or_default());
            let uvs =
                reader.read_tex_coords(0).map(|list| list.into_f32().flatten().collect()).unwrap_or_default();
            let own = piece.uvs.as_deref().unwrap_or(&[]).iter().flat_map(|uv| [uv.x, uv.y]).collect();
            same("texture coordinates", uvs, own);
            let corners: Vec<u32> = reader.read_indices().unwrap().into_u32().collect();
            assert_eq!(corners, piece.triangles.as_flattened(), "{}", path.display());
        }
        compared += 1;
    }
    assert!(compared >= 5, "only {compared} files could be compared");
}

/// A small OBJ with most features of the format.
const SMALL_OBJ: &str = "\u{feff}mtllib a b.mtl\r\no Cloth\r\nv 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 1 1 0 0 0 1\nv 0 1 .5e0 1 1 1\nv 0.5 1.5 0\n\
vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\nusemtl red\ng front a\ns 1\nf 1/1/1 2/2/1 \\\n 3/3/1\nf -5//1 -3//1 -2//1\n\
usemtl blue\nf 1 2 3 5 4 # five\nl 1 2\np 3\nf 4 5\ncurv 0 1 2\n";

/// A skinned, sparse, quantised sheet with two primitives, as a GLB.
fn small_glb() -> Vec<u8> {
    let mut binary: Vec<u8> = Vec::new();
    let floats = |list: &[f32]| list.iter().flat_map(|x| x.to_le_bytes()).collect::<Vec<u8>>();
    binary.extend(floats(&[0., 0., 0., 1., 0., 0., 0., 1., 0., 1., 1., 0.])); // 0: 48 bytes of positions
    binary.extend([0u16, 1, 2, 2, 1, 3].iter().flat_map(|x| x.to_le_bytes())); // 48: 12 bytes of corners
    binary.extend([0, 0, 255, 0, 0, 255, 255, 255]); // 60: 8 bytes of texture coordinates
    binary.extend([0, 1, 0, 0].repeat(4)); // 68: 16 bytes of joints
    binary.extend([128, 127, 0, 0].repeat(4)); // 84: 16 bytes of weights
    binary.extend([3, 0, 0, 0]); // 100: sparse index
    binary.extend(floats(&[1.0, 1.0, 0.25])); // 104: sparse value
    binary.extend(floats(nalgebra::Matrix4::<f32>::identity().as_slice()).repeat(2)); // 116: 128 bytes of matrices
    let document = json!({
        "asset": {"version": "2.0"}, "scene": 0, "scenes": [{"nodes": [0, 2]}],
        "nodes": [
            {"name": "root", "children": [1, 3], "rotation": [0.0, 0.6, 0.0, 0.8]},
            {"name": "joint", "translation": [0.0, 0.1, 0.0]},
            {"name": "sheet", "mesh": 0, "skin": 0},
            {"name": "again", "mesh": 1, "scale": [1.0, 1.0, 2.0]}
        ],
        "skins": [{"joints": [0, 1], "inverseBindMatrices": 5}],
        "meshes": [
            {"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 2, "JOINTS_0": 3, "WEIGHTS_0": 4}, "indices": 1}]},
            {"primitives": [{"attributes": {"POSITION": 0}, "mode": 5}], "weights": [0.5]}
        ],
        "buffers": [{"byteLength": 244}],
        "bufferViews": [
            {"buffer": 0, "byteLength": 48}, {"buffer": 0, "byteOffset": 48, "byteLength": 12},
            {"buffer": 0, "byteOffset": 60, "byteLength": 8, "byteStride": 2},
            {"buffer": 0, "byteOffset": 68, "byteLength": 16}, {"buffer": 0, "byteOffset": 84, "byteLength": 16},
            {"buffer": 0, "byteOffset": 100, "byteLength": 4}, {"buffer": 0, "byteOffset": 104, "byteLength": 12},
            {"buffer": 0, "byteOffset": 116, "byteLength": 128}
        ],
        "accessors": [
            {"bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "sparse": {"count": 1,
                "indices": {"bufferView": 5, "componentType": 5121}, "values": {"bufferView": 6}}},
            {"bufferView": 1, "componentType": 5123, "count": 6, "type": "SCALAR"},
            {"bufferView": 2, "componentType": 5121, "normalized": true, "count": 4, "type": "VEC2"},
            {"bufferView": 3, "componentType": 5121, "count": 4, "type": "VEC4"},
            {"bufferView": 4, "componentType": 5121, "normalized": true, "count": 4, "type": "VEC4"},
            {"bufferView": 7, "componentType": 5126, "count": 2, "type": "MAT4"}
        ]
    });
    join_glb(&document, &binary)
}

/// The same sheet as text with its bytes inside.
fn small_gltf() -> Vec<u8> {
    let text = r#"{"asset":{"version":"2.0"},"nodes":[{"mesh":0}],"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],
"buffers":[{"byteLength":36,"uri":"data:application/octet-stream;base64,AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAA"}],
"bufferViews":[{"buffer":0,"byteLength":36}],"accessors":[{"bufferView":0,"componentType":5126,"count":3,"type":"VEC3"}]}"#;
    text.as_bytes().to_vec()
}

/// Reads, builds, inspects; only a panic is an error. Returns whether the file was accepted.
fn survive(name: &str, bytes: &[u8]) -> bool {
    let options = ReadOptions { unit_m: Some(1.0), any_size: true, mask: None, ..ReadOptions::default() };
    let read =
        read_asset(name, bytes, &options, &mut |uri| Err(crease::Error::input(uri, "", "not there", "")));
    let Ok((asset, diagnostics)) = read else { return false };
    let Ok((garment, _)) = Garment::from_asset(&asset) else { return false };
    assert!(garment.points.iter().all(|p| p.iter().all(|x| x.is_finite())));
    assert!(garment.material.iter().flatten().all(|p| p.x.is_finite() && p.y.is_finite()));
    assert!(!inspect(&asset, &garment, &diagnostics).to_text().is_empty());
    true
}

#[test]
fn damaged_bytes_are_refused_not_fatal() {
    let samples =
        [("a.obj", SMALL_OBJ.as_bytes().to_vec()), ("a.glb", small_glb()), ("a.gltf", small_gltf())];
    // A fixed linear congruential sequence (Knuth's MMIX constants): the same damage on every run.
    let mut state = 2_026_u64;
    let mut random = move |below: usize| {
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    for (name, bytes) in &samples {
        assert!(survive(name, bytes), "{name} is sound before the damage");
        for cut in 0..64 {
            survive(name, &bytes[..bytes.len() * cut / 64]);
        }
        for _ in 0..4000 {
            let mut damaged = bytes.clone();
            for _ in 0..=random(4) {
                let at = random(damaged.len());
                damaged[at] ^= 1 << random(8);
            }
            survive(name, &damaged);
        }
        // A digit of the document replaced by another: still JSON, but other counts and indices.
        let digits: Vec<usize> = (0..bytes.len()).filter(|&at| bytes[at].is_ascii_digit()).collect();
        for _ in 0..4000 {
            let mut damaged = bytes.clone();
            for _ in 0..=random(2) {
                damaged[digits[random(digits.len())]] = b'0' + random(10) as u8;
            }
            survive(name, &damaged);
        }
    }
}

#[test]
fn foreign_formats_are_named() {
    for name in ["dress.fbx", "dress.STL", "dress.usdz"] {
        let error =
            read_asset(name, b"anything", &ReadOptions::default(), &mut |_| Ok(Vec::new())).unwrap_err();
        assert!(error.to_string().contains("export it as glTF"), "{error}");
    }
    for bytes in [&b""[..], b"glTF", b"{}", b"{\"asset\":{\"version\":\"2.0\"}}", b"\xFF\xFEv\0", b"[]"] {
        assert!(read_asset("x.gltf", bytes, &ReadOptions::default(), &mut |_| Ok(Vec::new())).is_err());
        assert!(read_asset("x", bytes, &ReadOptions::default(), &mut |_| Ok(Vec::new())).is_err());
    }
}
