//! `lab landscape`: every design of a space, and what is firm of the widest.

use super::{Failure, print};
use ask_tell::Grid;
use ask_tell::stream::stream;
use clap::Args;
use finger_opt::setup::Setup;
use finger_opt::setup::request::SetupRequest;
use insertion::evaluation::evaluator::{Measured, Specimen};
use insertion::evaluation::robustness::Plan;
use insertion::evaluation::template::Impossible;
use insertion::evaluation::tolerance::Search;
use insertion::evaluation::{Evaluation, grid_mm};
use insertion::outcome::Outcome;
use insertion::space::Design;
use rand::seq::SliceRandom;
use rayon::prelude::*;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use study::write_file;

/// Most designs of a recorded space.
const LARGEST: u64 = 20_000;
/// How many of the widest designs are confirmed, and how many random ones.
const CONFIRMED: usize = 100;
/// Seed of the random designs and of the repeats.
const SEED: u64 = 0;

/// Measure every design of a space, and confirm the widest
///
/// Writes one line per design: its window by the coarse-to-fine search; of the widest designs, and
/// of as many random ones, also the window by exhaustive search and the firm ranges within both.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    setup: SetupRequest,
    /// Table that is written
    #[arg(long, value_name = "FILE.csv")]
    out: PathBuf,
}

/// What confirms a design; mm, and trials run for it.
struct Confirmed {
    repeated_mm: f64,
    walked_mm: f64,
    firm_mm: f64,
    repeat_trials: u32,
    walk_trials: u32,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let setup = arguments.setup.setup()?;
    setup.only_task()?;
    let grid = Grid::new(setup.space.levels());
    if grid.size() > LARGEST {
        let size = grid.size();
        return Err(Failure::usage(format!(
            "the space has {size} designs; a landscape has at most {LARGEST}: give a coarser --space"
        )));
    }
    let designs: Vec<Design> = grid.points().map(|point| setup.space.design(&point)).collect();
    let searched = designs
        .par_iter()
        .map(|design| window(&setup, design, Search::Strides))
        .collect::<Result<Vec<Measured>, Failure>>()?;
    let wanted = wanted(&searched);
    let found = wanted
        .par_iter()
        .map(|&at| confirmed(&setup, &designs[at], &searched[at]))
        .collect::<Result<Vec<Confirmed>, Failure>>()?;
    let mut text = header(&setup);
    for (at, (design, measured)) in designs.iter().zip(&searched).enumerate() {
        let confirmed = wanted.iter().position(|&wanted| wanted == at).map(|i| &found[i]);
        text += &line(&setup, design, &measured.tasks[0], confirmed);
    }
    write_file(&arguments.out, &text)?;
    print(&format!("{} designs, {} of them confirmed\n", designs.len(), found.len()))
}

fn window(setup: &Setup, design: &Design, search: Search) -> Result<Measured, Failure> {
    let stop = AtomicBool::new(false);
    let measure =
        |specimen: &Specimen| setup.evaluator.measure(specimen, search, &Plan::WINDOW, &stop);
    setup.evaluator.evaluate_by(design, measure).map_err(refused)
}

fn refused(error: Impossible) -> Failure {
    Failure::running(error.to_string())
}

/// The widest designs, then random others, by their places.
fn wanted(searched: &[Measured]) -> Vec<usize> {
    let mut places: Vec<usize> = (0..searched.len()).collect();
    let range = |at: usize| searched[at].tasks[0].window.range_mm();
    places.sort_by(|&a, &b| range(b).total_cmp(&range(a)));
    let mut rest = places.split_off(CONFIRMED.min(places.len()));
    rest.shuffle(&mut stream(SEED, 0, "landscape"));
    places.extend(rest.into_iter().take(CONFIRMED));
    places
}

fn confirmed(setup: &Setup, design: &Design, searched: &Measured) -> Result<Confirmed, Failure> {
    let (evaluator, stop) = (&setup.evaluator, AtomicBool::new(false));
    let specimen =
        evaluator.specimen(&evaluator.templates[0], design, searched.stiffness).map_err(refused)?;
    let firm = |found: &Evaluation| {
        evaluator.firm(&specimen, found, SEED, &stop).map_err(|e| Failure::running(e.to_string()))
    };
    let repeated = firm(&searched.tasks[0])?;
    let walked = window(setup, design, Search::Walk)?.tasks.swap_remove(0);
    let same = walked.window == searched.tasks[0].window;
    let last = if same { repeated } else { firm(&walked)? };
    Ok(Confirmed {
        repeated_mm: repeated.range_mm(),
        walked_mm: walked.window.range_mm(),
        firm_mm: last.range_mm(),
        repeat_trials: repeated.trials,
        walk_trials: walked.trials + if same { 0 } else { last.trials },
    })
}

fn header(setup: &Setup) -> String {
    let axes = setup.space.parameters.iter().map(|parameter| parameter.key.as_str());
    let axes = axes.collect::<Vec<_>>().join(",");
    format!(
        "{axes},range_mm,negative_mm,positive_mm,failure_negative,failure_positive,trials,repeated_mm,\
         walked_mm,firm_mm,repeat_trials,walk_trials\n"
    )
}

fn line(
    setup: &Setup,
    design: &Design,
    found: &Evaluation,
    confirmed: Option<&Confirmed>,
) -> String {
    let window = &found.window;
    let values = setup.space.parameters.iter().filter_map(|parameter| design.get(&parameter.key));
    let mut cells: Vec<String> = values.map(|value| value.to_string()).collect();
    // What diverges at the nominal start has no window.
    let known = window.nominal != Outcome::Diverged;
    let mm = [window.range_mm(), grid_mm(window.negative_steps), grid_mm(window.positive_steps)];
    cells.extend(mm.map(|mm| if known { mm.to_string() } else { String::new() }));
    for end in [window.end_negative, window.end_positive] {
        let class = match end {
            Some(Outcome::Failed(class)) => class.number().to_string(),
            _ => String::new(),
        };
        cells.push(class);
    }
    cells.push(found.trials.to_string());
    match confirmed {
        None => cells.extend(std::iter::repeat_n(String::new(), 5)),
        Some(found) => {
            let mm = [found.repeated_mm, found.walked_mm, found.firm_mm];
            cells.extend(mm.map(|mm| mm.to_string()));
            cells.extend([found.repeat_trials, found.walk_trials].map(|n| n.to_string()));
        }
    }
    cells.join(",") + "\n"
}
