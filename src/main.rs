//! The command-line tool: a thin user of the library. Only this side prints.

mod cli;

fn main() -> std::process::ExitCode {
    cli::run()
}
