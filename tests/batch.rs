//! `crease batch`: on this machine, on a real Slurm on the loopback interface, and through Open Job Description, with the
//! same bytes everywhere.
//!
//! The test of Slurm needs slurmctld, slurmd and sbatch (Debian: slurmctld, slurmd, slurm-client) and a user who may run
//! slurmd (root); that of Open Job Description needs `openjd` (PyPI: openjd-cli) in the PATH. Where they are missing, both
//! are ignored.

#[path = "common/tool.rs"]
mod tool;

use assert_cmd::Command;
use serde_json::Value;
use std::path::{Path, PathBuf};
use test_attributes::needs_programs;
use tool::{Pose, crease, wavy_sheet};

/// A slightly wavy sheet that lies.
fn sheet(cells: usize) -> String {
    wavy_sheet(cells, 0.002, Pose::Lying)
}

fn fold(hold: f64) -> String {
    format!(
        r#"{{"format": "crease-wear/1", "actions": [{{"lay": {{"over": 0.3}}}},
            {{"fold": {{"line": [[0.5, 0], [0.5, 1]], "side": "left", "over": 0.5, "hold": {}}}}},
            {{"unfold": {{"all": true, "over": 0.5}}}}]}}"#,
        // Long enough that every fabric remembers the fold.
        3.0 + hold
    )
}

/// A folder with a job file for `garments` x `scripts` x two fabrics.
fn farm(garments: usize, scripts: usize, cells: usize) -> (tempfile::TempDir, String) {
    let folder = tempfile::tempdir().expect("a folder");
    let write = |name: &str, text: &str| std::fs::write(folder.path().join(name), text).expect("writes");
    let names = |prefix: &str, count: usize, ending: &str| -> Vec<String> {
        (0..count).map(|k| format!("{prefix}{k}.{ending}")).collect()
    };
    let (meshes, wear) = (names("sheet", garments, "obj"), names("fold", scripts, "json"));
    meshes.iter().enumerate().for_each(|(k, name)| write(name, &sheet(cells + k)));
    wear.iter().enumerate().for_each(|(k, name)| write(name, &fold(0.2 + 0.1 * k as f64)));
    let file = serde_json::json!({
        "format": "crease-batch/1", "garments": meshes, "wear": wear, "fabrics": ["denim", "silk-habotai"],
        "bake": ["--checkpoint-every", "0"],
    });
    write("jobs.json", &file.to_string());
    let path = folder.path().join("jobs.json").display().to_string();
    (folder, path)
}

/// Name and bytes of all outputs of a batch that are bit-identical between runs.
fn results(folder: &Path) -> Vec<(String, Vec<u8>)> {
    let mut list: Vec<(String, Vec<u8>)> = std::fs::read_dir(folder.join("worn"))
        .expect("a folder")
        .map(|entry| entry.expect("an entry").path())
        .filter(|path| {
            path.to_string_lossy().ends_with(".glb") || path.to_string_lossy().ends_with(".crease.json")
        })
        .map(|path| {
            (
                path.file_name().expect("a name").to_string_lossy().into_owned(),
                std::fs::read(&path).expect("reads"),
            )
        })
        .collect();
    list.sort();
    list
}

fn assert_same_results(one: &Path, other: &Path, jobs: usize) {
    let (one, other) = (results(one), results(other));
    assert_eq!(one.len(), 2 * jobs);
    let names = |list: &[(String, Vec<u8>)]| list.iter().map(|(name, _)| name.clone()).collect::<Vec<_>>();
    assert_eq!(names(&one), names(&other));
    for ((name, a), (_, b)) in one.iter().zip(&other) {
        assert!(a == b, "{name} differs");
    }
}

fn skipped(err: &str) -> usize {
    err.lines().filter(|line| line.ends_with("done before")).count()
}

#[test]
fn what_is_done_is_skipped_and_what_changed_is_not() {
    let (folder, jobs) = farm(2, 1, 4);
    let (_, err, code) = crease(&["batch", &jobs]);
    assert_eq!((code, skipped(&err), err.lines().count()), (0, 0, 4), "{err}");
    let worn = folder.path().join("worn");
    let page = std::fs::read_to_string(worn.join("index.html")).expect("a page");
    assert_eq!(page.matches("data:image/png;base64,").count(), 4);
    let summary: Value =
        serde_json::from_slice(&std::fs::read(worn.join("summary.json")).expect("reads")).expect("is JSON");
    assert_eq!((&summary["jobs"], &summary["done"], &summary["failed"]), (&4.into(), &4.into(), &0.into()));
    assert_eq!(summary["list"][0]["points"], 25);

    let before = results(folder.path());
    assert_eq!(skipped(&crease(&["batch", &jobs]).1), 4);
    // Another script: all anew. A damaged result: that one. Shards cover the rest.
    std::fs::write(worn.join("sheet0_fold0_denim.glb"), "broken").expect("writes");
    let (_, err, _) = crease(&["batch", &jobs, "--shard", "0/2"]);
    assert_eq!((skipped(&err), err.lines().count()), (1, 2), "{err}");
    assert!(before == results(folder.path()), "the mended one is what it was");
    std::fs::write(folder.path().join("fold0.json"), fold(0.4)).expect("writes");
    let (list, _, _) = crease(&["batch", &jobs, "--list"]);
    let list: Value = serde_json::from_str(&list).expect("is JSON");
    assert_eq!((&list["done"], &list["missing"]), (&0.into(), &4.into()));
    assert_eq!(skipped(&crease(&["batch", &jobs]).1), 0);
}

#[test]
fn a_job_that_fails_leaves_the_others_alone_and_is_named() {
    let (folder, jobs) = farm(2, 1, 4);
    std::fs::write(folder.path().join("sheet1.obj"), "v 0 0 nan\n").expect("writes");
    let (_, err, code) = crease(&["batch", &jobs, "--json"]);
    assert_eq!(code, 1);
    assert!(err.contains("2 of 4 jobs failed"), "{err}");
    let news: Vec<Value> = err.lines().filter_map(|line| serde_json::from_str(line).ok()).collect();
    let failed: Vec<&Value> = news.iter().filter(|news| news["state"] == "failed").collect();
    assert_eq!((news.len(), failed.len()), (4, 2));
    assert!(failed[0]["message"].as_str().is_some_and(|text| text.contains("line 1")), "{err}");
    assert_eq!(failed[0]["tries"], 1, "bad input is not tried again");
    assert_eq!(results(folder.path()).len(), 4);
}

#[test]
fn faults_of_every_file_come_in_one_go() {
    let (folder, jobs) = farm(2, 2, 4);
    std::fs::remove_file(folder.path().join("sheet0.obj")).expect("removes");
    std::fs::write(
        folder.path().join("fold1.json"),
        "{\"format\": \"crease-wear/1\",\n \"actions\": [{\"fodl\": {}}]}",
    )
    .expect("writes");
    let (_, err, code) = crease(&["batch", &jobs]);
    assert_eq!(code, 1);
    assert!(err.contains("sheet0.obj: there is no such file") && err.contains("fold1.json: line 2"), "{err}");
    assert!(!folder.path().join("worn").exists());
}

#[cfg(unix)]
#[test]
fn a_batch_that_is_interrupted_goes_on() {
    let (folder, jobs) = farm(1, 1, 14);
    let (plain, plain_jobs) = farm(1, 1, 14);
    assert_eq!(crease(&["batch", &plain_jobs]).2, 0);
    let mut child = std::process::Command::new(env!("CARGO_BIN_EXE_crease"))
        .args(["batch", &jobs, "--quiet"])
        .stderr(std::process::Stdio::null())
        .spawn()
        .expect("starts");
    let checkpoint = || {
        std::fs::read_dir(folder.path().join("worn")).is_ok_and(|mut list| {
            list.any(|e| e.is_ok_and(|e| e.path().extension().is_some_and(|x| x == "checkpoint")))
        })
    };
    while !checkpoint() && child.try_wait().expect("asks").is_none() {
        std::thread::sleep(std::time::Duration::from_millis(5));
    }
    tool::signal(&child, "-TERM");
    assert_eq!(child.wait().expect("waits").code(), Some(130));
    assert!(checkpoint(), "the checkpoint stays");
    assert_eq!(crease(&["batch", &jobs]).2, 0);
    assert_same_results(folder.path(), plain.path(), 2);
}

/// A farm of four jobs, and the path of its Open Job Description template.
fn described_farm() -> (tempfile::TempDir, String) {
    let (folder, jobs) = farm(1, 2, 4);
    let template = folder.path().join("jobs.template.json").display().to_string();
    assert_eq!(crease(&["batch", &jobs, "--openjd", &template]).2, 0);
    (folder, template)
}

#[test]
fn open_job_description_has_a_task_for_every_job() {
    let (_folder, template) = described_farm();
    let text: Value = serde_json::from_slice(&std::fs::read(&template).expect("reads")).expect("is JSON");
    assert_eq!(text["specificationVersion"], "jobtemplate-2023-09");
    assert_eq!(text["steps"][0]["parameterSpace"]["taskParameterDefinitions"][0]["range"], "0-3");
}

/// `openjd`: pip install openjd-cli.
#[needs_programs("openjd")]
#[test]
fn open_job_description_runs_the_same_jobs() {
    let (folder, template) = described_farm();
    let openjd = |arguments: &[&str]| {
        let output = Command::new("openjd").args(arguments).output().expect("runs");
        let output_text =
            String::from_utf8_lossy(&output.stdout).into_owned() + &String::from_utf8_lossy(&output.stderr);
        assert!(output.status.success(), "{output_text}");
    };
    openjd(&["check", &template]);
    let tool = format!("Crease={}", env!("CARGO_BIN_EXE_crease"));
    openjd(&["run", &template, "--step", "Bake", "--job-param", &tool]);
    openjd(&["run", &template, "--step", "Summary", "--job-param", &tool]);
    assert!(folder.path().join("worn/index.html").is_file());
    let (plain, plain_jobs) = farm(1, 2, 4);
    assert_eq!(crease(&["batch", &plain_jobs]).2, 0);
    assert_same_results(folder.path(), plain.path(), 4);
}

/// A Slurm of one controller and two nodes of two processors each, all on this machine; ends with the test.
struct Slurm {
    folder: tempfile::TempDir,
    daemons: Vec<std::process::Child>,
}

impl Slurm {
    /// Debian: slurmctld, slurmd, slurm-client; as root.
    fn start() -> Self {
        let folder = tempfile::tempdir().expect("a folder");
        let at = folder.path().display();
        let port = 20_000 + std::process::id() % 20_000;
        let user = std::env::var("USER").unwrap_or_else(|_| "root".to_owned());
        let conf = format!(
            "ClusterName=loop\nSlurmctldHost=localhost(127.0.0.1)\nSlurmUser={user}\nSlurmdUser={user}\n\
             AuthType=auth/none\nCredType=cred/none\nSlurmctldPort={port}\nSlurmdPort={}\n\
             StateSaveLocation={at}/state\nSlurmdSpoolDir={at}/spool-%n\nSlurmctldPidFile={at}/ctld.pid\n\
             SlurmdPidFile={at}/slurmd-%n.pid\nSlurmctldLogFile={at}/ctld.log\nSlurmdLogFile={at}/slurmd-%n.log\n\
             ProctrackType=proctrack/linuxproc\nTaskPlugin=task/none\nSwitchType=switch/none\nMpiDefault=none\n\
             ReturnToService=2\nSchedulerType=sched/backfill\nSelectType=select/cons_tres\nSelectTypeParameters=CR_CPU\n\
             SlurmdParameters=config_overrides\nAccountingStorageType=accounting_storage/none\n\
             JobAcctGatherType=jobacct_gather/none\nKillWait=5\nMinJobAge=3600\n\
             SchedulerParameters=sched_interval=1,batch_sched_delay=1,bf_interval=1,requeue_setup_env_fail\n\
             NodeName=one NodeHostname=localhost NodeAddr=127.0.0.1 Port={} CPUs=2 State=UNKNOWN\n\
             NodeName=two NodeHostname=localhost NodeAddr=127.0.0.1 Port={} CPUs=2 State=UNKNOWN\n\
             PartitionName=all Nodes=one,two Default=YES MaxTime=INFINITE State=UP\n",
            port + 1,
            port + 2,
            port + 3,
        );
        std::fs::create_dir(folder.path().join("state")).expect("makes");
        std::fs::write(folder.path().join("slurm.conf"), conf).expect("writes");
        let mut slurm = Self { folder, daemons: Vec::new() };
        for arguments in
            [vec!["slurmctld", "-D"], vec!["slurmd", "-D", "-N", "one"], vec!["slurmd", "-D", "-N", "two"]]
        {
            let daemon = std::process::Command::new(arguments[0])
                .args(&arguments[1..])
                .env("SLURM_CONF", slurm.conf())
                .stdout(std::process::Stdio::null())
                .stderr(std::process::Stdio::null())
                .spawn();
            slurm.daemons.push(daemon.expect("starts"));
        }
        let up = (0..60).any(|_| {
            std::thread::sleep(std::time::Duration::from_millis(500));
            slurm.run("sinfo", &["--noheader", "--format=%T %D"]).trim() == "idle 2"
        });
        assert!(up, "Slurm is installed but does not start: is this root?");
        slurm
    }

    fn conf(&self) -> PathBuf {
        self.folder.path().join("slurm.conf")
    }

    fn run(&self, program: &str, arguments: &[&str]) -> String {
        let output =
            Command::new(program).env("SLURM_CONF", self.conf()).args(arguments).output().expect("runs");
        String::from_utf8_lossy(&output.stdout).into_owned()
    }
}

impl Drop for Slurm {
    fn drop(&mut self) {
        // The nodes stop first, so that the controller is notified.
        for daemon in self.daemons.iter_mut().rev() {
            let _ = daemon.kill();
            let _ = daemon.wait();
        }
    }
}

#[needs_programs("slurmctld", "slurmd", "sbatch", "scontrol", "squeue")]
#[test]
fn slurm_runs_the_same_jobs_and_one_that_is_requeued_ends_the_same() {
    let slurm = Slurm::start();
    let (folder, jobs) = farm(5, 2, 10);
    let output = Command::new(env!("CARGO_BIN_EXE_crease"))
        .env("SLURM_CONF", slurm.conf())
        .args(["batch", &jobs, "--slurm"])
        .output()
        .expect("runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let array = String::from_utf8_lossy(&output.stdout).trim().to_owned();
    let worn = folder.path().join("worn");
    let wait = |what: &str, done: &dyn Fn() -> bool| {
        for _ in 0..3000 {
            if done() {
                return;
            }
            std::thread::sleep(std::time::Duration::from_millis(100));
        }
        panic!("{what} took too long: {}", slurm.run("squeue", &[]));
    };
    // The last task is kept from ending as soon as it has something to go on from.
    let task = format!("{array}_19");
    let victim = worn.join("sheet4_fold1_silk-habotai");
    wait("the last task", &|| victim.with_extension("checkpoint").is_file());
    slurm.run("scontrol", &["requeue", &task]);
    wait("the array and its summary", &|| worn.join("summary.json").is_file());
    let state = slurm.run("scontrol", &["show", "job", &task]);
    assert!(state.contains("Restarts=1"), "it was killed and requeued: {state}");
    let summary: Value =
        serde_json::from_slice(&std::fs::read(worn.join("summary.json")).expect("reads")).expect("is JSON");
    assert_eq!((&summary["jobs"], &summary["done"]), (&20.into(), &20.into()), "{summary:#}");
    // Both nodes had work.
    for node in ["one", "two"] {
        let log =
            std::fs::read_to_string(slurm.folder.path().join(format!("slurmd-{node}.log"))).expect("reads");
        assert!(log.contains("launching") || log.contains("Launching"), "{node}: {log}");
    }

    let (plain, plain_jobs) = farm(5, 2, 10);
    assert_eq!(crease(&["batch", &plain_jobs]).2, 0);
    assert_same_results(folder.path(), plain.path(), 20);
    println!("20 jobs over two nodes, one requeued: the bytes of the local batch");
}
