//! Garments of other cuts and poses are laid over one another limb by limb.

use crease::internal::transfer::{AlignedBy, TransferOptions, TransferResult, TransferSource, transfer};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::hinge_angle;
use crease_model::garment::{Garment, MeshOptions, RestState};
use crease_model::remesh::GarmentSurface;
use std::collections::{BTreeMap, BTreeSet};

/// Side of the squares that garments are made of [m].
const CELL: f64 = 0.02;

/// A garment of two layers, sewn along its outline, and where its points were in the pattern.
struct Made {
    garment: Garment,
    pattern: Vec<Vec3>,
}

/// Sews two layers over `rectangles` (left, right, bottom, top) [m] along their outline, but where `is_open`; `pose` brings them
/// to the shape of the file. The front may be open along x = 0.
fn sewn(
    rectangles: &[[f64; 4]],
    is_open: impl Fn(f64, f64) -> bool,
    open_front: bool,
    pose: impl Fn(Vec3) -> Vec3,
) -> Made {
    let cell = |x: f64| (x / CELL).round() as i32;
    let mut cells = BTreeSet::new();
    for [left, right, bottom, top] in rectangles.iter().map(|r| r.map(cell)) {
        cells.extend((left..right).flat_map(|i| (bottom..top).map(move |j| (i, j))));
    }
    let mut sewn = BTreeSet::new();
    for &(i, j) in &cells {
        let sides = [((i - 1, j), [(i, j), (i, j + 1)]), ((i + 1, j), [(i + 1, j), (i + 1, j + 1)])];
        let ends = [((i, j - 1), [(i, j), (i + 1, j)]), ((i, j + 1), [(i, j + 1), (i + 1, j + 1)])];
        for (other, edge) in sides.into_iter().chain(ends) {
            let middle = [0, 1].map(|k| {
                let pair = edge.map(|p: (i32, i32)| [p.0, p.1][k]);
                0.5 * CELL * f64::from(pair[0] + pair[1])
            });
            if !cells.contains(&other) && !is_open(middle[0], middle[1]) {
                sewn.extend(edge);
            }
        }
    }
    let depth = |(i, j): (i32, i32)| {
        let squared = |p: &(i32, i32)| f64::from((p.0 - i).pow(2) + (p.1 - j).pow(2));
        let distance = CELL * sewn.iter().map(squared).fold(f64::INFINITY, f64::min).sqrt();
        0.07 * (1.0 - (1.0 - (distance / 0.1).min(1.0)).powi(2)).sqrt()
    };
    let (mut vertices, mut pattern, mut triangles) = (Vec::new(), Vec::new(), Vec::new());
    // Layer 0 in front, 1 behind, 2 the right half of an open front.
    let mut number: BTreeMap<(i32, i32, i32), u32> = BTreeMap::new();
    for &(i, j) in &cells {
        for layer in [0, 1] {
            let mut corner = |p: (i32, i32)| {
                let own = match layer {
                    _ if sewn.contains(&p) => 0,
                    0 if open_front && p.0 == 0 && i < 0 => 2,
                    layer => layer,
                };
                *number.entry((p.0, p.1, own)).or_insert_with(|| {
                    let z = if sewn.contains(&p) { 0.0 } else { depth(p) };
                    let flat = Vec3::new(
                        CELL * f64::from(p.0),
                        CELL * f64::from(p.1),
                        if own == 1 { -z } else { z },
                    );
                    vertices.push(pose(flat).into());
                    pattern.push(flat);
                    vertices.len() as u32 - 1
                })
            };
            let [a, b, c, d] = [(i, j), (i + 1, j), (i + 1, j + 1), (i, j + 1)].map(&mut corner);
            let pair = if layer == 0 { [[a, b, c], [a, c, d]] } else { [[a, c, b], [a, d, c]] };
            // Two sewn layers of a corner would be one triangle twice.
            for t in pair {
                if !is_known(&triangles, &t) {
                    triangles.push(t);
                }
            }
        }
    }
    let garment =
        Garment::from_mesh(&vertices, &triangles, MeshOptions::default().name("made")).expect("is a garment");
    let nearest = |x: &Vec3| {
        let distance = |v: &usize| (Vec3::from(vertices[*v]) - x).norm_squared();
        let found = (0..vertices.len()).min_by(|a, b| distance(a).total_cmp(&distance(b)));
        pattern[found.expect("has vertices")]
    };
    Made { pattern: garment.points.iter().map(nearest).collect(), garment }
}

fn is_known(all: &[[u32; 3]], t: &[u32; 3]) -> bool {
    let mut sorted = *t;
    sorted.sort_unstable();
    all.iter().rev().take(2).any(|other| {
        let mut other = *other;
        other.sort_unstable();
        other == sorted
    })
}

/// An upper garment with sleeves of length `sleeve` [m] that hang by `angle` [rad].
fn shirt(half_width: f64, length: f64, sleeve: f64, angle: f64, open_front: bool) -> Made {
    let (top, cuff) = (length, half_width + sleeve);
    let rectangles = [
        [-half_width, half_width, 0.0, length],
        [half_width, cuff, top - 0.18, top],
        [-cuff, -half_width, top - 0.18, top],
    ];
    let is_open = |x: f64, y: f64| y < 1e-9 || x.abs() > cuff - 1e-9 || (y > top - 1e-9 && x.abs() < 0.09);
    let pose = |p: Vec3| {
        let along = ((p.x.abs() - half_width) / 0.1).clamp(0.0, 1.0);
        let (sin, cos) = (angle * along).sin_cos();
        let (dx, dy) = (p.x.abs() - half_width, p.y - (top - 0.05));
        let turned = Vec3::new(half_width + dx * cos + dy * sin, top - 0.05 - dx * sin + dy * cos, p.z);
        if along > 0.0 { Vec3::new(p.x.signum() * turned.x, turned.y, turned.z) } else { p }
    };
    sewn(&rectangles, is_open, open_front, pose)
}

/// A lower garment whose legs end at the height `bottom` [m].
fn trousers(bottom: f64) -> Made {
    let rectangles = [[-0.22, 0.22, 0.74, 1.0], [0.02, 0.22, bottom, 0.74], [-0.22, -0.02, bottom, 0.74]];
    sewn(&rectangles, |_, y| y < bottom + 1e-9 || y > 1.0 - 1e-9, false, |p| p)
}

/// A sleeve of its own: a tube along x, wider at the shoulder.
fn tube(from: f64, to: f64, height: f64) -> Made {
    let (around, along) = (20, 30);
    let (mut vertices, mut triangles) = (Vec::new(), Vec::new());
    for i in 0..=along {
        let x = from + (to - from) * f64::from(i) / f64::from(along);
        let radius = 0.07 - 0.02 * f64::from(i) / f64::from(along);
        for k in 0..around {
            let (sin, cos) = (std::f64::consts::TAU * f64::from(k) / f64::from(around)).sin_cos();
            vertices.push([x, height + radius * cos, radius * sin]);
        }
    }
    for (i, k) in (0..along).flat_map(|i| (0..around).map(move |k| (i, k))) {
        let at = |i: i32, k: i32| (i * around + k % around) as u32;
        let [a, b, c, d] = [at(i, k), at(i + 1, k), at(i + 1, k + 1), at(i, k + 1)];
        triangles.extend([[a, c, b], [a, d, c]]);
    }
    let garment =
        Garment::from_mesh(&vertices, &triangles, MeshOptions::default().name("tube")).expect("is a garment");
    Made { pattern: garment.points.clone(), garment }
}

impl Made {
    fn middles(&self) -> Vec<Vec3> {
        let hinges = self.garment.topology.hinges.iter();
        hinges.map(|h| (self.pattern[h.points[0].at()] + self.pattern[h.points[1].at()]) * 0.5).collect()
    }

    fn length(&self, h: usize) -> f64 {
        let points = self.garment.topology.hinges[h].points;
        (self.garment.points[points[1].at()] - self.garment.points[points[0].at()]).norm()
    }

    /// The garment with hinges bent by half a radian where `is_worn`, in the pattern; lifted, so that it does not lie in the place
    /// of another.
    fn worn(&self, is_worn: impl Fn(&Vec3) -> bool) -> TransferSource {
        let mut surface = GarmentSurface::without_texture(&self.garment);
        surface.points.iter_mut().for_each(|x| x.y += 0.6);
        let angle =
            |h: &crease_geometry::mesh::Hinge| hinge_angle(&h.points.map(|p| self.garment.points[p.at()]));
        let angles = self.garment.topology.hinges.iter().map(angle).collect();
        let mut memory = RestState::new(angles, self.garment.triangles.len());
        for (middle, rest) in self.middles().iter().zip(&mut memory.rest_angle) {
            *rest += if is_worn(middle) { 0.5 } else { 0.0 };
        }
        TransferSource { file: "source".into(), surface, memory, joints: Vec::new(), simulated: None }
    }

    /// Memory (angle times length) whose middle is `within`, and all of it [rad m].
    fn memory(&self, memory: &RestState, within: impl Fn(&Vec3) -> bool) -> [f64; 2] {
        let mut sums = [0.0; 2];
        for (h, middle) in self.middles().iter().enumerate() {
            let own = (memory.rest_angle[h] - memory.source_angle[h]).abs() * self.length(h);
            sums[0] += if within(middle) { own } else { 0.0 };
            sums[1] += own;
        }
        sums
    }

    /// Mean confidence of the triangles whose middle is `within`.
    fn confidence(&self, result: &TransferResult, within: impl Fn(&Vec3) -> bool) -> f64 {
        let middle = |t: &[crease_geometry::mesh::PointIndex; 3]| {
            t.iter().map(|p| self.pattern[p.at()]).sum::<Vec3>() / 3.0
        };
        let all = self.garment.triangles.iter().zip(&result.confidence);
        let inside: Vec<f64> = all.filter(|(t, _)| within(&middle(t))).map(|(_, c)| *c).collect();
        inside.iter().sum::<f64>() / inside.len().max(1) as f64
    }
}

fn carried(source: &TransferSource, target: &Made) -> TransferResult {
    let surface = GarmentSurface::without_texture(&target.garment);
    let options = TransferOptions::full(target.garment.points.len());
    let sources = std::slice::from_ref(source);
    let result = transfer(sources, &surface, &options).expect("transfers");
    assert_eq!(result.sources[0].aligned_by, Some(AlignedBy::Limbs), "{:?}", result.warnings);
    result
}

/// An elbow goes to the elbow of the same sleeve of a longer, wider garment in another pose, open in front or not.
#[test]
fn an_elbow_stays_an_elbow() {
    let source = shirt(0.24, 0.62, 0.5, 0.0, false);
    let worn = source.worn(|p| (p.x - 0.24 - 0.25).abs() < 0.05);
    for (target, half, sleeve) in
        [(shirt(0.3, 0.86, 0.56, 0.9, false), 0.3, 0.56), (shirt(0.28, 0.7, 0.5, 0.8, true), 0.28, 0.5)]
    {
        let result = carried(&worn, &target);
        let [own, _] = source.memory(&worn.memory, |_| true);
        let at_elbow = |p: &Vec3| (0.3..0.7).contains(&((p.x - half) / sleeve));
        let [there, all] = target.memory(&result.memory, at_elbow);
        println!("elbow: {own:.2} -> {there:.2} of {all:.2}; {:?}", result.warnings);
        assert!(there > 0.95 * all, "{there} of {all} rad m at the elbow");
        assert!((0.5..1.5).contains(&(there / own)), "{there} of {own} rad m");
        // A warning on low confidence may say more; what has no counterpart is nothing here.
        assert!(result.warnings.iter().all(|text| !text.contains("nothing goes")), "{:?}", result.warnings);
    }
}

/// Folds of a T-shirt stay on the torso and the upper sleeves of a garment with long ones; what is beyond gets nothing, and that is told.
#[test]
fn short_sleeves_do_not_reach_over_long_ones() {
    let source = shirt(0.26, 0.66, 0.14, 0.3, false);
    let worn = source.worn(|p| (p.x - 0.12).abs() < 0.03 || p.x > 0.3);
    let target = shirt(0.28, 0.7, 0.6, 0.8, false);
    let result = carried(&worn, &target);
    let beyond = |p: &Vec3| p.x.abs() > 0.28 + 0.14 + 0.1;
    let [there, all] = target.memory(&result.memory, beyond);
    println!("T-shirt: {there:.3} of {all:.3} beyond; {:?}", result.warnings);
    assert!(there < 0.01 * all, "{there} of {all} rad m on the lower sleeves");
    let [torso, _] = target.memory(&result.memory, |p| (p.x - 0.13).abs() < 0.08);
    assert!(torso > 0.4 * all, "{torso} of {all} rad m at the fold of the torso");
    assert!(target.confidence(&result, beyond) < 0.02);
    assert!(target.confidence(&result, |p| p.x.abs() < 0.2 && p.y < 0.5) > 0.5);
    let told = result.warnings.iter().any(|text| text.contains("upper part") && text.contains("left sleeve"));
    assert!(told, "{:?}", result.warnings);
}

/// A sleeve that is a file of its own is laid over the sleeve on its side, and the rest of the garment gets nothing.
#[test]
fn a_sleeve_of_its_own_goes_to_the_sleeve_on_its_side() {
    let target = shirt(0.26, 0.68, 0.5, 0.0, false);
    for side in [1.0, -1.0] {
        let source = tube(side * 0.3, side * 0.85, 0.55);
        let worn = source.worn(|p| (p.x.abs() - 0.57).abs() < 0.05);
        let result = carried(&worn, &target);
        let [there, all] =
            target.memory(&result.memory, |p| (0.3..0.7).contains(&((side * p.x - 0.26) / 0.5)));
        println!("tube {side}: {there:.3} of {all:.3}; {:?}", result.warnings);
        assert!(all > 0.3 && there > 0.95 * all, "{there} of {all} rad m at the elbow of that side");
        assert!(target.confidence(&result, |p| side * p.x < 0.2) < 0.01, "the rest gets nothing");
        let name = if side > 0.0 { "left sleeve" } else { "right sleeve" };
        assert!(result.warnings.iter().any(|text| text.contains(name)), "{:?}", result.warnings);
    }
}

/// A knee is lost on shorts; a thigh of shorts stays a thigh on trousers.
#[test]
fn legs_are_matched_from_the_crotch_down() {
    let (long, short) = (trousers(0.04), trousers(0.46));
    let knee = long.worn(|p| p.x > 0.0 && (p.y - 0.3).abs() < 0.04);
    let result = carried(&knee, &short);
    assert!(short.memory(&result.memory, |_| true)[1] < 0.02, "shorts have no knees");
    assert!(result.sources[0].losses.lost_crease_fraction > 0.95);
    let thigh = short.worn(|p| p.x > 0.0 && (p.y - 0.6).abs() < 0.04);
    let result = carried(&thigh, &long);
    let [there, all] = long.memory(&result.memory, |p| p.x > 0.0 && (p.y - 0.6).abs() < 0.1);
    println!("thigh: {there:.3} of {all:.3}; {:?}", result.warnings);
    assert!(all > 0.2 && there > 0.9 * all, "{there} of {all} rad m at the thigh");
}

/// Garments that their boxes align are aligned by these as before.
#[test]
fn garments_of_one_cut_keep_their_boxes() {
    let (source, target) = (shirt(0.24, 0.62, 0.2, 0.2, false), shirt(0.3, 0.74, 0.24, 0.2, false));
    let worn = source.worn(|p| (p.x - 0.1).abs() < 0.03);
    let surface = GarmentSurface::without_texture(&target.garment);
    let options = TransferOptions::full(target.garment.points.len());
    let result = transfer(&[worn], &surface, &options).expect("transfers");
    assert_eq!(result.sources[0].aligned_by, Some(AlignedBy::Box));
}
