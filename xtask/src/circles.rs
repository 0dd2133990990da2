//! `cargo xtask circles`: do the files of each crate import each other in one direction?
//!
//! An import is a path in code that leads to an item of another file, in a `use` or anywhere else.
//! Re-exports are followed to the file that defines the item, and a re-export alone is no import: a `mod.rs` may list the items of its children.
//! Test modules at the foot of a file are not read, nor are methods, which are found by type.

use crate::finding::{self, Finding};
use crate::rust_source::RustSource;
use crate::tree::Tree;
use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// Checks every crate of the workspace at `root` and prints each circle; true if there is none.
pub(crate) fn run(root: &Path) -> bool {
    match Tree::load(root) {
        Ok(tree) => finding::report("circles", check(&tree)),
        Err(error) => {
            eprintln!("circles: cannot read {}: {error}", root.display());
            false
        }
    }
}

/// One finding for each circle, at its first file.
fn check(tree: &Tree) -> Vec<Finding> {
    let roots = tree.entries().filter_map(|entry| {
        entry.strip_suffix("/src/lib.rs").or_else(|| entry.strip_suffix("/src/main.rs"))
    });
    let crates: BTreeSet<&str> = roots.collect();
    crates.into_iter().flat_map(|name| Crate::read(tree, name).circles()).collect()
}

/// A path of names, from the crate's root.
type ModulePath = Vec<String>;

/// A module: a file, or a part of one.
#[derive(Default)]
struct Module {
    /// File that holds it.
    file: String,
    /// Names of the items that it defines.
    items: BTreeSet<String>,
    /// Names that it imports or re-exports, each with the path of the item as written.
    imports: BTreeMap<String, ModulePath>,
    /// Modules of which it imports everything, as written.
    globs: Vec<ModulePath>,
    /// Paths in its code as written, without those of re-exports, each with its line.
    paths: Vec<(usize, ModulePath)>,
    /// Single names in its code, each with its line.
    names: Vec<(usize, String)>,
}

/// Imports between files: of each pair the first line and the path there.
type Imports<'a> = BTreeMap<&'a str, BTreeMap<&'a str, (usize, String)>>;

/// The modules of one crate.
#[derive(Default)]
struct Crate {
    modules: BTreeMap<ModulePath, Module>,
}

impl Crate {
    /// Reads the sources of the crate in the given folder.
    fn read(tree: &Tree, folder: &str) -> Self {
        let mut read = Self::default();
        let source = format!("{folder}/src/");
        for (path, text) in tree.texts_ending(".rs") {
            let Some(inside) = path.strip_prefix(&source).and_then(|p| p.strip_suffix(".rs"))
            else {
                continue;
            };
            let mut name: ModulePath = inside.split('/').map(str::to_owned).collect();
            if name.last().is_some_and(|last| {
                last == "mod" || name.len() == 1 && (last == "lib" || last == "main")
            }) {
                name.pop();
            }
            let code = RustSource::new(text).code;
            let tokens = tokens(&code);
            read.modules.entry(name.clone()).or_default().file = path.to_owned();
            read.take(&name, path, &tokens);
        }
        read
    }

    /// Reads the tokens of one module.
    fn take(&mut self, name: &[String], file: &str, tokens: &[(usize, &str)]) {
        let mut module = self.modules.remove(name).unwrap_or_default();
        module.file = file.to_owned();
        let (mut at, mut depth) = (0, 0_usize);
        while at < tokens.len() {
            let (line, token) = tokens[at];
            let next = tokens.get(at + 1).map_or("", |(_, next)| next);
            match token {
                "#" if starts_test_module(&tokens[at..]) => at = item_end(tokens, at),
                "{" => depth += 1,
                "}" => depth = depth.saturating_sub(1),
                "use" => {
                    let end =
                        (at..tokens.len()).find(|&i| tokens[i].1 == ";").unwrap_or(tokens.len());
                    let is_public = at > 0 && matches!(tokens[at - 1].1, "pub" | ")");
                    let mut leaves = Vec::new();
                    use_leaves(&tokens[at + 1..end], &mut Vec::new(), &mut leaves);
                    for (path, alias) in leaves {
                        if !is_public {
                            module.paths.push((line, path.clone()));
                        }
                        match alias.as_str() {
                            "*" => module.globs.push(path),
                            alias => _ = module.imports.insert(alias.to_owned(), path),
                        }
                    }
                    at = end;
                }
                "mod" if is_name(next) && tokens.get(at + 2).is_some_and(|(_, t)| *t == "{") => {
                    let end = item_end(tokens, at);
                    let child = joined(name, &[next.to_owned()]);
                    self.take(&child, file, &tokens[at + 3..end.min(tokens.len())]);
                    at = end;
                }
                "struct" | "enum" | "union" | "trait" | "type" | "const" | "static" | "fn"
                | "macro_rules"
                    if depth == 0 =>
                {
                    let named = tokens[at + 1..].iter().map(|(_, t)| *t).find(|t| {
                        is_name(t) && !matches!(*t, "mut" | "unsafe" | "extern" | "fn" | "async")
                    });
                    module.items.extend(named.map(str::to_owned));
                }
                first if is_name(first) && next == ":" && (at == 0 || tokens[at - 1].1 != ":") => {
                    let (path, end) = path_at(tokens, at);
                    if path.len() > 1 {
                        module.paths.push((line, path));
                        at = end - 1;
                    }
                }
                single
                    if is_name(single) && (at == 0 || !matches!(tokens[at - 1].1, ":" | ".")) =>
                {
                    module.names.push((line, single.to_owned()));
                }
                _ => {}
            }
            at += 1;
        }
        self.modules.insert(name.to_vec(), module);
    }

    /// The file that defines what `path`, from the crate's root, leads to; none for a module or an item of another crate.
    fn definition(&self, path: &[String], depth: usize) -> Option<&str> {
        let mut at = ModulePath::new();
        for (i, name) in path.iter().enumerate() {
            let child = joined(&at, std::slice::from_ref(name));
            if self.modules.contains_key(&child) {
                at = child;
                continue;
            }
            let module = self.modules.get(&at)?;
            if module.items.contains(name) {
                return Some(&module.file);
            }
            // Two modules may import everything of each other.
            if depth > 16 {
                return None;
            }
            let follow = |import: &[String], rest: &[String]| {
                let import = self.path_from_root(&at, import)?;
                self.definition(&joined(&import, rest), depth + 1)
            };
            return match module.imports.get(name) {
                Some(import) => follow(import, &path[i + 1..]),
                None => module.globs.iter().find_map(|glob| follow(glob, &path[i..])),
            };
        }
        None
    }

    /// The path from the crate's root of a path as the module `name` writes it; none if it leads to another crate.
    fn path_from_root(&self, name: &[String], path: &[String]) -> Option<ModulePath> {
        let first = path.first()?;
        if matches!(first.as_str(), "crate" | "self" | "super") {
            return Some(absolute(name, path));
        }
        if self.modules.contains_key(&joined(name, std::slice::from_ref(first))) {
            return Some(joined(name, path));
        }
        let import = self.modules.get(name)?.imports.get(first)?;
        // A crate may be imported under its own name.
        (import.first() != Some(first)).then_some(())?;
        Some(joined(&self.path_from_root(name, import)?, &path[1..]))
    }

    /// Imports between files: of each pair the first line and the path there.
    fn imports(&self) -> Imports<'_> {
        let mut imports = Imports::new();
        for (name, module) in &self.modules {
            let from = imports.entry(&module.file).or_default();
            let names = module.names.iter().filter(|(_, name)| module.imports.contains_key(name));
            let single = names.map(|(line, name)| (*line, vec![name.clone()]));
            for (line, path) in module.paths.iter().cloned().chain(single) {
                let Some(to) =
                    self.path_from_root(name, &path).and_then(|path| self.definition(&path, 0))
                else {
                    continue;
                };
                if to != module.file {
                    from.entry(to).or_insert_with(|| (line, path.join("::")));
                }
            }
        }
        imports
    }

    /// One finding for each set of files that import each other.
    fn circles(&self) -> Vec<Finding> {
        let imports = self.imports();
        let reached: BTreeMap<&str, BTreeSet<&str>> =
            imports.keys().map(|&file| (file, reach(&imports, file))).collect();
        let mut findings = Vec::new();
        let mut seen = BTreeSet::new();
        for (&file, others) in &reached {
            if !others.contains(file) || !seen.insert(file) {
                continue;
            }
            let members: Vec<&str> =
                others.iter().copied().filter(|other| reached[other].contains(file)).collect();
            seen.extend(&members);
            let steps = shortest_circle(&imports, file);
            let arrows: Vec<String> = steps
                .iter()
                .map(|(from, to)| {
                    let (line, path) = &imports[from][to];
                    format!("{from}:{line} imports {path} of {to}")
                })
                .collect();
            let message =
                format!("{} files import each other: {}", members.len(), arrows.join("; "));
            findings.push(Finding::new(file, 1, message));
        }
        findings
    }
}

/// All files that are reached from `file` by one import or more.
fn reach<'a>(imports: &Imports<'a>, file: &str) -> BTreeSet<&'a str> {
    let mut found = BTreeSet::new();
    let mut open: Vec<&str> = vec![file];
    while let Some(next) = open.pop() {
        for &to in imports.get(next).into_iter().flat_map(BTreeMap::keys) {
            if found.insert(to) {
                open.push(to);
            }
        }
    }
    found
}

/// The imports of a shortest circle through `file`.
fn shortest_circle<'a>(imports: &Imports<'a>, file: &'a str) -> Vec<(&'a str, &'a str)> {
    let mut from: BTreeMap<&str, &str> = BTreeMap::new();
    let mut open = std::collections::VecDeque::from([file]);
    while let Some(next) = open.pop_front() {
        for &to in imports[next].keys() {
            if let std::collections::btree_map::Entry::Vacant(entry) = from.entry(to) {
                entry.insert(next);
                open.push_back(to);
            }
        }
        if from.contains_key(file) {
            break;
        }
    }
    let mut steps = Vec::new();
    let mut at = file;
    while let Some(&before) = from.get(at) {
        steps.push((before, at));
        at = before;
        if at == file {
            break;
        }
    }
    steps.reverse();
    steps
}

/// Words and marks of the code, each with its line from 1.
fn tokens(code: &str) -> Vec<(usize, &str)> {
    let mut tokens = Vec::new();
    for (i, line) in code.lines().enumerate() {
        let mut rest = line.trim_start();
        while let Some(first) = rest.chars().next() {
            let length = if is_letter(first) {
                rest.find(|c| !is_letter(c)).unwrap_or(rest.len())
            } else {
                first.len_utf8()
            };
            tokens.push((i + 1, &rest[..length]));
            rest = rest[length..].trim_start();
        }
    }
    tokens
}

fn is_letter(c: char) -> bool {
    c.is_alphanumeric() || c == '_'
}

fn is_name(token: &str) -> bool {
    token.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// Whether tokens start with `#[cfg(test)]` before a module.
fn starts_test_module(tokens: &[(usize, &str)]) -> bool {
    let words: Vec<&str> = tokens.iter().take(8).map(|(_, token)| *token).collect();
    words.starts_with(&["#", "[", "cfg", "(", "test", ")", "]", "mod"])
}

/// Place of the brace or semicolon that ends the item that starts at `at`.
fn item_end(tokens: &[(usize, &str)], at: usize) -> usize {
    let mut depth = 0_usize;
    for (i, (_, token)) in tokens.iter().enumerate().skip(at) {
        match *token {
            "{" => depth += 1,
            "}" if depth <= 1 => return i,
            "}" => depth -= 1,
            ";" if depth == 0 => return i,
            _ => {}
        }
    }
    tokens.len()
}

/// The path that starts at `at`, and the place behind it.
fn path_at(tokens: &[(usize, &str)], mut at: usize) -> (ModulePath, usize) {
    let mut path = vec![tokens[at].1.to_owned()];
    at += 1;
    while tokens.len() > at + 2
        && tokens[at].1 == ":"
        && tokens[at + 1].1 == ":"
        && is_name(tokens[at + 2].1)
    {
        path.push(tokens[at + 2].1.to_owned());
        at += 3;
    }
    (path, at)
}

/// Each path of a `use`, with the name that it gets; `*` for all.
fn use_leaves(
    tokens: &[(usize, &str)],
    prefix: &mut ModulePath,
    leaves: &mut Vec<(ModulePath, String)>,
) {
    let mut path = prefix.clone();
    let mut alias = None;
    let mut at = 0;
    while at < tokens.len() {
        match tokens[at].1 {
            ":" => {}
            "{" => {
                let mut depth = 0_usize;
                let mut start = at + 1;
                for i in at..tokens.len() {
                    match tokens[i].1 {
                        "{" => depth += 1,
                        "}" => depth -= 1,
                        _ => {}
                    }
                    if depth == 1 && tokens[i].1 == "," || depth == 0 {
                        use_leaves(&tokens[start..i], &mut path, leaves);
                        start = i + 1;
                    }
                    if depth == 0 {
                        break;
                    }
                }
                return;
            }
            "as" => alias = tokens.get(at + 1).map(|(_, name)| (*name).to_owned()),
            "*" => return leaves.push((path, "*".to_owned())),
            name if alias.is_none() => path.push(name.to_owned()),
            _ => {}
        }
        at += 1;
    }
    if path.len() > prefix.len() || alias.is_some() {
        if path.last().is_some_and(|last| last == "self") {
            path.pop();
        }
        let name = alias.or_else(|| path.last().cloned()).unwrap_or_default();
        leaves.push((path, name));
    }
}

fn joined(start: &[String], rest: &[String]) -> ModulePath {
    [start, rest].concat()
}

/// A path from the crate's root, of one that starts with `crate`, `self` or `super` in the module `name`.
fn absolute(name: &[String], path: &[String]) -> ModulePath {
    let mut at: ModulePath = match path.first().map(String::as_str) {
        Some("self" | "super") => name.to_vec(),
        _ => ModulePath::new(),
    };
    for part in path {
        match part.as_str() {
            "crate" | "self" => {}
            "super" => _ = at.pop(),
            part => at.push(part.to_owned()),
        }
    }
    at
}

#[cfg(test)]
mod tests {
    use super::*;

    fn circles(files: &[(&str, &str)]) -> Vec<String> {
        check(&Tree::of(files)).into_iter().map(|f| f.message).collect()
    }

    #[test]
    fn one_direction_is_no_circle() {
        assert_eq!(
            circles(&[
                ("c/src/lib.rs", "mod a;\nmod b;\npub use a::A;\npub use b::B;\n"),
                ("c/src/a.rs", "pub struct A;\n#[cfg(test)]\nmod tests { use crate::b::B; }\n"),
                (
                    "c/src/b.rs",
                    "use crate::A; // crate::b\npub struct B(A);\nfn f() -> &str { \"crate::b\" }\n"
                ),
            ]),
            <[String; 0]>::default()
        );
    }

    #[test]
    fn a_circle_is_named_with_its_lines() {
        assert_eq!(
            circles(&[
                ("c/src/lib.rs", "mod a;\nmod b;"),
                ("c/src/a.rs", "use super::b::{self, B};\npub fn a() { b::c() }"),
                ("c/src/b.rs", "pub struct B;\npub fn c() { crate::a::a() }"),
            ]),
            [
                "2 files import each other: c/src/a.rs:1 imports super::b::B of c/src/b.rs; c/src/b.rs:2 imports crate::a::a of c/src/a.rs"
            ]
        );
    }

    #[test]
    fn re_exports_are_followed() {
        let hidden = circles(&[
            ("c/src/lib.rs", "mod a;\nmod b;\npub use b::B;"),
            ("c/src/a.rs", "use crate::B;\npub fn a(b: B) {}"),
            ("c/src/b.rs", "use crate::a as other;\npub struct B;\nfn c() { other::a(B) }"),
        ]);
        assert_eq!(hidden.len(), 1, "{hidden:?}");
        let nested = circles(&[
            ("c/src/main.rs", "mod a;"),
            ("c/src/a/mod.rs", "mod b;\npub use b::B;\npub struct A(B);"),
            ("c/src/a/b.rs", "use super::*;\npub struct B(Box<A>);\nfn f() { super::A::new() }"),
        ]);
        assert_eq!(nested.len(), 1, "{nested:?}");
    }
}
