//! `optimize map`: how insertions end over two errors of the start.

use super::terminal::merge;
use super::words;
use super::{Failure, chosen, print, print_json};
use crate::session::{Chosen, MapRequest};
use analysis::map::CaptureMap;
use clap::Args;
use insertion::trial::NEVER;
use serde_json::{Value, json};

/// Trace the capture map of one finger
///
/// A tolerance window is one line through it: along y, without a second error. At most 300 trials;
/// what lies between two that end alike is taken over from them.
#[derive(Debug, Args)]
pub struct Arguments {
    #[command(flatten)]
    request: MapRequest,
    /// Print the result as JSON
    #[arg(long)]
    json: bool,
}

/// Runs the command.
pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let (chosen, map) = arguments.request.run(&NEVER)?;
    if arguments.json {
        return print_json(&json(&chosen, &map));
    }
    let wrote =
        arguments.request.svg.iter().map(|file| format!("wrote         {}\n", file.display()));
    let wrote: String = wrote.collect();
    print(&format!("{}{wrote}", words::wrapped(&text(&chosen, &map))))
}

/// Output of `--json`.
pub fn json(chosen: &Chosen, map: &CaptureMap) -> Value {
    let mut fields = chosen::json(chosen);
    merge(&mut fields, json!(map));
    fields
}

fn text(chosen: &Chosen, map: &CaptureMap) -> String {
    let [first, second] = &map.axes;
    let mut lines = vec![("area".to_owned(), format!("{:.1} {} insert", map.area, map.area_unit))];
    for (number, axis) in map.axes.iter().enumerate() {
        let ends = map.ends(number);
        let text = ends.map_or("nothing inserts".to_owned(), |[low, high]| {
            let cut = if low == axis.low || high == axis.high { ", the map's end" } else { "" };
            format!("{low:+} to {high:+} {}{cut}", axis.unit)
        });
        lines.push((format!("along {}", axis.name), text));
    }
    let window = map.window_mm().map_or("fails at the nominal start".to_owned(), |[low, high]| {
        format!("{low:+} to {high:+} mm")
    });
    lines.push((format!("at {} = 0", second.name), window));
    let coarser = if map.traced_step > first.step {
        format!("; its border within {} for want of trials", map.traced_step)
    } else {
        String::new()
    };
    let places: usize = map.outcomes.iter().map(Vec::len).sum();
    let steps = format!("{} {}, {} {}", first.step, first.unit, second.step, second.unit);
    lines.push((
        "trials".to_owned(),
        format!("{} for {places} places, every {steps}{coarser}", map.trials),
    ));
    format!("task          {}\n{}{}", map.task, chosen::text(chosen), words::lines(lines))
}
