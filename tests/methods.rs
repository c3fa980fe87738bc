//! The methods of the shelf against independent numbers: orders, strips that swing, and where methods fail.
//!
//! Scenes are those of `crease chart accuracy` and `stability` (`chart::trial`); references that were computed by other
//! means stand beside each test, whole tables are read from the folder `reference` of `CREASE_TEST_DATA` where that is set. Every
//! test prints the figure it reached; `docs/validation/accuracy.md` lists them.
//!
//! ```text
//! cargo test --test methods NAME -- --nocapture
//! ```

#[path = "methods/constraints.rs"]
mod constraints;
#[path = "methods/elements.rs"]
mod elements;
#[path = "methods/maps.rs"]
mod maps;
#[path = "methods/orders.rs"]
mod orders;
#[path = "elastic/reference.rs"]
mod reference;
#[path = "methods/strips.rs"]
mod strips;
