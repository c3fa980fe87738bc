//! Source locations of the parts of a JSON text. serde_json has already accepted the text, so the scan never fails; parts
//! that it cannot follow have no location.

use crate::json::quoted::quoted;
use rustc_hash::FxHashSet;
use std::fmt;

/// One step of a path.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Segment {
    /// Member of an object.
    Name(String),
    /// Entry of a list, counted from 0.
    Entry(usize),
}

/// Path to a part of a JSON value; written `actions[2].fold.angle`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Path(Vec<Segment>);

impl Path {
    /// Returns the path of the whole value.
    pub fn root() -> Self {
        Self::default()
    }

    /// Returns the path extended by a member.
    pub fn name(&self, name: impl Into<String>) -> Self {
        self.step(Segment::Name(name.into()))
    }

    /// Returns the path extended by an entry.
    pub fn entry(&self, index: usize) -> Self {
        self.step(Segment::Entry(index))
    }

    /// Returns whether this is the path of the whole value.
    pub fn is_empty(&self) -> bool {
        self.0.is_empty()
    }

    fn step(&self, segment: Segment) -> Self {
        let mut steps = self.0.clone();
        steps.push(segment);
        Self(steps)
    }

    pub(super) fn push(&mut self, segment: Segment) {
        self.0.push(segment);
    }

    pub(super) fn pop(&mut self) {
        self.0.pop();
    }

    pub(super) fn from_serde(path: &serde_path_to_error::Path) -> Self {
        use serde_path_to_error::Segment as SerdeSegment;
        let steps = path.iter().map_while(|segment| match segment {
            SerdeSegment::Seq { index } => Some(Segment::Entry(*index)),
            SerdeSegment::Map { key } => Some(Segment::Name(key.clone())),
            SerdeSegment::Enum { variant } => Some(Segment::Name(variant.clone())),
            SerdeSegment::Unknown => None,
        });
        Self(steps.collect())
    }
}

impl fmt::Display for Path {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (depth, segment) in self.0.iter().enumerate() {
            match segment {
                Segment::Entry(index) => write!(out, "[{index}]")?,
                Segment::Name(name) => {
                    if depth > 0 {
                        out.write_str(".")?;
                    }
                    let name_quoted = quoted(name);
                    let plain = name.chars().all(|c| c.is_alphanumeric() || "_-".contains(c));
                    out.write_str(if plain { name_quoted.trim_matches('`') } else { &name_quoted })?;
                }
            }
        }
        Ok(())
    }
}

/// Byte offsets of a value, of its name where it is a member, and of its parts.
#[derive(Debug, Clone, Default)]
struct Node {
    value_start: usize,
    name_start: Option<usize>,
    name: Option<String>,
    children: Vec<Node>,
}

/// Locations of all parts of a text.
#[derive(Debug, Clone)]
pub(super) struct Spans {
    text: String,
    root: Node,
    duplicates: Vec<DuplicateKey>,
}

/// Name that an object has more than once.
#[derive(Debug, Clone)]
struct DuplicateKey {
    /// Byte offset of the later one.
    start: usize,
    name: String,
}

impl Spans {
    /// Scans a text that serde_json accepts.
    pub(super) fn scan(text: &str) -> Self {
        let mut scan = Scan { text, at: 0, duplicates: Vec::new() };
        let root = scan.value();
        Self { text: text.to_owned(), root, duplicates: scan.duplicates }
    }

    /// Returns the names that an object has more than once: location of the later one, and the quoted name.
    pub(super) fn duplicate_keys(&self) -> impl Iterator<Item = ((usize, usize), String)> {
        self.duplicates.iter().map(|key| (self.line_and_column(key.start), quoted(&key.name)))
    }

    /// Returns line and column of the value at `path`, or of its name; `None` where the text has no such value.
    pub(super) fn find(&self, path: &Path, of_name: bool) -> Option<(usize, usize)> {
        let mut node = &self.root;
        for segment in &path.0 {
            node = match segment {
                Segment::Entry(index) => node.children.get(*index)?,
                Segment::Name(name) => node.children.iter().find(|n| n.name.as_ref() == Some(name))?,
            };
        }
        Some(self.line_and_column(node.name_start.filter(|_| of_name).unwrap_or(node.value_start)))
    }

    fn line_and_column(&self, at: usize) -> (usize, usize) {
        let before = self.text.get(..at).unwrap_or(&self.text);
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
        (line, column)
    }
}

/// Returns line and column of a serde_json error, which counts columns in bytes, with the column in characters.
pub(super) fn error_position(text: &str, line: usize, column: usize) -> (usize, usize) {
    let whole = text.split('\n').nth(line.saturating_sub(1)).unwrap_or("");
    let before = whole.as_bytes().get(..column.saturating_sub(1)).unwrap_or(whole.as_bytes());
    (line.max(1), String::from_utf8_lossy(before).chars().count() + 1)
}

struct Scan<'a> {
    text: &'a str,
    at: usize,
    duplicates: Vec<DuplicateKey>,
}

impl Scan<'_> {
    fn peek(&mut self) -> Option<u8> {
        while let Some(b' ' | b'\t' | b'\r' | b'\n') = self.byte() {
            self.at += 1;
        }
        self.byte()
    }

    fn byte(&self) -> Option<u8> {
        self.text.as_bytes().get(self.at).copied()
    }

    /// Scans a value. Recursion is bounded by serde_json's limit of 128 levels, which the text has passed.
    fn value(&mut self) -> Node {
        let first = self.peek();
        let mut node = Node { value_start: self.at, ..Node::default() };
        match first {
            Some(b'{') => node.children = self.members(),
            Some(b'[') => node.children = self.entries(),
            Some(b'"') => self.string(),
            _ => {
                while !matches!(self.byte(), None | Some(b',' | b']' | b'}' | b' ' | b'\t' | b'\r' | b'\n')) {
                    self.at += 1;
                }
            }
        }
        node
    }

    fn string(&mut self) {
        self.at += 1;
        loop {
            match self.byte() {
                Some(b'\\') => self.at += 2,
                Some(b'"') => break,
                Some(_) => self.at += 1,
                None => return,
            }
        }
        self.at += 1;
    }

    fn entries(&mut self) -> Vec<Node> {
        self.at += 1;
        let mut entries = Vec::new();
        while !matches!(self.peek(), None | Some(b']')) {
            let before = self.at;
            entries.push(self.value());
            if self.at == before {
                break;
            }
            if self.peek() == Some(b',') {
                self.at += 1;
            }
        }
        self.at += 1;
        entries
    }

    fn members(&mut self) -> Vec<Node> {
        self.at += 1;
        let mut members = Vec::new();
        let mut names = FxHashSet::default();
        while self.peek() == Some(b'"') {
            let name_start = self.at;
            self.string();
            let name: String =
                serde_json::from_str(self.text.get(name_start..self.at).unwrap_or("")).unwrap_or_default();
            if !names.insert(name.clone()) {
                self.duplicates.push(DuplicateKey { start: name_start, name: name.clone() });
            }
            if self.peek() == Some(b':') {
                self.at += 1;
            }
            members.push(Node { name_start: Some(name_start), name: Some(name), ..self.value() });
            if self.peek() == Some(b',') {
                self.at += 1;
            }
        }
        self.at += 1;
        members
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn values_and_names_are_found() {
        let spans = Spans::scan("{\"a\": [1, {\"b \\\" c\":\n  true}], \"d\" : 2}");
        let path = Path::root().name("a").entry(1).name("b \" c");
        assert_eq!(spans.find(&path, false), Some((2, 3)));
        assert_eq!(spans.find(&path, true), Some((1, 12)));
        assert_eq!(spans.find(&Path::root().name("d"), false), Some((2, 17)));
        assert_eq!(spans.find(&Path::root().name("e"), false), None);
        assert_eq!(path.to_string(), "a[1].`b \" c`");
    }

    #[test]
    fn of_a_text_that_is_not_json_nothing_is_found_behind_the_error() {
        for text in ["", "{", "[", "[,,", "{\"a", "{\"a\\", "\"\\", "[1 2]", "{\"a\" 1}", "}", "[}"] {
            let spans = Spans::scan(text);
            assert_eq!(spans.find(&Path::root().name("b"), false), None, "{text}");
            assert_eq!(spans.find(&Path::root().entry(7), false), None, "{text}");
        }
        assert_eq!(Spans::scan("[1 2]").find(&Path::root().entry(0), false), Some((1, 2)));
    }
}
