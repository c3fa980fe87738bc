//! Parses the statements of an OBJ file into lists of positions, corners and faces. Statements that garments do not need
//! (curves, points, lines, smoothing groups, vendors' keywords) are skipped and noted; the others must be valid, and every
//! error is reported with its line.
//!
//! Indices are resolved here: relative ones against the elements read so far, all of them against the whole file at the
//! end (some writers put vertices after the faces). Triangulates no faces and makes no pieces: see [`super`].

use crate::corners::Corner;
use crate::error_list::ErrorList;
use crate::obj::lines::Lines;
use crate::tuning::TUNING;
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::INVALID;
use crease_model::error::Diagnostic;
use crease_model::garment::{ImportDiagnostic, Severity};
use rustc_hash::FxHashMap;

/// Face: a range of corners with one label.
pub(super) struct Face {
    pub(super) corners: std::ops::Range<usize>,
    pub(super) label: usize,
    line: usize,
}

/// Object, group and material of a face: `o`, `g` and `usemtl`.
#[derive(Debug, Clone, Default, PartialEq, Eq, Hash)]
pub(super) struct Label {
    pub(super) object: Option<String>,
    pub(super) group: Option<String>,
    pub(super) material: Option<String>,
}

/// Statements of a file.
#[derive(Default)]
pub(super) struct Statements {
    pub(super) positions: Vec<Vec3>,
    /// Positions that cannot be read, in order.
    pub(super) bad_positions: Vec<BadPosition>,
    /// One per position; white where the file has none.
    pub(super) colours: Vec<[f64; 3]>,
    pub(super) has_colours: bool,
    pub(super) uvs: Vec<Vec2>,
    pub(super) normals: Vec<Vec3>,
    pub(super) corners: Vec<Corner>,
    pub(super) faces: Vec<Face>,
    /// Labels in order of first use by a face.
    pub(super) labels: Vec<Label>,
    pub(super) diagnostics: Vec<ImportDiagnostic>,
}

/// Position that cannot be read. Only a piece that uses it is refused.
pub(super) struct BadPosition {
    /// Index of the position.
    pub(super) index: u32,
    line: usize,
    message: String,
}

impl BadPosition {
    /// Returns the error.
    pub(super) fn error(&self, file: &str) -> Diagnostic {
        let help = "correct or remove this vertex";
        Diagnostic::new(file, format!("line {}", self.line), self.message.clone(), help)
    }
}

/// Parses all statements of `bytes`; errors go to `errors`.
pub(super) fn parse(bytes: &[u8], errors: &mut ErrorList) -> Statements {
    let mut parser = Parser::new(errors);
    for line in Lines::new(bytes) {
        parser.statement(line.number, &line.text);
    }
    parser.finish()
}

struct Parser<'f> {
    read: Statements,
    errors: &'f mut ErrorList,
    label: Label,
    label_number: Option<usize>,
    label_numbers: FxHashMap<Label, usize>,
    /// Skipped keywords in order of appearance.
    skipped: Vec<(String, Occurrences)>,
    dropped_faces: Occurrences,
    replaced: Occurrences,
}

/// Occurrences of something in a file.
#[derive(Debug, Clone, Copy, Default)]
struct Occurrences {
    count: usize,
    /// Line of the first.
    first_line: usize,
}

impl Occurrences {
    fn add(&mut self, line: usize) {
        if self.count == 0 {
            self.first_line = line;
        }
        self.count += 1;
    }
}

impl<'f> Parser<'f> {
    fn new(errors: &'f mut ErrorList) -> Self {
        Self {
            read: Statements::default(),
            errors,
            label: Label::default(),
            label_number: None,
            label_numbers: FxHashMap::default(),
            skipped: Vec::new(),
            dropped_faces: Occurrences::default(),
            replaced: Occurrences::default(),
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
            // Shading and file references do not change the shape.
            "s" | "mtllib" | "usemap" | "maplib" | "lod" | "bevel" | "c_interp" | "d_interp" => {}
            other => self.skip(other, line),
        }
    }

    fn position(&mut self, line: usize, rest: &str) {
        let values = numbers(rest);
        let mut position = Vec3::zeros();
        for (k, slot) in position.iter_mut().enumerate() {
            let error = match values.get(k) {
                Some(Some(x)) if x.abs() <= TUNING.max_obj_coordinate => {
                    *slot = *x;
                    continue;
                }
                Some(_) => "a coordinate is not a finite number",
                None => "a vertex needs three coordinates",
            };
            let message = format!("{error}: \"v {}\"", short(rest));
            let index = self.read.positions.len() as u32;
            self.read.bad_positions.push(BadPosition { index, line, message });
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
        let at = |k: usize| {
            values.get(k).copied().unwrap_or(Some(0.0)).filter(|x| x.abs() <= TUNING.max_obj_coordinate)
        };
        let (u, v) = (at(0), at(1));
        if u.is_none() || v.is_none() {
            self.replaced.add(line);
        }
        // OBJ's v grows upward, glTF's downward.
        self.read.uvs.push(Vec2::new(u.unwrap_or(0.0), 1.0 - v.unwrap_or(0.0)));
    }

    fn normal(&mut self, line: usize, rest: &str) {
        let values = numbers(rest);
        let at = |k: usize| values.get(k).copied().flatten().filter(|x| x.abs() <= TUNING.max_obj_coordinate);
        let normal = match (at(0), at(1), at(2)) {
            (Some(x), Some(y), Some(z)) => Vec3::new(x, y, z).try_normalize(0.0),
            _ => None,
        };
        if normal.is_none() {
            self.replaced.add(line);
        }
        // Zero stands for the normal of the face, which replaces it when the vertex is made.
        self.read.normals.push(normal.unwrap_or_else(Vec3::zeros));
    }

    fn face(&mut self, line: usize, rest: &str) {
        let start = self.read.corners.len();
        for word in words(rest) {
            match self.corner(word) {
                Ok(corner) => self.read.corners.push(corner),
                Err(message) => {
                    self.errors.push(format!("line {line}"), message, "correct or remove this face");
                    self.read.corners.truncate(start);
                    return;
                }
            }
        }
        let corners = start..self.read.corners.len();
        if corners.len() < 3 {
            self.read.corners.truncate(start);
            self.dropped_faces.add(line);
        } else if corners.len() > TUNING.max_face_corners {
            self.errors.push(
                format!("line {line}"),
                format!("a face of {} corners", corners.len()),
                "cut it into smaller faces",
            );
        } else {
            let label = self.current_label();
            self.read.faces.push(Face { corners, label, line });
        }
    }

    /// Parses `v`, `v/vt`, `v//vn` or `v/vt/vn`, with empty parts anywhere after the first.
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
        if let Some((_, occurrences)) = self.skipped.iter_mut().find(|(known, _)| *known == keyword) {
            occurrences.add(line);
        } else if self.skipped.len() < TUNING.max_skipped_keywords {
            self.skipped.push((keyword, Occurrences { count: 1, first_line: line }));
        }
    }

    fn finish(mut self) -> Statements {
        self.check_indices();
        let mut diagnostics = Vec::new();
        let mut find = |severity, line: usize, message: String| {
            let location = format!("line {line}");
            diagnostics.push(ImportDiagnostic { severity, location, message: message.into() });
        };
        if let Occurrences { count: count @ 1.., first_line: line } = self.dropped_faces {
            find(Severity::Repaired, line, format!("{count} faces of fewer than 3 corners dropped"));
        }
        if let Occurrences { count: count @ 1.., first_line: line } = self.replaced {
            let message = format!("{count} texture coordinates or normals that are not numbers replaced");
            find(Severity::Repaired, line, message);
        }
        for (keyword, Occurrences { count, first_line }) in &self.skipped {
            find(Severity::Note, *first_line, format!("{count} \"{keyword}\" statements skipped"));
        }
        self.read.diagnostics = diagnostics;
        self.read
    }

    /// Reports indices beyond the whole file.
    fn check_indices(&mut self) {
        let counts = [self.read.positions.len(), self.read.uvs.len(), self.read.normals.len()];
        for face in &self.read.faces {
            let corners = self.read.corners.get(face.corners.clone()).unwrap_or(&[]);
            let beyond = corners.iter().find_map(|corner| {
                let parts = [corner.position, corner.uv, corner.normal];
                (0..3).find(|&k| parts[k] != INVALID && parts[k] as usize >= counts[k]).map(|k| (k, parts[k]))
            });
            if let Some((k, index)) = beyond {
                let kind = ["vertices", "texture coordinates", "normals"][k];
                self.errors.push(
                    format!("line {}", face.line),
                    format!("index {} is out of range: the file has {} {kind}", index + 1, counts[k]),
                    "correct or remove this face",
                );
            }
        }
    }
}

/// Returns the list position of an index; [`INVALID`] for an empty part. `kind` names the list.
fn resolve(part: &str, count: usize, kind: &str, word: &str) -> Result<u32, String> {
    if part.is_empty() {
        return Ok(INVALID);
    }
    let shown = short(word);
    let index: i64 = part.parse().map_err(|_| format!("corner \"{shown}\" is not an index"))?;
    match index {
        0 => Err(format!("corner \"{shown}\" has {kind} index 0; OBJ counts from 1")),
        1.. => match u32::try_from(index - 1) {
            Ok(position) if position != INVALID => Ok(position),
            _ => Err(format!("corner \"{shown}\": {kind} index {index} is out of range")),
        },
        _ => u32::try_from(count as i64 + index).map_err(|_| {
            format!(
                "corner \"{shown}\": relative {kind} index {index} is out of range, {count} were read so far"
            )
        }),
    }
}

/// Returns the words up to a comment. # begins a comment only at the start of a word: "1.#IND" is an invalid number.
fn words(rest: &str) -> impl Iterator<Item = &str> {
    rest.split_ascii_whitespace().take_while(|word| !word.starts_with('#'))
}

/// Returns the numbers of a statement up to a comment; `None` for words that are not finite numbers.
fn numbers(rest: &str) -> Vec<Option<f64>> {
    words(rest).take(8).map(|word| word.parse::<f64>().ok().filter(|x| x.is_finite())).collect()
}

/// Returns a name, inner blanks reduced to one; `None` if it is empty.
fn name(rest: &str) -> Option<String> {
    let words: Vec<&str> = rest.split_ascii_whitespace().collect();
    (!words.is_empty()).then(|| words.join(" "))
}

/// Returns enough of a text to recognise it in a message.
fn short(text: &str) -> String {
    let mut shown: String = text.chars().take(40).collect();
    if shown.len() < text.len() {
        shown.push_str("...");
    }
    shown
}
