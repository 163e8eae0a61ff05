//! `optimize next`: which finger to print next.

use super::progress::Progress;
use super::{Failure, print, print_json};
use crate::session::{Advised, NextRequest};
use calibration::table::design_json;
use clap::Args;
use insertion::trial::NEVER;
use serde_json::{Value, json};

/// Say which finger to print next, and when to stop printing.
///
/// The finger with the largest expected gain of the best known bench range, by simulation and
/// by what was measured; the file of measurements may have no line yet, or not be there.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    request: NextRequest,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
    /// Say nothing while it simulates
    #[arg(long)]
    quiet: bool,
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let Arguments { request, json, quiet } = arguments;
    let mut progress = Progress::of_simulations(request.how.simulations(), *quiet || *json);
    let found = request.run(&NEVER, &mut |event| progress.see(event))?;
    drop(progress);
    if *json {
        return print_json(&self::json(&found));
    }
    print(&text(&found, request))
}

/// Output of `--json`.
pub fn json(Advised { subject, advice, missing }: &Advised) -> Value {
    let next = advice.next.iter().map(|print| {
        let mut fields = design_json(&subject.designs[print.finger]);
        fields.insert("expected_mm".into(), json!(print.expected_mm));
        fields.insert("low_mm".into(), json!(print.low_mm));
        fields.insert("high_mm".into(), json!(print.high_mm));
        fields.insert("expected_gain_mm".into(), json!(print.expected_gain_mm));
        fields.insert("reason".into(), json!(print.reason));
        Value::Object(fields)
    });
    json!({
        "task": subject.task,
        "measured": subject.measured().len(),
        "measurements_missing": missing,
        "best_known_mm": advice.best_known_mm,
        "next": next.collect::<Vec<_>>(),
        "stop": advice.stop,
    })
}

fn text(Advised { subject, advice, missing }: &Advised, request: &NextRequest) -> String {
    let (measured, cost_mm) = (subject.measured().len(), request.print_cost_mm);
    let file = missing.then(|| format!(" ({} does not exist)", request.bench.measurements));
    let mut lines = vec![match advice.best_known_mm {
        Some(best) => format!(
            "{}: {measured} fingers measured, the best of them expected at {best:.1} mm",
            subject.task
        ),
        None => format!(
            "{}: nothing measured yet{}; by simulation alone",
            subject.task,
            file.unwrap_or_default()
        ),
    }];
    for (i, print) in advice.next.iter().enumerate() {
        lines.push(format!("{}. {}", i + 1, subject.designs[print.finger].labelled()));
        lines.push(format!(
            "   expected {:.1} mm (80 %: {:.1} to {:.1}), gain {:.2} mm: {}",
            print.expected_mm, print.low_mm, print.high_mm, print.expected_gain_mm, print.reason
        ));
    }
    if advice.stop {
        lines.push(format!("stop: no finger is expected to gain more than {cost_mm} mm"));
    }
    lines.join("\n") + "\n"
}
