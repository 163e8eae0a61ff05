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

/// Gives every source file under a folder, and its text.
fn sources(folder: &Path, each: &mut dyn FnMut(&Path, &str)) {
    for entry in std::fs::read_dir(folder).unwrap() {
        let path = entry.unwrap().path();
        if path.is_dir() {
            sources(&path, each);
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            each(&path, &std::fs::read_to_string(&path).unwrap());
        }
    }
}

/// Every `crate::ROOM` in a room of `src/` that comes later, as `file -> room`.
fn upward(folder: &Path, own: usize, found: &mut Vec<String>) {
    sources(folder, &mut |path, text| {
        let later = FLOW[own + 1..].iter();
        let used = later.filter(|room| text.contains(&format!("crate::{room}")));
        found.extend(used.map(|room| format!("{} -> {room}", path.display())));
    });
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

/// What std takes from the system's mathematical library (`clippy.toml` denies the same by type).
const SYSTEM: [&str; 27] = [
    "sin", "cos", "tan", "asin", "acos", "atan", "atan2", "sin_cos", "exp", "exp2", "exp_m1", "ln",
    "ln_1p", "log", "log2", "log10", "powf", "hypot", "cbrt", "sinh", "cosh", "tanh", "asinh",
    "acosh", "atanh", "gamma", "ln_gamma",
];

/// Whether a line of code calls one of them, as a method or by a path that is not `libm`'s.
fn calls_the_system(line: &str) -> bool {
    let code = line.split("//").next().unwrap_or_default();
    let name = |c: char| c.is_alphanumeric() || c == '_';
    SYSTEM.iter().any(|function| {
        code.match_indices(function).any(|(at, _)| {
            let (before, after) = (&code[..at], &code[at + function.len()..]);
            let types = ["f64::", "f32::", "f64>::", "f32>::", "Float::", "Field::"];
            let path = types.iter().any(|name| before.ends_with(name)) && !after.starts_with(name);
            path || before.ends_with('.') && after.trim_start().starts_with(['(', ':'])
        })
    })
}

#[test]
fn elementary_functions_and_draws_are_not_the_systems() {
    for call in ["x.sin()", "    .ln()", "map(f64::exp)", "f64::atan2(y, x)", "<f64>::log10(x)"] {
        assert!(calls_the_system(call), "{call}");
    }
    for other in ["libm::sin(x)", "self.log.moments", "x.log_det()", "// x.sin()", "f64::consts"] {
        assert!(!calls_the_system(other), "{other}");
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let mut found = Vec::new();
    for folder in ["crates", "src", "lab/src", "python/src"] {
        sources(&root.join(folder), &mut |path, text| {
            // Its normal numbers take the system's logarithm; one test compares ours with them.
            let drawn = text.contains("rand_distr::") && !path.ends_with("ask-tell/src/normal.rs");
            found.extend(drawn.then(|| format!("{}: rand_distr", path.display())));
            let lines = text.lines().enumerate().filter(|(_, line)| calls_the_system(line));
            found.extend(lines.map(|(i, line)| format!("{}:{}: {line}", path.display(), i + 1)));
        });
    }
    assert_eq!(found, Vec::<String>::new(), "use libm, or ask_tell::normal");
}
