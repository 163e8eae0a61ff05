//! The engine-neutral scene: bodies with convex geoms, joints with springs and
//! servos, and the pairs of bodies that may touch. SI units throughout.

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
    /// Coefficient of friction; a pair of geoms has the smaller of its two.
    pub friction: f64,
    /// Radius of the soft patch that a contact point stands for, m: friction also
    /// resists a turn about the normal, with at most that times the friction force,
    /// and force and moment share an ellipsoid (Howe and Cutkosky 1996, Int. J. Robot.
    /// Res. 15:557). A pair has the smaller of its two; at 0 a point turns freely.
    /// Engines without it ignore it.
    pub patch: f64,
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
pub enum Axis {
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
    Axes([Axis; 6]),
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
    pub contacts: Vec<(BodyId, BodyId)>,
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
