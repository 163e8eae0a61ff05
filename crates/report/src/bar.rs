//! Windows of the recommended finger as bars over the offset of the start: simulated, firm (all repeats insert),
//! simulated with the stiffness computed from its ribs, and measured on a robot.

use crate::answer::words::{design, ends_mm, interval, measured, mm, on, span};
use crate::answer::{Answer, MeasuredFinger, OnTask, Recommended, RobotWindow, Trust, lines};
use crate::glossary::explained;
use insertion::{Outcome, Window};
use maud::{Markup, html};
use study::{BenchPrediction, ByRibs};

/// Share of the width on either side that is reserved for the labels of a bar's ends.
const MARGIN: f64 = 0.2;

/// Bar: label, parts from outer to inner (CSS class and both ends, mm), and outcomes beyond its ends.
struct Bar {
    name: String,
    parts: Vec<(&'static str, [f64; 2])>,
    ends: [Option<Outcome>; 2],
    /// Whether only the range is known: the parts then extend from 0 to it and have no position on the scale.
    width_only: bool,
}

impl Bar {
    /// Returns a bar at its position on the scale.
    fn placed(name: String, parts: Vec<(&'static str, [f64; 2])>, window: Option<&Window>) -> Self {
        let ends = window.map_or([None; 2], |window| [window.end_negative, window.end_positive]);
        Bar { name, parts, ends, width_only: false }
    }

    /// Returns a bar of windows of which only the ranges, mm, are known, from outer to inner.
    fn width_only(name: String, ranges_mm: &[(&'static str, f64)]) -> Self {
        let parts = ranges_mm.iter().map(|&(class, range_mm)| (class, [0.0, range_mm])).collect();
        Bar { width_only: true, ..Bar::placed(name, parts, None) }
    }

    /// Returns the bar of a simulated window with its firm part, mm, if it was repeated.
    fn simulated(window: &Window, firm: Option<[f64; 2]>) -> Self {
        let whole = ends_mm(window);
        let inner = firm.map(|firm| ("firm", firm));
        let name = match firm {
            Some(firm) => {
                let [firm, whole] = [firm, whole].map(span);
                format!("simulated: firm {firm} mm (dark), single trials {whole} mm")
            }
            None => format!("simulated: {} mm, not confirmed", span(whole)),
        };
        Bar::placed(name, [("light", whole)].into_iter().chain(inner).collect(), Some(window))
    }
}

/// Returns the bars of each task and, below them on the same scale, those of the finger on each of `robots`; `None` if
/// no finger is recommended.
pub(super) fn section(answer: &Answer, robots: &[RobotWindow]) -> Option<Markup> {
    answer.verdict.finger()?;
    let with_robots = |task: &str, mut rows: Vec<Bar>| {
        rows.extend(robots.iter().map(on_robot));
        bars(task, &rows)
    };
    if let Some(bench) = &answer.record.on_bench {
        return Some(with_robots("", on_bench(answer, bench)));
    }
    let found = answer.recommended.as_ref()?;
    Some(html! {
        @for (at, task) in found.tasks.iter().enumerate() {
            (with_robots(&on(&answer.record.config, task.name), rows(answer, found, (at, task))))
        }
    })
}

/// Returns the bar of the finger on a robot, empty if the nominal start fails.
fn on_robot(robot: &RobotWindow) -> Bar {
    let window = &robot.measured.window;
    let inserts = window.nominal == Outcome::Inserted;
    let parts = inserts.then(|| ("light", ends_mm(window))).into_iter().collect();
    Bar::placed(format!("on {}", robot.words()), parts, Some(window))
}

fn rows(answer: &Answer, found: &Recommended, (at, task): (usize, &OnTask)) -> Vec<Bar> {
    // The firm window and the window by the ribs are those of `found.design`, not of the safe choice.
    let other = answer.design_to_print().filter(|named| named.index != found.design.index);
    let mut rows = vec![match other.and_then(|named| named.on(at)) {
        Some(other) => Bar::simulated(&other.window, None),
        None => Bar::simulated(&task.measured.window, task.firm.and_then(|firm| firm.window_mm())),
    }];
    if let Some(by_ribs) = found.by_ribs.filter(|_| other.is_none()) {
        let ribs = match by_ribs {
            ByRibs::Measured(tasks) => tasks.get(at),
            ByRibs::Refused(_) => None,
        };
        let shown = ribs.filter(|ribs| lines::comparable(ribs, task.measured));
        let parts = shown.map(|ribs| ("ribs", ends_mm(&ribs.window))).into_iter().collect();
        let text = lines::by_ribs(by_ribs, (at, task.measured));
        rows.extend(text.map(|(name, text)| Bar::placed(format!("{name}: {text}"), parts, None)));
    }
    if let Trust::Published { nearest } = &answer.trust {
        rows.extend(nearest.get(at).iter().flat_map(|(_, fingers)| fingers).map(published));
    }
    rows
}

/// Returns the bar of a published finger, of which only the range is known.
fn published((finger, range_mm): &MeasuredFinger) -> Bar {
    let range = mm(*range_mm);
    let name = format!("measured on a robot, {}: {range}, ends not recorded", design(finger));
    Bar::width_only(name, &[("measured", *range_mm)])
}

fn on_bench(answer: &Answer, bench: &BenchPrediction) -> Vec<Bar> {
    let Some(best) = bench.best.first() else { return Vec::new() };
    let interval = interval([best.low_mm, best.high_mm]);
    let finger = design(&best.design);
    let name = format!("expected on the bench, {finger}: {} ({interval})", mm(best.range_mm));
    let expected = Bar::width_only(name, &[("likely", best.high_mm), ("measured", best.low_mm)]);
    let mut rows = vec![expected];
    if let Some(best) = answer.use_now() {
        let name = format!("measured on a robot, {}: {}", design(&best.design), measured(&best));
        rows.push(Bar::width_only(name, &[("measured", best.range_mm)]));
    }
    rows.push(Bar::simulated(&bench.simulated.window, None));
    rows
}

/// Draws the bars on one scale: windows above its ticks, ranges without ends below them.
fn bars(on: &str, rows: &[Bar]) -> Markup {
    let positions = |row: &Bar| row.parts.iter().flat_map(|(_, span)| *span).collect::<Vec<_>>();
    let (ranges, windows): (Vec<&Bar>, Vec<&Bar>) = rows.iter().partition(|row| row.width_only);
    let all = || windows.iter().flat_map(|row| positions(row));
    let (low, high) = (all().fold(-0.5, f64::min), all().fold(0.5, f64::max));
    let widest = ranges.iter().flat_map(|row| positions(row)).fold(high - low, f64::max);
    let width = widest / (1.0 - 2.0 * MARGIN);
    let at = |mm: f64| 100.0 * (MARGIN + (mm - low) / width);
    let step = if high - low > 4.0 { 2 } else { 1 };
    let ticks = (low.ceil() as i32..=high.floor() as i32).filter(|mm| mm % step == 0);
    let outcome = |end: Option<Outcome>| end.map_or(String::new(), class);
    html! {
        div.bars {
            p.muted { "Offset of the start along y" (on) ", mm" }
            @for Bar { name, parts, ends, .. } in windows {
                p.name { (explained(name)) }
                div.track {
                    (filled(parts, at))
                    @if let Some((_, [from, to])) = parts.first() {
                        span.below style={ "right:" (percent(100.5 - at(*from))) } { (explained(&outcome(ends[0]))) }
                        span.above style={ "left:" (percent(at(*to) + 0.5)) } { (explained(&outcome(ends[1]))) }
                    }
                    b style={ "left:" (percent(at(0.0))) } {}
                }
            }
            div.ticks aria-hidden="true" {
                @for mm in ticks { span style={ "left:" (percent(at(f64::from(mm)))) } { (format!("{mm:+}").replace("+0", "0")) } }
            }
            @if !ranges.is_empty() { p.muted { "Ranges without their ends, on the same scale" } }
            @for Bar { name, parts, .. } in ranges {
                p.name { (explained(name)) }
                div.track.range { (filled(parts, |mm| at(low + mm) - 100.0 * MARGIN)) }
            }
        }
    }
}

/// Returns the parts of a bar as HTML; `at` maps a length, mm, to a position, percent of the width.
fn filled(parts: &[(&'static str, [f64; 2])], at: impl Fn(f64) -> f64) -> Markup {
    html! {
        @for (class, [from, to]) in parts {
            i class=(class) style={ "left:" (percent(at(*from))) ";width:" (percent(at(*to) - at(*from))) } {}
        }
    }
}

fn percent(value: f64) -> String {
    format!("{value:.1}%")
}

/// Returns the short name of an outcome, for a failure with the number of its class: `jammed (3)`.
fn class(outcome: Outcome) -> String {
    let number = outcome.failure().map_or(String::new(), |number| format!(" ({number})"));
    format!("{}{number}", outcome.short())
}
