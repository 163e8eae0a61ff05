//! Exact convex parts, and the mass properties of a body made of them.

use super::rounded::Rounded;
use contact::scene::{Geom, Inertia, Pose, Shape};
use contact::shapes;
use input::units::MM;
use nalgebra::{Matrix3, Point2, Point3, Translation3, Vector3};

/// Coordinate axis in a file; the discriminant is the index of the coordinate.
#[derive(serde::Deserialize, Clone, Copy)]
#[serde(rename_all = "kebab-case")]
pub(crate) enum Axis {
    X,
    Y,
    Z,
}

/// A convex part of a plug or socket.
#[derive(Debug, Clone, PartialEq)]
pub struct Part {
    /// Name for pictures and errors.
    pub name: String,
    /// Shape in metres.
    pub solid: Solid,
    /// Coefficient of friction of this part, if it differs from that of the task.
    pub friction: Option<f64>,
}

/// Solid of a task file, lengths in m.
#[derive(Debug, Clone, PartialEq)]
pub enum Solid {
    /// A box along the axes.
    Box {
        /// Smallest x, y and z.
        min: Vector3<f64>,
        /// Largest x, y and z.
        max: Vector3<f64>,
    },
    /// A cylinder along z.
    Cylinder {
        /// Axis position (x, y).
        centre: [f64; 2],
        /// Radius of the cylinder.
        radius: f64,
        /// Bottom and top in z.
        z: [f64; 2],
    },
    /// A convex outline in two axes, extruded along the third.
    Prism {
        /// Index of the axis of extrusion (0 x, 1 y, 2 z).
        axis: usize,
        /// Corners in the other two axes, in the order x, y, z.
        outline: Vec<[f64; 2]>,
        /// Start and end along the axis of extrusion.
        span: [f64; 2],
    },
    /// The convex hull of some points.
    Hull {
        /// Corners of the hull.
        points: Vec<Point3<f64>>,
    },
    /// A box with round edges.
    Rounded(Rounded),
}

/// Volume, m3; centroid, m; second moments about it per unit of density (integral of x xT), m5.
pub type Moments = (f64, Vector3<f64>, Matrix3<f64>);

impl Part {
    /// Returns the part as one geom, on a body with the frame of the part; round edges become a hull within 1 um.
    pub fn geom(&self) -> Geom {
        self.placed(self.solid.shape())
    }

    /// Returns the exact geoms for contacts, in the frame of [`Part::geom`].
    pub fn geoms(&self) -> Vec<Geom> {
        let Solid::Rounded(rounded) = &self.solid else { return vec![self.geom()] };
        rounded.pieces().map(|piece| self.placed(piece)).collect()
    }

    fn placed(&self, (shape, origin): (Shape, Vector3<f64>)) -> Geom {
        let pose = Pose::from_parts(Translation3::from(origin), nalgebra::one());
        Geom { name: self.name.clone(), shape, pose, friction: self.friction }
    }
}

impl Solid {
    /// Returns the solid as a centred shape, and the position of its centre.
    pub fn shape(&self) -> (Shape, Vector3<f64>) {
        match self {
            Solid::Box { min, max } => (Shape::Box { half: (max - min) / 2.0 }, (max + min) / 2.0),
            Solid::Cylinder { centre, radius, z } => (
                Shape::Cylinder { half_height: (z[1] - z[0]) / 2.0, radius: *radius },
                Vector3::new(centre[0], centre[1], (z[0] + z[1]) / 2.0),
            ),
            Solid::Prism { .. } | Solid::Hull { .. } | Solid::Rounded(_) => {
                centred(&self.corners())
            }
        }
    }

    /// Returns the corners in the part's frame (see [`Shape::corners`]).
    pub fn corners(&self) -> Vec<Point3<f64>> {
        match self {
            Solid::Prism { axis, outline, span } => {
                let place = |at: f64, p: &[f64; 2]| {
                    let mut point = [0.0; 3];
                    let (first, second) = other_axes(*axis);
                    (point[*axis], point[first], point[second]) = (at, p[0], p[1]);
                    Point3::from(point)
                };
                span.iter().flat_map(|&at| outline.iter().map(move |p| place(at, p))).collect()
            }
            Solid::Hull { points } => points.clone(),
            Solid::Rounded(rounded) => rounded.corners().collect(),
            _ => {
                let (shape, origin) = self.shape();
                shape.corners().into_iter().map(|p| p + origin).collect()
            }
        }
    }

    fn moments(&self) -> Moments {
        match self {
            Solid::Box { min, max } => {
                let size = max - min;
                let volume = size.product();
                let second = size.component_mul(&size) * (volume / 12.0);
                (volume, self.shape().1, Matrix3::from_diagonal(&second))
            }
            Solid::Cylinder { radius, z, .. } => {
                let height = z[1] - z[0];
                let volume = std::f64::consts::PI * radius * radius * height;
                let across = volume * radius * radius / 4.0;
                let along = volume * height * height / 12.0;
                let second = Vector3::new(across, across, along);
                (volume, self.shape().1, Matrix3::from_diagonal(&second))
            }
            Solid::Prism { axis, outline, span } => prism_moments(*axis, outline, *span),
            Solid::Hull { .. } | Solid::Rounded(_) => {
                // The checks of the task file exclude flat hulls.
                let (corners, faces) = hull(&self.corners()).unwrap_or_default();
                surface_moments(&corners, &faces)
            }
        }
    }
}

/// Returns the hull of points about their mean, and the mean.
pub(super) fn centred(points: &[Point3<f64>]) -> (Shape, Vector3<f64>) {
    let middle = points.iter().map(|p| p.coords).sum::<Vector3<f64>>() / points.len().max(1) as f64;
    (Shape::Hull { points: points.iter().map(|p| p - middle).collect() }, middle)
}

/// Returns the two axes that are not `axis`, in the order x, y, z.
pub fn other_axes(axis: usize) -> (usize, usize) {
    [(1, 2), (0, 2), (0, 1)][axis.min(2)]
}

/// Returns the convex hull of points in a plane, counter-clockwise, by Andrew's monotone chain.
pub fn convex_outline(points: Vec<Point2<f64>>) -> Vec<Point2<f64>> {
    outline_by(points, |p| *p)
}

/// Returns the convex hull, as [`convex_outline`], of items at positions `at` in a plane.
pub fn outline_by<P: Copy + PartialEq>(
    mut points: Vec<P>,
    at: impl Fn(&P) -> Point2<f64>,
) -> Vec<P> {
    let order = |a: Point2<f64>, b: Point2<f64>| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y));
    points.sort_by(|a, b| order(at(a), at(b)));
    points.dedup();
    if points.len() < 3 {
        return points;
    }
    let half = |points: &mut dyn Iterator<Item = &P>| {
        let mut corners: Vec<P> = Vec::new();
        for p in points {
            while let [.., a, b] = &corners[..]
                && (at(b) - at(a)).perp(&(at(p) - at(a))) <= 0.0
            {
                corners.pop();
            }
            corners.push(*p);
        }
        // The last point is the first of the other half.
        corners.pop();
        corners
    };
    let mut corners = half(&mut points.iter());
    corners.extend(half(&mut points.iter().rev()));
    corners
}

/// Returns the volume of a solid, m3.
pub fn volume(solid: &Solid) -> f64 {
    solid.moments().0
}

fn prism_moments(axis: usize, outline: &[[f64; 2]], span: [f64; 2]) -> Moments {
    // Polygon area, centroid and second moments by Green's theorem.
    let (mut area, mut first, mut second) = (0.0, [0.0; 2], [0.0; 3]);
    for (i, p) in outline.iter().enumerate() {
        let q = outline[(i + 1) % outline.len()];
        let cross = p[0] * q[1] - q[0] * p[1];
        area += cross / 2.0;
        for k in 0..2 {
            first[k] += cross * (p[k] + q[k]) / 6.0;
            second[k] += cross * (p[k] * p[k] + p[k] * q[k] + q[k] * q[k]) / 12.0;
        }
        second[2] +=
            cross * (p[0] * q[1] + 2.0 * p[0] * p[1] + 2.0 * q[0] * q[1] + q[0] * p[1]) / 24.0;
    }
    let centre = [first[0] / area, first[1] / area];
    let length = span[1] - span[0];
    let volume = area.abs() * length;
    let sign = area.signum() * length;
    let (a, b) = other_axes(axis);
    let mut middle = Vector3::zeros();
    (middle[a], middle[b], middle[axis]) = (centre[0], centre[1], (span[0] + span[1]) / 2.0);
    let mut tensor = Matrix3::zeros();
    tensor[(a, a)] = second[0] * sign - volume * centre[0] * centre[0];
    tensor[(b, b)] = second[1] * sign - volume * centre[1] * centre[1];
    tensor[(a, b)] = second[2] * sign - volume * centre[0] * centre[1];
    tensor[(b, a)] = tensor[(a, b)];
    tensor[(axis, axis)] = volume * length * length / 12.0;
    (volume, middle, tensor)
}

/// Corners of a surface, and its triangles as indices of corners, with outward normals.
pub type Triangles = (Vec<Point3<f64>>, Vec<[usize; 3]>);

/// Returns corners and outward triangles of the convex hull; `None` if the points lie nearly in a plane.
pub fn hull(points: &[Point3<f64>]) -> Option<Triangles> {
    let (corners, faces) = shapes::hull(points)?;
    let faces: Vec<_> = faces.iter().map(|face| face.map(|corner| corner as usize)).collect();
    (surface_moments(&corners, &faces).0 > MIN_VOLUME).then_some((corners, faces))
}

/// Volume below which a hull counts as flat, m3.
pub const MIN_VOLUME: f64 = 1e-7 * MM * MM * MM;

/// Returns volume, centroid and second moments about it of a closed surface of outward triangles.
pub fn surface_moments(corners: &[Point3<f64>], faces: &[[usize; 3]]) -> Moments {
    let (mut volume, mut first, mut second) = (0.0, Vector3::zeros(), Matrix3::zeros());
    for face in faces {
        let [a, b, c] = face.map(|corner| corners[corner].coords);
        let part = a.dot(&b.cross(&c)) / 6.0;
        let sum = a + b + c;
        volume += part;
        first += sum * (part / 4.0);
        let squares = a * a.transpose() + b * b.transpose() + c * c.transpose();
        second += (squares + sum * sum.transpose()) * (part / 20.0);
    }
    if volume == 0.0 {
        return (0.0, Vector3::zeros(), Matrix3::zeros());
    }
    let centre = first / volume;
    (volume, centre, second - centre * centre.transpose() * volume)
}

/// Returns the mass properties of parts of one density with the given total mass (kg). The
/// products of inertia are left out: they are zero or small for these plugs.
pub fn inertia<'a>(parts: impl IntoIterator<Item = &'a Part>, mass: f64) -> Inertia {
    let moments: Vec<_> = parts.into_iter().map(|part| part.solid.moments()).collect();
    let volume: f64 = moments.iter().map(|m| m.0).sum();
    let centre = moments.iter().map(|m| m.1 * m.0).sum::<Vector3<f64>>() / volume;
    let density = mass / volume;
    let second = moments.iter().fold(Matrix3::zeros(), |sum, (v, c, tensor)| {
        let arm = c - centre;
        sum + tensor + arm * arm.transpose() * *v
    }) * density;
    let d = second.diagonal();
    let moments = Vector3::new(d.y + d.z, d.x + d.z, d.x + d.y);
    Inertia { mass, centre: Point3::from(centre), moments }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_prism_that_is_a_box_weighs_like_the_box() {
        let cuboid = Solid::Box {
            min: Vector3::new(-0.004, 0.001, 0.0),
            max: Vector3::new(0.004, 0.007, 0.05),
        };
        let prism = Solid::Prism {
            axis: 1,
            outline: vec![[-0.004, 0.0], [-0.004, 0.05], [0.004, 0.05], [0.004, 0.0]],
            span: [0.001, 0.007],
        };
        let part = |solid| [Part { name: String::new(), solid, friction: None }];
        let hull = Solid::Hull { points: prism.corners() };
        let (a, b) = (inertia(&part(cuboid), 0.03), inertia(&part(prism), 0.03));
        let c = inertia(&part(hull), 0.03);
        assert!((a.centre - c.centre).norm() < 1e-12, "{c:?}");
        assert!((a.moments - c.moments).norm() < 1e-9 * a.moments.norm(), "{c:?}");
        assert!((a.centre - b.centre).norm() < 1e-15);
        assert!((a.moments - b.moments).norm() < 1e-9 * a.moments.norm());
        // m (h^2 + d^2) / 12 about x.
        let about_x = 0.03 * (0.05f64.powi(2) + 0.006f64.powi(2)) / 12.0;
        assert!((a.moments.x - about_x).abs() < 1e-12);
    }
}
