//! Tests of the sidecar: the contract of its fields, reading as the inverse of writing, and damaged files.

use super::*;
use crease_geometry::math::{Mat4, Vec2, Vec3};
use crease_geometry::mesh::PointIndex;
use crease_model::garment::{
    Garment, Placement, RestState, SourceAsset, SourceFormat, SourcePiece, UpAxis, WornGarment,
};
use serde_json::{Value, json};
use std::io::Write;

/// Two triangles over four points; five source vertices, as one is split at a seam.
fn example() -> Sidecar {
    let positions = [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]];
    let piece = SourcePiece {
        name: "cloth".into(),
        material: None,
        mesh: 0,
        primitive: 0,
        node: None,
        positions: positions.map(|[x, y]| Vec3::new(x, y, 0.0)).to_vec(),
        position_ids: None,
        normals: None,
        uvs: Some(positions.map(|[x, y]| Vec2::new(x, y)).to_vec()),
        mask: None,
        sewing_mask: None,
        triangles: vec![[0, 1, 2], [2, 4, 3]],
        placement: Placement::Rigid(Mat4::identity()),
        joints: Vec::new(),
        worn: true,
    };
    let asset = SourceAsset {
        file: "cloth.obj".into(),
        sha256: "00ff".into(),
        format: SourceFormat::Obj,
        unit_m: 0.01,
        unit_is_known: true,
        up: UpAxis::Z,
        document: None,
        obj: None,
        pieces: vec![piece],
    };
    let points = positions[..4].iter().map(|[x, y]| Vec3::new(*x, *y, 1.0 / 3.0)).collect();
    let source_point = [0, 1, 2, 3, 1].map(PointIndex).to_vec();
    let material = vec![[Vec2::zeros(); 3]; 2];
    let garment =
        Garment { material, source_point, ..Garment::of_triangles(points, &[[0, 1, 2], [2, 1, 3]]) };
    let worn = WornGarment {
        displacement: vec![Vec3::new(0.1, -2e-17, 3.0); 4],
        memory: RestState {
            source_angle: vec![0.0],
            rest_angle: vec![-0.7],
            stiffness_ratio: vec![1.3],
            rest_stretch_warp: vec![1.0, 1.01],
            rest_stretch_weft: vec![1.02, 1.0],
        },
    };
    Sidecar::new(
        &asset,
        &garment,
        &worn,
        json!({"name": "cotton"}),
        json!({"actions": []}),
        json!({"seed": 7}),
    )
    .unwrap()
}

fn example_json() -> Value {
    serde_json::from_slice(&write_sidecar(&example())).unwrap()
}

fn error_of(json: &Value) -> String {
    read_sidecar("a.crease.json", json.to_string().as_bytes()).unwrap_err().to_string()
}

/// The names are a contract with other tools: any change here is a new version of the format.
#[test]
fn the_field_names_and_values_of_the_contract() {
    let expected = json!({
        "format": "crease-sidecar/1",
        "source": {"file": "cloth.obj", "sha256": "00ff", "unit_m": 0.01, "up": "z"},
        "mesh": {
            "points_m": [[0.0, 0.0, 1.0 / 3.0], [1.0, 0.0, 1.0 / 3.0], [0.0, 1.0, 1.0 / 3.0], [1.0, 1.0, 1.0 / 3.0]],
            "triangles": [[0, 1, 2], [2, 1, 3]],
            "source_point": [0, 1, 2, 3, 1],
            "source_uv": [[0.0, 0.0], [1.0, 0.0], [0.0, 1.0], [1.0, 1.0], [1.0, 0.0]],
            "triangle_vertices": [[0, 1, 2], [2, 4, 3]],
        },
        "hinges": {
            "points": [[1, 2, 0, 3]],
            "source_angle_rad": [0.0], "rest_angle_rad": [-0.7], "stiffness_ratio": [1.3],
        },
        "triangles": {
            "rest_stretch_warp": [1.0, 1.01], "rest_stretch_weft": [1.02, 1.0], "warp_angle_rad": [0.0, 0.0],
        },
        "points": {"displacement_m": vec![[0.1, -2e-17, 3.0]; 4]},
        // Worked out by another program (hashlib, struct).
        "checksums": {
            "mesh_sha256": "2e8741ed2bf166c98ebce1061d9a2510c24c2c794eb09eca4df5546056cbd41d",
            "memory_sha256": "630fe8d1864e50bbad107f8045bdcaccda590a42aec99985587fa8bdfcefaf18",
        },
        "fabric": {"name": "cotton"}, "wear": {"actions": []}, "run": {"seed": 7},
    });
    assert_eq!(example_json(), expected);
}

#[test]
fn read_is_the_inverse_of_write_and_keeps_unknown_fields() {
    let mut json = example_json();
    json["studio"] = json!({"ticket": [1, 0.25]});
    json["hinges"]["confidence"] = json!([0.5]);
    json["source"]["author"] = json!("somebody");
    let text = json.to_string();
    let read = read_sidecar("a", text.as_bytes()).unwrap();
    assert_eq!(read.extra["studio"], json["studio"]);
    let again: Value = serde_json::from_slice(&write_sidecar(&read)).unwrap();
    assert_eq!(again, json);
    assert_eq!(read.worn().memory.rest_angle, [-0.7]);
    assert_eq!(read.worn().displacement[3].y, -2e-17);
    assert_eq!(read.mesh_triangles()[1], [2, 1, 3].map(PointIndex));
    assert_eq!(read.mesh_points()[3].z, 1.0 / 3.0);
}

#[test]
fn a_type_error_names_line_column_and_path() {
    let text = serde_json::to_string_pretty(&example_json()).unwrap().replace("-0.7", "null");
    let line = text.lines().position(|l| l.contains("null")).unwrap() + 1;
    let message = read_sidecar("a.crease.json", text.as_bytes()).unwrap_err().to_string();
    assert!(message.starts_with(&format!("a.crease.json: line {line}, column ")), "{message}");
    assert!(message.contains("hinges.rest_angle_rad[0]"), "{message}");
    assert!(!message.contains(" at line "), "said once: {message}");
}

#[test]
fn another_version_is_named_even_when_its_fields_differ() {
    let mut json = example_json();
    json["format"] = json!("crease-sidecar/2");
    assert!(error_of(&json).contains("crease-sidecar/2"));
    let message = error_of(&json!({"format": "crease-wear/1", "actions": []}));
    assert!(message.contains("crease-wear/1") && message.contains("OUT.crease.json"), "{message}");
    assert!(error_of(&json!({"actions": []})).contains("format"));
    assert!(error_of(&json!([1, 2])).contains("line 1"));
}

#[test]
fn every_contradiction_is_reported_in_one_go() {
    let mut json = example_json();
    json["source"]["unit_m"] = json!(0.0);
    json["mesh"]["triangles"][1][2] = json!(4);
    json["mesh"]["source_point"][4] = json!(9);
    json["mesh"]["source_uv"] = json!([[0.0, 0.0]]);
    json["hinges"]["points"][0][3] = json!(u32::MAX);
    json["hinges"]["source_angle_rad"] = json!([0.0, 0.0]);
    json["hinges"]["rest_angle_rad"] = json!([]);
    json["hinges"]["stiffness_ratio"][0] = json!(-1.0);
    json["triangles"]["rest_stretch_warp"] = json!([1.0]);
    json["triangles"]["rest_stretch_weft"][1] = json!(0.0);
    json["points"]["displacement_m"] = json!([]);
    let message = error_of(&json);
    for place in [
        "source.unit_m",
        "mesh.triangles[1]",
        "mesh.source_point[4]",
        "mesh.source_uv",
        "hinges.points[0]",
        "hinges.source_angle_rad",
        "hinges.rest_angle_rad",
        "hinges.stiffness_ratio[0]",
        "triangles.rest_stretch_warp",
        "triangles.rest_stretch_weft[1]",
        "points.displacement_m",
    ] {
        assert!(message.contains(&format!(": {place}: ")), "{place} missing in\n{message}");
    }
    assert_eq!(message.lines().count(), 11, "{message}");
}

/// An edit by hand or by a program that does not know the format must not pass for the bake; one that is meant may.
#[test]
fn edited_numbers_are_refused_unless_the_checksums_go_too() {
    let mut json = example_json();
    json["hinges"]["rest_angle_rad"][0] = json!(-0.71);
    let message = error_of(&json);
    assert!(message.contains("checksums.memory_sha256: does not fit"), "{message}");
    assert!(message.contains("delete \"checksums\"") && message.lines().count() == 1, "{message}");
    json["mesh"]["points_m"][0][0] = json!(0.5);
    assert_eq!(error_of(&json).lines().count(), 2);
    json.as_object_mut().unwrap().remove("checksums");
    assert!(read_sidecar("a", json.to_string().as_bytes()).is_ok());
    // Layout is no content.
    let pretty = serde_json::to_string_pretty(&example_json()).unwrap();
    assert!(read_sidecar("a", pretty.as_bytes()).is_ok());
}

#[test]
fn a_sidecar_knows_its_mesh_from_another() {
    let read = |text: &str| {
        let options = crate::ReadOptions::default();
        let mut nothing = |_: &str| Ok(Vec::new());
        crate::read_asset("m.obj", text.as_bytes(), &options, &mut nothing).unwrap().0
    };
    let own = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    let (garment, _) = Garment::from_asset(&own).unwrap();
    let worn = WornGarment { displacement: vec![Vec3::zeros(); 3], memory: RestState::flat(0, 1) };
    let sidecar = Sidecar::new(&own, &garment, &worn, Value::Null, Value::Null, Value::Null).unwrap();
    assert_eq!(sidecar.mesh_mismatch(&own), None);
    let moved = read("v 0 0 0\nv 1 0 0\nv 0 1.01 0\nf 1 2 3\n");
    assert!(sidecar.mesh_mismatch(&moved).unwrap().contains("vertex 2 is elsewhere"));
    // The gap of a seam that was sewn on import.
    let seam = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 0.1 0\nv 1 1 0\nv 0 1.1 0\nf 1 2 3\nf 4 5 6\n");
    let (garment, _) = Garment::from_asset_welded(&seam, Some(0.15)).unwrap();
    assert_eq!(garment.points.len(), 4);
    let worn = WornGarment { displacement: vec![Vec3::zeros(); 4], memory: RestState::flat(1, 2) };
    let sewn = Sidecar::new(&seam, &garment, &worn, Value::Null, Value::Null, Value::Null).unwrap();
    assert_eq!(sewn.mesh_mismatch(&seam), None);
    let more = read("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nf 1 2 3\nf 2 4 3\n");
    assert!(sidecar.mesh_mismatch(&more).unwrap().contains("3 vertices, this one has 4"));
}

#[test]
fn numbers_that_json_cannot_say_are_refused_on_both_sides() {
    let huge = example_json().to_string().replace("1.3", "1e999");
    assert!(read_sidecar("a", huge.as_bytes()).is_err());
    let mut sidecar = example();
    sidecar.hinges.rest_angle_rad[0] = f64::NAN;
    assert!(sidecar.validate("a").unwrap_err().to_string().contains("rest_angle_rad[0]"));
}

#[test]
fn truncated_or_mutated_text_is_a_fault_never_a_panic() {
    let text = write_sidecar(&example());
    for end in 0..text.len() - 2 {
        assert!(read_sidecar("a", &text[..end]).is_err(), "cut at {end}");
    }
    for i in 0..text.len() {
        for bit in 0..8 {
            let mut bent = text.clone();
            bent[i] ^= 1 << bit;
            let _ = read_sidecar("a", &bent);
        }
    }
    let mut longer = text.clone();
    longer.extend_from_slice(b"{}");
    assert!(read_sidecar("a", &longer).is_err(), "something after the end");
}

/// `content` as a gzip file.
fn compressed(content: &[u8]) -> Vec<u8> {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::best());
    encoder.write_all(content).unwrap();
    encoder.finish().unwrap()
}

#[test]
fn a_compressed_sidecar_is_the_plain_one() {
    let text = write_sidecar(&example());
    let gzip = compressed(&text);
    assert_eq!(read_sidecar("a", &gzip).unwrap(), example());
    let (head, tail) = text.split_at(100);
    let parts = [compressed(head), compressed(tail)].concat();
    assert_eq!(read_sidecar("a", &parts).unwrap(), example(), "a gzip file of two parts");
    let message = read_sidecar("a.gz", &compressed(b"{}")).unwrap_err().to_string();
    assert!(message.starts_with("a.gz: line 1, column 2"), "{message}");
}

#[test]
fn a_cut_or_damaged_gzip_file_is_a_fault_never_a_panic() {
    let gzip = compressed(&write_sidecar(&example()));
    for end in 2..gzip.len() {
        let message = read_sidecar("a.gz", &gzip[..end]).unwrap_err().to_string();
        assert!(message.starts_with("a.gz: gzip: is damaged or cut off"), "cut at {end}: {message}");
    }
    for i in 0..gzip.len() {
        let mut bent = gzip.clone();
        bent[i] ^= 0x10;
        let _ = read_sidecar("a", &bent);
    }
    let longer = [gzip.as_slice(), b"{}"].concat();
    assert!(read_sidecar("a", &longer).is_err(), "something after the end");
}

/// 200 MB of spaces are a gzip file of 200 kB.
#[test]
fn a_gzip_file_of_far_longer_content_is_refused() {
    let mut encoder = flate2::write::GzEncoder::new(Vec::new(), flate2::Compression::fast());
    for _ in 0..200 {
        encoder.write_all(&[b' '; 1_000_000]).unwrap();
    }
    let bomb = encoder.finish().unwrap();
    let message = read_sidecar("a.gz", &bomb).unwrap_err().to_string();
    assert!(message.contains("more than 100 times as long as the file"), "{} bytes: {message}", bomb.len());
}

#[test]
fn the_schema_names_every_field_of_the_contract() {
    let schema = serde_json::to_string(&schemars::schema_for!(Sidecar)).unwrap();
    for field in
        ["points_m", "source_point", "source_angle_rad", "stiffness_ratio", "displacement_m", "sha256"]
    {
        assert!(schema.contains(field), "{field}");
    }
}
