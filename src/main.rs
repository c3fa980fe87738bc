//! The command-line tool: a thin user of the library. Only this side prints.

// Units are written [m], [s]: rustdoc would take each for a link.
#![allow(rustdoc::broken_intra_doc_links)]

mod cli;

fn main() -> std::process::ExitCode {
    cli::run(std::env::args_os()).into()
}
