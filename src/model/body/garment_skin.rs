//! The skin of a garment in its file: where the joints of the body would carry each point of the cloth.
//!
//! Characters come with clothes that are bound to the skeleton of the body. A bake simulates the cloth instead, and may
//! keep it near those places. The skin belongs to the vertices of the file; points of any mesh on the same surface are
//! bound to the triangle that they lie in. Joints are those of the body: of one file by their number, of two files by
//! their names.

use crate::body::animated_body::{AnimatedBody, BodyPose};
use crate::body::rig::{JointInfluence, Rig, RigPiece, SkinBinding};
use crease_geometry::math::{Mat4, Vec3};
use crease_geometry::mesh::triangle_bvh::TriangleBvh;
use crease_geometry::mesh::{PointIndex, triangle};
use rayon::prelude::*;
use std::collections::HashMap;
use std::fmt;

/// Distance from the surface of the file within which a point lies on it [m].
const MAX_SURFACE_DISTANCE: f64 = 2e-3;
/// Distance of the skinned vertices from those of the garment, in the pose of the file of the body, within which both files
/// have the same pose [m].
const MAX_POSE_DIFFERENCE: f64 = 5e-3;

/// Skin of a garment, moved by the joints of a body.
#[derive(Clone, PartialEq)]
pub struct GarmentSkin {
    rig: Rig,
    /// Per node of the rig: the node of the body.
    body_node: Vec<Option<usize>>,
    /// Vertices in the pose of the file [m].
    vertices: Vec<Vec3>,
    triangles: Vec<[PointIndex; 3]>,
    /// Per vertex: the node of the body that moves it most; `None` for one that the body does not move.
    main_node: Vec<Option<usize>>,
    /// Per vertex: 1 where it is held, 0 where it is not, if the file says so.
    held: Option<Vec<f64>>,
}

/// Location of a point on the surface of the file.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SkinLocation {
    /// Corners of the triangle: vertices.
    pub corners: [u32; 3],
    /// Weights of the corners [-].
    pub weights: [f64; 3],
}

impl SkinLocation {
    /// Returns the mean of `values`, one per vertex, by the weights.
    fn mean<T>(&self, values: &[T]) -> T
    where
        T: Copy + std::ops::Mul<f64, Output = T> + std::ops::Add<Output = T>,
    {
        let [a, b, c] = [0, 1, 2].map(|k| values[self.corners[k] as usize] * self.weights[k]);
        a + b + c
    }

    /// Returns the corner with the largest weight.
    fn nearest_corner(&self) -> usize {
        self.corners[triangle::nearest_corner(&self.weights)] as usize
    }
}

impl fmt::Debug for GarmentSkin {
    /// Writes what tells two skins of one garment apart, not all numbers.
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let moved = self.main_node.iter().flatten().count();
        let held: Option<f64> = self.held.as_ref().map(|held| held.iter().sum());
        write!(out, "GarmentSkin({moved} of {} vertices, held {held:?})", self.vertices.len())
    }
}

impl GarmentSkin {
    /// Creates the skin of a garment with the `triangles` between the vertices of `rig` for `body`; `same_file` where both are
    /// of one file. `held` is 1 for vertices that are held and 0 for others, if the file says so.
    ///
    /// # Errors
    /// The reason why the garment cannot follow the body.
    pub fn new(
        rig: Rig,
        triangles: &[[u32; 3]],
        held: Option<Vec<f64>>,
        body: &AnimatedBody,
        same_file: bool,
    ) -> Result<Self, &'static str> {
        let Some(body_rig) = body.rig() else { return Err("the body has no skeleton") };
        let body_node = nodes_of_body(&rig, body_rig, same_file);
        let main_node = main_nodes(&rig, &body_node, body_rig);
        if main_node.iter().all(Option::is_none) {
            return Err("no joint of the body moves the garment in its file");
        }
        let vertices = rig.vertices(&rig.skeleton.rest(), None);
        let triangles = triangles.iter().map(|t| t.map(PointIndex)).collect();
        let skin = Self { rig, body_node, vertices, triangles, main_node, held };
        let there = skin.vertices(body, &body.rest());
        let pairs = there.iter().zip(&skin.vertices).zip(&skin.main_node);
        let farthest = pairs.filter(|(_, node)| node.is_some()).map(|((a, b), _)| (a - b).norm());
        if farthest.fold(0.0, f64::max) > MAX_POSE_DIFFERENCE {
            return Err("the garment has another pose in its file than the body in its own");
        }
        Ok(skin)
    }

    /// Returns the location of each of `points` [m], in the pose of the file; `None` for points that the body does not move.
    pub fn locate(&self, points: &[Vec3]) -> Vec<Option<SkinLocation>> {
        let bvh = TriangleBvh::new(&self.vertices, &self.triangles, 0.0);
        let locate = |point: &Vec3| {
            let nearest = bvh.nearest(&self.vertices, *point, MAX_SURFACE_DISTANCE)?;
            let corners = self.triangles[nearest.triangle as usize].map(|v| v.0);
            let is_moved = corners.iter().all(|&v| self.main_node[v as usize].is_some());
            is_moved.then_some(SkinLocation { corners, weights: nearest.weights() })
        };
        points.par_iter().map(locate).collect()
    }

    /// Returns the vertices in a pose of `body` [m].
    fn vertices(&self, body: &AnimatedBody, pose: &BodyPose) -> Vec<Vec3> {
        let (Some(rig), Some(pose)) = (body.rig(), pose.joints()) else { return self.vertices.clone() };
        let theirs = rig.scene_transforms(pose);
        let own = self.rig.scene_transforms(&self.rig.skeleton.rest());
        let transform = |(node, own): (&Option<usize>, Mat4)| {
            node.and_then(|node| theirs.get(node)).copied().unwrap_or(own)
        };
        let worlds: Vec<Mat4> = self.body_node.iter().zip(own).map(transform).collect();
        self.rig.vertices_under(&worlds, None)
    }

    /// Returns the skinned positions at `locations` in a pose of `body` [m].
    pub fn positions(
        &self,
        locations: &[Option<SkinLocation>],
        body: &AnimatedBody,
        pose: &BodyPose,
    ) -> Vec<Option<Vec3>> {
        let vertices = self.vertices(body, pose);
        locations.iter().map(|at| at.as_ref().map(|at| at.mean(&vertices))).collect()
    }

    /// Returns the node of the body that moves each location most.
    pub fn main_nodes(&self, locations: &[Option<SkinLocation>]) -> Vec<Option<usize>> {
        locations.iter().map(|at| self.main_node[at.as_ref()?.nearest_corner()]).collect()
    }

    /// Returns how much each location is held, 0 to 1, if the file says so.
    pub fn held(&self, locations: &[Option<SkinLocation>]) -> Option<Vec<f64>> {
        let held = self.held.as_ref()?;
        Some(locations.iter().map(|at| at.as_ref().map_or(0.0, |at| at.mean(held))).collect())
    }
}

/// Returns per node of `body` whether it is of a tree that moves vertices.
fn skeleton_nodes(body: &Rig) -> Vec<bool> {
    let top = |node: usize| body.skeleton.ancestors(node).last().unwrap_or(node);
    let direct = body.influencing_nodes();
    let tops: Vec<usize> = (0..direct.len()).filter(|&node| direct[node]).map(top).collect();
    (0..direct.len()).map(|node| tops.contains(&top(node))).collect()
}

/// Returns per node of `rig` the node of the skeleton of `body`: itself, where both are of one file, else the one of its name,
/// where there is one and only one. A file may hold a skeleton for the clothes beside that of the body.
fn nodes_of_body(rig: &Rig, body: &Rig, same_file: bool) -> Vec<Option<usize>> {
    let of_skeleton = skeleton_nodes(body);
    let mut by_name: HashMap<&str, Option<usize>> = HashMap::new();
    let nodes = body.skeleton.nodes().iter().enumerate();
    for (number, node) in nodes.filter(|(number, node)| of_skeleton[*number] && !node.name.is_empty()) {
        let found = by_name.entry(&node.name).or_insert(Some(number));
        *found = found.filter(|&first| first == number);
    }
    let own = rig.skeleton.nodes().iter().enumerate();
    own.map(|(number, node)| match same_file && of_skeleton.get(number) == Some(&true) {
        true => Some(number),
        false => by_name.get(node.name.as_str()).copied().flatten(),
    })
    .collect()
}

/// Returns per vertex of `rig` the node of `body` that moves it most, by `body_node`; `None` for one that does not follow the
/// skeleton of the body.
pub(super) fn main_nodes(rig: &Rig, body_node: &[Option<usize>], body: &Rig) -> Vec<Option<usize>> {
    let joints = body.pieces.iter().flat_map(RigPiece::joint_nodes).collect::<Vec<_>>();
    let of_body = |node: usize| body_node.get(node).copied().flatten();
    let of_piece = |piece: &RigPiece| -> Vec<Option<usize>> {
        match &piece.binding {
            SkinBinding::Static => vec![None; piece.positions.len()],
            // A mesh that hangs on a joint follows it; one beside the joints does not.
            SkinBinding::Node(node) => {
                let is_joint = |node: usize| joints.contains(&node);
                let follows = |node: &usize| is_joint(*node) || body.skeleton.ancestors(*node).any(is_joint);
                vec![of_body(*node).filter(follows); piece.positions.len()]
            }
            SkinBinding::Skin { joints, influences } => {
                let heaviest = |own: &Vec<JointInfluence>| {
                    let heaviest = own.iter().max_by(|a, b| a.weight.total_cmp(&b.weight))?;
                    of_body(joints.get(heaviest.joint as usize)?.node)
                };
                influences.iter().map(heaviest).collect()
            }
        }
    };
    rig.pieces.iter().flat_map(of_piece).collect()
}
