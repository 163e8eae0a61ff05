//! Windows of the measured fingers under a finger model.

use super::published::TaskTable;
use insertion::evaluation::Window;
use insertion::evaluation::taught::{Moved, teach};
use insertion::evaluation::template::Impossible;
use insertion::evaluation::tolerance::{self, Search};
use insertion::finger::computed::AtPad;
use insertion::finger::model::FingerSource;
use insertion::robot::Robot;
use insertion::space::Design;
use insertion::stiffness::Measurement;
use insertion::task::{StartRule, Task};
use insertion::trial::NEVER;
use insertion::trial::engine::EngineKind;
use rayon::prelude::*;

/// Setup for the windows of measured fingers.
pub struct Windows<'a> {
    pub fingers: &'a FingerSource,
    pub robot: &'a Robot,
    pub engine: EngineKind,
    pub search: Search,
}

impl Windows<'_> {
    /// Windows of all designs on all tasks, with their measured stiffness; in parallel, collected by
    /// task and design.
    ///
    /// # Errors
    /// If a finger is impossible, or the robot or the engine cannot do a task.
    pub fn measure(
        &self,
        tasks: &[Task],
        designs: &[Measurement],
    ) -> Result<Vec<TaskTable>, Impossible> {
        let pairs = tasks.iter().flat_map(|task| designs.iter().map(move |design| (task, design)));
        let pairs = pairs.collect::<Vec<_>>().into_par_iter();
        let windows = pairs.map(|(task, design)| self.window(task, design));
        let windows = windows.collect::<Result<Vec<Window>, Impossible>>()?;
        let table = |(task, found): (&Task, &[Window])| {
            TaskTable::new(&task.name, designs.iter().copied().zip(found.iter().cloned()))
        };
        Ok(tasks.iter().zip(windows.chunks(designs.len().max(1))).map(table).collect())
    }

    /// Window of a finger about the start that its task asks for.
    fn window(&self, task: &Task, design: &Measurement) -> Result<Window, Impossible> {
        let Measurement { compliance, assembly, density_percent, direction_deg, .. } = *design;
        let infill = Design::infill(density_percent, direction_deg);
        let finger = self.fingers.make(AtPad { compliance, assembly }, &infill, task)?.finger;
        let rig = self.engine.rig(task, self.robot, &finger, 1.0)?;
        let taught = match task.strategy.rule {
            StartRule::Given => None,
            StartRule::Taught => teach(&*rig, &finger, &NEVER),
        };
        let moved = Moved { rig: &*rig, by: taught.unwrap_or(0) };
        Ok(tolerance::evaluate(&moved, &finger, self.search).window)
    }
}
