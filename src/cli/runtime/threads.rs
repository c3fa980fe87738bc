//! The threads of a run.

use crate::cli::runtime::allocator;
use crease::{Error, Result};
use std::num::NonZeroUsize;

/// The pool of this run: so many threads, all cores unless told otherwise. The main thread is one of them, so that it
/// works where it would wait.
pub(in crate::cli) fn use_threads(count: Option<NonZeroUsize>) -> Result<()> {
    allocator::share();
    rayon::ThreadPoolBuilder::new()
        .num_threads(count.map_or(0, NonZeroUsize::get))
        .use_current_thread()
        .build_global()
        .map_err(|refusal| Error::input("--threads", "", refusal.to_string(), "ask for fewer"))
}
