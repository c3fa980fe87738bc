//! Orientation of triangle meshes: neighbours that agree, and triangles counter-clockwise seen from outside.
//!
//! A sheet is a set of triangles connected over edges with two triangles. Within a sheet the minority of opposite orientation
//! is flipped. Which side of a sheet is outside follows from the volume that it encloses: its openings are closed by fans of
//! triangles about the centroid of their border, and a negative volume means that the triangles face inwards. A sheet that
//! is mostly opening (a curved patch, a bowl) or encloses next to nothing (two layers, a plane) has no outside.

use crate::math::Vec3;
use crate::mesh::tuning::TUNING;
use crate::mesh::{Groups, PointIndex, Topology, triangle};
use rustc_hash::FxHashMap;
use std::collections::VecDeque;

/// Triangles connected over edges with two triangles.
#[derive(Debug, Clone)]
pub struct OrientedSheet {
    /// Numbers of its triangles.
    pub triangles: Vec<usize>,
    /// Numbers of those whose orientation differs from that of the majority.
    pub minority: Vec<usize>,
}

/// Returns the sheets of a mesh.
pub fn oriented_sheets(topology: &Topology) -> Vec<OrientedSheet> {
    let count = topology.triangle_edges.len();
    let mut disagrees = vec![false; topology.edges.len()];
    topology.misoriented.iter().for_each(|&e| disagrees[e as usize] = true);
    let mut differs: Vec<Option<bool>> = vec![None; count];
    let mut sheets = Vec::new();
    for start in 0..count {
        if differs[start].is_some() {
            continue;
        }
        let triangles = connected_sheet(start, topology, &disagrees, &mut differs);
        let differing = triangles.iter().filter(|&&t| differs[t] == Some(true)).count();
        let is_minority = 2 * differing <= triangles.len();
        let minority = triangles.iter().copied().filter(|&t| differs[t] == Some(is_minority)).collect();
        sheets.push(OrientedSheet { triangles, minority });
    }
    sheets
}

/// Returns the triangles connected to `start` over edges with two triangles; sets in `differs` whether the orientation
/// of each differs from that of `start`.
fn connected_sheet(
    start: usize,
    topology: &Topology,
    disagrees: &[bool],
    differs: &mut [Option<bool>],
) -> Vec<usize> {
    let mut sheet = Vec::new();
    let mut queue = VecDeque::from([(start, false)]);
    differs[start] = Some(false);
    while let Some((t, side)) = queue.pop_front() {
        sheet.push(t);
        for &e in &topology.triangle_edges[t] {
            let e = e as usize;
            if topology.edge_valence[e] != 2 {
                continue;
            }
            let [first, second] = topology.edge_triangles[e];
            let other = if first as usize == t { second } else { first } as usize;
            if differs[other].is_none() {
                differs[other] = Some(side ^ disagrees[e]);
                queue.push_back((other, side ^ disagrees[e]));
            }
        }
    }
    sheet
}

/// Returns the volume that consistently oriented `triangles` enclose [unit of `points`, cubed], negative if they face
/// inwards; `None` where a sheet has no outside.
pub fn enclosed_volume(points: &[Vec3], triangles: &[[PointIndex; 3]]) -> Option<f64> {
    let corner = |p: PointIndex| points.get(p.at()).copied().unwrap_or_default();
    let origin = corner(triangles.first()?[0]);
    let (mut volume, mut area) = (0.0, 0.0);
    for t in triangles {
        let corners = t.map(corner);
        volume += signed_volume(&origin, &corners);
        area += triangle::area(&corners);
    }
    let caps = opening_caps(points, triangles);
    let opening: f64 = caps.iter().map(triangle::area).sum();
    volume += caps.iter().map(|cap| signed_volume(&origin, cap)).sum::<f64>();
    let is_closed = opening <= TUNING.max_opening_fraction * area;
    let is_solid = volume.abs() > TUNING.min_volume_fraction * area * area.sqrt();
    (is_closed && is_solid).then_some(volume)
}

/// Returns triangles that close the openings of consistently oriented `triangles`.
fn opening_caps(points: &[Vec3], triangles: &[[PointIndex; 3]]) -> Vec<[Vec3; 3]> {
    let mut open: FxHashMap<[PointIndex; 2], u32> = FxHashMap::default();
    let sides = |t: &[PointIndex; 3]| [[t[0], t[1]], [t[1], t[2]], [t[2], t[0]]];
    for side in triangles.iter().flat_map(sides) {
        match open.get_mut(&[side[1], side[0]]) {
            Some(count) if *count > 0 => *count -= 1,
            _ => *open.entry(side).or_default() += 1,
        }
    }
    // The order of a hash map must not decide the order of a sum.
    let mut border: Vec<[PointIndex; 2]> =
        open.into_iter().filter(|(_, count)| *count > 0).map(|(side, _)| side).collect();
    border.sort_unstable();
    let mut ends: Vec<PointIndex> = border.iter().flatten().copied().collect();
    ends.sort_unstable();
    ends.dedup();
    let number = |p: PointIndex| ends.binary_search(&p).unwrap_or(0);
    let mut groups = Groups::new(ends.len());
    border.iter().for_each(|[a, b]| groups.join(number(*a) as u32, number(*b) as u32));
    let (loop_of, loops) = groups.numbered();
    let position = |p: PointIndex| points.get(p.at()).copied().unwrap_or_default();
    let mut centroids = vec![(Vec3::zeros(), 0.0); loops];
    for [a, _] in &border {
        let (sum, count) = &mut centroids[loop_of[number(*a)].at()];
        *sum += position(*a);
        *count += 1.0;
    }
    let cap = |[a, b]: &[PointIndex; 2]| {
        let (sum, count) = centroids[loop_of[number(*a)].at()];
        [position(*b), position(*a), sum / count]
    };
    border.iter().map(cap).collect()
}

/// Returns the signed volume of the tetrahedron of `corners` and `origin`.
fn signed_volume(origin: &Vec3, corners: &[Vec3; 3]) -> f64 {
    let [a, b, c] = corners.map(|p| p - origin);
    a.dot(&b.cross(&c)) / 6.0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A cylinder of radius 1 and height 4 along y, open at both ends, facing outwards.
    fn tube(around: u32) -> (Vec<Vec3>, Vec<[PointIndex; 3]>) {
        let at = |k: u32| std::f64::consts::TAU * f64::from(k % around) / f64::from(around);
        let ring = |y: f64| (0..around).map(move |k| Vec3::new(at(k).sin(), y, at(k).cos()));
        let points = ring(0.0).chain(ring(4.0)).collect();
        let square = |k: u32| {
            let (a, b) = (k, (k + 1) % around);
            [[a, b, b + around], [a, b + around, a + around]].map(|t| t.map(PointIndex))
        };
        (points, (0..around).flat_map(square).collect())
    }

    fn inverted(triangles: &[[PointIndex; 3]]) -> Vec<[PointIndex; 3]> {
        triangles.iter().map(|[a, b, c]| [*a, *c, *b]).collect()
    }

    /// The closed prism over a regular polygon of n corners has the volume 4 (n / 2) sin(2 pi / n).
    #[test]
    fn an_open_tube_encloses_its_volume() {
        let (points, triangles) = tube(24);
        let expected = 4.0 * 12.0 * (std::f64::consts::TAU / 24.0).sin();
        let volume = enclosed_volume(&points, &triangles).expect("has an outside");
        assert!((volume - expected).abs() < 1e-12, "{volume} {expected}");
        let volume = enclosed_volume(&points, &inverted(&triangles)).expect("has an outside");
        assert!((volume + expected).abs() < 1e-12, "{volume}");
    }

    #[test]
    fn patches_and_planes_have_no_outside() {
        let (points, triangles) = tube(24);
        assert_eq!(enclosed_volume(&points, &triangles[..20]), None, "a curved patch");
        let flat: Vec<Vec3> = points.iter().map(|p| Vec3::new(p.x, p.y, 0.0)).collect();
        assert_eq!(enclosed_volume(&flat, &triangles), None, "two layers");
        assert_eq!(enclosed_volume(&points, &[]), None);
    }

    #[test]
    fn the_minority_of_a_sheet_is_named() {
        let (points, mut triangles) = tube(24);
        triangles[5].swap(0, 1);
        triangles[30].swap(0, 1);
        let sheets = oriented_sheets(&Topology::new(points.len(), &triangles));
        assert_eq!(sheets.len(), 1);
        let mut minority = sheets[0].minority.clone();
        minority.sort_unstable();
        assert_eq!(minority, [5, 30]);
    }
}
