//! A bake on a body: what has to be known before it begins, and the moment the garment is put on.

use crate::bake::active_region::awake;
use crate::bake::depenetration;
use crate::bake::{BakeOptions, Run};
use crate::body::{AnimatedBody, BodyPose, PosedBody};
use crate::contact::{BodyContactSettings, BodyContactState, BodyPlanes, SELF_FOLD_MARGIN};
use crate::energy::{EdgeContact, PlaneContact};
use crate::error::{Error, Result};
use crate::garment::Garment;
use crate::math::Vec3;
use crate::mesh::{PointIndex, Topology};
use crate::sim::{State, StepReport};
use crate::wear::{ActionRunner, PersistentState, WearScript};
use serde::{Deserialize, Serialize};
use std::sync::Arc;
use std::time::Instant;

/// A body, checked against garment and script.
pub(super) struct OnBody {
    pub wearer: Arc<AnimatedBody>,
    /// Per point of the garment: how deep inside the body it lies [m].
    depths: Vec<f64>,
    /// Per point: whether the body cannot stir it; empty when all can be stirred.
    pub asleep: Vec<bool>,
}

impl OnBody {
    /// The body of `options`, if there is one. Refuses joints and clips that it has not and garments that do not fit it.
    pub fn prepare(
        garment: &Garment,
        script: &WearScript,
        script_file: &str,
        options: &BakeOptions,
    ) -> Result<Option<Self>> {
        let Some(wearer) = &options.body else { return Ok(None) };
        let mut faults = script.body_errors(script_file, wearer);
        let depths = match depenetration::depths(&garment.points, wearer) {
            Ok(depths) => depths,
            Err(Error::Input(more)) => {
                faults.extend(more);
                Vec::new()
            }
            Err(other) => return Err(other),
        };
        if !faults.is_empty() {
            return Err(Error::Input(faults));
        }
        let asleep = active_points(garment, script, options).iter().map(|stirred| !stirred).collect();
        Ok(Some(Self { wearer: wearer.clone(), depths, asleep }))
    }
}

/// The points of `garment` that the body of `options` stirs on its way through `script`, one flag per point. Empty when all
/// are to be taken as stirred: without a body, with one that only stands, or when a script does more than move it.
pub fn active_points(garment: &Garment, script: &WearScript, options: &BakeOptions) -> Vec<bool> {
    let Some(wearer) = options.body.as_ref().filter(|_| options.deactivate_static) else { return Vec::new() };
    let awake = awake(garment, wearer, &script.body_poses(wearer));
    if awake.contains(&true) { awake } else { Vec::new() }
}

/// Rounds in which a lead is averaged with its neighbours'.
const SMOOTHING: usize = 6;

/// A lead without jumps: where two parts of a body are equally near, one point follows one and the next the other.
fn smoothed(mut lead: Vec<Vec3>, held: &[bool], topology: &Topology) -> Vec<Vec3> {
    let is_held = |p: usize| held.get(p).copied().unwrap_or(false);
    lead.iter_mut().enumerate().filter(|(p, _)| is_held(*p)).for_each(|(_, d)| *d = Vec3::zeros());
    for _ in 0..SMOOTHING {
        let (mut sum, mut count) = (lead.clone(), vec![1.0; lead.len()]);
        for [a, b] in topology.edges.iter().map(|e| e.map(PointIndex::at)) {
            sum[a] += lead[b];
            sum[b] += lead[a];
            count[a] += 1.0;
            count[b] += 1.0;
        }
        for (p, (lead, sum)) in lead.iter_mut().zip(sum).enumerate().filter(|(p, _)| !is_held(*p)) {
            *lead = sum / count[p];
        }
    }
    lead
}

/// How far cloth was inside the body.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyPenetrationStats {
    /// Pairs of triangles of cloth and body that crossed where the body is open, and where it lies on itself: most after any
    /// step, when that was [s], and after the last.
    crossed: [(usize, f64); 2],
    crossing: [usize; 2],
    /// Steps with crossings where the body is open.
    steps: usize,
    /// When that began and ended [s].
    times: Option<[f64; 2]>,
    /// [m].
    depth: f64,
    #[serde(with = "crate::math::serde_vec::vector")]
    place: Vec3,
}

/// Cloth that is deeper inside than this is told [m].
const TOLD: f64 = 1e-3;
/// Radius of a limb, for how far straight edges of cloth sink into it [m].
const LIMB: f64 = 0.04;

impl BodyPenetrationStats {
    /// After a step that ended at `time` [s] with the cloth at `x` and `crossing` pairs of triangles.
    fn note(&mut self, time: f64, x: &[Vec3], cushions: &[PlaneContact], crossing: [usize; 2]) {
        self.crossing = crossing;
        self.steps += usize::from(crossing[0] > 0);
        for (most, now) in self.crossed.iter_mut().zip(crossing) {
            if now > most.0 {
                *most = (now, time);
            }
        }
        let Some((point, depth)) = BodyPlanes::deepest_penetration(x, cushions).filter(|(_, d)| *d > TOLD)
        else {
            return;
        };
        self.times = Some([self.times.map_or(time, |[from, _]| from), time]);
        if depth > self.depth {
            (self.depth, self.place) = (depth, x.get(point as usize).copied().unwrap_or_else(Vec3::zeros));
        }
    }

    /// In words, if there was any.
    pub fn warnings(&self) -> Vec<String> {
        self.inside().into_iter().chain(self.across()).collect()
    }

    fn across(&self) -> Option<String> {
        let [(open, at), (folded, when)] = self.crossed;
        let [open_now, folded_now] = self.crossing;
        let parts = [
            (open > 0).then(|| {
                format!(
                    "{open} at {at:.2} s, in {} steps some, {open_now} at the end of the wear (its corners between points of the cloth: a \
                     finer --resolution has fewer)",
                    self.steps
                )
            }),
            (folded > 0).then(|| {
                format!(
                    "where it folds into itself and {:.0} mm around {folded} at {when:.2} s, {folded_now} at the end",
                    1e3 * SELF_FOLD_MARGIN
                )
            }),
        ];
        let parts: Vec<String> = parts.into_iter().flatten().collect();
        (!parts.is_empty()).then(|| format!("pairs of triangles that crossed the body: {}", parts.join("; ")))
    }

    fn inside(&self) -> Option<String> {
        let [from, to] = self.times?;
        let p = self.place;
        Some(format!(
            "{from:.2} to {to:.2} s, now and then: cloth up to {:.1} mm inside the body, deepest near ({:.3}, {:.3}, {:.3}) m: where a body \
             folds into itself there is no room for cloth",
            1e3 * self.depth,
            p.x,
            p.y,
            p.z
        ))
    }
}

/// What a checkpoint keeps of a body and the cloth on it.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct BodyCheckpoint {
    /// As the actions before have left it.
    pub pose: BodyPose,
    /// How it meets the cloth.
    pub field: BodyContactState,
    /// How far cloth was inside it so far.
    pub pinch: BodyPenetrationStats,
    /// Time that dressing took [s].
    pub dressing_s: f64,
}

impl BodyCheckpoint {
    /// Whether it can be of `wearer` under a cloth of `points` points.
    pub fn fits(&self, wearer: &AnimatedBody, points: usize) -> bool {
        self.field.fits(wearer.rest_points().len(), points)
    }
}

/// Where the body is at the end of a step [m], and what of it is under the cloth.
type Met = (Arc<[Vec3]>, Arc<[PlaneContact]>, Arc<[EdgeContact]>);

impl Run<'_> {
    /// The garment is put on; where it was left, if the run is taken up.
    pub(super) fn put_on(&mut self, on_body: OnBody, taken_up: Option<&BodyCheckpoint>) {
        let clock = Instant::now();
        let OnBody { wearer, depths, asleep } = on_body;
        let settings = self.stepper.contact.settings();
        let edge = self.garment.mean_edge();
        let settings = BodyContactSettings {
            point_dhat: settings.dhat + edge * edge / (8.0 * LIMB),
            edge_dhat: settings.dhat,
            stiffness: settings.stiffness,
            areas: self.stepper.cloth.area.clone(),
            friction: settings.friction_body,
            slip_velocity_tol: settings.slip_velocity_tol,
        };
        let mut field = BodyPlanes::new(wearer.rest_points(), wearer.triangles(), settings);
        if let Some(moment) = taken_up {
            self.asleep = asleep;
            // That it fits was checked with the rest of the checkpoint.
            field.restore(&moment.field);
            self.field = Some(field);
            self.posture.body = Some(PosedBody::new(&wearer, moment.pose.clone()));
            self.pinch = moment.pinch.clone();
            self.dressing_s = moment.dressing_s;
            return;
        }
        self.field = Some(field);
        // What will sleep is dressed, too.
        let dressed = self.dress(&wearer, &depths);
        self.asleep = asleep;
        self.report.warnings.extend(dressed.warnings());
        self.posture.body = Some(PosedBody::new(&wearer, wearer.rest()));
        self.dressing_s = clock.elapsed().as_secs_f64();
    }

    /// What a checkpoint must have of the body, which stood as `posture` says when the action under way began.
    pub(super) fn body_moment(&self, posture: &PersistentState) -> Option<BodyCheckpoint> {
        let (field, standing) = (self.field.as_ref()?, posture.body.as_ref()?);
        Some(BodyCheckpoint {
            pose: standing.pose.clone(),
            field: field.state(),
            pinch: self.pinch.clone(),
            dressing_s: self.dressing_s,
        })
    }

    /// One accepted step with the body under the cloth.
    pub(super) fn step_on_body(
        &mut self,
        mut field: BodyPlanes,
        gesture: &mut dyn ActionRunner,
        begin: f64,
        h: f64,
    ) -> StepReport {
        let start = self.state.time;
        let mut last: Option<Met> = None;
        let mut begun = false;
        let (asleep, garment) = (&self.asleep, self.garment);
        let mut drive_at = |time: f64, state: &State| {
            let mut drive = gesture.loads_at(time - begin, &state.x);
            last = None;
            if let Some(points) = drive.body.take() {
                if drive.fixed.is_empty() {
                    drive.fixed.clone_from(asleep);
                }
                if !begun {
                    field.begin_step(&state.x, &garment.triangles, &garment.topology, &drive.fixed);
                    begun = true;
                }
                let points: Arc<[Vec3]> = field.resolve_self_contact(&points).into();
                let normals = field.normals(&points);
                drive.plane_contacts =
                    field.plane_contacts(&state.x, &points, &normals, time - start, drive.friction).into();
                drive.edge_contacts = field.edge_contacts(&points, &normals).into();
                drive.body_displacement =
                    smoothed(field.carried_displacement(&state.x, &points), &drive.fixed, &garment.topology)
                        .into();
                last = Some((points, drive.plane_contacts.clone(), drive.edge_contacts.clone()));
            }
            drive
        };
        let step = self.stepper.advance(&mut self.state, &self.memory.effective_rest, &mut drive_at, h);
        if let Some((points, cushions, supports)) = last {
            let moves = field.accept(&self.state.x, &points, &cushions, &supports);
            let crossing = field.raise_offsets(&self.state.x, &garment.triangles, moves);
            self.pinch.note(self.state.time, &self.state.x, &cushions, crossing);
        }
        self.field = Some(field);
        step
    }
}
