//! A garment from the worn pieces of a mesh file: placed in metres, welded to points, mended where that is safe, with
//! the directions of its cloth.
//!
//! Stage between reading and the solver. Everything repaired is said; what cannot be (edges of three layers, Möbius
//! strips) stays and carries no hinge, so that the garment is still usable. Sews no seams that are apart, changes no
//! positions, and looks for no crossings.

use super::material::lay_flat;
use super::repair::{Corners, drop_copies, mend_caps, turn_alike};
use super::{Finding, Garment, Severity};
use crate::format::{SourceAsset, SourcePiece};
use crate::math::{Vec2, Vec3};
use crate::mesh::{Groups, PointIndex, Topology, Welder};
use crate::{Error, Fault, Result};

/// Vertices closer than this part of the garment's diagonal are one point: a hundred times the rounding of single
/// precision, a hundredth of the finest edge worth simulating.
const WELD_DISTANCE: f64 = 1e-5;
/// And never farther apart than this [m]: a stray vertex far away must not weld the garment to a lump.
const WELD_LIMIT_M: f64 = 1e-4;

impl Garment {
    /// The garment made of the worn pieces of `asset`, and what was mended or is worth knowing.
    pub fn from_asset(asset: &SourceAsset) -> Result<(Self, Vec<Finding>)> {
        let sheet = SourceSheet::gather(asset)?;
        let mut findings = FindingList::default();
        let mut welder = Welder::new(&sheet.positions, sheet.weld_distance());
        let kept = drop_copies(&sheet.triangles, &sheet.uvs, &mut welder, &mut findings);
        welder.join_open_edges(&kept);
        welder.join_short_edges(&kept);
        let (vertex_point, welded_count) = welder.points();
        let mut corners = collapse(&kept, &vertex_point, &mut findings);
        let mut positions = vec![Vec3::zeros(); welded_count];
        for (&point, &position) in vertex_point.iter().zip(&sheet.positions).rev() {
            positions[point.at()] = position;
        }
        mend_caps(&positions, &mut corners, &mut findings);
        if corners.is_empty() {
            return Err(Error::fault(
                &asset.file,
                "",
                "no triangle of the garment has any area",
                "export it again, or choose another part with --garment",
            ));
        }
        let (points, source_point) = drop_loose(&positions, &vertex_point, &mut corners, &mut findings);
        turn_alike(points.len(), &mut corners, &mut findings);
        let triangles: Vec<[PointIndex; 3]> = corners.iter().map(|c| c.points).collect();
        let topology = Topology::new(points.len(), &triangles);
        note_edges(&topology, &mut findings);
        let triangle_part = find_parts(points.len(), &triangles);
        let part_count = triangle_part.iter().max().map_or(0, |&last| last as usize + 1);
        let flat = lay_flat(&points, &corners, &sheet.uvs, &topology, part_count);
        findings.note(flat.why);
        let memory_mask = mean_per_point(&sheet.mask, &source_point, points.len());
        let garment = Self {
            points,
            triangles,
            material: flat.material,
            material_from_uv: flat.from_uv,
            source_point,
            memory_mask,
            triangle_part,
            topology,
        };
        Ok((garment, findings.list))
    }
}

/// Findings in the order they come up.
#[derive(Default)]
pub(super) struct FindingList {
    list: Vec<Finding>,
}

impl FindingList {
    pub(super) fn note(&mut self, what: impl Into<String>) {
        self.list.push(Finding { severity: Severity::Note, place: String::new(), what: what.into() });
    }

    /// `count` things were mended; nothing is said of none.
    pub(super) fn repaired(&mut self, count: usize, what: &str) {
        if count > 0 {
            self.list.push(Finding {
                severity: Severity::Repaired,
                place: String::new(),
                what: format!("{count} {what}"),
            });
        }
    }
}

/// The worn pieces as one list of vertices, numbered as [`crate::mesh::VertexIndex`] says.
struct SourceSheet {
    /// One per vertex [m].
    positions: Vec<Vec3>,
    /// One per vertex, if its piece has texture coordinates.
    uvs: Vec<Option<Vec2>>,
    /// One per vertex: 0..1.
    mask: Vec<f64>,
    triangles: Vec<[u32; 3]>,
}

impl SourceSheet {
    fn gather(asset: &SourceAsset) -> Result<Self> {
        let mut sheet =
            Self { positions: Vec::new(), uvs: Vec::new(), mask: Vec::new(), triangles: Vec::new() };
        let mut faults = Vec::new();
        for piece in asset.worn_pieces() {
            if let Err(what) = sheet.add(piece) {
                let place = format!("piece \"{}\"", piece.name);
                faults.push(Fault::new(&asset.file, place, what, "read the file again"));
            }
        }
        if faults.is_empty() { Ok(sheet) } else { Err(Error::Input(faults)) }
    }

    fn add(&mut self, piece: &SourcePiece) -> std::result::Result<(), String> {
        let (first, count) = (self.positions.len() as u32, piece.positions.len());
        for vertex in 0..count {
            match piece.scene_position(vertex).filter(|p| p.iter().all(|x| x.is_finite())) {
                Some(position) => self.positions.push(position),
                None => return Err(format!("vertex {vertex} has no finite position")),
            }
            self.uvs.push(piece.uvs.as_ref().and_then(|uvs| uvs.get(vertex)).copied());
            let mask = piece.mask.as_ref().and_then(|mask| mask.get(vertex)).copied().unwrap_or(1.0);
            self.mask.push(mask.clamp(0.0, 1.0));
        }
        for triangle in &piece.triangles {
            if triangle.iter().any(|&corner| corner as usize >= count) {
                return Err(format!("triangle {triangle:?} of {count} vertices"));
            }
            self.triangles.push(triangle.map(|corner| first + corner));
        }
        Ok(())
    }

    /// Distance [m] within which vertices are one point; the box is that of the triangles.
    fn weld_distance(&self) -> f64 {
        let mut corners = self.triangles.iter().flatten().map(|&v| self.positions[v as usize]);
        let Some(first) = corners.next() else { return 0.0 };
        let (low, high) = corners.fold((first, first), |(low, high), p| (low.inf(&p), high.sup(&p)));
        (WELD_DISTANCE * (high - low).norm()).min(WELD_LIMIT_M)
    }
}

/// Triangles between points; those that repeat a point are left out.
fn collapse(kept: &[[u32; 3]], vertex_point: &[PointIndex], findings: &mut FindingList) -> Vec<Corners> {
    let corners: Vec<Corners> = kept
        .iter()
        .map(|&vertices| Corners {
            points: vertices.map(|v| vertex_point[v as usize]),
            vertices: Some(vertices),
        })
        .filter(|c| c.points[0] != c.points[1] && c.points[1] != c.points[2] && c.points[2] != c.points[0])
        .collect();
    findings.repaired(kept.len() - corners.len(), "triangles with coinciding corners dropped");
    corners
}

/// Drops points no triangle uses: they would have no mass. A vertex left without a point, which nobody draws, follows
/// the vertex before it.
fn drop_loose(
    positions: &[Vec3],
    vertex_point: &[PointIndex],
    corners: &mut [Corners],
    findings: &mut FindingList,
) -> (Vec<Vec3>, Vec<PointIndex>) {
    let mut used = vec![false; positions.len()];
    corners.iter().flat_map(|c| c.points).for_each(|point| used[point.at()] = true);
    let mut points = Vec::new();
    let mut renumbered: Vec<Option<PointIndex>> = Vec::with_capacity(positions.len());
    for (position, &used) in positions.iter().zip(&used) {
        renumbered.push(used.then(|| {
            points.push(*position);
            PointIndex(points.len() as u32 - 1)
        }));
    }
    for c in corners.iter_mut() {
        c.points = c.points.map(|point| renumbered[point.at()].unwrap_or(PointIndex(0)));
    }
    let mut last = PointIndex(0);
    let mut loose_count = 0;
    let source_point = vertex_point.iter().map(|point| {
        match renumbered[point.at()] {
            Some(point) => last = point,
            None => loose_count += 1,
        }
        last
    });
    let source_point = source_point.collect();
    if loose_count > 0 {
        findings.note(format!("{loose_count} vertices belong to no triangle"));
    }
    (points, source_point)
}

/// Says which edges will carry no hinge.
fn note_edges(topology: &Topology, findings: &mut FindingList) {
    let crowded = topology.edge_valence.iter().filter(|&&valence| valence > 2).count();
    if crowded > 0 {
        findings.note(format!(
            "{crowded} edges join more than two triangles: they bend freely and remember nothing"
        ));
    }
    if !topology.misoriented.is_empty() {
        findings.note(format!(
            "{} edges join triangles of opposite sides, and no turning of triangles mends it: they bend freely",
            topology.misoriented.len()
        ));
    }
}

/// Per triangle its part: triangles that share points, directly or through others, are one part.
fn find_parts(point_count: usize, triangles: &[[PointIndex; 3]]) -> Vec<u32> {
    let mut groups = Groups::new(point_count);
    for t in triangles {
        groups.join(t[0].0, t[1].0);
        groups.join(t[0].0, t[2].0);
    }
    let (part_of_point, _) = groups.numbered();
    triangles.iter().map(|t| part_of_point[t[0].at()].0).collect()
}

fn mean_per_point(mask: &[f64], source_point: &[PointIndex], point_count: usize) -> Vec<f64> {
    let mut sums = vec![(0.0, 0.0); point_count];
    for (value, point) in mask.iter().zip(source_point) {
        let (sum, count) = &mut sums[point.at()];
        *sum += value;
        *count += 1.0;
    }
    sums.into_iter().map(|(sum, count)| if count > 0.0 { sum / count } else { 1.0 }).collect()
}
