//! F1 to F4: the stiffness that is computed of a printed finger. They ask no contact engine.
//!
//! | check | what must be right |
//! | --- | --- |
//! | F1 | beams and a frame of known stiffness |
//! | F2 | the patch test: any even strain is met exactly |
//! | F3 | mesh: half the size changes little; matrices symmetric and positive definite |
//! | F4 | another program's stiffness of the measured designs |

mod beams;
mod mesh;
mod patch;
mod reference;

use super::CheckRow;
use finray::FingerError;
use finray::geometry::Geometry;
use finray::infill::Design;
use finray::printed::PrintedFinger;
use input::InputError;
use input::shipped::FINGERS;

pub use beams::f1;
pub use mesh::f3;
pub use patch::f2;
pub use reference::f4;

/// Why a finger has no stiffness to be checked.
#[derive(Debug, thiserror::Error)]
enum NoFinger {
    #[error(transparent)]
    File(#[from] InputError),
    #[error(transparent)]
    Finger(#[from] FingerError),
    #[error("no finger is shipped")]
    None,
}

/// Runs them all, in order.
pub fn run() -> Vec<CheckRow> {
    [f1, f2, f3, f4].iter().flat_map(|check| check()).collect()
}

/// The finger of the measured designs.
fn finray9() -> Result<PrintedFinger, NoFinger> {
    let shipped = FINGERS.first().ok_or(NoFinger::None)?;
    Ok(PrintedFinger::parse(shipped.text, shipped.file)?)
}

/// It with an infill of this density (percent) and direction (degrees).
fn infill(finger: &PrintedFinger, [density, direction]: [f64; 2]) -> Result<Geometry, NoFinger> {
    let design = Design { density_percent: density, direction_deg: direction, phase_mm: None };
    Ok(Geometry::new(finger, &design)?)
}
