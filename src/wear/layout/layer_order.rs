//! Order of the layers of a garment that lies: how many lie below a triangle, at its place.

use crate::wear::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_model::remesh::SurfaceMesh;
use rustc_hash::FxHashMap;

/// Triangles of a mesh that lies, by place, with their layers.
pub(crate) struct LayerOrder {
    /// Per triangle: number of layers below its centroid; 0 for triangles that were left out.
    below: Vec<u32>,
}

impl LayerOrder {
    /// The order of the triangles of `mesh`, at `positions` [m] (y is not looked at), with a corner that `near` selects. The tag of
    /// a triangle is its layer.
    pub fn new(mesh: &SurfaceMesh, positions: &[Vec3], near: impl Fn(usize) -> bool) -> Self {
        let cell = TUNING.prediction.layer_cell;
        let cell_of = |c: f64| (c / cell).floor() as i32;
        let flat =
            |f: u32| mesh.triangles[f as usize].map(|p| [positions[p as usize].x, positions[p as usize].z]);
        let faces: Vec<u32> = (0..mesh.triangles.len() as u32)
            .filter(|&f| {
                mesh.alive[f as usize] && mesh.triangles[f as usize].iter().any(|p| near(*p as usize))
            })
            .collect();
        let mut cells: FxHashMap<[i32; 2], Vec<u32>> = FxHashMap::default();
        for &f in &faces {
            let corners = flat(f);
            let span = |k: usize| {
                let all = corners.map(|c| c[k]);
                let low = all.iter().copied().fold(f64::INFINITY, f64::min);
                let high = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                cell_of(low)..=cell_of(high)
            };
            for i in span(0) {
                for j in span(1) {
                    cells.entry([i, j]).or_default().push(f);
                }
            }
        }
        let mut below = vec![0; mesh.triangles.len()];
        for &f in &faces {
            let corners = flat(f);
            let at = [0, 1].map(|k| corners.iter().map(|c| c[k]).sum::<f64>() / 3.0);
            let own = mesh.tag[f as usize];
            let here = cells.get(&at.map(cell_of)).into_iter().flatten();
            let lower = here.filter(|&&g| mesh.tag[g as usize] < own && contains(&flat(g), at));
            let mut layers: Vec<u32> = lower.map(|&g| mesh.tag[g as usize]).collect();
            layers.sort_unstable();
            layers.dedup();
            below[f as usize] = layers.len() as u32;
        }
        Self { below }
    }

    /// Number of layers below triangle `f`.
    pub fn below(&self, f: u32) -> u32 {
        self.below[f as usize]
    }
}

/// Whether a triangle of the plane, of either orientation, contains `p`.
fn contains(corners: &[[f64; 2]; 3], p: [f64; 2]) -> bool {
    let side = |k: usize| {
        let ([ax, ay], [bx, by]) = (corners[k], corners[(k + 1) % 3]);
        (bx - ax) * (p[1] - ay) - (by - ay) * (p[0] - ax)
    };
    let sides = [0, 1, 2].map(side);
    sides.iter().all(|s| *s >= 0.0) || sides.iter().all(|s| *s <= 0.0)
}
