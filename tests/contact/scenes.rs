//! The scenes of `tests/contact.rs` at full size and from many starts: prints one line for each run, and what failed.
//!
//! ```text
//! cargo run --release --example contact_scenes -- [SCENE] [POINTS] [STARTS] [FIRST]     default: all 2000 10 1
//! ```

// Every module serves the tests too, and this program uses a part of each.
#![allow(dead_code)]

#[path = "bakes.rs"]
mod bakes;
#[path = "../reference/external.rs"]
mod external;
#[path = "layers.rs"]
mod layers;
#[path = "run.rs"]
mod run;
#[path = "shapes.rs"]
mod shapes;
#[path = "shots.rs"]
mod shots;

use external::external;
use run::Run;

/// One run of a scene: its line, and whether it holds.
type Scene = fn(usize, u64) -> (String, bool);

const SCENES: [(&str, Scene); 8] = [
    ("sleeve", |n, seed| uncrossed("sleeve, 4 turns", &layers::wring(n, 4.0, seed))),
    ("stack5", |n, seed| stacked(5, n, seed)),
    ("stack10", |n, seed| stacked(10, n, seed)),
    ("fold-thrice", |n, seed| worn("fold-thrice.json", n, seed)),
    ("crumple", |n, seed| worn("crumple.json", n, seed)),
    ("folds", |n, seed| {
        let done =
            bakes::baked("five folds", &bakes::handkerchief(n, seed), 1.0, "cotton-poplin", &bakes::folds(5));
        (format!("{}; {:?}", done.line(), done.report.warnings), done.worst == 0)
    }),
    ("folded", |_, _| {
        let all = folded_by_others();
        let line = |(done, _): &(bakes::Outcome, usize)| {
            format!("{}; fastest {:.2} m/s; {:?}", done.line(), done.fastest, done.report.warnings)
        };
        let holds = all.iter().all(|(done, crossing)| bakes::adds_no_intersections(done, *crossing));
        (all.iter().map(line).collect::<Vec<_>>().join("\n    "), holds)
    }),
    ("shots", |_, seed| {
        let found = [5.0, 20.0].map(|speed| shots::shoot(50, speed, seed));
        let holds = found.iter().all(|f| (f.crossed, f.through) == (0, 0));
        (format!("shots at 5 and 20 m/s: {found:?}"), holds)
    }),
];

/// The T-shirt by a script of the folder `garments/wear`.
fn worn(wear: &str, points: usize, seed: u64) -> (String, bool) {
    let done = bakes::t_shirt(wear, points, seed);
    (format!("{}; {:?}", done.line(), done.report.warnings), done.start == 0 && done.worst == 0)
}

/// T-shirts that another program folded, with 48 and 108 crossings, laid and hung (`CREASE_TEST_DATA`).
fn folded_by_others() -> Vec<(bakes::Outcome, usize)> {
    let folder = external("garments/diffcloth-tshirt-folds");
    let mut all = Vec::new();
    for (file, crossing) in
        [("tshirt1900-folding-biFolded.obj", 48), ("tshirt1900-folding-triFolded.obj", 108)]
    {
        let obj = std::fs::read_to_string(folder.join(file)).expect(file);
        for (what, actions) in
            [("laid", r#"{"lay": {"over": 1.0}}"#), ("hung", r#"{"hang": {"by": "top", "for": 0.5}}"#)]
        {
            all.push((
                bakes::baked(&format!("{file}, {what}"), &obj, 0.1, "cotton-jersey", actions),
                crossing,
            ));
        }
    }
    all
}

fn uncrossed(name: &str, run: &Run) -> (String, bool) {
    (run.line(name), run.worst == 0)
}

fn stacked(count: usize, points: usize, seed: u64) -> (String, bool) {
    let run = layers::stack(count, points, seed, 2.0);
    let (reaction, in_order, least) = layers::judge(&run, count);
    let line = format!(
        "{}; reaction off by {reaction:.1e}, least gap {:.3} mm, kinetic energy {:.1e} J",
        run.line(&format!("{count} sheets")),
        1e3 * least,
        run.kinetic_energy()
    );
    let holds = run.worst == 0 && in_order && reaction.abs() < 1e-3 && run.kinetic_energy() < 1e-8;
    (line, holds)
}

fn main() {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let wanted = arguments.first().map_or("all", String::as_str);
    let number = |k: usize, or: usize| arguments.get(k).and_then(|a| a.parse().ok()).unwrap_or(or);
    let (points, starts, first) = (number(1, 2000), number(2, 10), number(3, 1));
    let mut failed = Vec::new();
    for (name, scene) in SCENES.iter().filter(|(name, _)| wanted == "all" || wanted == *name) {
        for seed in (first..first + starts).map(|k| k as u64) {
            let (line, holds) = scene(points, seed);
            println!("{} start {seed}: {line}", if holds { "holds" } else { "FAILS" });
            if !holds {
                failed.push(format!("{name} from start {seed}"));
            }
        }
    }
    println!("{} failed{}{}", failed.len(), if failed.is_empty() { "" } else { ": " }, failed.join(", "));
}
