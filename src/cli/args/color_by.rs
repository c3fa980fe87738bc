//! `--show`: quantity that colours a picture.

use clap::ValueEnum;
use crease::internal::report::ColorBy;

/// Values of `--show`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub enum ColorByArg {
    /// Shape only, in one colour
    Shape,
    /// Change of the rest angle of the hinges
    #[value(alias = "rest-angle")]
    RestAngleChange,
    /// Magnitude of the curvature
    Curvature,
    /// Stiffness ratio
    Stiffness,
    /// Displacement from the source shape
    Displacement,
    /// Change of the rest lengths
    Stretch,
    /// Confidence of a transfer
    Confidence,
}

impl From<ColorByArg> for ColorBy {
    fn from(argument: ColorByArg) -> Self {
        match argument {
            ColorByArg::Shape => Self::Shape,
            ColorByArg::RestAngleChange => Self::RestAngleChange,
            ColorByArg::Curvature => Self::Curvature,
            ColorByArg::Stiffness => Self::Stiffness,
            ColorByArg::Displacement => Self::Displacement,
            ColorByArg::Stretch => Self::Stretch,
            ColorByArg::Confidence => Self::Confidence,
        }
    }
}
