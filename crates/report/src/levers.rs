//! Levers: table and tornado diagram.

use super::chart::{Area, DrawResult, HPos, VPos, padded_range, render, rows, text_style};
use super::marks::{bar, dashed, label};
use super::theme::{BLUE, INK, MUTED, ORANGE};
use super::{ReportError, text_table};
use analysis::levers::{Lever, Levers, difference_mm, is_relevant, thousandths};
use plotters::prelude::Color;

/// Bars of a row of the diagram: from the current range to the ranges at both ends of a lever.
struct Bar<'a> {
    name: &'a str,
    /// Difference between the largest and the smallest range.
    span_mm: f64,
    /// Range at each end, mm, and the label of the end.
    ends: [(f64, String); 2],
    /// The lever; `None` for the infill.
    lever: Option<&'a Lever>,
}

/// Returns the rows of the levers and of the infill, largest span first.
fn bars<'a>(levers: &'a Levers) -> Vec<Bar<'a>> {
    let bar = |lever: &'a Lever| {
        let end = |end: usize| {
            let amount = lever.amount([lever.low, lever.high][end]);
            lever.ends[end].map_or((0.0, format!("none at {amount}")), |range| (range, amount))
        };
        let (span_mm, ends) = (lever.span_mm(levers.base), [end(0), end(1)]);
        Bar { name: &lever.name, span_mm, ends, lever: Some(lever) }
    };
    let mut bars: Vec<_> = levers.levers.iter().map(bar).collect();
    let span_mm = difference_mm(levers.infill);
    let ends = levers.infill.map(|range| (range, format!("{range:.1} mm")));
    let at = bars.partition_point(|bar| bar.span_mm > span_mm);
    bars.insert(at, Bar { name: "infill", span_mm, ends, lever: None });
    bars
}

/// Returns the summary sentence, a table within 80 columns, and the sources of the intervals.
pub fn text(levers: &Levers) -> String {
    let base = levers.base;
    let mut text = format!(
        "{}\n\nnow           {:.1} mm, start taught at {:+.1} mm\n\n",
        levers.sentence(),
        base.range_mm,
        base.taught_start_mm,
    );
    let mut sources = String::new();
    let rows = bars(levers).into_iter().map(|bar| {
        let Bar { name, span_mm, ends: [(low, _), (high, _)], lever } = bar;
        let interval = lever.map_or(String::new(), |lever| {
            let [low, now] = [lever.low, lever.value].map(thousandths);
            sources += &format!("  {name}: {}\n", lever.source);
            format!("{low} .. {now} .. {}", lever.amount(lever.high))
        });
        [name.to_owned(), interval, format!("{low:.1} .. {high:.1}"), format!("{span_mm:.1}")]
    });
    text += &text_table(3, ["lever", "from .. now .. to", "range there, mm", "span, mm"], rows);
    let left_out = match &levers.left_out[..] {
        [] => String::new(),
        names => format!("; not evaluated: {}", names.join(", ")),
    };
    text + &format!("\n{} windows{left_out}\nsources\n{sources}", levers.windows)
}

/// Width of the diagram (that of a phone), heights of a row and of head and foot together, and left margin, pixels.
const WIDTH: u32 = 356;
const ROW: u32 = 50;
const HEAD_AND_FOOT: u32 = 110;
const LEFT: u32 = 8;
/// Font size in pixels of the plot; about 12 on a phone, which scales the plot down.
const TEXT: u32 = 15;

/// Draws a tornado diagram: the ranges at both ends of each lever as bars from the current range of the finger, largest
/// span first; the infill in another colour, negligible levers in grey.
///
/// # Errors
/// If the drawing library fails.
pub fn svg(levers: &Levers) -> Result<String, ReportError> {
    let bars = bars(levers);
    let height = HEAD_AND_FOOT + ROW * bars.len() as u32;
    render("the levers", (WIDTH, height), |area| draw(area, levers, &bars))
}

fn draw(area: &Area<'_>, levers: &Levers, bars: &[Bar<'_>]) -> DrawResult {
    let base = levers.base.range_mm;
    let ends = bars.iter().flat_map(|bar| [bar.ends[0].0, bar.ends[1].0]);
    // Leaves room for the labels beside the bars.
    let range = padded_range(ends.chain([base]), 0.22);
    let [left, right] = [range.start, range.end];
    let title = format!("{}: range with one number changed", levers.task);
    let now = format!("range (mm), now {base:.1}");
    let mut chart = rows(area, &title, (&now, range), bars.len(), LEFT)?;
    for (row, Bar { name, span_mm, ends, lever }) in bars.iter().enumerate() {
        let (fill, ink, share) = match (is_relevant(*span_mm), lever) {
            (false, _) => (MUTED, MUTED, 0.45),
            (true, None) => (ORANGE, INK, 0.85),
            (true, Some(_)) => (BLUE, INK, 0.85),
        };
        let y = -(row as f64);
        let now = lever.map(|lever| format!(", now {}", lever.amount(lever.value)));
        let span = format!("span {span_mm:.1} mm{}", now.unwrap_or_default());
        for (words, ink, x, side) in
            [(*name, ink, left, HPos::Left), (&span, MUTED, right, HPos::Right)]
        {
            let style = text_style(TEXT, ink, side, VPos::Center);
            label(&mut chart, (x, y - 0.2), (0, 0), words, &style)?;
        }
        for ((mm, words), top) in ends.iter().zip([y - 0.37, y - 0.65]) {
            let (by, anchor) = if *mm < base { (-5, HPos::Right) } else { (5, HPos::Left) };
            let style = text_style(TEXT, ink, anchor, VPos::Center);
            bar(&mut chart, [base, *mm], [top, top - 0.27], fill.rgb.mix(share).filled())?;
            label(&mut chart, (*mm, top - 0.14), (by, 0), words, &style)?;
        }
        // Between the lines of text.
        dashed(&mut chart, [(base, y - 0.35), (base, y - 0.94)])?;
    }
    Ok(())
}
