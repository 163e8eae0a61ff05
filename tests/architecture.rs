//! The order of the rooms in `src/`: what lies in `crates/` the compiler keeps apart.

use std::path::Path;

/// A room may use those before it (`docs/architecture.md`).
const FLOW: [&str; 12] = [
    "connector",
    "sensitivity",
    "map",
    "study",
    "calibration",
    "identify",
    "levers",
    "tune",
    "answer",
    "report",
    "session",
    "cli",
];

/// Every `crate::ROOM` in a room of `src/` that comes later, as `file -> room`.
fn upward(folder: &Path, own: usize, found: &mut Vec<String>) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            upward(&path, own, found);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            let text = std::fs::read_to_string(&path).unwrap();
            let later = FLOW[own + 1..].iter();
            let used = later.filter(|room| text.contains(&format!("crate::{room}")));
            found.extend(used.map(|room| format!("{} -> {room}", path.display())));
        }
    }
}

#[test]
fn no_room_uses_a_later_one() {
    let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut found = Vec::new();
    for (own, room) in FLOW.iter().enumerate() {
        upward(&source.join(room), own, &mut found);
    }
    assert_eq!(found, Vec::<String>::new());
    // What the search finds is seen: the command line uses the reports.
    upward(&source.join("cli"), 4, &mut found);
    assert!(found.iter().any(|arrow| arrow.ends_with("-> report")));
    let folders =
        std::fs::read_dir(&source).unwrap().filter(|entry| entry.as_ref().unwrap().path().is_dir());
    assert_eq!(folders.count(), FLOW.len(), "a room stands outside the flow");
}
