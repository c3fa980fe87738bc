//! The command-line tool: a thin user of the library. Only this side prints.

fn main() -> std::process::ExitCode {
    crease_cli::run(std::env::args_os()).into()
}
