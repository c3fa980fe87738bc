//! Integrators compared with independent results: orders of convergence, swinging strips, and failures.
//!
//! Scenes are those of `crease chart accuracy` and `stability` (`chart::scenes`) and of `robustness`; references of other origin are
//! given with each test, whole tables are read from the folder `reference` of `CREASE_TEST_DATA` by tests of their own.
//! Every test prints its result; `docs/validation/accuracy.md` lists them.
//!
//! ```text
//! cargo test --test methods NAME -- --nocapture
//! ```

#[path = "methods/bakes.rs"]
mod bakes;
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
