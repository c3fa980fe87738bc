//! Place of every point of a target beside a crease line of a source: where it is matched, and straight where the line is.
//!
//! Points of two garments are matched to some millimetres, and a fold drawn by matches alone is as uneven. A fold is one straight line where a garment
//! lies: it is fitted to the matches of all its creases where the target lies, and every point near them is placed by that.

use crate::transfer::crease_drawing::point_matches;
use crate::transfer::crease_lines::CreaseLine;
use crate::transfer::lying_plane::LyingPlane;
use crate::transfer::tuning::TUNING;
use crease_geometry::math::Vec2;
use crease_model::remesh::{Correspondence, GarmentSurface, Match};
use std::collections::{BTreeMap, BTreeSet};

/// Places of the points of a target beside a line; not numbers where the line does not reach.
#[derive(Debug, Clone)]
pub(super) struct LineLevels {
    /// Signed distance from the line [m].
    pub level: Vec<f64>,
    /// Length of the line up to there [m].
    pub along: Vec<f64>,
}

/// Stretch of a matched line across one triangle, where the target lies.
struct Sample {
    /// Its middle [m].
    place: Vec2,
    /// Its length [m].
    weight: f64,
    /// Length of the source's line up to there [m].
    along: f64,
}

/// Straight line where the target lies.
#[derive(Clone)]
struct StraightLine {
    centre: Vec2,
    /// Unit vector along it, in the direction of the source's.
    direction: Vec2,
    /// Places along it from `centre`, and the length of the source's line up to them, both growing [m]: a garment of another cut has more cloth in
    /// some places.
    knots: Vec<[f64; 2]>,
    /// Root mean square distance of the samples [m].
    rms: f64,
}

impl LineLevels {
    /// Per line of `lines`, those of the source of `correspondence`: the places of the points of `target`.
    pub fn all(
        lines: &[CreaseLine],
        correspondence: &impl Correspondence,
        target: &GarmentSurface,
    ) -> Vec<Self> {
        let matches = point_matches(correspondence, target);
        let matched = |line| Self::matched(line, correspondence.source(), &matches);
        let matched: Vec<Self> = lines.iter().map(matched).collect();
        let has_fold = lines.iter().any(|line| line.fold.is_some());
        let Some(plane) = has_fold.then(|| LyingPlane::of(target)).flatten() else { return matched };
        let own_of = |(line, levels): (&CreaseLine, &Self)| {
            line.fold.and_then(|_| LyingLine::new(levels, target, &plane))
        };
        let own: Vec<Option<LyingLine>> = lines.iter().zip(&matched).map(own_of).collect();
        let placed = |(k, levels): (usize, Self)| {
            let Some(one) = &own[k] else { return levels };
            let is_same_fold = |(_, line): &(&Option<LyingLine>, &CreaseLine)| line.fold == lines[k].fold;
            let of_fold = own.iter().zip(lines).filter(is_same_fold).filter_map(|(own, _)| own.as_ref());
            let of_fold: Vec<&LyingLine> = of_fold.collect();
            let as_lying = lines[k].fold.map(|fold| fold.on(&plane));
            let (fit, shift) = one.on_fold(&of_fold, as_lying);
            let faces = one.faces_beside(&fit, shift, target, &plane, &lines[k]);
            levels.placed_by(&fit, &faces, target, &plane, &lines[k])
        };
        matched.into_iter().enumerate().map(placed).collect()
    }

    fn nowhere(count: usize) -> Self {
        Self { level: vec![f64::NAN; count], along: vec![f64::NAN; count] }
    }

    fn matched(line: &CreaseLine, source: &GarmentSurface, matches: &[Option<Match>]) -> Self {
        let mut all = Self::nowhere(matches.len());
        for (p, found) in matches.iter().enumerate() {
            let place = found.as_ref().and_then(|found| line.locate(source, found.triangle, &found.position));
            if let Some([level, along]) = place {
                (all.level[p], all.along[p]) = (level, along);
            }
        }
        all
    }

    /// The places by the line `fit` on `faces`, over the length of `line`.
    fn placed_by(
        &self,
        fit: &StraightLine,
        faces: &[u32],
        target: &GarmentSurface,
        plane: &LyingPlane,
        line: &CreaseLine,
    ) -> Self {
        let mut all = Self::nowhere(self.level.len());
        let mut agreement = 0.0;
        for p in faces.iter().flat_map(|f| target.triangles[*f as usize]).map(|p| p.at()) {
            let [level, along] = fit.place(&plane.places[p]);
            if all.level[p].is_nan() && line.reaches(along) {
                (all.level[p], all.along[p]) = (level, along);
                let own = self.level[p] * level;
                agreement += if own.is_nan() { 0.0 } else { own };
            }
        }
        if agreement < 0.0 {
            all.level.iter_mut().for_each(|level| *level = -*level);
        }
        all
    }

    /// Where the zero line crosses two sides of triangle `face`: weights of its corners, and the length of the line up to there [m].
    fn crossing(&self, target: &GarmentSurface, face: u32) -> Option<[([f64; 3], f64); 2]> {
        let t = target.triangles[face as usize].map(|p| p.at());
        let level = t.map(|p| self.level[p]);
        let mut found = Vec::new();
        for (i, j) in [(0, 1), (1, 2), (2, 0)] {
            if (level[i] < 0.0) != (level[j] < 0.0) {
                let part = level[i] / (level[i] - level[j]);
                let mut weights = [0.0; 3];
                (weights[i], weights[j]) = (1.0 - part, part);
                found.push((weights, self.along[t[i]] * (1.0 - part) + self.along[t[j]] * part));
            }
        }
        let [a, b] = found[..] else { return None };
        (a.1.is_finite() && b.1.is_finite()).then_some([a, b])
    }
}

/// A matched line where the target lies.
struct LyingLine {
    fit: StraightLine,
    samples: Vec<Sample>,
    /// Triangles that it crosses; all look to one side.
    faces: Vec<u32>,
    looks_up: bool,
}

impl LyingLine {
    /// The straight line through the places where `levels` are 0; `None` where they are far from one.
    fn new(levels: &LineLevels, target: &GarmentSurface, plane: &LyingPlane) -> Option<Self> {
        let mut sides: [(Vec<Sample>, Vec<u32>, f64); 2] = Default::default();
        for f in 0..target.triangles.len() as u32 {
            let Some(ends) = levels.crossing(target, f) else { continue };
            let corners = plane.corners(target, f);
            let place = |weights: [f64; 3]| (0..3).map(|k| corners[k] * weights[k]).sum::<Vec2>();
            let [a, b] = ends.map(|(weights, _)| place(weights));
            let (samples, faces, length) = &mut sides[usize::from(plane.looks_up[f as usize])];
            let weight = (b - a).norm();
            samples.push(Sample { place: 0.5 * (a + b), weight, along: 0.5 * (ends[0].1 + ends[1].1) });
            faces.push(f);
            *length += weight;
        }
        let [down, up] = sides;
        let looks_up = up.2 >= down.2;
        let (samples, faces, _) = if looks_up { up } else { down };
        let fit = StraightLine::fit(&samples)?;
        (fit.rms <= TUNING.max_straight_rms).then_some(Self { fit, samples, faces, looks_up })
    }

    /// First and last place on the line [m].
    fn ends(&self) -> [Vec2; 2] {
        let along = |sample: &Sample| self.fit.direction.dot(&(sample.place - self.fit.centre));
        let (low, high) =
            self.samples.iter().map(along).fold((0.0f64, 0.0f64), |(l, h), t| (l.min(t), h.max(t)));
        [low, high].map(|t| self.fit.centre + self.fit.direction * t)
    }

    /// The line of the fold of all creases `of_fold`, with this one, and the distance from it to this one [m]: through the two places `as_lying` [m], where
    /// the source has it as it lies, if the matches of all creases are near that, else through those matches.
    fn on_fold(&self, of_fold: &[&Self], as_lying: Option<[Vec2; 2]>) -> (StraightLine, f64) {
        let sample = |place: Vec2, weight| Sample { place, weight, along: self.fit.direction.dot(&place) };
        let through = |ends: &[Sample], max: f64| {
            let weights: Vec<f64> = ends.iter().map(|end| end.weight).collect();
            let line = StraightLine::weighted(ends, &weights)?;
            let apart =
                |own: &Self| own.ends().iter().map(|end| line.place(end)[0].abs()).fold(0.0, f64::max);
            if of_fold.iter().any(|own| apart(own) > max) {
                return None;
            }
            let weights: Vec<f64> = self.samples.iter().map(|sample| sample.weight).collect();
            let knots = line.knots(&self.samples, &weights);
            (!knots.is_empty()).then(|| (StraightLine { knots, ..line.clone() }, apart(self)))
        };
        let ends_of = |line: &&Self| {
            let ends = line.ends();
            let weight = (ends[1] - ends[0]).norm();
            ends.map(|place| sample(place, weight))
        };
        as_lying
            .and_then(|ends| through(&ends.map(|place| sample(place, 1.0)), TUNING.max_fold_shift))
            .or_else(|| {
                through(&of_fold.iter().flat_map(ends_of).collect::<Vec<_>>(), TUNING.max_straight_rms)
            })
            .unwrap_or_else(|| (self.fit.clone(), 0.0))
    }

    /// Triangles beside the line `fit`, which is `shift` [m] from this one at most: on its layer, over the length of `line`.
    fn faces_beside(
        &self,
        fit: &StraightLine,
        shift: f64,
        target: &GarmentSurface,
        plane: &LyingPlane,
        line: &CreaseLine,
    ) -> Vec<u32> {
        let is_beside = |f: u32| {
            let places = plane.corners(target, f).map(|x| fit.place(&x));
            let is_near = places.iter().any(|[level, _]| level.abs() <= line.reach + shift);
            let crosses =
                places.iter().any(|[level, _]| *level < 0.0) && places.iter().any(|[level, _]| *level >= 0.0);
            plane.looks_up[f as usize] == self.looks_up
                && (is_near || crosses)
                && places.iter().any(|[_, along]| line.reaches(*along))
        };
        let mut open = self.faces.clone();
        let mut found: BTreeSet<u32> = open.iter().copied().collect();
        while let Some(f) = open.pop() {
            for e in target.topology.triangle_edges[f as usize] {
                let Some(h) = target.topology.edge_hinge[e as usize] else { continue };
                for g in target.topology.hinges[h as usize].triangles {
                    if !found.contains(&g) && is_beside(g) {
                        found.insert(g);
                        open.push(g);
                    }
                }
            }
        }
        found.into_iter().collect()
    }
}

impl StraightLine {
    /// The line with the least distances from `samples`, of which those far off count less (iteratively reweighted least squares).
    fn fit(samples: &[Sample]) -> Option<Self> {
        let mut weights: Vec<f64> = samples.iter().map(|sample| sample.weight).collect();
        let mut line: Option<Self> = None;
        for _ in 0..TUNING.straight_rounds {
            let fit = Self::weighted(samples, &weights)?;
            for (weight, sample) in weights.iter_mut().zip(samples) {
                let apart = fit.place(&sample.place)[0].abs();
                *weight = sample.weight / (apart / TUNING.straight_scale).max(1.0);
            }
            line = Some(fit);
        }
        let knots = line.as_ref()?.knots(samples, &weights);
        line.filter(|_| !knots.is_empty()).map(|line| Self { knots, ..line })
    }

    fn weighted(samples: &[Sample], weights: &[f64]) -> Option<Self> {
        let total: f64 = weights.iter().sum();
        let all = || samples.iter().zip(weights);
        let centre = all().map(|(sample, w)| sample.place * *w).sum::<Vec2>() / total;
        let middle = all().map(|(sample, w)| sample.along * w).sum::<f64>() / total;
        let (mut xx, mut xy, mut yy, mut trend) = (0.0, 0.0, 0.0, Vec2::zeros());
        for (sample, w) in all() {
            let x = sample.place - centre;
            xx += w * x.x * x.x;
            xy += w * x.x * x.y;
            yy += w * x.y * x.y;
            trend += x * (w * (sample.along - middle));
        }
        let angle = 0.5 * (2.0 * xy).atan2(xx - yy);
        let mut direction = Vec2::new(angle.cos(), angle.sin());
        direction *= direction.dot(&trend).signum();
        let ahead = direction.dot(&trend);
        if ahead.is_nan() || ahead <= 0.0 {
            return None;
        }
        let line = Self { centre, direction, knots: vec![[0.0, middle]], rms: 0.0 };
        let squares: f64 = all().map(|(sample, w)| w * line.place(&sample.place)[0].powi(2)).sum();
        Some(Self { rms: (squares / total).sqrt(), ..line })
    }

    /// Means of the samples over short stretches along the line.
    fn knots(&self, samples: &[Sample], weights: &[f64]) -> Vec<[f64; 2]> {
        // Per stretch: the sums of the weights, and of the places along both lines times them.
        let mut stretches: BTreeMap<i64, [f64; 3]> = BTreeMap::new();
        for (sample, w) in samples.iter().zip(weights) {
            let t = self.direction.dot(&(sample.place - self.centre));
            let sums = stretches.entry((t / TUNING.straight_knot_spacing).floor() as i64).or_default();
            [1.0, t, sample.along].iter().zip(sums).for_each(|(value, sum)| *sum += w * value);
        }
        let mut knots: Vec<[f64; 2]> = Vec::new();
        for [weight, t, along] in stretches.into_values().filter(|[weight, ..]| *weight > 0.0) {
            let knot = [t / weight, along / weight];
            if knots.last().is_none_or(|last| knot[1] > last[1]) {
                knots.push(knot);
            }
        }
        knots
    }

    /// Signed distance of `x` from the line, and the length of the source's line up to there [m].
    fn place(&self, x: &Vec2) -> [f64; 2] {
        let apart = x - self.centre;
        let t = self.direction.dot(&apart);
        let after = self.knots.partition_point(|knot| knot[0] <= t);
        let along = match (after.checked_sub(1).map(|k| self.knots[k]), self.knots.get(after)) {
            (Some(a), Some(b)) => a[1] + (b[1] - a[1]) * (t - a[0]) / (b[0] - a[0]),
            (Some(end), None) => end[1] + t - end[0],
            (None, Some(end)) => end[1] + t - end[0],
            (None, None) => f64::NAN,
        };
        [self.direction.perp(&apart), along]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_fitted_through_most_of_its_samples() {
        let direction = Vec2::new(0.6, 0.8);
        let across = Vec2::new(-0.8, 0.6);
        let sample = |k: i32| {
            let along = 0.01 * f64::from(k);
            let apart = if k % 7 == 0 { 0.02 } else { 1e-3 * f64::from(k % 3 - 1) };
            Sample { place: direction * (1.1 * along) + across * apart, weight: 0.01, along }
        };
        let samples: Vec<Sample> = (0..60).map(sample).collect();
        let line = StraightLine::fit(&samples).expect("has a direction");
        assert!(line.direction.dot(&direction) > 0.9999, "{:?}", line.direction);
        let [level, along] = line.place(&(direction * 0.33));
        assert!(level.abs() < 1.5e-3 && (along - 0.3).abs() < 2e-3, "{level} {along}");
    }
}
