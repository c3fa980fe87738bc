//! The body a garment is worn on: how it is posed and how it moves. No cloth, no contact, no file.
//!
//! A [`AnimatedBody`] gives the place of every point of the body for every posture: of a skeleton with its skin
//! ([`rig`], linear blend skinning as the glTF 2.0 specification has it, 3.7.3), of a sequence of frames, or the only
//! one it has. `format` makes it from files, actions of `wear` move it, `contact::Body` lets the cloth feel it.
//! Does not do: other skinning (dual quaternions), constraints, drivers, physics of the body itself.

mod animated_body;
pub mod clip;
pub mod rig;
pub mod sequence;
pub mod skeleton;

pub use animated_body::{AnimatedBody, BodyMotion, BodyPose, FRAMES_CLIP, PosedBody, interpolate_body_pose};
pub use sequence::Sequence;
