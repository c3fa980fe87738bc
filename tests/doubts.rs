//! Files that hold something else than one plain garment, and runs that do nothing: set right, or told with the option that
//! helps.

#[path = "common/glb.rs"]
mod glb;
#[path = "common/tool.rs"]
mod tool;

use crease::{GarmentFile, Vec3};
use crease_io::gltf::{DetailOutput, keep_worn_pieces};
use crease_io::{ReadOptions, read_asset};
use crease_model::error::Message;
use crease_model::garment::{RestState, RigidParts, WornGarment, content_warnings};
use glb::{Part, detail_map, glb as file};
use serde_json::{Value, json};
use tool::crease_in;

fn parse(nodes: &[(&str, Vec<Part>)]) -> GarmentFile {
    GarmentFile::parse("a.glb", &file(nodes, |_| {}), &ReadOptions::default()).expect("is a garment")
}

fn heights(file: &GarmentFile, vertices: std::ops::Range<usize>) -> Vec<f64> {
    let point = |v: usize| file.garment.points[file.garment.source_point[v].at()];
    // Micrometres are whole numbers for every position that a single-precision file can hold.
    vertices.map(|v| (1e6 * point(v).z).round()).collect()
}

fn count_of(heights: &[f64], height: f64) -> usize {
    heights.iter().filter(|z| **z == height).count()
}

#[test]
fn front_and_back_laid_flat_go_to_their_own_sides() {
    let front = Part::sheet(6, 0.4, [0.0; 3]);
    let back = front.clone().reversed().textured(|[u, v]| [u + 1.0, v]);
    let tee = parse(&[("tee", vec![front, back])]);
    let (front, back) = (heights(&tee, 0..49), heights(&tee, 49..98));
    assert_eq!((count_of(&front, 150.0), count_of(&front, 0.0)), (25, 24), "{front:?}");
    assert_eq!((count_of(&back, -150.0), count_of(&back, 0.0)), (25, 24), "{back:?}");
    assert!(tee.repairs().iter().any(|told| told.contains("lie in one place")), "{:?}", tee.repairs());
    // Half of the triangles of the back coincide with some of the front, texture and all: it still is a layer.
    let mut other = Part::sheet(6, 0.4, [0.0; 3]).reversed();
    other.triangles.chunks_mut(2).for_each(|pair| {
        let all = [pair[0], pair[1]].concat();
        let mut corners: Vec<u32> = all.clone();
        corners.sort_unstable();
        corners.dedup();
        let [a, b, d, c] = corners[..] else { panic!("a square has four corners") };
        pair.copy_from_slice(&[[a, c, b], [a, d, c]]);
    });
    let front = Part::sheet(6, 0.4, [0.0; 3]);
    let tee = parse(&[("tee", vec![front.clone(), other])]);
    assert_eq!(tee.garment.points.len(), 2 * 49 - 24);
    assert_eq!(count_of(&heights(&tee, 49..98), -150.0), 25);
    // All of them do: the other side of one sheet.
    let sheet = parse(&[("sheet", vec![front.clone(), front.reversed()])]);
    assert_eq!(sheet.garment.points.len(), 49);
    assert!(sheet.repairs().iter().any(|told| told.contains("copies of triangles")), "{:?}", sheet.repairs());
}

/// Both sides of `part` in one primitive, each on an island of its own in the texture.
fn double_sided(part: &Part) -> Part {
    let mut both = part.clone().textured(|[u, v]| [0.5 * u, v]);
    let other = part.clone().reversed().textured(|[u, v]| [0.5 + 0.5 * u, v]);
    let first = both.positions.len() as u32;
    both.positions.extend(other.positions);
    both.uvs.extend(other.uvs);
    both.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
    both
}

/// Cloth of games, flat and in waves: both sides are one cloth.
#[test]
fn double_sided_cloth_is_worn_once() {
    let flat = Part::sheet(6, 0.4, [0.0; 3]);
    let wavy = flat.clone().moved(|[x, y, _]| [x, y, 0.03 * (20.0 * x).sin()]);
    for part in [flat, wavy] {
        let cape = parse(&[("cape", vec![double_sided(&part)])]);
        assert_eq!((cape.garment.points.len(), cape.garment.triangles.len()), (49, 72));
        let told = cape.repairs();
        assert!(told.iter().any(|told| told.contains("72 triangles of the other side")), "{told:?}");
    }
}

/// One pocket, and two, 3 mm off the panel and open above: their borders lie on inner edges of the panel.
#[test]
fn pockets_are_sewn_onto_the_inside_of_a_panel() {
    let pocket = |x: f64| {
        let inside = move |[px, py, _]: [f64; 3]| {
            let on_seam = (px - x).abs() > 0.09 || py < -0.09;
            [px, py, if on_seam { 0.0 } else { 0.003 }]
        };
        Part::sheet(4, 0.2, [x, 0.0, 0.0]).moved(inside)
    };
    let panel = Part::sheet(16, 0.8, [0.0; 3]);
    let points = |pockets: &[f64]| {
        let parts = std::iter::once(panel.clone()).chain(pockets.iter().map(|x| pocket(*x))).collect();
        parse(&[("front", parts)]).garment.points.len()
    };
    // 3 sides of 4 edges are sewn: 13 of the 25 points.
    assert_eq!(points(&[]), 289);
    assert_eq!([points(&[-0.2]), points(&[-0.2, 0.2])], [289 + 12, 289 + 24]);
}

#[test]
fn linings_and_patches_in_the_plane_of_the_shell_are_set_apart() {
    let shell = Part::sheet(6, 0.4, [0.0; 3]);
    let lined = parse(&[("shell", vec![shell.clone()]), ("lining", vec![Part::sheet(5, 0.4, [0.0; 3])])]);
    // All but the corners, where both have their borders: these are sewn.
    assert_eq!(count_of(&heights(&lined, 0..49), 150.0), 45);
    assert_eq!(count_of(&heights(&lined, 49..85), -150.0), 32);
    // A patch that lies within one triangle of the shell: only the patch can move.
    let coarse = Part::sheet(1, 0.4, [0.0; 3]);
    let patched = parse(&[("shell", vec![coarse]), ("patch", vec![Part::sheet(2, 0.05, [0.1, -0.1, 0.0])])]);
    assert_eq!(count_of(&heights(&patched, 0..4), 0.0), 4);
    assert_eq!(count_of(&heights(&patched, 4..13), -150.0), 9);
}

#[test]
fn panels_side_by_side_stay_and_their_open_seam_is_told() {
    let beside = |cells, gap: f64| Part::sheet(cells, 0.4, [0.4 + gap, 0.0, 0.0]);
    for (cells, gap) in [(6, 3e-4), (5, 0.0)] {
        let panels = parse(&[("panels", vec![Part::sheet(6, 0.4, [0.0; 3]), beside(cells, gap)])]);
        assert_eq!(count_of(&heights(&panels, 0..49), 0.0), 49);
        let told = panels.content_warnings();
        assert!(
            told.iter()
                .any(|told| told.contains("0.40 m of borders") && told.contains("ReadOptions::weld_m (")),
            "{told:?}"
        );
    }
    let bytes = file(&[("panels", vec![Part::sheet(6, 0.4, [0.0; 3]), beside(6, 3e-4)])], |_| {});
    let options = ReadOptions { weld_m: Some(4e-4), ..ReadOptions::default() };
    let sewn = GarmentFile::parse("a.glb", &bytes, &options).expect("is a garment");
    assert_eq!(sewn.garment.points.len(), 2 * 49 - 7);
    assert!(sewn.content_warnings().is_empty(), "{:?}", sewn.content_warnings());
}

/// A strip sewn onto the middle of a panel: its border has the positions of the panel's inner vertices.
#[test]
fn a_seam_that_an_obj_closes_itself_stays_closed() {
    let mut text = String::new();
    for k in 0..15 {
        text += &format!("v {} {} 0\n", 0.1 * f64::from(k % 5), 0.1 * f64::from(k / 5));
    }
    for k in 0..5 {
        text += &format!("v {} 0.1 0.1\n", 0.1 * f64::from(k));
    }
    text += "vt 0 0\nvt 1 1\ng panel\n";
    for k in (0..10).filter(|k| k % 5 < 4) {
        let (a, b) = (k + 1, k + 6);
        text += &format!("f {a}/1 {}/1 {}/1 {b}/1\n", a + 1, b + 1);
    }
    text += "g collar\n";
    for k in 6..10 {
        text += &format!("f {k}/2 {}/2 {}/2 {}/2\n", k + 1, k + 11, k + 10);
    }
    let sewn = GarmentFile::parse("a.obj", text.as_bytes(), &ReadOptions::default()).expect("is a garment");
    assert_eq!(sewn.garment.points.len(), 20, "the row of the seam once");
    assert!(sewn.garment.triangle_part.iter().all(|part| *part == 0));
    // With positions of its own the collar only touches the panel.
    let apart = text.replace("vt 0 0\n", "v 0 .1 0\nv .1 .1 0\nv .2 .1 0\nv .3 .1 0\nv .4 .1 0\nvt 0 0\n");
    let apart = (6..=10).fold(apart, |text, k| {
        let (head, tail) = text.split_once("g collar\n").expect("is there");
        format!("{head}g collar\n{}", tail.replace(&format!(" {k}/2"), &format!(" {}/2", k + 15)))
    });
    let apart = GarmentFile::parse("a.obj", apart.as_bytes(), &ReadOptions::default()).expect("is a garment");
    // Joined at the ends of the row, which are on borders of both, only.
    assert_eq!(apart.garment.points.len(), 23);
}

#[test]
fn trims_follow_the_cloth_that_carries_them() {
    let button = |x: f64| Part::can(10, 0.006, 0.002, [x, 0.05, 0.0]).moved(|[x, y, z]| [x, y, z + 0.008]);
    let shirt = parse(&[("shirt", vec![Part::sheet(20, 0.4, [0.0; 3])]), ("button", vec![button(0.1)])]);
    let rigid = RigidParts::find(&shirt.garment).expect("has a button");
    assert_eq!(rigid.cloth().points.len(), 441);
    assert!(rigid.notes()[0].starts_with("1 small solids of 22 points"), "{}", rigid.notes()[0]);
    // The half x > 0 is turned up by a right angle about the line x = 0.
    let turned = |p: &Vec3| if p.x > 0.0 { Vec3::new(-p.z, p.y, p.x) } else { *p };
    let cloth: Vec<Vec3> = rigid.cloth().points.iter().map(turned).collect();
    let all = rigid.positions(&cloth);
    for (now, before) in all.iter().zip(&shirt.garment.points) {
        assert!((now - turned(before)).norm() < 1e-9, "{before} {now}");
    }
    // Its memory is that of the cloth, and nothing on the button.
    let (hinges, triangles) = (rigid.cloth().topology.hinges.len(), rigid.cloth().triangles.len());
    let memory = RestState { rest_angle: vec![1.0; hinges], ..RestState::flat(hinges, triangles) };
    let displacement = vec![Vec3::zeros(); rigid.cloth().points.len()];
    let worn = rigid.worn(&WornGarment { displacement, memory: memory.clone() });
    assert_eq!(worn.memory.rest_angle.iter().filter(|angle| **angle == 1.0).count(), hinges);
    assert_eq!(rigid.cloth_memory(&worn.memory).rest_angle, memory.rest_angle);
    // A buckle on the back, too; a ball far from any cloth is no trim, nor is a solid without cloth.
    let buckle = Part::can(6, 0.02, 0.004, [0.0, 0.0, -0.021]);
    let shirt = parse(&[("shirt", vec![Part::sheet(20, 0.4, [0.0; 3])]), ("buckle", vec![buckle])]);
    assert!(RigidParts::find(&shirt.garment).is_some());
    let far = parse(&[("shirt", vec![Part::sheet(4, 0.4, [0.0; 3])]), ("ball", vec![button(0.9)])]);
    assert!(RigidParts::find(&far.garment).is_none());
    let bytes = file(&[("a", vec![Part::can(8, 0.02, 0.03, [0.0; 3])])], |_| {});
    let options = ReadOptions { unit_m: Some(1.0), any_size: true, ..ReadOptions::default() };
    let alone = GarmentFile::parse("a.glb", &bytes, &options).expect("is a garment");
    assert!(RigidParts::find(&alone.garment).is_none());
}

#[test]
fn other_things_in_the_file_are_told_with_the_setting_that_chooses() {
    let told = |nodes: &[(&str, Vec<Part>)]| {
        let file = parse(nodes);
        Message::join(content_warnings(&file.asset, &file.garment), "\n")
    };
    let shirt = || vec![Part::sheet(6, 0.4, [0.0, 0.0, 0.2])];
    let avatar = told(&[("Cloth", shirt()), ("Avatar", vec![Part::can(20, 0.1, 1.6, [0.0; 3])])]);
    assert!(
        avatar.contains("\"Avatar\" looks like a body")
            && avatar.contains("ReadOptions::garment (\"Cloth\")"),
        "{avatar}"
    );
    let levels = told(&[("shirt_LOD0", shirt()), ("shirt_LOD1", vec![Part::sheet(3, 0.4, [0.0, 0.0, 0.2])])]);
    assert!(
        levels.contains("fill the same place") && levels.contains("ReadOptions::garment (\"shirt_LOD0\")"),
        "{levels}"
    );
    let two = told(&[("shirt", shirt()), ("skirt", vec![Part::sheet(6, 0.4, [0.0, -0.6, 0.2])])]);
    assert!(two.contains("2 separate pieces of cloth") && two.contains("\"skirt\""), "{two}");
    assert_eq!(told(&[("shirt", shirt())]), "".into());
    let front = Part::sheet(6, 0.4, [0.0; 3]);
    let back = front.clone().reversed().textured(|[u, v]| [u + 1.0, v]);
    // Closed all round they are doubtful, but no copies of one another.
    let closed = told(&[("front", vec![front]), ("back", vec![back])]);
    assert!(!closed.contains("the same place") && !closed.contains("pieces of cloth"), "{closed}");
    // Two pieces that are joined at their border are one garment.
    let joined = told(&[("left", shirt()), ("right", vec![Part::sheet(6, 0.4, [0.4, 0.0, 0.2])])]);
    assert_eq!(joined, "".into());
}

/// Garment and skin are primitives of one mesh: both have as many targets, and only one was worn.
#[test]
fn a_worn_primitive_beside_another_reads_back() {
    let parts = vec![Part::sheet(6, 0.4, [0.0; 3]).of(0), Part::can(20, 0.1, 1.0, [0.0, 0.0, -0.3]).of(1)];
    let bytes =
        file(&[("dressed", parts)], |json| json["materials"] = json!([{"name": "linen"}, {"name": "hide"}]));
    let options = ReadOptions { garment: Some("linen".into()), ..ReadOptions::default() };
    let own = GarmentFile::parse("a.glb", &bytes, &options).expect("is a garment");
    let (points, hinges) = (own.garment.points.len(), own.garment.topology.hinges.len());
    let displacement = vec![Vec3::new(0.0, 0.0, 0.01); points];
    let worn = WornGarment { displacement, memory: RestState::flat(hinges, own.garment.triangles.len()) };
    let glb = own.to_glb_bytes(&worn).expect("writes");
    let mut alone = |name: &str| panic!("asks for {name}");
    let (mut again, _) = read_asset("worn.glb", &glb, &ReadOptions::default(), &mut alone).expect("reads");
    assert!(keep_worn_pieces(&mut again));
    let counts: Vec<usize> = again.worn_pieces().map(|piece| piece.positions.len()).collect();
    assert_eq!(counts, [49]);
}

/// The detail map of a garment of `parts` that is worn to ripples, and the worn file.
fn detailed(parts: Vec<Part>, edit: impl FnOnce(&mut Value)) -> (DetailOutput, Value) {
    // Different at every place, so that no part fits in the place of another.
    let ripple = |p: &Vec3| 0.004 * (130.0 * p.x + 40.0 * p.y + 200.0 * p.x * p.x).sin();
    detail_map(&file(&[("cloth", parts)], edit), ripple, 256)
}

#[test]
fn every_colourway_gets_the_wrinkles() {
    let edit = |json: &mut Value| {
        json["materials"] = json!([{"name": "navy"}, {"name": "white"}, {"name": "red"}]);
        let mapping = |k: usize| json!({"material": k, "variants": [k]});
        json["meshes"][0]["primitives"][0]["extensions"] =
            json!({"KHR_materials_variants": {"mappings": [mapping(0), mapping(1), mapping(2)]}});
        json["extensionsUsed"] = json!(["KHR_materials_variants"]);
        let names: Vec<Value> = ["navy", "white", "red"].map(|name| json!({"name": name})).into();
        json["extensions"] = json!({"KHR_materials_variants": {"variants": names}});
    };
    let (output, json) = detailed(vec![Part::sheet(6, 0.4, [0.0; 3]).of(0)], edit);
    assert!(output.notes.is_empty() && output.maps.len() == 3, "{:?}", output.notes);
    let textures: Vec<&Value> = (0..3).map(|k| &json["materials"][k]["normalTexture"]["index"]).collect();
    assert!(
        textures.iter().all(|texture| texture.is_u64() && *texture == textures[0]),
        "one picture: {textures:?}"
    );
    assert_eq!(json["images"].as_array().map(Vec::len), Some(1));
    // Shared with a primitive that is not painted in this material, it is copied in the mapping.
    let shared = |json: &mut Value| {
        edit(json);
        json["meshes"][0]["primitives"][0]["extensions"]["KHR_materials_variants"]["mappings"][1]["material"] =
            json!(0);
    };
    let (_, json) = detailed(vec![Part::sheet(6, 0.4, [0.0; 3]).of(2)], shared);
    let primitive = &json["meshes"][0]["primitives"][0];
    let mapped = primitive["extensions"]["KHR_materials_variants"]["mappings"].as_array().expect("stay");
    for material in mapped.iter().map(|mapping| &mapping["material"]).chain([&primitive["material"]]) {
        let index = material.as_u64().expect("is an index") as usize;
        assert!(json["materials"][index]["normalTexture"].is_object(), "{material}");
    }
}

#[test]
fn texture_coordinates_beyond_one_picture_get_a_map_of_their_own() {
    let one = || Part::sheet(6, 0.4, [0.0; 3]).of(0);
    let named = |json: &mut Value| json["materials"] = json!([{"name": "linen"}]);
    let transform = |json: &Value| {
        json["materials"][0]["normalTexture"]["extensions"]["KHR_texture_transform"]["scale"][0].as_f64()
    };
    // Repeated six times, and in a small corner as quantised coordinates are: one map for all.
    for factor in [6.0, 1.0 / 64.0] {
        let (output, json) = detailed(vec![one().textured(|uv| uv.map(|x| factor * x))], named);
        let map = &output.maps[0];
        assert!(map.in_material && map.conflicting_fraction < 0.05, "{factor}: {}", map.conflicting_fraction);
        assert!(output.notes.iter().any(|note| note.contains("texture coordinates")), "{:?}", output.notes);
        let scale = transform(&json).expect("is transformed");
        assert!((scale * factor - 1.0).abs() < 0.01, "{scale}");
        assert!(
            json["extensionsUsed"]
                .as_array()
                .is_some_and(|used| used.contains(&json!("KHR_texture_transform")))
        );
    }
    let half = |x: f64| Part::sheet(6, 0.2, [x, 0.0, 0.0]).of(0);
    // Two tiles: both in one map. Two primitives on one another: a map each.
    let (tiles, _) = detailed(vec![half(-0.1), half(0.1).textured(|[u, v]| [u + 1.0, v])], named);
    assert_eq!((tiles.maps.len(), tiles.maps[0].in_material), (1, true));
    assert!(tiles.maps[0].conflicting_fraction < 0.05);
    let (stacked, json) = detailed(vec![half(-0.1), half(0.1)], named);
    assert!(stacked.maps.len() == 2 && stacked.maps.iter().all(|map| map.in_material), "{:?}", stacked.notes);
    let used: Vec<&Value> =
        json["meshes"][0]["primitives"].as_array().expect("stay").iter().map(|p| &p["material"]).collect();
    assert_ne!(used[0], used[1]);
    // Within one primitive nothing can be done: told, and left out of the material.
    let mut both = half(-0.1);
    let other = half(0.1);
    let first = both.positions.len() as u32;
    both.triangles.extend(other.triangles.iter().map(|t| t.map(|v| v + first)));
    both.positions.extend(other.positions);
    both.uvs.extend(other.uvs);
    let (overlapping, json) = detailed(vec![both], named);
    assert!(!overlapping.maps[0].in_material && json["materials"][0].get("normalTexture").is_none());
    assert!(overlapping.notes.iter().any(|note| note.contains("contradict")), "{:?}", overlapping.notes);
    let (none, _) = detailed(vec![one().textured(|_| [0.0, 0.0])], named);
    assert!(
        none.maps.is_empty() && none.notes.iter().any(|note| note.contains("have no area")),
        "{:?}",
        none.notes
    );
}

const FOLD: &str = r#"{"format": "crease-wear/1", "$schema": "wear.schema.json", "actions": [
    {"lay": {"facing": "front", "over": 0.3}}, // a comment
    {"fold": {"line": [[0.5, 0], [0.5, 1]], "side": "left", "over": 0.5, "hold": 2}},
    {"press": {"pressure": 1000, "for": 3}}, {"unfold": {"all": true, "over": 0.5}}, {"settle": {"for": 0.5}}]}"#;

/// A folder with the script and the file `a.glb`.
fn folder_with(bytes: &[u8]) -> tempfile::TempDir {
    let folder = tempfile::tempdir().expect("a folder");
    std::fs::write(folder.path().join("wear.json"), FOLD).expect("writes");
    std::fs::write(folder.path().join("a.glb"), bytes).expect("writes");
    folder
}

fn report(folder: &tempfile::TempDir, name: &str) -> Value {
    serde_json::from_slice(&std::fs::read(folder.path().join(name)).expect("is written")).expect("is JSON")
}

#[test]
fn buttons_stay_on_the_cloth_through_a_fold() {
    let button = Part::can(8, 0.006, 0.002, [0.0; 3]).moved(|[x, y, z]| [x, z, y + 0.0025]);
    let folder = folder_with(&file(
        &[("shirt", vec![Part::sheet(10, 0.3, [0.0; 3])]), ("button", vec![button])],
        |_| {},
    ));
    let (_, err, code) =
        crease_in(folder.path(), "bake a.glb --wear wear.json -o made/out.glb --quality draft --quiet");
    assert_eq!(code, 0, "{err}");
    let warnings = report(&folder, "made/out.report.json")["warnings"].to_string();
    assert!(warnings.contains("1 small solids"), "{warnings}");
    let sidecar = report(&folder, "made/out.crease.json");
    let vectors = |list: &Value| -> Vec<Vec3> {
        serde_json::from_value::<Vec<[f64; 3]>>(list.clone())
            .expect("are vectors")
            .into_iter()
            .map(Vec3::from)
            .collect()
    };
    let before = vectors(&sidecar["mesh"]["points_m"]);
    let after: Vec<Vec3> =
        before.iter().zip(vectors(&sidecar["points"]["displacement_m"])).map(|(x, d)| x + d).collect();
    let cloth = 121;
    assert!((0..cloth).any(|p| (after[p] - before[p]).norm() > 1e-3), "the cloth is worn");
    let middle = |x: &[Vec3]| x[cloth..].iter().sum::<Vec3>() / (x.len() - cloth) as f64;
    let under =
        (0..cloth).min_by(|a, b| before[*a].norm().total_cmp(&before[*b].norm())).expect("has points");
    let gap = (middle(&after) - after[under]) - (middle(&before) - before[under]);
    assert!(gap.norm() < 2e-3, "{gap}");
    for p in cloth..before.len() {
        let (a, b) = ((before[p] - before[cloth]).norm(), (after[p] - after[cloth]).norm());
        assert!((a - b).abs() < 1e-9, "it keeps its shape");
    }
}

#[test]
fn a_mesh_too_coarse_for_its_fold_is_told() {
    let folder = folder_with(&file(
        &[(
            "triangle",
            vec![Part {
                positions: vec![[0.0, 0.0, 0.0], [0.4, 0.0, 0.0], [0.0, 0.4, 0.0]],
                uvs: vec![[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]],
                triangles: vec![[0, 1, 2]],
                material: None,
            }],
        )],
        |_| {},
    ));
    let (_, err, code) = crease_in(folder.path(), "bake a.glb --wear wear.json -o out.glb --quality draft");
    assert_eq!(code, 3, "{err}");
    assert!(err.contains("nothing is remembered") && err.contains("--resolution"), "{err}");
    assert!(report(&folder, "out.report.json")["warnings"].to_string().contains("--resolution"));
    let (_, err, code) = crease_in(
        folder.path(),
        "bake a.glb --wear wear.json -o out.glb --quality draft --resolution 20 --quiet",
    );
    assert_eq!(code, 0, "{err}");
}
