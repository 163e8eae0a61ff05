//! What would help more than the infill: tornado diagram, table, JSON.

use super::theme::{BLUE, Colour, INK, LINES, MUTED, ORANGE, PAPER};
use analysis::levers::{Lever, Levers, apart, counts, plain};
use maud::{Markup, html};
use serde_json::{Value, json};

/// The levers for other programs, the sentence first.
pub fn json(levers: &Levers) -> Value {
    let mut fields = json!({"sentence": levers.sentence()});
    if let (Some(fields), Value::Object(all)) = (fields.as_object_mut(), json!(levers)) {
        fields.extend(all);
    }
    fields
}

/// Bar of a diagram: from the range of the finger as it is to those at both ends.
struct Bar<'a> {
    name: &'a str,
    span_mm: f64,
    /// Range, mm, and what gives it.
    ends: [(f64, String); 2],
    /// The lever; `None` for the infill.
    lever: Option<&'a Lever>,
}

/// The levers with the infill among them, largest span first.
fn bars(levers: &Levers) -> Vec<Bar<'_>> {
    let bar = |lever: &'_ Lever| {
        let end = |end: usize| {
            let amount = lever.amount([lever.low, lever.high][end]);
            match lever.ends[end] {
                Some(range) => (range, amount),
                None => (0.0, format!("none at {amount}")),
            }
        };
        (lever.span_mm(levers.base), [end(0), end(1)])
    };
    let of = |lever| {
        let (span_mm, ends) = bar(lever);
        Bar { name: &lever.name, span_mm, ends, lever: Some(lever) }
    };
    let mut bars: Vec<_> = levers.levers.iter().map(of).collect();
    let span_mm = apart(levers.infill);
    let ends = levers.infill.map(|range| (range, format!("{range:.1} mm")));
    let at = bars.partition_point(|bar| bar.span_mm > span_mm);
    bars.insert(at, Bar { name: "infill", span_mm, ends, lever: None });
    bars
}

/// The sentence, and a table of 80 columns with the sources below.
pub fn text(levers: &Levers) -> String {
    let base = levers.base;
    let mut text = format!(
        "{}\n\nas it is      {:.1} mm, start taught at {:+.1} mm\n\n{:<25}{:<28}{:<17}{:>8}\n",
        levers.sentence(),
        base.range_mm,
        base.taught_start_mm,
        "lever",
        "from .. now .. to",
        "range there, mm",
        "span, mm"
    );
    let mut sources = String::new();
    for Bar { name, span_mm, ends: [(low, _), (high, _)], lever } in bars(levers) {
        let interval = lever.map_or(String::new(), |lever| {
            let [low, now] = [lever.low, lever.value].map(plain);
            sources += &format!("  {name}: {}\n", lever.source);
            format!("{low} .. {now} .. {}", lever.amount(lever.high))
        });
        let there = format!("{low:.1} .. {high:.1}");
        text += &format!("{name:<25}{interval:<28}{there:<17}{span_mm:>8.1}\n");
    }
    let left_out = match &levers.left_out[..] {
        [] => String::new(),
        names => format!("; none left for {}", names.join(", ")),
    };
    text + &format!("\n{} windows{left_out}\nsources\n{sources}", levers.windows)
}

/// Width of the diagram, left and right end of its scale, height of a row, first row; pixels.
const WIDTH: f64 = 600.0;
const SCALE: [f64; 2] = [260.0, 530.0];
const ROW: f64 = 42.0;
const TOP: f64 = 62.0;
/// Height of a bar: a row has one for each end.
const BAR: f64 = 15.0;

/// Where ranges lie.
struct Axis {
    low_mm: f64,
    pixels: f64,
}

impl Axis {
    fn over(mm: impl Iterator<Item = f64> + Clone) -> Self {
        let low_mm = mm.clone().fold(f64::INFINITY, f64::min).floor();
        let high_mm = mm.fold(low_mm, f64::max).ceil().max(low_mm + 1.0);
        Axis { low_mm, pixels: (SCALE[1] - SCALE[0]) / (high_mm - low_mm) }
    }

    fn at(&self, mm: f64) -> f64 {
        (SCALE[0] + (mm - self.low_mm) * self.pixels).round()
    }

    /// Whole millimetres, at most eight.
    fn ticks(&self) -> impl Iterator<Item = f64> {
        let count = ((SCALE[1] - SCALE[0]) / self.pixels).round();
        let step = (count / 8.0).ceil();
        let low = self.low_mm;
        (0..=(count / step) as u32).map(move |tick| low + f64::from(tick) * step)
    }
}

/// The ranges at both ends of each lever as bars from the range of the finger as it is, largest
/// span first; the infill's in a colour of its own, grey what is too little to matter.
pub fn svg(levers: &Levers) -> String {
    let bars = bars(levers);
    let base = levers.base.range_mm;
    let axis = Axis::over(bars.iter().flat_map(|bar| [bar.ends[0].0, bar.ends[1].0]).chain([base]));
    let bottom = TOP + ROW * bars.len() as f64;
    let title = format!("{}: range with one number changed, mm; now {base:.1} mm", levers.task);
    let line = |mm: f64, colour: Colour, dashes: &str| {
        let x = axis.at(mm);
        html! { line x1=(x) x2=(x) y1=(TOP - 8.0) y2=(bottom) stroke=(colour.hex()) stroke-dasharray=(dashes) {} }
    };
    let drawn = html! {
        svg xmlns="http://www.w3.org/2000/svg" viewBox={ "0 0 " (WIDTH) " " (bottom + 8.0) }
            font-family="sans-serif" font-size="13" fill=(INK.hex()) {
            rect width="100%" height="100%" fill=(PAPER.hex()) {}
            text x="12" y="22" font-size="15" { (title) }
            @for mm in axis.ticks() {
                (line(mm, LINES, "none"))
                text x=(axis.at(mm)) y=(TOP - 14.0) text-anchor="middle" fill=(MUTED.hex()) { (mm) }
            }
            @for (row, bar) in bars.iter().enumerate() {
                (drawn(bar, TOP + ROW * row as f64, base, &axis))
            }
            (line(base, INK, "4 3"))
        }
    };
    drawn.into_string()
}

/// A row of the diagram, whose top is at `y`.
fn drawn(bar: &Bar<'_>, y: f64, base: f64, axis: &Axis) -> Markup {
    let (fill, ink) = match (counts(bar.span_mm), bar.lever) {
        (false, _) => (MUTED, MUTED),
        (true, None) => (ORANGE, INK),
        (true, Some(_)) => (BLUE, INK),
    };
    let (middle, from) = (y + ROW / 2.0, axis.at(base));
    html! {
        text x="12" y=(middle - 2.0) fill=(ink.hex()) { (bar.name) }
        text x="12" y=(middle + 14.0) font-size="12" fill=(MUTED.hex()) {
            (format!("moves {:.1} mm", bar.span_mm))
            @if let Some(lever) = bar.lever { ", now at " (lever.amount(lever.value)) }
        }
        @for (end, (mm, label)) in bar.ends.iter().enumerate() {
            @let to = axis.at(*mm);
            @let top = y + ROW / 2.0 - BAR + end as f64 * (BAR + 1.0);
            @let (x, anchor) = if *mm < base { (to - 5.0, "end") } else { (to + 5.0, "start") };
            rect x=(to.min(from)) y=(top) width=((to - from).abs()) height=(BAR) fill=(fill.hex())
                fill-opacity=(if counts(bar.span_mm) { 0.85 } else { 0.45 }) {}
            text x=(x) y=(top + 12.0) font-size="12" text-anchor=(anchor) fill=(ink.hex()) { (label) }
        }
    }
}
