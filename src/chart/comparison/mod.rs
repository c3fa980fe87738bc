//! Time integrators that charts compare with those of the library; no bake offers them.
//!
//! Each is a [`MethodSpec`](crease_solver::sim::MethodSpec) for the stepper of a bake, with the energies, contact and
//! memory of a bake.

mod single_newton;
mod vertex_block_descent;

use crease_solver::sim::Method;

/// Backward Euler with one Newton iteration.
pub const BACKWARD_EULER_ONCE: Method = Method::Custom(&single_newton::BACKWARD_EULER_ONCE);
/// BDF2 with one Newton iteration.
pub const BDF2_ONCE: Method = Method::Custom(&single_newton::BDF2_ONCE);
/// Vertex block descent.
pub const VERTEX_BLOCK_DESCENT: Method = Method::Custom(&vertex_block_descent::SPEC);

/// All compared methods in the order of tables, those of the library included.
pub const METHODS: &[Method] = &[
    BACKWARD_EULER_ONCE,
    Method::BackwardEuler,
    BDF2_ONCE,
    Method::Bdf2,
    Method::Sdirk2,
    VERTEX_BLOCK_DESCENT,
];

/// Whether `method` looks like cloth without converging to the physics.
pub fn is_visual(method: Method) -> bool {
    method == VERTEX_BLOCK_DESCENT
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_method_of_the_library_is_compared_and_names_are_distinct() {
        assert!(Method::ALL.iter().all(|method| METHODS.contains(method)));
        for (k, method) in METHODS.iter().enumerate() {
            assert!(!METHODS[..k].contains(method), "{}", method.name());
            assert_eq!(is_visual(*method), method.description().contains("VISUAL"), "{}", method.name());
        }
    }
}
