//! Which file uses which: from `use` lines and from paths in the code, through re-exports to where a name is defined.

use crate::circles::circles;
use crate::tokens::{Token, closing, tokens, without_tests};
use crate::{assert_none, files_below, read};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Steps of following re-exports, so that a circle of them ends.
const MAX_REEXPORTS: usize = 8;

/// A path such as `crate::mesh::Topology`.
#[derive(Debug, Clone)]
struct Name {
    segments: Vec<String>,
    line: usize,
}

/// One file of `src`.
struct Source {
    path: PathBuf,
    /// Names of the modules that lead to it: `["sim", "newton"]`.
    module: Vec<String>,
    /// Names other modules can reach through it, and what they stand for; `*` for all of a module.
    aliases: Vec<(String, Name)>,
    /// Names that it only hands on.
    reexports: Vec<Name>,
    /// Names that it uses.
    uses: Vec<Name>,
}

/// One file uses a name of another.
#[derive(Debug, Clone)]
struct Import {
    from: usize,
    to: usize,
    line: usize,
    name: String,
    is_reexport: bool,
}

/// All files of `src` and what they use.
struct Sources {
    files: Vec<Source>,
    imports: Vec<Import>,
}

impl Source {
    fn read(path: &Path) -> Self {
        let inner = path.strip_prefix("src").expect("below src").with_extension("");
        let mut module: Vec<String> =
            inner.iter().map(|part| part.to_str().expect("UTF-8").to_owned()).collect();
        if module.last().is_some_and(|last| ["mod", "lib", "main"].contains(&last.as_str())) {
            module.pop();
        }
        let all = without_tests(&tokens(&read(path)));
        let mut source =
            Self { path: path.into(), module, aliases: Vec::new(), reexports: Vec::new(), uses: Vec::new() };
        let (mut at, mut is_public) = (0, false);
        while at < all.len() {
            match all[at].text.as_str() {
                "pub" => {
                    is_public = true;
                    at += 1;
                    if all.get(at).is_some_and(|t| t.text == "(") {
                        at = closing(&all, at) + 1;
                    }
                    continue;
                }
                "use" => at = source.read_use(&all, at + 1, is_public),
                _ if all[at].is_word() && !follows_path(&all, at) => at = source.read_path(&all, at),
                _ => at += 1,
            }
            is_public = false;
        }
        source
    }

    /// Reads the tree of a `use` from `at` to its semicolon; returns where the code goes on.
    fn read_use(&mut self, all: &[Token], at: usize, is_public: bool) -> usize {
        let end = all[at..].iter().position(|t| t.text == ";").map_or(all.len(), |length| at + length);
        for (name, alias) in use_tree(&all[at..end], &[]) {
            if is_public {
                self.reexports.push(name.clone());
            } else {
                self.uses.push(name.clone());
            }
            self.aliases.push((alias, name));
        }
        end + 1
    }

    /// Reads a path in the code, `a::b::c`; returns where the code goes on.
    fn read_path(&mut self, all: &[Token], at: usize) -> usize {
        let mut segments = vec![all[at].text.clone()];
        let mut next = at + 1;
        while all.get(next).is_some_and(|t| t.text == "::") && all.get(next + 1).is_some_and(Token::is_word) {
            segments.push(all[next + 1].text.clone());
            next += 2;
        }
        if segments.len() > 1 {
            self.uses.push(Name { segments, line: all[at].line });
        }
        next
    }
}

/// Whether the word at `at` is a later part of a path or a field.
fn follows_path(all: &[Token], at: usize) -> bool {
    at > 0 && ["::", "."].contains(&all[at - 1].text.as_str())
}

/// Names of a `use` tree, each with what it is called afterwards (`*` for a glob).
fn use_tree(tree: &[Token], before: &[String]) -> Vec<(Name, String)> {
    let mut segments = before.to_vec();
    let (mut at, mut found) = (0, Vec::new());
    let line = tree.first().map_or(0, |t| t.line);
    while let Some(token) = tree.get(at) {
        match token.text.as_str() {
            "{" => {
                let end = closing(tree, at);
                let (mut start, mut inner) = (at + 1, at + 1);
                while inner <= end {
                    let text = tree[inner].text.as_str();
                    if text == "{" {
                        inner = closing(tree, inner);
                    } else if text == "," || inner == end {
                        if start < inner {
                            found.extend(use_tree(&tree[start..inner], &segments));
                        }
                        start = inner + 1;
                    }
                    inner += 1;
                }
                return found;
            }
            "*" => return vec![(Name { segments, line }, "*".to_owned())],
            "as" => {
                let alias = tree.get(at + 1).map_or("_", |t| t.text.as_str()).to_owned();
                return vec![(Name { segments, line }, alias)];
            }
            "self" if !segments.is_empty() => {}
            _ if token.is_word() => segments.push(token.text.clone()),
            _ => {}
        }
        at += 1;
    }
    let alias = segments.last().cloned().unwrap_or_default();
    vec![(Name { segments, line }, alias)]
}

impl Sources {
    fn read() -> Self {
        let is_test = |path: &PathBuf| path.file_stem().is_some_and(|stem| stem == "tests");
        let paths = files_below("src", &[".rs"]).into_iter().filter(|path| !is_test(path));
        let mut sources =
            Self { files: paths.map(|path| Source::read(&path)).collect(), imports: Vec::new() };
        for (from, file) in sources.files.iter().enumerate() {
            for (names, is_reexport) in [(&file.uses, false), (&file.reexports, true)] {
                for name in names {
                    let Some(to) = sources.resolve(&file.module, &name.segments, 0) else { continue };
                    if to != from {
                        let import =
                            Import { from, to, line: name.line, name: name.segments.join("::"), is_reexport };
                        sources.imports.push(import);
                    }
                }
            }
        }
        sources
    }

    fn file_of(&self, module: &[String]) -> Option<usize> {
        self.files.iter().position(|file| file.module == module)
    }

    /// The file that defines what `path` means in `module`; `None` for what is not of this crate.
    fn resolve(&self, module: &[String], path: &[String], depth: usize) -> Option<usize> {
        if depth > MAX_REEXPORTS {
            return None;
        }
        let mut at = module.to_vec();
        let mut rest = path;
        match path.first()?.as_str() {
            "crate" | "crease" => (at, rest) = (Vec::new(), &path[1..]),
            "self" => rest = &path[1..],
            "super" => {
                while rest.first().is_some_and(|segment| segment == "super") {
                    at.pop();
                    rest = &rest[1..];
                }
            }
            child => {
                at.push(child.to_owned());
                self.file_of(&at)?;
                rest = &path[1..];
            }
        }
        while let Some(segment) = rest.first() {
            at.push(segment.clone());
            if self.file_of(&at).is_none() {
                at.pop();
                break;
            }
            rest = &rest[1..];
        }
        let file = self.file_of(&at)?;
        let Some(name) = rest.first() else { return Some(file) };
        for (alias, target) in &self.files[file].aliases {
            if alias == name {
                let whole: Vec<String> = target.segments.iter().chain(&rest[1..]).cloned().collect();
                return self.resolve(&at, &whole, depth + 1).or(Some(file));
            }
        }
        Some(file)
    }

    /// Folder, or file at the top, that a file belongs to: `sim`; `None` for `lib.rs` and `main.rs`.
    fn folder(&self, file: usize) -> Option<&str> {
        self.files[file].module.first().map(String::as_str)
    }

    fn shown(&self, import: &Import) -> String {
        let (from, to) = (&self.files[import.from], &self.files[import.to]);
        format!("{}:{}: {} (of {})", from.path.display(), import.line, import.name, to.path.display())
    }
}

/// The table "Floors" of the architecture page: floor of every folder.
fn floors() -> BTreeMap<String, usize> {
    let pages = files_below("", &["architecture.md", "ARCHITECTURE.md"]);
    let page = pages.first().expect("an architecture page");
    let text = read(page);
    let mut floors = BTreeMap::new();
    let section = text.split_once("## Floors").expect("the section \"Floors\"").1;
    for row in section.lines().skip(1).take_while(|line| !line.starts_with("## ")) {
        let mut cells = row.split('|').skip(1);
        let (Some(floor), Some(folders)) = (cells.next(), cells.next()) else { continue };
        let Ok(floor) = floor.trim().parse() else { continue };
        for folder in folders.split('`').skip(1).step_by(2) {
            let folder = folder.trim_end_matches('/').trim_end_matches(".rs");
            floors.insert(folder.trim_start_matches("src/").to_owned(), floor);
        }
    }
    floors
}

#[test]
fn every_folder_has_a_floor() {
    let (floors, sources) = (floors(), Sources::read());
    let folders: BTreeSet<&str> = (0..sources.files.len()).filter_map(|file| sources.folder(file)).collect();
    let missing: Vec<String> = folders
        .iter()
        .filter(|folder| !floors.contains_key(**folder))
        .map(|folder| format!("src/{folder}"))
        .collect();
    assert_none(&missing, "name each in the table \"Floors\" of the architecture page");
    let gone: Vec<String> =
        floors.keys().filter(|folder| !folders.contains(folder.as_str())).cloned().collect();
    assert_none(&gone, "take each out of the table \"Floors\": there is no such folder in src");
}

#[test]
fn no_folder_imports_a_higher_one() {
    let (floors, sources) = (floors(), Sources::read());
    let floor = |file| sources.folder(file).and_then(|folder| floors.get(folder));
    let upward = |import: &&Import| match (floor(import.from), floor(import.to)) {
        (Some(from), Some(to)) => to > from,
        _ => false,
    };
    let faults: Vec<String> = sources.imports.iter().filter(upward).map(|i| sources.shown(i)).collect();
    assert_none(&faults, "move what is imported to a lower folder, or take it as an argument");
}

#[test]
fn folders_form_no_circle() {
    let sources = Sources::read();
    let folders: Vec<&str> = {
        let all: BTreeSet<&str> = (0..sources.files.len()).filter_map(|file| sources.folder(file)).collect();
        all.into_iter().collect()
    };
    let place = |file| {
        let folder = sources.folder(file)?;
        folders.iter().position(|other| *other == folder)
    };
    let edges: Vec<(usize, usize)> = sources
        .imports
        .iter()
        .filter_map(|import| Some((place(import.from)?, place(import.to)?)))
        .filter(|(from, to)| from != to)
        .collect();
    for circle in circles(folders.len(), &edges) {
        let within = |file: usize| place(file).is_some_and(|folder| circle.contains(&folder));
        let faults: Vec<String> = sources
            .imports
            .iter()
            .filter(|i| within(i.from) && within(i.to) && sources.folder(i.from) != sources.folder(i.to))
            .map(|i| sources.shown(i))
            .collect();
        assert_none(&faults, "these folders import one another: move the shared items to the lower one");
    }
}

#[test]
fn files_of_a_folder_form_no_circle() {
    let sources = Sources::read();
    // A module that only hands on the names of its files does not depend on them.
    let own = |import: &&Import| {
        !import.is_reexport
            && sources.folder(import.from).is_some()
            && sources.folder(import.from) == sources.folder(import.to)
    };
    let edges: Vec<(usize, usize)> = sources.imports.iter().filter(own).map(|i| (i.from, i.to)).collect();
    let mut faults = Vec::new();
    for circle in circles(sources.files.len(), &edges) {
        let names: Vec<String> =
            circle.iter().map(|f| sources.files[*f].path.display().to_string()).collect();
        faults.push(format!("circle of {}:", names.join(", ")));
        let within = |i: &&Import| circle.contains(&i.from) && circle.contains(&i.to);
        faults.extend(
            sources.imports.iter().filter(own).filter(within).map(|i| format!("  {}", sources.shown(i))),
        );
    }
    assert_none(&faults, "move the items that both need to a file of their own");
}

#[test]
fn use_trees_are_read() {
    let tree = tokens("crate::a::{self, b::{C, D as E}, f::*}");
    let names: Vec<(String, String)> =
        use_tree(&tree, &[]).into_iter().map(|(name, alias)| (name.segments.join("::"), alias)).collect();
    let expected =
        [("crate::a", "a"), ("crate::a::b::C", "C"), ("crate::a::b::D", "E"), ("crate::a::f", "*")];
    assert_eq!(names, expected.map(|(name, alias)| (name.to_owned(), alias.to_owned())));
}
