//! `optimize compare` on studies of the fake engine.

use crate::common::{Studies, command, run};

fn compare(studies: &Studies, names: &[&str], more: &[&str]) -> crate::common::Ran {
    let mut command = command(&["compare"]);
    command.args(names.iter().map(|name| studies.dir(name))).args(more);
    run(&mut command)
}

#[test]
fn optimizers_are_compared_over_their_seeds() {
    let studies = Studies::new();
    let mut names = Vec::new();
    for optimizer in ["random", "cma-es", "sobol"] {
        for seed in ["1", "2", "3"] {
            let name = format!("{optimizer}-{seed}");
            studies.study(&name, 40, &["--optimizer", optimizer, "--seed", seed]).succeeds();
            names.push(name);
        }
    }
    let names: Vec<&str> = names.iter().map(String::as_str).collect();
    let more = ["--json", "--svg", &studies.word("compare.svg")];
    let result = compare(&studies, &names, &more).json();
    let groups = result["optimizers"].as_array().unwrap();
    assert_eq!(groups.len(), 3);
    for group in groups {
        assert_eq!(group["studies"], 3);
        let best = group["best_so_far_mm"].as_array().unwrap();
        let medians: Vec<f64> = best.iter().filter_map(|q| q["median"].as_f64()).collect();
        assert!(best.len() == 40 && medians.is_sorted(), "{group}");
        let reached = group["reached"].as_u64().unwrap();
        assert_eq!(group["evaluations_to_target"]["median"].is_null(), reached < 2, "{group}");
    }
    assert!(groups.iter().any(|group| group["reached"].as_u64() > Some(0)));
    let svg = studies.read("compare.svg");
    assert!(svg.contains("sobol (3 studies)") && svg.contains("<polygon"));
    compare(&studies, &names, &[]).says(&["best known"]);
    compare(&studies, &["random-1", "random-1"], &[]).fails(2, &["the same study", "seed 1"]);
}

#[test]
fn different_problems_are_refused() {
    let studies = Studies::new();
    studies.study("range", 4, &[]).succeeds();
    studies.study("centred", 4, &["--objective", "centred-range"]).succeeds();
    let said = ["cannot be compared", "objective range", "centred-range"];
    compare(&studies, &["range", "centred"], &[]).fails(2, &said);
    studies.study("front", 4, &["--objective", "range,slip"]).succeeds();
    compare(&studies, &["front"], &[]).fails(2, &["range,slip", "one objective in mm"]);
    let said = ["nothing", "not a study"];
    compare(&studies, &["range", "nothing"], &[]).fails(2, &said);
    compare(&studies, &[], &[]).fails(2, &["DIR"]);
}
