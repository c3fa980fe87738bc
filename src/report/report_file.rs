//! `OUT.report.json`: results, cost and warnings of a bake.
//!
//! Plain data: the bake fills it in, the tool writes it, other programs read it by these names (`docs/reference/formats/report.md`). Units
//! are part of the names. `crossings` are counted exactly by [`crossing_counts`].

use crate::bake::{BakeReport, BakeResult, ModelDecision};
use crate::report::detail_report::DetailReport;
use crate::report::export::ExportCheck;
use crate::report::fine_report::{FineReport, WrittenFile};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::intersections::self_intersections;
use crease_model::error::Vocabulary;
use crease_model::garment::{Garment, ShownWear, WornGarment};
use schemars::JsonSchema;
use serde::de::{MapAccess, Visitor};
use serde::{Deserialize, Deserializer, Serialize, Serializer};
use std::collections::BTreeMap;
use std::fmt;

/// Report of one bake.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
#[schemars(title = "crease report")]
#[non_exhaustive]
pub struct Report {
    /// Wall time of the run [s].
    pub wall_s: f64,
    /// Simulated time [s].
    pub simulated_s: f64,
    /// Accepted time steps.
    pub steps: u64,
    /// Linear solves: iterations of the global and of the local Newton solver.
    #[serde(default)]
    pub linear_solves: u64,
    /// Welded points of the simulated mesh.
    pub points: usize,
    /// Triangles of the simulated mesh.
    pub triangles: usize,
    /// Pairs of triangles that intersect in the result but not in the input.
    pub crossings: usize,
    /// Pairs of triangles that intersect in the input.
    pub crossings_at_start: usize,
    /// All pairs of triangles that intersect in the result, those of the input among them.
    #[serde(default)]
    pub crossings_in_result: usize,
    /// Memory events.
    pub events: EventCounts,
    /// Maximum magnitude of the change of rest angle, rest minus source angle, in the result [degrees].
    #[serde(alias = "max_rest_angle_deg")]
    pub max_rest_angle_change_deg: f64,
    /// Maximum stiffness ratio in the result [-]; 1 for new cloth.
    pub max_stiffness_ratio: f64,
    /// What the worn shape shows.
    #[serde(default)]
    pub shown: ShownReport,
    /// Time integrator, by its name on the command line.
    pub method: String,
    /// Models that were on or off, and why.
    pub models: Vec<ModelChoice>,
    /// Wall time per stage [s], in the order the stages first ran.
    #[schemars(with = "BTreeMap<String, f64>")]
    pub stages: StageTimes,
    /// Warnings for the user.
    pub warnings: Vec<String>,
    /// End of a run that could not recover before the end of its script, and made no garment; omitted for others.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub stopped: Option<StoppedRun>,
    /// Files of `--export`, compared after reading them back; omitted if there are none.
    #[serde(default, rename = "also", alias = "exports", skip_serializing_if = "Vec::is_empty")]
    pub exports: Vec<ExportCheck>,
    /// Normal maps of fine wrinkles; omitted if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub detail_maps: Vec<DetailReport>,
    /// Finer mesh of `--fine`; omitted if there is none.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub fine: Option<FineReport>,
    /// Files that were written beside the report, with their sizes; omitted if there are none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub files: Vec<WrittenFile>,
}

/// End of a run before the end of its script.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct StoppedRun {
    /// Action during which it ended, as a location in the script.
    pub action: String,
    /// Simulated time [s].
    pub time_s: f64,
    /// Position where it happened [m].
    pub position_m: [f64; 3],
    /// What happened, and the cure.
    pub reason: String,
    /// File of the last checkpoint, if there is one.
    #[serde(default)]
    pub checkpoint: Option<String>,
    /// File of the last frame, if frames were asked for.
    #[serde(default)]
    pub last_frame: Option<String>,
}

/// Memory events, counted over all hinges and triangles.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct EventCounts {
    /// Gradual events.
    pub gradual: u64,
    /// Critical events.
    pub critical: u64,
}

/// What the worn shape shows on the triangles of the garment.
#[derive(Debug, Clone, Copy, Default, PartialEq, Serialize, Deserialize, JsonSchema)]
pub struct ShownReport {
    /// Largest angle by which a triangle turned [degrees].
    pub max_turn_deg: f64,
    /// Angle by which 95 % of the area turned at most [degrees].
    pub turn_95_deg: f64,
    /// Largest displacement of a point [m].
    pub max_displacement_m: f64,
    /// Displacement of 95 % of the area at most [m].
    pub displacement_95_m: f64,
    /// Share of the area that turned by 5 degrees or more [%].
    pub turned_percent: f64,
}

/// Decision about one model.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub struct ModelChoice {
    /// Name of the model.
    pub name: String,
    /// Whether it was on.
    pub on: bool,
    /// Reason, with the number behind it.
    pub why: String,
}

impl ModelChoice {
    fn new(decision: &ModelDecision, words: &dyn Vocabulary) -> Self {
        Self { name: decision.name.to_owned(), on: decision.on, why: decision.why.worded(words) }
    }
}

/// Seconds per stage, in the order the stages first ran; an object in JSON.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct StageTimes(Vec<(String, f64)>);

impl StageTimes {
    /// Adds `seconds` to `stage`, which is appended if it is new.
    pub fn add(&mut self, stage: &str, seconds: f64) {
        match self.0.iter_mut().find(|(name, _)| name == stage) {
            Some((_, sum)) => *sum += seconds,
            None => self.0.push((stage.to_owned(), seconds)),
        }
    }

    /// Iterates over the stages and their seconds in order.
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
        struct StageVisitor;
        impl<'de> Visitor<'de> for StageVisitor {
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
        deserializer.deserialize_map(StageVisitor)
    }
}

/// Numbers of intersecting pairs of triangles.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct CrossingCounts {
    /// Pairs in the input.
    pub at_start: usize,
    /// Pairs in the result that are not in the input.
    pub added: usize,
    /// All pairs in the result.
    pub in_result: usize,
}

/// Returns the pairs of exported triangles of `garment` that intersect in its source pose, sorted.
pub fn source_crossings(garment: &Garment) -> Vec<[u32; 2]> {
    self_intersections(&garment.points, garment.exported_triangles())
}

/// Counts the intersections of the exported triangles of `worn` in the source pose. `start` are those of the input garment
/// ([`source_crossings`]).
pub fn crossing_counts(garment: &Garment, worn: &WornGarment, start: &[[u32; 2]]) -> CrossingCounts {
    let x: Vec<Vec3> = garment.points.iter().zip(&worn.displacement).map(|(x, d)| x + d).collect();
    let end = self_intersections(&x, garment.exported_triangles());
    let added = end.iter().filter(|pair| start.binary_search(pair).is_err()).count();
    CrossingCounts { at_start: start.len(), added, in_result: end.len() }
}

impl From<ShownWear> for ShownReport {
    fn from(shown: ShownWear) -> Self {
        Self {
            max_turn_deg: shown.max_turn.to_degrees(),
            turn_95_deg: shown.turn_95.to_degrees(),
            max_displacement_m: shown.max_displacement,
            displacement_95_m: shown.displacement_95,
            turned_percent: 100.0 * shown.visible_fraction,
        }
    }
}

impl fmt::Display for ShownReport {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            out,
            "turned by up to {:.0} degrees (95 % of it: {:.0}), moved by up to {:.0} mm (95 %: {:.0})",
            self.max_turn_deg,
            self.turn_95_deg,
            1e3 * self.max_displacement_m,
            1e3 * self.displacement_95_m
        )
    }
}

impl Report {
    /// Creates the report of the bake `baked` of `garment` in the words of `words`. The caller adds `method` and the times of reading
    /// and writing.
    pub fn of_bake(
        garment: &Garment,
        baked: &BakeResult,
        counts: CrossingCounts,
        words: &dyn Vocabulary,
    ) -> Self {
        let memory = &baked.worn.memory;
        Self {
            crossings: counts.added,
            crossings_at_start: counts.at_start,
            crossings_in_result: counts.in_result,
            max_rest_angle_change_deg: memory.angle_changes().map(f64::abs).fold(0.0, f64::max).to_degrees(),
            max_stiffness_ratio: memory.stiffness_ratio.iter().copied().fold(1.0, f64::max),
            shown: ShownWear::of(&baked.worn, garment).into(),
            ..Self::of_work(garment, &baked.report, words)
        }
    }

    /// Creates the report of a bake of `garment` that ended before its script, with `crossings_at_start` pairs of triangles that
    /// intersect in the input. The caller adds `method` and the files that were kept.
    pub fn of_stopped(
        garment: &Garment,
        work: &BakeReport,
        crossings_at_start: usize,
        words: &dyn Vocabulary,
    ) -> Self {
        let stopped = work.stopped.as_ref().map(|stop| StoppedRun {
            action: stop.action.clone(),
            time_s: stop.time,
            position_m: stop.cause.position.into(),
            reason: stop.cause.reason.worded(words),
            ..StoppedRun::default()
        });
        Self { crossings_at_start, stopped, ..Self::of_work(garment, work, words) }
    }

    /// The report of a bake without its result.
    fn of_work(garment: &Garment, work: &BakeReport, words: &dyn Vocabulary) -> Self {
        let mut stages = StageTimes::default();
        work.stages.iter().for_each(|(stage, seconds)| stages.add(stage, *seconds));
        Self {
            simulated_s: work.simulated,
            steps: work.steps,
            linear_solves: work.solves + work.local_solves,
            points: garment.points.len(),
            triangles: garment.triangles.len(),
            events: EventCounts { gradual: work.events.gradual, critical: work.events.critical },
            models: work.decisions.iter().map(|own| ModelChoice::new(own, words)).collect(),
            stages,
            warnings: work.warnings.iter().map(|warning| warning.worded(words)).collect(),
            ..Self::default()
        }
    }

    /// Returns the report file: indented JSON with a final line break.
    pub fn to_json(&self) -> String {
        // Plain numbers and strings can always be serialised.
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

    /// A horizontal triangle, and a vertical one whose lowest corner is at height `y` above its middle.
    fn lying_and_standing(y: f64) -> Garment {
        let text = format!("v -1 0 -1\nv 1 0 -1\nv 0 0 1\nv 0 {y} 0\nv -1 2 0\nv 1 2 0\nf 1 2 3\nf 4 5 6\n");
        let options = crease_io::ReadOptions::default();
        let mut nothing = |_: &str| Ok(Vec::new());
        let (asset, _) =
            crease_io::read_asset("two.obj", text.as_bytes(), &options, &mut nothing).expect("is a mesh");
        Garment::from_asset(&asset).expect("is a garment").0
    }

    #[test]
    fn crossings_of_the_input_are_counted_apart() {
        let counts_after = |y: f64, fall: f64| {
            let garment = lying_and_standing(y);
            let start = source_crossings(&garment);
            let lowest = garment.points.iter().position(|p| p.x == 0.0 && p.z == 0.0).expect("is there");
            let mut displacement = vec![Vec3::zeros(); garment.points.len()];
            displacement[lowest].y = -fall;
            let worn = WornGarment { displacement, memory: crease_model::garment::RestState::flat(0, 2) };
            let counts = crossing_counts(&garment, &worn, &start);
            (counts.at_start, counts.added)
        };
        assert_eq!(counts_after(0.5, 0.0), (0, 0));
        assert_eq!(counts_after(0.5, 1.0), (0, 1), "added by the bake");
        assert_eq!(counts_after(-0.5, 0.1), (1, 0), "in the input");
        assert_eq!(counts_after(-0.5, -1.0), (1, 0), "in the input and undone");
    }

    #[test]
    fn names_and_order_are_those_of_the_format() {
        let value = serde_json::to_value(report()).expect("plain data");
        let names: Vec<&str> =
            value.as_object().into_iter().flatten().map(|(name, _)| name.as_str()).collect();
        assert_eq!(
            names.join(" "),
            "wall_s simulated_s steps linear_solves points triangles crossings crossings_at_start crossings_in_result events max_rest_angle_change_deg \
             max_stiffness_ratio shown method models stages warnings"
        );
        let text = report().to_json();
        let compact: String = text.split_whitespace().collect();
        assert!(compact.contains(r#""stages":{"read":0.25,"solve":2.5,"contact":1.0}"#), "{text}");
        assert!(compact.contains(r#""events":{"gradual":3,"critical":1}"#), "{text}");
        assert!(compact.contains(r#"{"name":"friction","on":false,"why":"noslope"}"#), "{text}");
    }

    #[test]
    fn reports_with_old_names_can_be_read() {
        let old = report()
            .to_json()
            .replace("max_rest_angle_change_deg", "max_rest_angle_deg")
            .replace("  \"linear_solves\": 0,\n", "");
        let back: Report = serde_json::from_str(&old).expect("reads");
        assert_eq!(back, report());
        let map = serde_json::json!({"texels": 8, "in_material": true, "mean_tilt_deg": 1.0,
            "contradicted_percent": 2.0, "height_range_m": [0.0, 0.001]});
        let map: DetailReport = serde_json::from_value(map).expect("reads");
        assert_eq!(map.conflicting_texel_percent, 2.0);
    }

    #[test]
    fn a_report_survives_a_round_trip() {
        let back: Report = serde_json::from_str(&report().to_json()).expect("reads back");
        assert_eq!(back, report());
    }
}
