//! A simulated shape read off at the points of the garment, for frames and for the result.
//!
//! Frames follow the simulated mesh ([`ShapeFollower`]) from the source pose on, so that the garment's own triangles never cross. So does the
//! displacement of the result, where positions read off would cross. What is exported does not cross the body where the file does not,
//! either: where it would, the displacement is scaled down.

use crate::bake::ModelDecision;
use crate::bake::relax::shape_follower::ShapeFollower;
use crate::bake::tuning::TUNING;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::PointIndex;
use crease_geometry::mesh::intersections::{intersections_between, self_intersections};
use crease_model::body::AnimatedBody;
use crease_model::garment::Garment;
use crease_model::remesh::SimulationMesh;
use rustc_hash::FxHashSet;

/// Reading of a simulated mesh at the points of the garment.
pub(crate) struct GarmentReading<'a> {
    garment: &'a Garment,
    /// The body that it is worn on.
    body: Option<BodyBeside<'a>>,
}

/// Frames that show the garment: its own triangles, following the simulated mesh.
pub(in crate::bake) struct GarmentFrames<'a> {
    garment: &'a Garment,
    /// `None` until a mesh of other triangles is shown.
    follower: Option<ShapeFollower>,
}

/// A frame of the garment.
pub(in crate::bake) struct GarmentFrame {
    /// Positions of the garment's points [m].
    pub points: Vec<Vec3>,
    /// Largest distance of one from its place on the simulated mesh [m].
    pub distance: f64,
}

impl<'a> GarmentFrames<'a> {
    /// Frames of `garment`, none of them shown yet.
    pub fn new(garment: &'a Garment) -> Self {
        Self { garment, follower: None }
    }

    /// The frame with the points of `mesh` at `x` [m].
    pub fn show(&mut self, mesh: &SimulationMesh, x: &[Vec3]) -> GarmentFrame {
        let target = mesh.to_source(x);
        if !self.follows(mesh) {
            return GarmentFrame { points: target, distance: 0.0 };
        }
        let follower = self.follower();
        follower.follow(&target);
        GarmentFrame { points: follower.positions().to_vec(), distance: follower.distance_from(&target) }
    }

    /// Follows the points of `mesh` to `x` [m] between two frames, where they move far.
    pub fn keep_up(&mut self, mesh: &SimulationMesh, x: &[Vec3]) {
        if self.follows(mesh) {
            let target = mesh.to_source(x);
            let follower = self.follower();
            if follower.motion_to(&target) > TUNING.follow.max_step {
                follower.follow(&target);
            }
        }
    }

    /// Follows the points of `mesh` to `x` [m], where they were put.
    pub fn put(&mut self, mesh: &SimulationMesh, x: &[Vec3]) {
        if self.follows(mesh) {
            self.follower().follow_elsewhere(&mesh.to_source(x));
        }
    }

    /// Whether the triangles shown are others than those of `mesh`.
    fn follows(&self, mesh: &SimulationMesh) -> bool {
        !mesh.is_source || !self.garment.file_triangles.is_empty()
    }

    fn follower(&mut self) -> &mut ShapeFollower {
        let garment = self.garment;
        self.follower.get_or_insert_with(|| ShapeFollower::new(&garment.points, garment.exported_triangles()))
    }

    /// What a resumed run goes on from, if frames were shown.
    pub fn state(&self) -> Option<[Vec<Vec3>; 2]> {
        self.follower.as_ref().map(ShapeFollower::state)
    }

    /// Goes on from a [`Self::state`].
    pub fn restore(&mut self, state: [Vec<Vec3>; 2]) {
        if state.iter().all(|x| x.len() == self.garment.points.len()) {
            self.follower().restore(state);
        }
    }

    /// Drops what is kept between frames for speed alone.
    pub fn clear_caches(&mut self) {
        if let Some(follower) = &mut self.follower {
            follower.clear_caches();
        }
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

impl<'a> GarmentReading<'a> {
    /// Readings for `garment`, which is worn on `body` if there is one.
    pub fn new(garment: &'a Garment, body: Option<&'a AnimatedBody>) -> Self {
        let body = body.map(|body| {
            let beside = BodyBeside { body, own: FxHashSet::default() };
            let own = beside.crossing(garment, &garment.points).into_iter().collect();
            BodyBeside { own, ..beside }
        });
        Self { garment, body }
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

    /// Displacement of the garment's points from the source pose [m] by `displacement` of the points of `mesh` [m]; wrinkles of the
    /// source pose that the mesh does not follow stay. Where triangles would cross one another or the body it is smaller, and the
    /// decision says for how many points.
    pub fn displacement(
        &self,
        mesh: &SimulationMesh,
        displacement: &[Vec3],
    ) -> (Vec<Vec3>, Option<ModelDecision>) {
        let source = &self.garment.points;
        let shape: Vec<Vec3> = mesh.garment.points.iter().zip(displacement).map(|(x, d)| x + d).collect();
        let target = mesh.carry(self.garment, &shape);
        let mut points = target.clone();
        if !mesh.is_source || !self.garment.file_triangles.is_empty() {
            points = self.without_crossings(points);
        }
        points = self.beside_body(points);
        let held =
            target.iter().zip(&points).filter(|(a, b)| (*a - *b).norm() > TUNING.follow.displacement_tol);
        let count = held.count();
        let why =
            format!("{count} of {} points, where layers would cross one another or the body", points.len());
        let decision = (count > 0).then_some(ModelDecision { name: "held back", on: true, why: why.into() });
        (points.iter().zip(source).map(|(x, source)| x - source).collect(), decision)
    }

    /// The positions `target` [m], or others near them, at which no triangles cross but those that do in the source pose: those of the garment and, if
    /// it was refined, those of its file.
    fn without_crossings(&self, target: Vec<Vec3>) -> Vec<Vec3> {
        let points = self.without_crossings_of(target, &self.garment.triangles);
        match self.garment.file_triangles.is_empty() {
            true => points,
            false => self.without_crossings_of(points, &self.garment.file_triangles),
        }
    }

    /// The same for `triangles`.
    fn without_crossings_of(&self, target: Vec<Vec3>, triangles: &[[PointIndex; 3]]) -> Vec<Vec3> {
        let source = &self.garment.points;
        let crossing = self_intersections(&target, triangles);
        if crossing.is_empty() {
            return target;
        }
        let own: FxHashSet<[u32; 2]> = self_intersections(source, triangles).into_iter().collect();
        if crossing.iter().all(|pair| own.contains(pair)) {
            return target;
        }
        let mut follower = ShapeFollower::new(source, triangles);
        follower.follow(&target);
        follower.positions().to_vec()
    }

    /// The positions `x` [m], scaled back to the source pose where triangles cross the body and do not in the source pose.
    fn beside_body(&self, mut x: Vec<Vec3>) -> Vec<Vec3> {
        let Some(beside) = &self.body else { return x };
        let source = &self.garment.points;
        for round in 0..TUNING.follow.max_hold_back_rounds {
            let pairs = beside.crossing(self.garment, &x).into_iter();
            let faulty = pairs.filter(|pair| !beside.own.contains(pair));
            let faulty: Vec<PointIndex> =
                faulty.flat_map(|[of_garment, _]| self.garment.triangles[of_garment as usize]).collect();
            if faulty.is_empty() {
                break;
            }
            let last = round + 1 == TUNING.follow.max_hold_back_rounds;
            let factor = if last { 0.0 } else { TUNING.follow.hold_back_factor };
            for p in self.with_neighbours(&faulty, 1 + round / 8) {
                x[p] = source[p] + (x[p] - source[p]) * factor;
            }
            x = self.without_crossings(x);
        }
        x
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
}
