//! The commands that bring bench and simulation together, on the fake engine.

mod common;

use common::{Studies, optimize, read};

#[test]
fn measurements_are_added_checked_and_refused() {
    let folder = Studies::new();
    let path = folder.dir("bench.csv");
    let file = path.to_str().expect("a path in UTF-8");
    let add = |more: &[&str]| {
        optimize(&[&["measure", "add", file, "--task", "ket8", "--density", "20"], more].concat())
    };
    add(&["--direction", "0", "--range-mm", "5.7"]).succeeds();
    add(&["--direction", "10", "--negative-mm", "-1.5", "--failure-negative", "3"]).succeeds();
    let before = read(&path);
    add(&["--direction", "0", "--range-mm", "5.8"]).fails(2, &["line 4: task: ", "line 2"]);
    add(&["--direction", "0.35", "--range-mm", "5.8"]).fails(2, &["degrees, as in 20"]);
    assert_eq!(read(&path), before);
    let checked = optimize(&["measure", "check", file, "--json"]).json();
    assert_eq!((&checked["lines"], &checked["tasks"][0]["bounds"]), (&2.into(), &1.into()));
    std::fs::write(&path, before.replace("ket8", "ket80")).expect("the file is written");
    optimize(&["measure", "check", file]).fails(2, &["line 2: task: ", "did you mean `ket8`"]);
    assert_eq!(optimize(&["measure", "check", "published", "--json"]).json()["lines"], 44);
}
