//! An answer line by line, each a name and what it says: terminal and page show the same.

use super::words::{self, ends_mm, evaluated, interval, mm, span};
use super::{Answer, AsGood, Front, OnTask, Recommended, Spread};
use ask_tell::statistics::mean;
use calibration::order::Order;
use insertion::evaluation::objective::Measure;
use insertion::evaluation::robustness::firm::REPEATS;
use insertion::evaluation::{Evaluation, OffsetStep, grid_mm};
use insertion::outcome::Outcome;
use insertion::surrogate::Prediction;
use std::iter;
use study::{ByRibs, OnBench, Recorded, StudyRecord};

/// A name, empty where the line above goes on, and what is said.
pub type Line = (String, String);

fn line(name: &str, text: impl Into<String>) -> Line {
    (name.to_owned(), text.into())
}

/// The answer in few lines, after the sentence that stands first and what may be expected.
pub fn brief(answer: &Answer) -> Vec<Line> {
    let record = answer.record;
    let one = answer.recommended.as_ref().filter(|_| answer.verdict.finger().is_some());
    let simulated = one.filter(|_| answer.front.is_none() && record.on_bench.is_none());
    let mut lines: Vec<Line> = record.on_bench.iter().flat_map(measured).collect();
    lines.extend(caveats(answer));
    if let Some(found) = simulated {
        for task in &found.tasks {
            let window = &task.measured.window;
            let [below, above] = [window.end_negative, window.end_positive].map(words::end);
            lines.push(line("ends", format!("{below} below, {above} above{}", found.on(task))));
            lines.extend(drawn(task.measured));
        }
        let limits = found.constraints.iter();
        lines.extend(limits.map(|(measure, said)| line("constraint", format!("{measure} {said}"))));
        lines.extend(found.as_good.as_ref().map(|as_good| within(answer, as_good)));
        lines.extend(found.as_good.as_ref().and_then(safe));
        lines.extend(moves(answer).map(|text| line("infill", text)));
    }
    lines.extend(answer.front.iter().flat_map(|front| members(record, front)));
    lines.push(line("searched", searched(answer)));
    let first = record.first_current();
    if first > 0 {
        let number = record.segments.len();
        let text = format!(
            "{number}, from evaluation {first}: the settings changed, and only these count"
        );
        lines.push(line("segment", text));
    }
    lines
}

/// The first designs of a front.
fn members(record: &StudyRecord, front: &Front) -> Vec<Line> {
    let objectives = &record.config.objective;
    let member = |found: &&Recorded| {
        let values = objectives.show(found.feasible().unwrap_or_default());
        line("front", format!("{values}: {}", words::finger(&found.design)))
    };
    let left = front.designs.len().saturating_sub(MEMBERS);
    let more = (left > 0).then(|| line("", format!("and {left} more, in the report")));
    front.designs.iter().take(MEMBERS).map(member).chain(more).collect()
}

/// Designs of a front that are told.
const MEMBERS: usize = 4;

/// Returns the caveats to settle before the finger is printed.
pub fn caveats(answer: &Answer) -> Vec<Line> {
    let one = answer.recommended.as_ref().filter(|_| answer.verdict.finger().is_some());
    let simulated = one.filter(|_| answer.front.is_none() && answer.record.on_bench.is_none());
    let advice = simulated.and_then(|found| found.start?.advice()).map(|text| line("start", text));
    let bench = answer.record.on_bench.iter().flat_map(|bench| &bench.warnings);
    let warnings = bench.map(|words| line("warning", words));
    advice.into_iter().chain(simulated.and_then(extrapolated)).chain(warnings).collect()
}

/// How the finger was searched for.
pub fn searched(answer: &Answer) -> String {
    let record = answer.record;
    let (task, method) = (record.config.task_name(), record.config.method());
    match record.settled {
        true => format!("{task} with {method}: settled {}", words::settled(record)),
        false => format!("{task} with {method}: {} evaluations", record.evaluations.len()),
    }
}

/// Size and spread of the set of designs that are as good.
pub fn within(answer: &Answer, as_good: &AsGood) -> Line {
    let (count, of) = (as_good.designs.len(), answer.designs);
    let within = match answer.record.config.objective.first().unit() {
        "mm" => format!(" within {} mm", answer.record.config.indifference_mm),
        _ => String::new(),
    };
    if count < 2 {
        return line("as good", format!("no other of {of} designs{within}"));
    }
    let spread: Vec<String> = as_good.spread.iter().take(NAMED).map(Spread::words).collect();
    line("as good", format!("{count} of {of} designs{within}: {}", spread.join(", ")))
}

/// Parameters whose spread is told.
const NAMED: usize = 4;

/// The safe choice, if it is another than the recommended one.
pub fn safe(as_good: &AsGood) -> Option<Line> {
    let safe = as_good.safe.as_ref()?;
    let why = match (safe.measured_mm, safe.force_n) {
        (Some(measured_mm), _) => format!("a robot measured {}", mm(measured_mm)),
        (None, Some(force_n)) => format!("least force, {force_n:.0} N"),
        (None, None) => return None,
    };
    let loss = if safe.loss > 0.0 { format!(", {} less", mm(safe.loss)) } else { String::new() };
    Some(line("safe choice", format!("{}: {why}{loss}", words::design(&safe.design.design))))
}

/// How much the parameters of the space move the range.
pub fn moves(answer: &Answer) -> Option<String> {
    let spread = interval(answer.spread_mm?);
    Some(format!("moves the searched range from {spread} over {} designs", answer.designs))
}

fn extrapolated(found: &Recommended) -> Option<Line> {
    let distance = found.design.stiffness.hull_distance;
    let text = format!("stiffness extrapolated by {distance:.2} of the measured span: measure it");
    (!found.design.stiffness.inside_hull()).then(|| line("warning", text))
}

/// The recommended finger, what it tolerates and how firm that is, what is as good, and whether
/// it matters.
pub fn recommended(answer: &Answer, found: &Recommended) -> Vec<Line> {
    let config = &answer.record.config;
    let mut lines = vec![line("best design", evaluated(found.design))];
    lines.extend(found.firm_range_mm.map(|range_mm| {
        let repeats = format!("{REPEATS} of {REPEATS} repeats, friction, start, step varied");
        line("firm range", format!("{}: inserts in {repeats}", mm(range_mm)))
    }));
    if let Some((measure, value)) = found.objective {
        let of =
            config.aggregate.as_ref().map_or(String::new(), |a| format!(" ({a} of the tasks)"));
        lines.push(line(measure.name(), format!("{}{of}", measure.show(value))));
    }
    let limits = found.constraints.iter();
    lines.extend(limits.map(|(measure, words)| line("constraint", format!("{measure} {words}"))));
    for task in &found.tasks {
        if config.several_tasks() {
            lines.push(line("task", task.name));
        }
        lines.extend(window(task.measured));
        lines.extend(task.firm.map(|firm| match firm.window_mm() {
            None => line("firm window", "none: a repeat fails even at the nominal start"),
            Some(window) => line("firm window", format!("{} mm", span(window))),
        }));
        lines.extend(Measure::PeakForce.value(task.measured).map(|peak_n| {
            let peak = Measure::PeakForce.show(peak_n);
            let between = "between plug and socket, over the inserted trials";
            line("peak force", format!("{peak} {between}"))
        }));
        lines.extend(drawn(task.measured));
    }
    lines.extend(found.by_ribs.iter().flat_map(|by_ribs| {
        let lines = self::by_ribs(by_ribs);
        let named = lines.len() > 1;
        let name = |((name, text), task): (Line, &OnTask)| match named {
            true => (name, format!("{text} on {}", task.name)),
            false => (name, text),
        };
        lines.into_iter().zip(&found.tasks).map(name).collect::<Vec<_>>()
    }));
    lines.extend(stiffness(&found.design.stiffness));
    if let Some((measure, _)) = found.objective.filter(|_| !answer.walked.is_empty()) {
        let fell = found.searched.map_or(String::new(), |before| {
            format!("; the search had given this one {}", measure.show(before))
        });
        let count = answer.walked.len();
        let plural = if count == 1 { "" } else { "s" };
        lines.push(line("walked", format!("step by step: {count} design{plural}{fell}")));
    }
    lines.extend(found.as_good.iter().flat_map(|as_good| equivalent(answer, as_good)));
    lines.extend(answer.spread_mm.map(|spread| {
        let (designs, spread) = (answer.designs, interval(spread));
        line("spread", format!("ranges of the {designs} designs: {spread}"))
    }));
    lines.extend(raced(answer));
    lines.extend(answer.orders.iter().map(robot));
    if answer.orders.is_empty() && answer.record.on_bench.is_none() {
        lines.push(line("robot", "no bench experiment is known: print and measure the best few"));
    }
    lines
}

/// How many designs were out of the race early, and what is known of them.
fn raced(answer: &Answer) -> Option<Line> {
    let raced = || answer.record.current().iter().filter(|recorded| recorded.raced());
    let rates = raced().flat_map(|recorded| &recorded.tasks).flat_map(|task| &task.success);
    let tried = rates.filter_map(|rate| rate.raced()).map(f64::from);
    mean(tried).map(|mean| {
        let [designs, of] = [raced().count(), answer.designs];
        let early =
            format!("{designs} of {of} designs ended early, after {mean:.0} draws in the mean");
        line("raced", format!("{early}: they could not reach the best"))
    })
}

/// How many designs are as good, and which of them to take for other reasons.
fn equivalent(answer: &Answer, as_good: &AsGood) -> Vec<Line> {
    let named = as_good.alternatives.iter().map(|(reason, found, value, unit)| {
        let Recorded { design, index, .. } = found;
        let text = format!("{}: {value:.1} {unit} (evaluation {index})", design.labelled());
        (format!("  {reason}"), text)
    });
    iter::once(within(answer, as_good)).chain(named).collect()
}

/// How the robot orders the designs, as far as that is known.
fn robot((task, order): &(&str, Order)) -> Line {
    // A random order of n fingers has a rank correlation of mean 0 and variance 1 / (n - 1), taken as
    // normal: it does as well in less than 5 % of cases.
    let beyond_chance = order.spearman * (order.fingers as f64 - 1.0).sqrt() > 1.645;
    let chance = match beyond_chance {
        true => "",
        false => "; no better than chance: measure the best few",
    };
    line(
        "robot",
        format!(
            "on {task} {} ranked {} printed fingers {:+.2} like the bench (1: alike){chance}",
            order.source.words(),
            order.fingers,
            order.spearman
        ),
    )
}

/// The finger that is the best on the bench, and how far that is to be trusted.
pub fn on_bench(found: &OnBench) -> Vec<Line> {
    let Some(best) = found.best.first() else { return Vec::new() };
    let mut lines = vec![
        line("best on bench", best.design.labelled()),
        line(
            "bench range",
            format!(
                "{:.1} mm (80 %: {:.1} to {:.1}); the best of all {} fingers with probability {:.1} %",
                best.range_mm,
                best.low_mm,
                best.high_mm,
                found.fingers,
                100.0 * best.probability_best
            ),
        ),
    ];
    lines.extend(simulated(found));
    lines.push(line("measured", trust(found)));
    lines.extend(found.warnings.iter().map(|words| line("warning", words)));
    lines
}

/// The same in few lines.
fn measured(found: &OnBench) -> Vec<Line> {
    let chance = found.best.first().map(|best| {
        let [percent, of] = [100.0 * best.probability_best, found.fingers as f64];
        line("chance", format!("{percent:.0} % to be the best of all {of} fingers"))
    });
    chance.into_iter().chain(simulated(found)).collect()
}

/// The finger that is the best on the bench, as simulated.
fn simulated(found: &OnBench) -> Vec<Line> {
    let range = Measure::Range.value(&found.simulated).map(mm);
    let range = range.unwrap_or("no range".to_owned());
    let mut simulated = window(&found.simulated);
    simulated[0] = line("simulated", format!("{range}; {}", simulated[0].1));
    simulated
}

fn trust(found: &OnBench) -> String {
    let (trust, count) = (&found.trust, found.measured);
    let Some(deviation) = trust.mean_deviation_percent else { return format!("{count} fingers") };
    let rank = trust.spearman.map_or("-".to_owned(), |rank| format!("{rank:+.2}"));
    format!(
        "{count} fingers; each predicted without it: {deviation:.1} % off, Spearman {rank}, {} of {} \
         in the interval",
        trust.inside, trust.fingers
    )
}

/// The window of an evaluation and what ended it.
pub fn window(evaluation: &Evaluation) -> Vec<Line> {
    let window = &evaluation.window;
    let end = |outcome: Option<Outcome>| outcome.map_or("limit of the search", Outcome::label);
    if window.nominal != Outcome::Inserted {
        let nominal = end(Some(window.nominal));
        return vec![line("window", format!("none: the nominal start ends with {nominal}"))];
    }
    let [below, above] = [window.end_negative, window.end_positive].map(end);
    vec![
        line("window", format!("{} mm", span(ends_mm(window)))),
        line("ends", format!("{below} below, {above} above")),
    ]
}

/// Predicted stiffness, its uncertainty, and whether it is an extrapolation.
pub fn stiffness(prediction: &Prediction) -> [Line; 2] {
    let [compliance, assembly] = [prediction.compliance, prediction.assembly].map(words::stiffness);
    let hull = match prediction.inside_hull() {
        true => "inside the measured designs".to_owned(),
        false => format!("{:.2} spans OUTSIDE the measured designs", prediction.hull_distance),
    };
    let stiffness = format!("compliance {compliance}, assembly {assembly}, measured model");
    [line("stiffness", stiffness), line("", hull)]
}

/// Success rate and robust range, as far as they were measured.
pub fn drawn(evaluation: &Evaluation) -> Vec<Line> {
    let success = evaluation.success.as_ref().map(|success| {
        let [rate, failures] = words::success(success);
        [line("success rate", rate), line("", format!("failures {failures}"))]
    });
    let robust = evaluation.robust.as_ref().map(words::robust);
    let robust = robust.map(|robust| line("robust range", robust));
    success.into_iter().flatten().chain(robust).collect()
}

/// Tolerance of the finger with springs computed from its ribs, task by task.
pub fn by_ribs(found: &ByRibs) -> Vec<Line> {
    let tasks = match found {
        ByRibs::Refused(why) => return vec![line("from its ribs", why)],
        ByRibs::Measured(tasks) => tasks,
    };
    tasks.iter().map(|evaluation| line("from its ribs", tolerated(evaluation))).collect()
}

/// Range and window in one line, and from where they count.
fn tolerated(Evaluation { window, taught, .. }: &Evaluation) -> String {
    if window.nominal != Outcome::Inserted {
        return format!("none: its nominal start ends with {}", window.nominal.label());
    }
    let start =
        taught.map_or(String::new(), |steps| format!(", start taught {:+.1}", grid_mm(steps)));
    let (range, ends) = (mm(window.range_mm()), span(ends_mm(window)));
    format!("{range} ({ends}{start}); --finger-model computed")
}

/// Where a taught start came to lie; `None` if it was not taught.
pub fn taught(steps: Option<OffsetStep>) -> Option<Line> {
    let mm = grid_mm(steps?);
    Some(line("start", format!("taught: {mm:+.1} mm from that of the task file")))
}
