//! What a picture of a worn garment is drawn from: its shape before and after wear, and its memory per point.
//!
//! Made from the sidecar, which has everything in full, or from the mesh file alone, which has it per vertex and in
//! single precision, or not at all (any mesh: shape and curvature can be shown). Chooses no camera; `render` draws.

use crate::garment::{Garment, SourceAsset};
use crate::io::Sidecar;
use crate::io::gltf::{keep_worn_pieces, read_worn};
use crate::math::Vec3;
use crate::mesh::{Hinge, PointIndex, Topology};
use crate::report::render::{
    Camera, Colouring, Field, Image, curvature, largest_of_hinges, mean_of_hinges, render, side_by_side,
};
use crate::{Error, Result};

/// What the colours of a picture show.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColorBy {
    /// The shape alone.
    Shape,
    /// Change of rest angle [degrees].
    RestAngleChange,
    /// Magnitude of curvature [1/m].
    Curvature,
    /// Stiffness ratio [-].
    Stiffness,
    /// Displacement from the garment's own shape [mm].
    Displacement,
    /// Growth of the rest length, of warp or weft the larger in magnitude [%].
    Stretch,
    /// How sure a transfer is of what it carried over, 0 to 1.
    Confidence,
}

impl ColorBy {
    /// Every one, in the order of menus.
    pub const ALL: [Self; 7] = [
        Self::Shape,
        Self::RestAngleChange,
        Self::Curvature,
        Self::Stiffness,
        Self::Displacement,
        Self::Stretch,
        Self::Confidence,
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Shape => "shape",
            Self::RestAngleChange => "rest-angle-change",
            Self::Curvature => "curvature",
            Self::Stiffness => "stiffness",
            Self::Displacement => "displacement",
            Self::Stretch => "stretch",
            Self::Confidence => "confidence",
        }
    }
}

/// A worn garment, ready to be drawn.
#[derive(Debug, Clone)]
pub struct GarmentView {
    /// The file it came from, for messages.
    pub file: String,
    /// Own shape, one per point [m].
    pub before: Vec<Vec3>,
    /// Worn shape, one per point [m].
    pub after: Vec<Vec3>,
    /// Triangles over the points.
    pub triangles: Vec<[PointIndex; 3]>,
    /// What it remembers, if the file says so.
    pub memory: Option<PointMemory>,
    /// One per triangle, after a transfer: how sure it is.
    pub confidence: Option<Vec<f64>>,
}

/// Memory per point, as the attributes of the glTF say it, and what only the sidecar says.
#[derive(Debug, Clone, PartialEq)]
pub struct PointMemory {
    /// Change of rest angle of largest magnitude among the point's hinges [degrees].
    pub rest_angle_change_deg: Vec<f64>,
    /// Mean stiffness ratio of the point's hinges [-].
    pub stiffness_ratio: Vec<f64>,
    /// One per triangle: growth of the rest length [%]; only a sidecar says it.
    pub stretch_percent: Option<Vec<f64>>,
}

impl GarmentView {
    /// From a sidecar, which has been checked when it was read.
    pub fn of_sidecar(file: &str, sidecar: &Sidecar) -> Self {
        let before = sidecar.mesh_points();
        let worn = sidecar.worn();
        let hinges: Vec<Hinge> = sidecar
            .hinges
            .points
            .iter()
            .map(|points| Hinge { points: points.map(PointIndex), triangles: [0, 0], edge: 0 })
            .collect();
        let memory = &worn.memory;
        let change: Vec<f64> = memory
            .rest_angle
            .iter()
            .zip(&memory.source_angle)
            .map(|(rest, source)| (rest - source).to_degrees())
            .collect();
        Self {
            file: file.to_owned(),
            after: before.iter().zip(&worn.displacement).map(|(x, d)| x + d).collect(),
            memory: Some(PointMemory {
                rest_angle_change_deg: largest_of_hinges(before.len(), &hinges, &change),
                stiffness_ratio: mean_of_hinges(before.len(), &hinges, &memory.stiffness_ratio, 1.0),
                stretch_percent: Some(stretch_percent(&memory.rest_stretch_warp, &memory.rest_stretch_weft)),
            }),
            confidence: sidecar.triangles.confidence.clone(),
            before,
            triangles: sidecar.mesh_triangles(),
        }
    }

    /// From a mesh file alone: of a worn glTF its worn pieces, else all that is taken for the garment.
    pub fn of_asset(mut asset: SourceAsset) -> Result<Self> {
        let worn = if keep_worn_pieces(&mut asset) { Some(read_worn(&asset)?) } else { None };
        let (garment, _) = Garment::from_asset(&asset)?;
        let mut after = garment.points.clone();
        let memory = worn.map(|worn| {
            let mut memory = PointMemory {
                rest_angle_change_deg: vec![0.0; after.len()],
                stiffness_ratio: vec![1.0; after.len()],
                stretch_percent: None,
            };
            // Backwards, so that the first vertex of a point decides, as it did for the garment.
            for (v, point) in garment.source_point.iter().enumerate().rev() {
                if let Some(x) = worn.positions.get(v) {
                    after[point.at()] = *x;
                }
                memory.rest_angle_change_deg[point.at()] = worn.rest_angle_deg.get(v).copied().unwrap_or(0.0);
                memory.stiffness_ratio[point.at()] = worn.stiffness_ratio.get(v).copied().unwrap_or(1.0);
            }
            memory
        });
        Ok(Self {
            file: asset.file,
            before: garment.points,
            after,
            triangles: garment.triangles,
            memory,
            confidence: None,
        })
    }

    /// The worn garment, seen by `camera`, in `size` = [width, height] pixels.
    pub fn draw(&self, show: ColorBy, camera: &Camera, size: [usize; 2]) -> Result<Image> {
        render(&self.after, &self.triangles, &self.colouring(show)?, camera, size)
    }

    /// Own shape and worn shape beside each other, each of `size` pixels, in the same colours.
    pub fn draw_before_after(&self, show: ColorBy, camera: &Camera, size: [usize; 2]) -> Result<Image> {
        let colouring = self.colouring(show)?;
        let new = match (&colouring, self.field(show, &self.before, None)) {
            (Colouring::Field(worn), Some(new)) => {
                Colouring::Field(Field { range: Some(worn.limits()), ..new })
            }
            _ => Colouring::Shape,
        };
        let before = render(&self.before, &self.triangles, &new, camera, size)?;
        let after = render(&self.after, &self.triangles, &colouring, camera, size)?;
        Ok(side_by_side(&before, &after, ["before", "after"]))
    }

    /// What `show` colours the worn garment with; `None` for the bare shape, and for what its file does not say.
    pub fn field_of(&self, show: ColorBy) -> Option<Field> {
        if self.memory.is_none() && !matches!(show, ColorBy::Curvature | ColorBy::Displacement) {
            return None;
        }
        self.field(show, &self.after, self.memory.as_ref())
    }

    fn colouring(&self, show: ColorBy) -> Result<Colouring> {
        if show == ColorBy::Confidence && self.confidence.is_none() {
            return Err(Error::input(
                &self.file,
                "",
                "says nothing of confidence",
                "give the OUT.glb that `crease transfer` wrote, with its sidecar beside it",
            ));
        }
        if show != ColorBy::Shape && show != ColorBy::Curvature && self.memory.is_none() {
            return Err(Error::input(
                &self.file,
                "",
                "holds no wear to show",
                "give the OUT.glb that `crease bake` wrote, or show shape or curvature",
            ));
        }
        match self.field(show, &self.after, self.memory.as_ref()) {
            Some(field) => Ok(Colouring::Field(field)),
            None if show == ColorBy::Shape => Ok(Colouring::Shape),
            None => Err(Error::input(
                &self.file,
                "",
                format!("says nothing of {}", show.name()),
                "keep OUT.crease.json beside OUT.glb",
            )),
        }
    }

    /// Field on the shape `x`; without `memory` that of new cloth. `None` for the bare shape.
    fn field(&self, show: ColorBy, x: &[Vec3], memory: Option<&PointMemory>) -> Option<Field> {
        let new = |value: f64| vec![value; x.len()];
        match show {
            ColorBy::Shape => None,
            ColorBy::RestAngleChange => {
                Some(Field::rest_angle(memory.map_or_else(|| new(0.0), |m| m.rest_angle_change_deg.clone())))
            }
            ColorBy::Stiffness => {
                Some(Field::stiffness_ratio(memory.map_or_else(|| new(1.0), |m| m.stiffness_ratio.clone())))
            }
            ColorBy::Displacement => {
                let moved = x.iter().zip(&self.before).map(|(x, home)| 1e3 * (x - home).norm());
                Some(Field::displacement_mm(moved.collect()))
            }
            ColorBy::Stretch => match memory {
                Some(memory) => memory.stretch_percent.clone().map(Field::stretch_percent),
                None => Some(Field::stretch_percent(vec![0.0; self.triangles.len()])),
            },
            ColorBy::Confidence => self.confidence.clone().map(Field::confidence),
            ColorBy::Curvature => {
                // A file may name a point twice in a triangle; topology may not be asked about that.
                let sound: Vec<[PointIndex; 3]> =
                    self.triangles.iter().filter(|[a, b, c]| a != b && b != c && c != a).copied().collect();
                Some(Field::curvature(curvature(x, &sound, &Topology::new(x.len(), &sound))))
            }
        }
    }
}

/// Per triangle: of warp and weft the growth of larger magnitude [%].
fn stretch_percent(warp: &[f64], weft: &[f64]) -> Vec<f64> {
    let growth = |ratio: f64| 100.0 * (ratio - 1.0);
    let larger = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
    warp.iter().zip(weft).map(|(u, v)| larger(growth(*u), growth(*v))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_of_the_command_line_and_differ() {
        let mut names = ColorBy::ALL.map(ColorBy::name).to_vec();
        names.sort_unstable();
        names.dedup();
        assert_eq!(names.len(), ColorBy::ALL.len());
    }

    #[test]
    fn stretch_takes_the_axis_that_changed_more() {
        let percent = stretch_percent(&[1.02, 1.0, 0.99], &[1.01, 0.95, 1.0]);
        for (found, wanted) in percent.iter().zip([2.0, -5.0, -1.0]) {
            assert!((found - wanted).abs() < 1e-12, "{percent:?}");
        }
    }
}
