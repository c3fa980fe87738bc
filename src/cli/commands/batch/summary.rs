//! Summary of a batch: summary.json for programs, index.html with a picture of each garment for people.

use crate::commands::batch::job::JobRecord;
use crate::commands::batch::jobs::{Job, Jobs};
use crate::files::output::{Outputs, commit};
use crate::files::view_file::ViewFile;
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use crease::internal::report::render::{Camera, encode_png};
use crease::internal::report::{ColorBy, escaped};
use crease_model::error::Result;
use serde_json::{Value, json};
use std::fmt::Write;
use std::path::Path;

/// Size of a picture on the page [pixels].
const THUMBNAIL_SIZE: [usize; 2] = [320, 240];

/// Returns all jobs and their states.
pub fn list(jobs: &Jobs) -> Value {
    let entries: Vec<Value> = jobs.list.iter().map(|job| entry(jobs, job)).collect();
    let count = |state: &str| entries.iter().filter(|entry| entry["state"] == state).count();
    json!({
        "format": "crease-batch-summary/1",
        "jobs": jobs.list.len(),
        "done": count("done"), "not_converged": count("not_converged"), "failed": count("failed"),
        "missing": count("missing") + count("begun") + count("interrupted"),
        "list": entries,
    })
}

fn entry(jobs: &Jobs, job: &Job) -> Value {
    let record = JobRecord::read(jobs, job);
    let fingerprint = jobs.fingerprint(job).unwrap_or_default();
    let state = match &record {
        None => json!("missing"),
        Some(record) if record.fingerprint != fingerprint => json!("missing"),
        Some(record) if !record.outputs.is_empty() && !record.is_valid(jobs, &fingerprint) => {
            json!("missing")
        }
        Some(record) => json!(record.state),
    };
    let report: Value = std::fs::read(jobs.worn(job).with_extension("report.json"))
        .ok()
        .and_then(|bytes| serde_json::from_slice(&bytes).ok())
        .unwrap_or_default();
    json!({
        "name": job.name, "garment": job.garment, "wear": job.wear, "fabric": job.fabric, "state": state,
        "wall_s": record.as_ref().map(|r| r.wall_s), "tries": record.as_ref().map(|r| r.attempts),
        "message": record.as_ref().map_or("", |r| r.message.as_str()),
        "outputs": record.as_ref().map(|r| &r.outputs),
        "points": report["points"], "crossings": report["crossings"],
        "max_rest_angle_change_deg": report.get("max_rest_angle_change_deg").or(report.get("max_rest_angle_deg")),
        "max_stiffness_ratio": report["max_stiffness_ratio"],
    })
}

/// Writes summary.json and index.html into the output folder.
pub fn write(jobs: &Jobs) -> Result<()> {
    let list = list(jobs);
    let mut outputs = Outputs::new([]);
    outputs.add(&jobs.output.join("summary.json"), format!("{list:#}\n").as_bytes())?;
    outputs.add(&jobs.output.join("index.html"), page(jobs, &list).as_bytes())?;
    commit(outputs)
}

fn page(jobs: &Jobs, list: &Value) -> String {
    let mut cards = String::new();
    for (job, entry) in jobs.list.iter().zip(list["list"].as_array().into_iter().flatten()) {
        let state = entry["state"].as_str().unwrap_or_default();
        let has_outputs = entry["outputs"].as_object().is_some_and(|outputs| !outputs.is_empty());
        let exists = matches!(state, "done" | "not_converged") && has_outputs;
        let picture = exists.then(|| thumbnail(&jobs.worn(job))).flatten();
        let picture = picture.map_or_else(
            || "<div class=\"none\">no picture</div>".to_owned(),
            |png| format!("<img alt=\"\" width=\"320\" height=\"240\" src=\"data:image/png;base64,{png}\">"),
        );
        let name = escaped(&job.name);
        let link = if exists { format!("<a href=\"{name}.glb\">{name}</a>") } else { name };
        let number = |field: &str, unit: &str| match entry[field].as_f64() {
            Some(x) => format!("{}{unit}", (100.0 * x).round() / 100.0),
            None => "&ndash;".to_owned(),
        };
        // Writing to a string cannot fail.
        let _ = writeln!(
            cards,
            "<article class=\"{state}\">{picture}<h2>{link}</h2><p><b>{}</b> in {}; largest rest angle change {}, stiffness up \
             to {}, {} crossings</p><pre>{}</pre></article>",
            state.replace('_', " "),
            number("wall_s", " s"),
            number("max_rest_angle_change_deg", "°"),
            number("max_stiffness_ratio", "×"),
            number("crossings", ""),
            escaped(entry["message"].as_str().unwrap_or_default()),
        );
    }
    let head = format!(
        "{} jobs: {} done, {} not converged, {} failed, {} missing",
        list["jobs"], list["done"], list["not_converged"], list["failed"], list["missing"]
    );
    format!(
        "<!doctype html>\n<html lang=\"en\"><head><meta charset=\"utf-8\"><title>crease batch</title><style>\
         body{{font:14px/1.4 system-ui,sans-serif;background:#f4f3f0;color:#28292e;margin:1.5em}}\
         main{{display:flex;flex-wrap:wrap;gap:1em}}\
         article{{width:320px;background:#fff;border:1px solid #ddd;border-top:4px solid #4a8}}\
         article.failed{{border-top-color:#c33}}article.missing,article.begun,article.interrupted{{border-top-color:#aaa}}\
         article.not_converged{{border-top-color:#d90}}h1{{font-size:1.3em}}h2{{font-size:1em;margin:.5em .8em 0;\
         overflow-wrap:anywhere}}p{{margin:.3em .8em .6em}}pre{{margin:0 .8em;white-space:pre-wrap;color:#a00}}\
         .none{{height:240px;display:grid;place-items:center;color:#888}}</style></head>\n<body><h1>{head}</h1>\n\
         <main>\n{cards}</main></body></html>\n"
    )
}

/// Returns a picture of the worn garment as PNG in base64; `None` if it cannot be read.
fn thumbnail(worn: &Path) -> Option<String> {
    let view = ViewFile::read(worn, None).ok()?.view;
    let image = view.draw(ColorBy::Shape, &Camera::default(), THUMBNAIL_SIZE).ok()?;
    Some(STANDARD.encode(encode_png(&image).ok()?))
}
