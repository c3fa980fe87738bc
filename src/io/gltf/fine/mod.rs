//! Writes the worn surface as a finer mesh: `OUT.fine.glb`.
//!
//! The worn GLB is read back, its worn primitives get more vertices along creases and in wrinkles (`FineMesh`), and their morph target
//! `worn` is sampled from the worn surface. The vertices of the file stay the first ones with all of their attributes; what a new one has
//! is the mean of those at the ends of its edge.

mod rows;
mod skin_rows;
#[cfg(test)]
mod tests;
mod worn_rows;

use crate::gltf::append::{Appender, Purpose};
use crate::gltf::detail::{DetailInput, read_back};
use crate::gltf::fine::rows::PrimitiveRows;
use crate::gltf::fine::worn_rows::WornVertex;
use crate::gltf::smooth_shading::tilt_flat_normals;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::{PointIndex, triangle_key};
use crease_model::error::{Error, Result};
use crease_model::garment::{SourceAsset, SourcePiece};
use crease_model::remesh::{FileMesh, FileTriangle, FineMesh, FineVertex};
use rustc_hash::FxHashMap;
use serde_json::{Value, json};

/// Length of the edges of a finer mesh along creases and in wrinkles [m]: a third of those of a simulated mesh at its folds.
pub const FINE_EDGE: f64 = 4e-3;

/// GLB of a finer mesh, and its size.
#[derive(Debug, Clone, PartialEq)]
pub struct FineOutput {
    /// GLB file.
    pub glb: Vec<u8>,
    /// Vertices of the worn pieces.
    pub vertices: usize,
    /// Triangles of the worn pieces.
    pub triangles: usize,
    /// Pairs of triangles that intersect and whose triangles of the file do not.
    pub crossings: usize,
    /// Per worn piece: its new vertices, which follow those of the file.
    pub added: Vec<Vec<FineVertex>>,
}

/// Writes the worn file `glb` (as [`crate::gltf::write_worn_glb`] wrote it for `detail.coarse`; `asset` is its source) with edges of about
/// `edge` [m] along creases and in wrinkles.
///
/// # Errors
/// [`Error::Input`] for a worn file that is not of `asset`, or cannot be read.
pub fn write_fine_glb(
    glb: &[u8],
    asset: &SourceAsset,
    detail: &DetailInput,
    edge: f64,
) -> Result<FineOutput> {
    let worn = read_back(glb, asset, detail)?;
    let Some(document) = &worn.document else {
        return Err(Error::input(&asset.file, "fine mesh", "the worn file is no glTF", ""));
    };
    let pieces = fine_pieces(&worn, detail);
    let (triangles, flat) = file_triangles(&pieces, detail);
    let coarse = detail.coarse;
    let after: Vec<Vec3> = coarse.points.iter().zip(detail.displacement).map(|(x, d)| x + d).collect();
    let file = FileMesh {
        points: &coarse.points,
        after: &after,
        vertex_count: coarse.source_point.len(),
        triangles: &triangles,
    };
    let fine = FineMesh::new(&file, detail.surface, edge);
    let numbers = Numbers::new(&pieces, &fine);
    let mut appender = Appender::from_document(&worn.file, document)?;
    let mut output = FineOutput {
        glb: Vec::new(),
        vertices: coarse.source_point.len() + fine.vertices.len(),
        triangles: fine.triangles.len() + flat.iter().map(Vec::len).sum::<usize>(),
        crossings: fine.crossings,
        added: Vec::with_capacity(pieces.len()),
    };
    for (k, piece) in pieces.iter().enumerate() {
        let vertices: Vec<&FineVertex> = numbers.new[k].iter().map(|v| &fine.vertices[*v]).collect();
        let own = fine.triangles.iter().filter(|t| numbers.piece_of(t[0]) == k);
        let mut corners: Vec<[u32; 3]> = own.map(|t| t.map(|v| numbers.local(v))).collect();
        corners.extend(&flat[k]);
        let mut rows = PrimitiveRows::read(document, piece, &vertices)?;
        rows.tilt_flat(piece, &corners);
        let worn_vertices = WornVertex::all(piece, detail, &vertices, &fine.points);
        rows.set_worn(&asset.file, document, piece, &worn_vertices)?;
        rows.write(&mut appender, piece.source, &corners);
        output.added.push(vertices.into_iter().copied().collect());
    }
    output.glb = appender.into_glb();
    Ok(output)
}

/// Worn piece of a file.
pub(super) struct FinePiece<'a> {
    pub(super) source: &'a SourcePiece,
    /// Per vertex: its point.
    pub(super) points: &'a [PointIndex],
    /// Number of its first vertex among those of all worn pieces.
    pub(super) first: usize,
}

fn fine_pieces<'a>(worn: &'a SourceAsset, detail: &'a DetailInput) -> Vec<FinePiece<'a>> {
    let mut first = 0;
    let mut next = |source: &'a SourcePiece| {
        let points = &detail.coarse.source_point[first..first + source.positions.len()];
        let piece = FinePiece { source, points, first };
        first += points.len();
        piece
    };
    worn.worn_pieces().map(&mut next).collect()
}

/// Triangles of the pieces, in the order of the file; and per piece those between fewer than three points, which have no area.
fn file_triangles(pieces: &[FinePiece], detail: &DetailInput) -> (Vec<FileTriangle>, Vec<Vec<[u32; 3]>>) {
    let starts = detail.surface.starts(&detail.coarse.points, &detail.coarse.triangles);
    let known = detail.coarse.triangles.iter().map(|t| triangle_key(t.map(|p| p.0)));
    let starts: FxHashMap<[u32; 3], Option<u32>> = known.zip(starts).collect();
    let (mut all, mut flat) = (Vec::new(), vec![Vec::new(); pieces.len()]);
    for (piece, flat) in pieces.iter().zip(&mut flat) {
        for t in piece.source.file_triangles() {
            let points = t.map(|v| piece.points[v as usize].0);
            let [a, b, c] = points;
            if a == b || b == c || c == a {
                flat.push(t);
                continue;
            }
            let start = starts.get(&triangle_key(points)).copied().flatten();
            all.push(FileTriangle { points, vertices: t.map(|v| v + piece.first as u32), start });
        }
    }
    (all, flat)
}

/// Numbers of vertices: of all worn pieces together, and within a piece, where those of the file come first.
struct Numbers {
    /// Per piece: the number of its first vertex of the file; at the end the number of all of them.
    first: Vec<usize>,
    /// Per piece: its new vertices, as positions in their list.
    new: Vec<Vec<usize>>,
    /// Per new vertex: its piece and its number there.
    place: Vec<(usize, u32)>,
}

impl Numbers {
    fn new(pieces: &[FinePiece], fine: &FineMesh) -> Self {
        let mut first: Vec<usize> = pieces.iter().map(|piece| piece.first).collect();
        first.push(pieces.last().map_or(0, |piece| piece.first + piece.points.len()));
        let mut numbers = Self { first, new: vec![Vec::new(); pieces.len()], place: Vec::new() };
        for (k, vertex) in fine.vertices.iter().enumerate() {
            let piece = numbers.piece_of(vertex.of[0]);
            let own = pieces[piece].points.len() + numbers.new[piece].len();
            numbers.place.push((piece, own as u32));
            numbers.new[piece].push(k);
        }
        numbers
    }

    fn file_count(&self) -> usize {
        self.first.last().copied().unwrap_or(0)
    }

    fn piece_of(&self, vertex: u32) -> usize {
        match (vertex as usize).checked_sub(self.file_count()) {
            Some(k) => self.place[k].0,
            None => self.first.partition_point(|first| *first <= vertex as usize) - 1,
        }
    }

    fn local(&self, vertex: u32) -> u32 {
        match (vertex as usize).checked_sub(self.file_count()) {
            Some(k) => self.place[k].1,
            None => vertex - self.first[self.piece_of(vertex)] as u32,
        }
    }
}

impl PrimitiveRows {
    /// Tilts normals of new vertices where `triangles` would be taken for flat-shaded.
    fn tilt_flat(&mut self, piece: &FinePiece, triangles: &[[u32; 3]]) {
        let of = |name: &str| self.attributes.iter().position(|rows| rows.name == name && rows.width == 3);
        let Some((positions, normals)) = of("POSITION").zip(of("NORMAL")) else { return };
        let positions = self.attributes[positions].vectors();
        let mut tilted = self.attributes[normals].vectors();
        if tilt_flat_normals(&positions, triangles, &mut tilted, piece.points.len()) {
            self.attributes[normals].values = tilted.iter().flat_map(|n| [n.x, n.y, n.z]).collect();
        }
    }

    /// Writes the rows and `triangles` as those of the primitive of `piece`.
    fn write(&self, appender: &mut Appender, piece: &SourcePiece, triangles: &[[u32; 3]]) {
        let attributes = self.attributes.iter().map(|rows| (rows.name.clone(), rows.append(appender)));
        let attributes: Vec<(String, usize)> = attributes.collect();
        let targets: Vec<Value> = self
            .targets
            .iter()
            .map(|target| {
                let each = target.iter().map(|rows| (rows.name.clone(), json!(rows.append(appender))));
                Value::Object(each.collect())
            })
            .collect();
        let indices = appender.triangles(triangles);
        let Some(mesh) = appender.list("meshes").get_mut(piece.mesh) else { return };
        let Some(primitive) = mesh["primitives"][piece.primitive].as_object_mut() else { return };
        primitive.shift_remove("mode");
        primitive.insert("indices".into(), json!(indices));
        primitive.insert("attributes".into(), Value::Object(Default::default()));
        for (name, accessor) in attributes {
            primitive["attributes"][name] = json!(accessor);
        }
        primitive.insert("targets".into(), Value::Array(targets));
    }
}

impl rows::AttributeRows {
    /// Appends the rows; returns the accessor's index.
    fn append(&self, appender: &mut Appender) -> usize {
        let purpose = if self.name == "POSITION" { Purpose::Position } else { Purpose::Vertex };
        fn narrow<const N: usize>(values: &[f64]) -> Vec<[f32; N]> {
            values.as_chunks::<N>().0.iter().map(|row| row.map(|x| x as f32 + 0.0)).collect()
        }
        if self.is_target && self.name == "POSITION" && self.values.iter().all(|x| *x == 0.0) {
            return appender.zero_positions(self.values.len() / 3);
        }
        match self.width {
            1 => appender.vectors(&narrow::<1>(&self.values), purpose),
            2 => appender.vectors(&narrow::<2>(&self.values), purpose),
            4 if self.is_joints => {
                let rows = self.values.as_chunks::<4>().0.iter().map(|row| row.map(|x| x as u16));
                appender.joints(&rows.collect::<Vec<_>>())
            }
            4 => appender.vectors(&narrow::<4>(&self.values), purpose),
            _ => appender.vectors(&narrow::<3>(&self.values), purpose),
        }
    }
}
