//! Rows of the attributes and morph targets of a primitive, those of the file first, then the means that new vertices have.

use crate::gltf::accessor::Accessors;
use crate::gltf::fine::FinePiece;
use crate::gltf::fine::skin_rows::mix_influences;
use crate::gltf::json_cursor::Cursor;
use crease_model::error::Result;
use crease_model::garment::GltfDocument;
use crease_model::remesh::FineVertex;

/// Widths of attributes: SCALAR to VEC4.
const WIDTHS: std::ops::RangeInclusive<usize> = 1..=4;

/// Rows of one attribute, one per vertex.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AttributeRows {
    pub(super) name: String,
    /// Numbers per row.
    pub(super) width: usize,
    pub(super) values: Vec<f64>,
    /// Whether the numbers are joints.
    pub(super) is_joints: bool,
    /// Whether it belongs to a morph target.
    pub(super) is_target: bool,
}

/// Rows of a primitive.
pub(super) struct PrimitiveRows {
    pub(super) attributes: Vec<AttributeRows>,
    /// Per morph target.
    pub(super) targets: Vec<Vec<AttributeRows>>,
}

impl PrimitiveRows {
    /// Reads the rows of `piece` and adds those of the new `vertices`.
    pub(super) fn read(document: &GltfDocument, piece: &FinePiece, vertices: &[&FineVertex]) -> Result<Self> {
        let root = Cursor::root(&document.json);
        let primitive = root.entry("meshes", piece.source.mesh).entry("primitives", piece.source.primitive);
        let reader = RowReader { accessors: Accessors::new(document), root, piece, vertices };
        let mut attributes = reader.all(&primitive.member("attributes"), false)?;
        mix_influences(&mut attributes, piece, vertices);
        let targets = primitive.entries("targets");
        let targets = targets.iter().map(|target| reader.all(target, true)).collect::<Result<_>>()?;
        Ok(Self { attributes, targets })
    }
}

/// Mean of the rows of the file that `vertex` is of; `first` is the number of the first vertex of its piece.
pub(super) fn mean_row(values: &[f64], width: usize, vertex: &FineVertex, first: usize) -> Vec<f64> {
    let part = |k: usize, at: usize| vertex.weights[k] * values[(vertex.of[k] as usize - first) * width + at];
    (0..width).map(|at| (0..3).map(|k| part(k, at)).sum()).collect()
}

/// Row of the file that `vertex` is closest to.
fn nearest_row(values: &[f64], width: usize, vertex: &FineVertex, first: usize) -> Vec<f64> {
    let largest = (0..3).max_by(|a, b| vertex.weights[*a].total_cmp(&vertex.weights[*b]).then(b.cmp(a)));
    let start = (vertex.of[largest.unwrap_or(0)] as usize - first) * width;
    values[start..start + width].to_vec()
}

/// Reader of the rows of one primitive.
struct RowReader<'a> {
    root: Cursor<'a>,
    accessors: Accessors<'a>,
    piece: &'a FinePiece<'a>,
    vertices: &'a [&'a FineVertex],
}

impl RowReader<'_> {
    /// The rows of all attributes of a list of them.
    fn all(&self, list: &Cursor, is_target: bool) -> Result<Vec<AttributeRows>> {
        let mut all = Vec::new();
        for name in list.keys() {
            let Some(accessor) = list.index(name)? else { continue };
            let count = self.piece.points.len();
            let table = self.accessors.table(accessor, list.path())?;
            if table.row_count() != count || !WIDTHS.contains(&table.width) {
                continue;
            }
            let mut rows = AttributeRows {
                name: name.to_owned(),
                width: table.width,
                values: table.values,
                is_joints: name.starts_with("JOINTS_"),
                is_target,
            };
            let is_number = self.is_number(accessor, name);
            for vertex in self.vertices {
                rows.values.extend(self.new_row(&rows, vertex, is_number));
            }
            all.push(rows);
        }
        Ok(all)
    }

    /// Whether the accessor of an attribute of a program's own holds whole numbers, between which there are none.
    fn is_number(&self, accessor: usize, name: &str) -> bool {
        let accessor = self.root.entry("accessors", accessor);
        let is_float = accessor.index("componentType").ok().flatten() == Some(5126);
        name.starts_with('_') && !is_float && !accessor.member("normalized").as_flag()
    }

    fn new_row(&self, rows: &AttributeRows, vertex: &FineVertex, is_number: bool) -> Vec<f64> {
        let (values, width, first) = (&rows.values, rows.width, self.piece.first);
        if is_number || rows.is_joints {
            return nearest_row(values, width, vertex, first);
        }
        let mut row = mean_row(values, width, vertex, first);
        if rows.is_target {
            return row;
        }
        if rows.name == "TANGENT" && width == 4 {
            row[3] = nearest_row(values, width, vertex, first)[3];
        }
        if ["NORMAL", "TANGENT"].contains(&rows.name.as_str()) && width >= 3 {
            let length = row[..3].iter().map(|x| x * x).sum::<f64>().sqrt();
            match length > 1e-9 {
                true => row[..3].iter_mut().for_each(|x| *x /= length),
                false => row = nearest_row(values, width, vertex, first),
            }
        }
        row
    }
}
