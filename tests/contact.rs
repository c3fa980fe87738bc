//! Layers that never cross: contact of cloth with itself, with the ground and with a body, through the public interface.
//!
//! After every accepted step of every scene the crossing triangles are counted by `mesh::intersections`, exact predicates
//! that share nothing with the code that prevents crossings but the box tree. Starts are jittered. The same scenes at
//! full size and with more starts: `cargo run --release --example contact_scenes`.
//!
//! ```text
//! cargo test --test contact NAME -- --nocapture
//! ```

#[path = "contact/bakes.rs"]
mod bakes;
#[path = "contact/entangled.rs"]
mod entangled;
#[path = "contact/friction.rs"]
mod friction;
#[path = "contact/layers.rs"]
mod layers;
#[path = "contact/on_body.rs"]
mod on_body;
#[path = "contact/pins.rs"]
mod pins;
#[path = "contact/run.rs"]
mod run;
#[path = "contact/shapes.rs"]
mod shapes;
#[path = "contact/shots.rs"]
mod shots;
#[path = "contact/stick_slip.rs"]
mod stick_slip;
