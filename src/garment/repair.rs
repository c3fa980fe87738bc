//! Repairs of an imported triangle list that are safe to make unasked: copies of triangles, triangles without area,
//! and triangles that show the wrong side. Every repair is counted in a finding. Moves no point.

use crate::garment::build::ImportDiagnostics;
use crate::math::{Vec2, Vec3};
use crate::mesh::{PointIndex, Topology, Welder};
use rustc_hash::FxHashMap;
use std::collections::VecDeque;

/// A triangle lower than this part of its longest side has no area to speak of.
const CAP_HEIGHT: f64 = 1e-5;
/// Rounds of cap mending: a row of caps side by side needs several.
const CAP_ROUNDS: usize = 8;
/// Texture coordinates closer than this are the same.
const SAME_UV: f64 = 1e-6;

/// A triangle between points, and the file vertices at its corners unless a repair mixed several triangles'.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Corners {
    pub(super) points: [PointIndex; 3],
    pub(super) vertices: Option<[u32; 3]>,
}

/// Leaves out triangles that lie exactly on an earlier one, and joins their vertices to that one's: exact repeats,
/// and the inner side of meshes modelled with two sides. Triangles with other texture coordinates are another layer.
pub(super) fn drop_copies(
    triangles: &[[u32; 3]],
    uvs: &[Option<Vec2>],
    welder: &mut Welder,
    findings: &mut ImportDiagnostics,
) -> Vec<[u32; 3]> {
    let mut first_on: FxHashMap<[u32; 3], [u32; 3]> = FxHashMap::default();
    let mut kept = Vec::with_capacity(triangles.len());
    for &triangle in triangles {
        let mut sorted = triangle;
        sorted.sort_unstable_by_key(|&v| (welder.site(v), v));
        let sites = sorted.map(|v| welder.site(v));
        if sites[0] == sites[1] || sites[1] == sites[2] {
            kept.push(triangle);
            continue;
        }
        let same_uv = |(a, b): (&u32, &u32)| match (uvs[*a as usize], uvs[*b as usize]) {
            (Some(p), Some(q)) => (p - q).norm() <= SAME_UV,
            (None, None) => true,
            _ => false,
        };
        match first_on.get(&sites) {
            Some(first) if first.iter().zip(&sorted).all(same_uv) => {
                first.iter().zip(&sorted).for_each(|(&a, &b)| welder.join(a, b));
            }
            Some(_) => kept.push(triangle),
            None => {
                first_on.insert(sites, sorted);
                kept.push(triangle);
            }
        }
    }
    findings.repaired(triangles.len() - kept.len(), "copies of triangles dropped");
    kept
}

/// Mends triangles without area. Such a cap has a corner on its longest side; simply dropped, the cloth would be slit
/// along that side. So the side is turned: cap (a, c, b) and its neighbour (a, b, d) become (a, c, d) and (c, b, d).
/// A cap on the border is dropped, and so is one whose side cannot be turned; then repeats of triangles are dropped.
pub(super) fn mend_caps(positions: &[Vec3], corners: &mut Vec<Corners>, findings: &mut ImportDiagnostics) {
    let mut turned_count = 0;
    for _ in 0..CAP_ROUNDS {
        let turned = turn_caps(positions, corners);
        turned_count += turned;
        if turned == 0 {
            break;
        }
    }
    findings.repaired(turned_count, "triangles without area mended by turning an edge");
    let before = corners.len();
    corners.retain(|c| cap_side(positions, c).is_none());
    findings.repaired(before - corners.len(), "triangles without area dropped");
    let before = corners.len();
    let mut known: FxHashMap<[PointIndex; 3], ()> = FxHashMap::default();
    corners.retain(|c| {
        let mut sorted = c.points;
        sorted.sort_unstable();
        known.insert(sorted, ()).is_none()
    });
    findings.repaired(before - corners.len(), "triangles with the same corners as another dropped");
}

/// The number of the longest side (from corner k to k + 1) of a triangle without area; `None` if it has some.
fn cap_side(positions: &[Vec3], c: &Corners) -> Option<usize> {
    let p = c.points.map(|point| positions[point.at()]);
    let length = |k: usize| (p[(k + 1) % 3] - p[k]).norm();
    let longest = (0..3).max_by(|&i, &j| length(i).total_cmp(&length(j)))?;
    let height = (p[1] - p[0]).cross(&(p[2] - p[0])).norm() / length(longest);
    // A triangle of no size at all has no height either (not a number), and counts as a cap.
    let has_area = height > CAP_HEIGHT * length(longest);
    (!has_area).then_some(longest)
}

/// One round over all caps; gives the number of sides turned.
fn turn_caps(positions: &[Vec3], corners: &mut [Corners]) -> usize {
    let caps: Vec<(usize, usize)> =
        corners.iter().enumerate().filter_map(|(t, c)| Some((t, cap_side(positions, c)?))).collect();
    if caps.is_empty() {
        return 0;
    }
    let mut on_edge: FxHashMap<[PointIndex; 2], Vec<usize>> = FxHashMap::default();
    for (t, c) in corners.iter().enumerate() {
        for k in 0..3 {
            on_edge.entry(edge(c.points[k], c.points[(k + 1) % 3])).or_default().push(t);
        }
    }
    let mut touched = vec![false; corners.len()];
    let mut turned = 0;
    for (t, k) in caps {
        let [a, b, c] = [0, 1, 2].map(|i| corners[t].points[(k + i) % 3]);
        let others = on_edge.get(&edge(a, b)).map_or(&[][..], Vec::as_slice);
        let &[first, second] = others else { continue };
        let other = if first == t { second } else { first };
        let Some(j) = (0..3)
            .find(|&j| edge(corners[other].points[j], corners[other].points[(j + 1) % 3]) == edge(a, b))
        else {
            continue;
        };
        let [p, q, d] = [0, 1, 2].map(|i| corners[other].points[(j + i) % 3]);
        if touched[t] || touched[other] || d == c || on_edge.contains_key(&edge(c, d)) {
            continue;
        }
        corners[other] = Corners { points: [p, c, d], vertices: None };
        corners[t] = Corners { points: [c, q, d], vertices: None };
        (touched[t], touched[other]) = (true, true);
        on_edge.entry(edge(c, d)).or_default();
        turned += 1;
    }
    turned
}

fn edge(a: PointIndex, b: PointIndex) -> [PointIndex; 2] {
    if a < b { [a, b] } else { [b, a] }
}

/// Turns triangles so that neighbours agree on the side they show, the smaller number of each sheet giving way.
/// Only edges with two triangles tell; a strip with half a twist keeps edges that disagree.
pub(super) fn turn_alike(point_count: usize, corners: &mut [Corners], findings: &mut ImportDiagnostics) {
    let triangles: Vec<[PointIndex; 3]> = corners.iter().map(|c| c.points).collect();
    let topology = Topology::new(point_count, &triangles);
    if topology.misoriented.is_empty() {
        return;
    }
    let mut disagrees = vec![false; topology.edges.len()];
    topology.misoriented.iter().for_each(|&e| disagrees[e as usize] = true);
    let mut turned: Vec<Option<bool>> = vec![None; corners.len()];
    let mut turned_count = 0;
    for start in 0..corners.len() {
        if turned[start].is_some() {
            continue;
        }
        let sheet = walk_sheet(start, &topology, &disagrees, &mut turned);
        let wrong = sheet.iter().filter(|&&t| turned[t] == Some(true)).count();
        let give_way = 2 * wrong <= sheet.len();
        for t in sheet {
            if turned[t] == Some(give_way) {
                flip(&mut corners[t]);
                turned_count += 1;
            }
        }
    }
    findings.repaired(turned_count, "triangles turned to show the same side as their neighbours");
}

/// The triangles connected to `start` over edges with two triangles; notes in `turned` who differs from `start`.
fn walk_sheet(
    start: usize,
    topology: &Topology,
    disagrees: &[bool],
    turned: &mut [Option<bool>],
) -> Vec<usize> {
    let mut sheet = Vec::new();
    let mut queue = VecDeque::from([(start, false)]);
    turned[start] = Some(false);
    while let Some((t, side)) = queue.pop_front() {
        sheet.push(t);
        for &e in &topology.triangle_edges[t] {
            let e = e as usize;
            if topology.edge_valence[e] != 2 {
                continue;
            }
            let [first, second] = topology.edge_triangles[e];
            let other = if first as usize == t { second } else { first } as usize;
            if turned[other].is_none() {
                turned[other] = Some(side ^ disagrees[e]);
                queue.push_back((other, side ^ disagrees[e]));
            }
        }
    }
    sheet
}

fn flip(c: &mut Corners) {
    c.points.swap(1, 2);
    if let Some(vertices) = &mut c.vertices {
        vertices.swap(1, 2);
    }
}
