//! `optimize trial`: one simulated insertion.

use super::terminal::merge;
use super::words;
use super::{Failure, chosen, print, print_json};
use crate::session::{TrialDone, TrialRequest};
use clap::Args;
use insertion::evaluation::grid_mm;
use insertion::outcome::Outcome;
use insertion::trial::{NEVER, Trial};
use report::answer::lines;
use report::answer::words::number;
use serde_json::{Value, json};

/// Simulate one insertion.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    request: TrialRequest,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let done = arguments.request.run(&NEVER)?;
    if arguments.json {
        return print_json(&json(&done));
    }
    // `repeats       18 inserted, 2 failed: jammed`.
    let repeats = done.repeats.as_ref().map_or(String::new(), |counts| {
        let counts = counts.iter().map(|(outcome, count)| format!("{count} {outcome}"));
        format!("repeats       {}\n", counts.collect::<Vec<_>>().join(", "))
    });
    let start = words::lines(lines::taught(done.taught));
    let wrote = done.written.iter().map(|file| format!("wrote         {}\n", file.display()));
    let wrote: String = wrote.collect();
    let chosen = chosen::text(&done.chosen);
    print(&format!("{chosen}{start}{}{repeats}{wrote}", text(&done.trial)))
}

/// Output of `--json`.
pub fn json(done: &TrialDone) -> Value {
    let mut fields = chosen::json(&done.chosen);
    let trial = &done.trial;
    fields["offset_mm"] = json!(done.offset_mm);
    merge(&mut fields, ended(trial));
    fields["simulated_s"] = json!(trial.simulated_s);
    fields["retried_at_half_step"] = json!(trial.retried);
    fields["phases"] = json!(trial.phases);
    if let Some(taught) = done.taught {
        fields["taught_start_mm"] = json!(grid_mm(taught));
    }
    if let Some(counts) = &done.repeats {
        fields["repeats"] = json!(counts);
    }
    fields
}

pub(super) fn ended(trial: &Trial) -> Value {
    json!({
        "outcome": trial.outcome.word(),
        "failure": trial.outcome.failure(),
        "depth_mm": trial.depth_mm,
        "tilt_deg": trial.tilt_deg,
        "peak_force_n": trial.peak_force_n,
        "slip_mm": trial.slip_mm,
    })
}

fn text(trial: &Trial) -> String {
    let reason = match trial.outcome {
        Outcome::Failed(class) => format!(": {} (class {})", class.label(), class.number()),
        Outcome::Inserted | Outcome::Diverged => String::new(),
    };
    let mut text = format!(
        "outcome       {}{reason}\ndepth         {}\ntilt          {}\npeak force    {}\n\
         slip          {}\n",
        trial.outcome.word(),
        number(trial.depth_mm, 2, "mm"),
        number(trial.tilt_deg, 2, "deg"),
        number(trial.peak_force_n, 1, "N"),
        number(trial.slip_mm, 2, "mm"),
    );
    if trial.phases.is_empty() {
        return text;
    }
    text += "\nphase         end s   tip x mm  tip y mm  tip z mm  tilt deg  slip mm  peak N\n";
    for phase in &trial.phases {
        let [x, y, z] = phase.tip_mm;
        text.push_str(&format!(
            "{:<12} {:6.2}  {x:9.2} {y:9.2} {z:9.2} {:9.2} {:8.2} {:7.1}\n",
            phase.name, phase.time_s, phase.tilt_deg, phase.slip_mm, phase.peak_force_n
        ));
    }
    text
}
