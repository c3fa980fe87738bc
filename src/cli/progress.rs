//! How a run is doing, on stderr: a bar with the time left on a terminal, a plain line now and then otherwise.

use super::talk;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::time::{Duration, Instant};

/// Where there is no terminal, steps are told this often at most.
const LINE_EVERY: Duration = Duration::from_secs(5);

/// Shows the progress of one run.
#[derive(Debug)]
pub struct Progress {
    face: Face,
    stage: String,
    stage_began: Instant,
    /// Simulated time when the stage's first step was told [s]: where a resumed run began.
    stage_from_s: Option<f64>,
}

#[derive(Debug)]
enum Face {
    Quiet,
    Lines { last: Option<Instant> },
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
    /// On stderr, or nothing if `quiet`.
    pub fn new(quiet: bool) -> Self {
        let face = match (quiet, std::io::stderr().is_terminal()) {
            (true, _) => Face::Quiet,
            (false, true) => Face::Bar(bar()),
            (false, false) => Face::Lines { last: None },
        };
        Self { face, stage: String::new(), stage_began: Instant::now(), stage_from_s: None }
    }

    /// A stage begins.
    pub fn stage(&mut self, name: &str) {
        self.stage = name.to_owned();
        self.stage_began = Instant::now();
        self.stage_from_s = None;
        match &mut self.face {
            Face::Quiet => {}
            Face::Lines { last } => {
                *last = Some(self.stage_began);
                talk::say(name);
            }
            Face::Bar(bar) => {
                bar.set_prefix(name.to_owned());
                bar.set_message("");
                bar.set_position(0);
                bar.tick();
            }
        }
    }

    /// A step of the stage is done.
    pub fn step(&mut self, news: StepNews) {
        let from_s = *self.stage_from_s.get_or_insert(news.simulated_s);
        let words = || in_words(news, left_s(news, from_s, self.stage_began.elapsed().as_secs_f64()));
        match &mut self.face {
            Face::Quiet => {}
            Face::Lines { last } => {
                if last.is_none_or(|last| last.elapsed() >= LINE_EVERY) {
                    *last = Some(Instant::now());
                    talk::say(&format!("{}: {}", self.stage, words()));
                }
            }
            Face::Bar(bar) => {
                bar.set_length(milliseconds(news.total_s));
                bar.set_position(milliseconds(news.simulated_s));
                bar.set_message(words());
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
