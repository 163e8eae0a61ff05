//! Rules that the compiler does not keep.

use crate::common::{files, read, root};

/// Functions that std takes from the system's mathematical library (`clippy.toml` denies the same by type).
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
    let mut found = Vec::new();
    let folders = ["crates", "src", "lab/src", "python/src", "tests/analytic/src"];
    let sources = folders.iter().flat_map(|folder| files(&root(folder)));
    for path in sources.filter(|path| path.extension().is_some_and(|ending| ending == "rs")) {
        let text = read(&path);
        // Its numbers take the system's logarithm; `normal.rs` rounds them.
        let drawn = text.contains("rand_distr::") && !path.ends_with("ask-tell/src/normal.rs");
        found.extend(drawn.then(|| format!("{}: rand_distr", path.display())));
        let lines = text.lines().enumerate().filter(|(_, line)| calls_the_system(line));
        found.extend(lines.map(|(i, line)| format!("{}:{}: {line}", path.display(), i + 1)));
    }
    assert_eq!(found, Vec::<String>::new(), "use libm, or ask_tell::normal");
}

#[test]
fn helpers_do_not_depend_on_commands() {
    let mut helpers = files(&root("src/setup"));
    helpers.retain(|path| read(path).contains("commands::"));
    assert_eq!(helpers, Vec::<std::path::PathBuf>::new());
}
