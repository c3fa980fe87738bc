//! JSON that a person wrote, read with its places: every fault names line, column, path, what was expected and the
//! nearest allowed name, and all faults of a file come in one go.
//!
//! Stands on the lowest floor: wear scripts, fabrics and other files of the user's own are read through it. The
//! types say what is allowed: their JSON Schema (schemars) is the one list of names and ranges, printed for editors
//! and checked here. serde turns the checked value into the type afterwards.
//!
//! Does not do: files (the tool opens them), meshes, and JSON Schema in full; only the words that derived schemas
//! of this crate use.

mod check;
mod spans;
mod suggest;

pub use spans::{Path, Segment};
pub use suggest::nearest;

use crate::error::{Diagnostic, Error, Result};
use crate::json::spans::Places;
use schemars::{JsonSchema, generate::SchemaSettings};
use serde::de::DeserializeOwned;
use serde_json::Value;

/// Faults reported of one file; a file that is wrong throughout is not listed line by line.
const FAULT_LIMIT: usize = 50;

/// A JSON value with the file it came from and the place of each part in it.
#[derive(Debug, Clone)]
pub struct Document {
    file: String,
    value: Value,
    /// Absent for a value that was made by a program.
    places: Option<Places>,
}

impl Document {
    /// Reads `text` of `file` (a name for messages only). Fails on broken syntax and on names given twice.
    pub fn parse(file: &str, text: &str) -> Result<Self> {
        let text = text.strip_prefix('\u{feff}').unwrap_or(text);
        let value = serde_json::from_str(text).map_err(|e| {
            let place = spans::line_and_column(text, e.line(), e.column());
            let what = e.to_string();
            let what = what.split(" at line ").next().unwrap_or(&what).to_owned();
            Error::input(
                file,
                place,
                format!("not valid JSON: {what}"),
                "mend the syntax there or just before it",
            )
        })?;
        let places = Places::of(text);
        let twice: Vec<Diagnostic> = places
            .duplicate_keys()
            .take(FAULT_LIMIT)
            .map(|(place, name)| {
                Diagnostic::new(file, place, format!("{name} is given twice"), "keep one of them")
            })
            .collect();
        if !twice.is_empty() {
            return Err(Error::Input(twice));
        }
        Ok(Self { file: file.to_owned(), value, places: Some(places) })
    }

    /// A value made by a program; faults name the path in it only.
    pub fn from_value(file: &str, value: Value) -> Self {
        Self { file: file.to_owned(), value, places: None }
    }

    /// The value.
    pub fn value(&self) -> &Value {
        &self.value
    }

    /// Fills what the document leaves out from `base`, object by object; what it has itself stays.
    pub fn merge_defaults(&mut self, base: &Value) {
        complete(&mut self.value, base);
    }

    /// Sets a member of the top object, for values that a program derives from others.
    pub fn set(&mut self, path: &[&str], value: Value) {
        let mut at = &mut self.value;
        for name in path {
            let Value::Object(members) = at else { return };
            at = members.entry(*name).or_insert_with(|| Value::Object(Default::default()));
        }
        *at = value;
    }

    /// Everything that does not suit `schema`, in file order; empty when all is well.
    pub fn validate(&self, schema: &Value) -> Vec<Diagnostic> {
        check::faults(self, schema)
    }

    /// The value as a `T`. Meant for a document without [`Document::faults`]; what slips through is still located.
    pub fn decode<T: DeserializeOwned>(&self) -> Result<T> {
        serde_path_to_error::deserialize(&self.value).map_err(|e| {
            let path = Path::of_serde(e.path());
            Error::Input(vec![self.diagnostic(&path, e.inner().to_string(), "")])
        })
    }

    /// A fault at the value that `path` leads to.
    pub fn diagnostic(&self, path: &Path, what: impl Into<String>, cure: impl Into<String>) -> Diagnostic {
        Diagnostic::new(&self.file, self.place(path, false), what, cure)
    }

    /// A fault of the name of the member that `path` leads to.
    fn diagnostic_of_name(&self, path: &Path, what: String, cure: String) -> Diagnostic {
        Diagnostic::new(&self.file, self.place(path, true), what, cure)
    }

    fn place(&self, path: &Path, of_name: bool) -> String {
        let spot = self.places.as_ref().and_then(|places| places.find(path, of_name));
        match (spot, path.is_empty()) {
            (Some(spot), true) => spot,
            (Some(spot), false) => format!("{spot}, at {path}"),
            (None, true) => String::new(),
            (None, false) => path.to_string(),
        }
    }
}

/// The JSON Schema of `T`, as it is printed and as it is checked.
pub fn schema_of<T: JsonSchema>() -> Value {
    SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<T>().to_value()
}

fn complete(value: &mut Value, base: &Value) {
    if let (Value::Object(own), Value::Object(base)) = (value, base) {
        for (name, other) in base {
            match own.get_mut(name) {
                Some(mine) => complete(mine, other),
                None => {
                    own.insert(name.clone(), other.clone());
                }
            }
        }
    }
}

/// Text from a file, made safe and short enough for a message: quoted, control characters escaped, cut at 60.
pub(crate) fn quoted(text: &str) -> String {
    let mut out = String::from("`");
    for (count, c) in text.chars().enumerate() {
        if count == 60 {
            out.push('…');
            break;
        }
        match c {
            '"' | '\'' | '`' => out.push(c),
            _ => out.extend(c.escape_debug()),
        }
    }
    out.push('`');
    out
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde::Deserialize;

    /// How a test thing goes.
    #[derive(Debug, Deserialize, JsonSchema, PartialEq)]
    #[serde(rename_all = "snake_case")]
    enum Way {
        /// To the left.
        Left,
        /// To the right.
        Right,
    }

    #[derive(Debug, Deserialize, JsonSchema, PartialEq)]
    #[serde(deny_unknown_fields)]
    struct Thing {
        /// How wide it is [m]. More words.
        #[schemars(range(max = 2.0), extend("exclusiveMinimum" = 0.0))]
        width: f64,
        #[serde(default)]
        #[schemars(range(min = 1, max = 5))]
        count: Option<u32>,
        way: Way,
        #[serde(default)]
        parts: Vec<[f64; 2]>,
    }

    fn faults(text: &str) -> Vec<String> {
        match Document::parse("t.json", text) {
            Ok(document) => {
                document.validate(&schema_of::<Thing>()).iter().map(ToString::to_string).collect()
            }
            Err(Error::Input(faults)) => faults.iter().map(ToString::to_string).collect(),
            Err(other) => vec![other.to_string()],
        }
    }

    #[test]
    fn a_good_value_has_no_faults_and_decodes() {
        let text = r#"{"width": 2, "count": null, "way": "left", "parts": [[0, 1]]}"#;
        assert_eq!(faults(text), Vec::<String>::new());
        let thing: Thing = Document::parse("t.json", text).and_then(|d| d.decode()).expect("decodes");
        assert_eq!(thing, Thing { width: 2.0, count: None, way: Way::Left, parts: vec![[0.0, 1.0]] });
    }

    #[test]
    fn every_fault_is_reported_in_one_go_with_its_place() {
        let found = faults(
            "{\n  \"widht\": 1,\n  \"count\": 7.5,\n  \"way\": \"Lfet\",\n  \"parts\": [[1, 2], [3], 4]\n}",
        );
        assert_eq!(
            found,
            [
                "t.json: line 2, column 3, at widht: unknown name `widht` (did you mean `width`? allowed here: \
                 `width`, `count`, `way`, `parts`)",
                "t.json: line 3, column 12, at count: is 7.5, expected a whole number from 1 to 5",
                "t.json: line 4, column 10, at way: is `Lfet`, expected `left` or `right` (did you mean `left`?)",
                "t.json: line 5, column 21, at parts[1]: has 1 entry, expected a list of 2 numbers",
                "t.json: line 5, column 26, at parts[2]: is 4, expected a list of 2 numbers",
                "t.json: line 1, column 1: `width` is missing: a number above 0 and at most 2 (How wide it is [m].)",
            ]
        );
    }

    #[test]
    fn ranges_hold_at_their_ends() {
        assert!(faults(r#"{"width": 2.0, "way": "left"}"#).is_empty());
        for width in ["0", "2.0000001", "-1", "\"1\"", "null", "[]"] {
            let found = faults(&format!(r#"{{"width": {width}, "way": "left"}}"#));
            assert_eq!(found.len(), 1, "{found:?}");
            assert!(found[0].contains("column 11, at width: is "), "{found:?}");
        }
    }

    #[test]
    fn syntax_faults_and_doubles_are_placed() {
        assert!(
            faults("{\"width\": 1,\n \"way\" \"left\"}")[0]
                .starts_with("t.json: line 2, column 8: not valid JSON")
        );
        assert_eq!(
            faults("{\"width\": 1,\n \"width\": 2}"),
            ["t.json: line 2, column 2: `width` is given twice (keep one of them)"]
        );
        assert!(faults("")[0].contains("not valid JSON"));
        assert!(faults(&"[".repeat(100_000))[0].contains("not valid JSON"));
    }

    #[test]
    fn columns_count_characters() {
        let found = faults("{\"way\": \"ééé\", \"width\": -1}");
        assert!(found[1].contains("column 25, at width"), "{found:?}");
    }

    #[test]
    fn a_hopeless_file_gives_a_bounded_list() {
        let many: Vec<String> = (0..5000).map(|i| format!("\"x{i}\": 0")).collect();
        let found = faults(&format!("{{{}}}", many.join(",")));
        assert_eq!(found.len(), FAULT_LIMIT + 1);
        assert!(found[FAULT_LIMIT].contains("more"), "{}", found[FAULT_LIMIT]);
    }
}
