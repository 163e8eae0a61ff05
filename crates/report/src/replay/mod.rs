//! Recorded trials for looking at: a page that plays them, a table, a curve.

mod curve;
mod film;
mod table;

use super::elements::styled;
use super::explore::embedded;
pub use curve::svg as curve_svg;
pub use table::csv;

use insertion::evaluation::OffsetStep;
use insertion::finger::Pad;
use insertion::task::Task;
use insertion::trial::Recording;
use maud::{PreEscaped, html};

/// A recorded trial of a task, and what it is called.
#[derive(Debug, Clone, Copy)]
pub struct Film<'a> {
    /// For readers: `start shifted by +1.5 mm`.
    pub label: &'a str,
    /// The task that was tried.
    pub task: &'a Task,
    /// Pad and roof of the fingers.
    pub pad: &'a Pad,
    /// Recording of the trial.
    pub recording: &'a Recording,
}

/// The ends of a window: what they are called, and the step outward.
pub const ENDS: [(&str, OffsetStep); 2] = [("negative", -1), ("positive", 1)];

/// Where a study keeps the pair at an end of its recommended design's window, by the place of the
/// task; below its folder.
pub fn pair_file(task: usize, end: &str) -> String {
    format!("replay/{}-{end}.html", task + 1)
}

/// A page that plays films side by side. It opens offline: its script is our own, for nothing
/// that draws in WebGL is as small (three.js has 700 kB, this 18).
pub fn page(title: &str, films: &[Film]) -> String {
    let data: Vec<_> = films.iter().map(film::Data::new).collect();
    around(title, &embedded(&data))
}

const DATA: &str = "<script type=\"application/json\" id=\"films\">";

/// The recordings of a page of films, as they stand in it; `None` of another page.
pub fn data(page: &str) -> Option<&str> {
    let (_, rest) = page.split_once(DATA)?;
    rest.split('<').next()
}

/// The page without films, to put the data of one in behind [`DATA`].
pub(super) fn viewer() -> String {
    around("film", "")
}

fn around(title: &str, data: &str) -> String {
    styled(
        title,
        include_str!("viewer.css"),
        html! {
            h1 { (title) }
            div #views {}
            (controls())
            div #phases {}
            div #curves {}
            p.note {
                "Drag turns, the wheel or two fingers zoom, shift and drag moves up and down; a \
                click on a curve goes to that time. Red arrows: the socket presses the plug; blue: \
                the fingers do. The tips of the fingers are where they are; what lies between tip \
                and jaw is drawn for the eye, its bend as many times as large as the slider says."
            }
            (PreEscaped(DATA)) (PreEscaped(data)) (PreEscaped("</script>"))
            script { (PreEscaped(include_str!("viewer.js"))) }
        },
    )
}

fn controls() -> maud::Markup {
    html! {
        div.controls {
            button #play type="button" { "Play" }
            input #time type="range" min="0" step="any" value="0" aria-label="time";
            output #clock {}
            label {
                "speed"
                select #speed {
                    option value="1" { "real" }
                    option value="0.25" selected { "1/4" }
                    option value="0.1" { "1/10" }
                    option value="0.02" { "1/50" }
                }
            }
        }
        div.controls {
            label { "bend drawn" input #bend type="range" min="1" max="10" step="1" value="1"; output #times { "1 times" } }
            label { input #contact type="checkbox" checked; "contact forces" }
            label { input #grip type="checkbox"; "grip forces" }
            label { input #glass type="checkbox" checked; "socket of glass" }
        }
    }
}

#[cfg(test)]
pub(super) mod tests;
