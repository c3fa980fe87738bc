//! `unfold`: folds are opened again, the last one first.

use super::{Misfit, WearAction};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Open folds again, the last one first. Without `last`, all of them.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Unfold {
    /// Open every fold. May be left out; not together with `last`.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub all: Option<bool>,
    /// How many folds to open, counted back from the latest.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    #[schemars(range(min = 1, max = 10000))]
    pub last: Option<u32>,
    /// How long opening them takes, all together [s]. Default 2.
    #[serde(rename = "over", default = "over_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 3600))]
    pub over_s: f64,
}

fn over_s() -> f64 {
    2.0
}

impl WearAction for Unfold {
    /// All folds together take `over`: a script does not know how many there are.
    fn duration_s(&self) -> f64 {
        self.over_s
    }

    fn misfits(&self) -> Vec<Misfit> {
        match (self.all, self.last) {
            (Some(true), Some(_)) => {
                vec![Misfit::new("last", "`all` and `last` do not go together", "keep one of them")]
            }
            (Some(false), None) => {
                vec![Misfit::new(
                    "all",
                    "`all` is false and `last` is missing",
                    "say how many folds with `last`",
                )]
            }
            _ => Vec::new(),
        }
    }

    fn example() -> Self {
        Self { all: None, last: Some(2), over_s: 1.5 }
    }
}
