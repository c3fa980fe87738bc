//! The command-line tool: a thin user of the library. Only this side prints.

// Units are written [m], [s]: rustdoc would take each for a link.
#![allow(rustdoc::broken_intra_doc_links)]

fn main() -> std::process::ExitCode {
    crease_cli::run(std::env::args_os()).into()
}
