//! The built-in fabrics: one file each in `presets/`, one line each here. `docs/reference/fabrics.md` says where their
//! numbers come from, as does `provenance` in each.

use crate::error::{Error, Message, Operation, Result};
use crate::fabric::Fabric;
use crate::json::nearest;

/// The fabric of a bake that names none.
pub const DEFAULT_FABRIC: &str = "cotton-jersey";

/// The fabric with the numbers of the paper (Kim, Oh, Wohn), for its tables and its figure.
pub const PAPER_FABRIC: &str = "kow-tshirt";

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
    ///
    /// ```
    /// assert!(crease_model::fabric::Fabric::preset_names().contains(&"denim"));
    /// ```
    pub fn preset_names() -> Vec<&'static str> {
        names()
    }

    /// The preset `name`.
    ///
    /// # Errors
    /// [`crate::error::Error::Input`] for an unknown name, with the nearest known one.
    pub fn preset(name: &str) -> Result<Self> {
        match text_of(name) {
            Some(text) => Self::parse(name, text),
            None => {
                let cure = match nearest(name, names()) {
                    Some(meant) => {
                        Message::from(format!("did you mean `{meant}`? `"))
                            + Operation::ListFabrics
                            + "` names them all"
                    }
                    None => format!("the presets are {}", names().join(", ")).into(),
                };
                Err(Error::input(
                    "fabric",
                    "",
                    format!("there is no preset {}", crate::json::quoted(name)),
                    cure,
                ))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::fabric::FabricMemory;
    use std::f64::consts::PI;

    fn presets() -> Vec<Fabric> {
        names().into_iter().map(|name| Fabric::preset(name).expect(name)).collect()
    }

    #[test]
    fn all_presets_are_read_named_and_plausible() {
        let presets = presets();
        assert!(presets.len() >= 14);
        for (fabric, name) in presets.iter().zip(names()) {
            assert_eq!(fabric.name, name);
            let bending_length = fabric.bending_length();
            assert!((0.01..=0.03).contains(&bending_length), "{name}: bending length {bending_length} m");
            assert!((0.03..=0.5).contains(&fabric.area_density()), "{name}");
            assert!((1e-4..=1.5e-3).contains(&fabric.thickness()), "{name}");
            assert!((1e-6..=1.1e-4).contains(&fabric.bend_warp()), "{name}");
            assert!((0.3..=0.6).contains(&fabric.friction), "{name}");
            assert!(fabric.shear() < fabric.stretch_weft(), "{name}: shears harder than it stretches");
            let ratio = fabric.bend_warp() / fabric.bend_weft();
            assert!((ratio - 1.48).abs() < 0.02, "{name}: warp over weft {ratio}");
            assert!(fabric.memory.critical_threshold() > fabric.memory.gradual_threshold(), "{name}");
        }
    }

    #[test]
    fn every_group_says_where_it_comes_from() {
        for fabric in presets() {
            let of = &fabric.provenance;
            for text in [&of.mass, &of.stretch, &of.shear, &of.bend, &of.damping, &of.friction, &of.memory] {
                assert!(text.len() > 20 && text != "not stated", "{}: {text}", fabric.name);
            }
        }
    }

    #[test]
    fn the_fabric_of_the_paper_remembers_as_it_says() {
        let memory = Fabric::preset(PAPER_FABRIC).expect("exists").memory;
        assert_eq!(memory, FabricMemory::default());
        assert_eq!((memory.gradual_duration_s, memory.critical_duration_s), (4.3, 1.0));
        assert!((memory.gradual_threshold() - 0.27 * PI / 2.0).abs() < 1e-15);
        assert!((memory.critical_threshold() - 0.85 * PI / 2.0).abs() < 1e-15);
    }

    #[test]
    fn an_unknown_preset_is_a_fault_with_the_nearest() {
        let message = Fabric::preset("demin").expect_err("there is none").to_string();
        assert!(message.contains("did you mean `denim`?"), "{message}");
        assert!(Fabric::preset("mail").expect_err("there is none").to_string().contains("cotton-jersey"));
    }
}
