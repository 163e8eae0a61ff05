//! Files are read once in a run.

use finger_opt::command::parse;
use finger_opt::commands::evaluate;
use finger_opt::context::Context;
use insertion::trial::NEVER;

/// Alone in its process: it counts all texts that are parsed.
#[test]
fn each_input_file_is_parsed_once() {
    let files =
        ["tasks/usb.toml", "spaces/infill.toml", "robots/servo.toml", "fingers/finray9.toml"];
    let path = |name: &str| format!("{}/{name}", env!("CARGO_MANIFEST_DIR"));
    let [task, space, robot, finger] = files.map(path);
    for more in [vec![], vec!["--finger-model", "computed", "--finger", &finger]] {
        let words = ["--task", &task, "--space", &space, "--robot", &robot, "--engine", "fake"];
        let words = words.into_iter().chain(["--density", "20", "--direction", "10"]);
        let request: evaluate::Request = parse(words.chain(more)).ok().unwrap();
        let before = input::parsed();
        let found = request.evaluated(&Context::silent(&NEVER)).ok().unwrap();
        assert!(found.evaluation.window.range_mm() > 0.0);
        assert_eq!(input::parsed() - before, files.len() as u64, "{files:?}");
    }
}
