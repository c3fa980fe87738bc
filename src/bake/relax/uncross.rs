//! Layers of the garment kept apart where its own triangles, or those of the file that it was refined from, would cross.
//!
//! Layers of the simulated mesh never cross. Read off at the points of the garment, whose triangles are others, layers that lie close
//! may: a chord over a fold cuts through the layer inside of it. Wherever an edge passes through a triangle, the place of both on
//! the simulated surface says on which side of one another they belong and how far apart; their corners are moved there, round
//! by round (position-based dynamics, Müller and others 2007), until nothing crosses. What is exported does not cross the body where the
//! file does not, either: where it would, the displacement is scaled down.

use crate::bake::ModelDecision;
use crate::bake::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_geometry::mesh::distance::barycentric;
use crease_geometry::mesh::intersections::{intersections_between, self_intersections};
use crease_geometry::mesh::triangle::corners;
use crease_model::body::AnimatedBody;
use crease_model::garment::Garment;
use crease_model::remesh::{SimulationMesh, SurfaceFinder, interpolate};
use rustc_hash::FxHashSet;

/// Reading of a simulated mesh at the points of the garment, without crossings of the garment's triangles.
pub(crate) struct GarmentReading<'a> {
    garment: &'a Garment,
    /// Distance by which layers that cross are moved apart in a round [m].
    gap: f64,
    /// The triangles that are exported.
    exported: CrossingSurface<'a>,
    /// Those of the garment, if it is refined.
    refined: Option<CrossingSurface<'a>>,
    /// The body that it is worn on.
    body: Option<BodyBeside<'a>>,
}

/// A simulated shape read off at the points of the garment.
pub(crate) struct ReadShape {
    /// Positions of the garment's points [m].
    pub points: Vec<Vec3>,
    /// Pairs of exported triangles that cross there and do not in the source pose.
    pub crossing_pairs: u64,
}

/// Triangles over the points of the garment.
struct CrossingSurface<'a> {
    triangles: &'a [[PointIndex; 3]],
    /// Pairs of them that cross in the source pose.
    own: FxHashSet<[u32; 2]>,
}

impl<'a> CrossingSurface<'a> {
    fn new(source: &[Vec3], triangles: &'a [[PointIndex; 3]]) -> Self {
        Self { triangles, own: self_intersections(source, triangles).into_iter().collect() }
    }

    /// Pairs that cross and do not in the source pose; of `moved` points only those near them are looked at.
    fn crossing(&self, points: &[Vec3], moved: Option<&FxHashSet<PointIndex>>) -> Vec<[u32; 2]> {
        let all = match moved {
            None => self_intersections(points, self.triangles),
            Some(moved) => {
                let reach = TUNING.uncross.reach;
                let cell = |x: &Vec3| [x.x, x.y, x.z].map(|c| (c / reach).floor() as i32);
                let mut near = FxHashSet::default();
                for p in moved {
                    let [i, j, k] = cell(&points[p.at()]);
                    let around =
                        (-1..=1).flat_map(|a| (-1..=1).flat_map(move |b| (-1..=1).map(move |c| [a, b, c])));
                    near.extend(around.map(|[a, b, c]| [i + a, j + b, k + c]));
                }
                let looked_at = |t: &[PointIndex; 3]| t.iter().any(|p| near.contains(&cell(&points[p.at()])));
                let count = self.triangles.len() as u32;
                let faces: Vec<u32> =
                    (0..count).filter(|&f| looked_at(&self.triangles[f as usize])).collect();
                let some: Vec<[PointIndex; 3]> = faces.iter().map(|&f| self.triangles[f as usize]).collect();
                let found = self_intersections(points, &some);
                found.into_iter().map(|pair| pair.map(|f| faces[f as usize])).collect()
            }
        };
        all.into_iter().filter(|pair| !self.own.contains(pair)).collect()
    }

    /// Edges of either triangle of a pair that pass through the other.
    fn passages(&self, points: &[Vec3], [f, g]: [u32; 2]) -> Vec<Passage> {
        let mut found = Vec::new();
        for (face, other) in [(f, g), (g, f)] {
            let face = self.triangles[face as usize];
            let x = corners(points, &face);
            let normal = (x[1] - x[0]).cross(&(x[2] - x[0]));
            let t = self.triangles[other as usize];
            for k in 0..3 {
                let edge = [t[k], t[(k + 1) % 3]];
                let [a, b] = edge.map(|p| points[p.at()]);
                let [da, db] = [a, b].map(|p| normal.dot(&(p - x[0])));
                if (da < 0.0) == (db < 0.0) || da == db {
                    continue;
                }
                let weight = da / (da - db);
                let weights = barycentric(&(a + (b - a) * weight), &x);
                if weights.iter().all(|w| *w >= 0.0) {
                    found.push(Passage { edge, weight, face, weights });
                }
            }
        }
        found
    }
}

/// A body in the pose that it starts in.
struct BodyBeside<'a> {
    body: &'a AnimatedBody,
    /// Pairs of a triangle of the garment and one of the body that cross in the source pose.
    own: FxHashSet<[u32; 2]>,
}

impl BodyBeside<'_> {
    /// Pairs of a triangle of `garment`, with its points at `x` [m], and one of the body that cross.
    fn crossing(&self, garment: &Garment, x: &[Vec3]) -> Vec<[u32; 2]> {
        intersections_between(x, &garment.triangles, self.body.rest_points(), self.body.triangles())
    }
}

/// An edge that passes through a triangle.
struct Passage {
    /// Ends of the edge, and the weight of the second.
    edge: [PointIndex; 2],
    weight: f64,
    /// Corners of the triangle and their weights.
    face: [PointIndex; 3],
    weights: [f64; 3],
}

impl<'a> GarmentReading<'a> {
    /// Readings for `garment`, whose layers are `thickness` [m] thick, and which is worn on `body` if there is one.
    pub fn new(garment: &'a Garment, thickness: f64, body: Option<&'a AnimatedBody>) -> Self {
        let exported = CrossingSurface::new(&garment.points, garment.exported_triangles());
        let is_refined = !garment.file_triangles.is_empty();
        let refined = is_refined.then(|| CrossingSurface::new(&garment.points, &garment.triangles));
        let body = body.map(|body| {
            let beside = BodyBeside { body, own: FxHashSet::default() };
            let own = beside.crossing(garment, &garment.points).into_iter().collect();
            BodyBeside { own, ..beside }
        });
        let gap = thickness.max(TUNING.uncross.min_gap);
        Self { garment, gap, exported, refined, body }
    }

    /// Corners of triangles that cross one another or the body with the garment's points at `x` [m], and do not in the source pose.
    fn faulty_points(&self, x: &[Vec3]) -> Vec<PointIndex> {
        let of_layers = self.refined.iter().chain([&self.exported]).flat_map(|surface| {
            let faulty = surface.crossing(x, None).into_iter().flatten();
            faulty.flat_map(|f| surface.triangles[f as usize])
        });
        let on_body = self.body.iter().flat_map(|beside| {
            let pairs = beside.crossing(self.garment, x).into_iter();
            let faulty = pairs.filter(|pair| !beside.own.contains(pair));
            faulty.flat_map(|[of_garment, _]| self.garment.triangles[of_garment as usize])
        });
        of_layers.chain(on_body).collect()
    }

    /// The decision that says how much of the garment crosses the body with `displacement` [m], beside what does in its file;
    /// `None` without a body.
    pub fn body_decision(&self, displacement: &[Vec3]) -> Option<ModelDecision> {
        let beside = self.body.as_ref()?;
        let x: Vec<Vec3> = self.garment.points.iter().zip(displacement).map(|(x, d)| x + d).collect();
        let (now, before) = (beside.crossing(self.garment, &x).len(), beside.own.len());
        let why = format!(
            "{now} pairs of triangles cross the body in the shape that is exported, {before} in the file"
        );
        Some(ModelDecision { name: "body in result", on: true, why: why.into() })
    }

    /// Shape of the garment with the points of `mesh` at `x` [m].
    pub fn read(&self, mesh: &SimulationMesh, x: &[Vec3]) -> ReadShape {
        self.uncrossed(mesh.to_source(x), &self.exported, mesh, x)
    }

    /// The positions `points` of the garment's points [m], moved apart where triangles of `surface` cross, with the points of `mesh` at
    /// `x` [m].
    fn uncrossed(
        &self,
        mut points: Vec<Vec3>,
        surface: &CrossingSurface,
        mesh: &SimulationMesh,
        x: &[Vec3],
    ) -> ReadShape {
        if mesh.is_source && surface.triangles == mesh.garment.triangles {
            return ReadShape { points, crossing_pairs: 0 };
        }
        let mut crossing = surface.crossing(&points, None);
        if crossing.is_empty() {
            return ReadShape { points, crossing_pairs: 0 };
        }
        let finder = SurfaceFinder::new(&mesh.garment);
        for _ in 0..TUNING.uncross.max_rounds {
            let mut shift = vec![(Vec3::zeros(), 0u32); points.len()];
            for passage in crossing.iter().flat_map(|pair| surface.passages(&points, *pair)) {
                self.push(&passage, mesh, &finder, x, &mut shift);
            }
            let mut moved = FxHashSet::default();
            for (p, (sum, count)) in shift.iter().enumerate().filter(|(_, (_, count))| *count > 0) {
                points[p] += sum * (TUNING.uncross.over_relaxation / f64::from(*count));
                moved.insert(PointIndex(p as u32));
            }
            crossing = surface.crossing(&points, Some(&moved));
            if crossing.is_empty() {
                // Points pushed far may meet what was not looked at.
                crossing = surface.crossing(&points, None);
            }
            if crossing.is_empty() {
                break;
            }
        }
        ReadShape { points, crossing_pairs: crossing.len() as u64 }
    }

    /// Displacement of the garment's points from the source pose [m] by `displacement` of the points of `mesh` [m]; wrinkles of the
    /// source pose that the mesh does not follow stay. Where
    /// triangles would still cross it is scaled down, and the decision says for how many points.
    pub fn displacement(
        &self,
        mesh: &SimulationMesh,
        displacement: &[Vec3],
    ) -> (Vec<Vec3>, Option<ModelDecision>) {
        let source = &self.garment.points;
        let shape: Vec<Vec3> = mesh.garment.points.iter().zip(displacement).map(|(x, d)| x + d).collect();
        let mut points = mesh.carry(self.garment, &shape);
        for surface in self.refined.iter().chain([&self.exported]) {
            points = self.uncrossed(points, surface, mesh, &shape).points;
        }
        let mut held = vec![false; points.len()];
        if !mesh.is_source || self.body.is_some() || self.refined.is_some() {
            for round in 0..TUNING.uncross.max_hold_back_rounds {
                let faulty = self.faulty_points(&points);
                if faulty.is_empty() {
                    break;
                }
                let last = round + 1 == TUNING.uncross.max_hold_back_rounds;
                let factor = if last { 0.0 } else { TUNING.uncross.hold_back_factor };
                for p in self.with_neighbours(&faulty, 1 + round / 8) {
                    points[p] = source[p] + (points[p] - source[p]) * factor;
                    held[p] = true;
                }
            }
        }
        let count = held.iter().filter(|held| **held).count();
        let why =
            format!("{count} of {} points, where layers would cross one another or the body", points.len());
        let decision = (count > 0).then_some(ModelDecision { name: "held back", on: true, why: why.into() });
        (points.iter().zip(source).map(|(x, source)| x - source).collect(), decision)
    }

    /// The `points` and those at most `rings` edges away.
    fn with_neighbours(&self, points: &[PointIndex], rings: usize) -> Vec<usize> {
        let mut marked = vec![false; self.garment.points.len()];
        points.iter().for_each(|p| marked[p.at()] = true);
        for _ in 0..rings {
            let before = marked.clone();
            for [a, b] in &self.garment.topology.edges {
                marked[a.at()] |= before[b.at()];
                marked[b.at()] |= before[a.at()];
            }
        }
        (0..marked.len()).filter(|p| marked[*p]).collect()
    }

    /// Adds the shifts that bring the edge and the triangle of `passage` to the sides of one another where they belong.
    fn push(
        &self,
        passage: &Passage,
        mesh: &SimulationMesh,
        finder: &SurfaceFinder,
        x: &[Vec3],
        shift: &mut [(Vec3, u32)],
    ) {
        let Passage { edge, weight, face, weights } = passage;
        let source = &self.garment.points;
        let t = face;
        let on_edge = source[edge[0].at()] * (1.0 - weight) + source[edge[1].at()] * *weight;
        let on_face: Vec3 = (0..3).map(|k| source[t[k].at()] * weights[k]).sum();
        let position = |near: PointIndex, place: &Vec3| {
            let at = finder.locate(mesh.source_location[near.at()].face, place);
            interpolate(x, &mesh.garment.triangles, &at)
        };
        let apart = position(edge[0], &on_edge) - position(t[0], &on_face);
        let Some(direction) = apart.try_normalize(1e-9) else { return };
        let squares: f64 =
            (1.0 - weight).powi(2) + weight.powi(2) + weights.iter().map(|w| w * w).sum::<f64>();
        let step = direction * (self.gap / squares);
        let mut add = |p: PointIndex, by: Vec3| {
            shift[p.at()].0 += by;
            shift[p.at()].1 += 1;
        };
        add(edge[0], step * (1.0 - weight));
        add(edge[1], step * *weight);
        (0..3).for_each(|k| add(t[k], step * -weights[k]));
    }
}
