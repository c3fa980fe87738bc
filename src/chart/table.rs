//! The numbers of a chart as CSV and JSON: `{"chart": NAME, "rows": [{column: cell, ...}, ...], "notes": [...]}`.
//!
//! Column names include the unit. Other programs read them (`docs/reference/formats/charts.md`): columns are added,
//! never renamed.

use serde_json::{Map, Value, json};

/// One cell.
#[derive(Debug, Clone, PartialEq)]
pub enum Cell {
    /// A number; non-finite ones are written as empty cells.
    Number(f64),
    /// A count.
    Count(u64),
    /// A text.
    Text(String),
    /// True or false.
    Flag(bool),
    /// An empty cell.
    None,
}

impl From<f64> for Cell {
    fn from(number: f64) -> Self {
        Self::Number(number)
    }
}

impl From<u64> for Cell {
    fn from(count: u64) -> Self {
        Self::Count(count)
    }
}

impl From<&str> for Cell {
    fn from(text: &str) -> Self {
        Self::Text(text.to_owned())
    }
}

impl From<bool> for Cell {
    fn from(flag: bool) -> Self {
        Self::Flag(flag)
    }
}

impl<T: Into<Cell>> From<Option<T>> for Cell {
    fn from(cell: Option<T>) -> Self {
        cell.map_or(Self::None, Into::into)
    }
}

/// Rows under named columns.
#[derive(Debug, Clone, PartialEq)]
pub struct Table {
    columns: &'static [&'static str],
    rows: Vec<Vec<Cell>>,
}

impl Table {
    /// A table without rows.
    pub fn new(columns: &'static [&'static str]) -> Self {
        Self { columns, rows: Vec::new() }
    }

    /// Adds a row: one cell per column; missing cells are empty.
    pub fn push<const N: usize>(&mut self, cells: [Cell; N]) {
        let mut row = Vec::from(cells);
        row.resize(self.columns.len(), Cell::None);
        self.rows.push(row);
    }

    /// Names of the columns.
    pub fn columns(&self) -> &'static [&'static str] {
        self.columns
    }

    /// Rows of cells.
    pub fn rows(&self) -> &[Vec<Cell>] {
        &self.rows
    }

    /// Number in `column` of `row`; `None` for other cells.
    pub fn number(&self, row: usize, column: &str) -> Option<f64> {
        let index = self.columns.iter().position(|c| *c == column)?;
        match self.rows.get(row)?.get(index)? {
            Cell::Number(number) => Some(*number),
            Cell::Count(count) => Some(*count as f64),
            _ => None,
        }
    }

    /// Formats the table as CSV with a header line.
    pub fn to_csv(&self) -> String {
        let quoted = |text: &str| match text.contains([',', '"', '\n']) {
            true => format!("\"{}\"", text.replace('"', "\"\"")),
            false => text.to_owned(),
        };
        let cell = |cell: &Cell| match cell {
            Cell::Number(number) if number.is_finite() => number.to_string(),
            Cell::Count(count) => count.to_string(),
            Cell::Text(text) => quoted(text),
            Cell::Flag(flag) => flag.to_string(),
            Cell::Number(_) | Cell::None => String::new(),
        };
        let mut text = self.columns.join(",") + "\n";
        for row in &self.rows {
            text += &row.iter().map(cell).collect::<Vec<_>>().join(",");
            text.push('\n');
        }
        text
    }

    /// Formats the table as JSON, with the name of the chart and its notes.
    pub fn to_json(&self, chart: &str, notes: &[String]) -> String {
        let value = |cell: &Cell| match cell {
            Cell::Number(number) => json!(number),
            Cell::Count(count) => json!(count),
            Cell::Text(text) => json!(text),
            Cell::Flag(flag) => json!(flag),
            Cell::None => Value::Null,
        };
        let row = |cells: &Vec<Cell>| -> Map<String, Value> {
            self.columns.iter().map(|c| (*c).to_owned()).zip(cells.iter().map(value)).collect()
        };
        let rows: Vec<_> = self.rows.iter().map(row).collect();
        format!("{:#}\n", json!({"chart": chart, "rows": rows, "notes": notes}))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn csv_and_json_have_the_same_content() {
        let mut table = Table::new(&["fabric", "angle_deg", "steps", "memory"]);
        table.push(["a, b".into(), 1.5.into(), 3u64.into(), true.into()]);
        table.push(["c".into(), f64::NAN.into()]);
        assert_eq!(table.to_csv(), "fabric,angle_deg,steps,memory\n\"a, b\",1.5,3,true\nc,,,\n");
        let json: Value = serde_json::from_str(&table.to_json("x", &[])).expect("is JSON");
        assert_eq!(json["chart"], "x");
        assert_eq!(json["rows"][0]["angle_deg"], 1.5);
        assert_eq!(json["rows"][1], json!({"fabric": "c", "angle_deg": null, "steps": null, "memory": null}));
        assert_eq!(table.number(0, "steps"), Some(3.0));
    }
}
