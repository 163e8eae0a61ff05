//! What would help more than the infill.

use super::failure::not_stopped;
use super::finger::FingerRequest;
use super::request::SetupRequest;
use super::{Failure, Setup};
use analysis::levers::{Levers, Question};
use insertion::evaluation::template::Template;
use insertion::space::Design;
use insertion::surrogate::Prediction;
use std::sync::atomic::AtomicBool;

/// Of which finger on which task the levers are asked for.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct LeversRequest {
    /// Task, robot, finger model; one task.
    #[command(flatten)]
    pub setup: SetupRequest,
    /// The finger.
    #[command(flatten)]
    pub finger: FingerRequest,
}

impl LeversRequest {
    /// Measures the levers, and the softest and the stiffest infill of the space beside them.
    pub fn run(&self, stop: &AtomicBool) -> Result<Levers, Failure> {
        let setup = self.setup.setup()?;
        let chosen = self.finger.choose(&setup)?;
        let given = chosen.given.then_some(chosen.specimen.stiffness);
        levers(&setup, setup.only_task()?, (&chosen.design, given), None, stop)
    }
}

/// The levers of a design on one of the setup's tasks, its stiffness predicted unless given; `infill`
/// is the smallest and largest range over infills, mm, if that is known.
pub(super) fn levers(
    setup: &Setup,
    template: &Template,
    (design, given): (&Design, Option<Prediction>),
    infill: Option<[f64; 2]>,
    stop: &AtomicBool,
) -> Result<Levers, Failure> {
    let question =
        Question { evaluator: &setup.evaluator, template, space: &setup.space, design, given };
    let found = question.levers(infill, stop).map_err(Failure::input)?;
    not_stopped(stop)?;
    Ok(found)
}
