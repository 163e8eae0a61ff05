//! Step convergence: do the ends of the tolerance windows stay where they are
//! when the engine cuts time finer? No closed form says where they belong, so the
//! engine is compared with itself.

use crate::evaluation::tolerance::{self, Search};
use crate::evaluation::{OffsetStep, Window, grid_mm};
use crate::input::robot::Robot;
use crate::input::stiffness::Measurement;
use crate::input::task::Task;
use crate::physics::Engine;
use crate::trial::run::{EngineRig, RigError};
use crate::units::N_PER_MM;
use crate::verify::agreement;
use rayon::prelude::*;
use serde_json::{Value, json};
use std::fmt::Write;

/// Farthest an end may move, in grid steps: 0.1 mm.
const ALLOWED_STEPS: OffsetStep = 1;

/// The window of one finger, as simulated and finer.
#[derive(Debug, Clone, PartialEq)]
pub struct WindowRow {
    /// The task.
    pub task: String,
    /// The finger, one of the measured ones.
    pub design: Measurement,
    /// What was finer.
    pub finer: &'static str,
    /// With the production settings.
    pub production: Window,
    /// With the finer ones.
    pub refined: Window,
}

impl WindowRow {
    /// How far the negative and the positive end move outward, mm.
    pub fn moved_mm(&self) -> [f64; 2] {
        self.moved().map(grid_mm)
    }

    fn moved(&self) -> [OffsetStep; 2] {
        let (was, is) = (&self.production, &self.refined);
        [was.negative_steps - is.negative_steps, is.positive_steps - was.positive_steps]
    }

    /// Whether the nominal start ends alike and no end moves by more than 0.1 mm.
    pub fn passed(&self) -> bool {
        self.production.nominal == self.refined.nominal
            && self.moved().iter().all(|moved| moved.abs() <= ALLOWED_STEPS)
    }
}

/// The measured designs of lowest, middle and highest compliance stiffness.
pub fn three(mut designs: Vec<Measurement>) -> Vec<Measurement> {
    designs.sort_by(|a, b| a.compliance.total_cmp(&b.compliance));
    let Some(last) = designs.len().checked_sub(1) else { return designs };
    let mut places = vec![0, last / 2, last];
    places.dedup();
    places.into_iter().map(|place| designs[place]).collect()
}

/// Measures the windows of some fingers on some tasks, once as the engine is made
/// and once for each way in which it can be [finer](Engine::finer).
///
/// # Errors
/// If robot, task and engine do not go together.
pub fn measure(
    tasks: &[Task],
    designs: &[Measurement],
    robot: &Robot,
    make: &(dyn Fn() -> Box<dyn Engine> + Sync),
) -> Result<Vec<WindowRow>, RigError> {
    let cases: Vec<(&Task, Measurement)> =
        tasks.iter().flat_map(|task| designs.iter().map(move |design| (task, *design))).collect();
    let rows: Result<Vec<Vec<WindowRow>>, RigError> =
        cases.into_par_iter().map(|(task, design)| rows(task, design, robot, make())).collect();
    Ok(rows?.concat())
}

fn rows(
    task: &Task,
    design: Measurement,
    robot: &Robot,
    engine: Box<dyn Engine>,
) -> Result<Vec<WindowRow>, RigError> {
    let window = |engine| -> Result<Window, RigError> {
        let rig = EngineRig::new(task.clone(), robot, engine)?;
        let finger = agreement::finger(&task.finger, &design);
        Ok(tolerance::evaluate(&rig, &finger, Search::default()).window)
    };
    let finer = engine.finer();
    let production = window(engine)?;
    let row = |(finer, engine)| {
        Ok(WindowRow {
            task: task.name.clone(),
            design,
            finer,
            production: production.clone(),
            refined: window(engine)?,
        })
    };
    finer.into_iter().map(row).collect()
}

/// The rows as an aligned table, at most 100 columns wide.
pub fn table(rows: &[WindowRow]) -> String {
    let mut text = format!(
        "{:<7}{:>7}{:>12}  {:<19}{:>15}{:>16}{:>14}\n{:>26}  {:19}{:>15}{:>16}{:>14}\n",
        "task",
        "design",
        "compliance",
        "finer",
        "window",
        "finer window",
        "ends move",
        "N/mm",
        "",
        "mm",
        "mm",
        "mm"
    );
    for row in rows {
        let [below, above] = row.moved_mm();
        // Writing to a string cannot fail.
        let _ = writeln!(
            text,
            "{:<7}{:>7}{:>12.2}  {:<19}{:>15}{:>16}{:>7.1}{:>7.1}  {}",
            row.task,
            row.design.design,
            row.design.compliance / N_PER_MM,
            row.finer,
            ends(&row.production),
            ends(&row.refined),
            below,
            above,
            if row.passed() { "ok" } else { "FAIL" },
        );
    }
    text
}

fn ends(window: &Window) -> String {
    format!("{:.1} to {:+.1}", window.negative_mm(), window.positive_mm())
}

/// The rows as a JSON array of objects.
pub fn json(rows: &[WindowRow]) -> Value {
    let window = |window: &Window| json!({"negative_mm": window.negative_mm(), "positive_mm": window.positive_mm()});
    rows.iter()
        .map(|row| {
            let [below, above] = row.moved_mm();
            json!({
                "task": row.task,
                "design": row.design.design,
                "compliance_n_per_mm": row.design.compliance / N_PER_MM,
                "finer": row.finer,
                "production": window(&row.production),
                "refined": window(&row.refined),
                "negative_moved_mm": below,
                "positive_moved_mm": above,
                "allowed_mm": grid_mm(ALLOWED_STEPS),
                "passed": row.passed(),
            })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::published;
    use crate::outcome::{FailureClass, Outcome};

    fn window(negative_steps: OffsetStep, positive_steps: OffsetStep) -> Window {
        let end = Some(Outcome::Failed(FailureClass::Jammed));
        Window {
            nominal: Outcome::Inserted,
            negative_steps,
            positive_steps,
            end_negative: end,
            end_positive: end,
        }
    }

    fn row(refined: Window) -> WindowRow {
        let design = three(published::designs())[0];
        WindowRow {
            task: "usb".into(),
            design,
            finer: "half the step",
            production: window(-33, 14),
            refined,
        }
    }

    #[test]
    fn an_end_may_move_by_one_step_of_the_grid() {
        assert_eq!(row(window(-34, 13)).moved_mm(), [0.1, -0.1]);
        assert!(row(window(-34, 13)).passed());
        assert!(!row(window(-33, 16)).passed());
        let jams = Window { nominal: Outcome::Failed(FailureClass::Jammed), ..window(-33, 14) };
        assert!(!row(jams).passed());
    }

    #[test]
    fn the_three_designs_span_the_measured_stiffness() {
        let designs = published::designs();
        let all: Vec<f64> = designs.iter().map(|design| design.compliance).collect();
        let chosen: Vec<f64> = three(designs).iter().map(|design| design.compliance).collect();
        assert_eq!(chosen[0], all.iter().copied().fold(f64::INFINITY, f64::min));
        assert_eq!(chosen[2], all.iter().copied().fold(0.0, f64::max));
        assert_eq!(all.iter().filter(|&&k| k < chosen[1]).count(), (all.len() - 1) / 2);
    }

    #[test]
    fn the_table_fits_a_terminal_and_names_the_failures() {
        let text = table(&[row(window(-33, 14)), row(window(-33, 19))]);
        assert!(text.lines().all(|line| line.len() <= 100), "{text}");
        assert_eq!(text.matches("FAIL").count(), 1, "{text}");
    }
}
