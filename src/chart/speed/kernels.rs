//! Kernels that bound the speed of a bake, each measured alone.

use crate::statistics::median;
use crate::test_sheet::TestSheet;
use crease_geometry::math::{Mat3, Vec3};
use crease_geometry::mesh::PointIndex;
use crease_geometry::mesh::triangle_bvh::TriangleBvh;
use crease_linear::{BlockMatrix, BlockSink, Cholesky};
use crease_model::error::Result;
use std::time::Instant;

/// Numbers that the streaming copy moves: far more than fit into caches.
const STREAM_LENGTH: usize = 1 << 24;
/// Side of the sheet [m].
const SHEET_SIDE: f64 = 0.7;
/// Distance of two layers in contact, and margin of the boxes [m].
const LAYER_DISTANCE: f64 = 0.65e-3;

/// Times and rates of the kernels on sheets of one size.
pub(super) struct Kernels {
    /// Number of points of the sheet.
    pub points: usize,
    /// Streaming copy [bytes/s].
    pub copy: f64,
    /// Time of the sparse matrix-vector product [s].
    product: f64,
    /// Bytes of the matrix.
    matrix_bytes: f64,
    /// Time of the factorisation [s].
    pub factor: f64,
    /// Time of the triangular solves [s].
    solve: f64,
    /// Multiplications of the factorisation.
    multiplications: f64,
    /// Time of one search for overlaps of two layers in contact [s].
    pub search: f64,
    /// Pairs of triangles found by the search.
    pair_count: usize,
}

impl Kernels {
    /// Measures the kernels on sheets of about `points` points; medians of `runs`.
    ///
    /// # Errors
    /// If the sheet cannot be meshed or its system not be solved, which does not happen.
    pub fn measure(points: usize, runs: usize) -> Result<Self> {
        let (matrix, positions) = sheet_system(points)?;
        let rows = matrix.row_count();
        let from: Vec<f64> = (0..STREAM_LENGTH).map(|k| k as f64).collect();
        let mut to = vec![0.0; STREAM_LENGTH];
        let copy = time_of(runs, || to.copy_from_slice(std::hint::black_box(&from)));
        std::hint::black_box(&to);
        let x = vec![Vec3::new(1.0, 2.0, 3.0); rows];
        let mut y = vec![Vec3::zeros(); rows];
        let product = time_of(runs, || matrix.multiply(std::hint::black_box(&x), &mut y));
        let mut direct = Cholesky::default();
        // The first factorisation includes the symbolic analysis.
        let fails =
            |_| crease_model::error::Error::input("chart", "speed", "a sheet's system is not positive", "");
        direct.factorise(&matrix, &positions).map_err(fails)?;
        let mut is_solved = true;
        let factor = time_of(runs, || is_solved &= direct.factorise(&matrix, &positions).is_ok());
        let solve = time_of(runs, || is_solved &= direct.solve(&matrix, &mut x.clone()).is_ok());
        if !is_solved {
            return Err(crease_model::error::Error::input(
                "chart",
                "speed",
                "a sheet's system could not be solved",
                "",
            ));
        }
        let (points_of_layers, triangles) = two_layers(points)?;
        let mut tree = TriangleBvh::new(&points_of_layers, &triangles, LAYER_DISTANCE);
        let mut pair_count = 0;
        let search = time_of(runs, || {
            tree.refit(&points_of_layers, std::hint::black_box(&points_of_layers), LAYER_DISTANCE);
            pair_count = tree.overlapping_pairs().len();
        });
        Ok(Self {
            points: rows,
            copy: (2 * STREAM_LENGTH * size_of::<f64>()) as f64 / copy,
            product,
            matrix_bytes: matrix.bytes(),
            factor,
            solve,
            multiplications: direct.size().multiplications,
            search,
            pair_count,
        })
    }

    /// Floating-point rate of the factorisation [1/s].
    pub fn rate(&self) -> f64 {
        2.0 * self.multiplications / self.factor
    }

    /// Name and time of every kernel [s].
    pub fn rows(&self) -> [(&'static str, f64); 4] {
        [
            ("kernel: sparse product", self.product),
            ("kernel: factorisation", self.factor),
            ("kernel: solution", self.solve),
            ("kernel: search", self.search),
        ]
    }

    /// Results in words.
    pub fn note(&self) -> String {
        format!(
            "kernels at {} points: copy {:.1} GB/s; sparse product {:.2} ms, {:.1} GB/s of matrix; factorisation {:.1} ms, {:.0} GFlop/s; solution {:.1} ms; search of two layers {:.1} ms, {} pairs of triangles",
            self.points,
            self.copy / 1e9,
            1e3 * self.product,
            self.matrix_bytes / self.product / 1e9,
            1e3 * self.factor,
            self.rate() / 1e9,
            1e3 * self.solve,
            1e3 * self.search,
            self.pair_count
        )
    }
}

/// System of a flat sheet: springs along every edge and across every hinge, and mass.
fn sheet_system(points: usize) -> Result<(BlockMatrix, Vec<Vec3>)> {
    let garment = TestSheet::unstructured(SHEET_SIDE, SHEET_SIDE, points)?.flat_garment();
    let count = garment.points.len();
    let hinges: Vec<[u32; 4]> = garment.topology.hinges.iter().map(|h| h.points.map(|p| p.0)).collect();
    let mut matrix = BlockMatrix::with_pattern((0..count as u32).collect(), &mut |visit| {
        hinges.iter().for_each(|points| visit(points));
    });
    for [a, b, c, d] in &hinges {
        for (p, q) in [(a, b), (c, d), (a, c), (b, d)] {
            let along = (garment.points[*q as usize] - garment.points[*p as usize]).normalize();
            let block = along * along.transpose() * 100.0 + Mat3::identity();
            // Only blocks on and below the diagonal are stored.
            for (i, j, sign) in [(p, p, 1.0), (q, q, 1.0), (p.max(q), p.min(q), -1.0)] {
                matrix.add(*i, *j, &(block * sign));
            }
        }
    }
    (0..count).for_each(|p| matrix.add_diagonal(p, 1.0));
    Ok((matrix, garment.points))
}

/// Two flat layers in contact, of about `points` points in all.
fn two_layers(points: usize) -> Result<(Vec<Vec3>, Vec<[PointIndex; 3]>)> {
    let layer = TestSheet::unstructured(SHEET_SIDE, SHEET_SIDE, points / 2)?.flat_garment();
    let count = layer.points.len() as u32;
    // The normal of the flat sheet.
    let up = Vec3::y() * LAYER_DISTANCE;
    let above = layer.points.iter().map(|p| p + up);
    let shifted = layer.triangles.iter().map(|t| t.map(|p| PointIndex(p.0 + count)));
    Ok((
        layer.points.iter().copied().chain(above).collect(),
        layer.triangles.iter().copied().chain(shifted).collect(),
    ))
}

/// Median time of `runs` runs of `work` [s].
fn time_of(runs: usize, mut work: impl FnMut()) -> f64 {
    let times = (0..runs.max(1)).map(|_| {
        let clock = Instant::now();
        work();
        clock.elapsed().as_secs_f64()
    });
    median(times).unwrap_or(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn kernels_solve_their_systems() {
        let (matrix, positions) = sheet_system(300).unwrap();
        let x: Vec<Vec3> = positions.iter().map(|p| Vec3::new(p.x, 1.0, p.z)).collect();
        let mut y = vec![Vec3::zeros(); x.len()];
        matrix.multiply(&x, &mut y);
        let mut direct = Cholesky::default();
        direct.factorise(&matrix, &positions).unwrap();
        direct.solve(&matrix, &mut y).unwrap();
        let off = x.iter().zip(&y).map(|(a, b)| (a - b).amax()).fold(0.0, f64::max);
        assert!(off < 1e-6, "{off}");
        let kernels = Kernels::measure(300, 1).unwrap();
        assert!(kernels.factor > 0.0 && kernels.multiplications > 0.0 && kernels.copy > 0.0);
        // Every triangle is paired with the one above it.
        let (points, triangles) = two_layers(300).unwrap();
        let half = triangles.len() as u32 / 2;
        let pairs = TriangleBvh::new(&points, &triangles, LAYER_DISTANCE).overlapping_pairs();
        let found = |f: u32| pairs.iter().any(|pair| pair.contains(&f) && pair.contains(&(f + half)));
        assert!((0..half).all(found));
    }
}
