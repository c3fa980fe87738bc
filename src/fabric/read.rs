//! Reads `crease-fabric/1`: a fabric in full, or one based on a preset that says only what is different.

use super::{Fabric, preset_list};
use crate::error::{Error, Fault, Result};
use crate::json::{Document, Path, nearest, schema_of};
use serde_json::{Value, json};

/// Each group of [`super::Provenance`] with the fields it speaks of.
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
    /// Reads a fabric; `file` is its name in messages. What it leaves out comes from the preset `based_on`, if it
    /// names one; a group of numbers it changes is then no longer said to come from where the preset's came from.
    pub fn parse(file: &str, text: &str) -> Result<Self> {
        let mut document = Document::parse(file, text)?;
        let base = match document.value().get("based_on").and_then(Value::as_str) {
            Some(name) => Some(base_of(&document, name)?),
            None => None,
        };
        if let Some((base_name, base)) = base {
            restate_provenance(&mut document, file, &base_name);
            document.complete_from(&base);
        }
        let faults = document.faults(&schema_of::<Self>());
        if !faults.is_empty() {
            return Err(Error::Input(faults));
        }
        let fabric: Self = document.decode()?;
        let faults = fabric.misfits(&document);
        if faults.is_empty() { Ok(fabric) } else { Err(Error::Input(faults)) }
    }

    /// The JSON Schema of fabric files: a file with `based_on` need not say the rest.
    pub fn schema() -> Value {
        let mut schema = schema_of::<Self>();
        let all = schema.get("required").cloned().unwrap_or_default();
        if let Some(top) = schema.as_object_mut() {
            top.insert("required".to_owned(), json!(["format", "name"]));
            top.insert("anyOf".to_owned(), json!([{ "required": ["based_on"] }, { "required": all }]));
        }
        schema
    }

    /// As a file: JSON with line breaks, ending in one.
    pub fn to_json(&self) -> String {
        // Plain numbers and texts: writing them to memory does not fail.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }

    /// Faults that no single field shows.
    fn misfits(&self, document: &Document) -> Vec<Fault> {
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
                document.fault(&at.name(field), what, "raise it, or lower the gradual one")
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
        return Err(Error::Input(vec![document.fault(&Path::root().name("based_on"), what, cure)]));
    };
    Ok((name.to_owned(), Document::parse(name, text)?.value().clone()))
}

/// Marks every group of which the file has a number of its own, unless the file says itself where it is from.
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
