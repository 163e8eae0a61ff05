//! The planar referee on closed forms: forces and depths within 1e-6.
//!
//! Forms 1 to 5 hold for small displacements. There the displacements are scaled down, and the
//! deviation, which is proportional to the scale, is removed by Richardson's extrapolation.

use analytic_checks::planar::{
    Assembly, Chamfer, Feature, Geometry, Hole, Insertion, Mode, Outcome, Peg, Record, Support,
    TWO_POINT, Trial, V2, V3, cone_margin, holds, sample::draw, two_point_pose,
};
use ask_tell::stream::stream;
use rand::{Rng, RngExt};

const MM: f64 = 1e-3;
const DEG: f64 = std::f64::consts::PI / 180.0;
/// Largest error, as a share.
const ALLOWED: f64 = 1e-6;
/// Number of random cases of a form.
const CASES: u64 = 20;

fn close(found: f64, expected: f64, what: &str) {
    let error = (found / expected - 1.0).abs();
    assert!(error < ALLOWED, "{what}: found {found}, expected {expected}, error {error:.1e}");
}

/// Lateral 2.6 N/mm, angular 2000 N mm/rad about a centre 21 mm above the tip of a peg 8 mm wide.
fn base() -> Assembly {
    Assembly {
        peg: Peg { half_width: 4.0 * MM, radius: 0.0 },
        hole: Hole { half_width: 4.05 * MM, radius: 0.0, chamfer: None },
        friction: 0.2,
        support: Support { lateral: 2600.0, axial: 4e4, angular: 2.0, centre: 21.0 * MM },
        compliance: 0.0,
    }
}

/// Varies friction, clearance and the radii of a case.
fn varied(random: &mut impl Rng, rounded: bool) -> Assembly {
    let mut assembly = base();
    assembly.friction = random.random_range(0.05..0.4);
    let slack = random.random_range(0.02..0.5) * MM;
    assembly.hole.half_width = assembly.peg.half_width + slack / 2.0;
    if rounded {
        assembly.peg.radius = random.random_range(0.05..0.6) * MM;
        assembly.hole.radius = random.random_range(0.05..0.6) * MM;
    }
    assembly
}

/// Base case, then random ones.
fn cases(form: &str, rounded: bool) -> impl Iterator<Item = Assembly> {
    let varied = move |i| varied(&mut stream(40, i, form), rounded);
    std::iter::once(base()).chain((0..CASES).map(varied).collect::<Vec<_>>())
}

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

/// Depth of the tip in two-point contact at a tilt, by form 6.
fn two_point_depth(assembly: &Assembly, tilt: f64) -> f64 {
    let Assembly { peg, hole, .. } = assembly;
    let (r, rho, wide, rim) = (peg.half_width, peg.radius, hole.half_width, hole.radius);
    let (sin, cos) = libm::sincos(tilt);
    let across = 2.0 * wide + rim - rho - (r - rho) * cos + rho * sin;
    rim + (across * cos - r - rim) / sin
}

/// The peg of forms 6 and 7, 7 mm wide in 7.1 mm.
fn slim(rho: f64, rim: f64, friction: f64) -> Assembly {
    Assembly {
        peg: Peg { half_width: 3.5 * MM, radius: rho * MM },
        hole: Hole { half_width: 3.55 * MM, radius: rim * MM, chamfer: None },
        friction,
        ..base()
    }
}

/// Form 6: exact depth of two-point contact with radii, also where a step finds it.
#[test]
fn form_6_two_points_rounded() {
    let check = |assembly: &Assembly, tilt: f64| {
        let pose = two_point_pose(assembly, -tilt);
        let depth = -assembly.support.tip(&pose).y;
        close(depth, two_point_depth(assembly, tilt), "depth");
        assert!(Geometry::new(assembly).separation(&pose).abs() < 1e-12);
        depth / MM
    };
    let rounded = slim(0.3, 0.2, 0.2);
    for (tilt, published) in [(0.01, 10.497), (0.02, 5.494), (0.05, 2.485)] {
        assert!((check(&rounded, tilt) - published).abs() < 1e-3);
    }
    for assembly in cases("form 6", true) {
        check(&assembly, 0.6 * (1.0 - assembly.peg.half_width / assembly.hole.half_width).sqrt());
    }
}

/// Greatest depth at which an unloaded peg stays wedged, and the tilt there.
fn wedging_limit(assembly: &Assembly) -> [f64; 2] {
    let margin = |tilt: f64| {
        let pose = two_point_pose(assembly, -tilt);
        let geometry = Geometry::new(assembly);
        let [first, second] = TWO_POINT.map(|feature| geometry.touch(feature, &pose));
        cone_margin(&first, &second, assembly.friction)
    };
    // Deeper contacts lie on a steeper line; at a large tilt the flank is steep, too.
    let (mut low, mut high) = (1e-4, 0.1);
    for _ in 0..60 {
        let middle = (low + high) / 2.0;
        if margin(middle) < 0.0 { low = middle } else { high = middle }
    }
    [-assembly.support.tip(&two_point_pose(assembly, -low)).y, low]
}

/// Form 7: greatest depth of wedging, at which the line between the contacts, at an angle beta to the
/// plane of the mouth, leaves the cone of the tilted flank: beta + tilt = phi.
#[test]
fn form_7_wedging() {
    for (rho, rim, friction, published) in [
        (0.0, 0.0, 0.2, 1.068),
        (0.3, 0.0, 0.2, 1.331),
        (0.3, 0.3, 0.2, 1.594),
        (0.0, 0.0, 0.3, 1.915),
        (0.3, 0.0, 0.3, 2.198),
        (0.3, 0.3, 0.3, 2.481),
    ] {
        let assembly = slim(rho, rim, friction);
        let [found, tilt] = wedging_limit(&assembly);
        assert!((found / MM - published).abs() < 1e-3, "{found} {published}");
        let (sin, cos) = libm::sincos(tilt);
        // From the wall's contact to the rim's, across and along.
        let across = 2.0 * 3.55 * MM + assembly.hole.radius * (1.0 - cos);
        let left = (3.5 * MM - assembly.peg.radius) * sin + assembly.peg.radius * cos;
        let along = found - assembly.hole.radius * (1.0 - sin) - left;
        let beta = libm::atan2(along, across);
        close(beta + tilt, libm::atan(friction), "angle");
    }
}

/// Support that hardly turns.
fn upright(mut assembly: Assembly) -> Assembly {
    assembly.support.angular = 1e9;
    assembly
}

/// Form 8: force of crossing a rounded rim against a lateral spring.
#[test]
fn form_8_crossing_a_rounded_rim() {
    for (i, case) in cases("form 8", true).enumerate() {
        let mut assembly = upright(case);
        let mut share = stream(40, i as u64, "form 8, offset").random_range(0.1..0.95);
        if i == 0 {
            (assembly.peg.radius, assembly.hole.radius, share) = (0.3 * MM, 0.2 * MM, 0.0);
        }
        let (radii, phi) = (assembly.radii(), libm::atan(assembly.friction));
        let capture = radii * (1.0 - libm::sin(phi));
        let error = if i == 0 { 0.3 * MM } else { share * capture };
        let slack = assembly.hole.half_width - assembly.peg.half_width;
        let mut insertion = Insertion::above(assembly, slack + error, 0.0);
        let stiffness = assembly.support.lateral;
        let expected =
            |p: f64| stiffness * (radii * (libm::cos(p) - 1.0) + error) * libm::tan(p + phi);
        let (mut peak, step) = ([0.0, 0.0], if i == 0 { 0.2e-6 } else { 5e-6 });
        while insertion.depth() < 1.5 * MM {
            insertion.advance(step).unwrap();
            let Some(contact) = insertion.state.contacts.first() else { continue };
            let normal = insertion.geometry.touch(contact.feature, &insertion.state.pose).normal;
            let angle = libm::atan2(normal.y, -normal.x);
            close(insertion.force(), expected(angle), "force");
            if insertion.force() > peak[0] {
                peak = [insertion.force(), angle];
            }
        }
        close(insertion.force(), stiffness * error * assembly.friction, "end");
        if i == 0 {
            close(peak[0] / stiffness / MM, 0.230710, "peak");
            assert!((peak[1] / DEG - 43.585).abs() < 0.1);
        }
    }
}

/// Form 9: greatest lateral error at which a rounded rim captures the peg.
#[test]
fn form_9_capture_limit() {
    for case in cases("form 9", true).skip(1) {
        let assembly = upright(case);
        let slack = assembly.hole.half_width - assembly.peg.half_width;
        let outcome = |error: f64| {
            let lateral = slack + error;
            let trial = Trial { assembly, lateral, tilt: 0.0, depth: 2.0 * MM, limit: 20.0 };
            trial.run(0.05 * MM).unwrap().outcome
        };
        let limit = assembly.radii() * (1.0 - libm::sin(libm::atan(assembly.friction)));
        assert_eq!(outcome(limit * (1.0 - ALLOWED)), Outcome::Inserted, "{assembly:?}");
        assert_eq!(outcome(limit * (1.0 + ALLOWED)), Outcome::Missed, "{assembly:?}");
    }
}

/// Form 10: the normal of a rounded contact is the line between the cores.
#[test]
fn form_10_normal_of_a_rounded_contact() {
    for (i, assembly) in cases("form 10", true).skip(1).enumerate() {
        let geometry = Geometry::new(&assembly);
        let mut random = stream(40, i as u64, "form 10, angle");
        let (gap, tilt) = (random.random_range(-0.01..0.05) * MM, random.random_range(-0.1..0.1));
        for angle in [10.0, 20.0, 45.0, 70.0, 80.0].map(|angle| angle * DEG) {
            // From the core of the right rim to that of the tip's right edge.
            let normal = V2::new(-libm::cos(angle), libm::sin(angle));
            let rim =
                V2::new(assembly.hole.half_width, 0.0) + V2::new(1.0, -1.0) * assembly.hole.radius;
            let edge = V2::new(assembly.peg.half_width - assembly.peg.radius, assembly.peg.radius);
            let (sin, cos) = libm::sincos(tilt);
            let turned = V2::new(cos * edge.x - sin * edge.y, sin * edge.x + cos * edge.y);
            let tip = rim + normal * (assembly.radii() + gap) - turned;
            let pose = assembly.support.pose(tip, tilt);
            let touch = geometry.touch(Feature::Corners { side: 1, peg: 2, hole: 1 }, &pose);
            assert!((touch.normal - normal).norm() < 1e-9 && (touch.gap - gap).abs() < 1e-12);
            assert!(touch.reach > 0.0);
            let hole = rim + normal * assembly.hole.radius;
            assert!((touch.point - hole - normal * gap).norm() < 1e-12);
        }
    }
}

/// Number of random insertions.
const INSERTIONS: u64 = 200;

/// The rule for indeterminate cases leaves most of the sample, and all three outcomes are in it.
#[test]
fn sample_has_all_outcomes_and_few_indeterminate_cases() {
    let records: Vec<_> = (0..INSERTIONS).step_by(2).map(|i| draw(i).run(20e-6).unwrap()).collect();
    let indeterminate = records.iter().filter(|record| record.indeterminate()).count();
    assert!(indeterminate * 100 <= 15 * records.len(), "{indeterminate}");
    for outcome in [Outcome::Inserted, Outcome::Missed, Outcome::Jammed] {
        let count = records.iter().filter(|record| record.outcome == outcome).count();
        assert!(count >= 10, "{outcome:?}: {count}");
    }
}

/// Half the step of the drive changes no outcome, and the force at the end hardly.
#[test]
fn half_the_step_changes_no_outcome() {
    for trial in (0..INSERTIONS).step_by(8).map(draw) {
        let [whole, half] = [20e-6, 10e-6].map(|step| trial.run(step).unwrap());
        assert_eq!(whole.outcome, half.outcome, "{trial:?}");
        assert_eq!(whole.indeterminate(), half.indeterminate(), "{trial:?}");
        let end = |record: &Record| record.forces.last().unwrap()[1];
        if whole.outcome == Outcome::Inserted {
            assert!((end(&whole) - end(&half)).abs() < 0.1, "{trial:?}");
        }
    }
}
