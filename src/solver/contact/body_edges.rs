//! Points and edges of a body under triangles and edges of the cloth (`energy::EdgeContact`).
//!
//! A point of the body carries the cloth on the line along its normal, of several layers the innermost; an edge carries the edges of the cloth
//! that run across it, if the nearest positions lie between their ends. A contact that has been pressed through its cloth acts from farther
//! away in the next step, until it no longer is. There is no friction, and no contact in a self fold of the body.

use crate::contact::broad_phase::PairKind;
use crate::contact::self_fold::{BodySurface, ClothSurface};
use crate::contact::settings::BodyContactSettings;
use crate::contact::tuning::TUNING;
use crate::energy::EdgeContact;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::distance::edge_edge;
use crease_geometry::mesh::point_in_solid::point_areas;
use crease_geometry::mesh::triangle_bvh::TriangleBvh;
use crease_geometry::mesh::{PointIndex, Topology};
use rayon::prelude::*;
use rustc_hash::{FxHashMap, FxHashSet};

/// Points and edges of a body with the cloth over them.
pub(super) struct BodyEdges {
    topology: Topology,
    /// Hierarchy over the triangles of the cloth that can move.
    cloth: Option<TriangleBvh>,
    /// Areas of the points of the body [m²].
    areas: Vec<f64>,
    /// Offsets of the points of the body [m].
    pub offsets: Vec<f64>,
    /// Contacts of this step.
    overlaps: Vec<Overlap>,
    /// Those of the beginning of the step, and the offsets there.
    begun: (Vec<Overlap>, Vec<f64>),
}

/// A position on an edge of the body and the cloth over it at the beginning of a step.
#[derive(Debug, Clone, Copy)]
struct Overlap {
    /// Ends of the edge; a point of the body twice.
    edge: [u32; 2],
    /// Barycentric coordinates on the edge.
    edge_weights: [f64; 2],
    /// Corners of a triangle of the cloth; the ends of an edge of the cloth, the second twice.
    points: [u32; 3],
    /// Barycentric coordinates in the triangle.
    weights: [f64; 3],
}

/// Triangles of the cloth in which those on a line are searched.
#[derive(Clone, Copy)]
struct TriangleQuery<'a> {
    /// Positions of the cloth [m], one per point.
    x: &'a [Vec3],
    triangles: &'a [[PointIndex; 3]],
    /// Hierarchy over the triangles.
    bvh: &'a TriangleBvh,
}

impl BodyEdges {
    /// Points and edges of a body of `triangles` at `points` [m].
    pub fn new(points: &[Vec3], triangles: &[[PointIndex; 3]]) -> Self {
        Self {
            topology: Topology::new(points.len(), triangles),
            cloth: None,
            areas: point_areas(points, triangles),
            offsets: vec![0.0; points.len()],
            overlaps: Vec::new(),
            begun: (Vec::new(), vec![0.0; points.len()]),
        }
    }

    /// Starts a step with the cloth at `x` [m], of triangles `cloth` and their `topology`, over `body`.
    pub fn begin_step(
        &mut self,
        x: &[Vec3],
        cloth: &[[PointIndex; 3]],
        topology: &Topology,
        is_fixed: &impl Fn(usize) -> bool,
        body: BodySurface,
    ) {
        let tuning = &TUNING.body;
        let moves = |t: &[PointIndex; 3]| t.iter().any(|p| !is_fixed(p.at()));
        let moving: Vec<usize> = (0..cloth.len()).filter(|f| moves(&cloth[*f])).collect();
        let moving_triangles: Vec<_> = moving.iter().map(|f| cloth[*f]).collect();
        let bvh = TriangleBvh::fitted(&mut self.cloth, x, &moving_triangles, tuning.max_edge_distance);
        let cloth_near = TriangleQuery { x, triangles: &moving_triangles, bvh };
        let over_point =
            |(point, (at, normal)): (usize, (&Vec3, &Vec3))| over_point(cloth_near, point, *at, *normal);
        self.overlaps = body.x.par_iter().zip(body.normals).enumerate().filter_map(over_point).collect();
        // Every edge belongs to its first triangle.
        let owned = |topology: &Topology, f: usize| {
            let edges = topology.triangle_edges[f].map(|e| e as usize);
            edges.map(|e| (topology.edge_triangles[e][0] as usize == f).then(|| topology.edges[e]))
        };
        let body_topology = &self.topology;
        let crossings = |[f, g]: [u32; 2]| {
            let of_body = owned(body_topology, g as usize);
            let of_cloth = owned(topology, moving[f as usize]);
            let pairs = of_cloth.into_iter().flatten().flat_map(move |of_cloth| {
                of_body.into_iter().flatten().map(move |of_body| (of_cloth, of_body))
            });
            pairs.filter_map(|(of_cloth, of_body)| crossing_edges(x, of_cloth, body, of_body))
        };
        let near: Vec<[u32; 2]> = bvh.overlapping_pairs_with(body.bvh);
        self.overlaps.par_extend(near.into_par_iter().flat_map_iter(crossings));
        self.begun = (self.overlaps.clone(), self.offsets.clone());
    }

    /// Goes back to the contacts and offsets of the beginning of the step.
    pub fn restart(&mut self) {
        self.overlaps.clone_from(&self.begun.0);
        self.offsets.clone_from(&self.begun.1);
    }

    /// Adds contacts where triangles of `cloth` and of `body` intersect at the end of a step, `pairs` of them, and raises the
    /// offsets of those of `contacts` that were pressed through. Returns whether there were any.
    pub fn revise(
        &mut self,
        cloth: ClothSurface,
        body: BodySurface,
        pairs: &[[u32; 2]],
        contacts: &[EdgeContact],
        settings: &BodyContactSettings,
    ) -> bool {
        let x = cloth.x;
        let key = |overlap: &Overlap| (overlap.edge, overlap.points);
        let known: FxHashMap<([u32; 2], [u32; 3]), usize> =
            self.overlaps.iter().enumerate().map(|(k, overlap)| (key(overlap), k)).collect();
        let mut of_cloth: Vec<u32> = pairs.iter().map(|[f, _]| *f).collect();
        of_cloth.sort_unstable();
        of_cloth.dedup();
        let crossed: Vec<[PointIndex; 3]> = of_cloth.iter().map(|f| cloth.triangles[*f as usize]).collect();
        let bvh = TriangleBvh::new(x, &crossed, TUNING.body.max_edge_distance);
        let mut corners: Vec<usize> =
            pairs.iter().flat_map(|[_, g]| body.triangles[*g as usize]).map(PointIndex::at).collect();
        corners.sort_unstable();
        corners.dedup();
        let cloth_near = TriangleQuery { x, triangles: &crossed, bvh: &bvh };
        let over_points =
            corners.iter().filter_map(|&p| over_point(cloth_near, p, body.x[p], body.normals[p]));
        let edges_of = |topology: &Topology, f: u32| {
            topology.triangle_edges[f as usize].map(|e| topology.edges[e as usize])
        };
        let over_edges = pairs.iter().flat_map(|[f, g]| {
            let of_body = edges_of(&self.topology, *g);
            let pairs = edges_of(cloth.topology, *f)
                .into_iter()
                .flat_map(move |a| of_body.map(|b| (a, b)).into_iter());
            pairs.filter_map(|(of_cloth, of_body)| crossing_edges(x, of_cloth, body, of_body))
        });
        let mut found: Vec<Overlap> = over_points.chain(over_edges).collect();
        found.sort_by_key(key);
        found.dedup_by_key(|overlap| key(overlap));
        let is_through = |overlap: &Overlap| {
            let contact = self.contact(overlap, body.x, body.normals, settings);
            contact.is_some_and(|contact| contact.gap(x) < 0.0)
        };
        // Where a known one is through, the cloth has slid over it since.
        found.retain(|overlap| !known.contains_key(&key(overlap)) || is_through(overlap));
        let is_new = !found.is_empty();
        for overlap in found {
            match known.get(&key(&overlap)) {
                Some(k) => self.overlaps[*k] = overlap,
                None => self.overlaps.push(overlap),
            }
        }
        // Elsewhere contact is as strong as it should be: the cloth would slide on what stands off too far.
        let crossed_points: FxHashSet<u32> = crossed.iter().flatten().map(|p| p.0).collect();
        let is_crossed = |c: &&EdgeContact| {
            c.edge.iter().all(|p| corners.binary_search(&(*p as usize)).is_ok())
                && c.points.iter().all(|p| crossed_points.contains(p))
        };
        let weak: Vec<EdgeContact> = contacts.iter().filter(is_crossed).copied().collect();
        let missing = self.missing(x, &weak, settings);
        let max_offset = TUNING.body.max_edge_offset * settings.mean_point_dhat();
        let mut is_raised = false;
        for (offset, missing) in self.offsets.iter_mut().zip(missing).filter(|(_, missing)| *missing > 0.0) {
            is_raised |= *offset < max_offset;
            *offset = (*offset + missing).min(max_offset);
        }
        is_new || is_raised
    }

    /// Returns the contacts for a step that moves the body to `target` [m] with `normals`. `is_folded`: whether a point of the body is in a self
    /// fold, one flag per point.
    pub fn edge_contacts(
        &self,
        target: &[Vec3],
        normals: &[Vec3],
        is_folded: &[bool],
        settings: &BodyContactSettings,
    ) -> Vec<EdgeContact> {
        let open = self.overlaps.iter().filter(|o| !o.edge.iter().any(|p| is_folded[*p as usize]));
        open.filter_map(|overlap| self.contact(overlap, target, normals, settings)).collect()
    }

    /// Returns the contact at an overlap, with the body at `target` [m] with `normals`; `None` where it has no normal.
    fn contact(
        &self,
        o: &Overlap,
        target: &[Vec3],
        normals: &[Vec3],
        settings: &BodyContactSettings,
    ) -> Option<EdgeContact> {
        let mean =
            |of: &[f64]| -> f64 { o.edge.iter().zip(o.edge_weights).map(|(p, w)| of[*p as usize] * w).sum() };
        let cloth_area: f64 =
            o.points.iter().zip(o.weights).map(|(p, w)| settings.areas[*p as usize] * w).sum();
        let [anchor, normal] = [target, normals].map(|of| between(of, o.edge, o.edge_weights));
        let stiffness = TUNING.body.edge_stiffness_factor * settings.stiffness;
        Some(EdgeContact {
            edge: o.edge,
            edge_weights: o.edge_weights,
            points: o.points,
            weights: o.weights,
            anchor,
            normal: normal.try_normalize(1e-9)?,
            dhat: settings.edge_dhat + mean(&self.offsets),
            stiffness: stiffness * mean(&self.areas).max(cloth_area),
        })
    }

    /// Accepts the step with the cloth at `x` [m]; `contacts` were those of the step.
    pub fn end_step(&mut self, x: &[Vec3], contacts: &[EdgeContact], settings: &BodyContactSettings) {
        let tuning = &TUNING.body;
        let max_offset = tuning.max_edge_offset * settings.mean_point_dhat();
        let missing = self.missing(x, contacts, settings);
        for (offset, missing) in self.offsets.iter_mut().zip(missing) {
            *offset = (*offset * (1.0 - tuning.offset_decay) + missing).min(max_offset);
        }
    }

    /// Per point of the body: by how much its `contacts` fall short of the smallest gap with the cloth at `x` [m].
    fn missing(&self, x: &[Vec3], contacts: &[EdgeContact], settings: &BodyContactSettings) -> Vec<f64> {
        let mut missing = vec![0.0f64; self.offsets.len()];
        for contact in contacts {
            let amount = TUNING.body.min_edge_gap * settings.edge_dhat - contact.gap(x);
            for (p, w) in contact.edge.iter().zip(contact.edge_weights) {
                missing[*p as usize] = missing[*p as usize].max(w * amount);
            }
        }
        missing
    }
}

/// Returns the overlap of the point `point` of a body, at `at` [m] with that outward `normal`, and the innermost triangle of
/// `cloth` over it, if there is one.
fn over_point(cloth: TriangleQuery, point: usize, at: Vec3, normal: Vec3) -> Option<Overlap> {
    let tuning = &TUNING.body;
    let length = tuning.max_penetration + tuning.max_height_over_vertex;
    let hit = cloth.bvh.first_hit(cloth.x, at - normal * tuning.max_penetration, normal, length)?;
    let points = cloth.triangles[hit.triangle as usize].map(|p| p.0);
    Some(Overlap { edge: [point as u32; 2], edge_weights: [1.0, 0.0], points, weights: hit.weights })
}

/// Returns the overlap of the edge `of_cloth` of the cloth at `x` and the edge `of_body`, if the one runs across the other.
fn crossing_edges(
    x: &[Vec3],
    of_cloth: [PointIndex; 2],
    body: BodySurface,
    of_body: [PointIndex; 2],
) -> Option<Overlap> {
    let tuning = &TUNING.body;
    let ([a, b], [c, d]) = (of_cloth.map(PointIndex::at), of_body.map(PointIndex::at));
    if PairKind::EdgeEdge.apart_on_an_axis(&[x[a], x[b], body.x[c], body.x[d]], tuning.max_edge_distance) {
        return None;
    }
    let closest = edge_edge(&x[a], &x[b], &body.x[c], &body.x[d]);
    let [wa, wb, wc, wd] = closest.weights;
    let (weights, edge_weights) = ([wa, wb], [-wc, -wd]);
    let is_inside = weights.iter().chain(&edge_weights).all(|w| *w > tuning.edge_end_fraction);
    let edge = [c as u32, d as u32];
    let normal = between(body.normals, edge, edge_weights).try_normalize(1e-9)?;
    let height = closest.vector.dot(&normal);
    let is_upright = height.abs() >= tuning.min_edge_cosine * closest.distance;
    let max_distance = if height < 0.0 { tuning.max_penetration } else { tuning.max_edge_distance };
    (is_inside && is_upright && closest.distance <= max_distance).then_some(Overlap {
        edge,
        edge_weights,
        points: [a as u32, b as u32, b as u32],
        weights: [wa, wb, 0.0],
    })
}

/// Interpolates a field of the body along an edge.
fn between(of: &[Vec3], edge: [u32; 2], weights: [f64; 2]) -> Vec3 {
    edge.iter().zip(weights).map(|(p, w)| of[*p as usize] * w).sum()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::energy::{EdgeContacts, Energy};
    use crease_geometry::mesh::point_in_solid::point_normals;

    fn settings(points: usize) -> BodyContactSettings {
        BodyContactSettings {
            point_dhat: vec![1e-3; points],
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

    fn contacts(x: &[Vec3], cloth: &[[PointIndex; 3]], fixed: bool, is_folded: bool) -> Vec<EdgeContact> {
        let (body, triangles) = roof();
        let normals = point_normals(&body, &triangles);
        let bvh = TriangleBvh::new(&body, &triangles, 0.0);
        let surface = BodySurface { x: &body, normals: &normals, triangles: &triangles, bvh: &bvh };
        let mut edges = BodyEdges::new(&body, &triangles);
        let topology = Topology::new(x.len(), cloth);
        edges.begin_step(x, cloth, &topology, &|_| fixed, surface);
        edges.edge_contacts(&body, &normals, &vec![is_folded; body.len()], &settings(x.len()))
    }

    /// Edges of a triangle cross the ridge 0.4 mm under it, while all its points are outside the roof.
    #[test]
    fn a_ridge_carries_edges_that_cross_it() {
        let x = [Vec3::new(0.0, -4e-4, 0.008), Vec3::new(0.0, -4e-4, -0.008), Vec3::new(0.012, -4e-4, 0.008)];
        let cloth = [[0, 1, 2].map(PointIndex)];
        let found = contacts(&x, &cloth, false, false);
        assert!(!found.is_empty());
        for contact in &found {
            assert!((contact.gap(&x) + 4e-4).abs() < 1e-12 && contact.normal.y > 0.999, "{contact:?}");
            assert_eq!(contact.edge, [0, 1]);
        }
        let mut g = [Vec3::zeros(); 3];
        EdgeContacts(&found).add_gradient(&x, &mut g);
        assert!(g.iter().all(|g| g.y < 0.0), "pushed up: {g:?}");
        assert!(contacts(&x, &cloth, true, false).is_empty(), "fixed points have no contacts");
        assert!(contacts(&x, &cloth, false, true).is_empty(), "nothing in a self fold");
        let deep = x.map(|p| p - Vec3::new(0.0, 0.004, 0.0));
        assert!(contacts(&deep, &cloth, false, false).is_empty(), "caught between two parts of a body");
    }

    /// The end of the ridge lies under the middle of a triangle whose points are far outside.
    #[test]
    fn a_corner_carries_the_triangle_over_it_and_acts_from_farther_while_it_is_through() {
        let over =
            |height: f64| [[-0.06, 0.02], [-0.06, -0.02], [-0.03, 0.0]].map(|[x, z]| Vec3::new(x, height, z));
        let cloth = [[0, 1, 2].map(PointIndex)];
        let (body, triangles) = roof();
        let normals = point_normals(&body, &triangles);
        let bvh = TriangleBvh::new(&body, &triangles, 0.0);
        let surface = BodySurface { x: &body, normals: &normals, triangles: &triangles, bvh: &bvh };
        let mut edges = BodyEdges::new(&body, &triangles);
        let topology = Topology::new(3, &cloth);
        let x = over(2e-4);
        edges.begin_step(&x, &cloth, &topology, &|_| false, surface);
        let found = edges.edge_contacts(&body, &normals, &[false; 6], &settings(3));
        let corner = found.iter().find(|s| s.edge == [0, 0]).expect("has one");
        assert!((corner.gap(&x) - 2e-4).abs() < 1e-12);
        assert_eq!(corner.dhat, 5e-4);
        // A tenth of a millimetre through it, then far over it.
        edges.end_step(&over(-1e-4), &found, &settings(3));
        assert!((edges.offsets[0] - 3.5e-4).abs() < 1e-12, "{}", edges.offsets[0]);
        edges.end_step(&over(1e-2), &found, &settings(3));
        assert!((edges.offsets[0] - 3.5e-4 * (1.0 - TUNING.body.offset_decay)).abs() < 1e-12);
        for _ in 0..50 {
            edges.end_step(&over(-1e-4), &found, &settings(3));
        }
        assert_eq!(edges.offsets[0], TUNING.body.max_edge_offset * 1e-3, "the largest offset");
    }

    /// A triangle that the ridge has slid under within a step, and one that it has slid on under; a second attempt at the step begins anew.
    #[test]
    fn what_slides_under_the_cloth_within_a_step_carries_it_too() {
        let at = |x: f64, height: f64| {
            [[-0.03, 0.02], [-0.03, -0.02], [0.03, 0.0]].map(|[along, z]| Vec3::new(x + along, height, z))
        };
        let cloth = [[0, 1, 2].map(PointIndex)];
        let (body, triangles) = roof();
        let normals = point_normals(&body, &triangles);
        let bvh = TriangleBvh::new(&body, &triangles, 0.0);
        let surface = BodySurface { x: &body, normals: &normals, triangles: &triangles, bvh: &bvh };
        let topology = Topology::new(3, &cloth);
        let mut edges = BodyEdges::new(&body, &triangles);
        edges.begin_step(&at(0.2, 1e-4), &cloth, &topology, &|_| false, surface);
        let none = edges.edge_contacts(&body, &normals, &[false; 6], &settings(3));
        assert!(none.is_empty(), "nothing is over the roof: {none:?}");
        let pairs: Vec<[u32; 2]> = (0..4).map(|g| [0, g]).collect();
        let revised = |edges: &mut BodyEdges, x: &[Vec3; 3], contacts: &[EdgeContact]| {
            let cloth = ClothSurface { x, triangles: &cloth, topology: &topology };
            let changed = edges.revise(cloth, surface, &pairs, contacts, &settings(3));
            changed.then(|| edges.edge_contacts(&body, &normals, &[false; 6], &settings(3)))
        };
        let through = at(-0.05, -2e-4);
        let found = revised(&mut edges, &through, &[]).expect("the end of the ridge is through");
        let corner = |found: &[EdgeContact]| *found.iter().find(|c| c.edge == [0, 0]).expect("has one");
        assert!((corner(&found).gap(&through) + 2e-4).abs() < 1e-9, "{found:?}");
        // The cloth has slid on: the same corner is under another place of the same triangle.
        let slid = at(-0.04, -2e-4);
        let again = revised(&mut edges, &slid, &found).expect("is through again");
        assert!(corner(&again).weights != corner(&found).weights);
        assert!(corner(&again).dhat > corner(&found).dhat, "and acts from farther away");
        edges.restart();
        assert!(edges.edge_contacts(&body, &normals, &[false; 6], &settings(3)).is_empty());
        assert!(edges.offsets.iter().all(|offset| *offset == 0.0));
    }
}
