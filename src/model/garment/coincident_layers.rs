//! Layers that lie in one place: a lining in the plane of its shell, a patch, the back of a garment that is laid flat.
//!
//! Contact keeps layers apart that are apart; two that coincide have no sides. They are set apart by about the thickness of
//! cloth. At each place the layers that face the same side as the first one lie in the order of the file, the first on top, and
//! those that face the opposite side lie below them, so that front and back of a flat garment go to their own sides. A layer
//! here is a piece of cloth that is not folded back on itself; points where two of them are joined stay.

use crate::error::{Message, Setting};
use crate::garment::diagnostic::ImportDiagnostics;
use crate::garment::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::triangle_bvh::TriangleBvh;
use crease_geometry::mesh::{Groups, PointIndex, Topology, triangle};

/// Sets layers of `triangles` that coincide apart by moving `points`; reports how many points lie on another layer.
pub(super) fn separate_layers(
    points: &mut [Vec3],
    triangles: &[[PointIndex; 3]],
    topology: &Topology,
    diagnostics: &mut ImportDiagnostics,
) {
    let Some(layers) = TriangleLayers::new(points, triangles, topology) else { return };
    let shifts = layers.shifts();
    let count = shifts.iter().filter(|shift| **shift != Vec3::zeros()).count();
    points.iter_mut().zip(shifts).for_each(|(x, shift)| *x += shift);
    diagnostics.repaired(
        count,
        Message::from(format!(
            "points of layers that lie in one place set {:.1} mm apart (a lining, a patch, a copy, front and back laid flat): \
             offset the layers in the file, or choose one with ",
            1e3 * TUNING.layer_gap
        )) + Setting::Garment,
    );
}

/// Returns the unfolded piece of cloth that each triangle belongs to.
fn unfolded_pieces(triangles: &[[PointIndex; 3]], normals: &[Vec3], topology: &Topology) -> Vec<u32> {
    let mut groups = Groups::new(triangles.len());
    for hinge in &topology.hinges {
        let [a, b] = hinge.triangles;
        if normals[a as usize].dot(&normals[b as usize]) > -TUNING.layer_min_cosine {
            groups.join(a, b);
        }
    }
    groups.numbered().0.iter().map(|piece| piece.0).collect()
}

/// A layer at one place.
#[derive(Debug, Clone, Copy, PartialEq)]
struct LayerAt {
    layer: u32,
    normal: Vec3,
}

/// A garment and the layers of its triangles.
struct TriangleLayers<'a> {
    points: &'a [Vec3],
    triangles: &'a [[PointIndex; 3]],
    /// One per triangle: unit normal, zero without area.
    normals: Vec<Vec3>,
    /// One per triangle.
    layer: Vec<u32>,
    bvh: TriangleBvh,
}

impl<'a> TriangleLayers<'a> {
    /// The layers; `None` if there is one only.
    fn new(points: &'a [Vec3], triangles: &'a [[PointIndex; 3]], topology: &Topology) -> Option<Self> {
        let normal = |t: &[PointIndex; 3]| triangle::normal(&triangle::corners(points, t));
        let normals: Vec<Vec3> = triangles.iter().map(|t| normal(t).unwrap_or_else(Vec3::zeros)).collect();
        let layer = unfolded_pieces(triangles, &normals, topology);
        let has_others = layer.iter().max() != Some(&0);
        has_others.then(|| Self {
            points,
            triangles,
            normals,
            layer,
            bvh: TriangleBvh::new(points, triangles, 0.0),
        })
    }

    /// Returns the displacement of each point that sets its layer apart from those in the same place.
    fn shifts(&self) -> Vec<Vec3> {
        let mut shifts = vec![Vec3::zeros(); self.points.len()];
        let mut at_point: Vec<Vec<LayerAt>> = vec![Vec::new(); self.points.len()];
        let mut joined = vec![false; self.points.len()];
        let mut own: Vec<Option<u32>> = vec![None; self.points.len()];
        for (f, t) in self.triangles.iter().enumerate() {
            for p in t {
                joined[p.at()] |= *own[p.at()].get_or_insert(self.layer[f]) != self.layer[f];
            }
        }
        for f in 0..self.triangles.len() {
            for (p, others) in self.others_at_corners(f) {
                let known = &mut at_point[p.at()];
                for other in others {
                    if known.iter().all(|k| k.layer != other.layer) {
                        known.push(other);
                    }
                }
            }
        }
        for (p, mut layers) in at_point.into_iter().enumerate() {
            if let Some(own) = own[p]
                && layers.len() > 1
                && !joined[p]
            {
                shifts[p] = shift_of(own, &mut layers);
            }
        }
        shifts
    }

    /// Returns per corner of triangle `f` the layers there, its own included, where another one coincides with it. They are
    /// looked for a little within the triangle: panels that meet at a border do not lie on one another.
    fn others_at_corners(&self, f: usize) -> Vec<(PointIndex, Vec<LayerAt>)> {
        let corners = triangle::corners(self.points, &self.triangles[f]);
        let centroid = corners.iter().sum::<Vec3>() / 3.0;
        let own = LayerAt { layer: self.layer[f], normal: self.normals[f] };
        let mut found = Vec::new();
        for (p, x) in self.triangles[f].iter().zip(&corners) {
            let within = x.lerp(&centroid, TUNING.layer_probe_fraction);
            let mut layers = vec![own];
            let is_other = |g: u32, layers: &[LayerAt]| {
                layers.iter().all(|known| known.layer != self.layer[g as usize])
                    && self.normals[g as usize].dot(&own.normal).abs() > TUNING.layer_min_cosine
            };
            while layers.len() <= TUNING.max_coincident_layers
                && let Some(near) =
                    self.bvh.nearest_where(self.points, within, TUNING.max_layer_distance, |g| {
                        is_other(g, &layers)
                    })
            {
                let g = near.triangle as usize;
                layers.push(LayerAt { layer: self.layer[g], normal: self.normals[g] });
            }
            if layers.len() > 1 {
                found.push((*p, layers));
            }
        }
        found
    }
}

/// Returns the displacement of layer `own` among `layers`.
fn shift_of(own: u32, layers: &mut [LayerAt]) -> Vec3 {
    layers.sort_unstable_by_key(|at| at.layer);
    let up = layers[0].normal;
    let (same, mut turned): (Vec<LayerAt>, Vec<LayerAt>) =
        layers.iter().copied().partition(|at| at.normal.dot(&up) > 0.0);
    turned.reverse();
    let order = || same.iter().chain(&turned);
    let rank = order().position(|at| at.layer == own).unwrap_or(0);
    up * (TUNING.layer_gap * (0.5 * (layers.len() as f64 - 1.0) - rank as f64))
}
