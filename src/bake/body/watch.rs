//! Watch over a garment on its body: parts of it that fall off, and cloth that the body breaks through for longer than a
//! moment. Neither recovers, so the run ends there.

use crate::bake::body::penetration::BodyPenetrationStats;
use crate::bake::report::StopCause;
use crate::bake::tuning::TUNING;
use crease_geometry::math::{Vec3, bounds};
use crease_model::error::{Message, Setting};
use crease_model::garment::Garment;

/// Parts of a garment that began on its body.
pub(in crate::bake) struct BodyWatch {
    /// Per connected part of the garment: whether it is watched.
    watched: Vec<bool>,
    /// Per point: its part.
    part: Vec<u32>,
    /// Number of pairs of triangles of cloth and body that may intersect for longer than a moment.
    max_pairs: usize,
}

impl BodyWatch {
    /// The watch over `garment` on a body whose points are at `body` [m].
    pub fn new(garment: &Garment, body: &[Vec3]) -> Self {
        let count = garment.triangle_part.iter().max().map_or(0, |last| *last as usize + 1);
        let max_pairs = TUNING.body_watch.max_pair_fraction * garment.triangles.len() as f64;
        let mut watch = Self {
            watched: vec![true; count],
            part: garment.point_parts(),
            max_pairs: TUNING.body_watch.min_pairs.max(max_pairs as usize),
        };
        watch.watched = watch.parts_near(&garment.points, body);
        watch
    }

    /// The watch over a refined mesh of the same cloth, which is on its body as this one is.
    pub fn on_refined(&self, garment: &Garment, body: &[Vec3]) -> Self {
        Self { watched: self.watched.clone(), ..Self::new(garment, body) }
    }

    /// Per part: whether any of its points, at `x` [m], is beside or within the bounding box of a body at `body` [m].
    fn parts_near(&self, x: &[Vec3], body: &[Vec3]) -> Vec<bool> {
        let (low, high) = bounds(body);
        let margin = Vec3::repeat(TUNING.body_watch.margin);
        let (low, high) = (low - margin, high + margin);
        let mut near = vec![false; self.watched.len()];
        for (x, part) in x.iter().zip(&self.part) {
            let is_in = (0..3).all(|k| low[k] <= x[k] && x[k] <= high[k]);
            if let Some(slot) = near.get_mut(*part as usize).filter(|_| is_in) {
                *slot = true;
            }
        }
        near
    }

    /// Number of pairs of triangles of cloth and body that may intersect for longer than a moment.
    pub fn max_pairs(&self) -> usize {
        self.max_pairs
    }

    /// Cause to end the run at `time` [s] with the cloth at `x` and the body at `body` [m].
    pub fn cause_to_stop(
        &self,
        time: f64,
        x: &[Vec3],
        body: &[Vec3],
        penetration: &BodyPenetrationStats,
    ) -> Option<StopCause> {
        let near = self.parts_near(x, body);
        let lost = (0..near.len()).find(|part| self.watched[*part] && !near[*part]);
        if let Some(lost) = lost {
            let own: Vec<Vec3> = x
                .iter()
                .zip(&self.part)
                .filter(|(_, part)| **part as usize == lost)
                .map(|(x, _)| *x)
                .collect();
            let middle = own.iter().sum::<Vec3>() / own.len().max(1) as f64;
            let reason = format!(
                "at {time:.2} s a part of the garment of {} points has fallen off the body, to ({:.2}, {:.2}, {:.2}) m: nothing \
                 holds it; if the garment is skinned in its file, ",
                own.len(),
                middle.x,
                middle.y,
                middle.z
            );
            let reason =
                Message::from(reason) + Setting::Hold + " holds it to its joints, else fit it closer";
            return Some(StopCause { reason, position: middle });
        }
        let since = penetration.many_pairs_since()?;
        (time - since >= TUNING.body_watch.max_time).then(|| {
            let position = penetration.open_position();
            let reason = format!(
                "since {since:.2} s the body breaks through the cloth, now with {} pairs of triangles around ({:.2}, {:.2}, {:.2}) m: \
                 check the fit, refine the mesh with ",
                penetration.open_pairs(),
                position.x,
                position.y,
                position.z
            );
            let reason =
                Message::from(reason) + Setting::Resolution + ", or begin with a slower motion";
            StopCause { reason, position }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::GarmentFile;
    use crease_solver::contact::BodyIntersections;

    #[test]
    fn what_falls_off_ends_the_run() {
        let sheet = GarmentFile::sheet([0.2, 0.2], [2, 2]).expect("is a sheet").garment;
        let body = [Vec3::new(0.0, -1.0, 0.0), Vec3::new(0.2, 0.0, 0.2)];
        let watch = BodyWatch::new(&sheet, &body);
        let stats = BodyPenetrationStats::default();
        assert_eq!(watch.cause_to_stop(1.0, &sheet.points, &body, &stats), None);
        let fallen: Vec<Vec3> = sheet.points.iter().map(|p| p - Vec3::new(0.0, 2.0, 0.0)).collect();
        let reason = watch.cause_to_stop(1.0, &fallen, &body, &stats).expect("has fallen off").reason;
        assert!(reason.contains("9 points has fallen off") && reason.contains("at 1.00 s"), "{reason}");
        // What was never on the body cannot fall off it.
        let far = [Vec3::repeat(5.0), Vec3::repeat(6.0)];
        assert_eq!(BodyWatch::new(&sheet, &far).cause_to_stop(1.0, &fallen, &far, &stats), None);
    }

    /// Many pairs of triangles that intersect for more than half a second, beyond those of the start; a moment's are no cause.
    #[test]
    fn a_body_that_breaks_through_ends_the_run() {
        let sheet = GarmentFile::sheet([0.2, 0.2], [2, 2]).expect("is a sheet").garment;
        let body = [Vec3::new(0.0, -1.0, 0.0), Vec3::new(0.2, 0.0, 0.2)];
        let watch = BodyWatch::new(&sheet, &body);
        assert_eq!(watch.max_pairs(), 200);
        let cause = |pairs: &dyn Fn(f64) -> usize| {
            let mut stats = BodyPenetrationStats::default();
            stats.begin_with(50);
            (0..30).map(|step| 0.1 * f64::from(step)).find_map(|time| {
                let position = Vec3::new(0.1, 0.0, 0.2);
                let now = BodyIntersections { open: pairs(time), self_fold: 1000, position };
                stats.record(time, &sheet.points, &[], now, watch.max_pairs());
                watch.cause_to_stop(time, &sheet.points, &body, &stats).map(|cause| (time, cause))
            })
        };
        let (time, StopCause { reason, position }) =
            cause(&|t| if t > 0.95 { 251 } else { 0 }).expect("breaks through");
        assert!((1.45..1.65).contains(&time), "{time} s");
        assert!(reason.contains("since 1.00 s the body breaks through the cloth"), "{reason}");
        assert!(reason.contains("251 pairs") && reason.contains("Garment::refine"), "{reason}");
        assert_eq!(position, Vec3::new(0.1, 0.0, 0.2));
        assert_eq!(cause(&|_| 250), None, "as many as at the start, and no more than may be");
        assert_eq!(cause(&|t| if (10.0 * t).round() % 5.0 == 0.0 { 250 } else { 1000 }), None, "it recovers");
    }
}
