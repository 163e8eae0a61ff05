//! `report.html`: one file, a little script of its own, nothing fetched.

use super::elements::{definitions, document, figure};
use super::{
    ReportError, bench, convergence, explore, first, front, provenance, replay, set, shape,
};
use crate::answer::{Answer, UnderRobot, command, expectation, lines};
use insertion::surrogate::Model;
use maud::{Markup, html};
use std::path::{Path, PathBuf};
use study::StudyRecord;

/// Pixels of a plot in the page: narrow, so that its text stays readable when
/// a phone shrinks it to fit.
pub(super) const PLOT: (u32, u32) = (356, 300);
/// Bytes of films that a page holds; others it links to.
const FILMS: usize = 600_000;

/// Files beside the page in the folder of a study.
#[derive(Debug, Clone, Default)]
pub struct Beside {
    /// The folder, as commands name it.
    pub dir: PathBuf,
    /// Its films.
    pub films: Vec<Film>,
    /// Those of [`printer::FILES`](super::printer::FILES) that are there.
    pub files: Vec<&'static str>,
    /// Where nothing inserts, an SVG of the design that comes nearest at the nominal start.
    pub nominal: Option<String>,
    /// What moves the window: a sentence, and an SVG.
    pub levers: Option<(String, String)>,
    /// The window under two robots.
    pub robots: Vec<UnderRobot>,
    /// Maps of what the window is over two errors: captions and SVGs.
    pub maps: Vec<(String, String)>,
}

/// A film at an end of a window.
#[derive(Debug, Clone)]
pub struct Film {
    /// Place of the task.
    pub task: usize,
    /// The end, one of [`replay::ENDS`].
    pub end: &'static str,
    /// Its recordings as JSON without a `<`; `None` if the page only links to it.
    pub data: Option<String>,
}

impl Beside {
    /// Takes in a film by its page, as long as there is room for it.
    pub fn add(&mut self, task: usize, end: &'static str, page: &str) {
        let held: usize = self.films.iter().flat_map(|film| &film.data).map(String::len).sum();
        let data = replay::data(page).filter(|data| held + data.len() <= FILMS);
        self.films.push(Film { task, end, data: data.map(str::to_owned) });
    }
}

/// The report of a study as a page that opens offline. `model` is the stiffness model of the
/// study.
pub fn page(record: &StudyRecord, model: &Model, beside: &Beside) -> Result<String, ReportError> {
    let answer = Answer::of(record);
    let sections = sections(&answer, model, beside)?;
    let body = html! {
        main {
            (first::screen(&answer, beside))
            nav aria-label="contents" {
                @for (id, title, _) in &sections { a href=(format!("#{id}")) { (title) } }
            }
            @for (id, title, body) in &sections {
                section id=(id) { h2 { (title) } (body) }
            }
        }
    };
    Ok(document(&title(record), body))
}

/// The answer of the study in a folder as a piece of a page, for notebooks.
pub fn card(record: &StudyRecord, dir: &Path) -> String {
    let answer = Answer::of(record);
    let (command, why) = command::next(&answer, dir);
    let card = html! {
        div.finger-opt {
            h3 { (answer.verdict.headline()) }
            p { (expectation(&answer)) " (" (answer.trust.label()) ")" }
            (definitions(&lines::brief(&answer)))
            p { code { (command) } br; (why) }
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
    let section = |id, title: &str, body: Option<Markup>| Some((id, title.to_owned(), body?));
    let set_title = match record.on_bench {
        None => "Fingers as good",
        Some(_) => "As good by simulation alone",
    };
    // Their words are as wide as they are: on a phone they are moved, not shrunk.
    let drawn = |(caption, svg): &(String, String)| {
        html! { div.moved { (figure(svg, caption, caption)) } }
    };
    let maps = (!beside.maps.is_empty())
        .then(|| html! { div.views { @for map in &beside.maps { (drawn(map)) } } });
    let sections = [
        section("bench", "Predicted for the bench", bench::section(record)),
        section("set", set_title, set::section(answer)),
        section("front", "Between the objectives", front::section(answer, PLOT)?),
        section("shape", "Beyond the infill alone", shape::section(record)),
        section("levers", "What moves the window", beside.levers.as_ref().map(drawn)),
        section("maps", "Where it captures", maps),
        section("explore-views", "All designs", explore::section(answer, &beside.dir)),
        section("convergence", "Convergence", Some(convergence::section(record, PLOT)?)),
        section("failures", "How the trials ended", Some(provenance::outcomes(record))),
        section("provenance", "Provenance", Some(provenance::section(answer, model))),
    ];
    Ok(sections.into_iter().flatten().collect())
}
