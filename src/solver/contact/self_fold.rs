//! Self folds of a body: where two of its parts touch or penetrate each other, as in the crook of an elbow.
//!
//! Real flesh gives way there and skinned surfaces do not: the two sides would press the cloth between them to nothing. Both sides are
//! moved back by half each, so far that the cloth between them fits.

use crate::contact::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::triangle_bvh::TriangleBvh;
use crease_geometry::mesh::{PointIndex, Topology, triangle};
use rayon::prelude::*;

/// Points of a body in its self folds.
pub(super) struct SelfFold {
    /// Positions without self folds, as in the body's file [m], one per point.
    rest: Vec<Vec3>,
    /// Unit normals there, one per point.
    rest_normals: Vec<Vec3>,
    /// Whether a point is in a self fold, one flag per point.
    is_folded: Vec<bool>,
}

/// A body at given positions.
#[derive(Clone, Copy)]
pub(super) struct BodySurface<'a> {
    /// Positions [m], one per point.
    pub x: &'a [Vec3],
    /// Outward unit normals, one per point.
    pub normals: &'a [Vec3],
    /// Its triangles.
    pub triangles: &'a [[PointIndex; 3]],
    /// Hierarchy over its triangles, fitted to the positions.
    pub bvh: &'a TriangleBvh,
}

/// Cloth at given positions.
#[derive(Clone, Copy)]
pub struct ClothSurface<'a> {
    /// Positions [m], one per point.
    pub x: &'a [Vec3],
    /// Its triangles.
    pub triangles: &'a [[PointIndex; 3]],
    /// Edges and neighbours of the triangles.
    pub topology: &'a Topology,
}

impl SelfFold {
    /// A body at `rest` [m] with unit `normals`, one per point.
    pub fn new(rest: &[Vec3], normals: Vec<Vec3>) -> Self {
        Self { rest: rest.to_vec(), rest_normals: normals, is_folded: vec![false; rest.len()] }
    }

    /// Whether each point is in a self fold, one flag per point.
    pub fn flags(&self) -> &[bool] {
        &self.is_folded
    }

    /// Whether a triangle has a corner in a self fold.
    pub fn has_corner_of(&self, corners: &[PointIndex; 3]) -> bool {
        corners.iter().any(|p| self.is_folded[p.at()])
    }

    /// Returns the positions of points in self folds at `x` [m].
    pub fn positions(&self, x: &[Vec3]) -> Vec<Vec3> {
        x.iter().zip(&self.is_folded).filter(|(_, folded)| **folded).map(|(at, _)| *at).collect()
    }

    /// Returns the positions of a body of `triangles` with its self folds moved apart [m], and notes which points they have. `min_gap`: distance
    /// between the two sides [m]. Only parts that face each other across air at rest count, not the far side of a hand; only points that are
    /// `covered` by cloth, one flag per point, are moved.
    pub fn resolve(&mut self, body: BodySurface, covered: &[bool], min_gap: f64) -> Vec<Vec3> {
        let tuning = &TUNING.body;
        let triangles = body.triangles;
        let normal = |t: &[PointIndex; 3]| triangle::normal(&triangle::corners(body.x, t));
        let triangle_normals: Vec<Vec3> =
            triangles.iter().map(|t| normal(t).unwrap_or_else(Vec3::zeros)).collect();
        let resolve = |(p, at): (usize, &Vec3)| {
            if !covered[p] {
                return *at;
            }
            let facing = |f: u32| {
                let corner = triangles[f as usize][0].at();
                triangle_normals[f as usize].dot(&body.normals[p]) < tuning.max_facing_cosine
                    && (self.rest[corner] - self.rest[p]).dot(&self.rest_normals[p]) > 0.0
            };
            let max_depth = tuning.max_self_fold_depth;
            let Some(nearest) = body.bvh.nearest_where(body.x, *at, max_depth, facing) else { return *at };
            let other = triangle_normals[nearest.triangle as usize];
            let height = (at - body.x[triangles[nearest.triangle as usize][0].at()]).dot(&other);
            if height < min_gap { at + other * (0.5 * (min_gap - height).min(2.0 * max_depth)) } else { *at }
        };
        let resolved: Vec<Vec3> = body.x.par_iter().enumerate().map(resolve).collect();
        self.is_folded.iter_mut().zip(body.x.iter().zip(&resolved)).for_each(|(f, (a, b))| *f = a != b);
        resolved
    }
}
