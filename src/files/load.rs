//! [`Load`] and [`Save`] of the types that are one file each, and [`load_body`].

use crate::bake::Checkpoint;
use crate::files::garment_file::{GarmentFile, read_asset_file};
use crate::files::read::{file_name, read_bytes, read_text, write_bytes};
use crate::wear::WearScript;
use crease_io::{ReadOptions, Sidecar, read_body, read_sidecar, write_sidecar};
use crease_model::body::AnimatedBody;
use crease_model::error::Result;
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, SourcePiece};
use std::path::Path;

/// A value that is read from one file.
pub trait Load: Sized {
    /// Loads the file at `path`.
    ///
    /// # Errors
    /// [`crease_model::error::Error::Input`] with the problems of the file; [`crease_model::error::Error::File`] if it cannot be read.
    fn load(path: impl AsRef<Path>) -> Result<Self>;
}

/// A value that is written to one file.
pub trait Save {
    /// Saves the value at `path`.
    ///
    /// # Errors
    /// [`crease_model::error::Error::File`] if the file cannot be written.
    fn save(&self, path: impl AsRef<Path>) -> Result<()>;
}

/// The garment of a .glb, .gltf, .obj or USD file in metres, y up. [`GarmentFile::load`] has options for other units and axes and
/// for one garment of several, and keeps the file, into which the worn garment can be saved.
impl Load for Garment {
    fn load(path: impl AsRef<Path>) -> Result<Self> {
        Ok(GarmentFile::load(path, &ReadOptions::default())?.garment)
    }
}

/// A wear script.
impl Load for WearScript {
    fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::parse(&file_name(path), &read_text(path)?)
    }
}

/// A fabric file; [`Fabric::preset`] has the built-in ones.
impl Load for Fabric {
    fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::parse(&file_name(path), &read_text(path)?)
    }
}

/// A sidecar, OUT.crease.json, plain or compressed with gzip.
impl Load for Sidecar {
    fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        read_sidecar(&file_name(path), &read_bytes(path)?)
    }
}

impl Save for Sidecar {
    fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        write_bytes(path.as_ref(), &write_sidecar(self))
    }
}

/// A checkpoint, for [`crate::bake::Bake::resume`].
impl Load for Checkpoint {
    fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::parse(&file_name(path), &read_bytes(path)?)
    }
}

impl Save for Checkpoint {
    fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        write_bytes(path.as_ref(), &self.to_bytes())
    }
}

/// Loads a body with its skeleton and animation from a .glb or .gltf file, or without from an .obj or USD file: every mesh in it that
/// `options` do not choose as the garment. The garment's size is not checked.
///
/// # Errors
/// [`crease_model::error::Error::Input`] with every problem of the file; [`crease_model::error::Error::File`] if it cannot be read.
pub fn load_body(path: impl AsRef<Path>, options: &ReadOptions) -> Result<AnimatedBody> {
    let options = &ReadOptions { any_size: true, skip_damaged: true, ..options.clone() };
    let (asset, _) = read_asset_file(path.as_ref(), options)?;
    let is_body = |piece: &&SourcePiece| options.garment.is_none() || !piece.worn;
    let pieces: Vec<&SourcePiece> = asset.pieces.iter().filter(is_body).collect();
    read_body(&asset, &pieces)
}
