//! Options of commands that produce a worn garment.

use crate::args::values::count;
use std::num::NonZeroUsize;

/// Threads and output of a run.
#[derive(Debug, Clone, clap::Args)]
pub struct RunArgs {
    /// Worker threads [default: all cores]. Results are bit-identical for any value.
    #[arg(long, value_name = "N", value_parser = count)]
    pub threads: Option<NonZeroUsize>,
    /// Print the report on standard output, and progress as JSON lines on standard error
    #[arg(long)]
    pub json: bool,
    /// Print errors only
    #[arg(long)]
    pub quiet: bool,
}

impl RunArgs {
    /// Whether messages for people are printed.
    pub fn is_verbose(&self) -> bool {
        !self.quiet && !self.json
    }
}
