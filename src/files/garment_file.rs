//! [`GarmentFile`]: a mesh file with the garment in it, and the worn garment written back into it.

use crate::files::read::{STANDARD_STREAM, file_name, read_bytes, write_bytes};
use crate::wear::WearScript;
use crease_io::gltf::{embed_images, write_worn_glb};
use crease_io::{ReadOptions, Sidecar, read_asset};
use crease_model::error::{Error, Result};
use crease_model::fabric::Fabric;
use crease_model::garment::{
    Garment, ImportDiagnostic, Severity, SourceAsset, WornGarment, content_warnings,
};
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

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

    /// Makes a garment from `positions` [m], y up, and `triangles` of a mesh that has no file.
    ///
    /// ```
    /// use crease::GarmentFile;
    /// let corners = [[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.2, 0.0, 0.2], [0.0, 0.0, 0.2]];
    /// let file = GarmentFile::from_mesh("square", &corners, &[[0, 3, 2], [0, 2, 1]])?;
    /// assert_eq!(file.garment.triangles.len(), 2);
    /// # Ok::<(), crease::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Input`] for an index without a position, for positions that are not finite, and for a size no garment has.
    pub fn from_mesh(name: &str, positions: &[[f64; 3]], triangles: &[[u32; 3]]) -> Result<Self> {
        let mut obj = String::new();
        for [x, y, z] in positions {
            // Writing to a string does not fail.
            let _ = writeln!(obj, "v {x} {y} {z}");
        }
        for [a, b, c] in triangles.iter().map(|t| t.map(|p| u64::from(p) + 1)) {
            let _ = writeln!(obj, "f {a} {b} {c}");
        }
        Self::parse(&format!("{name}.obj"), obj.as_bytes(), &ReadOptions::default())
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
    /// [`Error::Input`] without cells and for a size no garment has.
    pub fn sheet(size: [f64; 2], cells: [u32; 2]) -> Result<Self> {
        let [columns, rows] = cells;
        let row = columns + 1;
        let mut positions = Vec::new();
        for (j, i) in (0..=rows).flat_map(|j| (0..=columns).map(move |i| (j, i))) {
            let [x, z] = [(i, columns, size[0]), (j, rows, size[1])]
                .map(|(k, count, side)| side * f64::from(k) / f64::from(count.max(1)));
            positions.push([x, 0.0, z]);
        }
        let squares = (0..rows).flat_map(|j| (0..columns).map(move |i| j * row + i));
        let triangles: Vec<[u32; 3]> =
            squares.flat_map(|a| [[a, a + row, a + row + 1], [a, a + row + 1, a + 1]]).collect();
        Self::from_mesh("sheet", &positions, &triangles)
    }

    fn new(asset: SourceAsset, mut diagnostics: Vec<ImportDiagnostic>, weld_m: Option<f64>) -> Result<Self> {
        let (garment, more) = Garment::from_asset_welded(&asset, weld_m)?;
        diagnostics.extend(more);
        Ok(Self { asset, garment, diagnostics })
    }

    /// A warning per repair that reading made, and per property of the file that is doubtful.
    pub fn repairs(&self) -> Vec<String> {
        let warning = |diagnostic: &ImportDiagnostic| match diagnostic.severity {
            Severity::Repaired => Some(format!("repaired: {}", diagnostic.message)),
            Severity::Warning => Some(format!("{}: {}", self.asset.file, diagnostic.message)),
            Severity::Note | Severity::Refused => None,
        };
        self.diagnostics.iter().filter_map(warning).collect()
    }

    /// A warning per doubt about the content: a body, copies or several garments among what is simulated, open seams.
    pub fn content_warnings(&self) -> Vec<String> {
        content_warnings(&self.asset, &self.garment)
    }

    /// Embeds the images that the document of the file `path` refers to, so that the saved file is complete. Returns a
    /// warning for each that cannot be read.
    pub fn embed_images(&mut self, path: &Path) -> Vec<String> {
        embed_asset_images(&mut self.asset, path)
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

/// Reads the mesh file `path` with the buffers that it refers to.
///
/// # Errors
/// [`Error::Input`] with every problem of the file; [`Error::File`] if it cannot be read.
pub fn read_asset_file(path: &Path, options: &ReadOptions) -> Result<(SourceAsset, Vec<ImportDiagnostic>)> {
    let bytes = read_bytes(path)?;
    read_asset(&file_name(path), &bytes, options, &mut |name| read_beside(path, name))
}

/// Embeds the images that the document of the file `path` refers to. Returns a warning for each that cannot be read.
pub fn embed_asset_images(asset: &mut SourceAsset, path: &Path) -> Vec<String> {
    match &mut asset.document {
        Some(document) => embed_images(document, &mut |name| read_beside(path, name)),
        None => Vec::new(),
    }
}

/// Reads the file to which the mesh file `mesh` refers as `name`.
fn read_beside(mesh: &Path, name: &str) -> Result<Vec<u8>> {
    if name.contains("://") {
        let message = "is a network address, which is not supported";
        return Err(Error::input(file_name(mesh), name, message, "export the mesh as .glb"));
    }
    let path = mesh.parent().unwrap_or(Path::new("")).join(name);
    // A file of that name, not the standard input.
    let path = if path == Path::new(STANDARD_STREAM) { Path::new(".").join(path) } else { path };
    read_bytes(&path)
}
