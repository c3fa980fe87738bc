//! Ready memories: sidecars that are part of the program, files of `garments/memories` of the garments that are part of it, too.

use crease_io::{Sidecar, read_sidecar};
use crease_model::error::{Error, Result};
use crease_model::json::{nearest, quoted};

macro_rules! memory_list {
    ($($name:literal,)*) => {
        /// Name and gzip file of each, in the order they are listed to people.
        const MEMORIES: &[(&str, &[u8])] = &[
            $(($name, include_bytes!(concat!("../../garments/memories/", $name, ".crease.json.gz"))),)*
        ];
    };
}

memory_list! {
    "fold-thrice",
    "crumple",
    "elbow",
}

/// Names of the memories that are part of the program, in list order.
///
/// ```
/// assert!(crease::format::ready_memory_names().any(|name| name == "fold-thrice"));
/// ```
pub fn ready_memory_names() -> impl Iterator<Item = &'static str> {
    MEMORIES.iter().map(|(name, _)| *name)
}

/// The memory `name`.
///
/// # Errors
/// [`Error::Input`] for an unknown name, with the nearest known one.
pub fn ready_memory(name: &str) -> Result<Sidecar> {
    if let Some((_, bytes)) = MEMORIES.iter().find(|(own, _)| *own == name) {
        return read_sidecar(name, bytes);
    }
    let help = match nearest(name, ready_memory_names()) {
        Some(meant) => format!("did you mean `{meant}`?"),
        None => format!("the memories are {}", ready_memory_names().collect::<Vec<_>>().join(", ")),
    };
    Err(Error::input("memory", "", format!("there is no memory {}", quoted(name)), help))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_memories_are_read_and_unknown_ones_are_said() {
        for name in ready_memory_names() {
            let sidecar = ready_memory(name).expect(name);
            assert!(sidecar.simulated.is_some(), "{name}: folds are transferred from the simulated mesh");
        }
        let message = |name| ready_memory(name).expect_err("there is none").to_string();
        assert!(message("elbwo").contains("did you mean `elbow`?"));
        assert!(message("").contains("the memories are fold-thrice, "));
    }
}
