//! A mesh file's bytes to a [`SourceAsset`]: finds out the format, hands over to its reader, decides which pieces are
//! worn, and refuses a garment of impossible size before anyone simulates it.
//!
//! First stage of the pipeline. A wrong unit is the commonest fault of garment files (centimetres read as metres) and
//! still runs, only wrongly; so a size no garment has must be confirmed by naming the unit.
//! Opens no files: what a document refers to comes through `resolve`.

use crate::garment::{ImportDiagnostic, SourceAsset, SourceFormat, SourcePiece, UpAxis};
use crate::io::diagnostics::DiagnosticList;
use crate::io::{gltf, obj};
use crate::math::{Mat4, Vec3};
use crate::{Error, Result};
use sha2::{Digest, Sha256};

/// The largest side of a garment's box [m] that is taken without question: a sock and a wedding train.
const GARMENT_SIDE_M: std::ops::RangeInclusive<f64> = 0.05..=5.0;
/// Metres per unit that can be asked for: a micrometre to a thousand kilometres.
const UNIT_M: std::ops::RangeInclusive<f64> = 1e-6..=1e6;
/// Coordinates beyond this [m] are damage, and their products would leave what numbers can hold.
const FARTHEST_M: f64 = 1e9;
/// Indices are 32 bits wide; a file this long cannot overflow them.
const LONGEST_FILE: usize = u32::MAX as usize;
/// Names listed in a message.
const NAMES_TOLD: usize = 40;

/// What a user may say about a mesh file.
///
/// ```
/// use crease::{GarmentFile, ReadOptions};
/// let obj = "v 0 0 0\nv 20 0 0\nv 20 0 20\nf 1 3 2\n";
/// let centimetres = ReadOptions { unit_m: Some(0.01), ..ReadOptions::default() };
/// let file = GarmentFile::parse("corner.obj", obj.as_bytes(), &centimetres)?;
/// assert!((file.garment.points[1].x - 0.2).abs() < 1e-12);
/// # Ok::<(), crease::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadOptions {
    /// Metres per file unit; 1 when not given, and then the garment's size is questioned.
    pub unit_m: Option<f64>,
    /// The file's up axis; y when not given.
    pub up: Option<UpAxis>,
    /// What to wear: name of a node, mesh, group, object or material; everything when not given.
    pub garment: Option<String>,
    /// Vertex attribute that scales how much a place remembers: `COLOR_0`, `COLOR_0.g`, `_PIN`, ...; of an OBJ
    /// `COLOR_0`. A component is chosen by `.r .g .b .a` or `.x .y .z .w`, else the first is taken.
    pub mask: Option<String>,
}

/// What a format's reader hands back.
pub(super) struct ReadPieces {
    /// Pieces in file order, all marked as worn.
    pub(super) pieces: Vec<NamedPiece>,
    /// The document, for glTF.
    pub(super) document: Option<crate::garment::GltfDocument>,
    /// What was noticed.
    pub(super) findings: Vec<ImportDiagnostic>,
}

/// A piece and every name it answers to.
pub(super) struct NamedPiece {
    pub(super) piece: SourcePiece,
    pub(super) names: Vec<String>,
}

/// The mesh file `bytes`, named `file_name` in messages, and what was noticed in it. `resolve` gives the bytes of
/// what the document refers to by a relative address (a glTF's .bin).
pub fn read_asset(
    file_name: &str,
    bytes: &[u8],
    options: &ReadOptions,
    resolve: &mut dyn FnMut(&str) -> Result<Vec<u8>>,
) -> Result<(SourceAsset, Vec<ImportDiagnostic>)> {
    let mut faults = DiagnosticList::new(file_name);
    let unit_m = options.unit_m.unwrap_or(1.0);
    if !UNIT_M.contains(&unit_m) {
        faults.push(
            "",
            format!("{unit_m} metres per unit cannot be"),
            "give --unit m, dm, cm, mm, in or metres",
        );
    }
    if bytes.len() > LONGEST_FILE {
        faults.push("", "longer than 4 GiB", "split it, or leave out what is not the garment");
    }
    faults.finish()?;
    let up = options.up.unwrap_or(UpAxis::Y);
    let format = format_of(file_name, bytes)?;
    let to_scene = to_scene(unit_m, up);
    let read = match format {
        SourceFormat::Obj => obj::read_obj(file_name, bytes, &to_scene, options.mask.as_deref())?,
        SourceFormat::Gltf => gltf::read_gltf(file_name, bytes, &to_scene, options.mask.as_deref(), resolve)?,
    };
    if read.pieces.iter().all(|named| named.piece.triangles.is_empty()) {
        // What was skipped is why.
        let seen: Vec<&str> = read.findings.iter().take(5).map(|finding| finding.message.as_str()).collect();
        let seen = if seen.is_empty() { String::new() } else { format!(": {}", seen.join(", ")) };
        let what = format!("there are no triangles in it{seen}");
        return Err(Error::input(file_name, "", what, "export the garment as a mesh"));
    }
    let mut pieces = read.pieces;
    choose_worn(file_name, &mut pieces, options.garment.as_deref())?;
    let asset = SourceAsset {
        file: file_name.to_owned(),
        sha256: Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect(),
        format,
        unit_m,
        up,
        document: read.document,
        pieces: pieces.into_iter().map(|named| named.piece).collect(),
    };
    check_reach(&asset)?;
    if options.unit_m.is_none() {
        check_size(&asset)?;
    }
    Ok((asset, read.findings))
}

/// File units and axes to metres, y up.
pub(super) fn to_scene(unit_m: f64, up: UpAxis) -> Mat4 {
    let turned = match up {
        UpAxis::Y => Mat4::identity(),
        UpAxis::Z => Mat4::new(
            1.0, 0.0, 0.0, 0.0, //
            0.0, 0.0, 1.0, 0.0, //
            0.0, -1.0, 0.0, 0.0, //
            0.0, 0.0, 0.0, 1.0,
        ),
    };
    Mat4::new_scaling(unit_m) * turned
}

/// The content decides, then the name; anything else is tried as OBJ, the only format without a mark of its own.
fn format_of(file_name: &str, bytes: &[u8]) -> Result<SourceFormat> {
    let extension = file_name.rsplit_once('.').map(|(_, e)| e.to_ascii_lowercase()).unwrap_or_default();
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let first = text.iter().copied().find(|byte| !byte.is_ascii_whitespace());
    if gltf::is_glb(bytes) || first == Some(b'{') || extension == "gltf" || extension == "glb" {
        return Ok(SourceFormat::Gltf);
    }
    let foreign = ["fbx", "stl", "ply", "dae", "abc", "usd", "usda", "usdc", "usdz", "blend", "3ds", "zprj"];
    if foreign.contains(&extension.as_str()) {
        return Err(Error::input(
            file_name,
            "",
            format!(".{extension} files cannot be read"),
            "export it as glTF (.glb) or OBJ",
        ));
    }
    if bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF") {
        return Err(Error::input(file_name, "byte 0", "the text is UTF-16", "save it as UTF-8"));
    }
    if extension != "obj" && bytes.iter().take(4096).any(|&byte| byte == 0) {
        return Err(Error::input(file_name, "", "neither glTF nor OBJ", "export it as glTF (.glb) or OBJ"));
    }
    Ok(SourceFormat::Obj)
}

/// Leaves `worn` on the pieces that answer to `garment`.
fn choose_worn(file: &str, pieces: &mut [NamedPiece], garment: Option<&str>) -> Result<()> {
    let Some(wanted) = garment else { return Ok(()) };
    for named in pieces.iter_mut() {
        named.piece.worn = named.names.iter().any(|name| name == wanted);
    }
    let worn: usize =
        pieces.iter().filter(|named| named.piece.worn).map(|named| named.piece.triangles.len()).sum();
    if worn > 0 {
        return Ok(());
    }
    let mut names: Vec<&str> = Vec::new();
    for name in pieces.iter().flat_map(|named| &named.names) {
        if !names.contains(&name.as_str()) && names.len() <= NAMES_TOLD {
            names.push(name);
        }
    }
    let more = if names.len() > NAMES_TOLD { ", and more" } else { "" };
    names.truncate(NAMES_TOLD);
    Err(Error::input(
        file,
        "",
        format!("no garment called \"{wanted}\" in it"),
        format!("--garment takes one of: {}{more}", names.join(", ")),
    ))
}

/// Refuses coordinates that are not numbers or absurdly far.
fn check_reach(asset: &SourceAsset) -> Result<()> {
    let mut faults = DiagnosticList::new(&asset.file);
    for piece in &asset.pieces {
        let near = |p: Vec3| p.iter().all(|x| x.abs() <= FARTHEST_M);
        let far = (0..piece.positions.len()).find(|&v| !piece.scene_position(v).is_some_and(near));
        if let Some(v) = far {
            faults.push(
                format!("piece \"{}\", vertex {v}", piece.name),
                "its position is not a number, or more than a million kilometres away",
                "mend the vertex, or the transforms above it",
            );
        }
    }
    faults.finish()
}

/// Refuses a garment no one could wear, as its unit is probably another one.
fn check_size(asset: &SourceAsset) -> Result<()> {
    let Some((low, high)) = asset.worn_bounds() else { return Ok(()) };
    let size = high - low;
    if GARMENT_SIDE_M.contains(&size.max()) {
        return Ok(());
    }
    let units = size / asset.unit_m;
    let fits: Vec<String> = [("m", 1.0), ("dm", 0.1), ("cm", 0.01), ("mm", 0.001), ("in", 0.0254)]
        .iter()
        .filter(|(_, unit)| (0.2..=2.5).contains(&(units.max() * unit)))
        .map(|(name, unit)| format!("--unit {name} makes it {:.2} m", units.max() * unit))
        .collect();
    let hint = if fits.is_empty() { String::new() } else { format!("; {}", fits.join(", ")) };
    Err(Error::input(
        &asset.file,
        "",
        format!(
            "the garment's box is {:.4} x {:.4} x {:.4} in file units, which would be {:.3} x {:.3} x {:.3} m",
            units.x, units.y, units.z, size.x, size.y, size.z
        ),
        format!("say the file's unit with --unit cm, mm, dm, in, m or metres per unit{hint}"),
    ))
}
