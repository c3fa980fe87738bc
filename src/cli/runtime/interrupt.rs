//! Ctrl-C and SIGTERM: a run that has something to keep is asked to stop after its present step; a run that has
//! not, and one that is asked twice, ends at once.

use crease::Result;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit code of an interrupted run, as shells have it.
pub const INTERRUPTED: u8 = 130;

/// Whether someone wants the run to stop.
#[derive(Debug, Clone, Default)]
pub struct Interrupt {
    asked: Arc<AtomicBool>,
    at_once: Arc<AtomicBool>,
}

impl Interrupt {
    /// Listens from now on; ends at once until told otherwise.
    pub fn listen() -> Result<Self> {
        let own = Self::default();
        own.at_once.store(true, Ordering::SeqCst);
        for signal in [SIGINT, SIGTERM] {
            // In this order: the first signal of a run that keeps something only leaves its mark.
            flag::register_conditional_shutdown(signal, INTERRUPTED.into(), own.at_once.clone())
                .and_then(|_| flag::register(signal, own.asked.clone()))
                .and_then(|_| flag::register(signal, own.at_once.clone()))
                .map_err(|source| crease::Error::File { file: "signals".to_owned(), source })?;
        }
        Ok(own)
    }

    /// Whether a signal ends the run at once, as it has nothing to keep (or all of it lies on the disk).
    pub fn ends_at_once(&self, yes: bool) {
        self.at_once.store(yes, Ordering::SeqCst);
    }

    /// Whether the run shall stop.
    pub fn asked(&self) -> bool {
        self.asked.load(Ordering::SeqCst)
    }
}
