//! The wear script: what is done to a garment, in order, as `crease-wear/1` JSON.
//!
//! Positions are fractions of the garment's bounding box as it lies or hangs, angles degrees, times seconds, so that
//! one script suits any garment. Reading reports every fault of a file in one go, with line, column and path
//! (`docs/wear.md`). Nothing here knows a garment, a body or a solver: whether a joint exists is asked at bake time.

use super::{Action, Repeat};
use crate::error::{Error, Fault, Result};
use crate::json::{Document, Path, schema_of};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;

/// Repeats within repeats at most.
pub const NESTING_LIMIT: usize = 8;
/// Actions with all repeats written out, at most: a guard against a typing error in `times`.
pub const ACTION_LIMIT: u64 = 100_000;
/// Wear in one script at most [s]: one day.
pub const DURATION_LIMIT_S: f64 = 86_400.0;

/// The format of a script.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum WearFormat {
    /// The first.
    #[default]
    #[serde(rename = "crease-wear/1")]
    V1,
}

/// What is done to a garment, in order.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "crease wear script")]
pub struct WearScript {
    /// Format of the file: crease-wear/1.
    pub format: WearFormat,
    /// Name of the script, for reports.
    #[serde(default)]
    pub name: String,
    /// What is done, in order.
    #[schemars(length(min = 1))]
    pub actions: Vec<Action>,
}

impl WearScript {
    /// Reads a script; `file` is its name in messages.
    pub fn parse(file: &str, text: &str) -> Result<Self> {
        Self::of_document(&Document::parse(file, text)?)
    }

    /// A script made by a program, checked like one from a file.
    pub fn new(name: impl Into<String>, actions: Vec<Action>) -> Result<Self> {
        let script = Self { format: WearFormat::V1, name: name.into(), actions };
        Self::of_document(&Document::of_value(
            "wear script",
            serde_json::to_value(&script).unwrap_or(Value::Null),
        ))
    }

    fn of_document(document: &Document) -> Result<Self> {
        let faults = document.faults(&Self::schema());
        if !faults.is_empty() {
            return Err(Error::Input(faults));
        }
        let script: Self = document.decode()?;
        let faults = script.misfits(document);
        if faults.is_empty() { Ok(script) } else { Err(Error::Input(faults)) }
    }

    /// The JSON Schema of script files.
    pub fn schema() -> Value {
        schema_of::<Self>()
    }

    /// As a file: JSON with line breaks, ending in one.
    pub fn to_json(&self) -> String {
        // Plain numbers, texts and lists: writing them to memory does not fail.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }

    /// How long the wear takes [s], repeats counted, clips not: only the body knows how long those are.
    pub fn duration_s(&self) -> f64 {
        self.actions.iter().map(|action| action.as_wear().duration_s()).sum()
    }

    /// Number of actions with repeats written out.
    pub fn action_count(&self) -> u64 {
        count(&self.actions)
    }

    /// The actions in order, repeats written out one by one as they are asked for; never a [`Action::Repeat`].
    pub fn flatten(&self) -> Flatten<'_> {
        Flatten { open: vec![Open { actions: &self.actions, next: 0, times_left: 0 }] }
    }

    /// One fault per action that moves a body, for a bake that has none.
    pub fn faults_without_body(&self, file: &str) -> Vec<Fault> {
        let mut faults = Vec::new();
        each(&self.actions, &Path::root().name("actions"), 0, &mut |action, path, _| {
            let own = !matches!(action, Action::Repeat(_)) && action.as_wear().needs_body();
            if own {
                let what = format!("`{}` moves a body, and there is none", action.name());
                faults.push(Fault::new(file, path.to_string(), what, "leave the action out"));
            }
        });
        faults
    }

    /// Faults that no single field shows.
    fn misfits(&self, document: &Document) -> Vec<Fault> {
        let mut faults = Vec::new();
        each(&self.actions, &Path::root().name("actions"), 0, &mut |action, path, depth| {
            let inside = path.name(action.name());
            for misfit in action.as_wear().misfits() {
                faults.push(document.fault(&inside.name(misfit.field), misfit.what, misfit.cure));
            }
            if depth >= NESTING_LIMIT && matches!(action, Action::Repeat(_)) {
                let what = format!("repeats lie more than {NESTING_LIMIT} deep");
                faults.push(document.fault(path, what, "multiply their `times` instead"));
            }
        });
        let (duration_s, count) = (self.duration_s(), self.action_count());
        let at = Path::root().name("actions");
        if duration_s > DURATION_LIMIT_S {
            let what =
                format!("the wear takes {duration_s:.0} s, more than {DURATION_LIMIT_S:.0} s (one day)");
            faults.push(document.fault(&at, what, "shorten holds or lower `times`"));
        }
        if count > ACTION_LIMIT {
            let what = format!("{count} actions with repeats written out, more than {ACTION_LIMIT}");
            faults.push(document.fault(&at, what, "lower `times`"));
        }
        faults
    }
}

/// Visits every action as written, repeats before what they repeat, with its path and depth. What lies deeper than
/// the limit is not visited: the fault above it says so.
fn each(actions: &[Action], at: &Path, depth: usize, visit: &mut impl FnMut(&Action, &Path, usize)) {
    for (index, action) in actions.iter().enumerate() {
        let path = at.entry(index);
        visit(action, &path, depth);
        if let (Action::Repeat(repeat), true) = (action, depth < NESTING_LIMIT) {
            each(&repeat.actions, &path.name("repeat").name("actions"), depth + 1, visit);
        }
    }
}

fn count(actions: &[Action]) -> u64 {
    let of = |action: &Action| match action {
        Action::Repeat(Repeat { times, actions }) => u64::from(*times).saturating_mul(count(actions)),
        _ => 1,
    };
    actions.iter().map(of).fold(0, u64::saturating_add)
}

/// Actions in order with repeats written out; see [`WearScript::flatten`].
#[derive(Debug, Clone)]
pub struct Flatten<'a> {
    open: Vec<Open<'a>>,
}

/// A list under way.
#[derive(Debug, Clone)]
struct Open<'a> {
    actions: &'a [Action],
    next: usize,
    /// Times still to go after this one.
    times_left: u32,
}

impl<'a> Iterator for Flatten<'a> {
    type Item = &'a Action;

    fn next(&mut self) -> Option<&'a Action> {
        while let Some(open) = self.open.last_mut() {
            let Some(action) = open.actions.get(open.next) else {
                if open.times_left > 0 {
                    open.times_left -= 1;
                    open.next = 0;
                } else {
                    self.open.pop();
                }
                continue;
            };
            open.next += 1;
            match action {
                // A repeat of nothing would turn round and round for nothing.
                Action::Repeat(repeat) if repeat.times == 0 || count(&repeat.actions) == 0 => {}
                Action::Repeat(repeat) => {
                    self.open.push(Open { actions: &repeat.actions, next: 0, times_left: repeat.times - 1 });
                }
                plain => return Some(plain),
            }
        }
        None
    }
}
