//! The job file, `crease-batch/1`, and its jobs: garments x wear scripts x fabrics, in that order.

use crate::commands::bake;
use crate::files::input;
use clap::Args;
use crease::internal::files::{ReferenceFolders, referenced_files};
use crease::internal::wear::WearScript;
use crease_io::ReadOptions;
use crease_model::error::{Diagnostic, Error, Result};
use crease_model::fabric::{DEFAULT_FABRIC, Fabric};
use crease_model::json::{Document, Path as JsonPath, schema_of};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use sha2::{Digest, Sha256};
use std::collections::HashMap;
use std::path::{Path, PathBuf};

/// Maximum number of jobs of a file, a guard against unintended products.
const MAX_JOBS: usize = 100_000;

/// Format of a job file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
enum BatchFormat {
    /// Version 1.
    #[serde(rename = "crease-batch/1")]
    V1,
}

/// Bakes of every garment with every script in every fabric. Paths are relative to the folder of the file.
#[derive(Debug, Clone, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "crease batch")]
pub struct JobFile {
    /// Format of the file: crease-batch/1.
    format: BatchFormat,
    /// Folder of the outputs, created if missing. Default worn.
    #[serde(default = "worn")]
    #[schemars(length(min = 1))]
    output: String,
    /// Mesh files.
    #[schemars(length(min = 1))]
    garments: Vec<String>,
    /// Wear scripts: files, or names of `crease example`.
    #[schemars(length(min = 1))]
    wear: Vec<String>,
    /// Names of `crease fabric list`, or fabric files. Default: the default fabric of `crease bake`.
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

/// Arguments of `crease bake` that the batch sets itself.
const RESERVED_ARGUMENTS: [&str; 7] =
    ["-o", "--output", "--wear", "--fabric", "--resume", "--threads", "--allow-folder"];

impl JobFile {
    /// Returns the JSON Schema of job files.
    pub fn schema() -> Value {
        schema_of::<Self>()
    }

    /// Returns the paths in the file: of its lists, of the outputs, and those arguments that look like one.
    fn paths(&self) -> impl Iterator<Item = &str> {
        let is_path = |value: &&str| value.contains(['/', '\\']) || *value == "..";
        let given = self.bake.iter().map(|argument| value_of(argument)).filter(is_path);
        let fabrics = self.fabrics.iter().filter(|name| !Fabric::preset_names().contains(&name.as_str()));
        let lists = self.garments.iter().chain(&self.wear).chain(fabrics).chain([&self.output]);
        lists.map(String::as_str).chain(given)
    }

    fn parse(file: &str, text: &str) -> Result<Self> {
        let document = Document::parse(file, text)?;
        let errors = document.validate(&Self::schema());
        if !errors.is_empty() {
            return Err(Error::Input(errors));
        }
        let read: Self = document.decode()?;
        let is_reserved = |a: &&String| RESERVED_ARGUMENTS.iter().any(|own| a.split('=').next() == Some(own));
        let location = JsonPath::root().name("bake");
        let mut errors: Vec<Diagnostic> = read
            .bake
            .iter()
            .filter(is_reserved)
            .map(|a| {
                document.diagnostic(&location, format!("`{a}` is given by the batch itself"), "leave it out")
            })
            .collect();
        if let Some((message, help)) = refused_options(&read.bake).filter(|_| errors.is_empty()) {
            errors.push(document.diagnostic(&location, message, help));
        }
        if errors.is_empty() { Ok(read) } else { Err(Error::Input(errors)) }
    }
}

/// Returns why `crease bake` would refuse the arguments `given`, and the cure; `None` if it takes them.
fn refused_options(given: &[String]) -> Option<(String, String)> {
    let command = bake::Arguments::augment_args(clap::Command::new("crease bake"));
    let own = ["crease bake", "mesh.glb", "--wear", "wear.json", "-o", "out.glb"];
    let text = command.try_get_matches_from(own.into_iter().chain(given.iter().map(String::as_str))).err()?;
    let text = text.to_string();
    let mut lines = text.lines().map(str::trim).filter(|line| !line.is_empty());
    let first = lines.next().unwrap_or_default();
    let message =
        first.strip_prefix("error: ").map_or_else(|| "is no option of a job".to_owned(), str::to_owned);
    let tip = lines.find_map(|line| line.strip_prefix("tip: ")).unwrap_or("see `crease bake --help`");
    Some((message, tip.to_owned()))
}

/// Returns the text of the script `wear` of a job file in `folder`: a file, or else the script of that name.
fn script_text(folder: &Path, wear: &str) -> Result<String> {
    let path = folder.join(wear);
    let is_name = !path.exists() && Path::new(wear).components().count() == 1 && !wear.contains('.');
    match WearScript::preset_text(wear).filter(|_| is_name) {
        Some(text) => Ok(text.to_owned()),
        // Says which name is near.
        None if is_name => WearScript::preset(wear).map(|_| String::new()),
        None => input::text(&path),
    }
}

/// One call of `crease bake`.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Job {
    /// Name of the job and of its outputs.
    pub name: String,
    /// Mesh file, as written in the job file.
    pub garment: String,
    /// Wear script, as written in the job file.
    pub wear: String,
    /// Fabric, as written in the job file.
    pub fabric: String,
}

/// Jobs of a file.
#[derive(Debug)]
pub struct Jobs {
    /// Absolute path of the job file.
    pub file: PathBuf,
    /// Folder of the job file, which paths are relative to.
    pub folder: PathBuf,
    /// Folder of the outputs.
    pub output: PathBuf,
    /// Jobs in order.
    pub list: Vec<Job>,
    /// Further arguments of every job.
    pub bake: Vec<String>,
    /// Absolute path of a folder besides that of the job file in which files may lie.
    pub allow_folder: Option<PathBuf>,
}

impl Jobs {
    /// Reads a job file and checks the scripts and fabrics that it names. The errors of all files are reported together.
    /// Files lie in the folder of the job file or in `allow_folder`.
    pub fn read(path: &Path, allow_folder: Option<&Path>) -> Result<Self> {
        let name = input::name_of(path);
        let read = JobFile::parse(&name, &input::text(path)?)?;
        let file = path.canonicalize().map_err(|source| Error::File { file: name.clone(), source })?;
        let folder = file.parent().unwrap_or(Path::new("/")).to_owned();
        let allow_folder = allow_folder.and_then(|folder| folder.canonicalize().ok());
        let folders = ReferenceFolders::of_folder(path, &folder, allow_folder.as_deref());
        let mut errors = Vec::new();
        let mut note = |outcome: Result<()>| match outcome {
            Ok(()) => Ok(()),
            Err(Error::Input(more)) => {
                errors.extend(more);
                Ok(())
            }
            Err(other) => Err(other),
        };
        for named in read.paths() {
            note(folders.check(&folder.join(named)))?;
        }
        for garment in &read.garments {
            let missing =
                || Error::input(garment, "", "there is no such file", "check the name and the folder");
            note(if folder.join(garment).is_file() { Ok(()) } else { Err(missing()) })?;
        }
        for wear in &read.wear {
            let parsed = script_text(&folder, wear).and_then(|text| WearScript::parse(wear, &text));
            note(parsed.map(drop))?;
        }
        for fabric in &read.fabrics {
            note(input::fabric(&resolve_fabric(&folder, fabric)).map(drop))?;
        }
        let count = read.garments.len().saturating_mul(read.wear.len()).saturating_mul(read.fabrics.len());
        if count > MAX_JOBS {
            let message = format!("has {count} jobs, more than {MAX_JOBS}");
            note(Err(Error::input(&name, "", message, "split it")))?;
        } else {
            errors.extend(name_conflicts(&name, &read));
        }
        if !errors.is_empty() {
            return Err(Error::Input(errors));
        }
        Ok(Self {
            output: folder.join(&read.output),
            list: product(&read),
            bake: read.bake,
            file,
            folder,
            allow_folder,
        })
    }

    /// Returns the path of the worn garment of a job.
    pub fn worn(&self, job: &Job) -> PathBuf {
        self.output.join(format!("{}.glb", job.name))
    }

    /// Returns the hash of all inputs of a job.
    pub fn fingerprint(&self, job: &Job) -> Result<String> {
        let mut hash = Sha256::new();
        let mut part = |bytes: &[u8]| {
            hash.update((bytes.len() as u64).to_le_bytes());
            hash.update(bytes);
        };
        part(env!("CARGO_PKG_VERSION").as_bytes());
        [&job.name, &job.garment].into_iter().chain(&self.bake).for_each(|text| part(text.as_bytes()));
        let garment = self.folder.join(&job.garment);
        let bytes = input::bytes(&garment)?;
        part(&bytes);
        let values = self.bake.iter().map(|argument| self.folder.join(value_of(argument)));
        let given = values.filter(|path| path.exists()).flat_map(files_in);
        let options = ReadOptions { allow_folder: self.allow_folder.clone(), ..ReadOptions::default() };
        for file in std::iter::once(garment).chain(given) {
            // Unreadable files are reported by the bake.
            for read in referenced_files(&file, &options).into_iter().chain([file]) {
                part(read.as_os_str().as_encoded_bytes());
                part(&regular_bytes(&read));
            }
        }
        part(script_text(&self.folder, &job.wear)?.as_bytes());
        part(input::fabric(&resolve_fabric(&self.folder, &job.fabric))?.to_json().as_bytes());
        Ok(hash.finalize().iter().map(|byte| format!("{byte:02x}")).collect())
    }
}

/// Returns the name of a preset unchanged, and the path of a fabric file in `folder`, as `crease bake` resolves it there.
fn resolve_fabric(folder: &Path, fabric: &str) -> String {
    let path = folder.join(fabric);
    let preset = Fabric::preset_names().contains(&fabric);
    if !preset && path.is_file() { path.display().to_string() } else { fabric.to_owned() }
}

/// Returns the value in an argument: what follows the sign in --body=FILE, or all of it.
fn value_of(argument: &str) -> &str {
    match argument.split_once('=') {
        Some((option, value)) if option.starts_with('-') => value,
        _ => argument,
    }
}

/// Returns `path`, or the files of a folder in the order of their names.
fn files_in(path: PathBuf) -> Vec<PathBuf> {
    if !path.is_dir() {
        return vec![path];
    }
    let entries = std::fs::read_dir(&path).into_iter().flatten().flatten();
    let mut files: Vec<PathBuf> = entries.map(|entry| entry.path()).filter(|path| path.is_file()).collect();
    files.sort();
    files
}

/// Returns the content of a regular file; nothing for others.
fn regular_bytes(path: &Path) -> Vec<u8> {
    if path.is_file() { input::bytes(path).unwrap_or_default() } else { Vec::new() }
}

/// Returns all combinations of a job file.
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

/// Returns a file name without extension, of characters that are valid on all file systems.
fn stem(path: &str) -> String {
    let stem =
        Path::new(path).file_stem().map_or_else(String::new, |stem| stem.to_string_lossy().into_owned());
    stem.chars().map(|c| if c.is_alphanumeric() || c == '-' { c } else { '-' }).collect()
}

/// Returns an error for each pair of jobs that would write the same files.
fn name_conflicts(file: &str, read: &JobFile) -> Vec<Diagnostic> {
    let mut seen: HashMap<String, Job> = HashMap::new();
    let mut errors = Vec::new();
    for job in product(read) {
        if let Some(other) = seen.get(&job.name) {
            let message = format!(
                "{} with {} in {} and {} with {} in {} would both be written as {}",
                other.garment, other.wear, other.fabric, job.garment, job.wear, job.fabric, job.name
            );
            errors.push(Diagnostic::new(file, "", message, "give the files different names"));
        }
        seen.entry(job.name.clone()).or_insert(job);
    }
    errors
}

#[cfg(test)]
mod tests {
    use super::*;

    fn file(text: &str) -> Result<JobFile> {
        JobFile::parse("jobs.json", text)
    }

    #[test]
    fn a_file_has_every_combination_in_order() {
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
    fn all_errors_are_reported_with_their_location() {
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
    fn options_and_names_of_scripts_are_checked_before_the_first_job() {
        let with = |bake: &str| {
            let text = format!(
                r#"{{"format": "crease-batch/1", "garments": ["a"], "wear": ["crumple"], "bake": [{bake}]}}"#
            );
            file(&text).map(drop).map_err(|error| error.to_string())
        };
        assert_eq!(with(r#""--strength", "0.5", "--unit=cm""#), Ok(()));
        let typo = with(r#""--stength", "0.5""#).expect_err("is refused");
        assert!(
            typo.contains("bake: unexpected argument '--stength'") && typo.contains("'--strength'"),
            "{typo}"
        );
        assert!(with(r#""--strength", "much""#).expect_err("is refused").contains("invalid value 'much'"));
        let folder = Path::new("no-such-folder");
        assert!(script_text(folder, "crumple").is_ok());
        let typo = script_text(folder, "crumpel").expect_err("is refused").to_string();
        assert!(typo.contains("did you mean `crumple`?"), "{typo}");
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
        let message = Jobs::read(&path, None).expect_err("is refused").to_string();
        assert!(message.contains("would both be written as a_x"), "{message}");
        assert!(message.contains("a.obj: there is no such file") && message.contains("x.json"), "{message}");
    }

    #[test]
    fn values_of_arguments_are_what_follows_the_sign() {
        assert_eq!(["--body=a=b.glb", "a=b.glb", "--body"].map(value_of), ["a=b.glb", "a=b.glb", "--body"]);
    }
}
