//! Measures every design of a space on one task and prints CSV: the window by the coarse-to-fine search; for
//! the widest designs and as many random ones also the exhaustive search and the firm ranges of both.

use ask_tell::Grid;
use ask_tell::stream::stream;
use clap::Parser;
use finger_opt::failure::Failure;
use finger_opt::setup::Setup;
use finger_opt::setup::request::SetupRequest;
use insertion::evaluation::Evaluation;
use insertion::evaluation::evaluator::{Measured, Specimen};
use insertion::evaluation::robustness::Plan;
use insertion::evaluation::tolerance::Search;
use insertion::outcome::Outcome;
use insertion::space::Design;
use insertion::trial::NEVER;
use rand::seq::SliceRandom;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Number of the widest designs that are confirmed, and number of the random ones.
const CONFIRMED: usize = 100;
/// Seed of the random designs and of the repeats.
const SEED: u64 = 0;

#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    setup: SetupRequest,
}

fn main() -> Result<(), Failure> {
    let setup = Arguments::parse().setup.setup()?;
    setup.only_task()?;
    let grid = Grid::new(setup.space.levels());
    let designs: Vec<Design> = grid.points().map(|point| setup.space.design(&point)).collect();
    let searched = designs.par_iter().map(|design| measure(&setup, design, Search::Strides));
    let searched = searched.collect::<Result<Vec<Measured>, Failure>>()?;
    let confirmed = to_confirm(&searched).into_par_iter();
    let confirmed = confirmed.map(|i| Ok((i, confirmed_cells(&setup, &designs[i], &searched[i])?)));
    let confirmed = confirmed.collect::<Result<BTreeMap<usize, String>, Failure>>()?;
    for parameter in &setup.space.parameters {
        print!("{},", parameter.key);
    }
    println!(
        "range_mm,negative_mm,positive_mm,failure_negative,failure_positive,trials,repeated_mm,walked_mm,firm_mm,\
         repeat_trials,walk_trials"
    );
    for (i, design) in designs.iter().enumerate() {
        for value in setup.space.parameters.iter().filter_map(|p| design.get(&p.key)) {
            print!("{value},");
        }
        let cells = window_cells(&searched[i].tasks[0]);
        println!("{cells},{}", confirmed.get(&i).map_or(",,,,", String::as_str));
    }
    Ok(())
}

fn measure(setup: &Setup, design: &Design, search: Search) -> Result<Measured, Failure> {
    let evaluator = &setup.evaluator;
    let window = |specimen: &Specimen| evaluator.measure(specimen, search, &Plan::WINDOW, &NEVER);
    evaluator.evaluate_by(design, window).map_err(Failure::input)
}

/// Returns the indices of the widest designs, then of random others.
fn to_confirm(searched: &[Measured]) -> Vec<usize> {
    let mut indices: Vec<usize> = (0..searched.len()).collect();
    let range = |i: usize| searched[i].tasks[0].window.range_mm();
    indices.sort_by(|&a, &b| range(b).total_cmp(&range(a)));
    let mut rest = indices.split_off(CONFIRMED.min(indices.len()));
    rest.shuffle(&mut stream(SEED, 0, "landscape"));
    indices.extend(rest.into_iter().take(CONFIRMED));
    indices
}

fn window_cells(found: &Evaluation) -> String {
    let window = &found.window;
    let [negative, positive] = [window.end_negative, window.end_positive].map(|end| {
        let class = end.and_then(Outcome::failure);
        class.map_or(String::new(), |class| class.to_string())
    });
    // A design that diverges at the nominal start has no window.
    let millimetres = match window.nominal {
        Outcome::Diverged => ",,".to_owned(),
        _ => format!("{},{},{}", window.range_mm(), window.negative_mm(), window.positive_mm()),
    };
    format!("{millimetres},{negative},{positive},{}", found.trials)
}

fn confirmed_cells(setup: &Setup, design: &Design, searched: &Measured) -> Result<String, Failure> {
    let evaluator = &setup.evaluator;
    let specimen = evaluator.specimen(&evaluator.templates[0], design, searched.stiffness);
    let specimen = specimen.map_err(Failure::input)?;
    let firm = |found| evaluator.firm(&specimen, found, SEED, &NEVER).map_err(Failure::input);
    let repeated = firm(&searched.tasks[0])?;
    let walked = measure(setup, design, Search::Walk)?.tasks.swap_remove(0);
    let (last, trials) = match walked.window == searched.tasks[0].window {
        true => (repeated, walked.trials),
        false => {
            let last = firm(&walked)?;
            (last, walked.trials + last.trials)
        }
    };
    let [repeated_mm, walked_mm, firm_mm] =
        [repeated.range_mm(), walked.window.range_mm(), last.range_mm()];
    Ok(format!("{repeated_mm},{walked_mm},{firm_mm},{},{trials}", repeated.trials))
}
