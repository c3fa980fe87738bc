//! Jobs on a Slurm cluster: an array whose tasks each run a shard, submitted by sbatch, and the summary after it.
//!
//! Needs a file system that all nodes see, with the tool and the job file on it at the same place. A task that is
//! requeued (a node went down, a higher priority came) skips what is done and goes on from the checkpoint.

use crate::cli::commands::batch::Arguments;
use crate::cli::commands::batch::jobs::Jobs;
use crate::cli::files::output::Outputs;
use crate::cli::runtime::console;
use crease::{Error, Result};
use std::path::Path;
use std::process::Command;

/// Tasks of one array at most: Slurm's own limit, unless a cluster has changed it, is 1001.
const MOST_TASKS: usize = 1000;
/// Slurm asks a task to stop so long before its time is up [s], enough for a step and a checkpoint.
const WARNING_S: u32 = 60;

/// Writes slurm-array.sh and slurm-summary.sh into the batch's folder and submits both; prints the number of the array.
pub fn submit(jobs: &Jobs, arguments: &Arguments) -> Result<()> {
    let [array, summary] = ["slurm-array.sh", "slurm-summary.sh"].map(|name| jobs.output.join(name));
    let crease =
        std::env::current_exe().map_err(|source| Error::File { file: "crease".to_owned(), source })?;
    let mut outputs = Outputs::new([]);
    outputs.add(&array, array_script(jobs, arguments, &crease)?.as_bytes())?;
    outputs.add(&summary, summary_script(jobs, &crease)?.as_bytes())?;
    outputs.commit()?;
    if arguments.dry_run {
        return console::data(&format!("{}\n{}\n", array.display(), summary.display()));
    }
    let number = sbatch(&arguments.sbatch, &array)?;
    // Whatever became of the tasks, the summary says so.
    let after = [arguments.sbatch.clone(), vec![format!("--dependency=afterany:{number}")]].concat();
    sbatch(&after, &summary)?;
    console::data(&format!("{number}\n"))
}

/// Submits a script; the number Slurm gives it.
fn sbatch(arguments: &[String], script: &Path) -> Result<String> {
    let output = Command::new("sbatch").arg("--parsable").args(arguments).arg(script).output();
    let output = output.map_err(|source| Error::File { file: "sbatch".to_owned(), source })?;
    if !output.status.success() {
        let said = String::from_utf8_lossy(&output.stderr).trim().to_owned();
        return Err(Error::input(
            "sbatch",
            "",
            said,
            "the script is in the output folder, to be mended and submitted",
        ));
    }
    let text = String::from_utf8_lossy(&output.stdout);
    Ok(text.trim().split(';').next().unwrap_or_default().to_owned())
}

fn array_script(jobs: &Jobs, arguments: &Arguments, crease: &Path) -> Result<String> {
    let tasks = jobs.list.len().min(MOST_TASKS);
    let at_once = arguments.parallel.map_or_else(String::new, |n| format!("%{n}"));
    let threads = arguments.threads.map_or(1, usize::from);
    let log = quoted_directive(&jobs.output.join("slurm-%A_%a.out"))?;
    Ok(format!(
        "#!/bin/bash\n\
         # Written by crease batch --slurm. May be submitted again: what is done is skipped.\n\
         #SBATCH --job-name=crease\n\
         #SBATCH --array=0-{}{at_once}\n\
         #SBATCH --cpus-per-task={threads}\n\
         #SBATCH --requeue\n\
         #SBATCH --open-mode=append\n\
         #SBATCH --output={log}\n\
         #SBATCH --signal=B:TERM@{WARNING_S}\n\
         exec {} batch {} --shard \"$SLURM_ARRAY_TASK_ID/{tasks}\" --parallel 1 --threads {threads} --retries {} --json\n",
        tasks - 1,
        quoted(crease)?,
        quoted(&jobs.file)?,
        arguments.retries,
    ))
}

fn summary_script(jobs: &Jobs, crease: &Path) -> Result<String> {
    let log = quoted_directive(&jobs.output.join("slurm-%j.out"))?;
    Ok(format!(
        "#!/bin/bash\n#SBATCH --job-name=crease-summary\n#SBATCH --output={log}\nexec {} batch {} --summary\n",
        quoted(crease)?,
        quoted(&jobs.file)?
    ))
}

fn text_of(path: &Path) -> Result<&str> {
    let text = path.to_str().filter(|text| !text.contains(['\n', '\r']));
    text.ok_or_else(|| Error::input(path.display().to_string(), "", "cannot stand in a script", "rename it"))
}

/// For the shell: in single quotes.
fn quoted(path: &Path) -> Result<String> {
    Ok(format!("'{}'", text_of(path)?.replace('\'', "'\\''")))
}

/// For a line that sbatch reads itself.
fn quoted_directive(path: &Path) -> Result<String> {
    Ok(format!("\"{}\"", text_of(path)?.replace('\\', "\\\\").replace('"', "\\\"")))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn odd_paths_survive_the_shell() {
        let odd = Path::new("/a b/it's $HOME;`x`");
        let script = format!("printf %s {}", quoted(odd).expect("can be written"));
        if let Ok(output) = Command::new("sh").args(["-c", &script]).output() {
            assert_eq!(String::from_utf8_lossy(&output.stdout), "/a b/it's $HOME;`x`");
        }
        assert!(quoted(Path::new("a\nb")).is_err());
    }
}
