//! A chart and the options it is made with.

use crate::{Figure, Table, draw};
use crease_model::error::Result;
use crease_model::fabric::{Fabric, PAPER_FABRIC};

/// Options of all charts.
#[derive(Debug, Clone, PartialEq)]
pub struct ChartOptions {
    /// Fabric of charts that show one.
    pub fabric: Fabric,
    /// Runs of every timed scene; medians are shown.
    pub runs: usize,
    /// Whether long scenes are run as well.
    pub full: bool,
}

impl ChartOptions {
    /// The default fabric, and five runs.
    ///
    /// # Errors
    /// None in practice: the default fabric is a preset.
    pub fn new() -> Result<Self> {
        Ok(Self { fabric: Fabric::preset(PAPER_FABRIC)?, runs: 5, full: false })
    }
}

/// Numbers and their picture.
#[derive(Debug, Clone, PartialEq)]
pub struct Chart {
    /// Name on the command line.
    pub name: &'static str,
    /// The numbers.
    pub table: Table,
    /// The picture.
    pub figure: Figure,
    /// Results and remarks for the reader, one sentence each.
    pub notes: Vec<String>,
}

impl Chart {
    /// Encodes the chart's files: extension and bytes of each.
    ///
    /// # Errors
    /// [`crease_model::error::Error::Input`] if the picture cannot be drawn.
    pub fn files(&self) -> Result<[(&'static str, Vec<u8>); 4]> {
        Ok([
            ("svg", draw::svg(&self.figure)?.into_bytes()),
            ("png", draw::png(&self.figure)?),
            ("csv", self.table.to_csv().into_bytes()),
            ("json", self.table.to_json(self.name, &self.notes).into_bytes()),
        ])
    }
}
