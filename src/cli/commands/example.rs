//! `crease example`: garments and wear scripts to try, which are part of the program.

use crate::files::input;
use crate::files::output::{Outputs, is_stream};
use crate::runtime::console;
use crease::internal::wear::WearScript;
use crease_model::error::{Error, Result};
use std::path::PathBuf;

/// A garment of the program.
struct Garment {
    name: &'static str,
    what: &'static str,
    glb: &'static [u8],
}

macro_rules! garment_list {
    ($($name:literal: $what:literal,)*) => {
        const GARMENTS: &[Garment] = &[$(Garment {
            name: $name,
            what: $what,
            glb: include_bytes!(concat!("../../../garments/", $name, ".glb")),
        },)*];
    };
}

garment_list! {
    "tshirt-draft": "T-shirt of 1,999 points; try --wear fold-thrice or crumple",
    "handkerchief": "square of 300 mm; try --wear press-crease",
    "sleeve": "sleeve on an arm with an elbow; try --wear elbow-ten-bends --body sleeve.glb --garment sleeve --body-node arm",
}

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease example
  crease example tshirt-draft -o .
  crease example fold-thrice -o .")]
pub struct Arguments {
    /// Garment or wear script to write; without it, all are listed
    name: Option<String>,
    /// Folder to write NAME.glb or NAME.json to; - is the standard output
    #[arg(short, long, value_name = "DIR", default_value = ".")]
    output: PathBuf,
}

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<()> {
    let Some(name) = &arguments.name else { return console::data(&list()) };
    let (file, bytes) = match GARMENTS.iter().find(|garment| garment.name == name) {
        Some(garment) => (format!("{name}.glb"), garment.glb),
        None => match WearScript::preset_text(name) {
            Some(text) => (format!("{name}.json"), text.as_bytes()),
            None => {
                let message = format!("there is no example {name}");
                return Err(Error::input("example", "", message, "`crease example` lists them"));
            }
        },
    };
    let path =
        if is_stream(&arguments.output) { arguments.output.clone() } else { arguments.output.join(file) };
    if path.exists() && !is_stream(&path) {
        let help = "name another folder with -o, or remove the file";
        return Err(Error::input(input::name_of(&path), "", "is there already", help));
    }
    let mut outputs = Outputs::new([]);
    outputs.add(&path, bytes)?;
    outputs.commit()
}

/// Returns the list of all examples for people.
fn list() -> String {
    let garments = GARMENTS.iter().map(|garment| format!("  {:<16}{}\n", garment.name, garment.what));
    let scripts = WearScript::preset_names().map(|name| format!("  {name}\n"));
    format!("Garments:\n{}Wear scripts:\n{}", garments.collect::<String>(), scripts.collect::<String>())
}
