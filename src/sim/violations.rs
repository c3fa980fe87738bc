//! Demands that a step could not meet: noticed after it, with their size and place, so that the report can tell.
//!
//! Nothing here changes the motion. Layers that are pressed thinner than they are push back ever harder, and stretched cloth pulls: the demand simply
//! stays unmet, and when it ends everything goes on.

use crate::contact::Contact;
use crate::math::Vec3;
use crate::sim::Cloth;
use serde::{Deserialize, Serialize};

/// How far off, and where [m].
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct Violation {
    /// In the unit of its kind.
    pub size: f64,
    /// [m].
    #[serde(rename = "place", with = "crate::math::serde_vec::vector")]
    pub position: Vec3,
}

/// What one accepted step could not do as it was told.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Violations {
    /// Layers are pressed to this share of their contact distance.
    pub pressed: Option<Violation>,
    /// Cloth is stretched by this strain.
    pub stretched: Option<Violation>,
}

/// Layers nearer than this share of their contact distance are pressed beyond what contact is made for.
const PRESSED: f64 = 0.02;
/// Strain beyond what any of the fabrics bears in wear.
const STRETCHED: f64 = 0.3;

impl Violations {
    /// What is unmet at `x`, after a step of `contact`.
    pub(super) fn detect(x: &[Vec3], cloth: &Cloth, contact: &Contact) -> Self {
        let pressed = contact
            .tightest_pair(x)
            .filter(|tightest| tightest.gap_ratio < PRESSED)
            .map(|tightest| Violation { size: tightest.gap_ratio, position: tightest.position });
        let strains = cloth.membrane.measure(x).into_iter().map(|[u, v, _]| u.max(v) - 1.0);
        let most =
            strains.zip(0..).fold((STRETCHED, usize::MAX), |most, s| if s.0 > most.0 { s } else { most });
        let stretched = (most.1 != usize::MAX)
            .then(|| Violation { size: most.0, position: cloth.membrane.centre(most.1, x) });
        Self { pressed, stretched }
    }

    /// Whether everything was met.
    pub fn is_none(&self) -> bool {
        *self == Self::default()
    }
}
