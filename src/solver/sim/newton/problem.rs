//! The incremental potential of one implicit problem: value and gradient.

use crate::contact::Contact;
use crate::energy::Energy;
use crease_geometry::math::{Vec3, dot};
use rayon::prelude::*;

/// The inertia term `|x - inertial|²_M / (2 effective_dt²)` of one implicit problem.
#[derive(Debug, Clone, Copy)]
pub struct Inertia<'a> {
    /// Masses, one per point [kg].
    pub mass: &'a [f64],
    /// Positions without forces, one per point [m].
    pub inertial: &'a [Vec3],
    /// Effective time step [s].
    pub effective_dt: f64,
}

/// A minimisation problem over the free points.
pub struct Problem<'a> {
    /// Inertia; `None` for equilibria.
    pub inertia: Option<Inertia<'a>>,
    /// Energies.
    pub terms: &'a [&'a dyn Energy],
    /// Points with prescribed positions, one flag per point.
    pub fixed: &'a [bool],
    /// Predicted positions of the solution [m]: the first direction uses the secant Hessian towards them. They change
    /// how fast the iterations converge, not the solution.
    pub predicted_positions: Option<&'a [Vec3]>,
}

/// Value of the incremental potential phi.
#[derive(Debug, Clone, Copy)]
pub(super) struct Potential {
    /// phi [J].
    pub sum: f64,
    /// Sum of the magnitudes of its terms [J], which bounds the rounding of `sum`.
    pub magnitude: f64,
}

impl Potential {
    fn add(&mut self, term: f64) {
        self.sum += term;
        self.magnitude += term.abs();
    }
}

impl Problem<'_> {
    /// Returns phi at `x`.
    pub(super) fn value(&self, x: &[Vec3], contact: &Contact) -> Potential {
        let mut value = Potential { sum: 0.0, magnitude: 0.0 };
        if let Some(Inertia { mass, inertial, effective_dt }) = self.inertia {
            let moved: f64 = x
                .iter()
                .zip(inertial)
                .zip(mass)
                .zip(self.fixed)
                .filter(|(_, fixed)| !**fixed)
                .map(|(((x, y), m), _)| m * (x - y).norm_squared())
                .sum();
            value.add(moved / (2.0 * effective_dt * effective_dt));
        }
        let terms = || self.terms.par_iter().map(|term| term.value(x)).collect::<Vec<f64>>();
        let (terms, contact) = rayon::join(terms, || contact.value(x));
        terms.into_iter().for_each(|term| value.add(term));
        value.add(contact);
        value
    }

    /// Returns the gradient of phi at `x`, one per point [N]; zero at fixed points.
    pub(super) fn gradient(&self, x: &[Vec3], contact: &Contact) -> Vec<Vec3> {
        let mut g = vec![Vec3::zeros(); x.len()];
        if let Some(Inertia { mass, inertial, effective_dt }) = self.inertia {
            for (((g, x), y), m) in g.iter_mut().zip(x).zip(inertial).zip(mass) {
                *g += (x - y) * (m / (effective_dt * effective_dt));
            }
        }
        let none = || vec![Vec3::zeros(); x.len()];
        let of_term = |term: &&dyn Energy| {
            let mut g = none();
            term.add_gradient(x, &mut g);
            g
        };
        let of_contact = || {
            let mut g = none();
            contact.add_gradient(x, &mut g);
            g
        };
        let (terms, contact) =
            rayon::join(|| self.terms.par_iter().map(of_term).collect::<Vec<_>>(), of_contact);
        for term in terms.iter().chain([&contact]) {
            g.iter_mut().zip(term).for_each(|(g, term)| *g += term);
        }
        g.iter_mut().zip(self.fixed).filter(|(_, fixed)| **fixed).for_each(|(g, _)| *g = Vec3::zeros());
        g
    }

    /// Returns the slope of phi at `x` along `d` [J].
    pub(super) fn slope(&self, x: &[Vec3], d: &[Vec3], contact: &Contact) -> f64 {
        dot(&self.gradient(x, contact), d)
    }
}
