//! Promises of the documents: links that lead somewhere, as many words as a person reads, and
//! every command.

use crate::common::{read, root};
use std::path::PathBuf;
use std::process::Command;

/// The pages in a folder, with their texts.
fn pages(folder: &str) -> Vec<(PathBuf, String)> {
    let entries = std::fs::read_dir(root(folder)).unwrap();
    let paths = entries.map(|entry| entry.unwrap().path());
    let pages = paths.filter(|path| path.extension().is_some_and(|extension| extension == "md"));
    pages.map(|path| (path.clone(), read(&path))).collect()
}

/// Words of all pages, as `wc -w` counts them.
fn words(pages: &[(PathBuf, String)]) -> usize {
    pages.iter().map(|(_, text)| text.split_whitespace().count()).sum()
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
    assert!(read(&root("README.md")).split_whitespace().count() <= 900);
    assert!(words(&pages("docs/guide")) <= 10_000);
    assert!(words(&pages("docs/notes")) <= 15_500);
}

#[test]
fn changelog_and_citation_are_of_this_version() {
    let version = env!("CARGO_PKG_VERSION");
    let changelog = read(&root("CHANGELOG.md"));
    let heading = changelog.lines().find_map(|line| line.strip_prefix("## ")).unwrap();
    let (made, date) = heading.split_once(" (").unwrap_or((heading, ""));
    assert_eq!(made, version, "first section of CHANGELOG.md");
    let citation = read(&root("CITATION.cff"));
    let released = format!("\nversion: {version}\ndate-released: {}", date.trim_end_matches(')'));
    assert!(citation.contains(&released), "CITATION.cff lacks {released}");
}

#[test]
fn what_is_written_of_the_commands_is_current() {
    let mut script = Command::new("python3");
    let script = script.arg(root("scripts/generate.py")).arg("--check");
    let Ok(done) = script.arg(env!("CARGO_BIN_EXE_optimize")).output() else {
        return eprintln!("left out, for want of python3");
    };
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}
