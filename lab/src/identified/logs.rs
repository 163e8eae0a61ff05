//! Logs of attempts in hidden cells, as a robot with a real sensor writes them.

use super::HiddenCell;
use super::truth::Known;
use ask_tell::normal::StandardNormal;
use ask_tell::stream::stream;
use calibration::identify::log::{Log, Moment, of_samples};
use finger_opt::failure::Failure;
use input::units::MM;
use insertion::evaluation::evaluator::Specimen;
use insertion::outcome::Outcome;
use insertion::space::Design;
use insertion::trial::engine::EngineKind;
use insertion::trial::{Course, Grasp, Probe, Rig, Sample};
use nalgebra::Vector3;
use rand::RngExt;
use std::path::Path;
use study::write_file;

/// The fingers that are logged: percent, degrees.
pub const LOGGED: [[f64; 2]; 2] = [[10.0, 0.0], [30.0, 0.0]];
/// Time between two moments, s.
const EVERY_S: f64 = 2e-3;
/// Noise of each moment and each axis, bias, and drift to the end of a log: standard deviations, N.
const NOISE_N: f64 = 0.5;
const BIAS_N: f64 = 1.0;
const DRIFT_N: f64 = 1.0;
/// Mass of what hangs on the sensor, kg.
const TOOL_KG: f64 = 1.0;
/// A robot that stands upright at this place: its logs are in the task's frame already.
const FRAME: &str =
    "origin_mm = [400.0, 0.0, 100.0]\naxis_angle_rad = [0.0, 0.0, 0.0]\ntool_mass_kg = 1.0\n";

/// Writes the logs of a cell into a folder, with `runs.csv` and `frame.toml`.
///
/// # Errors
/// If it cannot be simulated, or a file cannot be written.
pub fn write(
    cell: &HiddenCell<'_>,
    known: impl Fn(&Design) -> Option<Known>,
    engine: EngineKind,
    folder: &Path,
) -> Result<(), Failure> {
    std::fs::create_dir_all(folder).map_err(|error| Failure::Run(error.into()))?;
    let mut runs = "log,infill_density_percent,infill_direction_deg,offset_mm,outcome\n".to_owned();
    for (finger, [density, direction]) in LOGGED.into_iter().enumerate() {
        let design = Design::infill(density, direction);
        let (Specimen { task, finger: held, .. }, robot) = cell.setup(&design)?;
        let rig = engine.rig(&task, &robot, &held, 1.0).map_err(Failure::input)?;
        let grasp = Grasp::of(&held);
        let found = known(&design).unwrap_or_default();
        let starts = [found.start, found.negative + 0.2, found.positive + 0.2];
        for (i, offset_mm) in [None].into_iter().chain(starts.map(Some)).enumerate() {
            let (samples, outcome) = match offset_mm {
                None => probe(&*rig, grasp)?,
                Some(mm) => {
                    let (trial, samples) = rig.hold(grasp).logged(mm * MM, EVERY_S);
                    (samples, word(trial.outcome))
                }
            };
            let name = format!("{density}-{direction}-{i}.csv");
            let mut log = of_samples(&name, &samples).map_err(Failure::input)?;
            sensed(&mut log, cell.number, (finger * 10 + i) as u64);
            write_file(&folder.join(&name), &log.csv())?;
            let offset = offset_mm.map_or(String::new(), |mm| format!("{mm:.1}"));
            runs += &format!("{name},{density},{direction},{offset},{outcome}\n");
        }
    }
    write_file(&folder.join("frame.toml"), FRAME)?;
    Ok(write_file(&folder.join("runs.csv"), &runs)?)
}

fn probe(rig: &dyn Rig, grasp: Grasp<'_>) -> Result<(Vec<Sample>, String), Failure> {
    let found = rig.follow(grasp, Course::Probe(Probe::USUAL), EVERY_S);
    let (_, samples) =
        found.into_iter().next().ok_or_else(|| Failure::usage("the engine simulates nothing"))?;
    Ok((samples, "probe".to_owned()))
}

fn word(outcome: Outcome) -> String {
    match outcome {
        Outcome::Failed(class) => class.number().to_string(),
        // A trial that diverged is no attempt; there was none.
        _ => "inserted".to_owned(),
    }
}

/// Adds what the sensor carries, its noise, bias and drift.
fn sensed(log: &mut Log, cell: u64, number: u64) {
    let mut random = stream(cell, number, "sensor");
    let mut normal =
        |sd: f64| Vector3::from_fn(|_, _| sd * random.sample::<f64, _>(StandardNormal));
    let (bias, drift) = (normal(BIAS_N), normal(DRIFT_N));
    let places: Vec<Vector3<f64>> = log.moments.iter().map(|moment| moment.position).collect();
    let last = places.len() - 1;
    let rate = |i: usize| {
        let (a, b) = (i.saturating_sub(1), (i + 1).min(last));
        (places[b] - places[a]) / ((b - a) as f64 * EVERY_S)
    };
    let rates: Vec<Vector3<f64>> = (0..=last).map(rate).collect();
    for (i, Moment { force, .. }) in log.moments.iter_mut().enumerate() {
        let (a, b) = (i.saturating_sub(1), (i + 1).min(last));
        let acceleration = (rates[b] - rates[a]) / ((b - a) as f64 * EVERY_S);
        let share = i as f64 / last as f64;
        *force += bias + share * drift + normal(NOISE_N) - TOOL_KG * acceleration;
    }
}
