//! The command-line reference, `docs/reference/command-line.md`, as Markdown from the definition of the command line.

use clap::{Arg, Command};
use std::fmt::Write;

/// Returns the reference of `command` and its subcommands; the command must have been built. Hidden options and aliases
/// are left out.
pub fn markdown(command: &Command) -> String {
    let mut text = String::from(
        "# Command line\n\n\
         <!-- Generated: cargo run -- man --markdown > docs/reference/command-line.md -->\n",
    );
    let about = command.get_about().map(ToString::to_string).unwrap_or_default();
    // Writing to a string cannot fail.
    let _ = writeln!(text, "\n{about}\n");
    for sub in visible_subcommands(command) {
        let about = sub.get_about().map(ToString::to_string).unwrap_or_default();
        let name = sub.get_name();
        let _ = writeln!(text, "- [`{name}`](#crease-{name}){}: {about}", alias_note(sub));
    }
    if let Some(notes) = command.get_after_help() {
        let _ = writeln!(text, "\n```\n{}\n```", notes.to_string().trim_end());
    }
    for sub in visible_subcommands(command) {
        add_command(&mut text, sub, &["crease"]);
    }
    text
}

fn visible_subcommands(command: &Command) -> impl Iterator<Item = &Command> {
    command.get_subcommands().filter(|sub| sub.get_name() != "help" && !sub.is_hide_set())
}

fn alias_note(command: &Command) -> String {
    let aliases: Vec<String> = command.get_visible_aliases().map(|alias| format!("`{alias}`")).collect();
    if aliases.is_empty() { String::new() } else { format!(" (also {})", aliases.join(", ")) }
}

fn add_command(text: &mut String, command: &Command, parents: &[&str]) {
    let path = [parents, &[command.get_name()]].concat();
    let title = path.join(" ");
    let about = command.get_about().map(ToString::to_string).unwrap_or_default();
    let level = "#".repeat(path.len());
    let _ = writeln!(text, "\n{level} {title}\n\n{about}{}.", alias_note(command));
    let usage = command.clone().render_usage().to_string();
    let _ = writeln!(text, "\n```\n{}\n```", usage.trim_start_matches("Usage: ").trim());
    let arguments: Vec<&Arg> = command.get_arguments().filter(|a| is_documented(a)).collect();
    let mut groups: Vec<Option<&str>> = Vec::new();
    for argument in &arguments {
        if !groups.contains(&argument.get_help_heading()) {
            groups.push(argument.get_help_heading());
        }
    }
    for group in groups {
        if let Some(heading) = group {
            let _ = writeln!(text, "\n**{heading}**");
        }
        text.push_str("\n| argument | meaning |\n|---|---|\n");
        for argument in arguments.iter().filter(|argument| argument.get_help_heading() == group) {
            let _ = writeln!(text, "| {} | {} |", code(&signature(argument)), meaning(argument));
        }
    }
    if let Some(notes) = command.get_after_help() {
        let _ = writeln!(text, "\n```\n{}\n```", notes.to_string().trim_end());
    }
    for sub in visible_subcommands(command) {
        add_command(text, sub, &path);
    }
}

fn is_documented(argument: &Arg) -> bool {
    !argument.is_hide_set() && !["help", "version"].contains(&argument.get_id().as_str())
}

/// Returns the spelling of an argument: `-o, --output <OUT.glb>`.
fn signature(argument: &Arg) -> String {
    let names: Vec<String> = argument
        .get_short()
        .map(|short| format!("-{short}"))
        .into_iter()
        .chain(argument.get_long().map(|long| format!("--{long}")))
        .collect();
    let takes_value = argument.get_num_args().is_some_and(|range| range.takes_values());
    let values: Vec<String> = match argument.get_value_names() {
        Some(values) if takes_value => values.iter().map(ToString::to_string).collect(),
        _ => Vec::new(),
    };
    let optional = argument.get_num_args().is_some_and(|range| range.min_values() == 0);
    let value = match values.join(" ") {
        value if value.is_empty() => value,
        value if optional => format!("[=<{value}>]"),
        value if names.is_empty() => format!("<{value}>"),
        value => format!(" <{value}>"),
    };
    format!("{}{value}", names.join(", "))
}

/// Returns the help of an argument with its default and its possible values.
fn meaning(argument: &Arg) -> String {
    let help = argument.get_long_help().or(argument.get_help()).map(ToString::to_string).unwrap_or_default();
    let mut text = cell(&help);
    let defaults: Vec<String> =
        argument.get_default_values().iter().map(|value| value.to_string_lossy().into_owned()).collect();
    let is_flag = !argument.get_num_args().is_some_and(|range| range.takes_values());
    if !defaults.is_empty() && !is_flag {
        let _ = write!(text, " [default: {}]", defaults.join(", "));
    }
    if !argument.is_hide_possible_values_set() && !is_flag {
        for value in argument.get_possible_values().iter().filter(|value| !value.is_hide_set()) {
            let _ = write!(text, "<br>{}", code(value.get_name()));
            if let Some(help) = value.get_help() {
                let _ = write!(text, ": {}", cell(&help.to_string()));
            }
        }
    }
    text
}

/// Escapes text for a cell of a Markdown table.
fn cell(text: &str) -> String {
    text.replace('\n', " ").replace('|', "\\|").replace('<', "&lt;")
}

/// Formats text as code in a cell of a Markdown table.
fn code(text: &str) -> String {
    format!("`{}`", text.replace('|', "\\|"))
}
