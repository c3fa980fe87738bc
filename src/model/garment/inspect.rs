//! Report of `crease inspect` about a mesh file: contents, size, repairs, and edges that carry no hinge.
//!
//! Made from the source asset, the garment built from it, and the diagnostics of both stages. Counts no intersections:
//! `contact` does, and the caller fills the number in, as the contents that only the reader of a format knows.

use crate::error::{Message, Vocabulary};
use crate::garment::build::outer_triangles;
use crate::garment::{
    FileContents, Garment, ImportDiagnostic, Placement, RigidParts, Severity, SourceAsset, SourceFormat,
    UpAxis, content_warnings,
};
use crate::printable::printable;
use crease_geometry::mesh::{PointIndex, Topology, loop_length};
use serde::Serialize;
use std::borrow::Cow;
use std::fmt::Write;

/// Boundary loops listed in the text; the rest are counted.
const MAX_LISTED_LOOPS: usize = 12;
/// Pieces listed in the text.
const MAX_LISTED_PIECES: usize = 40;

/// Report about a mesh file and the garment made of it.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[non_exhaustive]
pub struct Inspection {
    /// File as the user named it.
    pub file: String,
    /// "OBJ", "glTF" or "USD".
    pub format: &'static str,
    /// SHA-256 of the file, lower-case hex.
    pub sha256: String,
    /// Metres per file unit.
    pub unit_m: f64,
    /// "y" or "z".
    pub up: &'static str,
    /// Sides of the bounding box of the worn pieces \[m\], y up.
    pub box_m: [f64; 3],
    /// The same sides in file units.
    pub box_units: [f64; 3],
    /// All pieces of the file, worn or not.
    pub pieces: Vec<PieceReport>,
    /// Joints, clips and attributes of the file.
    #[serde(flatten)]
    pub contents: FileContents,
    /// Connected parts of the garment.
    pub parts: Vec<PartReport>,
    /// Vertices of the worn pieces in the file.
    pub vertices: usize,
    /// Points after welding.
    pub points: usize,
    /// Triangles of the garment.
    pub triangles: usize,
    /// Triangles of the worn pieces in the file that are not in the garment.
    pub dropped_triangles: usize,
    /// Hinges: edges that bend with memory.
    pub hinges: usize,
    /// Vertices with the same point as another: at seams, texture borders and hard edges.
    pub welded_vertices: usize,
    /// Length of each boundary loop \[m\], longest first.
    pub boundary_loops_m: Vec<f64>,
    /// Edges of more than two triangles.
    pub non_manifold_edges: usize,
    /// Edges whose two triangles have opposite orientations.
    pub misoriented_edges: usize,
    /// Whether the warp follows the texture coordinates.
    pub warp_from_uv: bool,
    /// Pieces with texture coordinates among the worn ones.
    pub pieces_with_uv: usize,
    /// Mean edge length \[mm\].
    pub mean_edge_mm: f64,
    /// Shortest edge \[mm\].
    pub shortest_edge_mm: f64,
    /// Area of the cloth \[m2\].
    pub area_m2: f64,
    /// Pairs of triangles that already intersect; `None` where they were not counted.
    pub crossings_at_start: Option<usize>,
    /// Notes.
    pub notes: Vec<ImportDiagnostic>,
    /// Doubts, and parts that are left as they are.
    pub warnings: Vec<ImportDiagnostic>,
    /// Repairs.
    pub repaired: Vec<ImportDiagnostic>,
    /// Reasons why the garment is unusable.
    pub refused: Vec<ImportDiagnostic>,
}

/// Report about one piece of the file.
#[derive(Debug, Clone, PartialEq, Eq, Serialize)]
pub struct PieceReport {
    /// Node or group name.
    pub name: String,
    /// Material name.
    pub material: Option<String>,
    /// Vertices in the file.
    pub vertices: usize,
    /// Triangles.
    pub triangles: usize,
    /// Whether it has texture coordinates.
    pub has_uv: bool,
    /// Whether a skin moves it.
    pub skinned: bool,
    /// Whether it is part of the garment.
    pub worn: bool,
}

/// Report about one connected part of the garment.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct PartReport {
    /// Triangles.
    pub triangles: usize,
    /// Area \[m2\].
    pub area_m2: f64,
}

/// Makes the report; `diagnostics` are those of reading the file and of building the garment.
///
/// ```
/// use crease_model::garment::{Garment, MeshOptions, SourceAsset, inspect};
/// let (positions, triangles) = ([[0.0, 0.0, 0.0], [0.2, 0.0, 0.0], [0.2, 0.0, 0.2]], [[0, 2, 1]]);
/// let asset = SourceAsset::from_mesh(&positions, &triangles, &MeshOptions::default())?.0;
/// let (garment, diagnostics) = Garment::from_asset(&asset)?;
/// let inspection = inspect(&asset, &garment, &diagnostics);
/// assert_eq!((inspection.points, inspection.parts.len()), (3, 1));
/// assert!((inspection.area_m2 - 0.02).abs() < 1e-12);
/// # Ok::<(), crease_model::error::Error>(())
/// ```
pub fn inspect(asset: &SourceAsset, garment: &Garment, diagnostics: &[ImportDiagnostic]) -> Inspection {
    let box_m = asset.worn_bounds().map_or([0.0; 3], |(low, high)| (high - low).into());
    let of = |severity| -> Vec<ImportDiagnostic> {
        diagnostics.iter().filter(|d| d.severity == severity).cloned().collect()
    };
    // Of cloth that was exported with its thickness, one side counts.
    let outer = outer_triangles(&garment.triangles, &garment.inner_side);
    let topology = Topology::new(garment.points.len(), &outer);
    let edges = edge_lengths_m(garment, &topology);
    let parts = part_reports(garment);
    let note =
        |message: Message| ImportDiagnostic { severity: Severity::Note, location: String::new(), message };
    let trims = RigidParts::find(garment).map(|rigid| rigid.notes()).into_iter().flatten().map(Message::from);
    let told = content_warnings(asset, garment).into_iter().chain(trims).map(note);
    let notes: Vec<ImportDiagnostic> = of(Severity::Note);
    let source_triangles: usize = asset.worn_pieces().map(|piece| piece.triangles.len()).sum();
    Inspection {
        file: asset.file.clone(),
        format: match asset.format {
            SourceFormat::Obj => "OBJ",
            SourceFormat::Gltf => "glTF",
            SourceFormat::Usd => "USD",
            SourceFormat::Arrays => "arrays",
        },
        sha256: asset.sha256.clone(),
        unit_m: asset.unit_m,
        up: match asset.up {
            UpAxis::Y => "y",
            UpAxis::Z => "z",
        },
        box_m,
        box_units: box_m.map(|side| side / asset.unit_m),
        pieces: piece_reports(asset),
        contents: FileContents::default(),
        vertices: garment.source_point.len(),
        points: garment.points.len(),
        triangles: garment.triangles.len(),
        dropped_triangles: source_triangles.saturating_sub(garment.triangles.len()),
        hinges: garment.topology.hinges.len(),
        welded_vertices: garment.source_point.len().saturating_sub(garment.points.len()),
        boundary_loops_m: boundary_loops_m(garment, &topology, &outer),
        non_manifold_edges: topology.edge_valence.iter().filter(|&&valence| valence > 2).count(),
        misoriented_edges: garment.topology.misoriented.len(),
        warp_from_uv: garment.material_from_uv,
        pieces_with_uv: asset.worn_pieces().filter(|piece| piece.uvs.is_some()).count(),
        mean_edge_mm: 1e3 * edges.iter().sum::<f64>() / edges.len().max(1) as f64,
        shortest_edge_mm: 1e3 * edges.iter().copied().reduce(f64::min).unwrap_or(0.0),
        area_m2: parts.iter().map(|part| part.area_m2).sum(),
        parts,
        crossings_at_start: None,
        notes: notes.into_iter().chain(told).collect(),
        warnings: of(Severity::Warning),
        repaired: of(Severity::Repaired),
        refused: of(Severity::Refused),
    }
}

fn piece_reports(asset: &SourceAsset) -> Vec<PieceReport> {
    let report = |piece: &crate::garment::SourcePiece| PieceReport {
        name: piece.name.clone(),
        material: piece.material.clone(),
        vertices: piece.positions.len(),
        triangles: piece.triangles.len(),
        has_uv: piece.uvs.is_some(),
        skinned: matches!(piece.placement, Placement::Skinned(_)),
        worn: piece.worn,
    };
    asset.pieces.iter().map(report).collect()
}

fn part_reports(garment: &Garment) -> Vec<PartReport> {
    let count = garment.triangle_part.iter().max().map_or(0, |&last| last as usize + 1);
    let mut parts = vec![PartReport { triangles: 0, area_m2: 0.0 }; count];
    let outer = (0..garment.triangles.len()).filter(|f| !garment.inner_side[*f]);
    for (flat, part) in outer.map(|f| (&garment.material[f], garment.triangle_part[f])) {
        let (a, b) = (flat[1] - flat[0], flat[2] - flat[0]);
        parts[part as usize].triangles += 1;
        parts[part as usize].area_m2 += 0.5 * (a.x * b.y - a.y * b.x).abs();
    }
    // A part that is an inner side has none.
    parts.retain(|part| part.triangles > 0);
    parts
}

fn edge_lengths_m(garment: &Garment, topology: &Topology) -> Vec<f64> {
    let length = |&[a, b]: &[PointIndex; 2]| (garment.points[b.at()] - garment.points[a.at()]).norm();
    topology.edges.iter().map(length).collect()
}

fn boundary_loops_m(garment: &Garment, topology: &Topology, triangles: &[[PointIndex; 3]]) -> Vec<f64> {
    let loops = topology.boundary_loops(triangles);
    let mut lengths: Vec<f64> = loops.iter().map(|border| loop_length(&garment.points, border)).collect();
    lengths.sort_by(|a: &f64, b| b.total_cmp(a));
    lengths
}

impl Inspection {
    /// Returns the report with its diagnostics in the words of `words`.
    pub fn worded(mut self, words: &dyn Vocabulary) -> Self {
        for list in [&mut self.notes, &mut self.warnings, &mut self.repaired, &mut self.refused] {
            let all = std::mem::take(list).into_iter();
            *list = all.map(|diagnostic| diagnostic.worded(words)).collect();
        }
        self
    }

    /// Returns the report as text for a person, several lines, each ended.
    pub fn to_text(&self) -> String {
        let mut text = String::new();
        // Writing to a string cannot fail.
        let _ = self.write_text(&mut text);
        text
    }

    fn write_text(&self, out: &mut String) -> std::fmt::Result {
        let [x, y, z] = self.box_m;
        let [ux, uy, uz] = self.box_units;
        let file = printable(&self.file);
        writeln!(out, "{file} ({}, {} up, 1 unit = {} m)", self.format, self.up, self.unit_m)?;
        writeln!(out, "  box        {x:.3} x {y:.3} x {z:.3} m ({ux:.4} x {uy:.4} x {uz:.4} file units)")?;
        self.write_pieces(out)?;
        let names: Vec<Cow<str>> = self.pieces.iter().map(|piece| printable(&piece.name)).collect();
        self.contents.write_text(out, &names)?;
        writeln!(
            out,
            "  mesh       {} vertices, {} points ({} welded), {} triangles ({} dropped), {} hinges",
            self.vertices,
            self.points,
            self.welded_vertices,
            self.triangles,
            self.dropped_triangles,
            self.hinges
        )?;
        writeln!(
            out,
            "  edges      mean {:.2} mm, shortest {:.3} mm; {} non-manifold, {} misoriented",
            self.mean_edge_mm, self.shortest_edge_mm, self.non_manifold_edges, self.misoriented_edges
        )?;
        let parts: Vec<String> =
            self.parts.iter().take(MAX_LISTED_LOOPS).map(|p| p.triangles.to_string()).collect();
        writeln!(
            out,
            "  parts      {} ({} triangles), {:.3} m2 of cloth",
            self.parts.len(),
            abridged(&parts, self.parts.len()),
            self.area_m2
        )?;
        let loops: Vec<String> = self
            .boundary_loops_m
            .iter()
            .take(MAX_LISTED_LOOPS)
            .map(|length| format!("{length:.3}"))
            .collect();
        let count = self.boundary_loops_m.len();
        let lengths = if count > 0 { format!(" ({} m)", abridged(&loops, count)) } else { String::new() };
        writeln!(out, "  openings   {count}{lengths}")?;
        let warp = if self.warp_from_uv { "texture coordinates" } else { "the shape" };
        writeln!(
            out,
            "  warp       from {warp}; {} worn pieces have texture coordinates",
            self.pieces_with_uv
        )?;
        match self.crossings_at_start {
            Some(count) => writeln!(out, "  crossings  {count} pairs of triangles")?,
            None => writeln!(out, "  crossings  not counted")?,
        }
        for (title, diagnostics) in [
            ("note", &self.notes),
            ("warning", &self.warnings),
            ("repaired", &self.repaired),
            ("refused", &self.refused),
        ] {
            for diagnostic in diagnostics {
                let location = if diagnostic.location.is_empty() {
                    String::new()
                } else {
                    format!("{}: ", printable(&diagnostic.location))
                };
                writeln!(out, "  {title:<10} {location}{}", printable(&diagnostic.message))?;
            }
        }
        Ok(())
    }

    fn write_pieces(&self, out: &mut String) -> std::fmt::Result {
        for (number, piece) in self.pieces.iter().take(MAX_LISTED_PIECES).enumerate() {
            let material = piece
                .material
                .as_ref()
                .map_or(String::new(), |name| format!(", material \"{}\"", printable(name)));
            let uv = if piece.has_uv { ", UV" } else { "" };
            let skinned = if piece.skinned { ", skinned" } else { "" };
            let worn = if piece.worn { "" } else { ", not worn" };
            writeln!(
                out,
                "  piece#{number:<4} \"{}\": {} vertices, {} triangles{material}{uv}{skinned}{worn}",
                printable(&piece.name),
                piece.vertices,
                piece.triangles
            )?;
        }
        if self.pieces.len() > MAX_LISTED_PIECES {
            writeln!(out, "  piece      and {} more", self.pieces.len() - MAX_LISTED_PIECES)?;
        }
        Ok(())
    }
}

/// Returns "1, 2, 3 and 5 more".
fn abridged(shown: &[String], count: usize) -> String {
    let list = shown.join(", ");
    if count > shown.len() { format!("{list} and {} more", count - shown.len()) } else { list }
}
