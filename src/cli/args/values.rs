//! Parsers of option values.

use crate::files::input::STANDARD_STREAM;
use clap::builder::{PossibleValue, PossibleValuesParser, TypedValueParser};
use crease_io::unit_length;
use std::num::NonZeroUsize;
use std::path::{Path, PathBuf};

/// A value of an option: its name with hidden aliases after it, `|` between them; what it stands for; and its help, if any.
pub type Choice<T> = (&'static str, T, &'static str);

/// Returns the parser of an option that takes one of `choices`.
pub fn choice<T: Copy + Send + Sync + 'static>(
    choices: &'static [Choice<T>],
) -> impl TypedValueParser<Value = T> {
    let value = |(names, _, help): &Choice<T>| {
        let mut names = names.split('|');
        let value = PossibleValue::new(names.next().unwrap_or_default()).aliases(names);
        if help.is_empty() { value } else { value.help(*help) }
    };
    PossibleValuesParser::new(choices.iter().map(value)).try_map(|name| {
        let chosen = choices.iter().find(|(names, _, _)| names.split('|').any(|own| own == name));
        chosen.map(|(_, value, _)| *value).ok_or("no such value")
    })
}

/// A length [m].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Metres(pub f64);

/// Parses a unit of length: a name, or its length in metres.
pub fn unit(text: &str) -> Result<Metres, String> {
    unit_length(text)
        .map(Metres)
        .ok_or("expected m, dm, cm, mm, in, or a number of metres above 0".to_owned())
}

/// Parses a number of threads or jobs, of at least 1.
pub fn count(text: &str) -> Result<NonZeroUsize, String> {
    text.parse()
        .map_err(|_| "expected a whole number of at least 1; leave the option out for the default".to_owned())
}

/// Parses a finite number above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        _ => Err("expected a number above 0".to_owned()),
    }
}

/// Parses a number of at least 0.
pub fn not_negative(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number >= 0.0 && number.is_finite() => Ok(number),
        _ => Err("expected a number of at least 0".to_owned()),
    }
}

/// Parses a time from 0 to one day [s].
pub fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if (0.0..=86_400.0).contains(&number) => Ok(number),
        _ => Err("expected a number of seconds from 0 to 86400".to_owned()),
    }
}

/// Parses a path that ends in `.glb`, or `-`.
pub fn glb_path(text: &str) -> Result<PathBuf, String> {
    output_path(text, "glb")
}

/// Parses a path that ends in `.png`, or `-`.
pub fn png_path(text: &str) -> Result<PathBuf, String> {
    output_path(text, "png")
}

/// Parses a path that ends in `.html`, or `-`.
pub fn html_path(text: &str) -> Result<PathBuf, String> {
    output_path(text, "html")
}

/// Parses the path of an output: a name with `extension`, or `-`, the standard output.
fn output_path(text: &str, extension: &str) -> Result<PathBuf, String> {
    let path = Path::new(text);
    match path.extension() {
        Some(own) if own.eq_ignore_ascii_case(extension) => Ok(path.to_owned()),
        None if text == STANDARD_STREAM => Ok(path.to_owned()),
        _ => Err(format!("expected a file name that ends in .{extension}, or - for the standard output")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn units_are_lengths_in_metres() {
        for (text, metres) in
            [("m", 1.0), ("dm", 0.1), ("cm", 0.01), ("mm", 0.001), ("in", 0.0254), ("0.9144", 0.9144)]
        {
            assert_eq!(unit(text), Ok(Metres(metres)));
        }
        for text in ["", "0", "-1", "nan", "inf", "feet", "1e400"] {
            assert!(unit(text).is_err(), "{text}");
        }
    }

    #[test]
    fn extensions_are_checked() {
        assert!(glb_path("a/b.GLB").is_ok() && glb_path("-").is_ok());
        for text in ["a", "a.gltf", ".glb", ""] {
            assert!(glb_path(text).is_err(), "{text}");
        }
    }
}
