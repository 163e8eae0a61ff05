//! `report.html`: one file, a little script of its own, nothing fetched.

use super::elements::document;
use super::theme::variables;
use super::{
    ReportError, bench, best, convergence, drawn, explore, front, limits, printer, provenance,
    published, shape, windows,
};
use crate::answer::Answer;
use crate::answer::words::settled;
use crate::study::StudyRecord;
use insertion::surrogate::Model;
use maud::{Markup, PreEscaped, html};

/// Pixels of a plot in the page: narrow, so that its text stays readable when
/// a phone shrinks it to fit.
const PLOT: (u32, u32) = (560, 400);

/// Files beside the page in the folder of a study.
#[derive(Debug, Clone, Default)]
pub struct Beside {
    /// Its films: what a button says, and the page that plays it.
    pub replays: Vec<(String, String)>,
    /// Whether the recommended finger's files for the printer are there.
    pub printable: bool,
}

/// The report of a study as a page that opens offline. `model` is the stiffness model of the
/// study; the map marks the designs it was fitted to.
pub fn page(record: &StudyRecord, model: &Model, beside: &Beside) -> Result<String, ReportError> {
    let (config, title) = (&record.config, title(record));
    let sections = sections(&Answer::of(record), model, beside)?;
    let body = html! {
        main {
            header {
                h1 { (title) }
                p.muted {
                    "Robustness of a compliant finger in a connector insertion, by \
                    contact simulation: " (config.counted(record.evaluations.len())) "."
                    @if record.settled {
                        " Settled " (settled(record)) "."
                    }
                    @if let Some(note) = drawn::note(record) { " " (note) }
                }
            }
            nav aria-label="contents" {
                @for (id, title, _) in &sections { a href=(format!("#{id}")) { (title) } }
            }
            @for (id, title, body) in &sections {
                section id=(id) { h2 { (title) } (body) }
            }
        }
    };
    Ok(document(&title, &style(), body))
}

/// The answer of a study as a piece of a page, for notebooks.
pub fn card(record: &StudyRecord) -> String {
    let (config, title) = (&record.config, title(record));
    let card = html! {
        div.finger-opt {
            h3 { (title) }
            p { (config.counted(record.evaluations.len())) }
            @if let Some(bench) = bench::section(record) {
                (bench)
                h4 { "By simulation alone" }
            }
            (best::section(&Answer::of(record)))
        }
    };
    card.into_string()
}

fn title(StudyRecord { config, .. }: &StudyRecord) -> String {
    format!("{} with {}, seed {}", config.task_name(), config.method(), config.seed)
}

type Section = (&'static str, String, Markup);

/// Id, title and body of each section; what does not apply is left out.
fn sections(answer: &Answer, model: &Model, beside: &Beside) -> Result<Vec<Section>, ReportError> {
    let record = answer.record;
    let windows = each_task(record, |task| windows::section(record, task));
    let published = each_task(record, |task| published::section(record, task));
    let section = |id, title: &str, body| Some((id, title.to_owned(), body));
    let (best, played) = match record.on_bench {
        None => ("Best design", "Both ends of its window, played"),
        Some(_) => ("Best by simulation alone", "Both ends of its simulated window, played"),
    };
    let sections = [
        bench::section(record).and_then(|bench| section("bench", "Best on the bench", bench)),
        section("best", best, best::section(answer)),
        films(&beside.replays).and_then(|films| section("replay", played, films)),
        explore::section(record).and_then(|views| section("explore-views", "All designs", views)),
        printer::section(record)
            .filter(|_| beside.printable)
            .and_then(|printer| section("printer", "To the printer", printer)),
        section("windows", "Tolerance windows of the best designs", windows),
        shape::section(record).and_then(|shape| section("shape", "Beyond the infill alone", shape)),
        front::section(answer, PLOT)?
            .and_then(|front| section("front", "Between the objectives", front)),
        section("published", "Published ranges beside ours", published),
        section("limits", "What this does not say", limits::section(answer, model)),
        section("failures", "How the trials ended", provenance::outcomes(record)),
        section("convergence", "Convergence", convergence::section(record, PLOT)?),
        section("provenance", "Provenance", provenance::provenance(record)),
    ];
    Ok(sections.into_iter().flatten().collect())
}

/// Buttons that play the films; nothing without films.
fn films(replays: &[(String, String)]) -> Option<Markup> {
    (!replays.is_empty()).then(|| {
        html! {
            p { "The last start that inserts beside the first that fails:" }
            @for (i, (label, page)) in replays.iter().enumerate() {
                button type="button" data-film=(format!("film{i}")) { (label) }
                script type="application/json" id=(format!("film{i}")) {
                    (PreEscaped(explore::embedded(&page.as_str().into())))
                }
            }
            dialog #player aria-label="a film of two trials" {
                button #close type="button" { "Close" }
                // What a film holds came from a file: it runs its script, and reaches nothing else.
                iframe #film title="a film of two trials" sandbox="allow-scripts" {}
            }
        }
    })
}

/// A part for each task, under its name if there are several.
fn each_task(record: &StudyRecord, part: impl Fn(usize) -> Markup) -> Markup {
    html! {
        @for (at, name) in record.config.tasks().enumerate() {
            @if record.config.several_tasks() { h3 { (name) } }
            (part(at))
        }
    }
}

fn style() -> String {
    let (light, dark) = (variables(false), variables(true));
    format!(
        ":root{{color-scheme:light dark;{light}}}\n@media (prefers-color-scheme:dark){{:root{{{dark}}}}}\n{}",
        include_str!("style.css")
    )
}
