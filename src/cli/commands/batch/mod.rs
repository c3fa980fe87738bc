//! `crease batch`: bakes of all combinations of garments, wear scripts and fabrics of a job file.
//!
//! The same file serves this machine (N jobs at a time), a Slurm job array and an engine for Open Job Description: all
//! three run shards of the same list of jobs, and a job is the same call of `crease bake --resume` everywhere. A
//! finished job, identified by the hashes of its inputs and outputs, is skipped; a killed one continues from its
//! checkpoint and ends with the same bytes.

mod arguments;
mod job;
mod jobs;
mod local;
mod openjd;
mod slurm;
mod summary;

pub use arguments::Arguments;
pub use jobs::JobFile;

use crate::commands::batch::jobs::Jobs;
use crate::runtime::console;
use crate::runtime::interrupt::Interrupt;
use crease_model::error::{Error, Result};

/// Runs the command.
pub fn run(arguments: Arguments) -> Result<()> {
    let jobs = Jobs::read(&arguments.jobs, arguments.allow_folder.as_deref())?;
    if arguments.list {
        return console::data(&format!("{:#}\n", summary::list(&jobs)));
    }
    if let Some(path) = &arguments.openjd {
        return openjd::write(&jobs, path);
    }
    std::fs::create_dir_all(&jobs.output)
        .map_err(|source| Error::File { file: jobs.output.display().to_string(), source })?;
    if arguments.slurm {
        return slurm::submit(&jobs, &arguments);
    }
    if arguments.summary {
        return summary::write(&jobs);
    }
    let interrupt = Interrupt::listen()?;
    interrupt.set_exit_immediately(false);
    let outcome = local::run(&jobs, &arguments, &interrupt);
    // The summary is written after an interruption, too. Whoever splits the jobs into shards also requests their summary.
    if arguments.shard.is_none() {
        summary::write(&jobs)?;
    }
    outcome
}
