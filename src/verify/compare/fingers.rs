//! The windows of the measured fingers as one finger model has them.

use super::published::TaskTable;
use crate::evaluation::Window;
use crate::evaluation::taught::{Moved, teach};
use crate::evaluation::template::Impossible;
use crate::evaluation::tolerance::{self, Search};
use crate::finger::computed::AtPad;
use crate::finger::model::FingerSource;
use crate::input::robot::Robot;
use crate::input::space::Design;
use crate::input::stiffness::Measurement;
use crate::input::task::{StartRule, Task};
use crate::outcome::Outcome;
use crate::trial::NEVER;
use crate::trial::engine::EngineKind;
use rayon::prelude::*;

/// How the windows of measured fingers are found.
pub struct Windows<'a> {
    /// Makes the fingers.
    pub fingers: &'a FingerSource,
    /// The robot.
    pub robot: &'a Robot,
    /// What computes the contacts.
    pub engine: EngineKind,
    /// How the windows' ends are looked for.
    pub search: Search,
    /// Whether a start that does not insert is taught though its task does not ask for it.
    pub teach: bool,
}

impl Windows<'_> {
    /// The windows of all designs on all tasks, with their measured stiffness, and how many
    /// starts of each task were taught; in parallel, collected by task and design.
    ///
    /// # Errors
    /// If a finger cannot be, or the robot or the engine cannot do a task.
    pub fn measure(
        &self,
        tasks: &[Task],
        designs: &[Measurement],
    ) -> Result<Vec<(TaskTable, usize)>, Impossible> {
        let pairs: Vec<(&Task, &Measurement)> = tasks
            .iter()
            .flat_map(|task| designs.iter().map(move |design| (task, design)))
            .collect();
        let windows: Result<Vec<(Window, bool)>, Impossible> =
            pairs.into_par_iter().map(|(task, design)| self.window(task, design)).collect();
        let windows = windows?;
        let table = |(task, found): (&Task, &[(Window, bool)])| {
            let windows = found.iter().map(|(window, _)| window.clone());
            let rows = designs.iter().copied().zip(windows);
            (TaskTable::new(&task.name, rows), found.iter().filter(|(_, taught)| *taught).count())
        };
        Ok(tasks.iter().zip(windows.chunks(designs.len().max(1))).map(table).collect())
    }

    /// The window of a finger about its start, and whether that was moved to where it inserts.
    fn window(&self, task: &Task, design: &Measurement) -> Result<(Window, bool), Impossible> {
        let Measurement { compliance, assembly, density_percent, direction_deg, .. } = *design;
        let infill = Design::infill(density_percent, direction_deg);
        let finger = self.fingers.make(AtPad { compliance, assembly }, &infill, task)?.finger;
        let rig = self.engine.rig(task, self.robot, &finger, 1.0)?;
        let own = || tolerance::evaluate(&*rig, &finger, self.search).window;
        if task.strategy.rule == StartRule::Given {
            let window = own();
            if window.nominal == Outcome::Inserted || !self.teach {
                return Ok((window, false));
            }
        }
        let Some(by) = teach(&*rig, &finger, &NEVER) else { return Ok((own(), false)) };
        let moved = Moved { rig: &*rig, by };
        Ok((tolerance::evaluate(&moved, &finger, self.search).window, by != 0))
    }
}
