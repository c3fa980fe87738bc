//! Values and groups of options that several commands share.

use clap::Args;
use crease::garment::UpAxis;
use std::path::{Path, PathBuf};

/// How the coordinates of a mesh file are to be read.
#[derive(Debug, Clone, Args)]
pub struct MeshReading {
    /// Unit of the mesh file: m, dm, cm, mm, in, or its length in metres [default: told from the format and size]
    #[arg(long, value_name = "UNIT", value_parser = unit)]
    pub unit: Option<Metres>,
    /// Axis of the mesh file that points up: y or z [default: told from the format]
    #[arg(long, value_name = "AXIS", value_parser = up)]
    pub up: Option<UpAxis>,
    /// Node, mesh or group that is the garment [default: all of the file]
    #[arg(long, value_name = "NODE|GROUP")]
    pub garment: Option<String>,
}

/// A length [m].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Metres(pub f64);

/// A unit of length by its name or in metres.
pub fn unit(text: &str) -> Result<Metres, String> {
    let metres = match text {
        "m" => 1.0,
        "dm" => 0.1,
        "cm" => 0.01,
        "mm" => 0.001,
        "in" => 0.0254,
        number => {
            positive(number).map_err(|_| "expected m, dm, cm, mm, in, or a number of metres above 0")?
        }
    };
    Ok(Metres(metres))
}

fn up(text: &str) -> Result<UpAxis, String> {
    match text {
        "y" | "Y" => Ok(UpAxis::Y),
        "z" | "Z" => Ok(UpAxis::Z),
        _ => Err("expected y or z".to_owned()),
    }
}

/// A finite number above 0.
pub fn positive(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if number > 0.0 && number.is_finite() => Ok(number),
        _ => Err("expected a number above 0".to_owned()),
    }
}

/// A time of no more than a day [s], 0 included.
pub fn seconds(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(number) if (0.0..=86_400.0).contains(&number) => Ok(number),
        _ => Err("expected a number of seconds from 0 to 86400".to_owned()),
    }
}

/// A path that ends in `.glb`.
pub fn glb_path(text: &str) -> Result<PathBuf, String> {
    path_ending(text, "glb")
}

/// A path that ends in `.png`.
pub fn png_path(text: &str) -> Result<PathBuf, String> {
    path_ending(text, "png")
}

/// A path that ends in `.html`.
pub fn html_path(text: &str) -> Result<PathBuf, String> {
    path_ending(text, "html")
}

fn path_ending(text: &str, ending: &str) -> Result<PathBuf, String> {
    let path = Path::new(text);
    match path.extension() {
        Some(own) if own.eq_ignore_ascii_case(ending) => Ok(path.to_owned()),
        _ => Err(format!("expected a file name that ends in .{ending}")),
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
    fn endings_are_checked() {
        assert!(glb_path("a/b.GLB").is_ok());
        for text in ["a", "a.gltf", ".glb", ""] {
            assert!(glb_path(text).is_err(), "{text}");
        }
    }
}
