//! Small boxes around moving points, for tests that millions of pairs go through.
//!
//! Kept in single precision, rounded outward, with the high corner negated: two boxes are compared by eight additions
//! and eight comparisons that the compiler does four at a time, and a mesh's boxes stay in the cache. Rounding only
//! ever makes a box larger or a distance smaller, so that no pair is lost.

use crate::math::Vec3;

/// Widening of a limit that swallows the rounding of one subtraction in single precision.
const ROUNDING: f64 = 1e-6;

/// A unit vector's component along each axis for the space diagonal, rounded down: distances never look larger.
const DIAGONAL: f64 = 0.577_350_269;
/// Bound on the rounding of a sum of three coordinates, relative to the largest.
const SUM_ROUNDING: f64 = 1e-15;

/// Axis-aligned box (cut along the space diagonal) around points that move; never smaller than the truth.
#[derive(Debug, Clone, Copy, PartialEq)]
#[repr(align(32))]
pub struct SweptBox {
    /// Least x, y, z and position along the space diagonal \[m\], then the largest, negated. The diagonal has its lane
    /// for nothing and rejects a tenth of the pairs.
    bounds: [f32; 8],
}

impl SweptBox {
    /// Around nothing: near to nothing.
    pub const EMPTY: Self = Self { bounds: [f32::INFINITY; 8] };

    /// Around everything: near to all but nothing.
    pub const EVERYWHERE: Self = Self { bounds: [f32::NEG_INFINITY; 8] };

    /// Around a point that moves straight from `start` to `end` \[m\]. Empty if the start is not finite; an end that is
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

    /// Around both boxes; empty if one is, since then one of its points is nowhere.
    #[inline(always)]
    pub fn with(&self, other: &Self) -> Self {
        if self.bounds[0] == f32::INFINITY || other.bounds[0] == f32::INFINITY {
            return Self::EMPTY;
        }
        self.joined(other)
    }

    /// Around both boxes, neither of which may be empty.
    #[inline(always)]
    pub fn joined(&self, other: &Self) -> Self {
        let mut bounds = self.bounds;
        for (mine, theirs) in bounds.iter_mut().zip(&other.bounds) {
            *mine = if *theirs < *mine { *theirs } else { *mine };
        }
        Self { bounds }
    }

    /// False only if the boxes are more than `reach` apart along some axis ([`SweptBox::reach`]).
    #[inline(always)]
    pub fn near(&self, other: &Self, reach: f32) -> bool {
        let (a, b) = (&self.bounds, &other.bounds);
        let mut near = true;
        for k in 0..4 {
            near &= (a[k] + b[k + 4] <= reach) & (b[k] + a[k + 4] <= reach);
        }
        near
    }

    /// A reach \[m\] as [`SweptBox::near`] takes it, rounded up; never negative.
    #[inline]
    pub fn reach(reach: f64) -> f32 {
        -below(-(reach.max(0.0) * (1.0 + ROUNDING)))
    }
}

/// The nearest single-precision number or the one below, never above `value`.
#[inline(always)]
fn below(value: f64) -> f32 {
    let near = value as f32;
    if f64::from(near) > value { near.next_down() } else { near }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::math::Draw;
    use crate::mesh::distance::edge_edge;

    #[test]
    fn never_calls_near_boxes_far_and_seldom_the_reverse() {
        let mut draw = Draw::from_state(1);
        let (mut wrong, mut tested) = (0, 0);
        for k in 0..100_000 {
            let offset = Vec3::repeat([0.0, 1.0, -30.0][k % 3]);
            let x = [0; 4].map(|_| draw.in_unit_cube() + offset);
            let (one, other) = (SweptBox::of_point(&x[0], &x[1]), SweptBox::of_point(&x[2], &x[3]));
            let distance = edge_edge(&x[0], &x[1], &x[2], &x[3]).distance;
            assert!(one.near(&other, SweptBox::reach(distance)), "{distance}");
            let apart = (0..3)
                .map(|a| {
                    let span = |i: usize| (x[i][a].min(x[i + 1][a]), x[i][a].max(x[i + 1][a]));
                    (span(2).0 - span(0).1).max(span(0).0 - span(2).1)
                })
                .fold(f64::NEG_INFINITY, f64::max);
            wrong += usize::from(apart > 1e-5 && one.near(&other, SweptBox::reach(apart - 1e-5)));
            tested += usize::from(apart > 1e-5);
        }
        assert!(tested > 10_000);
        assert_eq!(wrong, 0, "a box at 30 m is loose by less than 10 micrometres");
    }

    #[test]
    fn what_is_not_finite_is_near_nothing_and_motion_to_nowhere_is_none() {
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
