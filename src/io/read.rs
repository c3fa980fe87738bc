//! Reads the bytes of a mesh file to a [`SourceAsset`]: detects the format, calls its reader, decides which pieces are
//! worn, and rejects a garment of implausible size before it is simulated.
//!
//! First stage of the pipeline. A wrong unit is the most common error of garment files (centimetres read as metres) and
//! would still run, with wrong results; so an implausible size is refused (`size`).
//! Opens no files: files that a document refers to come through `resolve`.

use crate::choose_worn::{choose_worn, labels_of};
use crate::error_list::ErrorList;
use crate::pieces::{DamagedPiece, FileFrame, MASK_SETTINGS, NamedPiece};
use crate::size::check_size;

use crate::{gltf, obj, usd};
use crease_geometry::math::Vec3;
use crease_model::error::{Error, Message, Result, Setting};
use crease_model::garment::{
    ImportDiagnostic, Severity, SourceAsset, SourceFormat, SourcePiece, UpAxis, is_in_range,
    is_plausible_unit,
};
use crease_model::json::{FileKind, kind_of_file};
use sha2::{Digest, Sha256};
use std::path::PathBuf;

/// Longest file [bytes]: indices have 32 bits, and a file this long cannot overflow them.
const MAX_FILE_BYTES: usize = u32::MAX as usize;

/// Options of reading a mesh file.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct ReadOptions {
    /// Metres per file unit; when not given that of a USD stage, otherwise 1.
    pub unit_m: Option<f64>,
    /// Up axis of the file; when not given that of a USD stage, otherwise y.
    pub up: Option<UpAxis>,
    /// Worn parts: the name of a node, mesh, group, object or material, NAME:MATERIAL, `piece#3` as `inspect` numbers them, or
    /// several of these with commas between them; everything when not given.
    pub garment: Option<String>,
    /// Vertex attribute that scales the memory locally: `COLOR_0`, `COLOR_0.g`, `_PIN`, ...; of an OBJ
    /// `COLOR_0`; of USD a primvar, where `COLOR_0` is `displayColor`. A component is chosen by `.r .g .b .a` or `.x .y .z .w`, else the first is taken.
    pub mask: Option<String>,
    /// Vertex attribute that scales hems and seams locally, named as `mask` is: 0 for single cloth.
    pub sewing_mask: Option<String>,
    /// Whether the garment may have a size that no garment has.
    pub any_size: bool,
    /// Whether parts that cannot be read are left out, with a warning, even if they are part of the garment.
    pub skip_damaged: bool,
    /// Distance within which vertices on borders are joined [m]; that of rounding when not given.
    pub weld_m: Option<f64>,
    /// Folder besides that of the file from which it may read others; for callers that open files.
    pub allow_folder: Option<PathBuf>,
}

/// Fetches a file that a document refers to: by its name, relative to the document, and the number of bytes from its start that are
/// needed; all where the document does not say.
pub type Resolve<'a> = dyn FnMut(&str, Option<u64>) -> Result<Vec<u8>> + 'a;

/// Reads the mesh file `bytes`, named `file_name` in messages; also returns repairs and notes. `resolve` returns the bytes
/// of a file that the document refers to by a relative address (a glTF's .bin, a layer of a USD stage).
///
/// ```
/// use crease_io::{ReadOptions, read_asset};
/// let obj = "v 0 0 0\nv 20 0 0\nv 20 0 20\nf 1 3 2\n";
/// let centimetres = ReadOptions { unit_m: Some(0.01), ..ReadOptions::default() };
/// let (asset, _) = read_asset("corner.obj", obj.as_bytes(), &centimetres, &mut |_| Ok(Vec::new()))?;
/// assert!((asset.pieces[0].scene_position(1).expect("is a vertex").x - 0.2).abs() < 1e-12);
/// # Ok::<(), crease_model::error::Error>(())
/// ```
pub fn read_asset(
    file_name: &str,
    bytes: &[u8],
    options: &ReadOptions,
    resolve: &mut dyn FnMut(&str) -> Result<Vec<u8>>,
) -> Result<(SourceAsset, Vec<ImportDiagnostic>)> {
    read_asset_with(file_name, bytes, options, &mut |name, _| resolve(name))
}

/// Does what [`read_asset`] does, and says how much of a file is needed before it is read.
///
/// # Errors
/// [`Error::Input`] with every problem of the file.
pub fn read_asset_with(
    file_name: &str,
    bytes: &[u8],
    options: &ReadOptions,
    resolve: &mut Resolve,
) -> Result<(SourceAsset, Vec<ImportDiagnostic>)> {
    let mut errors = ErrorList::new(file_name);
    let unit_m = options.unit_m.unwrap_or(1.0);
    let up = options.up.unwrap_or(UpAxis::Y);
    if !is_plausible_unit(unit_m) {
        errors.push(
            "",
            format!("{unit_m} metres per unit cannot be"),
            Message::from("give ") + Setting::Unit + " m, dm, cm, mm, in or metres",
        );
    }
    if bytes.len() > MAX_FILE_BYTES {
        errors.push("", "longer than 4 GiB", "split it, or leave out what is not the garment");
    }
    errors.finish()?;
    let format = format_of(file_name, bytes)?;
    let to_scene = up.to_scene(unit_m);
    let masks = [&options.mask, &options.sewing_mask].map(|name| name.as_deref());
    let mut read = match format {
        SourceFormat::Obj | SourceFormat::Arrays => obj::read_obj(file_name, bytes, &to_scene, masks)?,
        SourceFormat::Gltf => gltf::read_gltf(file_name, bytes, &to_scene, masks, resolve)
            .map_err(|error| no_mesh(file_name, bytes).unwrap_or(error))?,
        #[cfg(feature = "usd")]
        SourceFormat::Usd => {
            let whole = &mut |name: &str| resolve(name, None);
            usd::read_usd(file_name, bytes, (options.unit_m, options.up), masks, whole)?
        }
        #[cfg(not(feature = "usd"))]
        SourceFormat::Usd => {
            let cure = "export it as glTF (.glb) or OBJ, or use a build with the feature `usd`";
            return Err(Error::input(file_name, "", "this build reads no USD files", cure));
        }
    };
    let has_triangles = |named: &NamedPiece| !named.piece.triangles.is_empty();
    let has_others = read.pieces.iter().any(has_triangles);
    read.diagnostics.extend(check_damaged(file_name, read.damaged, options, has_others)?);
    if !has_others {
        // The notes say what was skipped.
        let notes = read.diagnostics.iter().take(5).map(|diagnostic| diagnostic.message.clone());
        let start = Message::from("there are no triangles in it");
        let message = match Message::join(notes, ", ") {
            notes if notes.is_empty() => start,
            notes => start + ": " + notes,
        };
        return Err(Error::input(file_name, "", message, "export the garment as a mesh"));
    }
    let mut pieces = read.pieces;
    for (setting, of) in MASK_SETTINGS.into_iter().zip([mask_of, sewing_mask_of]) {
        read.diagnostics.extend(scale_mask(setting, &mut pieces, of));
    }
    read.diagnostics.extend(choose_worn(file_name, &mut pieces, options.garment.as_deref())?);
    let frame = read.frame.unwrap_or(FileFrame { unit_m, up, states_unit: false });
    let asset = SourceAsset {
        file: file_name.to_owned(),
        sha256: Sha256::digest(bytes).iter().map(|byte| format!("{byte:02x}")).collect(),
        format,
        unit_m: frame.unit_m,
        unit_is_known: options.unit_m.is_some() || frame.states_unit,
        up: frame.up,
        document: read.document,
        obj: read.obj,
        pieces: pieces.into_iter().map(|named| named.piece).collect(),
    };
    check_coordinates(&asset)?;
    if !options.any_size {
        read.diagnostics.extend(check_size(&asset)?);
    }
    read.diagnostics.extend(gltf::earlier_wear_note(&asset));
    Ok((asset, read.diagnostics))
}

/// Returns the error of a file that is another of this crate's formats and no mesh.
fn no_mesh(file_name: &str, bytes: &[u8]) -> Option<Error> {
    let kind = kind_of_file(bytes).filter(|kind| !kind.is_mesh())?;
    let help = match kind {
        FileKind::Sidecar | FileKind::Report => "give the worn mesh that was written beside it",
        _ => "give the mesh file here",
    };
    Some(Error::input(file_name, "", format!("is {kind}, not a mesh"), help))
}

/// Detects the format by the content, then by the name; anything else is tried as OBJ, the only format without a signature.
fn format_of(file_name: &str, bytes: &[u8]) -> Result<SourceFormat> {
    let extension = file_name.rsplit_once('.').map(|(_, e)| e.to_ascii_lowercase()).unwrap_or_default();
    let text = bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes);
    let first = text.iter().copied().find(|byte| !byte.is_ascii_whitespace());
    if gltf::is_glb(bytes) || first == Some(b'{') || extension == "gltf" || extension == "glb" {
        return Ok(SourceFormat::Gltf);
    }
    if usd::is_usd(text) || usd::FILE_EXTENSIONS.contains(&extension.as_str()) {
        return Ok(SourceFormat::Usd);
    }
    let foreign = ["fbx", "stl", "ply", "dae", "abc", "blend", "3ds", "zprj"];
    if foreign.contains(&extension.as_str()) {
        return Err(Error::input(
            file_name,
            "",
            format!(".{extension} files cannot be read"),
            "export it as glTF (.glb), USD or OBJ",
        ));
    }
    if bytes.starts_with(b"\xFF\xFE") || bytes.starts_with(b"\xFE\xFF") {
        return Err(Error::input(file_name, "byte 0", "the text is UTF-16", "save it as UTF-8"));
    }
    if extension != "obj" && bytes.iter().take(4096).any(|&byte| byte == 0) {
        return Err(Error::input(
            file_name,
            "",
            "neither glTF nor USD nor OBJ",
            "export it as glTF (.glb), USD or OBJ",
        ));
    }
    Ok(SourceFormat::Obj)
}

/// Rejects the parts that cannot be read if they were asked for; returns warnings about the others, which are left as they
/// are.
fn check_damaged(
    file: &str,
    damaged: Vec<DamagedPiece>,
    options: &ReadOptions,
    has_others: bool,
) -> Result<Vec<ImportDiagnostic>> {
    let garment = options.garment.as_deref();
    let (mut errors, mut warnings) = (ErrorList::new(file), Vec::new());
    let labels =
        garment.map(|garment| std::iter::once(garment).chain(labels_of(garment)).collect::<Vec<_>>());
    for piece in damaged {
        let is_called = |label: &&str| {
            piece.names.iter().any(|name| name == label || label.starts_with(&format!("{name}:")))
        };
        let is_asked_for = labels.as_ref().is_none_or(|labels| labels.iter().any(is_called));
        if is_asked_for && !(options.skip_damaged && has_others) {
            for error in piece.errors {
                let help = match garment {
                    None if has_others => {
                        error.help + ", or leave it out by naming the garment with " + Setting::Garment
                    }
                    _ => error.help,
                };
                errors.push(error.location, error.message, help);
            }
        } else if let Some(error) = piece.errors.into_iter().next() {
            let name = piece.names.into_iter().next().unwrap_or_default();
            warnings.push(ImportDiagnostic {
                severity: Severity::Warning,
                location: error.location,
                message: Message::from(format!("\"{name}\" cannot be read and is left as it is: "))
                    + error.message,
            });
        }
    }
    errors.finish()?;
    Ok(warnings)
}

fn mask_of(piece: &mut SourcePiece) -> Option<&mut Vec<f64>> {
    piece.mask.as_mut()
}

fn sewing_mask_of(piece: &mut SourcePiece) -> Option<&mut Vec<f64>> {
    piece.sewing_mask.as_mut()
}

/// Converts the mask of `setting` to factors 0..1: whole numbers beyond 1 are bytes or words of a colour; returns a warning then. `of`
/// gives the mask of a piece.
fn scale_mask(
    setting: Setting,
    pieces: &mut [NamedPiece],
    of: fn(&mut SourcePiece) -> Option<&mut Vec<f64>>,
) -> Option<ImportDiagnostic> {
    let (mut max, mut are_whole) = (0.0_f64, true);
    for value in pieces.iter_mut().filter_map(|named| of(&mut named.piece)).flatten() {
        max = if value.is_finite() { max.max(*value) } else { max };
        are_whole &= value.fract() == 0.0;
    }
    let full = match max {
        _ if max <= 1.0 || !are_whole => 1.0,
        _ if max <= 255.0 => 255.0,
        _ => 65_535.0,
    };
    for value in pieces.iter_mut().filter_map(|named| of(&mut named.piece)).flatten() {
        *value = if value.is_finite() { (*value / full).clamp(0.0, 1.0) } else { 1.0 };
    }
    (max > 1.0).then(|| ImportDiagnostic {
        severity: Severity::Warning,
        location: String::new(),
        message: match full {
            1.0 => {
                Message::from(setting) + format!(": it has values up to {max}, and those above 1 count as 1")
            }
            _ => {
                Message::from(setting)
                    + format!(": it has whole numbers up to {max}, which count as fractions of {full}")
            }
        },
    })
}

/// Rejects coordinates that are not numbers or implausibly large.
fn check_coordinates(asset: &SourceAsset) -> Result<()> {
    let mut errors = ErrorList::new(&asset.file);
    for piece in asset.worn_pieces() {
        let is_near = |p: Vec3| is_in_range(&p);
        let far = (0..piece.positions.len()).find(|&v| !piece.scene_position(v).is_some_and(is_near));
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
