//! P6 to P10: two-point contact, wedging, crossing, capture and normals of rounded edges.

use super::forms::{DAMPING, SLOW, base};
use super::wedge::wedges;
use super::{Rounding, Slab};
use crate::build::{self, Measured};
use crate::planar::{
    Assembly, Geometry, Hole, Peg, TWO_POINT, V2, V3, cone_margin, two_point_pose,
};
use crate::{CheckRow, Tolerance};
use contact::Engine;
use input::units::{DEG, MM, N_PER_MM};

/// Largest error of a depth, mm, and of an angle, degrees.
const DEPTH: Tolerance = Tolerance::Absolute(0.01);
const ANGLE: Tolerance = Tolerance::Absolute(0.01);
const BISECTIONS: usize = 11;

/// Returns the peg 7 mm wide in 7.1 mm.
pub fn slim(rho: f64, rim: f64, friction: f64) -> Assembly {
    Assembly {
        peg: Peg { half_width: 3.5 * MM, radius: rho * MM },
        hole: Hole { half_width: 3.55 * MM, radius: rim * MM, chamfer: None },
        friction,
        ..base()
    }
}

/// Returns the rows P6 to P10 for edges of a representation.
pub fn rounded(engine: &dyn Engine, rounding: Rounding) -> Vec<CheckRow> {
    let mut rows = two_point(engine, rounding);
    rows.extend(wedging(engine, rounding));
    rows.extend(crossing(engine, rounding));
    rows.push(capture(engine, rounding));
    rows.extend(normals(engine, rounding));
    rows
}

/// Moment by which the contacts of P6 are pressed, N m: 0.05 N each.
const PRESSING: f64 = 2.5e-4;
/// Time of turning, s.
const TURNING: f64 = 0.5;

/// Turns the peg in its hole until both contacts are closed; the depth belongs to the tilt found.
fn two_point(engine: &dyn Engine, rounding: Rounding) -> Vec<CheckRow> {
    let row = |tilt: f64| {
        let mut assembly = slim(0.3, 0.2, 0.0);
        assembly.support.lateral = 0.1 * N_PER_MM;
        let closed = two_point_pose(&assembly, -tilt);
        let turned: Measured<(f64, f64)> = (|| {
            let depth = assembly.support.tip(&closed).y;
            let start = assembly.support.pose(V2::new(0.0, depth), 0.0);
            let mut slab = Slab::new(engine, &assembly, start, rounding, 0.3);
            let count = build::steps(slab.world.as_ref(), TURNING);
            let last = tilt + PRESSING / assembly.support.angular;
            // About the tip, so that only the tilt presses; then at rest.
            for i in 1..=count + count / 4 {
                let share = i.min(count) as f64 / count as f64;
                slab.target = assembly.support.pose(V2::new(0.0, depth), -last * share);
                slab.step(&V3::zeros())?;
            }
            Ok((slab.depth(), slab.pose().z))
        })();
        let of_tilt = |tilt: f64| -assembly.support.tip(&two_point_pose(&assembly, tilt)).y / MM;
        let expected = turned.map_or(f64::NAN, |(_, tilt)| of_tilt(tilt));
        let quantity = format!("depth of two contacts at {tilt} rad");
        CheckRow::new("P6", quantity, expected, turned.map(|(depth, _)| depth / MM), "mm", DEPTH)
    };
    [0.02, 0.05].map(row).to_vec()
}

fn wedging(engine: &dyn Engine, rounding: Rounding) -> Vec<CheckRow> {
    let row = |(rho, rim, friction): (f64, f64, f64)| {
        let assembly = slim(rho, rim, friction);
        let depth = |tilt: f64| -assembly.support.tip(&two_point_pose(&assembly, -tilt)).y / MM;
        let geometry = Geometry::new(&assembly);
        let inside = |tilt: f64| {
            let pose = two_point_pose(&assembly, -tilt);
            let [first, second] = TWO_POINT.map(|feature| geometry.touch(feature, &pose));
            cone_margin(&first, &second, friction) > 0.0
        };
        let limit = build::bisected([1e-3, 0.1], 40, |tilt| Ok(!inside(tilt))).unwrap_or(f64::NAN);
        let found = build::bisected([0.7 * limit, 1.5 * limit], BISECTIONS, |tilt| {
            wedges(engine, &assembly, tilt, rounding).map(|wedged| !wedged)
        });
        let quantity = format!("depth of wedging, mu {friction}, rho {rho}, rim {rim} mm");
        CheckRow::new("P7", quantity, depth(limit), found.map(depth), "mm", DEPTH)
    };
    [(0.0, 0.0, 0.3), (0.3, 0.0, 0.3), (0.3, 0.3, 0.3), (0.3, 0.3, 0.2)].map(row).to_vec()
}

/// Rotational stiffness of a peg that stays upright, N m/rad.
const UPRIGHT: f64 = 1e4;
/// Radii of tip edge and rim of P8 and P9, mm.
const RADII: [f64; 2] = [0.3, 0.2];

/// Speed of P8, m/s, and damping ratio of its springs: the first touch, which gives the peg a speed aside,
/// must have died away at the peak.
const CREEP: f64 = 0.5 * MM;
const CALM: f64 = 0.1;

fn upright() -> Assembly {
    let mut assembly = slim(RADII[0], RADII[1], 0.2);
    assembly.support.angular = UPRIGHT;
    assembly
}

/// Returns the world of a peg above the mouth with an overlap, m, of its edge and the rim.
fn above(engine: &dyn Engine, overlap: f64, rounding: Rounding, damping: f64) -> Slab {
    let assembly = upright();
    let slack = assembly.hole.half_width - assembly.peg.half_width;
    let start = assembly.support.pose(V2::new(slack + overlap, 2e-6), 0.0);
    Slab::new(engine, &assembly, start, rounding, damping)
}

/// Peak of Kx rhos (cos p - cos p0) tan(p + phi) over the angle p of the contact, and its end.
fn crossing(engine: &dyn Engine, rounding: Rounding) -> Vec<CheckRow> {
    let assembly = upright();
    let (radii, overlap) = (assembly.radii(), 0.3 * MM);
    let (stiffness, phi) = (assembly.support.lateral, libm::atan(assembly.friction));
    let force = |p: f64| stiffness * (radii * (libm::cos(p) - 1.0) + overlap) * libm::tan(p + phi);
    let first = libm::acos(1.0 - overlap / radii);
    let peak = (0..=10_000).map(|i| force(first * f64::from(i) / 1e4)).fold(0.0, f64::max);
    let found: Measured<[f64; 2]> = (|| {
        let mut slab = above(engine, overlap, rounding, CALM);
        let mut most: f64 = 0.0;
        loop {
            let [depth, force] = slab.sample(&(V3::y() * -CREEP))?;
            most = most.max(force);
            if depth > 1.5 * MM || force > MISSED {
                return Ok([most, force]);
            }
        }
    })();
    let row = |text, expected, i: usize| {
        let found = found.map(|found| found[i]);
        CheckRow::new("P8", text, expected, found, "N", Tolerance::Relative(0.01))
    };
    vec![row("peak of Fz over a round rim", peak, 0), row("Fz behind it", force(0.0), 1)]
}

/// Force at which a peg is not captured, N.
const MISSED: f64 = 10.0;

fn capture(engine: &dyn Engine, rounding: Rounding) -> CheckRow {
    let assembly = upright();
    let radii = assembly.radii();
    let limit = radii * (1.0 - libm::sin(libm::atan(assembly.friction)));
    let captured = |overlap: f64| {
        let mut slab = above(engine, overlap, rounding, DAMPING);
        loop {
            let [depth, force] = slab.sample(&(V3::y() * -2.0 * SLOW))?;
            if depth > 1.0 * MM || force > MISSED {
                return Ok(force < MISSED);
            }
        }
    };
    let found = build::bisected([0.6 * radii, radii], BISECTIONS, captured);
    CheckRow::new("P9", "overlap that is captured", limit / MM, found.map(|f| f / MM), "mm", DEPTH)
}

/// Overlap of P10, m, and springs, N/m, that hold the peg in it: it moves by a tenth of that.
const PRESSED: f64 = 0.3e-6;
const FIRM: f64 = 1e7;

/// Presses the edge on the rim without friction, and reads the direction of the force. The peg is at rest:
/// `direct` and rapier keep the points of a contact, and its normal, until it has moved by some micrometres.
fn normals(engine: &dyn Engine, rounding: Rounding) -> Vec<CheckRow> {
    let row = |angle: f64| {
        let mut assembly = upright();
        assembly.friction = 0.0;
        (assembly.support.lateral, assembly.support.axial) = (FIRM, FIRM);
        let Assembly { peg, hole, .. } = assembly;
        let rim = V2::new(hole.half_width + hole.radius, -hole.radius);
        let edge = V2::new(peg.half_width - peg.radius, peg.radius);
        let cores = |angle: f64| V2::new(-libm::cos(angle), libm::sin(angle));
        let tip = rim + cores(angle) * (assembly.radii() - PRESSED) - edge;
        let found: Measured<(f64, f64)> = (|| {
            let start = assembly.support.pose(tip, 0.0);
            let mut slab = Slab::new(engine, &assembly, start, rounding, 0.3);
            for _ in 0..build::steps(slab.world.as_ref(), 0.02) {
                slab.step(&V3::zeros())?;
            }
            let force = slab.world.contact(slab.hole[1], slab.peg).net;
            let apart = assembly.support.place(&slab.pose(), &edge) - rim;
            let angle = |x: f64, z: f64| libm::atan2(z, -x) / DEG;
            Ok((angle(apart.x, apart.y), angle(force.x, force.z)))
        })();
        let expected = found.map_or(f64::NAN, |(cores, _)| cores);
        let quantity = format!("normal at {} deg", angle / DEG);
        CheckRow::new("P10", quantity, expected, found.map(|(_, force)| force), "deg", ANGLE)
    };
    [10.0, 27.0, 45.0, 63.0, 80.0].map(|angle| row(angle * DEG)).to_vec()
}
