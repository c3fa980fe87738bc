//! Pictures of a garment: a small software rasteriser.
//!
//! ```text
//! points, triangles -> camera (projection) -> raster (triangle seen by each sample)
//!                   -> shade (light, occlusion, shadow on the ground) -> legend -> image -> PNG
//! ```
//!
//! A picture shows the shape alone, or a field on it: change of rest angle in degrees, curvature in 1/m, stiffness ratio,
//! displacement in mm. The colours of fields are safe for colour-blind readers, and the legend has the unit. A picture
//! shows a single surface without textures.

mod camera;
mod caption;
mod colour;
mod draw;
mod field;
pub mod font;
mod image;
mod lights;
mod occlusion;
mod raster;
mod shade;
mod shadow;
mod surface;
#[cfg(test)]
pub(crate) mod test_shapes;

pub(in crate::report) use camera::is_viewed_from_above;
pub use camera::{Camera, CameraView, Focus};
pub use caption::{one_above_the_other, side_by_side};
pub use colour::ColourMap;
pub use draw::{MAX_SIDE, render, render_shaded};
pub use field::{Colouring, Field, Values, curvature, largest_of_hinges, mean_of_hinges};
pub use image::{Image, encode_apng, encode_png};
pub(in crate::report) use surface::smooth_corner_normals;
