//! Builds a garment from the worn pieces of a source asset: in metres, welded to points, repaired where that is safe,
//! with material directions.
//!
//! Stage between reading and the solver. Every repair is reported; what cannot be repaired (edges of three layers, Möbius
//! strips) stays and remembers nothing, so that the garment is still usable. Layers that lie in one place are set
//! apart by a small distance. Sews no open seams and looks for no intersections.

use crate::error::{Diagnostic, Error, Message, Result, Setting};
use crate::garment::coincident_layers::separate_layers;
use crate::garment::diagnostic::ImportDiagnostics;
use crate::garment::material_coords::flatten_triangles;
use crate::garment::repair::{fix_caps, orient_outward, remove_duplicates};
use crate::garment::shell::{ShellMesh, Shells};
use crate::garment::tuning::TUNING;
use crate::garment::wedges::TriangleWedges;
use crate::garment::{Garment, ImportDiagnostic, SourceAsset, SourceFormat, SourcePiece};
use crease_geometry::math::{Vec2, Vec3};
use crease_geometry::mesh::{Groups, PointIndex, Topology, Welder};

impl Garment {
    /// Builds the garment from the worn pieces of `asset`; also returns the repairs and notes.
    ///
    /// Fails if a piece has vertices without a finite position or triangles without vertices, or if no triangle has any
    /// area.
    pub fn from_asset(asset: &SourceAsset) -> Result<(Self, Vec<ImportDiagnostic>)> {
        Self::from_asset_welded(asset, None)
    }

    /// The same, with vertices on borders joined up to `weld` \[m\] apart; `None` for the error of rounding.
    pub fn from_asset_welded(
        asset: &SourceAsset,
        weld: Option<f64>,
    ) -> Result<(Self, Vec<ImportDiagnostic>)> {
        let sheet = SourceSheet::gather(asset)?;
        let mut diagnostics = ImportDiagnostics::default();
        let rounding = sheet.weld_distance();
        let sewn = weld.filter(|&weld| weld > rounding);
        let weld = weld.unwrap_or(rounding);
        let mut welder = Welder::new(&sheet.positions, weld.min(rounding));
        let kept =
            remove_duplicates(&sheet.triangles, (&sheet.uvs, &sheet.pieces), &mut welder, &mut diagnostics);
        welder.join_open_edges(&kept);
        welder.join_seams(&kept, &sheet.position_ids);
        welder.join_borders_onto_panels(&kept);
        welder.join_short_edges(&kept);
        if let Some(distance) = sewn {
            welder.join_borders(&sheet.positions, &kept, distance);
        }
        let (mut vertex_point, welded_count) = welder.points();
        if asset.obj.is_some() {
            number_by_position(&mut vertex_point, welded_count, &sheet.position_ids);
        }
        let mut wedges = drop_collapsed(&kept, &vertex_point, &mut diagnostics);
        let positions = first_positions(&vertex_point, welded_count, &sheet.positions);
        fix_caps(&positions, &mut wedges, &mut diagnostics);
        if wedges.is_empty() {
            let help = match asset.format {
                SourceFormat::Arrays => Message::from("check the positions and indices"),
                _ => Message::from("export it again, or choose another part with ") + Setting::Garment,
            };
            return Err(Error::input(&asset.file, "", "no triangle of the garment has any area", help));
        }
        let (mut points, mut source_point) =
            drop_unused_points(&positions, &vertex_point, &mut wedges, &mut diagnostics);
        orient_outward(&points, &mut wedges, &mut diagnostics);
        let (mut triangles, mut topology, mut triangle_part) = connect(points.len(), &wedges);
        let mesh =
            ShellMesh { points: &points, triangles: &triangles, topology: &topology, part: &triangle_part };
        let Shells { inner: mut inner_side, thickness, .. } = Shells::find(mesh);
        if inner_side.contains(&true) {
            sew_panels(&mut points, &mut source_point, &mut wedges, &mut inner_side, [weld, thickness]);
            (triangles, topology, triangle_part) = connect(points.len(), &wedges);
            let cloth = outer_triangles(&triangles, &inner_side);
            let topology = Topology::new(points.len(), &cloth);
            prepare_cloth(&mut points, &cloth, &topology, &mut diagnostics);
        } else {
            prepare_cloth(&mut points, &triangles, &topology, &mut diagnostics);
        }
        let part_count = triangle_part.iter().max().map_or(0, |&last| last as usize + 1);
        let flat = flatten_triangles(&points, &wedges, &sheet.uvs, &sheet.pieces, &topology, part_count);
        diagnostics.note(flat.reason);
        let [memory_mask, sewing_mask] =
            sheet.masks.map(|mask| mean_per_point(&mask, &source_point, points.len()));
        let garment = Self {
            points,
            triangles,
            material: flat.material,
            material_from_uv: flat.from_uv,
            source_point,
            memory_mask,
            sewing_mask,
            triangle_part,
            triangle_panel: flat.panel,
            inner_side,
            file_triangles: Vec::new(),
            on_fold_line: None,
            topology,
        };
        Ok((garment, diagnostics.list))
    }
}

/// Worn pieces as one list of vertices, numbered as [`crease_geometry::mesh::VertexIndex`] says.
struct SourceSheet {
    /// One per vertex [m].
    positions: Vec<Vec3>,
    /// One per vertex, if its piece has texture coordinates.
    uvs: Vec<Option<Vec2>>,
    /// One per vertex: number of its piece.
    pieces: Vec<u32>,
    /// One per vertex: factors 0..1 of memory and of sewing.
    masks: [Vec<f64>; 2],
    triangles: Vec<[u32; 3]>,
    /// One per vertex: number of its position in the file, where others have the same.
    position_ids: Vec<Option<u32>>,
}

impl SourceSheet {
    fn gather(asset: &SourceAsset) -> Result<Self> {
        let mut sheet = Self {
            positions: Vec::new(),
            uvs: Vec::new(),
            pieces: Vec::new(),
            masks: [Vec::new(), Vec::new()],
            triangles: Vec::new(),
            position_ids: Vec::new(),
        };
        let mut diagnostics = Vec::new();
        for (number, piece) in (0..).zip(asset.worn_pieces()) {
            let added = sheet.add(piece);
            sheet.pieces.resize(sheet.positions.len(), number);
            if let Err(message) = added {
                let location = format!("piece \"{}\"", piece.name);
                diagnostics.push(Diagnostic::new(&asset.file, location, message, "read the file again"));
            }
        }
        if diagnostics.is_empty() { Ok(sheet) } else { Err(Error::Input(diagnostics)) }
    }

    fn add(&mut self, piece: &SourcePiece) -> std::result::Result<(), String> {
        let (first, count) = (self.positions.len() as u32, piece.positions.len());
        for vertex in 0..count {
            match piece.scene_position(vertex).filter(|p| p.iter().all(|x| x.is_finite())) {
                Some(position) => self.positions.push(position),
                None => return Err(format!("vertex {vertex} has no finite position")),
            }
            self.uvs.push(piece.uvs.as_ref().and_then(|uvs| uvs.get(vertex)).copied());
            self.position_ids.push(piece.position_ids.as_ref().and_then(|ids| ids.get(vertex)).copied());
            for (own, masked) in self.masks.iter_mut().zip([&piece.mask, &piece.sewing_mask]) {
                let mask = masked.as_ref().and_then(|mask| mask.get(vertex)).copied().unwrap_or(1.0);
                own.push(mask.clamp(0.0, 1.0));
            }
        }
        for triangle in &piece.triangles {
            if triangle.iter().any(|&corner| corner as usize >= count) {
                return Err(format!("triangle {triangle:?} of {count} vertices"));
            }
            self.triangles.push(triangle.map(|corner| first + corner));
        }
        Ok(())
    }

    /// Returns the distance [m] within which vertices are one point, from the bounding box of the triangles.
    fn weld_distance(&self) -> f64 {
        let mut corners = self.triangles.iter().flatten().map(|&v| self.positions[v as usize]);
        let Some(first) = corners.next() else { return 0.0 };
        let (low, high) = corners.fold((first, first), |(low, high), p| (low.inf(&p), high.sup(&p)));
        (TUNING.weld_distance_fraction * (high - low).norm()).min(TUNING.max_weld_distance)
    }
}

/// Returns the triangles between points, without those that repeat a point.
fn drop_collapsed(
    kept: &[[u32; 3]],
    vertex_point: &[PointIndex],
    diagnostics: &mut ImportDiagnostics,
) -> Vec<TriangleWedges> {
    let wedges: Vec<TriangleWedges> = kept
        .iter()
        .map(|&vertices| TriangleWedges {
            points: vertices.map(|v| vertex_point[v as usize]),
            vertices: Some(vertices),
        })
        .filter(|w| !w.is_collapsed())
        .collect();
    diagnostics.repaired(kept.len() - wedges.len(), "triangles with coinciding corners dropped");
    wedges
}

/// Numbers the points in the order of the positions of their file, the first of each point counting: that of the `v` lines of an OBJ
/// file, whatever pieces they are in.
fn number_by_position(vertex_point: &mut [PointIndex], point_count: usize, position_ids: &[Option<u32>]) {
    let mut first = vec![u32::MAX; point_count];
    for (point, id) in vertex_point.iter().zip(position_ids) {
        first[point.at()] = first[point.at()].min(id.unwrap_or(u32::MAX));
    }
    let mut order: Vec<u32> = (0..point_count as u32).collect();
    order.sort_by_key(|p| first[*p as usize]);
    let mut number = vec![PointIndex(0); point_count];
    (0..).zip(order).for_each(|(new, old)| number[old as usize] = PointIndex(new));
    vertex_point.iter_mut().for_each(|p| *p = number[p.at()]);
}

/// Drops points that no triangle uses: they would have no mass. A vertex left without a point, which nothing draws,
/// takes the point of the vertex before it.
fn drop_unused_points(
    positions: &[Vec3],
    vertex_point: &[PointIndex],
    wedges: &mut [TriangleWedges],
    diagnostics: &mut ImportDiagnostics,
) -> (Vec<Vec3>, Vec<PointIndex>) {
    let mut used = vec![false; positions.len()];
    wedges.iter().flat_map(|w| w.points).for_each(|point| used[point.at()] = true);
    let mut points = Vec::new();
    let mut renumbered: Vec<Option<PointIndex>> = Vec::with_capacity(positions.len());
    for (position, &used) in positions.iter().zip(&used) {
        renumbered.push(used.then(|| {
            points.push(*position);
            PointIndex(points.len() as u32 - 1)
        }));
    }
    for w in wedges.iter_mut() {
        w.points = w.points.map(|point| renumbered[point.at()].unwrap_or(PointIndex(0)));
    }
    let mut last = PointIndex(0);
    let mut unused_count = 0;
    let source_point = vertex_point.iter().map(|point| {
        match renumbered[point.at()] {
            Some(point) => last = point,
            None => unused_count += 1,
        }
        last
    });
    let source_point = source_point.collect();
    if unused_count > 0 {
        diagnostics.note(format!("{unused_count} vertices belong to no triangle"));
    }
    (points, source_point)
}

/// Returns the position of the first of `positions` \[m\] at each of `count` points; `point_of` gives the point of each.
fn first_positions(point_of: &[PointIndex], count: usize, positions: &[Vec3]) -> Vec<Vec3> {
    let mut first = vec![Vec3::zeros(); count];
    for (point, position) in point_of.iter().zip(positions).rev() {
        first[point.at()] = *position;
    }
    first
}

/// Returns the triangles between `point_count` points, their topology, and their connected parts.
pub(super) fn connect(
    point_count: usize,
    wedges: &[TriangleWedges],
) -> (Vec<[PointIndex; 3]>, Topology, Vec<u32>) {
    let triangles: Vec<[PointIndex; 3]> = wedges.iter().map(|w| w.points).collect();
    let topology = Topology::new(point_count, &triangles);
    let parts = find_parts(point_count, &triangles);
    (triangles, topology, parts)
}

/// Returns those of `triangles` that are no `inner_side`.
pub(super) fn outer_triangles(triangles: &[[PointIndex; 3]], inner_side: &[bool]) -> Vec<[PointIndex; 3]> {
    triangles.iter().zip(inner_side).filter(|(_, inner)| !**inner).map(|(t, _)| *t).collect()
}

/// Joins the outer sides of panels that are shells of their own. Their borders, which rims close, join up to `weld` \[m\] apart, and up to
/// the `thickness` \[m\]: seams of panels that got it one by one stand apart by as much.
fn sew_panels(
    points: &mut Vec<Vec3>,
    source_point: &mut [PointIndex],
    wedges: &mut Vec<TriangleWedges>,
    inner_side: &mut Vec<bool>,
    [weld, thickness]: [f64; 2],
) {
    let triangles: Vec<[PointIndex; 3]> = wedges.iter().map(|w| w.points).collect();
    let outer = outer_triangles(&triangles, inner_side);
    let border = Topology::new(points.len(), &outer);
    let open = border.edges.iter().zip(&border.edge_valence).filter(|(_, valence)| **valence == 1);
    let length = |[a, b]: &[PointIndex; 2]| (points[a.at()] - points[b.at()]).norm();
    let shortest = open.map(|(edge, _)| length(edge)).fold(f64::INFINITY, f64::min);
    // Borders do not close up along themselves.
    let mut welder = Welder::new(points, weld.max(thickness.min(0.5 * shortest)));
    welder.join_open_edges(&outer.iter().map(|t| t.map(|p| p.0)).collect::<Vec<_>>());
    let (joined, count) = welder.points();
    *points = first_positions(&joined, count, points);
    source_point.iter_mut().for_each(|p| *p = joined[p.at()]);
    wedges.iter_mut().for_each(|w| w.points = w.points.map(|p| joined[p.at()]));
    let mut kept = wedges.iter().map(|w| !w.is_collapsed());
    inner_side.retain(|_| kept.next() == Some(true));
    wedges.retain(|w| !w.is_collapsed());
}

/// Reports which edges of the triangles `cloth` carry no hinge, and sets layers of it apart that lie in one place.
fn prepare_cloth(
    points: &mut [Vec3],
    cloth: &[[PointIndex; 3]],
    topology: &Topology,
    diagnostics: &mut ImportDiagnostics,
) {
    note_edges(topology, diagnostics);
    separate_layers(points, cloth, topology, diagnostics);
}

/// Reports which edges carry no hinge.
fn note_edges(topology: &Topology, diagnostics: &mut ImportDiagnostics) {
    let non_manifold = topology.edge_valence.iter().filter(|&&valence| valence > 2).count();
    if non_manifold > 0 {
        diagnostics.note(format!(
            "{non_manifold} edges join more than two triangles: they bend across every wing and remember nothing"
        ));
    }
    if !topology.misoriented.is_empty() {
        diagnostics.note(format!(
            "{} edges join triangles of opposite sides, and flipping triangles cannot repair it: they bend freely",
            topology.misoriented.len()
        ));
    }
}

/// Returns the connected part of every triangle: triangles with common points, directly or through others, are one part.
fn find_parts(point_count: usize, triangles: &[[PointIndex; 3]]) -> Vec<u32> {
    let mut groups = Groups::new(point_count);
    for t in triangles {
        groups.join(t[0].0, t[1].0);
        groups.join(t[0].0, t[2].0);
    }
    let (part_of_point, _) = groups.numbered();
    triangles.iter().map(|t| part_of_point[t[0].at()].0).collect()
}

/// Returns the mean of `mask` over the vertices of every point; 1 for a point without vertices.
fn mean_per_point(mask: &[f64], source_point: &[PointIndex], point_count: usize) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); point_count];
    for (value, point) in mask.iter().zip(source_point) {
        let (sum, count) = &mut sums[point.at()];
        *sum += value;
        *count += 1.0;
    }
    sums.into_iter().map(|(sum, count)| if count > 0.0 { sum / count } else { 1.0 }).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::garment::{Placement, Severity, SourceFormat, UpAxis};
    use crease_geometry::math::Mat4;

    fn piece(positions: &[[f64; 3]], uvs: Option<&[[f64; 2]]>, triangles: &[[u32; 3]]) -> SourcePiece {
        SourcePiece {
            name: "cloth".into(),
            material: None,
            mesh: 0,
            primitive: 0,
            node: None,
            positions: positions.iter().map(|&p| p.into()).collect(),
            position_ids: None,
            normals: None,
            uvs: uvs.map(|uvs| uvs.iter().map(|&uv| uv.into()).collect()),
            mask: None,
            sewing_mask: None,
            triangles: triangles.to_vec(),
            placement: Placement::Rigid(Mat4::identity()),
            joints: Vec::new(),
            worn: true,
        }
    }

    fn build(pieces: Vec<SourcePiece>) -> Result<(Garment, Vec<ImportDiagnostic>)> {
        Garment::from_asset(&SourceAsset {
            file: "cloth.obj".into(),
            sha256: String::new(),
            format: SourceFormat::Obj,
            unit_m: 1.0,
            unit_is_known: false,
            up: UpAxis::Y,
            document: None,
            obj: None,
            pieces,
        })
    }

    fn repaired(diagnostics: &[ImportDiagnostic]) -> Vec<&str> {
        diagnostics.iter().filter(|f| f.severity == Severity::Repaired).map(|f| f.message.as_str()).collect()
    }

    /// Convention: swapping warp and weft, or laying flat at the texture's size, still runs and merely drapes wrongly.
    #[test]
    fn warp_is_plus_u_at_the_true_size() {
        // A 2 m x 1 m rectangle in the x-y plane; u grows along +y of space, v along -x, both in a small corner of the
        // texture.
        let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let uvs = [[0.1, 0.2], [0.1, 0.1], [0.3, 0.1], [0.3, 0.2]];
        let (garment, _) = build(vec![piece(&corners, Some(&uvs), &[[0, 1, 2], [0, 2, 3]])]).unwrap();
        assert!(garment.material_from_uv);
        // Along the warp (x of the material) goes space's y, along the weft space's -x.
        let expected = [[0.0, 0.0], [0.0, -2.0], [1.0, -2.0]];
        for (corner, expected) in garment.material[0].iter().zip(expected) {
            assert!((corner - Vec2::from(expected)).norm() < 1e-12, "{corner} {expected:?}");
        }
    }

    #[test]
    fn mirrored_texture_keeps_warp_and_positive_area() {
        let corners = [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 1.0, 0.0], [0.0, 1.0, 0.0]];
        let uvs = [[1.0, 0.0], [0.0, 0.0], [0.0, 1.0], [1.0, 1.0]];
        let (garment, _) = build(vec![piece(&corners, Some(&uvs), &[[0, 1, 2], [0, 2, 3]])]).unwrap();
        let [a, b, c] = garment.material[0];
        assert!((b - a - Vec2::new(-2.0, 0.0)).norm() < 1e-12, "u falls along space's x: {b}");
        assert!((b - a).perp(&(c - a)) > 0.0);
    }

    #[test]
    fn without_texture_warp_hangs_down() {
        // A wall: warp along y. A floor: warp along z.
        let wall = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0]];
        let (garment, _) = build(vec![piece(&wall, None, &[[0, 1, 2]])]).unwrap();
        assert!(!garment.material_from_uv);
        assert!((garment.material[0][2] - Vec2::new(2.0, 0.0)).norm() < 1e-12);
        assert!((garment.material[0][1] - Vec2::new(0.0, -1.0)).norm() < 1e-12);
        let floor = [[0.0, 0.0, 0.0], [0.0, 0.0, 2.0], [1.0, 0.0, 0.0]];
        let (garment, _) = build(vec![piece(&floor, None, &[[0, 1, 2]])]).unwrap();
        assert!((garment.material[0][1] - Vec2::new(2.0, 0.0)).norm() < 1e-12);
    }

    #[test]
    fn confetti_of_texture_is_not_followed() {
        let strip: Vec<[f64; 3]> =
            (0..10).flat_map(|k| [[0.0, f64::from(k), 0.0], [1.0, f64::from(k), 0.0]]).collect();
        let mut positions = Vec::new();
        for k in 0..9 {
            for corners in [[2 * k, 2 * k + 1, 2 * k + 3], [2 * k, 2 * k + 3, 2 * k + 2]] {
                positions.extend(corners.map(|c| strip[c]));
            }
        }
        let triangles: Vec<[u32; 3]> = (0..18).map(|t| [3 * t, 3 * t + 1, 3 * t + 2]).collect();
        let uvs: Vec<[f64; 2]> = (0..18)
            .flat_map(|t| [[f64::from(t), 0.0], [f64::from(t) + 0.3, 0.4], [f64::from(t), 0.9]])
            .collect();
        let (garment, diagnostics) = build(vec![piece(&positions, Some(&uvs), &triangles)]).unwrap();
        assert_eq!(garment.points.len(), 20);
        assert!(!garment.material_from_uv);
        assert!(diagnostics.iter().any(|f| f.message.contains("18 texture islands")), "{diagnostics:?}");
    }

    #[test]
    fn pieces_are_joined_at_their_common_edge() {
        let left = piece(&[[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]], None, &[[0, 1, 2]]);
        let mut right = piece(&[[1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [0.0, 1.0, 0.0]], None, &[[0, 1, 2]]);
        right.mask = Some(vec![0.0; 3]);
        let body = SourcePiece { worn: false, ..left.clone() };
        let (garment, _) = build(vec![left, body, right]).unwrap();
        assert_eq!(garment.points.len(), 4);
        assert_eq!(garment.source_point.iter().map(|p| p.0).collect::<Vec<_>>(), [0, 1, 2, 1, 3, 2]);
        assert_eq!(garment.topology.hinges.len(), 1);
        assert_eq!(garment.triangle_part, [0, 0]);
        assert_eq!(garment.memory_mask, [1.0, 0.5, 0.5, 0.0], "the mean of the vertices of a point");
    }

    #[test]
    fn the_minority_is_turned() {
        // A strip of six triangles, numbers 1 and 4 of opposite orientation.
        let positions: Vec<[f64; 3]> = (0..8).map(|k| [f64::from(k / 2), f64::from(k % 2), 0.0]).collect();
        let mut triangles: Vec<[u32; 3]> =
            (0..6).map(|k| if k % 2 == 0 { [k, k + 2, k + 1] } else { [k, k + 1, k + 2] }).collect();
        triangles[1].swap(0, 1);
        triangles[4].swap(0, 1);
        let (garment, diagnostics) = build(vec![piece(&positions, None, &triangles)]).unwrap();
        assert_eq!(repaired(&diagnostics), ["2 triangles flipped to the orientation of their neighbours"]);
        assert_eq!(garment.topology.hinges.len(), 5);
        for (t, flat) in garment.triangles.iter().zip(&garment.material) {
            let [a, b, c] = t.map(|p| garment.points[p.at()]);
            assert!((b - a).cross(&(c - a)).z > 0.0);
            assert!((flat[1] - flat[0]).perp(&(flat[2] - flat[0])) > 0.0);
        }
    }

    #[test]
    fn a_moebius_strip_stays_usable() {
        let count = 20u32;
        let positions: Vec<[f64; 3]> = (0..2 * count)
            .map(|k| {
                let angle = f64::from(k / 2) * std::f64::consts::TAU / f64::from(count);
                let side = if k % 2 == 0 { 0.3 } else { -0.3 };
                let radius = 1.0 + side * (0.5 * angle).cos();
                [radius * angle.cos(), side * (0.5 * angle).sin(), radius * angle.sin()]
            })
            .collect();
        let triangles: Vec<[u32; 3]> = (0..count)
            .flat_map(|k| {
                let (a, b) = (2 * k, 2 * k + 1);
                // The last segment closes with the sides exchanged.
                let (c, d) = if k + 1 < count { (a + 2, b + 2) } else { (1, 0) };
                [[a, c, b], [b, c, d]]
            })
            .collect();
        let (garment, diagnostics) = build(vec![piece(&positions, None, &triangles)]).unwrap();
        assert_eq!(garment.topology.misoriented.len(), 1);
        assert!(
            diagnostics.iter().any(|f| f.message.starts_with("1 edges join triangles of opposite sides")),
            "{diagnostics:?}"
        );
    }

    #[test]
    fn edges_of_three_triangles_carry_no_hinge() {
        let positions =
            [[0.0, 0.0, 0.0], [0.0, 1.0, 0.0], [1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]];
        let (garment, diagnostics) =
            build(vec![piece(&positions, None, &[[0, 1, 2], [1, 0, 3], [0, 1, 4]])]).unwrap();
        assert_eq!((garment.triangles.len(), garment.topology.hinges.len()), (3, 0));
        assert!(
            diagnostics.iter().any(|f| f.message.starts_with("1 edges join more than two")),
            "{diagnostics:?}"
        );
    }

    /// Both sides of a sheet modelled, with vertices of their own: one sheet. The same with other texture coordinates:
    /// front and back of a pillow laid flat, two layers joined all around.
    #[test]
    fn an_inner_side_is_dropped_and_a_back_panel_kept() {
        let grid: Vec<[f64; 3]> = (0..9).map(|k| [f64::from(k % 3), f64::from(k / 3), 0.0]).collect();
        // A fan around the middle, so that no triangle has all its corners on the rim.
        let rim = [0, 1, 2, 5, 8, 7, 6, 3];
        let triangles: Vec<[u32; 3]> = (0..8).map(|k| [4, rim[k], rim[(k + 1) % 8]]).collect();
        let back: Vec<[u32; 3]> = triangles.iter().map(|t| [t[0], t[2], t[1]]).collect();
        let uvs: Vec<[f64; 2]> = grid.iter().map(|p| [p[0], p[1]]).collect();
        let other: Vec<[f64; 2]> = grid.iter().map(|p| [p[0] + 5.0, p[1]]).collect();
        let pair = |back_uvs| {
            build(vec![piece(&grid, Some(&uvs), &triangles), piece(&grid, Some(back_uvs), &back)]).unwrap()
        };
        let (sheet, diagnostics) = pair(&uvs);
        assert_eq!((sheet.points.len(), sheet.triangles.len()), (9, 8));
        assert!(repaired(&diagnostics)[0].starts_with("8 copies of triangles dropped"), "{diagnostics:?}");
        assert_eq!(sheet.source_point[9..], sheet.source_point[..9], "the dropped side follows");
        let (pillow, _) = pair(&other);
        assert_eq!((pillow.points.len(), pillow.triangles.len()), (10, 16), "only the inner point is double");
        assert_eq!(pillow.topology.hinges.len(), 24, "closed all around");
    }

    /// A T-junction closed by a triangle without area: dropping it would slit the cloth from 0 to 1.
    #[test]
    fn a_cap_is_mended_without_a_slit() {
        let positions =
            [[0.0, 0.0, 0.0], [2.0, 0.0, 0.0], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [1.0, -1.0, 0.0]];
        // Above: one triangle on the whole edge. Below: two on its halves. Between: the cap 0, 2, 1.
        let triangles = [[0, 1, 3], [0, 2, 1], [0, 4, 2], [2, 4, 1]];
        let (garment, diagnostics) = build(vec![piece(&positions, None, &triangles)]).unwrap();
        assert_eq!(repaired(&diagnostics), ["1 triangles without area repaired by flipping an edge"]);
        assert_eq!((garment.triangles.len(), garment.topology.hinges.len()), (4, 4));
        let loops = garment.topology.boundary_loops(&garment.triangles);
        assert_eq!((loops.len(), loops[0].len()), (1, 4));
    }

    #[test]
    fn loose_vertices_have_no_points() {
        let positions = [[9.0, 9.0, 9.0], [0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [5.0, 0.0, 0.0]];
        let (garment, diagnostics) = build(vec![piece(&positions, None, &[[1, 2, 3], [1, 1, 2]])]).unwrap();
        assert_eq!(garment.points.len(), 3);
        assert_eq!(garment.source_point.len(), 5);
        assert!(garment.source_point.iter().all(|p| p.at() < 3));
        assert_eq!(repaired(&diagnostics), ["1 triangles with coinciding corners dropped"]);
        assert!(diagnostics.iter().any(|f| f.message.starts_with("2 vertices belong to no triangle")));
    }

    #[test]
    fn nothing_to_wear_is_refused() {
        let line = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [2.0, 0.0, 0.0]];
        assert!(build(vec![piece(&line, None, &[[0, 1, 2]])]).unwrap_err().to_string().contains("any area"));
        assert!(build(vec![]).is_err());
        let mut broken = piece(&line, None, &[[0, 1, 7]]);
        assert!(build(vec![broken.clone()]).unwrap_err().to_string().contains("of 3 vertices"));
        broken.positions[1].x = f64::NAN;
        assert!(build(vec![broken]).unwrap_err().to_string().contains("vertex 1"));
    }
}
