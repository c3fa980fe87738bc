//! Candidate pairs of primitives, as sorted lists.

use rayon::prelude::*;

/// Pairs that one task filters.
const PAIRS_PER_TASK: usize = 512;

/// Pairs of primitives of one mesh that may come near.
#[derive(Debug, Clone, Default, PartialEq, Eq)]
pub struct Candidates {
    /// (point, triangle), sorted.
    pub point_triangle: Vec<[u32; 2]>,
    /// (edge, edge), lower first, sorted.
    pub edge_edge: Vec<[u32; 2]>,
}

impl Candidates {
    /// Whether there is no pair.
    pub fn is_empty(&self) -> bool {
        self.point_triangle.is_empty() && self.edge_edge.is_empty()
    }

    /// Returns the number of pairs.
    pub fn len(&self) -> usize {
        self.point_triangle.len() + self.edge_edge.len()
    }

    /// Returns the pairs for which `point`, of point-triangle pairs, and `edge`, of edge-edge pairs, is true.
    pub fn filter(
        &self,
        point: impl Fn([u32; 2]) -> bool + Sync,
        edge: impl Fn([u32; 2]) -> bool + Sync,
    ) -> Self {
        Self {
            point_triangle: filtered(&self.point_triangle, point),
            edge_edge: filtered(&self.edge_edge, edge),
        }
    }

    /// Returns the union with `other`, which has no common pair.
    pub fn union(self, other: Self) -> Self {
        Self {
            point_triangle: merged(self.point_triangle, other.point_triangle),
            edge_edge: merged(self.edge_edge, other.edge_edge),
        }
    }
}

/// Returns the pairs of a list for which `keep` is true, in order.
fn filtered(list: &[[u32; 2]], keep: impl Fn([u32; 2]) -> bool + Sync) -> Vec<[u32; 2]> {
    list.par_iter().with_min_len(PAIRS_PER_TASK).copied().filter(|pair| keep(*pair)).collect()
}

/// Merges two sorted lists without common entries.
fn merged(first: Vec<[u32; 2]>, second: Vec<[u32; 2]>) -> Vec<[u32; 2]> {
    let mut all = Vec::with_capacity(first.len() + second.len());
    let mut second = second.into_iter().peekable();
    for pair in first {
        while let Some(other) = second.next_if(|other| *other < pair) {
            all.push(other);
        }
        all.push(pair);
    }
    all.extend(second);
    all
}

/// Merges `parts` and sorts by both indices, the first of which is below `count`: counting sort, then short runs.
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
