//! The engine-neutral scene: bodies with convex geoms, joints with springs and
//! servos, and the pairs of bodies that may touch, with their friction. SI units throughout.

use nalgebra::{Isometry3, Matrix6, Point3, Vector3};

/// A rigid pose, metres.
pub type Pose = Isometry3<f64>;

/// Index of a body in [`Scene::bodies`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct BodyId(pub usize);

/// Index of a joint in [`Scene::joints`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct JointId(pub usize);

/// A convex shape in its own frame.
#[derive(Debug, Clone, PartialEq)]
pub enum Shape {
    /// A box by its half extents, m.
    Box {
        /// Half extents along x, y and z.
        half: Vector3<f64>,
    },
    /// A cylinder about z.
    Cylinder {
        /// Half of its height, m.
        half_height: f64,
        /// Radius, m.
        radius: f64,
    },
    /// The convex hull of some points, m.
    Hull {
        /// The corners.
        points: Vec<Point3<f64>>,
    },
}

/// A shape on a body.
#[derive(Debug, Clone, PartialEq)]
pub struct Geom {
    /// For pictures, exports and errors.
    pub name: String,
    /// The shape.
    pub shape: Shape,
    /// Shape frame in the body frame.
    pub pose: Pose,
    /// Its own coefficient of friction, in place of that of the pair of bodies; of two geoms
    /// that have one, the smaller.
    pub friction: Option<f64>,
}

/// Two bodies that may touch, and the friction of their surfaces on one another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ContactPair {
    /// The first body.
    pub first: BodyId,
    /// The second body.
    pub second: BodyId,
    /// Of their surfaces, but for geoms that have a friction of their own.
    pub friction: Friction,
}

/// Two geoms that may touch; all bodies' geoms are counted in one row.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GeomPair {
    /// Index of their bodies' pair in [`Scene::contacts`].
    pub bodies: usize,
    /// The geom of the pair's first body.
    pub first: usize,
    /// The geom of the pair's second body.
    pub second: usize,
    /// Of their surfaces.
    pub friction: Friction,
}

/// Friction of one surface on another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Friction {
    /// Coefficient of friction.
    pub coefficient: f64,
    /// How it resists a turn about the contact's normal.
    pub torsion: Torsion,
}

/// What resists a turn of two faces about their normal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Torsion {
    /// Each contact point stands for a soft patch of this radius, m: friction resists a turn with
    /// at most that times the friction force, and force and moment share an ellipsoid (Howe
    /// and Cutkosky 1996, Int. J. Robot. Res. 15:557), beside the moment that the points have by
    /// their distances. At 0 a point turns freely. Engines without it ignore it.
    Radius(f64),
    /// The points of a contact together have the moment of the patch between them, evenly pressed,
    /// and no other.
    Patch,
}

impl Friction {
    /// Friction of hard surfaces, which resists no turn.
    pub fn hard(coefficient: f64) -> Self {
        Friction { coefficient, torsion: Torsion::Radius(0.0) }
    }
}

impl ContactPair {
    /// Friction of a geom of the first body on one of the second.
    fn between(&self, first: &Geom, second: &Geom) -> Friction {
        let own = first.friction.into_iter().chain(second.friction).reduce(f64::min);
        Friction { coefficient: own.unwrap_or(self.friction.coefficient), ..self.friction }
    }

    /// 1 if these are its bodies, -1 if they are in the other order.
    pub fn sign(&self, first: BodyId, second: BodyId) -> Option<f64> {
        match (self.first, self.second) {
            ends if ends == (first, second) => Some(1.0),
            ends if ends == (second, first) => Some(-1.0),
            _ => None,
        }
    }

    /// Whether a body is one of the two.
    pub fn has(&self, body: BodyId) -> bool {
        self.first == body || self.second == body
    }
}

/// Mass properties of a body about its centre of mass, along the body axes.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Inertia {
    /// kg.
    pub mass: f64,
    /// Centre of mass in the body frame, m.
    pub centre: Point3<f64>,
    /// Principal moments about x, y and z, kg m2.
    pub moments: Vector3<f64>,
}

/// How a body moves.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a scene has a handful of bodies")]
pub enum Motion {
    /// Stays where it is.
    Fixed,
    /// Follows a commanded pose.
    Driven,
    /// Follows forces.
    Free(Inertia),
    /// Follows forces but for its own weight, which the robot compensates.
    Carried(Inertia),
    /// The end of a mechanism that carries its own weight: as `Carried`, but its
    /// mass depends on the direction. Symmetric, positive definite 6x6, about the
    /// body frame's origin, along the body axes: kg, kg m, kg m2.
    Mechanism(Matrix6<f64>),
}

/// A rigid body.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Unique in the scene.
    pub name: String,
    /// How it moves.
    pub motion: Motion,
    /// Body frame in the world at the start.
    pub pose: Pose,
    /// Its shapes.
    pub geoms: Vec<Geom>,
}

/// A spring, with a servo's target and limit if it has them.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Spring {
    /// N/m or N m/rad.
    pub stiffness: f64,
    /// N s/m or N m s/rad.
    pub damping: f64,
    /// Rest position, m or rad.
    pub target: f64,
    /// Largest force or moment, N or N m; infinite for a plain spring.
    pub limit: f64,
}

impl Spring {
    /// A spring at rest in the zero position.
    pub fn new(stiffness: f64, damping: f64) -> Self {
        Spring { stiffness, damping, target: 0.0, limit: f64::INFINITY }
    }
}

/// One of the six axes of a joint.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum JointAxis {
    /// No relative motion.
    Locked,
    /// Motion against a spring.
    Sprung(Spring),
}

/// A joint's springs where the axes pull at one another.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Coupled {
    /// Symmetric, positive definite: N/m, N/rad (N m/m) and N m/rad.
    pub stiffness: Matrix6<f64>,
    /// Symmetric, not negative: N s/m, N s/rad and N m s/rad.
    pub damping: Matrix6<f64>,
}

/// What holds a joint's child to its parent.
#[derive(Debug, Clone, Copy, PartialEq)]
#[expect(clippy::large_enum_variant, reason = "a scene has a handful of joints")]
pub enum Springs {
    /// Each axis by itself: translations x, y, z, rotations x, y, z.
    Axes([JointAxis; 6]),
    /// All six axes at once; coordinates as above, the rotations as a rotation vector.
    Coupled(Coupled),
}

/// A joint between two bodies: translations along, then rotations about, the
/// x, y and z axes of the frame fixed to the parent.
#[derive(Debug, Clone, PartialEq)]
pub struct Joint {
    /// Unique in the scene.
    pub name: String,
    /// The body that carries the axes.
    pub parent: BodyId,
    /// The body that moves along them.
    pub child: BodyId,
    /// Joint frame in the parent frame.
    pub in_parent: Pose,
    /// Joint frame in the child frame.
    pub in_child: Pose,
    /// What resists relative motion.
    pub springs: Springs,
}

/// Everything an engine needs to know.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Scene {
    /// The bodies.
    pub bodies: Vec<Body>,
    /// The joints.
    pub joints: Vec<Joint>,
    /// Pairs of bodies that may touch; all others pass through one another.
    pub contacts: Vec<ContactPair>,
    /// m/s2.
    pub gravity: Vector3<f64>,
}

impl Scene {
    /// Adds a body.
    pub fn body(&mut self, body: Body) -> BodyId {
        self.bodies.push(body);
        BodyId(self.bodies.len() - 1)
    }

    /// Adds a joint.
    pub fn joint(&mut self, joint: Joint) -> JointId {
        self.joints.push(joint);
        JointId(self.joints.len() - 1)
    }

    /// Lets two bodies touch.
    pub fn contact(&mut self, first: BodyId, second: BodyId, friction: Friction) {
        self.contacts.push(ContactPair { first, second, friction });
    }

    /// The first pair of bodies whose friction has the moment of a pressed patch.
    pub fn patched(&self) -> Option<&ContactPair> {
        self.contacts.iter().find(|pair| pair.friction.torsion == Torsion::Patch)
    }

    /// Each two geoms that may touch, in the order of the contacts.
    pub fn geom_pairs(&self) -> Vec<GeomPair> {
        let mut next = 0;
        let count = |body: &Body| {
            next += body.geoms.len();
            next - body.geoms.len()
        };
        let from: Vec<usize> = self.bodies.iter().map(count).collect();
        let mut found = Vec::new();
        for (bodies, pair) in self.contacts.iter().enumerate() {
            let (a, b) = (pair.first.0, pair.second.0);
            for (i, first) in self.bodies[a].geoms.iter().enumerate() {
                for (j, second) in self.bodies[b].geoms.iter().enumerate() {
                    let friction = pair.between(first, second);
                    found.push(GeomPair {
                        bodies,
                        first: from[a] + i,
                        second: from[b] + j,
                        friction,
                    });
                }
            }
        }
        found
    }
}

impl Shape {
    /// Corners for boxes and hulls; for a cylinder the corners of a 16-sided
    /// prism inside it (for pictures and extents).
    pub fn corners(&self) -> Vec<Point3<f64>> {
        match self {
            Shape::Box { half } => (0..8)
                .map(|i| {
                    let sign = |bit: usize| if i >> bit & 1 == 0 { -1.0 } else { 1.0 };
                    Point3::new(sign(0) * half.x, sign(1) * half.y, sign(2) * half.z)
                })
                .collect(),
            Shape::Cylinder { half_height, radius } => (0..32)
                .map(|i| {
                    let angle = f64::from(i / 2) * std::f64::consts::TAU / 16.0;
                    let z = if i % 2 == 0 { -half_height } else { *half_height };
                    Point3::new(radius * angle.cos(), radius * angle.sin(), z)
                })
                .collect(),
            Shape::Hull { points } => points.clone(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_geoms_own_friction_takes_the_place_of_the_pairs() {
        let geom = |friction| Geom {
            name: String::new(),
            shape: Shape::Box { half: Vector3::repeat(1.0) },
            pose: Pose::identity(),
            friction,
        };
        let body = |frictions: [Option<f64>; 2]| Body {
            name: String::new(),
            motion: Motion::Fixed,
            pose: Pose::identity(),
            geoms: frictions.map(geom).to_vec(),
        };
        let mut scene = Scene::default();
        scene.body(body([None; 2]));
        let first = scene.body(body([None, Some(0.3)]));
        let second = scene.body(body([None, Some(0.02)]));
        scene.contact(first, second, Friction { coefficient: 1.0, torsion: Torsion::Radius(0.03) });
        let found: Vec<_> = scene
            .geom_pairs()
            .iter()
            .map(|p| (p.first, p.second, p.friction.coefficient))
            .collect();
        assert_eq!(found, [(2, 4, 1.0), (2, 5, 0.02), (3, 4, 0.3), (3, 5, 0.02)]);
        assert!(
            scene.geom_pairs().iter().all(|pair| pair.friction.torsion == Torsion::Radius(0.03))
        );
    }
}
