//! Terms that depend on who is near: candidates, response, friction, the bound that keeps layers apart.

pub mod bound;
pub mod candidates;
