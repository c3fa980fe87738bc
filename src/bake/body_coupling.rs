//! Coupling of the cloth to the body that wears it: the body's contact planes and edges in every step.
//!
//! The body moves as the script says; the cloth follows it by one-sided contact (`contact::body_planes`). Does not do: forces
//! of the cloth on the body.

use crate::bake::body_penetration::BodyPenetrationStats;
use crate::bake::tuning::TUNING;
use crate::body::{AnimatedBody, BodyPose};
use crate::contact::{BodyContactSettings, BodyContactState, BodyPlanes, ContactSettings};
use crate::energy::{EdgeContact, PlaneContact};
use crate::garment::{Garment, RestState};
use crate::math::Vec3;
use crate::mesh::{PointIndex, Topology};
use crate::remesh::Refinement;
use crate::sim::{State, StepReport, Stepper};
use crate::wear::ActionRunner;
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// The body under the cloth during a run.
pub(super) struct BodyCoupling {
    /// Contact planes of the body.
    planes: BodyPlanes,
    /// Per point of the cloth: whether the moving body cannot affect it; empty when all can be affected.
    pub inactive: Vec<bool>,
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
pub(super) struct SteppedCloth<'a> {
    /// The simulated mesh.
    pub garment: &'a Garment,
    /// Solver and contact.
    pub stepper: &'a mut Stepper,
    /// Positions and velocities.
    pub state: &'a mut State,
    /// The rest state in the energies.
    pub rest: &'a RestState,
}

/// The body at the end of a step, and its contact with the cloth.
struct ContactAtEnd {
    /// Positions of the body, one per point of it [m].
    positions: Arc<[Vec3]>,
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
        let settings = BodyContactSettings {
            point_dhat: mean_square_edges(garment)
                .into_iter()
                .map(|square| settings.dhat + square / (8.0 * TUNING.body.limb_radius))
                .collect(),
            edge_dhat: settings.dhat,
            stiffness: TUNING.body.contact_stiffness,
            areas,
            friction: settings.friction_body,
            slip_velocity_tol: settings.slip_velocity_tol,
        };
        Self {
            planes: BodyPlanes::new(animated.rest_points(), animated.triangles(), settings),
            inactive: Vec::new(),
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
        refined
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

    /// Drops what is cached between steps for speed alone.
    pub fn clear_caches(&mut self) {
        self.planes.clear_caches();
    }

    /// Makes one accepted step of at most `dt` [s] in an action that began at `begin` [s].
    pub fn step(
        &mut self,
        cloth: SteppedCloth,
        runner: &mut dyn ActionRunner,
        begin: f64,
        dt: f64,
    ) -> StepReport {
        let SteppedCloth { garment, stepper, state, rest } = cloth;
        let (planes, inactive) = (&mut self.planes, &self.inactive);
        let start = state.time;
        let mut last: Option<ContactAtEnd> = None;
        let mut begun = false;
        let mut loads_at_time = |time: f64, state: &State| {
            let mut loads = runner.loads_at(time - begin, &state.x);
            last = None;
            if let Some(points) = loads.body.take() {
                if loads.fixed.is_empty() {
                    loads.fixed.clone_from(inactive);
                }
                if !begun {
                    planes.begin_step(&state.x, &garment.triangles, &garment.topology, &loads.fixed);
                    begun = true;
                }
                let points: Arc<[Vec3]> = planes.resolve_self_contact(&points).into();
                let normals = planes.normals(&points);
                loads.plane_contacts =
                    planes.plane_contacts(&state.x, &points, &normals, time - start, loads.friction).into();
                loads.edge_contacts = planes.edge_contacts(&points, &normals).into();
                let carried = extrapolated(planes.carried_displacement(&state.x, &points), &garment.topology);
                loads.body_displacement = smoothed(carried, &loads.fixed, &garment.topology).into();
                last = Some(ContactAtEnd {
                    positions: points,
                    planes: loads.plane_contacts.clone(),
                    edges: loads.edge_contacts.clone(),
                });
            }
            loads
        };
        let step = stepper.advance(state, rest, &mut loads_at_time, dt);
        if let Some(end) = last {
            let moves = planes.end_step(&state.x, &end.positions, &end.planes, &end.edges);
            let intersections = planes.raise_offsets(&state.x, &garment.triangles, moves);
            self.penetration.record(state.time, &state.x, &end.planes, intersections);
        }
        step
    }
}

/// Means of the squared lengths of the edges at every point of `garment` [m²].
fn mean_square_edges(garment: &Garment) -> Vec<f64> {
    let mut sum = vec![[0.0, 0.0]; garment.points.len()];
    for &[a, b] in &garment.topology.edges {
        let square = (garment.points[a.at()] - garment.points[b.at()]).norm_squared();
        for p in [a, b] {
            sum[p.at()][0] += square;
            sum[p.at()][1] += 1.0;
        }
    }
    sum.into_iter().map(|[square, count]| square / f64::max(count, 1.0)).collect()
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
