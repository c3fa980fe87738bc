//! Which points and edges of a body hold up which triangles and edges of the cloth (`energy::EdgeContact`).
//!
//! A point of the body holds up the cloth on the line along its normal, of several layers the innermost; an edge of it the
//! edges of cloth that run across it, nearest to it in between their ends. One that has been pressed through its cloth pushes from
//! farther away in the next step, until it no longer is. Does not do: friction, and what lies in a fold of the body.

use crate::contact::body_planes::{BodyContactSettings, SINKING};
use crate::energy::EdgeContact;
use crate::math::Vec3;
use crate::mesh::distance::edge_edge;
use crate::mesh::point_in_solid::point_areas;
use crate::mesh::triangle_bvh::TriangleBvh;
use crate::mesh::{PointIndex, Topology};
use rayon::prelude::*;

/// Cloth over a point is looked for within this [m],
const OVER: f64 = 0.01;
/// an edge across an edge within this,
const ACROSS: f64 = 6e-3;
/// and on the wrong side within this: what is deeper inside is caught between two parts of the body.
const INSIDE: f64 = 2.5e-3;
/// The way from one edge to the other makes at least this cosine with the normal: edges side by side do not meet.
const UPRIGHT: f64 = 0.5;
/// Places nearer to an end of an edge than this share of it are the end's.
const END: f64 = 0.02;
/// What is pressed nearer than this share of what it holds cloth up by pushes from farther in the next step.
const LEFT: f64 = 0.5;
/// They are this many times as stiff as a point of the cloth is pushed: one may have to hold up all of the cloth around.
const STIFFER: f64 = 4.0;
/// They are raised by at most this many reaches.
const HIGHEST: f64 = 3.0;

/// What of a body is under triangles and edges of cloth.
pub(super) struct BodyEdges {
    topology: Topology,
    /// Per point of the body: the part of its surface that is nearest to it [m²].
    areas: Vec<f64>,
    /// Per point of the body: how much higher than its reach it holds cloth up [m].
    pub raised: Vec<f64>,
    /// In this step.
    over: Vec<Over>,
}

/// A place of the body and the cloth over it at the beginning of a step.
#[derive(Debug, Clone, Copy)]
struct Over {
    ends: [u32; 2],
    share: [f64; 2],
    points: [u32; 3],
    weights: [f64; 3],
}

/// A body: its points [m], the tree over its triangles, its normals.
type Surface<'a> = (&'a [Vec3], &'a TriangleBvh, &'a [Vec3]);

impl BodyEdges {
    /// Of a body of `triangles` at `points` [m].
    pub fn new(points: &[Vec3], triangles: &[[PointIndex; 3]]) -> Self {
        Self {
            topology: Topology::new(points.len(), triangles),
            areas: point_areas(points, triangles),
            raised: vec![0.0; points.len()],
            over: Vec::new(),
        }
    }

    /// A step begins with the cloth at `x`, of triangles `cloth` and their `topology`.
    pub fn begin_step(
        &mut self,
        x: &[Vec3],
        cloth: &[[PointIndex; 3]],
        topology: &Topology,
        is_held: &impl Fn(usize) -> bool,
        (body, under, normals): Surface,
    ) {
        let moves = |t: &[PointIndex; 3]| t.iter().any(|p| !is_held(p.at()));
        let moving: Vec<usize> = (0..cloth.len()).filter(|f| moves(&cloth[*f])).collect();
        let moving_triangles: Vec<_> = moving.iter().map(|f| cloth[*f]).collect();
        let tree = TriangleBvh::new(x, &moving_triangles, ACROSS);
        let look = |(corner, (at, normal)): (usize, (&Vec3, &Vec3))| {
            let hit = tree.first_hit(x, at - normal * INSIDE, *normal, INSIDE + OVER)?;
            let points = moving_triangles[hit.triangle as usize].map(|p| p.0);
            Some(Over { ends: [corner as u32; 2], share: [1.0, 0.0], points, weights: hit.weights })
        };
        self.over = body.par_iter().zip(normals).enumerate().filter_map(look).collect();
        for [f, g] in tree.overlapping_pairs_with(under) {
            // Every edge is its first triangle's.
            let owned = |topology: &Topology, f: usize| {
                let edges = topology.triangle_edges[f].map(|e| e as usize);
                edges.map(|e| (topology.edge_triangles[e][0] as usize == f).then(|| topology.edges[e]))
            };
            for own in owned(topology, moving[f as usize]).into_iter().flatten() {
                for of_body in owned(&self.topology, g as usize).into_iter().flatten() {
                    self.over.extend(across(x, own, body, normals, of_body));
                }
            }
        }
    }

    /// For a step that leads the body to `target` with `normals`; `folded` tells which of its points lie on others.
    pub fn edge_contacts(
        &self,
        target: &[Vec3],
        normals: &[Vec3],
        folded: &[bool],
        settings: &BodyContactSettings,
    ) -> Vec<EdgeContact> {
        let open = self.over.iter().filter(|over| !over.ends.iter().any(|p| folded[*p as usize]));
        let each = |over: &Over| {
            let mean = |of: &[f64]| -> f64 {
                over.ends.iter().zip(over.share).map(|(p, w)| of[*p as usize] * w).sum()
            };
            let of_cloth: f64 =
                over.points.iter().zip(over.weights).map(|(p, w)| settings.areas[*p as usize] * w).sum();
            let [place, normal] = [target, normals].map(|of| between(of, over.ends, over.share));
            Some(EdgeContact {
                edge: over.ends,
                edge_weights: over.share,
                points: over.points,
                weights: over.weights,
                anchor: place,
                normal: normal.try_normalize(1e-9)?,
                dhat: settings.edge_dhat + mean(&self.raised),
                stiffness: STIFFER * settings.stiffness * mean(&self.areas).max(of_cloth),
            })
        };
        open.filter_map(each).collect()
    }

    /// The step is over with the cloth at `x`; `supports` were those of the step.
    pub fn accept(&mut self, x: &[Vec3], supports: &[EdgeContact], settings: &BodyContactSettings) {
        let highest = HIGHEST * settings.point_dhat;
        let mut missing = vec![0.0f64; self.raised.len()];
        for support in supports {
            let amount = LEFT * settings.edge_dhat - support.gap(x);
            for (p, w) in support.edge.iter().zip(support.edge_weights) {
                missing[*p as usize] = missing[*p as usize].max(w * amount);
            }
        }
        for (raised, missing) in self.raised.iter_mut().zip(missing) {
            *raised = (*raised * (1.0 - SINKING) + missing).min(highest);
        }
    }
}

/// The edge `own` of the cloth at `x` across the edge `of_body`, if it is.
fn across(
    x: &[Vec3],
    own: [PointIndex; 2],
    body: &[Vec3],
    normals: &[Vec3],
    of_body: [PointIndex; 2],
) -> Option<Over> {
    let ([a, b], [c, d]) = (own.map(PointIndex::at), of_body.map(PointIndex::at));
    let gap = edge_edge(&x[a], &x[b], &body[c], &body[d]);
    let (on_own, share) = ([gap.weights[0], gap.weights[1]], [-gap.weights[2], -gap.weights[3]]);
    let inside = on_own.iter().chain(&share).all(|w| *w > END);
    let ends = [c as u32, d as u32];
    let normal = between(normals, ends, share).try_normalize(1e-9)?;
    let height = gap.vector.dot(&normal);
    let upright = height.abs() >= UPRIGHT * gap.distance;
    let most = if height < 0.0 { INSIDE } else { ACROSS };
    (inside && upright && gap.distance <= most).then(|| Over {
        ends,
        share,
        points: [a as u32, b as u32, b as u32],
        weights: [on_own[0], on_own[1], 0.0],
    })
}

fn between(of: &[Vec3], ends: [u32; 2], share: [f64; 2]) -> Vec3 {
    ends.iter().zip(share).map(|(p, w)| of[*p as usize] * w).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::{EdgeContacts, Energy};
    use crate::mesh::point_in_solid::point_normals;

    fn settings(points: usize) -> BodyContactSettings {
        BodyContactSettings {
            point_dhat: 1e-3,
            edge_dhat: 5e-4,
            stiffness: 1e6,
            areas: vec![1e-4; points],
            friction: 0.5,
            slip_velocity_tol: 1e-3,
        }
    }

    /// A roof whose ridge lies along x at height 0, its eaves 20 mm lower.
    fn roof() -> (Vec<Vec3>, Vec<[PointIndex; 3]>) {
        let at = |x: f64, y: f64, z: f64| Vec3::new(x, y, z);
        let points = vec![
            at(-0.05, 0.0, 0.0),
            at(0.05, 0.0, 0.0),
            at(-0.05, -0.02, 0.03),
            at(0.05, -0.02, 0.03),
            at(-0.05, -0.02, -0.03),
            at(0.05, -0.02, -0.03),
        ];
        let triangles = [[0, 2, 3], [0, 3, 1], [0, 1, 5], [0, 5, 4]].map(|t| t.map(PointIndex)).to_vec();
        (points, triangles)
    }

    fn supports(x: &[Vec3], cloth: &[[PointIndex; 3]], held: bool, folded: bool) -> Vec<EdgeContact> {
        let (body, triangles) = roof();
        let normals = point_normals(&body, &triangles);
        let under = TriangleBvh::new(&body, &triangles, 0.0);
        let mut support = BodyEdges::new(&body, &triangles);
        let topology = Topology::new(x.len(), cloth);
        support.begin_step(x, cloth, &topology, &|_| held, (&body, &under, &normals));
        support.edge_contacts(&body, &normals, &vec![folded; body.len()], &settings(x.len()))
    }

    /// Edges of a triangle cross the ridge 0.4 mm under it, while all its points are outside the roof.
    #[test]
    fn a_ridge_holds_up_edges_that_cross_it() {
        let x = [Vec3::new(0.0, -4e-4, 0.008), Vec3::new(0.0, -4e-4, -0.008), Vec3::new(0.012, -4e-4, 0.008)];
        let cloth = [[0, 1, 2].map(PointIndex)];
        let found = supports(&x, &cloth, false, false);
        assert!(!found.is_empty());
        for support in &found {
            assert!((support.gap(&x) + 4e-4).abs() < 1e-12 && support.normal.y > 0.999, "{support:?}");
            assert_eq!(support.edge, [0, 1]);
        }
        let mut g = [Vec3::zeros(); 3];
        EdgeContacts(&found).add_gradient(&x, &mut g);
        assert!(g.iter().all(|g| g.y < 0.0), "pushed up: {g:?}");
        assert!(supports(&x, &cloth, true, false).is_empty(), "what is held is not");
        assert!(supports(&x, &cloth, false, true).is_empty(), "nothing in a fold");
        let deep = x.map(|p| p - Vec3::new(0.0, 0.004, 0.0));
        assert!(supports(&deep, &cloth, false, false).is_empty(), "caught between two parts of a body");
    }

    /// The end of the ridge lies under the middle of a triangle whose points are far outside.
    #[test]
    fn a_corner_holds_up_the_triangle_over_it_and_pushes_from_farther_while_it_is_through() {
        let over =
            |height: f64| [[-0.06, 0.02], [-0.06, -0.02], [-0.03, 0.0]].map(|[x, z]| Vec3::new(x, height, z));
        let cloth = [[0, 1, 2].map(PointIndex)];
        let (body, triangles) = roof();
        let normals = point_normals(&body, &triangles);
        let under = TriangleBvh::new(&body, &triangles, 0.0);
        let mut support = BodyEdges::new(&body, &triangles);
        let topology = Topology::new(3, &cloth);
        let x = over(2e-4);
        support.begin_step(&x, &cloth, &topology, &|_| false, (&body, &under, &normals));
        let found = support.edge_contacts(&body, &normals, &[false; 6], &settings(3));
        let corner = found.iter().find(|s| s.edge == [0, 0]).expect("has one");
        assert!((corner.gap(&x) - 2e-4).abs() < 1e-12);
        assert_eq!(corner.dhat, 5e-4);
        // A tenth of a millimetre through it, then far over it.
        support.accept(&over(-1e-4), &found, &settings(3));
        assert!((support.raised[0] - 3.5e-4).abs() < 1e-12, "{}", support.raised[0]);
        support.accept(&over(1e-2), &found, &settings(3));
        assert!((support.raised[0] - 3.5e-4 * (1.0 - SINKING)).abs() < 1e-12);
        for _ in 0..50 {
            support.accept(&over(-1e-4), &found, &settings(3));
        }
        assert_eq!(support.raised[0], HIGHEST * 1e-3, "and no farther");
    }
}
