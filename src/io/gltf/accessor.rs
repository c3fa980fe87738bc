//! Accessors: typed tables in a document's buffers (glTF 2.0 specification, 3.6.2), every access checked.
//!
//! Reads interleaved, sparse, normalised and quantised data, and accessors without a buffer view, which are zero
//! (Blender writes them for empty morph targets). All values are converted to f64. Does not decode compressed buffer
//! views: documents that need them are rejected before anything is read.

use crate::gltf::json_cursor::Cursor;
use crate::tuning::TUNING;
use crease_geometry::math::Mat4;
use crease_model::error::Result;
use crease_model::garment::GltfDocument;
use serde_json::Value;

/// Content of an accessor: rows of equal width.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    /// Components per row: 1 for SCALAR, 3 for VEC3, 16 for MAT4 (column by column).
    pub width: usize,
    /// Row after row; normalised integers already as -1..1 or 0..1.
    pub values: Vec<f64>,
}

impl Table {
    /// Returns the rows.
    pub fn rows(&self) -> std::slice::ChunksExact<'_, f64> {
        self.values.chunks_exact(self.width.max(1))
    }

    /// Returns the number of rows.
    pub fn row_count(&self) -> usize {
        self.values.len() / self.width.max(1)
    }

    /// Returns row `row`; `None` beyond the end.
    pub fn row(&self, row: usize) -> Option<&[f64]> {
        self.values.get(row.checked_mul(self.width)?..row.checked_add(1)?.checked_mul(self.width)?)
    }

    /// Returns the rows as matrices; none if the width is not 16.
    pub fn matrices(&self) -> Vec<Mat4> {
        if self.width != 16 {
            return Vec::new();
        }
        self.rows().map(Mat4::from_column_slice).collect()
    }
}

/// Accessors of one document.
#[derive(Clone)]
pub struct Accessors<'a> {
    root: Cursor<'a>,
    buffers: &'a [Vec<u8>],
}

#[derive(Clone, Copy, PartialEq, Eq)]
enum Component {
    I8,
    U8,
    I16,
    U16,
    U32,
    F32,
}

impl Component {
    fn of(cursor: &Cursor) -> Result<Self> {
        Ok(match cursor.required_index("componentType")? {
            5120 => Self::I8,
            5121 => Self::U8,
            5122 => Self::I16,
            5123 => Self::U16,
            5125 => Self::U32,
            5126 => Self::F32,
            other => return Err(cursor.error(format!("component type {other} is unknown"))),
        })
    }

    fn bytes(self) -> usize {
        match self {
            Self::I8 | Self::U8 => 1,
            Self::I16 | Self::U16 => 2,
            Self::U32 | Self::F32 => 4,
        }
    }

    /// Reads the component at the start of `bytes`; zero if they end within it (callers check before).
    fn read(self, bytes: &[u8]) -> f64 {
        fn first<const N: usize>(bytes: &[u8]) -> [u8; N] {
            bytes.get(..N).and_then(|head| head.try_into().ok()).unwrap_or([0; N])
        }
        match self {
            Self::I8 => f64::from(i8::from_le_bytes(first(bytes))),
            Self::U8 => f64::from(u8::from_le_bytes(first(bytes))),
            Self::I16 => f64::from(i16::from_le_bytes(first(bytes))),
            Self::U16 => f64::from(u16::from_le_bytes(first(bytes))),
            Self::U32 => f64::from(u32::from_le_bytes(first(bytes))),
            Self::F32 => f64::from(f32::from_le_bytes(first(bytes))),
        }
    }

    /// Returns an integer as a fraction of its range (specification 3.11: f = max(c / 127, -1) and so on).
    fn normalised(self, value: f64) -> f64 {
        match self {
            Self::I8 => (value / 127.0).max(-1.0),
            Self::U8 => value / 255.0,
            Self::I16 => (value / 32_767.0).max(-1.0),
            Self::U16 => value / 65_535.0,
            Self::U32 => value / 4_294_967_295.0,
            Self::F32 => value,
        }
    }
}

/// Memory layout of one element.
#[derive(Clone, Copy)]
struct Layout {
    component: Component,
    rows: usize,
    columns: usize,
    normalised: bool,
}

impl Layout {
    fn of(accessor: &Cursor) -> Result<Self> {
        let (rows, columns) = match accessor.text("type") {
            Some("SCALAR") => (1, 1),
            Some("VEC2") => (2, 1),
            Some("VEC3") => (3, 1),
            Some("VEC4") => (4, 1),
            Some("MAT2") => (2, 2),
            Some("MAT3") => (3, 3),
            Some("MAT4") => (4, 4),
            other => return Err(accessor.error(format!("type {other:?} is unknown"))),
        };
        let normalised = accessor.member("normalized").as_flag();
        Ok(Self { component: Component::of(accessor)?, rows, columns, normalised })
    }

    fn width(self) -> usize {
        self.rows * self.columns
    }

    /// Returns the bytes of a column; matrix columns begin at multiples of four bytes.
    fn column_bytes(self) -> usize {
        let bytes = self.rows * self.component.bytes();
        if self.columns > 1 { bytes.next_multiple_of(4) } else { bytes }
    }

    fn bytes(self) -> usize {
        self.columns * self.column_bytes()
    }

    fn read(self, element: &[u8], values: &mut Vec<f64>) {
        for column in 0..self.columns {
            for row in 0..self.rows {
                let at = column * self.column_bytes() + row * self.component.bytes();
                let value = self.component.read(element.get(at..).unwrap_or(&[]));
                values.push(if self.normalised { self.component.normalised(value) } else { value });
            }
        }
    }
}

/// Evenly spaced elements within a buffer view, already known to lie inside it.
struct StridedElements<'a> {
    bytes: &'a [u8],
    stride: usize,
    element_bytes: usize,
    count: usize,
}

impl<'a> StridedElements<'a> {
    fn iter(&self) -> impl Iterator<Item = &'a [u8]> {
        let (bytes, stride, size) = (self.bytes, self.stride, self.element_bytes);
        (0..self.count).map(move |k| bytes.get(k * stride..k * stride + size).unwrap_or(&[]))
    }
}

impl<'a> Accessors<'a> {
    /// Returns the accessors of `document`.
    pub fn new(document: &'a GltfDocument) -> Self {
        Self::from_parts(&document.json, &document.buffers)
    }

    pub(super) fn from_parts(json: &'a Value, buffers: &'a [Vec<u8>]) -> Self {
        Self { root: Cursor::root(json), buffers }
    }

    /// Returns the number of bytes of all buffers.
    pub(super) fn byte_count(&self) -> usize {
        self.buffers.iter().map(Vec::len).sum()
    }

    /// Returns the number of rows that accessor `index` states; `user` is the location that refers to it.
    pub fn row_count(&self, index: usize, user: &str) -> Result<usize> {
        self.root.required_entry("accessors", index, user)?.required_index("count")
    }

    /// Reads accessor `index`; `user` is the location that refers to it.
    pub fn table(&self, index: usize, user: &str) -> Result<Table> {
        let accessor = self.root.required_entry("accessors", index, user)?;
        let layout = Layout::of(&accessor)?;
        let count = accessor.required_index("count")?;
        let mut values = match accessor.index("bufferView")? {
            Some(view) => {
                let offset = accessor.index("byteOffset")?.unwrap_or(0);
                let elements = self.elements(&accessor, view, offset, layout.bytes(), count)?;
                let mut values = Vec::with_capacity(count * layout.width());
                elements.iter().for_each(|element| layout.read(element, &mut values));
                values
            }
            None => {
                if count > self.byte_count().max(TUNING.max_empty_rows) {
                    return Err(accessor.error(format!("{count} rows without any data")));
                }
                vec![0.0; count * layout.width()]
            }
        };
        if accessor.member("sparse").exists() {
            self.replace_sparse(&accessor, layout, &mut values)?;
        }
        Ok(Table { width: layout.width(), values })
    }

    /// Reads accessor `index`, which must have `width` components per row and `count` rows (if given).
    pub fn table_of(&self, index: usize, width: usize, count: Option<usize>, user: &str) -> Result<Table> {
        if let Some(count) = count {
            let stated = self.row_count(index, user)?;
            if stated != count {
                let accessor = self.root.entry("accessors", index);
                return Err(accessor.error(format!("{stated} rows where {user} needs {count}")));
            }
        }
        let table = self.table(index, user)?;
        if table.width != width {
            let accessor = self.root.entry("accessors", index);
            return Err(
                accessor.error(format!("{} components a row where {user} needs {width}", table.width))
            );
        }
        Ok(table)
    }

    /// Reads the unsigned integers of accessor `index`: triangle corners.
    pub fn indices(&self, index: usize, user: &str) -> Result<Vec<u32>> {
        let accessor = self.root.required_entry("accessors", index, user)?;
        let layout = Layout::of(&accessor)?;
        let whole = matches!(layout.component, Component::U8 | Component::U16 | Component::U32);
        if !whole || layout.width() != 1 {
            return Err(accessor.error("indices must be unsigned whole numbers"));
        }
        let table = self.table(index, user)?;
        // f64 holds every u32 exactly, unless it is normalised.
        if layout.normalised {
            return Err(accessor.error("indices cannot be normalized"));
        }
        Ok(table.values.iter().map(|&value| value as u32).collect())
    }

    /// Replaces the rows that a sparse accessor lists.
    fn replace_sparse(&self, accessor: &Cursor, layout: Layout, values: &mut [f64]) -> Result<()> {
        let sparse = accessor.member("sparse");
        let count = sparse.required_index("count")?;
        let indices = sparse.member("indices");
        let index_layout =
            Layout { component: Component::of(&indices)?, rows: 1, columns: 1, normalised: false };
        if !matches!(index_layout.component, Component::U8 | Component::U16 | Component::U32) {
            return Err(indices.error("indices must be unsigned whole numbers"));
        }
        let contents = sparse.member("values");
        let mut row = Vec::with_capacity(layout.width());
        let index_elements = self.sparse_elements(&indices, index_layout, count)?;
        let value_elements = self.sparse_elements(&contents, layout, count)?;
        for (index, content) in index_elements.iter().zip(value_elements.iter()) {
            row.clear();
            layout.read(content, &mut row);
            let row_index = index_layout.component.read(index) as usize;
            let start = row_index.saturating_mul(layout.width());
            match values.get_mut(start..start.saturating_add(layout.width())) {
                Some(slot) => slot.copy_from_slice(&row),
                None => return Err(indices.error(format!("row {row_index} is beyond the end"))),
            }
        }
        Ok(())
    }

    fn sparse_elements(&self, part: &Cursor, layout: Layout, count: usize) -> Result<StridedElements<'a>> {
        let offset = part.index("byteOffset")?.unwrap_or(0);
        self.elements(part, part.required_index("bufferView")?, offset, layout.bytes(), count)
    }

    /// Returns `count` elements from `offset` on in buffer view `view`.
    fn elements(
        &self,
        user: &Cursor,
        view: usize,
        offset: usize,
        element_bytes: usize,
        count: usize,
    ) -> Result<StridedElements<'a>> {
        let view = self.root.required_entry("bufferViews", view, user.path())?;
        let number = view.required_index("buffer")?;
        let Some(buffer) = self.buffers.get(number) else {
            return Err(view.error(format!("buffers[{number}] is not in the file")));
        };
        let start = view.index("byteOffset")?.unwrap_or(0);
        let length = view.required_index("byteLength")?;
        let Some(bytes) = start.checked_add(length).and_then(|end| buffer.get(start..end)) else {
            return Err(view.error(format!(
                "bytes {start} to {} of buffers[{number}], which has {}",
                start.saturating_add(length),
                buffer.len()
            )));
        };
        let stride = view.index("byteStride")?.filter(|&stride| stride > 0).unwrap_or(element_bytes);
        // Overlapping elements would let a short file ask for any amount of memory.
        if stride < element_bytes {
            return Err(view.error(format!("byteStride {stride} for elements of {element_bytes} bytes")));
        }
        let needed = match count {
            0 => Some(0),
            _ => (count - 1).checked_mul(stride).and_then(|x| x.checked_add(element_bytes)),
        };
        let bytes = bytes.get(offset..);
        match (bytes, needed) {
            (Some(bytes), Some(needed)) if needed <= bytes.len() => {
                Ok(StridedElements { bytes, stride, element_bytes, count })
            }
            _ => Err(user.error(format!(
                "{count} elements of {element_bytes} bytes from byte {offset} on do not fit into {}, which has {length} bytes",
                view.path()
            ))),
        }
    }
}
