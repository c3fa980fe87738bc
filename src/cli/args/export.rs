//! `--export`: files for other programs beside the main outputs.

use crate::cli::files::input;
use crate::cli::files::output::Outputs;
use crate::cli::runtime::console;
use clap::builder::{PossibleValuesParser, TypedValueParser};
use crease::Result;
use crease::fabric::Fabric;
use crease::garment::{Garment, SourceAsset, WornGarment};
use crease::report::{Export, ExportCheck};
use std::path::{Path, PathBuf};

/// Files to be written on the side.
#[derive(Debug, Clone, clap::Args)]
pub struct ExportArgs {
    /// Files for other programs, comma-separated: the worn shape as OBJ, the rest mesh as OBJ, rest angles per vertex as
    /// GLB, a USD surface deformable
    #[arg(long, alias = "also", value_name = "LIST", value_delimiter = ',', value_parser = kinds())]
    export: Vec<Export>,
}

fn kinds() -> impl TypedValueParser<Value = Export> {
    let names = PossibleValuesParser::new(Export::ALL.map(|(name, _)| name));
    names.try_map(|name| {
        Export::ALL.iter().find(|(own, _)| *own == name).map(|(_, kind)| *kind).ok_or("no such kind")
    })
}

impl ExportArgs {
    /// Where the files of the main output `worn` go.
    fn paths<'a>(&'a self, worn: &'a Path) -> impl Iterator<Item = (Export, PathBuf)> + 'a {
        let mut seen = Vec::new();
        let first_time = move |kind: &Export| {
            let new = !seen.contains(kind);
            seen.push(*kind);
            new
        };
        self.export.iter().copied().filter(first_time).map(|kind| (kind, worn.with_extension(kind.ending())))
    }

    /// Whether all of them can be written: to be asked before a long run.
    pub fn check(&self, worn: &Path, outputs: &Outputs) -> Result<()> {
        self.paths(worn).try_for_each(|(_, path)| outputs.check(&path))
    }

    /// Makes the files, to appear with the others; what they said when read back.
    pub fn add(
        &self,
        worn_path: &Path,
        outputs: &mut Outputs,
        asset: &SourceAsset,
        garment: &Garment,
        worn: &WornGarment,
        fabric: &Fabric,
    ) -> Result<Vec<ExportCheck>> {
        let mut reports = Vec::new();
        for (kind, path) in self.paths(worn_path) {
            let file = kind.make(asset, garment, worn, fabric)?;
            outputs.add(&path, &file.bytes)?;
            let named = |report| ExportCheck { file: input::name_of(&path), ..report };
            reports.extend(file.reports.into_iter().map(named));
        }
        Ok(reports)
    }
}

/// What was written on the side, for people.
pub fn tell(reports: &[ExportCheck]) {
    for check in reports {
        console::say(&format!(
            "{}: {} off by {:.3} {} root mean square, {:.3} at most ({:.3} without it)",
            check.file,
            check.compared,
            check.rms_difference,
            check.unit,
            check.largest_difference,
            check.rms_without
        ));
    }
}
