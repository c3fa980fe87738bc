//! The outline of a panel: a closed chain of lines and arcs, each either sewn to the other panel or open.
//!
//! Coordinates are those of the flat panel [m]: x to the right, y along the garment's length towards its upper end.
//! Only the right half is given; the left is its mirror image. Every run is divided into equal pieces by itself, so
//! that two panels with a common run have exactly the same points along it, as sewing requires.

use crease_geometry::math::Vec2;

/// Kind of a run of the outline.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Border {
    /// A seam to the other panel.
    Sewn,
    /// An open edge: hem, neck, end of a sleeve or leg.
    Open,
}

/// One run of the outline, from the end of the previous one.
#[derive(Debug, Clone, Copy)]
pub struct Run {
    /// Control point of a quadratic Bézier arc [m]; `None` for a straight run.
    pub control: Option<[f64; 2]>,
    /// End of the run [m].
    pub to: [f64; 2],
    /// Kind of the run.
    pub border: Border,
}

/// A straight run to `to`.
pub const fn line(to: [f64; 2], border: Border) -> Run {
    Run { control: None, to, border }
}

/// An arc to `to` with the control point `control`.
pub const fn arc(control: [f64; 2], to: [f64; 2], border: Border) -> Run {
    Run { control: Some(control), to, border }
}

/// An outline divided into edges of about equal length.
#[derive(Debug, Clone)]
pub struct Boundary {
    /// Points, counter-clockwise [m].
    pub points: Vec<Vec2>,
    /// Kind of the edge that starts at each point.
    pub borders: Vec<Border>,
}

impl Boundary {
    /// Edge `i`, from its point to the next.
    pub fn edge(&self, i: usize) -> (Vec2, Vec2) {
        (self.points[i], self.points[(i + 1) % self.points.len()])
    }

    /// Distance [m] of `p` from the edges of `kind`, or from all edges; infinite when there are none.
    pub fn distance(&self, p: Vec2, kind: Option<Border>) -> f64 {
        (0..self.points.len())
            .filter(|&i| kind.is_none_or(|k| self.borders[i] == k))
            .map(|i| {
                let (a, b) = self.edge(i);
                let d = b - a;
                let t = ((p - a).dot(&d) / d.norm_squared()).clamp(0.0, 1.0);
                (p - a - t * d).norm()
            })
            .fold(f64::INFINITY, f64::min)
    }

    /// Whether `p` is inside (even-odd rule).
    pub fn contains(&self, p: Vec2) -> bool {
        let mut inside = false;
        for i in 0..self.points.len() {
            let (a, b) = self.edge(i);
            if (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y) {
                inside = !inside;
            }
        }
        inside
    }
}

/// Point of a run at the parameter `t`.
fn at(from: Vec2, run: &Run, t: f64) -> Vec2 {
    let to = Vec2::from(run.to);
    match run.control {
        None => from.lerp(&to, t),
        Some(control) => {
            let control = Vec2::from(control);
            from.lerp(&control, t).lerp(&control.lerp(&to, t), t)
        }
    }
}

/// `count` + 1 points along a run, evenly spaced by length, both ends included.
fn divide(from: Vec2, run: &Run, edge_m: f64) -> Vec<Vec2> {
    const CHORDS: usize = 400; // the length of an arc is then accurate to 1e-5
    let fine: Vec<Vec2> = (0..=CHORDS).map(|i| at(from, run, i as f64 / CHORDS as f64)).collect();
    let mut lengths = vec![0.0];
    for pair in fine.windows(2) {
        lengths.push(lengths[lengths.len() - 1] + (pair[1] - pair[0]).norm());
    }
    let total = lengths[CHORDS];
    let count = (total / edge_m).round().max(1.0) as usize;
    let mut points = vec![from];
    let mut k = 0;
    for i in 1..count {
        let wanted = total * i as f64 / count as f64;
        while lengths[k + 1] < wanted {
            k += 1;
        }
        points.push(fine[k].lerp(&fine[k + 1], (wanted - lengths[k]) / (lengths[k + 1] - lengths[k])));
    }
    points.push(Vec2::from(run.to));
    points
}

/// Closed outline of a right half that starts and ends on the centre line x = 0, divided into edges of about
/// `edge_m` [m].
pub fn boundary(start: [f64; 2], right_half: &[Run], edge_m: f64) -> Boundary {
    let mut points: Vec<Vec2> = Vec::new();
    let mut borders = Vec::new();
    let mut from = Vec2::from(start);
    for run in right_half {
        let mut pieces = divide(from, run, edge_m);
        from = pieces.pop().unwrap_or(from);
        borders.extend(pieces.iter().map(|_| run.border));
        points.append(&mut pieces);
    }
    // Edge i of the right half starts at point i; its mirror image ends there.
    let right_count = points.len();
    points.push(from);
    for i in (1..right_count).rev() {
        borders.push(borders[i]);
        points.push(Vec2::new(-points[i].x, points[i].y));
    }
    borders.push(borders[0]);
    Boundary { points, borders }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_square_is_divided_evenly_and_mirrored() {
        let half =
            [line([1.0, 0.0], Border::Open), line([1.0, 2.0], Border::Sewn), line([0.0, 2.0], Border::Open)];
        let b = boundary([0.0, 0.0], &half, 0.5);
        assert_eq!(b.points.len(), 16);
        assert_eq!(b.borders.iter().filter(|&&k| k == Border::Sewn).count(), 8);
        for i in 0..16 {
            let (p, q) = b.edge(i);
            assert!(((q - p).norm() - 0.5).abs() < 1e-12);
            let upright = (p.x - q.x).abs() < 1e-12;
            assert_eq!(b.borders[i] == Border::Sewn, upright, "edge {i}");
        }
        assert!(b.contains(Vec2::new(-0.9, 1.9)) && !b.contains(Vec2::new(-1.1, 1.0)));
        assert!((b.distance(Vec2::new(0.5, 0.25), Some(Border::Sewn)) - 0.5).abs() < 1e-12);
    }
}
