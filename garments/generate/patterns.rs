//! Sewing patterns as data. Lengths in metres, right halves only.
//!
//! A T-shirt with sleeves cut in one with the body, trousers with both legs cut in one, a handkerchief. Front and
//! back of the T-shirt differ only in the neck. The edge lengths are tuned to the numbers of welded points that the
//! tests require.

use crate::outline::{Border::Open, Border::Sewn, Run, arc, line};

/// A garment made of one panel, or of a front and a back sewn together.
pub struct Pattern {
    /// File name and node name.
    pub name: &'static str,
    /// Target edge length [m].
    pub edge_m: f64,
    /// Start of the right half, on the centre line [m].
    pub start: [f64; 2],
    /// Right half of the front.
    pub front: Vec<Run>,
    /// Right half of the back, for a sewn garment.
    pub back: Option<Vec<Run>>,
    /// Base colour, linear red green blue.
    pub colour: [f64; 3],
}

/// All patterns.
pub fn all() -> Vec<Pattern> {
    vec![tshirt("tshirt", 0.00831), tshirt("tshirt-draft", 0.0219), handkerchief(), trousers()]
}

/// The T-shirt with the edge length `edge_m` [m].
pub fn tshirt(name: &'static str, edge_m: f64) -> Pattern {
    let body = [
        line([0.268, 0.0], Open),                  // hem
        line([0.265, 0.425], Sewn),                // side
        arc([0.265, 0.455], [0.295, 0.447], Sewn), // armpit
        line([0.392, 0.419], Sewn),                // under the sleeve
        line([0.446, 0.600], Open),                // end of the sleeve
        line([0.085, 0.700], Sewn),                // shoulder
    ];
    let with_neck = |neck: Run| body.iter().copied().chain([neck]).collect();
    Pattern {
        name,
        edge_m,
        start: [0.0, 0.0],
        front: with_neck(arc([0.075, 0.605], [0.0, 0.605], Open)),
        back: Some(with_neck(arc([0.055, 0.672], [0.0, 0.672], Open))),
        colour: [0.35, 0.50, 0.65],
    }
}

fn trousers() -> Pattern {
    let outline = vec![
        arc([0.012, 0.735], [0.035, 0.670], Sewn), // crotch
        line([0.075, 0.0], Sewn),                  // inside of the leg
        line([0.275, 0.0], Open),                  // end of the leg
        line([0.262, 0.760], Sewn),                // outside of the leg
        arc([0.258, 0.900], [0.200, 1.000], Sewn), // hip
        line([0.0, 1.000], Open),                  // waist
    ];
    Pattern {
        name: "trousers",
        edge_m: 0.0130,
        start: [0.0, 0.735],
        front: outline.clone(),
        back: Some(outline),
        colour: [0.12, 0.15, 0.24],
    }
}

fn handkerchief() -> Pattern {
    Pattern {
        name: "handkerchief",
        edge_m: 0.00868,
        start: [0.0, 0.0],
        front: vec![line([0.2, 0.0], Open), line([0.2, 0.4], Open), line([0.0, 0.4], Open)],
        back: None,
        colour: [0.80, 0.76, 0.70],
    }
}
