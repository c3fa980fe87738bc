//! Benchmark of the direct solver against faer's sparse factorisation, on systems like those of a bake: two sheets of
//! cloth in contact, flat, folded once and folded thrice. `cargo bench --bench linear_solve [-- POINTS...]`
//!
//! Times are the minimum of several samples of the busiest thread's processor time, so that other load of the machine
//! does not count. "of gemm" is the rate of the factorisation against that of a large dense product in the same
//! precision.

mod faer_sparse;

use crease_geometry::math::{Mat3, Vec3};
use crease_linear::{BlockMatrix, BlockSink, Cholesky, FactorSize};
use faer_sparse::FaerSparse;
use std::collections::HashMap;
use std::time::Instant;

/// Side of a sheet [m].
const SIDE: f64 = 0.7;
/// Distance of layers [m].
const LAYER: f64 = 0.65e-3;

fn main() {
    let asked: Vec<u32> = std::env::args().filter_map(|a| a.parse().ok()).collect();
    let sizes = if asked.is_empty() { vec![2_000, 14_000, 60_000] } else { asked };
    println!(
        "gemm: {:.0} GFlop/s in double, {:.0} in single precision",
        gemm(1.0f64) / 1e9,
        gemm(1.0f32) / 1e9
    );
    println!(
        "points folds blocks/row | faer: factor [million numbers], analysis factor solve [ms] | crease: factor [million numbers] and work [GFlop], analysis factor solve, of gemm | two threads: factor solve | faer/crease on 1, 2 threads"
    );
    for points in sizes {
        for folds in [0, 1, 3] {
            row(points, folds);
        }
    }
}

/// Measures and prints one row.
fn row(points: u32, folds: u32) {
    let (matrix, positions) = system(points, folds);
    let rhs: Vec<Vec3> =
        (0..matrix.row_count()).map(|k| Vec3::new((k as f64).sin(), 1.0, (k as f64 * 0.7).cos())).collect();
    let repeat = if points > 30_000 { 2 } else { 5 };
    let mut faer = FaerSparse::default();
    let faer_times = on_threads(1, || {
        let analysis = min_time(repeat, &mut || faer.analyse(&matrix, &positions));
        let factor = min_time(repeat, &mut || faer.factorise(&matrix));
        [analysis, factor, min_time(repeat, &mut || faer.solve(&mut rhs.clone()))]
    });
    // The pattern without values: its factorisation fails immediately after the analysis.
    let mut empty = matrix.clone();
    empty.fill(&|_| ());
    let none = BlockMatrix::default();
    let mut crease = Cholesky::default();
    let mut times = |threads| {
        on_threads(threads, || {
            let analysis = min_time(repeat, &mut || {
                let _ = crease.factorise(&none, &[]);
                let _ = crease.factorise(&empty, &positions);
            });
            crease = Cholesky::default();
            let factor =
                min_time(repeat, &mut || crease.factorise(&matrix, &positions).expect("positive definite"));
            let solve =
                min_time(repeat, &mut || crease.solve(&matrix, &mut rhs.clone()).expect("positive definite"));
            [analysis, factor, solve]
        })
    };
    let one = times(1);
    let two = times(2);
    let mut x = rhs.clone();
    crease.solve(&matrix, &mut x).expect("positive definite");
    let mut y = rhs.clone();
    faer.solve(&mut y);
    let size = y.iter().map(|v| v.amax()).fold(0.0, f64::max);
    let difference = x.iter().zip(&y).map(|(x, y)| (x - y).amax()).fold(0.0, f64::max);
    let gemm = if crease.is_double() { gemm(1.0f64) } else { gemm(1.0f32) };
    let FactorSize { multiplications: work, entries: numbers } = crease.size();
    let total = |t: &[f64; 3]| t.iter().sum::<f64>();
    println!(
        "{:6} {folds} {:5.1} | {:6.1} {:5.0} {:6.0} {:5.0} | {:6.1} {:5.1}  {:5.1} {:6.0} {:5.0}  {:3.0} %{} | {:6.0} {:5.0} | {:.1} {:.1}   difference {:.0e}",
        matrix.row_count(),
        matrix.block_count() as f64 / matrix.row_count() as f64,
        1e-6 * faer.len() as f64,
        1e3 * faer_times[0],
        1e3 * faer_times[1],
        1e3 * faer_times[2],
        1e-6 * numbers as f64,
        2e-9 * work,
        1e3 * one[0],
        1e3 * one[1],
        1e3 * one[2],
        100.0 * 2.0 * work / one[1] / gemm,
        if crease.is_double() { " (double)" } else { "" },
        1e3 * two[1],
        1e3 * two[2],
        total(&faer_times) / total(&one),
        total(&faer_times) / (total(&two)),
        difference / size,
    );
}

/// Runs `work` on `count` threads.
fn on_threads<T: Send>(count: usize, work: impl FnOnce() -> T + Send) -> T {
    rayon::ThreadPoolBuilder::new().num_threads(count).build().expect("threads").install(work)
}

/// Minimum time of `work` over several samples [s]: processor time of the busiest thread, or wall time where the
/// system does not report it. A sample is long compared with the resolution of the clock.
fn min_time(samples: usize, work: &mut (dyn FnMut() + Send)) -> f64 {
    let clock = Instant::now();
    work();
    let repeat = (SAMPLE / clock.elapsed().as_secs_f64().max(1e-6)).ceil();
    (0..samples)
        .map(|_| {
            let (clock, start) = (Instant::now(), processor_seconds());
            (0..repeat as usize).for_each(|_| work());
            let spent =
                processor_seconds().iter().zip(&start).map(|(end, start)| end - start).fold(0.0, f64::max);
            let spent = if spent > 0.0 { spent } else { clock.elapsed().as_secs_f64() };
            spent / repeat
        })
        .fold(f64::INFINITY, f64::min)
}

/// Duration of a sample [s].
const SAMPLE: f64 = 0.2;

/// Processor time of every thread of the pool [s]; zeros where the system does not report it.
fn processor_seconds() -> Vec<f64> {
    let own = || {
        let text = std::fs::read_to_string("/proc/thread-self/schedstat").ok()?;
        Some(text.split(' ').next()?.parse::<f64>().ok()? * 1e-9)
    };
    rayon::broadcast(|_| own().unwrap_or(0.0))
}

/// Floating-point rate of a large dense product [1/s].
fn gemm<T: faer::traits::RealField + Copy>(value: T) -> f64 {
    const N: usize = 384;
    let (a, b) = (vec![value; N * N], vec![value; N * N]);
    let mut c = vec![value; N * N];
    let seconds = on_threads(1, || {
        min_time(20, &mut || {
            let [a, b] = [&a, &b].map(|m| faer::MatRef::from_column_major_slice(m, N, N));
            let c = faer::MatMut::from_column_major_slice_mut(&mut c, N, N);
            faer::linalg::matmul::matmul(c, faer::Accum::Replace, a, b.transpose(), value, faer::Par::Seq);
        })
    });
    2.0 * (N * N * N) as f64 / seconds
}

/// System of two square sheets in contact, folded, with about `points` points: inertia of a step of 1/240 s,
/// membrane, bending over two rings, and contact between layers with stiffness 1e2 to 1e5 N/m. The diagonal blocks'
/// eigenvalues then span 0.6 to 1e5 N/m; in bakes of the T-shirts 0.4 to 1e5 N/m is usual.
fn system(points: u32, folds: u32) -> (BlockMatrix, Vec<Vec3>) {
    let n = (f64::from(points) / 2.0).sqrt().round() as u32;
    let spacing = SIDE / f64::from(n);
    let mut positions = Vec::new();
    for sheet in 0..2 {
        for k in 0..n * n {
            // Points of the sheets are not aligned.
            let shift = 0.37 * f64::from(sheet) + 0.01 * f64::from(k % 7);
            let (i, j) = (f64::from(k % n) + shift, f64::from(k / n) + 0.6 * shift);
            positions.push(Vec3::new(i * spacing, f64::from(sheet) * LAYER, j * spacing));
        }
    }
    let (mut size, mut height) = ([SIDE; 2], LAYER);
    for fold in 0..folds as usize {
        let axis = fold % 2;
        size[axis] *= 0.5;
        for p in positions.iter_mut().filter(|p| p[2 * axis] > size[axis]) {
            p[2 * axis] = 2.0 * size[axis] - p[2 * axis];
            p.y = 2.0 * height + LAYER - p.y;
        }
        height = 2.0 * height + LAYER;
    }
    let mut pairs = Vec::new();
    for sheet in 0..2 {
        for k in 0..n * n {
            let (i, j) = (k % n, k / n);
            for (di, dj, stiffness) in [
                (1, 0, 600.0),
                (0, 1, 600.0),
                (1, 1, 300.0),
                (2, 0, 2.0),
                (0, 2, 2.0),
                (2, 1, 2.0),
                (1, 2, 2.0),
                (2, 2, 2.0),
            ] {
                if i + di < n && j + dj < n {
                    pairs.push((sheet * n * n + k, sheet * n * n + (j + dj) * n + i + di, stiffness));
                }
            }
            if i > 0 && j + 1 < n {
                pairs.push((sheet * n * n + k, sheet * n * n + (j + 1) * n + i - 1, 2.0));
            }
        }
    }
    add_contacts(&positions, spacing, &mut pairs);
    let mut matrix = BlockMatrix::with_pattern((0..positions.len() as u32).collect(), &mut |visit| {
        pairs.iter().for_each(|(a, b, _)| visit(&[*a, *b]));
    });
    for p in 0..positions.len() {
        matrix.add_diagonal(p, 0.15 * spacing * spacing * 240.0 * 240.0);
    }
    for &(a, b, stiffness) in &pairs {
        let u = (positions[a as usize] - positions[b as usize]).normalize();
        let block = (u * u.transpose() + Mat3::identity() * 1e-3) * stiffness;
        matrix.add(a, a, &block);
        matrix.add(b, b, &block);
        matrix.add(a.max(b), a.min(b), &-block);
    }
    (matrix, positions)
}

/// Adds contact pairs of neighbouring layers, of varying stiffness.
fn add_contacts(positions: &[Vec3], spacing: f64, pairs: &mut Vec<(u32, u32, f64)>) {
    let cell = |p: &Vec3| [p.x, p.z].map(|c| (c / (1.4 * spacing)).floor() as i32);
    let mut cells: HashMap<[i32; 2], Vec<u32>> = HashMap::new();
    for (k, p) in positions.iter().enumerate() {
        cells.entry(cell(p)).or_default().push(k as u32);
    }
    for (a, p) in positions.iter().enumerate() {
        let [i, j] = cell(p);
        for near in (0..9).filter_map(|k| cells.get(&[i + k % 3 - 1, j + k / 3 - 1])) {
            for &b in near {
                let d = positions[b as usize] - p;
                if d.y > 0.5 * LAYER && d.y < 1.5 * LAYER && d.x.hypot(d.z) < 1.4 * spacing {
                    pairs.push((a as u32, b, 10f64.powf(2.0 + 3.0 * (a as f64 * 0.618).fract().powi(4))));
                }
            }
        }
    }
}
