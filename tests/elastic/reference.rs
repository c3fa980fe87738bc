//! Tables of reference numbers, which are not part of the repository (`CREASE_TEST_DATA`).

#[path = "../reference/external.rs"]
mod external;

use external::external;
use serde_json::Value;

fn text(name: &str) -> String {
    std::fs::read_to_string(external(&format!("reference/{name}"))).expect(name)
}

/// A JSON file of the reference folder.
pub fn json(name: &str) -> Value {
    serde_json::from_str(&text(name)).expect("a reference file is valid JSON")
}

/// A CSV file of the reference folder: the cells of each row, without the header.
pub fn table(name: &str) -> Vec<Vec<String>> {
    let cells = |line: &str| line.split(',').map(|cell| cell.trim().to_owned()).collect();
    text(name).lines().skip(1).map(cells).collect()
}

/// Figures for a line of output, three digits each.
pub fn figures(values: &[f64]) -> String {
    let each: Vec<String> = values.iter().map(|v| format!("{v:.3e}")).collect();
    each.join(" ")
}
