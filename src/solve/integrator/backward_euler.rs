//! Backward Euler: x1 = x0 + h v1, M (v1 - v0) = h F(x1).

use super::Stage;
use crate::solve::State;

pub(super) fn stage(state: &State, h: f64) -> Stage {
    Stage { base: state.x.clone(), drift: state.v.clone(), span: h }
}
