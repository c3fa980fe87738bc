//! Jobs on a Slurm cluster: an array whose tasks each run a shard, submitted by sbatch, and the summary after it.
//!
//! Needs a file system shared by all nodes, with the tool and the job file at the same path. A requeued task (node
//! failure, preemption) skips finished jobs and continues from the checkpoint.

use crate::commands::batch::arguments::Arguments;
use crate::commands::batch::jobs::Jobs;
use crate::files::output::{Outputs, commit};
use crate::runtime::{console, executable};
use crease_model::error::{Error, Result};
use std::path::Path;
use std::process::Command;

/// Maximum number of tasks of an array; the default limit of Slurm is 1001.
const MAX_TASKS: usize = 1000;
/// Time before the time limit at which Slurm asks a task to stop [s], enough for a step and a checkpoint.
const STOP_NOTICE_S: u32 = 60;

/// Writes slurm-array.sh and slurm-summary.sh into the output folder and submits both; prints the job id of the array.
pub fn submit(jobs: &Jobs, arguments: &Arguments) -> Result<()> {
    let [array, summary] = ["slurm-array.sh", "slurm-summary.sh"].map(|name| jobs.output.join(name));
    let crease = executable::path()?;
    let mut outputs = Outputs::new([]);
    outputs.add(&array, array_script(jobs, arguments, &crease)?.as_bytes())?;
    outputs.add(&summary, summary_script(jobs, &crease)?.as_bytes())?;
    commit(outputs)?;
    if arguments.dry_run {
        return console::data(&format!("{}\n{}\n", array.display(), summary.display()));
    }
    let id = sbatch(&arguments.sbatch, &array)?;
    // The summary runs whether the tasks succeeded or failed.
    let after = [arguments.sbatch.clone(), vec![format!("--dependency=afterany:{id}")]].concat();
    sbatch(&after, &summary)?;
    console::data(&format!("{id}\n"))
}

/// Submits a script; returns its job id.
fn sbatch(arguments: &[String], script: &Path) -> Result<String> {
    let output = Command::new("sbatch").arg("--parsable").args(arguments).arg(script).output();
    let output = output.map_err(|source| Error::File { file: "sbatch".to_owned(), source })?;
    if !output.status.success() {
        let message = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        return Err(Error::input(
            "sbatch",
            "",
            message,
            "correct the script in the output folder and submit it",
        ));
    }
    let text = String::from_utf8_lossy(&output.stdout);
    Ok(text.trim().split(';').next().unwrap_or_default().to_owned())
}

fn array_script(jobs: &Jobs, arguments: &Arguments, crease: &Path) -> Result<String> {
    let tasks = jobs.list.len().min(MAX_TASKS);
    let limit = arguments.parallel.map_or_else(String::new, |n| format!("%{n}"));
    let threads = arguments.threads.map_or(1, usize::from);
    let log = quoted_directive(&jobs.output.join("slurm-%A_%a.out"))?;
    Ok(format!(
        "#!/bin/bash\n\
         # Written by crease batch --slurm. May be submitted again: finished jobs are skipped.\n\
         #SBATCH --job-name=crease\n\
         #SBATCH --array=0-{}{limit}\n\
         #SBATCH --cpus-per-task={threads}\n\
         #SBATCH --requeue\n\
         #SBATCH --open-mode=append\n\
         #SBATCH --output={log}\n\
         #SBATCH --signal=B:TERM@{STOP_NOTICE_S}\n\
         exec {} batch {} --shard \"$SLURM_ARRAY_TASK_ID/{tasks}\" --parallel 1 --threads {threads} --retries {} --json{}\n",
        tasks - 1,
        quoted(crease)?,
        quoted(&jobs.file)?,
        arguments.retries,
        allowed(jobs)?,
    ))
}

fn summary_script(jobs: &Jobs, crease: &Path) -> Result<String> {
    let log = quoted_directive(&jobs.output.join("slurm-%j.out"))?;
    Ok(format!(
        "#!/bin/bash\n#SBATCH --job-name=crease-summary\n#SBATCH --output={log}\nexec {} batch {} --summary{}\n",
        quoted(crease)?,
        quoted(&jobs.file)?,
        allowed(jobs)?
    ))
}

/// Returns the option that allows the folder of `jobs`, with a blank before it; empty if there is none.
fn allowed(jobs: &Jobs) -> Result<String> {
    let folder = jobs.allow_folder.as_deref();
    folder.map_or(Ok(String::new()), |folder| Ok(format!(" --allow-folder {}", quoted(folder)?)))
}

fn text_of(path: &Path) -> Result<&str> {
    let text = path.to_str().filter(|text| !text.contains(['\n', '\r']));
    text.ok_or_else(|| {
        Error::input(path.display().to_string(), "", "cannot be written in a script", "rename it")
    })
}

/// Quotes a path for the shell.
fn quoted(path: &Path) -> Result<String> {
    Ok(format!("'{}'", text_of(path)?.replace('\'', "'\\''")))
}

/// Quotes a path for a directive of sbatch.
fn quoted_directive(path: &Path) -> Result<String> {
    Ok(format!("\"{}\"", text_of(path)?.replace('\\', "\\\\").replace('"', "\\\"")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn special_characters_survive_the_shell() {
        let odd = Path::new("/a b/it's $HOME;`x`");
        let script = format!("printf %s {}", quoted(odd).expect("can be written"));
        if let Ok(output) = Command::new("sh").args(["-c", &script]).output() {
            assert_eq!(String::from_utf8_lossy(&output.stdout), "/a b/it's $HOME;`x`");
        }
        assert!(quoted(Path::new("a\nb")).is_err());
    }
}
