//! Fold lines drawn on the surface of a garment that is laid out flat: layers without thickness, folded along lines.
//!
//! A fold cuts the surface mesh along its line through all layers and turns the flap over; what was opened again is flat for the
//! next fold. [`crate::wear::draw_fold_lines`] feeds it with the actions of a script.

use crate::math::Vec3;
use crate::remesh::{CutPoint, SurfaceMesh};
use crate::wear::tuning::TUNING;

/// Number of the first row beside a line; fold lines are numbered from 0.
const FIRST_ROW: u32 = 1 << 16;

/// A surface mesh with the lines drawn so far.
#[derive(Debug, Clone)]
pub(super) struct LineLayout<'a> {
    mesh: SurfaceMesh<'a>,
    /// Positions without thickness, one per point of the mesh [m].
    positions: Vec<Vec3>,
    /// Positions before every fold that has not been opened, oldest first [m].
    before_folds: Vec<Vec<Vec3>>,
    /// Per fold and point: signed distance from its line when it was made [m].
    levels: Vec<Vec<f64>>,
}

impl<'a> LineLayout<'a> {
    /// No line yet on `mesh`.
    pub fn new(mesh: SurfaceMesh<'a>) -> Self {
        Self { positions: mesh.x.clone(), mesh, before_folds: Vec::new(), levels: Vec::new() }
    }

    /// Positions of the points of the garment, one per point [m].
    pub fn garment_positions(&self) -> &[Vec3] {
        &self.positions[..self.mesh.source.points.len()]
    }

    /// The surface mesh with all lines.
    pub fn into_mesh(self) -> SurfaceMesh<'a> {
        self.mesh
    }

    /// Lays the cloth out at `positions` [m], one per point of the garment. Returns whether that is possible: after a fold
    /// the points of the lines have no position in a new layout.
    pub fn lay_down(&mut self, positions: &[Vec3]) -> bool {
        if !self.levels.is_empty() {
            return false;
        }
        self.positions = positions.to_vec();
        self.fix_extremes();
        true
    }

    /// Keeps the points that span the box which fractions refer to.
    fn fix_extremes(&mut self) {
        for axis in [0, 2] {
            let along = |p: &usize| self.positions[*p][axis];
            let points = 0..self.positions.len();
            let low = points.clone().min_by(|a, b| along(a).total_cmp(&along(b)));
            let high = points.max_by(|a, b| along(a).total_cmp(&along(b)));
            low.into_iter().chain(high).for_each(|p| self.mesh.fix(p as u32));
        }
    }

    /// Turns what lies beyond a line over: `origin` is a point of the line [m], `outward` the unit vector across it.
    pub fn fold(&mut self, origin: Vec3, outward: Vec3) {
        let mut level: Vec<f64> = self.positions.iter().map(|p| (p - origin).dot(&outward)).collect();
        let made = self.mesh.cut(&mut level);
        self.extend(&made);
        let number = self.levels.len() as u32;
        for [p, q] in self.mesh.edges_on_line(&level) {
            self.mesh.draw_line(p, q, number);
        }
        self.before_folds.push(self.positions.clone());
        for (p, level) in self.positions.iter_mut().zip(&level) {
            if *level > 0.0 {
                *p -= outward * (2.0 * level);
            }
        }
        self.levels.push(level);
    }

    /// Opens the last `count` folds, or all.
    pub fn unfold(&mut self, count: Option<usize>) {
        let left = count.map_or(0, |count| self.before_folds.len().saturating_sub(count));
        if let Some(x) = self.before_folds.drain(left..).next() {
            self.positions = x;
        }
    }

    /// Values of new points, linear between those of the ends they lie between.
    fn extend(&mut self, made: &[CutPoint]) {
        for CutPoint { ends: [a, b], weight } in made {
            let (a, b) = (*a as usize, *b as usize);
            for x in self.before_folds.iter_mut().chain([&mut self.positions]) {
                x.push(x[a] * (1.0 - weight) + x[b] * *weight);
            }
            for level in &mut self.levels {
                level.push(level[a] * (1.0 - weight) + level[b] * weight);
            }
        }
    }

    /// Draws a row of edges at `row` [m] on either side of every fold line, where no other line is near.
    pub fn draw_rows(&mut self, row: f64) {
        for k in 0..self.levels.len() {
            for (side, shift) in [row, -row].into_iter().enumerate() {
                let mut level: Vec<f64> = self.levels[k].iter().map(|l| l - shift).collect();
                let made = self.mesh.cut(&mut level);
                self.extend(&made);
                let number = FIRST_ROW + 2 * k as u32 + side as u32;
                for [p, q] in self.mesh.edges_on_line(&level) {
                    if self.is_clear(k, p, q, row) {
                        self.mesh.draw_line(p, q, number);
                    }
                }
            }
        }
    }

    /// Whether no other line runs beside the edge of a row of line `k`; lines that cross it are no hindrance.
    fn is_clear(&self, k: usize, p: u32, q: u32, row: f64) -> bool {
        let (p, q) = (p as usize, q as usize);
        let length = (self.mesh.x[p] - self.mesh.x[q]).norm();
        let beside = |(j, level): (usize, &Vec<f64>)| {
            let near = level[p].abs().min(level[q].abs()) < TUNING.prediction.row_clearance * row;
            j != k && near && (level[p] - level[q]).abs() < 0.5 * length
        };
        !self.levels.iter().enumerate().any(beside)
    }
}
