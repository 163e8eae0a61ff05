//! `optimize next`: which finger to print next.

use super::calibrated::CalibrationArguments;
use super::setup::SetupArguments;
use super::{Failure, print, print_json};
use crate::calibration::bench::Posterior;
use crate::calibration::next::{Advice, Question, advise};
use crate::calibration::published;
use crate::calibration::subject::Subject;
use crate::calibration::table::design_json;
use ask_tell::stream::stream;
use clap::{Args, ValueEnum};
use insertion::space::Design;
use serde_json::{Value, json};

/// Joint draws per sample of the posterior.
const DRAWS: usize = 4;

/// Fingers that may be printed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Among {
    /// Those of the space
    Space,
    /// The 11 of the publication
    Published,
}

/// Say which finger to print next, and when to stop printing.
///
/// The finger with the largest expected gain of the best known bench range, by simulation and
/// by what was measured; the file of measurements may have no line yet.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    setup: SetupArguments,
    /// What was measured on the bench: published, or the path of a file
    #[arg(long, value_name = "FILE")]
    measurements: String,
    /// Fingers to print at a time
    #[arg(long, value_name = "K", default_value_t = 1, value_parser = clap::value_parser!(u16).range(1..=100))]
    count: u16,
    /// Fingers that may be printed
    #[arg(long, value_enum, default_value = "space")]
    among: Among,
    /// Gain of range that is worth the print and the measurement, mm; below it: stop
    #[arg(long, value_name = "MM", default_value_t = 0.1, value_parser = cost)]
    print_cost_mm: f64,
    #[command(flatten)]
    calibration: CalibrationArguments,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
    /// Say nothing while it simulates
    #[arg(long)]
    quiet: bool,
}

fn cost(text: &str) -> Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value >= 0.0 => Ok(value),
        _ => Err("a cost is a number, 0 or above, in mm of range".to_owned()),
    }
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    if arguments.setup.task.contains(',') {
        return Err(Failure::usage("give one --task: a finger is printed for one"));
    }
    let published: Vec<Design> = match arguments.among {
        Among::Space => Vec::new(),
        Among::Published => {
            let designs = published::designs().into_iter();
            designs
                .map(|design| Design::infill(design.density_percent, design.direction_deg))
                .collect()
        }
    };
    let quiet = arguments.quiet || arguments.json;
    let (setup, calibration) = (&arguments.setup, &arguments.calibration);
    let prepared = calibration.prepare(setup, &arguments.measurements, &published, quiet)?;
    let Some(subject) = prepared.subjects.first() else { return Err(Failure::no_task()) };
    let among: Vec<usize> = match arguments.among {
        Among::Space => (0..subject.of_space).collect(),
        Among::Published => published.iter().filter_map(|design| subject.finger(design)).collect(),
    };
    let benches = prepared.layout.benches(&prepared.subjects);
    let settings = calibration.settings();
    let mut random = stream(settings.seed, 0, "next");
    let dimension = prepared.layout.dimension();
    let posterior = Posterior::sampled(&benches, dimension, settings.effort, &mut random);
    let question = Question {
        among: &among,
        count: usize::from(arguments.count),
        cost_mm: arguments.print_cost_mm,
        draws: DRAWS,
    };
    let advice = advise(&benches[0], &posterior, &question, &mut random);
    if arguments.json {
        return print_json(&to_json(subject, &advice));
    }
    print(&text(subject, &advice, arguments.print_cost_mm))
}

fn to_json(subject: &Subject, advice: &Advice) -> Value {
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
        "best_known_mm": advice.best_known_mm,
        "next": next.collect::<Vec<_>>(),
        "stop": advice.stop,
    })
}

fn text(subject: &Subject, advice: &Advice, cost_mm: f64) -> String {
    let measured = subject.measured().len();
    let mut lines = vec![match advice.best_known_mm {
        Some(best) => format!(
            "{}: {measured} fingers measured, the best of them expected at {best:.1} mm",
            subject.task
        ),
        None => format!("{}: nothing measured yet; by simulation alone", subject.task),
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
