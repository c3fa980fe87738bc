//! The largest bends that the actions of a script give the cloth, against the thresholds of the memory law.
//!
//! These are bounds from the script alone, before the run: the angle of a fold, that of a roll within the reference length, half a turn
//! where nothing limits the bend. What laying out bends is not remembered and does not count.

use crate::wear::Action;
use std::borrow::Cow;
use std::f64::consts::PI;
use std::fmt;

/// Bend that nothing limits [rad]: layers that lie on one another.
const FREE_BEND: f64 = PI;

/// What the script is applied to.
#[derive(Debug, Clone, Copy)]
pub(super) struct ReachedCloth {
    /// Whether the garment is one flat layer.
    pub is_one_layer: bool,
    /// Whether a body wears it.
    pub is_worn: bool,
    /// Reference length of the memory law [m].
    pub reference_length: f64,
}

/// Band of the memory law.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum ReachedBand {
    /// Below both thresholds.
    Neither,
    /// Above the gradual threshold.
    Gradual,
    /// Above the critical threshold.
    Critical,
}

impl fmt::Display for ReachedBand {
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        f.write_str(match self {
            Self::Neither => "below both",
            Self::Gradual => "gradual",
            Self::Critical => "critical",
        })
    }
}

/// The largest bend of each kind of action of a script.
#[derive(Debug, Clone, PartialEq, Default)]
pub(super) struct BendReach {
    /// Name of the action and the largest bend [rad], in the order of the script.
    bends: Vec<(&'static str, f64)>,
}

impl BendReach {
    /// The bends of `actions` on `cloth`.
    pub fn new(actions: &[Cow<Action>], cloth: ReachedCloth) -> Self {
        let mut reach = Self::default();
        // Whether it lies, and whether a part of it was turned over or rolled up since.
        let (mut lies, mut turned) = (false, !cloth.is_one_layer);
        for action in actions {
            let name = action.name();
            let bend = match action.as_ref() {
                Action::Fold(fold) => fold.angle_deg.to_radians().abs().min(FREE_BEND),
                Action::Roll(roll) => (cloth.reference_length / roll.radius_m).min(FREE_BEND),
                Action::Press(_) | Action::Iron(_) if turned => FREE_BEND,
                Action::Release(_) if turned || !lies => FREE_BEND,
                Action::Hang(_) | Action::Crumple(_) | Action::Bend(_) | Action::Play(_) => FREE_BEND,
                Action::Hold(_) | Action::Settle(_) if cloth.is_worn && !lies => FREE_BEND,
                _ => 0.0,
            };
            lies = matches!(action.as_ref(), Action::Lay(_))
                || lies && !matches!(action.as_ref(), Action::Hang(_) | Action::Crumple(_));
            turned |= bend > 0.0;
            if bend > 0.0 {
                match reach.bends.iter_mut().find(|(known, _)| *known == name) {
                    Some((_, largest)) => *largest = largest.max(bend),
                    None => reach.bends.push((name, bend)),
                }
            }
        }
        reach
    }

    /// The band that the largest bend reaches, with the thresholds `gradual` and `critical` [rad].
    pub fn band(&self, [gradual, critical]: [f64; 2]) -> ReachedBand {
        band_of(self.bends.iter().map(|(_, bend)| *bend).fold(0.0, f64::max), [gradual, critical])
    }

    /// What each kind of action reaches, in one line.
    pub fn describe(&self, thresholds: [f64; 2]) -> String {
        let part = |(name, bend): &(&str, f64)| {
            format!(
                "`{name}` bends by up to {:.0} degrees ({})",
                bend.to_degrees(),
                band_of(*bend, thresholds)
            )
        };
        match self.bends.as_slice() {
            [] => "no action of the script bends the cloth".into(),
            bends => bends.iter().map(part).collect::<Vec<_>>().join(", "),
        }
    }
}

/// The band of a bend [rad]; a threshold itself is below.
fn band_of(bend: f64, [gradual, critical]: [f64; 2]) -> ReachedBand {
    match bend {
        _ if bend > critical => ReachedBand::Critical,
        _ if bend > gradual => ReachedBand::Gradual,
        _ => ReachedBand::Neither,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wear::WearScript;

    /// The reach of a script on one flat layer with a reference length of 20 mm.
    fn reach(script: &str, is_one_layer: bool) -> BendReach {
        let text = format!(r#"{{"format": "crease-wear/1", "name": "", "actions": [{script}]}}"#);
        let script = WearScript::parse("wear.json", &text).expect("is a script");
        let actions: Vec<Cow<Action>> = script.flatten().collect();
        BendReach::new(&actions, ReachedCloth { is_one_layer, is_worn: false, reference_length: 0.02 })
    }

    fn fold(degrees: f64) -> String {
        format!(
            r#"{{"lay": {{}}}}, {{"fold": {{"line": [[0.5, 0], [0.5, 1]], "side": "left", "angle": {degrees}}}}}"#
        )
    }

    #[test]
    fn folds_reach_what_their_angle_and_the_fabric_say() {
        let thresholds = [0.4, 1.3];
        let band = |degrees| reach(&fold(degrees), true).band(thresholds);
        let [a, b] = thresholds.map(f64::to_degrees);
        assert_eq!(band(3.0), ReachedBand::Neither);
        assert_eq!([band(a - 0.1), band(a + 0.1)], [ReachedBand::Neither, ReachedBand::Gradual]);
        assert_eq!([band(b - 0.1), band(b + 0.1)], [ReachedBand::Gradual, ReachedBand::Critical]);
        assert_eq!(reach(&fold(180.0), true).band([4.0, 5.0]), ReachedBand::Neither, "no cloth bends so far");
    }

    #[test]
    fn cloth_that_only_lies_reaches_nothing_and_a_pressed_fold_or_seam_all() {
        let lies =
            r#"{"lay": {}}, {"press": {"pressure": 100, "for": 1}}, {"hold": {"for": 9}}, {"release": {}}"#;
        assert_eq!(reach(lies, true), BendReach::default());
        assert_eq!(reach(lies, false).band([0.4, 1.3]), ReachedBand::Critical);
        let pressed = fold(20.0) + r#", {"press": {"pressure": 100, "for": 1}}"#;
        assert_eq!(reach(&fold(20.0), true).band([0.4, 1.3]), ReachedBand::Neither);
        assert_eq!(reach(&pressed, true).band([0.4, 1.3]), ReachedBand::Critical);
        for free in
            [r#"{"hang": {}}"#, r#"{"crumple": {"to": 0.5}}"#, r#"{"release": {}}"#, r#"{"wash": {}}"#]
        {
            assert_eq!(reach(free, true).band([0.4, 1.3]), ReachedBand::Critical, "{free}");
        }
    }

    #[test]
    fn a_roll_bends_by_the_reference_length_over_its_radius() {
        let roll = r#"{"lay": {}}, {"roll": {"radius": 0.04}}"#;
        assert!(reach(roll, true).describe([0.4, 1.3]).contains("29 degrees (gradual)"));
    }
}
