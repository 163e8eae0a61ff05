//! Simulated logs of attempts in hidden cells, with the errors of a real force sensor.

use super::cell::{FingerWindows, HiddenCell};
use calibration::identify::log::of_samples;
use finger_opt::failure::Failure;
use input::units::MM;
use insertion::evaluation::evaluator::Scenario;
use insertion::space::Design;
use insertion::trial::Grasp;
use insertion::trial::engine::EngineKind;
use std::path::Path;
use study::write_file;

/// Infills of the logged fingers, percent and degrees.
pub const LOGGED: [[f64; 2]; 2] = [[10.0, 0.0], [30.0, 0.0]];
/// Mass of the tool on the sensor, kg.
const TOOL_KG: f64 = 1.0;
/// Text of `frame.toml`: no rotation, since the logs are in the task's frame already, and the mass of the tool.
const FRAME: &str =
    "origin_mm = [400.0, 0.0, 100.0]\naxis_angle_rad = [0.0, 0.0, 0.0]\ntool_mass_kg = 1.0\n";

/// Writes the logs of a cell into a folder, with `runs.csv` and `frame.toml`: a friction probe and three attempts of
/// each logged finger.
pub fn write(
    cell: &HiddenCell<'_>,
    windows: &[FingerWindows],
    engine: EngineKind,
    folder: &Path,
) -> Result<(), Failure> {
    let mut runs = "log,infill_density_percent,infill_direction_deg,offset_mm,outcome\n".to_owned();
    for (finger, [density, direction]) in LOGGED.into_iter().enumerate() {
        let scenario = cell.setup(&Design::infill(density, direction))?;
        let Scenario { task, finger: held, robot, .. } = scenario;
        let rig = engine.rig(&task, &robot, &held, 1.0).map_err(Failure::input)?;
        let grasp = Grasp::of(&held);
        let known = |one: &&FingerWindows| one.finger.infill() == [density, direction];
        let [start, negative, positive] =
            windows.iter().find(known).map_or([0.0; 3], FingerWindows::starts_mm);
        // The probe, the taught start, 0.2 mm inside the negative end and 0.2 mm beyond the positive end.
        let offsets = [None, Some(start), Some(negative + 0.2), Some(positive + 0.2)];
        for (i, offset_mm) in offsets.into_iter().enumerate() {
            let (samples, outcome) = match offset_mm {
                None => {
                    let probed = rig.probe(grasp);
                    let none = || Failure::running("the engine simulates no probe");
                    (probed.ok_or_else(none)?.1, "probe".to_owned())
                }
                Some(mm) => {
                    let (trial, samples) = rig.grasp(grasp).logged(mm * MM);
                    let class = trial.outcome.failure();
                    (samples, class.map_or("inserted".to_owned(), |class| class.to_string()))
                }
            };
            let name = format!("{density}-{direction}-{i}.csv");
            let mut log = of_samples(&name, &samples).map_err(Failure::input)?;
            log.add_sensor_errors(TOOL_KG, cell.number, (finger * 10 + i) as u64);
            write_file(&folder.join(&name), &log.csv())?;
            let offset = offset_mm.map_or(String::new(), |mm| format!("{mm:.1}"));
            runs += &format!("{name},{density},{direction},{offset},{outcome}\n");
        }
    }
    write_file(&folder.join("frame.toml"), FRAME)?;
    Ok(write_file(&folder.join("runs.csv"), &runs)?)
}
