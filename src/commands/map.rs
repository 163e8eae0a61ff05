//! `optimize map`: outcomes of insertions over two errors of the start.

use crate::progress::cost;
use crate::setup::finger::usage;
use crate::{
    ChosenFinger, Context, Failure, FingerRequest, Output, Setup, SetupRequest, command, layout,
};
use analysis::map::{Axes, CaptureMap, Plane};
use insertion::{Design, Grasp, OffsetStep, Scenario, value_name};
use parameters::plan::grid::MAX_TRIALS;
use serde::Serialize;
use std::path::PathBuf;
use std::sync::atomic::{AtomicUsize, Ordering};

/// Trace the capture map of one finger
///
/// The tolerance window is its section along y without a second error. At most 300 trials are simulated; points
/// between two equal outcomes are filled in.
#[derive(Debug, Clone, Default, clap::Args)]
#[command(
    override_usage = usage("map"),
    after_help = "Example: optimize map --task usb --density 10 --direction 26 --axes y,yaw --svg map.svg"
)]
pub struct Request {
    /// One task, robot and finger model.
    #[command(flatten)]
    pub setup: SetupRequest,
    /// The finger.
    #[command(flatten)]
    pub finger: FingerRequest,
    /// The two errors of the start, mm or degrees
    #[arg(long, value_enum, default_value_t)]
    pub axes: Axes,
    /// Draw the map
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
}

/// Capture map of a finger: outcomes of insertions over two errors of the start.
#[derive(Serialize)]
pub struct Mapped {
    /// The finger on its task.
    #[serde(flatten)]
    pub chosen: ChosenFinger,
    /// The map.
    #[serde(flatten)]
    pub map: CaptureMap,
}

impl command::Request for Request {
    const PROGRESS: bool = true;

    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        let stop = context.stop;
        context.begin(cost::MAP);
        let setup = self.setup.setup()?;
        let chosen = self.finger.choose(&setup)?;
        let taught = setup.evaluator.taught(&chosen.scenario, stop)?;
        let map = map_of(&setup, (&chosen.scenario, &chosen.design), taught, self.axes, context)?;
        let svg = report::map::svg(&map)?;
        let value = Mapped { chosen, map };
        let text = layout::wrapped(&value.text()) + &layout::wrote(&self.svg);
        Output::new(text, value).drawn(svg, self.svg.as_ref())
    }
}

/// Number of trials that are one part of the progress: a single one can be as short as a result from the cache.
const TOGETHER: usize = 10;

/// Traces the capture map of `scenario`, which has the given design. It is centred on the taught start, if any.
///
/// # Errors
/// If task, robot and finger cannot be simulated; if it is cancelled meanwhile.
pub(crate) fn map_of(
    setup: &Setup,
    (scenario, design): (&Scenario, &Design),
    taught: Option<OffsetStep>,
    axes: Axes,
    context: &Context<'_>,
) -> Result<CaptureMap, Failure> {
    let rig = setup.evaluator.rig(scenario, taught, 1.0)?;
    let grasp = Grasp { stop: context.stop, ..Grasp::of(&scenario.finger) };
    let plane = Plane::new(&*rig, grasp, axes);
    let what = format!("trials of the map {}", value_name(axes));
    let part = |done_of, trials: usize| {
        context.part(&what, done_of, cost::MAP * trials as f64 / MAX_TRIALS as f64);
    };
    let count = AtomicUsize::new(0);
    let done = || {
        let done = count.fetch_add(1, Ordering::Relaxed) + 1;
        if done.is_multiple_of(TOGETHER) {
            part([done, MAX_TRIALS], TOGETHER);
        }
    };
    let map = CaptureMap::trace(&scenario.task.name, design.clone(), &plane, &done);
    if map.trials < MAX_TRIALS {
        part([map.trials; 2], MAX_TRIALS - map.trials / TOGETHER * TOGETHER);
    }
    context.check()?;
    Ok(map)
}

impl Mapped {
    fn text(&self) -> String {
        let Mapped { chosen, map } = self;
        let [first, second] = &map.axes;
        let area = format!("{:.1} {}, of starts that insert", map.area, map.area_unit);
        let mut lines = vec![("area".to_owned(), area)];
        for (number, axis) in map.axes.iter().enumerate() {
            let text = map.ends(number).map_or("nothing inserts".to_owned(), |[low, high]| {
                let cut = if low == axis.low || high == axis.high { ", the map's end" } else { "" };
                format!("{low:+} to {high:+} {}{cut}", axis.unit)
            });
            lines.push((format!("along {}", axis.name), text));
        }
        let window = map.window_mm().map(|[low, high]| format!("{low:+} to {high:+} mm"));
        let window = window.unwrap_or("fails at the nominal start".to_owned());
        lines.push((format!("at {} = 0", second.name), window));
        let coarser = (map.traced_step > first.step)
            .then(|| format!("; border traced to {} only (limit of trials)", map.traced_step));
        let points: usize = map.outcomes.iter().map(Vec::len).sum();
        let steps = format!("{} {}, {} {}", first.step, first.unit, second.step, second.unit);
        let trials = format!("{} for {points} grid points, every {steps}", map.trials);
        lines.push(("trials".to_owned(), trials + &coarser.unwrap_or_default()));
        chosen.text() + &layout::lines(lines)
    }
}
