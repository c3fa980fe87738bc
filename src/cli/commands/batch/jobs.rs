//! The job file, `crease-batch/1`, and the list of jobs it stands for: garments x wear scripts x fabrics, in that order.

use crate::cli::files::input;
use crease::fabric::{DEFAULT_FABRIC, Fabric};
use crease::json::{Document, Path as JsonPath, schema_of};
use crease::wear::WearScript;
use crease::{Diagnostic, Error, Result};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Jobs of one file at most: a guard against a product that nobody meant.
const MOST_JOBS: usize = 100_000;

/// The format of a job file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
enum BatchFormat {
    /// The first.
    #[serde(rename = "crease-batch/1")]
    V1,
}

/// Many garments, each worn by every script in every fabric. Paths count from the folder of the file.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "crease batch")]
pub struct JobFile {
    /// Format of the file: crease-batch/1.
    format: BatchFormat,
    /// Folder for what comes out; made if there is none. Default worn.
    #[serde(default = "worn")]
    #[schemars(length(min = 1))]
    output: String,
    /// Mesh files.
    #[schemars(length(min = 1))]
    garments: Vec<String>,
    /// Wear scripts.
    #[schemars(length(min = 1))]
    wear: Vec<String>,
    /// Names of `crease fabric list`, or fabric files. Default the tool's own.
    #[serde(default = "fabrics")]
    #[schemars(length(min = 1))]
    fabrics: Vec<String>,
    /// Further arguments of `crease bake` for every job, such as --unit, cm.
    #[serde(default)]
    bake: Vec<String>,
}

fn worn() -> String {
    "worn".to_owned()
}

fn fabrics() -> Vec<String> {
    vec![DEFAULT_FABRIC.to_owned()]
}

/// Arguments of `crease bake` that a batch gives itself.
const OWN_ARGUMENTS: [&str; 6] = ["-o", "--output", "--wear", "--fabric", "--resume", "--threads"];

impl JobFile {
    /// The JSON Schema of job files.
    pub fn schema() -> Value {
        schema_of::<Self>()
    }

    fn parse(file: &str, text: &str) -> Result<Self> {
        let document = Document::parse(file, text)?;
        let faults = document.validate(&Self::schema());
        if !faults.is_empty() {
            return Err(Error::Input(faults));
        }
        let read: Self = document.decode()?;
        let own = |a: &&String| OWN_ARGUMENTS.iter().any(|own| a.split('=').next() == Some(own));
        let place = JsonPath::root().name("bake");
        let faults: Vec<Diagnostic> = read
            .bake
            .iter()
            .filter(own)
            .map(|a| {
                document.diagnostic(&place, format!("`{a}` is given by the batch itself"), "leave it out")
            })
            .collect();
        if faults.is_empty() { Ok(read) } else { Err(Error::Input(faults)) }
    }
}

/// One call of `crease bake`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Job {
    /// Its name: that of what it writes.
    pub name: String,
    /// Mesh file, as the job file has it.
    pub garment: String,
    /// Wear script, as the job file has it.
    pub wear: String,
    /// Fabric, as the job file has it.
    pub fabric: String,
}

/// All jobs of a file.
#[derive(Debug)]
pub struct Jobs {
    /// The job file, absolute.
    pub file: PathBuf,
    /// Its folder: paths count from here.
    pub folder: PathBuf,
    /// Folder for what comes out.
    pub output: PathBuf,
    /// The jobs, in order.
    pub list: Vec<Job>,
    /// Further arguments of every job.
    pub bake: Vec<String>,
}

impl Jobs {
    /// Reads a job file and everything small that it names: faults of all files come in one go.
    pub fn read(path: &Path) -> Result<Self> {
        let name = input::name_of(path);
        let read = JobFile::parse(&name, &input::text(path)?)?;
        let file = path.canonicalize().map_err(|source| Error::File { file: name.clone(), source })?;
        let folder = file.parent().unwrap_or(Path::new("/")).to_owned();
        let mut faults = Vec::new();
        let mut note = |outcome: Result<()>| match outcome {
            Ok(()) => Ok(()),
            Err(Error::Input(more)) => {
                faults.extend(more);
                Ok(())
            }
            Err(other) => Err(other),
        };
        for garment in &read.garments {
            let missing =
                || Error::input(garment, "", "there is no such file", "check the name and the folder");
            note(if folder.join(garment).is_file() { Ok(()) } else { Err(missing()) })?;
        }
        for wear in &read.wear {
            let parsed = input::text(&folder.join(wear)).and_then(|text| WearScript::parse(wear, &text));
            note(parsed.map(drop))?;
        }
        for fabric in &read.fabrics {
            note(input::fabric(&from(&folder, fabric)).map(drop))?;
        }
        let count = read.garments.len().saturating_mul(read.wear.len()).saturating_mul(read.fabrics.len());
        if count > MOST_JOBS {
            let what = format!("stands for {count} jobs, more than {MOST_JOBS}");
            note(Err(Error::input(&name, "", what, "split it")))?;
        } else {
            faults.extend(same_names(&name, &read));
        }
        if !faults.is_empty() {
            return Err(Error::Input(faults));
        }
        Ok(Self { output: folder.join(&read.output), list: product(&read), bake: read.bake, file, folder })
    }

    /// OUT.glb of a job.
    pub fn worn(&self, job: &Job) -> PathBuf {
        self.output.join(format!("{}.glb", job.name))
    }

    /// Hash of everything that the result of a job depends on.
    pub fn key(&self, job: &Job) -> Result<String> {
        let mut hash = Sha256::new();
        let mut part = |bytes: &[u8]| {
            hash.update((bytes.len() as u64).to_le_bytes());
            hash.update(bytes);
        };
        part(env!("CARGO_PKG_VERSION").as_bytes());
        [&job.name, &job.garment].into_iter().chain(&self.bake).for_each(|text| part(text.as_bytes()));
        let garment = self.folder.join(&job.garment);
        let bytes = input::bytes(&garment)?;
        for name in referred_to(&bytes) {
            // What cannot be read is the bake's to tell.
            part(&input::bytes(&garment.with_file_name(name)).unwrap_or_default());
        }
        part(&bytes);
        part(&input::bytes(&self.folder.join(&job.wear))?);
        part(input::fabric(&from(&self.folder, &job.fabric))?.to_json().as_bytes());
        Ok(hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
    }
}

/// A fabric by its name, else by its file in `folder`: as `crease bake` takes it there.
fn from(folder: &Path, fabric: &str) -> String {
    let path = folder.join(fabric);
    let preset = Fabric::preset_names().contains(&fabric);
    if !preset && path.is_file() { path.display().to_string() } else { fabric.to_owned() }
}

/// Files that a .gltf refers to.
fn referred_to(bytes: &[u8]) -> Vec<String> {
    let Ok(document) = serde_json::from_slice::<Value>(bytes) else { return Vec::new() };
    let list = |name: &str| document[name].as_array().cloned().unwrap_or_default();
    let all = list("buffers").into_iter().chain(list("images"));
    all.filter_map(|entry| entry["uri"].as_str().map(str::to_owned))
        .filter(|uri| !uri.contains(':'))
        .collect()
}

fn product(file: &JobFile) -> Vec<Job> {
    let mut list = Vec::new();
    for garment in &file.garments {
        for wear in &file.wear {
            for fabric in &file.fabrics {
                let name = [garment, wear, fabric].map(|path| stem(path)).join("_");
                let [garment, wear, fabric] = [garment, wear, fabric].map(String::clone);
                list.push(Job { name, garment, wear, fabric });
            }
        }
    }
    list
}

/// File name without ending, of characters that no file system minds.
fn stem(path: &str) -> String {
    let stem =
        Path::new(path).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    stem.chars().map(|c| if c.is_alphanumeric() || c == '-' { c } else { '-' }).collect()
}

/// Jobs that would write the same files.
fn same_names(file: &str, read: &JobFile) -> Vec<Diagnostic> {
    let mut seen: HashMap<String, Job> = HashMap::new();
    let mut faults = Vec::new();
    for job in product(read) {
        if let Some(other) = seen.get(&job.name) {
            let what = format!(
                "{} with {} in {} and {} with {} in {} would both be written as {}",
                other.garment, other.wear, other.fabric, job.garment, job.wear, job.fabric, job.name
            );
            faults.push(Diagnostic::new(file, "", what, "give the files different names"));
        }
        seen.entry(job.name.clone()).or_insert(job);
    }
    faults
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str) -> Result<JobFile> {
        JobFile::parse("jobs.json", text)
    }

    #[test]
    fn a_file_stands_for_every_combination_in_order() {
        let read = file(
            r#"{"format": "crease-batch/1", "garments": ["a/shirt.glb", "b.obj"], "wear": ["x.json"],
                "fabrics": ["denim", "my own.json"]}"#,
        )
        .expect("reads");
        let names: Vec<String> = product(&read).into_iter().map(|job| job.name).collect();
        assert_eq!(names, ["shirt_x_denim", "shirt_x_my-own", "b_x_denim", "b_x_my-own"]);
        assert_eq!(read.output, "worn");
    }

    #[test]
    fn faults_are_placed_and_all_there() {
        let message = file(
            "{\"format\": \"crease-batch/1\", \"garments\": [],\n \"waer\": [\"x\"],\n \"bake\": \"--unit\"}",
        )
        .expect_err("is refused")
        .to_string();
        for part in ["garments", "line 2", "`wear`", "bake"] {
            assert!(message.contains(part), "{part}: {message}");
        }
        let own =
            r#"{"format": "crease-batch/1", "garments": ["a"], "wear": ["x"], "bake": ["--fabric=denim"]}"#;
        assert!(file(own).expect_err("is refused").to_string().contains("given by the batch itself"));
    }

    #[test]
    fn two_jobs_may_not_write_the_same_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let path = folder.path().join("jobs.json");
        std::fs::write(
            &path,
            r#"{"format": "crease-batch/1", "garments": ["a.obj", "b/a.glb"], "wear": ["x.json"]}"#,
        )
        .expect("writes");
        let message = Jobs::read(&path).expect_err("is refused").to_string();
        assert!(message.contains("would both be written as a_x"), "{message}");
        assert!(message.contains("a.obj: there is no such file") && message.contains("x.json"), "{message}");
    }

    #[test]
    fn buffers_beside_a_gltf_count() {
        let text = br#"{"buffers": [{"uri": "a.bin"}, {"uri": "data:,"}], "images": [{"uri": "b.png"}, {}]}"#;
        assert_eq!(referred_to(text), ["a.bin", "b.png"]);
        assert!(referred_to(b"v 0 0 0").is_empty());
    }
}
