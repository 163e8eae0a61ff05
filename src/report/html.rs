//! `report.html`: one file, no scripts, nothing fetched.

use super::text::escape;
use super::theme::{inline, variables};
use super::{ReportError, best, convergence, front, map, others, scatter, sections, windows};
use crate::evaluation::objective::Measure;
use crate::input::stiffness::Measurement;
use crate::study::StudyRecord;

/// Pixels of a plot in the page: narrow, so that its text stays readable when
/// a phone shrinks it to fit.
const PLOT: (u32, u32) = (560, 400);

/// The report of a study as a page that opens offline. `measurements` are the
/// designs that the study's stiffness model was fitted to; the map marks them.
///
/// # Errors
/// If the drawing library refuses.
pub fn html(record: &StudyRecord, measurements: &[Measurement]) -> Result<String, ReportError> {
    let config = &record.config;
    let title = format!("{} with {}, seed {}", config.task_name(), config.method(), config.seed);
    let map_title = format!("{} over density and direction", capital(record));
    let windows = |task| windows_part(record, task);
    let published = |task| published_part(record, task);
    let body = [
        section("best", "Best design", &best::section(record)),
        section("convergence", "Convergence", &convergence_part(record)?),
        front_part(record)?,
        section("map", &map_title, &map_part(record, measurements)?),
        others_part(record)?,
        section("windows", "Tolerance windows of the best designs", &each_task(record, windows)?),
        section("published", "Published ranges beside ours", &each_task(record, published)?),
        section("failures", "How the trials ended", &sections::failures(record)),
        section("limits", "What this does not say", &sections::limits(record)),
        section("provenance", "Provenance", &sections::provenance(record)),
    ];
    let title = escape(&title);
    Ok(format!(
        "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <meta name=\"color-scheme\" content=\"light dark\">\n\
         <title>{title}</title>\n<style>\n{}</style>\n</head>\n<body>\n<main>\n\
         <header><h1>{title}</h1>\n<p class=\"muted\">Robustness of a compliant finger in a \
         connector insertion, by contact simulation: {} of {} evaluations.</p></header>\n\
         {}</main>\n</body>\n</html>\n",
        style(),
        record.evaluations.len(),
        config.evaluations(),
        body.concat(),
    ))
}

fn section(id: &str, title: &str, body: &str) -> String {
    format!("<section id=\"{id}\">\n<h2>{title}</h2>\n{body}</section>\n")
}

fn figure(svg: &str, label: &str, caption: &str) -> String {
    let caption = escape(caption);
    format!("<figure>\n{}\n<figcaption>{caption}</figcaption>\n</figure>\n", inline(svg, label))
}

fn convergence_part(record: &StudyRecord) -> Result<String, ReportError> {
    let svg = convergence::svg(record, PLOT)?;
    let caption = match record.config.objective.single() {
        Some(Measure::Range | Measure::CentredRange) => {
            "Value of each evaluation, and the best so far, against the number of \
             evaluations. Values are multiples of the 0.1 mm grid."
        }
        Some(_) => {
            "Value of each evaluation, and the best so far, against the number of evaluations."
        }
        None => {
            "Hypervolume of the front against the number of evaluations, from the reference \
             stated with the front."
        }
    };
    Ok(figure(&svg, "best value against evaluations", caption))
}

/// A whole section, or nothing for a single objective.
fn front_part(record: &StudyRecord) -> Result<String, ReportError> {
    if record.config.objective.single().is_some() {
        return Ok(String::new());
    }
    let caption = "All evaluated designs by their first two objectives. Rings: the designs \
                   among which nothing but preference decides.";
    let plot = front::svg(record, PLOT)?
        .map_or(String::new(), |svg| figure(&svg, "the front and all evaluations", caption));
    Ok(section("front", "Between the objectives", &(plot + &front::section(record))))
}

fn map_part(record: &StudyRecord, measurements: &[Measurement]) -> Result<String, ReportError> {
    let caption = format!(
        "Coloured cells: evaluated designs, by {}. Rings: designs whose stiffness was measured. \
         Cross in a frame: the best design. Red outline: no value. Grey outline: violates a \
         constraint. Outside the rings' hull the stiffness is extrapolated. Of designs with the \
         same infill the best is on top.",
        record.config.objective.first()
    );
    Ok(match map::svg(record, measurements, (560, 500))? {
        Some(svg) => figure(&svg, "map over infill density and direction", &caption),
        None => "<p>The space of this study has no infill density and direction.</p>\n".to_owned(),
    })
}

/// A whole section, or nothing if the space is the infill alone.
fn others_part(record: &StudyRecord) -> Result<String, ReportError> {
    let first = capital(record);
    let caption = format!(
        "{first} of each evaluated design against one number each of task and finger; all others \
         differ as well. Cross: the best design."
    );
    Ok(match others::svg(record, PLOT.0)? {
        Some(svg) => {
            let figure = figure(&svg, "objective against the other parameters", &caption);
            section("others", &format!("{first} over the other parameters"), &figure)
        }
        None => String::new(),
    })
}

/// The first objective as a sentence begins.
fn capital(record: &StudyRecord) -> String {
    let name = record.config.objective.first().name();
    name[..1].to_uppercase() + &name[1..]
}

/// A part for each task, under its name if there are several.
fn each_task(
    record: &StudyRecord,
    part: impl Fn(usize) -> Result<String, ReportError>,
) -> Result<String, ReportError> {
    let alone = !record.config.several_tasks();
    let titled = |(task, name): (usize, &str)| {
        let title = if alone { String::new() } else { format!("<h3>{}</h3>\n", escape(name)) };
        Ok(title + &part(task)?)
    };
    record.config.tasks().enumerate().map(titled).collect()
}

fn windows_part(record: &StudyRecord, task: usize) -> Result<String, ReportError> {
    let caption = "Offsets that insert, about the nominal start (line at 0 mm), each end to \
                   within 0.1 mm. At each end the failure met there: 1 contact loss before the \
                   search, 2 plug missed, 3 jammed, 4 contact loss in insertion.";
    Ok(match windows::svg(record, task, PLOT.0)? {
        Some(svg) => {
            figure(&svg, "tolerance windows of the best designs", caption)
                + &sections::best_ten(record, task)
        }
        None => "<p>No evaluation has a value and keeps all constraints.</p>\n".to_owned(),
    })
}

fn published_part(record: &StudyRecord, task: usize) -> Result<String, ReportError> {
    let caption = "Range against the compliance stiffness of one finger: predicted for our \
                   designs, measured for the published ones.";
    let plot = scatter::svg(record, task, PLOT)?
        .map_or(String::new(), |svg| figure(&svg, "range against compliance stiffness", caption));
    Ok(sections::published(record, task) + &plot)
}

fn style() -> String {
    let (light, dark) = (variables(false), variables(true));
    format!(
        ":root{{{light}}}\n@media (prefers-color-scheme:dark){{:root{{{dark}}}}}\n{}",
        include_str!("style.css")
    )
}
