//! BDF2 with variable steps (physics.md 4.2): with r = h2 / h1 and y' = f,
//!
//! ```text
//! y2 = [ (1 + r)² y1 - r² y0 + (1 + r) h2 f2 ] / (1 + 2 r)
//! ```

use super::Stage;
use crate::solve::{Previous, State};

pub(super) fn stage(state: &State, previous: &Previous, h: f64) -> Stage {
    let r = h / previous.step;
    let (now, before) = ((1.0 + r).powi(2) / (1.0 + 2.0 * r), r * r / (1.0 + 2.0 * r));
    let mix = |a: &[_], b: &[_]| {
        a.iter().zip(b).map(|(a, b): (&nalgebra::Vector3<f64>, _)| a * now - b * before).collect()
    };
    Stage {
        base: mix(&state.x, &previous.x),
        drift: mix(&state.v, &previous.v),
        span: (1.0 + r) / (1.0 + 2.0 * r) * h,
    }
}
