//! The elastic solver against independent numbers, through the public interface only.
//!
//! The references were computed by other means than this crate (closed forms, shooting, 50-digit arithmetic, a
//! shell solver in Python): the constants that a fresh clone needs are nailed down beside each test, whole tables are
//! read from the folder `reference` of `CREASE_TEST_DATA` by tests of their own. Every test prints the figure it reached;
//! `docs/validation/accuracy.md` lists them.
//!
//! ```text
//! cargo test --test elastic NAME -- --nocapture
//! ```

#[path = "elastic/buckling.rs"]
mod buckling;
#[path = "elastic/cantilever.rs"]
mod cantilever;
#[path = "elastic/guided.rs"]
mod guided;
#[path = "common/hessian_shift.rs"]
mod hessian_shift;
#[path = "elastic/hinge.rs"]
mod hinge;
#[path = "elastic/hinge_hessian.rs"]
mod hinge_hessian;
#[path = "elastic/lateral.rs"]
mod lateral;
#[path = "elastic/membrane.rs"]
mod membrane;
#[path = "elastic/motion.rs"]
mod motion;
#[path = "elastic/patch.rs"]
mod patch;
#[path = "elastic/reference.rs"]
mod reference;
#[path = "elastic/rest.rs"]
mod rest;
#[path = "elastic/sewing.rs"]
mod sewing;
#[path = "elastic/sheet.rs"]
mod sheet;
