//! Parts of a body that a garment does not rest on: clothes that are worn over it, and parts that are left out by name.

use crate::body::animated_body::AnimatedBody;
use crate::body::garment_skin::main_nodes;
use crate::body::lookup::LookupError;
use crate::body::rig::Rig;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_geometry::mesh::point_in_solid::point_normals;
use crease_geometry::mesh::triangle_bvh::TriangleBvh;

/// Distance within which a part lies over or under a garment [m].
const NEAR: f64 = 0.05;
/// Fraction of the points of a garment that a part must be near to lie over it [-].
const MIN_NEAR_FRACTION: f64 = 0.1;
/// Fraction of those that must be on its inner side [-].
const MIN_INNER_FRACTION: f64 = 0.8;
/// Depth on the inner side from which a point counts [m]: a fitted garment lies in its body by less.
const MIN_DEPTH: f64 = 1e-3;

impl AnimatedBody {
    /// Returns whether it lies over `garment` [m], as a jacket over a shirt: most of the points near it are on its inner side.
    pub fn lies_over(&self, garment: &[Vec3]) -> bool {
        let (points, triangles) = (self.rest_points(), self.triangles());
        let normals = point_normals(points, triangles);
        let bvh = TriangleBvh::new(points, triangles, 0.0);
        let (mut near, mut inner) = (0, 0);
        for x in garment {
            let Some(nearest) = bvh.nearest(points, *x, NEAR) else { continue };
            let corners = triangles[nearest.triangle as usize].map(PointIndex::at);
            let weights = nearest.weights();
            let normal: Vec3 = corners.iter().zip(weights).map(|(c, w)| normals[*c] * w).sum();
            let at: Vec3 = corners.iter().zip(weights).map(|(c, w)| points[*c] * w).sum();
            near += 1;
            inner += usize::from((x - at).dot(&normal) < -MIN_DEPTH * normal.norm());
        }
        f64::from(near) >= MIN_NEAR_FRACTION * garment.len() as f64
            && inner as f64 >= MIN_INNER_FRACTION * f64::from(near)
            && near > 0
    }

    /// Leaves out the triangles that the joint called `wanted`, or one below it, moves most. Returns their number.
    ///
    /// # Errors
    /// There is no such joint.
    pub fn leave_out(&mut self, wanted: &str) -> Result<usize, LookupError> {
        let joint = self.find_joint(wanted)?;
        let Some(rig) = self.rig() else { return Err(LookupError::nothing("joint", wanted)) };
        let is_below = |node: usize| node == joint || rig.skeleton.ancestors(node).any(|up| up == joint);
        let left_out: Vec<bool> =
            main_joints(rig).into_iter().map(|node| node.is_some_and(is_below)).collect();
        Ok(self.remove_triangles(|vertex| left_out.get(vertex).copied().unwrap_or(false)))
    }

    /// Returns the joints that move a vertex more than every other joint does: name, or number without one, and how many vertices
    /// each.
    pub fn moving_joints(&self) -> Vec<(String, usize)> {
        let Some(rig) = self.rig() else { return Vec::new() };
        let mut counts = vec![0; rig.skeleton.nodes().len()];
        main_joints(rig).into_iter().flatten().for_each(|node| counts[node] += 1);
        let moving = counts.into_iter().enumerate().filter(|(_, count)| *count > 0);
        moving.map(|(node, count)| (self.node_name(node), count)).collect()
    }
}

/// Returns per vertex of `rig` the joint that moves it most.
fn main_joints(rig: &Rig) -> Vec<Option<usize>> {
    let identity: Vec<Option<usize>> = (0..rig.skeleton.nodes().len()).map(Some).collect();
    main_nodes(rig, &identity, rig)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::body::BodyMotion;

    /// A tube of radius 0.1 m along y, its faces outwards.
    fn tube() -> AnimatedBody {
        let mut points = Vec::new();
        for (y, k) in [0.0, 0.5].into_iter().flat_map(|y| (0..16).map(move |k| (y, k))) {
            let angle = std::f64::consts::TAU * f64::from(k) / 16.0;
            points.push(Vec3::new(0.1 * angle.sin(), y, 0.1 * angle.cos()));
        }
        let faces = |k: u32| {
            let (a, b) = (k, (k + 1) % 16);
            [[a, b, b + 16], [a, b + 16, a + 16]]
        };
        let triangles: Vec<[u32; 3]> = (0..16).flat_map(faces).collect();
        AnimatedBody::new("tube", "", BodyMotion::Still, &points, &triangles)
    }

    #[test]
    fn a_part_lies_over_what_is_inside_it() {
        let ring = |radius: f64| -> Vec<Vec3> {
            let at = |k: u32| std::f64::consts::TAU * f64::from(k) / 30.0;
            (0..30).map(|k| Vec3::new(radius * at(k).sin(), 0.25, radius * at(k).cos())).collect()
        };
        assert!(tube().lies_over(&ring(0.08)));
        assert!(!tube().lies_over(&ring(0.12)), "a body under the garment");
        assert!(!tube().lies_over(&ring(0.3)), "far away");
    }
}
