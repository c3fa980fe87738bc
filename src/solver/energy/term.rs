//! The interface of an energy term, and what assembles its Hessian.

use crate::energy::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_linear::BlockSink;
use rayon::prelude::*;

/// An energy over the points of a mesh.
pub trait Energy: Sync {
    /// Name of the term for messages.
    fn name(&self) -> &'static str;
    /// Returns the energy [J] at positions `x` [m], one per point.
    fn value(&self, x: &[Vec3]) -> f64;
    /// Adds the gradient [N] at `x` to `out`, one entry per point.
    fn add_gradient(&self, x: &[Vec3], out: &mut [Vec3]);
    /// Adds a positive semi-definite Hessian [N/m] at `x`.
    fn add_hessian(&self, x: &[Vec3], out: &mut dyn BlockSink);
    /// Adds a positive semi-definite secant Hessian [N/m] for the path that begins at `x` and has its middle near
    /// `midpoint` [m]: its product with the displacement approximates the difference of the gradients at both ends.
    /// Where elements rotate along the path, the error is of third order in the angle; that of the Hessian at `x` is of
    /// second. The default is the Hessian at `x`, for terms whose elements do not rotate.
    fn add_secant_hessian(&self, x: &[Vec3], _midpoint: &[Vec3], out: &mut dyn BlockSink) {
        self.add_hessian(x, out);
    }
    /// Visits every group of points that the Hessian couples.
    fn visit_stencils(&self, _visit: &mut dyn FnMut(&[u32])) {}
    /// Returns the term of those elements that contain at least one of `points` (one flag per point). Gradient and
    /// Hessian of these points are unchanged, and the value changes by the same amount when they move. `None` where the
    /// whole term is cheap enough.
    fn restricted_to(&self, _points: &[bool]) -> Option<Box<dyn Energy + '_>> {
        None
    }
}

/// Terms without what exerts no force on some points.
pub(crate) struct RestrictedTerms<'a> {
    whole: &'a [&'a dyn Energy],
    parts: Vec<Option<Box<dyn Energy + 'a>>>,
}

impl<'a> RestrictedTerms<'a> {
    /// Restricts the terms `whole` to the flagged `points`.
    pub fn new(whole: &'a [&'a dyn Energy], points: &[bool]) -> Self {
        Self { whole, parts: whole.iter().map(|term| term.restricted_to(points)).collect() }
    }

    /// The terms, whole where they cannot be restricted.
    pub fn terms(&self) -> Vec<&dyn Energy> {
        self.whole.iter().zip(&self.parts).map(|(whole, part)| part.as_deref().unwrap_or(*whole)).collect()
    }
}

/// Sums a function of every element and its index, in the same order for any number of threads.
pub(super) fn sum_of<T: Sync>(elements: &[T], of: impl Fn((usize, &T)) -> f64 + Sync) -> f64 {
    const CHUNK: usize = TUNING.elements_per_task;
    let part = |(k, part): (usize, &[T])| {
        let numbered = part.iter().enumerate().map(|(i, element)| (k * CHUNK + i, element));
        numbered.map(&of).sum::<f64>()
    };
    elements.par_chunks(CHUNK).enumerate().map(part).collect::<Vec<f64>>().into_iter().sum()
}
