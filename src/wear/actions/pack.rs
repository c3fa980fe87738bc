//! `pack`: the lying garment is folded to a size and lies under a weight for hours, as in a suitcase or a drawer, or is folded to a
//! width and rolled up.
//!
//! It consists of `fold` and `press`, or of `fold` and `roll`. Long holds take few steps (`docs/adr/0018-steps-of-a-hold.md`).

use crate::wear::action_runner::{ActionContext, ActionStart};
use crate::wear::actions::{Fold, FoldSide, Press, Roll};
use crate::wear::fraction::Fraction2;
use crate::wear::persistent_state::PersistentState;
use crate::wear::script::action_list::Action;
use crate::wear::wear_action::{FieldError, WearAction};
use crease_model::error::Result;
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};

/// Fold the lying garment to a size and leave it under a weight, or roll it up. `unfold` opens it again.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
pub struct Pack {
    /// Whether it is folded to its size, or to its width and then rolled up from below. Default `fold`.
    #[serde(default)]
    pub how: Packing,
    /// Width and height to which it is folded, in fractions of the bounding box; of a roll only the width counts. Default [0.4,
    /// 0.5]: both sides in, then once across.
    #[serde(default = "default_to")]
    #[schemars(inner(range(min = 0.1, max = 1)))]
    pub to: [f64; 2],
    /// Pressure of what lies on it [Pa]. Default 500, a full suitcase. A roll has none: its band holds it.
    #[serde(rename = "pressure", default, skip_serializing_if = "Option::is_none")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 1_000_000))]
    pub pressure_pa: Option<f64>,
    /// Duration of each fold [s], half of that of rolling up. Default 2.
    #[serde(rename = "over", default = "default_over_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 3600))]
    pub over_s: f64,
    /// Time under the weight, or rolled up [s]. Default 14400, four hours.
    #[serde(rename = "for", default = "default_for_s")]
    #[schemars(extend("exclusiveMinimum" = 0), range(max = 86400))]
    pub for_s: f64,
}

/// Ways to pack.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default, Serialize, Deserialize, JsonSchema)]
#[serde(rename_all = "snake_case")]
pub enum Packing {
    /// Fold it to the size.
    #[default]
    Fold,
    /// Fold it to the width and roll it up from below.
    Roll,
}

fn default_to() -> [f64; 2] {
    [0.4, 0.5]
}

/// Pressure where a script gives none [Pa].
const DEFAULT_PRESSURE_PA: f64 = 500.0;

fn default_over_s() -> f64 {
    2.0
}

fn default_for_s() -> f64 {
    14_400.0
}

/// Fraction of the wanted size by which what is folded may be larger: lines in text are rounded.
const SIZE_TOL: f64 = 1e-9;

/// An interval of fractions that the garment covers along one axis.
#[derive(Debug, Clone, Copy)]
struct FractionInterval {
    low: f64,
    high: f64,
}

impl Pack {
    /// The folds that bring the garment to its size, in order: first across its width, then along its height.
    fn folds(&self) -> Vec<Fold> {
        let [width, height] = self.to;
        let height = if self.how == Packing::Roll { 1.0 } else { height };
        let unit = FractionInterval { low: 0.0, high: 1.0 };
        let (mut across, mut upward, mut folds) = (unit, unit, Vec::new());
        while across.high - across.low > width * (1.0 + SIZE_TOL) {
            let length = across.high - across.low;
            // A flap must not reach beyond what it is laid on.
            if length <= 3.0 * width * (1.0 + SIZE_TOL) {
                let middle = 0.5 * (across.low + across.high);
                across = FractionInterval { low: middle - 0.5 * width, high: middle + 0.5 * width };
                folds.push(self.fold_at(0, across.low, FoldSide::Left));
                folds.push(self.fold_at(0, across.high, FoldSide::Right));
            } else {
                across.low = 0.5 * (across.low + across.high);
                folds.push(self.fold_at(0, across.low, FoldSide::Left));
            }
        }
        while upward.high - upward.low > height * (1.0 + SIZE_TOL) {
            upward.low = (upward.high - height).min(0.5 * (upward.low + upward.high));
            folds.push(self.fold_at(1, upward.low, FoldSide::Lower));
        }
        folds
    }

    /// The fold along the line where the coordinate `axis` is `at`.
    fn fold_at(&self, axis: usize, at: f64, side: FoldSide) -> Fold {
        let end = |along: f64| Fraction2(if axis == 0 { [at, along] } else { [along, at] });
        Fold { line: [end(0.0), end(1.0)], side, angle_deg: 180.0, over_s: self.over_s, hold_s: self.over_s }
    }
}

impl Pack {
    /// The actions that it consists of, in order.
    pub(in crate::wear) fn parts(&self) -> Vec<Action> {
        let last = match self.how {
            Packing::Fold => {
                let pressure_pa = self.pressure_pa.unwrap_or(DEFAULT_PRESSURE_PA);
                Action::Press(Press { pressure_pa, for_s: self.for_s })
            }
            Packing::Roll => {
                Action::Roll(Roll { over_s: 2.0 * self.over_s, hold_s: self.for_s, ..Roll::default() })
            }
        };
        self.folds().into_iter().map(Action::Fold).chain([last]).collect()
    }
}

impl WearAction for Pack {
    fn duration(&self) -> f64 {
        self.parts().iter().map(|part| part.as_wear_action().duration()).sum()
    }

    fn validate(&self) -> Vec<FieldError> {
        match (self.how, self.pressure_pa) {
            (Packing::Roll, Some(_)) => {
                let message = "a roll lies under no weight";
                vec![FieldError::new("pressure", message, "leave `pressure` out, or fold")]
            }
            _ => Vec::new(),
        }
    }

    fn start_action(
        &self,
        context: &ActionContext,
        _persistent: &mut PersistentState,
    ) -> Result<ActionStart> {
        Err(context.refuse_whole("pack"))
    }

    fn example() -> Self {
        Self { how: Packing::Fold, to: [0.35, 0.25], pressure_pa: Some(800.0), over_s: 1.5, for_s: 7200.0 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Folds a unit square on paper and returns the extent of what lies there.
    fn folded(pack: &Pack) -> [f64; 2] {
        let mut extents = [[0.0, 1.0]; 2];
        for fold in pack.folds() {
            let (axis, at) = if fold.line[0].x() == fold.line[1].x() {
                (0, fold.line[0].x())
            } else {
                (1, fold.line[0].y())
            };
            let [low, high]: [f64; 2] = extents[axis];
            let turns_low = matches!(fold.side, FoldSide::Left | FoldSide::Lower);
            extents[axis] = if turns_low {
                assert!(at > low && at < high);
                [at, high.max(2.0 * at - low)]
            } else {
                assert!(at > low && at < high);
                [low.min(2.0 * at - high), at]
            };
        }
        extents.map(|[low, high]| high - low)
    }

    #[test]
    fn every_size_is_reached_with_few_folds() {
        for k in 1..=20 {
            for l in 1..=20 {
                let to = [0.05 + 0.0475 * f64::from(k), 0.05 + 0.0475 * f64::from(l)];
                let pack = Pack { to, ..Pack::example() };
                let size = folded(&pack);
                assert!((0..2).all(|axis| size[axis] <= to[axis] * (1.0 + 1e-6)), "{to:?}: {size:?}");
                assert!(pack.folds().len() <= 9, "{to:?}: {} folds", pack.folds().len());
            }
        }
        let lines = Pack { to: [0.4, 0.5], ..Pack::example() }.folds();
        assert_eq!(
            lines.iter().map(|fold| fold.side).collect::<Vec<_>>(),
            [FoldSide::Left, FoldSide::Right, FoldSide::Lower]
        );
    }

    #[test]
    fn a_roll_is_folded_to_its_width_only() {
        let pack = Pack { how: Packing::Roll, pressure_pa: None, ..Pack::example() };
        let parts = pack.parts();
        assert_eq!(
            parts.iter().map(Action::name).collect::<Vec<_>>(),
            ["fold", "fold", "roll"],
            "both sides in, then rolled"
        );
        assert!((pack.duration() - (2.0 * 3.0 + 3.0 + 7200.0)).abs() < 1e-9);
        assert!(pack.validate().is_empty());
        assert_eq!(Pack { pressure_pa: Some(100.0), ..pack }.validate()[0].field, "pressure");
    }
}
