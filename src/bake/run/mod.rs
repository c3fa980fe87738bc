//! First phase of a bake: the script performed action by action and step by step.
//!
//! `setup` makes the state, `simulate` runs `action_loop` over it: loads of the action -> time step -> memory; `refinement` bisects
//! triangles between steps. `lay_first` performs a leading `lay`, `trims` carries buttons along. `checkpoint` is an interrupted run,
//! `observer` what watches it, `frames` the garment over time. `findings`, `violation_log` and `initial_intersections` collect what
//! the report says. `from_motion` replaces the phase by a motion that already exists.

pub(super) mod action_loop;
pub mod checkpoint;
pub(super) mod findings;
pub(super) mod frames;
pub(super) mod from_motion;
pub(super) mod initial_intersections;
pub(super) mod lay_first;
pub(super) mod observer;
pub(super) mod refinement;
pub(super) mod running_bake;
pub(super) mod setup;
pub(super) mod simulate;
pub(super) mod trims;
pub(super) mod violation_log;
