//! Checks a value against a derived JSON Schema and says in words what does not suit.
//!
//! Understands what schemars writes for the types of this crate: `$ref`, `type`, `properties`, `required`,
//! `additionalProperties: false`, `items`, item and number limits, `const`, `enum`, and `oneOf` / `anyOf` as unit
//! enums, as externally tagged enums (`{"fold": {...}}`) and as options. Other words of the language are ignored:
//! serde still has the last say.

use crate::error::Diagnostic;
use crate::json::{Document, FAULT_LIMIT, Path, Segment, nearest, quoted};
use serde_json::Value;

/// References followed one after the other before a schema is taken to go in circles.
const REFERENCE_LIMIT: usize = 16;

pub(super) fn faults(document: &Document, schema: &Value) -> Vec<Diagnostic> {
    let mut check = Check::new(document, schema, Path::root());
    check.value(schema, &document.value);
    let Check { mut faults, left_out, .. } = check;
    if left_out > 0 {
        faults.push(document.diagnostic(
            &Path::root(),
            format!("and {left_out} more faults"),
            "mend these first",
        ));
    }
    faults
}

struct Check<'a> {
    document: &'a Document,
    root: &'a Value,
    path: Path,
    faults: Vec<Diagnostic>,
    left_out: usize,
    /// What the list around a value is for: entries seldom say it themselves.
    list_purpose: String,
}

impl<'a> Check<'a> {
    fn new(document: &'a Document, root: &'a Value, path: Path) -> Self {
        Self { document, root, path, faults: Vec::new(), left_out: 0, list_purpose: String::new() }
    }

    fn value(&mut self, schema: &'a Value, value: &Value) {
        let resolved = self.resolve(schema);
        if let Some(branches) = branches(resolved) {
            return self.choice(schema, branches, value);
        }
        if let Some(words) = words(resolved) {
            return self.word(schema, &words, value);
        }
        if !suits_type(resolved, value) {
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
        let too_few = limit(resolved, "minItems").is_some_and(|least| count < least);
        let too_many = limit(resolved, "maxItems").is_some_and(|most| count > most);
        if too_few || too_many {
            let noun = if count == 1 { "entry" } else { "entries" };
            let what = format!("has {count} {noun}, expected {}", self.expected(schema));
            return self.fault(what, self.purpose(schema));
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
            let what = format!("`{name}` is missing: {}", self.expected(schema));
            self.fault(what, self.purpose(schema));
        }
    }

    fn unknown_name(&mut self, name: &str, allowed: Vec<&str>) {
        let list = allowed.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
        let what = format!("unknown name {}", quoted(name));
        let cure = match nearest(name, allowed.iter().copied()) {
            Some(meant) => format!("did you mean `{meant}`? allowed here: {list}"),
            None if allowed.is_empty() => "nothing is allowed here: write {}".to_owned(),
            None => format!("allowed here: {list}"),
        };
        self.within(Segment::Name(name.to_owned()), |check| {
            let fault = check.document.diagnostic_of_name(&check.path, what, cure);
            check.add(fault);
        });
    }

    fn word(&mut self, schema: &'a Value, words: &[&str], value: &Value) {
        match value.as_str() {
            Some(word) if words.contains(&word) => {}
            Some(word) => {
                let what = format!("is {}, expected {}", quoted(word), self.expected(schema));
                let cure =
                    nearest(word, words.iter().copied()).map(|meant| format!("did you mean `{meant}`?"));
                self.fault(what, cure.unwrap_or_else(|| self.purpose(schema)));
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
        if branches.iter().any(|branch| self.suits(branch, value)) {
            return;
        }
        let same_kind = branches.iter().find(|branch| self.suits_kind(branch, value));
        match same_kind {
            Some(branch) => self.value(branch, value),
            None => self.unexpected(schema, value),
        }
    }

    /// An enum written `{"fold": {...}}`: exactly one member, whose name says which.
    fn tagged(&mut self, tags: &[(&'a str, &'a Value)], value: &Value) {
        let allowed: Vec<&str> = tags.iter().map(|(name, _)| *name).collect();
        let Some(members) = value.as_object().filter(|members| members.len() == 1) else {
            let list = allowed.iter().map(|name| format!("`{name}`")).collect::<Vec<_>>().join(", ");
            let what = match value {
                Value::Object(members) => format!("has {} names, expected exactly one", members.len()),
                other => format!("is {}, expected an object with exactly one name", shown(other)),
            };
            return self.fault(what, format!("write {{\"NAME\": {{...}}}} with one of {list}"));
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

    fn suits(&self, schema: &'a Value, value: &Value) -> bool {
        let mut trial = Check::new(self.document, self.root, self.path.clone());
        trial.value(schema, value);
        trial.faults.is_empty()
    }

    /// Whether `value` is at least the kind of thing (text, list, ...) that `schema` asks for.
    fn suits_kind(&self, schema: &'a Value, value: &Value) -> bool {
        let resolved = self.resolve(schema);
        match branches(resolved) {
            Some(branches) => branches.iter().any(|branch| self.suits_kind(branch, value)),
            None => suits_type(resolved, value),
        }
    }

    fn unexpected(&mut self, schema: &'a Value, value: &Value) {
        let what = format!("is {}, expected {}", shown(value), self.expected(schema));
        self.fault(what, self.purpose(schema));
    }

    fn fault(&mut self, what: String, cure: String) {
        let fault = self.document.diagnostic(&self.path, what, cure);
        self.add(fault);
    }

    fn add(&mut self, fault: Diagnostic) {
        if self.faults.len() < FAULT_LIMIT {
            self.faults.push(fault);
        } else {
            self.left_out += 1;
        }
    }

    fn within(&mut self, segment: Segment, look: impl FnOnce(&mut Self)) {
        self.path.push(segment);
        look(self);
        self.path.pop();
    }

    fn resolve(&self, schema: &'a Value) -> &'a Value {
        let mut at = schema;
        for _ in 0..REFERENCE_LIMIT {
            let Some(reference) = at.get("$ref").and_then(Value::as_str) else { break };
            match reference.strip_prefix('#').and_then(|pointer| self.root.pointer(pointer)) {
                Some(target) => at = target,
                None => break,
            }
        }
        at
    }

    /// The first sentence of what a value is for.
    fn purpose(&self, schema: &'a Value) -> String {
        let described = schema.get("description").or_else(|| self.resolve(schema).get("description"));
        let Some(text) = described.and_then(Value::as_str) else { return self.list_purpose.clone() };
        let line = text.lines().next().unwrap_or("");
        match line.find(". ") {
            Some(end) => line.get(..=end).unwrap_or(line).to_owned(),
            None => line.to_owned(),
        }
    }

    /// What `schema` asks for, in words.
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
        let (least, most) = (limit(resolved, "minItems"), limit(resolved, "maxItems"));
        let count = match (least, most) {
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

/// Name and schema of each branch, if every branch is an object with exactly one required member.
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

fn suits_type(schema: &Value, value: &Value) -> bool {
    let mut any = false;
    for kind in kinds(schema) {
        any = true;
        let suits = match kind {
            "null" => value.is_null(),
            "boolean" => value.is_boolean(),
            "integer" => value.is_u64() || value.is_i64(),
            "number" => value.is_number(),
            "string" => value.is_string(),
            "array" => value.is_array(),
            "object" => value.is_object(),
            _ => true,
        };
        if suits {
            return true;
        }
    }
    !any
}

fn in_range(schema: &Value, x: f64) -> bool {
    let of = |name: &str| schema.get(name).and_then(Value::as_f64);
    of("minimum").is_none_or(|least| x >= least)
        && of("maximum").is_none_or(|most| x <= most)
        && of("exclusiveMinimum").is_none_or(|least| x > least)
        && of("exclusiveMaximum").is_none_or(|most| x < most)
}

fn range_in_words(schema: &Value) -> String {
    let of = |name: &str| schema.get(name).and_then(Value::as_f64);
    let low = of("exclusiveMinimum").map(|x| format!("above {x}"));
    let high = of("exclusiveMaximum").map(|x| format!("below {x}"));
    match (of("minimum"), of("maximum"), low, high) {
        (Some(a), Some(b), None, None) => format!(" from {a} to {b}"),
        (Some(a), None, None, None) => format!(" of at least {a}"),
        (least, most, low, high) => {
            let low = low.or_else(|| least.map(|x| format!("at least {x}")));
            let high = high.or_else(|| most.map(|x| format!("at most {x}")));
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
