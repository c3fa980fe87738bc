//! The sleeve on an arm: a tube of cloth around a closed, skinned body with shoulder, elbow and wrist.
//!
//! The arm points along +x at `HEIGHT`, its elbow bends upwards about +z. Skin weights blend over `BLEND` around the
//! elbow: with linear blend skinning the inner side of a bent arm folds into itself unless
//! `BLEND > 3 radius tan(angle / 2)`, which at 120 degrees and 46 mm means 0.24 m.

use crate::glb::{Clip, Joint, JointRotations};
use crate::{Mesh, smoothstep};
use crease_geometry::math::{Vec2, Vec3};
use std::f64::consts::TAU;

/// Height of the arm's axis above the ground [m].
pub const HEIGHT: f64 = 1.2;
/// Positions of shoulder, elbow and wrist on the axis [m].
pub const JOINTS: [f64; 3] = [0.0, 0.30, 0.56];
/// Radius of the arm [m].
const ARM_RADIUS: f64 = 0.046;
/// Positions on the axis where the round ends of the arm begin [m].
const ARM_ENDS: [f64; 2] = [0.0, 0.60];
/// Circumference of the sleeve, 8 mm outside the arm [m].
const SLEEVE_CIRCUMFERENCE: f64 = 0.34;
/// Ends of the sleeve on the axis [m].
const SLEEVE_ENDS: [f64; 2] = [0.02, 0.57];
/// Points around the sleeve; rows are spaced by the height of an equilateral triangle.
const SLEEVE_COLUMNS: usize = 40;
/// Points around the arm; its facets are 0.2 mm inside the cylinder.
const ARM_COLUMNS: usize = 32;
/// Length over which the elbow's weights blend [m].
const BLEND: f64 = 0.32;
/// Length over which the wrist's weights blend [m].
const WRIST_BLEND: f64 = 0.06;

/// Skin weights of shoulder, elbow and wrist at `x` along the arm [m]; they sum to one.
pub fn weights(x: f64) -> [f64; 3] {
    let step = |middle: f64, width: f64| smoothstep((x - middle) / width + 0.5);
    let (elbow, wrist) = (step(JOINTS[1], BLEND), step(JOINTS[2], WRIST_BLEND));
    [1.0 - elbow, elbow * (1.0 - wrist), elbow * wrist]
}

/// Joints: shoulder, elbow and wrist.
pub fn joints() -> Vec<Joint> {
    let joint = |k: usize, name| Joint {
        name,
        position: Vec3::new(JOINTS[k], HEIGHT, 0.0),
        parent: k.checked_sub(1),
    };
    vec![joint(0, "shoulder"), joint(1, "elbow"), joint(2, "wrist")]
}

/// The clip "elbow": 0 to 120 degrees and back within 2 s, with zero velocity at both ends.
pub fn elbow() -> Clip {
    const KEYS: usize = 32;
    let (times, rotations) = (0..=KEYS)
        .map(|k| {
            let phase = k as f64 / KEYS as f64;
            let angle = 120f64.to_radians() * 0.5 * (1.0 - (TAU * phase).cos());
            let (sin, cos) = (angle / 2.0).sin_cos();
            ([(2.0 * phase) as f32], [0.0, 0.0, sin as f32, cos as f32])
        })
        .unzip();
    Clip { name: "elbow", times, rotations: vec![JointRotations { joint: 1, rotations }] }
}

/// Unit normal of the axis at the angle `turn` [turns].
fn around(turn: f64) -> Vec3 {
    let (sin, cos) = (TAU * turn).sin_cos();
    Vec3::new(0.0, cos, sin)
}

/// The sleeve: staggered rings, cut along its top in the texture, with open ends.
pub fn sleeve() -> Mesh {
    let radius = SLEEVE_CIRCUMFERENCE / TAU;
    let length = SLEEVE_ENDS[1] - SLEEVE_ENDS[0];
    let edge = SLEEVE_CIRCUMFERENCE / SLEEVE_COLUMNS as f64;
    let rows = (length / (edge * 3f64.sqrt() / 2.0)).round() as usize;
    let mut mesh = Mesh::default();
    for i in 0..=rows {
        let along = i as f64 / rows as f64;
        let x = SLEEVE_ENDS[0] + along * length;
        for j in 0..=SLEEVE_COLUMNS {
            let column = j as f64 + if i % 2 == 1 { 0.5 } else { 0.0 };
            // The last column coincides exactly with the first.
            let turn = (j % SLEEVE_COLUMNS) as f64 + (column - j as f64);
            let normal = around(turn / SLEEVE_COLUMNS as f64);
            mesh.positions.push(Vec3::new(x, HEIGHT, 0.0) + radius * normal);
            mesh.normals.push(normal);
            mesh.uvs.push(Vec2::new(along * length, column * edge) / length);
        }
    }
    let at = |i: usize, j: usize| (i * (SLEEVE_COLUMNS + 1) + j) as u32;
    for i in 0..rows {
        for j in 0..SLEEVE_COLUMNS {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)];
            mesh.triangles.extend(if i % 2 == 0 { [[a, b, c], [b, d, c]] } else { [[a, d, c], [a, b, d]] });
        }
    }
    mesh
}

/// The arm: a closed cylinder with round ends.
pub fn arm() -> Mesh {
    let mut mesh = Mesh::default();
    let rings = arm_rings();
    for (i, &ArmRing { x, radius, normal_x }) in rings.iter().enumerate() {
        let pole = i == 0 || i + 1 == rings.len();
        for j in 0..if pole { 1 } else { ARM_COLUMNS } {
            let out = around((j as f64 + 0.5 * (i % 2) as f64) / ARM_COLUMNS as f64);
            mesh.positions.push(Vec3::new(x, HEIGHT, 0.0) + radius * out);
            mesh.normals
                .push((out * (1.0 - normal_x * normal_x).max(0.0).sqrt() + Vec3::x() * normal_x).normalize());
        }
    }
    // A pole is one vertex; ring i follows the first pole and i - 1 full rings.
    let last = rings.len() - 1;
    let at = |i: usize, j: usize| match i {
        0 => 0,
        i if i == last => (1 + (last - 1) * ARM_COLUMNS) as u32,
        i => (1 + (i - 1) * ARM_COLUMNS + j % ARM_COLUMNS) as u32,
    };
    for i in 0..last {
        for j in 0..ARM_COLUMNS {
            let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)];
            let pair = if i % 2 == 0 { [[a, b, c], [b, d, c]] } else { [[a, d, c], [a, b, d]] };
            mesh.triangles.extend(pair.into_iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[2] != t[0]));
        }
    }
    mesh
}

/// A ring of the arm.
struct ArmRing {
    /// Position on the axis [m].
    x: f64,
    /// Radius [m].
    radius: f64,
    /// Component of the unit normal along +x.
    normal_x: f64,
}

/// Rings of the arm from pole to pole.
fn arm_rings() -> Vec<ArmRing> {
    const CAP_ROWS: usize = 8;
    const TUBE_ROWS: usize = 60;
    let cap = |k: usize| (TAU / 4.0 * k as f64 / CAP_ROWS as f64).sin_cos();
    let mut rings = Vec::new();
    for k in 0..CAP_ROWS {
        let (sin, cos) = cap(k);
        rings.push(ArmRing { x: ARM_ENDS[0] - ARM_RADIUS * cos, radius: ARM_RADIUS * sin, normal_x: -cos });
    }
    for k in 0..=TUBE_ROWS {
        let x = ARM_ENDS[0] + (ARM_ENDS[1] - ARM_ENDS[0]) * k as f64 / TUBE_ROWS as f64;
        rings.push(ArmRing { x, radius: ARM_RADIUS, normal_x: 0.0 });
    }
    for k in (0..CAP_ROWS).rev() {
        let (sin, cos) = cap(k);
        rings.push(ArmRing { x: ARM_ENDS[1] + ARM_RADIUS * cos, radius: ARM_RADIUS * sin, normal_x: cos });
    }
    rings
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality;

    #[test]
    fn the_arm_is_closed_and_oriented_outwards() {
        let arm = arm();
        let q = quality::measure(&arm);
        assert_eq!((q.opening_count, q.part_count, q.bad_edge_count), (0, 1, 0));
        assert_eq!(q.point_count, q.vertex_count);
        let volume: f64 = arm
            .triangles
            .iter()
            .map(|t| {
                let [a, b, c] = t.map(|i| arm.positions[i as usize] - Vec3::new(0.3, HEIGHT, 0.0));
                a.dot(&b.cross(&c)) / 6.0
            })
            .sum();
        let round = std::f64::consts::PI * ARM_RADIUS.powi(2) * (0.6 + 4.0 / 3.0 * ARM_RADIUS);
        assert!((volume / round - 1.0).abs() < 0.015 && volume < round, "{volume} {round}");
    }

    #[test]
    fn the_sleeve_is_oriented_outwards_and_clear_of_the_arm() {
        let sleeve = sleeve();
        for t in &sleeve.triangles {
            let [a, b, c] = t.map(|i| sleeve.positions[i as usize]);
            let centre = (a + b + c) / 3.0;
            let out = Vec3::new(0.0, centre.y - HEIGHT, centre.z);
            assert!((b - a).cross(&(c - a)).dot(&out) > 0.0);
            assert!(out.norm() - ARM_RADIUS > 0.007, "{}", out.norm());
            let [p, q, r] = t.map(|i| sleeve.uvs[i as usize]);
            assert!((q - p).perp(&(r - p)) < 0.0, "the texture is mirrored");
        }
        assert!(sleeve.uvs.iter().all(|uv| uv.min() >= -1e-12 && uv.max() <= 1.0 + 1e-12));
    }

    /// Bent by 120 degrees, the inner line of the arm is still monotonic: the body does not intersect itself.
    #[test]
    fn the_bent_arm_does_not_fold_into_itself() {
        let (sin, cos) = (TAU / 6.0).sin_cos(); // half of 120 degrees, from the bisector
        let across = |x: f64| {
            let w = weights(x)[1] + weights(x)[2];
            (x - JOINTS[1]) * cos - (2.0 * w - 1.0) * ARM_RADIUS * sin
        };
        let mut last = across(0.1);
        for k in 1..=400 {
            let here = across(0.1 + 0.001 * k as f64);
            assert!(here > last);
            last = here;
        }
    }
}
