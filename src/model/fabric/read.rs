//! Reads `crease-fabric/1`: a complete fabric, or one based on a preset with the differences only.

use crate::error::{Diagnostic, Error, Result};
use crate::fabric::{Fabric, preset_list};
use crate::json::{Document, Path, nearest, schema_of};
use serde_json::{Value, json};

/// Groups of [`crate::fabric::Provenance`] with their fields.
const GROUPS: [(&str, &[&str]); 7] = [
    ("mass", &["area_density_g_m2", "thickness_mm"]),
    ("stretch", &["stretch_warp_n_per_m", "stretch_weft_n_per_m"]),
    ("shear", &["shear_n_per_m"]),
    ("bend", &["bend_warp_un_m", "bend_weft_un_m"]),
    ("damping", &["stretch_damping_s", "bend_damping_s"]),
    ("friction", &["friction", "friction_ground"]),
    ("memory", &["memory"]),
];

impl Fabric {
    /// Reads a fabric file; `file` is its name in messages. Fields that it leaves out are those of the preset `based_on`, if
    /// there is one; the provenance of a group with a changed number is replaced.
    ///
    /// # Errors
    /// [`crate::error::Error::Input`] with every error of the file, each with line, column and help.
    pub fn parse(file: &str, text: &str) -> Result<Self> {
        let mut document = Document::parse(file, text)?;
        let base = match document.value().get("based_on").and_then(Value::as_str) {
            Some(name) => Some(base_of(&document, name)?),
            None => None,
        };
        if let Some((base_name, base)) = base {
            restate_provenance(&mut document, file, &base_name);
            document.merge_defaults(&base);
        }
        let faults = document.validate(&schema_of::<Self>());
        if !faults.is_empty() {
            return Err(Error::Input(faults));
        }
        let fabric: Self = document.decode()?;
        let faults = fabric.validate(&document);
        if faults.is_empty() { Ok(fabric) } else { Err(Error::Input(faults)) }
    }

    /// JSON Schema of fabric files; a file with `based_on` may leave the rest out.
    pub fn schema() -> Value {
        let mut schema = schema_of::<Self>();
        let all = schema.get("required").cloned().unwrap_or_default();
        if let Some(top) = schema.as_object_mut() {
            top.insert("required".to_owned(), json!(["format", "name"]));
            top.insert("anyOf".to_owned(), json!([{ "required": ["based_on"] }, { "required": all }]));
        }
        schema
    }

    /// The fabric as a file: JSON with line breaks, ending in one.
    pub fn to_json(&self) -> String {
        // Plain numbers and texts: writing them to memory does not fail.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }

    /// Errors that involve more than one field.
    fn validate(&self, document: &Document) -> Vec<Diagnostic> {
        let at = Path::root().name("memory");
        let memory = &self.memory;
        let pairs = [
            (
                "critical_threshold_percent",
                memory.critical_threshold_percent,
                memory.gradual_threshold_percent,
            ),
            (
                "critical_stretch_threshold_percent",
                memory.critical_stretch_threshold_percent,
                memory.gradual_stretch_threshold_percent,
            ),
        ];
        let swapped = pairs.into_iter().filter(|(_, critical, gradual)| critical <= gradual);
        swapped
            .map(|(field, critical, gradual)| {
                let what = format!("is {critical}, not above the gradual threshold of {gradual}");
                document.diagnostic(&at.name(field), what, "raise it, or lower the gradual one")
            })
            .collect()
    }
}

fn base_of(document: &Document, name: &str) -> Result<(String, Value)> {
    let Some(text) = preset_list::text_of(name) else {
        let names = preset_list::names();
        let cure = match nearest(name, names.iter().copied()) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => format!("the presets are {}", names.join(", ")),
        };
        let what = format!("there is no preset {}", crate::json::quoted(name));
        return Err(Error::Input(vec![document.diagnostic(&Path::root().name("based_on"), what, cure)]));
    };
    Ok((name.to_owned(), Document::parse(name, text)?.value().clone()))
}

/// Replaces the provenance of every group of which the file changes a number, unless the file states it.
fn restate_provenance(document: &mut Document, file: &str, base: &str) {
    for (group, fields) in GROUPS {
        let own = fields.iter().any(|field| document.value().get(field).is_some());
        let stated = document.value().pointer(&format!("/provenance/{group}")).is_some();
        if own && !stated && document.value().is_object() {
            let text = format!("{file}, changed from the preset {base}; origin not stated");
            document.set(&["provenance", group], Value::String(text));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn faults(text: &str) -> Vec<String> {
        match Fabric::parse("f.json", text) {
            Ok(fabric) => panic!("accepted: {fabric:?}"),
            Err(Error::Input(faults)) => faults.iter().map(ToString::to_string).collect(),
            Err(other) => panic!("{other}"),
        }
    }

    #[test]
    fn units_become_si() {
        let text = Fabric::preset("denim").expect("exists").to_json();
        let text = text.replace("\"bend_warp_un_m\": 71.6", "\"bend_warp_un_m\": 12.5");
        let fabric = Fabric::parse("f.json", &text).expect("is valid");
        assert!((fabric.bend_warp() - 12.5e-6).abs() < 1e-18);
        assert!((fabric.area_density() - 0.421).abs() < 1e-12);
        assert!((fabric.thickness() - 0.887e-3).abs() < 1e-12);
        assert!((fabric.memory.reference_length() - 0.002).abs() < 1e-12);
        assert!((fabric.memory.critical_stretch_threshold() - 0.06).abs() < 1e-12);
        // B = 1e-5 N·m, 0.2 kg/m²: (1e-5 / (0.2 * 9.81))^(1/3) = 17.2 mm.
        let known = Fabric {
            bend_warp_un_m: 20.0,
            bend_weft_un_m: 5.0,
            area_density_g_m2: 200.0,
            ..Fabric::preset("denim").expect("exists")
        };
        assert!((known.bending_length() - 0.017209).abs() < 1e-6, "{}", known.bending_length());
    }

    #[test]
    fn presets_survive_a_round_trip() {
        for name in Fabric::preset_names() {
            let fabric = Fabric::preset(name).expect(name);
            assert_eq!(Fabric::parse(name, &fabric.to_json()).expect(name), fabric);
        }
    }

    #[test]
    fn a_fabric_may_say_only_what_is_different() {
        let text = r#"{"format": "crease-fabric/1", "name": "stiff denim", "based_on": "denim",
            "bend_warp_un_m": 150, "memory": {"critical_duration_s": 2.5}}"#;
        let denim = Fabric::preset("denim").expect("exists");
        let fabric = Fabric::parse("stiff.json", text).expect("is valid");
        assert_eq!(fabric.name, "stiff denim");
        assert_eq!(fabric.bend_warp_un_m, 150.0);
        assert_eq!(fabric.bend_weft_un_m, denim.bend_weft_un_m);
        assert_eq!(fabric.memory.critical_duration_s, 2.5);
        assert_eq!(fabric.memory.critical_threshold_percent, denim.memory.critical_threshold_percent);
        // The numbers it changed are no longer those of the literature.
        assert!(fabric.provenance.bend.contains("stiff.json"), "{}", fabric.provenance.bend);
        assert!(fabric.provenance.memory.contains("stiff.json"));
        assert_eq!(fabric.provenance.shear, denim.provenance.shear);
    }

    #[test]
    fn faults_name_the_place_the_nearest_name_and_all_at_once() {
        let text = "{\"format\": \"crease-fabric/1\", \"name\": \"x\", \"based_on\": \"denim\",\n\
                    \"bend_wrap_un_m\": 3,\n\"thickness_mm\": 0,\n\"memory\": {\"gradual_angle_ratio\": 1.5}}";
        let found = faults(text);
        assert_eq!(found.len(), 3, "{found:#?}");
        assert!(found[0].contains("line 2, column 1") && found[0].contains("did you mean `bend_warp_un_m`?"));
        assert!(found[1].contains("line 3, column 17, at thickness_mm: is 0, expected a number above 0"));
        assert!(found[2].contains("at memory.gradual_angle_ratio: is 1.5, expected a number from 0 to 1"));
    }

    #[test]
    fn thresholds_in_the_wrong_order_and_unknown_bases_are_faults() {
        let with = |rest: &str| format!(r#"{{"format": "crease-fabric/1", "name": "x", {rest}}}"#);
        let swapped = r#""based_on": "linen", "memory": {"gradual_threshold_percent": 120}"#;
        assert!(faults(&with(swapped))[0].contains("not above the gradual threshold of 120"));
        assert!(faults(&with(r#""based_on": "linnen""#))[0].contains("did you mean `linen`?"));
        assert_eq!(faults(&with(r#""memory": {}"#)).len(), 11, "a fabric of its own says everything");
        assert!(faults(&with(r#""based_on": "linen", "provenance": 3"#))[0].contains("provenance: is 3"));
    }

    #[test]
    fn the_schema_lets_a_based_fabric_be_short() {
        let schema = Fabric::schema();
        assert_eq!(schema.get("required"), Some(&json!(["format", "name"])));
        assert!(schema.pointer("/anyOf/1/required/4").is_some());
    }
}
