//! The process: console, progress line, interruption, threads, allocator.

pub mod allocator;
pub mod console;
pub mod interrupt;
pub mod progress;
pub mod threads;
