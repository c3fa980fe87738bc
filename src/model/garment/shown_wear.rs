//! How much of its wear a worn garment shows: by how far its surface turned and moved.

use crate::error::{Message, Setting};
use crate::garment::{Garment, WornGarment};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::triangle;

/// Angle by which cloth must turn for an eye to see it from 1 m [rad], an assumption: 5 degrees, which change its brightness by some per cent.
const VISIBLE_TURN: f64 = 0.0873;
/// Share of the cloth that must turn so far, at least [-]: a crease of 1 m on a shirt.
const MIN_VISIBLE_FRACTION: f64 = 2e-3;
/// Share of the cloth that the percentiles leave out [-].
const LEFT_OUT: f64 = 0.05;

/// What a worn garment shows, on its own triangles.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
#[non_exhaustive]
pub struct ShownWear {
    /// Largest angle by which a triangle turned [rad].
    pub max_turn: f64,
    /// Angle by which 95 % of the area turned at most [rad].
    pub turn_95: f64,
    /// Largest displacement of a point \[m\].
    pub max_displacement: f64,
    /// Displacement of 95 % of the area at most \[m\].
    pub displacement_95: f64,
    /// Share of the area that turned by an angle that an eye sees [-].
    pub visible_fraction: f64,
}

impl ShownWear {
    /// Returns what `worn` shows on `garment`.
    pub fn of(worn: &WornGarment, garment: &Garment) -> Self {
        let after: Vec<Vec3> = garment.points.iter().zip(&worn.displacement).map(|(x, d)| x + d).collect();
        let (mut turns, mut moves) = (Vec::new(), Vec::new());
        for t in &garment.triangles {
            let [before, now] = [&garment.points, &after].map(|x| t.map(|p| x[p.at()]));
            let area = triangle::area(&before);
            if let (Some(from), Some(to)) = (triangle::normal(&before), triangle::normal(&now)) {
                turns.push((from.cross(&to).norm().atan2(from.dot(&to)), area));
            }
            let moved: Vec3 = t.iter().map(|p| worn.displacement[p.at()]).sum::<Vec3>() / 3.0;
            moves.push((moved.norm(), area));
        }
        let area: f64 = turns.iter().map(|(_, area)| area).sum();
        // An empty sum would be a negative zero.
        let visible =
            turns.iter().filter(|(turn, _)| *turn > VISIBLE_TURN).fold(0.0, |sum, (_, area)| sum + area);
        Self {
            max_turn: turns.iter().map(|(turn, _)| *turn).fold(0.0, f64::max),
            turn_95: upper_bound(turns),
            max_displacement: worn.displacement.iter().map(|d| d.norm()).fold(0.0, f64::max),
            displacement_95: upper_bound(moves),
            visible_fraction: if area > 0.0 { visible / area } else { 0.0 },
        }
    }

    /// Warning if hardly an eye sees it.
    pub fn faint_warning(&self) -> Option<Message> {
        if self.visible_fraction >= MIN_VISIBLE_FRACTION {
            return None;
        }
        let what = format!(
            "hardly an eye sees the wear: the cloth turns by up to {:.1} degrees, and {:.1} % of it by {:.0} or more; hold it longer, press it, \
             choose a fabric that creases more, or raise ",
            self.max_turn.to_degrees(),
            100.0 * self.visible_fraction,
            VISIBLE_TURN.to_degrees()
        );
        Some(Message::from(what) + Setting::Strength)
    }
}

/// The value below which all but 5 % of the area lies, of `values` with their areas.
fn upper_bound(mut values: Vec<(f64, f64)>) -> f64 {
    values.sort_by(|a, b| b.0.total_cmp(&a.0));
    let mut above = LEFT_OUT * values.iter().map(|(_, area)| area).sum::<f64>();
    let found = values.iter().find(|(_, area)| {
        above -= area;
        above < 0.0
    });
    found.map_or(0.0, |(value, _)| *value)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::garment::RestState;

    /// A strip of 100 squares of 10 mm, of which the last `lifted` rise by `slope`.
    fn shown(lifted: usize, slope: f64) -> ShownWear {
        let garment = Garment::sheet([1.0, 0.01], [100, 1]).expect("is a sheet");
        let start = 1.0 - 0.01 * lifted as f64;
        let low = garment.points.iter().map(|x| x.x).fold(f64::INFINITY, f64::min);
        let rise = |x: &Vec3| Vec3::y() * (slope * (x.x - low - start).max(0.0));
        let memory = RestState::flat(garment.topology.hinges.len(), garment.triangles.len());
        let worn = WornGarment { displacement: garment.points.iter().map(rise).collect(), memory };
        ShownWear::of(&worn, &garment)
    }

    #[test]
    fn turned_cloth_is_measured_by_its_area() {
        let half = shown(50, 0.2);
        assert!((half.max_turn - 0.2f64.atan()).abs() < 1e-9 && (half.turn_95 - half.max_turn).abs() < 1e-9);
        assert!((half.max_displacement - 0.1).abs() < 1e-9 && (half.visible_fraction - 0.5).abs() < 1e-9);
        assert!((0.085..0.095).contains(&half.displacement_95), "{half:?}");
        assert_eq!(half.faint_warning(), None);
        // A few squares are beyond the percentile, and a slope of 3 degrees is beyond the eye.
        assert_eq!(shown(3, 0.2).turn_95, 0.0);
        assert!(shown(50, 0.05).faint_warning().is_some());
    }
}
