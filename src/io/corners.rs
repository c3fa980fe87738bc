//! Vertices and triangles of a piece from the corners of its faces, for formats whose positions, texture coordinates and
//! normals are separate lists.

use crate::polygon::{Triangulator, newell_normal};
use crease_geometry::math::Vec3;
use rustc_hash::FxHashMap;

/// Corner of a face: indices of its position, texture coordinates and normal in their lists.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub(super) struct Corner {
    pub(super) position: u32,
    pub(super) uv: u32,
    pub(super) normal: u32,
}

/// Vertices of one piece, one per different corner in order of first use until they are numbered otherwise, and its triangles.
#[derive(Default)]
pub(super) struct CornerVertices {
    numbers: FxHashMap<Corner, u32>,
    /// Per vertex: its corner.
    pub(super) corners: Vec<Corner>,
    /// Per vertex: normal of the first face that uses it, for corners without one.
    pub(super) face_normals: Vec<Vec3>,
    /// Corners into `corners`, oriented as the faces.
    pub(super) triangles: Vec<[u32; 3]>,
}

impl CornerVertices {
    /// Adds a face of these corners, whose positions are in the list `positions`.
    pub(super) fn add_face(
        &mut self,
        positions: &[Vec3],
        corners: &[Corner],
        triangulator: &mut Triangulator,
    ) {
        let at = |corner: &Corner| positions.get(corner.position as usize).copied();
        let outline: Vec<Vec3> = corners.iter().filter_map(at).collect();
        let normal = newell_normal(&outline).try_normalize(0.0).unwrap_or_else(Vec3::y);
        let vertices: Vec<u32> = corners.iter().map(|corner| self.vertex(*corner, normal)).collect();
        for triangle in triangulator.triangulate(&outline) {
            self.triangles.push(triangle.map(|k| vertices[k as usize]));
        }
    }

    /// Numbers the vertices in the order of their positions: first one vertex per position, then the others of seams.
    pub(super) fn number_by_position(&mut self) {
        let count = self.corners.len();
        let position = |v: &u32| self.corners[*v as usize].position;
        let mut order: Vec<u32> = (0..count as u32).collect();
        order.sort_by_key(position);
        let (mut first, mut other) = (Vec::with_capacity(count), Vec::new());
        for v in order {
            match first.last().is_some_and(|last| position(last) == position(&v)) {
                true => other.push(v),
                false => first.push(v),
            }
        }
        first.extend(other);
        let mut number = vec![0; count];
        (0..).zip(&first).for_each(|(new, old)| number[*old as usize] = new);
        self.triangles.iter_mut().flatten().for_each(|v| *v = number[*v as usize]);
        self.numbers.values_mut().for_each(|v| *v = number[*v as usize]);
        self.corners = first.iter().map(|old| self.corners[*old as usize]).collect();
        self.face_normals = first.iter().map(|old| self.face_normals[*old as usize]).collect();
    }

    fn vertex(&mut self, corner: Corner, face_normal: Vec3) -> u32 {
        let next = self.corners.len() as u32;
        let number = *self.numbers.entry(corner).or_insert(next);
        if number == next {
            self.corners.push(corner);
            self.face_normals.push(face_normal);
        }
        number
    }
}
