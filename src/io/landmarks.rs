//! Landmarks, format `crease-landmarks/1`: pairs of corresponding positions of two garments, marked by a person.
//!
//! Units stand in the names: metres, y up, as in sidecars, whatever the unit of the mesh files.

use crate::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_model::error::{Error, Result};
use crease_model::json::{Document, Path, schema_of};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Format of a landmark file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
enum LandmarksFormat {
    /// First version.
    #[serde(rename = "crease-landmarks/1")]
    V1,
}

/// Pairs of corresponding positions of two garments.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "crease landmarks")]
pub struct Landmarks {
    /// Format of the file: crease-landmarks/1.
    format: LandmarksFormat,
    /// Pairs of positions; three or more that are not collinear also define a rotation and a scale.
    #[schemars(length(min = 1, max = 1000))]
    pub pairs: Vec<Landmark>,
}

/// A position on both garments.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Landmark {
    /// Name, for people: left elbow.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub name: Option<String>,
    /// Position on the source garment, in metres, y up, as in its sidecar.
    pub source_m: [f64; 3],
    /// Position on the target garment, in metres, y up.
    pub target_m: [f64; 3],
}

impl Landmarks {
    /// Parses landmarks; `file` is their name in messages. Fails also if two source positions coincide.
    ///
    /// ```
    /// let text = r#"{"format": "crease-landmarks/1", "pairs": [{"source_m": [0, 1, 0], "target_m": [0, 1.1, 0]}]}"#;
    /// let landmarks = crease_io::Landmarks::parse("landmarks.json", text)?;
    /// assert_eq!(landmarks.pairs[0].target_m[1], 1.1);
    /// # Ok::<(), crease_model::error::Error>(())
    /// ```
    pub fn parse(file: &str, text: &str) -> Result<Self> {
        let document = Document::parse(file, text)?;
        let errors = document.validate(&Self::schema());
        if !errors.is_empty() {
            return Err(Error::Input(errors));
        }
        let read: Self = document.decode()?;
        let mut errors = Vec::new();
        for (i, one) in read.pairs.iter().enumerate() {
            let same = |other: &Landmark| {
                (Vec3::from(other.source_m) - Vec3::from(one.source_m)).norm() < TUNING.landmark_tol_m
            };
            if let Some(first) = read.pairs[..i].iter().position(same) {
                let location = Path::root().name("pairs").entry(i).name("source_m");
                let message = format!("is where pairs[{first}] is");
                errors.push(document.diagnostic(&location, message, "keep one of them"));
            }
        }
        if errors.is_empty() { Ok(read) } else { Err(Error::Input(errors)) }
    }

    /// Returns the JSON Schema of landmark files.
    pub fn schema() -> Value {
        schema_of::<Self>()
    }

    /// Returns the source and target position of each pair [m].
    pub fn position_pairs(&self) -> Vec<[Vec3; 2]> {
        self.pairs.iter().map(|pair| [pair.source_m, pair.target_m].map(Vec3::from)).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_errors_of_a_file_are_reported_with_their_locations() {
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
