//! `--show`: quantity that colours a picture.

use crate::args::values::Choice;
use crease::internal::report::ColorBy;

/// Values of `--show`.
pub const COLOR_BY: [Choice<ColorBy>; 7] = [
    ("shape", ColorBy::Shape, "Shape only, in one colour"),
    ("rest-angle-change|rest-angle", ColorBy::RestAngleChange, "Change of the rest angle of the hinges"),
    ("curvature", ColorBy::Curvature, "Magnitude of the curvature"),
    ("stiffness", ColorBy::Stiffness, "Stiffness ratio"),
    ("displacement", ColorBy::Displacement, "Displacement from the source shape"),
    ("stretch", ColorBy::Stretch, "Change of the rest lengths"),
    ("confidence", ColorBy::Confidence, "Confidence of a transfer"),
];
