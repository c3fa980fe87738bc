//! `load` and `save` of the types that are one file each.

use crate::bake::Checkpoint;
use crate::body::AnimatedBody;
use crate::error::Result;
use crate::fabric::Fabric;
use crate::files::garment_file::{GarmentFile, read_asset_file};
use crate::files::read::{file_name, read_bytes, read_text, write_bytes};
use crate::garment::{Garment, SourcePiece};
use crate::io::{ReadOptions, Sidecar, read_sidecar, write_sidecar};
use crate::wear::WearScript;
use std::path::Path;

impl Garment {
    /// Loads the garment of a .glb, .gltf, .obj or USD file in metres, y up. [`GarmentFile::load`] has options for other units
    /// and axes and for one garment of several, and keeps the file, into which the worn garment can be saved.
    ///
    /// # Errors
    /// Those of [`GarmentFile::load`].
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        Ok(GarmentFile::load(path, &ReadOptions::default())?.garment)
    }
}

impl WearScript {
    /// Loads a wear script.
    ///
    /// # Errors
    /// [`crate::Error::Input`] with every problem of the file; [`crate::Error::File`] if it cannot be read.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::parse(&file_name(path), &read_text(path)?)
    }
}

impl Fabric {
    /// Loads a fabric file; [`Fabric::preset`] has the built-in ones.
    ///
    /// # Errors
    /// [`crate::Error::Input`] with every problem of the file; [`crate::Error::File`] if it cannot be read.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::parse(&file_name(path), &read_text(path)?)
    }
}

impl AnimatedBody {
    /// Loads a body with its skeleton and animation from a .glb or .gltf file, or without from an .obj or USD file: every mesh in it that `options` do not
    /// choose as the garment. The garment's size is not checked.
    ///
    /// # Errors
    /// [`crate::Error::Input`] with every problem of the file; [`crate::Error::File`] if it cannot be read.
    pub fn load(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Self> {
        let options = &ReadOptions { any_size: true, skip_damaged: true, ..options.clone() };
        let (asset, _) = read_asset_file(path.as_ref(), options)?;
        let is_body = |piece: &&SourcePiece| options.garment.is_none() || !piece.worn;
        let pieces: Vec<&SourcePiece> = asset.pieces.iter().filter(is_body).collect();
        Self::from_pieces(&asset, &pieces)
    }
}

impl Sidecar {
    /// Loads a sidecar, OUT.crease.json.
    ///
    /// # Errors
    /// [`crate::Error::Input`] with the first problem of the file; [`crate::Error::File`] if it cannot be read.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        read_sidecar(&file_name(path), &read_bytes(path)?)
    }

    /// Saves the sidecar.
    ///
    /// # Errors
    /// [`crate::Error::File`] if the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        write_bytes(path.as_ref(), &write_sidecar(self))
    }
}

impl Checkpoint {
    /// Loads a checkpoint, for [`crate::Bake::resume`].
    ///
    /// # Errors
    /// [`crate::Error::Input`] if the file is no checkpoint or damaged; [`crate::Error::File`] if it cannot be read.
    pub fn load(path: impl AsRef<Path>) -> Result<Self> {
        let path = path.as_ref();
        Self::parse(&file_name(path), &read_bytes(path)?)
    }

    /// Saves the checkpoint.
    ///
    /// # Errors
    /// [`crate::Error::File`] if the file cannot be written.
    pub fn save(&self, path: impl AsRef<Path>) -> Result<()> {
        write_bytes(path.as_ref(), &self.to_bytes())
    }
}
