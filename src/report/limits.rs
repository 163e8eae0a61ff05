//! Limits of the numbers of a study.

use crate::answer::Answer;
use crate::calibration::order::{Order, OrderSource, rank_correlation};
use crate::study::StudyRecord;
use insertion::evaluation::objective::Measure;
use insertion::stiffness::Axis;
use insertion::surrogate::Model;
use maud::{Markup, html};

/// Key of the remote centre, where a space has it among its parameters.
const REMOTE_CENTRE_KEY: &str = "finger.rcc_mm";

pub(super) fn section(answer: &Answer, model: &Model) -> Markup {
    let record = answer.record;
    let goals = record.config.goals();
    html! {
        ul {
            li {
                @match &record.on_bench {
                    None => {
                        "These are results of a contact simulation. No finger was printed for this study."
                    }
                    Some(found) => {
                        "These are results of a contact simulation, but for the bench range: that rests \
                        on " (found.measured) " measured fingers, and far from them on its priors."
                    }
                }
            }
            li { (published_order(answer)) }
            li {
                "The ends of a window are known to the 0.1 mm grid: the next step does not insert, \
                so the end lies within 0.1 mm beyond the one given, and the range is up to 0.2 mm \
                wider. Differences of 0.2 mm between designs are at this resolution."
            }
            li { (gaps(answer)) }
            li { (stiffness(model, goals.need(Measure::RobustRange))) }
            @if goals.need_draws() {
                li {
                    "Success rate and robust range are those of the assumed errors, not of your \
                    cell. All designs meet the same draws, so differences between designs are \
                    surer than the values."
                }
            }
            li { (remote_centre(record)) }
        }
    }
}

fn gaps(answer: &Answer) -> String {
    let walked = match answer.walked.len() {
        0 => "No design was walked, step by step. For any design ".to_owned(),
        count => format!("The best {count} designs were walked, step by step. For any other "),
    };
    format!(
        "Not every step of a window was tried. A study looks every 0.5 mm outward and bisects \
         before the first failure, so it can step over a gap: starts that fail between starts \
         that insert. {walked}use optimize evaluate --walk before you print."
    )
}

fn published_order(answer: &Answer) -> String {
    let here = |&(task, Order { spearman, fingers, source }): &(&str, Order)| {
        let whose = match source {
            OrderSource::Study => "this study's",
            OrderSource::Validation => "our validated",
            OrderSource::OtherRig => {
                "our validated (paper's fingers, robot servo: not this study's)"
            }
        };
        let published = rank_correlation(task)
            .map_or(String::new(), |(r, n)| format!("; of the published ones {r:+.2} over {n}"));
        format!(
            " On {task} the rank correlation between {whose} simulated ranges and those of the bench \
             is {spearman:+.2} over {fingers} fingers (+1: same order, −1: opposite order){published}."
        )
    };
    let here: String = answer.orders.iter().map(here).collect();
    format!(
        "In the published simulation of these tasks, ranges rank the designs in the opposite \
         order to the robot on two of four tasks.{here} Confirm the best design, and a very \
         different one, on the robot."
    )
}

fn stiffness(model: &Model, robust: bool) -> String {
    let error = |axis| {
        let percent = model.chosen(axis)?.mean_absolute_percent;
        percent.is_finite().then(|| format!("{percent:.1} % in {}", axis.label()))
    };
    let errors: Vec<String> = Axis::ALL.into_iter().filter_map(error).collect();
    let missed = match errors.is_empty() {
        true => "How far it misses others is not known.".to_owned(),
        false => format!(
            "Each left out of the fit in turn, they are missed by {} on average.",
            errors.join(" and by ")
        ),
    };
    let ribs = match model.ratios {
        true => ", and from the ribs of the finger",
        false => "",
    };
    let carried = if robust {
        "The windows shown are those of fingers of exactly the predicted stiffness; the robust \
         range alone carries its error."
    } else {
        "The range is that of a finger of exactly the predicted stiffness; its error is not \
         carried into the range."
    };
    format!("Stiffness is predicted from {}{ribs}. {missed} {carried}", model.counted(),)
}

fn remote_centre(record: &StudyRecord) -> &'static str {
    let parameters = &record.config.space.parameters;
    if parameters.iter().any(|parameter| parameter.key == REMOTE_CENTRE_KEY) {
        "The finger's remote centre is a number of the design here, set apart from the infill. In \
         truth it moves with the infill direction; whether a finger with this infill and this \
         remote centre can be made was not checked. It matters for long, slender plugs."
    } else {
        "The finger's remote centre is where the task file puts it: at one distance for all \
         designs, or along a straight line over the infill direction. On a printed finger it moves \
         with the infill; how far was not measured. It matters for long, slender plugs."
    }
}
