//! A trial that a caller commands step by step: no command of the command line has it.

use super::Failure;
use super::call::read;
use super::setup::{Setup, SetupArguments};
use super::specimen::FingerArguments;
use clap::Args;
use input::shipped::Source;
use input::units::MM;
use insertion::evaluation::tolerance::offset;
use insertion::trial::{Driven, NEVER, State};
use nalgebra::Vector3;

/// Task, robot and finger.
#[derive(Debug, Args)]
struct Arguments {
    #[command(flatten)]
    setup: SetupArguments,
    #[command(flatten)]
    finger: FingerArguments,
}

/// A grasped part in front of its socket.
pub struct Insertion {
    driven: Driven,
    /// The taught start, m.
    taught: f64,
}

impl Insertion {
    /// Of the words that `optimize trial` takes for task, robot and finger; `tasks`, if there are
    /// any, in place of the file that `--task` names.
    ///
    /// # Errors
    /// As the command fails, and if the engine simulates nothing.
    pub fn new(words: &[String], tasks: &[Source]) -> Result<Self, Failure> {
        let mut arguments: Arguments = read(words)?;
        arguments.setup.given = tasks.to_vec();
        let setup = Setup::from_arguments(&arguments.setup)?;
        let specimen = arguments.finger.choose(&setup)?.specimen;
        let taught = setup.evaluator.taught(&specimen, &NEVER).map_err(Failure::input)?;
        let rig = setup.evaluator.rig(&specimen, None, 1.0).map_err(Failure::input)?;
        let driven = rig.driven(&specimen.finger).ok_or_else(|| {
            Failure::usage(
                "this engine simulates nothing that could be driven; use --engine direct",
            )
        })?;
        Ok(Insertion { driven, taught: taught.map_or(0.0, offset) })
    }

    /// Begins anew, with the start shifted by so much along y, mm.
    pub fn start(&mut self, offset_mm: f64) -> State {
        self.driven.start(self.taught + offset_mm * MM)
    }

    /// Commands a velocity of the TCP, mm/s, for a control step.
    pub fn step(&mut self, velocity_mm_per_s: [f64; 3]) -> State {
        self.driven.step(Vector3::from(velocity_mm_per_s) * MM)
    }
}
