//! `report.html`: a page without external files, with inline scripts.

use super::elements::{definitions, document, figure};
use super::glossary::explained;
use super::page_files::{PageFiles, PostAnalysis};
use super::{
    ReportError, bench, convergence, explore, front, levers, map, overview, provenance, shape, ties,
};
use crate::answer::{Answer, command, expectation, lines};
use maud::{Markup, html};
use std::path::Path;

/// Size of a plot in the page, pixels: narrow, so that its text stays readable when scaled down on
/// a phone.
pub(super) const PLOT: (u32, u32) = (356, 300);

/// Returns the report of a study as an HTML page that works offline.
pub fn page(answer: &Answer, files: &PageFiles) -> Result<String, ReportError> {
    let sections = sections(answer, files)?;
    let body = html! {
        main {
            (overview::screen(answer, files))
            nav aria-label="contents" {
                @for (id, title, _) in &sections { a href=(format!("#{id}")) { (title) } }
            }
            @for (id, title, body) in &sections {
                section id=(id) { h2 { (explained(title)) } (body) }
            }
        }
    };
    let config = &answer.record.config;
    let method = config.method();
    Ok(document(&format!("{} with {method}, seed {}", config.task_name(), config.seed), body))
}

/// Returns the answer as an HTML fragment, for notebooks; `dir` is the study's folder.
pub fn card(answer: &Answer, dir: &Path) -> String {
    let (command, why) = command::next(answer, dir);
    let card = html! {
        div.finger-opt {
            h3 { (answer.headline()) }
            p { (expectation(answer)) " (" (answer.trust.label()) ")" }
            (definitions(&lines::brief(answer)))
            p { code { (command) } br; (why) }
        }
    };
    card.into_string()
}

type Section = (&'static str, String, Markup);

/// Returns id, title and body of each section that is not empty.
fn sections(answer: &Answer, files: &PageFiles) -> Result<Vec<Section>, ReportError> {
    let record = answer.record;
    let section = |id, title: &str, body: Option<Markup>| Some((id, title.to_owned(), body?));
    let set_title = if record.on_bench.is_none() { "Ties" } else { "Ties by simulation alone" };
    let PostAnalysis { levers, maps, .. } = &files.analyses;
    let captioned = |svg: Result<String, ReportError>, caption: String| {
        svg.map(|svg| figure(&svg, &caption, &caption))
    };
    let levers = levers.as_ref().map(|levers| captioned(levers::svg(levers), levers.sentence()));
    let levers = levers.transpose()?.map(|figure| html! { div.moved { (figure) } });
    let maps = maps.iter().map(|map| captioned(map::svg(map), map.caption()));
    let maps = maps.collect::<Result<Vec<_>, _>>()?;
    let maps =
        (!maps.is_empty()).then(|| html! { div.views.maps { @for figure in maps { (figure) } } });
    let sections = [
        section("bench", "Predicted for the bench", bench::section(record)),
        section("set", set_title, ties::section(answer)),
        section("front", "Pareto front", front::section(answer, PLOT)?),
        section("shape", "Beyond the infill", shape::section(answer)),
        section("levers", "Sensitivity of the window", levers),
        section("maps", "Capture maps", maps),
        section("explore-views", "All designs", explore::section(answer, &files.dir)),
        section("convergence", "Convergence", Some(convergence::section(record, PLOT)?)),
        section("provenance", "Provenance", Some(provenance::section(answer))),
    ];
    Ok(sections.into_iter().flatten().collect())
}
