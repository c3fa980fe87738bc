//! Constants of carrying memory between meshes.

/// What counts as shown by a simulation mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct ResolvedTuning {
    /// Smallest radius of curvature that stays [edges], default 2.2: hinges between equilateral triangles bent by 23 degrees.
    pub min_radius_edges: f64,
    /// Rounds in which the excess is averaged over a ring of triangles, default 2: after one, 0.9 % of the hinge length at an elbow
    /// still bends by over 45 degrees, after two 0.03 %.
    pub rounds: usize,
}

/// Sampling, smoothing and fit of a carried memory.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct CarryTuning {
    /// Fraction of the curvature that is spread over a ring of triangles [-], default 0.5: without, creases on coarse triangles
    /// zigzag; all of it would blur them.
    pub spread_fraction: f64,
    /// The part of a memory that a simulation mesh can show.
    pub resolved: ResolvedTuning,
    /// Parts along a side into which a triangle is cut whose curvature is spread over another mesh, default 6.
    pub scatter_parts: u32,
    /// Samples along a target side per source side [-], default 2: no source triangle is stepped over.
    pub samples_per_source_side: f64,
    /// Smallest number of samples along a side of a target triangle, default 3.
    pub min_samples_per_side: f64,
    /// Largest number of samples along a side of a target triangle, default 24: bounds the work per triangle.
    pub max_samples_per_side: f64,
    /// Residual at which the fit of hinge angles stops, relative to the right-hand side [-], default 1e-10. The matrix is
    /// well conditioned (the three hinges of a face are independent), so this takes some tens of iterations.
    pub hinge_fit_residual_tol: f64,
    /// Largest number of conjugate gradient iterations of that fit, default 2000: a bound that is not reached in practice.
    pub max_hinge_fit_iterations: usize,
    /// Enclosed volume relative to area times size below which its sign says nothing [-], default 1e-3.
    pub min_enclosed_volume_ratio: f64,
}

/// The constants in use.
pub(super) const TUNING: CarryTuning = CarryTuning {
    spread_fraction: 0.5,
    resolved: ResolvedTuning { min_radius_edges: 2.2, rounds: 2 },
    scatter_parts: 6,
    samples_per_source_side: 2.0,
    min_samples_per_side: 3.0,
    max_samples_per_side: 24.0,
    hinge_fit_residual_tol: 1e-10,
    max_hinge_fit_iterations: 2000,
    min_enclosed_volume_ratio: 1e-3,
};
