//! Halves edges beside creases and where the worn surface is curved, longest first, with the triangles on them (longest-edge bisection,
//! Rivara 1984).

use crate::remesh::fine_mesh::FileMesh;
use crate::remesh::fine_mesh::split_mesh::SplitMesh;
use crate::remesh::tuning::TUNING;
use crate::remesh::worn_surface::CreaseDistances;
use crate::remesh::{WornPlace, WornSurface};
use crease_geometry::math::{Mat3, Vec3};
use crease_geometry::mesh::LongEdge;
use std::collections::BinaryHeap;

/// Places of the points of a mesh on the worn surface.
pub(super) struct Places<'a> {
    pub surface: &'a WornSurface,
    pub creases: &'a CreaseDistances<'a>,
    /// Per point: its place; `None` where the worn surface has none.
    all: Vec<Option<WornPlace>>,
}

impl<'a> Places<'a> {
    /// The places of the points of the file, which `mesh` still is.
    pub fn new(
        mesh: &SplitMesh,
        file: &FileMesh,
        surface: &'a WornSurface,
        creases: &'a CreaseDistances<'a>,
    ) -> Self {
        let mut all: Vec<Option<WornPlace>> = vec![None; mesh.points.len()];
        for t in file.triangles {
            let Some(start) = t.start else { continue };
            for p in t.points.map(|p| p as usize) {
                if all[p].is_none() {
                    all[p] = Some(surface.at(start, &mesh.points[p]));
                }
            }
        }
        Self { surface, creases, all }
    }

    /// The place of point `p`.
    pub fn at(&self, p: usize) -> Option<&WornPlace> {
        self.all.get(p).and_then(Option::as_ref)
    }

    /// The place of `x` [m] on an edge, where the worn surface has places of both of its ends.
    pub fn on_edge(&self, [a, b]: [u32; 2], x: &Vec3) -> Option<WornPlace> {
        let (first, _) = (self.at(a as usize)?, self.at(b as usize)?);
        Some(self.surface.at(first.face, x))
    }

    /// Splits an edge of `mesh` where its second end has `weight`.
    pub fn split(&mut self, mesh: &mut SplitMesh, edge: [u32; 2], weight: f64) -> u32 {
        let new = mesh.split(edge, weight);
        let place = self.on_edge(edge, &mesh.points[new as usize]);
        self.all.push(place);
        new
    }
}

/// Halves the edges of `mesh` that need it until they are about `edge` [m] long.
pub(super) fn refine(mesh: &mut SplitMesh, places: &mut Places, edge: f64) {
    let long = |mesh: &SplitMesh, ends: [u32; 2]| LongEdge { length: mesh.length(ends), ends };
    let mut open: BinaryHeap<LongEdge<u32>> = BinaryHeap::new();
    for ends in mesh.edges() {
        if needs_halving(mesh, places, ends, edge) {
            open.push(long(mesh, ends));
        }
    }
    while let Some(LongEdge { length, ends }) = open.pop() {
        if mesh.points.len() >= TUNING.max_fine_points {
            break;
        }
        let on = mesh.on(ends).to_vec();
        if on.is_empty() {
            continue;
        }
        // A shorter edge is not halved before the longest of its triangles: that would leave slivers.
        let longest = on.iter().flat_map(|f| mesh.edges_of(*f)).map(|other| long(mesh, other)).max();
        if let Some(longer) = longest.filter(|other| *other > LongEdge { length, ends }) {
            open.push(LongEdge { length, ends });
            open.push(longer);
            continue;
        }
        let new = places.split(mesh, ends, 0.5);
        let mut made: Vec<[u32; 2]> = mesh.edges_at(new, &on);
        made.retain(|ends| needs_halving(mesh, places, *ends, edge));
        open.extend(made.into_iter().map(|ends| long(mesh, ends)));
    }
}

/// Whether an edge is long, and lies beside a crease or where the worn surface departs from it.
fn needs_halving(mesh: &SplitMesh, places: &Places, ends: [u32; 2], edge: f64) -> bool {
    let length = mesh.length(ends);
    if length <= TUNING.fine_split_ratio * edge {
        return false;
    }
    let [from, to] = ends.map(|p| places.at(p as usize));
    let (Some(from), Some(to)) = (from, to) else { return false };
    let [a, b] = ends.map(|p| mesh.points[p as usize]);
    let parts = (length / edge).ceil().max(2.0) as usize;
    let is_beside = |place: &WornPlace, x: &Vec3| {
        places.creases.at(place.face, x).is_some_and(|crease| crease.distance < crease.half_width + edge)
    };
    if is_beside(from, &a) || is_beside(to, &b) {
        return true;
    }
    let mut face = from.face;
    (1..parts).any(|k| {
        let part = k as f64 / parts as f64;
        let x = a * (1.0 - part) + b * part;
        let place = places.surface.at(face, &x);
        face = place.face;
        let flat = from.position * (1.0 - part) + to.position * part;
        let turn: Mat3 = from.turn * (1.0 - part) + to.turn * part;
        (place.position - flat).norm() > TUNING.max_fine_deviation
            || (place.turn - turn).norm() > TUNING.max_fine_turn
            || is_beside(&place, &x)
    })
}
