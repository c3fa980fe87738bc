//! Worker threads of the process.

use crease::{Error, Result};
use std::num::NonZeroUsize;

/// Starts the global thread pool with `count` threads, by default one per core. The main thread is one of them and
/// works while it would otherwise wait.
pub(in crate::cli) fn use_threads(count: Option<NonZeroUsize>) -> Result<()> {
    rayon::ThreadPoolBuilder::new()
        .num_threads(count.map_or(0, NonZeroUsize::get))
        .use_current_thread()
        .build_global()
        .map_err(|error| Error::input("--threads", "", error.to_string(), "use fewer threads"))
}
