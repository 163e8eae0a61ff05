//! F1 to F4: the computed stiffness of a printed finger, without a contact engine.
//!
//! | check | what must be right |
//! | --- | --- |
//! | F1 | beams and a frame of known stiffness |
//! | F2 | the patch test: any even strain is met exactly |
//! | F3 | mesh: half the size changes little; matrices symmetric and positive definite |
//! | F4 | another program's stiffness of the measured designs |

mod beams;
mod mesh;
mod reference;

use super::CheckRow;
use finray::geometry::Geometry;
use finray::infill::InfillDesign;
use finray::printed::PrintedFinger;
use input::shipped::FINGERS;

pub fn run() -> Vec<CheckRow> {
    [beams::f1, beams::f2, mesh::f3, reference::f4].iter().flat_map(|check| check()).collect()
}

fn finray9() -> Option<PrintedFinger> {
    let shipped = FINGERS.first()?;
    PrintedFinger::parse(shipped.text, shipped.file).ok()
}

/// Returns the finger with an infill of a density (percent) and a direction (degrees).
fn infill(finger: &PrintedFinger, [density, direction]: [f64; 2]) -> Option<Geometry> {
    let design =
        InfillDesign { density_percent: density, direction_deg: direction, phase_mm: None };
    Geometry::new(finger, &design).ok()
}
