//! Test data that is not part of the repository: meshes of others and whole tables of reference numbers.

use std::path::PathBuf;

/// The file or folder `name` of the folder that the environment variable `CREASE_TEST_DATA` names. A test that calls it
/// has the attribute `needs_data`, and fails if the data is missing all the same.
pub fn external(name: &str) -> PathBuf {
    let data = std::env::var_os("CREASE_TEST_DATA").expect("CREASE_TEST_DATA names a folder of data");
    let path = PathBuf::from(data).join(name);
    assert!(path.exists(), "{name} is not in the folder that CREASE_TEST_DATA names");
    path
}
