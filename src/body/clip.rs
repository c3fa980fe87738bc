//! Animation clips: what a node does over time, by the three interpolations of glTF (specification, appendix C).
//!
//! ```text
//! STEP         v(t) = v_k                                    for t_k <= t < t_k+1
//! LINEAR       v(t) = (1 - u) v_k + u v_k+1,                 rotations by slerp, the short way
//! CUBICSPLINE  v(t) = (2u³ - 3u² + 1) v_k + h (u³ - 2u² + u) b_k + (3u² - 2u³) v_k+1 + h (u³ - u²) a_k+1
//!              h = t_k+1 - t_k, u = (t - t_k) / h; a, b: tangents before and after a key; rotations normalised
//! ```
//!
//! Before the first key and after the last the value stays. Knows no file and no mesh.

use crate::body::skeleton::{NodeTransform, Pose, turn_towards};
use crate::math::Vec3;
use nalgebra::{Quaternion, UnitQuaternion};

/// What of a node a channel moves.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Target {
    /// Its translation [file units].
    Translation,
    /// Its rotation: x, y, z, w.
    Rotation,
    /// Its scale.
    Scale,
    /// Weights of the morph targets of its mesh.
    Weights,
}

impl Target {
    /// Numbers of one value; as many as there are morph targets for weights.
    pub fn width(self) -> Option<usize> {
        match self {
            Self::Translation | Self::Scale => Some(3),
            Self::Rotation => Some(4),
            Self::Weights => None,
        }
    }
}

/// How values between keys are found.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// The last key's.
    Step,
    /// In a straight line, or along the great circle.
    Linear,
    /// By a cubic with given tangents.
    CubicSpline,
}

/// One thing that moves.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// The node.
    pub node: usize,
    /// What of it.
    pub target: Target,
    /// How it goes between the keys.
    pub interpolation: Interpolation,
    /// Increasing [s].
    pub times: Vec<f64>,
    /// Key after key, `width` numbers each; for cubic splines tangent before, value, tangent after.
    pub values: Vec<f64>,
    /// Numbers of one value.
    pub width: usize,
}

/// An animation.
#[derive(Debug, Clone, PartialEq)]
pub struct Clip {
    /// Its name; empty when it has none.
    pub name: String,
    /// What moves.
    pub channels: Vec<Channel>,
}

impl Channel {
    /// Value at `t` [s].
    fn at(&self, t: f64) -> Vec<f64> {
        let last = self.times.len().saturating_sub(1);
        let after = self.times.partition_point(|key| *key <= t);
        if after == 0 || after > last || self.interpolation == Interpolation::Step {
            return self.key(after.saturating_sub(1).min(last)).to_vec();
        }
        let k = after - 1;
        let span = self.times[after] - self.times[k];
        let u = (t - self.times[k]) / span;
        let (from, to) = (self.key(k), self.key(after));
        if self.interpolation == Interpolation::Linear {
            if let (Target::Rotation, Some(a), Some(b)) = (self.target, quaternion(from), quaternion(to)) {
                return turn_towards(&a, &b, u).coords.as_slice().to_vec();
            }
            return from.iter().zip(to).map(|(a, b)| a + u * (b - a)).collect();
        }
        let (u2, u3) = (u * u, u * u * u);
        let (out, into) = (self.part(k, 2), self.part(after, 0));
        (0..self.width)
            .map(|i| {
                (2.0 * u3 - 3.0 * u2 + 1.0) * from[i]
                    + span * (u3 - 2.0 * u2 + u) * out[i]
                    + (3.0 * u2 - 2.0 * u3) * to[i]
                    + span * (u3 - u2) * into[i]
            })
            .collect()
    }

    /// Value of key `k`.
    fn key(&self, k: usize) -> &[f64] {
        self.part(k, 1)
    }

    /// Tangent before (0), value (1) or tangent after (2) of key `k`.
    fn part(&self, k: usize, part: usize) -> &[f64] {
        let row = if self.interpolation == Interpolation::CubicSpline { 3 * k + part } else { k };
        self.values.get(row * self.width..(row + 1) * self.width).unwrap_or(&[])
    }

    /// Whether keys and values fit each other, so that any time has a value.
    pub fn is_whole(&self) -> bool {
        let rows = if self.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let counted = !self.times.is_empty()
            && self.width > 0
            && self.target.width().is_none_or(|width| width == self.width)
            && self.values.len() == rows * self.times.len() * self.width;
        let rising = self.times.windows(2).all(|pair| pair[0] < pair[1]);
        counted && rising && self.times.iter().chain(&self.values).all(|x| x.is_finite())
    }
}

impl Clip {
    /// First and last key [s]. Players start a clip at 0 whatever its first key; so does [`Clip::length`].
    pub fn length(&self) -> f64 {
        self.channels.iter().filter_map(|c| c.times.last()).copied().fold(0.0, f64::max)
    }

    /// Shortest time between two keys of a moving channel [s]; `None` if nothing moves.
    pub fn shortest_key(&self) -> Option<f64> {
        let gaps = self.channels.iter().flat_map(|c| c.times.windows(2).map(|pair| pair[1] - pair[0]));
        gaps.min_by(f64::total_cmp)
    }

    /// `pose` with what this clip moves at its place at `t` [s].
    pub fn pose(&self, rest: &[NodeTransform], t: f64) -> Pose {
        let mut pose = rest.to_vec();
        for channel in self.channels.iter().filter(|c| c.target != Target::Weights) {
            let Some(NodeTransform::Parts { translation, rotation, scale }) = pose.get_mut(channel.node)
            else {
                continue;
            };
            let value = channel.at(t);
            match channel.target {
                Target::Translation => *translation = Vec3::from_column_slice(&value),
                Target::Scale => *scale = Vec3::from_column_slice(&value),
                Target::Rotation => *rotation = quaternion(&value).unwrap_or(*rotation),
                Target::Weights => {}
            }
        }
        pose
    }

    /// Weights of the morph targets of the mesh at `node` at `t` [s], if the clip moves them.
    pub fn weights(&self, node: usize, t: f64) -> Option<Vec<f64>> {
        let channel = self.channels.iter().find(|c| c.node == node && c.target == Target::Weights)?;
        Some(channel.at(t))
    }
}

fn quaternion(xyzw: &[f64]) -> Option<UnitQuaternion<f64>> {
    match *xyzw {
        [x, y, z, w] => UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-9),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::FRAC_PI_2;

    fn channel(interpolation: Interpolation, values: &[f64]) -> Channel {
        let c = Channel {
            node: 0,
            target: Target::Translation,
            interpolation,
            times: vec![1.0, 3.0],
            values: values.to_vec(),
            width: 3,
        };
        assert!(c.is_whole());
        c
    }

    #[test]
    fn steps_and_lines() {
        let values = [0.0, 0.0, 0.0, 4.0, 2.0, 0.0];
        let step = channel(Interpolation::Step, &values);
        assert_eq!((step.at(2.9)[0], step.at(3.0)[0], step.at(-1.0)[0]), (0.0, 4.0, 0.0));
        let line = channel(Interpolation::Linear, &values);
        assert_eq!((line.at(1.5), line.at(9.0)), (vec![1.0, 0.5, 0.0], vec![4.0, 2.0, 0.0]));
    }

    /// t² between 1 and 3: value and tangents (2t) at the keys give the parabola back, tangents being per second.
    #[test]
    fn a_spline_with_the_tangents_of_a_parabola_is_that_parabola() {
        let zero = [0.0; 3];
        let rows: [[f64; 3]; 6] = [zero, [1.0; 3], [2.0; 3], [6.0; 3], [9.0; 3], zero];
        let spline = channel(Interpolation::CubicSpline, rows.as_flattened());
        for t in [1.0, 1.3, 2.0, 2.7] {
            assert!((spline.at(t)[1] - t * t).abs() < 1e-14, "{t}");
        }
    }

    #[test]
    fn rotations_go_along_the_great_circle() {
        let at = |angle: f64| UnitQuaternion::from_axis_angle(&Vec3::z_axis(), angle);
        let values: Vec<f64> =
            [0.0, FRAC_PI_2].iter().flat_map(|a| at(*a).coords.as_slice().to_vec()).collect();
        let turn = Channel {
            node: 0,
            target: Target::Rotation,
            interpolation: Interpolation::Linear,
            times: vec![0.0, 1.0],
            values,
            width: 4,
        };
        let clip = Clip { name: "turn".into(), channels: vec![turn] };
        let rest = [NodeTransform::Parts {
            translation: Vec3::x(),
            rotation: UnitQuaternion::identity(),
            scale: Vec3::repeat(1.0),
        }];
        let NodeTransform::Parts { rotation, translation, .. } = clip.pose(&rest, 0.25)[0] else {
            panic!("parts")
        };
        assert!(rotation.angle_to(&at(0.25 * FRAC_PI_2)) < 1e-12);
        assert_eq!((translation, clip.length()), (Vec3::x(), 1.0));
    }

    #[test]
    fn broken_channels_are_told() {
        let mut c = channel(Interpolation::Linear, &[0.0; 6]);
        c.times = vec![1.0, 1.0];
        assert!(!c.is_whole(), "times must rise");
        c.times = vec![1.0, 2.0, 3.0];
        assert!(!c.is_whole(), "a value is missing");
    }
}
