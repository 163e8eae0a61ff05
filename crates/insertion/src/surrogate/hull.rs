//! Convex hull of the measured designs, and distance to it.

use crate::stiffness::Infill;
use crate::task::geometry::convex_outline;
use ask_tell::statistics::span;
use finray::polygon::edges;
use nalgebra::Point2;

/// Convex hull in coordinates scaled by the measured spans.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Hull {
    /// Smallest density and direction.
    origin: Infill,
    /// Largest minus smallest density and direction; 1 if equal.
    span: Infill,
    /// Corners, counter-clockwise; two for a segment, one for a point.
    corners: Vec<Point2<f64>>,
}

/// Distance, in units of the spans, below which a point counts as on the hull.
const TOLERANCE: f64 = 1e-9;

impl Hull {
    pub fn new(points: &[Infill]) -> Self {
        let ranges = [0, 1].map(|axis| span(points.iter().map(|p| p[axis])));
        let origin = ranges.map(|[low, _]| low);
        let span = ranges.map(|[low, high]| if high > low { high - low } else { 1.0 });
        let mut hull = Hull { origin, span, corners: Vec::new() };
        hull.corners = convex_outline(points.iter().map(|&p| hull.scale(p)).collect());
        hull
    }

    /// Returns the distance in units of the spans; 0 inside and on the edge.
    pub fn distance(&self, point: Infill) -> f64 {
        let p = self.scale(point);
        let edges = || edges(&self.corners);
        let inside = self.corners.len() > 2 && edges().all(|(a, b)| (b - a).perp(&(p - a)) >= 0.0);
        let distance = edges().map(|(a, b)| to_segment(a, b, p)).fold(f64::INFINITY, f64::min);
        if inside || distance < TOLERANCE { 0.0 } else { distance }
    }

    fn scale(&self, p: Infill) -> Point2<f64> {
        Point2::from([0, 1].map(|axis| (p[axis] - self.origin[axis]) / self.span[axis]))
    }
}

/// Returns the distance of `p` from the segment between `a` and `b`.
fn to_segment(a: Point2<f64>, b: Point2<f64>, p: Point2<f64>) -> f64 {
    let (along, from_a) = (b - a, p - a);
    let squared = along.norm_squared();
    let share = if squared == 0.0 { 0.0 } else { from_a.dot(&along) / squared };
    let off = from_a - along * share.clamp(0.0, 1.0);
    libm::hypot(off.x, off.y)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_in_units_of_the_spans() {
        let hull = Hull::new(&[[10.0, 0.0], [30.0, 0.0], [30.0, 40.0], [10.0, 40.0], [20.0, 20.0]]);
        assert_eq!(hull.corners.len(), 4);
        assert_eq!(hull.distance([20.0, 10.0]), 0.0);
        assert_eq!(hull.distance([10.0, 17.0]), 0.0);
        assert_eq!(hull.distance([20.0, 60.0]), 0.5);
        assert!((hull.distance([50.0, 80.0]) - 2f64.sqrt()).abs() < 1e-12);
    }

    #[test]
    fn designs_on_a_line_or_at_a_point_still_have_a_distance() {
        let line = Hull::new(&[[10.0, 0.0], [20.0, 0.0], [30.0, 0.0]]);
        assert_eq!(line.distance([15.0, 0.0]), 0.0);
        assert_eq!(line.distance([20.0, 2.0]), 2.0);
        assert_eq!(Hull::new(&[[10.0, 0.0]]).distance([10.0, 3.0]), 3.0);
    }
}
