//! Landmarks, format `crease-landmarks/1`: places of two garments that belong together, as a person marked them.
//!
//! Units stand in the names: metres, y up, as in sidecars, whatever the mesh files count in.

use crate::json::{Document, Path, schema_of};
use crate::math::Vec3;
use crate::{Error, Result};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Places nearer to one another than this are the same [m].
const SAME_PLACE: f64 = 1e-5;

/// The format of a landmark file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
enum LandmarksFormat {
    /// The first.
    #[serde(rename = "crease-landmarks/1")]
    V1,
}

/// Places of two garments that belong together.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "crease landmarks")]
pub struct Landmarks {
    /// Format of the file: crease-landmarks/1.
    format: LandmarksFormat,
    /// One for each place; three that do not lie on a line, or more, also turn and scale.
    #[schemars(length(min = 1, max = 1000))]
    pub pairs: Vec<Landmark>,
}

/// One place on both garments.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Landmark {
    /// What it is, for people: left elbow.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// On the garment the memory comes from, in metres, y up, as its sidecar's points.
    pub source_m: [f64; 3],
    /// On the garment it goes to, in metres, y up.
    pub target_m: [f64; 3],
}

impl Landmarks {
    /// Reads landmarks; `file` is their name in messages. Refused, too, when a place of the source is there twice.
    ///
    /// ```
    /// let text = r#"{"format": "crease-landmarks/1", "pairs": [{"source_m": [0, 1, 0], "target_m": [0, 1.1, 0]}]}"#;
    /// let landmarks = crease::Landmarks::parse("landmarks.json", text)?;
    /// assert_eq!(landmarks.pairs[0].target_m[1], 1.1);
    /// # Ok::<(), crease::Error>(())
    /// ```
    pub fn parse(file: &str, text: &str) -> Result<Self> {
        let document = Document::parse(file, text)?;
        let faults = document.validate(&Self::schema());
        if !faults.is_empty() {
            return Err(Error::Input(faults));
        }
        let read: Self = document.decode()?;
        let mut faults = Vec::new();
        for (i, one) in read.pairs.iter().enumerate() {
            let same = |other: &Landmark| {
                (Vec3::from(other.source_m) - Vec3::from(one.source_m)).norm() < SAME_PLACE
            };
            if let Some(first) = read.pairs[..i].iter().position(same) {
                let place = Path::root().name("pairs").entry(i).name("source_m");
                let what = format!("is where pairs[{first}] is");
                faults.push(document.diagnostic(&place, what, "keep one of them"));
            }
        }
        if faults.is_empty() { Ok(read) } else { Err(Error::Input(faults)) }
    }

    /// The JSON Schema of landmark files.
    pub fn schema() -> Value {
        schema_of::<Self>()
    }

    /// Source and target place of each [m].
    pub fn position_pairs(&self) -> Vec<[Vec3; 2]> {
        self.pairs.iter().map(|pair| [pair.source_m, pair.target_m].map(Vec3::from)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_faults_of_a_file_are_told_at_once_with_their_places() {
        let read = Landmarks::parse(
            "l.json",
            r#"{"format": "crease-landmarks/1", "pairs": [{"name": "neck", "source_m": [0, 1, 0], "target_m": [0, 1.1, 0]}]}"#,
        );
        assert_eq!(read.unwrap().position_pairs(), [[Vec3::y(), Vec3::y() * 1.1]]);
        let twice = r#"{"format": "crease-landmarks/1", "pairs": [{"source_m": [0, 1, 0], "target_m": [0, 1, 0]},
            {"source_m": [0, 1, 0], "target_m": [0, 2, 0]}]}"#;
        let message = Landmarks::parse("l.json", twice).unwrap_err().to_string();
        assert!(message.contains("line 2") && message.contains("pairs[0]"), "{message}");
        let wrong = r#"{"format": "crease-landmarks/1", "pairs": [{"source": [0, 1], "target_m": [0, 1]}]}"#;
        let message = Landmarks::parse("l.json", wrong).unwrap_err().to_string();
        assert!(message.contains("source_m") && message.contains("target_m"), "{message}");
    }
}
