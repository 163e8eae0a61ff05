//! `optimize levers`: one-at-a-time sensitivity of the range.

use crate::progress::cost;
use crate::setup::finger::usage;
use crate::studies::summary::levers_json;
use crate::{Context, Failure, FingerRequest, Output, Setup, SetupRequest, command, layout};
use analysis::levers::{LeverAnalysis, Levers};
use insertion::{Design, Prediction};
use report::levers as output;
use std::path::PathBuf;

/// Compare the infill with other ways to widen the window: tilt, strokes, grip, friction, robot
#[derive(Debug, Clone, Default, clap::Args)]
#[command(
    override_usage = usage("levers"),
    after_help = "Example: optimize levers --task rj45 --density 18 --direction 20 --svg rj45.svg"
)]
pub struct Request {
    /// One task, robot and finger model.
    #[command(flatten)]
    pub setup: SetupRequest,
    /// The finger.
    #[command(flatten)]
    pub finger: FingerRequest,
    /// Draw the ranges at both ends of each lever
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
}

impl command::Request for Request {
    const PROGRESS: bool = true;

    /// Simulates the levers, and for comparison the softest and the stiffest infill of the space.
    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        context.begin(cost::LEVERS);
        let setup = self.setup.setup()?;
        let chosen = self.finger.choose(&setup)?;
        let given = chosen.given.then_some(chosen.scenario.stiffness);
        let levers = levers(&setup, (&chosen.design, given), None, context)?;
        let (svg, text) = (output::svg(&levers)?, layout::wrapped(&output::text(&levers)));
        Output::new(text, levers_json(&levers)).drawn(svg, self.svg.as_ref())
    }
}

/// Simulates the levers of a design on the setup's task. The stiffness is predicted unless given; `infill` is the
/// smallest and largest range over infills, mm, if known.
pub(crate) fn levers(
    setup: &Setup,
    (design, given): (&Design, Option<Prediction>),
    infill: Option<[f64; 2]>,
    context: &Context<'_>,
) -> Result<Levers, Failure> {
    let (evaluator, template) = (&setup.evaluator, setup.only_task()?);
    let done = |[done, of]: [usize; 2]| {
        context.part("windows of the levers", [done, of], cost::LEVERS / of as f64);
    };
    let space = &setup.space;
    let analysis = LeverAnalysis { evaluator, template, space, design, given, done: &done };
    let levers = analysis.levers(infill, context.stop)?;
    context.check()?;
    Ok(levers)
}
