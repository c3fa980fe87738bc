//! Tables of the reference folder, which lies beside the repository and is not part of it.

use serde_json::Value;
use std::path::Path;

fn text(name: &str) -> Option<String> {
    let file = Path::new(env!("CARGO_MANIFEST_DIR")).join("../shared/reference").join(name);
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
