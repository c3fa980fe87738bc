//! What the machine can do: kernels that bound a bake, each measured alone.

use crate::chart::median;
use crate::chart::test_sheet::Sheet;
use crate::energy::BlockSink;
use crate::error::Result;
use crate::math::{Mat3, Vec3};
use crate::mesh::PointIndex;
use crate::mesh::triangle_bvh::TriangleBvh;
use crate::sim::{BlockMatrix, Cholesky};
use std::time::Instant;

/// Numbers that the streaming copy moves: far more than caches hold.
const STREAM: usize = 1 << 24;
/// Side of the kernels' sheet [m].
const SHEET: f64 = 0.7;
/// Distance of two layers that touch, and how far boxes reach [m].
const LAYER: f64 = 0.65e-3;

/// What the machine can do with a sheet.
pub(super) struct Kernels {
    /// Points of the sheet.
    pub points: usize,
    /// Streaming copy [bytes/s].
    pub copy: f64,
    /// Sparse product [s], and the bytes it reads.
    product: (f64, f64),
    /// Factorisation and solution [s], and multiplications of the former.
    pub factor: f64,
    solve: f64,
    work: f64,
    /// One search of two layers that touch [s], and pairs of triangles that it finds.
    pub search: f64,
    near: usize,
}

impl Kernels {
    /// Measures them on sheets of about `points` points; medians of `runs`.
    pub fn measure(points: usize, runs: usize) -> Result<Self> {
        let (matrix, places) = sheet_system(points)?;
        let rows = matrix.row_count();
        let from: Vec<f64> = (0..STREAM).map(|k| k as f64).collect();
        let mut to = vec![0.0; STREAM];
        let copy = time_of(runs, || to.copy_from_slice(std::hint::black_box(&from)));
        std::hint::black_box(&to);
        let x = vec![Vec3::new(1.0, 2.0, 3.0); rows];
        let mut y = vec![Vec3::zeros(); rows];
        let product = time_of(runs, || matrix.multiply(std::hint::black_box(&x), &mut y));
        let mut direct = Cholesky::default();
        // The first one finds the order of elimination.
        let fails = |_| crate::Error::input("chart", "speed", "a sheet's system is not positive", "");
        direct.factorise(&matrix, &places).map_err(fails)?;
        let mut sound = true;
        let factor = time_of(runs, || sound &= direct.factorise(&matrix, &places).is_ok());
        let solve = time_of(runs, || sound &= direct.solve(&matrix, &mut x.clone()).is_ok());
        if !sound {
            return Err(crate::Error::input("chart", "speed", "a sheet's system could not be solved", ""));
        }
        let (points_of_layers, triangles) = two_layers(points)?;
        let mut tree = TriangleBvh::new(&points_of_layers, &triangles, LAYER);
        let mut near = 0;
        let search = time_of(runs, || {
            tree.refit(&points_of_layers, std::hint::black_box(&points_of_layers), LAYER);
            near = tree.overlapping_pairs().len();
        });
        Ok(Self {
            points: rows,
            copy: (2 * STREAM * size_of::<f64>()) as f64 / copy,
            product: (product, matrix.bytes()),
            factor,
            solve,
            work: direct.size().0,
            search,
            near,
        })
    }

    /// Operations of the factorisation in a second.
    pub fn rate(&self) -> f64 {
        2.0 * self.work / self.factor
    }

    /// Name and time [s] of each.
    pub fn rows(&self) -> [(&'static str, f64); 4] {
        [
            ("kernel: sparse product", self.product.0),
            ("kernel: factorisation", self.factor),
            ("kernel: solution", self.solve),
            ("kernel: search", self.search),
        ]
    }

    /// In words.
    pub fn note(&self) -> String {
        format!(
            "kernels at {} points: copy {:.1} GB/s; sparse product {:.2} ms, {:.1} GB/s of matrix; factorisation {:.1} ms, {:.0} GFlop/s; solution {:.1} ms; search of two layers {:.1} ms, {} pairs of triangles",
            self.points,
            self.copy / 1e9,
            1e3 * self.product.0,
            self.product.1 / self.product.0 / 1e9,
            1e3 * self.factor,
            self.rate() / 1e9,
            1e3 * self.solve,
            1e3 * self.search,
            self.near
        )
    }
}

/// A flat sheet's system: every edge a spring along itself and every hinge one across, and mass.
fn sheet_system(points: usize) -> Result<(BlockMatrix, Vec<Vec3>)> {
    let garment = Sheet::unstructured(SHEET, SHEET, points)?.flat_garment();
    let count = garment.points.len();
    let hinges: Vec<[u32; 4]> = garment.topology.hinges.iter().map(|h| h.points.map(|p| p.0)).collect();
    let mut matrix = BlockMatrix::with_pattern((0..count as u32).collect(), &mut |visit| {
        hinges.iter().for_each(|points| visit(points));
    });
    for [a, b, c, d] in &hinges {
        for (p, q) in [(a, b), (c, d), (a, c), (b, d)] {
            let along = (garment.points[*q as usize] - garment.points[*p as usize]).normalize();
            let block = along * along.transpose() * 100.0 + Mat3::identity();
            // Only blocks on and below the diagonal are given.
            for (i, j, sign) in [(p, p, 1.0), (q, q, 1.0), (p.max(q), p.min(q), -1.0)] {
                matrix.add(*i, *j, &(block * sign));
            }
        }
    }
    (0..count).for_each(|p| matrix.add_diagonal(p, 1.0));
    Ok((matrix, garment.points))
}

/// Two flat layers of about `points` points in all that touch.
fn two_layers(points: usize) -> Result<(Vec<Vec3>, Vec<[PointIndex; 3]>)> {
    let layer = Sheet::unstructured(SHEET, SHEET, points / 2)?.flat_garment();
    let count = layer.points.len() as u32;
    // The axis in which the sheet is flat.
    let up = Vec3::y() * LAYER;
    let above = layer.points.iter().map(|p| p + up);
    let shifted = layer.triangles.iter().map(|t| t.map(|p| PointIndex(p.0 + count)));
    Ok((
        layer.points.iter().copied().chain(above).collect(),
        layer.triangles.iter().copied().chain(shifted).collect(),
    ))
}

/// Median time of `work` over `runs` [s].
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
    fn kernels_solve_what_they_are_given() {
        let (matrix, places) = sheet_system(300).unwrap();
        let x: Vec<Vec3> = places.iter().map(|p| Vec3::new(p.x, 1.0, p.z)).collect();
        let mut y = vec![Vec3::zeros(); x.len()];
        matrix.multiply(&x, &mut y);
        let mut direct = Cholesky::default();
        direct.factorise(&matrix, &places).unwrap();
        direct.solve(&matrix, &mut y).unwrap();
        let off = x.iter().zip(&y).map(|(a, b)| (a - b).amax()).fold(0.0, f64::max);
        assert!(off < 1e-6, "{off}");
        let kernels = Kernels::measure(300, 1).unwrap();
        assert!(kernels.factor > 0.0 && kernels.work > 0.0 && kernels.copy > 0.0);
        // Every triangle finds the one over it.
        let (points, triangles) = two_layers(300).unwrap();
        let half = triangles.len() as u32 / 2;
        let pairs = TriangleBvh::new(&points, &triangles, LAYER).overlapping_pairs();
        let found = |f: u32| pairs.iter().any(|pair| pair.contains(&f) && pair.contains(&(f + half)));
        assert!((0..half).all(found));
    }
}
