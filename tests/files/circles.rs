//! The files of a folder of `src` import each other without circles.
//!
//! A file imports another if it names an item of it, by `use` or by a path. An item that a `mod.rs`
//! re-exports counts as one of its original file. Items of the `mod.rs` of a folder are shared by
//! the files below it and do not count. Tests inside files may import anything.

use super::layers::{code, files, identifier, layer, read, source, table};
use std::collections::{BTreeMap, BTreeSet};
use std::path::{Path, PathBuf};

/// Names from the root of the crate down to a module or an item.
type Names = Vec<String>;

/// A file with the paths that it names and the items that it re-exports.
struct File {
    named: BTreeSet<Names>,
    /// Re-exported items by name.
    exported: BTreeMap<String, Names>,
}

/// The paths of a tree `a::{b, c::{self, d}, e as f}`, each with its local name.
fn paths(tree: &str) -> Vec<(Names, String)> {
    let tree = tree.trim();
    let Some((before, inner)) = tree.split_once('{') else {
        let (path, name) = tree.split_once(" as ").unwrap_or((tree, ""));
        let mut path: Names = path.split("::").map(|part| part.trim().into()).collect();
        if path.len() > 1 && path.last().is_some_and(|part| part == "self") {
            path.pop();
        }
        let last = path.last().cloned().unwrap_or_default();
        let name = if name.is_empty() { last } else { name.into() };
        return vec![(path, name)];
    };
    let inner = inner.rsplit_once('}').map_or(inner, |(inner, _)| inner);
    let (mut depth, mut start, mut found) = (0, 0, Vec::new());
    for (at, c) in inner.char_indices().chain([(inner.len(), ',')]) {
        match c {
            '{' => depth += 1,
            '}' => depth -= 1,
            ',' if depth == 0 => {
                if !inner[start..at].trim().is_empty() {
                    found.extend(paths(&format!("{before}{}", inner[start..at].trim())));
                }
                start = at + 1;
            }
            _ => {}
        }
    }
    found
}

/// The path from the root of the crate of a path in the module `own`, if it is in the crate.
fn absolute(own: &[String], path: &[String], modules: &BTreeSet<Names>) -> Option<Names> {
    let climbs = path.iter().take_while(|part| *part == "super").count();
    match path.first()?.as_str() {
        "crate" => Some(path[1..].to_vec()),
        "self" => Some([own, &path[1..]].concat()),
        "super" => Some([&own[..own.len() - climbs], &path[climbs..]].concat()),
        first => {
            let child = [own, &[first.to_owned()]].concat();
            modules.contains(&child).then(|| [own, path].concat())
        }
    }
}

/// Every path `a::b::c` in the text that is not part of another path.
fn written_paths(text: &str) -> Vec<Names> {
    let part_of_name = |c: char| c.is_alphanumeric() || c == '_';
    let mut found = Vec::new();
    let mut rest = text;
    while let Some(start) = rest.find(part_of_name) {
        let mut path = Vec::new();
        rest = &rest[start..];
        loop {
            let name = identifier(rest);
            path.push(name.to_owned());
            rest = &rest[name.len()..];
            match rest.strip_prefix("::") {
                Some(more) if more.starts_with(part_of_name) => rest = more,
                _ => break,
            }
        }
        if path.len() > 1 {
            found.push(path);
        }
    }
    found
}

fn file(own: &[String], text: &str, modules: &BTreeSet<Names>) -> File {
    let text = code(text);
    let text = text.split("#[cfg(test)]").next().unwrap_or_default();
    let (mut named, mut exported) = (BTreeSet::new(), BTreeMap::new());
    let (mut imported, mut rest) = (BTreeMap::new(), String::new());
    let mut statements = text;
    loop {
        let next = statements
            .match_indices("use ")
            .map(|(at, _)| at)
            .find(|&at| statements[..at].ends_with(|c: char| c.is_whitespace()) || at == 0);
        let Some(at) = next else { break };
        let line = statements[..at].rsplit('\n').next().unwrap_or_default();
        let public = line.trim_start().starts_with("pub");
        rest += &statements[..at];
        let Some((tree, after)) = statements[at + "use ".len()..].split_once(';') else {
            break;
        };
        for (path, name) in paths(tree) {
            let Some(path) = absolute(own, &path, modules) else {
                continue;
            };
            if public {
                exported.insert(name.clone(), path.clone());
            }
            if !modules.contains(&path) {
                named.insert(path.clone());
            }
            imported.insert(name, path);
        }
        statements = after;
    }
    rest += statements;
    for path in written_paths(&rest) {
        named.extend(match imported.get(&path[0]) {
            Some(whole) => Some([whole, &path[1..]].concat()),
            None => absolute(own, &path, modules),
        });
    }
    File { named, exported }
}

/// The module of the item or module with these names.
fn home(names: &Names, all: &BTreeMap<Names, File>) -> Option<Names> {
    let mut names = names.clone();
    // A re-export may be of a re-export.
    for _ in 0..8 {
        let length = (1..=names.len())
            .rev()
            .find(|&length| all.contains_key(&names[..length]))?;
        let (module, item) = names.split_at(length);
        let exported = &all[module].exported;
        match item.first().and_then(|item| exported.get(item)) {
            Some(path) => names = [path, &item[1..]].concat(),
            None => return Some(module.to_vec()),
        }
    }
    None
}

/// By module: the modules of its own folder of `src` that it imports, without its parents.
fn imports(texts: &[(Names, String)]) -> BTreeMap<Names, BTreeSet<Names>> {
    let modules = texts.iter().map(|(names, _)| names.clone()).collect();
    let all: BTreeMap<Names, File> = texts
        .iter()
        .map(|(own, text)| (own.clone(), file(own, text, &modules)))
        .collect();
    let of = |own: &Names| {
        let homes = all[own].named.iter().filter_map(|names| home(names, &all));
        homes
            .filter(|home| home[0] == own[0] && !own.starts_with(home))
            .collect()
    };
    all.keys().map(|own| (own.clone(), of(own))).collect()
}

/// One circle among the imports, if any.
fn circle(imports: &BTreeMap<Names, BTreeSet<Names>>) -> Option<Vec<String>> {
    let mut left = imports.clone();
    // A module without imports is in no circle.
    while let Some(free) = left
        .iter()
        .find(|(_, to)| !to.iter().any(|to| left.contains_key(to)))
        .map(|(own, _)| own.clone())
    {
        left.remove(&free);
    }
    let mut at = left.keys().next()?.clone();
    let mut way: Vec<Names> = Vec::new();
    while !way.contains(&at) {
        way.push(at.clone());
        at = left[&at].iter().find(|to| left.contains_key(*to))?.clone();
    }
    way.push(at.clone());
    let start = way.iter().position(|names| *names == at)?;
    Some(way[start..].iter().map(|names| names.join("::")).collect())
}

/// The folder of the table that a file belongs to, with the rest of its path.
fn place(path: &Path, table: &[String]) -> Option<(String, PathBuf)> {
    let below = path.strip_prefix(source()).expect("below src");
    let split = |folder: &String| Some((folder.clone(), below.strip_prefix(folder).ok()?.into()));
    table.iter().find_map(split)
}

/// The names of a file's module, from its folder of the table.
fn module(folder: &str, rest: &Path) -> Names {
    let rest = rest.with_extension("");
    let parts = rest.iter().map(|part| part.to_string_lossy().into_owned());
    let inner = parts.filter(|part| part != "mod" && part != "lib");
    std::iter::once(layer(folder).to_owned())
        .chain(inner)
        .collect()
}

/// The text of a file of a folder that is a crate of its own, with all paths from the root of `src`.
fn from_the_top(text: &str, folder: &str, table: &[String]) -> String {
    if !source().join(folder).join("Cargo.toml").is_file() {
        return text.to_owned();
    }
    let mut parts = text.split("crate::");
    let mut out = parts.next().unwrap_or_default().to_owned();
    for part in parts {
        let first = identifier(part);
        let elsewhere = table.iter().any(|folder| layer(folder) == first);
        out += "crate::";
        if !elsewhere {
            out += &format!("{folder}::");
        }
        out += part;
    }
    out
}

#[test]
fn the_files_of_a_folder_import_each_other_without_circles() {
    let table = table();
    let text = |path: &PathBuf| {
        let (folder, rest) = place(path, &table)?;
        let text = from_the_top(&read(path), &folder, &table);
        Some((module(&folder, &rest), text))
    };
    let texts: Vec<(Names, String)> = files(&source()).iter().filter_map(text).collect();
    let imports = imports(&texts);
    let count: usize = imports.values().map(BTreeSet::len).sum();
    assert!(count > 500, "only {count} imports were found");
    // An import by a path only, and one through a re-export.
    let has = |from: &[&str], to: &[&str]| {
        let names = |all: &[&str]| -> Names { all.iter().map(|&part| part.into()).collect() };
        imports[&names(from)].contains(&names(to))
    };
    assert!(has(&["system", "initial"], &["system", "rank"]));
    let tape = ["integrate", "implicit", "tape"];
    assert!(has(&["integrate", "trajectory"], &tape));
    // A file of a crate of one folder.
    assert!(has(&["figures", "report_page"], &["figures", "forces"]));
    let circle = circle(&imports);
    assert!(
        circle.is_none(),
        "{}",
        circle.unwrap_or_default().join(" → ")
    );
}

#[test]
fn circles_are_found_through_lists_paths_exports_and_folders() {
    let found = |files: &[(&str, &str)]| {
        let names = |path: &str| -> Names { path.split('/').map(String::from).collect() };
        let texts: Vec<(Names, String)> = files
            .iter()
            .map(|(path, text)| (names(path), (*text).into()))
            .collect();
        circle(&imports(&texts)).is_some()
    };
    let root = ("f", "pub mod a;\nmod b;\nmod g;\npub use a::Item;\n");
    let pair = |a, b| found(&[root, ("f/a", a), ("f/b", b)]);
    let to_a = "use super::a::{Other,\n    Item as Same};\n";
    assert!(pair("use super::{\n    b::{self, Thing},\n};\n", to_a));
    assert!(pair("fn f() { super::b::thing() }", to_a));
    assert!(pair("use crate::f::b;\nfn f() { b::thing() }", to_a));
    assert!(pair("use super::b::thing;", "use super::Item;"));
    assert!(!pair("use super::b::thing;", "use super::common;"));
    assert!(!pair("use super::b::thing;", "// use super::a::Item;"));
    assert!(!pair("", to_a));
    let test = "#[cfg(test)]\nmod tests {\n    use super::super::b::thing;\n}\n";
    assert!(!pair(test, to_a));
    let folder = |inner| {
        let exports = ("f/g", "mod h;\npub use h::Deep;\n");
        found(&[
            root,
            ("f/a", "use super::g::Deep;"),
            exports,
            ("f/g/h", inner),
        ])
    };
    assert!(folder("use crate::f::a::Item;"));
    assert!(folder("use super::super::Item;"));
    assert!(!folder("use super::common;"));
}
