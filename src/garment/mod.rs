//! The nouns that flow through the pipeline: the garment, its memory, its state, the worn result.

mod finding;
mod garment_type;
mod rest_shape;
mod worn;

pub use finding::{Finding, Severity};
pub use garment_type::Garment;
pub use rest_shape::RestShape;
pub use worn::WornGarment;
