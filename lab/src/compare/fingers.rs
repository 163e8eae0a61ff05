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

/// Windows of all designs on all tasks, with their measured stiffness, each about the start that its
/// task asks for; in parallel, collected by task and design.
pub fn windows(
    fingers: &FingerSource,
    robot: &Robot,
    engine: EngineKind,
    search: Search,
    tasks: &[Task],
    designs: &[Measurement],
) -> Result<Vec<TaskTable>, Impossible> {
    let window = |(task, design): (&Task, &Measurement)| {
        let Measurement { compliance, assembly, density_percent, direction_deg, .. } = *design;
        let infill = Design::infill(density_percent, direction_deg);
        let finger = fingers.make(AtPad { compliance, assembly }, &infill, task)?.finger;
        let rig = engine.rig(task, robot, &finger, 1.0)?;
        let taught = match task.strategy.rule {
            StartRule::Given => None,
            StartRule::Taught => teach(&*rig, &finger, &NEVER),
        };
        let moved = Moved { rig: &*rig, by: taught.unwrap_or(0) };
        Ok(tolerance::evaluate(&moved, &finger, search).window)
    };
    let pairs = tasks.iter().flat_map(|task| designs.iter().map(move |design| (task, design)));
    let pairs = pairs.collect::<Vec<_>>().into_par_iter();
    let windows = pairs.map(window).collect::<Result<Vec<Window>, Impossible>>()?;
    let table = |(task, found): (&Task, &[Window])| {
        TaskTable::new(&task.name, designs.iter().copied().zip(found.iter().cloned()))
    };
    Ok(tasks.iter().zip(windows.chunks(designs.len().max(1))).map(table).collect())
}
