//! Files that a job makes of a worn garment, and their paths.

use crate::files::{GarmentFile, Outputs, is_stream};
use crate::report::{DetailReport, Export, ExportCheck, FineReport, WrittenFile};
use crease_io::UsdFrames;
use crease_io::gltf::{
    DetailInput, DetailOf, FINE_EDGE, FlatNormals, MapDepth, MapOptions, SourceShape, add_detail_map,
    apply_worn, write_fine_glb, write_worn_glb_with,
};
use crease_model::error::Result;
use crease_model::fabric::Fabric;
use crease_model::garment::{SourceAsset, WornGarment};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// Files that a job writes.
#[derive(Debug, Clone, Default)]
pub struct OutputOptions {
    /// OUT.glb, beside which the others go; `-` for the standard output, beside which nothing goes. `None` to write nothing.
    pub path: Option<PathBuf>,
    /// Shape and normals of OUT.glb.
    pub shape: ShapeOptions,
    /// Normal maps of the worn surface.
    pub detail: Option<DetailOptions>,
    /// Whether OUT.fine.glb is written: the garment with vertices added along creases and in wrinkles.
    pub fine: bool,
    /// Files for other programs.
    pub exports: Vec<Export>,
    /// Whether OUT.png is drawn: the garment before and after.
    #[cfg(feature = "render")]
    pub preview: bool,
}

/// Frames of the garment over time, as OBJ files.
#[derive(Debug, Clone)]
pub struct FrameOptions {
    /// Folder for the frames.
    pub folder: PathBuf,
    /// Frames per simulated second.
    pub rate: f64,
}

/// Shape and normals of a worn glTF.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct ShapeOptions {
    /// What becomes of the source shape where the worn shape is made the base shape, for programs that do not read default morph weights;
    /// `None` where the source shape stays the base shape.
    pub apply: Option<SourceShape>,
    /// Treatment of flat-shaded vertices.
    pub flat_normals: FlatNormals,
}

/// Detail maps of a worn garment.
#[derive(Debug, Clone, Copy)]
pub struct DetailOptions {
    /// Texels per side.
    pub texels: u64,
    /// Bits per channel.
    pub depth: MapDepth,
    /// What the maps show.
    pub of: DetailOf,
    /// Whether the maps go beside the garment as files: normals, heights and angles of creases.
    pub files: bool,
}

/// Entries of a report about the files beside the main outputs.
#[derive(Debug, Default)]
pub struct WrittenFiles {
    /// One entry per detail map.
    pub detail_maps: Vec<DetailReport>,
    /// The finer mesh.
    pub fine: Option<FineReport>,
    /// Checks of the exported files.
    pub exports: Vec<ExportCheck>,
    /// All files but the report, and their sizes.
    pub files: Vec<WrittenFile>,
    /// Warnings about them.
    pub warnings: Vec<String>,
}

impl ShapeOptions {
    /// Returns the worn glTF of `worn`, not yet applied, with `extras` in its worn meshes.
    pub(super) fn worn_glb(self, mesh: &GarmentFile, worn: &WornGarment, extras: &Value) -> Result<Vec<u8>> {
        write_worn_glb_with(&mesh.asset, &mesh.garment, worn, extras, self.flat_normals)
    }

    /// Applies the worn shape of `glb`, `file` in messages, if that is asked for.
    pub(super) fn applied(self, file: &str, glb: Vec<u8>) -> Result<Vec<u8>> {
        match self.apply {
            Some(source) => apply_worn(file, &glb, source),
            None => Ok(glb),
        }
    }

    /// Returns `worn` as OUT.fine.glb, `file` in messages, and its size: the garment with vertices added along creases and in wrinkles.
    ///
    /// # Errors
    /// Those of [`Self::glb`].
    pub fn fine_glb(
        self,
        file: &str,
        mesh: &GarmentFile,
        worn: &WornGarment,
        detail: &DetailInput,
    ) -> Result<(Vec<u8>, FineReport)> {
        // The sidecar has other vertices, and is not named.
        let glb = self.worn_glb(mesh, worn, &json!({ "crease": {} }))?;
        let detail = DetailInput { flat_normals: self.flat_normals, ..*detail };
        let fine = write_fine_glb(&glb, &mesh.asset, &detail, FINE_EDGE)?;
        let report = FineReport {
            file: file.to_owned(),
            vertices: fine.vertices,
            triangles: fine.triangles,
            crossings: fine.crossings,
        };
        Ok((self.applied(file, fine.glb)?, report))
    }

    /// Returns `worn` as .glb, with `extras` in its worn meshes.
    ///
    /// # Errors
    /// [`crease_model::error::Error::Input`] if `worn` does not fit the garment, or the file has a construct that cannot be kept.
    pub fn glb(self, mesh: &GarmentFile, worn: &WornGarment, extras: &Value) -> Result<Vec<u8>> {
        self.applied(&mesh.asset.file, self.worn_glb(mesh, worn, extras)?)
    }
}

impl DetailOptions {
    /// Adds detail maps to the worn glTF `glb`, and the pictures that go beside `worn` to `outputs`. Reports and warnings go to `written`.
    pub(super) fn add(
        self,
        worn: &Path,
        outputs: &mut Outputs,
        written: &mut WrittenFiles,
        asset: &SourceAsset,
        detail: &DetailInput,
        glb: Vec<u8>,
    ) -> Result<Vec<u8>> {
        let options =
            MapOptions { side: self.texels as usize, depth: self.depth, of: self.of, creases: self.files };
        let detailed = add_detail_map(&glb, asset, detail, options)?;
        written.warnings.extend(detailed.notes);
        for (k, map) in detailed.maps.iter().enumerate() {
            let beside = |kind: &str| map_path(worn, kind, k, detailed.maps.len());
            let mut report = DetailReport::new(map, self.texels);
            if !map.in_material && is_stream(worn) {
                let left_out = "a normal map that fits no material is left out: the standard output has no place beside it";
                written.warnings.push(left_out.to_owned());
            } else if self.files || !map.in_material {
                let path = beside("normal");
                outputs.add(&path, &map.normal_png)?;
                report.normal_map = last_name(&path);
            }
            if self.files {
                let path = beside("height");
                outputs.add(&path, &map.height_png)?;
                report.height_map = last_name(&path);
            }
            if let Some(mask) = &map.crease_png {
                let path = beside("creases");
                outputs.add(&path, mask)?;
                report.crease_map = last_name(&path);
            }
            written.detail_maps.push(report);
        }
        Ok(detailed.glb)
    }
}

/// Returns OUT.normal.png for the only map, OUT.normal.2.png for the second of several.
fn map_path(worn: &Path, kind: &str, k: usize, count: usize) -> PathBuf {
    let extension = if count > 1 { format!("{kind}.{}.png", k + 1) } else { format!("{kind}.png") };
    worn.with_extension(extension)
}

fn last_name(path: &Path) -> Option<String> {
    path.file_name().map(|name| name.to_string_lossy().into_owned())
}

impl OutputOptions {
    /// Whether an output is sampled from the worn surface.
    pub fn shows_surface(&self) -> bool {
        self.detail.is_some() || self.fine
    }

    /// Kinds and paths of the exported files that go beside `worn`, without duplicates.
    fn export_paths(&self, worn: &Path) -> Vec<(Export, PathBuf)> {
        let mut paths: Vec<(Export, PathBuf)> = Vec::new();
        for kind in &self.exports {
            if !paths.iter().any(|(seen, _)| seen == kind) {
                paths.push((*kind, worn.with_extension(kind.ending())));
            }
        }
        paths
    }

    /// Checks that all files beside those of `paths` can be written.
    pub(super) fn check(&self, paths: &WornPaths, outputs: &Outputs) -> Result<()> {
        paths.paths().try_for_each(|path| outputs.check(path))?;
        if self.fine {
            outputs.check(&paths.fine())?;
        }
        self.export_paths(&paths.worn).iter().try_for_each(|(_, path)| outputs.check(path))?;
        #[cfg(feature = "render")]
        if self.preview {
            outputs.check(&paths.preview())?;
        }
        Ok(())
    }

    /// Adds the exported files to `outputs`; returns how well each carries the wear, as found when reading it back.
    pub(super) fn add_exports(
        &self,
        worn_path: &Path,
        outputs: &mut Outputs,
        mesh: &GarmentFile,
        worn: &WornGarment,
        fabric: &Fabric,
        frames: Option<UsdFrames>,
    ) -> Result<Vec<ExportCheck>> {
        let mut checks = Vec::new();
        for (kind, path) in self.export_paths(worn_path) {
            let stem = worn_path.file_stem().unwrap_or_default().to_string_lossy();
            let file = kind.make(&stem, &mesh.asset, &mesh.garment, worn, fabric, frames)?;
            outputs.add(&path, &file.bytes)?;
            for (ending, bytes) in &file.beside {
                outputs.add(&worn_path.with_extension(ending), bytes)?;
            }
            let with_name = |check| ExportCheck { file: crate::files::file_name(&path), ..check };
            checks.extend(file.checks.into_iter().map(with_name));
        }
        Ok(checks)
    }
}

/// Paths of a worn garment, its sidecar and the report of the run.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct WornPaths {
    /// OUT.glb, or the standard output
    pub worn: PathBuf,
    /// OUT.crease.json; none beside the standard output
    pub sidecar: Option<PathBuf>,
    /// OUT.report.json; none beside the standard output
    pub report: Option<PathBuf>,
}

impl WornPaths {
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

    /// Path of the finer mesh, OUT.fine.glb.
    pub fn fine(&self) -> PathBuf {
        self.worn.with_extension("fine.glb")
    }

    /// Path of the checkpoint, OUT.checkpoint; `None` beside the standard output.
    pub fn checkpoint(&self) -> Option<PathBuf> {
        (!is_stream(&self.worn)).then(|| self.worn.with_extension("checkpoint"))
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
        let outputs = WornPaths::beside(Path::new("a/my.shirt.glb"));
        assert_eq!(outputs.sidecar.as_deref(), Some(Path::new("a/my.shirt.crease.json")));
        assert_eq!(outputs.report.as_deref(), Some(Path::new("a/my.shirt.report.json")));
        assert_eq!(outputs.preview(), Path::new("a/my.shirt.png"));
        assert_eq!(outputs.extras(), json!({"crease": {"sidecar": "my.shirt.crease.json"}}));
    }

    #[test]
    fn nothing_lies_beside_the_standard_output() {
        let outputs = WornPaths::beside(Path::new("-"));
        assert_eq!(outputs.paths().collect::<Vec<_>>(), [Path::new("-")]);
        assert_eq!(outputs.extras(), json!({"crease": {}}));
    }
}
