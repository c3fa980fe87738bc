//! How a run is doing, on stderr: a bar with the time left on a terminal, a plain line or a line of JSON now and then
//! otherwise.

use crate::cli::runtime::console;
use indicatif::{ProgressBar, ProgressStyle};
use serde_json::json;
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Where there is no terminal, steps are told this often at most.
const LINE_EVERY: Duration = Duration::from_secs(5);

/// Shows the progress of one run.
#[derive(Debug)]
pub struct Progress {
    face: Face,
    stage: String,
    /// When the first step was told, and the simulated time then [s].
    first_step: Option<(Instant, f64)>,
}

#[derive(Debug)]
enum Face {
    Quiet,
    Lines { last: Option<Instant>, json: bool },
    Bar(ProgressBar),
}

/// How far a simulation is.
#[derive(Debug, Clone, Copy)]
pub struct StepNews {
    /// Wear that is done [s].
    pub simulated_s: f64,
    /// Wear in all [s].
    pub total_s: f64,
    /// Accepted steps.
    pub step: u64,
    /// Events of memory.
    pub events: u64,
}

impl Progress {
    /// On stderr: nothing if `quiet`, lines of JSON if `json`.
    pub fn new(quiet: bool, json: bool) -> Self {
        let face = match (quiet, json || !std::io::stderr().is_terminal()) {
            (true, _) => Face::Quiet,
            (false, false) => Face::Bar(bar()),
            (false, true) => Face::Lines { last: None, json },
        };
        Self { face, stage: String::new(), first_step: None }
    }

    /// A stage begins.
    pub fn stage(&mut self, name: &str) {
        self.stage = name.to_owned();
        match &mut self.face {
            Face::Quiet => {}
            Face::Lines { last, json } => {
                *last = Some(Instant::now());
                console::say(&if *json { json!({"stage": name}).to_string() } else { name.to_owned() });
            }
            Face::Bar(bar) => {
                bar.set_prefix(name.to_owned());
                bar.tick();
            }
        }
    }

    /// A step of the stage `name` is done; the stage begins if it is another one than before.
    pub fn step(&mut self, name: &str, news: StepNews) {
        if self.stage != name {
            self.stage(name);
        }
        let (began, from_s) = *self.first_step.get_or_insert_with(|| (Instant::now(), news.simulated_s));
        let left_s = left_s(news, from_s, began.elapsed().as_secs_f64());
        match &mut self.face {
            Face::Quiet => {}
            Face::Lines { last, json } => {
                if last.is_none_or(|last| last.elapsed() >= LINE_EVERY) {
                    *last = Some(Instant::now());
                    console::say(&match json {
                        true => in_json(&self.stage, news, left_s),
                        false => format!("{}: {}", self.stage, in_words(news, left_s)),
                    });
                }
            }
            Face::Bar(bar) => {
                bar.set_length(milliseconds(news.total_s));
                bar.set_position(milliseconds(news.simulated_s));
                bar.set_message(in_words(news, left_s));
            }
        }
    }

    /// All is done: the bar goes away, lines stay.
    pub fn finish(&mut self) {
        if let Face::Bar(bar) = &self.face {
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

/// Time left if the rest goes as what has been done [s]; `None` before there is anything to go by.
fn left_s(news: StepNews, from_s: f64, elapsed_s: f64) -> Option<f64> {
    let done_s = news.simulated_s - from_s;
    (done_s > 0.0).then(|| (elapsed_s * (news.total_s - news.simulated_s) / done_s).max(0.0))
}

fn in_json(stage: &str, news: StepNews, left_s: Option<f64>) -> String {
    let StepNews { simulated_s, total_s, step, events } = news;
    json!({
        "stage": stage, "simulated_s": simulated_s, "total_s": total_s, "step": step, "events": events, "left_s": left_s,
    })
    .to_string()
}

fn in_words(news: StepNews, left_s: Option<f64>) -> String {
    let StepNews { simulated_s, total_s, step, events } = news;
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

    const NEWS: StepNews = StepNews { simulated_s: 12.0, total_s: 60.0, step: 480, events: 35 };

    #[test]
    fn time_left_goes_by_what_was_done_in_this_run() {
        assert_eq!(left_s(NEWS, 0.0, 6.0), Some(24.0));
        assert_eq!(left_s(NEWS, 10.0, 6.0), Some(144.0));
        assert_eq!(left_s(NEWS, 12.0, 6.0), None);
    }

    #[test]
    fn words_have_units() {
        assert_eq!(in_words(NEWS, None), "12.0 of 60.0 s, step 480, 35 events");
        assert_eq!(in_words(NEWS, Some(24.0)), "12.0 of 60.0 s, step 480, 35 events, 24 s left");
        assert_eq!(in_words(NEWS, Some(144.0)), "12.0 of 60.0 s, step 480, 35 events, 2 min left");
        assert!(in_words(NEWS, Some(7200.0)).ends_with("2.0 h left"));
    }

    #[test]
    fn odd_times_do_not_break_the_bar() {
        assert_eq!((milliseconds(-1.0), milliseconds(f64::NAN), milliseconds(1.5)), (0, 0, 1500));
    }
}
