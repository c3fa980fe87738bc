//! Inputs of a bake job: garment, body, script and fabric.

use crate::bake::{Bake, BakeOptions, ModelDecision, active_points, body_at_first_key};
use crate::files::{FrameFolder, merge_errors, read_fabric, read_script};
use crate::job::body_source::{BodyOptions, SkinOrReason, left_out_under};
use crate::job::garment_source::{GarmentSource, ReadGarment};
use crate::job::memory_source::EarlierMemory;
use crate::wear::WearScript;
use crease_geometry::math::Vec3;
use crease_io::gltf::write_worn_glb;
use crease_io::{FrameRows, Sidecar};
use crease_model::error::{Error, Message, Result};
use crease_model::fabric::Fabric;
use crease_model::garment::{RestState, WornGarment, corner_vertices};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};
use std::sync::Arc;

/// Names listed by [`BakeInput::decisions`].
const MAX_LISTED: usize = 40;

/// Sources of a bake.
#[derive(Debug)]
pub struct BakeSources {
    /// Garment.
    pub garment: GarmentSource,
    /// Wear script.
    pub wear: WearSource,
    /// Fabric: the name of a preset, a file, or `-` for the standard input.
    pub fabric: String,
    /// Body that wears the garment.
    pub body: Option<BodyOptions>,
    /// Length of edges to which the garment is refined, where the body can move it [mm]; `None` for the mesh of the file.
    pub resolution_mm: Option<f64>,
    /// Whether the memory of an earlier run is left out.
    pub forget: bool,
}

/// Wear script of a bake.
#[derive(Debug)]
pub enum WearSource {
    /// A file, the name of a script of the program, or `-` for the standard input.
    File(PathBuf),
    /// A script in memory.
    Script {
        /// Its name in messages.
        name: String,
        /// The script.
        script: Box<WearScript>,
    },
}

/// Inputs of a bake, read and checked.
#[derive(Debug)]
pub(super) struct BakeInput {
    /// Mesh file and garment.
    pub(super) garment: ReadGarment,
    /// Wear script.
    pub(super) script: WearScript,
    /// File of the script, for messages.
    pub(super) script_file: String,
    /// Fabric of the garment.
    pub(super) fabric: Fabric,
    /// Options of the bake, with the body and the garment's skin.
    pub(super) options: BakeOptions,
    /// Reason why a garment on a body does not follow the skin of its file.
    no_skin: Option<Message>,
    /// Memory that the garment begins with.
    pub(super) earlier: Option<EarlierMemory>,
    /// Warnings about it.
    pub(super) earlier_warnings: Vec<Message>,
}

impl WearSource {
    /// Path of the file.
    pub(super) fn path(&self) -> Option<&Path> {
        match self {
            Self::File(path) => Some(path),
            Self::Script { .. } => None,
        }
    }

    /// Reads the script, for a bake with or without a body; returns its name, too.
    fn read(self, has_body: bool) -> Result<(WearScript, String)> {
        let (script, name) = match self {
            Self::File(path) => (read_script(&path)?, crate::files::file_name(&path)),
            Self::Script { name, script } => (*script, name),
        };
        let mut errors = if has_body { Vec::new() } else { script.errors_without_body(&name) };
        errors.extend(script.order_errors(&name));
        if errors.is_empty() { Ok((script, name)) } else { Err(Error::Input(errors)) }
    }
}

impl BakeInput {
    /// Reads all files. The errors of all of them are reported together. Body and skin are added to `options`.
    pub(super) fn read(sources: BakeSources, mut options: BakeOptions) -> Result<Self> {
        let BakeSources { garment, wear, fabric, body, resolution_mm, forget } = sources;
        let script = wear.read(body.is_some());
        let fabric = read_fabric(&fabric);
        let (mut garment, (script, script_file), fabric) = match (garment.read(), script, fabric) {
            (Ok(garment), Ok(script), Ok(fabric)) => (garment, script, fabric),
            (garment, script, fabric) => {
                let errors = [script.err(), fabric.err(), garment.err()];
                return Err(merge_errors(errors.into_iter().flatten()));
            }
        };
        let no_skin = match body {
            Some(body) => add_body(&mut options, &body, &garment, &script)?,
            None => None,
        };
        options.finest_edge = resolution_mm.map(|mm| 1e-3 * mm).or(options.finest_edge);
        garment.refine(resolution_mm, |garment| active_points(garment, &script, &options))?;
        let earlier = match garment.path.as_deref().filter(|_| !forget) {
            Some(path) => EarlierMemory::read(path, &garment.mesh)?,
            None => None,
        };
        let (earlier, left_out) = match earlier {
            Some(Err(why)) => {
                (None, Some(Message::from("it has been worn already, and that is left out: ") + why))
            }
            Some(Ok(earlier)) => (Some(earlier), None),
            None => (None, None),
        };
        let other_fabric = earlier.as_ref().and_then(|earlier| earlier.fabric_warning(&fabric));
        let under = if options.body.is_none() { left_out_under(&garment, &script) } else { None };
        let earlier_warnings = left_out.into_iter().chain(other_fabric).chain(under).collect();
        Ok(Self { garment, script, script_file, fabric, options, no_skin, earlier, earlier_warnings })
    }

    /// Fails if the script names joints or clips that the body lacks, as a run does.
    pub(super) fn check_body_motion(&self) -> Result<()> {
        let body = self.options.body.as_deref();
        let errors = body.map_or(Vec::new(), |body| self.script.body_errors(&self.script_file, body));
        if errors.is_empty() { Ok(()) } else { Err(Error::Input(errors)) }
    }

    /// Returns the bake that is asked for.
    pub(super) fn bake(&self) -> Bake<'_> {
        let bake = Bake::new(&self.garment.mesh.garment, &self.fabric, &self.script)
            .script_name(&self.script_file)
            .options(self.options.clone());
        match &self.earlier {
            Some(earlier) => bake.earlier_memory(&earlier.memory),
            None => bake,
        }
    }

    /// Describes garment and joints as decisions, in front of those of the plan.
    pub(super) fn decisions(&self) -> Vec<ModelDecision> {
        let mut names: Vec<String> = Vec::new();
        for piece in self.garment.mesh.asset.worn_pieces() {
            let name = format!("\"{}\"", piece.name);
            if !names.contains(&name) {
                names.push(name);
            }
        }
        let listed = |names: &[String]| match names.len() {
            0 => "none that moves it".to_owned(),
            1..=MAX_LISTED => names.join(", "),
            more => format!("{}, and {} more", names[..MAX_LISTED].join(", "), more - MAX_LISTED),
        };
        let garment = &self.garment.mesh.garment;
        let why = format!(
            "{} points, {} triangles of {}",
            garment.points.len(),
            garment.triangles.len(),
            listed(&names)
        );
        let mut all = vec![ModelDecision { name: "garment", on: true, why: why.into() }];
        let Some(body) = &self.options.body else { return all };
        let joint = |(name, count): (String, usize)| format!("\"{name}\" ({count})");
        let joints: Vec<String> = body.moving_joints().into_iter().map(joint).collect();
        all.push(ModelDecision { name: "joints", on: !joints.is_empty(), why: listed(&joints).into() });
        all.extend(self.no_leash());
        all
    }

    /// The decision that the garment does not follow the skin of its file, with the reason.
    pub(super) fn no_leash(&self) -> Option<ModelDecision> {
        let why = self.no_skin.clone()?;
        Some(ModelDecision { name: "leash", on: false, why })
    }

    /// Shows the rows of the garment's file in `frames`; points of garments without a file's vertices as they are.
    pub(super) fn show_vertices(&self, frames: &mut FrameFolder) {
        let (mesh, garment) = (&self.garment.mesh, self.garment.coarse());
        match corner_vertices(&mesh.asset, garment) {
            Some(triangles) => frames.show_file(FrameRows::of_file(&mesh.asset, garment), &triangles),
            None => frames.show_points(&mesh.garment.triangles),
        }
    }

    /// Writes the garment without wear to memory, so that errors of the writers are found before the bake.
    pub(super) fn check_writers(&self, extras: &Value) -> Result<()> {
        let mesh = &self.garment.mesh;
        let unworn = WornGarment {
            displacement: vec![Vec3::zeros(); mesh.garment.points.len()],
            memory: RestState::flat(mesh.garment.topology.hinges.len(), mesh.garment.triangles.len()),
        };
        write_worn_glb(&mesh.asset, &mesh.garment, &unworn, extras)?;
        self.sidecar(&unworn, Value::Null).map(drop)
    }

    /// Returns the sidecar of `worn`; `run` describes the run.
    pub(super) fn sidecar(&self, worn: &WornGarment, run: Value) -> Result<Sidecar> {
        self.garment.sidecar(worn, &self.fabric, json!(self.script), run)
    }
}

/// Adds the body and the garment's skin on it to `options`; returns the reason why there is no skin. A body that is not held starts
/// at the first key of the script.
fn add_body(
    options: &mut BakeOptions,
    body: &BodyOptions,
    garment: &ReadGarment,
    script: &WearScript,
) -> Result<Option<Message>> {
    let read = body.read(garment)?;
    let skin: SkinOrReason = body.read_skin(garment, &read)?;
    let started = match &skin {
        Ok(_) => None,
        Err(_) => body_at_first_key(&read, &garment.mesh.garment, script),
    };
    options.body = Some(Arc::new(started.unwrap_or(read)));
    let (skin, reason) = match skin {
        Ok(skin) => (Some(skin), None),
        Err(reason) => (None, Some(reason)),
    };
    options.skin = skin;
    Ok(reason)
}
