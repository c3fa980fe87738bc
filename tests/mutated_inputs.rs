//! Damaged files: for truncated files and flipped bits every reader returns a result or an error, without a panic, within
//! limits of time and memory.
//!
//! The seeds that fuzzing starts from are mutated in full, in every run. The real garments of the folder `garments` of
//! `CREASE_TEST_DATA` are mutated at 4 places and with 8 flips each, and with `CREASE_MUTATE=all` at 64 places and with 256 flips each, as
//! `docs/validation/robustness.md` reports. `CREASE_MUTATE_SECONDS=N` spends N more seconds on each reader's seeds.

#[path = "reference/external.rs"]
mod external;
#[path = "fuzz/feed.rs"]
mod feed;

use crease::{Error, Result};
use external::external;
use std::cell::Cell;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};
use test_attributes::needs_data;

/// Time limit of one input, in a test build.
const MAX_TIME: Duration = Duration::from_secs(10);
/// Peak memory of the process [KiB].
const MAX_MEMORY_KIB: u64 = 2 << 20;

/// Pseudo-random numbers (SplitMix64).
struct SplitMix64(u64);

impl SplitMix64 {
    fn next(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
    }
}

/// Returns `cuts` prefixes of `bytes`, then `flips` copies with one to eight bits flipped.
fn mutations(bytes: &[u8], cuts: usize, flips: usize, seed: u64) -> impl Iterator<Item = Vec<u8>> + '_ {
    let cut = move |k: usize| bytes[..bytes.len() * k / cuts].to_vec();
    let mut rng = SplitMix64(seed);
    let flip = move |_| {
        let mut copy = bytes.to_vec();
        for _ in 0..=rng.next() % 8 {
            let bit = rng.next() as usize % (8 * copy.len().max(1));
            if let Some(byte) = copy.get_mut(bit / 8) {
                *byte ^= 1 << (bit % 8);
            }
        }
        copy
    };
    (0..cuts).map(cut).chain((0..flips).map(flip))
}

#[derive(Default)]
struct Tally {
    read: usize,
    refused: usize,
    slowest: Duration,
    failures: Vec<String>,
}

impl Tally {
    fn feed(&mut self, what: &str, reader: impl FnOnce() -> Result<()>) {
        let began = Instant::now();
        let outcome = catch_unwind(AssertUnwindSafe(reader));
        let took = began.elapsed();
        self.slowest = self.slowest.max(took);
        match outcome {
            Ok(Ok(())) => self.read += 1,
            // A message must name the location or the help.
            Ok(Err(error)) if !error.to_string().trim().is_empty() => self.refused += 1,
            Ok(Err(_)) => self.failures.push(format!("{what}: an empty message")),
            Err(_) => self.failures.push(format!("{what}: a panic")),
        }
        if took > MAX_TIME {
            self.failures.push(format!("{what}: {:.1} s", took.as_secs_f64()));
        }
    }

    fn finish(self, what: &str) {
        let Self { read, refused, slowest, failures } = self;
        let memory = peak_memory_kib();
        println!(
            "{what}: {} inputs, {read} read, {refused} refused, slowest {:.2} s, most memory {} MiB",
            read + refused + failures.len(),
            slowest.as_secs_f64(),
            memory.map_or("?".into(), |kib| (kib / 1024).to_string()),
        );
        assert!(failures.is_empty(), "{} failures:\n{}", failures.len(), failures.join("\n"));
        assert!(memory.is_none_or(|kib| kib < MAX_MEMORY_KIB), "{memory:?} KiB");
    }
}

/// Returns the peak memory of this process [KiB], where the system reports it.
fn peak_memory_kib() -> Option<u64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"))?;
    line.trim().trim_end_matches(" kB").parse().ok()
}

fn files_under(folder: &Path) -> Vec<PathBuf> {
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).expect("a folder") {
        let path = entry.expect("an entry").path();
        if path.is_dir() { files.extend(files_under(&path)) } else { files.push(path) }
    }
    files.sort();
    files
}

fn seeds(kind: &str) -> Vec<PathBuf> {
    files_under(&Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fuzz/seeds").join(kind))
}

fn mutate_seeds(kind: &str, reader: &dyn Fn(&str, &[u8]) -> Result<()>) {
    let mut tally = Tally::default();
    for path in seeds(kind) {
        let bytes = std::fs::read(&path).expect("reads");
        let name = path.file_name().expect("a name").to_string_lossy().into_owned();
        for (k, mutated) in mutations(&bytes, bytes.len().min(1000), 1500, 7).enumerate() {
            tally.feed(&format!("{kind}/{name}, mutation {k}"), || reader(&name, &mutated));
        }
    }
    // On request: more flips of the same seeds, with other random numbers.
    let seconds = std::env::var("CREASE_MUTATE_SECONDS").ok().and_then(|text| text.parse().ok());
    let until = Instant::now() + Duration::from_secs(seconds.unwrap_or(0));
    for seed in 1000.. {
        if Instant::now() >= until {
            break;
        }
        for path in seeds(kind) {
            let bytes = std::fs::read(&path).expect("reads");
            let name = path.file_name().expect("a name").to_string_lossy().into_owned();
            for (k, mutated) in mutations(&bytes, 1, 100, seed).enumerate() {
                tally.feed(&format!("{kind}/{name}, seed {seed}, mutation {k}"), || reader(&name, &mutated));
            }
        }
    }
    assert!(tally.refused > 100, "{kind}: mutations are noticed");
    tally.finish(kind);
}

/// Unchanged seeds are accepted; otherwise the mutations would only test the first checks of a reader.
#[test]
fn the_seeds_themselves_are_read() {
    let read = |kind: &str, reader: &dyn Fn(&str, &[u8]) -> Result<()>| {
        for path in seeds(kind) {
            let name = path.file_name().expect("a name").to_string_lossy().into_owned();
            let outcome = reader(&name, &std::fs::read(&path).expect("reads"));
            assert!(outcome.is_ok(), "{name}: {outcome:?}");
        }
    };
    read("obj", &|name, bytes| feed::lone_mesh(name, bytes));
    read("gltf", &|name, bytes| feed::lone_mesh(name, bytes));
    read("references", &|_, bytes| feed::mesh_with_file(bytes));
    read("usd", &|name, bytes| feed::lone_mesh(name, bytes));
    read("wear", &|_, bytes| feed::wear(bytes));
    read("fabric", &|_, bytes| feed::fabric(bytes));
    read("sidecar", &|_, bytes| feed::sidecar(bytes));
    read("checkpoint", &|_, bytes| feed::checkpoint(bytes));
    read("landmarks", &|_, bytes| feed::landmarks(bytes));
}

#[test]
fn mutated_obj_seeds() {
    mutate_seeds("obj", &|name, bytes| feed::lone_mesh(name, bytes));
}

#[test]
fn mutated_gltf_seeds() {
    mutate_seeds("gltf", &|name, bytes| feed::lone_mesh(name, bytes));
}

#[test]
fn mutated_references() {
    mutate_seeds("references", &|_, bytes| feed::mesh_with_file(bytes));
}

#[test]
fn mutated_usd_seeds() {
    // A panic of the package that decodes USD is caught where it is called: it would count as a refusal. The check before the
    // decoder has to find what makes it panic.
    let caught = Cell::new(0usize);
    mutate_seeds("usd", &|name, bytes| {
        let read = feed::lone_mesh(name, bytes);
        caught.set(
            caught.get()
                + usize::from(read.as_ref().is_err_and(|e| e.to_string().contains("reader stopped"))),
        );
        read
    });
    assert_eq!(caught.get(), 0, "panics of the decoder");
}

#[test]
fn mutated_wear_scripts() {
    mutate_seeds("wear", &|_, bytes| feed::wear(bytes));
}

#[test]
fn mutated_fabrics() {
    mutate_seeds("fabric", &|_, bytes| feed::fabric(bytes));
}

#[test]
fn mutated_sidecars() {
    mutate_seeds("sidecar", &|_, bytes| feed::sidecar(bytes));
}

#[test]
fn mutated_checkpoints() {
    mutate_seeds("checkpoint", &|_, bytes| feed::checkpoint(bytes));
}

#[test]
fn mutated_landmarks() {
    mutate_seeds("landmarks", &|_, bytes| feed::landmarks(bytes));
}

/// A count of 10^12 is rejected: no memory is allocated beyond the size of the file.
#[test]
fn counts_that_lie_are_refused_without_allocating() {
    let gltf = std::fs::read_to_string(&seeds("gltf")[0]).expect("reads");
    for lie in ["1000000000000", "4294967295", "18446744073709551615", "2147483648"] {
        for field in ["count", "byteLength", "byteOffset", "bufferView", "mesh", "POSITION"] {
            let marker = format!("\"{field}\": ");
            for (at, _) in gltf.match_indices(&marker) {
                let (head, tail) = gltf.split_at(at + marker.len());
                let rest = tail.trim_start_matches(|c: char| c.is_ascii_digit());
                let began = Instant::now();
                let outcome = feed::lone_mesh("lie.gltf", format!("{head}{lie}{rest}").as_bytes());
                assert!(began.elapsed() < Duration::from_secs(2), "{field} {lie}");
                // A byteLength of a buffer or an unused view may be too long to matter; never is it fatal.
                drop(outcome);
            }
        }
    }
    for line in ["f 1 2 1000000000000\n", "f -1000000000000 2 3\n", "f 99999999999999999999999999 1 2\n"] {
        let text = format!("v 0 0 0\nv 0.2 0 0\nv 0 0.2 0\n{line}");
        assert!(matches!(feed::lone_mesh("lie.obj", text.as_bytes()), Err(Error::Input(_))), "{line}");
    }
    assert!(peak_memory_kib().is_none_or(|kib| kib < MAX_MEMORY_KIB));
}

/// Found by mutation 78 of seed 2099: a buffer that states fewer bytes than it has and its views use was read, and
/// written shorter than those views reach, so that the worn garment could not be read any more.
#[test]
fn a_buffer_that_states_too_little_is_written_whole() {
    let text = std::fs::read_to_string(&seeds("gltf")[0]).expect("reads");
    let mut document: serde_json::Value = serde_json::from_str(&text).expect("is JSON");
    let stated = &mut document["buffers"][0]["byteLength"];
    assert!(stated.as_u64().is_some_and(|bytes| bytes > 180));
    *stated = 112.into();
    feed::lone_mesh("short.gltf", document.to_string().as_bytes()).expect("is read, and what is written too");
}

/// All files of the shared garments, and those they refer to.
#[needs_data("garments")]
#[test]
fn mutated_garments() {
    let folder = external("garments");
    let all = std::env::var("CREASE_MUTATE").is_ok_and(|value| value == "all");
    let (cuts, flips) = if all { (64, 256) } else { (4, 8) };
    let mut tally = Tally::default();
    for path in files_under(&folder) {
        let bytes = std::fs::read(&path).expect("reads");
        let beside = path.parent().expect("a folder").to_owned();
        // A buffer is read by the document beside it.
        let document = path.with_extension("gltf");
        let is_buffer = path.extension().is_some_and(|e| e == "bin") && document.exists();
        let name = path.display().to_string();
        for (k, mutated) in mutations(&bytes, cuts, flips, 11).enumerate() {
            tally.feed(&format!("{name}, mutation {k}"), || {
                if is_buffer {
                    let text = std::fs::read(&document).expect("reads");
                    return feed::mesh(&document.display().to_string(), &text, &mut |_| Ok(mutated.clone()));
                }
                feed::mesh(&name, &mutated, &mut |file| {
                    std::fs::read(beside.join(file))
                        .map_err(|source| Error::File { file: file.to_owned(), source })
                })
            });
        }
    }
    tally.finish("garments");
}
