//! Paths of the files that describe a worn garment.

use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Paths of a worn garment, its sidecar and the report of the run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WornOutputs {
    /// OUT.glb
    pub worn: PathBuf,
    /// OUT.crease.json
    pub sidecar: PathBuf,
    /// OUT.report.json
    pub report: PathBuf,
}

impl WornOutputs {
    /// Derives all paths from that of the worn garment.
    pub fn beside(worn: &Path) -> Self {
        Self {
            sidecar: worn.with_extension("crease.json"),
            report: worn.with_extension("report.json"),
            worn: worn.to_owned(),
        }
    }

    /// All paths.
    pub fn paths(&self) -> [&Path; 3] {
        [&self.worn, &self.sidecar, &self.report]
    }

    /// Path of the preview picture, OUT.png.
    pub fn preview(&self) -> PathBuf {
        self.worn.with_extension("png")
    }

    /// The `extras` of worn meshes, which name the sidecar relative to the garment.
    pub fn extras(&self) -> Value {
        let name = self.sidecar.file_name().map(|name| name.to_string_lossy().into_owned());
        json!({ "crease": { "sidecar": name } })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn paths_are_derived_from_the_worn_garment() {
        let outputs = WornOutputs::beside(Path::new("a/my.shirt.glb"));
        assert_eq!(outputs.sidecar, Path::new("a/my.shirt.crease.json"));
        assert_eq!(outputs.report, Path::new("a/my.shirt.report.json"));
        assert_eq!(outputs.preview(), Path::new("a/my.shirt.png"));
        assert_eq!(outputs.extras(), json!({"crease": {"sidecar": "my.shirt.crease.json"}}));
    }
}
