//! The process in which the library has started its threads.

use crate::CreaseError;
use pyo3::prelude::*;
use std::sync::atomic::{AtomicU32, Ordering};

/// Number of that process; 0 before the first call.
static STARTED_IN: AtomicU32 = AtomicU32::new(0);

/// Fails in a fork of a process that has called the library: a fork has none of its threads, and the library would wait for them.
pub fn check_not_forked() -> PyResult<()> {
    let own = std::process::id();
    match STARTED_IN.compare_exchange(0, own, Ordering::SeqCst, Ordering::SeqCst) {
        Err(other) if other != own => Err(CreaseError::new_err(
            "this process is a fork of one that has used crease, and has none of its threads (with multiprocessing, use \
             the start method spawn: multiprocessing.get_context(\"spawn\"))",
        )),
        _ => Ok(()),
    }
}
