//! P1 to P5: force over depth of a sharp peg, with lateral and angular compliance together.
//!
//! The peg of Whitney (1982, J. Dyn. Sys. Meas. Control 104:65) crosses a chamfer, slides at one
//! point and then at two. The referee gives the expected values: its limits for small displacements
//! are Whitney's closed forms, which neglect the tilt beside the coefficient of friction (19 % of the
//! one-point force here).

use super::{Rounding, Slab};
use crate::build::{self, Measured};
use crate::planar::{Assembly, Chamfer, Hole, Insertion, Peg, Support, V2, V3};
use crate::{CheckRow, Tolerance};
use contact::Engine;
use input::units::{DEG, MM, N_PER_MM};

/// Speed of the drive, m/s, and damping ratio of the springs: they carry less than 0.1 % of a force.
pub(super) const SLOW: f64 = 2.0 * MM;
pub(super) const DAMPING: f64 = 0.01;
/// Step of the referee, m.
const STEP: f64 = 5e-6;
/// Depth of the chamfer's foot, m.
const FOOT: f64 = 1.5 * MM;
/// Lateral error of the tip, m, and tilt, rad, at the start.
const ERROR: f64 = 1.0 * MM;
const TILT: f64 = -0.02;
/// Force that counts as a contact, N, and that of a peg that jams.
const TOUCHES: f64 = 0.01;
const LIMIT: f64 = 50.0;

/// Returns a peg 8 mm wide on springs, whose centre lies 21 mm above its tip, over a hole with a chamfer.
pub fn base() -> Assembly {
    let chamfer = Chamfer { width: FOOT, angle: 45.0 * DEG };
    Assembly {
        peg: Peg { half_width: 4.0 * MM, radius: 0.0 },
        hole: Hole { half_width: 4.05 * MM, radius: 0.0, chamfer: Some(chamfer) },
        friction: 0.2,
        support: Support {
            lateral: 2.6 * N_PER_MM,
            axial: 40.0 * N_PER_MM,
            angular: 2.0,
            centre: 21.0 * MM,
        },
        compliance: 0.0,
    }
}

/// Depth, force, side force and moment about the tip after each step, and whether the left wall is
/// touched.
struct Course(Vec<([f64; 4], bool)>);

impl Course {
    /// Returns force, side force and moment at a depth.
    fn at(&self, depth: f64) -> Option<[f64; 3]> {
        let after = self.0.iter().position(|(row, _)| row[0] >= depth)?;
        let (a, b) = (self.0[after.checked_sub(1)?].0, self.0[after].0);
        let share = (depth - a[0]) / (b[0] - a[0]);
        Some([1, 2, 3].map(|i| a[i] + share * (b[i] - a[i])))
    }

    /// Returns the depth at which the left wall is first touched.
    fn onset(&self) -> Option<f64> {
        self.0.iter().find(|(_, touches)| *touches).map(|(row, _)| row[0])
    }
}

/// Returns depth, force, side force and moment about the middle of the tip.
fn row(assembly: &Assembly, pose: &V3, load: &V3) -> [f64; 4] {
    let tip = assembly.support.tip(pose);
    let moment = load.z + (pose.xy() - tip).perp(&load.xy());
    [-tip.y, -load.y, load.x, moment]
}

fn expected(assembly: Assembly, depth: f64) -> Option<Course> {
    let mut insertion = Insertion::above(assembly, ERROR, TILT);
    let mut rows = Vec::new();
    while insertion.depth() < depth && insertion.force() < LIMIT {
        insertion.advance(STEP).ok()?;
        let touches = insertion.state.contacts.iter().any(|contact| contact.feature.side() == 0);
        rows.push((row(&assembly, &insertion.state.pose, &insertion.load()), touches));
    }
    Some(Course(rows))
}

fn measured(engine: &dyn Engine, assembly: Assembly, depth: f64) -> Measured<Course> {
    let start = Insertion::above(assembly, ERROR, TILT).target;
    let mut slab = Slab::new(engine, &assembly, start, Rounding::Flats(0), DAMPING);
    let mut rows = Vec::new();
    while slab.depth() < depth && -slab.load().y < LIMIT {
        slab.step(&(V3::y() * -SLOW))?;
        let touches = slab.world.contact(slab.hole[0], slab.peg).normal_sum > TOUCHES;
        rows.push((row(&assembly, &slab.pose(), &slab.load()), touches));
    }
    Ok(Course(rows))
}

/// Returns the force of a chamfer of 60 degrees after 0.5 mm, by Whitney's closed form.
fn chamfer_force() -> f64 {
    let Assembly { peg, friction, support, .. } = base();
    let Support { lateral, angular, centre, .. } = support;
    let (sin, cos) = libm::sincos(60.0 * DEG);
    let (along, across) = (cos + friction * sin, sin - friction * cos);
    let stiffness =
        (lateral * centre * centre + angular) * across - lateral * centre * peg.half_width * along;
    lateral * angular * along * 0.5 * MM * cos / sin / stiffness
}

/// Returns the force after the tip's edge has sunk by 0.5 mm on a chamfer of 60 degrees.
fn chamfer_measured(engine: &dyn Engine) -> Measured {
    let mut assembly = base();
    let angle = 60.0 * DEG;
    assembly.hole.chamfer = Some(Chamfer { width: 1.0 * MM, angle });
    let [r, hole] = [assembly.peg.half_width, assembly.hole.half_width];
    let depth = 0.5 * MM * libm::tan(angle);
    let tip = V2::new(hole + 0.5 * MM - r, 1e-6 - depth);
    let start = assembly.support.pose(tip, 0.0);
    let mut slab = Slab::new(engine, &assembly, start, Rounding::Flats(0), DAMPING);
    loop {
        slab.step(&(V3::y() * -SLOW))?;
        let force = -slab.load().y;
        let down = -depth - assembly.support.place(&slab.pose(), &V2::new(r, 0.0)).y;
        if down > 0.5 * MM || force > LIMIT {
            return Ok(force * 0.5 * MM / down);
        }
    }
}

/// Returns the angle of the tilted flank, and that of the force on it, to the plane of the mouth where
/// the flank is pressed on a sharp rim without friction, degrees.
fn flank_normal(engine: &dyn Engine) -> Measured<[f64; 2]> {
    let mut assembly = base();
    assembly.friction = 0.0;
    assembly.hole = Hole { half_width: 4.5 * MM, radius: 0.0, chamfer: None };
    let start = assembly.support.pose(V2::new(0.0, -3.0 * MM), 1.5 * TILT);
    let mut slab = Slab::new(engine, &assembly, start, Rounding::Flats(0), 0.3);
    for _ in 0..build::steps(slab.world.as_ref(), 0.5) {
        slab.step(&(V3::x() * SLOW))?;
    }
    let force = slab.world.contact(slab.hole[1], slab.peg).net;
    Ok([-slab.pose().z, libm::atan2(force.z, -force.x)].map(|angle| angle / DEG))
}

/// Returns the rows P1 to P5, and P10 for a sharp rim.
pub fn sharp(engine: &dyn Engine) -> Vec<CheckRow> {
    let share = Tolerance::Relative(0.01);
    let depth = 7.0 * MM;
    let assembly = base();
    let (Some(expected), found) = (expected(assembly, depth), measured(engine, assembly, depth))
    else {
        return Vec::new();
    };
    let found = found.as_ref();
    let new = |check, text: &str, depth: f64, value: fn([f64; 3]) -> f64, unit| {
        let at = |course: &Course| course.at(depth).map_or(f64::NAN, value);
        CheckRow::new(check, text, at(&expected), found.map(at), unit, share)
    };
    let [force, ratio]: [fn([f64; 3]) -> f64; 2] =
        [|row| row[0], |[force, _, moment]| moment / (4.0 * MM * force)];
    let onset = |course: &Course| course.onset().map_or(f64::NAN, |depth| depth / MM);
    let closed = chamfer_measured(engine);
    let normal = flank_normal(engine);
    vec![
        CheckRow::new("P1", "Fz on a chamfer of 60 deg", chamfer_force(), closed, "N", share),
        new("P1", "Fz on a chamfer of 45 deg, tilted", 0.75 * MM, force, "N"),
        new("P2", "Fz at one point, 1 mm inside", FOOT + 1.0 * MM, force, "N"),
        CheckRow::new(
            "P3",
            "depth of the second contact",
            onset(&expected),
            found.map(onset),
            "mm",
            Tolerance::Absolute(0.01),
        ),
        new("P4", "Fz at two points, 5 mm inside", FOOT + 5.0 * MM, force, "N"),
        new("P5", "M/(r Fz) of sliding, 5 mm inside", FOOT + 5.0 * MM, ratio, "-"),
        CheckRow::new(
            "P10",
            "normal of a tilted flank on a sharp rim",
            normal.map_or(f64::NAN, |[flank, _]| flank),
            normal.map(|[_, force]| force),
            "deg",
            Tolerance::Absolute(0.01),
        ),
    ]
}
