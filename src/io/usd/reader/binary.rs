//! Check of a USDC file (crate format of USD) before it is decoded: the decoder of the package takes counts, offsets and indices of
//! the file on trust, and a damaged one would make it stop the program or ask for any amount of memory.
//!
//! Checks the structural sections here and the values in [`crate::usd::reader::binary_values`]. A file that passes is decoded
//! without an index out of range, and within memory proportional to its size.
//! Follows the layout of OpenUSD's `crateFile.cpp`, versions 0.4 to 0.12; older files are refused.

use crate::usd::reader::binary_reader::{Reader, Tables};
use crate::usd::reader::binary_values::ValueCheck;
use crate::usd::signature::BINARY_MAGIC;

/// First bytes of a USDC file.
/// Minor versions of the format, 0.N, that can be read.
const MINOR_VERSIONS: std::ops::RangeInclusive<u8> = 4..=12;
/// Length of the head of the file.
const HEAD_BYTES: usize = 88;
/// Most sections of a file.
const MAX_SECTIONS: u64 = 63;
/// Most bytes of the texts of all paths together: a chain of nested prims repeats the names of all above it.
const MAX_PATH_BYTES: usize = 1 << 28;
/// Deepest nesting of prims, above which the composition would exhaust the stack.
pub(super) const MAX_DEPTH: usize = 128;

/// Checks the USDC file `bytes`.
///
/// # Errors
/// What is wrong with it.
pub(super) fn check_binary(bytes: &[u8]) -> Result<(), String> {
    let damaged = |part: &str| format!("its {part} cannot be read: the file is damaged or incomplete");
    if bytes.len() < HEAD_BYTES || !bytes.starts_with(BINARY_MAGIC) {
        return Err(damaged("head"));
    }
    let (major, minor) = (bytes[8], bytes[9]);
    if major != 0 || !MINOR_VERSIONS.contains(&minor) {
        return Err(format!("version {major}.{minor} of the format is not known"));
    }
    let sections = Sections::read(bytes).ok_or_else(|| damaged("table of contents"))?;
    let tables = sections.tables(minor).map_err(damaged)?;
    ValueCheck::new(&tables).check_all().ok_or_else(|| damaged("values"))
}

/// Sections of a file by name.
struct Sections<'a> {
    bytes: &'a [u8],
    starts: Vec<(&'a [u8], u64)>,
}

impl<'a> Sections<'a> {
    fn read(bytes: &'a [u8]) -> Option<Self> {
        let start = Reader::new(bytes, 16)?.u64()?;
        let mut reader = Reader::new(bytes, start).filter(|reader| reader.position() > 0)?;
        let count = reader.u64()?;
        if !(1..=MAX_SECTIONS).contains(&count) {
            return None;
        }
        let mut starts = Vec::new();
        for _ in 0..count {
            let name = reader.take(16)?;
            let name = name.split(|byte| *byte == 0).next()?;
            let (start, length) = (reader.u64()?, reader.u64()?);
            (start.checked_add(length)? <= bytes.len() as u64).then_some(())?;
            starts.push((name, start));
        }
        Some(Self { bytes, starts })
    }

    fn section(&self, name: &str) -> Option<Reader<'a>> {
        let start = self.starts.iter().find(|(own, _)| *own == name.as_bytes())?.1;
        Reader::new(self.bytes, start)
    }

    /// Reads the tables; the error is the name of the part that is wrong.
    fn tables(&self, minor: u8) -> Result<Tables<'a>, &'static str> {
        let token_lengths = self.tokens().ok_or("names")?;
        let token_count = token_lengths.len() as u64;
        let string_count = self.strings(token_count).ok_or("texts")?;
        let values = self.fields(token_count).ok_or("fields")?;
        let fieldset_count = self.fieldsets(values.len() as u64).ok_or("fields")?;
        let path_count = self.paths(&token_lengths).ok_or("paths")?;
        self.specs(path_count, fieldset_count).ok_or("prims")?;
        Ok(Tables { bytes: self.bytes, minor, token_lengths, string_count, path_count, values })
    }

    fn tokens(&self) -> Option<Vec<usize>> {
        let mut reader = self.section("TOKENS")?;
        let (count, length) = (reader.u64()?, reader.u64()?);
        let texts = reader.decompress(usize::try_from(length).ok()?)?;
        if texts.len() as u64 != length {
            return None;
        }
        let Some((0, texts)) = texts.split_last().map(|(last, texts)| (*last, texts)) else {
            return (count == 0 && texts.is_empty()).then(Vec::new);
        };
        std::str::from_utf8(texts).ok()?;
        let lengths: Vec<usize> = texts.split(|byte| *byte == 0).map(<[u8]>::len).collect();
        (lengths.len() as u64 == count).then_some(lengths)
    }

    fn strings(&self, token_count: u64) -> Option<u64> {
        let mut reader = self.section("STRINGS")?;
        let count = reader.u64()?;
        let all = reader.take(count.checked_mul(4)?)?;
        let is_known = |index: &[u8]| {
            Reader::new(index, 0).and_then(|mut r| r.u32()).is_some_and(|k| u64::from(k) < token_count)
        };
        all.chunks(4).all(is_known).then_some(count)
    }

    fn fields(&self, token_count: u64) -> Option<Vec<u64>> {
        let mut reader = self.section("FIELDS")?;
        let count = reader.u64()?;
        let names = reader.integers(count)?;
        if !names.iter().all(|name| u64::from(*name as u32) < token_count) {
            return None;
        }
        let values = reader.decompress(names.len() * 8)?;
        let whole = |value: &[u8]| Some(u64::from_le_bytes(value.try_into().ok()?));
        let values: Vec<u64> = values.chunks(8).map_while(whole).collect();
        (values.len() == names.len()).then_some(values)
    }

    fn fieldsets(&self, field_count: u64) -> Option<u64> {
        let mut reader = self.section("FIELDSETS")?;
        let count = reader.u64()?;
        let fields = reader.integers(count)?;
        fields.iter().all(|field| *field == -1 || u64::from(*field as u32) < field_count).then_some(count)
    }

    /// Checks that the paths are a tree in which every entry comes once, and that their texts are not too long.
    fn paths(&self, token_lengths: &[usize]) -> Option<u64> {
        let mut reader = self.section("PATHS")?;
        let (path_count, count) = (reader.u64()?, reader.u64()?);
        if path_count > self.bytes.len() as u64 || count > path_count {
            return None;
        }
        let (numbers, names, jumps) =
            (reader.integers(count)?, reader.integers(count)?, reader.integers(count)?);
        let mut is_visited = vec![false; numbers.len()];
        let mut total = 0usize;
        // Entry, length of the path above it, depth of that.
        let mut pending = if numbers.is_empty() { Vec::new() } else { vec![(0usize, 0usize, 0usize)] };
        while let Some((mut entry, mut above, mut depth)) = pending.pop() {
            loop {
                if std::mem::replace(is_visited.get_mut(entry)?, true) {
                    return None;
                }
                let token = *token_lengths.get(names[entry].unsigned_abs() as usize)?;
                let length = above + token + 1;
                total = total.checked_add(length)?;
                if u64::from(numbers[entry] as u32) >= path_count
                    || total > MAX_PATH_BYTES
                    || depth > MAX_DEPTH
                {
                    return None;
                }
                let jump = jumps[entry];
                let (has_child, has_sibling) = (jump > 0 || jump == -1, jump >= 0);
                if has_child && has_sibling {
                    pending.push((entry.checked_add(jump as usize)?, above, depth));
                }
                if has_child {
                    (above, depth) = (length, depth + 1);
                }
                if !has_child && !has_sibling {
                    break;
                }
                entry += 1;
            }
        }
        Some(path_count)
    }

    fn specs(&self, path_count: u64, fieldset_count: u64) -> Option<()> {
        let mut reader = self.section("SPECS")?;
        let count = reader.u64()?;
        let (paths, fieldsets) = (reader.integers(count)?, reader.integers(count)?);
        reader.integers(count)?;
        let is_below = |all: &[i32], limit: u64| all.iter().all(|k| u64::from(*k as u32) < limit);
        (is_below(&paths, path_count) && is_below(&fieldsets, fieldset_count)).then_some(())
    }
}
