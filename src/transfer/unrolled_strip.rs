//! Triangles of a surface around a line, unrolled into a plane from neighbour to neighbour: what is straight on the cloth is straight there.

use crease_geometry::math::Vec2;
use crease_model::remesh::GarmentSurface;
use rustc_hash::FxHashMap;
use std::cmp::Reverse;
use std::collections::BinaryHeap;

/// Unrolled triangles of a surface.
pub(super) struct UnrolledStrip<'a> {
    surface: &'a GarmentSurface,
    /// Per triangle: its corners in the plane [m].
    corners: FxHashMap<u32, [Vec2; 3]>,
    /// The triangles, in the order in which they were unrolled.
    pub order: Vec<u32>,
}

impl<'a> UnrolledStrip<'a> {
    /// Triangle `first` alone.
    pub fn new(surface: &'a GarmentSurface, first: u32) -> Self {
        let [a, b, c] = surface.corners(first as usize);
        let third = third_corner(
            [Vec2::zeros(), Vec2::new((b - a).norm(), 0.0)],
            [(c - a).norm(), (c - b).norm()],
            1.0,
        );
        let corners = [Vec2::zeros(), Vec2::new((b - a).norm(), 0.0), third];
        Self { surface, corners: FxHashMap::from_iter([(first, corners)]), order: vec![first] }
    }

    /// Corners of `face` in the plane [m], if it was unrolled.
    pub fn corners(&self, face: u32) -> Option<&[Vec2; 3]> {
        self.corners.get(&face)
    }

    /// Triangle `first` alone, with its `corners` in the plane [m].
    pub fn of(surface: &'a GarmentSurface, first: u32, corners: [Vec2; 3]) -> Self {
        Self { surface, corners: FxHashMap::from_iter([(first, corners)]), order: vec![first] }
    }

    /// Unrolls triangles beside those that are, the one with the least `distance` first; none without. It is given a triangle, the ends of the side at
    /// which it is reached, and its corners.
    pub fn grow(&mut self, distance: impl Fn(u32, &[Vec2; 2], &[Vec2; 3]) -> Option<f64>) {
        // Distances are positive, and so their bits are in order.
        let mut queue = BinaryHeap::new();
        let beside = |strip: &Self, face: u32| -> Vec<Reverse<(u64, u32, u32, u32)>> {
            let topology = &strip.surface.topology;
            let sides = topology.triangle_edges[face as usize].into_iter();
            let entry = |e: u32| {
                let hinge = &topology.hinges[topology.edge_hinge[e as usize]? as usize];
                let next = hinge.triangles[usize::from(hinge.triangles[0] == face)];
                if strip.corners.contains_key(&next) {
                    return None;
                }
                let side = strip.side(face, [hinge.points[0].0, hinge.points[1].0])?;
                let key = distance(next, &side, &strip.placed(next, face, e)?)?;
                Some(Reverse((key.to_bits(), next, face, e)))
            };
            sides.filter_map(entry).collect()
        };
        for face in &self.order {
            queue.extend(beside(self, *face));
        }
        while let Some(Reverse((_, next, from, edge))) = queue.pop() {
            if self.corners.contains_key(&next) {
                continue;
            }
            if let Some(corners) = self.placed(next, from, edge) {
                self.corners.insert(next, corners);
                self.order.push(next);
                queue.extend(beside(self, next));
            }
        }
    }

    /// The points `ends` of triangle `face` in the plane.
    fn side(&self, face: u32, ends: [u32; 2]) -> Option<[Vec2; 2]> {
        let corners = self.corners.get(&face)?;
        let t = &self.surface.triangles[face as usize];
        let place = |p: u32| t.iter().position(|q| q.0 == p).map(|k| corners[k]);
        Some([place(ends[0])?, place(ends[1])?])
    }

    /// Corners of triangle `next` beside `from`, on the other side of their `edge`.
    fn placed(&self, next: u32, from: u32, edge: u32) -> Option<[Vec2; 3]> {
        let ends = self.surface.topology.edges[edge as usize].map(|p| p.0);
        let [p, q] = self.side(from, ends)?;
        let apex_of =
            |face: u32| self.surface.triangles[face as usize].iter().position(|c| !ends.contains(&c.0));
        let apex = self.corners[&from][apex_of(from)?];
        let side = -(q - p).perp(&(apex - p)).signum();
        let x = |p: u32| self.surface.points[p as usize];
        let own = apex_of(next)?;
        let t = self.surface.triangles[next as usize];
        let lengths = ends.map(|end| (x(t[own].0) - x(end)).norm());
        let third = third_corner([p, q], lengths, side);
        Some(t.map(|c| {
            if c.0 == ends[0] {
                p
            } else if c.0 == ends[1] {
                q
            } else {
                third
            }
        }))
    }
}

/// The place at the distances `lengths` [m] from the ends `p` and `q` of a side, to its left where `side` is positive.
fn third_corner([p, q]: [Vec2; 2], lengths: [f64; 2], side: f64) -> Vec2 {
    let length = (q - p).norm().max(f64::MIN_POSITIVE);
    let along = (q - p) / length;
    let foot = 0.5 * (length + (lengths[0] * lengths[0] - lengths[1] * lengths[1]) / length);
    let height = (lengths[0] * lengths[0] - foot * foot).max(0.0).sqrt();
    p + along * foot + Vec2::new(-along.y, along.x) * (side * height)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crease_geometry::math::Vec3;
    use crease_model::garment::Garment;

    #[test]
    fn a_rolled_sheet_unrolls_to_its_own_size() {
        let mut garment = Garment::sheet([0.3, 0.1], [30, 10]).expect("is a sheet");
        let low = garment.points.iter().map(|x| x.x).fold(f64::INFINITY, f64::min);
        let flat: Vec<Vec3> = garment.points.clone();
        for x in &mut garment.points {
            let angle = (x.x - low) / 0.06;
            *x = Vec3::new(0.06 * angle.sin(), x.y + 0.06 * angle.cos(), x.z);
        }
        let surface = GarmentSurface::without_texture(&garment);
        let mut strip = UnrolledStrip::new(&surface, 0);
        strip.grow(|_, _, _| Some(0.0));
        assert_eq!(strip.order.len(), garment.triangles.len());
        let place = |p: usize| {
            let f = garment.triangles.iter().position(|t| t.iter().any(|q| q.at() == p)).expect("is used");
            let k = garment.triangles[f].iter().position(|q| q.at() == p).expect("is a corner");
            strip.corners(f as u32).expect("was unrolled")[k]
        };
        for (a, b) in [(0, flat.len() - 1), (10, 200), (3, 330)] {
            let [own, unrolled] = [(flat[a] - flat[b]).norm(), (place(a) - place(b)).norm()];
            assert!((own / unrolled - 1.0).abs() < 2e-3, "{own} {unrolled}");
        }
    }
}
