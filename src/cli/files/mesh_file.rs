//! Reads a mesh file with what it refers to: buffers because nothing can be read without them, images so that the
//! output, which is one file, shows what the input showed wherever it is put.

use crate::cli::args::common::MeshReading;
use crate::cli::files::input;
use crease::garment::{Garment, ImportDiagnostic, Severity, SourceAsset};
use crease::io::gltf::embed_images;
use crease::io::{ReadOptions, read_asset};
use crease::{Error, Result};
use std::path::Path;

/// A mesh file, the garment in it, and what was noticed on the way.
#[derive(Debug)]
pub struct MeshFile {
    /// The file as it came.
    pub asset: SourceAsset,
    /// The garment in it.
    pub garment: Garment,
    /// What reading and mending noticed.
    pub findings: Vec<ImportDiagnostic>,
}

impl MeshFile {
    /// Reads `path` and makes the garment.
    pub fn read(path: &Path, reading: &MeshReading) -> Result<Self> {
        Self::read_masked(path, reading, None)
    }

    /// The same with the vertex attribute `mask` for the garment's memory mask.
    pub fn read_masked(path: &Path, reading: &MeshReading, mask: Option<String>) -> Result<Self> {
        let (asset, mut findings) = read_masked_at(path, reading, mask)?;
        let (garment, more) = Garment::from_asset(&asset)?;
        findings.extend(more);
        Ok(Self { asset, garment, findings })
    }

    /// What was mended, in words.
    pub fn repairs(&self) -> Vec<String> {
        let repaired = self.findings.iter().filter(|finding| finding.severity == Severity::Repaired);
        repaired.map(|finding| format!("repaired: {}", finding.message)).collect()
    }

    /// Takes images that the document names by a path into the document; what could not be taken in, in words.
    pub fn embed_images(&mut self, path: &Path) -> Vec<String> {
        match &mut self.asset.document {
            Some(document) => embed_images(document, &mut |name| beside(path, name)),
            None => Vec::new(),
        }
    }
}

/// Reads `path` with the buffers it refers to.
pub fn read_asset_at(path: &Path, reading: &MeshReading) -> Result<(SourceAsset, Vec<ImportDiagnostic>)> {
    read_masked_at(path, reading, None)
}

fn read_masked_at(
    path: &Path,
    reading: &MeshReading,
    mask: Option<String>,
) -> Result<(SourceAsset, Vec<ImportDiagnostic>)> {
    let options = ReadOptions {
        unit_m: reading.unit.map(|unit| unit.0),
        up: reading.up,
        garment: reading.garment.clone(),
        mask,
    };
    let bytes = input::bytes(path)?;
    read_asset(&input::name_of(path), &bytes, &options, &mut |name| beside(path, name))
}

/// The bytes of what `mesh` refers to as `name`.
fn beside(mesh: &Path, name: &str) -> Result<Vec<u8>> {
    if name.contains("://") {
        return Err(Error::input(
            input::name_of(mesh),
            name,
            "lies on a network, which is not asked",
            "export the mesh as .glb",
        ));
    }
    input::bytes(&mesh.parent().unwrap_or(Path::new("")).join(name))
}
