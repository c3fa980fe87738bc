//! The result of a bake: the garment in its source pose, with its memory.

use crate::error::{Message, Setting};
use crate::garment::{Garment, RestState};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::triangle::{area, corners};
use crease_geometry::mesh::{Hinge, PointIndex, hinge_angle, unwrap_angle};

/// Change of rest angle from which a hinge counts for what is shown [rad]: 20 degrees.
const MIN_SHOWN_CHANGE: f64 = 0.35;
/// Width of cloth beside creases that turns by this angle at most [m], an assumption: a radius of 30 mm.
const OPENED_WIDTH: f64 = 0.015;
/// Fraction shown below which a warning is given [-].
const MIN_SHOWN_FRACTION: f64 = 0.2;

/// Fraction of the angle that a pose leaves of a crease which `hinge` has where it lies in none: by the width of cloth that it stands for, at most
/// 1 [-].
pub(crate) fn opened_fraction(points: &[Vec3], triangles: &[[PointIndex; 3]], hinge: &Hinge) -> f64 {
    let [a, b, ..] = hinge.points.map(|p| points[p.at()]);
    let area: f64 = hinge.triangles.iter().map(|f| area(&corners(points, &triangles[*f as usize]))).sum();
    (area / (b - a).norm().max(f64::MIN_POSITIVE) / OPENED_WIDTH).min(1.0)
}

/// Garment after wear.
#[derive(Debug, Clone)]
pub struct WornGarment {
    /// One per point: displacement from the source pose \[m\], y up.
    pub displacement: Vec<Vec3>,
    /// Rest state that the wear left.
    pub memory: RestState,
}

impl WornGarment {
    /// Angle to which the pose of a garment opens a crease that remembers any more, an assumption [rad]: 29 degrees, which moves
    /// its line by 10 mm where it decays over 55 mm.
    pub const OPENED_ANGLE: f64 = 0.51;

    /// Fraction of what strong hinges of `garment` remember, opened as its pose does, that the worn shape bends them by (regression by length of
    /// hinge) [-]; `None` where no hinge remembers 20 degrees.
    pub fn shown_fraction(&self, garment: &Garment) -> Option<f64> {
        let (mut both, mut own) = (0.0, 0.0);
        for (h, hinge) in garment.topology.hinges.iter().enumerate() {
            let change = self.memory.rest_angle[h] - self.memory.source_angle[h];
            if change.abs() < MIN_SHOWN_CHANGE {
                continue;
            }
            let limit = Self::OPENED_ANGLE * opened_fraction(&garment.points, &garment.triangles, hinge);
            let change = change.clamp(-limit, limit);
            let source = hinge.points.map(|p| garment.points[p.at()]);
            let worn = hinge.points.map(|p| garment.points[p.at()] + self.displacement[p.at()]);
            let before = hinge_angle(&source);
            let bend = unwrap_angle(hinge_angle(&worn), before) - before;
            let length = (source[1] - source[0]).norm();
            both += length * bend * change;
            own += length * change * change;
        }
        (own > 0.0).then(|| both / own)
    }

    /// Warning if the worn shape of `garment` shows less than a fifth of what it remembers.
    pub fn hidden_warning(&self, garment: &Garment) -> Option<Message> {
        let shown = self.shown_fraction(garment).filter(|shown| *shown < MIN_SHOWN_FRACTION)?;
        let what = format!(
            "the worn shape shows {:.0} % of what is remembered: the triangles of the file cannot follow its creases; ",
            100.0 * shown.max(0.0)
        );
        Some(
            Message::from(what)
                + Setting::Resolution
                + " refines them, "
                + Setting::DetailMap
                + " shows the rest in the normal map",
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_is_remembered_and_not_shown_is_told() {
        let points = vec![Vec3::zeros(), Vec3::z(), -Vec3::x(), Vec3::x()];
        let garment = Garment::of_triangles(points, &[[0, 1, 2], [1, 0, 3]]);
        let mut memory = RestState::flat(1, 2);
        memory.rest_angle[0] = 1.0;
        let mut worn = WornGarment { displacement: vec![Vec3::zeros(); 4], memory };
        assert_eq!(worn.shown_fraction(&garment), Some(0.0));
        assert!(worn.hidden_warning(&garment).is_some());
        // The second wing turned by half of what the pose leaves of it, to the side of a positive angle.
        let bend = |angle: f64| Vec3::new(angle.cos(), angle.sin(), 0.0);
        let quad = |wing: Vec3| hinge_angle(&[Vec3::zeros(), Vec3::z(), -Vec3::x(), wing]);
        let half = 0.5 * WornGarment::OPENED_ANGLE;
        let wing = if quad(bend(half)) > 0.0 { bend(half) } else { bend(-half) };
        worn.displacement[3] = wing - Vec3::x();
        let shown = worn.shown_fraction(&garment).expect("it remembers");
        assert!((shown - 0.5).abs() < 1e-12, "{shown}");
        assert_eq!(worn.hidden_warning(&garment), None);
    }
}
