//! Forms 1 to 5, which hold for small displacements: the displacements are scaled down, and the
//! deviation, which is proportional to the scale, is removed by Richardson's extrapolation. At the
//! full errors of the base case it is 0.2 % for form 1, and 19 % for form 2, where the tilt beside
//! the coefficient of friction is neglected.

use crate::{DEG, MM, base, cases, close};
use analytic_checks::planar::{Assembly, Chamfer, Insertion, Mode, Support, V2, V3, holds};

/// Scale of small displacements.
const SCALE: f64 = 1e-4;

/// Returns the limit of a value at displacements of scale 0.
fn small<const N: usize>(value: impl Fn(f64) -> [f64; N]) -> [f64; N] {
    let (whole, half) = (value(SCALE), value(SCALE / 2.0));
    std::array::from_fn(|i| 2.0 * half[i] - whole[i])
}

/// Form 1: crossing a chamfer with a support that yields laterally and in tilt.
#[test]
fn form_1_chamfer_crossing() {
    let expected = |assembly: &Assembly, angle: f64| {
        let (mu, r) = (assembly.friction, assembly.peg.half_width);
        let Support { lateral, angular, centre, .. } = assembly.support;
        let (sin, cos) = libm::sincos(angle);
        let (a, b) = (cos + mu * sin, sin - mu * cos);
        let way = 0.5 * MM / libm::tan(angle);
        lateral * angular * a * way
            / ((lateral * centre * centre + angular) * b - lateral * centre * r * a)
    };
    let found = |assembly: &Assembly, angle: f64, scale: f64| {
        let mut assembly = *assembly;
        assembly.hole.chamfer = Some(Chamfer { width: 1.0 * MM, angle });
        let [r, hole] = [assembly.peg.half_width, assembly.hole.half_width];
        let depth = 0.5 * MM * libm::tan(angle);
        let tip = V2::new(hole + 0.5 * MM - r, -depth);
        let mut insertion = Insertion::new(assembly, tip, 0.0);
        insertion.advance(0.5 * MM * scale).unwrap();
        let corner = assembly.support.place(&insertion.state.pose, &V2::new(r, 0.0));
        let down = -depth - corner.y;
        [insertion.force() / down * 0.5 * MM]
    };
    close(expected(&base(), 60.0 * DEG), 0.446487, "the published number");
    for (i, assembly) in cases("form 1", false).enumerate() {
        let angle = if i == 0 { 60.0 } else { 60.0 + i as f64 / 2.0 } * DEG;
        let [force] = small(|scale| found(&assembly, angle, scale));
        close(force, expected(&assembly, angle), "force");
    }
}

/// Lateral error of the tip, m, tilt towards +x, rad, and clearance on one side, m.
const ERRORS: [f64; 3] = [1.0 * MM, 0.02, 0.05 * MM];

/// Puts the peg inside, upright and in the middle, then offsets the springs by the scaled errors.
fn inside(assembly: &Assembly, [lateral, tilt, slack]: [f64; 3], depth: f64) -> Insertion {
    let mut assembly = *assembly;
    assembly.hole.half_width = assembly.peg.half_width + slack;
    let mut insertion = Insertion::new(assembly, V2::new(0.0, -depth), 0.0);
    insertion.target = assembly.support.pose(V2::new(lateral, -depth), -tilt);
    // A step at which the peg slides down at its contact, whatever it turns.
    insertion.advance(lateral).unwrap();
    insertion
}

/// Normal force and tilt of form 2 at the base case's errors.
fn one_point(assembly: &Assembly, depth: f64) -> [f64; 2] {
    let [lateral, tilt, slack] = ERRORS;
    let Support { lateral: kx, angular: kt, centre, .. } = assembly.support;
    let overlap = lateral - slack + depth * tilt;
    let lever = centre - depth - assembly.friction * assembly.peg.half_width;
    let normal = overlap / (1.0 / kx + (centre - depth) * lever / kt);
    [normal, tilt + normal * lever / kt]
}

/// Form 2: the force of one-point contact; the tilt grows with it, for the rim pushes back below the
/// compliance centre.
#[test]
fn form_2_one_point_contact() {
    for (depth, published) in [(1.0, 0.336446), (3.0, 0.374479), (5.0, 0.414843)] {
        let [normal, _] = one_point(&base(), depth * MM);
        assert!((0.2 * normal - published).abs() < 1e-6, "{depth}");
    }
    let depths = [1.0, 3.0, 5.0];
    for (i, assembly) in cases("form 2", false).enumerate() {
        for depth in depths.map(|depth| depth * MM).into_iter().take(if i == 0 { 3 } else { 1 }) {
            // The force depends on their difference; in a wide hole one point stays alone.
            let errors = [ERRORS[0] + 9.0 * ERRORS[2], ERRORS[1], 10.0 * ERRORS[2]];
            let [force, tilt] = small(|scale| {
                let insertion = inside(&assembly, errors.map(|error| error * scale), depth);
                assert_eq!(insertion.state.contacts.len(), 1);
                [insertion.force() / scale, -insertion.state.pose.z / scale]
            });
            let [normal, expected_tilt] = one_point(&assembly, depth);
            close(force, assembly.friction * normal, "force");
            close(tilt, expected_tilt, "tilt");
        }
    }
}

/// Advances until a second contact closes, to within 0.1 nm.
fn onset(insertion: &mut Insertion) {
    let mut step = 0.1 * MM;
    while step > 1e-10 {
        let mut next = insertion.clone();
        next.advance(step).unwrap();
        match next.state.contacts.len() {
            2 => step /= 2.0,
            _ => *insertion = next,
        }
    }
}

/// Form 3: onset of two-point contact.
#[test]
fn form_3_onset_of_two_points() {
    for (i, assembly) in cases("form 3", false).enumerate() {
        let [found] = small(|scale| {
            let mut insertion = inside(&assembly, ERRORS.map(|error| error * scale), 1.0 * MM);
            onset(&mut insertion);
            [insertion.depth()]
        });
        let excess = |depth: f64| one_point(&assembly, depth)[1] * depth - 2.0 * ERRORS[2];
        let (mut low, mut high) = (0.0, 10.0 * MM);
        for _ in 0..60 {
            let middle = (low + high) / 2.0;
            if excess(middle) < 0.0 { low = middle } else { high = middle }
        }
        close(found, low, "depth");
        if i == 0 {
            close(found, 2.7683983 * MM, "base case");
        }
    }
}

/// Side force towards -x, moment about a height above the tip, clockwise, and force of insertion.
fn loads(insertion: &Insertion, height: f64) -> [f64; 3] {
    let load = insertion.load();
    let at = insertion.assembly.support.place(&insertion.state.pose, &V2::new(0.0, height));
    let arm = insertion.state.pose.xy() - at;
    [-load.x, -load.z - arm.perp(&load.xy()), -load.y]
}

/// Forms 4 and 5: force in two-point contact, and the jamming diagram, on whose line a peg slides.
/// With radii the contacts lie by both nearer along the axis, and the moment is that about the
/// lower one.
#[test]
fn forms_4_and_5_two_points() {
    for rounded in [false, true] {
        for assembly in cases("form 4", rounded) {
            let (mu, r) = (assembly.friction, assembly.peg.half_width);
            let depth = 6.0 * MM;
            let [side, moment, force] = small(|scale| {
                let mut insertion = inside(&assembly, ERRORS.map(|error| error * scale), depth);
                insertion.advance(1e-6 * scale).unwrap();
                assert_eq!(insertion.state.contacts.len(), 2);
                assert!(insertion.state.contacts.iter().all(|c| c.mode != Mode::Stick));
                loads(&insertion, assembly.peg.radius).map(|load| load / scale)
            });
            let apart = depth - assembly.radii();
            let expected = 2.0 * mu / apart * moment + mu * side * (1.0 + 2.0 * r * mu / apart);
            close(force, expected, "form 4");
            let lambda = apart / (2.0 * r * mu);
            let line = lambda - mu * (1.0 + lambda) * side / force;
            close(moment / (r * force), line, "form 5");
        }
    }
}

/// Form 5: beyond the line of the jamming diagram the contacts hold the load, before it they do not.
#[test]
fn form_5_jamming_threshold() {
    for (i, assembly) in cases("form 5", true).enumerate() {
        let (mu, r) = (assembly.friction, assembly.peg.half_width);
        let side = [0.0, 0.5, -0.5][i % 3];
        let (depth, height) = (6.0 * MM, assembly.peg.radius);
        let [found] = small(|scale| {
            let insertion = inside(&assembly, ERRORS.map(|error| error * scale), depth);
            let at = assembly.support.place(&insertion.state.pose, &V2::new(0.0, height));
            let arm = insertion.state.pose.xy() - at;
            let jams = |ratio: f64| {
                let force = V2::new(-side, -1.0);
                let moment = -ratio * r - arm.perp(&force);
                holds(&insertion, V3::new(force.x, force.y, moment))
            };
            let (mut low, mut high) = (0.0, 100.0);
            for _ in 0..60 {
                let middle = (low + high) / 2.0;
                if jams(middle) { high = middle } else { low = middle }
            }
            [low]
        });
        let lambda = (depth - assembly.radii()) / (2.0 * r * mu);
        close(found, lambda - mu * (1.0 + lambda) * side, "M/(r Fz)");
    }
}
