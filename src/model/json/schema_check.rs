//! Validates a value against a derived JSON Schema and reports violations in words.
//!
//! Understands the keywords that schemars writes for the types of this crate: `$ref`, `type`, `properties`, `required`,
//! `additionalProperties: false`, `items`, item and number limits, `const`, `enum`, and `oneOf` / `anyOf` as unit
//! enums, as externally tagged enums (`{"fold": {...}}`) and as options. Other keywords are ignored: serde decides last.

use crate::error::Diagnostic;
use crate::json::document::{Document, MAX_DIAGNOSTICS};
use crate::json::quoted::quoted;
use crate::json::spans::{Path, Segment};
use crate::json::suggest::nearest;
use serde_json::Value;

/// Consecutive references after which a schema is taken to be cyclic.
const MAX_REFERENCES: usize = 16;

impl Document {
    /// Returns all violations of `schema`, in file order; none for a valid document. Beyond a limit they are counted.
    pub fn validate(&self, schema: &Value) -> Vec<Diagnostic> {
        let mut check = Check::new(self, schema, Path::root());
        check.value(schema, self.value());
        let Check { mut diagnostics, omitted, .. } = check;
        if omitted > 0 {
            let message = format!("and {omitted} more errors");
            diagnostics.push(self.diagnostic(&Path::root(), message, "correct these first"));
        }
        diagnostics
    }
}

/// State of a validation.
struct Check<'a> {
    document: &'a Document,
    root: &'a Value,
    path: Path,
    diagnostics: Vec<Diagnostic>,
    omitted: usize,
    /// Description of the list around a value: entries seldom have their own.
    list_purpose: String,
}

impl<'a> Check<'a> {
    fn new(document: &'a Document, root: &'a Value, path: Path) -> Self {
        Self { document, root, path, diagnostics: Vec::new(), omitted: 0, list_purpose: String::new() }
    }

    fn value(&mut self, schema: &'a Value, value: &Value) {
        let resolved = self.resolve(schema);
        if let Some(branches) = branches(resolved) {
            return self.choice(schema, branches, value);
        }
        if let Some(words) = words(resolved) {
            return self.word(schema, &words, value);
        }
        if !matches_type(resolved, value) {
            return self.unexpected(schema, value);
        }
        match value {
            Value::Number(number) if !in_range(resolved, number.as_f64().unwrap_or(f64::NAN)) => {
                self.unexpected(schema, value);
            }
            Value::Array(entries) => self.list(schema, resolved, entries),
            Value::Object(members) => self.object(resolved, members),
            Value::String(text)
                if (text.chars().count() as u64) < limit(resolved, "minLength").unwrap_or(0) =>
            {
                self.unexpected(schema, value);
            }
            _ => {}
        }
    }

    fn list(&mut self, schema: &'a Value, resolved: &'a Value, entries: &[Value]) {
        let count = entries.len() as u64;
        let too_few = limit(resolved, "minItems").is_some_and(|min| count < min);
        let too_many = limit(resolved, "maxItems").is_some_and(|max| count > max);
        if too_few || too_many {
            let noun = if count == 1 { "entry" } else { "entries" };
            let message = format!("has {count} {noun}, expected {}", self.expected(schema));
            return self.report(message, self.purpose(schema));
        }
        let Some(items) = resolved.get("items") else { return };
        let purpose = self.purpose(schema);
        let outer = std::mem::replace(&mut self.list_purpose, purpose);
        for (index, entry) in entries.iter().enumerate() {
            self.within(Segment::Entry(index), |check| check.value(items, entry));
        }
        self.list_purpose = outer;
    }

    fn object(&mut self, resolved: &'a Value, members: &serde_json::Map<String, Value>) {
        let properties = resolved.get("properties").and_then(Value::as_object);
        let closed = resolved.get("additionalProperties") == Some(&Value::Bool(false));
        for (name, member) in members {
            match properties.and_then(|p| p.get(name)) {
                Some(schema) => self.within(Segment::Name(name.clone()), |check| check.value(schema, member)),
                None if closed => {
                    let allowed = properties.into_iter().flat_map(|p| p.keys().map(String::as_str)).collect();
                    self.unknown_name(name, allowed);
                }
                None => {}
            }
        }
        let required = resolved.get("required").and_then(Value::as_array).into_iter().flatten();
        for name in required.filter_map(Value::as_str).filter(|name| !members.contains_key(*name)) {
            let schema = properties.and_then(|p| p.get(name)).unwrap_or(&Value::Null);
            let message = format!("`{name}` is missing: {}", self.expected(schema));
            self.report(message, self.purpose(schema));
        }
    }

    fn unknown_name(&mut self, name: &str, allowed: Vec<&str>) {
        let list = allowed.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        let message = format!("unknown name {}", quoted(name));
        let help = match nearest(name, allowed.iter().copied()) {
            Some(meant) => format!("did you mean `{meant}`? allowed here: {list}"),
            None if allowed.is_empty() => "nothing is allowed here: write {}".to_owned(),
            None => format!("allowed here: {list}"),
        };
        self.within(Segment::Name(name.to_owned()), |check| {
            let diagnostic = check.document.diagnostic_of_name(&check.path, message, help.into());
            check.add(diagnostic);
        });
    }

    fn word(&mut self, schema: &'a Value, words: &[&str], value: &Value) {
        match value.as_str() {
            Some(word) if words.contains(&word) => {}
            Some(word) => {
                let message = format!("is {}, expected {}", quoted(word), self.expected(schema));
                let help =
                    nearest(word, words.iter().copied()).map(|meant| format!("did you mean `{meant}`?"));
                self.report(message, help.unwrap_or_else(|| self.purpose(schema)));
            }
            None => self.unexpected(schema, value),
        }
    }

    fn choice(&mut self, schema: &'a Value, branches: &'a [Value], value: &Value) {
        if let Some(tags) = tags(branches) {
            return self.tagged(&tags, value);
        }
        if let Some(words) = branches.iter().map(constant).collect::<Option<Vec<_>>>() {
            return self.word(schema, &words, value);
        }
        if branches.iter().any(|branch| self.is_valid(branch, value)) {
            return;
        }
        let same_kind = branches.iter().find(|branch| self.matches_kind(branch, value));
        match same_kind {
            Some(branch) => self.value(branch, value),
            None => self.unexpected(schema, value),
        }
    }

    /// Checks an enum written `{"fold": {...}}`: exactly one member, whose name is the variant.
    fn tagged(&mut self, tags: &[(&'a str, &'a Value)], value: &Value) {
        let allowed: Vec<&str> = tags.iter().map(|(name, _)| *name).collect();
        let Some(members) = value.as_object().filter(|members| members.len() == 1) else {
            let list = allowed.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
            let message = match value {
                Value::Object(members) => format!("has {} names, expected exactly one", members.len()),
                other => format!("is {}, expected an object with exactly one name", shown(other)),
            };
            return self.report(message, format!("write {{\"NAME\": {{...}}}} with one of {list}"));
        };
        for (name, member) in members {
            match tags.iter().find(|(tag, _)| tag == name) {
                Some((_, schema)) => {
                    self.within(Segment::Name(name.clone()), |check| check.value(schema, member))
                }
                None => self.unknown_name(name, allowed.clone()),
            }
        }
    }

    fn is_valid(&self, schema: &'a Value, value: &Value) -> bool {
        let mut trial = Check::new(self.document, self.root, self.path.clone());
        trial.value(schema, value);
        trial.diagnostics.is_empty()
    }

    /// Returns whether `value` has the type (text, list, ...) that `schema` asks for.
    fn matches_kind(&self, schema: &'a Value, value: &Value) -> bool {
        let resolved = self.resolve(schema);
        match branches(resolved) {
            Some(branches) => branches.iter().any(|branch| self.matches_kind(branch, value)),
            None => matches_type(resolved, value),
        }
    }

    fn unexpected(&mut self, schema: &'a Value, value: &Value) {
        let message = format!("is {}, expected {}", shown(value), self.expected(schema));
        self.report(message, self.purpose(schema));
    }

    fn report(&mut self, message: String, help: String) {
        let diagnostic = self.document.diagnostic(&self.path, message, help);
        self.add(diagnostic);
    }

    fn add(&mut self, diagnostic: Diagnostic) {
        if self.diagnostics.len() < MAX_DIAGNOSTICS {
            self.diagnostics.push(diagnostic);
        } else {
            self.omitted += 1;
        }
    }

    fn within(&mut self, segment: Segment, visit: impl FnOnce(&mut Self)) {
        self.path.push(segment);
        visit(self);
        self.path.pop();
    }

    fn resolve(&self, schema: &'a Value) -> &'a Value {
        let mut at = schema;
        for _ in 0..MAX_REFERENCES {
            let Some(reference) = at.get("$ref").and_then(Value::as_str) else { break };
            match reference.strip_prefix('#').and_then(|pointer| self.root.pointer(pointer)) {
                Some(target) => at = target,
                None => break,
            }
        }
        at
    }

    /// Returns the first sentence of the description of a value.
    fn purpose(&self, schema: &'a Value) -> String {
        let described = schema.get("description").or_else(|| self.resolve(schema).get("description"));
        let Some(text) = described.and_then(Value::as_str) else { return self.list_purpose.clone() };
        let line = text.lines().next().unwrap_or("");
        match line.find(". ") {
            Some(end) => line.get(..=end).unwrap_or(line).to_owned(),
            None => line.to_owned(),
        }
    }

    /// Describes in words the values that `schema` allows.
    fn expected(&self, schema: &'a Value) -> String {
        let resolved = self.resolve(schema);
        if let Some(branches) = branches(resolved) {
            if tags(branches).is_some() {
                return "an object with exactly one name".to_owned();
            }
            let of_branch = |branch| match constant(branch) {
                Some(word) => format!("`{word}`"),
                None => self.expected(branch),
            };
            return joined(branches.iter().filter(|b| !is_null(b)).map(of_branch).collect());
        }
        if let Some(words) = words(resolved) {
            return joined(words.iter().map(|word| format!("`{word}`")).collect());
        }
        match kinds(resolved).find(|kind| *kind != "null") {
            Some("boolean") => "true or false".to_owned(),
            Some("integer") => format!("a whole number{}", range_in_words(resolved)),
            Some("number") => format!("a number{}", range_in_words(resolved)),
            Some("string") if limit(resolved, "minLength").is_some() => "a text that is not empty".to_owned(),
            Some("string") => "a text".to_owned(),
            Some("object") => "an object {...}".to_owned(),
            Some("array") => self.expected_list(resolved),
            _ => "something else".to_owned(),
        }
    }

    fn expected_list(&self, resolved: &'a Value) -> String {
        let (min, max) = (limit(resolved, "minItems"), limit(resolved, "maxItems"));
        let count = match (min, max) {
            (Some(a), Some(b)) if a == b => format!(" of {a}"),
            (Some(1), None) => " of at least one".to_owned(),
            _ => " of".to_owned(),
        };
        let entry = resolved.get("items").map(|items| self.resolve(items)).unwrap_or(&Value::Null);
        match kinds(entry).next() {
            Some("number" | "integer") => format!("a list{count} numbers"),
            Some("array") => {
                let inner = self.expected_list(entry).replacen("a list", "lists", 1);
                format!("a list{count} {inner}")
            }
            _ => format!("a list{count} entries"),
        }
    }
}

fn branches(schema: &Value) -> Option<&[Value]> {
    let list = schema.get("oneOf").or_else(|| schema.get("anyOf"))?;
    list.as_array().map(Vec::as_slice)
}

/// Returns name and schema of each branch, if every branch is an object with exactly one required member.
fn tags(branches: &[Value]) -> Option<Vec<(&str, &Value)>> {
    branches
        .iter()
        .map(|branch| match branch.get("required").and_then(Value::as_array).map(Vec::as_slice) {
            Some([Value::String(name)]) => Some((name.as_str(), branch.get("properties")?.get(name)?)),
            _ => None,
        })
        .collect()
}

fn constant(branch: &Value) -> Option<&str> {
    branch.get("const").and_then(Value::as_str)
}

fn words(schema: &Value) -> Option<Vec<&str>> {
    match schema.get("enum").and_then(Value::as_array) {
        Some(list) => list.iter().map(Value::as_str).collect(),
        None => constant(schema).map(|word| vec![word]),
    }
}

fn kinds(schema: &Value) -> impl Iterator<Item = &str> {
    let kinds = schema.get("type");
    let list = kinds.and_then(Value::as_array).into_iter().flatten().filter_map(Value::as_str);
    kinds.and_then(Value::as_str).into_iter().chain(list)
}

fn is_null(schema: &Value) -> bool {
    schema.get("type").and_then(Value::as_str) == Some("null")
}

fn matches_type(schema: &Value, value: &Value) -> bool {
    let mut has_kinds = false;
    for kind in kinds(schema) {
        has_kinds = true;
        let matches = match kind {
            "null" => value.is_null(),
            "boolean" => value.is_boolean(),
            "integer" => value.is_u64() || value.is_i64(),
            "number" => value.is_number(),
            "string" => value.is_string(),
            "array" => value.is_array(),
            "object" => value.is_object(),
            _ => true,
        };
        if matches {
            return true;
        }
    }
    !has_kinds
}

fn in_range(schema: &Value, x: f64) -> bool {
    let of = |name: &str| schema.get(name).and_then(Value::as_f64);
    of("minimum").is_none_or(|min| x >= min)
        && of("maximum").is_none_or(|max| x <= max)
        && of("exclusiveMinimum").is_none_or(|min| x > min)
        && of("exclusiveMaximum").is_none_or(|max| x < max)
}

fn range_in_words(schema: &Value) -> String {
    let of = |name: &str| schema.get(name).and_then(Value::as_f64);
    let low = of("exclusiveMinimum").map(|x| format!("above {x}"));
    let high = of("exclusiveMaximum").map(|x| format!("below {x}"));
    match (of("minimum"), of("maximum"), low, high) {
        (Some(a), Some(b), None, None) => format!(" from {a} to {b}"),
        (Some(a), None, None, None) => format!(" of at least {a}"),
        (min, max, low, high) => {
            let low = low.or_else(|| min.map(|x| format!("at least {x}")));
            let high = high.or_else(|| max.map(|x| format!("at most {x}")));
            match (low, high) {
                (Some(low), Some(high)) => format!(" {low} and {high}"),
                (Some(one), None) | (None, Some(one)) => format!(" {one}"),
                (None, None) => String::new(),
            }
        }
    }
}

fn limit(schema: &Value, name: &str) -> Option<u64> {
    schema.get(name).and_then(Value::as_u64)
}

fn shown(value: &Value) -> String {
    match value {
        Value::Null => "null".to_owned(),
        Value::String(text) => format!("the text {}", quoted(text)),
        Value::Array(_) => "a list".to_owned(),
        Value::Object(_) => "an object".to_owned(),
        Value::Bool(_) | Value::Number(_) => value.to_string(),
    }
}

fn joined(mut list: Vec<String>) -> String {
    match list.pop() {
        Some(last) if list.is_empty() => last,
        Some(last) => format!("{} or {last}", list.join(", ")),
        None => "nothing".to_owned(),
    }
}
