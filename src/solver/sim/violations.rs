//! Constraint violations of an accepted step: layers that are compressed and cloth that is stretched beyond what the
//! model is made for. They are detected after the step with their size and position for the report and do not change
//! the motion.

use crate::contact::Contact;
use crate::sim::cloth::Cloth;
use crate::sim::tuning::TUNING;
use crease_geometry::math::Vec3;
use serde::{Deserialize, Serialize};

/// Size and position of the largest violation of one kind.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Violation {
    /// Size in the unit of its kind; see [`Violations`].
    pub size: f64,
    /// Position on the cloth [m].
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    pub position: Vec3,
}

/// Constraint violations of one accepted step.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Violations {
    /// Smallest ratio of a gap between layers to its activation distance [-].
    pub pressed: Option<Violation>,
    /// Largest strain along warp or weft [-].
    pub stretched: Option<Violation>,
    /// Largest strain [-], if more of the cloth than single triangles is stretched beyond what cloth bears.
    pub torn: Option<Violation>,
    /// Smallest ratio of a gap between layers to its activation distance [-], if the solver moved no point at all and did not converge:
    /// layers touch there, and contact lets nothing pass.
    pub stuck: Option<Violation>,
}

impl Violations {
    /// Detects the violations at `x` [m], after a step of `contact`.
    pub(super) fn detect(x: &[Vec3], cloth: &Cloth, contact: &Contact) -> Self {
        let pressed = contact
            .tightest_pair(x)
            .filter(|tightest| tightest.gap_ratio < TUNING.min_gap_ratio)
            .map(|tightest| Violation { size: tightest.gap_ratio, position: tightest.position });
        let strains = strains(x, cloth);
        let none = (TUNING.max_strain, usize::MAX);
        let (size, triangle) =
            strains.iter().copied().zip(0..).fold(none, |max, s| if s.0 > max.0 { s } else { max });
        let stretched = (triangle != usize::MAX)
            .then(|| Violation { size, position: cloth.membrane.centre(triangle, x) });
        let torn = stretched.filter(|worst| {
            worst.size > TUNING.max_cloth_strain && {
                let area = cloth.membrane.area();
                let beyond =
                    strains.iter().zip(area).filter(|(strain, _)| **strain > TUNING.max_cloth_strain);
                let torn: f64 = beyond.map(|(_, area)| area).sum();
                torn > TUNING.min_torn_fraction * area.iter().sum::<f64>()
            }
        });
        Self { pressed, stretched, torn, stuck: None }
    }

    /// The same violations after a step from `before` [m] to `after` [m] that did not converge.
    pub(super) fn of_unconverged(self, before: &[Vec3], after: &[Vec3], contact: &Contact) -> Self {
        let moves = |(a, b): (&Vec3, &Vec3)| (a - b).norm() > TUNING.min_motion;
        let is_still = !before.iter().zip(after).any(moves);
        let tightest = is_still.then(|| contact.tightest_pair(after)).flatten();
        let stuck = tightest.map(|pair| Violation { size: pair.gap_ratio, position: pair.position });
        Self { stuck, ..self }
    }

    /// Whether cloth that is stretched too far was not stretched so far at `before` [m], the beginning of the step.
    pub(super) fn stretches_farther(&self, before: &[Vec3], cloth: &Cloth) -> bool {
        let farther =
            |stretched: Violation| stretched.size > strains(before, cloth).into_iter().fold(0.0, f64::max);
        self.stretched.is_some_and(farther)
    }

    /// Whether there is no violation.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}

/// Returns the larger of the strains along warp and weft at `x` [m] [-], one per triangle.
fn strains(x: &[Vec3], cloth: &Cloth) -> Vec<f64> {
    cloth.membrane.measure(x).into_iter().map(|[u, v, _]| u.max(v) - 1.0).collect()
}
