//! Reads the meshes of a USD file: .usda, .usdc, .usd and .usdz, with the layers that it refers to.
//!
//! The stage is composed in memory ([`stage`], the door of the package `openusd`), its prims are walked ([`walk`]), and every mesh
//! that is shown becomes pieces ([`mesh`], [`pieces`]). Skeletons, blend shapes, animation, subdivision and geometry other than
//! meshes are left out, which is said. Unit and up axis are those of the stage unless the caller gives others.

mod binary;
mod binary_reader;
mod binary_values;
mod layers;
mod mesh;
mod notes;
mod package;
mod pieces;
mod primvar;
mod stage;
mod transform;
mod walk;

use crate::pieces::{FileFrame, MASK_SETTINGS, ReadPieces};
use crate::tuning::TUNING;
use crate::usd::reader::layers::{LayerFault, UsdLayers};
use crate::usd::reader::mesh::MaskName;
use crate::usd::reader::stage::{Fault, Stage, UsdValue, guarded};
use crate::usd::reader::walk::{Found, Walk, survey};
use crease_model::error::{Error, Message, Result, Setting};
use crease_model::garment::{ImportDiagnostic, Severity, UpAxis, is_plausible_unit};
use rustc_hash::FxHashSet;
use std::cell::RefCell;
use std::rc::Rc;

/// Length of the unit of a stage that states none [m]: a centimetre.
const DEFAULT_UNIT_M: f64 = 0.01;
/// Files that a stage may refer to.
const MAX_LAYERS: usize = 10_000;
/// Advice for files that cannot be read.
const REWRITE: &str =
    "write the file again, flattened (usdcat --flatten in.usd -o out.usda), or export it as glTF (.glb)";

/// Reads the pieces of a USD file. `frame` is the unit and the axis that the caller gives; `resolve` fetches the layers that the
/// file refers to.
pub(crate) fn read_usd(
    file: &str,
    bytes: &[u8],
    frame: (Option<f64>, Option<UpAxis>),
    masks: [Option<&str>; 2],
    resolve: &mut dyn FnMut(&str) -> Result<Vec<u8>>,
) -> Result<ReadPieces> {
    let read = guarded(|| read_stage(file, bytes, frame, masks, resolve));
    read.unwrap_or_else(|| {
        Err(Error::input(file, "", "its structure is damaged: the USD reader stopped in it", REWRITE))
    })
}

fn read_stage(
    file: &str,
    bytes: &[u8],
    (unit_m, up): (Option<f64>, Option<UpAxis>),
    masks: [Option<&str>; 2],
    resolve: &mut dyn FnMut(&str) -> Result<Vec<u8>>,
) -> Result<ReadPieces> {
    let refuse = |fault: Fault| Error::input(file, "", format!("it cannot be read as USD: {fault}"), REWRITE);
    let layers = Rc::new(RefCell::new(UsdLayers::default()));
    let name = file.rsplit(['/', '\\']).next().unwrap_or(file);
    let root = layers.borrow_mut().add(name, bytes).map_err(refuse)?;
    let stage = open_with_layers(&layers, &root, resolve).map_err(refuse)?;
    let (frame, note) = stage_frame(file, &stage, unit_m, up)?;
    let byte_count = layers.borrow().byte_count();
    let mask_names = masks.map(|mask| mask.map(MaskName::parse));
    let walk = Walk::new(file, frame.up.to_scene(frame.unit_m), mask_names, byte_count);
    let found = walk.run(&stage).map_err(refuse)?;
    check_masks(file, masks, &found)?;
    let faults = stage.composition_faults();
    let mut diagnostics = unresolved(faults, &layers.borrow());
    diagnostics.extend(note);
    diagnostics.extend(found.notes.into_diagnostics());
    Ok(ReadPieces {
        pieces: found.pieces,
        damaged: found.damaged,
        document: None,
        obj: None,
        frame: Some(frame),
        diagnostics,
    })
}

/// Composes the stage again until no layer is missing that `resolve` has.
fn open_with_layers(
    layers: &Rc<RefCell<UsdLayers>>,
    root: &str,
    resolve: &mut dyn FnMut(&str) -> Result<Vec<u8>>,
) -> std::result::Result<Stage, Fault> {
    let mut fetched_names = FxHashSet::default();
    loop {
        let stage = Stage::open(layers, root)?;
        // The stage asks for layers while it is visited: they are not borrowed then.
        let byte_count = layers.borrow().byte_count();
        survey(&stage, byte_count)?;
        let missing = layers.borrow_mut().take_missing();
        if missing.is_empty() {
            return Ok(stage);
        }
        if fetched_names.len() + missing.len() > MAX_LAYERS {
            return Err(format!("it refers to more than {MAX_LAYERS} files"));
        }
        for name in missing {
            if !fetched_names.insert(name.clone()) {
                layers.borrow_mut().fail(name, "it was read and is not found again".to_owned().into());
                continue;
            }
            let fetched = resolve(&name).map_err(reason);
            let added = fetched.and_then(|bytes| Ok(layers.borrow_mut().add(&name, &bytes)?));
            if let Err(fault) = added {
                layers.borrow_mut().fail(name, fault);
            }
        }
    }
}

/// Returns why a file cannot be had, without its name.
fn reason(error: Error) -> LayerFault {
    match error {
        Error::Input(mut all) if !all.is_empty() => {
            let first = all.swap_remove(0);
            let can_be_allowed = first.help.names_setting(Setting::AllowFolder);
            LayerFault { reason: first.message.to_string(), can_be_allowed }
        }
        other => other.to_string().into(),
    }
}

/// Returns unit and up axis, and a note if the stage does not state its unit.
fn stage_frame(
    file: &str,
    stage: &Stage,
    unit_m: Option<f64>,
    up: Option<UpAxis>,
) -> Result<(FileFrame, Option<ImportDiagnostic>)> {
    let metadata = |name: &str| {
        stage
            .metadata(name)
            .map_err(|fault| Error::input(file, name, format!("cannot be read: {fault}"), REWRITE))
    };
    let own_unit = match metadata("metersPerUnit")? {
        Some(UsdValue::Number(unit)) if is_plausible_unit(unit) => Some(unit),
        Some(_) if unit_m.is_none() => {
            let message = "is no length of a unit in metres";
            return Err(Error::input(
                file,
                "metersPerUnit",
                message,
                Message::from("give the unit with ") + Setting::Unit,
            ));
        }
        _ => None,
    };
    let own_up = match metadata("upAxis")? {
        Some(UsdValue::Token(axis)) if axis == "Z" => UpAxis::Z,
        Some(UsdValue::Token(axis)) if axis == "Y" => UpAxis::Y,
        Some(_) if up.is_none() => {
            let help = Message::from("give the axis with ") + Setting::Up;
            return Err(Error::input(file, "upAxis", "is neither Y nor Z", help));
        }
        _ => UpAxis::Y,
    };
    let note = (unit_m.is_none() && own_unit.is_none()).then(|| ImportDiagnostic {
        severity: Severity::Note,
        location: String::new(),
        message: Message::from(
            "metersPerUnit is not given: the unit is taken to be the centimetre, as USD has it (",
        ) + Setting::Unit
            + " states another)",
    });
    let frame = FileFrame {
        unit_m: unit_m.or(own_unit).unwrap_or(DEFAULT_UNIT_M),
        up: up.unwrap_or(own_up),
        states_unit: own_unit.is_some(),
    };
    Ok((frame, note))
}

/// Refuses masks that no mesh has.
fn check_masks(file: &str, masks: [Option<&str>; 2], found: &Found) -> Result<()> {
    let pieces = || found.pieces.iter().map(|named| &named.piece);
    let is_found =
        [pieces().any(|piece| piece.mask.is_some()), pieces().any(|piece| piece.sewing_mask.is_some())];
    for ((wanted, setting), is_found) in masks.into_iter().zip(MASK_SETTINGS).zip(is_found) {
        let Some(wanted) = wanted.filter(|_| !is_found && !found.pieces.is_empty()) else { continue };
        let primvar = MaskName::parse(wanted).primvar;
        if let Some(reason) = found.notes.message_about(&primvar) {
            let help =
                Message::from("write it as numbers, one per point, corner or face, or leave out ") + setting;
            return Err(Error::input(file, "", reason, help));
        }
        let help = match found.primvars.is_empty() {
            true => Message::from("leave out ") + setting + ": the meshes have no primvars",
            false => Message::from(setting) + format!(" takes one of: {}", found.primvars.join(", ")),
        };
        return Err(Error::input(file, "", format!("no primvar called \"{wanted}\""), help));
    }
    Ok(())
}

/// Returns warnings about what could not be composed.
fn unresolved(faults: Vec<(String, Option<String>)>, layers: &UsdLayers) -> Vec<ImportDiagnostic> {
    let count = faults.len();
    let warning = |(message, address): (String, Option<String>)| {
        let fault = address.and_then(|address| layers.failure(&address));
        let reason = fault.map_or(String::new(), |fault| format!(" ({})", fault.reason));
        let cures = "flatten the stage (usdcat --flatten), or put the file where it is looked for";
        let text = Message::from(format!("left out: {message}{reason}; {cures}"));
        let message = match fault.is_some_and(|fault| fault.can_be_allowed) {
            true => text + ", or allow its folder with " + Setting::AllowFolder.to("DIR"),
            false => text,
        };
        ImportDiagnostic { severity: Severity::Warning, location: String::new(), message }
    };
    let mut all: Vec<ImportDiagnostic> =
        faults.into_iter().take(TUNING.max_listed_errors).map(warning).collect();
    if count > all.len() {
        let message = format!("{} more parts of the stage are left out", count - all.len());
        all.push(ImportDiagnostic {
            severity: Severity::Warning,
            location: String::new(),
            message: message.into(),
        });
    }
    all
}
