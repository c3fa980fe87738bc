//! The threads of a run.

use crease::{Error, Result};
use std::num::NonZeroUsize;

/// One heap for all threads, where the C library would give each its own: what one has let go of serves the others. A bake of
/// 13,863 points takes a tenth less memory so.
#[cfg(all(target_os = "linux", target_env = "gnu"))]
fn share_heap() {
    // Safe: it sets a number, and is called before there are other threads. A refusal costs memory only.
    unsafe { libc::mallopt(libc::M_ARENA_MAX, 1) };
}

#[cfg(not(all(target_os = "linux", target_env = "gnu")))]
fn share_heap() {}

/// The pool of this run: so many threads, all cores unless told otherwise. The main thread is one of them, so that it
/// works where it would wait.
pub(super) fn use_threads(count: Option<NonZeroUsize>) -> Result<()> {
    share_heap();
    rayon::ThreadPoolBuilder::new()
        .num_threads(count.map_or(0, NonZeroUsize::get))
        .use_current_thread()
        .build_global()
        .map_err(|refusal| Error::fault("--threads", "", refusal.to_string(), "ask for fewer"))
}
