//! Process-level services: console output, progress, interruption, threads, words.

pub mod console;
pub mod executable;
pub mod interrupt;
pub mod progress;
pub mod threads;
#[cfg(feature = "charts")]
pub mod waiting;
pub mod wording;
