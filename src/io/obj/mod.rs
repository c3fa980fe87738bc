//! Reads Wavefront OBJ with a tolerant line parser. The `obj-rs` crate panics on some keywords, rejects colours, blanks in
//! names and mixed corners, and reads single precision, so it serves only as the oracle in tests.
//!
//! A piece has the faces of one object, group and material; a vertex is a `v/vt/vn` triplet. The first vertices are those of the `v`
//! lines in their order, one each; the other triplets of these lines follow, in the same order.
//! Material libraries are not read: only the names of materials are kept.

mod lines;
mod parse;

use crate::corners::{Corner, CornerVertices};
use crate::error_list::ErrorList;
use crate::obj::parse::{BadPosition, Face, Label, Statements};
use crate::pieces::{DamagedPiece, MASK_SETTINGS, NamedPiece, ReadPieces};
use crate::polygon::Triangulator;
use crease_geometry::math::{Mat4, Vec2, Vec3};
use crease_geometry::mesh::INVALID;
use crease_model::error::{Diagnostic, Error, Message, Result, Setting};
use crease_model::garment::{ImportDiagnostic, ObjFace, ObjLines, Placement, Severity, SourcePiece};

/// Name of a piece without object and group.
const UNNAMED: &str = "default";

/// Reads the pieces of an OBJ file.
pub(super) fn read_obj(
    file: &str,
    bytes: &[u8],
    to_scene: &Mat4,
    masks: [Option<&str>; 2],
) -> Result<ReadPieces> {
    let mut errors = ErrorList::new(file);
    let mut statements = parse::parse(bytes, &mut errors);
    let mut is_used = vec![false; statements.positions.len()];
    for corner in &statements.corners {
        if let Some(slot) = is_used.get_mut(corner.position as usize) {
            *slot = true;
        }
    }
    // A position that no face uses belongs to no piece that could be refused for it.
    let belongs = |bad: &&BadPosition| is_used.get(bad.index as usize).copied().unwrap_or(false);
    let all = !errors.is_empty();
    for bad in statements.bad_positions.iter().filter(|bad| all || !belongs(bad)) {
        let error = bad.error(file);
        errors.push(error.location, error.message, error.help);
    }
    errors.finish()?;
    let mut components = [None; 2];
    for ((component, wanted), setting) in components.iter_mut().zip(masks).zip(MASK_SETTINGS) {
        *component = wanted.map(|wanted| mask_component(file, setting, wanted, &statements)).transpose()?;
    }
    let mut diagnostics = std::mem::take(&mut statements.diagnostics);
    let mut builders: Vec<CornerVertices> =
        statements.labels.iter().map(|_| CornerVertices::default()).collect();
    let mut triangulator = Triangulator::new();
    for face in &statements.faces {
        let corners = statements.corners.get(face.corners.clone()).unwrap_or(&[]);
        if let Some(builder) = builders.get_mut(face.label) {
            builder.add_face(&statements.positions, corners, &mut triangulator);
        }
    }
    builders.iter_mut().for_each(CornerVertices::number_by_position);
    if triangulator.fan_count > 0 {
        diagnostics.push(ImportDiagnostic {
            severity: Severity::Note,
            location: String::new(),
            message: Message::from(format!(
                "{} faces intersect themselves or have no area: cut as fans",
                triangulator.fan_count
            )),
        });
    }
    let (mut pieces, mut damaged) = (Vec::new(), Vec::new());
    let (mut piece_of_label, mut piece_positions) = (Vec::new(), Vec::new());
    for (number, (builder, label)) in builders.into_iter().zip(&statements.labels).enumerate() {
        let uses = |bad: &&BadPosition| builder.corners.iter().any(|corner| corner.position == bad.index);
        let errors: Vec<Diagnostic> =
            statements.bad_positions.iter().filter(uses).map(|bad| bad.error(file)).collect();
        let lines = builder.corners.iter().map(|corner| corner.position).collect();
        let named = named_piece(builder, number, label, to_scene, components, &statements);
        piece_of_label.push(errors.is_empty().then_some(pieces.len()));
        if errors.is_empty() {
            pieces.push(named);
            piece_positions.push(lines);
        } else {
            damaged.push(DamagedPiece { names: named.names, errors });
        }
    }
    let face = |face: &Face| ObjFace {
        piece: piece_of_label.get(face.label).copied().flatten(),
        corners: statements.corners[face.corners.clone()].iter().map(|c| [c.position, c.uv]).collect(),
    };
    let faces = statements.faces.iter().map(face).collect();
    let obj = ObjLines { faces, positions: statements.positions, uvs: statements.uvs, piece_positions };
    Ok(ReadPieces { pieces, damaged, document: None, obj: Some(obj), frame: None, diagnostics })
}

/// Returns the colour component that `option` names.
fn mask_component(file: &str, setting: Setting, wanted: &str, statements: &Statements) -> Result<usize> {
    let component = match wanted {
        "COLOR_0" | "COLOR_0.r" | "COLOR_0.x" => Some(0),
        "COLOR_0.g" | "COLOR_0.y" => Some(1),
        "COLOR_0.b" | "COLOR_0.z" => Some(2),
        _ => None,
    };
    match component {
        Some(component) if statements.has_colours => Ok(component),
        Some(_) => {
            let message = "no vertex colours in it to take the mask from";
            Err(Error::input(file, "", message, Message::from("leave out ") + setting))
        }
        None => Err(Error::input(
            file,
            "",
            format!("no vertex attribute called \"{wanted}\""),
            "an OBJ file has COLOR_0, with .r .g .b",
        )),
    }
}

/// Makes the piece of the faces with one label.
fn named_piece(
    vertices: CornerVertices,
    number: usize,
    label: &Label,
    to_scene: &Mat4,
    [mask, sewing_mask]: [Option<usize>; 2],
    statements: &Statements,
) -> NamedPiece {
    let (has_uvs, has_normals) = (
        vertices.corners.iter().any(|c| c.uv != INVALID),
        vertices.corners.iter().any(|c| c.normal != INVALID),
    );
    let position = |c: &Corner| statements.positions.get(c.position as usize).copied().unwrap_or_default();
    let uv = |c: &Corner| statements.uvs.get(c.uv as usize).copied().unwrap_or_else(Vec2::zeros);
    let normal = |(c, face_normal): (&Corner, &Vec3)| {
        let own = statements.normals.get(c.normal as usize);
        own.copied().filter(|n| n.norm_squared() > 0.0).unwrap_or(*face_normal)
    };
    let colour = |c: &Corner, k: usize| statements.colours.get(c.position as usize).map_or(1.0, |rgb| rgb[k]);
    let mut names: Vec<String> = Vec::new();
    let group_words = label.group.iter().flat_map(|group| group.split(' ').map(str::to_owned));
    let given = label.group.iter().chain(&label.object).chain(&label.material).cloned();
    for name in given.chain(group_words) {
        if !names.contains(&name) {
            names.push(name);
        }
    }
    let name = label.group.as_ref().or(label.object.as_ref());
    if name.is_none() {
        names.push(UNNAMED.to_owned());
    }
    let piece = SourcePiece {
        name: name.map_or(UNNAMED, String::as_str).to_owned(),
        material: label.material.clone(),
        mesh: 0,
        primitive: number,
        node: None,
        positions: vertices.corners.iter().map(position).collect(),
        position_ids: Some(vertices.corners.iter().map(|c| c.position).collect()),
        normals: has_normals
            .then(|| vertices.corners.iter().zip(&vertices.face_normals).map(normal).collect()),
        uvs: has_uvs.then(|| vertices.corners.iter().map(uv).collect()),
        mask: mask.map(|k| vertices.corners.iter().map(|c| colour(c, k)).collect()),
        sewing_mask: sewing_mask.map(|k| vertices.corners.iter().map(|c| colour(c, k)).collect()),
        triangles: vertices.triangles,
        placement: Placement::Rigid(*to_scene),
        joints: Vec::new(),
        worn: true,
    };
    NamedPiece { piece, names }
}

#[cfg(test)]
mod tests {
    use crate::{ReadOptions, read_asset};
    use crease_geometry::math::{Vec2, Vec3};
    use crease_model::garment::{ImportDiagnostic, Severity, SourceAsset};

    fn read_with(
        text: &str,
        options: &ReadOptions,
    ) -> crease_model::error::Result<(SourceAsset, Vec<ImportDiagnostic>)> {
        read_asset("test.obj", text.as_bytes(), options, &mut |_| unreachable!("an OBJ refers to nothing"))
    }

    fn read(text: &str) -> (SourceAsset, Vec<ImportDiagnostic>) {
        read_with(text, &ReadOptions::default()).unwrap()
    }

    fn message(text: &str) -> String {
        read_with(text, &ReadOptions::default()).unwrap_err().to_string()
    }

    const SQUARE: &str = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

    #[test]
    fn vertices_are_those_of_the_v_lines_first_and_then_those_of_seams() {
        let text =
            format!("{SQUARE}vt 0.25 0.75\nvt 1 0\nvn 0 0 2\nf 3/2/1 1/1/1 2/1/1\nf 3/2/1 4/1/1 1/2/1\n");
        let (asset, diagnostics) = read(&text);
        let piece = &asset.pieces[0];
        assert_eq!(piece.triangles, [[2, 0, 1], [2, 3, 4]]);
        assert_eq!(piece.positions[2], Vec3::new(1.0, 1.0, 0.0));
        assert_eq!(piece.positions[4], piece.positions[0], "two texture coordinates, two vertices");
        // Convention: OBJ counts v upward, glTF (and we) downward.
        assert_eq!(piece.uvs.as_ref().unwrap()[0], Vec2::new(0.25, 0.25));
        assert_eq!(piece.normals.as_ref().unwrap()[0], Vec3::z(), "of unit length");
        assert!(diagnostics.is_empty(), "{diagnostics:?}");
    }

    #[test]
    fn corners_may_be_mixed() {
        let (asset, _) = read(&format!("{SQUARE}vt 1 1\nvn 1 0 0\nf 1 2/1 3//1\nf 1/ 3// 4/1/\n"));
        let piece = &asset.pieces[0];
        assert_eq!(piece.positions.len(), 5, "1, 2/1, 3//1, 3, 4/1");
        assert_eq!(piece.uvs.as_ref().unwrap()[0], Vec2::zeros());
        let normals = piece.normals.as_ref().unwrap();
        assert_eq!(
            (normals[0], normals[2]),
            (Vec3::z(), Vec3::x()),
            "the normal of the face where the file has none"
        );
    }

    #[test]
    fn groups_materials_and_objects_make_pieces() {
        let text = format!(
            "{SQUARE}f 1 2 3\no Shirt\nusemtl blue  cloth\nf 1 3 4\ng left  arm\nf 1 2 4\nusemtl red\nf 2 3 4\no Shirt\nusemtl blue cloth\nf 1 2 3 4\n"
        );
        let (asset, _) = read(&text);
        let names: Vec<_> = asset
            .pieces
            .iter()
            .map(|p| (p.name.as_str(), p.material.as_deref(), p.triangles.len()))
            .collect();
        let expected = [
            ("default", None, 1),
            ("Shirt", Some("blue cloth"), 3),
            ("left arm", Some("blue cloth"), 1),
            ("left arm", Some("red"), 1),
        ];
        assert_eq!(names, expected);
        for (garment, worn) in [
            ("Shirt", [false, true, true, true]),
            ("arm", [false, false, true, true]),
            ("blue cloth", [false, true, true, false]),
            ("default", [true, false, false, false]),
        ] {
            let options = ReadOptions { garment: Some(garment.into()), ..ReadOptions::default() };
            let (asset, _) = read_with(&text, &options).unwrap();
            assert_eq!(asset.pieces.iter().map(|p| p.worn).collect::<Vec<_>>(), worn, "{garment}");
        }
        let options = ReadOptions { garment: Some("sleeve".into()), ..ReadOptions::default() };
        let message = read_with(&text, &options).unwrap_err().to_string();
        assert!(
            message.contains("\"sleeve\"") && message.contains("left arm") && message.contains("red"),
            "{message}"
        );
    }

    #[test]
    fn every_error_is_reported_with_its_line() {
        let message =
            message("v 0 0 0\nv 1 nan 0\nv 1 1\nv 1 1 1e400\nf 1 2 0\nf 1 2 x\nf 1 2 9\nf -5 1 2\n");
        for line in 2..=8 {
            assert!(message.contains(&format!("line {line}:")), "line {line} in {message}");
        }
        assert_eq!(message.lines().count(), 7);
    }

    #[test]
    fn a_thousand_errors_are_counted_not_listed() {
        let message = message(&"v 1 1 nan\n".repeat(1000));
        assert!(message.contains("and 980 more") && message.lines().count() == 21, "{message}");
    }

    #[test]
    fn what_is_not_cloth_is_skipped_and_noted() {
        let (_, diagnostics) = read(&format!(
            "{SQUARE}cstype bezier\nlod 3\nl 1 2\np 1\np 2\nf 1 2\nf 1 2 3 # a comment\nvt 1 nan\n"
        ));
        let reported: Vec<_> =
            diagnostics.iter().map(|f| (f.severity, f.location.as_str(), f.message.as_str())).collect();
        let expected = [
            (Severity::Repaired, "line 10", "1 faces of fewer than 3 corners dropped"),
            (Severity::Repaired, "line 12", "1 texture coordinates or normals that are not numbers replaced"),
            (Severity::Note, "line 5", "1 \"cstype\" statements skipped"),
            (Severity::Note, "line 7", "1 \"l\" statements skipped"),
            (Severity::Note, "line 8", "2 \"p\" statements skipped"),
        ];
        assert_eq!(reported, expected);
    }

    #[test]
    fn a_mask_comes_from_vertex_colours() {
        let text = "v 0 0 0 1 0.25 0\nv 1 0 0 0 0 0\nv 1 1 0 0 7 0\nf 1 2 3\n";
        let options = ReadOptions { mask: Some("COLOR_0.g".into()), ..ReadOptions::default() };
        let (asset, _) = read_with(text, &options).unwrap();
        assert_eq!(asset.pieces[0].mask.as_deref(), Some(&[0.25, 0.0, 1.0][..]));
        let options = ReadOptions { sewing_mask: Some("COLOR_0".into()), ..options };
        let (asset, _) = read_with(text, &options).unwrap();
        assert_eq!(asset.pieces[0].sewing_mask.as_deref(), Some(&[1.0, 0.0, 0.0][..]));
        let options = ReadOptions { mask: Some("_PIN".into()), ..ReadOptions::default() };
        assert!(read_with(text, &options).unwrap_err().to_string().contains("_PIN"));
    }

    #[test]
    fn unit_and_up_axis_are_applied() {
        let text = "v 0 0 0\nv 100 0 0\nv 0 0 100\nf 1 2 3\n";
        assert!(message(text).contains("ReadOptions::unit_m (cm) makes it 1.00 m"), "{}", message(text));
        let options = ReadOptions {
            unit_m: Some(0.01),
            up: Some(crease_model::garment::UpAxis::Z),
            ..ReadOptions::default()
        };
        let (asset, _) = read_with(text, &options).unwrap();
        let top = asset.pieces[0].scene_position(2).unwrap();
        assert!((top - Vec3::y()).norm() < 1e-15, "the file's z is up: {top}");
        // An implausible size is refused whatever the unit, and accepted on request.
        let options = ReadOptions { unit_m: Some(1.0), ..ReadOptions::default() };
        assert!(read_with(text, &options).is_err());
        assert!(read_with(text, &ReadOptions { any_size: true, ..options }).is_ok());
        for unit in [0.0, -1.0, f64::NAN, f64::INFINITY] {
            let options = ReadOptions { unit_m: Some(unit), ..ReadOptions::default() };
            assert!(read_with(text, &options).is_err());
        }
    }
}
