//! T8, second part: independence of the time step.
//!
//! Halving the step changes no outcome of the cases that can end in two ways, each taken at both
//! sides of its threshold; and a restored snapshot continues exactly like its world.

use super::build;
use super::edge::{self, Push};
use super::{CheckRow, Make, Tolerance, incline, jamming, wedging};
use contact::{Diverged, Engine};
use input::units::{DEG, MM};

/// Distance of the cases from their thresholds, as a share.
const MARGIN: f64 = 0.02;
/// A block that is slower than this rests, m/s.
const RESTS: f64 = 0.01 * MM;
const FRICTION: f64 = 0.3;
/// Simulated time before the snapshot and after it, s: from the push to the fall.
const BEFORE: f64 = 0.3;
const AFTER: f64 = 0.3;

/// Outcomes that change with the step, and bits that change with a snapshot, T8 rows.
pub fn t8(make: Make<'_>) -> Vec<CheckRow> {
    let none = Tolerance::Absolute(0.0);
    let row = |text: &str, measured| CheckRow::new("T8", text, 0.0, measured, "-", none);
    let engine = make(1.0);
    vec![
        row("outcomes changed by half the step", changed_outcomes(make)),
        row("steps changed by restoring a snapshot", changed_steps(engine.as_ref())),
    ]
}

fn changed_outcomes(make: Make<'_>) -> Result<f64, Diverged> {
    let (whole, half) = (outcomes(make(1.0).as_ref())?, outcomes(make(0.5).as_ref())?);
    Ok(whole.iter().zip(&half).filter(|(a, b)| a != b).count() as f64)
}

/// Whether a block rests on an incline at two headings, a peg jams, a peg
/// wedges, below and above their thresholds; whether a block tips at the edge.
fn outcomes(engine: &dyn Engine) -> Result<Vec<bool>, Diverged> {
    let mut all = Vec::new();
    for share in [1.0 - MARGIN, 1.0 + MARGIN] {
        for heading in [0.0, 37.0] {
            all.push(incline::creep(engine, FRICTION, heading * DEG, share)? < RESTS);
        }
        all.push(jamming::jams_at(engine, share)?);
        all.push(wedging::wedges(engine, FRICTION, share * FRICTION)?);
    }
    all.push(edge::tipping_place(engine)?.abs() < edge::ALLOWED);
    Ok(all)
}

/// Steps after which a world and its restored snapshot differ at all.
fn changed_steps(engine: &dyn Engine) -> Result<f64, Diverged> {
    let mut first = Push::new(engine);
    for _ in 0..build::steps(first.world.as_ref(), BEFORE) {
        first.step()?;
    }
    let mut second = first.copy();
    let mut changed = 0;
    for _ in 0..build::steps(first.world.as_ref(), AFTER) {
        first.step()?;
        second.step()?;
        changed += usize::from(first.world.pose(first.block) != second.world.pose(second.block));
    }
    Ok(changed as f64)
}
