//! Tables of reference numbers, which are not part of the repository (`CREASE_TEST_DATA`).

#[path = "../reference/external.rs"]
mod external;

use external::external;
use serde_json::Value;

fn text(name: &str) -> Option<String> {
    let file = external("reference")?.join(name);
    match std::fs::read_to_string(&file) {
        Ok(text) => Some(text),
        Err(_) => {
            println!("{name} is not there: only the constants in the test are checked");
            None
        }
    }
}

/// A JSON file of the reference folder, if it is there.
pub fn json(name: &str) -> Option<Value> {
    text(name).map(|text| serde_json::from_str(&text).expect("a reference file is valid JSON"))
}

/// A CSV file of the reference folder, if it is there: the cells of each row, without the header.
pub fn table(name: &str) -> Option<Vec<Vec<String>>> {
    let rows = |text: String| {
        let cells = |line: &str| line.split(',').map(|cell| cell.trim().to_owned()).collect();
        text.lines().skip(1).map(cells).collect()
    };
    text(name).map(rows)
}

/// Figures for a line of output, three digits each.
pub fn figures(values: &[f64]) -> String {
    let each: Vec<String> = values.iter().map(|v| format!("{v:.3e}")).collect();
    each.join(" ")
}
