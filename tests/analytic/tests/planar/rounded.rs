//! Forms 6 to 10, which are exact.

use crate::{ALLOWED, DEG, MM, cases, close};
use analytic_checks::planar::{
    Assembly, Feature, Geometry, Insertion, Outcome, TWO_POINT, Trial, V2, cone_margin,
    two_point_pose,
};
use analytic_checks::slab::slim;
use ask_tell::stream::stream;
use rand::RngExt;

/// Depth of the tip in two-point contact at a tilt, by form 6.
fn two_point_depth(assembly: &Assembly, tilt: f64) -> f64 {
    let Assembly { peg, hole, .. } = assembly;
    let (r, rho, wide, rim) = (peg.half_width, peg.radius, hole.half_width, hole.radius);
    let (sin, cos) = libm::sincos(tilt);
    let across = 2.0 * wide + rim - rho - (r - rho) * cos + rho * sin;
    rim + (across * cos - r - rim) / sin
}

/// Form 6: exact depth of two-point contact with radii.
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
