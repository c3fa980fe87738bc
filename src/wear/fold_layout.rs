//! Layout of a garment while its creases are predicted: layers without thickness, folded along lines.
//!
//! Every action is applied in turn. A fold marks what lies along its line, in all layers, and turns the flap over. A
//! garment that lies is marked along its sides, where the upper layer passes into the lower one, and a weight marks what
//! lies on such a side: it bends over that step. An action whose creases cannot be predicted marks the layout as
//! unpredictable.

use crate::error::Result;
use crate::garment::Garment;
use crate::math::Vec3;
use crate::mesh::triangle;
use crate::remesh::SurfaceMesh;
use crate::wear::action_runner::{ActionContext, ActionStart};
use crate::wear::line_layout::LineLayout;
use crate::wear::persistent_state::{GarmentFrame, PersistentState};
use crate::wear::tuning::TUNING;
use rustc_hash::FxHashMap;

/// Distances of a point from predicted creases [m]; infinite beyond the reach of the prediction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct CreaseDistance {
    /// Distance from the nearest fold line.
    pub fold: f64,
    /// Distance from the nearest side of the garment, its own or one that it is pressed on.
    pub side: f64,
}

/// Positions and layers before a fold.
#[derive(Debug, Clone)]
struct LayoutSnapshot {
    positions: Vec<Vec3>,
    layers: Vec<u32>,
}

/// A point on a side of the garment.
#[derive(Debug, Clone, Copy)]
struct SidePoint {
    /// [m].
    position: Vec3,
    layer: u32,
}

/// Points on sides by cell.
type SidePoints = FxHashMap<[i32; 2], Vec<SidePoint>>;

/// A flat layout of a garment with the distances of its points from creases.
#[derive(Debug, Clone)]
pub struct FoldLayout<'a> {
    garment: &'a Garment,
    /// Largest distance from a line that counts [m].
    reach: f64,
    /// Positions without thickness, one per point [m].
    positions: Vec<Vec3>,
    /// Per point: its layer, counted from below.
    layers: Vec<u32>,
    /// State before every fold that has not been opened, oldest first.
    before_folds: Vec<LayoutSnapshot>,
    persistent: PersistentState,
    /// Edges between the upper layer and the lower one.
    side_edges: Vec<[u32; 2]>,
    distances: Vec<CreaseDistance>,
    /// Fold lines on the surface, where they are drawn.
    lines: Option<LineLayout<'a>>,
    /// Whether an action creases the cloth in a way that cannot be predicted.
    unpredictable: bool,
}

impl<'a> FoldLayout<'a> {
    /// The layout of `garment` as its file has it, before any action; distances up to `reach` [m] count.
    pub(super) fn new(garment: &'a Garment, reach: f64) -> Self {
        let count = garment.points.len();
        Self {
            garment,
            reach,
            positions: garment.points.clone(),
            layers: vec![0; count],
            before_folds: Vec::new(),
            persistent: PersistentState::default(),
            side_edges: Vec::new(),
            distances: vec![CreaseDistance { fold: f64::INFINITY, side: f64::INFINITY }; count],
            lines: None,
            unpredictable: false,
        }
    }

    /// Draws the fold lines of the following actions on the surface.
    pub(super) fn draw_lines(&mut self) {
        self.lines = Some(LineLayout::new(SurfaceMesh::new(self.garment)));
    }

    /// The fold lines, if they were drawn.
    pub(super) fn into_lines(self) -> Option<LineLayout<'a>> {
        self.lines
    }

    /// Distances of the points from creases, one per point.
    pub(super) fn into_distances(self) -> Vec<CreaseDistance> {
        self.distances
    }

    /// Whether the cloth may crease anywhere.
    pub(super) fn is_unpredictable(&self) -> bool {
        self.unpredictable
    }

    /// Marks that the cloth may crease anywhere.
    pub(super) fn mark_unpredictable(&mut self) {
        self.unpredictable = true;
    }

    /// Leaves the cloth as it lies; cloth that does not lie falls and may crease anywhere.
    pub(super) fn require_flat(&mut self) {
        if self.ground_frame().is_none() {
            self.mark_unpredictable();
        }
    }

    /// The frame of fractions, if the cloth lies.
    pub(super) fn ground_frame(&self) -> Option<GarmentFrame> {
        self.persistent.ground_frame()
    }

    /// Lays the cloth down as the action does that `start` starts.
    pub(super) fn lay_down(
        &mut self,
        start: impl FnOnce(&ActionContext, &mut PersistentState) -> Result<ActionStart>,
    ) {
        let context = ActionContext {
            positions: &self.positions,
            source_positions: &self.garment.points,
            masses: &[],
            thickness: 0.0,
            script_file: "",
            location: "",
        };
        let started = start(&context, &mut self.persistent);
        let Some(laid) = started.ok().and_then(|start| start.start_positions) else {
            return self.mark_unpredictable();
        };
        self.positions = laid;
        self.before_folds.clear();
        let normals: Vec<Vec3> = self
            .garment
            .triangles
            .iter()
            .map(|t| triangle::area_vector(&triangle::corners(&self.positions, t)))
            .collect();
        let vertical = normals.iter().fold(0.0, |sum, n| sum + n.y.abs());
        let area = normals.iter().fold(0.0, |sum, n| sum + n.norm());
        if vertical < TUNING.prediction.min_flat_normal_y * area {
            return self.mark_unpredictable();
        }
        self.positions.iter_mut().for_each(|p| p.y = 0.0);
        if self.lines.as_mut().is_some_and(|lines| !lines.lay_down(&self.positions)) {
            return self.mark_unpredictable();
        }
        self.find_sides(&normals);
        let own = self.side_points();
        for p in 0..self.positions.len() {
            self.mark_side(p, &own, |_| true);
        }
    }

    /// Turns over what lies beyond the line through `origin` [m]; `outward` is the unit vector across the line.
    pub(super) fn fold(&mut self, origin: Vec3, outward: Vec3) {
        if let Some(lines) = &mut self.lines {
            lines.fold(origin, outward);
        }
        self.before_folds
            .push(LayoutSnapshot { positions: self.positions.clone(), layers: self.layers.clone() });
        let top = self.layers.iter().copied().max().unwrap_or(0);
        for ((p, distance), layer) in self.positions.iter_mut().zip(&mut self.distances).zip(&mut self.layers)
        {
            let beyond = (*p - origin).dot(&outward);
            if beyond.abs() < self.reach {
                distance.fold = distance.fold.min(beyond.abs());
            }
            if beyond > 0.0 {
                *p -= outward * (2.0 * beyond);
                *layer = (2 * top + 1).saturating_sub(*layer);
            }
        }
    }

    /// Opens the last `count` folds, or all.
    pub(super) fn unfold(&mut self, count: Option<usize>) {
        if let Some(lines) = &mut self.lines {
            lines.unfold(count);
        }
        let left = count.map_or(0, |count| self.before_folds.len().saturating_sub(count));
        if let Some(before) = self.before_folds.drain(left..).next() {
            self.positions = before.positions;
            self.layers = before.layers;
        }
    }

    /// Presses down everything that lies there.
    pub(super) fn press(&mut self) {
        self.require_flat();
        let steps = self.side_points();
        let mut stacks: FxHashMap<[i32; 2], Vec<u32>> = FxHashMap::default();
        for (p, layer) in self.positions.iter().zip(&self.layers) {
            stacks.entry(self.cell(p)).or_default().push(*layer);
        }
        for stack in stacks.values_mut() {
            stack.sort_unstable();
            stack.dedup();
        }
        for p in 0..self.positions.len() {
            let Some(stack) = stacks.get(&self.cell(&self.positions[p])) else { continue };
            let own = self.layers[p];
            // Number of layers between the step and this one.
            let between = |step: u32| stack.iter().filter(|&&layer| step < layer && layer < own).count();
            let shows = |step: u32| step < own && between(step) < TUNING.prediction.max_layers_through;
            self.mark_side(p, &steps, shows);
        }
    }

    /// Finds the points of the upper layer, and the edges where it passes into the lower one.
    fn find_sides(&mut self, normals: &[Vec3]) {
        self.layers.fill(0);
        for (t, _) in self.garment.triangles.iter().zip(normals).filter(|(_, normal)| normal.y > 0.0) {
            t.iter().for_each(|p| self.layers[p.at()] = 1);
        }
        let turns = self.garment.topology.hinges.iter().filter(|hinge| {
            let [a, b] = hinge.triangles.map(|f| normals[f as usize].y > 0.0);
            a != b
        });
        self.side_edges = turns.map(|hinge| [hinge.points[0].0, hinge.points[1].0]).collect();
    }

    fn cell(&self, p: &Vec3) -> [i32; 2] {
        [p.x, p.z].map(|c| (c / self.reach).floor() as i32)
    }

    /// The first point and the middle of every edge on a side.
    fn side_points(&self) -> SidePoints {
        let mut points = SidePoints::default();
        for &[a, b] in &self.side_edges {
            let [xa, xb] = [a, b].map(|p| self.positions[p as usize]);
            let layer = self.layers[a as usize].max(self.layers[b as usize]);
            for position in [xa, 0.5 * (xa + xb)] {
                points.entry(self.cell(&position)).or_default().push(SidePoint { position, layer });
            }
        }
        points
    }

    /// Updates the distance of point `p` from those of `sides` whose layer counts.
    fn mark_side(&mut self, p: usize, sides: &SidePoints, counts: impl Fn(u32) -> bool) {
        let own = self.positions[p];
        let [i, j] = self.cell(&own);
        let cells = (i - 1..=i + 1).flat_map(|i| (j - 1..=j + 1).map(move |j| [i, j]));
        let near = cells.filter_map(|cell| sides.get(&cell)).flatten().filter(|side| counts(side.layer));
        let distance = near.map(|side| (side.position - own).norm()).fold(f64::INFINITY, f64::min);
        if distance < self.reach {
            self.distances[p].side = self.distances[p].side.min(distance);
        }
    }
}
