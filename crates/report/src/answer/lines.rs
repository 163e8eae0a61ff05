//! Lines of an answer, each with a name and a text, for the terminal and the page.

use super::words::{self, ends_mm, evaluated, interval, mm, span};
use super::{Answer, Front, LeftOut, OnTask, Recommended, Spread, Ties, Verdict};
use ask_tell::statistics::mean;
use calibration::rank_correlation::{Order, RankCorrelation};
use calibration::verdict::coverage;
use insertion::evaluation::robustness::firm::REPEATS;
use insertion::outcome::{STOP_REMEDY, stop_words};
use insertion::{Evaluation, Measure, Outcome, Prediction, Robot, Variable, grid_mm};
use parameters::label;
use std::iter;
use study::{BenchPrediction, ByRibs, Recorded, StudyRecord};

/// Name and text; the name is empty if the text continues the line above.
pub type Line = (String, String);

fn line(name: &str, text: impl Into<String>) -> Line {
    (name.to_owned(), text.into())
}

/// Returns the short form of the answer: the lines below its headline and the expected performance.
pub fn brief(answer: &Answer) -> Vec<Line> {
    let record = answer.record;
    let mut lines = measured(answer);
    lines.extend(record.on_bench.iter().flat_map(on_bench));
    lines.extend(caveats(answer));
    if let Some(found) = simulated_finger(answer) {
        lines.extend(simulated(answer, found));
        lines.extend(spread(answer));
        lines.extend(edge(answer));
    }
    lines.extend(answer.front.iter().flat_map(|front| members(record, front)));
    lines.push(line("search", searched(answer)));
    let first = record.first_current();
    if first > 0 {
        let number = record.segments.len();
        let text = format!(
            "{number}, since evaluation {first}: earlier ones had other settings and do not count"
        );
        lines.push(line("segment", text));
    }
    lines
}

/// Returns the best published finger with its simulated range, and whether the simulation ranks the published fingers
/// like the robot, unless the user's measurements are known.
pub fn measured(answer: &Answer) -> Vec<Line> {
    let compared = |found: &RankCorrelation| {
        let RankCorrelation { spearman, fingers, source, best: finger, .. } = found;
        let order = match found.order() {
            Order::Like => "like the robot",
            Order::Chance => "no better than chance",
            Order::Opposite => "opposite to the robot",
        };
        let on = words::on(&answer.record.config, &found.task);
        let (best, model) = (words::design(&finger.design), mm(finger.simulated_mm));
        let measured = mm(finger.measured_mm);
        let ranking =
            format!("the model ranks {fingers} fingers {order} (Spearman {spearman:+.2})");
        line("measured", format!("best {best}: {measured}{on} ({source} {model}); {ranking}"))
    };
    match (answer.verdict.finger(), &answer.record.on_bench) {
        (Some(_), None) => answer.rank_correlations.iter().map(compared).collect(),
        // The headline names the best measured finger.
        _ => Vec::new(),
    }
}

/// Returns the recommended design; `None` if measurements were used, for a Pareto front, or without a finger to print.
fn simulated_finger<'a, 'b>(answer: &'b Answer<'a>) -> Option<&'b Recommended<'a>> {
    let alone = answer.front.is_none() && answer.record.on_bench.is_none();
    answer.recommended.as_ref().filter(|_| alone && answer.verdict.finger().is_some())
}

/// Returns the outcomes at the ends of the windows of a recommended design, its success rates, constraints, ties and
/// the safe choice, and the design that was widest in the search.
pub fn simulated(answer: &Answer, found: &Recommended) -> Vec<Line> {
    let config = &answer.record.config;
    let of_task = |task: &OnTask| {
        let window = &task.measured.window;
        let [below, above] = [window.end_negative, window.end_positive].map(words::end);
        let (on, stops) = (words::on(config, task.name), some_stops(task.measured));
        let ends = line("ends", format!("{below} below, {above} above{on}{stops}"));
        iter::once(ends).chain(drawn(task.measured)).collect::<Vec<_>>()
    };
    let tasks = found.design.tasks();
    let limits = config.constraints.iter().map(|c| format!("{} {}", c.measure, c.words(&tasks)));
    let limits = limits.map(|text| line("constraint", text));
    let tied = found.ties.iter().map(|ties| tied(answer, ties));
    let safe = found.ties.iter().filter_map(safe);
    let why = left_out(answer).into_iter().chain(widest(answer));
    found.tasks.iter().flat_map(of_task).chain(limits).chain(why).chain(tied).chain(safe).collect()
}

/// Returns the best design with its force and the limit, if a tied one is recommended in its place.
pub fn left_out(answer: &Answer) -> Option<Line> {
    let LeftOut { design, force, gain } = answer.left_out.as_ref()?;
    let config = &answer.record.config;
    let more = format!(", {} more", config.objective.first().show(*gain));
    let more = if *gain > 0.0 { &more } else { "" };
    let force = force.words(&config.robot);
    Some(line("left out", format!("{}{more}: {force}", words::design(&design.design))))
}

/// Returns the best design of the search with its value in the repeats (with varied friction, start and time step), if
/// it was repeated and another design is recommended.
pub fn widest(answer: &Answer) -> Option<Line> {
    let found = answer.recommended.as_ref()?;
    let (measure, _) = found.objective.filter(|(measure, _)| measure.unit() == "mm")?;
    let left_out = answer.left_out.as_ref().map(|left_out| left_out.design);
    let named = [Some(found.design), answer.design_to_print(), left_out];
    let named = named.map(|named| named.map(|named| named.index));
    let best = answer.record.best().filter(|best| !named.contains(&Some(best.index)))?;
    let repeated = measure.show(*answer.record.firm_values.get(&best.index)?);
    let (design, searched) = (words::design(&best.design), measure.show(best.value()?));
    Some(line("widest", format!("{design}: {searched} in the search, {repeated} in repeats")))
}

/// Returns the first designs of a front.
fn members(record: &StudyRecord, front: &Front) -> Vec<Line> {
    let objectives = &record.config.objective;
    let member = |found: &&Recorded| {
        let values = objectives.show(found.feasible().unwrap_or_default());
        line("front", format!("{values}: {}", words::design(&found.design)))
    };
    let left = front.designs.len().saturating_sub(MEMBERS);
    let more = (left > 0).then(|| line("", format!("and {left} more, in the report")));
    front.designs.iter().take(MEMBERS).map(member).chain(more).collect()
}

/// Largest number of designs of a front that are listed.
const MEMBERS: usize = 4;

/// Returns advice on robot stops and on the start, and warnings to read before the finger is printed.
pub fn caveats(answer: &Answer) -> Vec<Line> {
    let found = simulated_finger(answer);
    let advice = found.and_then(|found| found.start.as_ref()?.advice.as_deref());
    let advice = advice.map(|text| line("start", text));
    let bench = answer.record.on_bench.iter().flat_map(|bench| &bench.warnings);
    let warnings = bench.map(|words| line("warning", words));
    let stiffness = found.map(|found| &found.design.stiffness).filter(|of| !of.inside_hull());
    let extrapolated = stiffness.map(|of| {
        let distance = format!("{:.2} of the measured span", of.hull_distance);
        line("warning", format!("stiffness extrapolated by {distance}: measure this finger"))
    });
    let robot = answer.record.limits.robot.as_ref().and_then(Robot::remark);
    let robot = robot.map(|text| line("warning", text));
    let stops = answer.stopped().map(|_| line("warning", STOP_REMEDY));
    stops.into_iter().chain(advice).chain(extrapolated).chain(warnings).chain(robot).collect()
}

/// Returns the warning that precedes the recommendation: a contact force above a limit, unless the headline names it as
/// the cause of robot stops.
pub fn first(answer: &Answer) -> Option<Line> {
    let stops = answer.stopped().is_some() && !answer.force.as_ref()?.of_connector;
    force(answer).filter(|_| !stops)
}

/// Returns a contact force above the limit of connector or robot, with a remedy.
pub fn force(answer: &Answer) -> Option<Line> {
    let excess = answer.force.as_ref()?;
    let acceptable = acceptable(answer);
    let remedy = match answer.record.on_bench {
        // Studies with measurements do not support constraints.
        Some(_) => format!("try optimize task tune FILE --max-force-n {acceptable:.0}"),
        None => format!("try --constraint 'peak-force<={acceptable:.0}'"),
    };
    Some(line("force", format!("{}; {remedy}", excess.words(&answer.record.config.robot))))
}

/// Returns the largest force that is acceptable for all connectors and the robot, rounded down, N.
fn acceptable(answer: &Answer) -> f64 {
    let limits = &answer.record.limits;
    let each = (0..answer.record.config.tasks.len()).map(|task| limits.acceptable(task));
    each.fold(f64::INFINITY, f64::min).floor()
}

/// Returns tasks, optimizer, robot, number of evaluations, and the mating forces of the connectors.
pub fn searched(answer: &Answer) -> String {
    let record = answer.record;
    let config = &record.config;
    let (task, method, robot) = (config.task_name(), config.method(), &config.robot);
    let evaluated = match record.settled {
        true => format!("settled {}", words::settled(record)),
        false => format!("{} evaluations", record.evaluations.len()),
    };
    let mut forces: Vec<_> =
        record.limits.mating.iter().copied().map(words::mating_force).collect();
    forces.dedup();
    format!("{task} with {method}, robot {robot}: {evaluated}; mating force {}", forces.join(", "))
}

/// Returns the number of designs that tie with the recommended one, their parameters, and the losses of others among
/// these parameters and of the nearest ones.
pub fn tied(answer: &Answer, ties: &Ties) -> Line {
    let (count, of) = (ties.designs.len(), answer.designs);
    let measure = answer.record.config.objective.first();
    let in_mm = measure.unit() == "mm";
    let within = match in_mm {
        true => format!(" within {} mm", answer.record.config.indifference_mm),
        false => String::new(),
    };
    let spread: Vec<String> = ties.spread.iter().take(SPREADS).map(Spread::words).collect();
    let tied = match count {
        ..2 => format!("none of {of} designs{within}"),
        _ => format!("{count} of {of} designs{within}: {}", spread.join(", ")),
    };
    let others =
        ties.loss_within.map(|loss| format!("others there lose up to {}", measure.show(loss)));
    let matters = in_mm && !matches!(answer.verdict, Verdict::Any { .. });
    let narrow = ties.narrow.filter(|_| matters).map(|(steps, loss)| {
        let nearest = match steps {
            1 => "narrow: evaluated neighbours".to_owned(),
            _ => format!("the nearest others, {steps} steps away,"),
        };
        format!("{nearest} lose at least {}", mm(loss))
    });
    line("ties", [Some(tied), others, narrow].into_iter().flatten().collect::<Vec<_>>().join("; "))
}

/// Largest number of parameters whose values are listed.
const SPREADS: usize = 4;

/// Returns the safe choice, or the tied design with the least force, and the reason for it, if there is one.
pub fn safe(ties: &Ties) -> Option<Line> {
    let safe = ties.safe.as_ref()?;
    let why = match (safe.measured_mm, safe.force_n) {
        (Some(measured_mm), _) => format!("measured {} on a robot", mm(measured_mm)),
        (None, Some(force_n)) => format!("{force_n:.0} N in simulation"),
        (None, None) => return None,
    };
    let loss = if safe.loss > 0.0 { format!(", {} less", mm(safe.loss)) } else { String::new() };
    Some(line(safe.name(), format!("{}: {why}{loss}", words::design(&safe.design.design))))
}

/// Returns the smallest and largest range of the designs that insert, and the number of the others.
pub fn spread(answer: &Answer) -> Option<Line> {
    let spread = interval(answer.spread_mm?);
    let failing = answer.record.current().iter().filter(|design| !design.inserts_on_all()).count();
    let fails = if failing > 0 { format!("; {failing} fail at the start") } else { String::new() };
    Some(line("infill", format!("range {spread} over {} designs{fails}", answer.designs)))
}

/// Returns the parameters of the finger to print that have the least or the largest value of the space; `None` if there
/// are none, or if any finger will do.
pub fn edge(answer: &Answer) -> Option<Line> {
    let matters = !matches!(answer.verdict, Verdict::Any { .. });
    let design = answer.design_to_print().filter(|_| matters)?;
    let at = |parameter: &Variable| {
        let value = design.design.get(&parameter.key)?;
        let (name, unit) = label(&parameter.key);
        let bounds = [(parameter.low, "least"), (parameter.high, "largest")];
        let (_, bound) = bounds.into_iter().find(|(bound, _)| *bound == value)?;
        Some(format!("{name} {value}{unit} is the {bound}"))
    };
    let free = answer.record.config.space.parameters.iter().filter(|p| p.low != p.high);
    let found: Vec<String> = free.filter_map(at).collect();
    (!found.is_empty()).then(|| line("edge", format!("{} of the space searched", found.join(", "))))
}

/// Returns the details of the recommendation by simulation that [`brief`] omits.
pub fn recommended(answer: &Answer, found: &Recommended) -> Vec<Line> {
    let config = &answer.record.config;
    let mut lines = vec![line("best design", evaluated(found.design))];
    lines.extend(found.firm_range_mm.map(|range_mm| {
        let text = format!("{}: inserts in {REPEATS} of {REPEATS} repeats", mm(range_mm));
        line("firm range", format!("{text} with slightly varied friction, start and time step"))
    }));
    if let Some((measure, value)) = found.objective {
        let of =
            config.aggregate.as_ref().map_or(String::new(), |a| format!(" ({a} of the tasks)"));
        lines.push(line(measure.name(), format!("{}{of}", measure.show(value))));
    }
    for task in &found.tasks {
        lines.extend(config.several_tasks().then(|| line("task", task.name)));
        lines.extend(window(task.measured).into_iter().take(1));
        lines.extend(task.firm.map(|firm| match firm.window_mm() {
            None => line("firm window", "none: a repeat fails even at the nominal start"),
            Some(window) => line("firm window", format!("{} mm", span(window))),
        }));
        lines.extend(Measure::PeakForce.value(task.measured).map(|peak_n| {
            let peak = Measure::PeakForce.show(peak_n);
            line("peak force", format!("{peak} in the trials that insert"))
        }));
    }
    if let Some(ribs) = found.by_ribs {
        lines.extend(found.tasks.iter().enumerate().filter_map(|(at, task)| {
            let (name, text) = by_ribs(ribs, (at, task.measured))?;
            Some((name, text + &words::on(config, task.name)))
        }));
    }
    lines.extend(stiffness(&found.design.stiffness));
    if !answer.walked.is_empty() {
        let designs = input::counted(answer.walked.len(), "design");
        lines.push(line("walked", format!("step by step: {designs}")));
    }
    if answer.record.on_bench.is_some() {
        lines.extend(simulated(answer, found));
    }
    lines.extend(raced(answer));
    lines
}

/// Returns the number of designs whose success rate was estimated from fewer draws, because it could no longer exceed
/// the best (racing).
fn raced(answer: &Answer) -> Option<Line> {
    let raced = || answer.record.current().iter().filter(|recorded| recorded.raced());
    let rates = raced().flat_map(|recorded| &recorded.tasks).flat_map(|task| &task.success);
    mean(rates.filter_map(|rate| rate.raced()).map(f64::from)).map(|mean| {
        let [designs, of] = [raced().count(), answer.designs];
        let early =
            format!("{designs} of {of} designs ended early, after {mean:.0} draws on average");
        line("raced", format!("{early}: they could not reach the best"))
    })
}

/// Returns the probability that the finger is the best on the bench, and its simulated window.
fn on_bench(found: &BenchPrediction) -> Vec<Line> {
    let chance = found.best.first().map(|best| {
        let [percent, of] = [100.0 * best.probability_best, found.fingers as f64];
        line("probability", format!("{percent:.0} % of being the best of all {of} fingers"))
    });
    let range = Measure::Range.value(&found.simulated).map_or("no range".to_owned(), mm);
    let mut simulated = window(&found.simulated);
    simulated[0] = line("simulated", format!("{range}; {}", simulated[0].1));
    chance.into_iter().chain(simulated).collect()
}

/// Returns the accuracy of the predictions of the measured fingers.
pub fn accuracy(found: &BenchPrediction) -> Line {
    let (trust, count) = (&found.trust, found.measured);
    let Some(deviation) = trust.mean_deviation_percent else {
        return line("measured", format!("{count} fingers"));
    };
    let rank = trust.spearman.map_or("-".to_owned(), |rank| format!("{rank:+.2}"));
    let inside = coverage(trust.inside, trust.fingers);
    let error = format!("leave-one-out error {deviation:.1} %, Spearman {rank}");
    line("measured", format!("{count} fingers; {error}, {inside}"))
}

/// Returns the window of an evaluation and the outcomes at its ends.
pub fn window(evaluation: &Evaluation) -> Vec<Line> {
    let window = &evaluation.window;
    if window.nominal != Outcome::Inserted {
        let (nominal, stop) = (window.nominal.label(), stop_words(evaluation.nominal_stop()));
        return vec![line("window", format!("none: the nominal start ends with {nominal}{stop}"))];
    }
    let end = |outcome: Option<Outcome>| outcome.map_or("limit of the search", Outcome::label);
    let [below, above] = [window.end_negative, window.end_positive].map(end);
    vec![
        line("window", format!("{} mm", span(ends_mm(window)))),
        line("ends", format!("{below} below, {above} above{}", some_stops(evaluation))),
    ]
}

/// Returns `; ` and the number of trials that a protective stop of the robot ended, for the line of the ends; empty if
/// there are none, or if they end most trials, as the headline says.
fn some_stops(evaluation: &Evaluation) -> String {
    let Evaluation { robot_stops, trials, .. } = evaluation;
    match *robot_stops > 0 && !evaluation.mostly_stopped() {
        true => format!(
            "; robot stop in {robot_stops} of {trials} trials: a plug seated by then is inserted"
        ),
        false => String::new(),
    }
}

/// Returns the predicted stiffness, its uncertainty, and whether it is an extrapolation.
pub fn stiffness(prediction: &Prediction) -> [Line; 2] {
    let [compliance, assembly] = [prediction.compliance, prediction.assembly].map(words::stiffness);
    let hull = match prediction.inside_hull() {
        true => "inside the measured designs".to_owned(),
        false => format!("{:.2} spans OUTSIDE the measured designs", prediction.hull_distance),
    };
    let stiffness = format!("compliance {compliance}, assembly {assembly}, measured model");
    [line("stiffness", stiffness), line("", hull)]
}

/// Returns success rate and robust range, if they were evaluated.
pub fn drawn(evaluation: &Evaluation) -> Vec<Line> {
    let success = evaluation.success.as_ref().map(|success| {
        let [rate, failures] = words::success(success);
        [line("success rate", rate), line("", format!("failures {failures}"))]
    });
    let robust = evaluation.robust.as_ref().map(words::robust);
    let robust = robust.map(|robust| line("robust range", robust));
    success.into_iter().flatten().chain(robust).collect()
}

/// Returns whether the window with stiffness computed from the ribs has the same kind of start as that with the measured
/// stiffness. If it fails at the given start, its start was taught: its window is the nearest one, however narrow.
pub fn comparable(ribs: &Evaluation, measured: &Evaluation) -> bool {
    ribs.taught.is_none() || measured.taught.is_some()
}

/// Returns the window with stiffness computed from the ribs on the task with index `at`, whose evaluation with the
/// measured stiffness is given.
pub fn by_ribs(found: &ByRibs, (at, measured): (usize, &Evaluation)) -> Option<Line> {
    let tasks = match found {
        ByRibs::Refused(why) => return (at == 0).then(|| line("from its ribs", why)),
        ByRibs::Measured(tasks) => tasks,
    };
    let ribs = tasks.get(at)?;
    let window = &ribs.window;
    let text = if window.nominal != Outcome::Inserted {
        let (nominal, stop) = (window.nominal.label(), stop_words(ribs.nominal_stop()));
        format!("none: its nominal start ends with {nominal}{stop}")
    } else if !comparable(ribs, measured) {
        "not compared: it fails at the given start".to_owned()
    } else {
        let start = ribs.taught.map(|steps| format!(", start taught {:+.1}", grid_mm(steps)));
        let (range, ends) = (mm(window.range_mm()), span(ends_mm(window)));
        format!("{range} ({ends}{})", start.unwrap_or_default())
    };
    Some(line("from its ribs", text))
}

/// Returns the position of a taught start relative to that of the task file, `mm`; `None` if it was not taught.
pub fn taught(mm: Option<f64>) -> Option<Line> {
    let mm = mm?;
    Some(line("start", format!("taught: {mm:+.1} mm from that of the task file")))
}
