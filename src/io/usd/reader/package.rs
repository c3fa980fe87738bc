//! Files in a USDZ package: a ZIP archive that keeps them uncompressed, so that each is a range of the archive's bytes.

use std::ops::Range;

/// Signature of the end of the directory.
const END_SIGNATURE: u32 = 0x0605_4b50;
/// Bytes of the end of the directory without its comment.
const END_BYTES: usize = 22;
/// Longest comment at the end of an archive [bytes].
const MAX_COMMENT_BYTES: usize = u16::MAX as usize;
/// Signature of an entry of the directory.
const ENTRY_SIGNATURE: u32 = 0x0201_4b50;
/// Bytes of an entry of the directory without its name.
const ENTRY_BYTES: usize = 46;
/// Signature of the header before a file.
const FILE_SIGNATURE: u32 = 0x0403_4b50;
/// Bytes of the header before a file without its name.
const FILE_BYTES: usize = 30;

/// File in a package.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct PackagedFile {
    /// Name with folders.
    pub(super) name: String,
    /// Bytes of its content in the archive.
    pub(super) range: Range<usize>,
}

/// Lists the USD files in the package `bytes`, in their order. Pictures and other files are left out.
///
/// # Errors
/// A message if the archive is damaged, or a USD file in it is compressed or encrypted.
pub(super) fn packaged_layers(bytes: &[u8]) -> Result<Vec<PackagedFile>, String> {
    let damaged = || "the archive is damaged: its directory cannot be read".to_owned();
    let end = find_end(bytes).ok_or_else(damaged)?;
    let count = usize::from(u16_at(bytes, end + 10).ok_or_else(damaged)?);
    let mut at = u32_at(bytes, end + 16).ok_or_else(damaged)? as usize;
    let mut files = Vec::new();
    let mut total_size = 0usize;
    for _ in 0..count {
        if u32_at(bytes, at) != Some(ENTRY_SIGNATURE) {
            return Err(damaged());
        }
        let field = |offset: usize| u16_at(bytes, at + offset).map(usize::from).ok_or_else(damaged);
        let (flags, method) = (field(8)?, field(10)?);
        let lengths = [field(28)?, field(30)?, field(32)?];
        let size = u32_at(bytes, at + 24).ok_or_else(damaged)? as usize;
        let start = u32_at(bytes, at + 42).ok_or_else(damaged)? as usize;
        let name = bytes.get(at + ENTRY_BYTES..at + ENTRY_BYTES + lengths[0]).ok_or_else(damaged)?;
        let name = String::from_utf8_lossy(name).into_owned();
        at += ENTRY_BYTES + lengths.iter().sum::<usize>();
        if !is_layer_name(&name) {
            continue;
        }
        if method != 0 || flags & 1 != 0 {
            return Err(format!(
                "the file \"{name}\" in it is compressed or encrypted, which USDZ does not allow"
            ));
        }
        let range = content_range(bytes, start, size).ok_or_else(|| {
            format!("the archive is damaged: the file \"{name}\" in it goes beyond its end")
        })?;
        // Entries that overlap would be kept any number of times.
        total_size = total_size.saturating_add(range.len());
        if total_size > bytes.len() {
            return Err("the archive is damaged: files in it overlap".to_owned());
        }
        files.push(PackagedFile { name, range });
    }
    Ok(files)
}

/// Returns whether a file of this name holds a USD layer.
pub(super) fn is_layer_name(name: &str) -> bool {
    let extension = name.rsplit_once('.').map_or("", |(_, extension)| extension);
    ["usd", "usda", "usdc"].iter().any(|own| extension.eq_ignore_ascii_case(own))
}

/// Returns the position of the end of the directory.
fn find_end(bytes: &[u8]) -> Option<usize> {
    let last = bytes.len().checked_sub(END_BYTES)?;
    (last.saturating_sub(MAX_COMMENT_BYTES)..=last).rev().find(|&at| u32_at(bytes, at) == Some(END_SIGNATURE))
}

/// Returns the content of the file whose header is at `start`.
fn content_range(bytes: &[u8], start: usize, size: usize) -> Option<Range<usize>> {
    if u32_at(bytes, start)? != FILE_SIGNATURE {
        return None;
    }
    let lengths = usize::from(u16_at(bytes, start + 26)?) + usize::from(u16_at(bytes, start + 28)?);
    let first = start + FILE_BYTES + lengths;
    let end = first.checked_add(size)?;
    (end <= bytes.len()).then_some(first..end)
}

fn u16_at(bytes: &[u8], at: usize) -> Option<u16> {
    Some(u16::from_le_bytes(bytes.get(at..at.checked_add(2)?)?.try_into().ok()?))
}

fn u32_at(bytes: &[u8], at: usize) -> Option<u32> {
    Some(u32::from_le_bytes(bytes.get(at..at.checked_add(4)?)?.try_into().ok()?))
}

#[cfg(test)]
pub(super) mod tests {
    use super::*;

    /// Archive of these files; `method` is that of ZIP, 0 for uncompressed.
    pub(in crate::usd::reader) fn archive(files: &[(&str, &[u8])], method: u16) -> Vec<u8> {
        let (mut bytes, mut directory) = (Vec::new(), Vec::new());
        for (name, content) in files {
            let start = bytes.len() as u32;
            let mut common = vec![20, 0, 0, 0];
            common.extend(method.to_le_bytes());
            common.extend([0; 8]);
            common.extend((content.len() as u32).to_le_bytes());
            common.extend((content.len() as u32).to_le_bytes());
            common.extend((name.len() as u16).to_le_bytes());
            common.extend([0, 0]);
            bytes.extend(FILE_SIGNATURE.to_le_bytes());
            bytes.extend(&common);
            bytes.extend(name.as_bytes());
            bytes.extend(*content);
            directory.extend(ENTRY_SIGNATURE.to_le_bytes());
            directory.extend([20, 0]);
            directory.extend(&common);
            directory.extend([0; 10]);
            directory.extend(start.to_le_bytes());
            directory.extend(name.as_bytes());
        }
        let (start, count) = (bytes.len() as u32, files.len() as u16);
        bytes.extend(&directory);
        bytes.extend(END_SIGNATURE.to_le_bytes());
        bytes.extend([0; 4]);
        bytes.extend(count.to_le_bytes());
        bytes.extend(count.to_le_bytes());
        bytes.extend((directory.len() as u32).to_le_bytes());
        bytes.extend(start.to_le_bytes());
        bytes.extend([0, 0]);
        bytes
    }

    #[test]
    fn layers_are_found_and_pictures_are_not() {
        let bytes = archive(&[("a.usda", b"#usda"), ("a.png", b"?"), ("parts/b.usdc", b"PXR")], 0);
        let layers = packaged_layers(&bytes).expect("is an archive");
        let found: Vec<_> = layers.iter().map(|f| (f.name.as_str(), &bytes[f.range.clone()])).collect();
        assert_eq!(found, [("a.usda", &b"#usda"[..]), ("parts/b.usdc", b"PXR")]);
    }

    #[test]
    fn damaged_and_compressed_archives_are_refused() {
        assert!(
            packaged_layers(&archive(&[("a.usda", b"#usda")], 8))
                .expect_err("is deflated")
                .contains("compressed")
        );
        let mut overlapping = archive(&[("a.usda", &[b' '; 999]), ("b.usda", &[b' '; 999])], 0);
        let second = overlapping.len() - END_BYTES - 6 - 4;
        assert!(packaged_layers(&overlapping).is_ok());
        overlapping[second..second + 4].fill(0);
        assert!(packaged_layers(&overlapping).is_ok(), "two views of one file fit the size of the archive");
        let entry = overlapping
            [overlapping.len() - END_BYTES - ENTRY_BYTES - 6..overlapping.len() - END_BYTES]
            .to_vec();
        let end = overlapping.split_off(overlapping.len() - END_BYTES);
        overlapping.extend(entry);
        overlapping.extend(end);
        let count = overlapping.len() - END_BYTES + 10;
        overlapping[count] = 3;
        assert!(packaged_layers(&overlapping).expect_err("three times one file").contains("overlap"));
        let whole = archive(&[("a.usda", b"#usda 1.0\n")], 0);
        for length in 0..whole.len() {
            assert!(packaged_layers(&whole[..length]).is_err(), "{length}");
        }
    }
}
