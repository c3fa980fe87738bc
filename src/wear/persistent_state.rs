//! State of a garment that outlives an action: its orientation, the frame of fractions, folds, and what holds it.

use crate::wear::layout::roll_map::RollRecord;
use crease_geometry::math::{Mat3, PlaneStretch, Vec3, bounds};
use crease_model::body::PosedBody;
use crease_solver::sim::Loads;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// The plane that fractions of the bounding box refer to.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct GarmentFrame {
    /// The point (0, 0), lower left [m].
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    pub origin: Vec3,
    /// Vector from (0, 0) to (1, 0) [m].
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    pub right: Vec3,
    /// Vector from (0, 0) to (0, 1) [m].
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    pub upward: Vec3,
}

impl GarmentFrame {
    /// Position of a fraction [m].
    pub fn position(&self, fraction: [f64; 2]) -> Vec3 {
        self.origin + self.right * fraction[0] + self.upward * fraction[1]
    }

    /// Fraction of a position [m].
    pub fn fraction(&self, position: &Vec3) -> [f64; 2] {
        let arm = position - self.origin;
        [&self.right, &self.upward].map(|axis| arm.dot(axis) / axis.norm_squared().max(f64::MIN_POSITIVE))
    }

    /// Frame of a hanging garment with points `x` [m]: x to the right, y upward.
    pub fn hanging(x: &[Vec3]) -> Self {
        let (low, high) = bounds(x);
        Self {
            origin: Vec3::new(low.x, low.y, 0.5 * (low.z + high.z)),
            right: Vec3::new(high.x - low.x, 0.0, 0.0),
            upward: Vec3::new(0.0, high.y - low.y, 0.0),
        }
    }

    /// Frame of a garment on the ground with points `x` [m]: x to the right, -z upward.
    pub fn lying(x: &[Vec3]) -> Self {
        let (low, high) = bounds(x);
        Self {
            origin: Vec3::new(low.x, 0.0, high.z),
            right: Vec3::new(high.x - low.x, 0.0, 0.0),
            upward: Vec3::new(0.0, 0.0, low.z - high.z),
        }
    }
}

/// A fold that has been made and not opened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct FoldRecord {
    /// Points of the flap.
    pub flap: Vec<u32>,
    /// A point of the fold line on the ground [m].
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    pub origin: Vec3,
    /// Unit vector along the line.
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    pub along: Vec3,
    /// Unit vector from the line to where the flap lay before.
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    pub outward: Vec3,
    /// Angle by which the flap was turned [rad].
    pub angle: f64,
    /// Points that stay where they are while cloth lies folded, one flag per point; empty for none.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub panel: Vec<bool>,
}

/// A fold or a roll that has been made and not opened.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum TurnRecord {
    /// One side was turned over.
    Fold(FoldRecord),
    /// All of it was rolled up.
    Roll(RollRecord),
}

/// State that outlives an action.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PersistentState {
    /// Rotation of the garment as a whole, from directions of its file to present ones.
    #[serde(with = "crease_geometry::math::serde_vec::matrix")]
    pub orientation: Mat3,
    /// Frame that fractions refer to, once the garment lies or hangs.
    pub frame: Option<GarmentFrame>,
    /// Folds and rolls that are not opened yet, oldest first.
    pub turns: Vec<TurnRecord>,
    /// Height of the ground [m], where there is one.
    pub ground: Option<f64>,
    /// Per hinge: by how much laying the garment down bent it [rad]; empty for a garment that does not lie. It is not remembered.
    pub laid_bend: Vec<f64>,
    /// Per triangle: stretch from its shape in the file to its rest shape; empty where that is the shape in the file. A garment that was
    /// laid out has the rest shape of its cut.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub cut: Vec<PlaneStretch>,
    /// Loads of the last action that act until they are released.
    pub held_loads: Option<Loads>,
    /// The body the garment is worn on, in its present pose.
    // A checkpoint stores the pose separately: the body itself is the caller's.
    #[serde(skip)]
    pub body: Option<PosedBody>,
}

impl Default for PersistentState {
    fn default() -> Self {
        Self {
            orientation: Mat3::identity(),
            frame: None,
            turns: Vec::new(),
            ground: None,
            laid_bend: Vec::new(),
            cut: Vec::new(),
            held_loads: None,
            body: None,
        }
    }
}

impl PersistentState {
    /// The frame, if the garment lies on the ground.
    pub fn ground_frame(&self) -> Option<GarmentFrame> {
        self.ground.and(self.frame)
    }

    /// The frame, if the garment lies on the ground and is not rolled up.
    pub fn open_frame(&self) -> Option<GarmentFrame> {
        let is_rolled = matches!(self.turns.last(), Some(TurnRecord::Roll(_)));
        self.ground_frame().filter(|_| !is_rolled)
    }

    /// Angles of the hinges [rad] without what laying the garment down bent: of a bend beyond `source` [rad] in the same direction
    /// only what goes beyond that counts.
    pub fn remembered_angle<'a>(&self, angle: &'a [f64], source: &[f64]) -> Cow<'a, [f64]> {
        if self.laid_bend.is_empty() {
            return Cow::Borrowed(angle);
        }
        let bends = angle.iter().zip(source).zip(&self.laid_bend);
        bends.map(|((a, s), laid)| a - (a - s).clamp(laid.min(0.0), laid.max(0.0))).collect()
    }

    /// Loads while no action changes anything: gravity, the ground, the body and whatever has not been released.
    pub fn idle_loads(&self) -> Loads {
        let held = self.held_loads.clone().unwrap_or_else(|| Loads::gravity_only(self.ground));
        Loads { body: self.body.clone(), ..held }
    }

    /// Idle loads of cloth that lies folded: its panels stay where they are.
    pub fn folded_loads(&self) -> Loads {
        let idle = self.idle_loads();
        if idle.fixed.is_empty() { Loads { fixed: self.panel(), ..idle } } else { idle }
    }

    /// Lets the panels of all folds move again.
    pub fn free_panels(&mut self) {
        for turn in &mut self.turns {
            if let TurnRecord::Fold(fold) = turn {
                fold.panel.clear();
            }
        }
    }

    /// Points that stay where they are in all folds, one flag per point; empty for none.
    fn panel(&self) -> Vec<bool> {
        let panel_of = |turn: &TurnRecord| match turn {
            TurnRecord::Fold(fold) => fold.panel.clone(),
            TurnRecord::Roll(_) => Vec::new(),
        };
        let both = |a: Vec<bool>, b: Vec<bool>| a.into_iter().zip(b).map(|(a, b)| a && b).collect();
        self.turns.iter().map(panel_of).reduce(both).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_laying_down_bent_is_not_remembered() {
        let state = PersistentState { laid_bend: vec![2.0, -2.0, 0.1], ..PersistentState::default() };
        let source = [0.5, 0.5, 0.5];
        // As laid; opened; folded the other way; folded beyond.
        assert_eq!(*state.remembered_angle(&[2.5, -1.5, 0.6], &source), [0.5, 0.5, 0.5]);
        assert_eq!(*state.remembered_angle(&[0.5, 0.5, 0.5], &source), [0.5, 0.5, 0.5]);
        assert_eq!(*state.remembered_angle(&[-1.0, 2.0, 0.0], &source), [-1.0, 2.0, 0.0]);
        assert_eq!(*state.remembered_angle(&[3.0, -2.0, 3.6], &source), [1.0, 0.0, 3.5]);
    }

    #[test]
    fn what_is_a_panel_of_every_fold_stays_until_one_is_opened() {
        let fold = |panel: Vec<bool>| {
            TurnRecord::Fold(FoldRecord {
                flap: Vec::new(),
                origin: Vec3::zeros(),
                along: Vec3::z(),
                outward: Vec3::x(),
                angle: 3.1,
                panel,
            })
        };
        let turns = vec![fold(vec![true, true, false]), fold(vec![true, false, true])];
        let mut folded = PersistentState { turns, ground: Some(0.0), ..PersistentState::default() };
        assert_eq!(folded.folded_loads().fixed, [true, false, false]);
        assert!(folded.idle_loads().fixed.is_empty());
        // A fold that is held by springs has none, and with it nothing is fixed.
        let mut held = folded.clone();
        held.turns.push(fold(Vec::new()));
        folded.free_panels();
        assert!(held.folded_loads().fixed.is_empty() && folded.folded_loads().fixed.is_empty());
    }
}
