//! Crease lines of sources drawn on the surface of a target garment, with a row of edges on either side.
//!
//! Every point of the target has its signed distance from a line of a source ([`LineLevels`]);
//! the target's surface is cut along the zero line of this distance. What the source remembers beside the line then
//! lies on the two rows of triangles beside it on the target.

use crate::transfer::crease_lines::CreaseLine;
use crate::transfer::line_levels::LineLevels;
use crate::transfer::tuning::TUNING;
use crease_model::garment::Garment;
use crease_model::remesh::{Correspondence, Curve, CutPoint, GarmentSurface, Match, Query, SurfaceMesh};
use rayon::prelude::*;

/// Number of the first row beside a line; lines are numbered from 0.
const FIRST_ROW: u32 = 1 << 16;

/// The surface of a garment with crease lines.
#[derive(Debug, Clone)]
pub struct DrawnCreases<'a> {
    /// The garment's surface with edges along every line and the rows beside it.
    pub mesh: SurfaceMesh<'a>,
    /// Distance of the rows from their lines [m], the smallest of all.
    pub row: f64,
}

/// Lines being drawn.
pub(super) struct CreaseDrawing<'a> {
    mesh: SurfaceMesh<'a>,
    /// Per line and point of the mesh: signed distance [m]; not a number where the line does not reach.
    levels: Vec<Vec<f64>>,
    /// Distance of the rows of every line [m].
    rows: Vec<f64>,
}

impl<'a> CreaseDrawing<'a> {
    /// Nothing drawn on `garment` yet.
    pub fn new(garment: &'a Garment) -> Self {
        Self { mesh: SurfaceMesh::new(garment), levels: Vec::new(), rows: Vec::new() }
    }

    /// Adds the `lines` of a source; `levels` has their places on the garment.
    pub fn add(&mut self, lines: &[CreaseLine], levels: &[LineLevels]) {
        self.levels.extend(levels.iter().map(|own| own.level.clone()));
        self.rows.extend(lines.iter().map(|line| line.row));
    }

    /// Draws all lines and their rows; `None` without a line.
    pub fn finish(mut self) -> Option<DrawnCreases<'a>> {
        for k in 0..self.levels.len() {
            let mut level = self.levels[k].clone();
            self.cut(&mut level, self.rows[k]);
            self.levels[k] = level;
            for [p, q] in self.mesh.edges_on_line(&self.levels[k]) {
                self.mesh.draw(p, q, Curve::Line(k as u32));
            }
        }
        for k in 0..self.levels.len() {
            let row = self.rows[k];
            for (side, shift) in [row, -row].into_iter().enumerate() {
                let mut level: Vec<f64> = self.levels[k].iter().map(|l| l - shift).collect();
                self.cut(&mut level, row);
                let number = FIRST_ROW + 2 * k as u32 + side as u32;
                for [p, q] in self.mesh.edges_on_line(&level) {
                    if self.is_clear(k, p, q) {
                        self.mesh.draw(p, q, Curve::Line(number));
                    }
                }
            }
        }
        let row = self.rows.iter().copied().reduce(f64::min)?;
        Some(DrawnCreases { mesh: self.mesh, row })
    }

    /// Cuts the mesh along the zero line of `level`, through the points of other curves that lie next to it.
    fn cut(&mut self, level: &mut Vec<f64>, row: f64) {
        for (p, level) in level.iter_mut().enumerate() {
            if level.abs() < TUNING.crease_line_snap * row && self.mesh.curve_degree(p as u32) > 0 {
                *level = 0.0;
            }
        }
        let made = self.mesh.cut(level);
        for CutPoint { ends: [a, b], weight } in made {
            for level in &mut self.levels {
                level.push(level[a as usize] * (1.0 - weight) + level[b as usize] * weight);
            }
        }
    }

    /// Whether no other line runs beside the edge of a row of line `k`; lines that cross it are no hindrance.
    fn is_clear(&self, k: usize, p: u32, q: u32) -> bool {
        let (p, q) = (p as usize, q as usize);
        let length = (self.mesh.x[p] - self.mesh.x[q]).norm();
        let beside = |(j, level): (usize, &Vec<f64>)| {
            let near = level[p].abs().min(level[q].abs()) < TUNING.crease_row_clearance * self.rows[k];
            j != k && near && (level[p] - level[q]).abs() < 0.5 * length
        };
        !self.levels.iter().enumerate().any(beside)
    }
}

/// The best match of every point of `target`, over the triangles around it.
pub(super) fn point_matches(
    correspondence: &impl Correspondence,
    target: &GarmentSurface,
) -> Vec<Option<Match>> {
    let outward = target.orientation_sign();
    let of_face = |f: usize| {
        let normal = outward * target.normal(f).try_normalize(0.0).unwrap_or_default();
        [0, 1, 2].map(|k| {
            let query = Query {
                position: target.points[target.triangles[f][k].at()],
                uv: target.uvs.as_ref().map(|uvs| uvs[f][k]),
                normal,
                gradient: target.texture_gradient(f),
            };
            correspondence.find(f, &query)
        })
    };
    let found: Vec<[Option<Match>; 3]> = (0..target.triangles.len()).into_par_iter().map(of_face).collect();
    let mut best: Vec<Option<Match>> = vec![None; target.points.len()];
    for (t, found) in target.triangles.iter().zip(found) {
        for (p, one) in t.iter().zip(found) {
            let Some(one) = one else { continue };
            let own = &mut best[p.at()];
            if own.is_none_or(|own| one.quality > own.quality) {
                *own = Some(one);
            }
        }
    }
    best
}
