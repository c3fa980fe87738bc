//! Chains of hinges that go straight on from one another: the lines along which cloth was creased.

use crease_geometry::math::Vec3;
use crease_geometry::mesh::Topology;
use rustc_hash::FxHashMap;

/// Hinges that go straight on from one another.
#[derive(Debug, Clone, PartialEq)]
pub struct HingeChain {
    /// Points along it.
    pub points: Vec<u32>,
    /// Hinge between each two of them.
    pub hinges: Vec<u32>,
    /// Its length [m].
    pub length: f64,
}

impl HingeChain {
    /// Ends and hinge of every edge.
    pub fn edges(&self) -> impl Iterator<Item = (&[u32], &u32)> {
        self.points.windows(2).zip(&self.hinges)
    }

    /// All chains of the hinges `chosen` of a mesh over `points` [m], in which the cosine of the bend from one edge to the next is at
    /// least `min_cosine`. Every chosen hinge is in one chain.
    pub fn all(
        points: &[Vec3],
        topology: &Topology,
        chosen: impl Fn(usize) -> bool,
        min_cosine: f64,
    ) -> Vec<Self> {
        let mut at_point: FxHashMap<u32, Vec<u32>> = FxHashMap::default();
        let (mut edges, mut hinges) = (Vec::new(), Vec::new());
        for (h, hinge) in topology.hinges.iter().enumerate().filter(|(h, _)| chosen(*h)) {
            for p in &hinge.points[..2] {
                at_point.entry(p.0).or_default().push(edges.len() as u32);
            }
            edges.push([hinge.points[0].0, hinge.points[1].0]);
            hinges.push(h as u32);
        }
        let next = continuations(points, &edges, &at_point, min_cosine);
        let mut used = vec![false; edges.len()];
        let mut chains = Vec::new();
        for first in 0..edges.len() {
            if used[first] {
                continue;
            }
            used[first] = true;
            // From the second end on, then from the first: points, and the hinges after the first edge.
            let mut halves: [(Vec<u32>, Vec<u32>); 2] = Default::default();
            for ((along, beyond), end) in halves.iter_mut().zip([1, 0]) {
                let (mut edge, mut end) = (first, end);
                loop {
                    let point = edges[edge][end];
                    along.push(point);
                    let Some(other) = next[edge][end].filter(|other| !used[*other as usize]) else { break };
                    edge = other as usize;
                    used[edge] = true;
                    beyond.push(hinges[edge]);
                    end = usize::from(edges[edge][0] == point);
                }
            }
            let [(ahead, hinges_ahead), (back, hinges_back)] = halves;
            let along: Vec<u32> = back.into_iter().rev().chain(ahead).collect();
            let length = along
                .windows(2)
                .map(|ends| (points[ends[1] as usize] - points[ends[0] as usize]).norm())
                .sum();
            let hinges = hinges_back.into_iter().rev().chain([hinges[first]]).chain(hinges_ahead).collect();
            chains.push(Self { points: along, hinges, length });
        }
        chains
    }
}

/// Per edge and end: the edge that goes on there. At every point the straightest pairs are joined first.
fn continuations(
    points: &[Vec3],
    edges: &[[u32; 2]],
    at_point: &FxHashMap<u32, Vec<u32>>,
    min_cosine: f64,
) -> Vec<[Option<u32>; 2]> {
    let mut next = vec![[None; 2]; edges.len()];
    let mut places: Vec<&u32> = at_point.keys().collect();
    places.sort_unstable();
    for p in places {
        let own = &at_point[p];
        let outward = |e: u32| {
            let [a, b] = edges[e as usize];
            let other = if a == *p { b } else { a };
            (points[other as usize] - points[*p as usize]).try_normalize(0.0).unwrap_or_else(Vec3::zeros)
        };
        let mut pairs = Vec::new();
        for (i, &a) in own.iter().enumerate() {
            for &b in &own[i + 1..] {
                let cosine = -outward(a).dot(&outward(b));
                if cosine >= min_cosine {
                    pairs.push((cosine, a, b));
                }
            }
        }
        pairs.sort_by(|x, y| y.0.total_cmp(&x.0).then((x.1, x.2).cmp(&(y.1, y.2))));
        let end = |e: u32| usize::from(edges[e as usize][1] == *p);
        for (_, a, b) in pairs {
            if next[a as usize][end(a)].is_none() && next[b as usize][end(b)].is_none() {
                next[a as usize][end(a)] = Some(b);
                next[b as usize][end(b)] = Some(a);
            }
        }
    }
    next
}
