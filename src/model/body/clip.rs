//! Animation clips: properties of nodes over time, with the three interpolations of glTF (specification, appendix C).
//!
//! ```text
//! STEP         v(t) = v_k                                    for t_k <= t < t_k+1
//! LINEAR       v(t) = (1 - u) v_k + u v_k+1,                 rotations by slerp along the shorter arc
//! CUBICSPLINE  v(t) = (2u³ - 3u² + 1) v_k + h (u³ - 2u² + u) b_k + (3u² - 2u³) v_k+1 + h (u³ - u²) a_k+1
//!              h = t_k+1 - t_k, u = (t - t_k) / h; a, b: tangents before and after a key; rotations normalised
//! ```
//!
//! Before the first key and after the last the value is constant. Knows no file and no mesh.

use crate::body::skeleton::{NodeTransform, Pose, slerp};
use crease_geometry::math::Vec3;
use nalgebra::{Quaternion, UnitQuaternion};

/// Property of a node that a channel animates.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum AnimatedProperty {
    /// Translation [file units].
    Translation,
    /// Rotation: quaternion x, y, z, w.
    Rotation,
    /// Scale [-].
    Scale,
    /// Weights of the morph targets of its mesh [-].
    Weights,
}

impl AnimatedProperty {
    /// Returns the number of components of one value; `None` for weights, which have one per morph target.
    pub fn width(self) -> Option<usize> {
        match self {
            Self::Translation | Self::Scale => Some(3),
            Self::Rotation => Some(4),
            Self::Weights => None,
        }
    }
}

/// Interpolation between keys.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Interpolation {
    /// Value of the last key.
    Step,
    /// Linear, for rotations along the great circle.
    Linear,
    /// Cubic with given tangents.
    CubicSpline,
}

/// Animation of one property of one node.
#[derive(Debug, Clone, PartialEq)]
pub struct Channel {
    /// Node.
    pub node: usize,
    /// Animated property.
    pub target: AnimatedProperty,
    /// Interpolation between the keys.
    pub interpolation: Interpolation,
    /// Times of the keys, not decreasing; of several keys at one time the last counts from that time on [s].
    pub times: Vec<f64>,
    /// Values, key after key, `width` numbers each; for cubic splines in-tangent, value, out-tangent.
    pub values: Vec<f64>,
    /// Number of components of one value.
    pub width: usize,
}

/// Animation clip.
#[derive(Debug, Clone, PartialEq)]
pub struct Clip {
    /// Name; empty when it has none.
    pub name: String,
    /// Channels.
    pub channels: Vec<Channel>,
    /// Reason why the clip cannot be played, if its data are damaged.
    pub damage: Option<String>,
}

impl Channel {
    /// Returns the value at `t` [s].
    fn value(&self, t: f64) -> Vec<f64> {
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
            if let (AnimatedProperty::Rotation, Some(a), Some(b)) =
                (self.target, quaternion(from), quaternion(to))
            {
                return slerp(&a, &b, u).coords.as_slice().to_vec();
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

    /// Returns the value of key `k`.
    fn key(&self, k: usize) -> &[f64] {
        self.part(k, 1)
    }

    /// Returns the in-tangent (0), value (1) or out-tangent (2) of key `k`.
    fn part(&self, k: usize, part: usize) -> &[f64] {
        let row = if self.interpolation == Interpolation::CubicSpline { 3 * k + part } else { k };
        self.values.get(row * self.width..(row + 1) * self.width).unwrap_or(&[])
    }

    /// Returns the largest difference between two values of one component.
    pub fn range(&self) -> f64 {
        let keys = || (0..self.times.len()).map(|k| self.key(k));
        let at = |key: &[f64], i: usize| key.get(i).copied().unwrap_or_default();
        let range = |i: usize| {
            let (low, high) = keys().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), key| {
                (low.min(at(key, i)), high.max(at(key, i)))
            });
            high - low
        };
        (0..self.width).map(range).fold(0.0, f64::max)
    }

    /// Returns whether keys and values fit each other, so that any time has a value.
    pub fn is_valid(&self) -> bool {
        let rows = if self.interpolation == Interpolation::CubicSpline { 3 } else { 1 };
        let counted = !self.times.is_empty()
            && self.width > 0
            && self.target.width().is_none_or(|width| width == self.width)
            && self.values.len() == rows * self.times.len() * self.width;
        let rising = self.times.windows(2).all(|pair| pair[0] <= pair[1]);
        counted && rising && self.times.iter().chain(&self.values).all(|x| x.is_finite())
    }
}

impl Clip {
    /// Returns the time of the last key [s]; a clip starts at 0 whatever its first key, as in players.
    pub fn length(&self) -> f64 {
        self.channels.iter().filter_map(|c| c.times.last()).copied().fold(0.0, f64::max)
    }

    /// Returns the pose `rest` with the animated properties at time `t` [s].
    pub fn pose(&self, rest: &[NodeTransform], t: f64) -> Pose {
        let mut pose = rest.to_vec();
        for channel in self.channels.iter().filter(|c| c.target != AnimatedProperty::Weights) {
            let Some(NodeTransform::Trs { translation, rotation, scale }) = pose.get_mut(channel.node) else {
                continue;
            };
            let value = channel.value(t);
            match channel.target {
                AnimatedProperty::Translation => *translation = Vec3::from_column_slice(&value),
                AnimatedProperty::Scale => *scale = Vec3::from_column_slice(&value),
                AnimatedProperty::Rotation => *rotation = quaternion(&value).unwrap_or(*rotation),
                AnimatedProperty::Weights => {}
            }
        }
        pose
    }

    /// Returns the weights of the morph targets of the mesh at `node` at `t` [s], if the clip animates them.
    pub fn weights(&self, node: usize, t: f64) -> Option<Vec<f64>> {
        let channel =
            self.channels.iter().find(|c| c.node == node && c.target == AnimatedProperty::Weights)?;
        Some(channel.value(t))
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
            target: AnimatedProperty::Translation,
            interpolation,
            times: vec![1.0, 3.0],
            values: values.to_vec(),
            width: 3,
        };
        assert!(c.is_valid());
        c
    }

    #[test]
    fn steps_and_lines() {
        let values = [0.0, 0.0, 0.0, 4.0, 2.0, 0.0];
        let step = channel(Interpolation::Step, &values);
        assert_eq!((step.value(2.9)[0], step.value(3.0)[0], step.value(-1.0)[0]), (0.0, 4.0, 0.0));
        let line = channel(Interpolation::Linear, &values);
        assert_eq!((line.value(1.5), line.value(9.0)), (vec![1.0, 0.5, 0.0], vec![4.0, 2.0, 0.0]));
    }

    /// t² between 1 and 3: value and tangents (2t) at the keys give the parabola back, tangents being per second.
    #[test]
    fn a_spline_with_the_tangents_of_a_parabola_is_that_parabola() {
        let zero = [0.0; 3];
        let rows: [[f64; 3]; 6] = [zero, [1.0; 3], [2.0; 3], [6.0; 3], [9.0; 3], zero];
        let spline = channel(Interpolation::CubicSpline, rows.as_flattened());
        for t in [1.0, 1.3, 2.0, 2.7] {
            assert!((spline.value(t)[1] - t * t).abs() < 1e-14, "{t}");
        }
    }

    #[test]
    fn rotations_go_along_the_great_circle() {
        let at = |angle: f64| UnitQuaternion::from_axis_angle(&Vec3::z_axis(), angle);
        let values: Vec<f64> =
            [0.0, FRAC_PI_2].iter().flat_map(|a| at(*a).coords.as_slice().to_vec()).collect();
        let turn = Channel {
            node: 0,
            target: AnimatedProperty::Rotation,
            interpolation: Interpolation::Linear,
            times: vec![0.0, 1.0],
            values,
            width: 4,
        };
        let clip = Clip { name: "turn".into(), channels: vec![turn], damage: None };
        let rest = [NodeTransform::Trs {
            translation: Vec3::x(),
            rotation: UnitQuaternion::identity(),
            scale: Vec3::repeat(1.0),
        }];
        let NodeTransform::Trs { rotation, translation, .. } = clip.pose(&rest, 0.25)[0] else {
            panic!("parts")
        };
        assert!(rotation.angle_to(&at(0.25 * FRAC_PI_2)) < 1e-12);
        assert_eq!((translation, clip.length()), (Vec3::x(), 1.0));
    }

    #[test]
    fn two_keys_at_one_time_are_a_jump() {
        let mut c = channel(Interpolation::Linear, &[0.0; 6]);
        c.times = vec![0.0, 1.0, 1.0, 2.0];
        c.values = [0.0, 1.0, 5.0, 6.0].iter().flat_map(|x| [*x, 0.0, 0.0]).collect();
        assert!(c.is_valid());
        let at = |t: f64| c.value(t)[0];
        assert_eq!([at(0.5), at(1.0), at(1.5), at(3.0)], [0.5, 5.0, 5.5, 6.0]);
        assert_eq!(c.range(), 6.0);
    }

    #[test]
    fn broken_channels_are_detected() {
        let mut c = channel(Interpolation::Linear, &[0.0; 6]);
        c.times = vec![2.0, 1.0];
        assert!(!c.is_valid(), "times must not fall");
        c.times = vec![1.0, 2.0, 3.0];
        assert!(!c.is_valid(), "a value is missing");
    }
}
