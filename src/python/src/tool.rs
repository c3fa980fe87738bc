//! `run_tool`: the command-line tool within a process of Python.

use crate::process::check_not_forked;
use pyo3::prelude::*;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag::register_conditional_default;
use std::ffi::OsString;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, LazyLock, Mutex, PoisonError};

/// Runs of the tool in this process, and what signals do between them.
#[derive(Debug, Default)]
struct ToolRuns {
    /// Number of runs now.
    active: usize,
    /// Whether there is none.
    idle: Arc<AtomicBool>,
    /// Signals that have a handler which ends the process between runs.
    ending: Vec<i32>,
}

static RUNS: LazyLock<Mutex<ToolRuns>> = LazyLock::new(Mutex::default);

/// A run of the tool. The tool removes its signal handlers when it returns, but the disposition of a signal that ends the process by
/// default does not come back with that: a handler that ends it takes its place.
struct ToolRun;

impl ToolRun {
    /// Begins a run. `ending` are the signals that end the process by default.
    fn begin(ending: Vec<i32>) -> std::io::Result<Self> {
        let mut runs = RUNS.lock().unwrap_or_else(PoisonError::into_inner);
        for signal in ending {
            if !runs.ending.contains(&signal) {
                register_conditional_default(signal, runs.idle.clone())?;
                runs.ending.push(signal);
            }
        }
        runs.active += 1;
        runs.idle.store(false, Ordering::SeqCst);
        Ok(Self)
    }
}

impl Drop for ToolRun {
    fn drop(&mut self) {
        let mut runs = RUNS.lock().unwrap_or_else(PoisonError::into_inner);
        runs.active -= 1;
        runs.idle.store(runs.active == 0, Ordering::SeqCst);
    }
}

/// Returns the signals of the tool that end this process by default: those without a handler of Python.
fn ending_signals(py: Python<'_>) -> PyResult<Vec<i32>> {
    let module = py.import("signal")?;
    let default = module.getattr("SIG_DFL")?;
    let mut ending = Vec::new();
    for signal in [SIGINT, SIGTERM] {
        if module.call_method1("getsignal", (signal,))?.eq(&default)? {
            ending.push(signal);
        }
    }
    Ok(ending)
}

/// Runs the tool with the words of a command line after the name of the program; returns its exit code.
#[pyfunction]
pub fn run_tool(py: Python<'_>, words: Vec<OsString>) -> PyResult<u8> {
    check_not_forked()?;
    let run = ToolRun::begin(ending_signals(py)?)?;
    let code = py.detach(|| crease_cli::run([OsString::from("crease")].into_iter().chain(words)));
    drop(run);
    Ok(code)
}
