//! The memory law under stress, through the public interface: every property that `docs/theory/memory.md` states is a test
//! over a table. Each prints the figure it reached:
//!
//! ```text
//! cargo test --test memory NAME -- --nocapture
//! ```

#[path = "common/hessian_shift.rs"]
mod hessian_shift;
#[path = "memory/hinge.rs"]
mod hinge;
#[path = "memory/law.rs"]
mod law;
#[path = "memory/scene.rs"]
mod scene;
#[path = "memory/strip.rs"]
mod strip;
