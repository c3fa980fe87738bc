//! `--export`: files for other programs beside the main outputs.

use crate::files::input;
use crate::files::output::Outputs;
use crate::runtime::console;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use crease::internal::files::GarmentFile;
use crease::internal::report::{Export, ExportCheck};
use crease_io::UsdFrames;
use crease_model::error::Result;
use crease_model::fabric::Fabric;
use crease_model::garment::WornGarment;
use std::path::{Path, PathBuf};

/// Files for other programs.
#[derive(Debug, Clone, clap::Args)]
pub struct ExportArgs {
    /// Files for other programs, comma-separated: worn shape as OBJ, rest mesh as OBJ, rest angles per vertex as GLB,
    /// USD scene
    #[arg(long, alias = "also", value_name = "LIST", value_delimiter = ',', value_parser = kinds())]
    export: Vec<Export>,
}

fn kinds() -> impl TypedValueParser<Value = Export> {
    // Earlier scripts say `usda`.
    let value = |(name, kind)| {
        let value = PossibleValue::new(name);
        if kind == Export::Usd { value.alias("usda") } else { value }
    };
    PossibleValuesParser::new(Export::ALL.map(value)).try_map(|name| {
        let name = if name == "usda" { "usd" } else { &name };
        Export::ALL.iter().find(|(own, _)| *own == name).map(|(_, kind)| *kind).ok_or("no such kind")
    })
}

impl ExportArgs {
    /// Kinds and paths of the files that go beside the worn garment `worn`, without duplicates.
    fn paths<'a>(&'a self, worn: &'a Path) -> impl Iterator<Item = (Export, PathBuf)> + 'a {
        let mut seen = Vec::new();
        let is_new = move |kind: &Export| {
            let new = !seen.contains(kind);
            seen.push(*kind);
            new
        };
        self.export.iter().copied().filter(is_new).map(|kind| (kind, worn.with_extension(kind.ending())))
    }

    /// Whether any file is asked for.
    pub fn is_given(&self) -> bool {
        !self.export.is_empty()
    }

    /// Whether a USD scene is written.
    pub fn has_usd(&self) -> bool {
        self.export.contains(&Export::Usd)
    }

    /// Checks that all files can be written. To be called before a long run.
    pub fn check(&self, worn: &Path, outputs: &Outputs) -> Result<()> {
        self.paths(worn).try_for_each(|(_, path)| outputs.check(&path))
    }

    /// Adds the files to `outputs` and returns how well each carries the wear, as found when reading it back.
    pub fn add(
        &self,
        worn_path: &Path,
        outputs: &mut Outputs,
        mesh: &GarmentFile,
        worn: &WornGarment,
        fabric: &Fabric,
        frames: Option<UsdFrames>,
    ) -> Result<Vec<ExportCheck>> {
        let mut checks = Vec::new();
        for (kind, path) in self.paths(worn_path) {
            let stem = worn_path.file_stem().unwrap_or_default().to_string_lossy();
            let file = kind.make(&stem, &mesh.asset, &mesh.garment, worn, fabric, frames)?;
            outputs.add(&path, &file.bytes)?;
            for (ending, bytes) in &file.beside {
                outputs.add(&worn_path.with_extension(ending), bytes)?;
            }
            let with_name = |check| ExportCheck { file: input::name_of(&path), ..check };
            checks.extend(file.checks.into_iter().map(with_name));
        }
        Ok(checks)
    }
}

/// Prints the checks of exported files for people.
pub fn print_checks(checks: &[ExportCheck]) {
    for check in checks {
        console::message(&format!(
            "{}: {} differ by {:.3} {} RMS, {:.3} at most ({:.3} without the export)",
            check.file,
            check.compared,
            check.rms_difference,
            check.unit,
            check.largest_difference,
            check.rms_without
        ));
    }
}
