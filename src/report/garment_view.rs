//! Data to draw a worn garment from: its shape before and after wear, and its memory per point.
//!
//! It comes from the sidecar, or from the mesh file alone, which has memory per vertex in single precision or none (then
//! only shape and curvature can be drawn). Drawing is done by `render`.

use crate::report::render::{
    Camera, Colouring, Field, Image, curvature, largest_of_hinges, mean_of_hinges, render, render_shaded,
    side_by_side,
};
use crate::report::worn_view::WornView;
use crease_geometry::math::Vec3;

use crease_geometry::mesh::{Hinge, PointIndex, Topology};

use crease_io::Sidecar;

use crease_io::gltf::{keep_worn_pieces, read_worn};

use crease_model::error::{Error, Message, Operation, Result};
use crease_model::garment::{Garment, SourceAsset};

/// Quantity that colours a picture.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum ColorBy {
    /// Shape only.
    Shape,
    /// Change of rest angle [degrees].
    RestAngleChange,
    /// Magnitude of curvature [1/m].
    Curvature,
    /// Stiffness ratio [-].
    Stiffness,
    /// Displacement from the source shape [mm].
    Displacement,
    /// Change of the rest length along warp or weft, whichever is larger in magnitude [%].
    Stretch,
    /// Confidence of a transfer, 0 to 1.
    Confidence,
}

impl ColorBy {
    /// All quantities, in the order of menus.
    pub const ALL: [Self; 7] = [
        Self::Shape,
        Self::RestAngleChange,
        Self::Curvature,
        Self::Stiffness,
        Self::Displacement,
        Self::Stretch,
        Self::Confidence,
    ];

    /// Returns the name on the command line.
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

/// Shapes and memory of a garment.
#[derive(Debug, Clone)]
pub struct GarmentView {
    /// File of the garment, for messages.
    pub file: String,
    /// Source shape, one position per point [m].
    pub before: Vec<Vec3>,
    /// Worn shape, one position per point [m].
    pub after: Vec<Vec3>,
    /// Triangles over the points.
    pub triangles: Vec<[PointIndex; 3]>,
    /// Per vertex of the worn pieces of the file: its point.
    pub vertex_points: Vec<PointIndex>,
    /// Memory, if the file has any.
    pub memory: Option<PointMemory>,
    /// Confidence of a transfer, one value per triangle.
    pub confidence: Option<Vec<f64>>,
    /// Worn surface, which pictures of the worn garment show in place of its own triangles.
    pub surface: Option<WornView>,
}

/// Memory per point, as in the attributes of the glTF, and per triangle.
#[derive(Debug, Clone, PartialEq)]
pub struct PointMemory {
    /// Change of rest angle with the largest magnitude among the hinges of the point [degrees].
    pub rest_angle_change_deg: Vec<f64>,
    /// Mean stiffness ratio of the hinges of the point [-].
    pub stiffness_ratio: Vec<f64>,
    /// Change of the rest length, one value per triangle [%]; known from a sidecar only.
    pub stretch_percent: Option<Vec<f64>>,
}

impl GarmentView {
    /// Creates the view of a mesh without memory whose vertices are its points; `before` and `after` are its shapes [m].
    pub fn of_shapes(
        file: impl Into<String>,
        [before, after]: [Vec<Vec3>; 2],
        triangles: Vec<[PointIndex; 3]>,
    ) -> Self {
        let vertex_points = (0..before.len() as u32).map(PointIndex).collect();
        let (memory, confidence, surface) = (None, None, None);
        Self { file: file.into(), before, after, triangles, vertex_points, memory, confidence, surface }
    }

    /// Creates the view from a sidecar, which has been validated by its reader.
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
            vertex_points: sidecar.mesh.source_point.iter().map(|&p| PointIndex(p)).collect(),
            surface: None,
        }
    }

    /// Draws the worn surface that `sidecar`, of which the view was made, holds; its own triangles where that cannot be made, with a message that says
    /// why.
    pub fn with_worn_surface(self, sidecar: &Sidecar) -> (Self, Option<Message>) {
        match WornView::of_sidecar(&self.file, sidecar) {
            Ok(surface) => (Self { surface: Some(surface), ..self }, None),
            Err(error) => (self, Some(own_triangles_message(&error))),
        }
    }

    /// Creates the view from a mesh file: the worn pieces of a worn glTF, otherwise the whole garment.
    pub fn of_asset(asset: &mut SourceAsset) -> Result<Self> {
        let worn = if keep_worn_pieces(asset) { Some(read_worn(asset)?) } else { None };
        let (garment, _) = Garment::from_asset(asset)?;
        let (mut before, mut after) = (garment.points.clone(), garment.points.clone());
        let memory = worn.map(|worn| {
            let mut memory = PointMemory {
                rest_angle_change_deg: vec![0.0; after.len()],
                stiffness_ratio: vec![1.0; after.len()],
                stretch_percent: None,
            };
            // In reverse order, so that the first vertex of a point counts, as on import.
            for (v, point) in garment.source_point.iter().enumerate().rev() {
                if let Some(x) = worn.positions.get(v) {
                    after[point.at()] = *x;
                }
                if let Some(x) = worn.source_positions.get(v) {
                    before[point.at()] = *x;
                }
                memory.rest_angle_change_deg[point.at()] = worn.rest_angle_deg.get(v).copied().unwrap_or(0.0);
                memory.stiffness_ratio[point.at()] = worn.stiffness_ratio.get(v).copied().unwrap_or(1.0);
            }
            memory
        });
        Ok(Self {
            file: asset.file.clone(),
            before,
            after,
            triangles: garment.triangles,
            vertex_points: garment.source_point,
            memory,
            confidence: None,
            surface: None,
        })
    }

    /// Draws the worn garment; `size` is [width, height] in pixels. Fails if the file lacks the quantity.
    pub fn draw(&self, color_by: ColorBy, camera: &Camera, size: [usize; 2]) -> Result<Image> {
        self.draw_worn(&self.colouring(color_by)?, camera, size)
    }

    fn draw_worn(&self, colouring: &Colouring, camera: &Camera, size: [usize; 2]) -> Result<Image> {
        let Some(surface) = &self.surface else {
            return render(&self.after, &self.triangles, colouring, camera, size);
        };
        let colouring = match colouring {
            Colouring::Shape => Colouring::Shape,
            Colouring::Field(field) => Colouring::Field(surface.carried(field)),
        };
        let normals = Some(&surface.normals[..]);
        render_shaded(&surface.points, &surface.triangles, normals, &colouring, camera, size)
    }

    /// Draws the source shape and the worn shape side by side, each of `size` pixels, with the same colour scale.
    pub fn draw_before_after(&self, color_by: ColorBy, camera: &Camera, size: [usize; 2]) -> Result<Image> {
        let colouring = self.colouring(color_by)?;
        let new = match (&colouring, self.field(color_by, &self.before, None)) {
            (Colouring::Field(worn), Some(new)) => {
                Colouring::Field(Field { range: Some(worn.limits()), ..new })
            }
            _ => Colouring::Shape,
        };
        let before = render(&self.before, &self.triangles, &new, camera, size)?;
        let after = self.draw_worn(&colouring, camera, size)?;
        Ok(side_by_side(&before, &after, ["before", "after"]))
    }

    /// Returns the values of `color_by` on the worn garment; `None` for the shape, and where the file lacks the quantity.
    pub fn field_of(&self, color_by: ColorBy) -> Option<Field> {
        if self.memory.is_none() && !matches!(color_by, ColorBy::Curvature | ColorBy::Displacement) {
            return None;
        }
        self.field(color_by, &self.after, self.memory.as_ref())
    }

    /// Returns how the worn garment is coloured; fails where the file lacks the quantity.
    fn colouring(&self, color_by: ColorBy) -> Result<Colouring> {
        if color_by == ColorBy::Confidence && self.confidence.is_none() {
            return Err(Error::input(
                &self.file,
                "",
                "has no confidence",
                Message::from("give the OUT.glb that `")
                    + Operation::Transfer
                    + "` wrote, with its sidecar beside it",
            ));
        }
        if color_by != ColorBy::Shape && color_by != ColorBy::Curvature && self.memory.is_none() {
            return Err(Error::input(
                &self.file,
                "",
                "holds no wear to show",
                Message::from("give the OUT.glb that `")
                    + Operation::Bake
                    + "` wrote, or show shape or curvature",
            ));
        }
        match self.field(color_by, &self.after, self.memory.as_ref()) {
            Some(field) => Ok(Colouring::Field(field)),
            None if color_by == ColorBy::Shape => Ok(Colouring::Shape),
            None => Err(Error::input(
                &self.file,
                "",
                format!("has no {}", color_by.name()),
                "keep OUT.crease.json beside OUT.glb",
            )),
        }
    }

    /// Returns the values on the shape `x`, of new cloth where there is no `memory`; `None` for the shape.
    fn field(&self, color_by: ColorBy, x: &[Vec3], memory: Option<&PointMemory>) -> Option<Field> {
        let new = |value: f64| vec![value; x.len()];
        match color_by {
            ColorBy::Shape => None,
            ColorBy::RestAngleChange => Some(Field::rest_angle_change(
                memory.map_or_else(|| new(0.0), |m| m.rest_angle_change_deg.clone()),
            )),
            ColorBy::Stiffness => {
                Some(Field::stiffness_ratio(memory.map_or_else(|| new(1.0), |m| m.stiffness_ratio.clone())))
            }
            ColorBy::Displacement => {
                let moved = x.iter().zip(&self.before).map(|(x, source)| 1e3 * (x - source).norm());
                Some(Field::displacement_mm(moved.collect()))
            }
            ColorBy::Stretch => match memory {
                Some(memory) => memory.stretch_percent.clone().map(Field::stretch_percent),
                None => Some(Field::stretch_percent(vec![0.0; self.triangles.len()])),
            },
            ColorBy::Confidence => self.confidence.clone().map(Field::confidence),
            ColorBy::Curvature => {
                // Topology requires triangles of three different points, which a file need not have.
                let valid: Vec<[PointIndex; 3]> =
                    self.triangles.iter().filter(|[a, b, c]| a != b && b != c && c != a).copied().collect();
                Some(Field::curvature(curvature(x, &valid, &Topology::new(x.len(), &valid))))
            }
        }
    }
}

/// Message that the triangles of a file are shown in place of its worn surface, because of `error`.
pub fn own_triangles_message(error: &Error) -> Message {
    format!("shows the triangles of the file, not what was worn: {error}").into()
}

/// Returns per triangle the change along warp or weft, whichever is larger in magnitude [%].
fn stretch_percent(warp: &[f64], weft: &[f64]) -> Vec<f64> {
    let growth = |ratio: f64| 100.0 * (ratio - 1.0);
    let larger = |a: f64, b: f64| if b.abs() > a.abs() { b } else { a };
    warp.iter().zip(weft).map(|(u, v)| larger(growth(*u), growth(*v))).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_unique() {
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
