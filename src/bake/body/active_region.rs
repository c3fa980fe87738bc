//! Selects the points that a moving body can affect; all others are fixed.
//!
//! Where only the body moves, cloth far from its moving parts stays where it is, on the static part of the body under it,
//! and is left out of the solve. Active are the points near a moving part of the body in any of its poses, those whose
//! leash moves, and those joined to them within a hand's breadth of cloth; also those that have no static part of the body
//! within that breadth: a free hem beside moving legs hangs on nothing that stays.

use crate::bake::BakeOptions;
use crate::bake::body::leash::GarmentLeash;
use crate::bake::tuning::TUNING;
use crate::wear::WearScript;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::triangle_bvh::TriangleBvh;
use crease_geometry::mesh::{PointIndex, edge_distances};
use crease_model::garment::Garment;

/// Points of `garment` that the body of `options` can affect during `script`, one flag per point. Empty when all points are
/// to be simulated: without a body, with a body that does not move, or with [`BakeOptions::deactivate_static`] off.
pub fn active_points(garment: &Garment, script: &WearScript, options: &BakeOptions) -> Vec<bool> {
    active_points_on(garment, GarmentLeash::new(garment, options).as_ref(), script, options)
}

/// The same for `garment` on its `leash`, if it has one.
pub(in crate::bake) fn active_points_on(
    garment: &Garment,
    leash: Option<&GarmentLeash>,
    script: &WearScript,
    options: &BakeOptions,
) -> Vec<bool> {
    let Some(animated) = options.body.as_ref().filter(|_| options.deactivate_static) else {
        return Vec::new();
    };
    let tuning = &TUNING.active_region;
    let poses = script.body_poses(animated);
    let start = animated.rest_points();
    let posed: Vec<Vec<Vec3>> = poses.iter().map(|pose| animated.points(pose)).collect();
    let moves = moving_points(start, &posed);
    let (moving, standing): (Vec<_>, Vec<_>) =
        animated.triangles().iter().partition(|t| t.iter().any(|p| moves[p.at()]));
    let all_poses = std::iter::once(start).chain(posed.iter().map(Vec::as_slice));
    let mut near_motion = points_near(garment, &moving, all_poses);
    if let Some(leash) = leash {
        let moved = leash.moved_points(&poses, tuning.min_body_motion);
        near_motion.iter_mut().zip(moved).for_each(|(near, moved)| *near |= moved);
    }
    let near_rest = points_near(garment, &standing, std::iter::once(start));
    let margin = tuning.geodesic_margin;
    let [to_motion, to_rest] = [near_motion, near_rest]
        .map(|near| edge_distances(&garment.points, &garment.topology, &near, margin));
    let can_move = to_motion.iter().any(|distance| *distance <= margin);
    let is_active = |(motion, rest): (&f64, &f64)| *motion <= margin || *rest > margin;
    let active: Vec<bool> = to_motion.iter().zip(&to_rest).map(is_active).collect();
    if can_move { active } else { Vec::new() }
}

/// Returns one flag per point of a body: whether it moves from `start` through `poses` [m].
fn moving_points(start: &[Vec3], poses: &[Vec<Vec3>]) -> Vec<bool> {
    let mut moves = vec![false; start.len()];
    for positions in poses {
        for ((moves, a), b) in moves.iter_mut().zip(start).zip(positions) {
            *moves |= (a - b).norm() > TUNING.active_region.min_body_motion;
        }
    }
    moves
}

/// Returns one flag per point of `garment`: whether it is near one of `triangles` of a body in any of its `poses` [m].
fn points_near<'a>(
    garment: &Garment,
    triangles: &[[PointIndex; 3]],
    poses: impl Iterator<Item = &'a [Vec3]>,
) -> Vec<bool> {
    let mut near = vec![false; garment.points.len()];
    if triangles.is_empty() {
        return near;
    }
    let mut tree: Option<TriangleBvh> = None;
    for positions in poses {
        let tree = tree.get_or_insert_with(|| TriangleBvh::new(positions, triangles, 0.0));
        tree.refit(positions, positions, 0.0);
        for (near, x) in near.iter_mut().zip(&garment.points).filter(|(near, _)| !**near) {
            *near = tree.nearest(positions, *x, TUNING.active_region.max_body_distance).is_some();
        }
    }
    near
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::files::GarmentFile;
    use crease_model::body::{AnimatedBody, BodyMotion, Sequence};
    use std::sync::Arc;

    /// A cube of 60 mm around `centre` [m].
    fn cube(centre: Vec3) -> Vec<Vec3> {
        let side = |k: usize, bit: usize| if k >> bit & 1 == 1 { 0.03 } else { -0.03 };
        (0..8).map(|k| centre + Vec3::new(side(k, 0), side(k, 1), side(k, 2))).collect()
    }

    /// A sheet of 0.2 x 1 m that rests on a cube at one end; a second cube below its middle goes down. The other end hangs free.
    #[test]
    fn cloth_stays_where_the_body_under_it_stays() {
        let faces = [
            [0, 2, 1],
            [1, 2, 3],
            [4, 5, 6],
            [5, 7, 6],
            [0, 1, 4],
            [1, 5, 4],
            [2, 6, 3],
            [3, 6, 7],
            [0, 4, 2],
            [2, 4, 6],
            [1, 3, 5],
            [3, 7, 5],
        ];
        let triangles: Vec<[u32; 3]> = faces.iter().copied().chain(faces.map(|t| t.map(|k| k + 8))).collect();
        let frame = |drop: f64| {
            let at = |z: f64, y: f64| cube(Vec3::new(0.1, y - 0.035, z));
            [at(0.05, 0.0), at(0.5, -drop)].concat()
        };
        let frames = vec![frame(0.0), frame(0.1)];
        let sequence = Sequence { rate: 1.0, frames: frames.clone() };
        let body = AnimatedBody::new("cubes", "", BodyMotion::Sequence(sequence), &frames[0], &triangles);
        let script = r#"{"format": "crease-wear/1", "actions": [{"play": {"clip": "frames"}}]}"#;
        let script = WearScript::parse("", script).expect("is a script");
        let options = BakeOptions { body: Some(Arc::new(body)), ..BakeOptions::default() };
        let sheet = GarmentFile::sheet([0.2, 1.0], [4, 40]).expect("is a sheet").garment;
        let active = active_points(&sheet, &script, &options);
        let all = |from: f64, to: f64, expected: bool| {
            let within = |z: f64| from <= z && z <= to;
            let mut points = sheet.points.iter().zip(&active).filter(|(x, _)| within(x.z));
            points.all(|(_, active)| *active == expected)
        };
        assert!(all(0.0, 0.1, false), "on the cube that stays");
        assert!(all(0.4, 0.6, true), "over the cube that moves");
        assert!(all(0.8, 1.0, true), "the free end");
    }
}
