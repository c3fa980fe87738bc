//! Progress of a run on stderr: a bar with the remaining time on a terminal, otherwise a text or JSON line every few
//! seconds.

use crate::runtime::console;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Minimum time between two progress lines without a terminal.
const MIN_LINE_INTERVAL: Duration = Duration::from_secs(5);

/// Progress display of one run.
#[derive(Debug)]
pub struct Progress {
    display: Display,
    stage: String,
    /// Progress so far, from which the remaining time is extrapolated.
    pace: Option<Pace>,
}

/// Progress of a run over time. Steps differ in cost: the first ones of a fold are short, those of a hold are long. So the
/// remaining time follows from the whole run and from its last quarter, and is stated only after the first tenth.
#[derive(Debug)]
struct Pace {
    started: Instant,
    /// Wall time and simulated time of the steps [s].
    steps: Vec<(f64, f64)>,
}

impl Pace {
    /// Fraction of the script after which the remaining time is stated.
    const MIN_DONE: f64 = 0.1;

    fn new() -> Self {
        Self { started: Instant::now(), steps: Vec::new() }
    }

    /// Records a step; returns the remaining wall time [s].
    fn record(&mut self, wall_s: f64, now: StepProgress) -> Option<f64> {
        self.steps.push((wall_s, now.simulated_s));
        let (first_wall, first_simulated) = *self.steps.first()?;
        let done = now.simulated_s - first_simulated;
        if now.simulated_s < Self::MIN_DONE * now.total_s || done <= 0.0 {
            return None;
        }
        let recent = self.steps.partition_point(|(_, simulated)| *simulated <= first_simulated + 0.75 * done);
        let (recent_wall, recent_simulated) = self.steps[recent.saturating_sub(1)];
        let whole = (wall_s - first_wall) / done;
        let last = (wall_s - recent_wall) / (now.simulated_s - recent_simulated).max(f64::MIN_POSITIVE);
        // A mean of both on a logarithmic scale, in which what came last counts three times as much.
        let pace = whole * (last / whole).clamp(0.1, 10.0).powf(0.75);
        let left = pace * (now.total_s - now.simulated_s);
        left.is_finite().then_some(left.max(0.0))
    }
}

#[derive(Debug)]
enum Display {
    Quiet,
    Lines { last: Option<Instant>, json: bool },
    Bar(ProgressBar),
}

/// State of a simulation after a step.
#[derive(Debug, Clone, Copy)]
pub struct StepProgress {
    /// Simulated time so far [s].
    pub simulated_s: f64,
    /// Simulated time of the whole script [s].
    pub total_s: f64,
    /// Accepted steps.
    pub step: u64,
    /// Memory events so far, gradual and critical.
    pub events: u64,
}

impl StepProgress {
    /// The same with a total that is not exceeded: coming to rest, and moving a body to the first pose of a clip, may take longer
    /// than the script says.
    fn within_total(self) -> Self {
        Self { total_s: self.total_s.max(self.simulated_s), ..self }
    }
}

impl Progress {
    /// Creates a display on stderr: none if `quiet`, JSON lines if `json`.
    pub fn new(quiet: bool, json: bool) -> Self {
        let display = match (quiet, json || !std::io::stderr().is_terminal()) {
            (true, _) => Display::Quiet,
            (false, false) => Display::Bar(bar()),
            (false, true) => Display::Lines { last: None, json },
        };
        Self { display, stage: String::new(), pace: None }
    }

    /// Reports that stage `name` begins.
    pub fn stage(&mut self, name: &str) {
        self.stage = name.to_owned();
        match &mut self.display {
            Display::Quiet => {}
            Display::Lines { last, json } => {
                *last = Some(Instant::now());
                console::message(&if *json { json!({"stage": name}).to_string() } else { name.to_owned() });
            }
            Display::Bar(bar) => {
                bar.set_prefix(name.to_owned());
                bar.tick();
            }
        }
    }

    /// Reports a finished step of stage `name`, and the stage if it is new.
    pub fn step(&mut self, name: &str, now: StepProgress) {
        if self.stage != name {
            self.stage(name);
        }
        let now = now.within_total();
        let pace = self.pace.get_or_insert_with(Pace::new);
        let wall_s = pace.started.elapsed().as_secs_f64();
        let left_s = pace.record(wall_s, now);
        match &mut self.display {
            Display::Quiet => {}
            Display::Lines { last, json } => {
                if last.is_none_or(|last| last.elapsed() >= MIN_LINE_INTERVAL) {
                    *last = Some(Instant::now());
                    console::message(&match json {
                        true => json_line(&self.stage, now, left_s),
                        false => format!("{}: {}", self.stage, text_line(now, left_s)),
                    });
                }
            }
            Display::Bar(bar) => {
                bar.set_length(milliseconds(now.total_s));
                bar.set_position(milliseconds(now.simulated_s));
                bar.set_message(text_line(now, left_s));
            }
        }
    }

    /// Removes the bar; lines stay.
    pub fn finish(&mut self) {
        if let Display::Bar(bar) = &self.display {
            bar.finish_and_clear();
        }
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        self.finish();
    }
}

fn bar() -> ProgressBar {
    let bar = ProgressBar::new(0);
    if let Ok(style) = ProgressStyle::with_template("{prefix:>10} [{bar:30}] {msg}") {
        bar.set_style(style);
    }
    bar
}

fn milliseconds(seconds: f64) -> u64 {
    // Negative and NaN become 0.
    (seconds * 1e3) as u64
}

fn json_line(stage: &str, now: StepProgress, left_s: Option<f64>) -> String {
    let StepProgress { simulated_s, total_s, step, events } = now;
    json!({
        "stage": stage, "simulated_s": simulated_s, "total_s": total_s, "step": step, "events": events, "left_s": left_s,
    })
    .to_string()
}

fn text_line(now: StepProgress, left_s: Option<f64>) -> String {
    let StepProgress { simulated_s, total_s, step, events } = now;
    let left = match left_s {
        None => String::new(),
        Some(s) if s < 90.0 => format!(", {s:.0} s left"),
        Some(s) if s < 5400.0 => format!(", {:.0} min left", s / 60.0),
        Some(s) => format!(", {:.1} h left", s / 3600.0),
    };
    format!("{simulated_s:.1} of {total_s:.1} s, step {step}, {events} events{left}")
}

#[cfg(test)]
mod tests {
    use super::*;

    const NOW: StepProgress = StepProgress { simulated_s: 12.0, total_s: 60.0, step: 480, events: 35 };

    /// Wall time that each twentieth of a script takes, and the estimates after each.
    fn estimates(costs: [f64; 20]) -> Vec<(f64, Option<f64>)> {
        let (mut pace, mut wall) = (Pace::new(), 0.0);
        pace.record(0.0, StepProgress { simulated_s: 0.0, ..NOW });
        let mut all = Vec::new();
        for (k, cost) in (1..).zip(costs) {
            wall += cost;
            all.push((wall, pace.record(wall, StepProgress { simulated_s: 3.0 * f64::from(k), ..NOW })));
        }
        all
    }

    #[test]
    fn remaining_time_is_right_for_even_steps_and_unknown_at_first() {
        for (k, (wall, left)) in estimates([6.0; 20]).into_iter().enumerate() {
            match left {
                None => assert!(k < 1, "{k}"),
                Some(left) => assert!((left - (120.0 - wall)).abs() < 1e-9, "{wall} {left}"),
            }
        }
    }

    /// The first tenth is twenty times as slow as the rest.
    #[test]
    fn a_slow_start_is_soon_within_a_factor_of_two() {
        let mut costs = [1.0; 20];
        costs[..2].fill(20.0);
        let all = estimates(costs);
        let total = all[19].0;
        for (wall, left) in &all[9..18] {
            let left = left.expect("is stated");
            assert!(left < 2.0 * (total - wall) && left > 0.5 * (total - wall), "{wall} {left} of {total}");
        }
    }

    /// Scripts whose parts differ by less than a factor of two: from the first tenth on so does the estimate, also where a part ends and
    /// nothing tells that the next one is faster.
    #[test]
    fn after_a_tenth_the_estimate_is_within_a_factor_of_two() {
        let costs = |cost: fn(usize) -> f64| -> [f64; 20] { std::array::from_fn(cost) };
        for (name, costs) in [
            ("a slow third first", costs(|k| if k < 7 { 1.8 } else { 1.0 })),
            ("a slow third last", costs(|k| if k < 13 { 1.0 } else { 1.8 })),
            ("folds and holds in turn", costs(|k| [1.0, 1.0, 1.8, 1.8][k % 4])),
            ("slower and slower", costs(|k| 1.0 + 0.8 * k as f64 / 19.0)),
        ] {
            let total: f64 = costs.iter().sum();
            for (wall, left) in &estimates(costs)[1..19] {
                let (left, real) = (left.expect("is stated"), total - wall);
                assert!(left < 2.0 * real && left > 0.5 * real, "{name}: {left} for {real} at {wall}");
            }
        }
    }

    #[test]
    fn the_time_does_not_exceed_the_total() {
        let late = StepProgress { simulated_s: 62.04, ..NOW }.within_total();
        assert_eq!(text_line(late, None), "62.0 of 62.0 s, step 480, 35 events");
        assert_eq!(text_line(NOW.within_total(), None), text_line(NOW, None));
    }

    #[test]
    fn progress_lines_have_units() {
        assert_eq!(text_line(NOW, None), "12.0 of 60.0 s, step 480, 35 events");
        assert_eq!(text_line(NOW, Some(24.0)), "12.0 of 60.0 s, step 480, 35 events, 24 s left");
        assert_eq!(text_line(NOW, Some(144.0)), "12.0 of 60.0 s, step 480, 35 events, 2 min left");
        assert!(text_line(NOW, Some(7200.0)).ends_with("2.0 h left"));
    }

    #[test]
    fn negative_and_nan_times_are_zero() {
        assert_eq!((milliseconds(-1.0), milliseconds(f64::NAN), milliseconds(1.5)), (0, 0, 1500));
    }
}
