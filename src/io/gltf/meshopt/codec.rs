//! Decoders of the three bitstreams of `EXT_meshopt_compression` (specification, appendix A).
//!
//! They return `None` for bytes that are not such a bitstream. The crate that wraps the reference implementation would bring
//! its C++ sources and with them a second compiler to every build.

/// Elements of a group of the attribute bitstream.
const GROUP: usize = 16;
/// Bytes of the largest block of the attribute bitstream.
const MAX_BLOCK_BYTES: usize = 8192;
/// Elements of the largest block of the attribute bitstream.
const MAX_BLOCK_ELEMENTS: usize = 256;
/// Smallest tail of the attribute bitstream [bytes].
const MIN_TAIL_BYTES: usize = 32;
/// Bytes of the table at the end of the triangle bitstream.
const TABLE_BYTES: usize = 16;
/// Padding at the end of the sequence bitstream [bytes].
const SEQUENCE_PADDING: usize = 4;

/// Reader of a bitstream.
struct Bytes<'a>(&'a [u8]);

impl<'a> Bytes<'a> {
    fn take(&mut self, count: usize) -> Option<&'a [u8]> {
        let (head, rest) = self.0.split_at_checked(count)?;
        self.0 = rest;
        Some(head)
    }

    fn byte(&mut self) -> Option<u8> {
        Some(self.take(1)?[0])
    }

    /// Reads a number of seven bits a byte, the lowest first.
    fn variable(&mut self) -> Option<u32> {
        let mut value = 0;
        for shift in (0..35).step_by(7) {
            let byte = self.byte()?;
            value |= u32::from(byte & 127).wrapping_shl(shift);
            if byte < 128 {
                return Some(value);
            }
        }
        None
    }
}

/// Decodes `count` elements of `stride` bytes of the attribute bitstream, version 0.
pub(super) fn decode_attributes(data: &[u8], count: usize, stride: usize) -> Option<Vec<u8>> {
    let tail = stride.max(MIN_TAIL_BYTES);
    let (body, end) = data.split_at_checked(data.len().checked_sub(tail)?)?;
    let mut bytes = Bytes(body);
    if bytes.byte()? != 0xa0 {
        return None;
    }
    let mut last = end.get(tail - stride..)?.to_vec();
    let mut out = vec![0; count * stride];
    let block = ((MAX_BLOCK_BYTES / stride) & !(GROUP - 1)).min(MAX_BLOCK_ELEMENTS);
    for first in (0..count).step_by(block) {
        let size = block.min(count - first);
        for k in 0..stride {
            let groups = size.div_ceil(GROUP);
            let header = bytes.take(groups.div_ceil(4))?;
            for group in 0..groups {
                let mode = (header[group / 4] >> (2 * (group % 4))) & 3;
                let deltas = decode_group(&mut bytes, mode)?;
                let start = first + group * GROUP;
                for (element, delta) in (start..first + size).zip(deltas) {
                    let change = (delta >> 1) ^ (delta & 1).wrapping_neg();
                    last[k] = last[k].wrapping_add(change);
                    out[element * stride + k] = last[k];
                }
            }
        }
    }
    Some(out)
}

/// Decodes the deltas of a group: none, of two or four bits with larger ones after them, or of eight.
fn decode_group(bytes: &mut Bytes, mode: u8) -> Option<[u8; GROUP]> {
    let mut deltas = [0; GROUP];
    match mode {
        0 => {}
        3 => deltas.copy_from_slice(bytes.take(GROUP)?),
        _ => {
            let bits = 2 * usize::from(mode);
            let largest = (1u8 << bits) - 1;
            let packed = bytes.take(GROUP * bits / 8)?;
            for (i, delta) in deltas.iter_mut().enumerate() {
                let at = i * bits;
                *delta = (packed[at / 8] >> (8 - bits - at % 8)) & largest;
                if *delta == largest {
                    *delta = bytes.byte()?;
                }
            }
        }
    }
    Some(deltas)
}

/// Most recent vertices and edges of the triangle bitstream.
struct Recent {
    vertices: [u32; 16],
    vertex: usize,
    edges: [[u32; 2]; 16],
    edge: usize,
    /// Vertex that was not used yet.
    next: u32,
    /// Vertex that was last written by its number.
    last: u32,
}

impl Recent {
    fn push_vertex(&mut self, vertex: u32, is_new: bool) {
        self.vertices[self.vertex] = vertex;
        self.vertex = (self.vertex + usize::from(is_new)) % 16;
    }

    fn push_edge(&mut self, edge: [u32; 2]) {
        self.edges[self.edge] = edge;
        self.edge = (self.edge + 1) % 16;
    }

    fn edge_before(&self, back: u8) -> [u32; 2] {
        self.edges[(self.edge + 15 - usize::from(back)) % 16]
    }

    /// Vertex by its code: 0 for a new one, else its place before the one that is `skipped` places before the next.
    fn vertex_of(&mut self, code: u8, skipped: usize) -> u32 {
        if code == 0 {
            self.next = self.next.wrapping_add(1);
            return self.next.wrapping_sub(1);
        }
        self.vertices[(self.vertex + 32 - usize::from(code) - skipped) % 16]
    }

    /// Vertex by the difference to the last that was written so.
    fn read_vertex(&mut self, bytes: &mut Bytes) -> Option<u32> {
        self.last = self.last.wrapping_add(difference(bytes.variable()?));
        Some(self.last)
    }
}

/// Signed difference in a number whose lowest bit is the sign.
fn difference(value: u32) -> u32 {
    (value >> 1) ^ (value & 1).wrapping_neg()
}

/// Decodes `count` indices of the triangle bitstream, versions 0 and 1.
pub(super) fn decode_triangles(data: &[u8], count: usize) -> Option<Vec<u32>> {
    let (body, table) = data.split_at_checked(data.len().checked_sub(TABLE_BYTES)?)?;
    let mut bytes = Bytes(body);
    let version = bytes.byte()?;
    if !(0xe0..=0xe1).contains(&version) || !count.is_multiple_of(3) {
        return None;
    }
    let codes = bytes.take(count / 3)?;
    // The codes beyond stand for a vertex beside the last; version 0 has none.
    let first_beside = if version == 0xe1 { 13 } else { 15 };
    let mut recent =
        Recent { vertices: [u32::MAX; 16], vertex: 0, edges: [[u32::MAX; 2]; 16], edge: 0, next: 0, last: 0 };
    let mut indices = Vec::with_capacity(count);
    for &code in codes {
        let (high, low) = (code >> 4, code & 15);
        let triangle = if high < 15 {
            let [a, b] = recent.edge_before(high);
            let c = match low {
                15 => recent.read_vertex(&mut bytes)?,
                13 | 14 if low >= first_beside => {
                    recent.last =
                        if low == 13 { recent.last.wrapping_sub(1) } else { recent.last.wrapping_add(1) };
                    recent.last
                }
                _ => recent.vertex_of(low, 1),
            };
            recent.push_vertex(c, low == 0 || low >= first_beside);
            recent.push_edge([c, b]);
            recent.push_edge([a, c]);
            [a, b, c]
        } else {
            let pair = if low < 14 { table[usize::from(low)] } else { bytes.byte()? };
            if low >= 14 && pair == 0 {
                recent.next = 0;
            }
            // The first vertex is new, or written by its number; numbers come after all three codes.
            let codes = [if low == 15 { 15 } else { 0 }, pair >> 4, pair & 15];
            let is_written = |code: u8| low >= 14 && code == 15;
            let mut t = [0; 3];
            for (vertex, code) in t.iter_mut().zip(codes) {
                *vertex = if is_written(code) { 0 } else { recent.vertex_of(code, 0) };
            }
            for (vertex, code) in t.iter_mut().zip(codes) {
                if is_written(code) {
                    *vertex = recent.read_vertex(&mut bytes)?;
                }
            }
            for (k, (vertex, code)) in t.into_iter().zip(codes).enumerate() {
                recent.push_vertex(vertex, k == 0 || code == 0 || is_written(code));
            }
            recent.push_edge([t[1], t[0]]);
            recent.push_edge([t[2], t[1]]);
            recent.push_edge([t[0], t[2]]);
            t
        };
        indices.extend(triangle);
    }
    Some(indices)
}

/// Decodes `count` indices of the sequence bitstream.
pub(super) fn decode_sequence(data: &[u8], count: usize) -> Option<Vec<u32>> {
    let mut bytes = Bytes(data.get(..data.len().checked_sub(SEQUENCE_PADDING)?)?);
    if !(0xd0..=0xd1).contains(&bytes.byte()?) {
        return None;
    }
    let mut last = [0u32; 2];
    let mut next = || {
        let value = bytes.variable()?;
        let last = &mut last[(value & 1) as usize];
        *last = last.wrapping_add(difference(value >> 1));
        Some(*last)
    };
    (0..count).map(|_| next()).collect()
}
