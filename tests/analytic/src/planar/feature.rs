//! Features of contact: pairs of a corner and an edge, or of two corners, of peg and hole.

use super::outline::{Edge, Outline};
use super::{Assembly, V2, V3};

/// Pair of core features that may touch; `side` is 0 for the left body of the hole, 1 for the right.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Feature {
    /// Corner of the peg on an edge of the hole.
    PegCorner {
        /// Body of the hole.
        side: usize,
        /// Corner of the peg.
        corner: usize,
        /// Edge of the hole.
        edge: usize,
    },
    /// Corner of the hole on an edge of the peg.
    HoleCorner {
        /// Body of the hole.
        side: usize,
        /// Corner of the hole.
        corner: usize,
        /// Edge of the peg.
        edge: usize,
    },
    /// Corner of the peg on a corner of the hole.
    Corners {
        /// Body of the hole.
        side: usize,
        /// Corner of the peg.
        peg: usize,
        /// Corner of the hole.
        hole: usize,
    },
}

/// Geometry of a feature at a pose of the peg.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Touch {
    /// Distance of the surfaces, m; negative if they overlap.
    pub gap: f64,
    /// Unit normal from the hole to the peg.
    pub normal: V2,
    /// Nearest point on the surface of the peg, m.
    pub point: V2,
    /// Distance along the outlines to where another feature takes over, m; negative beyond it.
    pub reach: f64,
}

impl Feature {
    /// Returns the body of the hole.
    pub fn side(&self) -> usize {
        match *self {
            Feature::PegCorner { side, .. }
            | Feature::HoleCorner { side, .. }
            | Feature::Corners { side, .. } => side,
        }
    }
}

/// Outlines of peg and hole.
#[derive(Debug, Clone, PartialEq)]
pub struct Geometry {
    assembly: Assembly,
    peg: Outline,
    hole: [Outline; 2],
    /// All features.
    pub features: Vec<Feature>,
}

impl Geometry {
    /// Lists the features of an assembly. Two corners without a radius touch at no definite normal:
    /// they meet at the ends of their edges only.
    pub fn new(assembly: &Assembly) -> Self {
        let (peg, hole) = (assembly.peg.outline(), assembly.hole.outlines());
        let mut features = Vec::new();
        for (side, body) in hole.iter().enumerate() {
            for corner in peg.corners() {
                let on = |edge| Feature::PegCorner { side, corner, edge };
                features.extend((0..body.edges()).map(on));
            }
            for corner in body.corners() {
                let on = |edge| Feature::HoleCorner { side, corner, edge };
                features.extend((0..peg.edges()).map(on));
                if assembly.radii() > 0.0 {
                    let with = |peg| Feature::Corners { side, peg, hole: corner };
                    features.extend(peg.corners().map(with));
                }
            }
        }
        Geometry { assembly: *assembly, peg, hole, features }
    }

    /// Returns the outline of the peg at a pose.
    fn placed(&self, pose: &V3) -> Outline {
        self.peg.moved(|point| self.assembly.support.place(pose, point))
    }

    /// Returns the geometry of a feature at a pose.
    pub fn touch(&self, feature: Feature, pose: &V3) -> Touch {
        self.touch_of(feature, &self.placed(pose))
    }

    /// Returns the geometry of all features at a pose.
    pub fn touches(&self, pose: &V3) -> Vec<(Feature, Touch)> {
        let peg = self.placed(pose);
        self.features.iter().map(|&feature| (feature, self.touch_of(feature, &peg))).collect()
    }

    fn touch_of(&self, feature: Feature, peg: &Outline) -> Touch {
        let radii = self.assembly.radii();
        match feature {
            Feature::PegCorner { side, corner, edge } => {
                let (edge, at) = (self.hole[side].edge(edge), peg.points[corner]);
                let normal = edge.outward();
                let gap = (at - edge.from).dot(&normal) - radii;
                let point = at - normal * peg.radius;
                let reach = within(&edge, &at).min(LEVER * beyond(peg, corner, &-normal));
                Touch { gap, normal, point, reach }
            }
            Feature::HoleCorner { side, corner, edge } => {
                let (edge, at) = (peg.edge(edge), self.hole[side].points[corner]);
                let normal = -edge.outward();
                let gap = -(at - edge.from).dot(&normal) - radii;
                // On the peg's surface: the gap beyond the hole's.
                let body = &self.hole[side];
                let point = at + normal * (body.radius + gap);
                let reach = within(&edge, &at).min(LEVER * beyond(body, corner, &normal));
                Touch { gap, normal, point, reach }
            }
            Feature::Corners { side, peg: i, hole: j } => {
                let body = &self.hole[side];
                let apart = peg.points[i] - body.points[j];
                let distance = apart.norm();
                let normal = apart / distance;
                let reach = beyond(body, j, &apart).min(beyond(peg, i, &-apart));
                let point = peg.points[i] - normal * peg.radius;
                Touch { gap: distance - radii, normal, point, reach }
            }
        }
    }

    /// Returns the distance of the peg from the nearer body of the hole, m, negative if they
    /// overlap: the largest, over the directions, of the distance between their extreme points.
    pub fn separation(&self, pose: &V3) -> f64 {
        let peg = self.placed(pose);
        let of = |body: &Outline| {
            let own = (0..body.edges()).map(|i| body.edge(i).outward());
            let others = (0..peg.edges()).map(|i| -peg.edge(i).outward());
            let pairs = body.corners().flat_map(|j| peg.corners().map(move |i| (i, j)));
            let between = pairs.filter_map(|(i, j)| {
                (peg.points[i] - body.points[j]).try_normalize(f64::MIN_POSITIVE)
            });
            let normals = own.chain(others).chain(between);
            let widest = normals.filter(|normal| bounds(body, normal));
            widest.map(|normal| clearance(&peg, body, &normal)).fold(f64::NEG_INFINITY, f64::max)
        };
        self.hole.iter().map(of).fold(f64::INFINITY, f64::min) - self.assembly.radii()
    }
}

/// Length, m, by which an angle is taken for a distance along the outlines: a corner touches an edge
/// only at a normal between those of its own edges.
const LEVER: f64 = 10e-3;

/// Returns how far inside an edge a point's projection lies, m; negative outside.
fn within(edge: &Edge, point: &V2) -> f64 {
    let along = (point - edge.from).dot(&edge.along);
    along.min(edge.length - along)
}

/// Returns how far a vector from a corner points beyond both of its edges, in its unit.
fn beyond(outline: &Outline, corner: usize, vector: &V2) -> f64 {
    let (before, after) = (outline.edge(corner - 1), outline.edge(corner));
    vector.dot(&before.along).min(-vector.dot(&after.along))
}

/// Returns whether a body, which extends beyond the ends of its outline, is bounded in a direction.
fn bounds(body: &Outline, normal: &V2) -> bool {
    const ROUNDING: f64 = 1e-12;
    let (first, last) = (body.edge(0), body.edge(body.edges() - 1));
    normal.dot(&first.along) > -ROUNDING && normal.dot(&last.along) < ROUNDING
}

/// Returns the distance along a normal between the extreme points of peg and body, m.
fn clearance(peg: &Outline, body: &Outline, normal: &V2) -> f64 {
    let along = |points: &[V2], towards: f64| {
        points.iter().map(|point| towards * point.dot(normal)).fold(f64::NEG_INFINITY, f64::max)
    };
    -along(&peg.points, -1.0) - along(&body.points, 1.0)
}
