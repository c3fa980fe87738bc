//! Logical lines of an OBJ file: any line end, a byte-order mark skipped, lines ending in a backslash joined. Lines are
//! numbered as in a text editor, for messages.

use std::borrow::Cow;

/// Logical line.
pub(super) struct Line<'a> {
    /// Number of its first line in the file, from 1.
    pub(super) number: usize,
    /// Text, without line end; bytes that are not UTF-8 are replaced (they occur in names only).
    pub(super) text: Cow<'a, str>,
}

/// Iterator over the logical lines of a file.
pub(super) struct Lines<'a> {
    rest: &'a [u8],
    number: usize,
}

impl<'a> Lines<'a> {
    /// Creates the iterator over the lines of `bytes`.
    pub(super) fn new(bytes: &'a [u8]) -> Self {
        Self { rest: bytes.strip_prefix(b"\xEF\xBB\xBF").unwrap_or(bytes), number: 0 }
    }

    /// Returns the next physical line.
    fn physical(&mut self) -> Option<&'a [u8]> {
        if self.rest.is_empty() {
            return None;
        }
        self.number += 1;
        let end = self.rest.iter().position(|&b| b == b'\n' || b == b'\r').unwrap_or(self.rest.len());
        let (line, after) = self.rest.split_at(end);
        self.rest = match after {
            [b'\r', b'\n', rest @ ..] | [_, rest @ ..] => rest,
            [] => after,
        };
        Some(line)
    }
}

impl<'a> Iterator for Lines<'a> {
    type Item = Line<'a>;

    fn next(&mut self) -> Option<Line<'a>> {
        let first = self.physical()?;
        let number = self.number;
        // A comment is not continued: its backslash may belong to a drawing.
        let comment = first.trim_ascii_start().starts_with(b"#");
        let (false, Some(start)) = (comment, first.strip_suffix(b"\\")) else {
            return Some(Line { number, text: String::from_utf8_lossy(first) });
        };
        let mut joined = start.to_vec();
        while let Some(line) = self.physical() {
            joined.push(b' ');
            match line.strip_suffix(b"\\") {
                Some(part) => joined.extend_from_slice(part),
                None => {
                    joined.extend_from_slice(line);
                    break;
                }
            }
        }
        Some(Line { number, text: Cow::Owned(String::from_utf8_lossy(&joined).into_owned()) })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &[u8]) -> Vec<(usize, String)> {
        Lines::new(text).map(|line| (line.number, line.text.into_owned())).collect()
    }

    #[test]
    fn every_line_end_counts_once() {
        let expected = [(1, "a".to_owned()), (2, String::new()), (3, "b".to_owned())];
        for text in [&b"a\n\nb"[..], b"a\r\n\r\nb\r\n", b"a\r\rb\r", b"\xEF\xBB\xBFa\n\nb\n"] {
            assert_eq!(read(text), expected, "{text:?}");
        }
    }

    #[test]
    fn backslashes_join_and_the_next_number_is_right() {
        assert_eq!(
            read(b"f 1 \\\r\n 2\\\n 3\n# art \\\nv"),
            [(1, "f 1   2  3".to_owned()), (4, "# art \\".to_owned()), (5, "v".to_owned())]
        );
        assert_eq!(read(b"f 1\\"), [(1, "f 1".to_owned())]);
    }
}
