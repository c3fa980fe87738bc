//! The wear scripts that are part of the program: one file each in `garments/wear/`, one line each here.

use crate::wear::WearScript;
use crease_model::error::{Error, Result};
use crease_model::json::nearest;

macro_rules! preset_list {
    ($($name:literal,)*) => {
        /// Name and text of each, in the order they are listed to people.
        const PRESETS: &[(&str, &str)] =
            &[$(($name, include_str!(concat!("../../../garments/wear/", $name, ".json"))),)*];
    };
}

preset_list! {
    "fold-thrice",
    "press-crease",
    "crumple",
    "iron",
    "pack",
    "roll",
    "wash",
    "hang-overnight",
    "trouser-crease",
    "elbow-ten-bends",
    "sit-down",
}

impl WearScript {
    /// Names of the scripts that are part of the program, in list order.
    ///
    /// ```
    /// assert!(crease::WearScript::preset_names().any(|name| name == "fold-thrice"));
    /// ```
    pub fn preset_names() -> impl Iterator<Item = &'static str> {
        PRESETS.iter().map(|(name, _)| *name)
    }

    /// Text of the script `name`, as its file has it.
    pub fn preset_text(name: &str) -> Option<&'static str> {
        PRESETS.iter().find(|(own, _)| *own == name).map(|(_, text)| *text)
    }

    /// The script `name`.
    ///
    /// # Errors
    /// [`crease_model::error::Error::Input`] for an unknown name, with the nearest known one.
    pub fn preset(name: &str) -> Result<Self> {
        if let Some(text) = Self::preset_text(name) {
            return Self::parse(name, text);
        }
        let help = match nearest(name, Self::preset_names().collect::<Vec<_>>()) {
            Some(meant) => format!("did you mean `{meant}`?"),
            None => format!("the scripts are {}", Self::preset_names().collect::<Vec<_>>().join(", ")),
        };
        let message = format!("there is no script {}", crease_model::json::quoted(name));
        Err(Error::input("wear", "", message, help))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_presets_are_read_and_all_files_are_presets() {
        for name in WearScript::preset_names() {
            assert!(!WearScript::preset(name).expect(name).actions.is_empty());
        }
        let folder = concat!(env!("CARGO_MANIFEST_DIR"), "/garments/wear");
        let files = std::fs::read_dir(folder).expect("a folder").map(|file| file.expect("a file").path());
        let scripts = files.filter(|path| path.extension().is_some_and(|ending| ending == "json"));
        assert_eq!(scripts.count(), PRESETS.len());
        let message = WearScript::preset("fold-trice").expect_err("there is none").to_string();
        assert!(message.contains("did you mean `fold-thrice`?"), "{message}");
    }
}
