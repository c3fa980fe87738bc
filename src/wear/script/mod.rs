//! The wear script: the actions on a garment in order, as `crease-wear/1` JSON.
//!
//! Positions are fractions of the garment's bounding box as it lies or hangs, angles degrees, times seconds, so that
//! one script suits any garment. Reading reports every error of a file at once, with line, column and path
//! (`docs/guide/wear-scripts.md`). No garment, body or solver is known here: whether a joint exists is checked by the bake.

pub(crate) mod action_list;
mod action_order;
mod preset_list;

use crate::wear::script::action_list::{Action, Repeat};
use crease_model::body::{AnimatedBody, BodyPose};
use crease_model::error::{Diagnostic, Error, Message, Result, Setting};
use crease_model::json::{Document, Path, schema_of};
use schemars::JsonSchema;
use serde::{Deserialize, Serialize};
use serde_json::Value;
use std::borrow::Cow;

/// Largest depth of repeats within repeats.
pub const MAX_NESTING: usize = 8;
/// Largest number of actions with all repeats written out: a guard against a typing error in `times`.
pub const MAX_ACTIONS: u64 = 100_000;
/// Largest duration of one script [s]: one day.
pub const MAX_DURATION_S: f64 = 86_400.0;

/// The format of a script.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq, Serialize, Deserialize, JsonSchema)]
pub enum WearFormat {
    /// The first version.
    #[default]
    #[serde(rename = "crease-wear/1")]
    V1,
}

/// The actions on a garment, in order.
///
/// ```
/// use crease::WearScript;
/// let script = WearScript::parse("nap.json", r#"{"format": "crease-wear/1", "name": "a nap", "actions": [
///     {"repeat": {"times": 3, "actions": [{"crumple": {"to": 0.5, "over": 2}}, {"release": {}}, {"settle": {"for": 1}}]}}]}"#)?;
/// assert_eq!(script.flatten().count(), 9);
/// # Ok::<(), crease::Error>(())
/// ```
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
#[schemars(title = "crease wear script")]
pub struct WearScript {
    /// Format of the file: crease-wear/1.
    pub format: WearFormat,
    /// Name of the script, for reports.
    #[serde(default)]
    pub name: String,
    /// The actions, in order.
    #[schemars(length(min = 1))]
    pub actions: Vec<Action>,
}

impl WearScript {
    /// Reads a script; `file` is its name in messages.
    ///
    /// ```
    /// let text = r#"{"format": "crease-wear/1", "actions": [{"setle": {"for": 1}}]}"#;
    /// let message = crease::WearScript::parse("wear.json", text).unwrap_err().to_string();
    /// assert!(message.contains("line 1") && message.contains("settle"), "{message}");
    /// ```
    pub fn parse(file: &str, text: &str) -> Result<Self> {
        Self::from_document(&Document::parse(file, text)?)
    }

    /// A script made by a program, checked like one from a file.
    pub fn new(name: impl Into<String>, actions: Vec<Action>) -> Result<Self> {
        let script = Self { format: WearFormat::V1, name: name.into(), actions };
        Self::from_document(&Document::from_value(
            "wear script",
            serde_json::to_value(&script).unwrap_or(Value::Null),
        ))
    }

    fn from_document(document: &Document) -> Result<Self> {
        let errors = document.validate(&Self::schema());
        if !errors.is_empty() {
            return Err(Error::Input(errors));
        }
        let script: Self = document.decode()?;
        let errors = script.validate(document);
        if errors.is_empty() { Ok(script) } else { Err(Error::Input(errors)) }
    }

    /// The JSON Schema of script files.
    pub fn schema() -> Value {
        schema_of::<Self>()
    }

    /// The script as a file: JSON with line breaks, ending in one.
    pub fn to_json(&self) -> String {
        // Plain numbers, texts and lists: writing them to memory does not fail.
        let mut text = serde_json::to_string_pretty(self).unwrap_or_default();
        text.push('\n');
        text
    }

    /// Duration [s] with repeats, without clips: only the body determines the length of those.
    pub fn duration(&self) -> f64 {
        self.actions.iter().map(|action| action.as_wear_action().duration()).sum()
    }

    /// Number of actions with repeats written out.
    pub fn action_count(&self) -> u64 {
        count_actions(&self.actions)
    }

    /// The actions in order, repeats and actions that consist of others written out one by one as they are asked for.
    pub fn flatten(&self) -> Flatten<'_> {
        Flatten { open: vec![OpenList { actions: Cow::Borrowed(&self.actions), next: 0, times_left: 0 }] }
    }

    /// One error per action that moves a body, for a bake without one.
    pub fn errors_without_body(&self, file: &str) -> Vec<Diagnostic> {
        let mut errors = Vec::new();
        visit_actions(&self.actions, &Path::root().name("actions"), 0, &mut |action, path, _| {
            let own = !matches!(action, Action::Repeat(_)) && action.as_wear_action().needs_body();
            if own {
                let message = format!("`{}` moves a body, and there is none", action.name());
                let help = Message::from("give the body with ") + Setting::Body + ", or leave the action out";
                errors.push(Diagnostic::new(file, path.to_string(), message, help));
            }
        });
        errors
    }

    /// Errors of the actions with regard to `body`: joints and clips that do not exist.
    pub fn body_errors(&self, file: &str, body: &AnimatedBody) -> Vec<Diagnostic> {
        let mut errors = Vec::new();
        visit_actions(&self.actions, &Path::root().name("actions"), 0, &mut |action, path, _| {
            for error in action.as_wear_action().validate_body(body) {
                let location = path.name(action.name()).name(error.field).to_string();
                errors.push(Diagnostic::new(file, location, error.message, error.help));
            }
        });
        errors
    }

    /// What the actions do with `body` that the user should know, each once.
    pub fn body_notes(&self, body: &AnimatedBody) -> Vec<String> {
        let mut notes: Vec<String> = Vec::new();
        visit_actions(&self.actions, &Path::root().name("actions"), 0, &mut |action, _, _| {
            for note in action.as_wear_action().body_notes(body) {
                if !notes.contains(&note) {
                    notes.push(note);
                }
            }
        });
        notes
    }

    /// Duration with `body` [s], without transitions between clips.
    pub fn duration_with_body(&self, body: Option<&AnimatedBody>) -> f64 {
        let clip = |action: Cow<Action>| match (action.as_ref(), body) {
            (Action::Play(play), Some(body)) => play.duration_on(body),
            _ => 0.0,
        };
        self.duration() + self.flatten().map(clip).sum::<f64>()
    }

    /// Index of the action, in the flattened script, from which on the garment is only opened and rests: `unfold`, then nothing but
    /// `settle`.
    pub fn opening(&self) -> Option<usize> {
        let actions: Vec<Cow<Action>> = self.flatten().collect();
        let last = actions.iter().rposition(|action| !matches!(action.as_ref(), Action::Settle(_)))?;
        matches!(actions[last].as_ref(), Action::Unfold(_)).then_some(last)
    }

    /// Poses that the script takes `body` through, in order; every action as written counts once. Empty when an action takes
    /// the garment off the body or moves it by other means.
    pub fn body_poses(&self, body: &AnimatedBody) -> Vec<BodyPose> {
        let (mut poses, mut other) = (vec![body.rest()], false);
        visit_actions(&self.actions, &Path::root().name("actions"), 0, &mut |action, _, _| match action {
            Action::Repeat(_) | Action::Hold(_) | Action::Settle(_) | Action::Release(_) => {}
            Action::Bend(_) | Action::Play(_) => {
                let from = poses.last().cloned().unwrap_or(BodyPose::Still);
                poses.extend(action.as_wear_action().body_poses(body, &from));
                if matches!(action, Action::Bend(_)) {
                    poses.push(from);
                }
            }
            _ => other = true,
        });
        if other { Vec::new() } else { poses }
    }

    /// Errors that no single field shows.
    fn validate(&self, document: &Document) -> Vec<Diagnostic> {
        let mut errors = Vec::new();
        visit_actions(&self.actions, &Path::root().name("actions"), 0, &mut |action, path, depth| {
            let inside = path.name(action.name());
            for error in action.as_wear_action().validate() {
                errors.push(document.diagnostic(&inside.name(error.field), error.message, error.help));
            }
            if depth >= MAX_NESTING && matches!(action, Action::Repeat(_)) {
                let message = format!("repeats lie more than {MAX_NESTING} deep");
                errors.push(document.diagnostic(path, message, "multiply their `times` instead"));
            }
        });
        let (duration, count) = (self.duration(), self.action_count());
        let at = Path::root().name("actions");
        if duration > MAX_DURATION_S {
            let message =
                format!("the wear takes {duration:.0} s, more than {MAX_DURATION_S:.0} s (one day)");
            errors.push(document.diagnostic(&at, message, "shorten holds or lower `times`"));
        }
        if count > MAX_ACTIONS {
            let message = format!("{count} actions with repeats written out, more than {MAX_ACTIONS}");
            errors.push(document.diagnostic(&at, message, "lower `times`"));
        }
        errors
    }
}

/// Calls `visit` for every action as written, repeats before what they repeat, with its path and depth. Actions deeper than
/// the limit are not visited: an error of the script says so.
fn visit_actions(actions: &[Action], at: &Path, depth: usize, visit: &mut impl FnMut(&Action, &Path, usize)) {
    for (index, action) in actions.iter().enumerate() {
        let path = at.entry(index);
        visit(action, &path, depth);
        if let (Action::Repeat(repeat), true) = (action, depth < MAX_NESTING) {
            visit_actions(&repeat.actions, &path.name("repeat").name("actions"), depth + 1, visit);
        }
    }
}

/// Number of actions with repeats written out.
fn count_actions(actions: &[Action]) -> u64 {
    let count = |action: &Action| match action {
        Action::Repeat(Repeat { times, actions }) => u64::from(*times).saturating_mul(count_actions(actions)),
        other => other.parts().len().max(1) as u64,
    };
    actions.iter().map(count).fold(0, u64::saturating_add)
}

/// Iterator over actions in order, written out; see [`WearScript::flatten`].
#[derive(Debug, Clone)]
pub struct Flatten<'a> {
    open: Vec<OpenList<'a>>,
}

/// A list of actions in progress.
#[derive(Debug, Clone)]
struct OpenList<'a> {
    actions: Cow<'a, [Action]>,
    next: usize,
    /// Repetitions after the present one.
    times_left: u32,
}

impl<'a> OpenList<'a> {
    /// The action that is due; `None` at the end of the list.
    fn due(&self) -> Option<Cow<'a, Action>> {
        match &self.actions {
            Cow::Borrowed(actions) => actions.get(self.next).map(Cow::Borrowed),
            Cow::Owned(actions) => actions.get(self.next).cloned().map(Cow::Owned),
        }
    }
}

impl<'a> Iterator for Flatten<'a> {
    type Item = Cow<'a, Action>;

    fn next(&mut self) -> Option<Cow<'a, Action>> {
        while let Some(open) = self.open.last_mut() {
            let Some(action) = open.due() else {
                if open.times_left > 0 {
                    open.times_left -= 1;
                    open.next = 0;
                } else {
                    self.open.pop();
                }
                continue;
            };
            open.next += 1;
            let (actions, times) = match action {
                Cow::Borrowed(Action::Repeat(repeat)) => (Cow::Borrowed(&repeat.actions[..]), repeat.times),
                Cow::Owned(Action::Repeat(repeat)) => (Cow::Owned(repeat.actions), repeat.times),
                other => match other.parts() {
                    parts if parts.is_empty() => return Some(other),
                    parts => (Cow::Owned(parts), 1),
                },
            };
            // A repeat without actions would loop without a result.
            if times > 0 && count_actions(&actions) > 0 {
                self.open.push(OpenList { actions, next: 0, times_left: times - 1 });
            }
        }
        None
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::wear::actions::Hold;
    use crate::wear::wear_action::WearAction;

    const FOLD_THRICE: &str = include_str!("../../../garments/wear/fold-thrice.json");
    const CRUMPLE: &str = include_str!("../../../garments/wear/crumple.json");
    const PRESS_CREASE: &str = include_str!("../../../garments/wear/press-crease.json");

    fn errors_of(text: &str) -> Vec<String> {
        match WearScript::parse("w.json", text) {
            Ok(script) => panic!("accepted: {script:?}"),
            Err(Error::Input(errors)) => errors.iter().map(ToString::to_string).collect(),
            Err(other) => panic!("{other}"),
        }
    }

    fn script(actions: &str) -> String {
        format!(r#"{{"format": "crease-wear/1", "name": "t", "actions": [{actions}]}}"#)
    }

    #[test]
    fn scripts_of_the_repository_are_read() {
        let expected = [
            (FOLD_THRICE, 58.0, vec!["lay", "fold", "fold", "fold", "press", "unfold", "settle"]),
            (CRUMPLE, 38.0, vec!["lay", "crumple", "release", "settle"]),
            (PRESS_CREASE, 131.0, vec!["lay", "fold", "press", "unfold", "settle"]),
        ];
        for (text, duration_s, names) in expected {
            let script = WearScript::parse("w.json", text).expect("is valid");
            assert_eq!(script.duration(), duration_s);
            assert_eq!(script.flatten().map(|action| action.name()).collect::<Vec<_>>(), names);
            assert_eq!(WearScript::parse("again", &script.to_json()).expect("round trip"), script);
        }
    }

    #[test]
    fn every_action_survives_a_round_trip_and_stands_in_the_schema() {
        let schema = WearScript::schema();
        let branches =
            schema.pointer("/$defs/Action/oneOf").and_then(Value::as_array).expect("a list of actions");
        assert_eq!(branches.len(), Action::NAMES.len());
        let examples = Action::examples();
        assert_eq!(examples.iter().map(Action::name).collect::<Vec<_>>(), Action::NAMES);
        for (example, branch) in examples.into_iter().zip(branches) {
            let name = example.name();
            assert!(branch.pointer(&format!("/properties/{name}")).is_some(), "{name} is not in the schema");
            let before = WearScript::new("round trip", vec![example]).expect(name);
            let after = WearScript::parse("w.json", &before.to_json()).expect(name);
            assert_eq!(after, before);
            // Every field of an example differs from its default, so a lost field would show.
            assert!(after.to_json().contains(&format!("\"{name}\"")));
        }
    }

    #[test]
    fn every_field_of_every_action_is_explained_in_the_schema() {
        let schema = WearScript::schema();
        for name in Action::NAMES {
            let variant = format!("{}{}", name[..1].to_uppercase(), &name[1..]);
            let of_action = schema.pointer(&format!("/$defs/{variant}")).expect(name);
            let fields = of_action.get("properties").and_then(Value::as_object).into_iter().flatten();
            for (field, of_field) in fields {
                assert!(of_field.get("description").is_some(), "{name}.{field} has no description");
            }
        }
    }

    #[test]
    fn the_guide_names_every_action_and_field() {
        let guide = include_str!("../../../docs/guide/wear-scripts.md");
        for example in Action::examples() {
            let name = example.name();
            assert!(guide.contains(&format!("| `{name}` |")), "docs/guide/wear-scripts.md lacks {name}");
            let value = serde_json::to_value(&example).expect("plain data");
            for field in
                value.get(name).and_then(Value::as_object).into_iter().flatten().map(|(field, _)| field)
            {
                assert!(
                    guide.contains(&format!("`{field}`")),
                    "docs/guide/wear-scripts.md lacks {name}.{field}"
                );
            }
        }
        assert!(
            guide.contains(FOLD_THRICE.trim()),
            "the script in docs/guide/wear-scripts.md is not the one that comes along"
        );
    }

    #[test]
    fn defaults_are_as_the_schema_says() {
        let line = r#""line": [[0.5, 0], [0.5, 1]], "side": "left""#;
        let text = script(&format!(
            r#"{{"lay": {{}}}}, {{"fold": {{{line}}}}}, {{"unfold": {{}}}}, {{"settle": {{}}}}, {{"hang": {{}}}},
               {{"crumple": {{"to": 0.3}}}}, {{"bend": {{"joint": "elbow", "axis": "z", "angle": 90}}}},
               {{"play": {{"clip": "walk"}}}}, {{"iron": {{}}}}, {{"pack": {{}}}}, {{"wash": {{}}}}, {{"roll": {{}}}}, {{"pack": {{"how": "roll"}}}}"#
        ));
        let script = WearScript::parse("w.json", &text).expect("is valid");
        assert_eq!(
            script.duration(),
            2.0 + 2.0 + 2.0 + 3.0 + 5.0 + 3.0 + 2.0 + 10.0 + 14_412.0 + 10_813.5 + 4.0 + 14_412.0
        );
        assert!(
            matches!(&script.actions[1], Action::Fold(fold) if fold.angle_deg == 180.0 && fold.hold_s == 0.0)
        );
    }

    #[test]
    fn a_misspelt_action_is_located_and_the_meant_one_named() {
        let found = errors_of("{\"format\": \"crease-wear/1\",\n \"actions\": [\n  {\"fodl\": {}}]}");
        assert_eq!(found.len(), 1);
        assert_eq!(
            found[0],
            "w.json: line 3, column 4, at actions[0].fodl: unknown name `fodl` (did you mean `fold`? allowed here: \
             `lay`, `fold`, `roll`, `unfold`, `press`, `hold`, `settle`, `hang`, `crumple`, `iron`, `pack`, `wash`, `release`, `bend`, `play`, `repeat`)"
        );
    }

    #[test]
    fn all_errors_are_reported_at_once() {
        let text = script(
            r#"{"fold": {"line": [[0.3, 0], [0.3, 1]], "side": "left", "angel": 90}},
               {"fold": {"line": [[0.3, 0], [0.3]], "side": "top", "angle": 200}},
               {"hold": {"for": 0}}, {"press": {"for": 5}}, "release",
               {"repeat": {"times": 0, "actions": [{"hold": {"for": "long"}}]}}"#,
        );
        let found = errors_of(&text);
        let expected = [
            "actions[0].fold.angel: unknown name",
            "actions[1].fold.line[1]: has 1 entry, expected a list of 2 numbers",
            "actions[1].fold.side: is `top`, expected `left`, `right`, `upper` or `lower`",
            "actions[1].fold.angle: is 200, expected a number above 0 and at most 180",
            "actions[2].hold.for: is 0, expected a number above 0",
            "actions[3].press: `pressure` is missing",
            "actions[4]: is the text `release`, expected an object with exactly one name",
            "actions[5].repeat.times: is 0, expected a whole number from 1 to 10000",
            "actions[5].repeat.actions[0].hold.for: is the text `long`, expected a number",
        ];
        assert_eq!(found.len(), expected.len(), "{found:#?}");
        for (error, expected) in found.iter().zip(expected) {
            assert!(error.contains(expected), "{error}\nlacks\n{expected}");
            assert!(error.starts_with("w.json: line "), "{error}");
        }
    }

    #[test]
    fn fields_that_contradict_each_other_are_errors_too() {
        let cases = [
            (r#"{"fold": {"line": [[0.3, 0.2], [0.3, 0.2]], "side": "left"}}"#, "fold.line: the two points"),
            (
                r#"{"fold": {"line": [[0, 0.2], [1, 0.2]], "side": "left"}}"#,
                "fold.side: a level line has no left",
            ),
            (
                r#"{"fold": {"line": [[0.2, 0], [0.2, 1]], "side": "upper"}}"#,
                "fold.side: an upright line has no upper",
            ),
            (r#"{"unfold": {"all": true, "last": 2}}"#, "unfold.last: `all` and `last`"),
            (r#"{"unfold": {"all": false}}"#, "unfold.all: `all` is false"),
            (r#"{"bend": {"joint": "j", "axis": [0, 0, 0], "angle": 20}}"#, "bend.axis: the axis has no"),
            (r#"{"bend": {"joint": "j", "axis": "x", "angle": 0}}"#, "bend.angle: an angle of 0"),
            (
                r#"{"iron": {"box": [[0, 0], [1, 1]], "line": [[0, 0], [1, 1]]}}"#,
                "iron.line: `box` and `line`",
            ),
            (r#"{"iron": {"box": [[0, 0.5], [1, 0.5]]}}"#, "iron.box: the box has no area"),
            (r#"{"iron": {"line": [[0, 0.5], [0, 0.5]]}}"#, "iron.line: the two ends"),
        ];
        let all = cases.map(|(action, _)| action).join(", ");
        let found = errors_of(&script(&all));
        assert_eq!(found.len(), cases.len(), "{found:#?}");
        for ((index, (_, expected)), error) in cases.iter().enumerate().zip(&found) {
            assert!(error.contains(&format!("at actions[{index}].{expected}")), "{error}");
        }
    }

    #[test]
    fn choices_between_kinds_are_explained() {
        assert!(
            errors_of(&script(r#"{"hang": {"by": "botom"}}"#))[0]
                .contains("by: is `botom`, expected `top`, `hanger` or `hook`")
        );
        let by = &errors_of(&script(r#"{"hang": {"by": [[0.5, 1, 2]]}}"#))[0];
        assert!(by.contains("by[0]: has 3 entries"), "{by}");
        assert!(errors_of(&script(r#"{"hang": {"by": []}}"#))[0].contains("by: has 0 entries"));
        assert!(
            errors_of(&script(r#"{"hang": {"by": 3}}"#))[0]
                .contains("by: is 3, expected `top`, `hanger` or `hook` or a list")
        );
        let axis = &errors_of(&script(r#"{"bend": {"joint": "j", "axis": "w", "angle": 9}}"#))[0];
        assert!(axis.contains("axis: is `w`, expected `x`, `y` or `z`"), "{axis}");
    }

    #[test]
    fn another_format_is_named() {
        let found = errors_of(r#"{"format": "crease-wear/2", "actions": [{"release": {}}]}"#);
        assert!(found[0].contains("at format: is `crease-wear/2`, expected `crease-wear/1`"), "{}", found[0]);
        assert!(errors_of("{}")[0].contains("`format` is missing: `crease-wear/1`"));
        assert!(errors_of("[]")[0].contains("is a list, expected an object"));
        assert!(
            errors_of(&script(""))[0].contains("actions: has 0 entries, expected a list of at least one")
        );
    }

    #[test]
    fn repeats_are_written_out_in_order() {
        let text = script(
            r#"{"repeat": {"times": 2, "actions": [{"hold": {"for": 1}},
                {"repeat": {"times": 3, "actions": [{"settle": {"for": 2}}]}}]}}, {"release": {}}"#,
        );
        let script = WearScript::parse("w.json", &text).expect("is valid");
        let names: Vec<_> = script.flatten().map(|action| action.name()).collect();
        assert_eq!(
            names,
            ["hold", "settle", "settle", "settle", "hold", "settle", "settle", "settle", "release"]
        );
        assert_eq!(script.action_count(), 9);
        assert_eq!(script.duration(), 14.0);
    }

    #[test]
    fn actions_that_consist_of_others_are_written_out() {
        let text =
            script(r#"{"repeat": {"times": 2, "actions": [{"wash": {}}]}}, {"lay": {}}, {"pack": {}}"#);
        let script = WearScript::parse("w.json", &text).expect("is valid");
        let actions: Vec<_> = script.flatten().collect();
        let names: Vec<_> = actions.iter().map(|action| action.name()).collect();
        assert_eq!(names, ["crumple", "hang", "crumple", "hang", "lay", "fold", "fold", "fold", "press"]);
        assert_eq!(script.action_count(), names.len() as u64);
        let total: f64 = actions.iter().map(|action| action.as_wear_action().duration()).sum();
        assert!((total - script.duration()).abs() < 1e-9);
    }

    #[test]
    fn runaway_repeats_are_refused() {
        let nested = |depth: usize, times: u32, inner: &str| {
            (0..depth).fold(inner.to_owned(), |inner, _| {
                format!(r#"{{"repeat": {{"times": {times}, "actions": [{inner}]}}}}"#)
            })
        };
        assert!(WearScript::parse("w.json", &script(&nested(8, 2, r#"{"release": {}}"#))).is_ok());
        assert!(errors_of(&script(&nested(9, 2, r#"{"release": {}}"#)))[0].contains("more than 8 deep"));
        // Times multiply beyond 64 bits, and must not wrap.
        assert!(
            errors_of(&script(&nested(8, 10_000, r#"{"release": {}}"#)))[0].contains("actions with repeats")
        );
        assert!(errors_of(&script(&nested(2, 300, r#"{"hold": {"for": 1}}"#)))[0].contains("takes 90000 s"));
        assert!(errors_of(&script(&nested(1, 10_001, r#"{"release": {}}"#)))[0].contains("from 1 to 10000"));
        assert!(errors_of(&script(&nested(30, 1, r#"{"release": {}}"#))).iter().any(|f| f.contains("deep")));
        assert!(errors_of(&script(&nested(1000, 1, r#"{"release": {}}"#)))[0].contains("recursion limit"));
    }

    #[test]
    fn empty_repeats_of_a_program_do_not_hang() {
        let empty =
            (0..8).fold(Vec::new(), |actions, _| vec![Action::Repeat(Repeat { times: 10_000, actions })]);
        let script = WearScript { format: WearFormat::V1, name: String::new(), actions: empty };
        assert_eq!(script.flatten().count(), 0);
    }

    #[test]
    fn scripts_made_by_programs_are_checked_too() {
        let bad = WearScript::new(
            "bad",
            vec![Action::Hold(Hold { for_s: f64::NAN }), Action::Hold(Hold { for_s: -1.0 })],
        );
        let Err(Error::Input(errors)) = bad else { panic!("accepted") };
        assert_eq!(errors.len(), 2);
        assert_eq!(errors[1].location, "actions[1].hold.for");
    }

    #[test]
    fn actions_of_a_body_are_found_within_repeats() {
        let actions =
            r#"{"hold": {"for": 1}}, {"repeat": {"times": 2, "actions": [{"play": {"clip": "walk"}}]}}"#;
        let script = WearScript::parse("w.json", &script(actions)).expect("is valid");
        let errors = script.errors_without_body("w.json");
        assert_eq!(errors.len(), 1);
        assert_eq!(errors[0].location, "actions[1].repeat.actions[0]");
        assert!(script.actions[1].as_wear_action().needs_body());
    }

    #[test]
    fn damaged_scripts_never_panic() {
        for at in 0..FOLD_THRICE.len() {
            for bit in 0..8 {
                let mut bytes = FOLD_THRICE.as_bytes().to_vec();
                bytes[at] ^= 1 << bit;
                let _ = WearScript::parse("w.json", &String::from_utf8_lossy(&bytes));
            }
            let _ = WearScript::parse("w.json", &FOLD_THRICE[..at]);
        }
        assert!(Hold::example().validate().is_empty());
    }
}
