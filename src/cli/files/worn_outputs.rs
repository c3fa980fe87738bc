//! Paths of the files that describe a worn garment.

use crate::files::output::is_stream;
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Paths of a worn garment, its sidecar and the report of the run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WornOutputs {
    /// OUT.glb, or the standard output
    pub worn: PathBuf,
    /// OUT.crease.json; none beside the standard output
    pub sidecar: Option<PathBuf>,
    /// OUT.report.json; none beside the standard output
    pub report: Option<PathBuf>,
}

impl WornOutputs {
    /// Derives all paths from that of the worn garment.
    pub fn beside(worn: &Path) -> Self {
        let beside = |extension: &str| (!is_stream(worn)).then(|| worn.with_extension(extension));
        Self { sidecar: beside("crease.json"), report: beside("report.json"), worn: worn.to_owned() }
    }

    /// All paths.
    pub fn paths(&self) -> impl Iterator<Item = &Path> {
        [Some(&self.worn), self.sidecar.as_ref(), self.report.as_ref()]
            .into_iter()
            .flatten()
            .map(PathBuf::as_path)
    }

    /// Path of the preview picture, OUT.png.
    pub fn preview(&self) -> PathBuf {
        self.worn.with_extension("png")
    }

    /// The `extras` of worn meshes, which name the sidecar relative to the garment.
    pub fn extras(&self) -> Value {
        let name = self.sidecar.as_ref().and_then(|path| path.file_name());
        match name {
            Some(name) => json!({ "crease": { "sidecar": name.to_string_lossy() } }),
            None => json!({ "crease": {} }),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_derived_from_the_worn_garment() {
        let outputs = WornOutputs::beside(Path::new("a/my.shirt.glb"));
        assert_eq!(outputs.sidecar.as_deref(), Some(Path::new("a/my.shirt.crease.json")));
        assert_eq!(outputs.report.as_deref(), Some(Path::new("a/my.shirt.report.json")));
        assert_eq!(outputs.preview(), Path::new("a/my.shirt.png"));
        assert_eq!(outputs.extras(), json!({"crease": {"sidecar": "my.shirt.crease.json"}}));
    }

    #[test]
    fn nothing_lies_beside_the_standard_output() {
        let outputs = WornOutputs::beside(Path::new("-"));
        assert_eq!(outputs.paths().collect::<Vec<_>>(), [Path::new("-")]);
        assert_eq!(outputs.extras(), json!({"crease": {}}));
    }
}
