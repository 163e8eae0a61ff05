//! Rules that the compiler does not keep.

use crate::common::{files, read, root};

/// The numbers of `rand_distr` take the system's logarithm; `normal.rs` rounds them.
#[test]
fn draws_are_not_the_systems() {
    let mut found = ["crates", "src", "lab/src", "python/src", "tests/analytic/src"]
        .map(|folder| files(&root(folder)))
        .concat();
    found.retain(|path| path.extension().is_some_and(|ending| ending == "rs"));
    found.retain(|path| !path.ends_with("ask-tell/src/normal.rs"));
    found.retain(|path| read(path).contains("rand_distr::"));
    assert_eq!(found, Vec::<std::path::PathBuf>::new(), "use ask_tell::normal");
}

#[test]
fn helpers_do_not_depend_on_commands() {
    let mut helpers = files(&root("src/setup"));
    helpers.retain(|path| read(path).contains("commands::"));
    assert_eq!(helpers, Vec::<std::path::PathBuf>::new());
}
