//! The window of the finger that is named, as bars over the start's offset: what simulation finds,
//! how much of it is firm, what its ribs give, and what a robot measured.

use crate::answer::words::{end, ends_mm, infill, interval, mm, span};
use crate::answer::{Answer, Measured, OnTask, Recommended, Trust, UnderRobot, Verdict, lines};
use insertion::evaluation::Window;
use insertion::outcome::Outcome;
use maud::{Markup, html};
use study::{ByRibs, OnBench};

/// Share of the width that is left at either side for the words at the ends of a bar.
const ROOM: f64 = 0.2;

/// A bar: what it is, its parts, the outer one first, each with its class, and what ends it.
struct Row {
    name: String,
    parts: Vec<(&'static str, [f64; 2])>,
    ends: [Option<Outcome>; 2],
}

impl Row {
    fn new(name: String, class: &'static str, span: [f64; 2]) -> Self {
        Row { name, parts: vec![(class, span)], ends: [None; 2] }
    }

    fn simulated(window: &Window, firm: Option<[f64; 2]>) -> Self {
        let whole = ends_mm(window);
        let inner = firm.map(|firm| ("firm", firm));
        let name = match firm {
            Some(firm) => format!("simulated: firm {} mm, light {} mm", span(firm), span(whole)),
            None => format!("simulated: {} mm, not confirmed", span(whole)),
        };
        let parts = [("light", whole)].into_iter().chain(inner).collect();
        Row { name, parts, ends: [window.end_negative, window.end_positive] }
    }
}

/// The bars, task by task, those under several robots below on the same scale; nothing if no finger is
/// named.
pub(super) fn section(answer: &Answer, robots: &[UnderRobot]) -> Option<Markup> {
    answer.verdict.finger()?;
    let drawn = |on: &str, mut rows: Vec<Row>| {
        rows.extend(robots.iter().map(under));
        bars(on, &rows)
    };
    if let Some(bench) = &answer.record.on_bench {
        return Some(drawn("", on_bench(answer, bench)));
    }
    let found = answer.recommended.as_ref()?;
    Some(html! {
        @for (at, task) in found.tasks.iter().enumerate() {
            (drawn(&found.on(task), rows(answer, found, (at, task))))
        }
    })
}

/// The same finger under a robot.
fn under(robot: &UnderRobot) -> Row {
    let window = &robot.measured.window;
    let inserts = window.nominal == Outcome::Inserted;
    let parts = inserts.then(|| ("light", ends_mm(window))).into_iter().collect();
    let name = format!("under {}", robot.words());
    Row { name, parts, ends: [window.end_negative, window.end_positive] }
}

fn rows(answer: &Answer, found: &Recommended, (at, task): (usize, &OnTask)) -> Vec<Row> {
    // The finger that is named among several as good ones was not confirmed by itself.
    let other = answer.named().filter(|named| named.index != found.design.index);
    let mut rows = vec![match other.and_then(|named| named.on(at)) {
        Some(other) => Row::simulated(&other.window, None),
        None => Row::simulated(&task.measured.window, task.firm.and_then(|firm| firm.window_mm())),
    }];
    if let Some(by_ribs) = found.by_ribs.filter(|_| other.is_none()) {
        let text = lines::by_ribs(by_ribs).into_iter().nth(at);
        let text = text.map_or(String::new(), |(name, text)| format!("{name}: {text}"));
        let window = match by_ribs {
            ByRibs::Measured(tasks) => tasks.get(at).map(|task| ends_mm(&task.window)),
            ByRibs::Refused(_) => None,
        };
        let parts = window.map(|window| ("ribs", window)).into_iter().collect();
        rows.push(Row { name: text, parts, ends: [None; 2] });
    }
    if let Trust::Published { nearest, .. } = &answer.trust {
        rows.extend(nearest.get(at).iter().flat_map(|(_, fingers)| fingers).map(measured));
    }
    rows
}

/// A finger that a robot measured; only its range is known, so the bar lies about the start.
fn measured(Measured { design, range_mm }: &Measured) -> Row {
    Row::new(
        format!("measured on a robot, {}: {}", infill(design), mm(*range_mm)),
        "measured",
        [-range_mm / 2.0, range_mm / 2.0],
    )
}

fn on_bench(answer: &Answer, bench: &OnBench) -> Vec<Row> {
    let Some(best) = bench.best.first() else { return Vec::new() };
    let [low, high] = [best.low_mm, best.high_mm];
    let name = format!("on the bench: {} ({})", mm(best.range_mm), interval([low, high]));
    let mut expected = Row::new(name, "likely", [-high / 2.0, high / 2.0]);
    expected.parts.push(("measured", [-low / 2.0, low / 2.0]));
    let mut rows = vec![expected];
    if let Verdict::MeasuredBefore { design, range_mm: Some(range_mm), .. } = answer.verdict {
        rows.push(measured(&Measured { design: design.clone(), range_mm }));
    }
    rows.push(Row::simulated(&bench.simulated.window, None));
    rows
}

fn bars(on: &str, rows: &[Row]) -> Markup {
    let all = || rows.iter().flat_map(|row| row.parts.iter().flat_map(|(_, span)| *span));
    let (low, high) = (all().fold(-0.5, f64::min), all().fold(0.5, f64::max));
    let width = (high - low) / (1.0 - 2.0 * ROOM);
    let at = |mm: f64| 100.0 * (ROOM + (mm - low) / width);
    let step = if high - low > 4.0 { 2 } else { 1 };
    let ticks = (low.ceil() as i32..=high.floor() as i32).filter(|mm| mm % step == 0);
    html! {
        div.bars {
            p.muted { "Start along y" (on) ", in mm from the taught one" }
            @for Row { name, parts, ends } in rows {
                p.name { (name) }
                div.track {
                    @for (class, [from, to]) in parts {
                        i class=(class) style={ "left:" (percent(at(*from))) ";width:" (percent(at(*to) - at(*from))) } {}
                    }
                    @if let Some((_, [from, to])) = parts.first() {
                        span.below style={ "right:" (percent(100.5 - at(*from))) } title=(end(ends[0])) { (short(ends[0])) }
                        span.above style={ "left:" (percent(at(*to) + 0.5)) } title=(end(ends[1])) { (short(ends[1])) }
                    }
                    b style={ "left:" (percent(at(0.0))) } {}
                }
            }
            div.ticks aria-hidden="true" {
                @for mm in ticks { span style={ "left:" (percent(at(f64::from(mm)))) } { (format!("{mm:+}").replace("+0", "0")) } }
            }
        }
    }
}

fn percent(value: f64) -> String {
    format!("{value:.1}%")
}

/// Returns the outcome at the end of a bar in a word.
fn short(end: Option<Outcome>) -> &'static str {
    match end {
        Some(Outcome::Failed(class)) => class.short(),
        Some(outcome) => outcome.label(),
        None => "",
    }
}
