//! Ctrl-C and SIGTERM. While a run holds unsaved results the first signal asks it to stop after the current step and
//! the second one ends it; otherwise the first signal ends it.

use crease::Result;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::flag;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit code of an interrupted run, the shell convention for SIGINT.
pub const INTERRUPTED: u8 = 130;

/// State of the signal handlers, shared between clones.
#[derive(Debug, Clone, Default)]
pub struct Interrupt {
    requested: Arc<AtomicBool>,
    exit_immediately: Arc<AtomicBool>,
}

impl Interrupt {
    /// Installs the signal handlers. Until [`Self::set_exit_immediately`] is called, a signal ends the process.
    pub fn listen() -> Result<Self> {
        let own = Self::default();
        own.exit_immediately.store(true, Ordering::SeqCst);
        for signal in [SIGINT, SIGTERM] {
            // The order matters: handlers run as registered, so that the first signal finds `exit_immediately` as the
            // run has set it, and only then sets it for the second.
            flag::register_conditional_shutdown(signal, INTERRUPTED.into(), own.exit_immediately.clone())
                .and_then(|_| flag::register(signal, own.requested.clone()))
                .and_then(|_| flag::register(signal, own.exit_immediately.clone()))
                .map_err(|source| crease::Error::File { file: "signals".to_owned(), source })?;
        }
        Ok(own)
    }

    /// Sets whether the next signal ends the process: `true` while there is nothing to save.
    pub fn set_exit_immediately(&self, yes: bool) {
        self.exit_immediately.store(yes, Ordering::SeqCst);
    }

    /// Whether the run has been asked to stop.
    pub fn is_requested(&self) -> bool {
        self.requested.load(Ordering::SeqCst)
    }
}
