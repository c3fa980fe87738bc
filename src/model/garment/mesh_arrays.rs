//! A garment from arrays: positions, triangles and texture coordinates of a mesh that has no file.
//!
//! The arrays become a [`SourceAsset`] as a file does, so that the garment gets the same repairs and can be written out again.
//! Errors name the entry of the array, all of a mesh at once.

use crate::error::{Diagnostic, Error, Message, Result};
use crate::garment::garment_size::{GarmentSize, is_in_range, is_plausible_unit, usual_units};
use crate::garment::tuning::TUNING;
use crate::garment::{
    Garment, ImportDiagnostic, Placement, Severity, SourceAsset, SourceFormat, SourcePiece, UpAxis,
};
use crease_geometry::math::{Vec2, Vec3};
use rustc_hash::FxHashMap;

/// Options of a garment from arrays: [`Garment::from_mesh`], [`crease::internal::files::GarmentFile::from_mesh`].
///
/// ```
/// use crease_model::garment::{Garment, MeshOptions, UpAxis};
/// let corners = [[0.0, 0.0, 0.0], [20.0, 0.0, 0.0], [20.0, 20.0, 0.0], [0.0, 20.0, 0.0]];
/// let options = MeshOptions::default()
///     .name("square")
///     .unit_m(0.01)
///     .up(UpAxis::Z)
///     .uvs(vec![[0.0, 1.0], [1.0, 1.0], [1.0, 0.0], [0.0, 0.0]]);
/// let garment = Garment::from_mesh(&corners, &[[0, 1, 2], [0, 2, 3]], options)?;
/// assert!((garment.points[2].z + 0.2).abs() < 1e-12, "20 cm along y, which is -z where y is up");
/// assert!(garment.material_from_uv);
/// # Ok::<(), crease_model::error::Error>(())
/// ```
#[derive(Debug, Clone, Default, PartialEq)]
#[non_exhaustive]
pub struct MeshOptions {
    /// Name of the mesh in messages and files; "mesh" when not given.
    pub name: Option<String>,
    /// Texture coordinates, one per position; v grows downward as in glTF. Warp is +u.
    pub uvs: Option<Vec<[f64; 2]>>,
    /// Texture coordinates of the corners, one entry per triangle; v grows downward as in glTF. Where corners at one position
    /// differ, the mesh gets a vertex for each, after those of the positions.
    pub corner_uvs: Option<Vec<[[f64; 2]; 3]>>,
    /// Metres per unit of the positions; 1 when not given.
    pub unit_m: Option<f64>,
    /// Axis of the positions that points up.
    pub up: UpAxis,
    /// Whether the garment may have a size that no garment has.
    pub any_size: bool,
    /// Distance within which positions on borders are joined \[m\]; that of rounding when not given.
    pub weld_m: Option<f64>,
}

impl MeshOptions {
    /// Sets the name of the mesh in messages and files.
    pub fn name(self, name: impl Into<String>) -> Self {
        Self { name: Some(name.into()), ..self }
    }

    /// Sets texture coordinates, one per position.
    pub fn uvs(self, uvs: impl Into<Vec<[f64; 2]>>) -> Self {
        Self { uvs: Some(uvs.into()), ..self }
    }

    /// Sets texture coordinates of the corners, one entry per triangle.
    pub fn corner_uvs(self, uvs: impl Into<Vec<[[f64; 2]; 3]>>) -> Self {
        Self { corner_uvs: Some(uvs.into()), ..self }
    }

    /// Sets the metres per unit of the positions.
    pub fn unit_m(self, unit_m: f64) -> Self {
        Self { unit_m: Some(unit_m), ..self }
    }

    /// Sets the axis of the positions that points up.
    pub fn up(self, up: UpAxis) -> Self {
        Self { up, ..self }
    }

    /// Sets whether the garment may have a size that no garment has.
    pub fn any_size(self, any_size: bool) -> Self {
        Self { any_size, ..self }
    }

    /// Sets the distance within which positions on borders are joined \[m\].
    pub fn weld_m(self, weld_m: f64) -> Self {
        Self { weld_m: Some(weld_m), ..self }
    }
}

impl Garment {
    /// Makes a garment from `positions` \[m\], y up, and `triangles` between them, with the repairs that a file gets.
    /// [`Garment::source_point`] has the point of each position. [`crease::internal::files::GarmentFile::from_mesh`] also keeps the mesh, into
    /// which the worn garment can be saved.
    ///
    /// ```
    /// use crease_model::garment::{Garment, MeshOptions};
    /// let corners = [[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.2, 0.0, 0.2], [0.0, 0.0, 0.2]];
    /// let garment = Garment::from_mesh(&corners, &[[0, 3, 2], [0, 2, 1]], MeshOptions::default())?;
    /// assert_eq!(garment.topology.hinges.len(), 1);
    /// let error = Garment::from_mesh(&corners, &[[0, 3, 2], [0, 2, 7]], MeshOptions::default()).unwrap_err();
    /// assert_eq!(error.to_string(), "mesh: triangle 1, corner 2: index 7, 4 positions (indices count from 0)");
    /// # Ok::<(), crease_model::error::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Input`] with every index without a position, every number that is not finite and every list of another length;
    /// for a size that no garment has; if no triangle has any area.
    pub fn from_mesh(positions: &[[f64; 3]], triangles: &[[u32; 3]], options: MeshOptions) -> Result<Self> {
        let (asset, _) = SourceAsset::from_mesh(positions, triangles, &options)?;
        Ok(Self::from_asset_welded(&asset, options.weld_m)?.0)
    }
}

impl SourceAsset {
    /// Makes an asset of one piece from `positions` and `triangles` between them; also returns doubts about it. Vertex k is
    /// position k. The checksum is empty.
    ///
    /// # Errors
    /// Those of [`Garment::from_mesh`], but for triangles without area.
    pub fn from_mesh(
        positions: &[[f64; 3]],
        triangles: &[[u32; 3]],
        options: &MeshOptions,
    ) -> Result<(Self, Vec<ImportDiagnostic>)> {
        let name = options.name.clone().unwrap_or_else(|| "mesh".to_owned());
        let unit_m = options.unit_m.unwrap_or(1.0);
        let mut errors = ArrayErrors::new(&name);
        errors.check_options(options);
        errors.check_positions(positions, unit_m);
        errors.check_triangles(triangles, positions.len());
        errors.check_uvs(options, positions.len(), triangles.len());
        errors.finish()?;
        let vertices = MeshVertices::new(positions, triangles, options);
        let piece = SourcePiece {
            name: name.clone(),
            material: None,
            mesh: 0,
            primitive: 0,
            node: None,
            positions: vertices.positions,
            position_ids: vertices.position_ids,
            normals: None,
            uvs: vertices.uvs,
            mask: None,
            sewing_mask: None,
            triangles: vertices.triangles,
            placement: Placement::Rigid(options.up.to_scene(unit_m)),
            joints: Vec::new(),
            worn: true,
        };
        let asset = Self {
            file: name,
            sha256: String::new(),
            format: SourceFormat::Arrays,
            unit_m,
            unit_is_known: options.unit_m.is_some(),
            up: options.up,
            document: None,
            obj: None,
            pieces: vec![piece],
        };
        let doubt = if options.any_size { None } else { check_size(&asset)? };
        Ok((asset, doubt.into_iter().collect()))
    }
}

/// Errors of arrays found so far.
struct ArrayErrors<'a> {
    mesh: &'a str,
    listed: Vec<Diagnostic>,
    omitted: usize,
}

impl<'a> ArrayErrors<'a> {
    fn new(mesh: &'a str) -> Self {
        Self { mesh, listed: Vec::new(), omitted: 0 }
    }

    fn push(&mut self, location: impl Into<String>, message: impl Into<Message>, help: &str) {
        if self.listed.len() < TUNING.max_listed_errors {
            self.listed.push(Diagnostic::new(self.mesh, location, message, help));
        } else {
            self.omitted += 1;
        }
    }

    fn check_options(&mut self, options: &MeshOptions) {
        if let Some(unit) = options.unit_m.filter(|unit| !is_plausible_unit(*unit)) {
            self.push("unit", format!("{unit} m per unit cannot be"), "");
        }
        if let Some(weld) = options.weld_m.filter(|weld| !(*weld >= 0.0 && weld.is_finite())) {
            self.push("weld distance", format!("{weld} m is no length"), "");
        }
    }

    fn check_positions(&mut self, positions: &[[f64; 3]], unit_m: f64) {
        if u32::try_from(positions.len()).is_err() {
            self.push("positions", "more than an index of 32 bits can name", "");
        }
        for (k, position) in positions.iter().enumerate() {
            if position.iter().any(|x| !x.is_finite()) {
                self.push(format!("position {k}"), "not finite", "");
            } else if !is_in_range(&(unit_m * Vec3::from(*position))) {
                self.push(format!("position {k}"), "more than a million kilometres away", "");
            }
        }
    }

    fn check_triangles(&mut self, triangles: &[[u32; 3]], position_count: usize) {
        if triangles.is_empty() {
            self.push("triangles", "there are none", "");
        }
        for (f, triangle) in triangles.iter().enumerate() {
            for (k, index) in triangle.iter().enumerate().filter(|(_, p)| **p as usize >= position_count) {
                let message = format!("index {index}, {position_count} positions");
                self.push(format!("triangle {f}, corner {k}"), message, "indices count from 0");
            }
        }
    }

    fn check_uvs(&mut self, options: &MeshOptions, position_count: usize, triangle_count: usize) {
        let is_finite = |uv: &[f64; 2]| uv.iter().all(|x| x.is_finite());
        if options.uvs.is_some() && options.corner_uvs.is_some() {
            self.push("uv", "given per position and per corner", "give one of them");
        }
        if let Some(uvs) = &options.uvs {
            if uvs.len() != position_count {
                self.push("uv", format!("{} entries, {position_count} positions", uvs.len()), "");
            }
            for (k, _) in uvs.iter().enumerate().filter(|(_, uv)| !is_finite(uv)) {
                self.push(format!("uv {k}"), "not finite", "");
            }
        }
        if let Some(uvs) = &options.corner_uvs {
            if uvs.len() != triangle_count {
                self.push("uv", format!("{} entries, {triangle_count} triangles", uvs.len()), "");
            }
            for (f, corners) in uvs.iter().enumerate() {
                for (k, _) in corners.iter().enumerate().filter(|(_, uv)| !is_finite(uv)) {
                    self.push(format!("uv of triangle {f}, corner {k}"), "not finite", "");
                }
            }
        }
    }

    /// Fails with all errors, if there are any.
    fn finish(mut self) -> Result<()> {
        if self.omitted > 0 {
            self.listed.push(Diagnostic::new(self.mesh, "", format!("and {} more errors", self.omitted), ""));
        }
        if self.listed.is_empty() { Ok(()) } else { Err(Error::Input(self.listed)) }
    }
}

/// Vertices of a mesh from arrays: the positions in their order, then one for each further texture coordinate of a position.
struct MeshVertices {
    /// One per vertex, in units of the arrays.
    positions: Vec<Vec3>,
    /// One per vertex: its position, where a position may have several vertices.
    position_ids: Option<Vec<u32>>,
    /// One per vertex.
    uvs: Option<Vec<Vec2>>,
    triangles: Vec<[u32; 3]>,
}

impl MeshVertices {
    /// The vertices of checked arrays.
    fn new(positions: &[[f64; 3]], triangles: &[[u32; 3]], options: &MeshOptions) -> Self {
        let vertices = Self {
            positions: positions.iter().map(|&p| p.into()).collect(),
            position_ids: None,
            uvs: options.uvs.as_ref().map(|uvs| uvs.iter().map(|&uv| uv.into()).collect()),
            triangles: triangles.to_vec(),
        };
        match &options.corner_uvs {
            Some(corner_uvs) => vertices.split(corner_uvs),
            None => vertices,
        }
    }

    /// Gives the corners their texture coordinates, and a vertex of its own to each further one of a position.
    fn split(mut self, corner_uvs: &[[[f64; 2]; 3]]) -> Self {
        let mut uvs: Vec<Option<Vec2>> = vec![None; self.positions.len()];
        let mut ids: Vec<u32> = (0..self.positions.len() as u32).collect();
        let mut further: FxHashMap<(u32, [u64; 2]), u32> = FxHashMap::default();
        for (triangle, corners) in self.triangles.iter_mut().zip(corner_uvs) {
            for (corner, uv) in triangle.iter_mut().zip(corners) {
                let (position, uv) = (*corner, Vec2::from(*uv));
                if *uvs[position as usize].get_or_insert(uv) == uv {
                    continue;
                }
                // Both zeros are equal.
                let key = [uv.x, uv.y].map(|x| (x + 0.0).to_bits());
                *corner = *further.entry((position, key)).or_insert_with(|| {
                    self.positions.push(self.positions[position as usize]);
                    ids.push(position);
                    uvs.push(Some(uv));
                    uvs.len() as u32 - 1
                });
            }
        }
        self.position_ids = Some(ids);
        self.uvs = Some(uvs.into_iter().map(|uv| uv.unwrap_or_else(Vec2::zeros)).collect());
        self
    }
}

/// Rejects a mesh of a size that no garment has; returns a warning about one that is rare, unless its unit is known.
fn check_size(asset: &SourceAsset) -> Result<Option<ImportDiagnostic>> {
    let Some((low, high)) = asset.worn_bounds() else { return Ok(None) };
    let size = high - low;
    let extent = format!("{:.3} x {:.3} x {:.3} m", size.x, size.y, size.z);
    let units = usual_units(size.max() / asset.unit_m);
    let units: Vec<String> = units.map(|(name, side)| format!("{name} make it {side:.2} m")).collect();
    let hint = if units.is_empty() { String::new() } else { format!(": {}", units.join(", ")) };
    match GarmentSize::of_longest_side(size.max()) {
        GarmentSize::Rare if !asset.unit_is_known => Ok(Some(ImportDiagnostic {
            severity: Severity::Warning,
            location: String::new(),
            message: format!(
                "the garment is {extent}, which few garments are: give the unit if that is wrong{hint}"
            )
            .into(),
        })),
        GarmentSize::Usual | GarmentSize::Rare => Ok(None),
        GarmentSize::Implausible => Err(Error::input(
            &asset.file,
            "positions",
            format!("{extent} in size, which no garment is"),
            format!("give the unit{hint}; or allow any size"),
        )),
    }
}

/// Arrays of a flat sheet.
#[derive(Debug, Clone)]
pub struct SheetArrays {
    /// Positions of the vertices \[m\].
    pub positions: Vec<[f64; 3]>,
    /// Corners of the triangles.
    pub triangles: Vec<[u32; 3]>,
}

/// Returns positions \[m\] and triangles of a flat rectangular sheet of `size` \[m\], x along warp and z along weft at height 0, in
/// `cells` squares of two triangles along each side. Positions are in the order in which the triangles name them.
///
/// # Errors
/// [`Error::Input`] for more points than can be baked.
pub fn sheet_arrays(size: [f64; 2], cells: [u32; 2]) -> Result<SheetArrays> {
    let [columns, rows] = cells;
    let row = columns.saturating_add(1);
    let count = u64::from(row) * (u64::from(rows) + 1);
    if count > TUNING.max_points as u64 {
        let message = format!("{columns} x {rows} cells have {count} points");
        return Err(Error::input(
            "sheet",
            "",
            message,
            format!("at most {} can be baked", TUNING.max_points),
        ));
    }
    let mut number: Vec<Option<u32>> = vec![None; count as usize];
    let (mut positions, mut triangles) = (Vec::new(), Vec::new());
    let mut corner = |k: u32| {
        *number[k as usize].get_or_insert_with(|| {
            let along = |k: u32, count: u32, side: f64| side * f64::from(k) / f64::from(count.max(1));
            positions.push([along(k % row, columns, size[0]), 0.0, along(k / row, rows, size[1])]);
            positions.len() as u32 - 1
        })
    };
    for a in (0..rows).flat_map(|j| (0..columns).map(move |i| j * row + i)) {
        let [a, b, c, d] = [a, a + row, a + row + 1, a + 1].map(&mut corner);
        triangles.extend([[a, b, c], [a, c, d]]);
    }
    Ok(SheetArrays { positions, triangles })
}

impl Garment {
    /// Makes a flat rectangular sheet of cloth of `size` \[m\], x along warp and z along weft at height 0, in `cells` squares of two
    /// triangles along each side.
    ///
    /// ```
    /// let sheet = crease_model::garment::Garment::sheet([0.3, 0.2], [6, 4])?;
    /// assert_eq!((sheet.points.len(), sheet.triangles.len()), (35, 48));
    /// # Ok::<(), crease_model::error::Error>(())
    /// ```
    ///
    /// # Errors
    /// [`Error::Input`] without cells and for a size no garment has.
    pub fn sheet(size: [f64; 2], cells: [u32; 2]) -> Result<Self> {
        let SheetArrays { positions, triangles } = sheet_arrays(size, cells)?;
        Self::from_mesh(&positions, &triangles, MeshOptions::default().name("sheet"))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const SQUARE: [[f64; 3]; 4] = [[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.2, 0.0, 0.2], [0.0, 0.0, 0.2]];
    const HALVES: [[u32; 3]; 2] = [[0, 3, 2], [0, 2, 1]];

    fn lines(result: Result<Garment>) -> Vec<String> {
        result.expect_err("is refused").to_string().lines().map(str::to_owned).collect()
    }

    #[test]
    fn every_error_of_the_arrays_is_reported_at_its_entry() {
        let mut positions = SQUARE.to_vec();
        positions.extend([[f64::NAN, 0.0, 0.0], [0.0, 1e300, 0.0]]);
        let options =
            MeshOptions::default().name("tri").unit_m(0.0).weld_m(-1.0).uvs([[0.0, f64::INFINITY]; 3]);
        let expected = [
            "tri: unit: 0 m per unit cannot be",
            "tri: weld distance: -1 m is no length",
            "tri: position 4: not finite",
            "tri: triangle 1, corner 2: index 7, 6 positions (indices count from 0)",
            "tri: uv: 3 entries, 6 positions",
            "tri: uv 0: not finite",
            "tri: uv 1: not finite",
            "tri: uv 2: not finite",
        ];
        assert_eq!(lines(Garment::from_mesh(&positions, &[[0, 1, 2], [0, 2, 7]], options)), expected);
        let far = lines(Garment::from_mesh(&positions, &HALVES, MeshOptions::default()));
        assert_eq!(far[1], "mesh: position 5: more than a million kilometres away");
        let both = MeshOptions::default().uvs([[0.0; 2]; 4]).corner_uvs([[[f64::NAN; 2]; 3]; 1]);
        let both = lines(Garment::from_mesh(&SQUARE, &HALVES, both));
        assert_eq!(both[1], "mesh: uv: 1 entries, 2 triangles");
        assert_eq!(both[2], "mesh: uv of triangle 0, corner 0: not finite");
        assert_eq!(
            lines(Garment::from_mesh(&[], &[], MeshOptions::default())),
            ["mesh: triangles: there are none"]
        );
        let many = lines(Garment::from_mesh(&SQUARE, &[[9; 3]; 100], MeshOptions::default()));
        assert!(many.len() == 21 && many[20] == "mesh: and 280 more errors", "{many:?}");
        let flat =
            lines(Garment::from_mesh(&[[0.0; 3], [0.1; 3], [0.2; 3]], &[[0, 1, 2]], MeshOptions::default()));
        assert_eq!(flat, ["mesh: no triangle of the garment has any area (check the positions and indices)"]);
    }

    #[test]
    fn a_size_that_no_garment_has_is_refused_and_may_be_allowed() {
        let curtain = SQUARE.map(|p| p.map(|x| 30.0 * x));
        let refused = lines(Garment::from_mesh(&curtain, &HALVES, MeshOptions::default()));
        assert_eq!(
            refused,
            [
                "mesh: positions: 6.000 x 0.000 x 6.000 m in size, which no garment is (give the unit: dm make it 0.60 m, in make it \
             0.15 m; or allow any size)"
            ]
        );
        assert!(Garment::from_mesh(&curtain, &HALVES, MeshOptions::default().any_size(true)).is_ok());
        assert!(Garment::from_mesh(&curtain, &HALVES, MeshOptions::default().unit_m(0.1)).is_ok());
        let large = SQUARE.map(|p| p.map(|x| 15.0 * x));
        let doubts =
            |options: MeshOptions| SourceAsset::from_mesh(&large, &HALVES, &options).expect("is made").1;
        let [doubt] = &doubts(MeshOptions::default())[..] else { panic!("a garment of 3 m is rare") };
        assert!(doubt.severity == Severity::Warning && !doubt.message.contains("--"), "{doubt:?}");
        assert!(doubts(MeshOptions::default().unit_m(1.0)).is_empty());
    }

    #[test]
    fn corners_of_one_position_may_have_several_texture_coordinates() {
        let island = |shift: f64| SQUARE.map(|[x, _, z]| [x + shift, z]);
        let (left, right) = (island(0.0), island(0.5));
        let uvs = [HALVES[0].map(|k| left[k as usize]), HALVES[1].map(|k| right[k as usize])];
        let options = MeshOptions::default().corner_uvs(uvs);
        let (asset, _) = SourceAsset::from_mesh(&SQUARE, &HALVES, &options).expect("is made");
        let piece = &asset.pieces[0];
        assert_eq!(piece.triangles, [[0, 3, 2], [4, 5, 1]], "positions first, then the further vertices");
        assert_eq!(piece.position_ids.as_deref(), Some(&[0, 1, 2, 3, 0, 2][..]));
        let own = piece.uvs.as_ref().expect("has texture coordinates");
        for (triangle, uvs) in piece.triangles.iter().zip(uvs) {
            assert_eq!(triangle.map(|v| own[v as usize]), uvs.map(Vec2::from));
        }
        let garment = Garment::from_mesh(&SQUARE, &HALVES, options).expect("is a garment");
        assert_eq!(
            (garment.points.len(), garment.topology.hinges.len()),
            (4, 1),
            "the seam of the texture is closed"
        );
    }

    #[test]
    fn a_sheet_of_too_many_points_is_refused() {
        for cells in [[u32::MAX; 2], [2_000_000, 1], [0, 0], [3, 0]] {
            assert!(Garment::sheet([1.0; 2], cells).is_err(), "{cells:?}");
        }
    }
}
