//! Findings on a bake without effect, or with less than the wear left: actions that move nothing, a garment that the body
//! never came near, a mesh too coarse for its creases, a result without any memory.

use crate::bake::tuning::TUNING;
use crate::bake::{BakeOptions, BakeResult};
use crate::wear::{Action, WearScript};
use crease_geometry::math::Vec3;
use crease_geometry::mesh::triangle_bvh::TriangleBvh;
use crease_model::body::AnimatedBody;
use crease_model::error::{Message, Setting};
use crease_model::garment::{Garment, RestState, ShownWear};
use std::borrow::Cow;

/// Adds warnings to the report of `baked`, and the reason why its result is empty if it is.
pub(in crate::bake) fn add_findings(
    garment: &Garment,
    script: &WearScript,
    options: &BakeOptions,
    earlier: Option<&RestState>,
    baked: &mut BakeResult,
) {
    let report = &mut baked.report;
    report.warn(idle_actions(script, options.body.as_deref()));
    // A skinned garment follows the joints of a body whose skin may have been cut away under it.
    let worn_by_contact = options.body.as_ref().filter(|_| options.skin.is_none());
    let far = worn_by_contact.and_then(|body| distance_from_body(garment, script, body));
    if let Some(distance) = far {
        let what = format!(
            "the garment never comes nearer to the body than {distance:.2} m: check the units of both files ("
        );
        report.warnings.push(
            Message::from(what)
                + Setting::Unit
                + ", "
                + Setting::BodyUnit
                + ") and that they lie in one place",
        );
    }
    let wears = script
        .flatten()
        .any(|action| !matches!(*action, Action::Lay(_) | Action::Release(_) | Action::Settle(_)));
    if !options.memory || !wears {
        return;
    }
    let on_mesh = &baked.simulated;
    let earned = crease_sum(&on_mesh.garment, &on_mesh.worn.memory);
    let kept = crease_sum(garment, &baked.worn.memory);
    if earned > TUNING.findings.min_crease_sum && kept < TUNING.findings.min_kept_fraction * earned {
        let mm = 1e3 * garment.mean_edge();
        let what = format!(
            "the mesh of the file is too coarse for its creases: with edges of {mm:.0} mm it keeps {:.0} % of them; ",
            (100.0 * kept / earned).max(0.0)
        );
        let advised = (0.25 * mm).clamp(1.0, TUNING.findings.max_advised_resolution_mm).round();
        report.warnings.push(
            Message::from(what) + Setting::Resolution.to_number(format!("{advised:.0}")) + " refines it",
        );
    }
    let cure = match (far.is_some(), garment.topology.hinges.is_empty(), options.body.is_some()) {
        (true, ..) => "the garment is not on the body".into(),
        (_, true, _) => {
            Message::from("the mesh has no edge to bend at; refine it with ") + Setting::Resolution
        }
        (_, _, true) => "the body moved none of it enough: bend further, longer or more often".into(),
        _ => Message::from("fold, press or hold it longer, or refine the mesh with ") + Setting::Resolution,
    };
    report.empty_reason = empty_reason(&baked.worn.memory, earlier, cure);
    let is_worn = report.empty_reason.is_none();
    let faint = || ShownWear::of(&baked.worn, garment).faint_warning().filter(|_| is_worn);
    report.warn(baked.worn.hidden_warning(garment).or_else(faint));
}

/// Reason why `memory` is empty, with a `cure`, if nothing in it changed to speak of against the `earlier` one or new cloth.
pub(in crate::bake) fn empty_reason(
    memory: &RestState,
    earlier: Option<&RestState>,
    cure: Message,
) -> Option<Message> {
    let limit = TUNING.findings.min_angle_change.to_degrees();
    let change = earlier.map(|earlier| memory.change_since(earlier));
    let what = format!("nothing is remembered: no hinge changed by {limit} degrees and no length (");
    is_unchanged(change.as_ref().unwrap_or(memory)).then(|| Message::from(what) + cure + ")")
}

/// A warning per action that takes no time, or that moves no part of `body`; repeated ones count once.
fn idle_actions(script: &WearScript, body: Option<&AnimatedBody>) -> Vec<Message> {
    let mut known: Vec<Cow<Action>> = Vec::new();
    let mut warnings = Vec::new();
    for (number, action) in script.flatten().enumerate() {
        if known.contains(&action) || warnings.len() >= TUNING.findings.max_idle_actions {
            continue;
        }
        known.push(action.clone());
        let called = format!("action {} of the script, `{}`,", number + 1, action.name());
        let moves_body = matches!(*action, Action::Bend(_) | Action::Play(_));
        if let (true, Some(body)) = (moves_body, body) {
            let poses = action.as_wear_action().body_poses(body, &body.rest());
            let start = body.rest_points();
            let moves = |x: &Vec<Vec3>| {
                x.iter().zip(start).any(|(a, b)| (a - b).norm() > TUNING.active_region.min_body_motion)
            };
            if !poses.is_empty() && !poses.iter().map(|pose| body.points(pose)).any(|x| moves(&x)) {
                let what = format!(
                    "{called} moves no vertex of the body: check that its joint or clip moves the mesh ("
                );
                warnings.push(Message::from(what) + Setting::Explain + " lists the joints), and the angle");
            }
        } else if !matches!(*action, Action::Release(_) | Action::Play(_))
            && action.as_wear_action().duration() <= 0.0
        {
            let what = format!("{called} takes no time, so that nothing happens in it: give it a duration");
            warnings.push(what.into());
        }
    }
    warnings
}

/// Whether no hinge and no triangle changed to speak of.
fn is_unchanged(memory: &RestState) -> bool {
    let mut stretches = memory.rest_stretch_warp.iter().chain(&memory.rest_stretch_weft);
    memory.angle_changes().all(|change| change.abs() < TUNING.findings.min_angle_change)
        && stretches.all(|stretch| (stretch - 1.0).abs() < TUNING.findings.min_stretch_change)
}

/// Change of rest angle times length, summed over the hinges [rad m].
fn crease_sum(garment: &Garment, memory: &RestState) -> f64 {
    let length = |h: &crease_geometry::mesh::Hinge| {
        (garment.points[h.points[1].at()] - garment.points[h.points[0].at()]).norm()
    };
    garment
        .topology
        .hinges
        .iter()
        .zip(memory.angle_changes())
        .map(|(h, change)| change.abs() * length(h))
        .sum()
}

/// Smallest distance [m] between garment and body in the poses of the script, if they never come near each other.
fn distance_from_body(garment: &Garment, script: &WearScript, body: &AnimatedBody) -> Option<f64> {
    let rest = body.rest_points();
    let mut poses: Vec<Vec<Vec3>> = script.body_poses(body).iter().map(|pose| body.points(pose)).collect();
    poses.push(rest.to_vec());
    let mut bvh = TriangleBvh::new(rest, body.triangles(), 0.0);
    let mut nearest = f64::INFINITY;
    for x in &poses {
        bvh.refit(x, x, 0.0);
        for p in &garment.points {
            if let Some(near) = bvh.nearest(x, *p, nearest) {
                nearest = nearest.min(near.closest.distance);
            }
            if nearest <= TUNING.findings.near_body {
                return None;
            }
        }
    }
    nearest.is_finite().then_some(nearest)
}
