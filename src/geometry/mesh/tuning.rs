//! Tuning constants of the mesh algorithms: each with its quantity and reason.

/// All tuning constants of this folder.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MeshTuning {
    /// Fraction of the gap above the minimum distance that is left when a pair is stopped (s of ACCD; there 0.1) [-].
    pub ccd_kept_gap: f64,
    /// Fraction of the gap that a free motion keeps at least [-]. Below `ccd_kept_gap`, so that a motion once cut short is found free when it
    /// is tested again.
    pub ccd_free_gap: f64,
    /// Fraction of the gap above the level at which conservative advancement ends [-].
    pub ccd_gap_tol: f64,
    /// Largest number of advancement steps; five are usual. What was reached is the answer then.
    pub ccd_max_steps: usize,
    /// Squared sine of a corner angle below which a triangle is searched as three edges [-] (angle 1e-10).
    pub max_sliver_squared_sine: f64,
    /// Squared sine of the angle below which two edges count as parallel [-] (angle 1e-8: over a centimetre, 0.1 nm).
    pub max_parallel_squared_sine: f64,
    /// Motion of a point over the mean box size after which the triangle hierarchy is rebuilt [-]: refitted boxes overlap too much by then.
    pub bvh_rebuild_motion: f64,
    /// Growth of boxes over the mean box size when the triangle hierarchy is built [-]. Splits are judged by volume, and the boxes of a garment
    /// that lies flat would have none.
    pub bvh_build_growth: f64,
    /// Largest number of triangles in a leaf of the static hierarchy.
    pub bvh_leaf_size: usize,
    /// Number of pairs of nodes into which a search of the static hierarchy is divided.
    pub bvh_search_parts: usize,
    /// Number of them that one task searches: lists that are allocated by one thread and freed by another are expensive.
    pub bvh_parts_per_task: usize,
    /// Number of pairs of triangles that a task has room for at first.
    pub bvh_pairs_per_task: usize,
    /// Winding number above which a point counts as inside [-].
    pub min_inside_winding: f64,
    /// Area of the openings of a sheet over its own above which it has no outside [-]: a hemisphere has 0.5, a trunk without
    /// head, arms and legs 0.2.
    pub max_opening_fraction: f64,
    /// Enclosed volume over area to the power 1.5 below which a sheet has no outside [-]: a sphere has 0.09, an arm 20 times
    /// as long as wide 0.03, two layers 1 m wide and 5 mm apart 0.002.
    pub min_volume_fraction: f64,
}

impl MeshTuning {
    /// The values in use.
    pub const DEFAULT: Self = Self {
        ccd_kept_gap: 0.08,
        ccd_free_gap: 0.03,
        ccd_gap_tol: 0.02,
        ccd_max_steps: 64,
        max_sliver_squared_sine: 1e-20,
        max_parallel_squared_sine: 1e-16,
        bvh_rebuild_motion: 2.0,
        bvh_build_growth: 0.05,
        bvh_leaf_size: 4,
        bvh_search_parts: 256,
        bvh_parts_per_task: 16,
        bvh_pairs_per_task: 4096,
        min_inside_winding: 0.5,
        max_opening_fraction: 0.3,
        min_volume_fraction: 0.002,
    };
}

/// The constants that the mesh algorithms read.
pub(crate) const TUNING: MeshTuning = MeshTuning::DEFAULT;
