//! `OUT.report.json`: what a bake did, what it cost and what there is to worry about, in numbers.
//!
//! Plain data: the bake fills it in, the tool writes it, others read it by these names (`docs/formats.md`). Units
//! stand in the names. It measures nothing itself; `crossings` are counted exactly by who fills them in.

use schemars::JsonSchema;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::BTreeMap;
use std::fmt;

/// The report of one bake.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "crease report")]
pub struct Report {
    /// Time the run took [s].
    pub wall_s: f64,
    /// Time that passed for the cloth [s].
    pub simulated_s: f64,
    /// Accepted time steps.
    pub steps: u64,
    /// Welded points of the simulated mesh.
    pub points: usize,
    /// Triangles of the simulated mesh.
    pub triangles: usize,
    /// Pairs of triangles that intersect in the result and did not at the start.
    pub crossings: usize,
    /// Pairs of triangles that intersect in the input already.
    pub crossings_at_start: usize,
    /// Events of memory.
    pub events: EventCounts,
    /// Largest magnitude of a rest angle in the result [degrees].
    pub max_rest_angle_deg: f64,
    /// Largest stiffness ratio in the result [-]; 1 is new cloth.
    pub max_stiffness_ratio: f64,
    /// Time integration, by its name on the command line.
    pub method: String,
    /// Which models were on, which were off, and why.
    pub models: Vec<ModelChoice>,
    /// Time by stage [s], in the order the stages first ran.
    #[schemars(with = "BTreeMap<String, f64>")]
    pub stages: StageTimes,
    /// What the user should know of, in words.
    pub warnings: Vec<String>,
}

/// Events of memory, counted over all hinges and triangles.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct EventCounts {
    /// Gradual ones.
    pub gradual: u64,
    /// Critical ones.
    pub critical: u64,
}

/// A model, and whether a scene needs it.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ModelChoice {
    /// Its name.
    pub name: String,
    /// Whether it was on.
    pub on: bool,
    /// Why, with the number behind it.
    pub why: String,
}

/// Seconds by stage, in the order the stages first ran; in JSON an object.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StageTimes(Vec<(String, f64)>);

impl StageTimes {
    /// Adds `seconds` to `stage`; a new stage goes to the end.
    pub fn add(&mut self, stage: &str, seconds: f64) {
        match self.0.iter_mut().find(|(name, _)| name == stage) {
            Some((_, sum)) => *sum += seconds,
            None => self.0.push((stage.to_owned(), seconds)),
        }
    }

    /// Stages with their seconds, in order.
    pub fn iter(&self) -> impl Iterator<Item = (&str, f64)> {
        self.0.iter().map(|(name, seconds)| (name.as_str(), *seconds))
    }
}

impl Serialize for StageTimes {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_map(self.iter())
    }
}

impl<'de> Deserialize<'de> for StageTimes {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        struct InOrder;
        impl<'de> Visitor<'de> for InOrder {
            type Value = StageTimes;

            fn expecting(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
                out.write_str("an object of seconds by stage")
            }

            fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<StageTimes, A::Error> {
                let mut stages = Vec::new();
                while let Some(entry) = map.next_entry()? {
                    stages.push(entry);
                }
                Ok(StageTimes(stages))
            }
        }
        deserializer.deserialize_map(InOrder)
    }
}

impl Report {
    /// As a file: JSON with line breaks, ending in one.
    pub fn to_json(&self) -> String {
        // Plain numbers and texts: writing them to memory does not fail.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn report() -> Report {
        let mut stages = StageTimes::default();
        for (stage, seconds) in [("read", 0.25), ("solve", 2.0), ("contact", 1.0), ("solve", 0.5)] {
            stages.add(stage, seconds);
        }
        Report {
            wall_s: 4.0,
            steps: 120,
            events: EventCounts { gradual: 3, critical: 1 },
            method: "bdf2".to_owned(),
            models: vec![ModelChoice { name: "friction".to_owned(), on: false, why: "no slope".to_owned() }],
            stages,
            ..Report::default()
        }
    }

    #[test]
    fn names_and_order_are_those_others_read() {
        let value = serde_json::to_value(report()).expect("plain data");
        let names: Vec<&str> =
            value.as_object().into_iter().flatten().map(|(name, _)| name.as_str()).collect();
        assert_eq!(
            names.join(" "),
            "wall_s simulated_s steps points triangles crossings crossings_at_start events max_rest_angle_deg \
             max_stiffness_ratio method models stages warnings"
        );
        let text = report().to_json();
        let compact: String = text.split_whitespace().collect();
        assert!(compact.contains(r#""stages":{"read":0.25,"solve":2.5,"contact":1.0}"#), "{text}");
        assert!(compact.contains(r#""events":{"gradual":3,"critical":1}"#), "{text}");
        assert!(compact.contains(r#"{"name":"friction","on":false,"why":"noslope"}"#), "{text}");
    }

    #[test]
    fn a_report_survives_a_round_trip() {
        let back: Report = serde_json::from_str(&report().to_json()).expect("reads back");
        assert_eq!(back, report());
    }
}
