//! The page's tables and texts.

use super::text::{design, escape, outcome_words, values};
use super::windows;
use crate::evaluation::objective::Measure;
use crate::evaluation::{Evaluation, Window};
use crate::input::published::{Origin, Published, designs, of_task};
use crate::input::space::{DENSITY_KEY, DIRECTION_KEY};
use crate::input::stiffness::Measurement;
use crate::outcome::{FailureClass, Outcome};
use crate::study::{Provenance, Recorded, StudyRecord};
use crate::verify::compare::published::rank_correlation;

/// A list of names and values; both are escaped.
pub(super) fn definitions(rows: &[(String, String)]) -> String {
    let row = |(name, value): &(String, String)| {
        format!("<dt>{}</dt><dd>{}</dd>\n", escape(name), escape(value))
    };
    format!("<dl>\n{}</dl>\n", rows.iter().map(row).collect::<String>())
}

/// A table; cells are escaped.
pub(super) fn table(head: &[&str], rows: &[Vec<String>]) -> String {
    let cells = |tag: &str, cells: &mut dyn Iterator<Item = String>| -> String {
        cells.map(|cell| format!("<{tag}>{}</{tag}>", escape(&cell))).collect()
    };
    let head = cells("th", &mut head.iter().map(|&h| h.to_owned()));
    let body: String = rows
        .iter()
        .map(|row| format!("<tr>{}</tr>\n", cells("td", &mut row.iter().cloned())))
        .collect();
    format!("<table>\n<thead><tr>{head}</tr></thead>\n<tbody>\n{body}</tbody>\n</table>\n")
}

/// Range and failure classes at both ends, as in the published columns.
fn ours(window: &Window) -> String {
    if window.nominal != Outcome::Inserted {
        return format!("0.0 mm ({} at the nominal start)", outcome_words(window.nominal));
    }
    let class = |end: Option<Outcome>| match end {
        Some(Outcome::Failed(class)) => class.number().to_string(),
        Some(Outcome::Diverged) => "diverged".to_owned(),
        _ => "–".to_owned(),
    };
    let ends = [class(window.end_negative), class(window.end_positive)];
    format!("{:.1} mm ({} | {})", window.range_mm(), ends[0], ends[1])
}

/// The evaluation of a measured design, if the study has one.
fn of_design<'a>(record: &'a StudyRecord, m: &Measurement) -> Option<&'a Recorded> {
    record.evaluations.iter().find(|r| {
        r.design.get(DENSITY_KEY) == Some(m.density_percent)
            && r.design.get(DIRECTION_KEY) == Some(m.direction_deg)
    })
}

/// Published ranges of a task, by its place among the tasks, beside ours.
pub(super) fn published(record: &StudyRecord, place: usize) -> String {
    let task = record.config.tasks().nth(place).unwrap_or_default();
    let simulation = of_task(task, Origin::Simulation);
    let bench = of_task(task, Origin::Bench);
    if simulation.is_empty() && bench.is_empty() {
        return format!("<p>No ranges are published for the task {}.</p>\n", escape(task));
    }
    let cell = |rows: &[Published], design| {
        rows.iter().find(|row| row.design == design).map_or(String::new(), Published::words)
    };
    let rows: Vec<Vec<String>> = designs()
        .iter()
        .map(|m| {
            vec![
                m.design.to_string(),
                format!("{} %, {}°", m.density_percent, m.direction_deg),
                of_design(record, m)
                    .and_then(|found| found.on(place))
                    .map_or(String::new(), |found| ours(&found.window)),
                cell(&simulation, m.design),
                cell(&bench, m.design),
            ]
        })
        .collect();
    let head = ["design", "infill", "this study", "published simulation", "bench experiments"];
    format!(
        "<p>Tolerable range, and in brackets the failure class beyond the negative | positive \
         end. Blank: this study did not evaluate the design. Published ranges come without an \
         error; ours are known to within +0.2 mm of the model.</p>\n{}",
        table(&head, &rows)
    )
}

/// Windows of the best designs on one task as a table, for those who cannot see the bars.
pub(super) fn best_ten(record: &StudyRecord, task: usize) -> String {
    let rows: Vec<Vec<String>> = windows::best(record)
        .iter()
        .filter_map(|(r, found)| {
            let window = &r.on(task)?.window;
            Some(vec![
                r.index.to_string(),
                design(&r.design),
                values(&record.config.objective, found),
                format!("{:+.1} to {:+.1} mm", window.negative_mm(), window.positive_mm()),
                super::text::stiffness(r.stiffness.compliance),
                if r.stiffness.inside_hull() { "inside" } else { "outside" }.to_owned(),
            ])
        })
        .collect();
    let head =
        ["evaluation", "design", "objective", "window", "compliance stiffness", "measured hull"];
    format!("<details><summary>The same as a table</summary>\n{}</details>\n", table(&head, &rows))
}

/// How the trials of the study ended.
pub(super) fn failures(record: &StudyRecord) -> String {
    let windows = || record.evaluations.iter().flat_map(Recorded::tasks);
    let sum = |of: &dyn Fn(&Evaluation) -> u32| -> u64 {
        windows().map(|evaluation| u64::from(of(evaluation))).sum()
    };
    let trials = sum(&|found| found.trials);
    let share = |count: u64| {
        if trials == 0 {
            "–".to_owned()
        } else {
            format!("{:.1} %", 100.0 * count as f64 / trials as f64)
        }
    };
    let mut rows: Vec<Vec<String>> = FailureClass::ALL
        .into_iter()
        .map(|class| {
            let count = sum(&|found| found.failure_counts[class as usize]);
            let name = format!("{} {}", class.number(), class.label());
            vec![name, count.to_string(), share(count)]
        })
        .collect();
    let diverged = sum(&|found| found.diverged);
    rows.push(vec!["simulation diverged".to_owned(), diverged.to_string(), share(diverged)]);
    let failed = diverged + sum(&|found| found.failure_counts.iter().sum());
    let inserted = trials.saturating_sub(failed);
    rows.push(vec!["inserted".to_owned(), inserted.to_string(), share(inserted)]);
    let at_nominal = windows().filter(|found| found.window.nominal != Outcome::Inserted);
    format!(
        "<p>{trials} trials in {} window searches. {} of them do not insert at the nominal \
         start. A window search stops at the first failure on each side, so failures count \
         window ends, not how likely a failure is.</p>\n{}",
        windows().count(),
        at_nominal.count(),
        table(&["how the trial ended", "trials", "share"], &rows)
    )
}

/// What decided the results.
pub(super) fn provenance(record: &StudyRecord) -> String {
    let config = &record.config;
    let mut rows: Vec<(String, String)> = [
        ("study", config.name()),
        ("task", config.task_name()),
        ("robot", config.robot.clone()),
        ("optimizer", config.method()),
        ("objective", config.objective.to_string()),
        ("seed", config.seed.to_string()),
        ("evaluations", format!("{} of {}", record.evaluations.len(), config.evaluations())),
        ("designs proposed at a time", config.batch.to_string()),
    ]
    .map(|(name, value)| (name.to_owned(), value))
    .into();
    rows.extend(config.constraints.iter().map(|c| ("constraint".to_owned(), c.to_string())));
    rows.extend(config.aggregate.iter().map(|a| {
        let value = format!("{a}, of values that are not scaled");
        ("objective over the tasks".to_owned(), value)
    }));
    rows.extend(config.uncertainty.iter().map(|u| ("drawn errors".to_owned(), u.clone())));
    for p in config.space.parameters() {
        let value = format!("{} to {} in steps of {}", p.low, p.high, p.step);
        rows.push((format!("{}: {}", config.space.name(), p.key), value));
    }
    let windows = record.evaluations.iter().flat_map(Recorded::tasks);
    let simulated: f64 = windows.map(|found| found.simulated_s).sum();
    let wall: f64 = record.evaluations.iter().map(|r| r.timing.wall_s).sum();
    rows.push(("simulated time of the window searches".to_owned(), format!("{simulated:.0} s")));
    rows.push(("wall-clock time, summed over evaluations".to_owned(), format!("{wall:.0} s")));
    rows.extend(record.segments.iter().enumerate().flat_map(|(i, segment)| {
        let name = |what: &str| match record.segments.len() {
            1 => what.to_owned(),
            _ => format!("{what}, segment {} (from evaluation {})", i + 1, segment.first),
        };
        let Provenance { program, source_sha256, input_sha256, engine } = &segment.provenance;
        let mut rows = vec![
            (name("finger-opt"), format!("{program}, sources {source_sha256}")),
            (name("contact engine"), engine.version.clone()),
        ];
        let settings = engine.settings.iter().map(|(key, value)| format!("{key} = {value}"));
        rows.push((name("engine settings"), settings.collect::<Vec<_>>().join(", ")));
        rows.extend(
            input_sha256
                .iter()
                .map(|(role, hash)| (name(&format!("SHA-256 of the {role} file")), hash.clone())),
        );
        rows
    }));
    definitions(&rows)
}

/// What the numbers do not say.
pub(super) fn limits(record: &StudyRecord) -> String {
    let here = |task: &str| {
        let (r, n) = rank_correlation(task)?;
        Some(format!(
            " On {task} the rank correlation between published simulated and bench \
             ranges is {r:+.2} over {n} designs (+1: same order, −1: opposite order)."
        ))
    };
    let here: String = record.config.tasks().filter_map(here).collect();
    let goals = record.config.goals();
    let carried = match goals.need(Measure::RobustRange) {
        true => {
            "The windows shown are those of fingers of exactly the predicted stiffness. The \
                 robust range alone carries the stiffness error."
        }
        false => {
            "The range is that of a finger of exactly the predicted stiffness. The stiffness \
                  error above is not carried into the range."
        }
    };
    let drawn = match goals.need_draws() {
        true => {
            "<li>Success rate and robust range are those of the assumed errors, not of your \
                 cell. All designs meet the same draws, so differences between designs are surer \
                 than the values.</li>\n"
        }
        false => "",
    };
    format!(
        "<ul>\n\
         <li>These are results of a contact simulation. No finger was printed for this study.</li>\n\
         <li>In the published simulation of these tasks, ranges rank the designs in the opposite \
         order to the robot on two of four tasks.{here} Confirm the best design, and a very \
         different one, on the robot.</li>\n\
         <li>{carried}</li>\n{drawn}\
         <li>The centre of rotation of the finger is fixed in the model. In truth it moves with \
         the infill direction, which matters for long, slender plugs.</li>\n\
         <li>Differences of 0.2 mm between designs are at the resolution of the window search.</li>\n\
         </ul>\n"
    )
}
