//! Reads the bytes of a mesh file to a [`SourceAsset`]: detects the format, calls its reader, decides which pieces are
//! worn, and rejects a garment of implausible size before it is simulated.
//!
//! First stage of the pipeline. A wrong unit is the most common error of garment files (centimetres read as metres) and
//! would still run, with wrong results; so an implausible size must be confirmed by stating the unit.
//! Opens no files: files that a document refers to come through `resolve`.

use crate::garment::{ImportDiagnostic, SourceAsset, SourceFormat, UpAxis};
use crate::io::error_list::ErrorList;
use crate::io::pieces::{NamedPiece, to_scene};
use crate::io::tuning::TUNING;
use crate::io::{gltf, obj};
use crate::math::Vec3;
use crate::{Error, Result};
use sha2::{Digest, Sha256};

/// Longest file [bytes]: indices have 32 bits, and a file this long cannot overflow them.
const MAX_FILE_BYTES: usize = u32::MAX as usize;

/// Options of reading a mesh file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadOptions {
    /// Metres per file unit; 1 when not given, and then the garment's size must be plausible.
    pub unit_m: Option<f64>,
    /// Up axis of the file; y when not given.
    pub up: Option<UpAxis>,
    /// Worn part: name of a node, mesh, group, object or material; everything when not given.
    pub garment: Option<String>,
    /// Vertex attribute that scales the memory locally: `COLOR_0`, `COLOR_0.g`, `_PIN`, ...; of an OBJ
    /// `COLOR_0`. A component is chosen by `.r .g .b .a` or `.x .y .z .w`, else the first is taken.
    pub mask: Option<String>,
    /// Distance within which vertices on borders are joined [m]; that of rounding when not given.
    pub weld_m: Option<f64>,
}

/// Reads the mesh file `bytes`, named `file_name` in messages; also returns repairs and notes. `resolve` returns the bytes
/// of a file that the document refers to by a relative address (a glTF's .bin).
///
/// ```
/// use crease::{GarmentFile, ReadOptions};
/// let obj = "v 0 0 0\nv 20 0 0\nv 20 0 20\nf 1 3 2\n";
/// let centimetres = ReadOptions { unit_m: Some(0.01), ..ReadOptions::default() };
/// let file = GarmentFile::parse("corner.obj", obj.as_bytes(), &centimetres)?;
/// assert!((file.garment.points[1].x - 0.2).abs() < 1e-12);
/// # Ok::<(), crease::Error>(())
/// ```
pub fn read_asset(
    file_name: &str,
    bytes: &[u8],
    options: &ReadOptions,
    resolve: &mut dyn FnMut(&str) -> Result<Vec<u8>>,
) -> Result<(SourceAsset, Vec<ImportDiagnostic>)> {
    let mut errors = ErrorList::new(file_name);
    let unit_m = options.unit_m.unwrap_or(1.0);
    if !TUNING.unit_m.contains(&unit_m) {
        errors.push(
            "",
            format!("{unit_m} metres per unit cannot be"),
            "give --unit m, dm, cm, mm, in or metres",
        );
    }
    if bytes.len() > MAX_FILE_BYTES {
        errors.push("", "longer than 4 GiB", "split it, or leave out what is not the garment");
    }
    errors.finish()?;
    let up = options.up.unwrap_or(UpAxis::Y);
    let format = format_of(file_name, bytes)?;
    let to_scene = to_scene(unit_m, up);
    let read = match format {
        SourceFormat::Obj => obj::read_obj(file_name, bytes, &to_scene, options.mask.as_deref())?,
        SourceFormat::Gltf => gltf::read_gltf(file_name, bytes, &to_scene, options.mask.as_deref(), resolve)?,
    };
    if read.pieces.iter().all(|named| named.piece.triangles.is_empty()) {
        // The notes say what was skipped.
        let notes: Vec<&str> =
            read.diagnostics.iter().take(5).map(|diagnostic| diagnostic.message.as_str()).collect();
        let notes = if notes.is_empty() { String::new() } else { format!(": {}", notes.join(", ")) };
        let message = format!("there are no triangles in it{notes}");
        return Err(Error::input(file_name, "", message, "export the garment as a mesh"));
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
    check_coordinates(&asset)?;
    if options.unit_m.is_none() {
        check_size(&asset)?;
    }
    Ok((asset, read.diagnostics))
}

/// Detects the format by the content, then by the name; anything else is tried as OBJ, the only format without a signature.
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

/// Marks the pieces named `garment` as worn, and no others.
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
        if !names.contains(&name.as_str()) && names.len() <= TUNING.max_listed_names {
            names.push(name);
        }
    }
    let more = if names.len() > TUNING.max_listed_names { ", and more" } else { "" };
    names.truncate(TUNING.max_listed_names);
    Err(Error::input(
        file,
        "",
        format!("no garment called \"{wanted}\" in it"),
        format!("--garment takes one of: {}{more}", names.join(", ")),
    ))
}

/// Rejects coordinates that are not numbers or implausibly large.
fn check_coordinates(asset: &SourceAsset) -> Result<()> {
    let mut errors = ErrorList::new(&asset.file);
    for piece in &asset.pieces {
        let near = |p: Vec3| p.iter().all(|x| x.abs() <= TUNING.max_coordinate_m);
        let far = (0..piece.positions.len()).find(|&v| !piece.scene_position(v).is_some_and(near));
        if let Some(v) = far {
            errors.push(
                format!("piece \"{}\", vertex {v}", piece.name),
                "its position is not a number, or more than a million kilometres away",
                "correct the vertex, or the transforms above it",
            );
        }
    }
    errors.finish()
}

/// Rejects a garment of implausible size, as its unit is probably another one.
fn check_size(asset: &SourceAsset) -> Result<()> {
    let Some((low, high)) = asset.worn_bounds() else { return Ok(()) };
    let size = high - low;
    if TUNING.garment_side_m.contains(&size.max()) {
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
