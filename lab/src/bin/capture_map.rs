//! Prints the capture map of one finger as CSV, beside a trial at every place, and a summary on stderr.

use analysis::map::Mark;
use clap::Parser;
use finger_opt::command::Request as _;
use finger_opt::commands::map::{Mapped, Request};
use finger_opt::context::Context;
use finger_opt::failure::Failure;
use insertion::outcome::Outcome;
use insertion::trial::NEVER;

#[derive(Parser)]
struct Arguments {
    #[command(flatten)]
    request: Request,
}

fn main() -> Result<(), Failure> {
    let Arguments { request } = Arguments::parse();
    let Mapped { map, .. } = request.run(&Context::silent(&NEVER))?;
    let full = request.full(&map, &NEVER)?;
    let [first, second] = &map.axes;
    let [x, y] = [first, second].map(|axis| format!("{}_{}", axis.name, axis.unit));
    println!("{x},{y},outcome,simulated,outcome_of_full_grid");
    for (j, row) in full.iter().enumerate() {
        for (i, &full) in row.iter().enumerate() {
            let (x, y, simulated) = (first.value(i), second.value(j), map.simulated[j][i]);
            let [outcome, full] = [map.outcomes[j][i], full].map(i8::from);
            println!("{x},{y},{outcome},{},{full}", u8::from(simulated));
        }
    }
    let pairs = || map.outcomes.iter().flatten().zip(full.iter().flatten());
    let inserts = |mark: &Mark| mark.0 == Outcome::Inserted;
    eprintln!(
        "{} {}: {} trials, border within {}, area {} {}; {} of {} places differ from a trial there, \
         {} of them in whether they insert",
        map.task,
        second.name,
        map.trials,
        map.traced_step,
        map.area,
        map.area_unit,
        pairs().filter(|(a, b)| a != b).count(),
        pairs().count(),
        pairs().filter(|(a, b)| inserts(a) != inserts(b)).count(),
    );
    Ok(())
}
