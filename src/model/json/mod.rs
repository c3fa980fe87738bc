//! JSON that a person wrote, read with source locations: every diagnostic names line, column and path, what was expected
//! and the nearest allowed name, and all diagnostics of a file are reported in one pass. Comments and a `$schema` for
//! editors are allowed.
//!
//! Wear scripts, fabrics and other files of the user are read through it. The Rust types define what is allowed: their
//! JSON Schema (schemars) is the one list of names and ranges, printed for editors and checked here. serde converts the
//! checked value into the type afterwards.
//!
//! Not covered: files (the tool opens them), meshes, and JSON Schema in full; only the keywords that derived schemas of
//! this crate use.

mod comments;
mod document;
mod file_kind;
mod quoted;
mod schema_check;
mod spans;
mod suggest;

pub use document::Document;
pub use file_kind::{FileKind, kind_of_file, kind_of_mesh};
pub use quoted::quoted;
pub use spans::{Path, Segment};
pub use suggest::nearest;

use schemars::{JsonSchema, generate::SchemaSettings};
use serde_json::Value;

/// Returns the JSON Schema of `T`, as it is printed and as it is checked.
pub fn schema_of<T: JsonSchema>() -> Value {
    SchemaSettings::draft2020_12().into_generator().into_root_schema_for::<T>().to_value()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::error::Error;
    use crate::json::document::MAX_DIAGNOSTICS;
    use serde::Deserialize;

    /// Side of a test value.
    #[derive(Debug, Deserialize, JsonSchema, PartialEq)]
    #[serde(rename_all = "snake_case")]
    enum Side {
        /// To the left.
        Left,
        /// To the right.
        Right,
    }

    #[derive(Debug, Deserialize, JsonSchema, PartialEq)]
    #[serde(deny_unknown_fields)]
    struct Thing {
        /// Width of it [m]. More words.
        #[schemars(range(max = 2.0), extend("exclusiveMinimum" = 0.0))]
        width: f64,
        #[serde(default)]
        #[schemars(range(min = 1, max = 5))]
        count: Option<u32>,
        side: Side,
        #[serde(default)]
        parts: Vec<[f64; 2]>,
    }

    fn messages(text: &str) -> Vec<String> {
        match Document::parse("t.json", text) {
            Ok(document) => {
                document.validate(&schema_of::<Thing>()).iter().map(ToString::to_string).collect()
            }
            Err(Error::Input(diagnostics)) => diagnostics.iter().map(ToString::to_string).collect(),
            Err(other) => vec![other.to_string()],
        }
    }

    #[test]
    fn a_valid_value_decodes() {
        let text = r#"{"width": 2, "count": null, "side": "left", "parts": [[0, 1]]}"#;
        assert_eq!(messages(text), Vec::<String>::new());
        let thing: Thing = Document::parse("t.json", text).and_then(|d| d.decode()).expect("decodes");
        assert_eq!(thing, Thing { width: 2.0, count: None, side: Side::Left, parts: vec![[0.0, 1.0]] });
    }

    #[test]
    fn all_violations_are_reported_with_their_locations() {
        let found = messages(
            "{\n  \"widht\": 1,\n  \"count\": 7.5,\n  \"side\": \"Lfet\",\n  \"parts\": [[1, 2], [3], 4]\n}",
        );
        assert_eq!(
            found,
            [
                "t.json: line 2, column 3, at widht: unknown name `widht` (did you mean `width`? allowed here: \
                 `width`, `count`, `side`, `parts`)",
                "t.json: line 3, column 12, at count: is 7.5, expected a whole number from 1 to 5",
                "t.json: line 4, column 11, at side: is `Lfet`, expected `left` or `right` (did you mean `left`?)",
                "t.json: line 5, column 21, at parts[1]: has 1 entry, expected a list of 2 numbers",
                "t.json: line 5, column 26, at parts[2]: is 4, expected a list of 2 numbers",
                "t.json: line 1, column 1: `width` is missing: a number above 0 and at most 2 (Width of it [m].)",
            ]
        );
    }

    #[test]
    fn ranges_hold_at_their_ends() {
        assert!(messages(r#"{"width": 2.0, "side": "left"}"#).is_empty());
        for width in ["0", "2.0000001", "-1", "\"1\"", "null", "[]"] {
            let found = messages(&format!(r#"{{"width": {width}, "side": "left"}}"#));
            assert_eq!(found.len(), 1, "{found:?}");
            assert!(found[0].contains("column 11, at width: is "), "{found:?}");
        }
    }

    #[test]
    fn syntax_errors_and_duplicate_keys_are_located() {
        assert!(
            messages("{\"width\": 1,\n \"side\" \"left\"}")[0]
                .starts_with("t.json: line 2, column 9: not valid JSON")
        );
        assert_eq!(
            messages("{\"width\": 1,\n \"width\": 2}"),
            ["t.json: line 2, column 2: `width` is given twice (keep one of them)"]
        );
        assert!(messages("")[0].contains("not valid JSON"));
        assert!(messages(&"[".repeat(100_000))[0].contains("not valid JSON"));
    }

    #[test]
    fn columns_count_characters() {
        let found = messages("{\"side\": \"ééé\", \"width\": -1}");
        assert!(found[1].contains("column 26, at width"), "{found:?}");
    }

    #[test]
    fn a_file_of_errors_gives_a_bounded_list() {
        let many: Vec<String> = (0..5000).map(|i| format!("\"x{i}\": 0")).collect();
        let found = messages(&format!("{{{}}}", many.join(",")));
        assert_eq!(found.len(), MAX_DIAGNOSTICS + 1);
        assert!(found[MAX_DIAGNOSTICS].contains("more"), "{}", found[MAX_DIAGNOSTICS]);
    }
}
