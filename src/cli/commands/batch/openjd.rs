//! Jobs for engines of the Open Job Description: a job template (jobtemplate-2023-09) whose tasks each run a shard,
//! with the summary as a second step. Run it with `openjd run TEMPLATE.json --step Bake`, or submit it to a farm.

use crate::commands::batch::jobs::Jobs;
use crate::files::output::{Outputs, commit};
use crease::internal::files::folder_of;
use crease_model::error::Result;
use serde_json::{Value, json};
use std::path::Path;

/// Maximum number of tasks of a step, a limit of the format.
const MAX_TASKS: usize = 1024;
/// Time between the request to stop a task and its termination [s].
const CANCEL_NOTICE_S: u32 = 30;

/// Writes the template.
pub fn write(jobs: &Jobs, path: &Path) -> Result<()> {
    let mut outputs = Outputs::new([jobs.file.as_path()]);
    outputs.add(path, format!("{:#}\n", template(jobs, path)).as_bytes())?;
    commit(outputs)
}

fn template(jobs: &Jobs, path: &Path) -> Value {
    let tasks = jobs.list.len().min(MAX_TASKS);
    let on_run = |rest: &[&str]| {
        let mut args = vec!["batch".to_owned(), "{{Param.Jobs}}".to_owned()];
        args.extend(rest.iter().map(|text| (*text).to_owned()));
        if let Some(folder) = &jobs.allow_folder {
            args.extend(["--allow-folder".to_owned(), folder.display().to_string()]);
        }
        json!({"actions": {"onRun": {
            "command": "{{Param.Crease}}",
            "args": args,
            "cancelation": {"mode": "NOTIFY_THEN_TERMINATE", "notifyPeriodInSeconds": CANCEL_NOTICE_S},
        }}})
    };
    let mut parameter = json!({"name": "Jobs", "type": "PATH", "objectType": "FILE", "dataFlow": "IN",
        "description": "The job file, crease-batch/1."});
    // The default is relative to the folder of the template; without it the parameter is required.
    if let (Ok(folder), Some(name)) = (folder_of(path).canonicalize(), jobs.file.file_name())
        && folder == jobs.folder
    {
        parameter["default"] = json!(name.to_string_lossy());
    }
    let shard = format!("{{{{Task.Param.Shard}}}}/{tasks}");
    json!({
        "specificationVersion": "jobtemplate-2023-09",
        "name": "crease batch",
        "parameterDefinitions": [
            parameter,
            {"name": "Crease", "type": "STRING", "default": "crease", "description": "The tool."},
        ],
        "steps": [
            {
                "name": "Bake",
                "parameterSpace": {"taskParameterDefinitions": [
                    {"name": "Shard", "type": "INT", "range": format!("0-{}", tasks - 1)},
                ]},
                "script": on_run(&["--shard", &shard, "--parallel", "1", "--json"]),
            },
            {
                "name": "Summary",
                "dependencies": [{"dependsOn": "Bake"}],
                "script": on_run(&["--summary"]),
            },
        ],
    })
}
