//! Layout of a garment while its fold lines are drawn, before anything is simulated.
//!
//! Every action is applied in turn. A fold draws its line on the surface through all layers and turns the flap over; an action
//! that may crease the cloth anywhere ends the prediction.

use crate::wear::action_runner::{ActionContext, ActionStart};
use crate::wear::layout::flat_layout::LayoutQuality;
use crate::wear::layout::line_layout::LineLayout;
use crate::wear::persistent_state::{GarmentFrame, PersistentState};
use crate::wear::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::triangle;
use crease_model::error::Result;
use crease_model::garment::Garment;
use crease_model::remesh::SurfaceMesh;

/// How far ahead the creases of a script are known.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Foresight {
    /// The script creases the cloth along its fold lines only.
    Whole,
    /// The garment does not lie in its file: where lines run on it is known once it was laid, by the first action.
    NeedsLaying,
    /// An action, by its index in the flattened script, may crease the cloth anywhere.
    Until(usize),
}

/// A garment with the fold lines of the actions so far.
#[derive(Debug, Clone)]
pub struct FoldLayout<'a> {
    garment: &'a Garment,
    /// Positions of the garment once it lies, one per point [m], where they are known.
    laid: Option<&'a [Vec3]>,
    /// Thickness of a layer [m]: a garment that is no higher than a few layers lies already.
    thickness: f64,
    lines: LineLayout<'a>,
    persistent: PersistentState,
    /// How good the layout in the plane is, of a garment that does not lie in its file.
    quality: Option<LayoutQuality>,
    foresight: Foresight,
    /// Index of the current action.
    action: usize,
}

impl<'a> FoldLayout<'a> {
    /// The layout of `garment` as its file has it, before any action. `laid` are the positions after it was laid, one per point
    /// [m], where they are known; `thickness` is that of a layer [m], `row` the distance of
    /// the rows beside a line [m].
    pub(crate) fn new(garment: &'a Garment, laid: Option<&'a [Vec3]>, thickness: f64, row: f64) -> Self {
        Self {
            garment,
            laid,
            thickness,
            lines: LineLayout::new(SurfaceMesh::new(garment), thickness, row),
            persistent: PersistentState::default(),
            quality: None,
            foresight: Foresight::Whole,
            action: 0,
        }
    }

    /// Sets the index of the action that comes next. Returns whether its creases can still be told.
    pub(crate) fn begin_action(&mut self, index: usize) -> bool {
        self.action = index;
        self.foresight == Foresight::Whole
    }

    /// The lines so far, and how far they go; also, of a garment that was laid out, how good its layout is.
    pub(crate) fn finish(self) -> (LineLayout<'a>, Foresight, Option<LayoutQuality>) {
        (self.lines, self.foresight, self.quality)
    }

    /// Marks that the cloth may crease anywhere.
    pub(crate) fn mark_unpredictable(&mut self) {
        self.foresight = Foresight::Until(self.action);
    }

    /// Leaves the cloth as it lies; cloth that does not lie falls and may crease anywhere.
    pub(crate) fn require_flat(&mut self) {
        if self.ground_frame().is_none() {
            self.mark_unpredictable();
        }
    }

    /// Takes the garment up: it keeps its lines, and lies no more.
    pub(crate) fn take_up(&mut self) {
        self.persistent.frame = None;
    }

    /// The frame of fractions, if the cloth lies.
    pub(crate) fn ground_frame(&self) -> Option<GarmentFrame> {
        self.persistent.ground_frame()
    }

    /// Lays the cloth down as the action does that `start` starts.
    pub(crate) fn lay_down(
        &mut self,
        start: impl FnOnce(&ActionContext, &mut PersistentState) -> Result<ActionStart>,
    ) {
        let context = ActionContext {
            positions: self.lines.garment_positions(),
            source_positions: &self.garment.points,
            triangles: &self.garment.triangles,
            masses: &[],
            thickness: self.thickness,
            script_file: "",
            location: "",
        };
        let started = start(&context, &mut self.persistent);
        let Some((Some(mut positions), laid_out)) =
            started.ok().map(|start| (start.start_positions, start.laid_out))
        else {
            return self.mark_unpredictable();
        };
        self.quality = laid_out.as_ref().map(|laid_out| laid_out.quality);
        let rim = laid_out.map(|laid_out| laid_out.level);
        // Laid out on the triangles of the file, it is not yet where it will lie.
        if rim.is_some() || !self.is_flat(&positions) {
            match (self.action, self.laid) {
                (0, None) => {
                    self.foresight = Foresight::NeedsLaying;
                    if rim.is_none() {
                        return;
                    }
                }
                (0, Some(laid)) => {
                    positions = laid.to_vec();
                    self.persistent.frame = Some(GarmentFrame::lying(laid));
                }
                _ => return self.mark_unpredictable(),
            }
        }
        if !self.lines.lay_down(&positions, rim) {
            self.mark_unpredictable();
        }
    }

    /// Whether the triangles at `positions` [m] lie level, as a whole.
    fn is_flat(&self, positions: &[Vec3]) -> bool {
        let normals = self.garment.triangles.iter();
        let normals = normals.map(|t| triangle::area_vector(&triangle::corners(positions, t)));
        let (vertical, area) = normals.fold((0.0, 0.0), |(y, all), n| (y + n.y.abs(), all + n.norm()));
        vertical >= TUNING.prediction.min_flat_normal_y * area
    }

    /// Turns over what lies beyond the line through `origin` [m]; `outward` is the unit vector across the line.
    pub(crate) fn fold(&mut self, origin: Vec3, outward: Vec3) {
        self.lines.fold(origin, outward);
    }

    /// Opens the last `count` folds, or all.
    pub(crate) fn unfold(&mut self, count: Option<usize>) {
        self.lines.unfold(count);
    }
}
