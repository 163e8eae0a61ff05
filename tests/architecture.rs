//! Holds every import of the library to the order in which data flows (`docs/architecture.md`),
//! and finds circles among the files of a room.

use std::collections::{BTreeMap, BTreeSet};
use std::path::Path;

/// The rooms, from the vocabulary up to the command line; a room may use those before it.
const FLOW: [&str; 19] = [
    "units",
    "files",
    "stream",
    "outcome",
    "scene",
    "input",
    "finger",
    "surrogate",
    "physics",
    "trial",
    "connector",
    "evaluation",
    "optimizer",
    "sensitivity",
    "study",
    "verify",
    "calibration",
    "report",
    "cli",
];

/// Path below `src/` and text without its tests, of every file of the library.
fn sources() -> BTreeMap<String, String> {
    fn collect(folder: &Path, root: &Path, found: &mut BTreeMap<String, String>) {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                collect(&path, root, found);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                let text = std::fs::read_to_string(&path).unwrap();
                let name = path.strip_prefix(root).unwrap().to_str().unwrap().replace('\\', "/");
                found.insert(name, text);
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = BTreeMap::new();
    collect(&root, &root, &mut found);
    found
}

/// The text without comments and without what is compiled for tests only: tests may look up.
fn code(text: &str) -> String {
    let shipped = text.split("#[cfg(test)]\nmod tests {").next().unwrap_or(text);
    let line = |line: &str| line.split("//").next().unwrap_or(line).to_owned() + "\n";
    shipped.lines().map(line).collect()
}

/// `a::b::c` of every path that begins with `root`, the braces of `use` written out.
fn paths(code: &str, root: &str) -> BTreeSet<Vec<String>> {
    let word = |c: char| c.is_alphanumeric() || c == '_';
    let mut found = BTreeSet::new();
    for (at, _) in code.match_indices(root) {
        if code[..at].ends_with(|c: char| word(c) || c == ':') {
            continue;
        }
        expand(&code[at + root.len()..], &mut Vec::new(), &mut found);
    }
    found
}

/// Reads one path (or a group in braces) and gives what follows it.
fn expand<'a>(
    text: &'a str,
    before: &mut Vec<String>,
    found: &mut BTreeSet<Vec<String>>,
) -> &'a str {
    let text = text.trim_start();
    if let Some(mut rest) = text.strip_prefix('{') {
        loop {
            rest = expand(rest, before, found).trim_start();
            match rest.strip_prefix(',') {
                Some(more) => rest = more,
                None => return rest.strip_prefix('}').unwrap_or(rest),
            }
        }
    }
    let end = text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len());
    if end == 0 {
        return text;
    }
    before.push(text[..end].to_owned());
    let rest = match text[end..].strip_prefix("::") {
        Some(rest) => expand(rest, before, found),
        None => {
            found.insert(before.clone());
            &text[end..]
        }
    };
    before.pop();
    rest
}

/// Every import from a room farther up, as `file -> room`.
fn upward(sources: &BTreeMap<String, String>) -> Vec<String> {
    let floor = |room: &str| FLOW.iter().position(|name| *name == room);
    let mut found = Vec::new();
    for (file, text) in sources.iter().filter(|(file, _)| !file.ends_with("tests.rs")) {
        let room = file.split('/').next().unwrap_or(file).trim_end_matches(".rs");
        let Some(own) = floor(room) else { continue };
        let rooms: BTreeSet<String> = paths(&code(text), "crate::")
            .into_iter()
            .filter_map(|path| path.into_iter().next())
            .collect();
        for used in rooms {
            if floor(&used).is_some_and(|other| other > own) {
                found.push(format!("src/{file} -> {used}"));
            }
        }
    }
    found
}

/// The file of `path` below `src/`, as far as the path names files and folders.
fn file_of(path: &[String], sources: &BTreeMap<String, String>) -> Option<String> {
    (1..=path.len()).rev().find_map(|length| {
        let stem = path[..length].join("/");
        [format!("{stem}.rs"), format!("{stem}/mod.rs")]
            .into_iter()
            .find(|file| sources.contains_key(file))
    })
}

/// Which files each file uses. A folder's `mod.rs` only gathers what its files offer, and
/// holds what they share, so arrows to it from its own files are left out.
fn arrows(sources: &BTreeMap<String, String>) -> BTreeMap<String, BTreeSet<String>> {
    let mut all = BTreeMap::new();
    for (file, text) in sources.iter().filter(|(file, _)| !file.ends_with("tests.rs")) {
        let code = code(text);
        let mut here: Vec<String> =
            file.trim_end_matches(".rs").split('/').map(str::to_owned).collect();
        if here.last().is_some_and(|last| last == "mod") {
            here.pop();
        }
        let mut used: BTreeSet<Vec<String>> = paths(&code, "crate::");
        let above = &here[..here.len().saturating_sub(1)];
        used.extend(
            paths(&code, "super::")
                .into_iter()
                .filter(|path| path[0] != "super")
                .map(|path| above.iter().cloned().chain(path).collect()),
        );
        let folder = file.rsplit_once('/').map_or("", |(folder, _)| folder);
        let own_mod = |other: &str| {
            other
                .strip_suffix("mod.rs")
                .is_some_and(|parent| format!("{folder}/").starts_with(parent))
        };
        let files = used.iter().filter_map(|path| file_of(path, sources));
        let files = files.filter(|other| other != file && !own_mod(other));
        all.insert(file.clone(), files.collect());
    }
    all
}

/// A circle of imports, if there is one: the files in order.
fn circle(arrows: &BTreeMap<String, BTreeSet<String>>) -> Option<Vec<String>> {
    fn visit(
        file: &str,
        arrows: &BTreeMap<String, BTreeSet<String>>,
        way: &mut Vec<String>,
        done: &mut BTreeSet<String>,
    ) -> Option<Vec<String>> {
        if let Some(start) = way.iter().position(|before| before == file) {
            return Some(way[start..].to_vec());
        }
        if !done.contains(file) {
            way.push(file.to_owned());
            for next in arrows.get(file).into_iter().flatten() {
                if let Some(circle) = visit(next, arrows, way, done) {
                    return Some(circle);
                }
            }
            way.pop();
            done.insert(file.to_owned());
        }
        None
    }
    let mut done = BTreeSet::new();
    arrows.keys().find_map(|file| visit(file, arrows, &mut Vec::new(), &mut done))
}

#[test]
fn no_import_runs_up_the_flow() {
    assert_eq!(upward(&sources()), Vec::<String>::new());
}

#[test]
fn an_upward_import_is_seen() {
    let mut sources = sources();
    let scene = sources.get_mut("scene.rs").unwrap();
    scene.insert_str(0, "use crate::{units::MM, study::{self, Study}};\n");
    assert_eq!(upward(&sources), ["src/scene.rs -> study"]);
}

#[test]
fn no_files_import_in_a_circle() {
    assert_eq!(circle(&arrows(&sources())), None);
}

#[test]
fn a_circle_is_seen() {
    let file = |text: &str| text.to_owned();
    let mut sources = BTreeMap::from([
        ("a/mod.rs".to_owned(), file("mod b; mod c; pub use b::B;")),
        ("a/b.rs".to_owned(), file("use super::c::C;\nuse super::B;")),
        ("a/c.rs".to_owned(), file("// use super::b::B;")),
    ]);
    assert_eq!(circle(&arrows(&sources)), None);
    sources.insert("a/c.rs".to_owned(), file("use crate::a::{b, D};"));
    assert_eq!(circle(&arrows(&sources)).unwrap(), ["a/b.rs", "a/c.rs"]);
}

#[test]
fn every_room_stands_in_the_flow() {
    let rooms: BTreeSet<String> = sources()
        .keys()
        .map(|file| file.split('/').next().unwrap_or(file).trim_end_matches(".rs").to_owned())
        .filter(|room| !["lib", "main"].contains(&room.as_str()))
        .collect();
    assert_eq!(rooms, FLOW.iter().map(|room| (*room).to_owned()).collect());
}

/// Path below the package and text of the README and every page of `docs/`.
fn pages() -> Vec<(String, String)> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let docs = std::fs::read_dir(root.join("docs")).unwrap();
    let names = docs.map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let pages = names.filter(|name| name.ends_with(".md")).map(|name| format!("docs/{name}"));
    let named = pages.chain(["README.md".to_owned()]);
    named.map(|name| (name.clone(), std::fs::read_to_string(root.join(&name)).unwrap())).collect()
}

/// The targets of the links to files in a page, without their anchors.
fn links(text: &str) -> Vec<&str> {
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split([')', ' ']).next());
    let files = targets.filter(|target| !target.starts_with("http") && !target.starts_with('#'));
    files.filter_map(|target| target.split('#').next()).collect()
}

#[test]
fn every_link_of_the_documents_leads_to_a_file() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    for (name, text) in pages() {
        let folder = root.join(&name);
        let folder = folder.parent().unwrap();
        for target in links(&text) {
            assert!(folder.join(target).exists(), "{name} links to {target}, which is not there");
        }
    }
    assert_eq!(links("a [b](c.md#d) [e](https://f) ![g](h.svg)"), ["c.md", "h.svg"]);
}

#[test]
fn every_document_is_a_page_of_the_book() {
    let pages = pages();
    let (_, summary) = pages.iter().find(|(name, _)| name == "docs/SUMMARY.md").unwrap();
    let listed = links(summary);
    for (name, _) in &pages {
        let page = name.strip_prefix("docs/").unwrap_or("SUMMARY.md");
        assert!(page == "SUMMARY.md" || listed.contains(&page), "{name} is not in docs/SUMMARY.md");
    }
}
