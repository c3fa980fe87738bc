//! Triangles that follow a shape without crossing.
//!
//! The points of a garment are read off a simulated mesh whose layers never cross, but their triangles are others: a chord over a fold cuts
//! through the layer inside of it. So the triangles do not take the positions read off, they move towards them: from positions at which
//! nothing crosses to the minimum of
//!
//! ```text
//! E = sum_i A_i/2 |u_i|² + sum_(ij) s/2 |u_i - u_j|² + barrier(x),     u_i = x_i - X_i
//! ```
//!
//! with the positions read off X, by Newton's method, every displacement cut short of the first touch (`contact`). What keeps layers apart
//! spreads over their neighbours. Energies are per stiffness: only their ratios matter. What crosses in the source pose may do so
//! for ever, all else never does.

use crate::bake::tuning::TUNING;
use crease_geometry::math::{Mat3, Vec3, nearest_rotation};
use crease_geometry::mesh::{PointIndex, Topology, triangle};
use crease_solver::contact::{Contact, ContactSettings};
use crease_solver::energy::{Energy, EvenTether};
use crease_solver::sim::{NewtonOptions, Problem, Workspace};

/// Triangles that follow a shape.
pub(in crate::bake) struct ShapeFollower {
    triangles: Topology,
    contact: Contact,
    work: Workspace,
    /// Stiffness of the tether, one per point [m²].
    stiffness: Vec<f64>,
    /// Stiffness of an edge [m²].
    edge_stiffness: f64,
    /// Positions, one per point [m].
    x: Vec<Vec3>,
    /// Positions that were followed, one per point [m].
    target: Vec<Vec3>,
}

impl ShapeFollower {
    /// Followers with these `triangles` over points at `source` [m].
    pub fn new(source: &[Vec3], triangles: &[[PointIndex; 3]]) -> Self {
        let topology = Topology::new(source.len(), triangles);
        let mut area = vec![0.0; source.len()];
        for t in triangles {
            let part = triangle::area(&triangle::corners(source, t)) / 3.0;
            t.iter().for_each(|p| area[p.at()] += part);
        }
        let mean_area = area.iter().sum::<f64>() / area.len().max(1) as f64;
        let length = |[a, b]: &[PointIndex; 2]| (source[a.at()] - source[b.at()]).norm();
        let mean_edge = topology.edges.iter().map(length).sum::<f64>() / topology.edges.len().max(1) as f64;
        let tuning = &TUNING.follow;
        let distance = tuning.contact_distance.min(tuning.max_contact_edge_fraction * mean_edge);
        let settings = ContactSettings::uniform(distance, tuning.contact_stiffness, 0.0);
        let stiffness = area.iter().map(|area| area.max(tuning.min_area_fraction * mean_area)).collect();
        Self {
            contact: Contact::new(settings, source, triangles, &topology, area),
            triangles: topology,
            work: Workspace::default(),
            stiffness,
            edge_stiffness: tuning.edge_stiffness * mean_area,
            x: source.to_vec(),
            target: source.to_vec(),
        }
    }

    /// Positions, one per point [m].
    pub fn positions(&self) -> &[Vec3] {
        &self.x
    }

    /// What a resumed run goes on from: positions and the positions that were followed, one per point [m].
    pub fn state(&self) -> [Vec<Vec3>; 2] {
        [self.x.clone(), self.target.clone()]
    }

    /// Goes on from a [`Self::state`].
    pub fn restore(&mut self, [x, target]: [Vec<Vec3>; 2]) {
        (self.x, self.target) = (x, target);
    }

    /// Drops what is kept between motions for speed alone.
    pub fn clear_caches(&mut self) {
        self.contact.clear_caches();
        self.work.reset();
    }

    /// Moves towards `target` [m], one position per point, along straight lines from the last.
    pub fn follow(&mut self, target: &[Vec3]) {
        self.follow_in_steps(target, TUNING.follow.max_step);
    }

    /// Moves towards `target` [m], one position per point, where the garment was put: no path to it is known.
    pub fn follow_elsewhere(&mut self, target: &[Vec3]) {
        self.align_with(target);
        self.follow_in_steps(target, TUNING.follow.max_step_elsewhere);
    }

    /// Returns the largest distance of `target` from the last [m].
    pub fn motion_to(&self, target: &[Vec3]) -> f64 {
        farthest(&self.target, target)
    }

    /// Returns the largest distance of the points from `target` [m].
    pub fn distance_from(&self, target: &[Vec3]) -> f64 {
        farthest(&self.x, target)
    }

    fn follow_in_steps(&mut self, target: &[Vec3], max_step: f64) {
        let far = self.motion_to(target);
        if far <= TUNING.follow.min_motion {
            return;
        }
        let from = self.target.clone();
        let steps = (far / max_step).ceil().clamp(1.0, TUNING.follow.max_steps);
        for step in 1..=steps as usize {
            let fraction = step as f64 / steps;
            let between = |(a, b): (&Vec3, &Vec3)| a + (b - a) * fraction;
            let next: Vec<Vec3> = from.iter().zip(target).map(between).collect();
            self.approach(if fraction < 1.0 { &next } else { target });
        }
    }

    /// Moves all points as a rigid body to where the positions that were followed lie nearest to `target`, if that is nearer.
    fn align_with(&mut self, target: &[Vec3]) {
        let mean = |x: &[Vec3]| x.iter().sum::<Vec3>() / x.len().max(1) as f64;
        let (before, after) = (mean(&self.target), mean(target));
        let mixed: Mat3 =
            self.target.iter().zip(target).map(|(a, b)| (b - after) * (a - before).transpose()).sum();
        let Some(nearest) = nearest_rotation(mixed) else { return };
        let moved =
            |x: &[Vec3]| -> Vec<Vec3> { x.iter().map(|x| after + nearest.rotation * (x - before)).collect() };
        let followed = moved(&self.target);
        let squares = |x: &[Vec3]| -> f64 { x.iter().zip(target).map(|(a, b)| (a - b).norm_squared()).sum() };
        if squares(&followed) < squares(&self.target) {
            self.x = moved(&self.x);
            self.target = followed;
        }
    }

    /// Moves towards `target`, which is near. What does not move there stays where it is.
    fn approach(&mut self, target: &[Vec3]) {
        let tuning = &TUNING.follow;
        let moves = |(a, b): (&Vec3, &Vec3)| (a - b).norm_squared() > tuning.min_motion * tuning.min_motion;
        let mut free: Vec<bool> = target.iter().zip(&self.target).map(moves).collect();
        for _ in 0..tuning.free_rings {
            let before = free.clone();
            for [a, b] in &self.triangles.edges {
                free[a.at()] |= before[b.at()];
                free[b.at()] |= before[a.at()];
            }
        }
        let fixed: Vec<bool> = free.iter().map(|free| !free).collect();
        self.contact.begin_step(&self.x, f64::INFINITY, 0.0, &fixed);
        let tether = EvenTether {
            target,
            stiffness: &self.stiffness,
            edges: &self.triangles.edges,
            edge_stiffness: self.edge_stiffness,
        };
        let terms: [&dyn Energy; 1] = [&tether];
        let newton = NewtonOptions {
            displacement_tol: tuning.displacement_tol,
            decrement_tol: tuning.energy_tol,
            rel_decrement_tol: 0.0,
            max_iterations: tuning.max_iterations,
        };
        let problem = Problem { inertia: None, terms: &terms, fixed: &fixed, predicted_positions: None };
        problem.solve(&mut self.x, &mut self.contact, &newton, &mut self.work);
        self.contact.end_step(&self.x, f64::INFINITY);
        for ((followed, target), free) in self.target.iter_mut().zip(target).zip(free) {
            if free {
                *followed = *target;
            }
        }
    }
}

/// Returns the largest distance between two positions of a point [m].
fn farthest(from: &[Vec3], to: &[Vec3]) -> f64 {
    from.iter().zip(to).map(|(a, b)| (a - b).norm()).fold(0.0, f64::max)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crease_geometry::mesh::intersections::self_intersections;

    /// Two sheets of `n` x `n` squares of 20 mm, 4 mm apart.
    fn sheets(n: u32) -> (Vec<Vec3>, Vec<[PointIndex; 3]>) {
        let (mut points, mut triangles) = (Vec::new(), Vec::new());
        for layer in 0..2 {
            let base = points.len() as u32;
            for k in 0..(n + 1) * (n + 1) {
                let (i, j) = (f64::from(k % (n + 1)), f64::from(k / (n + 1)));
                points.push(Vec3::new(0.02 * i, 4e-3 * f64::from(layer), 0.02 * j));
            }
            for k in 0..n * n {
                let a = base + k / n * (n + 1) + k % n;
                triangles.push([a, a + n + 1, a + 1].map(PointIndex));
                triangles.push([a + 1, a + n + 1, a + n + 2].map(PointIndex));
            }
        }
        (points, triangles)
    }

    /// Positions read off cross one another for a while, then the sheets come apart again.
    #[test]
    fn sheets_that_would_cross_stay_apart_and_come_back() {
        let (source, triangles) = sheets(6);
        let mut follower = ShapeFollower::new(&source, &triangles);
        let dent = |depth: f64| -> Vec<Vec3> {
            let half = source.len() / 2;
            let lower = |(p, x): (usize, &Vec3)| {
                let middle = (x.x - 0.06).hypot(x.z - 0.06) < 0.03;
                if p >= half && middle { x - Vec3::y() * depth } else { *x }
            };
            source.iter().enumerate().map(lower).collect()
        };
        for depth in [2e-3, 5e-3, 8e-3] {
            let target = dent(depth);
            follower.follow(&target);
            let left = follower.distance_from(&target);
            assert!(self_intersections(follower.positions(), &triangles).is_empty(), "{depth} m deep");
            assert!(left < 5e-3, "{left} m from what is followed");
            let crosses = !self_intersections(&target, &triangles).is_empty();
            assert_eq!(crosses, depth > 4e-3);
        }
        follower.follow(&source);
        let left = follower.distance_from(&source);
        assert!(left < 2e-4, "{left} m from a shape without crossings");
    }

    #[test]
    fn a_shape_that_was_put_elsewhere_is_followed_there() {
        let (source, triangles) = sheets(4);
        let mut follower = ShapeFollower::new(&source, &triangles);
        let upright = |x: &Vec3| Vec3::new(1.0 - x.y, x.x, 2.0 + x.z);
        let target: Vec<Vec3> = source.iter().map(upright).collect();
        follower.follow_elsewhere(&target);
        assert!(follower.distance_from(&target) < 1e-6);
    }
}
