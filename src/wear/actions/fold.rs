//! `fold`: one side of a line is turned over, as hands fold cloth on a table.

use super::{Misfit, WearAction};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Turn one side of a line over the rest, and hold it there. Folds stack: all layers that lie there go along.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Fold {
    /// Two points of the line, [x, y] in fractions 0..1 of the bounding box. The line goes on beyond them.
    pub line: [Fraction2; 2],
    /// Which side of the line is turned over.
    pub side: Side,
    /// How far it is turned [degrees]: 180 lays it flat on the rest. Default 180.
    #[serde(rename = "angle", default = "angle_deg")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 180))]
    pub angle_deg: f64,
    /// How long turning takes [s]. Default 2.
    #[serde(rename = "over", default = "over_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 3600))]
    pub over_s: f64,
    /// How long it is held afterwards [s]. Default 0.
    #[serde(rename = "hold", default)]
    #[schemars(range(min = 0, max = 86400))]
    pub hold_s: f64,
}

/// [x, y] in fractions 0..1 of the garment's bounding box as it lies or hangs, x to the right, y upward.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(transparent)]
pub struct Fraction2(#[schemars(inner(range(min = -10, max = 10)))] pub [f64; 2]);

impl Fraction2 {
    /// From the left edge, in widths.
    pub fn x(self) -> f64 {
        self.0[0]
    }

    /// From the lower edge, in heights.
    pub fn y(self) -> f64 {
        self.0[1]
    }
}

/// A side of a line, as seen from above with the garment's upper edge away from the viewer.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Side {
    /// Where x is smaller than on the line.
    Left,
    /// Where x is larger than on the line.
    Right,
    /// Where y is larger than on the line.
    Upper,
    /// Where y is smaller than on the line.
    Lower,
}

fn angle_deg() -> f64 {
    180.0
}

fn over_s() -> f64 {
    2.0
}

impl Fold {
    /// Whether a point, in fractions, is on the side that is turned over.
    pub fn turns(&self, point: Fraction2) -> bool {
        let [a, b] = self.line;
        let (dx, dy) = (b.x() - a.x(), b.y() - a.y());
        // Positive on the left of the direction a -> b.
        let left_of_direction = dx * (point.y() - a.y()) - dy * (point.x() - a.x());
        match self.side {
            Side::Left => left_of_direction * dy > 0.0,
            Side::Right => left_of_direction * dy < 0.0,
            Side::Upper => left_of_direction * dx > 0.0,
            Side::Lower => left_of_direction * dx < 0.0,
        }
    }
}

impl WearAction for Fold {
    fn duration_s(&self) -> f64 {
        self.over_s + self.hold_s
    }

    fn misfits(&self) -> Vec<Misfit> {
        let [a, b] = self.line;
        let (dx, dy) = ((b.x() - a.x()).abs(), (b.y() - a.y()).abs());
        // A line shorter than a millionth of the garment has no direction worth trusting.
        const LEAST: f64 = 1e-6;
        if dx.max(dy) < LEAST {
            let what = "the two points of the line are the same: it has no direction";
            return vec![Misfit::new("line", what, "give two points apart from each other")];
        }
        match self.side {
            Side::Left | Side::Right if dy < LEAST => {
                vec![Misfit::new(
                    "side",
                    "a level line has no left and no right side",
                    "use `upper` or `lower`",
                )]
            }
            Side::Upper | Side::Lower if dx < LEAST => {
                vec![Misfit::new(
                    "side",
                    "an upright line has no upper and no lower side",
                    "use `left` or `right`",
                )]
            }
            _ => Vec::new(),
        }
    }

    fn example() -> Self {
        Self {
            line: [Fraction2([0.3, 0.0]), Fraction2([0.35, 1.0])],
            side: Side::Left,
            angle_deg: 170.0,
            over_s: 2.5,
            hold_s: 5.0,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sides_do_not_depend_on_the_direction_of_the_line() {
        for (side, inside, outside) in [
            (Side::Left, [0.1, 0.5], [0.9, 0.5]),
            (Side::Right, [0.9, 0.5], [0.1, 0.5]),
            (Side::Upper, [0.5, 0.9], [0.5, 0.1]),
            (Side::Lower, [0.5, 0.1], [0.5, 0.9]),
        ] {
            for line in [[[0.4, 0.3], [0.6, 0.7]], [[0.4, 0.7], [0.6, 0.3]]] {
                let forth = Fold { line: line.map(Fraction2), side, ..Fold::example() };
                let back = Fold { line: [forth.line[1], forth.line[0]], ..forth.clone() };
                for fold in [forth, back] {
                    assert!(fold.turns(Fraction2(inside)), "{fold:?}");
                    assert!(!fold.turns(Fraction2(outside)), "{fold:?}");
                }
            }
        }
    }
}
