//! Inputs of a bake: garment, body, script and fabric.

use crate::args::body::SkinOrReason;
use crate::args::refine::Refinement;
use crate::commands::bake::arguments::Arguments;
use crate::files::earlier_memory::EarlierMemory;
use crate::files::frame_folder::FrameFolder;
use crate::files::input;
use crate::files::wear::read_script;
use crease::internal::bake::{Bake, BakeOptions, ModelDecision, ModelPlan, active_points, body_at_first_key};
use crease::internal::files::GarmentFile;
use crease::internal::wear::WearScript;
use crease_geometry::math::Vec3;
use crease_io::gltf::write_worn_glb;
use crease_io::{FrameRows, Sidecar};
use crease_model::body::{AnimatedBody, GarmentSkin};
use crease_model::error::{Error, Result};
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, RestState, WornGarment, corner_vertices};
use serde_json::{Value, json};
use std::path::Path;
use std::sync::Arc;

/// Names listed by `--explain`.
const MAX_LISTED: usize = 40;

/// Inputs of a bake, read and checked.
#[derive(Debug)]
pub struct BakeInput {
    /// Mesh file and garment.
    pub mesh: GarmentFile,
    /// Wear script.
    pub script: WearScript,
    /// File of the script, for messages.
    pub script_file: String,
    /// Fabric of the garment.
    pub fabric: Fabric,
    /// Body that the garment is worn on.
    pub body: Option<Arc<AnimatedBody>>,
    /// Skin of the garment on that body, or the reason why there is none.
    pub skin: Option<SkinOrReason>,
    /// Outcome of `--resolution`.
    pub refinement: Option<Refinement>,
    /// Memory that the garment begins with.
    pub earlier: Option<EarlierMemory>,
    /// Warnings about it.
    pub earlier_warnings: Vec<String>,
}

impl BakeInput {
    /// Reads all files. The errors of all of them are reported together.
    pub fn read(arguments: &Arguments) -> Result<Self> {
        let body = arguments.body.path().filter(|body| *body != arguments.mesh);
        input::check_streams(&[
            ("MESH", Some(&arguments.mesh)),
            ("--wear", Some(&arguments.wear)),
            ("--fabric", Some(Path::new(&arguments.fabric))),
            ("--body", body),
        ])?;
        let script_file = input::name_of(&arguments.wear);
        let script = worn_script(&script_file, &arguments.wear, arguments.body.is_given());
        let fabric = input::fabric(&arguments.fabric);
        let reading = arguments.reading.options();
        let mesh = GarmentFile::load(&arguments.mesh, &reading);
        match (script, fabric, mesh) {
            (Ok(script), Ok(fabric), Ok(mut mesh)) => {
                let mut body = arguments.body.read(&arguments.mesh, &reading, &mesh)?;
                let skin = match &body {
                    Some(body) => Some(arguments.body.read_skin(&arguments.mesh, &reading, &mesh, body)?),
                    None => None,
                };
                let is_free = found(&skin).is_none();
                let read = body.as_deref().filter(|_| is_free);
                if let Some(started) = read.and_then(|read| body_at_first_key(read, &mesh.garment, &script)) {
                    body = Some(Arc::new(started));
                }
                let options = arguments.options(body.as_ref(), found(&skin));
                let active = |garment: &Garment| active_points(garment, &script, &options);
                let refinement = arguments.refine.refine(&arguments.mesh, &mut mesh.garment, active)?;
                let earlier =
                    if arguments.forget { None } else { EarlierMemory::read(&arguments.mesh, &mesh)? };
                let (earlier, left_out) = match earlier {
                    Some(Err(why)) => {
                        (None, Some(format!("it has been worn already, and that is left out: {why}")))
                    }
                    Some(Ok(earlier)) => (Some(earlier), None),
                    None => (None, None),
                };
                let other_fabric = earlier.as_ref().and_then(|earlier| earlier.fabric_warning(&fabric));
                let earlier_warnings = left_out.into_iter().chain(other_fabric).collect();
                Ok(Self {
                    mesh,
                    script,
                    script_file,
                    fabric,
                    body,
                    skin,
                    refinement,
                    earlier,
                    earlier_warnings,
                })
            }
            (script, fabric, mesh) => {
                Err(input::merge_errors([script.err(), fabric.err(), mesh.err()].into_iter().flatten()))
            }
        }
    }

    /// Fails if the script names joints or clips that the body lacks, as a run does.
    pub fn check_body_motion(&self) -> Result<()> {
        let body = self.body.as_deref();
        let errors = body.map_or(Vec::new(), |body| self.script.body_errors(&self.script_file, body));
        if errors.is_empty() { Ok(()) } else { Err(Error::Input(errors)) }
    }

    /// Returns the options of the bake.
    pub fn options(&self, arguments: &Arguments) -> BakeOptions {
        arguments.options(self.body.as_ref(), found(&self.skin))
    }

    /// Returns which models the bake uses, and why.
    pub fn plan(&self, arguments: &Arguments) -> ModelPlan {
        self.bake(arguments).plan()
    }

    /// Returns the bake that is asked for.
    pub fn bake(&self, arguments: &Arguments) -> Bake<'_> {
        let bake = Bake::new(&self.mesh.garment, &self.fabric, &self.script)
            .script_name(&self.script_file)
            .options(self.options(arguments));
        match &self.earlier {
            Some(earlier) => bake.earlier_memory(&earlier.memory),
            None => bake,
        }
    }

    /// Describes garment and joints as decisions, in front of those of the plan.
    pub fn decisions(&self) -> Vec<ModelDecision> {
        let mut names: Vec<String> = Vec::new();
        for piece in self.mesh.asset.worn_pieces() {
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
        let garment = &self.mesh.garment;
        let why = format!(
            "{} points, {} triangles of {}",
            garment.points.len(),
            garment.triangles.len(),
            listed(&names)
        );
        let mut all = vec![ModelDecision { name: "garment", on: true, why: why.into() }];
        let Some(body) = &self.body else { return all };
        let joint = |(name, count): (String, usize)| format!("\"{name}\" ({count})");
        let joints: Vec<String> = body.moving_joints().into_iter().map(joint).collect();
        all.push(ModelDecision { name: "joints", on: !joints.is_empty(), why: listed(&joints).into() });
        all.extend(self.no_leash());
        all
    }

    /// The decision that the garment does not follow the skin of its file, with the reason.
    pub fn no_leash(&self) -> Option<ModelDecision> {
        let reason = self.skin.as_ref()?.as_ref().err()?;
        Some(ModelDecision { name: "leash", on: false, why: reason.as_str().into() })
    }

    /// Shows the rows of the garment's file in `frames`; points of garments without a file's vertices as they are.
    pub fn show_vertices(&self, frames: &mut FrameFolder) {
        let coarse = self.refinement.as_ref().and_then(|refinement| refinement.coarse.as_ref());
        let garment = coarse.map_or(&self.mesh.garment, |coarse| &coarse.garment);
        match corner_vertices(&self.mesh.asset, garment) {
            Some(triangles) => frames.show_file(FrameRows::of_file(&self.mesh.asset, garment), &triangles),
            None => frames.show_points(&self.mesh.garment.triangles),
        }
    }

    /// Writes the garment without wear to memory, so that errors of the writers are found before the bake.
    pub fn check_writers(&self, extras: &Value) -> Result<()> {
        let garment = &self.mesh.garment;
        let unworn = WornGarment {
            displacement: vec![Vec3::zeros(); garment.points.len()],
            memory: RestState::flat(garment.topology.hinges.len(), garment.triangles.len()),
        };
        write_worn_glb(&self.mesh.asset, garment, &unworn, extras)?;
        self.sidecar(&unworn, Value::Null).map(drop)
    }

    /// Returns the sidecar of `worn`; `run` describes the run.
    pub fn sidecar(&self, worn: &WornGarment, run: Value) -> Result<Sidecar> {
        let (fabric, wear) = (json!(self.fabric), json!(self.script));
        Sidecar::new(&self.mesh.asset, &self.mesh.garment, worn, fabric, wear, run)
    }
}

/// The skin, if there is one.
fn found(skin: &Option<SkinOrReason>) -> Option<&Arc<GarmentSkin>> {
    skin.as_ref()?.as_ref().ok()
}

fn worn_script(file: &str, path: &Path, has_body: bool) -> Result<WearScript> {
    let script = read_script(path)?;
    let errors = if has_body { Vec::new() } else { script.errors_without_body(file) };
    if errors.is_empty() { Ok(script) } else { Err(Error::Input(errors)) }
}
