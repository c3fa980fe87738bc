//! `play`: an animation clip of the body is played.

use super::WearAction;
use crate::error::Result;
use crate::wear::gesture::{Posture, Scene, Start};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Play an animation clip of the body, as often as asked. Needs a body.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Play {
    /// Name of the clip, as the body file has it.
    #[schemars(length(min = 1))]
    pub clip: String,
    /// How often. Default 1.
    #[serde(default = "once")]
    #[schemars(range(min = 1, max = 10000))]
    pub repeat: u32,
}

fn once() -> u32 {
    1
}

impl WearAction for Play {
    /// 0: only the body knows how long its clip is.
    fn duration_s(&self) -> f64 {
        0.0
    }

    fn needs_body(&self) -> bool {
        true
    }

    fn begin(&self, scene: &Scene, _posture: &mut Posture) -> Result<Start> {
        Err(scene.refuse("`play` moves a body, and there is none", "leave this action out"))
    }

    fn example() -> Self {
        Self { clip: "walk".to_owned(), repeat: 3 }
    }
}
