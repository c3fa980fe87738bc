//! Axis-aligned bounding boxes of moving points, for tests of millions of pairs.
//!
//! Boxes are kept in single precision, rounded outward, with the high corner negated: two boxes are compared by eight additions
//! and eight comparisons that the compiler does four at a time, and a mesh's boxes stay in the cache. Rounding only makes
//! a box larger or a distance smaller, so that no pair is lost.

use crate::math::Vec3;

/// Widening of a limit that swallows the rounding of one subtraction in single precision.
const ROUNDING: f64 = 1e-6;

/// Component of the unit space diagonal along each axis, rounded down: distances never look larger.
const DIAGONAL: f64 = 0.577_350_269;
/// Bound on the rounding of a sum of three coordinates over the largest [-].
const SUM_ROUNDING: f64 = 1e-15;

/// Axis-aligned box, also bounded along the space diagonal, around points that move; never smaller than exact.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(32))]
pub struct SweptBox {
    /// Smallest x, y, z and position along the space diagonal \[m\], then the largest, negated. The diagonal costs nothing, as its lane
    /// would be unused, and rejects a tenth of the pairs.
    bounds: [f32; 8],
}

impl SweptBox {
    /// Box around nothing, which is near to nothing.
    pub const EMPTY: Self = Self { bounds: [f32::INFINITY; 8] };

    /// Box around everything, which is near to all but [`Self::EMPTY`].
    pub const EVERYWHERE: Self = Self { bounds: [f32::NEG_INFINITY; 8] };

    /// Returns the box of a point that moves straight from `start` to `end` \[m\]. Empty if the start is not finite; an end that is
    /// not finite counts as the start.
    #[inline]
    pub fn of_point(start: &Vec3, end: &Vec3) -> Self {
        if !start.sum().is_finite() {
            return Self::EMPTY;
        }
        let end = if end.sum().is_finite() { end } else { start };
        let mut bounds = [f32::NEG_INFINITY; 8];
        for axis in 0..3 {
            let (a, b) = (start[axis], end[axis]);
            bounds[axis] = below(if a < b { a } else { b });
            bounds[axis + 4] = below(if a < b { -b } else { -a });
        }
        let (a, b) = (start.sum() * DIAGONAL, end.sum() * DIAGONAL);
        let rounding = SUM_ROUNDING * (start.amax() + end.amax());
        bounds[3] = below(a.min(b) - rounding);
        bounds[7] = below((-a).min(-b) - rounding);
        Self { bounds }
    }

    /// Returns the box around both; empty if one is, since then one of its points is not finite.
    #[inline(always)]
    pub fn with(&self, other: &Self) -> Self {
        if self.bounds[0] == f32::INFINITY || other.bounds[0] == f32::INFINITY {
            return Self::EMPTY;
        }
        self.joined(other)
    }

    /// Returns the box around both, neither of which may be empty.
    #[inline(always)]
    pub fn joined(&self, other: &Self) -> Self {
        let mut bounds = self.bounds;
        for (mine, theirs) in bounds.iter_mut().zip(&other.bounds) {
            *mine = if *theirs < *mine { *theirs } else { *mine };
        }
        Self { bounds }
    }

    /// Whether the boxes may be within `limit` ([`SweptBox::limit`]): false only if they are farther apart along some axis.
    #[inline(always)]
    pub fn near(&self, other: &Self, limit: f32) -> bool {
        let (a, b) = (&self.bounds, &other.bounds);
        let mut near = true;
        for k in 0..4 {
            near &= (a[k] + b[k + 4] <= limit) & (b[k] + a[k + 4] <= limit);
        }
        near
    }

    /// Returns a distance \[m\] as [`SweptBox::near`] takes it, rounded up; never negative.
    #[inline]
    pub fn limit(distance: f64) -> f32 {
        -below(-(distance.max(0.0) * (1.0 + ROUNDING)))
    }
}

/// Box around points that move straight: boxes at the start and at the end, interpolated in between.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MovingBox {
    start: SweptBox,
    end: SweptBox,
}

impl MovingBox {
    /// Box around nothing.
    pub const EMPTY: Self = Self { start: SweptBox::EMPTY, end: SweptBox::EMPTY };

    /// Returns the box of a point that moves from `start` to `end` \[m\], where all points move by the same fraction of their displacement.
    #[inline]
    pub fn uniform(start: &Vec3, end: &Vec3) -> Self {
        let end = if end.sum().is_finite() { end } else { start };
        Self { start: SweptBox::of_point(start, start), end: SweptBox::of_point(end, end) }
    }

    /// Returns the box of such a point where each moves by any fraction of its displacement.
    #[inline]
    pub fn swept(start: &Vec3, end: &Vec3) -> Self {
        let all = SweptBox::of_point(start, end);
        Self { start: all, end: all }
    }

    /// Returns the box around both; empty if one is ([`SweptBox::with`]).
    #[inline(always)]
    pub fn with(&self, other: &Self) -> Self {
        Self { start: self.start.with(&other.start), end: self.end.with(&other.end) }
    }

    /// Returns the box around both; the other if one is empty.
    #[inline(always)]
    pub fn joined(&self, other: &Self) -> Self {
        Self { start: self.start.joined(&other.start), end: self.end.joined(&other.end) }
    }

    /// Whether the boxes may be within `limit` ([`SweptBox::limit`]) at some moment: false only if at every moment they are farther apart
    /// along some axis. `is_static`: the boxes are the same at both ends.
    #[inline(always)]
    pub fn near(&self, other: &Self, limit: f32, is_static: bool) -> bool {
        if is_static {
            return self.start.near(&other.start, limit);
        }
        let [(a, b), (c, d)] =
            [(&self.start.bounds, &other.start.bounds), (&self.end.bounds, &other.end.bounds)];
        let (mut apart, mut at_start, mut at_end) = (false, true, true);
        for k in 0..4 {
            let first = [a[k] + b[k + 4] <= limit, b[k] + a[k + 4] <= limit];
            let last = [c[k] + d[k + 4] <= limit, d[k] + c[k + 4] <= limit];
            apart |= !(first[0] | last[0]) | !(first[1] | last[1]);
            at_start &= first[0] & first[1];
            at_end &= last[0] & last[1];
        }
        !apart & (at_start | at_end) || !apart && self.meets(other, limit)
    }

    /// Whether there is a moment at which they are near along every axis, where along each axis they are near at the start or the end.
    #[cold]
    fn meets(&self, other: &Self, limit: f32) -> bool {
        let limit = f64::from(limit);
        let (mut from, mut until) = (0.0f64, 1.0f64);
        for k in 0..8 {
            let sum = |a: &SweptBox, b: &SweptBox| f64::from(a.bounds[k]) + f64::from(b.bounds[(k + 4) % 8]);
            let (first, last) = (sum(&self.start, &other.start), sum(&self.end, &other.end));
            let moment = (first - limit) / (first - last);
            if first > limit {
                from = from.max(moment);
            } else if last > limit {
                until = until.min(moment);
            }
        }
        from <= until + MOMENT_ROUNDING
    }
}

/// Rounding of a moment over the duration of the motion [-].
const MOMENT_ROUNDING: f64 = 1e-9;

/// Returns the nearest single-precision number or the one below, never above `value`.
#[inline(always)]
fn below(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) > value { near.next_down() } else { near }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Rng;
    use crate::mesh::distance::edge_edge;

    #[test]
    fn never_calls_near_boxes_far_and_seldom_the_reverse() {
        let mut rng = Rng::from_state(1);
        let (mut wrong, mut tested) = (0, 0);
        for k in 0..100_000 {
            let offset = Vec3::repeat([0.0, 1.0, -30.0][k % 3]);
            let x = [0; 4].map(|_| rng.in_unit_cube() + offset);
            let (one, other) = (SweptBox::of_point(&x[0], &x[1]), SweptBox::of_point(&x[2], &x[3]));
            let distance = edge_edge(&x[0], &x[1], &x[2], &x[3]).distance;
            assert!(one.near(&other, SweptBox::limit(distance)), "{distance}");
            let apart = (0..3)
                .map(|a| {
                    let span = |i: usize| (x[i][a].min(x[i + 1][a]), x[i][a].max(x[i + 1][a]));
                    (span(2).0 - span(0).1).max(span(0).0 - span(2).1)
                })
                .fold(f64::NEG_INFINITY, f64::max);
            wrong += usize::from(apart > 1e-5 && one.near(&other, SweptBox::limit(apart - 1e-5)));
            tested += usize::from(apart > 1e-5);
        }
        assert!(tested > 10_000);
        assert_eq!(wrong, 0, "a box at 30 m is loose by less than 10 micrometres");
    }

    /// Two edges in motion, all points by the same fraction: near at some moment means near boxes, and boxes that are near only at different
    /// moments are not.
    #[test]
    fn moving_boxes_are_near_when_they_meet_and_not_when_one_passes_where_the_other_was() {
        let mut rng = Rng::from_state(2);
        let mut far = 0;
        for _ in 0..20_000 {
            let x = [0; 4].map(|_| rng.in_unit_cube() * 0.1);
            let common = rng.in_cube() * 3.0;
            let y = x.map(|x| x + common + rng.in_cube() * 0.2);
            let at = |t: f64| std::array::from_fn::<Vec3, 4, _>(|i| x[i] + (y[i] - x[i]) * t);
            let of = |i: usize| MovingBox::uniform(&x[i], &y[i]);
            let (one, other) = (of(0).with(&of(1)), of(2).with(&of(3)));
            let nearest = (0..=20)
                .map(|k| {
                    let [a, b, c, d] = at(f64::from(k) / 20.0);
                    edge_edge(&a, &b, &c, &d).distance
                })
                .fold(f64::INFINITY, f64::min);
            assert!(one.near(&other, SweptBox::limit(nearest), false), "{nearest}");
            far += usize::from(!one.near(&other, SweptBox::limit(0.0), false));
        }
        assert!(far > 2_000, "{far}");
        let step = Vec3::new(0.1, 0.0, 0.0);
        let moving = |from: Vec3, to: Vec3| MovingBox::uniform(&from, &to);
        let (first, second) = (moving(Vec3::zeros(), step * 10.0), moving(step, step * 11.0));
        assert!(!first.near(&second, SweptBox::limit(0.09), false), "one behind the other");
        assert!(first.near(&second, SweptBox::limit(0.11), false));
        let across = moving(step * 5.0 + Vec3::y(), step * 5.0 - Vec3::y());
        assert!(first.near(&across, SweptBox::limit(1e-3), false), "both are there in the middle");
        let late = moving(step * 2.0 + Vec3::y(), step * 2.0 - Vec3::y());
        assert!(!first.near(&late, SweptBox::limit(1e-3), false), "the first has passed");
        assert!(!first.near(&MovingBox::EMPTY, f32::MAX, false));
        assert_eq!(first.joined(&MovingBox::EMPTY), first);
    }

    #[test]
    fn boxes_of_points_that_are_not_finite_are_near_nothing() {
        let (a, bad) = (Vec3::x(), Vec3::new(0.0, f64::NAN, 0.0));
        let fine = SweptBox::of_point(&a, &a);
        assert_eq!(SweptBox::of_point(&bad, &a), SweptBox::EMPTY);
        assert_eq!(SweptBox::of_point(&a, &bad), fine);
        assert_eq!(fine.with(&SweptBox::EMPTY), SweptBox::EMPTY);
        assert!(!fine.near(&SweptBox::EMPTY, f32::MAX) && !SweptBox::EMPTY.near(&SweptBox::EMPTY, f32::MAX));
        assert!(fine.near(&fine, 0.0));
        let huge = Vec3::repeat(1e300);
        let vast = SweptBox::of_point(&-huge, &huge);
        assert!(vast.near(&fine, 0.0) && vast.near(&vast, 0.0));
    }
}
