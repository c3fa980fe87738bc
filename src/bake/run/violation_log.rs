//! Log of violated constraints over a run: one warning per stretch of time, with the worst position.

use crate::bake::report::StopCause;
use crate::bake::tuning::TUNING;
use crease_model::error::{Message, Setting};
use crease_solver::sim::{Violation, Violations};
use serde::{Deserialize, Serialize};

/// One stretch of time in which a constraint was violated.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Episode {
    /// Beginning [s].
    from: f64,
    /// End [s].
    to: f64,
    worst: Violation,
}

impl Episode {
    /// Time and position in words.
    fn describe(&self) -> [String; 2] {
        let Self { from, to, .. } = self;
        let when = if to > from { format!("{from:.2} to {to:.2} s") } else { format!("{from:.2} s") };
        let x = &self.worst.position;
        [when, format!("({:.3}, {:.3}, {:.3}) m", x.x, x.y, x.z)]
    }
}

/// All violations so far.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ViolationLog {
    /// Layers pressed together: the gap left as a fraction of the thickness [-].
    pressed: Vec<Episode>,
    /// Cloth overstretched: its strain [-].
    stretched: Vec<Episode>,
    /// Cloth stretched beyond what it bears.
    torn: Vec<Episode>,
    /// Steps in a row, up to the last one, in which nothing moved though the solver did not converge.
    stuck: Option<Stuck>,
}

/// Steps in a row in which contact held the whole cloth fast.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
struct Stuck {
    /// End of the first of them [s].
    from: f64,
    steps: u64,
    /// Where layers touch.
    tightest: Violation,
}

impl ViolationLog {
    /// Records the violations of the step that ended at `time` [s].
    pub(in crate::bake) fn record(&mut self, time: f64, found: &Violations) {
        // The smaller the gap that is left between pressed layers, the worse.
        record(&mut self.pressed, time, found.pressed, |a, b| a < b);
        record(&mut self.stretched, time, found.stretched, |a, b| a > b);
        record(&mut self.torn, time, found.torn, |a, b| a > b);
        let before = self.stuck.take();
        self.stuck = found.stuck.map(|tightest| {
            let first = before.map_or(time, |stuck| stuck.from);
            Stuck { from: first, steps: 1 + before.map_or(0, |stuck| stuck.steps), tightest }
        });
    }

    /// Cause to end the run at `time` [s]: cloth that has been stretched beyond what it bears for longer than a moment, or that has
    /// not moved at all for some steps though the solver did not converge.
    pub(in crate::bake) fn cause_to_stop(&self, time: f64) -> Option<StopCause> {
        self.stuck_cause().or_else(|| self.torn_cause(time))
    }

    fn stuck_cause(&self) -> Option<StopCause> {
        let Stuck { from, tightest, .. } =
            self.stuck.filter(|stuck| stuck.steps >= TUNING.warnings.max_stuck_steps)?;
        let x = &tightest.position;
        let reason = format!(
            "the cloth is stuck: since {from:.2} s nothing moves, as layers touch near ({:.3}, {:.3}, {:.3}) m; part the layers there in \
             the file, leave out what lies double, or choose another ",
            x.x, x.y, x.z
        );
        let reason = Message::from(reason) + Setting::Resolution;
        Some(StopCause { reason, position: *x })
    }

    fn torn_cause(&self, time: f64) -> Option<StopCause> {
        let torn = self.torn.last()?;
        (torn.to == time && time - torn.from >= TUNING.warnings.max_torn_time).then(|| {
            let [_, at] = torn.describe();
            let reason = format!(
                "the cloth is torn: since {:.2} s it is stretched to {:.1} times its length near {at}; check the unit, the fit \
                 on the body and what pulls there, or begin with a slower motion",
                torn.from,
                1.0 + torn.worst.size
            );
            StopCause { reason: reason.into(), position: torn.worst.position }
        })
    }

    /// Warnings, in order of the constraints.
    pub(in crate::bake) fn warnings(&self) -> Vec<String> {
        let pressed = warnings(&self.pressed, "pressed layers too thin", |size, when, at| {
            format!(
                "{when}: layers pressed to {:.0} % of their thickness near {at}; none of them crossed",
                100.0 * size
            )
        });
        let stretched = warnings(&self.stretched, "overstretched cloth", |size, when, at| {
            format!("{when}: cloth stretched by {:.0} % near {at}", 100.0 * size)
        });
        [pressed, stretched].concat()
    }
}

/// Records what was `found` at `time` [s], in the last episode if that has just ended.
fn record(
    episodes: &mut Vec<Episode>,
    time: f64,
    found: Option<Violation>,
    is_worse: impl Fn(f64, f64) -> bool,
) {
    let Some(found) = found else { return };
    match episodes.last_mut().filter(|last| time - last.to <= TUNING.warnings.max_pause) {
        Some(last) => {
            last.to = time;
            if is_worse(found.size, last.worst.size) {
                last.worst = found;
            }
        }
        None => episodes.push(Episode { from: time, to: time, worst: found }),
    }
}

/// One warning for each of the first episodes, by size, time and position, and one that counts the others.
fn warnings(
    episodes: &[Episode],
    summary: &str,
    describe: impl Fn(f64, &str, &str) -> String,
) -> Vec<String> {
    let max = TUNING.warnings.max_violations;
    let mut all: Vec<String> = episodes
        .iter()
        .take(max)
        .map(|episode| {
            let [when, at] = episode.describe();
            describe(episode.worst.size, &when, &at)
        })
        .collect();
    if episodes.len() > max {
        all.push(format!("{} more times something {summary}", episodes.len() - max));
    }
    all
}

#[cfg(test)]
mod tests {
    use super::*;
    use crease_geometry::math::Vec3;

    #[test]
    fn near_times_make_one_warning_with_the_worst_place() {
        let mut log = ViolationLog::default();
        let stretched = |size: f64, x: f64| Violations {
            stretched: Some(Violation { size, position: Vec3::new(x, 0.0, 0.0) }),
            ..Violations::default()
        };
        log.record(1.0, &stretched(0.31, 0.1));
        log.record(1.2, &stretched(0.43, 0.2));
        log.record(1.3, &Violations::default());
        log.record(1.4, &stretched(0.32, 0.3));
        log.record(5.0, &stretched(0.31, 0.4));
        let warnings = log.warnings();
        assert_eq!(warnings.len(), 2);
        assert!(warnings[0].starts_with("1.00 to 1.40 s: "), "{}", warnings[0]);
        assert!(warnings[0].contains("43 % near (0.200, 0.000, 0.000) m"), "{}", warnings[0]);
        assert!(warnings[1].starts_with("5.00 s: "));
    }

    #[test]
    fn the_rest_is_counted() {
        let mut log = ViolationLog::default();
        let pressed = Violations {
            pressed: Some(Violation { size: 0.05, position: Vec3::zeros() }),
            ..Violations::default()
        };
        (0..9).for_each(|k| log.record(f64::from(k), &pressed));
        let warnings = log.warnings();
        assert_eq!(warnings.len(), 6);
        assert!(warnings[0].contains("5 % of their thickness"));
        assert_eq!(warnings[5], "4 more times something pressed layers too thin");
    }

    #[test]
    fn cloth_that_stays_stuck_is_a_reason_to_stop() {
        let mut log = ViolationLog::default();
        let stuck = Violations {
            stuck: Some(Violation { size: 0.0, position: Vec3::zeros() }),
            ..Violations::default()
        };
        for time in [0.1, 0.2, 0.3, 0.4] {
            log.record(time, &stuck);
            assert_eq!(log.cause_to_stop(time), None, "some steps pass");
        }
        log.record(0.5, &Violations::default());
        for time in [0.6, 0.7, 0.8, 0.9, 1.0] {
            log.record(time, &stuck);
        }
        let reason = log.cause_to_stop(1.0).expect("it does not pass").reason;
        assert!(reason.contains("since 0.60 s"), "{reason}");
    }

    #[test]
    fn cloth_that_stays_torn_is_a_reason_to_stop() {
        let mut log = ViolationLog::default();
        let torn = Violations {
            torn: Some(Violation { size: 1.4, position: Vec3::zeros() }),
            ..Violations::default()
        };
        log.record(1.0, &torn);
        assert_eq!(log.cause_to_stop(1.0), None, "a moment passes");
        log.record(1.1, &torn);
        log.record(1.3, &torn);
        let reason = log.cause_to_stop(1.3).expect("it does not pass").reason;
        assert!(reason.contains("since 1.00 s") && reason.contains("2.4 times its length"), "{reason}");
        log.record(1.4, &Violations::default());
        assert_eq!(log.cause_to_stop(1.4), None, "it has recovered");
    }
}
