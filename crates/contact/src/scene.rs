//! Scenes for any engine: bodies with convex geoms, joints with springs and servos, and the pairs
//! of bodies that may touch, with their friction. SI units.

use nalgebra::{Isometry3, Matrix6, Point3, UnitQuaternion, Vector3, Vector6};

/// Pose of a frame: translation, m, and rotation.
pub type Pose = Isometry3<f64>;

/// Returns the translation and the rotation vector from one pose to another, world axes.
pub fn displacement(from: &Pose, to: &Pose) -> Vector6<f64> {
    let translation = to.translation.vector - from.translation.vector;
    let rotation = (to.rotation * from.rotation.inverse()).scaled_axis();
    Vector6::new(translation.x, translation.y, translation.z, rotation.x, rotation.y, rotation.z)
}

/// Returns the 6x6 matrix that rotates linear and angular velocities.
pub fn block_rotation(rotation: &UnitQuaternion<f64>) -> Matrix6<f64> {
    let axes = rotation.to_rotation_matrix().into_inner();
    let mut blocks = Matrix6::zeros();
    blocks.fixed_view_mut::<3, 3>(0, 0).copy_from(&axes);
    blocks.fixed_view_mut::<3, 3>(3, 3).copy_from(&axes);
    blocks
}

/// Index of a body in [`Scene::bodies`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BodyId(pub usize);

/// Index of a joint in [`Scene::joints`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct JointId(pub usize);

/// Convex shape in its own frame.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// Box by its half extents.
    Box {
        /// Half extents along x, y and z, m.
        half: Vector3<f64>,
    },
    /// Cylinder about z.
    Cylinder {
        /// Half of the height, m.
        half_height: f64,
        /// Radius, m.
        radius: f64,
    },
    /// Convex hull of points.
    Hull {
        /// Points, m.
        points: Vec<Point3<f64>>,
    },
    /// Points within a radius of a core: a box with round edges and corners, a capsule, a ball.
    RoundBox {
        /// Half extents of the core along x, y and z, m; any of them may be 0.
        core: Vector3<f64>,
        /// Radius, m.
        radius: f64,
    },
}

/// Shape on a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Geom {
    /// Name in pictures, exports and errors.
    pub name: String,
    /// Shape in its own frame.
    pub shape: Shape,
    /// Pose of the shape in the body frame.
    pub pose: Pose,
    /// Coefficient of friction that replaces that of the pair; if both geoms have one, the smaller applies.
    pub friction: Option<f64>,
}

/// Pair of bodies that may touch.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPair {
    /// First body.
    pub first: BodyId,
    /// Second body.
    pub second: BodyId,
    /// Friction of their surfaces, except for geoms with a coefficient of their own.
    pub friction: Friction,
}

/// Pair of geoms that may touch; geoms are numbered consecutively over all bodies.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GeomPair {
    /// Index of their bodies' pair in [`Scene::contacts`].
    pub bodies: usize,
    /// Geom of the first body.
    pub first: usize,
    /// Geom of the second body.
    pub second: usize,
    /// Friction of their surfaces.
    pub friction: Friction,
}

/// Friction of one surface on another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Coefficient of friction.
    pub coefficient: f64,
    /// Friction against rotation about the contact normal.
    pub torsion: Torsion,
}

/// Friction against rotation of two faces about their normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Torsion {
    /// Soft patch of this radius, m, at each contact point: the friction moment is at most the radius times
    /// the friction force, and both are limited by an ellipsoid (Howe and Cutkosky 1996, Int. J. Robot. Res.
    /// 15:557). It adds to the moment that several points have due to their distances. With a radius of 0 a
    /// point rotates freely. Engines without torsional friction ignore it.
    Radius(f64),
    /// Contact patch spanned by the contact points; its friction moment is only that of the patch under uniform
    /// pressure.
    Patch,
}

impl Friction {
    /// Creates friction without torsion.
    pub fn hard(coefficient: f64) -> Self {
        Friction { coefficient, torsion: Torsion::Radius(0.0) }
    }

    /// Returns the friction of two geoms that may have coefficients of their own: the smaller one applies.
    pub fn of_geoms(self, [first, second]: [Option<f64>; 2]) -> Self {
        let own = first.into_iter().chain(second).reduce(f64::min);
        Friction { coefficient: own.unwrap_or(self.coefficient), ..self }
    }
}

/// Returns 1 for the bodies of the pair, -1 for them in reverse order, `None` for others.
pub(crate) fn sign<T: Copy + PartialEq>(pair: (T, T), bodies: (T, T)) -> Option<f64> {
    match bodies {
        ends if ends == pair => Some(1.0),
        (second, first) if (first, second) == pair => Some(-1.0),
        _ => None,
    }
}

impl ContactPair {
    /// Returns 1 for the bodies of the pair, -1 for them in reverse order, `None` for others.
    pub fn sign(&self, first: BodyId, second: BodyId) -> Option<f64> {
        sign((self.first, self.second), (first, second))
    }

    /// Returns whether a body is in the pair.
    pub fn contains(&self, body: BodyId) -> bool {
        self.first == body || self.second == body
    }
}

/// Mass properties of a body about its centre of mass, along the body axes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Inertia {
    /// Mass, kg.
    pub mass: f64,
    /// Centre of mass in the body frame, m.
    pub centre: Point3<f64>,
    /// Principal moments about x, y and z, kg m2.
    pub moments: Vector3<f64>,
}

/// Motion of a body.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a scene has a handful of bodies")]
pub enum Motion {
    /// No motion.
    Fixed,
    /// Motion along commanded poses.
    Driven,
    /// Motion under forces.
    Free(Inertia),
    /// Motion under forces except the weight, which the robot compensates.
    Carried(Inertia),
    /// End of a mechanism, without weight like `Carried`, with a mass that depends on the direction: symmetric,
    /// positive definite 6x6, about the body frame's origin, along the body axes: kg, kg m, kg m2.
    Mechanism(Matrix6<f64>),
}

/// Rigid body.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name, unique in the scene.
    pub name: String,
    /// Motion of the body.
    pub motion: Motion,
    /// Pose in the world at the start.
    pub pose: Pose,
    /// Shapes of the body.
    pub geoms: Vec<Geom>,
}

/// Spring, with target and limit if it is a servo.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// Stiffness, N/m or N m/rad.
    pub stiffness: f64,
    /// Damping, N s/m or N m s/rad.
    pub damping: f64,
    /// Rest position, m or rad.
    pub target: f64,
    /// Largest force or moment, N or N m; infinite for a plain spring.
    pub limit: f64,
}

impl Spring {
    /// Creates a spring at rest in the zero position.
    pub fn new(stiffness: f64, damping: f64) -> Self {
        Spring { stiffness, damping, target: 0.0, limit: f64::INFINITY }
    }
}

/// Springs that hold a joint's child to its parent.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a scene has a handful of joints")]
pub enum Springs {
    /// Spring of each axis, `None` if the axis is locked: translations x, y, z, rotations x, y, z.
    Axes([Option<Spring>; 6]),
    /// Coupled springs of all axes, in the same order; the rotations are a rotation vector.
    Coupled {
        /// Stiffness, symmetric, positive definite: N/m, N/rad (N m/m) and N m/rad.
        stiffness: Matrix6<f64>,
        /// Damping, symmetric, not negative: N s/m, N s/rad and N m s/rad.
        damping: Matrix6<f64>,
    },
}

/// Joint: translations along, then rotations about, the x, y and z axes of the parent's frame.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Name, unique in the scene.
    pub name: String,
    /// Body that carries the axes.
    pub parent: BodyId,
    /// Body that moves along them.
    pub child: BodyId,
    /// Pose of the joint frame in the parent frame.
    pub in_parent: Pose,
    /// Pose of the joint frame in the child frame.
    pub in_child: Pose,
    /// Springs against relative motion.
    pub springs: Springs,
}

/// Coulomb friction along z of a fixed body's frame that acts at the origin of another body's frame, like that of
/// springs that press on a plug from the sides. It opposes the velocity, and sticks as a contact of the engine does.
#[derive(Debug, Clone, PartialEq)]
pub struct AxialFriction {
    /// Fixed body.
    pub parent: BodyId,
    /// Body on which it acts.
    pub child: BodyId,
    /// Intervals of x and y in the parent's frame in which it acts, m.
    pub region: [[f64; 2]; 2],
    /// Depth below the parent's origin, m, ascending, and largest force there, N.
    pub force: Vec<[f64; 2]>,
}

impl AxialFriction {
    /// Returns the largest force at these poses of parent and child, N: linear between the depths, 0 above the
    /// first, and the last one below the last.
    pub fn limit(&self, parent: &Pose, child: &Pose) -> f64 {
        let at = parent.inverse_transform_point(&child.translation.vector.into());
        let inside =
            |axis: usize| (self.region[axis][0]..=self.region[axis][1]).contains(&at[axis]);
        let depth = -at.z;
        let below = self.force.partition_point(|[from, _]| *from <= depth);
        let above = below.checked_sub(1).filter(|_| inside(0) && inside(1));
        let Some([from, low]) = above.map(|i| self.force[i]) else { return 0.0 };
        let Some([to, high]) = self.force.get(below) else { return low };
        low + (high - low) * (depth - from) / (to - from)
    }
}

/// Bodies, joints and contacts to simulate.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    /// Bodies by [`BodyId`].
    pub bodies: Vec<Body>,
    /// Joints by [`JointId`].
    pub joints: Vec<Joint>,
    /// Pairs of bodies that may touch; all others pass through one another.
    pub contacts: Vec<ContactPair>,
    /// Friction along an axis, if any; its force is part of the contact of its two bodies.
    pub axial_friction: Option<AxialFriction>,
    /// Gravity, m/s2.
    pub gravity: Vector3<f64>,
}

impl Scene {
    /// Adds a body and returns its index.
    pub fn body(&mut self, body: Body) -> BodyId {
        self.bodies.push(body);
        BodyId(self.bodies.len() - 1)
    }

    /// Adds a joint and returns its index.
    pub fn joint(&mut self, joint: Joint) -> JointId {
        self.joints.push(joint);
        JointId(self.joints.len() - 1)
    }

    /// Adds a pair of bodies that may touch.
    pub fn contact(&mut self, first: BodyId, second: BodyId, friction: Friction) {
        self.contacts.push(ContactPair { first, second, friction });
    }

    /// Returns the first pair of bodies with the torsional friction of a contact patch.
    pub fn first_patch(&self) -> Option<&ContactPair> {
        self.contacts.iter().find(|pair| pair.friction.torsion == Torsion::Patch)
    }

    /// Returns the pairs of geoms that may touch, in the order of the contacts.
    pub fn geom_pairs(&self) -> Vec<GeomPair> {
        let numbered = |body: BodyId| {
            let before: usize = self.bodies[..body.0].iter().map(|body| body.geoms.len()).sum();
            (before..).zip(&self.bodies[body.0].geoms)
        };
        let mut pairs = Vec::new();
        for (bodies, pair) in self.contacts.iter().enumerate() {
            for (first, own) in numbered(pair.first) {
                for (second, other) in numbered(pair.second) {
                    let friction = pair.friction.of_geoms([own.friction, other.friction]);
                    pairs.push(GeomPair { bodies, first, second, friction });
                }
            }
        }
        pairs
    }
}

impl Shape {
    /// Returns the corners, m, for pictures and extents: of a cylinder those of an inscribed prism with 16 sides,
    /// of a round edge a point every 22.5 degrees.
    pub fn corners(&self) -> Vec<Point3<f64>> {
        match self {
            Shape::Box { half } => {
                octants().map(|signs| signs.component_mul(half).into()).collect()
            }
            Shape::Cylinder { half_height, radius } => {
                let corner = |i: u32| {
                    let angle = f64::from(i / 2) * std::f64::consts::TAU / 16.0;
                    let z = if i.is_multiple_of(2) { -half_height } else { *half_height };
                    Point3::new(radius * libm::cos(angle), radius * libm::sin(angle), z)
                };
                (0..32).map(corner).collect()
            }
            Shape::Hull { points } => points.clone(),
            Shape::RoundBox { core, radius } => {
                let angle = |i: u32| f64::from(i) * std::f64::consts::FRAC_PI_8;
                let outward = |i: u32| {
                    let (up, around) = (angle(i / 5), angle(i % 5));
                    let [level, height] = [libm::cos(up), libm::sin(up)];
                    Vector3::new(level * libm::cos(around), level * libm::sin(around), height)
                };
                let point = |i| core + outward(i) * *radius;
                let octant = |signs: Vector3<f64>| {
                    (0..25).map(move |i| Point3::from(point(i).component_mul(&signs)))
                };
                octants().flat_map(octant).collect()
            }
        }
    }
}

/// Returns the signs of x, y and z in the eight octants.
fn octants() -> impl Iterator<Item = Vector3<f64>> {
    let sign = |i: usize, bit: usize| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
    (0..8).map(move |i| Vector3::from_fn(|axis, _| sign(i, axis)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_geoms_own_friction_takes_the_place_of_the_pairs() {
        let (shape, pose) = (Shape::Box { half: Vector3::repeat(1.0) }, Pose::identity());
        let geom = |friction| Geom { name: String::new(), shape: shape.clone(), pose, friction };
        let body = |frictions: [Option<f64>; 2]| {
            let geoms = frictions.map(geom).to_vec();
            Body { name: String::new(), motion: Motion::Fixed, pose, geoms }
        };
        let mut scene = Scene::default();
        scene.body(body([None; 2]));
        let first = scene.body(body([None, Some(0.3)]));
        let second = scene.body(body([None, Some(0.02)]));
        scene.contact(first, second, Friction { coefficient: 1.0, torsion: Torsion::Radius(0.03) });
        let found = scene.geom_pairs();
        let coefficients = found.iter().map(|p| (p.first, p.second, p.friction.coefficient));
        let expected = [(2, 4, 1.0), (2, 5, 0.02), (3, 4, 0.3), (3, 5, 0.02)];
        assert!(coefficients.eq(expected), "{found:?}");
        assert!(found.iter().all(|pair| pair.friction.torsion == Torsion::Radius(0.03)));
    }

    #[test]
    fn axial_friction_is_that_of_the_depth_within_its_region_alone() {
        let (parent, child) = (BodyId(0), BodyId(1));
        let force = vec![[1e-3, 4.0], [2e-3, 12.0], [6e-3, 8.0]];
        let friction = AxialFriction { parent, child, region: [[-1e-3, 1e-3]; 2], force };
        let at = |x: f64, z: f64| friction.limit(&Pose::identity(), &Pose::translation(x, 0.0, z));
        for (x_mm, depth_mm, expected) in [
            (0.0, -1.0, 0.0),
            (0.0, 0.9, 0.0),
            (0.0, 1.0, 4.0),
            (0.0, 1.5, 8.0),
            (0.9, 3.0, 11.0),
            (1.1, 3.0, 0.0),
            (0.0, 9.0, 8.0),
        ] {
            let found = at(x_mm * 1e-3, -depth_mm * 1e-3);
            assert!((found - expected).abs() < 1e-9, "{x_mm} {depth_mm}: {found}");
        }
        let signs = [(parent, child), (child, parent)].map(|ends| sign((parent, child), ends));
        assert_eq!(signs, [Some(1.0), Some(-1.0)]);
    }
}
