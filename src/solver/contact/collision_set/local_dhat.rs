//! Activation distances of single points: reduced where something was nearer than d-hat at the start, and growing back.

use crate::contact::collision_set::candidate_pair::CandidatePair;
use crate::contact::tuning::TUNING;
use crease_geometry::math::Vec3;

/// Largest activation distance of the pairs of each point.
pub(super) struct LocalDhat {
    /// D-hat of the cloth [m].
    dhat: f64,
    /// Activation distances [m], one per point.
    per_point: Vec<f64>,
}

impl LocalDhat {
    /// D-hat [m] for each of `count` points.
    pub fn new(dhat: f64, count: usize) -> Self {
        Self { dhat, per_point: vec![dhat; count] }
    }

    /// Sets all activation distances to d-hat.
    pub fn reset(&mut self) {
        self.per_point.fill(self.dhat);
    }

    /// Returns the largest activation distance of a pair of these points [m].
    pub fn of_pair(&self, points: &[u32; 4]) -> f64 {
        points.iter().map(|p| self.per_point[*p as usize]).fold(self.dhat, f64::min)
    }

    /// Whether any activation distance is below d-hat.
    pub fn is_reduced(&self) -> bool {
        self.per_point.iter().any(|dhat| *dhat < self.dhat)
    }

    /// Reduces the activation distances of the points of `pairs` below their distance at `x` [m].
    pub fn reduce(&mut self, x: &[Vec3], pairs: &[CandidatePair]) {
        for pair in pairs {
            let near = TUNING.search.max_dhat_over_rest_distance * pair.closest_points(x).distance;
            for p in pair.points {
                self.per_point[p as usize] = self.per_point[p as usize].min(near);
            }
        }
    }

    /// Lets reduced activation distances grow during a step of `h` seconds that ended at `x` [m]: with time, and only so far that the
    /// barrier of `pairs` pushes gently.
    pub fn grow(&mut self, x: &[Vec3], h: f64, pairs: &[CandidatePair]) {
        let mut nearest = vec![f64::INFINITY; x.len()];
        for pair in pairs.iter().filter(|pair| !pair.ignored) {
            if pair.points.iter().any(|p| self.per_point[*p as usize] < self.dhat) {
                let near = pair.closest_points(x).distance;
                for p in pair.points {
                    nearest[p as usize] = nearest[p as usize].min(near);
                }
            }
        }
        let growth = self.dhat * h / TUNING.search.dhat_growth_time;
        let max_ratio = TUNING.search.max_growing_dhat_over_distance;
        for (dhat, near) in self.per_point.iter_mut().zip(nearest) {
            *dhat = dhat.max((*dhat + growth).min(max_ratio * near).min(self.dhat));
        }
    }
}
