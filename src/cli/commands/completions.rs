//! `crease completions` and `crease man`: shell completions and manual, generated from the definition that the command
//! line is parsed by.

use crate::commands::reference;
use crate::files::input::name_of;
use crate::files::output::{Outputs, commit};
use crate::runtime::console;
use clap::Command;
use clap_complete::Shell;
use crease_model::error::{Error, Result};
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease completions bash > ~/.local/share/bash-completion/completions/crease
  crease completions zsh  > ~/.zfunc/_crease
  crease completions fish > ~/.config/fish/completions/crease.fish")]
pub struct Arguments {
    /// Shell
    #[arg(value_enum)]
    shell: Shell,
}

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease man | man -l -
  crease man --to ~/.local/share/man/man1")]
pub struct ManArguments {
    /// Folder for crease.1 and one page per command [default: crease.1 on standard output]
    #[arg(long, value_name = "DIR")]
    to: Option<PathBuf>,
    /// Print the reference of all commands as Markdown
    #[arg(long, hide = true, conflicts_with = "to")]
    markdown: bool,
}

/// Prints the completions of `command`.
pub fn run(arguments: Arguments, mut command: Command) -> Result<()> {
    let mut text = Vec::new();
    clap_complete::generate(arguments.shell, &mut command, "crease", &mut text);
    console::data(&text)
}

/// Prints or writes the manual of `command`.
pub fn run_man(arguments: ManArguments, mut command: Command) -> Result<()> {
    command.build();
    if arguments.markdown {
        return console::data(&reference::markdown(&command));
    }
    let Some(folder) = arguments.to else { return console::data(&page(command)) };
    if !folder.is_dir() {
        return Err(Error::input(name_of(&folder), "", "there is no such folder", "make it first"));
    }
    let mut outputs = Outputs::new([]);
    add_pages(&mut outputs, &folder, &command)?;
    commit(outputs)
}

fn add_pages(outputs: &mut Outputs, folder: &Path, command: &Command) -> Result<()> {
    let name = command.get_display_name().unwrap_or_else(|| command.get_name()).to_owned();
    outputs.add(&folder.join(format!("{name}.1")), page(command.clone()).as_bytes())?;
    for sub in command.get_subcommands().filter(|sub| sub.get_name() != "help") {
        add_pages(outputs, folder, sub)?;
    }
    Ok(())
}

fn page(command: Command) -> String {
    let mut text = Vec::new();
    // Writing to memory does not fail.
    let _ = clap_mangen::Man::new(command).render(&mut text);
    String::from_utf8_lossy(&text).into_owned()
}
