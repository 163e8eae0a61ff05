//! How insertions end over two errors of the start.

use super::failure::not_stopped;
use super::{Chosen, Failure, FingerRequest, Setup, SetupRequest};
use analysis::map::{Axes, CaptureMap, Mark, Plane};
use insertion::evaluation::OffsetStep;
use insertion::evaluation::evaluator::Specimen;
use insertion::space::Design;
use insertion::trial::Grasp;
use std::path::PathBuf;
use std::sync::atomic::AtomicBool;
use study::write_file;

/// Which finger to map on which task, and over which errors.
#[derive(Debug, Clone, Default, clap::Args)]
pub struct MapRequest {
    /// Task, robot, finger model; one task.
    #[command(flatten)]
    pub setup: SetupRequest,
    /// The finger.
    #[command(flatten)]
    pub finger: FingerRequest,
    /// The two errors of the start: mm, degrees
    #[arg(long, value_enum, default_value_t)]
    pub axes: Axes,
    /// Draw the map
    #[arg(long, value_name = "FILE.svg")]
    pub svg: Option<PathBuf>,
}

impl MapRequest {
    /// Traces the map and draws it if that was asked for.
    pub fn run(&self, stop: &AtomicBool) -> Result<(Chosen, CaptureMap), Failure> {
        let setup = self.setup.setup()?;
        let chosen = self.finger.choose(&setup)?;
        let taught = setup.evaluator.taught(&chosen.specimen, stop).map_err(Failure::input)?;
        let finger = (&chosen.specimen, &chosen.design);
        let map = map_of(&setup, finger, taught, self.axes, stop)?;
        if let Some(file) = &self.svg {
            write_file(file, &report::map::svg(&map)?)?;
        }
        Ok((chosen, map))
    }

    /// A trial at every place of that map: thousands.
    pub fn full(&self, map: &CaptureMap, stop: &AtomicBool) -> Result<Vec<Vec<Mark>>, Failure> {
        let setup = self.setup.setup()?;
        let specimen = self.finger.choose(&setup)?.specimen;
        let taught = setup.evaluator.taught(&specimen, stop).map_err(Failure::input)?;
        on_plane((&setup, &specimen), taught, self.axes, stop, |plane| map.full(plane))
    }
}

/// The map of a finger, a specimen and its design, from this taught start.
///
/// # Errors
/// If task, robot and finger cannot be simulated; if `stop` is set meanwhile.
pub(super) fn map_of(
    setup: &Setup,
    (specimen, design): (&Specimen, &Design),
    taught: Option<OffsetStep>,
    axes: Axes,
    stop: &AtomicBool,
) -> Result<CaptureMap, Failure> {
    on_plane((setup, specimen), taught, axes, stop, |plane| {
        CaptureMap::trace(&specimen.task.name, design.clone(), plane)
    })
}

fn on_plane<T>(
    (setup, specimen): (&Setup, &Specimen),
    taught: Option<OffsetStep>,
    axes: Axes,
    stop: &AtomicBool,
    measure: impl FnOnce(&Plane) -> T,
) -> Result<T, Failure> {
    let rig = setup.evaluator.rig(specimen, taught, 1.0).map_err(Failure::input)?;
    let grasp = Grasp { stop, ..Grasp::of(&specimen.finger) };
    let measured = measure(&Plane::new(&*rig, grasp, axes));
    not_stopped(stop)?;
    Ok(measured)
}
