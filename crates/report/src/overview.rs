//! First screen of the page of a study: recommendation, evidence, animated trials (films), window, drawing and files of
//! the finger, and the next command.

use super::elements::{data_url, figure};
use super::glossary::explained;
use super::page_files::{FilmPair, PageFiles};
use super::printer::{self, recommended};
use super::replay::{ENDS, pair_file, player};
use super::{bar, explore};
use crate::answer::words::{design, evaluated, on, outcome, remedy};
use crate::answer::{Answer, Verdict, command, expectation, lines};
use analysis::levers::Levers;
use finray::export::sheet;
use insertion::outcome::stop_words;
use insertion::{Evaluation, FailureClass, Outcome, grid_mm};
use maud::{Markup, PreEscaped, html};
use study::Recorded;

/// Returns the first screen, above all sections.
pub(super) fn screen(answer: &Answer, files: &PageFiles) -> Markup {
    let (command, why) = command::next(answer, &files.dir);
    let uncertainty = files.analyses.levers.as_ref().and_then(Levers::uncertainty);
    html! {
        header {
            p.muted { (lines::searched(answer)) }
            @if let Some((name, text)) = lines::first(answer) { p.warn { b { (name) } " " (text) "." } }
            h1 { (answer.headline()) }
            p.lead {
                (explained(&expectation(answer))) ". "
                @if answer.verdict.finger().is_some() { span.trust { (answer.trust.label()) } }
            }
            // With measurements the finger is chosen by predictions for the bench.
            @if let Some((_, text)) = lines::widest(answer).filter(|_| answer.record.on_bench.is_none()) {
                p.muted { "Widest in the search: " (explained(&text)) "." }
            }
            @if let Some((_, text)) = lines::left_out(answer) { p.warn { "Left out: " (text) "." } }
            @for (_, text) in lines::caveats(answer) { p.warn { (text) } }
        }
        div.first {
            @if let Verdict::NothingInserts { nearest, fails, .. } = &answer.verdict {
                (nominal(nearest, fails.map(|fails| (fails, answer.stopped().is_some())), files))
            } @else if let Some((_, tasks)) = answer.finger_and_evaluations() { (films(answer, &tasks, files)) }
            div {
                (bar::section(answer, &files.analyses.robots).unwrap_or_default())
                (drawing_and_files(answer, files).unwrap_or_default())
            }
        }
        div.next { h2 { "Next step: " (why) } pre { code { (command) } } }
        // Below, so that the next step is on the first screen.
        @for (_, text) in lines::measured(answer) { p.muted { "Measured: " (text) "." } }
        @if let Some(text) = uncertainty { p.muted { "Uncertain: " (text) "." } }
    }
}

/// Colours of the drawing and the colours of the page that replace them.
const COLOURS: [(&str, &str); 7] = [
    ("#aab7c9", "var(--lines)"),
    ("#223", "var(--ink)"),
    ("#a33", "var(--red)"),
    ("#c60", "var(--orange)"),
    ("#a40", "var(--orange)"),
    ("#222", "var(--muted)"),
    ("#444", "var(--muted)"),
];

/// Returns the drawing of the finger and links to its files.
fn drawing_and_files(answer: &Answer, files: &PageFiles) -> Option<Markup> {
    let geometry = recommended(answer)?;
    let finger = answer.verdict.finger()?;
    let best = match (&answer.front, answer.use_now()) {
        (Some(_), _) => format!(", best in {}", answer.record.config.objective.first().name()),
        (None, Some(_)) if answer.record.on_bench.is_some() => {
            ", largest expected range".to_owned()
        }
        (None, Some(_)) => ", best in simulation".to_owned(),
        (None, None) => String::new(),
    };
    let caption = format!("{}{best}, {} ribs", design(finger), geometry.ribs);
    let svg = sheet::part(&geometry);
    let svg = COLOURS.iter().fold(svg, |svg, (from, to)| svg.replace(from, to));
    let names = printer::FILES.into_iter().filter(|(file, _)| files.files.contains(file));
    Some(html! {
        div.finger { (figure(&svg, "drawing of the finger", &caption)) }
        p.files { @for (file, name) in names { a.button href=(file) { (name) } } }
    })
}

/// Returns the outcome of the design that is nearest to inserting, advice, and a drawing of its nominal start; `fails` is
/// its evaluation, and whether it would insert without the robot's stop.
fn nominal(nearest: &Recorded, fails: Option<(&Evaluation, bool)>, files: &PageFiles) -> Markup {
    html! {
        div.whole {
            @if let Some((fails, by_robot)) = fails {
                p {
                    "Nearest to inserting: " (evaluated(nearest)) ". \
                    Its nominal start ends with " b { (outcome(fails.window.nominal)) } (stop_words(fails.nominal_stop())) ". " (remedy(fails.window.nominal, fails.nominal_stop(), by_robot)) "."
                }
            }
            @if let Some(svg) = &files.nominal {
                // The first text of the drawing describes the trial; it is escaped in the file.
                @let text = svg.split_once("<text").and_then(|(_, rest)| rest.split_once('>'));
                @let text = text.and_then(|(_, rest)| rest.split('<').next()).unwrap_or_default();
                figure.wide {
                    img alt="the nominal start, phase by phase, from two sides" src=(data_url(svg));
                    figcaption { (PreEscaped(text)) "; the last phase is the one in which it fails" }
                }
            }
        }
    }
}

/// Returns the name of the window end whose films are shown first: a jam or a miss is more informative than a lost
/// plug.
pub fn preferred(answer: &Answer) -> &'static str {
    let informative = |end: Option<Outcome>| {
        matches!(end, Some(Outcome::Failed(FailureClass::PlugMissed | FailureClass::Jammed)))
    };
    let [negative, positive] = ENDS.map(|(end, _)| end);
    let window =
        answer.finger_and_evaluations().and_then(|(_, tasks)| Some(&tasks.first()?.window));
    let below = window.is_some_and(|w| informative(w.end_negative) && !informative(w.end_positive));
    if below { negative } else { positive }
}

/// Returns a player for the two trials at an end of a window, with a button for each end.
fn films(answer: &Answer, tasks: &[&Evaluation], files: &PageFiles) -> Markup {
    let films = &files.films;
    let (shown, linked): (Vec<&FilmPair>, Vec<&FilmPair>) =
        films.iter().partition(|film| film.data.is_some());
    html! {
        @if !films.is_empty() {
            div.films {
                // The film comes from a file: sandboxed, it runs its script and has no other access.
                @if let Some(film) = shown.first() {
                    div.stage {
                        @if let Some(poster) = &film.poster {
                            img src=(data_url(poster)) alt="how the failed trial ended";
                        }
                        iframe #film title="two trials: the last that inserts, the first that fails" sandbox="allow-scripts" {}
                    }
                    p #caption.muted { (caption(film, tasks, film.poster.is_some())) }
                } @else if let Some((film, poster)) = linked.first().and_then(|film| Some((film, film.poster.as_ref()?))) {
                    div.stage {
                        a href=(pair_file(film.task, film.end)) {
                            img src=(data_url(poster)) alt="how the failed trial ended; opens its replay";
                        }
                    }
                    p.muted { (caption(film, tasks, true)) }
                }
                p.files {
                    @for (at, film) in shown.iter().enumerate() {
                        button type="button" data-film=(at) data-caption=(caption(film, tasks, false)) {
                            span aria-hidden="true" { "▶ " } "Play the " (label(answer, film))
                        }
                        script type="application/json" id={ "film" (at) } {
                            (PreEscaped(film.data.as_deref().unwrap_or_default()))
                        }
                    }
                    @for film in linked {
                        a.button href=(pair_file(film.task, film.end)) { "Replay of the " (label(answer, film)) }
                    }
                }
                script type="application/json" id="viewer" {
                    (PreEscaped(explore::embedded(&player("film", "").into())))
                }
                script { (PreEscaped(include_str!("films.js"))) }
            }
        }
    }
}

fn label(answer: &Answer, film: &FilmPair) -> String {
    let config = &answer.record.config;
    format!("{} end{}", film.end, on(config, config.tasks().nth(film.task).unwrap_or_default()))
}

/// Returns `Left: the last start that inserts (+5.7 mm). Right: the next (+5.8 mm): jammed (class 3).`, or a caption
/// of the failed trial alone.
fn caption(film: &FilmPair, tasks: &[&Evaluation], failed_alone: bool) -> String {
    let Some(window) = tasks.get(film.task).map(|task| &task.window) else { return String::new() };
    let (last, end, outward) = match film.end == ENDS[0].0 {
        true => (window.negative_steps, window.end_negative, ENDS[0].1),
        false => (window.positive_steps, window.end_positive, ENDS[1].1),
    };
    let [inside, outside] = [last, last + outward].map(grid_mm);
    let ends = end.map_or("fails".to_owned(), outcome);
    match failed_alone {
        true => format!("The first start outside of the window ({outside:+.1} mm): {ends}."),
        false => format!(
            "Left: the last start that inserts ({inside:+.1} mm). Right: the next ({outside:+.1} mm): {ends}."
        ),
    }
}
