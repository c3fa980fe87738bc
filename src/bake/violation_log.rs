//! Demands that could not be met, gathered over a run: one warning for every stretch of time, with the worst place.

use crate::math::Vec3;
use crate::sim::{Violation, Violations};
use serde::{Deserialize, Serialize};

/// Times nearer than this belong to one warning [s].
const PAUSE: f64 = 0.25;
/// Warnings of one kind at most; the rest are counted.
const MOST: usize = 5;

/// One stretch of time.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
struct Episode {
    from: f64,
    to: f64,
    worst: Violation,
}

/// Everything unmet so far: layers pressed, cloth stretched.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct UnmetLog([Vec<Episode>; 2]);

impl UnmetLog {
    /// Takes up what the step that ended at `time` [s] left unmet.
    pub fn note(&mut self, time: f64, unmet: &Violations) {
        let all = [unmet.pressed, unmet.stretched];
        for (kind, (episodes, found)) in self.0.iter_mut().zip(all).enumerate() {
            let Some(found) = found else { continue };
            // The less there is left between pressed layers, the worse.
            let worse =
                |a: &Violation, b: &Violation| if kind == 0 { a.size < b.size } else { a.size > b.size };
            match episodes.last_mut().filter(|last| time - last.to <= PAUSE) {
                Some(last) => {
                    last.to = time;
                    if worse(&found, &last.worst) {
                        last.worst = found;
                    }
                }
                None => episodes.push(Episode { from: time, to: time, worst: found }),
            }
        }
    }

    /// In words.
    pub fn warnings(&self) -> Vec<String> {
        let mut all = Vec::new();
        for (kind, episodes) in self.0.iter().enumerate() {
            for e in episodes.iter().take(MOST) {
                let (when, at) = (span(e.from, e.to), place(&e.worst.position));
                let size = e.worst.size;
                all.push(match kind {
                    0 => format!(
                        "{when}: layers pressed to {:.0} % of their thickness near {at}; none of them crossed",
                        100.0 * size
                    ),
                    _ => format!("{when}: cloth stretched by {:.0} % near {at}", 100.0 * size),
                });
            }
            if episodes.len() > MOST {
                let what = ["pressed layers too thin", "overstretched cloth"][kind];
                all.push(format!("{} more times something {what}", episodes.len() - MOST));
            }
        }
        all
    }
}

fn span(from: f64, to: f64) -> String {
    if to > from { format!("{from:.2} to {to:.2} s") } else { format!("{from:.2} s") }
}

fn place(x: &Vec3) -> String {
    format!("({:.3}, {:.3}, {:.3}) m", x.x, x.y, x.z)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn near_times_make_one_warning_with_the_worst_place() {
        let mut log = UnmetLog::default();
        let stretched = |size: f64, x: f64| Violations {
            stretched: Some(Violation { size, position: Vec3::new(x, 0.0, 0.0) }),
            ..Violations::default()
        };
        log.note(1.0, &stretched(0.31, 0.1));
        log.note(1.2, &stretched(0.43, 0.2));
        log.note(1.3, &Violations::default());
        log.note(1.4, &stretched(0.32, 0.3));
        log.note(5.0, &stretched(0.31, 0.4));
        let warnings = log.warnings();
        assert_eq!(warnings.len(), 2);
        assert!(warnings[0].starts_with("1.00 to 1.40 s: "), "{}", warnings[0]);
        assert!(warnings[0].contains("43 % near (0.200, 0.000, 0.000) m"), "{}", warnings[0]);
        assert!(warnings[1].starts_with("5.00 s: "));
    }

    #[test]
    fn the_rest_is_counted() {
        let mut log = UnmetLog::default();
        let pressed = Violations {
            pressed: Some(Violation { size: 0.05, position: Vec3::zeros() }),
            ..Violations::default()
        };
        (0..9).for_each(|k| log.note(f64::from(k), &pressed));
        let warnings = log.warnings();
        assert_eq!(warnings.len(), 6);
        assert!(warnings[0].contains("5 % of their thickness"));
        assert_eq!(warnings[5], "4 more times something pressed layers too thin");
    }
}
