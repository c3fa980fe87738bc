//! Net angles across fold lines of a lying garment: what is left of a fold, wherever within 25 mm its hinges are.

use crease_geometry::math::{Vec3, bounds};
use crease_model::garment::{Garment, RestState};

/// Distance from a line within which hinges belong to it [m].
const REACH: f64 = 0.025;
/// Distance from lines across, where two folds meet, within which hinges are left out [m].
const MEETING: f64 = 0.04;

/// A line across a garment that lies in the plane of x and z.
#[derive(Debug, Clone, Copy)]
pub(super) struct Line {
    /// Coordinate that is the same all along the line: 0 for x, 2 for z.
    pub axis: usize,
    /// Its value as a fraction of the extent of the garment.
    pub at: f64,
}

/// The lines of `fold-thrice`.
pub(super) const FOLD_THRICE_LINES: [Line; 3] =
    [Line { axis: 0, at: 0.3 }, Line { axis: 0, at: 0.7 }, Line { axis: 2, at: 0.5 }];

/// Returns the net changes of angle by the memory `rest` of `garment` across `lines`, each times the length it is summed over \[rad m\]:
/// for every line, side of the cloth and stretch between lines across.
pub(super) fn net_angles(garment: &Garment, rest: &RestState, lines: &[Line]) -> Vec<f64> {
    let (low, high) = bounds(&garment.points);
    let position = |line: &Line| low[line.axis] + line.at * (high[line.axis] - low[line.axis]);
    let stretches = lines.len() + 1;
    let mut sums = vec![0.0; lines.len() * 2 * stretches];
    let changes = garment.topology.hinges.iter().zip(rest.angle_changes());
    for (hinge, change) in changes.filter(|(_, change)| *change != 0.0) {
        let [a, b, c, _] = hinge.points.map(|p| garment.points[p.at()]);
        let (middle, along) = ((a + b) / 2.0, b - a);
        let is_up = along.cross(&(c - a)).y > 0.0;
        for (k, line) in lines.iter().enumerate() {
            let other = 2 - line.axis;
            let across: Vec<f64> = lines.iter().filter(|line| line.axis == other).map(position).collect();
            let meets = across.iter().any(|at| (middle[other] - at).abs() < MEETING);
            if (middle[line.axis] - position(line)).abs() > REACH || meets {
                continue;
            }
            let mut direction = Vec3::zeros();
            direction[other] = 1.0;
            let stretch = across.iter().filter(|at| **at < middle[other]).count();
            let along_line = along.dot(&direction).powi(2) / along.norm().max(f64::MIN_POSITIVE);
            sums[(2 * k + usize::from(is_up)) * stretches + stretch] += change * along_line;
        }
    }
    sums
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::test_sheet::TestSheet;

    #[test]
    fn a_crease_counts_by_its_angle_and_length_however_many_lines_share_it() {
        let lines: Vec<f64> = (0..=60).map(|k| 0.005 * f64::from(k)).collect();
        let garment = TestSheet::strip(&lines, 0.1, 20).flat_garment();
        let (low, high) = bounds(&garment.points);
        assert!((high.x - low.x - 0.3).abs() < 1e-9);
        let of = |creases: &[(f64, f64)]| {
            let mut rest = RestState::flat(garment.topology.hinges.len(), garment.triangles.len());
            for (h, hinge) in garment.topology.hinges.iter().enumerate() {
                let [a, b] = [hinge.points[0], hinge.points[1]].map(|p| garment.points[p.at()].x);
                let hit = creases.iter().find(|(at, _)| (a - at).abs() < 1e-9 && (b - at).abs() < 1e-9);
                rest.rest_angle[h] = hit.map_or(0.0, |(_, angle)| *angle);
            }
            let sums = net_angles(&garment, &rest, &[Line { axis: 0, at: 0.5 }]);
            sums.iter().map(|sum| sum.abs()).sum::<f64>()
        };
        let [one, shared, away] = [&[(0.15, 0.5)][..], &[(0.145, 0.25), (0.15, 0.25)], &[(0.2, 0.5)]].map(of);
        assert!((one - 0.05).abs() < 1e-9 && (shared - 0.05).abs() < 1e-9 && away == 0.0, "{one} {shared}");
    }
}
