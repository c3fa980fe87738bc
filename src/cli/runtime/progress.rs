//! Progress of a run on stderr: a bar with the remaining time on a terminal, otherwise a text or JSON line every few
//! seconds.

use crate::cli::runtime::console;
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
    /// First reported step, from which the remaining time is extrapolated.
    first_step: Option<FirstStep>,
}

#[derive(Debug, Clone, Copy)]
struct FirstStep {
    at: Instant,
    /// Simulated time of that step [s].
    simulated_s: f64,
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

impl Progress {
    /// Creates a display on stderr: none if `quiet`, JSON lines if `json`.
    pub fn new(quiet: bool, json: bool) -> Self {
        let display = match (quiet, json || !std::io::stderr().is_terminal()) {
            (true, _) => Display::Quiet,
            (false, false) => Display::Bar(bar()),
            (false, true) => Display::Lines { last: None, json },
        };
        Self { display, stage: String::new(), first_step: None }
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
        let first = *self
            .first_step
            .get_or_insert_with(|| FirstStep { at: Instant::now(), simulated_s: now.simulated_s });
        let left_s = remaining_s(now, first.simulated_s, first.at.elapsed().as_secs_f64());
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

/// Remaining wall time [s], extrapolated from the progress since simulated time `from_s`; `None` without progress.
fn remaining_s(now: StepProgress, from_s: f64, elapsed_s: f64) -> Option<f64> {
    let done_s = now.simulated_s - from_s;
    (done_s > 0.0).then(|| (elapsed_s * (now.total_s - now.simulated_s) / done_s).max(0.0))
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

    #[test]
    fn remaining_time_extrapolates_the_progress_of_this_run() {
        assert_eq!(remaining_s(NOW, 0.0, 6.0), Some(24.0));
        assert_eq!(remaining_s(NOW, 10.0, 6.0), Some(144.0));
        assert_eq!(remaining_s(NOW, 12.0, 6.0), None);
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
