//! Value of the raw document with its path, so that every error names its location. A member may be missing, or of
//! another type than the specification says.

use crease_model::error::{Error, Message, Result};
use serde_json::Value;

/// Help for a damaged document.
const REPAIR_HELP: &str = "export the file again, or correct it at this location";

/// Value and its path, as in "meshes[0].primitives[1]".
#[derive(Clone)]
pub(super) struct Cursor<'a> {
    value: Option<&'a Value>,
    path: String,
}

impl<'a> Cursor<'a> {
    /// Returns the cursor of the whole document.
    pub(super) fn root(document: &'a Value) -> Self {
        Self { value: Some(document), path: String::new() }
    }

    /// Returns the path.
    pub(super) fn path(&self) -> &str {
        &self.path
    }

    /// Creates an error at this value.
    pub(super) fn error(&self, message: impl Into<Message>) -> Error {
        Error::input("glTF", self.path.clone(), message, REPAIR_HELP)
    }

    /// Returns whether there is such a value.
    pub(super) fn exists(&self) -> bool {
        self.value.is_some()
    }

    /// Returns the member `key`, which may not exist.
    pub(super) fn member(&self, key: &str) -> Self {
        let path = if self.path.is_empty() { key.to_owned() } else { format!("{}.{key}", self.path) };
        Self { value: self.value.and_then(|value| value.get(key)), path }
    }

    /// Returns the entry `index` of the list `key`, which may not exist.
    pub(super) fn entry(&self, key: &str, index: usize) -> Self {
        let list = self.member(key);
        let value = list.value.and_then(|value| value.get(index));
        Self { value, path: format!("{}[{index}]", list.path) }
    }

    /// Returns the entry `index` of the list `key`; fails with an error that names the user of the index.
    pub(super) fn required_entry(&self, key: &str, index: usize, user: &str) -> Result<Self> {
        let entry = self.entry(key, index);
        if entry.exists() {
            return Ok(entry);
        }
        Err(Error::input("glTF", user, format!("{key}[{index}] is not in the file"), REPAIR_HELP))
    }

    /// Returns the number of entries of the list `key`.
    pub(super) fn length(&self, key: &str) -> usize {
        self.member(key).value.and_then(Value::as_array).map_or(0, Vec::len)
    }

    /// Returns the entries of the list `key`.
    pub(super) fn entries(&self, key: &str) -> Vec<Self> {
        (0..self.length(key)).map(|index| self.entry(key, index)).collect()
    }

    /// Returns the names of the members, if there are any.
    pub(super) fn keys(&self) -> Vec<&'a str> {
        let object = self.value.and_then(Value::as_object);
        object.map(|object| object.keys().map(String::as_str).collect()).unwrap_or_default()
    }

    /// Returns the value if it is a text.
    pub(super) fn as_text(&self) -> Option<&'a str> {
        self.value.and_then(Value::as_str)
    }

    /// Returns the member `key` if it is a text.
    pub(super) fn text(&self, key: &str) -> Option<&'a str> {
        self.member(key).as_text()
    }

    /// Returns whether the value is a list.
    pub(super) fn is_list(&self) -> bool {
        self.value.is_some_and(Value::is_array)
    }

    /// Returns whether the value is an object.
    pub(super) fn is_object(&self) -> bool {
        self.value.is_some_and(Value::is_object)
    }

    /// Returns whether the value is `true`.
    pub(super) fn as_flag(&self) -> bool {
        self.value.and_then(Value::as_bool).unwrap_or(false)
    }

    /// Returns the value as a count or index.
    pub(super) fn as_index(&self) -> Result<Option<usize>> {
        let Some(value) = self.value else { return Ok(None) };
        // Some writers write 3.0 for 3.
        let whole = value.as_u64().or_else(|| {
            value.as_f64().filter(|x| x.fract() == 0.0 && (0.0..9e15).contains(x)).map(|x| x as u64)
        });
        match whole.and_then(|x| usize::try_from(x).ok()) {
            Some(index) => Ok(Some(index)),
            None => Err(self.error(format!("{value} is not an index or a count"))),
        }
    }

    /// Returns the count or index in the member `key`, if there is one.
    pub(super) fn index(&self, key: &str) -> Result<Option<usize>> {
        self.member(key).as_index()
    }

    /// Returns the count or index in the member `key`; fails if there is none.
    pub(super) fn required_index(&self, key: &str) -> Result<usize> {
        self.index(key)?.ok_or_else(|| self.error(format!("\"{key}\" is missing")))
    }

    /// Returns the list of indices `key`; empty if there is none.
    pub(super) fn indices(&self, key: &str) -> Result<Vec<usize>> {
        let read = |entry: Self| entry.as_index()?.ok_or_else(|| entry.error("is missing"));
        self.entries(key).into_iter().map(read).collect()
    }

    /// Returns the `N` numbers of the list `key`, if there is one.
    pub(super) fn numbers<const N: usize>(&self, key: &str) -> Result<Option<[f64; N]>> {
        let list = self.member(key);
        let Some(value) = list.value else { return Ok(None) };
        let read: Option<Vec<f64>> =
            value.as_array().and_then(|list| list.iter().map(Value::as_f64).collect());
        match read.and_then(|list| <[f64; N]>::try_from(list).ok()) {
            Some(numbers) if numbers.iter().all(|x| x.is_finite()) => Ok(Some(numbers)),
            _ => Err(list.error(format!("must be {N} numbers"))),
        }
    }

    /// Returns the finite numbers of the list `key`, 0 for other entries; empty if there is none.
    pub(super) fn number_list(&self, key: &str) -> Vec<f64> {
        let list = self.member(key).value.and_then(Value::as_array);
        let number = |x: &Value| x.as_f64().filter(|x| x.is_finite()).unwrap_or(0.0);
        list.map(|list| list.iter().map(number).collect()).unwrap_or_default()
    }
}
