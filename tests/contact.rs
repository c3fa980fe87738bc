//! Layers that never cross: contact of cloth with itself, with the ground and with a body, through the public interface.
//!
//! After every accepted step of every scene the intersecting triangles are counted by `mesh::intersections`, exact predicates
//! independent of the code that prevents intersections but for the bounding-volume hierarchy. Starts are jittered. The same scenes at
//! full size and with more starts: `cargo run --release --example contact_scenes`.
//!
//! ```text
//! cargo test --test contact NAME -- --nocapture
//! ```

#[path = "contact/bakes.rs"]
mod bakes;
#[path = "contact/friction.rs"]
mod friction;
#[path = "contact/initial_intersections.rs"]
mod initial_intersections;
#[path = "contact/layers.rs"]
mod layers;
#[path = "contact/on_body.rs"]
mod on_body;
#[path = "contact/pins.rs"]
mod pins;
#[path = "contact/refined_frames.rs"]
mod refined_frames;
#[path = "contact/run.rs"]
mod run;
#[path = "contact/shapes.rs"]
mod shapes;
#[path = "contact/shots.rs"]
mod shots;
