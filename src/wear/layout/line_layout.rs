//! Fold lines drawn on the surface of a garment that is laid out flat: layers folded along lines.
//!
//! A fold cuts the surface mesh along its line through all layers and turns the flap over; what was opened again is flat for the
//! next fold. Positions have no thickness, but layers have an order: in a stack outer layers run round inner ones, and the
//! middle of their bend lies farther out. [`crate::wear::draw_fold_lines`] feeds it with the actions of a script.

use crate::wear::layout::fold_map::{bend_middle, line_shift};
use crate::wear::layout::layer_order::LayerOrder;
use crate::wear::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_model::remesh::{Curve, CutPoint, SurfaceMesh};

/// Number of the first row beside a line; fold lines are numbered from 0.
const FIRST_ROW: u32 = 1 << 16;

/// Whether the number of a line is that of a row beside a fold line.
pub fn is_row(number: u32) -> bool {
    number >= FIRST_ROW
}

/// Positions and layers before a fold.
#[derive(Debug, Clone)]
struct BeforeFold {
    /// One per point [m].
    positions: Vec<Vec3>,
    /// One per triangle.
    layers: Vec<u32>,
}

/// A surface mesh with the lines drawn so far. The tag of a triangle is its layer, counted from below.
#[derive(Debug, Clone)]
pub(crate) struct LineLayout<'a> {
    mesh: SurfaceMesh<'a>,
    /// Thickness of a layer [m].
    thickness: f64,
    /// Distance of the rows beside a line [m].
    row: f64,
    /// Positions without thickness, one per point of the mesh [m].
    positions: Vec<Vec3>,
    /// State before every fold that has not been opened, oldest first.
    before_folds: Vec<BeforeFold>,
    /// Per fold and point: signed distance from its line when it was made [m].
    levels: Vec<Vec<f64>>,
}

impl<'a> LineLayout<'a> {
    /// No line yet on `mesh`, of layers of `thickness` [m]; lines will have rows at `row` [m] on either side.
    pub fn new(mesh: SurfaceMesh<'a>, thickness: f64, row: f64) -> Self {
        let positions = mesh.x.clone();
        Self { positions, thickness, row, mesh, before_folds: Vec::new(), levels: Vec::new() }
    }

    /// Positions of the points of the garment, one per point [m].
    pub fn garment_positions(&self) -> &[Vec3] {
        &self.positions[..self.mesh.source.points.len()]
    }

    /// The surface mesh with all lines.
    pub fn into_mesh(self) -> SurfaceMesh<'a> {
        self.mesh
    }

    /// Lays the cloth out at `positions` [m], one per point of the garment; what lies higher is a higher layer.
    /// Where `rim`, one per point, is 0 the cloth turns over, and a line is drawn. Returns whether that is possible: after a fold the points of the lines have no position in a new layout.
    pub fn lay_down(&mut self, positions: &[Vec3], rim: Option<Vec<f64>>) -> bool {
        if !self.levels.is_empty() {
            return false;
        }
        self.mesh.tag = ranks_by_height(&self.mesh.triangles, positions);
        self.positions = positions.iter().map(|p| Vec3::new(p.x, 0.0, p.z)).collect();
        if let Some(mut rim) = rim {
            self.cut(&mut rim);
            for [p, q] in self.mesh.edges_on_line(&rim) {
                self.mesh.draw(p, q, Curve::Rim);
            }
        }
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
        let beyond: Vec<f64> = self.positions.iter().map(|p| (p - origin).dot(&outward)).collect();
        let bends = self.bend_offsets(&beyond);
        let mut level: Vec<f64> = beyond.iter().zip(&bends).map(|(beyond, bend)| beyond - bend).collect();
        self.cut(&mut level);
        let number = self.levels.len() as u32;
        for [p, q] in self.mesh.edges_on_line(&level) {
            self.mesh.draw(p, q, Curve::Line(number));
        }
        self.before_folds
            .push(BeforeFold { positions: self.positions.clone(), layers: self.mesh.tag.clone() });
        let top = self.mesh.tag.iter().copied().max().unwrap_or(0);
        for (tag, t) in self.mesh.tag.iter_mut().zip(&self.mesh.triangles) {
            if t.iter().map(|p| level[*p as usize]).sum::<f64>() > 0.0 {
                *tag = top.saturating_mul(2).saturating_add(1).saturating_sub(*tag);
            }
        }
        for (p, level) in self.positions.iter_mut().zip(&level) {
            if *level > 0.0 {
                *p -= outward * (2.0 * (*p - origin).dot(&outward));
            }
        }
        self.levels.push(level);
    }

    /// Cuts the mesh along the zero line of `level`, through the points that lie next to it: cut points beside one would make tiny
    /// triangles. Points of other curves count from farther off, so that an edge between two curves stays as short as it is.
    fn cut(&mut self, level: &mut Vec<f64>) {
        let tuning = &TUNING.prediction;
        for (p, level) in level.iter_mut().enumerate() {
            let snap = if self.mesh.curve_degree(p as u32) > 0 { tuning.snap_rows } else { tuning.snap_free };
            if level.abs() < snap * self.row {
                *level = 0.0;
            }
        }
        let made = self.mesh.cut(level);
        self.extend(&made);
    }

    /// Per point: where the middle of the bend of its layer lies, beyond a fold line from which points lie `beyond` [m]. The
    /// middle of the whole stack's lies on the line ([`line_shift`]).
    fn bend_offsets(&self, beyond: &[f64]) -> Vec<f64> {
        let width = TUNING.fold.strip_width;
        let order = LayerOrder::new(&self.mesh, &self.positions, |p| beyond[p].abs() < 2.0 * width);
        let rank = |p: usize| -> f64 {
            let around = &self.mesh.around[p];
            around.iter().map(|&f| f64::from(order.below(f))).sum::<f64>() / around.len().max(1) as f64
        };
        let height = |p: usize| (rank(p) + TUNING.prediction.lowest_layer_height) * self.thickness;
        let near: Vec<usize> = (0..beyond.len()).filter(|&p| beyond[p].abs() < width).collect();
        let mut heights: Vec<f64> = near.iter().map(|&p| height(p)).collect();
        heights.sort_unstable_by(f64::total_cmp);
        let top = (TUNING.fold.stack_quantile * heights.len() as f64) as usize;
        let Some(top) = heights.get(top).copied() else { return vec![0.0; beyond.len()] };
        let mut offsets = vec![0.0; beyond.len()];
        for p in near {
            let depth = top + TUNING.fold.axis_clearance * self.thickness - height(p);
            offsets[p] = bend_middle(depth.max(0.0)) - line_shift(top);
        }
        offsets
    }

    /// Opens the last `count` folds, or all.
    pub fn unfold(&mut self, count: Option<usize>) {
        let left = count.map_or(0, |count| self.before_folds.len().saturating_sub(count));
        if let Some(before) = self.before_folds.drain(left..).next() {
            self.positions = before.positions;
            // Triangles of later cuts lie in the layer of the one they are a part of.
            let old = before.layers.len();
            self.mesh.tag[..old].copy_from_slice(&before.layers);
            for f in old..self.mesh.tag.len() {
                self.mesh.tag[f] = self.mesh.tag[self.mesh.parent_of(f as u32) as usize];
            }
        }
    }

    /// Values of new points, linear between those of the ends they lie between.
    fn extend(&mut self, made: &[CutPoint]) {
        for CutPoint { ends: [a, b], weight } in made {
            let (a, b) = (*a as usize, *b as usize);
            let before = self.before_folds.iter_mut().map(|before| &mut before.positions);
            for x in before.chain([&mut self.positions]) {
                x.push(x[a] * (1.0 - weight) + x[b] * *weight);
            }
            for level in &mut self.levels {
                level.push(level[a] * (1.0 - weight) + level[b] * weight);
            }
        }
    }

    /// Draws a row of edges on either side of every fold line, where no other line is near.
    pub fn draw_rows(&mut self) {
        let row = self.row;
        for k in 0..self.levels.len() {
            for (side, shift) in [row, -row].into_iter().enumerate() {
                let mut level: Vec<f64> = self.levels[k].iter().map(|l| l - shift).collect();
                self.cut(&mut level);
                let number = FIRST_ROW + 2 * k as u32 + side as u32;
                for [p, q] in self.mesh.edges_on_line(&level) {
                    if self.is_clear(k, p, q) {
                        self.mesh.draw(p, q, Curve::Line(number));
                    }
                }
            }
        }
    }

    /// Whether no other line runs beside the edge of a row of line `k`; lines that cross it are no hindrance.
    fn is_clear(&self, k: usize, p: u32, q: u32) -> bool {
        let (p, q) = (p as usize, q as usize);
        let length = (self.mesh.x[p] - self.mesh.x[q]).norm();
        let beside = |(j, level): (usize, &Vec<f64>)| {
            let near = level[p].abs().min(level[q].abs()) < TUNING.prediction.row_clearance * self.row;
            j != k && near && (level[p] - level[q]).abs() < 0.5 * length
        };
        !self.levels.iter().enumerate().any(beside)
    }
}
/// Per triangle at `positions` [m]: its rank by the height of its centroid; of equal heights one that looks up is higher.
fn ranks_by_height(triangles: &[[u32; 3]], positions: &[Vec3]) -> Vec<u32> {
    let key = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|p| positions[p as usize]);
        (a.y + b.y + c.y, (b - a).cross(&(c - a)).y > 0.0)
    };
    let keys: Vec<(f64, bool)> = triangles.iter().map(key).collect();
    let mut order: Vec<usize> = (0..keys.len()).collect();
    let compare = |f: usize, g: usize| keys[f].0.total_cmp(&keys[g].0).then(keys[f].1.cmp(&keys[g].1));
    order.sort_by(|f, g| compare(*f, *g));
    let mut ranks = vec![0; keys.len()];
    for w in order.windows(2) {
        ranks[w[1]] = ranks[w[0]] + u32::from(compare(w[0], w[1]).is_ne());
    }
    ranks
}
