//! Round hole: a ring of flat-sided prisms.

use insertion::task::{Part, Solid};
use std::f64::consts::PI;

/// Largest error of the hole's diameter, as a share of the clearance, as far as the flats allow.
const OFF: f64 = 0.05;
/// Fewest and most flats, multiples of four, so that one faces each of -x, +x, -y and +y.
const FLATS: [u32; 2] = [16, 96];

#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hole {
    pub flats: u32,
    /// Distance of each flat from the axis, m.
    pub flat: f64,
    /// Largest distance of the wall from the circle, m.
    pub off: f64,
}

impl Hole {
    /// Hole for a plug of a diameter with a clearance, m.
    pub fn new(diameter: f64, clearance: f64) -> Self {
        let radius = (diameter + clearance) / 2.0;
        // With the flat at r - off and its corners at (r - off) / cos(pi / n) = r + off.
        let off = |flats: u32| radius * libm::tan(PI / 2.0 / f64::from(flats)).powi(2);
        let [fewest, most] = FLATS;
        let enough = |flats: &u32| 2.0 * off(*flats) <= OFF * clearance;
        let flats = (fewest..most).step_by(4).find(enough).unwrap_or(most);
        Hole { flats, flat: radius - off(flats), off: off(flats) }
    }

    /// Prisms between the hole and a rectangle of half sides `outer` in x and y, m.
    pub fn walls(&self, outer: [f64; 2], z: [f64; 2]) -> Vec<Part> {
        let corner = |k: u32| {
            let turn = (f64::from(k) - 0.5) * 2.0 * PI / f64::from(self.flats);
            let (x, y) = (libm::cos(turn), libm::sin(turn));
            let inner = self.flat / libm::cos(PI / f64::from(self.flats));
            let far = (outer[0] / x.abs()).min(outer[1] / y.abs());
            [inner, far].map(|from| [from * x, from * y])
        };
        let wall = |k: u32| {
            let ([a, b], [d, c]) = (corner(k), corner(k + 1));
            let solid = Solid::Prism { axis: 2, outline: vec![a, b, c, d], span: z };
            Part { name: format!("wall {}", k + 1), solid, friction: None }
        };
        (0..self.flats).map(wall).collect()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::units::MM;
    use insertion::task::geometry;

    /// The flats' ring has the volume of its rectangle less the circle, and keeps the clearance
    /// within a twentieth where the flats suffice.
    #[test]
    fn a_hole_is_its_circle_within_the_error_that_it_states() {
        for (diameter_mm, clearance_mm) in [(3.0, 0.1), (8.0, 0.1), (20.0, 0.2), (100.0, 0.02)] {
            let (diameter, clearance) = (diameter_mm * MM, clearance_mm * MM);
            let hole = Hole::new(diameter, clearance);
            let radius = (diameter + clearance) / 2.0;
            let corner = hole.flat / (PI / f64::from(hole.flats)).cos();
            assert!((radius - hole.flat - hole.off).abs() < 1e-12);
            assert!((corner - radius - hole.off).abs() < 1e-12);
            assert!(hole.flats == FLATS[1] || 2.0 * hole.off <= OFF * clearance);
            let half = diameter;
            let walls = hole.walls([half; 2], [-5.0 * MM, 0.0]);
            let volume: f64 = walls.iter().map(|part| geometry::volume(&part.solid)).sum();
            let expected = 5.0 * MM * (4.0 * half * half - PI * radius * radius);
            // Its corners are cut where no flat's end meets them.
            assert!((volume / expected - 1.0).abs() < 0.02, "{volume} {expected}");
        }
    }
}
