//! The statements of an OBJ file to lists of positions, corners and faces, tolerantly: what garments do not need
//! (curves, points, lines, smoothing groups, vendors' own keywords) is skipped and noted, what they do need must be
//! right, and every fault is told with its line.
//!
//! Indices are resolved here: relative ones against what has been read so far, all of them against the whole file at
//! the end (some writers put vertices after the faces). Cuts no faces and makes no pieces: see [`super`].

use crate::garment::{ImportDiagnostic, Severity};
use crate::io::diagnostics::DiagnosticList;
use crate::io::obj::lines::Lines;
use crate::math::{Vec2, Vec3};
use crate::mesh::INVALID;
use rustc_hash::FxHashMap;

/// Coordinates beyond this many units are damage.
const FARTHEST: f64 = 1e12;
/// More corners than any drawn face has; the clipper's own limit lies higher.
const MOST_CORNERS: usize = 1_000_000;
/// Skipped keywords told apart; a binary file taken for text has a new one on every line.
const MOST_KEYWORDS: usize = 20;

/// One corner of a face: positions of its `v`, `vt` and `vn` in their lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Corner {
    pub(super) position: u32,
    pub(super) uv: u32,
    pub(super) normal: u32,
}

/// A face: a run of corners under one label.
pub(super) struct Face {
    pub(super) corners: std::ops::Range<usize>,
    pub(super) label: usize,
    line: usize,
}

/// What a face stands under: `o`, `g` and `usemtl`.
#[derive(Debug, Clone, Default, PartialEq, Eq, Hash)]
pub(super) struct Label {
    pub(super) object: Option<String>,
    pub(super) group: Option<String>,
    pub(super) material: Option<String>,
}

/// A file's statements.
#[derive(Default)]
pub(super) struct Statements {
    pub(super) positions: Vec<Vec3>,
    /// One per position; white where the file has none.
    pub(super) colours: Vec<[f64; 3]>,
    pub(super) has_colours: bool,
    pub(super) uvs: Vec<Vec2>,
    pub(super) normals: Vec<Vec3>,
    pub(super) corners: Vec<Corner>,
    pub(super) faces: Vec<Face>,
    /// In order of first use by a face.
    pub(super) labels: Vec<Label>,
    pub(super) findings: Vec<ImportDiagnostic>,
}

/// Reads every statement of `bytes`; faults go to `faults`.
pub(super) fn parse(bytes: &[u8], faults: &mut DiagnosticList) -> Statements {
    let mut parser = Parser::new(faults);
    for line in Lines::new(bytes) {
        parser.statement(line.number, &line.text);
    }
    parser.finish()
}

struct Parser<'f> {
    read: Statements,
    faults: &'f mut DiagnosticList,
    label: Label,
    label_number: Option<usize>,
    label_numbers: FxHashMap<Label, usize>,
    /// Keywords that were skipped, with the line of the first and their count, in order of appearance.
    skipped: Vec<(String, usize, usize)>,
    dropped_faces: (usize, usize),
    mended: (usize, usize),
}

impl<'f> Parser<'f> {
    fn new(faults: &'f mut DiagnosticList) -> Self {
        Self {
            read: Statements::default(),
            faults,
            label: Label::default(),
            label_number: None,
            label_numbers: FxHashMap::default(),
            skipped: Vec::new(),
            dropped_faces: (0, 0),
            mended: (0, 0),
        }
    }

    fn statement(&mut self, line: usize, text: &str) {
        let text = text.trim();
        let (keyword, rest) = text.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((text, ""));
        match keyword {
            "" => {}
            _ if keyword.starts_with('#') => {}
            "v" => self.position(line, rest),
            "vt" => self.uv(line, rest),
            "vn" => self.normal(line, rest),
            "f" | "fo" => self.face(line, rest),
            "o" => self.relabel(|label| {
                label.object = name(rest);
                label.group = None;
            }),
            "g" => self.relabel(|label| label.group = name(rest)),
            "usemtl" => self.relabel(|label| label.material = name(rest)),
            // Shading and file references: nothing a garment's shape depends on.
            "s" | "mtllib" | "usemap" | "maplib" | "lod" | "bevel" | "c_interp" | "d_interp" => {}
            other => self.skip(other, line),
        }
    }

    fn position(&mut self, line: usize, rest: &str) {
        let values = numbers(rest);
        let place = || format!("line {line}");
        let mut position = Vec3::zeros();
        for (k, slot) in position.iter_mut().enumerate() {
            let fault = match values.get(k) {
                Some(Some(x)) if x.abs() <= FARTHEST => {
                    *slot = *x;
                    continue;
                }
                Some(_) => "a coordinate is not a finite number",
                None => "a vertex needs three coordinates",
            };
            self.faults.push(
                place(),
                format!("{fault}: \"v {}\"", short(rest)),
                "mend or remove this vertex",
            );
            break;
        }
        self.read.positions.push(position);
        // x y z r g b, or x y z w r g b; a lone w matters to curves only.
        let colour = match values.as_slice() {
            [_, _, _, r, g, b] | [_, _, _, _, r, g, b, ..] => Some([r, g, b].map(|c| c.unwrap_or(1.0))),
            _ => None,
        };
        self.read.has_colours |= colour.is_some();
        self.read.colours.push(colour.unwrap_or([1.0; 3]));
    }

    fn uv(&mut self, line: usize, rest: &str) {
        let values = numbers(rest);
        let at = |k: usize| values.get(k).copied().unwrap_or(Some(0.0)).filter(|x| x.abs() <= FARTHEST);
        let (u, v) = (at(0), at(1));
        if u.is_none() || v.is_none() {
            self.mend(line);
        }
        // OBJ's v grows upward, glTF's downward.
        self.read.uvs.push(Vec2::new(u.unwrap_or(0.0), 1.0 - v.unwrap_or(0.0)));
    }

    fn normal(&mut self, line: usize, rest: &str) {
        let values = numbers(rest);
        let at = |k: usize| values.get(k).copied().flatten().filter(|x| x.abs() <= FARTHEST);
        let normal = match (at(0), at(1), at(2)) {
            (Some(x), Some(y), Some(z)) => Vec3::new(x, y, z).try_normalize(0.0),
            _ => None,
        };
        if normal.is_none() {
            self.mend(line);
        }
        // Zero asks for the face's own normal when the vertex is made.
        self.read.normals.push(normal.unwrap_or_else(Vec3::zeros));
    }

    fn face(&mut self, line: usize, rest: &str) {
        let start = self.read.corners.len();
        for word in words(rest) {
            match self.corner(word) {
                Ok(corner) => self.read.corners.push(corner),
                Err(what) => {
                    self.faults.push(format!("line {line}"), what, "mend or remove this face");
                    self.read.corners.truncate(start);
                    return;
                }
            }
        }
        let corners = start..self.read.corners.len();
        if corners.len() < 3 {
            self.read.corners.truncate(start);
            self.dropped_faces = (self.dropped_faces.0 + 1, first_line(self.dropped_faces.1, line));
        } else if corners.len() > MOST_CORNERS {
            self.faults.push(
                format!("line {line}"),
                format!("a face of {} corners", corners.len()),
                "cut it into smaller faces",
            );
        } else {
            let label = self.current_label();
            self.read.faces.push(Face { corners, label, line });
        }
    }

    /// `v`, `v/vt`, `v//vn`, `v/vt/vn`, with empty parts anywhere after the first.
    fn corner(&self, word: &str) -> Result<Corner, String> {
        let mut parts = word.split('/');
        let position = resolve(parts.next().unwrap_or(""), self.read.positions.len(), "vertex", word)?;
        if position == INVALID {
            return Err(format!("corner \"{}\" has no vertex index", short(word)));
        }
        let uv = resolve(parts.next().unwrap_or(""), self.read.uvs.len(), "texture", word)?;
        let normal = resolve(parts.next().unwrap_or(""), self.read.normals.len(), "normal", word)?;
        Ok(Corner { position, uv, normal })
    }

    fn relabel(&mut self, change: impl FnOnce(&mut Label)) {
        change(&mut self.label);
        self.label_number = None;
    }

    fn current_label(&mut self) -> usize {
        if let Some(number) = self.label_number {
            return number;
        }
        let next = self.read.labels.len();
        let number = *self.label_numbers.entry(self.label.clone()).or_insert(next);
        if number == next {
            self.read.labels.push(self.label.clone());
        }
        self.label_number = Some(number);
        number
    }

    fn skip(&mut self, keyword: &str, line: usize) {
        let keyword = short(keyword);
        if let Some((_, _, count)) = self.skipped.iter_mut().find(|(known, ..)| *known == keyword) {
            *count += 1;
        } else if self.skipped.len() < MOST_KEYWORDS {
            self.skipped.push((keyword, line, 1));
        }
    }

    fn mend(&mut self, line: usize) {
        self.mended = (self.mended.0 + 1, first_line(self.mended.1, line));
    }

    fn finish(mut self) -> Statements {
        self.check_indices();
        let mut findings = Vec::new();
        let mut find = |severity, line: usize, what| {
            findings.push(ImportDiagnostic { severity, location: format!("line {line}"), message: what });
        };
        if let (count @ 1.., line) = self.dropped_faces {
            find(Severity::Repaired, line, format!("{count} faces of fewer than 3 corners dropped"));
        }
        if let (count @ 1.., line) = self.mended {
            let what = format!("{count} texture coordinates or normals that are not numbers replaced");
            find(Severity::Repaired, line, what);
        }
        for (keyword, line, count) in &self.skipped {
            find(Severity::Note, *line, format!("{count} \"{keyword}\" statements skipped"));
        }
        self.read.findings = findings;
        self.read
    }

    /// Indices beyond the whole file.
    fn check_indices(&mut self) {
        let counts = [self.read.positions.len(), self.read.uvs.len(), self.read.normals.len()];
        for face in &self.read.faces {
            let corners = self.read.corners.get(face.corners.clone()).unwrap_or(&[]);
            let beyond = corners.iter().find_map(|corner| {
                let parts = [corner.position, corner.uv, corner.normal];
                (0..3).find(|&k| parts[k] != INVALID && parts[k] as usize >= counts[k]).map(|k| (k, parts[k]))
            });
            if let Some((k, index)) = beyond {
                let what = ["vertices", "texture coordinates", "normals"][k];
                self.faults.push(
                    format!("line {}", face.line),
                    format!("index {} is out of range: the file has {} {what}", index + 1, counts[k]),
                    "mend or remove this face",
                );
            }
        }
    }
}

/// The list position an index means; [`INVALID`] for an empty part.
fn resolve(part: &str, count: usize, what: &str, word: &str) -> Result<u32, String> {
    if part.is_empty() {
        return Ok(INVALID);
    }
    let shown = short(word);
    let index: i64 = part.parse().map_err(|_| format!("corner \"{shown}\" is not an index"))?;
    match index {
        0 => Err(format!("corner \"{shown}\" has {what} index 0; OBJ counts from 1")),
        1.. => match u32::try_from(index - 1) {
            Ok(position) if position != INVALID => Ok(position),
            _ => Err(format!("corner \"{shown}\": {what} index {index} is out of range")),
        },
        _ => u32::try_from(count as i64 + index).map_err(|_| {
            format!(
                "corner \"{shown}\": relative {what} index {index} is out of range, {count} were read so far"
            )
        }),
    }
}

/// Words up to a comment. The sign begins one only at the start of a word: "1.#IND" is a number gone wrong.
fn words(rest: &str) -> impl Iterator<Item = &str> {
    rest.split_ascii_whitespace().take_while(|word| !word.starts_with('#'))
}

/// Numbers of a statement up to a comment; `None` for what is not a finite number.
fn numbers(rest: &str) -> Vec<Option<f64>> {
    words(rest).take(8).map(|word| word.parse::<f64>().ok().filter(|x| x.is_finite())).collect()
}

/// A name as it stands, inner blanks kept to one; nothing if empty.
fn name(rest: &str) -> Option<String> {
    let words: Vec<&str> = rest.split_ascii_whitespace().collect();
    (!words.is_empty()).then(|| words.join(" "))
}

/// Enough of a text to recognise it in a message.
fn short(text: &str) -> String {
    let mut shown: String = text.chars().take(40).collect();
    if shown.len() < text.len() {
        shown.push_str("...");
    }
    shown
}

fn first_line(known: usize, line: usize) -> usize {
    if known == 0 { line } else { known }
}
