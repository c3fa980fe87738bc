//! Layers of a stage by identifier: the files of USD that one file refers to, kept in memory.
//!
//! A layer is identified by its address relative to the folder of the first file. Files in a USDZ package are identified as if the
//! package were a folder. Every layer is checked here before the package that decodes it gets it ([`check_binary`], and the nesting
//! of text).

use crate::usd::reader::binary::{MAX_DEPTH, check_binary};
use crate::usd::reader::package::{is_layer_name, packaged_layers};
use crate::usd::signature::{BINARY_MAGIC, TEXT_MAGIC, is_package};
use rustc_hash::{FxHashMap, FxHashSet};
use std::sync::Arc;

/// Reason why a layer cannot be had.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct LayerFault {
    /// What is wrong with it.
    pub reason: String,
    /// Whether it could be had if its folder were allowed.
    pub can_be_allowed: bool,
}

impl From<String> for LayerFault {
    fn from(reason: String) -> Self {
        Self { reason, can_be_allowed: false }
    }
}

/// Layers in memory, and those that were asked for in vain.
#[derive(Debug, Default)]
pub(super) struct UsdLayers {
    contents: FxHashMap<String, Arc<[u8]>>,
    /// Package to the first layer in it, and address to the name of its layer where that is another.
    first_layers: FxHashMap<String, String>,
    /// Layers that were asked for and are not there.
    missing: Vec<String>,
    /// Reasons why layers cannot be had.
    failures: FxHashMap<String, LayerFault>,
}

impl UsdLayers {
    /// Adds the file `identifier` and returns the identifier of its layer: that of a package is its first.
    ///
    /// # Errors
    /// What is wrong with the file.
    pub(super) fn add(&mut self, identifier: &str, bytes: &[u8]) -> Result<String, String> {
        if !is_package(bytes) {
            check_layer(bytes)?;
            return Ok(self.keep(identifier, bytes));
        }
        let files = packaged_layers(bytes)?;
        let mut first = None;
        for file in files {
            let content = bytes.get(file.range).unwrap_or_default();
            check_layer(content).map_err(|message| format!("\"{}\" in it: {message}", file.name))?;
            let name = self.keep(&format!("{identifier}/{}", file.name), content);
            first.get_or_insert(name);
        }
        let first = first.ok_or("there is no USD file in the archive")?;
        self.first_layers.insert(identifier.to_owned(), first.clone());
        Ok(first)
    }

    /// Keeps a layer, under a name with the extension of its content, and returns that name.
    fn keep(&mut self, identifier: &str, bytes: &[u8]) -> String {
        let name = with_extension(identifier, bytes);
        if name != identifier {
            self.first_layers.insert(identifier.to_owned(), name.clone());
        }
        self.contents.insert(name.clone(), bytes.into());
        name
    }

    /// Notes why the layer `identifier` cannot be had.
    pub(super) fn fail(&mut self, identifier: String, fault: LayerFault) {
        self.failures.insert(identifier, fault);
    }

    /// Returns why a layer, or the package it is in, cannot be had, by the end of its address.
    pub(super) fn failure(&self, address: &str) -> Option<&LayerFault> {
        let name = joined("", address);
        let is_in = |known: &str| name.strip_prefix(known).is_some_and(|file| file.starts_with('/'));
        let is_it = |known: &&String| **known == name || known.ends_with(&format!("/{name}")) || is_in(known);
        let key = self.failures.keys().find(is_it)?;
        self.failures.get(key)
    }

    /// Takes the layers that were asked for and are not there, each once, without those that are known not to be had.
    pub(super) fn take_missing(&mut self) -> Vec<String> {
        let mut seen = FxHashSet::default();
        let mut missing = std::mem::take(&mut self.missing);
        missing.retain(|name| !self.failures.contains_key(name) && seen.insert(name.clone()));
        missing
    }

    /// Returns the identifier under which the layer `identifier` is kept, and notes it as missing otherwise.
    pub(super) fn find(&mut self, identifier: &str) -> Option<String> {
        if self.contents.contains_key(identifier) {
            return Some(identifier.to_owned());
        }
        if let Some(first) = self.first_layers.get(identifier) {
            return Some(first.clone());
        }
        // Of a file in a package that is not there the package is missing.
        let package = identifier.split_inclusive(".usdz/").next().and_then(|start| start.strip_suffix('/'));
        let package =
            package.filter(|package| package.ends_with(".usdz") && !self.first_layers.contains_key(*package));
        self.missing.push(package.unwrap_or(identifier).to_owned());
        None
    }

    /// Returns the content of a layer.
    pub(super) fn content(&self, identifier: &str) -> Option<Arc<[u8]>> {
        self.contents.get(identifier).cloned()
    }

    /// Returns the bytes of all layers together.
    pub(super) fn byte_count(&self) -> usize {
        self.contents.values().map(|content| content.len()).sum()
    }
}

/// Returns the identifier of the layer at `address` in the layer `anchor`.
pub(super) fn joined(anchor: &str, address: &str) -> String {
    // A file in a package is "package.usdz[folder/file.usda]".
    let address = address.replace(['\\', '['], "/").replace(']', "");
    if address.starts_with('/') || address.contains("://") || address.get(1..3) == Some(":/") {
        return address;
    }
    let folder = anchor.rsplit_once('/').map_or("", |(folder, _)| folder);
    let mut parts: Vec<&str> = Vec::new();
    for part in folder.split('/').chain(address.split('/')) {
        match part {
            "" | "." => {}
            ".." if parts.last().is_some_and(|last| *last != "..") => drop(parts.pop()),
            part => parts.push(part),
        }
    }
    parts.join("/")
}

/// Returns `identifier` with an extension that names the format of its content.
fn with_extension(identifier: &str, bytes: &[u8]) -> String {
    let is_binary = bytes.starts_with(BINARY_MAGIC);
    let named = identifier.rsplit_once('.').map_or("", |(_, extension)| extension).to_ascii_lowercase();
    let fits = named == "usd" || named == if is_binary { "usdc" } else { "usda" };
    match (fits && is_layer_name(identifier), is_binary) {
        (true, _) => identifier.to_owned(),
        (false, true) => format!("{identifier}.usdc"),
        (false, false) => format!("{identifier}.usda"),
    }
}

fn check_layer(bytes: &[u8]) -> Result<(), String> {
    if bytes.starts_with(BINARY_MAGIC) {
        return check_binary(bytes);
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = bytes[..error.valid_up_to()].iter().filter(|byte| **byte == b'\n').count() + 1;
        format!("line {line} is not UTF-8 text, and the file is no USDC")
    })?;
    if !bytes.starts_with(TEXT_MAGIC) {
        return Err("it begins neither with #usda nor as USDC does".to_owned());
    }
    check_nesting(text)
}

/// Refuses text in which brackets are nested too deep.
fn check_nesting(text: &str) -> Result<(), String> {
    let mut depth = 0usize;
    let mut rest = text.as_bytes();
    let mut line = 1;
    while let Some((&first, after)) = rest.split_first() {
        let mut skipped = 0;
        match first {
            b'{' | b'(' | b'[' => depth += 1,
            b'}' | b')' | b']' => depth = depth.saturating_sub(1),
            b'#' => skipped = after.iter().position(|byte| *byte == b'\n').unwrap_or(after.len()),
            b'"' | b'\'' => skipped = quoted_length(rest, first).saturating_sub(1),
            b'\n' => line += 1,
            _ => {}
        }
        if depth > 2 * MAX_DEPTH {
            return Err(format!("line {line}: brackets are nested more than {} deep", 2 * MAX_DEPTH));
        }
        let (passed, next) = after.split_at(skipped.min(after.len()));
        line += passed.iter().filter(|byte| **byte == b'\n').count();
        rest = next;
    }
    Ok(())
}

/// Returns the length of the quoted text that `rest` begins with.
fn quoted_length(rest: &[u8], quote: u8) -> usize {
    let long = [quote; 3];
    let end: &[u8] = if rest.starts_with(&long) { &long } else { &long[..1] };
    let mut at = end.len();
    while at < rest.len() {
        if rest[at] == b'\\' {
            at += 2;
        } else if rest[at..].starts_with(end) {
            return at + end.len();
        } else {
            at += 1;
        }
    }
    rest.len()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::usd::reader::package::tests::archive;

    #[test]
    fn addresses_are_relative_to_the_layer_that_has_them() {
        assert_eq!(joined("", "./parts/sleeve.usd"), "parts/sleeve.usd");
        assert_eq!(joined("parts/sleeve.usd", "../cuff.usda"), "cuff.usda");
        assert_eq!(joined("parts/sleeve.usd", "../../cuff.usda"), "../cuff.usda");
        assert_eq!(joined("a.usda", "b.usdz[geo/c.usdc]"), "b.usdz/geo/c.usdc");
        assert_eq!(joined("parts/a.usda", "/cloth/b.usd"), "/cloth/b.usd");
        assert_eq!(joined("parts/a.usda", "https://x/b.usd"), "https://x/b.usd");
    }

    #[test]
    fn a_layer_is_found_by_the_address_it_was_asked_for() {
        let mut layers = UsdLayers::default();
        assert_eq!(layers.find("parts/sleeve"), None);
        assert_eq!(layers.take_missing(), ["parts/sleeve"]);
        assert_eq!(layers.add("parts/sleeve", b"#usda 1.0\n").as_deref(), Ok("parts/sleeve.usda"));
        assert_eq!(layers.find("parts/sleeve").as_deref(), Some("parts/sleeve.usda"));

        let address = joined("", "b.usdz[geo/c.usdc]");
        assert_eq!(layers.find(&address), None);
        assert_eq!(layers.take_missing(), ["b.usdz"], "the package is fetched");
        let package = archive(&[("a.usda", b"#usda 1.0\n"), ("geo/c.usdc", b"#usda 1.0\n")], 0);
        assert_eq!(layers.add("b.usdz", &package).as_deref(), Ok("b.usdz/a.usda"));
        assert_eq!(layers.find(&address).as_deref(), Some("b.usdz/geo/c.usdc.usda"));
        assert!(layers.find("b.usdz/none.usda").is_none() && layers.take_missing() == ["b.usdz/none.usda"]);
    }

    #[test]
    fn nesting_counts_outside_of_quotes_and_comments() {
        assert!(check_nesting(&"{".repeat(10_000)).is_err());
        assert!(check_nesting(&format!("\"{}\" # {}\n", "(".repeat(999), "[".repeat(999))).is_ok());
        assert!(check_nesting(&format!("\"\"\"{} \" \\\"\"\"\"", "(".repeat(999))).is_ok());
        assert!(check_nesting(&"{}".repeat(999)).is_ok());
        assert!(check_nesting("\"open").is_ok() && check_nesting("'\\").is_ok());
    }
}
