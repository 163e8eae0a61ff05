//! Referee of the contact engines: quasi-static insertion of a peg in the plane, with exact arcs.
//!
//! The peg has three degrees of freedom (lateral, axial, tilt) and hangs on three springs at its
//! compliance centre. Peg and hole are convex outlines of straight edges whose corners are arcs:
//! a polygon (the core) and the disc of a radius that is swept along it. Contacts are rigid, with
//! Coulomb friction. For each step of the drive the equilibrium is sought among the contact modes
//! (open, sliding to either side, sticking) by Newton's method, so a force has the precision of the
//! arithmetic. Contacts can be made compliant, to tell what the stiffness of an engine's contacts is
//! worth. No collision library is used, and no code of the engines.
//!
//! | module | content |
//! | --- | --- |
//! | `outline` | peg and hole: edges, corners, radii |
//! | `feature` | pairs of corner and edge, or of two corners: gap, normal, point |
//! | `equilibrium` | forces and pose for given contact modes |
//! | `modes` | search for the contact modes |
//! | `path` | steps of the drive, snaps, limit of the force |
//! | `wedging` | friction cones of two contacts, indeterminate cases |
//! | `trial` | outcome of an insertion and force over depth |
//! | `sample` | random insertions |
//!
//! Coordinates: x across the hole, z along its axis and out of it; the mouth lies in z = 0 and the
//! hole's axis in x = 0. Angles are positive from x to z. SI units.

mod equilibrium;
mod feature;
mod modes;
mod outline;
mod path;
pub mod sample;
mod trial;
mod wedging;

use nalgebra::{Vector2, Vector3};

pub use feature::{Feature, Geometry, Touch};
pub use modes::{Contact, Mode, State};
pub use outline::{Chamfer, Hole, Outline, Peg};
pub use path::{Insertion, Stop};
pub use trial::{Outcome, Record, Trial};
pub use wedging::{TWO_POINT, cone_margin, holds, two_point_pose, wedges};

/// Vector in the plane: across and along the hole's axis.
pub type V2 = Vector2<f64>;
/// Lateral and axial position of the compliance centre, m, and tilt, rad; or the loads on them.
pub type V3 = Vector3<f64>;

/// Springs that hold the peg at its compliance centre, along x and z and against tilt.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Support {
    /// Lateral stiffness, N/m.
    pub lateral: f64,
    /// Axial stiffness, N/m.
    pub axial: f64,
    /// Angular stiffness, N m/rad.
    pub angular: f64,
    /// Distance of the compliance centre from the tip, m.
    pub centre: f64,
}

impl Support {
    /// Returns the stiffness of the three coordinates.
    pub fn stiffness(&self) -> V3 {
        V3::new(self.lateral, self.axial, self.angular)
    }

    /// Returns the coordinates of the compliance centre at which the middle of the tip lies at a
    /// point and the peg is tilted.
    pub fn pose(&self, tip: V2, tilt: f64) -> V3 {
        let centre = tip + turned(tilt, &V2::new(0.0, self.centre));
        V3::new(centre.x, centre.y, tilt)
    }

    /// Returns the middle of the tip.
    pub fn tip(&self, pose: &V3) -> V2 {
        self.place(pose, &V2::zeros())
    }

    /// Returns the position of a point of the peg.
    pub fn place(&self, pose: &V3, point: &V2) -> V2 {
        let arm = point - V2::new(0.0, self.centre);
        pose.xy() + turned(pose.z, &arm)
    }
}

/// Returns a vector turned by an angle, with the same bits on every platform.
fn turned(angle: f64, vector: &V2) -> V2 {
    let (sin, cos) = libm::sincos(angle);
    V2::new(cos * vector.x - sin * vector.y, sin * vector.x + cos * vector.y)
}

/// Peg, hole, friction and springs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Assembly {
    /// The peg.
    pub peg: Peg,
    /// The hole.
    pub hole: Hole,
    /// Coefficient of friction.
    pub friction: f64,
    /// Springs of the peg.
    pub support: Support,
    /// Compliance of a contact along its normal, m/N; 0 for rigid contacts.
    pub compliance: f64,
}

impl Assembly {
    /// Returns the sum of the radii of tip edge and rim, m.
    pub fn radii(&self) -> f64 {
        self.peg.radius + self.hole.radius
    }
}
