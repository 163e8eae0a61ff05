//! Promises of the documents: links that lead somewhere, as many words as a person reads, and
//! every command.

use finger_opt::commands::COMMANDS;
use std::path::{Path, PathBuf};
use std::process::Command;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// The pages in a folder, with their texts.
fn pages(folder: &str) -> Vec<(PathBuf, String)> {
    let entries = std::fs::read_dir(root().join(folder)).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let pages = paths.filter(|path| path.extension().is_some_and(|extension| extension == "md"));
    pages.map(|path| (path.clone(), std::fs::read_to_string(path).unwrap())).collect()
}

fn words(pages: &[(PathBuf, String)]) -> usize {
    let words = |text: &str| text.split_whitespace().filter(|word| *word != "|").count();
    pages.iter().map(|(_, text)| words(text)).sum()
}

/// The targets of the links to files in a page, without their anchors.
fn links(text: &str) -> Vec<&str> {
    let targets = text.split("](").skip(1).filter_map(|rest| rest.split([')', ' ']).next());
    let files = targets.filter(|target| !target.starts_with("http") && !target.starts_with('#'));
    files.filter_map(|target| target.split('#').next()).collect()
}

#[test]
fn every_link_leads_to_a_file() {
    for (page, text) in
        ["", "docs", "docs/guide", "docs/notes", "python"].into_iter().flat_map(pages)
    {
        for target in links(&text) {
            let there = page.parent().unwrap().join(target).exists();
            assert!(there, "{} links to {target}, which is not there", page.display());
        }
    }
    assert_eq!(links("a [b](c.md#d) [e](https://f) ![g](h.svg)"), ["c.md", "h.svg"]);
}

#[test]
fn the_documents_can_be_read_in_an_evening() {
    let readme = std::fs::read_to_string(root().join("README.md")).unwrap();
    assert!(readme.split_whitespace().count() <= 900);
    assert!(words(&pages("docs/guide")) <= 10_000);
    assert!(words(&pages("docs/notes")) <= 14_000);
}

#[test]
fn changelog_and_citation_are_of_this_version() {
    let version = env!("CARGO_PKG_VERSION");
    let changelog = std::fs::read_to_string(root().join("CHANGELOG.md")).unwrap();
    let heading = changelog.lines().find_map(|line| line.strip_prefix("## ")).unwrap();
    let (made, date) = heading.split_once(" (").unwrap_or((heading, ""));
    assert_eq!(made, version, "first section of CHANGELOG.md");
    let citation = std::fs::read_to_string(root().join("CITATION.cff")).unwrap();
    let released = format!("\nversion: {version}\ndate-released: {}", date.trim_end_matches(')'));
    assert!(citation.contains(&released), "CITATION.cff lacks {released}");
}

#[test]
fn the_command_reference_is_what_the_program_says() {
    let page = std::fs::read_to_string(root().join("docs/cli.md"));
    let same = page
        .is_ok_and(|text| text == finger_opt::manual::reference(finger_opt::program::program()));
    assert!(same, "docs/cli.md is not what --help says: scripts/generate.py writes it");
}

#[test]
fn every_file_of_a_command_is_in_the_list() {
    let (root, mut found) = (root().join("src/commands"), Vec::new());
    let mut folders = vec![root.clone()];
    while let Some(folder) = folders.pop() {
        for entry in std::fs::read_dir(folder).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                folders.push(path);
            } else if path.extension().is_some_and(|ending| ending == "rs") {
                let name = path.with_extension("").strip_prefix(&root).unwrap().to_owned();
                found.push(name.display().to_string().replace('_', "-").replace(['/', '\\'], " "));
            }
        }
    }
    found.retain(|name| name != "mod");
    found.sort();
    let mut listed: Vec<String> = COMMANDS.iter().map(|command| command.path.join(" ")).collect();
    listed.sort();
    assert_eq!(found, listed, "scripts/generate.py writes src/commands/mod.rs");
}

#[test]
fn what_is_written_of_the_commands_is_current() {
    let mut script = Command::new("python3");
    let script = script.arg(root().join("scripts/generate.py")).arg("--check");
    let Ok(done) = script.arg(env!("CARGO_BIN_EXE_optimize")).output() else {
        return eprintln!("left out, for want of python3");
    };
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}
