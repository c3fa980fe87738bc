//! Numbers of a USDC file, read within its bounds: the only file that names the package `lz4_flex`.

/// Most bytes that LZ4 makes of one.
const MAX_EXPANSION: u64 = 255;

/// Bytes with a position, read in little-endian order.
#[derive(Debug, Clone)]
pub(super) struct Reader<'a> {
    bytes: &'a [u8],
    at: usize,
}

impl<'a> Reader<'a> {
    pub(super) fn new(bytes: &'a [u8], at: u64) -> Option<Self> {
        let at = usize::try_from(at).ok()?;
        (at <= bytes.len()).then_some(Self { bytes, at })
    }

    pub(super) fn position(&self) -> usize {
        self.at
    }

    /// Returns the next `count` bytes.
    pub(super) fn take(&mut self, count: u64) -> Option<&'a [u8]> {
        let end = self.at.checked_add(usize::try_from(count).ok()?)?;
        let taken = self.bytes.get(self.at..end)?;
        self.at = end;
        Some(taken)
    }

    /// Skips `count` items of `size` bytes.
    pub(super) fn skip(&mut self, count: u64, size: u64) -> Option<()> {
        self.take(count.checked_mul(size)?).map(drop)
    }

    pub(super) fn u8(&mut self) -> Option<u8> {
        self.take(1).map(|byte| byte[0])
    }

    pub(super) fn u32(&mut self) -> Option<u32> {
        Some(u32::from_le_bytes(self.take(4)?.try_into().ok()?))
    }

    pub(super) fn u64(&mut self) -> Option<u64> {
        Some(u64::from_le_bytes(self.take(8)?.try_into().ok()?))
    }

    /// Moves by an offset from the current position, which is read first.
    pub(super) fn jump(&mut self) -> Option<()> {
        let start = i64::try_from(self.at).ok()?;
        let offset = self.u64()? as i64;
        // The decoder adds to the position after the offset.
        offset.checked_sub(8)?;
        let to = usize::try_from(start.checked_add(offset)?).ok()?;
        *self = Self::new(self.bytes, to as u64)?;
        Some(())
    }

    /// Decompresses a block of LZ4 with its length before it; at most `max` bytes come out.
    pub(super) fn decompress(&mut self, max: usize) -> Option<Vec<u8>> {
        let length = self.u64()?;
        let block = self.take(length)?;
        // Blocks of more than 2 GB are in chunks, which the decoder does not know.
        let (0, packed) = block.split_first().map(|(chunks, packed)| (*chunks, packed))? else { return None };
        let possible = usize::try_from(MAX_EXPANSION.saturating_mul(length).saturating_add(64)).ok()?;
        let mut content = vec![0; max.min(possible)];
        let length = lz4_flex::block::decompress_into(packed, &mut content).ok()?;
        content.truncate(length);
        Some(content)
    }

    /// Decodes `count` compressed integers.
    pub(super) fn integers(&mut self, count: u64) -> Option<Vec<i32>> {
        if count > self.bytes.len() as u64 {
            return None;
        }
        let count = count as usize;
        let codes = (count * 2).div_ceil(8);
        let content = self.decompress(4 + codes + 4 * count)?;
        if count == 0 {
            return Some(Vec::new());
        }
        let mut head = Reader::new(&content, 0)?;
        let common = head.u32()? as i32;
        let codes = head.take(codes as u64)?;
        let mut decoded = Vec::with_capacity(count);
        let mut previous = 0i32;
        for k in 0..codes.len() * 4 {
            let delta = match (codes[k / 4] >> (2 * (k % 4))) & 3 {
                0 => common,
                1 => i32::from(head.u8()? as i8),
                2 => i32::from(i16::from_le_bytes(head.take(2)?.try_into().ok()?)),
                _ => head.u32()? as i32,
            };
            previous = previous.wrapping_add(delta);
            decoded.push(previous);
        }
        decoded.truncate(count);
        Some(decoded)
    }
}

/// Tables of a file, by which its values are checked.
#[derive(Debug)]
pub(super) struct Tables<'a> {
    pub(super) bytes: &'a [u8],
    /// N of the version 0.N.
    pub(super) minor: u8,
    /// Length of each token [bytes].
    pub(super) token_lengths: Vec<usize>,
    pub(super) string_count: u64,
    pub(super) path_count: u64,
    /// Per field: its value, or where that is.
    pub(super) values: Vec<u64>,
}
