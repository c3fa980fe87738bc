//! Vertex positions of a body (or a garment) given frame by frame: an OBJ sequence of a capture or another program.
//!
//! Between frames every vertex moves in a straight line. Knows no file; the reader checks the frames.

use crease_geometry::math::Vec3;

/// Vertex positions over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Sequence {
    /// Frames per second.
    pub rate: f64,
    /// Per frame: one position per vertex [m]; at least one frame, all of one length.
    pub frames: Vec<Vec<Vec3>>,
}

impl Sequence {
    /// Returns the time from the first frame to the last [s].
    pub fn length(&self) -> f64 {
        self.frames.len().saturating_sub(1) as f64 / self.rate
    }

    /// Returns the largest distance of the centroid of a frame from that of the first [m].
    pub fn travel(&self) -> f64 {
        let centroid = |frame: &Vec<Vec3>| frame.iter().sum::<Vec3>() / frame.len().max(1) as f64;
        let first = self.frames.first().map(centroid).unwrap_or_default();
        self.frames.iter().map(|frame| (centroid(frame) - first).norm()).fold(0.0, f64::max)
    }

    /// Returns the positions [m] at `t` [s] after the first frame, clamped to the sequence.
    pub fn positions(&self, t: f64) -> Vec<Vec3> {
        let last = self.frames.len().saturating_sub(1);
        let frame = (t * self.rate).clamp(0.0, last as f64);
        let from = (frame.floor() as usize).min(last);
        let fraction = frame - from as f64;
        let (Some(a), Some(b)) = (self.frames.get(from), self.frames.get((from + 1).min(last))) else {
            return Vec::new();
        };
        a.iter().zip(b).map(|(a, b)| a + (b - a) * fraction).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn positions_between_frames_lie_on_the_line() {
        let frames = [0.0, 1.0, 3.0].map(|x| vec![Vec3::new(x, 0.0, 0.0)]).to_vec();
        let sequence = Sequence { rate: 2.0, frames };
        assert_eq!(sequence.length(), 1.0);
        let at = |t| sequence.positions(t)[0].x;
        assert_eq!(sequence.travel(), 3.0);
        assert_eq!([at(-1.0), at(0.25), at(0.75), at(1.0), at(9.0)], [0.0, 0.5, 2.0, 3.0, 3.0]);
    }
}
