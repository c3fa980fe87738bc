//! USD files as meshes: the garment of a USD stage is that of the same mesh in another format, and what is left out is said.

#[path = "common/tool.rs"]
mod tool;

use crease::{Error, Result, Vec3};
use crease_io::{ReadOptions, read_asset};
use crease_model::garment::{Garment, ImportDiagnostic, Severity, SourceAsset, UpAxis};
use std::fmt::Write;
use tool::{crease_in, write, write_script};

/// Reads `text` as USD, with `files` beside it.
fn read_with(
    text: &str,
    options: &ReadOptions,
    files: &[(&str, &str)],
) -> Result<(SourceAsset, Vec<ImportDiagnostic>)> {
    let mut resolve = |name: &str| {
        let found = files.iter().find(|(own, _)| *own == name);
        found
            .map(|(_, text)| text.as_bytes().to_vec())
            .ok_or_else(|| Error::input(name, "", "there is no such file", "look"))
    };
    read_asset("folder/shirt.usda", text.as_bytes(), options, &mut resolve)
}

fn read(text: &str) -> (SourceAsset, Vec<ImportDiagnostic>) {
    read_with(text, &ReadOptions::default(), &[]).expect("is read")
}

fn refusal(text: &str) -> String {
    read_with(text, &ReadOptions::default(), &[]).expect_err("is refused").to_string()
}

/// Header of a stage in metres, y up.
const METRES: &str = "#usda 1.0\n(\n    metersPerUnit = 1\n    upAxis = \"Y\"\n)\n";

/// A mesh prim of a square of 0.2 m in the plane z = 0, with `lines` in it.
fn square(name: &str, lines: &str) -> String {
    format!(
        "def Mesh \"{name}\"\n{{\n    point3f[] points = [(0, 0, 0), (0.2, 0, 0), (0.2, 0.2, 0), (0, 0.2, 0)]\n    \
         int[] faceVertexCounts = [4]\n    int[] faceVertexIndices = [0, 1, 2, 3]\n    \
         uniform token subdivisionScheme = \"none\"\n    {lines}\n}}\n"
    )
}

/// A position of the scene, rounded.
fn corner(asset: &SourceAsset, piece: usize, vertex: usize) -> [f64; 3] {
    let x = asset.pieces[piece].scene_position(vertex).expect("a vertex");
    [x.x, x.y, x.z].map(|x| (x * 1e6).round() / 1e6)
}

/// Area vector of all triangles of a piece in the scene.
fn area_vector(asset: &SourceAsset, piece: usize) -> Vec3 {
    let own = &asset.pieces[piece];
    let at = |v: u32| own.scene_position(v as usize).expect("a vertex");
    own.triangles.iter().map(|t| (at(t[1]) - at(t[0])).cross(&(at(t[2]) - at(t[0]))) / 2.0).sum()
}

fn said(diagnostics: &[ImportDiagnostic], text: &str) -> bool {
    diagnostics.iter().any(|d| d.message.contains(text))
}

#[test]
fn unit_and_axis_are_those_of_the_stage_unless_others_are_given() {
    let text = |unit: &str, up: &str| format!("#usda 1.0\n(\n    {unit}\n    {up}\n)\n{}", square("A", ""));
    let (asset, diagnostics) = read(&text("metersPerUnit = 2", "upAxis = \"Z\""));
    assert_eq!((asset.unit_m, asset.up, asset.unit_is_known), (2.0, UpAxis::Z, true));
    assert_eq!(corner(&asset, 0, 2), [0.4, 0.0, -0.4]);
    assert!(!said(&diagnostics, "centimetre"), "{diagnostics:?}");
    // A stage without either is in centimetres, y up.
    let options = ReadOptions { any_size: true, ..ReadOptions::default() };
    let (asset, diagnostics) = read_with(&text("", ""), &options, &[]).expect("is read");
    assert_eq!((asset.unit_m, asset.up, asset.unit_is_known), (0.01, UpAxis::Y, false));
    assert!(said(&diagnostics, "centimetre"), "{diagnostics:?}");
    let options = ReadOptions { unit_m: Some(1.0), up: Some(UpAxis::Y), ..ReadOptions::default() };
    let (asset, _) =
        read_with(&text("metersPerUnit = 0.001", "upAxis = \"Z\""), &options, &[]).expect("is read");
    assert_eq!((asset.unit_m, asset.up), (1.0, UpAxis::Y));
    assert!(refusal(&text("metersPerUnit = 0", "")).contains("metersPerUnit"));
    assert!(refusal(&text("metersPerUnit = 1", "upAxis = \"X\"")).contains("ReadOptions::up"));
}

#[test]
fn transforms_lead_to_the_world_and_mirrors_turn_no_side() {
    let inner = square(
        "A",
        "double3 xformOp:translate = (1, 0, 0)\n    uniform token[] xformOpOrder = [\"xformOp:translate\"]",
    );
    let outer = |operations: &str, order: &str| {
        format!(
            "{METRES}def Xform \"Up\"\n{{\n    {operations}\n    uniform token[] xformOpOrder = [{order}]\n{inner}}}\n"
        )
    };
    let (asset, _) = read(&outer("float xformOp:rotateZ = 90", "\"xformOp:rotateZ\""));
    assert_eq!(corner(&asset, 0, 1), [0.0, 1.2, 0.0]);
    let (asset, _) = read(&outer(
        "double3 xformOp:translate:pivot = (1, 0, 0)\n    float xformOp:rotateY = 90",
        "\"xformOp:translate:pivot\", \"xformOp:rotateY\", \"!invert!xformOp:translate:pivot\"",
    ));
    assert_eq!(corner(&asset, 0, 1), [1.0, 0.0, -0.2]);
    let (asset, _) = read(&outer("float3 xformOp:scale = (-1, 1, 1)", "\"xformOp:scale\""));
    assert_eq!(corner(&asset, 0, 1), [-1.2, 0.0, 0.0]);
    assert!(area_vector(&asset, 0).z > 0.039, "counter-clockwise in the scene, too");
    let (asset, _) = read(&format!("{METRES}{}", square("A", "uniform token orientation = \"leftHanded\"")));
    assert!(area_vector(&asset, 0).z < -0.039);
    // The prim's own order begins anew.
    let reset = inner.replace("[\"xformOp", "[\"!resetXformStack!\", \"xformOp");
    let (asset, _) =
        read(&outer("float xformOp:rotateZ = 90", "\"xformOp:rotateZ\"").replace(&inner, &reset));
    assert_eq!(corner(&asset, 0, 1), [1.2, 0.0, 0.0]);
    let foreign = outer("", "\"xformOp:tr{anslate\"");
    assert!(refusal(&foreign).contains("no name of an attribute"), "{}", refusal(&foreign));
    let singular = outer("float3 xformOp:scale = (0, 1, 1)", "\"!invert!xformOp:scale\"");
    assert!(
        refusal(&singular).contains("/Up/A.xformOpOrder: its place is not known: /Up: !invert!xformOp:scale")
    );
}

#[test]
fn texture_coordinates_split_vertices_and_not_the_cloth() {
    let seam = "#usda 1.0\n(\n    metersPerUnit = 1\n)\ndef Mesh \"A\"\n{\n    \
        point3f[] points = [(0, 0, 0), (0.2, 0, 0), (0.2, 0.2, 0), (0, 0.2, 0), (0.4, 0, 0), (0.4, 0.2, 0)]\n    \
        int[] faceVertexCounts = [4, 4]\n    int[] faceVertexIndices = [0, 1, 2, 3, 1, 4, 5, 2]\n    \
        uniform token subdivisionScheme = \"none\"\n    PRIMVAR\n}\n";
    let vertices = |primvar: &str| {
        let (asset, diagnostics) = read(&seam.replace("PRIMVAR", primvar));
        let (garment, _) = Garment::from_asset(&asset).expect("a garment");
        assert_eq!(garment.points.len(), 6, "{primvar}");
        (asset.pieces[0].positions.len(), asset.pieces[0].uvs.clone(), diagnostics)
    };
    let face = "[(0, 0), (1, 0), (1, 1), (0, 1), (0, 0), (1, 0), (1, 1), (0, 1)] ( interpolation = \"faceVarying\" )";
    let (count, uvs, _) = vertices(&format!("texCoord2f[] primvars:st = {face}"));
    assert_eq!(count, 8);
    // USD counts v upward, we downward.
    assert_eq!(uvs.expect("has some")[2], crease_geometry::math::Vec2::new(1.0, 0.0));
    let (count, ..) = vertices(
        "texCoord2f[] primvars:st = [(0, 0), (1, 0), (1, 1), (0, 1)] ( interpolation = \"faceVarying\" )\n    \
         int[] primvars:st:indices = [0, 1, 2, 3, 0, 1, 2, 3]",
    );
    assert_eq!(count, 8);
    let six = "[(0, 0), (1, 0), (1, 1), (0, 1), (2, 0), (2, 1)]";
    assert_eq!(vertices(&format!("texCoord2f[] primvars:map1 = {six} ( interpolation = \"vertex\" )")).0, 6);
    assert_eq!(vertices("texCoord2f[] primvars:st = [(0, 0), (1, 1)] ( interpolation = \"uniform\" )").0, 8);
    let (count, uvs, diagnostics) =
        vertices("texCoord2f[] primvars:st = [(0, 0)] ( interpolation = \"faceVarying\" )");
    assert_eq!((count, uvs), (6, None));
    assert!(
        said(&diagnostics, "primvars:st is left out: it has 1 values where 8 are needed"),
        "{diagnostics:?}"
    );
    // Normals split vertices, too.
    let normals = "normal3f[] normals = [(0, 0, 1), (0, 0, 1), (0, 0, 1), (0, 0, 1), (1, 0, 1), (1, 0, 1), (1, 0, 1), (1, 0, 1)] \
                   ( interpolation = \"faceVarying\" )";
    assert_eq!(vertices(normals).0, 8);
}

#[test]
fn materials_make_pieces_and_names_choose_them() {
    let subset = "def GeomSubset \"hem\"\n    {\n        uniform token elementType = \"face\"\n        \
        uniform token familyName = \"materialBind\"\n        int[] indices = [0]\n        \
        rel material:binding = </Look/Rib>\n    }\n    rel material:binding = </Look/Cotton>";
    let second = square("Back", "").replace("[4]", "[3, 3]").replace("[0, 1, 2, 3]", "[0, 1, 2, 0, 2, 3]");
    let second = second.replace("uniform token subdiv", &format!("{subset}\n    uniform token subdiv"));
    let text =
        format!("{METRES}def Xform \"Shirt\"\n{{\n{}{second}}}\n{}", square("Front", ""), square("Shoe", ""));
    let (asset, _) = read(&text);
    let pieces: Vec<_> =
        asset.pieces.iter().map(|p| (p.name.as_str(), p.material.as_deref(), p.triangles.len())).collect();
    assert_eq!(
        pieces,
        [("Front", None, 2), ("Back", Some("Rib"), 1), ("Back", Some("Cotton"), 1), ("Shoe", None, 2)]
    );
    for (garment, worn) in [
        ("Shirt", [true, true, true, false]),
        ("Back", [false, true, true, false]),
        ("hem", [false, true, false, false]),
        ("Back:Cotton", [false, false, true, false]),
        ("/Shirt/Front,Shoe", [true, false, false, true]),
    ] {
        let options = ReadOptions { garment: Some(garment.into()), ..ReadOptions::default() };
        let (asset, _) = read_with(&text, &options, &[]).expect("is read");
        assert_eq!(asset.pieces.iter().map(|p| p.worn).collect::<Vec<_>>(), worn, "{garment}");
    }
}

#[test]
fn masks_are_primvars() {
    let colour = "color3f[] primvars:displayColor = [(1, 0, 0), (1, 0.5, 0), (1, 1, 0), (1, 0.25, 0)] ( interpolation = \"vertex\" )";
    let text = format!("{METRES}{}", square("A", colour));
    let options = ReadOptions { mask: Some("COLOR_0.g".into()), ..ReadOptions::default() };
    let (asset, _) = read_with(&text, &options, &[]).expect("is read");
    assert_eq!(asset.pieces[0].mask.as_deref(), Some(&[0.0, 0.5, 1.0, 0.25][..]));
    let options = ReadOptions { sewing_mask: Some("hems".into()), ..ReadOptions::default() };
    let message = read_with(&text, &options, &[]).expect_err("there is none").to_string();
    assert!(message.contains("\"hems\"") && message.contains("displayColor"), "{message}");
}

#[test]
fn what_is_left_out_is_said() {
    let lines = "point3f[] points.timeSamples = { 1: [(0, 0, 0), (0.3, 0, 0), (0.3, 0.3, 0), (0, 0.3, 0)], 2: [(0, 0, 9), (0.2, 0, 9), (0.2, 0.2, 9), (0, 0.2, 9)] }";
    let moving = square("Moving", lines).replacen(
        "    point3f[] points = [(0, 0, 0), (0.2, 0, 0), (0.2, 0.2, 0), (0, 0.2, 0)]\n",
        "",
        1,
    );
    let skinned = square(
        "Skinned",
        "rel skel:skeleton = </S>\n    int[] primvars:skel:jointIndices = [0]\n    token[] skel:blendShapes = [\"worn\"]",
    );
    let smooth = square("Smooth", "").replace("\"none\"", "\"catmullClark\"");
    let others = "def BasisCurves \"Hair\"\n{\n}\ndef PointInstancer \"Buttons\"\n{\n    def Mesh \"Button\"\n    {\n    }\n}\n\
                  class Mesh \"Class\"\n{\n}\ndef Mesh \"Empty\"\n{\n}\n";
    let hidden = square("Hidden", "token visibility = \"invisible\"")
        + &square("Guide", "uniform token purpose = \"guide\"");
    let (asset, diagnostics) = read(&format!("{METRES}{moving}{skinned}{smooth}{others}{hidden}"));
    let names: Vec<&str> = asset.pieces.iter().map(|p| p.name.as_str()).collect();
    assert_eq!(names, ["Moving", "Skinned", "Smooth"]);
    assert_eq!(corner(&asset, 0, 1), [0.3, 0.0, 0.0], "of the earliest time");
    let mut list = String::new();
    for d in &diagnostics {
        let _ = writeln!(list, "{:?} {}: {}", d.severity, d.location, d.message);
    }
    for expected in [
        "Warning /Moving: 1 meshes change over time",
        "Warning /Skinned: 1 meshes have a skeleton, which is not read",
        "Warning /Skinned: 1 meshes have blend shapes",
        "Note /Smooth: 1 meshes are to be subdivided (catmullClark)",
        "Note /Hair: 1 prims of the type BasisCurves are skipped",
        "Warning /Buttons: 1 point instancers are skipped",
        "Note /Class: 1 prims that are inactive, abstract or undefined are skipped",
        "Note /Empty: 1 meshes without faces are skipped",
        "Note /Hidden: 1 meshes are invisible",
        "Note /Guide: 1 meshes have the purpose \"guide\"",
    ] {
        assert!(list.contains(expected), "{expected} in\n{list}");
    }
}

#[test]
fn references_payloads_sublayers_and_variants_are_composed() {
    let sleeve = format!("#usda 1.0\n(\n    defaultPrim = \"Sleeve\"\n)\n{}", square("Sleeve", ""));
    let cuffs = format!("#usda 1.0\n{}", square("Cuff", ""));
    let base = format!("#usda 1.0\n{}", square("Body", ""));
    let text = "#usda 1.0\n(\n    metersPerUnit = 1\n    subLayers = [@./base.usda@]\n)\n\
        def \"Left\" ( prepend references = @parts/sleeve.usda@ )\n{\n}\n\
        def \"Right\" ( instanceable = true\n prepend references = @parts/sleeve.usda@ )\n{\n}\n\
        def \"Cuffs\" ( prepend payload = @./parts/cuffs.usda@</Cuff> )\n{\n}\n\
        def \"Lost\" ( prepend references = @missing.usda@</A> )\n{\n}\n";
    let files = [("base.usda", &*base), ("parts/sleeve.usda", &*sleeve), ("parts/cuffs.usda", &*cuffs)];
    let (asset, diagnostics) = read_with(text, &ReadOptions::default(), &files).expect("is read");
    let mut names: Vec<&str> = asset.pieces.iter().map(|p| p.name.as_str()).collect();
    names.sort_unstable();
    assert_eq!(names, ["Body", "Cuffs", "Left", "Right"]);
    let lost = diagnostics.iter().find(|d| d.message.contains("missing.usda")).expect("is told");
    assert_eq!(lost.severity, Severity::Warning);
    assert!(
        lost.message.contains("/Lost") && lost.message.contains("there is no such file"),
        "{}",
        lost.message
    );
    assert!(lost.message.contains("usdcat --flatten"), "{}", lost.message);
    // A stage of missing files has nothing to read, and says which.
    let lost = "#usda 1.0\ndef \"Lost\" ( prepend references = @missing.usda@ )\n{\n}\n";
    assert!(refusal(lost).contains("missing.usda"), "{}", refusal(lost));
    // Damaged references are warned about, circles end.
    let circle = format!(
        "{METRES}def \"A\" ( references = </A/B> )\n{{\n    def \"B\" ( references = </A> )\n    {{\n    }}\n}}\n{}",
        square("C", "")
    );
    let (asset, diagnostics) = read(&circle);
    assert_eq!(asset.pieces.len(), 1);
    assert!(said(&diagnostics, "cycle"), "{diagnostics:?}");
    let damaged = [("base.usda", "#usda 1.0\ndef {")];
    let text =
        format!("#usda 1.0\n(\n    metersPerUnit = 1\n    subLayers = [@base.usda@]\n)\n{}", square("C", ""));
    let (_, diagnostics) = read_with(&text, &ReadOptions::default(), &damaged).expect("is read");
    assert!(said(&diagnostics, "base.usda"), "{diagnostics:?}");
    // References of references, without end: refused, not composed for ever.
    let mut text = METRES.to_owned() + &square("P0", "");
    for k in 1..24 {
        let _ = writeln!(
            text,
            "def \"P{k}\"\n{{\n    def \"A\" ( references = </P{0}> )\n    {{\n    }}\n    def \"B\" ( references = </P{0}> )\n    {{\n    }}\n}}",
            k - 1
        );
    }
    let began = std::time::Instant::now();
    assert!(read_with(&text, &ReadOptions::default(), &[]).is_err());
    assert!(began.elapsed().as_secs() < 60, "{:?}", began.elapsed());
}

#[test]
fn damaged_meshes_are_refused_with_their_place() {
    let broken = |from: &str, to: &str| {
        assert!(square("A", "").contains(from), "{from}");
        refusal(&format!("{METRES}{}", square("A", "").replace(from, to)))
    };
    for (from, to, expected) in [
        ("faceVertexCounts = [4]", "faceVertexCounts = [5]", "/A.faceVertexIndices: has 4 corners"),
        ("faceVertexCounts = [4]", "faceVertexCounts = [-4]", "/A.faceVertexCounts[0]: a face of -4 corners"),
        ("[0, 1, 2, 3]", "[0, 1, 2, 4]", "/A.faceVertexIndices[3]: 4 is out of range: the mesh has 4 points"),
        ("[0, 1, 2, 3]", "[0, 1, 2, -1]", "/A.faceVertexIndices[3]"),
        ("(0.2, 0.2, 0)", "(nan, 0.2, 0)", "/A.points[2]: (NaN, 0.2"),
        ("(0.2, 0.2, 0)", "(0.2, inf, 0)", "/A.points[2]"),
        (
            "point3f[] points",
            "point3f[] pointz",
            "/A.faceVertexIndices[0]: 0 is out of range: the mesh has 0 points",
        ),
        ("def Mesh", "def Xform", "there are no triangles in it"),
    ] {
        let message = broken(from, to);
        assert!(message.contains(expected), "{expected} in {message}");
        assert!(message.contains("folder/shirt.usda") && message.ends_with(')'), "{message}");
    }
    assert!(refusal("#usda 1.0\n").contains("no triangles"));
    assert!(refusal("").contains("neither"), "{}", refusal(""));
    assert!(refusal(&format!("#usda 1.0\n{}", "def \"A\" {".repeat(5000))).contains("nested"));
    // A damaged mesh beside the garment is left out where the garment is named.
    let text = format!("{METRES}{}{}", square("A", ""), square("B", "").replace("[4]", "[5]"));
    let options = ReadOptions { garment: Some("A".into()), ..ReadOptions::default() };
    let (_, diagnostics) = read_with(&text, &options, &[]).expect("is read");
    assert!(said(&diagnostics, "\"B\" cannot be read"), "{diagnostics:?}");
    assert!(refusal(&text).contains("ReadOptions::garment"));
}

/// Counts of 10^12 and offsets beyond the file in a USDC: no memory is asked for beyond the size of the file.
#[test]
fn counts_that_lie_in_a_binary_file_are_refused() {
    let folder =
        std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("tests/fuzz/seeds/usd");
    let bytes = std::fs::read(folder.join("square.usdc")).expect("reads");
    let read = |bytes: &[u8]| {
        read_asset("a.usdc", bytes, &ReadOptions::default(), &mut |name| {
            Err(Error::input(name, "", "none", ""))
        })
    };
    assert!(read(&bytes).is_ok());
    let mut refused = 0;
    for at in 0..bytes.len() - 8 {
        for lie in [1_000_000_000_000u64, u64::from(u32::MAX), u64::MAX, 1 << 47] {
            let mut lying = bytes.clone();
            lying[at..at + 8].copy_from_slice(&lie.to_le_bytes());
            let outcome = read(&lying);
            refused += usize::from(outcome.is_err());
            let message = outcome.err().map(|error| error.to_string()).unwrap_or_default();
            assert!(!message.contains("reader stopped"), "{at}, {lie}: {message}");
        }
    }
    assert!(refused > bytes.len(), "{refused}");
}

/// A sheet: points [m], y up, their texture coordinates, corners of its squares.
struct Sheet {
    points: Vec<[f64; 3]>,
    uvs: Vec<[f64; 2]>,
    squares: Vec<[usize; 4]>,
}

/// Makes a sheet of 12 x 12 squares of 25 mm that is bent a little.
fn sheet() -> Sheet {
    let n = 12;
    let row = n + 1;
    let (mut points, mut uvs, mut squares) = (Vec::new(), Vec::new(), Vec::new());
    for (j, i) in (0..row).flat_map(|j| (0..row).map(move |i| (j, i))) {
        let [u, v] = [i, j].map(|k| k as f64 / n as f64);
        points.push([0.3 * u, 0.0625 * (v - 0.5) * (v - 0.5), 0.3 * v]);
        uvs.push([u, v]);
    }
    for (j, i) in (0..n).flat_map(|j| (0..n).map(move |i| (j, i))) {
        let a = j * row + i;
        squares.push([a, a + row, a + row + 1, a + 1]);
    }
    // Points in the order of their first corner: that of vertices, and so of what `--export obj` writes of both formats.
    let mut order: Vec<usize> = Vec::new();
    for p in squares.iter().flatten() {
        if !order.contains(p) {
            order.push(*p);
        }
    }
    let number = |p: usize| order.iter().position(|old| *old == p).expect("is used");
    let squares = squares.iter().map(|s| s.map(number)).collect();
    Sheet {
        points: order.iter().map(|p| points[*p]).collect(),
        uvs: order.iter().map(|p| uvs[*p]).collect(),
        squares,
    }
}

fn sheet_obj() -> String {
    let Sheet { points, uvs, squares } = sheet();
    let mut text = String::new();
    for [x, y, z] in points {
        let _ = writeln!(text, "v {x} {y} {z}");
    }
    for [u, v] in uvs {
        let _ = writeln!(text, "vt {u} {v}");
    }
    for s in squares {
        let [a, b, c, d] = s.map(|k| k + 1);
        let _ = writeln!(text, "f {a}/{a} {b}/{b} {c}/{c} {d}/{d}");
    }
    text
}

/// The sheet as USD; `write` gives the file's coordinates of a point.
fn sheet_usda(header: &str, write: impl Fn([f64; 3]) -> [f64; 3]) -> String {
    let Sheet { points, uvs, squares } = sheet();
    let points: Vec<String> =
        points.into_iter().map(write).map(|[x, y, z]| format!("({x}, {y}, {z})")).collect();
    let uvs: Vec<String> = uvs.iter().map(|[u, v]| format!("({u}, {v})")).collect();
    let corners: Vec<String> = squares.iter().flatten().map(usize::to_string).collect();
    format!(
        "#usda 1.0\n({header})\ndef Mesh \"sheet\"\n{{\n    point3d[] points = [{}]\n    int[] faceVertexCounts = [{}]\n    \
         int[] faceVertexIndices = [{}]\n    texCoord2d[] primvars:st = [{}] ( interpolation = \"vertex\" )\n    \
         uniform token subdivisionScheme = \"none\"\n}}\n",
        points.join(", "),
        vec!["4"; squares.len()].join(", "),
        corners.join(", "),
        uvs.join(", ")
    )
}

/// Worn positions [m] that `--export obj` wrote beside `name`.
fn worn(folder: &std::path::Path, name: &str) -> Vec<f64> {
    let text = std::fs::read_to_string(folder.join(format!("{name}-worn.worn.obj"))).expect("reads");
    let lines = text.lines().filter_map(|line| line.strip_prefix("v "));
    lines.flat_map(|line| line.split(' ').map(|x| x.parse::<f64>().expect("a number"))).collect()
}

#[test]
fn the_same_sheet_is_worn_alike_from_obj_and_usd() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    let own = std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("garments/wear");
    write(at, "sheet.obj", sheet_obj());
    write(at, "metres.usda", sheet_usda("metersPerUnit = 1\nupAxis = \"Y\"", |p| p));
    write(
        at,
        "centimetres.usda",
        sheet_usda("metersPerUnit = 0.01\nupAxis = \"Z\"", |[x, y, z]| [100.0 * x, -100.0 * z, 100.0 * y]),
    );
    std::fs::copy(own.join("press-crease.json"), at.join("wear.json")).expect("copies");
    for name in ["sheet.obj", "metres.usda", "centimetres.usda"] {
        let stem = name.split('.').next().expect("a name");
        let line =
            format!("bake {name} --wear wear.json --quality draft --export obj,usd -o {stem}-worn.glb");
        let (_, error, code) = crease_in(at, &line);
        assert_eq!(code, 0, "{error}");
        assert!(!error.contains("unit"), "{error}");
    }
    let reference = worn(at, "sheet");
    let height = reference.iter().skip(1).step_by(3).fold(0.0f64, |most, y| most.max(y.abs()));
    assert!(height > 1e-3, "something is remembered: {height}");
    // Units and axes round the last digits, and an iteration may then stop elsewhere; the README states how far whole events agree.
    assert!(worn(at, "metres") == reference, "the same numbers give the same garment");
    let other = worn(at, "centimetres");
    assert_eq!(other.len(), reference.len());
    let distance = other.iter().zip(&reference).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(distance < 2e-3, "{distance}");
    // What is written as USD is read again: the shape of the file, without guide and blend shape.
    let (out, error, code) = crease_in(at, "inspect metres.usda");
    assert_eq!(code, 0, "{error}");
    let (again, error, code) = crease_in(at, "inspect metres-worn.usda");
    assert_eq!(code, 0, "{error}");
    for line in out.lines().filter(|line| line.contains("hinges") || line.contains("box")) {
        assert!(again.contains(line), "{line} in\n{again}");
    }
    assert!(again.contains("blend shapes") && again.contains("purpose \"guide\""), "{again}");
}

#[test]
fn text_binary_and_package_are_one_mesh() {
    let folder =
        std::path::Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("tests/fuzz/seeds/usd");
    let read = |name: &str| {
        let bytes = std::fs::read(folder.join(name)).expect("reads");
        let (asset, _) =
            read_asset(name, &bytes, &ReadOptions::default(), &mut |_| unreachable!()).expect("is read");
        asset
    };
    let text = read("square.usda");
    assert_eq!(
        text.pieces.iter().map(|p| p.material.as_deref()).collect::<Vec<_>>(),
        [Some("Cotton"), Some("Rib")]
    );
    for other in [read("square.usdc"), read("square.usdz")] {
        assert_eq!((other.unit_m, other.up), (text.unit_m, text.up));
        for (a, b) in text.pieces.iter().zip(&other.pieces) {
            assert_eq!(
                (&a.positions, &a.uvs, &a.triangles, &a.material),
                (&b.positions, &b.uvs, &b.triangles, &b.material)
            );
        }
    }
}

#[test]
fn a_usd_file_is_a_body_that_does_not_move() {
    let folder = tempfile::tempdir().expect("a folder");
    let at = folder.path();
    write(at, "sheet.obj", sheet_obj());
    let table = "#usda 1.0\n(\n    metersPerUnit = 0.01\n)\ndef Mesh \"Table\"\n{\n    \
        point3f[] points = [(-10, -2, -10), (-10, -2, 40), (40, -2, 40), (40, -2, -10)]\n    \
        int[] faceVertexCounts = [4]\n    int[] faceVertexIndices = [0, 1, 2, 3]\n    \
        uniform token subdivisionScheme = \"none\"\n}\n";
    write(at, "table.usda", table);
    write_script(at, "wear.json", r#"{"hold": {"for": 0.1}}"#);
    let (_, error, code) = crease_in(
        at,
        "bake sheet.obj --unit m --body table.usda --wear wear.json --quality draft -o out.glb",
    );
    assert!(code == 0 || code == 3, "{error}");
    assert!(!error.contains("--body-unit"), "its unit is its own: {error}");
}
