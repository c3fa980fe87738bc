//! Trousers on a lower body: pelvis and two legs with hips and knees, and the clip "sit-down".
//!
//! The body is an implicit surface: the smooth union of round cones (distance to a segment of linearly varying
//! radius); the trousers are its offset surface. Both are meshed by rings, which branch at the crotch, and smoothed:
//! every point moves towards the mean of its neighbours and is projected back onto the surface. Front is +z, the left
//! leg is at +x.

use crate::glb::{Clip, Joint, JointRotations};
use crate::{Mesh, smoothstep};
use crease_geometry::math::{Vec2, Vec3};
use std::f64::consts::TAU;

/// Left hip [m]; joints of the right leg are mirrored.
const HIP: Vec3 = Vec3::new(0.09, 0.92, 0.0);
/// Left knee [m].
const KNEE: Vec3 = Vec3::new(0.10, 0.50, 0.0);
/// Left ankle [m].
const ANKLE: Vec3 = Vec3::new(0.105, 0.08, -0.01);
/// Radii at the ends of the thigh [m].
const THIGH: [f64; 2] = [0.088, 0.060];
/// Radii at the ends of the calf [m].
const CALF: [f64; 2] = [0.060, 0.042];
/// A horizontal capsule across the body.
struct Capsule {
    /// Half the length of its axis [m].
    half_width: f64,
    /// Height of its axis [m].
    height: f64,
    /// Radius [m].
    radius: f64,
}

const PELVIS: Capsule = Capsule { half_width: 0.075, height: 0.98, radius: 0.112 };
const WAIST: Capsule = Capsule { half_width: 0.050, height: 1.14, radius: 0.092 };
/// Width of the smooth union [m].
const UNION_WIDTH: f64 = 0.04;
/// Height of the crotch [m].
const CROTCH: f64 = 0.835;
/// Points around a leg.
const AROUND: usize = 28;
/// Edges of the crotch line, from front to back.
const BETWEEN: usize = 6;
/// Spacing of rows [m].
const ROW: f64 = 0.0165;
/// Distance between trousers and body [m].
const GAP: f64 = 0.009;
/// Rounds of smoothing.
const ROUNDS: usize = 150;
/// Length over which the weights of the hip blend [m].
const HIP_BLEND: f64 = 0.34;
/// Length over which the weights of the knee blend [m].
const KNEE_BLEND: f64 = 0.28;

/// Distance to a round cone from `a` to `b` with the radii `radius` at its ends [m].
fn cone_distance(x: &Vec3, a: &Vec3, b: &Vec3, radius: [f64; 2]) -> f64 {
    let along = (b - a) / (b - a).norm_squared();
    let t = (x - a).dot(&along).clamp(0.0, 1.0);
    (x - a - (b - a) * t).norm() - radius[0] - (radius[1] - radius[0]) * t
}

/// Smooth minimum of two distances [m].
fn smooth_min(a: f64, b: f64) -> f64 {
    let near = (UNION_WIDTH - (a - b).abs()).max(0.0) / UNION_WIDTH;
    a.min(b) - 0.25 * near * near * UNION_WIDTH
}

/// Approximate signed distance from the body [m].
fn body_distance(x: &Vec3) -> f64 {
    let across = |capsule: &Capsule| {
        let &Capsule { half_width, height, radius } = capsule;
        let ends = [-half_width, half_width].map(|x| Vec3::new(x, height, 0.0));
        cone_distance(x, &ends[0], &ends[1], [radius, radius])
    };
    // By symmetry the point is mirrored to the left leg.
    let own = Vec3::new(x.x.abs(), x.y, x.z);
    let leg = smooth_min(cone_distance(&own, &HIP, &KNEE, THIGH), cone_distance(&own, &KNEE, &ANKLE, CALF));
    let other = Vec3::new(-own.x, own.y, own.z);
    let legs = smooth_min(leg, cone_distance(&other, &HIP, &KNEE, THIGH));
    smooth_min(smooth_min(across(&PELVIS), across(&WAIST)), legs)
}

/// Gradient of the distance, of about unit length.
fn outward(x: &Vec3) -> Vec3 {
    let step = 1e-5;
    Vec3::from_fn(|k, _| {
        let d = Vec3::ith(k, step);
        (body_distance(&(x + d)) - body_distance(&(x - d))) / (2.0 * step)
    })
}

/// Points in rings around body and legs.
struct Rings {
    points: Vec<Vec3>,
    /// Rings of the pelvis from the crotch upwards, of the left and of the right leg from the crotch downwards. Those
    /// of one piece have the same number of points and the same orientation; odd ones are shifted by half a column.
    pieces: [Vec<Vec<usize>>; 3],
    /// One flag per point: whether it lies on an open end, where its height is fixed.
    ends: Vec<bool>,
}

impl Rings {
    /// Rings on the offset surface at `offset` [m], from the height `low` to `high` [m].
    fn new(offset: f64, low: f64, high: f64) -> Self {
        let mut rings = Self { points: Vec::new(), pieces: Default::default(), ends: Vec::new() };
        let outer = AROUND - BETWEEN;
        let between: Vec<usize> = (0..=BETWEEN)
            .map(|k| rings.add(Vec3::new(0.0, CROTCH, 0.08 * (1.0 - 2.0 * k as f64 / BETWEEN as f64))))
            .collect();
        // Seen from above: from the front of the crotch line around the left leg to its back, then around the right
        // one.
        let mut half = |side: f64| -> Vec<usize> {
            (1..outer)
                .map(|k| {
                    let (sin, cos) = (0.5 * TAU * k as f64 / outer as f64).sin_cos();
                    rings.add(Vec3::new(0.19 * sin * side, CROTCH, 0.1 * cos))
                })
                .collect()
        };
        let (left, right) = (half(1.0), half(-1.0));
        let (front, back) = (between[0], between[BETWEEN]);
        let pelvis: Vec<usize> = [front]
            .into_iter()
            .chain(left.iter().copied())
            .chain([back])
            .chain(right.iter().rev().copied())
            .collect();
        // Legs have the orientation of the pelvis: the left one ends with the crotch line, the right one too,
        // reversed.
        let left: Vec<usize> = [front]
            .into_iter()
            .chain(left)
            .chain([back])
            .chain(between[1..BETWEEN].iter().rev().copied())
            .collect();
        let right: Vec<usize> = [back]
            .into_iter()
            .chain(right.into_iter().rev())
            .chain([front])
            .chain(between[1..BETWEEN].iter().copied())
            .collect();
        for (piece, first) in [pelvis, left, right].into_iter().enumerate() {
            let (end, centre_to) = match piece {
                0 => (high, Vec3::new(0.0, high, 0.0)),
                1 => (low, Vec3::new(ANKLE.x, low, ANKLE.z)),
                _ => (low, Vec3::new(-ANKLE.x, low, ANKLE.z)),
            };
            rings.extend(piece, first, end, centre_to);
        }
        rings.smooth(offset);
        rings
    }

    fn add(&mut self, x: Vec3) -> usize {
        self.points.push(x);
        self.ends.push(false);
        self.points.len() - 1
    }

    /// Appends the rings of a piece from `first` to the height `end`, where they are around `centre` [m].
    fn extend(&mut self, piece: usize, first: Vec<usize>, end: f64, centre: Vec3) {
        let rows = ((CROTCH - end).abs() / ROW).round() as usize;
        let count = first.len();
        let middle = first.iter().map(|&p| self.points[p]).sum::<Vec3>() / count as f64;
        let mut all = vec![first.clone()];
        for row in 1..=rows {
            let fraction = row as f64 / rows as f64;
            let position = |rings: &Self, k: usize| {
                let [a, b] = [k, k + 1].map(|k| rings.points[first[k % count]] - middle);
                let out = if row % 2 == 1 { 0.5 * (a + b) } else { a };
                let narrowing = if piece == 0 { 1.0 - 0.2 * fraction } else { 1.0 - 0.5 * fraction };
                let mut x = middle.lerp(&centre, fraction) + Vec3::new(out.x, 0.0, out.z) * narrowing;
                x.y = CROTCH + (end - CROTCH) * fraction;
                x
            };
            let ring: Vec<usize> = (0..count)
                .map(|k| {
                    let x = position(self, k);
                    self.add(x)
                })
                .collect();
            all.push(ring);
        }
        if let Some(last) = all.last() {
            last.iter().for_each(|&p| self.ends[p] = true);
        }
        self.pieces[piece] = all;
    }

    /// Triangles over the points, not yet oriented.
    fn triangles(&self) -> Vec<[usize; 3]> {
        let mut all = Vec::new();
        for piece in &self.pieces {
            for (i, pair) in piece.windows(2).enumerate() {
                let count = pair[0].len();
                for j in 0..count {
                    let [a, b] = [j, (j + 1) % count].map(|j| pair[0][j]);
                    let [c, d] = [j, (j + 1) % count].map(|j| pair[1][j]);
                    all.extend(if i % 2 == 0 { [[a, b, c], [b, d, c]] } else { [[a, d, c], [a, b, d]] });
                }
            }
        }
        all
    }

    /// Moves every point towards the mean of its neighbours and projects it onto the offset surface at `offset` [m].
    fn smooth(&mut self, offset: f64) {
        let mut neighbours = vec![Vec::new(); self.points.len()];
        for t in self.triangles() {
            for k in 0..3 {
                neighbours[t[k]].extend([t[(k + 1) % 3], t[(k + 2) % 3]]);
            }
        }
        for round in 0..ROUNDS {
            let before = self.points.clone();
            for (p, x) in self.points.iter_mut().enumerate() {
                let mean =
                    neighbours[p].iter().map(|&q| before[q]).sum::<Vec3>() / neighbours[p].len() as f64;
                let y = x.y;
                if round > 0 {
                    *x += 0.6 * (mean - *x);
                }
                for _ in 0..4 {
                    if self.ends[p] {
                        x.y = y;
                    }
                    let mut out = outward(x);
                    if self.ends[p] {
                        out.y = 0.0;
                    }
                    *x -=
                        out * ((body_distance(x) - offset) / out.norm_squared().max(0.05)).clamp(-0.05, 0.05);
                }
            }
        }
    }

    /// Mesh of vertices: each piece is cut along its first column in the texture, whose unit is `size` [m].
    fn mesh(&self, size: f64) -> Mesh {
        let mut mesh = Mesh::default();
        for (number, piece) in self.pieces.iter().enumerate() {
            let count = piece[0].len();
            let base = mesh.positions.len() as u32;
            let first = mesh.triangles.len();
            for (i, ring) in piece.iter().enumerate() {
                for j in 0..=count {
                    let x = self.points[ring[j % count]];
                    let normal = outward(&x).normalize();
                    mesh.positions.push(x);
                    mesh.normals.push(normal);
                    // Warp along the legs, from the waist down.
                    let along = if number == 0 { -(i as f64) } else { i as f64 } * ROW + (1.1 - CROTCH);
                    let column = j as f64 + if i % 2 == 1 { 0.5 } else { 0.0 };
                    let across = column * 0.019 + [0.0, 0.86, 1.42][number];
                    mesh.uvs.push(Vec2::new(along, across) / size);
                }
            }
            let at = |i: usize, j: usize| base + (i * (count + 1) + j) as u32;
            for i in 0..piece.len() - 1 {
                for j in 0..count {
                    let [a, b, c, d] = [at(i, j), at(i, j + 1), at(i + 1, j), at(i + 1, j + 1)];
                    mesh.triangles.extend(if i % 2 == 0 {
                        [[a, b, c], [b, d, c]]
                    } else {
                        [[a, d, c], [a, b, d]]
                    });
                }
            }
            orient_outwards(&mut mesh, first);
        }
        mesh
    }
}

/// Flips all triangles from `first` on if their normals point inwards on average.
fn orient_outwards(mesh: &mut Mesh, first: usize) {
    let outward_area = |t: &[u32; 3]| {
        let [a, b, c] = t.map(|v| mesh.positions[v as usize]);
        (b - a).cross(&(c - a)).dot(&outward(&((a + b + c) / 3.0)))
    };
    if mesh.triangles[first..].iter().map(outward_area).sum::<f64>() < 0.0 {
        mesh.triangles[first..].iter_mut().for_each(|t| t.swap(1, 2));
    }
}

/// The trousers: open at the waist and the ankles.
pub fn trousers() -> Mesh {
    Rings::new(GAP, 0.11, 1.08).mesh(2.0)
}

/// The body: closed.
pub fn body() -> Mesh {
    let rings = Rings::new(0.0, 0.07, 1.16);
    let mut mesh = rings.mesh(2.0);
    mesh.uvs.clear();
    // Fans close its ends.
    for piece in &rings.pieces {
        let Some(last) = piece.last() else { continue };
        let middle = last.iter().map(|&p| rings.points[p]).sum::<Vec3>() / last.len() as f64;
        let up = if middle.y > CROTCH { Vec3::y() } else { -Vec3::y() };
        let first = mesh.positions.len() as u32;
        mesh.positions.push(middle);
        mesh.positions.extend(last.iter().map(|&p| rings.points[p]));
        mesh.normals.extend(std::iter::repeat_n(up, last.len() + 1));
        let count = last.len() as u32;
        for j in 0..count {
            let [a, b] = [j, (j + 1) % count].map(|j| first + 1 + j);
            let [x, y] = [a, b].map(|v| mesh.positions[v as usize] - middle);
            mesh.triangles.push(if x.cross(&y).dot(&up) > 0.0 { [first, a, b] } else { [first, b, a] });
        }
    }
    mesh
}

/// Joints: pelvis, then hip and knee of the left and the right leg.
pub fn joints() -> Vec<Joint> {
    let mirrored = |x: Vec3| Vec3::new(-x.x, x.y, x.z);
    let pelvis = Vec3::new(0.0, 1.0, 0.0);
    let joint = |name, position, parent| Joint { name, position, parent };
    vec![
        joint("pelvis", pelvis, None),
        joint("hip.L", HIP, Some(0)),
        joint("knee.L", KNEE, Some(1)),
        joint("hip.R", mirrored(HIP), Some(0)),
        joint("knee.R", mirrored(KNEE), Some(3)),
    ]
}

/// Skin weights at `x`: pairs of joint and weight; the weights sum to one.
pub fn weights(x: &Vec3) -> Vec<(u8, f64)> {
    let step = |height: f64, width: f64| smoothstep((height - x.y) / width + 0.5);
    let (hip, knee) = (step(HIP.y - 0.02, HIP_BLEND), step(KNEE.y, KNEE_BLEND));
    // Both hips have weight between the legs.
    let left = smoothstep((x.x / 0.08 + 1.0) * 0.5);
    let side = |first: u8, part: f64| [(first, part * hip * (1.0 - knee)), (first + 1, part * hip * knee)];
    let all = [(0, 1.0 - hip)].into_iter().chain(side(1, left)).chain(side(3, 1.0 - left));
    all.filter(|(_, w)| *w > 0.0).collect()
}

/// The clip "sit-down" of 6 s: down, one second seated, slowly up.
pub fn sit_down() -> Clip {
    const KEYS: usize = 72;
    let seated = |t: f64| smoothstep(t / 1.5).min(smoothstep((6.0 - t) / 3.5));
    let times: Vec<f64> = (0..=KEYS).map(|k| 6.0 * k as f64 / KEYS as f64).collect();
    let rotations = |degrees: f64| -> Vec<[f32; 4]> {
        let rotation = |t: &f64| {
            let (sin, cos) = (0.5 * degrees.to_radians() * seated(*t)).sin_cos();
            [sin as f32, 0.0, 0.0, cos as f32]
        };
        times.iter().map(rotation).collect()
    };
    let all = [(1, -80.0), (2, 85.0), (3, -80.0), (4, 85.0)];
    Clip {
        name: "sit-down",
        times: times.iter().map(|t| [*t as f32]).collect(),
        rotations: all
            .map(|(joint, degrees)| JointRotations { joint, rotations: rotations(degrees) })
            .into_iter()
            .collect(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::quality;

    #[test]
    fn the_body_is_closed_and_the_trousers_are_clear_of_it() {
        let q = quality::measure(&body());
        assert_eq!((q.opening_count, q.part_count, q.bad_edge_count), (0, 1, 0));
        for x in &trousers().positions {
            assert!((body_distance(x) - GAP).abs() < 1e-3, "{} at {x}", body_distance(x));
        }
        for x in body().positions.iter().filter(|x| x.y > 0.08 && x.y < 1.15) {
            assert!(body_distance(x).abs() < 1e-3, "{} at {x}", body_distance(x));
        }
    }

    #[test]
    fn weights_sum_to_one_and_are_at_most_four() {
        for x in &trousers().positions {
            let all = weights(x);
            assert!(all.len() <= 4 && (all.iter().map(|(_, w)| w).sum::<f64>() - 1.0).abs() < 1e-12);
        }
    }
}
