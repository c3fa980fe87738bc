//! Trousers on a lower body: pelvis and two legs with hips and knees, and the clip "sit-down".
//!
//! The body is where a smooth sum of round limbs ends (distances to segments of tapering radius, joined by a smooth least); the
//! trousers are the same surface a little farther out. Both are rings laid around it, split at the crotch, then evened out:
//! every point goes towards the mean of its neighbours and back to the surface. Front is +z, the wearer's left is +x.

use crate::glb::{Clip, Joint};
use crate::{Mesh, smooth};
use crease::math::{Vec2, Vec3};
use std::f64::consts::TAU;

/// Hips, knees and ankles of the left leg [m]; the right one's are mirrored.
const HIP: Vec3 = Vec3::new(0.09, 0.92, 0.0);
const KNEE: Vec3 = Vec3::new(0.10, 0.50, 0.0);
const ANKLE: Vec3 = Vec3::new(0.105, 0.08, -0.01);
/// Radii at the ends of thigh and calf [m].
const THIGH: [f64; 2] = [0.088, 0.060];
const CALF: [f64; 2] = [0.060, 0.042];
/// Half width, height and radius of pelvis and waist [m].
const PELVIS: [f64; 3] = [0.075, 0.98, 0.112];
const WAIST: [f64; 3] = [0.050, 1.14, 0.092];
/// Width over which limbs run into one another [m].
const SMOOTH: f64 = 0.04;
/// Where the legs part [m].
const CROTCH: f64 = 0.835;
/// Points around a leg, those of them on the seam between the legs, front to back.
const AROUND: usize = 28;
const BETWEEN: usize = 6;
/// Distance of rows [m].
const ROW: f64 = 0.0165;
/// Air between trousers and body [m].
const AIR: f64 = 0.009;
/// Rounds of evening out.
const ROUNDS: usize = 150;
/// Lengths over which the weights of hip and knee blend [m].
const BLENDS: [f64; 2] = [0.34, 0.28];

/// Distance to a limb from `a` to `b` whose radius goes from `radius[0]` to `radius[1]` [m].
fn limb(x: &Vec3, a: &Vec3, b: &Vec3, radius: [f64; 2]) -> f64 {
    let along = (b - a) / (b - a).norm_squared();
    let t = (x - a).dot(&along).clamp(0.0, 1.0);
    (x - a - (b - a) * t).norm() - radius[0] - (radius[1] - radius[0]) * t
}

/// The lesser of two distances, rounded where they are nearly equal.
fn joined(a: f64, b: f64) -> f64 {
    let near = (SMOOTH - (a - b).abs()).max(0.0) / SMOOTH;
    a.min(b) - 0.25 * near * near * SMOOTH
}

/// Distance from the body, about [m].
fn height(x: &Vec3) -> f64 {
    let across = |[half, y, radius]: [f64; 3]| {
        limb(x, &Vec3::new(-half, y, 0.0), &Vec3::new(half, y, 0.0), [radius, radius])
    };
    // One leg is enough: the other is its mirror image.
    let own = Vec3::new(x.x.abs(), x.y, x.z);
    let leg = joined(limb(&own, &HIP, &KNEE, THIGH), limb(&own, &KNEE, &ANKLE, CALF));
    let other = Vec3::new(-own.x, own.y, own.z);
    let legs = joined(leg, limb(&other, &HIP, &KNEE, THIGH));
    joined(joined(across(PELVIS), across(WAIST)), legs)
}

/// Its gradient, of about unit length.
fn outward(x: &Vec3) -> Vec3 {
    let step = 1e-5;
    Vec3::from_fn(|k, _| {
        let d = Vec3::ith(k, step);
        (height(&(x + d)) - height(&(x - d))) / (2.0 * step)
    })
}

/// Points in rings around body and legs, before they are vertices.
struct Rings {
    points: Vec<Vec3>,
    /// Rings of the pelvis from the crotch up, of the left and of the right leg from the crotch down; those of one piece all have
    /// the same number of points and turn the same way round, odd ones half a place on.
    pieces: [Vec<Vec<usize>>; 3],
    /// Per point: whether it lies on an open end, and keeps its height.
    ends: Vec<bool>,
}

impl Rings {
    /// Rings `air` [m] outside the body, from `low` to `high` [m].
    fn new(air: f64, low: f64, high: f64) -> Self {
        let mut rings = Self { points: Vec::new(), pieces: Default::default(), ends: Vec::new() };
        let outer = AROUND - BETWEEN;
        let between: Vec<usize> = (0..=BETWEEN)
            .map(|k| rings.add(Vec3::new(0.0, CROTCH, 0.08 * (1.0 - 2.0 * k as f64 / BETWEEN as f64))))
            .collect();
        // Seen from above, from the front of the seam round the left leg to its back, and on round the right one.
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
        // Each leg round the same way as the pelvis: the left one back by the seam, the right one out by it.
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
        rings.even_out(air);
        rings
    }

    fn add(&mut self, x: Vec3) -> usize {
        self.points.push(x);
        self.ends.push(false);
        self.points.len() - 1
    }

    /// Rings from `first` to the height `end`, where they are around `centre`.
    fn extend(&mut self, piece: usize, first: Vec<usize>, end: f64, centre: Vec3) {
        let rows = ((CROTCH - end).abs() / ROW).round() as usize;
        let count = first.len();
        let middle = first.iter().map(|&p| self.points[p]).sum::<Vec3>() / count as f64;
        let mut all = vec![first.clone()];
        for row in 1..=rows {
            let share = row as f64 / rows as f64;
            let place = |rings: &Self, k: usize| {
                let [a, b] = [k, k + 1].map(|k| rings.points[first[k % count]] - middle);
                let out = if row % 2 == 1 { 0.5 * (a + b) } else { a };
                let narrow = if piece == 0 { 1.0 - 0.2 * share } else { 1.0 - 0.5 * share };
                let mut x = middle.lerp(&centre, share) + Vec3::new(out.x, 0.0, out.z) * narrow;
                x.y = CROTCH + (end - CROTCH) * share;
                x
            };
            let ring: Vec<usize> = (0..count)
                .map(|k| {
                    let x = place(self, k);
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

    /// Triangles between points, not yet turned outward.
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

    fn even_out(&mut self, air: f64) {
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
                    *x -= out * ((height(x) - air) / out.norm_squared().max(0.05)).clamp(-0.05, 0.05);
                }
            }
        }
    }

    /// As vertices: each piece cut open along its first column in the texture, in which lengths are fractions of `size` [m].
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
            turn_outward(&mut mesh, first);
        }
        mesh
    }
}

/// Turns the triangles from `first` on all alike, so that most look outward.
fn turn_outward(mesh: &mut Mesh, first: usize) {
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
    Rings::new(AIR, 0.11, 1.08).mesh(2.0)
}

/// The body: closed.
pub fn body() -> Mesh {
    let rings = Rings::new(0.0, 0.07, 1.16);
    let mut mesh = rings.mesh(2.0);
    mesh.uvs.clear();
    // Its ends are closed by fans.
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
    let joint = |name, place, parent| Joint { name, place, parent };
    vec![
        joint("pelvis", pelvis, None),
        joint("hip.L", HIP, Some(0)),
        joint("knee.L", KNEE, Some(1)),
        joint("hip.R", mirrored(HIP), Some(0)),
        joint("knee.R", mirrored(KNEE), Some(3)),
    ]
}

/// Skin weights at `x`: (joint, weight), the weights summing to one.
pub fn weights(x: &Vec3) -> Vec<(u8, f64)> {
    let step = |height: f64, width: f64| smooth((height - x.y) / width + 0.5);
    let (hip, knee) = (step(HIP.y - 0.02, BLENDS[0]), step(KNEE.y, BLENDS[1]));
    // Between the legs both hips have a share.
    let left = smooth((x.x / 0.08 + 1.0) * 0.5);
    let side = |first: u8, share: f64| [(first, share * hip * (1.0 - knee)), (first + 1, share * hip * knee)];
    let all = [(0, 1.0 - hip)].into_iter().chain(side(1, left)).chain(side(3, 1.0 - left));
    all.filter(|(_, w)| *w > 0.0).collect()
}

/// Keys of the clip "sit-down", 6 s: down, a second seated, slowly up. Per joint: its turns as (x, y, z, w).
pub fn sit_down() -> Clip {
    const KEYS: usize = 72;
    let seated = |t: f64| smooth(t / 1.5).min(smooth((6.0 - t) / 3.5));
    let times: Vec<f64> = (0..=KEYS).map(|k| 6.0 * k as f64 / KEYS as f64).collect();
    let turns = |degrees: f64| -> Vec<[f32; 4]> {
        let turn = |t: &f64| {
            let (sin, cos) = (0.5 * degrees.to_radians() * seated(*t)).sin_cos();
            [sin as f32, 0.0, 0.0, cos as f32]
        };
        times.iter().map(turn).collect()
    };
    let all = [(1, -80.0), (2, 85.0), (3, -80.0), (4, 85.0)];
    (
        times.iter().map(|t| [*t as f32]).collect(),
        all.map(|(joint, degrees)| (joint, turns(degrees))).to_vec(),
    )
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
            assert!((height(x) - AIR).abs() < 1e-3, "{} at {x}", height(x));
        }
        for x in body().positions.iter().filter(|x| x.y > 0.08 && x.y < 1.15) {
            assert!(height(x).abs() < 1e-3, "{} at {x}", height(x));
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
