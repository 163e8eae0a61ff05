//! What is printed of an evaluation and of a whole study.

use super::{Failure, print, print_json};
use finger_opt::evaluation::{Evaluation, Outcome};
use finger_opt::study::{Ending, Recorded, Study};
use finger_opt::surrogate::Prediction;
use finger_opt::units::N_PER_MM;
use serde_json::{Value, json};
use std::fmt::Write;

/// Prints the result of a study, `known` evaluations of which were in the cache.
pub fn show(study: &Study, ending: Ending, known: u64, as_json: bool) -> Result<(), Failure> {
    if as_json {
        return print_json(&to_json(study, ending, known));
    }
    print_text(study, ending, known)
}

fn print_text(study: &Study, ending: Ending, known: u64) -> Result<(), Failure> {
    let (config, done) = (&study.config, study.evaluations.len());
    let mut text = String::new();
    let mut line = |line: String| {
        text.push_str(&line);
        text.push('\n');
    };
    let end = match ending {
        Ending::SpaceExhausted => ": every design of the space",
        Ending::Converged => ": the polish has converged",
        Ending::BudgetSpent | Ending::Interrupted => "",
    };
    line(format!("{} with {}: {done} evaluations{end}", config.task, config.method()));
    match finger_opt::study::best(&study.evaluations) {
        None => line("no evaluation gave a value".to_owned()),
        Some(best) => {
            line(format!("best design   {} (evaluation {})", best.design, best.index));
            if let Some(value) = best.value {
                line(format!("{:<13} {value:.1} mm", config.objective));
            }
            line(window(&best.evaluation));
            line(stiffness(&best.stiffness));
        }
    }
    if known > 0 {
        line(format!("cache         {known} evaluations were known from other studies"));
    }
    let page = study.dir().join(super::report::PAGE);
    line(format!("study         {} (see {})", study.dir().display(), page.display()));
    print(&text)
}

/// The window of an evaluation and what ended it.
pub fn window(evaluation: &Evaluation) -> String {
    let window = &evaluation.window;
    if window.nominal != Outcome::Inserted {
        return format!(
            "window        none: the nominal start ends with {}",
            end(Some(window.nominal))
        );
    }
    format!(
        "window        {:.1} to {:+.1} mm; ends: {} below, {} above",
        window.negative_mm(),
        window.positive_mm(),
        end(window.end_negative),
        end(window.end_positive)
    )
}

fn end(outcome: Option<Outcome>) -> String {
    match outcome {
        None => "limit of the search".to_owned(),
        Some(Outcome::Inserted) => "inserted".to_owned(),
        Some(Outcome::Failed(class)) => class.label().to_owned(),
        Some(Outcome::Diverged) => "diverged".to_owned(),
    }
}

/// Predicted stiffness, its uncertainty, and whether it is an extrapolation.
pub fn stiffness(prediction: &Prediction) -> String {
    let mut text = String::from("stiffness    ");
    for (axis, estimate) in
        [("compliance", prediction.compliance), ("assembly", prediction.assembly)]
    {
        let (mean, sd) = (estimate.mean / N_PER_MM, estimate.sd / N_PER_MM);
        // Writing to a String cannot fail.
        let _ = write!(text, " {axis} {mean:.2} ± {sd:.2} N/mm,");
    }
    if prediction.inside_hull() {
        text.push_str(" inside the measured designs");
    } else {
        let distance = prediction.hull_distance;
        let _ = write!(text, " {distance:.2} spans OUTSIDE the measured designs");
    }
    text
}

fn to_json(study: &Study, ending: Ending, known: u64) -> Value {
    let config = &study.config;
    let ending = match ending {
        Ending::BudgetSpent => "budget_spent",
        Ending::SpaceExhausted => "space_exhausted",
        Ending::Converged => "converged",
        Ending::Interrupted => "interrupted",
    };
    json!({
        "task": config.task,
        "space": config.space.name(),
        "robot": config.robot,
        "engine": config.engine,
        "optimizer": config.optimizer,
        "objective": config.objective,
        "seed": config.seed,
        "budget": config.budget,
        "polish": config.polish,
        "evaluations": study.evaluations.len(),
        "cached": known,
        "ending": ending,
        "best": finger_opt::study::best(&study.evaluations).map(recorded_json),
        "study": study.dir(),
    })
}

fn recorded_json(recorded: &Recorded) -> Value {
    let mut fields = json!({
        "evaluation": recorded.index,
        "objective_mm": recorded.value,
        "stiffness": stiffness_json(&recorded.stiffness),
    });
    merge(&mut fields, json!(recorded.design));
    merge(&mut fields, evaluation_json(&recorded.evaluation));
    fields
}

/// The keys every evaluation is printed with.
pub fn evaluation_json(evaluation: &Evaluation) -> Value {
    let window = &evaluation.window;
    json!({
        "range_mm": window.range_mm(),
        "negative_mm": window.negative_mm(),
        "positive_mm": window.positive_mm(),
        "nominal": outcome_word(window.nominal),
        "failure_negative": failure(window.end_negative),
        "failure_positive": failure(window.end_positive),
        "failure_counts": evaluation.failure_counts,
        "diverged": evaluation.diverged,
        "peak_force_n": evaluation.peak_force_n,
        "slip_mm": evaluation.slip_mm,
        "trials": evaluation.trials,
        "simulated_s": evaluation.simulated_s,
    })
}

/// A prediction with its uncertainty.
pub fn stiffness_json(prediction: &Prediction) -> Value {
    json!({
        "compliance_n_per_mm": prediction.compliance.mean / N_PER_MM,
        "compliance_sd_n_per_mm": prediction.compliance.sd / N_PER_MM,
        "assembly_n_per_mm": prediction.assembly.mean / N_PER_MM,
        "assembly_sd_n_per_mm": prediction.assembly.sd / N_PER_MM,
        "hull_distance": prediction.hull_distance,
        "inside_hull": prediction.inside_hull(),
    })
}

/// `inserted`, `failed` or `diverged`.
pub fn outcome_word(outcome: Outcome) -> &'static str {
    match outcome {
        Outcome::Inserted => "inserted",
        Outcome::Failed(_) => "failed",
        Outcome::Diverged => "diverged",
    }
}

/// The failure class, 1 to 4, if it was a failure.
pub fn failure(outcome: Option<Outcome>) -> Option<u8> {
    match outcome {
        Some(Outcome::Failed(class)) => Some(class.number()),
        _ => None,
    }
}

/// Adds the fields of one JSON object to another.
pub fn merge(fields: &mut Value, more: Value) {
    if let (Value::Object(fields), Value::Object(more)) = (fields, more) {
        fields.extend(more);
    }
}
