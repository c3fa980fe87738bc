//! `crease example`: garments, wear scripts and ready memories to try, which are part of the program.

use crate::files::input;
use crate::files::output::{Outputs, commit, is_stream};
use crate::runtime::console;
use crease::internal::files::{HANDKERCHIEF, SLEEVE, TSHIRT_DRAFT, ready_memory, ready_memory_names};
use crease::internal::wear::WearScript;
use crease_io::write_sidecar;
use crease_model::error::{Error, Result};
use crease_model::json::nearest;
use std::path::PathBuf;

/// A garment of the program.
struct Garment {
    name: &'static str,
    what: &'static str,
    glb: &'static [u8],
}

const GARMENTS: &[Garment] = &[
    Garment {
        name: "tshirt-draft",
        what: "T-shirt of 1,999 points; try --wear fold-thrice or crumple",
        glb: TSHIRT_DRAFT,
    },
    Garment { name: "handkerchief", what: "square of 300 mm; try --wear press-crease", glb: HANDKERCHIEF },
    Garment {
        name: "sleeve",
        what: "sleeve on an arm with an elbow; try --wear elbow-ten-bends --body sleeve.glb --garment sleeve --body-node arm",
        glb: SLEEVE,
    },
];

/// Ending of a memory's file; in lists it tells a memory from the script of the same name.
const MEMORY_ENDING: &str = ".crease.json";

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease example
  crease example tshirt-draft -o .
  crease example fold-thrice -o .
  crease example fold-thrice.crease.json -o .")]
pub struct Arguments {
    /// Garment, wear script or memory to write; without it, all are listed
    name: Option<String>,
    /// Folder to write NAME.glb, NAME.json or NAME.crease.json to; - is the standard output
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    output: PathBuf,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<()> {
    let Some(name) = &arguments.name else { return console::data(&list()) };
    let (file, bytes) = find(name)?;
    let path =
        if is_stream(&arguments.output) { arguments.output.clone() } else { arguments.output.join(file) };
    if path.exists() && !is_stream(&path) {
        let help = "name another folder with -o, or remove the file";
        return Err(Error::input(input::name_of(&path), "", "is there already", help));
    }
    let mut outputs = Outputs::new([]);
    outputs.add(&path, &bytes)?;
    commit(outputs)
}

/// Returns file name and content of the example `name`: a garment, a wear script, or a memory with its ending or, where no script
/// has its name, without.
fn find(name: &str) -> Result<(String, Vec<u8>)> {
    if let Some(garment) = GARMENTS.iter().find(|garment| garment.name == name) {
        return Ok((format!("{name}.glb"), garment.glb.to_vec()));
    }
    if let Some(text) = WearScript::preset_text(name) {
        return Ok((format!("{name}.json"), text.as_bytes().to_vec()));
    }
    let memory = name.strip_suffix(MEMORY_ENDING).unwrap_or(name);
    if ready_memory_names().any(|own| own == memory) {
        return Ok((format!("{memory}{MEMORY_ENDING}"), write_sidecar(&ready_memory(memory)?)));
    }
    let names = GARMENTS.iter().map(|garment| garment.name).chain(WearScript::preset_names());
    let help = match nearest(memory, names.chain(ready_memory_names())) {
        Some(meant) => format!("did you mean `{meant}`? `crease example` lists all"),
        None => "`crease example` lists them".to_owned(),
    };
    Err(Error::input("example", "", format!("there is no example {name}"), help))
}

/// Returns the list of all examples for people.
fn list() -> String {
    let garments = GARMENTS.iter().map(|garment| format!("  {:<16}{}\n", garment.name, garment.what));
    let scripts = WearScript::preset_names().map(|name| format!("  {name}\n"));
    let memories = ready_memory_names().map(|name| format!("  {name}{MEMORY_ENDING}\n"));
    format!(
        "Garments:\n{}Wear scripts:\n{}Memories, for `crease transfer NAME --to MESH`:\n{}",
        garments.collect::<String>(),
        scripts.collect::<String>(),
        memories.collect::<String>(),
    )
}
