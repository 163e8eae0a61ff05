//! Friction of a contact patch against rotation about its normal, from the contact points of the patch.
//!
//! The contact points are the corners of the patch. Friction at the corners would resist a rotation with their lever
//! arms, which are longer than those inside the patch. So the friction of each point acts nearer to the centre of
//! pressure, such that the mean lever arm is that of a patch under uniform pressure; the normal force remains at the
//! point. Sliding without rotation is then still resisted at the centre of pressure (Mason 1986, Int. J. Robot. Res.
//! 5:53), and rotation by `mu N` times the mean lever arm.
//!
//! If the load is eccentric, the uniform pressure acts on the smaller rectangle that has its middle at the centre of
//! pressure (Meyerhof 1953, 3rd Int. Conf. Soil Mech.): half of its length is the distance from there to the nearer
//! edge.

use crate::scene::Pose;
use nalgebra::{Point3, Vector3};

/// Contact patch, which determines where the friction of its contact points acts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Patch {
    /// Centre of pressure in the frame in which the points were given, m.
    centre: Point3<f64>,
    /// Distance from the centre of pressure at which the friction of a point acts, divided by the distance of the
    /// point.
    share: f64,
}

impl Patch {
    /// Creates a patch of contact points with their loads; without any load, all points bear the same load. Points and
    /// normal are given in one frame.
    pub fn new(points: &[(Point3<f64>, f64)], normal: &Vector3<f64>) -> Self {
        let total: f64 = points.iter().map(|(_, load)| load).sum();
        let part = |load: f64| if total > 0.0 { load / total } else { 1.0 / points.len() as f64 };
        let mean = |of: &dyn Fn(&Point3<f64>) -> Vector3<f64>| {
            points.iter().map(|(point, load)| of(point) * part(*load)).sum::<Vector3<f64>>()
        };
        let centre = Point3::from(mean(&|point| point.coords));
        let distance = |point: &Point3<f64>| (point - centre).norm();
        let lever: f64 = points.iter().map(|(point, load)| distance(point) * part(*load)).sum();
        let [half, other] = pressed(points, &centre, normal);
        let share = if lever > 0.0 { mean_lever(half, other) / lever } else { 0.0 };
        Patch { centre, share }
    }

    /// Returns the vector, m, from a contact point to the point at which its friction acts, world axes; `frame` is the
    /// pose of the patch's frame in the world.
    pub fn offset(&self, frame: &Pose, point: &Point3<f64>, normal: &Vector3<f64>) -> Vector3<f64> {
        let inward = (frame * self.centre - point) * (1.0 - self.share);
        inward - normal * inward.dot(normal)
    }
}

/// Returns the half sides of the loaded rectangle about the centre of pressure, m. The points are corners of a
/// rectangle, so that the line from one to the nearest is an edge.
fn pressed(points: &[(Point3<f64>, f64)], centre: &Point3<f64>, normal: &Vector3<f64>) -> [f64; 2] {
    let offsets = points[1..].iter().map(|(point, _)| point - points[0].0);
    let nearest = offsets.min_by(|a, b| a.norm_squared().total_cmp(&b.norm_squared()));
    let Some(along) = nearest.and_then(|offset| offset.try_normalize(0.0)) else { return [0.0; 2] };
    [along, normal.cross(&along)].map(|axis| {
        let places = || points.iter().map(|(point, _)| (point - centre).dot(&axis));
        places().fold(0.0, f64::max).min(-places().fold(0.0, f64::min))
    })
}

/// Returns the mean lever arm, `sqrt(x^2 + y^2)`, over a rectangle with these half sides about its middle, m.
fn mean_lever(half: f64, other: f64) -> f64 {
    let (short, long) = if half < other { (half, other) } else { (other, half) };
    if short <= 0.0 {
        return long / 2.0;
    }
    let towards = |a: f64, b: f64| a * a / (6.0 * b) * libm::asinh(b / a);
    libm::hypot(short, long) / 3.0 + towards(short, long) + towards(long, short)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The integral by the midpoint rule.
    fn summed(half: f64, other: f64) -> f64 {
        let at = |i: usize, half: f64| half * ((2 * i + 1) as f64 / 800.0 - 1.0);
        let cells = (0..800).flat_map(|i| (0..800).map(move |j| (i, j)));
        cells.map(|(i, j)| libm::hypot(at(i, half), at(j, other))).sum::<f64>() / 640_000.0
    }

    #[test]
    fn the_mean_lever_is_the_integral_over_the_patch() {
        for (half, other, known) in [(6.0, 4.5, 4.042), (4.5, 6.0, 4.042), (3.5, 4.5, 3.075)] {
            let found = mean_lever(half, other);
            assert!((found - known).abs() < 1e-3, "{found}");
            assert!((found / summed(half, other) - 1.0).abs() < 1e-5, "{found}");
        }
        assert_eq!(mean_lever(0.0, 3.0), 1.5);
        assert!((mean_lever(1e-9, 3.0) - 1.5).abs() < 1e-6);
        assert_eq!(mean_lever(0.0, 0.0), 0.0);
    }

    #[test]
    fn friction_acts_at_the_patchs_lever_about_the_centre_of_pressure() {
        let corners = [(6.0, 4.5), (-6.0, 4.5), (-6.0, -4.5), (6.0, -4.5)];
        let loaded = |loads: [f64; 4]| {
            let place = |(x, y)| Point3::new(x, y, 2.0);
            corners.into_iter().map(place).zip(loads).collect::<Vec<_>>()
        };
        // Evenly; 1.5 mm beside the middle, which presses 6 of 9 mm; on an edge; on a corner.
        for (loads, (x, y), [half, other]) in [
            ([3.0; 4], (0.0, 0.0), [6.0, 4.5]),
            ([4.0, 4.0, 2.0, 2.0], (0.0, 1.5), [6.0, 3.0]),
            ([6.0, 6.0, 0.0, 0.0], (0.0, 4.5), [6.0, 0.0]),
            ([12.0, 0.0, 0.0, 0.0], (6.0, 4.5), [0.0, 0.0]),
        ] {
            let points = loaded(loads);
            let patch = Patch::new(&points, &Vector3::z());
            assert!((patch.centre - Point3::new(x, y, 2.0)).norm() < 1e-12);
            let lever = |(point, load): &(Point3<f64>, f64)| {
                let offset = patch.offset(&Pose::identity(), point, &Vector3::z());
                (point + offset - patch.centre).norm() * load
            };
            let lever = points.iter().map(lever).sum::<f64>() / 12.0;
            assert!((lever - mean_lever(half, other)).abs() < 1e-12, "{loads:?}: {lever}");
        }
        let [even, unloaded] =
            [3.0, 0.0].map(|load| Patch::new(&loaded([load; 4]), &Vector3::z()).share);
        assert!((unloaded - even).abs() < 1e-12);
    }
}
