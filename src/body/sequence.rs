//! A body (or a garment) whose places are given frame by frame: an OBJ sequence of a capture or another program.
//!
//! Between frames every vertex goes in a straight line. Knows no file: who reads the frames checks them.

use crate::math::Vec3;

/// Places over time.
#[derive(Debug, Clone, PartialEq)]
pub struct Sequence {
    /// Frames per second.
    pub rate: f64,
    /// Per frame: one place per vertex [m]; at least one frame, all of one length.
    pub frames: Vec<Vec<Vec3>>,
}

impl Sequence {
    /// Time from the first frame to the last [s].
    pub fn length(&self) -> f64 {
        self.frames.len().saturating_sub(1) as f64 / self.rate
    }

    /// Places at `t` [s] after the first frame.
    pub fn at(&self, t: f64) -> Vec<Vec3> {
        let last = self.frames.len().saturating_sub(1);
        let place = (t * self.rate).clamp(0.0, last as f64);
        let from = (place.floor() as usize).min(last);
        let share = place - from as f64;
        let (Some(a), Some(b)) = (self.frames.get(from), self.frames.get((from + 1).min(last))) else {
            return Vec::new();
        };
        a.iter().zip(b).map(|(a, b)| a + (b - a) * share).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_between_frames_lie_on_the_line() {
        let frames = [0.0, 1.0, 3.0].map(|x| vec![Vec3::new(x, 0.0, 0.0)]).to_vec();
        let sequence = Sequence { rate: 2.0, frames };
        assert_eq!(sequence.length(), 1.0);
        let at = |t| sequence.at(t)[0].x;
        assert_eq!([at(-1.0), at(0.25), at(0.75), at(1.0), at(9.0)], [0.0, 0.5, 2.0, 3.0, 3.0]);
    }
}
