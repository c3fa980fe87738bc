//! A body that the cloth meets: triangles whose points are known functions of time (a skinned arm, a mannequin).
//!
//! The solver does not move it and it weighs nothing. For every step it is told where its points should be at the
//! end ([`Body::aim`]); how far they get is decided together with the cloth, point by point, by the same bound that
//! keeps layers apart (`contact::bound`), so that a body never runs through cloth that has nowhere to go. What is
//! left is the lag, and is made up for as soon as there is room.
//!
//! Both sides of a triangle push: a body may be thin, open, not convex or in several pieces. Its pieces do not meet one
//! another.

use crate::contact::broad_phase::CandidateFinder;
use crate::contact::initial_intersections::Mesh;
use crate::error::{Diagnostic, Error, Result};
use crate::math::Vec3;
use crate::mesh::point_in_solid::point_areas;
use crate::mesh::{PointIndex, Topology};

/// A body of triangles that moves as it is told.
#[derive(Clone)]
pub struct Body {
    pub(super) triangles: Vec<[PointIndex; 3]>,
    pub(super) edges: Vec<[u32; 2]>,
    pub(super) triangle_edges: Vec<[u32; 3]>,
    /// Area that each point stands for [m²].
    pub(super) point_area: Vec<f64>,
    /// Area that each edge stands for [m²].
    pub(super) edge_area: Vec<f64>,
    pub(super) finder: CandidateFinder,
    /// Where the last accepted step left it [m], one per point.
    pub(super) start: Vec<Vec3>,
    /// Where it is now [m].
    pub(super) now: Vec<Vec3>,
    /// Where it should be at the end of the step [m].
    pub(super) target: Vec<Vec3>,
}

impl Body {
    /// A body at rest at `points` [m]. A triangle that repeats a point has no area and is left out.
    ///
    /// # Errors
    /// `Error::Input` with every point that is not finite and every triangle that names a point that is not there.
    pub fn new(points: Vec<Vec3>, triangles: Vec<[PointIndex; 3]>) -> Result<Self> {
        let mut faults = Vec::new();
        for (k, _) in points.iter().enumerate().filter(|(_, x)| !x.sum().is_finite()) {
            let cure = "give every point three finite coordinates";
            faults.push(Diagnostic::new("body", format!("points[{k}]"), "is not finite", cure));
        }
        for (k, t) in triangles.iter().enumerate() {
            if let Some(p) = t.iter().find(|p| p.at() >= points.len()) {
                let what = format!("names point {} of {}", p.0, points.len());
                faults.push(Diagnostic::new("body", format!("triangles[{k}]"), what, "count points from 0"));
            }
        }
        if !faults.is_empty() {
            return Err(Error::Input(faults));
        }
        let triangles: Vec<_> =
            triangles.into_iter().filter(|[a, b, c]| a != b && b != c && c != a).collect();
        let topology = Topology::new(points.len(), &triangles);
        let point_area = point_areas(&points, &triangles);
        let edges: Vec<[u32; 2]> = topology.edges.iter().map(|e| e.map(|p| p.0)).collect();
        Ok(Self {
            edge_area: edge_area(&edges, &point_area),
            finder: CandidateFinder::new(&points, &triangles, &topology),
            triangles,
            edges,
            triangle_edges: topology.triangle_edges,
            point_area,
            start: points.clone(),
            now: points.clone(),
            target: points,
        })
    }

    /// Number of points.
    pub fn point_count(&self) -> usize {
        self.now.len()
    }

    /// Where it is [m], one per point.
    pub fn points(&self) -> &[Vec3] {
        &self.now
    }

    /// Its triangles, those left out that had no area by their corners.
    pub fn triangles(&self) -> &[[PointIndex; 3]] {
        &self.triangles
    }

    /// Goes back to where the last accepted step left it, and aims at `target` [m], one per point, for the end of the
    /// step. Points without a finite target stay.
    pub fn aim(&mut self, target: &[Vec3]) {
        self.now.clone_from(&self.start);
        for ((goal, at), wanted) in self.target.iter_mut().zip(&self.start).zip(target) {
            *goal = if wanted.sum().is_finite() { *wanted } else { *at };
        }
    }

    /// What is still to go to the target [m], one per point.
    pub(super) fn way(&self) -> Vec<Vec3> {
        self.target.iter().zip(&self.now).map(|(goal, at)| goal - at).collect()
    }

    /// The farthest any point is from its target, and that point [m].
    pub fn lag(&self) -> (f64, usize) {
        let lags = self.target.iter().zip(&self.now).map(|(goal, at)| (goal - at).norm());
        lags.zip(0..).fold((0.0, 0), |most, lag| if lag.0 > most.0 { lag } else { most })
    }

    /// As it is counted, where it is now.
    pub(super) fn mesh(&self) -> Mesh<'_> {
        Mesh {
            x: &self.now,
            triangles: &self.triangles,
            triangle_edges: &self.triangle_edges,
            edge_count: self.edges.len(),
        }
    }

    /// The step is accepted: the next starts from here.
    pub(super) fn accept(&mut self) {
        self.start.clone_from(&self.now);
    }
}

/// An edge stands for its share of the area of its two ends: summed over edges as much as over points.
pub(super) fn edge_area(edges: &[[u32; 2]], point_area: &[f64]) -> Vec<f64> {
    let mut degree = vec![0.0f64; point_area.len()];
    edges.iter().flatten().for_each(|&p| degree[p as usize] += 1.0);
    let share = |p: u32| point_area[p as usize] / degree[p as usize].max(1.0);
    edges.iter().map(|e| share(e[0]) + share(e[1])).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn all_faults_of_a_body_come_at_once() {
        let points = vec![Vec3::zeros(), Vec3::x(), Vec3::new(f64::NAN, 0.0, 0.0)];
        let triangles = vec![[0, 1, 2].map(PointIndex), [0, 1, 7].map(PointIndex)];
        let Err(Error::Input(faults)) = Body::new(points, triangles) else { panic!("must be refused") };
        let places: Vec<&str> = faults.iter().map(|f| f.location.as_str()).collect();
        assert_eq!(places, ["points[2]", "triangles[1]"]);
    }

    #[test]
    fn a_body_aims_from_where_it_was_left() {
        let points = vec![Vec3::zeros(), Vec3::x(), Vec3::y()];
        let flat = vec![[0, 1, 2].map(PointIndex), [0, 0, 1].map(PointIndex)];
        let mut body = Body::new(points.clone(), flat).expect("is a body");
        assert_eq!(body.triangles().len(), 1);
        assert!((body.point_area.iter().sum::<f64>() - 0.5).abs() < 1e-15);
        assert!((body.edge_area.iter().sum::<f64>() - 0.5).abs() < 1e-15);
        let mut target = points.clone();
        target[1].z = 2.0;
        target[2].z = f64::NAN;
        body.aim(&target);
        assert_eq!(body.lag(), (2.0, 1));
        body.now[1].z = 1.5;
        body.aim(&target);
        assert_eq!(body.lag(), (2.0, 1), "a try that was thrown away leaves no trace");
        body.now[1].z = 1.5;
        body.accept();
        body.aim(&target);
        assert_eq!(body.lag(), (0.5, 1));
    }
}
