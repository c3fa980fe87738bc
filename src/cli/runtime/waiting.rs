//! Elapsed time of a computation whose length is unknown: a spinner on a terminal, otherwise a line every half minute.

use crate::runtime::console;
use indicatif::{ProgressBar, ProgressStyle};
use std::io::IsTerminal;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::thread::JoinHandle;
use std::time::{Duration, Instant};

/// Time between two lines without a terminal.
const LINE_INTERVAL: Duration = Duration::from_secs(30);

/// Display that ends when it is dropped.
#[derive(Debug)]
pub enum Waiting {
    /// On a terminal.
    Spinner(ProgressBar),
    /// Elsewhere: a thread that prints lines.
    Lines {
        /// Whether the computation has ended.
        ended: Arc<AtomicBool>,
        /// The thread.
        thread: Option<JoinHandle<()>>,
    },
}

impl Waiting {
    /// Begins to show that `what` is being computed.
    pub fn begin(what: &str) -> Self {
        if std::io::stderr().is_terminal() {
            let style = ProgressStyle::with_template("{spinner} {msg}, {elapsed}");
            let spinner = ProgressBar::new_spinner().with_message(what.to_owned());
            spinner.set_style(style.unwrap_or_else(|_| ProgressStyle::default_spinner()));
            spinner.enable_steady_tick(Duration::from_millis(120));
            return Self::Spinner(spinner);
        }
        let ended = Arc::new(AtomicBool::new(false));
        let (flag, what, began) = (ended.clone(), what.to_owned(), Instant::now());
        let thread = std::thread::spawn(move || {
            let mut last = began;
            while !flag.load(Ordering::Relaxed) {
                std::thread::park_timeout(LINE_INTERVAL);
                if !flag.load(Ordering::Relaxed) && last.elapsed() >= LINE_INTERVAL {
                    console::message(&format!("{what}: {} s", began.elapsed().as_secs()));
                    last = Instant::now();
                }
            }
        });
        Self::Lines { ended, thread: Some(thread) }
    }
}

impl Drop for Waiting {
    fn drop(&mut self) {
        match self {
            Self::Spinner(spinner) => spinner.finish_and_clear(),
            Self::Lines { ended, thread } => {
                ended.store(true, Ordering::Relaxed);
                if let Some(thread) = thread.take() {
                    thread.thread().unpark();
                    // A panic of the display is of no interest to the computation.
                    let _ = thread.join();
                }
            }
        }
    }
}
