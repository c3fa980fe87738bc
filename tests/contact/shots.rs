//! Tunnelling: scraps of cloth shot at a sheet, by many thicknesses a step.

use crate::run::{COTTON, Kind, Pattern, Run};
use crease_geometry::math::{Rng, Vec3};
use crease_geometry::mesh::triangle_bvh::TriangleBvh;
use crease_solver::sim::Loads;

/// Outcome of a number of shots.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Shots {
    pub shots: usize,
    /// Shots that met the sheet, judged by where they would have been.
    pub hits: usize,
    /// Shots with intersecting triangles after any step.
    pub crossed: usize,
    /// Shots that ended on the other side.
    pub through: usize,
    /// Steps in all.
    pub steps: usize,
}

/// `count` scraps of 2 cm, each turned and aimed at random, fly at `speed` [m/s] at a sheet of 0.2 m held at its border, in
/// steps of 1/60 s and no shorter.
pub fn shoot(count: usize, speed: f64, seed: u64) -> Shots {
    let mut rng = Rng::from_seed(seed);
    let mut found = Shots::default();
    for _ in 0..count {
        let (hit, run, scrap, aim) = one_shot(speed, &mut rng);
        let tree = TriangleBvh::new(&run.state.x, &run.triangles, 0.0);
        // Looking back along its path, the sheet is met an even number of times from the near side.
        let through = (scrap..run.state.x.len()).any(|p| {
            let mut from = run.state.x[p];
            let mut met = 0;
            while let Some(hit) = tree.first_hit(&run.state.x, from, -aim, 10.0) {
                let own = run.triangles[hit.triangle as usize].iter().any(|c| c.at() >= scrap);
                met += usize::from(!own);
                from -= aim * (hit.t + 1e-9);
            }
            met % 2 == 1
        });
        found.shots += 1;
        found.hits += usize::from(hit);
        found.crossed += usize::from(run.worst != 0);
        found.through += usize::from(through);
        found.steps += run.steps;
    }
    found
}

fn one_shot(speed: f64, rng: &mut Rng) -> (bool, Run, usize, Vec3) {
    const SIDE: usize = 12;
    let mut pattern = Pattern::square((SIDE + 1) * (SIDE + 1), 0.2, Vec3::zeros());
    let scrap = pattern.x.len();
    let (a, b) = (rng.in_cube(), rng.in_cube());
    let e1 = a.normalize();
    let e2 = (b - e1 * e1.dot(&b)).normalize();
    let above = Vec3::new(0.1 * (rng.uniform() - 0.5), 0.03, 0.1 * (rng.uniform() - 0.5));
    pattern
        .add([3, 3], [0.02, 0.02], false, |u, v| above + e1 * (0.02 * (u - 0.5)) + e2 * (0.02 * (v - 0.5)));
    let aim = Vec3::new(0.6 * (rng.uniform() - 0.5), -1.0, 0.6 * (rng.uniform() - 0.5)).normalize();
    let mut run = Run::new(&pattern, Kind { thickness: 0.5e-3, ..COTTON }, 4.0);
    let h = 1.0 / 60.0;
    run.stepper.options.min_dt = h;
    run.stepper.options.max_dt = h;
    run.stepper.options.newton.max_iterations = 10;
    run.state.v[scrap..].fill(aim * speed);
    let border =
        |p: usize| p < scrap && [0, SIDE].iter().any(|&k| p % (SIDE + 1) == k || p / (SIDE + 1) == k);
    let fixed: Vec<bool> = (0..pattern.x.len()).map(border).collect();
    let would_be = above + aim * (speed * 0.1);
    run.go(0.1, &mut |_, _| Loads {
        fixed: fixed.clone(),
        gravity: Vec3::zeros(),
        drag: 0.0,
        ..Loads::gravity_only(None)
    });
    (would_be.y < 0.0, run, scrap, aim)
}

#[test]
fn nothing_tunnels() {
    for speed in [5.0, 20.0] {
        let found = shoot(15, speed, 7);
        println!("{speed} m/s, {:.0} thicknesses a step: {found:?}", speed / 60.0 / 0.5e-3);
        assert_eq!((found.hits, found.crossed, found.through), (15, 0, 0));
    }
}
