//! What of two triangles whose boxes overlap may really come near: boxes of single points and edges first, then distances.

use crate::contact::broad_phase::CandidateFinder;
use crate::math::Vec3;
use crate::mesh::distance::{edge_edge_squared, point_triangle_squared};

/// A mesh that meets itself, with its motion.
pub(super) struct Side<'a> {
    pub mesh: &'a CandidateFinder,
    pub start: &'a [Vec3],
    /// One per point: length of its way \[m\]; empty at rest.
    pub ways: &'a [f64],
    /// How near a pair may come to be found \[m\].
    pub reach: f64,
    /// The same for boxes.
    pub box_reach: f32,
    /// Ends of the ways, when all points go the same fraction of theirs.
    pub together: Option<&'a [Vec3]>,
}

impl Side<'_> {
    /// Whether the boxes are the same at both ends of the motion: they were swept along it, or nothing moves.
    #[inline(always)]
    pub fn rests(&self) -> bool {
        self.together.is_none()
    }

    /// Adds the points of `triangle` whose boxes are near triangle `other`.
    #[inline(always)]
    pub fn shortlist_points(&self, triangle: u32, other: u32, list: &mut Shortlist) {
        let other_box = &self.mesh.triangle_boxes[other as usize];
        list.make_room(3);
        for p in self.mesh.triangles[triangle as usize].points() {
            list.add_if(
                [p, other],
                self.mesh.point_boxes[p as usize].near(other_box, self.box_reach, self.rests()),
            );
        }
    }

    /// Adds the edges of `triangle` with the edges of triangle `other` whose boxes are near.
    #[inline(always)]
    pub fn shortlist_edges(&self, triangle: u32, other: u32, list: &mut Shortlist) {
        let others = &self.mesh.triangles[other as usize];
        list.make_room(9);
        for e in self.mesh.triangles[triangle as usize].edges() {
            let own_box = &self.mesh.edge_boxes[e as usize];
            for f in others.edges() {
                list.add_if(
                    [e, f],
                    own_box.near(&self.mesh.edge_boxes[f as usize], self.box_reach, self.rests()),
                );
            }
        }
    }

    /// Whether a point and a triangle can come near; a shared point excludes the pair.
    #[inline(always)]
    pub fn point_near(&self, point: u32, triangle: u32) -> bool {
        let corners = self.mesh.triangles[triangle as usize].corners;
        let squared = |[p]: [&Vec3; 1], [a, b, c]: [&Vec3; 3]| point_triangle_squared(p, a, b, c);
        !corners.contains(&point) && self.may_come_near([point], corners, squared)
    }

    /// Whether two edges can come near; a shared point excludes the pair.
    #[inline(always)]
    pub fn edge_near(&self, edge: u32, other: u32) -> bool {
        let (ends, others) = (self.mesh.edges[edge as usize], self.mesh.edges[other as usize]);
        let squared = |[a, b]: [&Vec3; 2], [c, d]: [&Vec3; 2]| edge_edge_squared(a, b, c, d);
        let shared = ends.iter().any(|p| others.contains(p));
        !shared && self.may_come_near(ends, others, squared)
    }

    /// Whether a pair can come within the reach: its distance now, less the longest way of a point on either side.
    /// That is a corner's, since inner points move by averages of corners. The two ways count apart and common motion
    /// is not deducted, because each point may in the end make another fraction of its way.
    #[inline(always)]
    fn may_come_near<const M: usize, const N: usize>(
        &self,
        own: [u32; M],
        others: [u32; N],
        squared: impl Fn([&Vec3; M], [&Vec3; N]) -> f64,
    ) -> bool {
        let limit = self.reach
            + match self.together {
                Some(end) => self.way_against(end, &own, &others),
                None => self.way(&own) + self.way(&others),
            };
        let x = own.map(|p| &self.start[p as usize]);
        let y = others.map(|p| &self.start[p as usize]);
        squared(x, y) <= limit * limit
    }

    /// The longest way of one of the points against one of the others \[m\], all going by the same fraction.
    #[inline(always)]
    fn way_against(&self, end: &[Vec3], own: &[u32], others: &[u32]) -> f64 {
        let mut longest: f64 = 0.0;
        for &p in own {
            let way = end[p as usize] - self.start[p as usize];
            for &q in others {
                let against = (way - (end[q as usize] - self.start[q as usize])).norm_squared();
                longest = longest.max(if against.is_finite() { against } else { 0.0 });
            }
        }
        longest.sqrt()
    }

    /// The longest way of these points \[m\].
    #[inline(always)]
    fn way(&self, points: &[u32]) -> f64 {
        if self.ways.is_empty() {
            return 0.0;
        }
        points.iter().map(|&p| self.ways[p as usize]).fold(0.0, f64::max)
    }
}

/// Pairs whose boxes are near, on their way to the exact test. Collected first and tested then, and added without
/// a branch, because which box test passes cannot be predicted and a wrong guess costs more than the test.
#[derive(Default)]
pub(super) struct Shortlist {
    pairs: Vec<[u32; 2]>,
    count: usize,
}

impl Shortlist {
    /// Room for that many calls of [`Shortlist::add_if`].
    #[inline(always)]
    fn make_room(&mut self, more: usize) {
        if self.count + more > self.pairs.len() {
            self.pairs.resize(2 * self.pairs.len() + more, [0; 2]);
        }
    }

    #[inline(always)]
    fn add_if(&mut self, pair: [u32; 2], yes: bool) {
        self.pairs[self.count] = pair;
        self.count += usize::from(yes);
    }

    /// The lower index of each pair first.
    pub fn ordered(&mut self) {
        self.pairs[..self.count]
            .iter_mut()
            .for_each(|pair| *pair = [pair[0].min(pair[1]), pair[0].max(pair[1])]);
    }

    /// Takes all pairs off the list, and gives those that pass the test.
    #[inline(always)]
    pub fn drain(&mut self, test: impl Fn(u32, u32) -> bool) -> Vec<[u32; 2]> {
        let mut kept = 0;
        for k in 0..std::mem::take(&mut self.count) {
            let pair = self.pairs[k];
            self.pairs[kept] = pair;
            kept += usize::from(test(pair[0], pair[1]));
        }
        self.pairs[..kept].to_vec()
    }
}

/// Merges the parts and sorts by both indices; the first is below `count`. Counting sort, then short runs.
pub(super) fn sorted(parts: &[Vec<[u32; 2]>], count: usize) -> Vec<[u32; 2]> {
    let mut ends = vec![0u32; count + 1];
    for &[first, _] in parts.iter().flatten() {
        ends[first as usize + 1] += 1;
    }
    for i in 0..count {
        ends[i + 1] += ends[i];
    }
    let mut merged = vec![[0u32; 2]; ends[count] as usize];
    let mut next = ends.clone();
    for pair in parts.iter().flatten() {
        let slot = &mut next[pair[0] as usize];
        merged[*slot as usize] = *pair;
        *slot += 1;
    }
    for run in ends.windows(2) {
        merged[run[0] as usize..run[1] as usize].sort_unstable_by_key(|pair| pair[1]);
    }
    merged
}
