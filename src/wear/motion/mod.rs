//! Motions of points and bodies in time, and the springs that carry points along.

pub(crate) mod body_motion;
pub(crate) mod motion_profile;
pub(crate) mod slowed_jumps;
pub(crate) mod springs;
