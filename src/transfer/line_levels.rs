//! Place of every point of a target beside a crease line of a source: where it is matched, and straight where the line is.
//!
//! Points of two garments are matched to some millimetres, and a fold drawn by matches alone is as uneven. A straight line is therefore
//! fitted to its matches on the unrolled cloth of the target, and every point near it is placed by that.

use crate::transfer::crease_drawing::point_matches;
use crate::transfer::crease_lines::CreaseLine;
use crate::transfer::tuning::TUNING;
use crate::transfer::unrolled_strip::UnrolledStrip;
use crease_geometry::math::Vec2;
use crease_model::remesh::{Correspondence, GarmentSurface, Match};
use std::collections::BTreeMap;

/// Places of the points of a target beside a line; not numbers where the line does not reach.
#[derive(Debug, Clone)]
pub(super) struct LineLevels {
    /// Signed distance from the line [m].
    pub level: Vec<f64>,
    /// Length of the line up to there [m].
    pub along: Vec<f64>,
}

/// Stretch of a matched line across one triangle, unrolled.
struct Sample {
    /// Its middle [m].
    place: Vec2,
    /// Its length [m].
    weight: f64,
    /// Length of the source's line up to there [m].
    along: f64,
}

/// Straight line on unrolled cloth.
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
        let of_line = |line: &CreaseLine| {
            let matched = Self::matched(line, correspondence.source(), &matches);
            let straight = line.is_straight.then(|| matched.straight(line, target)).flatten();
            straight.unwrap_or(matched)
        };
        lines.iter().map(of_line).collect()
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

    /// The places by a straight line through those where the level is 0, on the cloth of `target`; `None` where they are far from one.
    fn straight(&self, line: &CreaseLine, target: &GarmentSurface) -> Option<Self> {
        let mut crossed: Vec<(f64, u32)> = (0..target.triangles.len() as u32)
            .filter_map(|f| self.crossing(target, f).map(|[a, b]| (0.5 * (a.1 + b.1), f)))
            .collect();
        crossed.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)));
        let (_, first) = *crossed.get(crossed.len() / 2)?;
        let mut strip = UnrolledStrip::new(target, first);
        strip.grow(|face, _, _| {
            let levels = target.triangles[face as usize].map(|p| self.level[p.at()].abs());
            levels.iter().all(|level| level.is_finite()).then(|| match self.crossing(target, face) {
                Some(_) => 0.0,
                None => levels.into_iter().fold(f64::INFINITY, f64::min),
            })
        });
        let mut fit = StraightLine::fit(&self.samples(&strip, target, &crossed))?;
        // What is unrolled along the line itself has it straight, and the line goes on over cloth without matches, up to its ends.
        for _ in 0..TUNING.straight_rounds {
            strip = fit.strip(&strip, target, line)?;
            let samples = self.samples(&strip, target, &crossed);
            let near = |sample: &Sample| fit.place(&sample.place)[0].abs() <= line.reach;
            fit = StraightLine::fit(&samples.into_iter().filter(near).collect::<Vec<_>>())?;
        }
        (fit.rms <= TUNING.max_straight_rms).then(|| self.placed_by(&fit, &strip, target, line))
    }

    /// The places by the line `fit` on `strip`, over the length of `line`.
    fn placed_by(
        &self,
        fit: &StraightLine,
        strip: &UnrolledStrip,
        target: &GarmentSurface,
        line: &CreaseLine,
    ) -> Self {
        let mut all = Self::nowhere(self.level.len());
        let mut agreement = 0.0;
        for face in &strip.order {
            let Some(corners) = strip.corners(*face) else { continue };
            for (p, x) in target.triangles[*face as usize].iter().zip(corners) {
                let [level, along] = fit.place(x);
                if all.level[p.at()].is_nan() && line.reaches(along) {
                    (all.level[p.at()], all.along[p.at()]) = (level, along);
                    let own = self.level[p.at()] * level;
                    agreement += if own.is_nan() { 0.0 } else { own };
                }
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

    /// The zero line over the unrolled triangles among `crossed`.
    fn samples(&self, strip: &UnrolledStrip, target: &GarmentSurface, crossed: &[(f64, u32)]) -> Vec<Sample> {
        let sample = |(along, face): &(f64, u32)| {
            let corners = strip.corners(*face)?;
            let place = |weights: [f64; 3]| (0..3).map(|k| corners[k] * weights[k]).sum::<Vec2>();
            let [a, b] = self.crossing(target, *face)?.map(|(weights, _)| place(weights));
            Some(Sample { place: 0.5 * (a + b), weight: (b - a).norm(), along: *along })
        };
        crossed.iter().filter_map(sample).collect()
    }
}

impl StraightLine {
    /// The cloth of `target` around this line on `strip`, unrolled along it over the length of `line`: first what it crosses, then what lies beside
    /// that, outwards, so that cloth of another place that unrolls to the same is left out.
    fn strip<'a>(
        &self,
        strip: &UnrolledStrip,
        target: &'a GarmentSurface,
        line: &CreaseLine,
    ) -> Option<UnrolledStrip<'a>> {
        let middle = 0.5 * line.length();
        let start = strip.order.iter().filter_map(|face| {
            let corners = strip.corners(*face)?;
            let levels = corners.map(|x| self.place(&x)[0]);
            let crosses = levels.iter().any(|level| *level < 0.0) && levels.iter().any(|level| *level >= 0.0);
            let along = self.place(&((corners[0] + corners[1] + corners[2]) / 3.0))[1];
            crosses.then_some(((along - middle).abs(), *face, *corners))
        });
        let (_, first, corners) = start.min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
        let mut own = UnrolledStrip::of(target, first, corners);
        let middle_of = |side: &[Vec2; 2]| self.place(&(0.5 * (side[0] + side[1])));
        own.grow(|_, side, _| {
            let [a, b] = side.map(|x| self.place(&x)[0]);
            let [_, along] = middle_of(side);
            ((a < 0.0) != (b < 0.0) && line.reaches(along)).then_some((along - middle).abs())
        });
        own.grow(|_, side, corners| {
            let [level, along] = middle_of(side);
            let [beyond, _] = self.place(&((corners[0] + corners[1] + corners[2]) / 3.0));
            let is_outward = level * beyond > 0.0 && beyond.abs() >= level.abs();
            (is_outward && level.abs() <= line.reach && line.reaches(along)).then_some(level.abs())
        });
        Some(own)
    }

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
