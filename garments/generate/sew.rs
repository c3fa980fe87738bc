//! Sewing: front and back become a closed garment that lies on the ground; a single panel becomes a sheet.
//!
//! The layers touch only at the seams. From there they separate like the faces of a lens and are parallel at the
//! distance `LAYER_DISTANCE`, so that a contact solver with a millimetre of thickness starts without contact.
//! Vertices stay split along the seams, where the texture of front and back differ; they coincide exactly, so
//! importing welds them.

use crate::Mesh;
use crate::outline::{Border, Boundary, boundary};
use crate::patterns::Pattern;
use crate::triangulate::{Panel, fill};
use crease_geometry::math::{Vec2, Vec3};

/// Distance between front and back away from the seams [m].
const LAYER_DISTANCE: f64 = 0.003;
/// Distance from the seam over which the layers separate [m].
const SEPARATION_LENGTH: f64 = 0.025;
/// Height of the lowest points above the ground [m].
const CLEARANCE: f64 = 0.001;
/// Free strip between the panels in the texture [m].
const TEXTURE_GAP: f64 = 0.02;

/// Makes the mesh of a pattern.
pub fn make(pattern: &Pattern) -> Mesh {
    let outline = |half| boundary(pattern.start, half, pattern.edge_m);
    let front = outline(&pattern.front);
    let mut mesh = Mesh::default();
    let texture = Texture::of(&front, pattern.back.is_some());
    let sheet = fill(&front, pattern.edge_m, Vec2::new(0.5, 0.5));
    match &pattern.back {
        None => add(&mut mesh, &sheet, |_| CLEARANCE, false, &texture),
        Some(half) => {
            // Each layer is half a gap from the middle plane; open borders have the full gap.
            let middle = CLEARANCE + LAYER_DISTANCE / 2.0;
            let half_gap = |b: &Boundary, p: Vec2| lens(b.distance(p, Some(Border::Sewn))) / 2.0;
            add(&mut mesh, &sheet, |p| middle + half_gap(&front, p), false, &texture);
            let back = outline(half);
            // The lattice of the back is shifted by the centroid of a triangle, so that its edges do not coincide
            // with the front's.
            let sheet = fill(&back, pattern.edge_m, Vec2::new(0.5 + 2.0 / 3.0, 0.5));
            add(&mut mesh, &sheet, |p| middle - half_gap(&back, p), true, &texture);
        }
    }
    centre_on_ground(&mut mesh);
    mesh.normals = normals(&mesh.positions, &mesh.triangles);
    mesh
}

/// Distance between the layers at `distance` from the nearest seam [m]: a quarter of an ellipse, steep at the seam,
/// so that the first row of points already has a gap of a millimetre.
fn lens(distance: f64) -> f64 {
    let t = (distance / SEPARATION_LENGTH).min(1.0);
    LAYER_DISTANCE * (t * (2.0 - t)).sqrt()
}

/// Layout of the panels in the texture: warp (the garment's length, downwards) along +u, front and back side by side
/// along v, not mirrored, at one scale.
struct Texture {
    low: Vec2,
    high: Vec2,
    metres_per_unit: f64,
}

impl Texture {
    fn of(outline: &Boundary, has_back: bool) -> Self {
        let (mut low, mut high) = (outline.points[0], outline.points[0]);
        for p in &outline.points {
            (low, high) = (low.inf(p), high.sup(p));
        }
        let size = high - low;
        let across = if has_back { 2.0 * size.x + TEXTURE_GAP } else { size.x };
        Self { low, high, metres_per_unit: size.y.max(across) }
    }

    fn uv(&self, p: Vec2, back: bool) -> Vec2 {
        let across =
            if back { self.high.x - self.low.x + TEXTURE_GAP + p.x - self.low.x } else { self.high.x - p.x };
        Vec2::new(self.high.y - p.y, across) / self.metres_per_unit
    }
}

/// Adds a panel at the height `height` [m].
fn add(mesh: &mut Mesh, panel: &Panel, height: impl Fn(Vec2) -> f64, back: bool, texture: &Texture) {
    let first = mesh.positions.len() as u32;
    for &p in &panel.points {
        mesh.positions.push(Vec3::new(p.x, height(p), -p.y));
        mesh.uvs.push(texture.uv(p, back));
    }
    mesh.triangles.extend(panel.triangles.iter().map(|&[a, b, c]| {
        let t = if back { [a, c, b] } else { [a, b, c] };
        t.map(|i| first + i)
    }));
}

/// Centres the garment's bounding box along z.
fn centre_on_ground(mesh: &mut Mesh) {
    let along = |p: &Vec3| p.z;
    let low = mesh.positions.iter().map(along).fold(f64::INFINITY, f64::min);
    let high = mesh.positions.iter().map(along).fold(f64::NEG_INFINITY, f64::max);
    for p in &mut mesh.positions {
        p.z -= (low + high) / 2.0;
    }
}

/// Smooth normals, weighted by triangle area. Front and back have no common vertices: seams are hard edges.
pub fn normals(positions: &[Vec3], triangles: &[[u32; 3]]) -> Vec<Vec3> {
    let mut sums = vec![Vec3::zeros(); positions.len()];
    for t in triangles {
        let [a, b, c] = t.map(|i| positions[i as usize]);
        let n = (b - a).cross(&(c - a));
        for &i in t {
            sums[i as usize] += n;
        }
    }
    sums.iter().map(|n| n.normalize()).collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::patterns;

    fn draft() -> Mesh {
        make(&patterns::all().swap_remove(1))
    }

    /// Warp is +u along the length, weft +v across; swapped axes would go unnoticed and give wrong creases.
    #[test]
    fn texture_follows_the_length_and_keeps_one_scale() {
        let mesh = draft();
        let mut scales = Vec::new();
        for t in &mesh.triangles {
            let [a, b, _] = t.map(|i| i as usize);
            let (d, e) = (mesh.positions[b] - mesh.positions[a], mesh.uvs[b] - mesh.uvs[a]);
            assert!((e.x * d.z >= 0.0) || e.x.abs() < 1e-9, "+u runs down the garment");
            scales.push(e.norm() / d.xz().norm());
            let [p, q, r] = t.map(|i| mesh.uvs[i as usize]);
            assert!(
                (q - p).perp(&(r - p)) < 0.0,
                "v grows downward, so a panel seen from outside turns clockwise"
            );
        }
        let (low, high) = scales.iter().fold((f64::MAX, 0.0f64), |(l, h), &s| (l.min(s), h.max(s)));
        assert!(high / low < 1.0 + 1e-9, "{low} {high}");
        assert!(mesh.uvs.iter().all(|uv| uv.min() >= 0.0 && uv.max() <= 1.0 + 1e-12));
    }

    #[test]
    fn it_lies_on_the_ground_front_up() {
        let mesh = draft();
        let low = mesh.positions.iter().map(|p| p.y).fold(f64::INFINITY, f64::min);
        let high = mesh.positions.iter().map(|p| p.y).fold(0.0, f64::max);
        assert!((low - 0.001).abs() < 1e-9 && (high - 0.004).abs() < 1e-9, "{low} {high}");
        for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
            assert!(p.y < 0.0024 || p.y > 0.0026 || n.y.abs() > 0.5, "{p} {n}");
            assert!((p.y <= 0.0026) || n.y > 0.0, "front faces up");
        }
    }
}
