//! Watches a bake: progress once a simulated second, and a stop after a limit of steps.
//!
//! `cargo run --release --example observer`

use crease::{Bake, BakeProgress, Error, Fabric, GarmentFile, Observer, Quality, WearScript};

struct Progress {
    printed: f64,
    steps: u64,
}

impl Observer for Progress {
    fn progress(&mut self, now: &BakeProgress) {
        self.steps = now.steps;
        if now.time >= self.printed + 1.0 {
            self.printed = now.time;
            println!("{:4.1} of {:.1} s: {}, {} steps", now.time, now.total, now.stage, now.steps);
        }
    }

    fn should_stop(&mut self) -> bool {
        self.steps > 10_000
    }
}

fn main() -> crease::Result<()> {
    let sheet = GarmentFile::sheet([0.2, 0.2], [8, 8])?;
    let text = r#"{"format": "crease-wear/1", "actions": [{"lay": {"facing": "front"}}, {"crumple": {"to": 0.4, "over": 2, "hold": 2}}]}"#;
    let (script, fabric) = (WearScript::parse("crumple.json", text)?, Fabric::preset("denim")?);
    let mut progress = Progress { printed: 0.0, steps: 0 };
    match Bake::new(&sheet.garment, &fabric, &script).quality(Quality::Draft).run_with(&mut progress) {
        Ok(result) => println!("{} hinges remember a crease", result.report.events.critical),
        Err(Error::Interrupted) => println!("stopped after {} steps", progress.steps),
        Err(error) => return Err(error),
    }
    Ok(())
}
