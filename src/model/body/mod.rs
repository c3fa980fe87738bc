//! The body a garment is worn on: its poses and its motion. No cloth, no contact, no file.
//!
//! An [`AnimatedBody`] gives the position of every point of the body in every pose: of a skeleton with its skin
//! ([`rig`], linear blend skinning as in the glTF 2.0 specification, 3.7.3), of a sequence of frames, or of a body that
//! does not move. `io` makes it from files, actions of `wear` pose it, `contact` keeps the cloth outside it. Not covered:
//! other skinning (dual quaternions), constraints, drivers, physics of the body itself.

mod animated_body;
pub mod clip;
mod clip_jumps;
mod fit;
mod garment_skin;
mod layers;
mod lookup;
pub mod rig;
mod root_motion;
pub mod sequence;
pub mod skeleton;

pub use animated_body::{AnimatedBody, BodyMotion, BodyPose, FRAMES_CLIP, PosedBody, interpolate_body_pose};
pub use clip_jumps::ClipJump;
pub use garment_skin::{GarmentSkin, SkinLocation};
pub use lookup::LookupError;
pub use root_motion::RootMotion;
pub use sequence::Sequence;
