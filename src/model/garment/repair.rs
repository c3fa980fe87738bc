//! Repairs of an imported triangle list that are safe to make unasked: duplicate triangles, triangles without area, and
//! inconsistent orientation. Every repair is counted in a diagnostic. Moves no point.

use crate::garment::diagnostic::ImportDiagnostics;
use crate::garment::tuning::TUNING;
use crate::garment::wedges::TriangleWedges;
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::orientation::{OrientedSheet, enclosed_volume, oriented_sheets};
use crease_geometry::mesh::{Groups, PointIndex, Topology, Welder, edge_key, triangle};
use rustc_hash::{FxHashMap, FxHashSet};

/// Removes triangles that coincide with an earlier one, and joins their vertices to that one's: exact repeats, and the
/// inner side of meshes modelled with two sides. Triangles with other texture coordinates are another layer and stay, and so do those of a
/// sheet that coincides in part only, as the back of a flat garment under a front with other diagonals; but a sheet of turned triangles of
/// the same piece is the other side of double-sided cloth. Vertices have texture coordinates and a piece.
pub(super) fn remove_duplicates(
    triangles: &[[u32; 3]],
    (uvs, pieces): (&[Option<Vec2>], &[u32]),
    welder: &mut Welder,
    diagnostics: &mut ImportDiagnostics,
) -> Vec<[u32; 3]> {
    let mut sheets = Groups::new(uvs.len());
    for [a, b, c] in triangles {
        sheets.join(*a, *b);
        sheets.join(*a, *c);
    }
    let is_other_side = |own: u32, of: u32| pieces[own as usize] == pieces[of as usize];
    let originals = originals(triangles, uvs, welder, is_other_side);
    let is_apart = |sheets: &mut Groups, copied: &Copied| {
        copied.same_texture || sheets.find(copied.own[0]) != sheets.find(copied.of[0])
    };
    let originals: Vec<Option<Copied>> =
        originals.into_iter().map(|copied| copied.filter(|copied| is_apart(&mut sheets, copied))).collect();
    // Per sheet: triangles, and copies among them.
    let mut counts: FxHashMap<u32, [usize; 2]> = FxHashMap::default();
    for (t, original) in triangles.iter().zip(&originals) {
        let count = counts.entry(sheets.find(t[0])).or_default();
        count[0] += 1;
        count[1] += usize::from(original.is_some());
    }
    let mut kept = Vec::with_capacity(triangles.len());
    let mut turned_count = 0;
    for (&triangle, original) in triangles.iter().zip(originals) {
        let [all, copies] = counts.get(&sheets.find(triangle[0])).copied().unwrap_or_default();
        let whole_sheet = copies as f64 >= TUNING.min_copied_fraction * all as f64;
        match original {
            Some(Copied { own, of, same_texture }) if whole_sheet || own == of => {
                turned_count += usize::from(!same_texture);
                of.iter().zip(&own).for_each(|(&a, &b)| welder.join(a, b));
            }
            _ => kept.push(triangle),
        }
    }
    diagnostics.repaired(
        turned_count,
        "triangles of the other side of double-sided cloth follow the first side: one cloth is worn (two layers need places of \
         their own, 1 mm apart, or pieces of their own)",
    );
    let dropped = triangles.len() - kept.len() - turned_count;
    diagnostics.repaired(
        dropped,
        "copies of triangles dropped (the same place and texture; a second layer needs its own place, 1 mm apart, or its own \
         texture coordinates)",
    );
    kept
}

/// Triangle that coincides with an earlier one: the vertices of both, in the same order.
struct Copied {
    own: [u32; 3],
    of: [u32; 3],
    /// Whether the texture coordinates are the same, too.
    same_texture: bool,
}

/// Returns for every triangle the earlier one with the same places, and with the same texture coordinates or turned to the other side
/// of the same piece of cloth, as `is_other_side` says of a vertex of both.
fn originals(
    triangles: &[[u32; 3]],
    uvs: &[Option<Vec2>],
    welder: &Welder,
    is_other_side: impl Fn(u32, u32) -> bool,
) -> Vec<Option<Copied>> {
    // Whether the corners run round as their sites do in order.
    let runs_up = |triangle: &[u32; 3]| {
        let [a, b, c] = triangle.map(|v| welder.site(v));
        (a < b) as u8 + (b < c) as u8 + (c < a) as u8 == 2
    };
    let mut first_on: FxHashMap<[u32; 3], ([u32; 3], bool)> = FxHashMap::default();
    let find = |triangle: &[u32; 3]| {
        let mut own = *triangle;
        own.sort_unstable_by_key(|&v| (welder.site(v), v));
        let sites = own.map(|v| welder.site(v));
        if sites[0] == sites[1] || sites[1] == sites[2] {
            return None;
        }
        let same_uv = |(a, b): (&u32, &u32)| match (uvs[*a as usize], uvs[*b as usize]) {
            (Some(p), Some(q)) => (p - q).norm() <= TUNING.copy_uv_tol,
            (None, None) => true,
            _ => false,
        };
        match first_on.get(&sites) {
            Some((of, up)) => {
                let same_texture = of.iter().zip(&own).all(same_uv);
                let is_turned = *up != runs_up(triangle) && is_other_side(own[0], of[0]);
                (same_texture || is_turned).then_some(Copied { own, of: *of, same_texture })
            }
            None => {
                first_on.insert(sites, (own, runs_up(triangle)));
                None
            }
        }
    };
    triangles.iter().map(find).collect()
}

/// Repairs triangles without area. Such a cap has a corner on its longest side; simply dropped, the cloth would be slit
/// along that side. So the side is flipped: cap (a, c, b) and its neighbour (a, b, d) become (a, c, d) and (c, b, d).
/// A cap on the border is dropped, and so is one whose side cannot be flipped; then repeats of triangles are dropped.
pub(super) fn fix_caps(
    positions: &[Vec3],
    wedges: &mut Vec<TriangleWedges>,
    diagnostics: &mut ImportDiagnostics,
) {
    let mut flipped_count = 0;
    for _ in 0..TUNING.max_cap_passes {
        let flipped = flip_caps(positions, wedges);
        flipped_count += flipped;
        if flipped == 0 {
            break;
        }
    }
    diagnostics.repaired(flipped_count, "triangles without area repaired by flipping an edge");
    let before = wedges.len();
    wedges.retain(|w| cap_side(positions, w).is_none());
    diagnostics.repaired(before - wedges.len(), "triangles without area dropped");
    let before = wedges.len();
    let mut known: FxHashSet<[PointIndex; 3]> = FxHashSet::default();
    wedges.retain(|w| {
        let mut sorted = w.points;
        sorted.sort_unstable();
        known.insert(sorted)
    });
    diagnostics.repaired(before - wedges.len(), "triangles with the same corners as another dropped");
}

/// Returns the number k of the longest side (from corner k to k + 1) of a triangle without area; `None` if it has some.
fn cap_side(positions: &[Vec3], wedges: &TriangleWedges) -> Option<usize> {
    let p = wedges.points.map(|point| positions[point.at()]);
    let lengths = [0, 1, 2].map(|k: usize| (p[(k + 1) % 3] - p[k]).norm());
    let longest = (0..3).max_by(|&i, &j| lengths[i].total_cmp(&lengths[j]))?;
    let height = triangle::area_vector(&p).norm() / lengths[longest];
    // A triangle whose corners coincide has a height that is not a number, and counts as a cap.
    let has_area = height > TUNING.cap_height_fraction * lengths[longest];
    (!has_area).then_some(longest)
}

/// Makes one pass over all caps; returns the number of sides flipped.
fn flip_caps(positions: &[Vec3], wedges: &mut [TriangleWedges]) -> usize {
    let caps: Vec<(usize, usize)> =
        wedges.iter().enumerate().filter_map(|(t, w)| Some((t, cap_side(positions, w)?))).collect();
    if caps.is_empty() {
        return 0;
    }
    let mut on_edge: FxHashMap<[PointIndex; 2], Vec<usize>> = FxHashMap::default();
    for (t, w) in wedges.iter().enumerate() {
        for k in 0..3 {
            on_edge.entry(edge_key(w.points[k], w.points[(k + 1) % 3])).or_default().push(t);
        }
    }
    let mut modified = vec![false; wedges.len()];
    let mut flipped = 0;
    for (t, k) in caps {
        let [a, b, c] = [0, 1, 2].map(|i| wedges[t].points[(k + i) % 3]);
        let others = on_edge.get(&edge_key(a, b)).map_or(&[][..], Vec::as_slice);
        let &[first, second] = others else { continue };
        let other = if first == t { second } else { first };
        let Some(j) = (0..3).find(|&j| {
            edge_key(wedges[other].points[j], wedges[other].points[(j + 1) % 3]) == edge_key(a, b)
        }) else {
            continue;
        };
        let [p, q, d] = [0, 1, 2].map(|i| wedges[other].points[(j + i) % 3]);
        if modified[t] || modified[other] || d == c || on_edge.contains_key(&edge_key(c, d)) {
            continue;
        }
        wedges[other] = TriangleWedges { points: [p, c, d], vertices: None };
        wedges[t] = TriangleWedges { points: [c, q, d], vertices: None };
        (modified[t], modified[other]) = (true, true);
        on_edge.entry(edge_key(c, d)).or_default();
        flipped += 1;
    }
    flipped
}

/// Flips triangles so that neighbours agree in orientation; the minority of each connected sheet is flipped. Only
/// edges with two triangles count; a strip with half a twist keeps edges that disagree.
///
/// Then flips a garment that faces inwards as a whole: the sheets that have an outside (`mesh::orientation`) enclose a negative
/// volume together. Sheets are not flipped one by one, as linings face the body.
pub(super) fn orient_outward(
    points: &[Vec3],
    wedges: &mut [TriangleWedges],
    diagnostics: &mut ImportDiagnostics,
) {
    let triangles: Vec<[PointIndex; 3]> = wedges.iter().map(|w| w.points).collect();
    let sheets = oriented_sheets(&Topology::new(points.len(), &triangles));
    let mut flipped_count = 0;
    for &t in sheets.iter().flat_map(|sheet| &sheet.minority) {
        flip_triangle(&mut wedges[t]);
        flipped_count += 1;
    }
    diagnostics.repaired(flipped_count, "triangles flipped to the orientation of their neighbours");
    let volume = |sheet: &OrientedSheet| {
        let own: Vec<[PointIndex; 3]> = sheet.triangles.iter().map(|&t| wedges[t].points).collect();
        enclosed_volume(points, &own)
    };
    if sheets.iter().filter_map(volume).sum::<f64>() < 0.0 {
        wedges.iter_mut().for_each(flip_triangle);
        diagnostics.repaired(wedges.len(), "triangles flipped: the garment faced inwards");
    }
}

fn flip_triangle(wedges: &mut TriangleWedges) {
    wedges.points.swap(1, 2);
    if let Some(vertices) = &mut wedges.vertices {
        vertices.swap(1, 2);
    }
}
