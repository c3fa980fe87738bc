//! Ctrl-C and SIGTERM. While a run holds unsaved results the first signal asks it to stop after the current step and
//! the second one ends it; otherwise the first signal ends it.

use crease_model::error::Result;
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::{SigId, flag, low_level};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

/// Exit code of an interrupted run, the shell convention for SIGINT.
pub const INTERRUPTED: u8 = 130;

/// Registered signal handlers, removed when dropped: a process such as Python goes on after the run.
#[derive(Debug, Default)]
struct Handlers(Vec<SigId>);

impl Drop for Handlers {
    fn drop(&mut self) {
        for id in self.0.drain(..) {
            low_level::unregister(id);
        }
    }
}

/// State of the signal handlers, shared between clones. They are removed with the last clone.
#[derive(Debug, Clone, Default)]
pub struct Interrupt {
    requested: Arc<AtomicBool>,
    exit_immediately: Arc<AtomicBool>,
    _handlers: Arc<Handlers>,
}

impl Interrupt {
    /// Installs the signal handlers. Until [`Self::set_exit_immediately`] is called, a signal ends the process.
    pub fn listen() -> Result<Self> {
        let (requested, exit_immediately) = <(Arc<AtomicBool>, Arc<AtomicBool>)>::default();
        exit_immediately.store(true, Ordering::SeqCst);
        let mut handlers = Handlers::default();
        for signal in [SIGINT, SIGTERM] {
            // The order matters: handlers run as registered, so that the first signal finds `exit_immediately` as the
            // run has set it, and only then sets it for the second.
            for register in [
                flag::register_conditional_shutdown(signal, INTERRUPTED.into(), exit_immediately.clone()),
                flag::register(signal, requested.clone()),
                flag::register(signal, exit_immediately.clone()),
            ] {
                let failed = |source| crease_model::error::Error::File { file: "signals".to_owned(), source };
                handlers.0.push(register.map_err(failed)?);
            }
        }
        Ok(Self { requested, exit_immediately, _handlers: Arc::new(handlers) })
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
