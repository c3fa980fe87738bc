//! A mesh file with the files it refers to: buffers, which reading needs, and images, which are embedded so that the
//! single output file is complete.

use crate::cli::files::input;
use crease::garment::{Garment, ImportDiagnostic, Severity, SourceAsset};
use crease::io::gltf::embed_images;
use crease::io::{ReadOptions, read_asset};
use crease::{Error, Result};
use std::path::Path;

/// A mesh file and the garment in it.
#[derive(Debug)]
pub struct MeshFile {
    /// Content of the file.
    pub asset: SourceAsset,
    /// Garment made from it.
    pub garment: Garment,
    /// Diagnostics of reading and repairing.
    pub findings: Vec<ImportDiagnostic>,
}

impl MeshFile {
    /// Reads `path` and makes the garment.
    pub fn read(path: &Path, options: &ReadOptions) -> Result<Self> {
        let (asset, mut findings) = read_asset_at(path, options)?;
        let (garment, more) = Garment::from_asset(&asset)?;
        findings.extend(more);
        Ok(Self { asset, garment, findings })
    }

    /// Returns a warning per repair.
    pub fn repairs(&self) -> Vec<String> {
        let repaired = self.findings.iter().filter(|finding| finding.severity == Severity::Repaired);
        repaired.map(|finding| format!("repaired: {}", finding.message)).collect()
    }

    /// Embeds the images that the document of the file `path` refers to; returns a warning for each that cannot be read.
    pub fn embed_images(&mut self, path: &Path) -> Vec<String> {
        match &mut self.asset.document {
            Some(document) => embed_images(document, &mut |name| read_beside(path, name)),
            None => Vec::new(),
        }
    }
}

/// Reads `path` with the buffers it refers to.
pub fn read_asset_at(path: &Path, options: &ReadOptions) -> Result<(SourceAsset, Vec<ImportDiagnostic>)> {
    let bytes = input::bytes(path)?;
    read_asset(&input::name_of(path), &bytes, options, &mut |name| read_beside(path, name))
}

/// Reads the file that `mesh` refers to as `name`.
fn read_beside(mesh: &Path, name: &str) -> Result<Vec<u8>> {
    if name.contains("://") {
        return Err(Error::input(
            input::name_of(mesh),
            name,
            "is a network address, which is not supported",
            "export the mesh as .glb",
        ));
    }
    input::bytes(&mesh.parent().unwrap_or(Path::new("")).join(name))
}
