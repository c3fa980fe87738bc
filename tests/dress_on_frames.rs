//! A dress on a body that is given as frames: it walks and swings its arms, and the dress hangs on its hips by contact alone. The
//! environment variable `CREASE_FULL_SIZE` makes it four seconds.

use crease::internal::bake::{Bake, BakeProgress, Observer, Quality};
use crease::internal::wear::WearScript;
use crease_geometry::math::Vec3;
use crease_geometry::mesh::intersections::{intersections_between, self_intersections};
use crease_model::body::{AnimatedBody, BodyMotion, Sequence};
use crease_model::error::Message;
use crease_model::fabric::Fabric;
use crease_model::garment::{Garment, MeshOptions};
use std::f64::consts::TAU;
use std::sync::Arc;

const RATE: f64 = 30.0;

/// A surface of rings.
#[derive(Default)]
struct Rings {
    points: Vec<Vec3>,
    triangles: Vec<[u32; 3]>,
}

impl Rings {
    /// Adds a tube of `around` points through rings of centre and radii along x and z [m], from below; closed at both ends or open.
    fn add(&mut self, around: u32, rings: &[(Vec3, [f64; 2])], is_closed: bool) {
        let first = self.points.len() as u32;
        for (centre, [a, b]) in rings {
            for k in 0..around {
                let angle = TAU * f64::from(k) / f64::from(around);
                self.points.push(centre + Vec3::new(a * angle.sin(), 0.0, b * angle.cos()));
            }
        }
        let at = |ring: u32, k: u32| first + ring * around + k % around;
        let count = rings.len() as u32;
        for (ring, k) in (0..count - 1).flat_map(|ring| (0..around).map(move |k| (ring, k))) {
            let [a, b, c, d] = [at(ring, k), at(ring, k + 1), at(ring + 1, k + 1), at(ring + 1, k)];
            let is_even = (ring + k) % 2 == 0;
            self.triangles.extend(if is_even { [[a, b, c], [a, c, d]] } else { [[a, b, d], [b, c, d]] });
        }
        if is_closed {
            for (ring, is_last) in [(0, false), (count - 1, true)] {
                let middle = self.points.len() as u32;
                self.points.push(rings[ring as usize].0);
                let cap = |k: u32| {
                    let (a, b) = (at(ring, k), at(ring, k + 1));
                    if is_last { [a, b, middle] } else { [b, a, middle] }
                };
                self.triangles.extend((0..around).map(cap));
            }
        }
    }

    /// The points after `from` turned by `angle` about the x axis through `pivot`.
    fn turn(&mut self, from: usize, pivot: Vec3, angle: f64) {
        let (sin, cos) = angle.sin_cos();
        for point in &mut self.points[from..] {
            let d = *point - pivot;
            *point = pivot + Vec3::new(d.x, cos * d.y - sin * d.z, sin * d.y + cos * d.z);
        }
    }
}

/// Radii of the trunk at the height `y` [m]: hips, a waist, the chest.
fn trunk(y: f64) -> [f64; 2] {
    let bump = |at: f64, width: f64| (-((y - at) / width).powi(2)).exp();
    let wide = 0.125 + 0.045 * bump(0.9, 0.1) + 0.035 * bump(1.32, 0.13);
    [wide, 0.72 * wide]
}

/// The body at `t` [s]: thighs and arms swing by up to 25 degrees `pace` times a second, against each other, from rest on.
fn body(t: f64, pace: f64) -> Rings {
    let mut rings = Rings::default();
    let along = |from: f64, to: f64, count: u32| {
        (0..count).map(move |k| from + (to - from) * f64::from(k) / f64::from(count - 1))
    };
    let trunk: Vec<_> = along(0.8, 1.45, 14).map(|y| (Vec3::new(0.0, y, 0.0), trunk(y))).collect();
    rings.add(24, &trunk, true);
    let swing = (25.0_f64).to_radians() * (t / 0.5).min(1.0) * (TAU * pace * t).sin();
    for side in [1.0, -1.0] {
        let from = rings.points.len();
        let leg: Vec<_> =
            along(0.05, 0.9, 16).map(|y| (Vec3::new(0.085 * side, y, 0.0), [0.045 + 0.04 * y; 2])).collect();
        rings.add(12, &leg, true);
        rings.turn(from, Vec3::new(0.0, 0.9, 0.0), side * swing);
        let from = rings.points.len();
        let arm: Vec<_> = along(0.8, 1.4, 10).map(|y| (Vec3::new(0.27 * side, y, 0.0), [0.035; 2])).collect();
        rings.add(10, &arm, true);
        rings.turn(from, Vec3::new(0.0, 1.4, 0.0), -side * swing);
    }
    rings
}

/// The dress: 12 mm from the trunk down to the hips, from there a skirt to above the knees.
fn dress() -> Rings {
    let mut rings = Rings::default();
    let ring = |k: u32| {
        let y = 0.55 + 0.7 * f64::from(k) / 28.0;
        let below = (0.9 - y).max(0.0);
        let [a, b] = trunk(y.max(0.9)).map(|radius| radius + 0.012);
        (Vec3::new(0.0, y, 0.0), [a + 0.15 * below, b + 0.32 * below])
    };
    rings.add(40, &(0..=28).map(ring).collect::<Vec<_>>(), false);
    rings
}

/// Frames of the garment.
#[derive(Default)]
struct Frames(Vec<Vec<Vec3>>);

impl Observer for Frames {
    fn progress(&mut self, _: &BakeProgress) {}

    fn frame(&mut self, points: &[Vec3]) -> crease::Result<()> {
        self.0.push(points.to_vec());
        Ok(())
    }
}

/// What a walk of `seconds` at `pace` steps a second does to the dress.
struct Walked {
    /// Largest stretch of an edge in any frame [-].
    stretch: f64,
    /// Most pairs of triangles of dress and body that intersect in a frame.
    pairs: usize,
    /// Height of the lowest point in any frame [m].
    lowest: f64,
    warnings: Vec<Message>,
}

fn walk(seconds: f64, pace: f64) -> Walked {
    let count = (seconds * RATE) as usize + 1;
    let frames: Vec<Vec<Vec3>> = (0..count).map(|k| body(k as f64 / RATE, pace).points).collect();
    let start = body(0.0, pace);
    let motion = BodyMotion::Sequence(Sequence { rate: RATE, frames });
    let animated = Arc::new(AnimatedBody::new("walk", "", motion, &start.points, &start.triangles));
    let worn = dress();
    let positions: Vec<[f64; 3]> = worn.points.iter().map(|p| [p.x, p.y, p.z]).collect();
    let garment = Garment::from_mesh(&positions, &worn.triangles, MeshOptions::default().name("dress"))
        .expect("is a garment");
    let script = r#"{"format": "crease-wear/1", "actions": [{"play": {"clip": "frames"}}]}"#;
    let script = WearScript::parse("", script).expect("is a script");
    let fabric = Fabric::preset("cotton-jersey").expect("exists");
    let mut shown = Frames::default();
    let bake = Bake::new(&garment, &fabric, &script).quality(Quality::Draft).frames_per_second(RATE);
    let baked = bake.body(animated.clone()).run_with(&mut shown).expect("runs");
    assert_eq!(baked.report.unconverged_reason, None, "{:?}", baked.report.warnings);
    assert!(shown.0.len() >= count);

    let edges: Vec<[usize; 2]> = garment.topology.edges.iter().map(|e| e.map(|p| p.at())).collect();
    let length = |x: &[Vec3], [a, b]: [usize; 2]| (x[a] - x[b]).norm();
    let mut walked =
        Walked { stretch: 0.0, pairs: 0, lowest: f64::INFINITY, warnings: baked.report.warnings };
    for (k, x) in shown.0.iter().enumerate() {
        assert!(self_intersections(x, &garment.triangles).is_empty(), "frame {k}");
        let ratio = |edge: &[usize; 2]| length(x, *edge) / length(&garment.points, *edge) - 1.0;
        walked.stretch = edges.iter().map(ratio).fold(walked.stretch, f64::max);
        let pose = animated.points(&animated.clip_pose(0, k as f64 / RATE, None));
        let pairs = intersections_between(x, &garment.triangles, &pose, animated.triangles()).len();
        walked.pairs = walked.pairs.max(pairs);
        walked.lowest = x.iter().map(|p| p.y).fold(walked.lowest, f64::min);
    }
    let Walked { stretch, pairs, lowest, warnings } = &walked;
    println!(
        "{} frames, {} steps, stretch {stretch:.3}, {pairs} pairs, lowest {lowest:.3} m: {warnings:?}",
        shown.0.len(),
        baked.report.steps
    );
    walked
}

/// Frames show a run and change nothing of it: neither on a body that moves nor where the state of an action goes on from step to step.
#[test]
fn a_run_is_the_same_with_frames_and_without() {
    let fabric = Fabric::preset("cotton-jersey").expect("exists");
    let end = |garment: &Garment, body: &Arc<AnimatedBody>, actions: &str, rate: f64| {
        let script = format!(r#"{{"format": "crease-wear/1", "actions": [{actions}]}}"#);
        let script = WearScript::parse("", &script).expect("is a script");
        let bake = Bake::new(garment, &fabric, &script).quality(Quality::Draft).frames_per_second(rate);
        bake.body(body.clone()).run_with(&mut Frames::default()).expect("runs").end
    };
    let frames: Vec<Vec<Vec3>> = (0..10).map(|k| body(f64::from(k) / RATE, 1.0).points).collect();
    let motion = BodyMotion::Sequence(Sequence { rate: RATE, frames });
    let start = body(0.0, 1.0);
    let walking = Arc::new(AnimatedBody::new("walk", "", motion, &start.points, &start.triangles));
    let worn = dress();
    let positions: Vec<[f64; 3]> = worn.points.iter().map(|p| [p.x, p.y, p.z]).collect();
    let garment = Garment::from_mesh(&positions, &worn.triangles, MeshOptions::default().name("dress"))
        .expect("is a garment");
    let play = r#"{"play": {"clip": "frames"}}"#;
    assert_eq!(end(&garment, &walking, play, 0.0), end(&garment, &walking, play, 100.0));

    let corners = [[1.0, 0.0, 0.0], [2.0, 0.0, 0.0], [2.0, 0.0, 1.0], [1.0, 0.0, 1.0]].map(Vec3::from);
    let table = AnimatedBody::new("table", "", BodyMotion::Still, &corners, &[[0, 2, 1], [0, 3, 2]]);
    let table = Arc::new(table);
    let sheet = Garment::sheet([0.3, 0.3], [6, 6]).expect("is a sheet");
    let folds = r#"{"lay": {"facing": "up", "over": 0.2}}, {"fold": {"line": [[0.5, 0], [0.5, 1]], "side": "left", "over": 0.4}},
        {"fold": {"line": [[0, 0.5], [1, 0.5]], "side": "upper", "over": 0.4}}, {"unfold": {"over": 0.8}}, {"hold": {"for": 0.1}}"#;
    assert_eq!(end(&sheet, &table, folds, 0.0), end(&sheet, &table, folds, 50.0));
}

#[test]
fn a_dress_walks_with_its_body() {
    let seconds = if std::env::var_os("CREASE_FULL_SIZE").is_some() { 4.0 } else { 1.5 };
    let walked = walk(seconds, 1.0);
    assert!(walked.stretch < 0.2, "{}", walked.stretch);
    assert!(walked.pairs <= 2, "{}", walked.pairs);
    assert!(walked.lowest > 0.5, "it has not slipped: {}", walked.lowest);
    assert!(walked.warnings.is_empty(), "{:?}", walked.warnings);
}

/// Thighs that move by more than the reach of contact in the longest step.
#[test]
fn legs_that_run_do_not_pass_the_cloth_between_two_steps() {
    let walked = walk(1.2, 2.5);
    assert!(walked.warnings.iter().all(|text| !text.contains("crossed the body")), "{:?}", walked.warnings);
    assert!(walked.stretch < 0.2, "{}", walked.stretch);
}
