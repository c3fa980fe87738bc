//! [`GarmentFile`]: a mesh file with the garment in it, and the worn garment written back into it.

use crate::bake::{BakeResult, SimulatedGarment};
use crate::files::read::{MAX_BYTES, file_name, read_bytes, refuse_gzip, write_bytes};
use crate::files::reference::{ReferenceFolders, read_referenced};
use crate::wear::WearScript;
use crease_io::gltf::{
    DetailInput, FINE_EDGE, FlatNormals, embed_images, sidecar_name, write_fine_glb, write_worn_glb,
};
use crease_io::{ReadOptions, Sidecar, read_asset, read_asset_with};
use crease_model::error::{Error, Message, Result};
use crease_model::fabric::Fabric;
use crease_model::garment::{
    Garment, ImportDiagnostic, MeshOptions, Severity, SheetArrays, SourceAsset, WornGarment,
    content_warnings, sheet_arrays,
};
use crease_model::remesh::{GarmentSurface, WornSurface};
use serde_json::{Value, json};
use sha2::{Digest, Sha256};
use std::path::{Path, PathBuf};

/// A mesh file and the garment in it.
///
/// ```
/// use crease::{GarmentFile, ReadOptions};
/// let obj = "v 0 0 0\nv 0.2 0 0\nv 0.2 0 0.2\nv 0 0 0.2\nf 1 4 3\nf 1 3 2\n";
/// let file = GarmentFile::parse("square.obj", obj.as_bytes(), &ReadOptions::default())?;
/// assert_eq!(file.garment.points.len(), 4);
/// assert_eq!(file.garment.topology.hinges.len(), 1);
/// # Ok::<(), crease::Error>(())
/// ```
#[derive(Debug)]
pub struct GarmentFile {
    /// Content of the file.
    pub asset: SourceAsset,
    /// Garment made from it.
    pub garment: Garment,
    /// Diagnostics of reading and repairing.
    pub diagnostics: Vec<ImportDiagnostic>,
}

impl GarmentFile {
    /// Loads a .glb, .gltf (with its buffers), .obj or USD file.
    ///
    /// # Errors
    /// [`Error::Input`] with every problem of the file; [`Error::File`] if it cannot be read.
    pub fn load(path: impl AsRef<Path>, options: &ReadOptions) -> Result<Self> {
        let (asset, diagnostics) = read_asset_file(path.as_ref(), options)?;
        Self::new(asset, diagnostics, options.weld_m)
    }

    /// Reads a .glb, .obj or USD file from memory; `name` is its name in messages.
    ///
    /// # Errors
    /// [`Error::Input`] with every problem of the file; a .gltf file that refers to others is one; what a USD file refers to is left out, with a warning.
    pub fn parse(name: &str, bytes: &[u8], options: &ReadOptions) -> Result<Self> {
        let (asset, diagnostics) = read_asset(name, bytes, options, &mut |other| {
            Err(Error::input(name, other, "is another file", "load the mesh from its folder, or as .glb"))
        })?;
        Self::new(asset, diagnostics, options.weld_m)
    }

    /// Makes a garment from `positions` [m], y up, and `triangles` between them, of a mesh that has no file. The vertices of the
    /// saved file are the positions in their order.
    ///
    /// ```
    /// use crease::{GarmentFile, MeshOptions};
    /// let corners = [[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.2, 0.0, 0.2], [0.0, 0.0, 0.2]];
    /// let options = MeshOptions::default().name("square").uvs([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]);
    /// let file = GarmentFile::from_mesh(&corners, &[[0, 3, 2], [0, 2, 1]], options)?;
    /// assert_eq!(file.garment.triangles.len(), 2);
    /// # Ok::<(), crease::Error>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`Garment::from_mesh`].
    pub fn from_mesh(positions: &[[f64; 3]], triangles: &[[u32; 3]], options: MeshOptions) -> Result<Self> {
        let (asset, diagnostics) = SourceAsset::from_mesh(positions, triangles, &options)?;
        let mut file = Self::new(asset, diagnostics, options.weld_m)?;
        file.asset.sha256 = checksum(positions, triangles, &options);
        Ok(file)
    }

    /// A flat rectangular sheet of cloth of `size` [m], x along warp and z along weft at height 0, in `cells` squares of two
    /// triangles along each side.
    ///
    /// ```
    /// let sheet = crease::GarmentFile::sheet([0.3, 0.2], [6, 4])?.garment;
    /// assert_eq!((sheet.points.len(), sheet.triangles.len()), (35, 48));
    /// # Ok::<(), crease::Error>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`Garment::sheet`].
    pub fn sheet(size: [f64; 2], cells: [u32; 2]) -> Result<Self> {
        let SheetArrays { positions, triangles } = sheet_arrays(size, cells)?;
        Self::from_mesh(&positions, &triangles, MeshOptions::default().name("sheet"))
    }

    fn new(asset: SourceAsset, mut diagnostics: Vec<ImportDiagnostic>, weld_m: Option<f64>) -> Result<Self> {
        let (garment, more) = Garment::from_asset_welded(&asset, weld_m)?;
        diagnostics.extend(more);
        Ok(Self { asset, garment, diagnostics })
    }

    /// A warning per repair that reading made, and per property of the file that is doubtful.
    pub fn repairs(&self) -> Vec<Message> {
        let warning = |diagnostic: &ImportDiagnostic| match diagnostic.severity {
            Severity::Repaired => Some(Message::from("repaired: ") + diagnostic.message.clone()),
            Severity::Warning => {
                Some(Message::from(format!("{}: ", self.asset.file)) + diagnostic.message.clone())
            }
            Severity::Note | Severity::Refused => None,
        };
        self.diagnostics.iter().filter_map(warning).collect()
    }

    /// A warning per doubt about the content: a body, copies or several garments among what is simulated, open seams.
    pub fn content_warnings(&self) -> Vec<Message> {
        content_warnings(&self.asset, &self.garment)
    }

    /// Embeds the images that the document of the file `path`, read with `options`, refers to, so that the saved file is complete.
    /// Returns a warning for each that cannot be read.
    pub fn embed_images(&mut self, path: &Path, options: &ReadOptions) -> Vec<Message> {
        embed_asset_images(&mut self.asset, path, options)
    }

    /// The file as .glb with the wrinkles of `worn` as morph target `worn`, switched on, and its memory as vertex attributes.
    ///
    /// ```
    /// use crease::{GarmentFile, RestState, Vec3, WornGarment};
    /// let file = GarmentFile::sheet([0.2, 0.2], [1, 1])?;
    /// let up = Vec3::new(0.0, 0.01, 0.0);
    /// let worn = WornGarment { displacement: vec![up; 4], memory: RestState::flat(1, 2) };
    /// assert!(file.to_glb_bytes(&worn)?.starts_with(b"glTF"));
    /// # Ok::<(), crease::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Input`] if `worn` does not fit the garment, or the file has a construct that cannot be kept.
    pub fn to_glb_bytes(&self, worn: &WornGarment) -> Result<Vec<u8>> {
        write_worn_glb(&self.asset, &self.garment, worn, &Value::Null)
    }

    /// The file as .glb like [`GarmentFile::to_glb_bytes`], with vertices added along the creases and in the wrinkles of `result`, a bake
    /// of this garment in `fabric`. The vertices of the file come first and stay as they are.
    ///
    /// ```
    /// use crease::{Bake, Fabric, GarmentFile, Quality, WearScript};
    /// let sheet = GarmentFile::sheet([0.2, 0.2], [2, 2])?;
    /// let script = WearScript::parse("", r#"{"format": "crease-wear/1", "actions": [{"settle": {"for": 0.1}}]}"#)?;
    /// let fabric = Fabric::preset("denim")?;
    /// let result = Bake::new(&sheet.garment, &fabric, &script).quality(Quality::Draft).run()?;
    /// assert!(sheet.to_fine_glb_bytes(&result, &fabric)?.starts_with(b"glTF"));
    /// # Ok::<(), crease::Error>(())
    /// ```
    ///
    /// # Errors
    /// Those of [`GarmentFile::to_glb_bytes`].
    pub fn to_fine_glb_bytes(&self, result: &BakeResult, fabric: &Fabric) -> Result<Vec<u8>> {
        let SimulatedGarment { garment, worn } = &result.simulated;
        let mesh = GarmentSurface::without_texture(garment);
        let detail = DetailInput {
            coarse: &self.garment,
            displacement: &result.worn.displacement,
            surface: &WornSurface::new(&mesh, worn, fabric.crease_width()),
            flat_normals: FlatNormals::default(),
        };
        let glb = self.to_glb_bytes(&result.worn)?;
        Ok(write_fine_glb(&glb, &self.asset, &detail, FINE_EDGE)?.glb)
    }

    /// Saves [`GarmentFile::to_glb_bytes`].
    ///
    /// # Errors
    /// Those of [`GarmentFile::to_glb_bytes`]; [`Error::File`] if the file cannot be written.
    pub fn save_glb(&self, worn: &WornGarment, path: impl AsRef<Path>) -> Result<()> {
        write_bytes(path.as_ref(), &self.to_glb_bytes(worn)?)
    }

    /// The sidecar of `worn`: mesh, rest state and displacement in full precision, for [`crate::transfer::Transfer`] and other
    /// programs. [`Sidecar::save`] writes it.
    ///
    /// ```
    /// use crease::{Fabric, GarmentFile, RestState, Vec3, WearScript, WornGarment};
    /// let file = GarmentFile::sheet([0.2, 0.2], [1, 1])?;
    /// let mut memory = RestState::flat(1, 2);
    /// memory.rest_angle[0] = 0.5;
    /// let worn = WornGarment { displacement: vec![Vec3::zeros(); 4], memory };
    /// let script = WearScript::parse("", r#"{"format": "crease-wear/1", "actions": [{"settle": {"for": 1}}]}"#)?;
    /// let sidecar = file.sidecar(&worn, &Fabric::preset("denim")?, &script)?;
    /// assert_eq!(sidecar.hinges.rest_angle_rad, [0.5]);
    /// # Ok::<(), crease::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Input`] if `worn` does not fit the garment or holds a number that is not finite.
    pub fn sidecar(&self, worn: &WornGarment, fabric: &Fabric, script: &WearScript) -> Result<Sidecar> {
        Sidecar::new(&self.asset, &self.garment, worn, json!(fabric), json!(script), Value::Null)
    }
}

/// Returns the SHA-256 of arrays, lower-case hex: of their numbers in little-endian order.
fn checksum(positions: &[[f64; 3]], triangles: &[[u32; 3]], options: &MeshOptions) -> String {
    let uvs = options.uvs.iter().flat_map(|uvs| uvs.as_flattened());
    let corner_uvs = options.corner_uvs.iter().flat_map(|uvs| uvs.as_flattened().as_flattened());
    let numbers = positions.as_flattened().iter().chain(uvs).chain(corner_uvs);
    let mut bytes: Vec<u8> = numbers.flat_map(|x| x.to_le_bytes()).collect();
    bytes.extend(triangles.as_flattened().iter().flat_map(|index| index.to_le_bytes()));
    Sha256::digest(&bytes).iter().map(|byte| format!("{byte:02x}")).collect()
}

/// Reads the mesh file `path` with the buffers that it refers to.
///
/// # Errors
/// [`Error::Input`] with every problem of the file; [`Error::File`] if it cannot be read.
pub fn read_asset_file(path: &Path, options: &ReadOptions) -> Result<(SourceAsset, Vec<ImportDiagnostic>)> {
    let bytes = read_bytes(path)?;
    refuse_gzip(path, &bytes)?;
    let mut reader = ReferenceReader::new(path, options);
    read_asset_with(&file_name(path), &bytes, options, &mut |name, needed| reader.read(name, needed))
}

/// Embeds the images that the document of the file `path`, read with `options`, refers to. Returns a warning for each that cannot be
/// read.
pub fn embed_asset_images(asset: &mut SourceAsset, path: &Path, options: &ReadOptions) -> Vec<Message> {
    let mut reader = ReferenceReader::new(path, options);
    match &mut asset.document {
        Some(document) => embed_images(document, &mut |name| reader.read(name, None)),
        None => Vec::new(),
    }
}

/// Returns the files that the mesh file `path` refers to and that are read with it, whether they exist or not; none of a file that
/// cannot be read.
pub fn referenced_files(path: &Path, options: &ReadOptions) -> Vec<PathBuf> {
    let options = ReadOptions { any_size: true, skip_damaged: true, ..options.clone() };
    let folders = ReferenceFolders::of_file(path, options.allow_folder.as_deref());
    let mut names = Vec::new();
    let Ok(bytes) = read_bytes(path) else { return names };
    let read = read_asset_with(&file_name(path), &bytes, &options, &mut |name, needed| {
        names.extend(folders.path_of(name));
        folders.read(name, needed)
    });
    if let Ok((mut asset, _)) = read
        && let Some(document) = &mut asset.document
    {
        names.extend(sidecar_name(document).and_then(|name| folders.path_of(name).ok()));
        embed_images(document, &mut |name| {
            names.extend(folders.path_of(name));
            folders.read(name, None)
        });
    }
    names
}

/// Reader of the files that one mesh file refers to, which together may be as long as one file.
struct ReferenceReader {
    folders: ReferenceFolders,
    /// Bytes that may still be read.
    left: u64,
}

impl ReferenceReader {
    fn new(path: &Path, options: &ReadOptions) -> Self {
        Self { folders: ReferenceFolders::of_file(path, options.allow_folder.as_deref()), left: MAX_BYTES }
    }

    fn read(&mut self, name: &str, needed: Option<u64>) -> Result<Vec<u8>> {
        let path = self.folders.path_of(name)?;
        let length = path.metadata().map_or(0, |data| data.len());
        if needed.unwrap_or(length).min(length) > self.left {
            let message = "is too long: with the other files of the mesh it has more than 4 GiB";
            return Err(Error::input(
                file_name(&path),
                "",
                message,
                "split it, or leave out what is not the garment",
            ));
        }
        let bytes = read_referenced(&path, needed)?;
        self.left = self.left.saturating_sub(bytes.len() as u64);
        Ok(bytes)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crease_geometry::math::Vec3;
    use crease_io::{read_sidecar, write_sidecar};
    use crease_model::garment::RestState;

    #[test]
    fn a_garment_from_arrays_is_written_with_its_vertices_in_their_order() {
        let positions = [[0.2, 0.0, 0.2], [0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.0, 0.0, 0.2]];
        let options = MeshOptions::default().name("square").uvs(positions.map(|[x, _, z]| [x, z]));
        let file =
            GarmentFile::from_mesh(&positions, &[[1, 3, 0], [1, 0, 2]], options).expect("is a garment");
        assert!(
            file.diagnostics.iter().all(|note| note.severity == Severity::Note),
            "{:?}",
            file.diagnostics
        );
        let up = Vec3::new(0.0, 0.01, 0.0);
        let worn = WornGarment { displacement: vec![up; 4], memory: RestState::flat(1, 2) };
        let glb = file.to_glb_bytes(&worn).expect("is written");
        let read = GarmentFile::parse("square.glb", &glb, &ReadOptions::default()).expect("is read");
        let piece = &read.asset.pieces[0];
        for (own, position) in piece.positions.iter().zip(positions) {
            assert!((own - up - Vec3::from(position)).norm() < 1e-6, "{own} is {position:?}");
        }
        assert_eq!(piece.uvs.as_ref().map(Vec::len), Some(4));
        let script = r#"{"format": "crease-wear/1", "actions": [{"settle": {"for": 1}}]}"#;
        let script = WearScript::parse("", script).expect("is a script");
        let fabric = Fabric::preset("denim").expect("exists");
        let sidecar = file.sidecar(&worn, &fabric, &script).expect("is made");
        assert_eq!((sidecar.source.file.as_str(), sidecar.source.sha256.len()), ("square", 64));
        let read = read_sidecar("square.crease.json", &write_sidecar(&sidecar)).expect("is a sidecar");
        assert_eq!(read.worn().displacement, worn.displacement);
    }

    /// Two panels that meet at a seam of four vertices, a triangle on its side, one that is turned over, and a copy.
    #[test]
    fn arrays_get_the_repairs_of_a_file() {
        let mut positions = vec![[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.2, 0.0, 0.2], [0.0, 0.0, 0.2]];
        positions.extend([
            [0.2, 0.0, 0.0],
            [0.4, 0.0, 0.0],
            [0.4, 0.0, 0.2],
            [0.2, 0.0, 0.2],
            [0.3, 0.0, 0.0],
        ]);
        let triangles = [[0, 3, 2], [0, 2, 1], [4, 6, 7], [4, 6, 5], [4, 5, 8], [0, 3, 2]];
        let arrays =
            GarmentFile::from_mesh(&positions, &triangles, MeshOptions::default()).expect("is a garment");
        let mut obj: String = positions.iter().map(|[x, y, z]| format!("v {x} {y} {z}\n")).collect();
        // The reader numbers vertices by their first use.
        obj.extend(triangles.iter().map(|t| format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1)));
        let file =
            GarmentFile::parse("mesh.obj", obj.as_bytes(), &ReadOptions::default()).expect("is a garment");
        assert_eq!(arrays.diagnostics, file.diagnostics);
        let repairs = arrays.repairs();
        assert!(
            repairs.len() >= 3 && repairs.iter().all(|repair| repair.starts_with("repaired")),
            "{repairs:?}"
        );
        let (own, other) = (arrays.garment, file.garment);
        assert_eq!(own.points.len(), other.points.len());
        let places = |garment: &Garment| -> Vec<[Vec3; 3]> {
            garment.triangles.iter().map(|t| t.map(|p| garment.points[p.at()])).collect()
        };
        assert_eq!((places(&own), &own.material), (places(&other), &other.material));
        assert_eq!(own.source_point.len(), positions.len(), "one point per position");
        for (point, position) in own.source_point.iter().zip(&positions) {
            assert_eq!(own.points[point.at()], Vec3::from(*position));
        }
    }
}
