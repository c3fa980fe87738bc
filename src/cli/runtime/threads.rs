//! Worker threads of a run.

use crease_model::error::{Error, Result};
use std::num::NonZeroUsize;

/// Stack of a worker thread [bytes], as large as that of the main thread: the whole run is on one of them.
const STACK_BYTES: usize = 8 << 20;

/// Runs `work` on `count` threads of its own, by default one per core. `work` itself is on one of them and computes while it
/// would otherwise wait. They end with it, so that a process can have any number of runs, each with its own `count`.
pub(crate) fn on_threads<T: Send>(
    count: Option<NonZeroUsize>,
    work: impl FnOnce() -> Result<T> + Send,
) -> Result<T> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(count.map_or(0, NonZeroUsize::get))
        .stack_size(STACK_BYTES)
        .build()
        .map_err(|error| Error::input("--threads", "", error.to_string(), "use fewer threads"))?
        .install(work)
}
