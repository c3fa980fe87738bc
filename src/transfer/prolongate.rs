//! Memory that a coarser mesh of the same garment earned, on the garment itself.
//!
//! Both lie in one place, and of every point of the garment it is known in which coarse triangle it lies: a place lands on the
//! nearest of those around the ones its corners lie in, so that layers that touch are never taken for one another. Hinges
//! between triangles that both meshes have go over number by number; what lies between is spread as between any two meshes.

use crate::garment::{CoarseMesh, Garment, RestState};
use crate::math::Vec3;
use crate::mesh::distance::point_triangle_squared;
use crate::transfer::correspondence::{Landing, Lands, Place, smallest_rotation};
use crate::transfer::hinge_fit::{PlaneTensor, hinge_angles};
use crate::transfer::resample::gather;
use crate::transfer::{Change, GarmentSurface, TransferOptions, new_memory, stiffness};
use rustc_hash::FxHashMap;

/// Memory of `garment`, one entry per hinge and triangle of it: that which `coarse`, made of it, has earned.
pub fn prolongate(coarse: &CoarseMesh, memory: &RestState, garment: &Garment) -> RestState {
    let target = GarmentSurface::without_texture(garment);
    let lands = Within::new(coarse, &target);
    let gathered = gather(&lands, memory, &target, 1.0);
    let wanted: Vec<PlaneTensor> = gathered.iter().map(|g| g.curvature).collect();
    let mut change = Change {
        angle: hinge_angles(&target, &wanted),
        stiffness: stiffness(&target, &gathered),
        stretch: gathered.iter().map(|g| g.stretch).collect(),
    };
    take_over(&mut change, &Change::of_memory(memory), coarse, garment);
    change.applied_to(new_memory(&target), &target, &TransferOptions::full(target.points.len()))
}

/// The numbers of what both meshes have.
fn take_over(change: &mut Change, own: &Change, coarse: &CoarseMesh, garment: &Garment) {
    let hinges = garment.topology.hinges.iter().enumerate();
    let numbers: FxHashMap<[u32; 2], usize> = hinges.map(|(h, hinge)| (hinge.triangles, h)).collect();
    for (h, hinge) in coarse.garment.topology.hinges.iter().enumerate() {
        let [Some(a), Some(b)] = hinge.triangles.map(|f| coarse.unchanged_from[f as usize]) else { continue };
        if let Some(&whole) = numbers.get(&[a.min(b), a.max(b)]) {
            change.angle[whole] = own.angle[h];
            change.stiffness[whole] = own.stiffness[h];
        }
    }
    for (f, same) in coarse.unchanged_from.iter().enumerate() {
        if let Some(whole) = same {
            change.stretch[*whole as usize] = own.stretch[f];
        }
    }
}

/// Finds places of a garment on its coarser mesh.
struct Within<'a> {
    source: GarmentSurface,
    target: &'a GarmentSurface,
    containing_triangle: &'a [u32],
    /// Per coarse triangle: itself and all that share a point with it, sorted.
    around: Vec<Vec<u32>>,
    /// Per coarse triangle: outward unit normal.
    normals: Vec<Vec3>,
}

impl<'a> Within<'a> {
    fn new(coarse: &'a CoarseMesh, target: &'a GarmentSurface) -> Self {
        let source = GarmentSurface::without_texture(&coarse.garment);
        let mut on_point = vec![Vec::new(); source.points.len()];
        for (f, t) in source.triangles.iter().enumerate() {
            t.iter().for_each(|p| on_point[p.at()].push(f as u32));
        }
        let around = source.triangles.iter().map(|t| {
            let mut near: Vec<u32> = t.iter().flat_map(|p| on_point[p.at()].iter().copied()).collect();
            near.sort_unstable();
            near.dedup();
            near
        });
        let outward = target.outward();
        let unit = |f: usize| outward * source.normal(f).try_normalize(0.0).unwrap_or_else(Vec3::z);
        Self {
            around: around.collect(),
            normals: (0..source.triangles.len()).map(unit).collect(),
            source,
            target,
            containing_triangle: &coarse.containing_triangle,
        }
    }
}

impl Lands for Within<'_> {
    fn source(&self) -> &GarmentSurface {
        &self.source
    }

    fn land(&self, f: usize, place: &Place) -> Option<Landing> {
        let distance = |g: u32| {
            let [a, b, c] = self.source.corners(g as usize);
            point_triangle_squared(&place.position, &a, &b, &c)
        };
        let corners = self.target.triangles[f].iter().map(|p| self.containing_triangle[p.at()]);
        let near = corners.flat_map(|g| self.around[g as usize].iter().copied());
        let nearest =
            near.map(|g| (distance(g), g)).min_by(|a, b| a.0.total_cmp(&b.0).then(a.1.cmp(&b.1)))?;
        let triangle = nearest.1 as usize;
        let map = smallest_rotation(&self.normals[triangle], &place.normal);
        Some(Landing { triangle, quality: 1.0, map })
    }
}
