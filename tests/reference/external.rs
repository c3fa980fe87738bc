//! Test data that is not part of the repository: meshes of others and whole tables of reference numbers.

use std::path::PathBuf;

/// The folder `name` of the folder that the environment variable `CREASE_TEST_DATA` names, or `None` where it is not there.
/// Tests that need it print that they were skipped.
pub fn external(name: &str) -> Option<PathBuf> {
    let data = std::env::var_os("CREASE_TEST_DATA").filter(|path| !path.is_empty());
    let folder = data.map(|path| PathBuf::from(path).join(name)).filter(|path| path.is_dir());
    if folder.is_none() {
        println!("skipped: {name} is not in the folder that CREASE_TEST_DATA names");
    }
    folder
}
