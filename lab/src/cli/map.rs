//! `lab map`: capture maps against a trial at every place.

use super::{Failure, print};
use analysis::map::{CaptureMap, Mark};
use clap::Args;
use finger_opt::command::Request as _;
use finger_opt::commands::map::{Mapped, Request as MapRequest};
use finger_opt::context::Context;
use insertion::outcome::Outcome;
use insertion::trial::NEVER;
use std::path::PathBuf;
use study::write_file;

/// Compare the capture map of one finger with a trial at every place
///
/// Writes both outcomes of every place, and says how many the map has otherwise.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    request: MapRequest,
    /// Table that is written
    #[arg(long, value_name = "FILE.csv")]
    out: PathBuf,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Mapped { map, .. } = arguments.request.run(&Context::silent(&NEVER))?;
    let full = arguments.request.full(&map, &NEVER)?;
    write_file(&arguments.out, &csv(&map, &full))?;
    let pairs = || map.outcomes.iter().flatten().zip(full.iter().flatten());
    let inserts = |mark: &Mark| mark.0 == Outcome::Inserted;
    print(&format!(
        "{} {}: {} trials, border within {}, area {} {}; of {} places {} are \
         otherwise with a trial at each, {} of them in whether they insert\n",
        map.task,
        map.axes[1].name,
        map.trials,
        map.traced_step,
        map.area,
        map.area_unit,
        pairs().count(),
        pairs().filter(|(a, b)| a != b).count(),
        pairs().filter(|(a, b)| inserts(a) != inserts(b)).count(),
    ))
}

fn csv(map: &CaptureMap, full: &[Vec<Mark>]) -> String {
    let [first, second] = &map.axes;
    let names = [first, second].map(|axis| format!("{}_{}", axis.name, axis.unit)).join(",");
    let mut text = format!("{names},outcome,simulated,outcome_of_full_grid\n");
    for (at, row) in full.iter().enumerate() {
        for (i, full) in row.iter().enumerate() {
            let (place, outcome) = ([first.value(i), second.value(at)], map.outcomes[at][i]);
            let simulated = u8::from(map.simulated[at][i]);
            let [outcome, full] = [outcome, *full].map(i8::from);
            text += &format!("{},{},{outcome},{simulated},{full}\n", place[0], place[1]);
        }
    }
    text
}
