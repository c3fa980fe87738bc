//! The viewer page in a browser: it draws without an error, and what it draws is to be seen.
//!
//! Runs where Chromium is installed (Debian: chromium), with its software renderer; else the test is ignored.

use serde_json::{Value, json};
use std::path::Path;
use std::process::{Command, Stdio};
use std::time::{Duration, Instant};
use test_attributes::needs_programs;

/// Time limit of the browser; the page holds megabytes of script.
const TIMEOUT: Duration = Duration::from_secs(120);

fn chromium() -> &'static str {
    let path = std::env::var_os("PATH").unwrap_or_default();
    ["chromium", "chromium-browser", "google-chrome"]
        .into_iter()
        .find(|program| std::env::split_paths(&path).any(|folder| folder.join(program).is_file()))
        .expect("Chromium is installed (Debian: chromium)")
}

/// Runs the browser on `address` in its own profile; returns its standard output.
fn browse(browser: &str, profile: &Path, arguments: &[&str], address: &str) -> String {
    let out = profile.join("out.txt");
    let mut child = Command::new(browser)
        .args(["--headless=new", "--no-sandbox", "--use-angle=swiftshader", "--enable-unsafe-swiftshader"])
        .args(["--window-size=900,600", "--virtual-time-budget=20000"])
        .arg(format!("--user-data-dir={}", profile.display()))
        .args(arguments)
        .arg(address)
        .stdout(std::fs::File::create(&out).expect("makes"))
        .stderr(Stdio::null())
        .spawn()
        .expect("starts");
    let began = Instant::now();
    while child.try_wait().expect("asks").is_none() {
        assert!(began.elapsed() < TIMEOUT, "the browser does not end");
        std::thread::sleep(Duration::from_millis(50));
    }
    String::from_utf8_lossy(&std::fs::read(&out).expect("reads")).into_owned()
}

/// Pixels of a PNG, four bytes each.
fn pixels(path: &Path) -> Vec<[u8; 3]> {
    let file = std::io::BufReader::new(std::fs::File::open(path).expect("opens"));
    let mut reader = png::Decoder::new(file).read_info().expect("is a PNG");
    let mut bytes = vec![0; reader.output_buffer_size().expect("fits")];
    let info = reader.next_frame(&mut bytes).expect("reads");
    let samples = info.color_type.samples();
    bytes[..info.buffer_size()].chunks_exact(samples).map(|p| [p[0], p[1], p[2]]).collect()
}

/// The sidecar with strong memory: rest angles of 70 degrees to one side in its first half, to the other in its second,
/// and displacements of up to 50 mm.
fn well_worn(mut sidecar: Value) -> Value {
    if let Some(angles) = sidecar["hinges"]["rest_angle_rad"].as_array_mut() {
        let half = angles.len() / 2;
        angles
            .iter_mut()
            .enumerate()
            .for_each(|(h, angle)| *angle = json!(if h < half { -1.2 } else { 1.2 }));
    }
    if let Some(displacements) = sidecar["points"]["displacement_m"].as_array_mut() {
        let count = displacements.len() as f64;
        displacements
            .iter_mut()
            .enumerate()
            .for_each(|(p, d)| *d = json!([0.0, 0.05 * p as f64 / count, 0.0]));
    }
    sidecar
}

#[needs_programs("chromium|chromium-browser|google-chrome")]
#[test]
fn the_page_shows_the_worn_garment_and_its_colours() {
    let browser = chromium();
    let folder = tempfile::tempdir().expect("a folder");
    let page = folder.path().join("worn.html");
    // Two garments beside each other: the seed of the fuzz targets, with its sidecar put beside it.
    let seeds = Path::new(concat!(env!("CARGO_MANIFEST_DIR"), "/../..")).join("tests/fuzz/seeds");
    let worn = folder.path().join("out.glb");
    std::fs::copy(seeds.join("gltf/worn.glb"), &worn).expect("copies");
    let sidecar = std::fs::read(seeds.join("sidecar/worn.json")).expect("reads");
    let sidecar = well_worn(serde_json::from_slice(&sidecar).expect("is JSON"));
    std::fs::write(folder.path().join("out.crease.json"), sidecar.to_string()).expect("writes");
    let made = Command::new(env!("CARGO_BIN_EXE_crease"))
        .args(["view".as_ref(), worn.as_os_str(), worn.as_os_str(), "-o".as_ref(), page.as_os_str()])
        .status()
        .expect("runs");
    assert!(made.success());
    let address = |state: &str| format!("file://{}#{state}", page.display());

    let dom = browse(browser, folder.path(), &["--dump-dom"], &address("show=stiffness&worn=0.5"));
    let body = dom.rsplit("<body").next().unwrap_or_default();
    let body = &body[..body.find('>').unwrap_or(0)];
    assert!(body.contains("data-ready=\"yes\"") && !body.contains("data-error"), "<body{body}>");
    assert_eq!(dom.matches("class=\"pane").count(), 2);
    assert!(dom.contains(">50 %<"), "the slider shows its value");

    // Without the library and the clips of three.js the page is small, and it forbids requests itself.
    let size = std::fs::metadata(&page).expect("is there").len();
    assert!(size < 1_000_000, "{size} bytes");
    let dom =
        browse(browser, folder.path(), &["--dump-dom"], &address("show=curvature&wipe=0.3&wire=1&view=back"));
    assert!(dom.contains("data-ready=\"yes\"") && dom.contains("left: 30%"), "the wipe has its handle");

    let mut pictures = Vec::new();
    for state in ["show=rest-angle-change", "show=rest-angle-change&worn=0", "show=displacement"] {
        let state = &format!("{state}&dark=0");
        let picture = folder.path().join("picture.png");
        let screenshot = format!("--screenshot={}", picture.display());
        browse(browser, folder.path(), &[&screenshot], &address(state));
        pictures.push(pixels(&picture));
    }
    // The garment's folds are orange and blue; its displacement is in the colours of viridis.
    let fraction = |picture: &[[u8; 3]], is: &dyn Fn(&[u8; 3]) -> bool| {
        picture.iter().filter(|p| is(p)).count() as f64 / picture.len() as f64
    };
    let bluish = |p: &[u8; 3]| i32::from(p[2]) > i32::from(p[0]) + 40;
    let reddish = |p: &[u8; 3]| i32::from(p[0]) > i32::from(p[2]) + 40;
    let greenish = |p: &[u8; 3]| i32::from(p[1]) > i32::from(p[0]) + 30;
    assert!(fraction(&pictures[0], &bluish) > 0.01 && fraction(&pictures[0], &reddish) > 0.01, "rest angle");
    assert!(fraction(&pictures[2], &greenish) > 0.01, "displacement");
    let moved = pictures[0].iter().zip(&pictures[1]).filter(|(a, b)| a != b).count();
    assert!(moved > pictures[0].len() / 500, "the slider moves the garment: {moved} pixels");
}
