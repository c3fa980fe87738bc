//! Check of the values of a USDC file: where each lies, how long it is, and what it refers to.
//!
//! Decodes nothing but the indices that the decoder follows.

use crate::usd::reader::binary_reader::{Reader, Tables};

/// Bit of a value that is a list.
const LIST_BIT: u64 = 1 << 63;
/// Bit of a value that stands in the field itself.
const INLINE_BIT: u64 = 1 << 62;
/// Bit of a compressed list.
const PACKED_BIT: u64 = 1 << 61;
/// Bits of the position of a value, or of the value itself.
const PAYLOAD_BITS: u64 = (1 << 48) - 1;
/// Shortest list that is compressed.
const MIN_PACKED_COUNT: u64 = 4;
/// Deepest nesting of dictionaries and time samples.
const MAX_NESTING: usize = 32;
/// Most decoded bytes of one field: the samples over time may be one list many times over.
const MAX_FIELD_BYTES: u64 = 1 << 31;
/// Values in dictionaries and time samples of all fields together.
const MIN_VALUE_BUDGET: u64 = 1 << 16;

/// Types of values by their number in the file, where not only their size counts.
mod kind {
    pub(super) const INT: u64 = 3;
    pub(super) const UINT64: u64 = 6;
    pub(super) const HALF: u64 = 7;
    pub(super) const DOUBLE: u64 = 9;
    pub(super) const STRING: u64 = 10;
    pub(super) const TOKEN: u64 = 11;
    pub(super) const ASSET_PATH: u64 = 12;
    pub(super) const DICTIONARY: u64 = 31;
    pub(super) const TOKEN_LIST_OP: u64 = 32;
    pub(super) const STRING_LIST_OP: u64 = 33;
    pub(super) const PATH_LIST_OP: u64 = 34;
    pub(super) const REFERENCE_LIST_OP: u64 = 35;
    pub(super) const INT_LIST_OP: u64 = 36;
    pub(super) const UINT64_LIST_OP: u64 = 39;
    pub(super) const PATH_VECTOR: u64 = 40;
    pub(super) const TOKEN_VECTOR: u64 = 41;
    pub(super) const SPECIFIER: u64 = 42;
    pub(super) const VARIABILITY: u64 = 44;
    pub(super) const VARIANT_SELECTIONS: u64 = 45;
    pub(super) const TIME_SAMPLES: u64 = 46;
    pub(super) const PAYLOAD: u64 = 47;
    pub(super) const DOUBLE_VECTOR: u64 = 48;
    pub(super) const LAYER_OFFSETS: u64 = 49;
    pub(super) const STRING_VECTOR: u64 = 50;
    pub(super) const UNREGISTERED: u64 = 53;
    pub(super) const UNREGISTERED_LIST_OP: u64 = 54;
    pub(super) const PAYLOAD_LIST_OP: u64 = 55;
    pub(super) const TIME_CODE: u64 = 56;
    pub(super) const PATH_EXPRESSION: u64 = 57;
    pub(super) const RELOCATES: u64 = 58;
}

/// What items of a list are.
#[derive(Debug, Clone, Copy)]
enum Item {
    Token,
    String,
    Path,
    /// Plain numbers of this size [bytes].
    Plain(u64),
    Reference,
    Payload,
}

/// Check of the values of one file.
pub(super) struct ValueCheck<'a> {
    tables: &'a Tables<'a>,
    /// Values in dictionaries and time samples that may still come.
    budget: u64,
    /// Decoded bytes of the current field.
    field_bytes: u64,
}

impl<'a> ValueCheck<'a> {
    pub(super) fn new(tables: &'a Tables<'a>) -> Self {
        let budget = MIN_VALUE_BUDGET.max(tables.bytes.len() as u64);
        Self { tables, budget, field_bytes: 0 }
    }

    /// Checks the values of all fields.
    pub(super) fn check_all(mut self) -> Option<()> {
        for value in &self.tables.values {
            self.field_bytes = 0;
            self.value(*value, 0)?;
        }
        Some(())
    }

    fn value(&mut self, value: u64, depth: usize) -> Option<()> {
        self.budget = self.budget.checked_sub(u64::from(depth > 0))?;
        if depth > MAX_NESTING {
            return None;
        }
        let (number, payload) = ((value >> 48) & 0xFF, value & PAYLOAD_BITS);
        let (is_list, is_inline) = (value & LIST_BIT != 0, value & INLINE_BIT != 0);
        // The decoder looks at the bit of a list only for types of which there are lists.
        let has_lists =
            number < kind::DICTIONARY || matches!(number, kind::TIME_CODE | kind::PATH_EXPRESSION);
        if is_list && has_lists {
            return (!is_inline).then(|| self.list(number, payload, value & PACKED_BIT != 0))?;
        }
        if is_inline {
            let index = payload & u64::from(u32::MAX);
            return match number {
                kind::TOKEN | kind::ASSET_PATH | kind::PATH_EXPRESSION | kind::UNREGISTERED => {
                    self.is_index(index, Item::Token)
                }
                kind::STRING => self.is_index(index, Item::String),
                // Of these a whole structure follows, which cannot stand in the field.
                kind::TOKEN_LIST_OP..=kind::TOKEN_VECTOR
                | kind::VARIANT_SELECTIONS..=kind::STRING_VECTOR
                | kind::UNREGISTERED_LIST_OP
                | kind::PAYLOAD_LIST_OP
                | kind::RELOCATES => None,
                _ => Some(()),
            };
        }
        let mut reader = Reader::new(self.tables.bytes, payload)?;
        match number {
            kind::STRING | kind::ASSET_PATH | kind::PATH_EXPRESSION => {
                self.item(&mut reader, Item::String, depth)
            }
            kind::TOKEN | kind::UNREGISTERED => self.is_index(reader.u64()?, Item::Token),
            kind::DICTIONARY => self.dictionary(&mut reader, depth),
            kind::TOKEN_LIST_OP => self.list_op(&mut reader, Item::Token, depth),
            kind::STRING_LIST_OP | kind::UNREGISTERED_LIST_OP => {
                self.list_op(&mut reader, Item::String, depth)
            }
            kind::PATH_LIST_OP => self.list_op(&mut reader, Item::Path, depth),
            kind::REFERENCE_LIST_OP => self.list_op(&mut reader, Item::Reference, depth),
            kind::PAYLOAD_LIST_OP => self.list_op(&mut reader, Item::Payload, depth),
            kind::INT_LIST_OP..=kind::UINT64_LIST_OP => {
                let size = if (number - kind::INT_LIST_OP).is_multiple_of(2) { 4 } else { 8 };
                self.list_op(&mut reader, Item::Plain(size), depth)
            }
            kind::PATH_VECTOR => self.items(&mut reader, Item::Path, depth),
            kind::TOKEN_VECTOR => self.items(&mut reader, Item::Token, depth),
            kind::STRING_VECTOR => self.items(&mut reader, Item::String, depth),
            kind::LAYER_OFFSETS => self.items(&mut reader, Item::Plain(16), depth),
            kind::SPECIFIER..=kind::VARIABILITY => reader.skip(1, 4),
            kind::VARIANT_SELECTIONS => {
                let count = reader.u64()?;
                (count <= self.tables.bytes.len() as u64 / 8).then_some(())?;
                (0..2 * count).try_for_each(|_| self.item(&mut reader, Item::String, depth))
            }
            kind::TIME_SAMPLES => self.time_samples(&mut reader, depth),
            kind::PAYLOAD => self.item(&mut reader, Item::Payload, depth),
            kind::DOUBLE_VECTOR => self.list(number, payload, value & PACKED_BIT != 0),
            kind::RELOCATES => {
                let count = reader.u64()?;
                (count <= self.tables.bytes.len() as u64 / 8).then_some(())?;
                (0..2 * count).try_for_each(|_| self.item(&mut reader, Item::Path, depth))
            }
            // A type that is not known here is not known to the decoder.
            _ => size_of_item(number).map_or(Some(()), |size| reader.skip(1, size)),
        }
    }

    fn is_index(&self, index: u64, item: Item) -> Option<()> {
        let count = match item {
            Item::Token => self.tables.token_lengths.len() as u64,
            Item::String => self.tables.string_count,
            _ => self.tables.path_count,
        };
        (index < count).then_some(())
    }

    fn item(&mut self, reader: &mut Reader, item: Item, depth: usize) -> Option<()> {
        match item {
            Item::Token | Item::String | Item::Path => self.is_index(u64::from(reader.u32()?), item),
            Item::Plain(size) => reader.skip(1, size),
            Item::Reference => {
                self.item(reader, Item::String, depth)?;
                self.item(reader, Item::Path, depth)?;
                reader.skip(1, 16)?;
                self.dictionary(reader, depth)
            }
            Item::Payload => {
                self.item(reader, Item::String, depth)?;
                self.item(reader, Item::Path, depth)?;
                reader.skip(1, if self.tables.minor >= 8 { 16 } else { 0 })
            }
        }
    }

    /// Checks a count and so many items.
    fn items(&mut self, reader: &mut Reader, item: Item, depth: usize) -> Option<()> {
        let count = reader.u64()?;
        let size = match item {
            Item::Plain(size) => size,
            Item::Reference => 32,
            Item::Payload => 8,
            _ => 4,
        };
        reader.clone().skip(count, size)?;
        (0..count).try_for_each(|_| self.item(reader, item, depth))
    }

    fn list_op(&mut self, reader: &mut Reader, item: Item, depth: usize) -> Option<()> {
        let head = reader.u8()?;
        let lists = [1, 2, 3, 4, 5, 6].iter().filter(|bit| head & (1 << **bit) != 0).count();
        (0..lists).try_for_each(|_| self.items(reader, item, depth))
    }

    fn dictionary(&mut self, reader: &mut Reader, depth: usize) -> Option<()> {
        let count = reader.u64()?;
        for _ in 0..count {
            self.item(reader, Item::String, depth)?;
            reader.jump()?;
            let value = reader.u64()?;
            self.value(value, depth + 1)?;
        }
        Some(())
    }

    fn time_samples(&mut self, reader: &mut Reader, depth: usize) -> Option<()> {
        reader.jump()?;
        let times = reader.u64()?;
        self.value(times, depth + 1)?;
        reader.jump()?;
        let count = reader.u64()?;
        let values = reader.take(count.checked_mul(8)?)?;
        for value in values.chunks(8) {
            self.value(Reader::new(value, 0)?.u64()?, depth + 1)?;
        }
        Some(())
    }

    /// Checks a list of values of the type `number` at `payload`.
    fn list(&mut self, number: u64, payload: u64, is_packed: bool) -> Option<()> {
        let mut reader = Reader::new(self.tables.bytes, payload)?;
        if payload == 0 {
            return Some(());
        }
        if matches!(number, kind::STRING | kind::ASSET_PATH | kind::PATH_EXPRESSION) {
            return self.items(&mut reader, Item::String, 0);
        }
        if self.tables.minor < 5 {
            reader.u32()?;
        }
        let count = if self.tables.minor < 7 { u64::from(reader.u32()?) } else { reader.u64()? };
        let Some(size) = size_of_item(number) else { return Some(()) };
        self.field_bytes = self.field_bytes.checked_add(count.checked_mul(size)?)?;
        if self.field_bytes > MAX_FIELD_BYTES {
            return None;
        }
        let is_integer = (kind::INT..=kind::UINT64).contains(&number);
        let is_float = (kind::HALF..=kind::DOUBLE).contains(&number)
            || matches!(number, kind::DOUBLE_VECTOR | kind::TIME_CODE);
        if is_packed && !is_integer && !is_float {
            return None;
        }
        let is_packed = is_packed && count >= MIN_PACKED_COUNT;
        match number {
            kind::TOKEN => (0..count).try_for_each(|_| self.item(&mut reader, Item::Token, 0)),
            _ if is_packed && is_integer && self.tables.minor >= 5 => integers(&mut reader, count, size),
            _ if is_packed && is_float && self.tables.minor >= 6 => packed_floats(&mut reader, count, size),
            _ => reader.skip(count, size),
        }
    }
}

/// Checks `count` compressed integers of `size` bytes.
fn integers(reader: &mut Reader, count: u64, size: u64) -> Option<()> {
    if size == 4 {
        return reader.integers(count).map(drop);
    }
    // The decoder of 64 bits needs the first integer and the codes; what is missing after them is an error without a panic.
    let codes = usize::try_from(count.checked_mul(2)?.div_ceil(8)).ok()?;
    let max = codes.checked_add(4 + 4 * usize::try_from(count).ok()?)?;
    (reader.decompress(max)?.len() >= codes + 8).then_some(())
}

/// Checks `count` compressed numbers of `size` bytes: integers, or indices into a table.
fn packed_floats(reader: &mut Reader, count: u64, size: u64) -> Option<()> {
    match reader.u8()? {
        b'i' => reader.integers(count).map(drop),
        b't' => {
            let length = reader.u32()?;
            reader.skip(u64::from(length), size)?;
            reader.integers(count)?.iter().all(|index| (*index as u32) < length).then_some(())
        }
        _ => None,
    }
}

/// Returns the bytes of one value of a type; `None` for a type without a fixed size or unknown.
fn size_of_item(number: u64) -> Option<u64> {
    Some(match number {
        1 | 2 => 1,
        3 | 4 => 4,
        5 | 6 | 9 | 48 | 56 => 8,
        7 => 2,
        8 | kind::TOKEN => 4,
        13 => 32,
        14 => 72,
        15 => 128,
        16 => 32,
        17 => 16,
        18 => 8,
        // Vectors of two, three and four doubles, floats, halves and integers.
        19..=30 => ((number - 19) / 4 + 2) * [8, 4, 2, 4][((number - 19) % 4) as usize],
        51 | 52 => 0,
        _ => return None,
    })
}
