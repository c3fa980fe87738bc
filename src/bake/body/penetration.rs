//! Statistics of the depth of cloth inside the body, and of triangles that intersect it.

use crate::bake::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_model::error::{Message, Setting};
use crease_solver::contact::{BodyIntersections, BodyPlanes, Penetration, SELF_FOLD_MARGIN};
use crease_solver::energy::PlaneContact;
use serde::{Deserialize, Serialize};

/// Intersecting pairs of triangles of cloth and body in one kind of region.
#[derive(Debug, Clone, Copy, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct IntersectionCount {
    /// Largest number after any step.
    max: usize,
    /// Time of that step [s].
    time: f64,
    /// Number after the last step.
    last: usize,
}

impl IntersectionCount {
    fn record(&mut self, count: usize, time: f64) {
        self.last = count;
        if count > self.max {
            (self.max, self.time) = (count, time);
        }
    }
}

/// Statistics of the penetration of cloth into the body over a run.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyPenetrationStats {
    /// Intersections in regions where the body does not touch itself.
    open: IntersectionCount,
    /// Intersections in regions where the body folds into itself.
    self_fold: IntersectionCount,
    /// Steps with intersections where the body does not touch itself.
    steps: usize,
    /// Middle of those after the last step [m].
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    open_position: Vec3,
    /// Time since which there are many of them without a pause [s].
    many_since: Option<f64>,
    /// Intersections with which the run began: they count as the file's own.
    at_start: usize,
    /// Time of the first and the last step with cloth inside the body [s].
    times: Option<[f64; 2]>,
    /// Largest depth [m].
    max_depth: f64,
    /// Position of the largest depth [m].
    #[serde(with = "crease_geometry::math::serde_vec::vector")]
    deepest_position: Vec3,
}

impl BodyPenetrationStats {
    /// Records a step that ended at `time` [s] with the cloth at `x` [m], in contact by `planes`, and the
    /// pairs that intersect then; more than `many` beyond those of the start are too many.
    pub(in crate::bake) fn record(
        &mut self,
        time: f64,
        x: &[Vec3],
        planes: &[PlaneContact],
        intersections: BodyIntersections,
        many: usize,
    ) {
        let BodyIntersections { open, self_fold, position } = intersections;
        self.open_position = position;
        let is_many = open > self.at_start + many;
        self.many_since = is_many.then(|| self.many_since.unwrap_or(time));
        self.open.record(open, time);
        self.self_fold.record(self_fold, time);
        self.steps += usize::from(open > 0);
        let deepest =
            BodyPlanes::deepest_penetration(x, planes).filter(|p| p.depth > TUNING.body.min_reported_depth);
        let Some(Penetration { point, depth }) = deepest else { return };
        self.times = Some([self.times.map_or(time, |[from, _]| from), time]);
        if depth > self.max_depth {
            self.max_depth = depth;
            self.deepest_position = x.get(point as usize).copied().unwrap_or_else(Vec3::zeros);
        }
    }

    /// Sets the number of intersections with which the run begins.
    pub(in crate::bake) fn begin_with(&mut self, pairs: usize) {
        self.at_start = pairs;
        self.open.last = pairs;
    }

    /// Number of pairs after the last step, or at the start, where the body does not touch itself.
    pub(in crate::bake) fn open_pairs(&self) -> usize {
        self.open.last
    }

    /// Middle of those pairs [m].
    pub(in crate::bake) fn open_position(&self) -> Vec3 {
        self.open_position
    }

    /// Time since which there are many pairs without a pause [s].
    pub(in crate::bake) fn many_pairs_since(&self) -> Option<f64> {
        self.many_since
    }

    /// Reason why the cloth does not count as worn, if the body breaks through it after the last step in more places than at the
    /// start and than corners of the body may between its points.
    pub(in crate::bake) fn reason_broken_through(&self) -> Option<String> {
        let IntersectionCount { last, .. } = self.open;
        let x = self.open_position;
        (last > self.at_start + TUNING.body_watch.max_pairs_at_end).then(|| {
            format!(
                "at the end of the wear the body breaks through the cloth, with {last} pairs of triangles around ({:.3}, {:.3}, {:.3}) m \
                 ({} at the start); check the fit, refine the mesh, or begin with a slower motion",
                x.x, x.y, x.z, self.at_start
            )
        })
    }

    /// Warnings on depth and intersections, if there were any.
    pub(in crate::bake) fn warnings(&self) -> Vec<Message> {
        self.depth_warning().map(Message::from).into_iter().chain(self.intersection_warning()).collect()
    }

    fn intersection_warning(&self) -> Option<Message> {
        let (open, fold) = (&self.open, &self.self_fold);
        let parts = [
            (open.max > 0).then(|| {
                let what = format!(
                    "{} at {:.2} s, in {} steps some, {} at the end of the wear (corners of the body between points of the cloth: \
                     a finer ",
                    open.max, open.time, self.steps, open.last
                );
                Message::from(what) + Setting::Resolution + " has fewer)"
            }),
            (fold.max > 0).then(|| {
                let what = format!(
                    "where it folds into itself and {:.0} mm around {} at {:.2} s, {} at the end",
                    1e3 * SELF_FOLD_MARGIN,
                    fold.max,
                    fold.time,
                    fold.last
                );
                what.into()
            }),
        ];
        let parts = Message::join(parts.into_iter().flatten(), "; ");
        let what = "pairs of triangles that crossed the body: ";
        (!parts.is_empty()).then(|| Message::from(what) + parts)
    }

    fn depth_warning(&self) -> Option<String> {
        let [from, to] = self.times?;
        let p = self.deepest_position;
        Some(format!(
            "{from:.2} to {to:.2} s, at times: cloth up to {:.1} mm inside the body, deepest near ({:.3}, {:.3}, {:.3}) m: where a body \
             folds into itself there is no room for cloth",
            1e3 * self.max_depth,
            p.x,
            p.y,
            p.z
        ))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Up to 20 pairs beyond those of the start are corners between points; more are a body that sticks out, whatever was in between.
    #[test]
    fn a_body_that_ends_through_the_cloth_is_no_success() {
        let at = Vec3::new(0.1, 1.2, 0.0);
        let ended = |at_start: usize, steps: &[usize]| {
            let mut stats = BodyPenetrationStats::default();
            stats.begin_with(at_start);
            for (k, open) in steps.iter().enumerate() {
                let found = BodyIntersections { open: *open, self_fold: 500, position: at };
                stats.record(k as f64, &[], &[], found, 1000);
            }
            stats.reason_broken_through()
        };
        assert_eq!(ended(0, &[98, 20]), None, "it recovered");
        assert_eq!(ended(78, &[98]), None, "most of it was so in the file");
        let told = ended(77, &[0, 98]).expect("is a reason");
        assert!(
            told.contains("98 pairs of triangles around (0.100, 1.200, 0.000) m (77 at the start)"),
            "{told}"
        );
        assert!(ended(0, &[21]).is_some() && ended(30, &[]).is_none());
    }
}
