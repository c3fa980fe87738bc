//! Far clearance: cloth of which no two parts were near in a wide query needs no other query until it has bent.

use crate::contact::tuning::TUNING;
use crease_geometry::math::Vec3;

/// Result of the last far query.
#[derive(Default)]
pub(super) struct FarClearance {
    /// Set when no pair was found.
    clear: Option<ClearAt>,
    /// Steps until the next far query.
    cooldown: u32,
}

/// Positions at which no pair was nearer than a distance.
struct ClearAt {
    /// Positions [m], one per point.
    x: Vec<Vec3>,
    /// Distance of the query [m].
    distance: f64,
}

impl FarClearance {
    /// Whether the last far query found no pair.
    pub fn is_clear(&self) -> bool {
        self.clear.is_some()
    }

    /// Whether the last far query shows that no pair can come within `distance` [m] during the displacement `d` from `x`: no point of a pair
    /// has come nearer than by its own displacement since, common motion left out. `uniform_step`: all points move by the same fraction.
    pub fn covers(&self, x: &[Vec3], d: &[Vec3], distance: f64, uniform_step: bool) -> bool {
        let Some(clear) = &self.clear else { return false };
        let since: Vec<Vec3> = x.iter().zip(&clear.x).map(|(x, at)| x - at).collect();
        let at_end: Vec<Vec3> = since.iter().zip(d).map(|(since, d)| since + d).collect();
        // Written so that what is not finite is far.
        let longer = |a: f64, b: f64| if b <= a { a } else { b };
        let farthest = |displacements: &[Vec3]| {
            let common = mean(displacements);
            displacements.iter().map(|d| (d - common).norm()).fold(0.0, longer)
        };
        let approach = if uniform_step {
            farthest(&since).max(farthest(&at_end))
        } else {
            farthest(&since) + d.iter().map(|d| d.norm()).fold(0.0, longer)
        };
        (distance + 2.0 * approach) * (1.0 + 1e-9) <= clear.distance
    }

    /// Forgets the last far query. Returns whether another is due in this step.
    pub fn is_due(&mut self) -> bool {
        self.clear = None;
        self.cooldown = self.cooldown.saturating_sub(1);
        self.cooldown == 0
    }

    /// Notes that a query at `x` [m] within `distance` [m] found no pair.
    pub fn set_clear(&mut self, x: &[Vec3], distance: f64) {
        self.clear = Some(ClearAt { x: x.to_vec(), distance });
    }

    /// Notes that a far query found a pair.
    pub fn set_near(&mut self) {
        self.cooldown = TUNING.search.far_query_period;
    }
}

/// Returns the mean of displacements [m]; zero when not all are finite.
pub(super) fn mean(d: &[Vec3]) -> Vec3 {
    let mean = d.iter().sum::<Vec3>() / d.len().max(1) as f64;
    if mean.sum().is_finite() { mean } else { Vec3::zeros() }
}
