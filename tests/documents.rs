//! What the documents promise: links that lead somewhere, as many words as a person reads, and
//! every command.

use std::path::{Path, PathBuf};

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
    assert!(words(&pages("docs/guide")) <= 9_000);
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

/// `RENEW=1 cargo test --release --test documents` writes the page again.
#[test]
fn the_command_reference_is_what_the_program_says() {
    let page = root().join("docs/cli.md");
    let reference = finger_opt::manual::reference();
    if std::env::var_os("RENEW").is_some() {
        std::fs::write(&page, &reference).unwrap();
    }
    let same = std::fs::read_to_string(&page).is_ok_and(|text| text == reference);
    assert!(same, "docs/cli.md is not what --help says: renew it with RENEW=1");
}
