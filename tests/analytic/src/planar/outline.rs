//! Outlines of peg and hole: open convex chains of core corners, and the radius about them.

use super::V2;

/// Length of the peg and of the hole's faces, m: longer than any way of insertion.
const LONG: f64 = 0.2;

/// Peg of two parallel flanks and a flat tip, with rounded tip edges.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Peg {
    /// Half of the width, m.
    pub half_width: f64,
    /// Radius of the tip edges, m.
    pub radius: f64,
}

/// Hole of two parallel walls in a flat mouth, with rounded rims or chamfers.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Hole {
    /// Half of the width, m.
    pub half_width: f64,
    /// Radius of the rims, m; with a chamfer that of its two edges.
    pub radius: f64,
    /// Chamfer of the core's rims.
    pub chamfer: Option<Chamfer>,
}

/// Flat in place of a rim.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Chamfer {
    /// Width across the hole, m.
    pub width: f64,
    /// Angle to the plane of the mouth, rad.
    pub angle: f64,
}

/// Open convex chain of points with the body on its left. The ends lie far away, so only the inner
/// points are corners.
#[derive(Debug, Clone, PartialEq)]
pub struct Outline {
    /// Points of the core, m.
    pub points: Vec<V2>,
    /// Radius about the core, m.
    pub radius: f64,
}

/// Edge of an outline.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// First point, m.
    pub from: V2,
    /// Unit vector to the second point.
    pub along: V2,
    /// Distance of the points, m.
    pub length: f64,
}

impl Edge {
    /// Returns the unit normal that points out of the body.
    pub fn outward(&self) -> V2 {
        V2::new(self.along.y, -self.along.x)
    }
}

impl Outline {
    /// Returns the number of edges.
    pub fn edges(&self) -> usize {
        self.points.len() - 1
    }

    /// Returns the indices of the corners.
    pub fn corners(&self) -> std::ops::Range<usize> {
        1..self.points.len() - 1
    }

    /// Returns an edge; edge `i` ends at point `i + 1`.
    pub fn edge(&self, i: usize) -> Edge {
        let (from, to) = (self.points[i], self.points[i + 1]);
        let length = (to - from).norm();
        Edge { from, along: (to - from) / length, length }
    }

    /// Returns the outline with its points moved.
    pub fn moved(&self, place: impl Fn(&V2) -> V2) -> Outline {
        Outline { points: self.points.iter().map(place).collect(), radius: self.radius }
    }
}

impl Peg {
    /// Returns the outline with the middle of the tip at the origin and the peg along +z.
    pub fn outline(&self) -> Outline {
        let (half, bottom) = (self.half_width - self.radius, self.radius);
        let points = [[-half, LONG], [-half, bottom], [half, bottom], [half, LONG]];
        Outline { points: points.map(V2::from).to_vec(), radius: self.radius }
    }
}

impl Hole {
    /// Returns the outlines of the bodies on the left and on the right of the hole.
    pub fn outlines(&self) -> [Outline; 2] {
        let (wall, mouth) = (self.half_width + self.radius, -self.radius);
        let mut right = vec![V2::new(LONG, mouth)];
        match self.chamfer {
            Some(Chamfer { width, angle }) => {
                let low = mouth - width * libm::tan(angle);
                right.extend([V2::new(wall + width, mouth), V2::new(wall, low)]);
            }
            None => right.push(V2::new(wall, mouth)),
        }
        right.push(V2::new(wall, -LONG));
        let left = right.iter().rev().map(|point| V2::new(-point.x, point.y)).collect();
        [left, right].map(|points| Outline { points, radius: self.radius })
    }
}
