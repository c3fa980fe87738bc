//! Coupling of the cloth to the body that wears it: the body's contact planes and edges in every step.
//!
//! The body moves as the script says; the cloth follows it by one-sided contact (`contact::body_planes`). Does not do: forces
//! of the cloth on the body.

use crate::bake::body::leash::{GarmentLeash, follow_leashes};
use crate::bake::body::penetration::BodyPenetrationStats;
use crate::bake::body::static_contact::body_contact_settings;
use crate::bake::body::watch::BodyWatch;
use crate::bake::report::StopCause;
use crate::bake::run::frames::{FrameSchedule, StepStart};
use crate::bake::tuning::TUNING;
use crate::wear::ActionRunner;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::point_in_solid::Solid;
use crease_geometry::mesh::{PointIndex, Topology};
use crease_model::body::{AnimatedBody, BodyPose};
use crease_model::garment::{Garment, RestState};
use crease_model::remesh::Refinement;
use crease_solver::contact::{BodyContactState, BodyPlanes, ClothSurface, ContactSettings};
use crease_solver::energy::{EdgeContact, Leash, PlaneContact};
use crease_solver::sim::{LoadSource, Loads, State, StepReport, Stepper};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The body under the cloth during a run.
pub(in crate::bake) struct BodyCoupling {
    /// Contact planes of the body.
    pub planes: BodyPlanes,
    /// Per point of the cloth: whether the moving body cannot affect it; empty when all can be affected.
    pub inactive: Vec<bool>,
    /// What holds the cloth to its skin, if it has one.
    leash: Option<GarmentLeash>,
    /// Watch over what falls off or is broken through.
    watch: BodyWatch,
    /// Gap at which cloth rests on the body [m].
    point_dhat: f64,
    /// Depth of cloth inside the body so far.
    pub penetration: BodyPenetrationStats,
}

/// State of the body in a checkpoint, and of the contact with it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyCheckpoint {
    /// Pose after the finished actions.
    pub pose: BodyPose,
    /// Contact with the cloth.
    pub contact: BodyContactState,
    /// Depth of cloth inside the body so far.
    pub penetration: BodyPenetrationStats,
}

impl BodyCheckpoint {
    /// Whether its lists fit `animated` under a cloth of `points` points.
    pub fn fits(&self, animated: &AnimatedBody, points: usize) -> bool {
        self.contact.fits(animated.rest_points().len(), points)
    }
}

/// The cloth that a step moves.
pub(in crate::bake) struct SteppedCloth<'a> {
    /// The simulated mesh.
    pub garment: &'a Garment,
    /// Solver and contact.
    pub stepper: &'a mut Stepper,
    /// Positions and velocities.
    pub state: &'a mut State,
    /// The rest state in the energies.
    pub rest: &'a RestState,
}

/// A step to be made.
pub(in crate::bake) struct StepRange {
    /// Time at which its action began [s].
    pub begin: f64,
    /// Its length at most [s].
    pub dt: f64,
}

/// The body at the end of a step, and its contact with the cloth.
struct ContactAtEnd {
    /// Positions of the body, one per point of it [m].
    positions: Arc<[Vec3]>,
    /// Unit normals there, one per point of it.
    normals: Vec<Vec3>,
    planes: Arc<[PlaneContact]>,
    edges: Arc<[EdgeContact]>,
}

impl BodyCoupling {
    /// The coupling of `animated` in its start pose to `garment`, whose points stand for `areas` [m²].
    pub fn new(
        garment: &Garment,
        animated: &AnimatedBody,
        settings: &ContactSettings,
        areas: Vec<f64>,
    ) -> Self {
        let settings = body_contact_settings(garment, settings, areas);
        Self {
            watch: BodyWatch::new(garment, animated.rest_points()),
            point_dhat: settings.mean_point_dhat(),
            planes: BodyPlanes::new(animated.rest_points(), animated.triangles(), settings),
            inactive: Vec::new(),
            leash: None,
            penetration: BodyPenetrationStats::default(),
        }
    }

    /// The coupling of the same body to the refined mesh, whose points stand for `areas` [m²]. Contact of new points is that of their
    /// neighbours.
    pub fn on_refined(
        &self,
        refinement: &Refinement,
        animated: &AnimatedBody,
        settings: &ContactSettings,
        areas: Vec<f64>,
    ) -> Self {
        let mut refined = Self::new(&refinement.mesh.garment, animated, settings, areas);
        let state = self.planes.state().on_points(|values| refinement.points(values));
        refined.planes.restore(&state);
        if !self.inactive.is_empty() {
            refined.inactive = refinement.flags(&self.inactive);
        }
        refined.penetration = self.penetration.clone();
        refined.leash = self.leash.as_ref().map(|leash| leash.on_refined(refinement));
        refined.watch = self.watch.on_refined(&refinement.mesh.garment, animated.rest_points());
        refined
    }

    /// Holds the cloth by `leash` from now on. Its points stand for `areas` [m²] and lay `depths` [m] inside the body at the
    /// start; `stiffness` is that of contact per area [N/m³].
    pub fn hold(&mut self, mut leash: GarmentLeash, areas: &[f64], stiffness: f64, depths: &[f64]) {
        leash.prepare(areas, stiffness, depths, 2.0 * self.point_dhat);
        self.leash = Some(leash);
    }

    /// Restores contact and statistics of a checkpoint that fits.
    pub fn restore(&mut self, from: &BodyCheckpoint) {
        self.planes.restore(&from.contact);
        self.penetration = from.penetration.clone();
    }

    /// Contact and statistics for a checkpoint, with the body in `pose`.
    pub fn checkpoint(&self, pose: &BodyPose) -> BodyCheckpoint {
        BodyCheckpoint {
            pose: pose.clone(),
            contact: self.planes.state(),
            penetration: self.penetration.clone(),
        }
    }

    /// Cause to end the run at `time` [s] with the cloth at `x` [m], while it is on the body.
    pub fn cause_to_stop(&self, time: f64, x: &[Vec3]) -> Option<StopCause> {
        self.watch.cause_to_stop(time, x, self.planes.points(), &self.penetration)
    }

    /// Reason why `garment`, which ends at `x` [m], does not count as worn on `animated`: more of its simulated points lie deep
    /// inside than a garment may have that is put on, or the body breaks through it. What was so at the start does not count.
    pub fn reason_inside(&self, garment: &Garment, animated: &AnimatedBody, x: &[Vec3]) -> Option<String> {
        self.reason_deep(garment, animated, x).or_else(|| self.penetration.reason_broken_through())
    }

    fn reason_deep(&self, garment: &Garment, animated: &AnimatedBody, x: &[Vec3]) -> Option<String> {
        let tuning = &TUNING.body;
        let depths =
            |x: &[Vec3], body: &[Vec3]| Solid::new(body, animated.triangles()).depths(x, tuning.depth_search);
        let before = depths(&garment.points, animated.rest_points());
        let now = depths(x, self.planes.points());
        let simulated: Vec<usize> =
            (0..x.len()).filter(|p| !self.inactive.get(*p).copied().unwrap_or(false)).collect();
        let is_deep = |p: &&usize| now[**p] - before[**p] > tuning.max_fit_depth;
        let deep: Vec<usize> = simulated.iter().filter(is_deep).copied().collect();
        if deep.len() as f64 <= tuning.max_deep_fraction * simulated.len() as f64 {
            return None;
        }
        let deepest = deep.iter().copied().max_by(|a, b| now[*a].total_cmp(&now[*b]))?;
        let at = x[deepest];
        Some(format!(
            "at the end of the wear {} of {} simulated points lie deeper than {:.0} mm inside the body, up to {:.0} mm at \
             ({:.3}, {:.3}, {:.3}) m: it has passed through the cloth; begin with a slower motion, or fit the garment closer",
            deep.len(),
            simulated.len(),
            1e3 * tuning.max_fit_depth,
            1e3 * now[deepest],
            at.x,
            at.y,
            at.z
        ))
    }

    /// Drops what is cached between steps for speed alone.
    pub fn clear_caches(&mut self) {
        self.planes.clear_caches();
    }

    /// Makes one accepted step. Also returns, for each of the frames of a schedule that are due in it from its start, the offsets of the points
    /// from their chord [m] by which the body carries them along its arc.
    pub fn step(
        &mut self,
        cloth: SteppedCloth,
        runner: &mut dyn ActionRunner,
        StepRange { begin, dt }: StepRange,
        frames: Option<(&FrameSchedule, &StepStart)>,
    ) -> (StepReport, Vec<Vec<Vec3>>) {
        let SteppedCloth { garment, stepper, state, rest } = cloth;
        let mut loads = LoadsOnBody {
            planes: &mut self.planes,
            inactive: &self.inactive,
            leash: self.leash.as_ref(),
            garment,
            runner,
            begin,
            start: state.time,
            begun: false,
            leashes_before: Vec::new(),
            end: None,
            max_pairs: TUNING.body.max_pairs_after(self.penetration.open_pairs()),
        };
        let step = stepper.advance(state, rest, &mut loads, dt);
        let offsets = frames.map_or(Vec::new(), |(frames, start)| {
            loads.offsets_on_arc(start, state, &frames.due(start.time, state.time))
        });
        let (end, planes) = (loads.end, loads.planes);
        if let Some(end) = end {
            let moves = planes.end_step(&state.x, &end.positions, &end.planes, &end.edges);
            let intersections = planes.raise_offsets(&state.x, &garment.triangles, moves);
            let many = self.watch.max_pairs();
            self.penetration.record(state.time, &state.x, &end.planes, intersections, many);
        }
        (step, offsets)
    }
}

/// Loads of the steps of an action on a body.
struct LoadsOnBody<'a> {
    planes: &'a mut BodyPlanes,
    inactive: &'a [bool],
    leash: Option<&'a GarmentLeash>,
    garment: &'a Garment,
    runner: &'a mut dyn ActionRunner,
    /// Time at which the action began [s].
    begin: f64,
    /// Time at which the step begins [s].
    start: f64,
    /// Whether contact has been searched for in the step.
    begun: bool,
    /// Leashes at the beginning of the step.
    leashes_before: Vec<Leash>,
    /// The body at the end of the last attempt at the step.
    end: Option<ContactAtEnd>,
    /// Pairs of triangles of cloth and body that may intersect after the step.
    max_pairs: usize,
}

impl LoadsOnBody<'_> {
    /// Per fraction `due` of the step from `start` to `state`: the offsets from the chord between both by which the surface under each point
    /// carries it [m]. A limb turns on an arc, and its chord would lead the cloth through it.
    fn offsets_on_arc(&mut self, start: &StepStart, state: &State, due: &[f64]) -> Vec<Vec<Vec3>> {
        // Without a motion there is no arc.
        let moves = self.end.as_ref().is_some_and(|end| self.planes.moves_to(&end.positions));
        if due.is_empty() || !moves {
            return Vec::new();
        }
        let mut carried_at = |time: f64| {
            let posed = self.runner.loads_at(time - self.begin, &state.x).body?;
            let carried = self.planes.carried_displacement(&start.positions, &posed.points);
            let carried = extrapolated(carried, &self.garment.topology);
            Some(smoothed(carried, self.inactive, &self.garment.topology))
        };
        let Some((first, last)) = carried_at(start.time).zip(carried_at(state.time)) else {
            return Vec::new();
        };
        let offset = |fraction: &f64| {
            let now = carried_at(start.time + fraction * (state.time - start.time))?;
            let ends = first.iter().zip(&last).map(|(a, b)| a * (1.0 - fraction) + b * *fraction);
            Some(now.iter().zip(ends).map(|(now, ends)| now - ends).collect())
        };
        due.iter().map(offset).collect::<Option<_>>().unwrap_or_default()
    }
}

impl LoadSource for LoadsOnBody<'_> {
    fn loads_at(&mut self, time: f64, state: &State) -> Loads {
        let Self { planes, leash, garment, runner, begin, .. } = self;
        let mut loads = runner.loads_at(time - *begin, &state.x);
        self.end = None;
        let Some(posed) = loads.body.take() else { return loads };
        if loads.fixed.is_empty() {
            loads.fixed = self.inactive.to_vec();
        }
        if self.begun {
            planes.restart_edges();
        } else {
            if let Some(leash) = leash {
                let before = runner.loads_at(self.start - *begin, &state.x).body;
                self.leashes_before = leash.leashes(before.as_ref().unwrap_or(&posed), &loads.fixed);
            }
            planes.begin_step(&state.x, &garment.triangles, &garment.topology, &loads.fixed);
            self.begun = true;
        }
        let positions: Arc<[Vec3]> = planes.resolve_self_contact(&posed.points).into();
        let normals = planes.normals(&positions);
        loads.plane_contacts =
            planes.plane_contacts(&state.x, &positions, &normals, time - self.start, loads.friction).into();
        loads.edge_contacts = planes.edge_contacts(&positions, &normals).into();
        let carried = extrapolated(planes.carried_displacement(&state.x, &positions), &garment.topology);
        let mut displacement = smoothed(carried, &loads.fixed, &garment.topology);
        if let Some(leash) = leash {
            let leashes = leash.leashes(&posed, &loads.fixed);
            follow_leashes(&mut displacement, &self.leashes_before, &leashes, |p| planes.is_near(p));
            loads.leashes = leashes.into();
        }
        loads.body_displacement = displacement.into();
        let (planes, edges) = (loads.plane_contacts.clone(), loads.edge_contacts.clone());
        self.end = Some(ContactAtEnd { positions, normals, planes, edges });
        loads
    }

    fn revised_contacts(&mut self, x: &[Vec3], loads: &Loads) -> Option<Arc<[EdgeContact]>> {
        let end = self.end.as_mut().filter(|end| Arc::ptr_eq(&end.edges, &loads.edge_contacts))?;
        let cloth = ClothSurface { x, triangles: &self.garment.triangles, topology: &self.garment.topology };
        let pairs = self.planes.open_pairs(x, cloth.triangles, &end.positions);
        let revised =
            self.planes.revised_edge_contacts(cloth, &end.positions, &end.normals, &end.edges, pairs)?;
        end.edges = revised.into();
        Some(end.edges.clone())
    }

    fn crosses_more(&mut self, x: &[Vec3], loads: &Loads) -> bool {
        let end = self.end.as_ref().filter(|end| Arc::ptr_eq(&end.edges, &loads.edge_contacts));
        end.is_some_and(|end| {
            self.planes.open_pairs(x, &self.garment.triangles, &end.positions).len() > self.max_pairs
        })
    }
}

/// Displacements of all points: where they are not known, those of the nearest points along the cloth.
fn extrapolated(known: Vec<Option<Vec3>>, topology: &Topology) -> Vec<Vec3> {
    let mut all = known;
    let mut open: Vec<[usize; 2]> = topology.edges.iter().map(|e| e.map(PointIndex::at)).collect();
    loop {
        open.retain(|[a, b]| all[*a].is_none() || all[*b].is_none());
        let mut sum: Vec<(Vec3, f64)> = vec![(Vec3::zeros(), 0.0); all.len()];
        for &[a, b] in &open {
            for (from, to) in [(a, b), (b, a)] {
                if let (Some(displacement), None) = (all[from], all[to]) {
                    sum[to].0 += displacement;
                    sum[to].1 += 1.0;
                }
            }
        }
        let mut found = false;
        for (all, (sum, count)) in all.iter_mut().zip(sum).filter(|(_, (_, count))| *count > 0.0) {
            *all = Some(sum / count);
            found = true;
        }
        if !found {
            return all.into_iter().map(Option::unwrap_or_default).collect();
        }
    }
}

/// Displacements averaged with those of neighbours: where two parts of a body are equally near, one point follows one part
/// and the next point the other. Points that are `fixed` (empty for none) do not move.
fn smoothed(mut displacement: Vec<Vec3>, fixed: &[bool], topology: &Topology) -> Vec<Vec3> {
    let is_fixed = |p: usize| fixed.get(p).copied().unwrap_or(false);
    displacement.iter_mut().enumerate().filter(|(p, _)| is_fixed(*p)).for_each(|(_, d)| *d = Vec3::zeros());
    for _ in 0..TUNING.body.smoothing_rounds {
        let (mut sum, mut count) = (displacement.clone(), vec![1.0; displacement.len()]);
        for [a, b] in topology.edges.iter().map(|e| e.map(PointIndex::at)) {
            sum[a] += displacement[b];
            sum[b] += displacement[a];
            count[a] += 1.0;
            count[b] += 1.0;
        }
        for (p, (d, sum)) in displacement.iter_mut().zip(sum).enumerate().filter(|(p, _)| !is_fixed(*p)) {
            *d = sum / count[p];
        }
    }
    displacement
}
