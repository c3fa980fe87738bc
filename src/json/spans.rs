//! Where each part of a JSON text stands. serde_json has already accepted the text, so the scan only has to find
//! its way; it never fails, and what it cannot follow it leaves without a place.

use rustc_hash::FxHashSet;
use std::fmt;

/// One step of a path.
#[derive(Debug, Clone, PartialEq, Eq)]
pub enum Segment {
    /// Into the member of an object with this name.
    Name(String),
    /// Into the entry of a list, counted from 0.
    Entry(usize),
}

/// The way to a part of a JSON value; written `actions[2].fold.angle`.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Path(Vec<Segment>);

impl Path {
    /// The whole value.
    pub fn root() -> Self {
        Self::default()
    }

    /// One step further, to a member.
    pub fn name(&self, name: impl Into<String>) -> Self {
        self.step(Segment::Name(name.into()))
    }

    /// One step further, to an entry.
    pub fn entry(&self, index: usize) -> Self {
        self.step(Segment::Entry(index))
    }

    /// Whether the whole value is meant.
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

    pub(super) fn of_serde(path: &serde_path_to_error::Path) -> Self {
        use serde_path_to_error::Segment as Theirs;
        let steps = path.iter().map_while(|segment| match segment {
            Theirs::Seq { index } => Some(Segment::Entry(*index)),
            Theirs::Map { key } => Some(Segment::Name(key.clone())),
            Theirs::Enum { variant } => Some(Segment::Name(variant.clone())),
            Theirs::Unknown => None,
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
                    let quoted = crate::json::quoted(name);
                    let plain = name.chars().all(|c| c.is_alphanumeric() || "_-".contains(c));
                    out.write_str(if plain { quoted.trim_matches('`') } else { &quoted })?;
                }
            }
        }
        Ok(())
    }
}

/// Byte offsets of a value, of its name where it is a member, and of what lies in it.
#[derive(Debug, Clone, Default)]
struct Node {
    value_at: usize,
    name_at: Option<usize>,
    name: Option<String>,
    inside: Vec<Node>,
}

/// The places of every part of a text.
#[derive(Debug, Clone)]
pub(super) struct Places {
    text: String,
    root: Node,
    twice: Vec<(usize, String)>,
}

impl Places {
    /// Of a text that serde_json accepts.
    pub(super) fn of(text: &str) -> Self {
        let mut scan = Scan { text, at: 0, twice: Vec::new() };
        let root = scan.value();
        Self { text: text.to_owned(), root, twice: scan.twice }
    }

    /// Names that an object has more than once: place of the later one, and the name, quoted.
    pub(super) fn duplicate_keys(&self) -> impl Iterator<Item = (String, String)> {
        self.twice.iter().map(|(at, name)| (self.spot(*at), crate::json::quoted(name)))
    }

    /// "line 3, column 14" of the value at `path`, or of its name; nothing where the text has no such value.
    pub(super) fn find(&self, path: &Path, of_name: bool) -> Option<String> {
        let mut node = &self.root;
        for segment in &path.0 {
            node = match segment {
                Segment::Entry(index) => node.inside.get(*index)?,
                Segment::Name(name) => node.inside.iter().find(|n| n.name.as_ref() == Some(name))?,
            };
        }
        Some(self.spot(node.name_at.filter(|_| of_name).unwrap_or(node.value_at)))
    }

    fn spot(&self, at: usize) -> String {
        let before = self.text.get(..at).unwrap_or(&self.text);
        let line = before.matches('\n').count() + 1;
        let column = before.chars().rev().take_while(|c| *c != '\n').count() + 1;
        format!("line {line}, column {column}")
    }
}

/// serde_json counts columns in bytes; people count characters.
pub(super) fn line_and_column(text: &str, line: usize, column: usize) -> String {
    let whole = text.split('\n').nth(line.saturating_sub(1)).unwrap_or("");
    let before = whole.as_bytes().get(..column.saturating_sub(1)).unwrap_or(whole.as_bytes());
    format!("line {}, column {}", line.max(1), String::from_utf8_lossy(before).chars().count() + 1)
}

struct Scan<'a> {
    text: &'a str,
    at: usize,
    twice: Vec<(usize, String)>,
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

    /// As deep as serde_json's own limit of 128, which the text has passed.
    fn value(&mut self) -> Node {
        let first = self.peek();
        let mut node = Node { value_at: self.at, ..Node::default() };
        match first {
            Some(b'{') => node.inside = self.members(),
            Some(b'[') => node.inside = self.entries(),
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
            let name_at = self.at;
            self.string();
            let name: String =
                serde_json::from_str(self.text.get(name_at..self.at).unwrap_or("")).unwrap_or_default();
            if !names.insert(name.clone()) {
                self.twice.push((name_at, name.clone()));
            }
            if self.peek() == Some(b':') {
                self.at += 1;
            }
            members.push(Node { name_at: Some(name_at), name: Some(name), ..self.value() });
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
        let places = Places::of("{\"a\": [1, {\"b \\\" c\":\n  true}], \"d\" : 2}");
        let path = Path::root().name("a").entry(1).name("b \" c");
        assert_eq!(places.find(&path, false).as_deref(), Some("line 2, column 3"));
        assert_eq!(places.find(&path, true).as_deref(), Some("line 1, column 12"));
        assert_eq!(places.find(&Path::root().name("d"), false).as_deref(), Some("line 2, column 17"));
        assert_eq!(places.find(&Path::root().name("e"), false), None);
        assert_eq!(path.to_string(), "a[1].`b \" c`");
    }

    #[test]
    fn a_text_that_is_not_json_does_not_hang_or_panic() {
        for text in ["", "{", "[", "[,,", "{\"a", "{\"a\\", "\"\\", "[1 2]", "{\"a\" 1}", "}", "[}"] {
            Places::of(text);
        }
    }
}
