//! `optimize evaluate`: the tolerance window of one finger.

use super::computed_too;
use super::repeat::{self, RepeatArguments};
use super::setup::{self, Setup, SetupArguments};
use super::specimen::{Chosen, FingerArguments};
use super::words::{self, merge};
use super::{Failure, print, print_json};
use clap::Args;
use input::shipped::UNCERTAINTIES;
use insertion::evaluation::Evaluation;
use insertion::evaluation::robustness::repeat::Bands;
use insertion::evaluation::tolerance::Search;
use insertion::trial::NEVER;
use serde_json::{Value, json};
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// Measure one finger.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    pub setup: SetupArguments,
    #[command(flatten)]
    finger: FingerArguments,
    /// Go step by step to the first failure: sees gaps narrower than 0.5 mm, three times the trials
    #[arg(long)]
    walk: bool,
    /// Success rate and robust range under these errors, too: typical, or the path of a file
    #[arg(long, value_name = "NAME")]
    uncertainty: Option<String>,
    /// Seed of the drawn errors: those of the study with this seed
    #[arg(long, value_name = "N", default_value_t = 0, requires = "uncertainty")]
    seed: u64,
    #[command(flatten)]
    repeat: RepeatArguments,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// What the command found.
pub struct Found {
    setup: Setup,
    chosen: Chosen,
    evaluation: Evaluation,
    bands: Option<Bands>,
    wall_s: f64,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let found = find(arguments, &NEVER)?;
    let setup = (&arguments.setup, &found.setup);
    let computed = computed_too::measure(setup, &arguments.finger, arguments.search(), &NEVER);
    if arguments.json {
        let mut fields = found.json(arguments);
        computed.iter().for_each(|found| merge(&mut fields, computed_too::json(found)));
        return print_json(&fields);
    }
    let bands = found.bands.as_ref().map(repeat::bands_text).unwrap_or_default();
    let computed = computed.iter().flat_map(words::by_ribs).collect::<String>();
    let text = text(&found.chosen, &found.setup, &found.evaluation);
    let all = format!("{text}{computed}{bands}time          {:.1} s\n", found.wall_s);
    print(&words::wrapped(&all))
}

/// Measures; ends early, with a failure, once `stop` is set.
pub fn find(arguments: &Arguments, stop: &AtomicBool) -> Result<Found, Failure> {
    let mut setup = Setup::from_arguments(&arguments.setup)?;
    if let Some(name) = &arguments.uncertainty {
        setup = setup.under(setup::find("uncertainty", UNCERTAINTIES, name)?)?;
    }
    let chosen = arguments.finger.choose(&setup)?;
    let clock = Instant::now();
    let search = arguments.search();
    let plan = setup.plan(arguments.seed, |_| setup.uncertainty.is_some())?;
    let evaluation =
        setup.evaluator.measure(&chosen.specimen, search, &plan, stop).map_err(Failure::input)?;
    if stop.load(Ordering::SeqCst) {
        return Err(Failure::running("interrupted"));
    }
    let wall_s = clock.elapsed().as_secs_f64();
    let bands = arguments.repeat.bands(&setup, &chosen, &evaluation)?;
    Ok(Found { setup, chosen, evaluation, bands, wall_s })
}

impl Arguments {
    fn search(&self) -> Search {
        if self.walk { Search::Walk } else { Search::Strides }
    }
}

impl Found {
    /// What `--json` prints.
    pub fn json(&self, arguments: &Arguments) -> Value {
        let mut fields = self.chosen.json(&self.setup, &arguments.finger);
        merge(&mut fields, json!(self.evaluation));
        merge(&mut fields, json!({"wall_s": self.wall_s}));
        if let Some(bands) = &self.bands {
            merge(&mut fields, json!({"bands": repeat::bands_json(bands)}));
        }
        fields
    }
}

fn text(chosen: &Chosen, setup: &Setup, evaluation: &Evaluation) -> String {
    let [c1, c2, c3, c4] = evaluation.failure_counts;
    let mut lines = vec![
        format!("task          {}", chosen.specimen.task.name),
        chosen.text(setup),
        format!("range         {:.1} mm", evaluation.window.range_mm()),
        words::window(evaluation),
        format!(
            "failures      {c1} of class 1, {c2} of 2, {c3} of 3, {c4} of 4, {} diverged in {} trials",
            evaluation.diverged, evaluation.trials
        ),
        format!("peak force    {}", words::number(evaluation.peak_force_n, 1, "N")),
    ];
    lines.extend(words::taught(evaluation.taught));
    lines.extend(words::drawn_text(evaluation));
    lines.join("\n") + "\n"
}
