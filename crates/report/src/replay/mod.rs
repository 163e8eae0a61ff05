//! Recorded trials as a page that plays them, and as a plot of force against depth.

mod curve;
mod film;

use super::elements::styled;
use super::explore::embedded;
pub use curve::svg as curve_svg;

use insertion::{OffsetStep, Pad, Recording, Task};
use maud::{PreEscaped, html};

/// Recorded trial of a task.
#[derive(Debug, Clone, Copy)]
pub struct Film<'a> {
    /// Label: `start shifted by +1.5 mm`.
    pub label: &'a str,
    /// Task of the trial.
    pub task: &'a Task,
    /// Pad of the fingers, which presses the part, and the roof above it.
    pub pad: &'a Pad,
    /// Recording of the trial.
    pub recording: &'a Recording,
}

/// Ends of a window: name and step outward.
pub const ENDS: [(&str, OffsetStep); 2] = [("negative", -1), ("positive", 1)];

/// Returns the path, in the folder of a study, of the page with both trials at an end of the recommended finger's
/// window; `task` is the index of the task.
pub fn pair_file(task: usize, end: &str) -> String {
    format!("replay/{}-{end}.html", task + 1)
}

/// Returns the path of a picture of the last instant of the failed trial, shown until the films are played.
pub fn poster_file(task: usize, end: &str) -> String {
    format!("replay/{}-{end}.svg", task + 1)
}

/// Returns a page that plays films side by side, offline. Its script of 18 kB replaces a library (three.js: 700 kB).
pub fn page(title: &str, films: &[Film]) -> String {
    player(title, &embedded(&films.iter().map(film::data).collect()))
}

/// Tag before the data of a page of films.
const DATA: &str = "<script type=\"application/json\" id=\"films\">";

/// Returns the JSON data of a page of films; `None` if the page has none.
pub fn data(page: &str) -> Option<&str> {
    let (_, rest) = page.split_once(DATA)?;
    rest.split('<').next()
}

/// Returns a page that plays the films of `data`, JSON; if it is empty, a script can insert the data after [`DATA`].
pub(super) fn player(title: &str, data: &str) -> String {
    styled(
        title,
        include_str!("viewer.css"),
        html! {
            h1 { (title) }
            div #views {}
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
                label { "deflection drawn" input #bend type="range" min="1" max="10" step="1" value="1"; output #times { "1 times" } }
                label { input #contact type="checkbox" checked; "contact forces" }
                label { input #grip type="checkbox"; "grip forces" }
                label { input #glass type="checkbox" checked; "transparent socket" }
            }
            div #phases {}
            div #curves {}
            p.note {
                "Drag to rotate, scroll or pinch to zoom, hold Shift and drag to move up and down; \
                click a curve to go to that time. Red arrows: force of the socket on the plug; blue: \
                forces of the fingers on it. Drawn are the simulated parts: the faces that plug and \
                socket can touch, and the gripped part; pale, schematic: the plug where its faces are left \
                out between them; violet, without contact: contact springs and other faces that overlap \
                when mated. Between fingertip and jaw the finger is \
                schematic; the slider exaggerates its deflection."
            }
            (PreEscaped(DATA)) (PreEscaped(data)) (PreEscaped("</script>"))
            script { (PreEscaped(include_str!("viewer.js"))) }
        },
    )
}

#[cfg(test)]
pub(super) mod tests;
