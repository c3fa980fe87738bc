//! Order of the actions of a script: what needs a garment that lies comes after `lay`.

use crate::wear::action_runner::NeededPlace;
use crate::wear::script::action_list::Action;
use crate::wear::script::{WearScript, visit_actions};
use crease_model::error::Diagnostic;
use crease_model::json::Path;

/// Where the garment is between two actions, as far as the script tells.
#[derive(Debug, Clone, Copy, Default)]
struct ScriptedPlace {
    /// Whether it lies on the ground or fell there.
    is_on_ground: bool,
    /// Whether it lies as it was laid.
    lies: bool,
    /// Whether it is rolled up.
    is_rolled: bool,
}

impl ScriptedPlace {
    /// What `action` needs and does not find.
    fn missing(self, action: &Action) -> Option<NeededPlace> {
        let (needed, found) = match action {
            Action::Press(_) => (NeededPlace::OnGround, self.is_on_ground),
            Action::Iron(_) => (NeededPlace::Lying, self.lies),
            Action::Fold(_) | Action::Roll(_) | Action::Pack(_) => {
                (NeededPlace::Open, self.lies && !self.is_rolled)
            }
            _ => return None,
        };
        (!found).then_some(needed)
    }

    /// The place after `action`.
    fn after(self, action: &Action) -> Self {
        match action {
            Action::Lay(_) => Self { is_on_ground: true, lies: true, is_rolled: false },
            Action::Hang(_) | Action::Wash(_) => Self::default(),
            Action::Release(_) => Self { is_on_ground: true, ..self },
            Action::Roll(_) => Self { is_rolled: true, ..self },
            Action::Unfold(_) | Action::Crumple(_) => Self { is_rolled: false, ..self },
            _ => self,
        }
    }
}

impl WearScript {
    /// One error per action that needs a garment that lies where no `lay` comes before it. A repeat counts with its first repetition.
    pub fn order_errors(&self, file: &str) -> Vec<Diagnostic> {
        let (mut place, mut errors) = (ScriptedPlace::default(), Vec::new());
        visit_actions(&self.actions, &Path::root().name("actions"), 0, &mut |action, path, _| {
            if let Some(needed) = place.missing(action) {
                let (message, help) = needed.fault(action.name());
                errors.push(Diagnostic::new(file, path.to_string(), message, help));
            }
            place = place.after(action);
        });
        errors
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn errors(actions: &str) -> Vec<String> {
        let text = format!(r#"{{"format": "crease-wear/1", "name": "", "actions": [{actions}]}}"#);
        let script = WearScript::parse("wear.json", &text).expect("is a script");
        script.order_errors("wear.json").iter().map(ToString::to_string).collect()
    }

    #[test]
    fn what_needs_a_garment_that_lies_comes_after_lay() {
        const FOLD: &str = r#"{"fold": {"line": [[0.5, 0], [0.5, 1]], "side": "left"}}"#;
        for (before, count) in [
            ("", 1),
            (r#"{"lay": {}},"#, 0),
            (r#"{"lay": {}}, {"hang": {}},"#, 1),
            (r#"{"lay": {}}, {"hang": {}}, {"release": {}},"#, 1),
            (r#"{"lay": {}}, {"roll": {}},"#, 1),
            (r#"{"lay": {}}, {"roll": {}}, {"unfold": {}},"#, 0),
            (r#"{"lay": {}}, {"wash": {}}, {"lay": {}},"#, 0),
        ] {
            let found = errors(&format!("{before} {FOLD}"));
            assert_eq!(found.len(), count, "{before}: {found:?}");
        }
        let press = r#"{"press": {"pressure": 100, "for": 1}}"#;
        assert!(errors(&format!(r#"{{"hang": {{}}}}, {{"release": {{}}}}, {press}"#)).is_empty());
        let nested = format!(r#"{{"repeat": {{"times": 2, "actions": [{press}]}}}}"#);
        let found = errors(&nested);
        assert!(
            found.len() == 1 && found[0].contains("actions[0].repeat.actions[0]") && found[0].contains("lay"),
            "{found:?}"
        );
    }
}
