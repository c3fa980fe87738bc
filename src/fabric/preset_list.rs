//! The fabrics that come along: one file each in `presets/`, one line each here. `docs/fabrics.md` says where their
//! numbers come from, as does `provenance` in each.

use super::Fabric;
use crate::error::{Error, Result};
use crate::json::nearest;

/// The fabric of a bake that names none.
pub const DEFAULT_FABRIC: &str = "kow-tshirt";

macro_rules! preset_list {
    ($($name:literal,)*) => {
        /// Name and file of each, in the order they are listed to people.
        const PRESETS: &[(&str, &str)] = &[$(($name, include_str!(concat!("presets/", $name, ".json"))),)*];
    };
}

preset_list! {
    "kow-tshirt",
    "cotton-poplin",
    "cotton-poplin-resin",
    "denim",
    "linen",
    "wool-summer-suiting",
    "wool-winter-flannel",
    "silk-habotai",
    "polyester-georgette",
    "polyester-taffeta",
    "viscose-challis",
    "polycotton-shirting",
    "cotton-jersey",
    "interlock-ponte",
}

/// Names of all presets, in list order.
pub(super) fn names() -> Vec<&'static str> {
    PRESETS.iter().map(|(name, _)| *name).collect()
}

/// The file of a preset.
pub(super) fn text_of(name: &str) -> Option<&'static str> {
    PRESETS.iter().find(|(own, _)| *own == name).map(|(_, text)| *text)
}

impl Fabric {
    /// Names of all presets, in list order.
    pub fn preset_names() -> Vec<&'static str> {
        names()
    }

    /// The preset `name`; the fault names the nearest one where there is none.
    pub fn preset(name: &str) -> Result<Self> {
        match text_of(name) {
            Some(text) => Self::parse(name, text),
            None => {
                let cure = match nearest(name, names()) {
                    Some(meant) => format!("did you mean `{meant}`? `crease fabric list` names them all"),
                    None => format!("the presets are {}", names().join(", ")),
                };
                Err(Error::fault(
                    "fabric",
                    "",
                    format!("there is no preset {}", crate::json::quoted(name)),
                    cure,
                ))
            }
        }
    }
}
