//! `crease batch`: many garments, each worn by every script in every fabric, from one job file.
//!
//! The same file serves this machine (N at a time), a Slurm job array and an engine that speaks Open Job Description:
//! all three run shards of the same list of jobs, and a job is the same call of `crease bake --resume` everywhere. A
//! job that is done, by the hashes of what goes in and of what came out, is skipped; one that was killed goes on from
//! its checkpoint, so that it ends with the same bytes.

mod job;
mod jobs;
mod local;
mod openjd;
mod slurm;
mod summary;

pub use jobs::JobFile;

use crate::cli::commands::batch::jobs::Jobs;
use crate::cli::runtime::console;
use crate::cli::runtime::interrupt::Interrupt;
use crease::{Error, Result};
use std::num::NonZeroUsize;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease batch jobs.json                     all jobs on this machine
  crease batch jobs.json --parallel 8        eight at a time
  crease batch jobs.json --list              what would be done
  crease batch jobs.json --slurm             as a Slurm job array
  crease batch jobs.json --openjd jobs.template.json

A job file:
  {\"format\": \"crease-batch/1\", \"output\": \"worn\", \"garments\": [\"shirt.glb\"],
   \"wear\": [\"fold-thrice.json\"], \"fabrics\": [\"denim\", \"linen\"]}")]
pub struct Arguments {
    /// Job file, crease-batch/1; its paths count from its own folder
    #[arg(value_name = "JOBS.json")]
    jobs: PathBuf,
    /// Jobs at the same time [default: as many as there are processors]
    #[arg(long, value_name = "N")]
    parallel: Option<NonZeroUsize>,
    /// Retries per failed or killed job
    #[arg(long, value_name = "N", default_value_t = 2)]
    retries: u32,
    /// Worker threads of each job [default: cores divided by parallel jobs]
    #[arg(long, value_name = "N")]
    threads: Option<NonZeroUsize>,
    /// Run only shard I of N: jobs I, I + N, I + 2 N, ..., counted from 0; writes no summary
    #[arg(long, alias = "share", value_name = "I/N", value_parser = shard, conflicts_with_all = ["list", "summary", "slurm", "openjd"])]
    shard: Option<Shard>,
    /// Say what would be done and what is done already, as JSON
    #[arg(long, conflicts_with_all = ["summary", "slurm", "openjd"])]
    list: bool,
    /// Only write the summary of what is there
    #[arg(long, conflicts_with_all = ["slurm", "openjd"])]
    summary: bool,
    /// Submit a Slurm job array, and the summary after it
    #[arg(long, conflicts_with = "openjd")]
    slurm: bool,
    /// With --slurm: handed to sbatch as it is, such as --partition=long; may be given several times
    #[arg(long, value_name = "ARGUMENT", requires = "slurm", allow_hyphen_values = true)]
    sbatch: Vec<String>,
    /// With --slurm: write the script and do not submit it
    #[arg(long, requires = "slurm")]
    dry_run: bool,
    /// Write an Open Job Description template instead
    #[arg(long, value_name = "TEMPLATE.json")]
    openjd: Option<PathBuf>,
    /// Print progress as JSON lines
    #[arg(long)]
    json: bool,
    /// Errors only
    #[arg(long)]
    quiet: bool,
}

/// Every job whose number leaves `number` when divided by `of`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    number: usize,
    of: usize,
}

impl Shard {
    const ALL: Self = Self { number: 0, of: 1 };

    fn holds(self, job: usize) -> bool {
        job % self.of == self.number
    }
}

fn shard(text: &str) -> std::result::Result<Shard, String> {
    let parsed = text.split_once('/').and_then(|(number, of)| Some((number.parse().ok()?, of.parse().ok()?)));
    match parsed {
        Some((number, of)) if number < of => Ok(Shard { number, of }),
        _ => Err("expected I/N with I from 0 to N - 1".to_owned()),
    }
}

pub fn run(arguments: Arguments) -> Result<()> {
    let jobs = Jobs::read(&arguments.jobs)?;
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
    interrupt.ends_at_once(false);
    let outcome = local::run(&jobs, &arguments, &interrupt);
    // What is there so far is worth seeing, also after an interruption; shards are summed up by whoever split the jobs.
    if arguments.shard.is_none() {
        summary::write(&jobs)?;
    }
    outcome
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_cover_every_job_once() {
        for of in 1..6 {
            for job in 0..20 {
                assert_eq!((0..of).filter(|&number| Shard { number, of }.holds(job)).count(), 1);
            }
        }
        assert_eq!(shard("3/20"), Ok(Shard { number: 3, of: 20 }));
        for text in ["", "1", "2/2", "-1/3", "0/0", "a/b"] {
            assert!(shard(text).is_err(), "{text}");
        }
    }
}
