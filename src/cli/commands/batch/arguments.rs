//! Command-line arguments of `crease batch`.

use crate::args::values::count;
use std::num::NonZeroUsize;
use std::path::PathBuf;

#[derive(Debug, clap::Args)]
#[command(after_help = "Examples:
  crease batch jobs.json                     all jobs on this machine
  crease batch jobs.json --parallel 8        eight at a time
  crease batch jobs.json --list              list the jobs and their states
  crease batch jobs.json --slurm             as a Slurm job array
  crease batch jobs.json --openjd jobs.template.json

A job file:
  {\"format\": \"crease-batch/1\", \"output\": \"worn\", \"garments\": [\"shirt.glb\"],
   \"wear\": [\"fold-thrice.json\"], \"fabrics\": [\"denim\", \"linen\"]}")]
pub struct Arguments {
    /// Job file, crease-batch/1; paths in it are relative to its folder
    #[arg(value_name = "JOBS.json")]
    pub jobs: PathBuf,
    /// Jobs that run at the same time [default: number of cores]
    #[arg(long, value_name = "N", value_parser = count)]
    pub parallel: Option<NonZeroUsize>,
    /// Retries per failed or killed job
    #[arg(long, value_name = "N", default_value_t = 2)]
    pub retries: u32,
    /// Worker threads of each job [default: cores divided by parallel jobs]
    #[arg(long, value_name = "N", value_parser = count)]
    pub threads: Option<NonZeroUsize>,
    /// Run only shard I of N: jobs I, I + N, I + 2 N, ..., counted from 0; writes no summary
    #[arg(long, alias = "share", value_name = "I/N", value_parser = shard, conflicts_with_all = ["list", "summary", "slurm", "openjd"])]
    pub shard: Option<Shard>,
    /// Print all jobs and their states as JSON, and run none
    #[arg(long, conflicts_with_all = ["summary", "slurm", "openjd"])]
    pub list: bool,
    /// Only write the summary of the existing results
    #[arg(long, conflicts_with_all = ["slurm", "openjd"])]
    pub summary: bool,
    /// Submit a Slurm job array and a summary job after it
    #[arg(long, conflicts_with = "openjd")]
    pub slurm: bool,
    /// With --slurm: argument passed to sbatch, such as --partition=long; may be repeated
    #[arg(long, value_name = "ARGUMENT", requires = "slurm", allow_hyphen_values = true)]
    pub sbatch: Vec<String>,
    /// With --slurm: write the scripts without submitting them
    #[arg(long, requires = "slurm")]
    pub dry_run: bool,
    /// Write an Open Job Description template instead
    #[arg(long, value_name = "TEMPLATE.json")]
    pub openjd: Option<PathBuf>,
    /// Folder besides that of the job file in which its garments, scripts, fabrics and outputs, and the files that they name, may lie
    #[arg(long, value_name = "DIR")]
    pub allow_folder: Option<PathBuf>,
    /// Print progress as JSON lines
    #[arg(long)]
    pub json: bool,
    /// Print errors only
    #[arg(long)]
    pub quiet: bool,
}

/// Part of the jobs: those whose number has the remainder `number` when divided by `of`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Shard {
    number: usize,
    of: usize,
}

impl Shard {
    /// All jobs.
    pub const ALL: Self = Self { number: 0, of: 1 };

    /// Whether job number `job` belongs to the shard.
    pub fn contains(self, job: usize) -> bool {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shards_cover_every_job_once() {
        for of in 1..6 {
            for job in 0..20 {
                assert_eq!((0..of).filter(|&number| Shard { number, of }.contains(job)).count(), 1);
            }
        }
        assert_eq!(shard("3/20"), Ok(Shard { number: 3, of: 20 }));
        for text in ["", "1", "2/2", "-1/3", "0/0", "a/b"] {
            assert!(shard(text).is_err(), "{text}");
        }
    }
}
