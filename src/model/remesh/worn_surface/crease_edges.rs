//! Edges of the creases of a simulated mesh: the centre line of each, and the rows beside it, whose angle belongs to the crease.
//!
//! A fold bends the mesh along its line, along a row beside it, or along both in turn. The angle of an edge together with those that run
//! beside it, its net angle, does not depend on that. Cloth that bends evenly over all three has no crease, nor has a mesh that was made for folds any beside
//! the lines that were drawn for them: a wrinkle there does not run along edges, and is smooth. Edges are chained by their net
//! angle; the middle of a crease is the line with most of it. A crease is one curve: where its net angle is small for a short way, as where
//! it crosses another crease, it goes on along the edges of the mesh.

use crate::remesh::GarmentSurface;
use crate::remesh::hinge_chains::HingeChain;
use crate::remesh::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use rustc_hash::FxHashSet;
use std::ops::Range;

/// Part of an edge in a crease.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Part {
    None,
    Centre,
    Row,
}

/// Edges of the creases of a mesh.
#[derive(Debug)]
pub(super) struct CreaseEdges {
    /// Per hinge.
    part: Vec<Part>,
    /// Per hinge of a row: the hinge of a centre line that it belongs to.
    centre_of: Vec<Option<u32>>,
    /// Per triangle: whether it lies between a centre line and a row beside it.
    pub strip: Vec<bool>,
    /// Per centre line: its points, and the hinge between each two of them.
    pub lines: Vec<(Vec<u32>, Vec<u32>)>,
}

/// The hinges of a mesh that run beside one another.
struct ParallelEdges<'a> {
    mesh: &'a GarmentSurface,
    /// Per point: the hinges at it.
    at_point: Vec<Vec<u32>>,
}

impl CreaseEdges {
    /// Finds the creases of `mesh` among its hinges, whose rest angles changed by `changes` [rad].
    pub fn find(mesh: &GarmentSurface, changes: &[f64]) -> Self {
        let beside = ParallelEdges::new(mesh);
        let parts: Vec<[f64; 3]> = (0..changes.len()).map(|h| beside.parts(h, |g| changes[g])).collect();
        let net: Vec<f64> = parts.iter().map(|parts| parts.iter().sum()).collect();
        let is_concentrated = |h: usize| {
            let most = parts[h].iter().fold(0.0, |most: f64, part| most.max(part.abs()));
            most >= TUNING.min_crease_concentration * net[h].abs()
        };
        let is_folded = |h: usize| {
            let on = |p: &PointIndex| mesh.on_fold_line.as_ref().is_none_or(|on| on[p.at()]);
            mesh.topology.hinges[h].points[..2].iter().all(on)
        };
        let strong = |h: usize| is_folded(h) && net[h].abs() >= TUNING.min_crease_angle && is_concentrated(h);
        let mut chains = HingeChain::all(&mesh.points, &mesh.topology, strong, TUNING.min_crease_cosine);
        chains.retain(|chain| chain.length >= TUNING.min_crease_length);
        // Edges beside count half: where the cloth bends along a row alone, that is the middle.
        let weight = |chain: &HingeChain| -> f64 {
            let each = chain.hinges.iter().map(|h| *h as usize);
            each.map(|h| beside.length(h) * 0.5 * (net[h] + changes[h]).abs()).sum()
        };
        let traced = |chain| beside.traced(chain, strong);
        let mut ranked: Vec<(f64, HingeChain)> =
            chains.into_iter().map(traced).map(|c| (weight(&c), c)).collect();
        ranked.sort_by(|a, b| b.0.total_cmp(&a.0).then_with(|| a.1.points.cmp(&b.1.points)));
        let count = changes.len();
        let mut found = Self {
            part: vec![Part::None; count],
            centre_of: vec![None; count],
            strip: Vec::new(),
            lines: Vec::new(),
        };
        for (_, chain) in &ranked {
            found.add(chain, &beside, changes);
        }
        found.strip = strip_triangles(mesh, &found.part);
        found
    }

    /// Takes the runs of `chain` that are left by stronger ones as centre lines, with the rows beside them.
    fn add(&mut self, chain: &HingeChain, beside: &ParallelEdges, changes: &[f64]) {
        for run in self.runs_left(chain, beside, changes) {
            let hinges = &chain.hinges[run.clone()];
            for h in hinges {
                self.part[*h as usize] = Part::Centre;
                self.centre_of[*h as usize] = None;
            }
            for h in hinges {
                for row in beside.sides(*h as usize).into_iter().flatten().map(|row| row as usize) {
                    if self.part[row] == Part::Centre {
                        continue;
                    }
                    self.part[row] = Part::Row;
                    let nearer = |other: u32| beside.distance(row, *h) < beside.distance(row, other);
                    if self.centre_of[row].is_none_or(nearer) {
                        self.centre_of[row] = Some(*h);
                    }
                }
            }
            self.lines.push((chain.points[run.start..=run.end].to_vec(), hinges.to_vec()));
        }
    }

    /// The runs of hinges of `chain` that are in no crease and beside none, from strong hinge to strong hinge.
    fn runs_left(&self, chain: &HingeChain, beside: &ParallelEdges, changes: &[f64]) -> Vec<Range<usize>> {
        let free = |g: usize| if self.part[g] == Part::None { changes[g] } else { 0.0 };
        // A second line of the same fold: beside a row of a stronger one, and bent to the same side.
        let is_taken = |g: u32, net: f64| match self.part[g as usize] {
            Part::None => false,
            Part::Centre => true,
            Part::Row => self.centre_of[g as usize].is_some_and(|c| net * changes[c as usize] > 0.0),
        };
        let mut runs = Vec::new();
        // Of the run so far: the range from its first to its last strong hinge, and the length of the strong ones [m].
        let mut run: Option<(Range<usize>, f64)> = None;
        let mut close = |run: Option<(Range<usize>, f64)>| {
            runs.extend(run.filter(|(_, length)| *length >= TUNING.min_crease_length).map(|(run, _)| run));
        };
        for (k, h) in chain.hinges.iter().map(|h| *h as usize).enumerate() {
            let net = beside.net(h, free);
            if self.part[h] != Part::None || beside.sides(h).into_iter().flatten().any(|g| is_taken(g, net)) {
                close(run.take());
            } else if net.abs() >= TUNING.min_crease_angle {
                let (range, length) = run.take().unwrap_or((k..k, 0.0));
                run = Some((range.start..k + 1, length + beside.length(h)));
            }
        }
        close(run);
        runs
    }

    /// Per hinge on a centre line: its change among `changes` [rad], with those of the rows beside it by their length; 0 for others.
    pub fn net_angles(&self, mesh: &GarmentSurface, changes: &[f64]) -> Vec<f64> {
        let length = |h: usize| {
            let [a, b, ..] = mesh.topology.hinges[h].points.map(|p| mesh.points[p.at()]);
            (b - a).norm()
        };
        let mut net = vec![0.0; changes.len()];
        self.centre_hinges().for_each(|h| net[h] = changes[h]);
        for (row, h) in self.rows() {
            net[h] += changes[row] * length(row) / length(h);
        }
        net
    }

    /// Every hinge of a row, with the hinge of a centre line that it belongs to.
    pub fn rows(&self) -> impl Iterator<Item = (usize, usize)> {
        let centre = |(row, centre): (usize, &Option<u32>)| centre.map(|h| (row, h as usize));
        self.centre_of.iter().enumerate().filter_map(centre)
    }

    /// Whether hinge `h` is on a centre line.
    pub fn is_centre(&self, h: usize) -> bool {
        self.part[h] == Part::Centre
    }

    /// The hinges on centre lines.
    pub fn centre_hinges(&self) -> impl Iterator<Item = usize> {
        (0..self.part.len()).filter(|h| self.is_centre(*h))
    }
}

impl<'a> ParallelEdges<'a> {
    fn new(mesh: &'a GarmentSurface) -> Self {
        let mut at_point: Vec<Vec<u32>> = vec![Vec::new(); mesh.points.len()];
        for (h, hinge) in mesh.topology.hinges.iter().enumerate() {
            hinge.points[..2].iter().for_each(|p| at_point[p.at()].push(h as u32));
        }
        Self { mesh, at_point }
    }

    fn ends(&self, h: usize) -> [Vec3; 2] {
        let [a, b, ..] = self.mesh.topology.hinges[h].points.map(|p| self.mesh.points[p.at()]);
        [a, b]
    }

    /// Length of hinge `h` [m].
    fn length(&self, h: usize) -> f64 {
        let [a, b] = self.ends(h);
        (b - a).norm()
    }

    /// Distance between the middles of two hinges [m].
    fn distance(&self, h: usize, g: u32) -> f64 {
        let [[a, b], [c, d]] = [self.ends(h), self.ends(g as usize)];
        0.5 * (a + b - c - d).norm()
    }

    /// The hinges beside hinge `h`, on either side: those about parallel to it at the opposite corner of its triangle, if that is near.
    fn sides(&self, h: usize) -> [Vec<u32>; 2] {
        let [a, b] = self.ends(h);
        let [.., c, d] = self.mesh.topology.hinges[h].points;
        let Some(own) = (b - a).try_normalize(0.0) else { return [Vec::new(), Vec::new()] };
        [c, d].map(|p| {
            if own.cross(&(self.mesh.points[p.at()] - a)).norm() >= TUNING.max_row_distance {
                return Vec::new();
            }
            let is_parallel = |g: &u32| {
                let [a, b] = self.ends(*g as usize);
                (b - a).try_normalize(0.0).is_some_and(|g| g.dot(&own).abs() > TUNING.min_row_cosine)
            };
            self.at_point[p.at()].iter().copied().filter(is_parallel).collect()
        })
    }

    /// `chain`, continued straight on from both ends as long as `strong` hinges follow before long.
    fn traced(&self, chain: HingeChain, strong: impl Fn(usize) -> bool) -> HingeChain {
        let HingeChain { mut points, mut hinges, .. } = chain;
        for _ in 0..2 {
            let (more_points, more_hinges) = self.beyond(&points, &hinges, &strong);
            points.extend(more_points);
            hinges.extend(more_hinges);
            points.reverse();
            hinges.reverse();
        }
        let length = hinges.iter().map(|h| self.length(*h as usize)).sum();
        HingeChain { points, hinges, length }
    }

    /// Points and hinges by which [`Self::traced`] continues a chain beyond its last point.
    fn beyond(&self, points: &[u32], hinges: &[u32], strong: impl Fn(usize) -> bool) -> (Vec<u32>, Vec<u32>) {
        let (mut more_points, mut more_hinges) = (Vec::new(), Vec::new());
        let [.., mut from, mut at] = *points else { return (more_points, more_hinges) };
        let mut used: FxHashSet<u32> = hinges.iter().copied().collect();
        let (mut gap, mut kept) = (0.0, 0);
        while gap < TUNING.max_crease_gap {
            let x = |p: u32| self.mesh.points[p as usize];
            let Some(ahead) = (x(at) - x(from)).try_normalize(0.0) else { break };
            let next = self.at_point[at as usize].iter().filter(|h| !used.contains(h)).map(|h| {
                let [a, b, ..] = self.mesh.topology.hinges[*h as usize].points;
                let to = if a.0 == at { b.0 } else { a.0 };
                let cosine = (x(to) - x(at)).try_normalize(0.0).map_or(-1.0, |onward| onward.dot(&ahead));
                (cosine, *h, to)
            });
            let Some((cosine, h, to)) = next.max_by(|a, b| a.0.total_cmp(&b.0).then(b.1.cmp(&a.1))) else {
                break;
            };
            if cosine < TUNING.min_traced_cosine {
                break;
            }
            used.insert(h);
            more_points.push(to);
            more_hinges.push(h);
            if strong(h as usize) {
                (gap, kept) = (0.0, more_hinges.len());
            } else {
                gap += self.length(h as usize);
            }
            (from, at) = (at, to);
        }
        more_points.truncate(kept);
        more_hinges.truncate(kept);
        (more_points, more_hinges)
    }

    /// The angle `change` of hinge `h` with the mean of those beside it on either side.
    fn net(&self, h: usize, change: impl Fn(usize) -> f64) -> f64 {
        self.parts(h, change).into_iter().sum()
    }

    /// The angle `change` of hinge `h`, and the mean of those beside it on either side.
    fn parts(&self, h: usize, change: impl Fn(usize) -> f64) -> [f64; 3] {
        let of_side = |side: Vec<u32>| {
            let (mut sum, mut length) = (0.0, 0.0);
            for g in side.into_iter().map(|g| g as usize) {
                sum += change(g) * self.length(g);
                length += self.length(g);
            }
            if length > 0.0 { sum / length } else { 0.0 }
        };
        let [left, right] = self.sides(h).map(of_side);
        [change(h), left, right]
    }
}

/// Triangles between a centre line and a row beside it.
fn strip_triangles(mesh: &GarmentSurface, part: &[Part]) -> Vec<bool> {
    let mut on = vec![[false; 2]; mesh.points.len()];
    for (hinge, part) in mesh.topology.hinges.iter().zip(part) {
        let k = match part {
            Part::None => continue,
            Part::Centre => 0,
            Part::Row => 1,
        };
        hinge.points[..2].iter().for_each(|p| on[p.at()][k] = true);
    }
    let between = |t: &[crease_geometry::mesh::PointIndex; 3]| {
        let on = t.map(|p| on[p.at()]);
        on.iter().all(|[centre, row]| *centre || *row)
            && on.iter().any(|[centre, _]| *centre)
            && on.iter().any(|[centre, row]| *row && !*centre)
    };
    mesh.triangles.iter().map(between).collect()
}
