//! Groups of command-line arguments that several commands have in common, and parsers of their values.

pub mod apply;
pub mod body;
pub mod color_by;
pub mod export;
pub mod mesh;
pub mod refine;
pub mod run;
pub mod values;
