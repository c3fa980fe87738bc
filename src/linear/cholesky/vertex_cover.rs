//! Minimum vertex cover of a bipartite graph.
//!
//! A maximum matching by augmenting paths (Kuhn's method after a greedy start: the graphs are the couplings across one
//! plane, a few hundred nodes) gives a minimum vertex cover by Koenig's theorem. Without recursion, as paths may be
//! long.

use crate::block_matrix::INVALID;

/// Returns for each left and each right node whether it is in a minimum vertex cover. The neighbours of left node i are
/// the right nodes `across[start[i]..start[i + 1]]`.
pub fn minimum_vertex_cover(start: &[u32], across: &[u32], right_count: usize) -> (Vec<bool>, Vec<bool>) {
    let graph = Graph { start, across };
    let left_count = start.len() - 1;
    let mut matching = Matching { of_left: vec![INVALID; left_count], of_right: vec![INVALID; right_count] };
    for i in 0..left_count as u32 {
        if let Some(&j) = graph.of(i).iter().find(|&&j| matching.of_right[j as usize] == INVALID) {
            matching.join(i, j);
        }
    }
    let mut seen = vec![INVALID; right_count];
    for i in 0..left_count as u32 {
        if matching.of_left[i as usize] == INVALID {
            matching.augment(graph, i, &mut seen);
        }
    }
    // The cover is the left nodes that no alternating path from an unmatched left node reaches, and the right ones
    // reached.
    let mut left: Vec<bool> = matching.of_left.iter().map(|&j| j != INVALID).collect();
    let mut right = vec![false; right_count];
    let mut open: Vec<u32> = (0..left_count as u32).filter(|&i| !left[i as usize]).collect();
    while let Some(i) = open.pop() {
        for &j in graph.of(i) {
            if !std::mem::replace(&mut right[j as usize], true) {
                let back = matching.of_right[j as usize];
                if back != INVALID && std::mem::replace(&mut left[back as usize], false) {
                    open.push(back);
                }
            }
        }
    }
    (left, right)
}

#[derive(Clone, Copy)]
struct Graph<'a> {
    start: &'a [u32],
    across: &'a [u32],
}

impl<'a> Graph<'a> {
    fn of(&self, i: u32) -> &'a [u32] {
        &self.across[self.start[i as usize] as usize..self.start[i as usize + 1] as usize]
    }
}

struct Matching {
    of_left: Vec<u32>,
    of_right: Vec<u32>,
}

impl Matching {
    fn join(&mut self, i: u32, j: u32) {
        self.of_left[i as usize] = j;
        self.of_right[j as usize] = i;
    }

    /// Finds an augmenting path from the unmatched left node `root` and flips it. `seen` is the last root of every
    /// right node.
    fn augment(&mut self, graph: Graph, root: u32, seen: &mut [u32]) {
        // Left nodes on the path and the number of edges tried of each.
        let mut path = vec![(root, 0)];
        while let Some((i, tried)) = path.last_mut() {
            let Some(&j) = graph.of(*i).get(*tried) else {
                path.pop();
                continue;
            };
            *tried += 1;
            if std::mem::replace(&mut seen[j as usize], root) == root {
                continue;
            }
            let next = self.of_right[j as usize];
            if next != INVALID {
                path.push((next, 0));
                continue;
            }
            for &(i, tried) in &path {
                self.join(i, graph.of(i)[tried - 1]);
            }
            return;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crease_geometry::math::Rng;

    #[test]
    fn covers_are_minimal() {
        // Random graphs of five and five nodes against all 1024 subsets.
        let mut rng = Rng::from_state(7);
        for _ in 0..200 {
            let (mut start, mut across) = (vec![0], Vec::new());
            for _ in 0..5 {
                for j in 0..5 {
                    if rng.next_u64() >> 62 == 0 {
                        across.push(j);
                    }
                }
                start.push(across.len() as u32);
            }
            let edges: Vec<(usize, usize)> = (0..5)
                .flat_map(|i| {
                    across[start[i] as usize..start[i + 1] as usize].iter().map(move |&j| (i, j as usize))
                })
                .collect();
            let covers = |set: u32| edges.iter().all(|(i, j)| set >> i & 1 == 1 || set >> (5 + j) & 1 == 1);
            let minimum = (0..1024u32).filter(|&s| covers(s)).map(u32::count_ones).min().unwrap();
            let (left, right) = minimum_vertex_cover(&start, &across, 5);
            let chosen = left.iter().chain(&right).enumerate().map(|(k, &c)| u32::from(c) << k).sum();
            assert!(covers(chosen), "an edge is not covered");
            assert_eq!(chosen.count_ones(), minimum);
        }
    }
}
