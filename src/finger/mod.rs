//! One printed finger as the paper models it: six springs about a remote
//! centre of compliance (RCC), Sec. "Stiffness model" and Table "Simulation Inputs".

mod model;

pub use model::{Coupling, FingerModel, Rcc};

use crate::scene::{Axis, Coupled, Geom, Inertia, Pose, Shape, Spring, Springs};
use crate::task::Friction;
use crate::units::{GRAM, MM, N_PER_MM};
use nalgebra::{Matrix6, Point3, Vector3};

/// One finger, in SI units; both fingers of a gripper are alike.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finger {
    /// Spring in y, the direction in which the jaws close, N/m.
    pub compliance: f64,
    /// Spring in z, the direction of assembly, N/m.
    pub assembly: f64,
    /// Spring in x, across the finger's width, N/m.
    pub depth: f64,
    /// Rotational springs about x, y and z through the RCC, N m/rad.
    pub rotation: [f64; 3],
    /// Distance of the RCC from the contact plane towards the plug's tip, m.
    pub rcc: f64,
    /// Mass, kg.
    pub mass: f64,
    /// Translational damping of the springs, N s/m.
    pub damping: f64,
    /// Rotational damping of the springs, N m s/rad.
    pub rotational_damping: f64,
    /// How the springs pull at one another; they do not in the paper.
    pub coupling: Option<Coupling>,
}

/// Rotational spring about x, N m/rad: the upper end of the range in the paper's
/// Table "Simulation Inputs" (0.5 .. 2), of which the paper itself used 1; why is
/// in `docs/calibration.md`.
const TILTING: f64 = 2.0;

impl Finger {
    /// A finger of the given compliance and assembly stiffness (N/m, per
    /// finger), everything else as in the paper.
    pub fn new(compliance: f64, assembly: f64) -> Self {
        Finger {
            compliance,
            assembly,
            depth: 100.0 * N_PER_MM,
            rotation: [TILTING, 10.0, 10.0],
            rcc: 21.0 * MM,
            mass: 2.0 * GRAM,
            damping: 10.0,
            rotational_damping: 0.02,
            coupling: None,
        }
    }
}

/// The notch: a vertical pad that presses the part, and a roof above it that
/// rests on the part's shoulder and carries the assembly force. Dimensions in m.
pub mod notch {
    use crate::units::MM;
    /// Width of pad and roof in x.
    pub const WIDTH: f64 = 12.0 * MM;
    /// Height of the pad, downward from the roof.
    pub const PAD_HEIGHT: f64 = 8.4 * MM;
    /// Thickness of the pad behind its face (not decisive).
    pub const PAD_THICKNESS: f64 = 4.0 * MM;
    /// How far the roof reaches over the part in y.
    pub const ROOF_DEPTH: f64 = 2.5 * MM;
    /// Thickness of the roof (not decisive).
    pub const ROOF_THICKNESS: f64 = 3.0 * MM;
    /// Gap between roof and shoulder at the grasp: the roof comes to rest on
    /// the shoulder when the part is first pushed up.
    pub const ROOF_GAP: f64 = 0.05 * MM;
}

impl Finger {
    /// The six springs about the RCC: translations x, y, z, rotations x, y, z.
    pub fn springs(&self) -> [Spring; 6] {
        let translation = |k: f64| Spring::new(k, self.damping);
        let rotation = |k: f64| Spring::new(k, self.rotational_damping);
        let [rx, ry, rz] = self.rotation;
        [
            translation(self.depth),
            translation(self.compliance),
            translation(self.assembly),
            rotation(rx),
            rotation(ry),
            rotation(rz),
        ]
    }
}

impl Finger {
    /// What ties the finger to its jaw at the RCC; `side` as of [`tip`].
    pub fn mounted(&self, side: f64) -> Springs {
        let springs = self.springs();
        match &self.coupling {
            None => Springs::Axes(springs.map(Axis::Sprung)),
            Some(coupling) => Springs::Coupled(Coupled {
                stiffness: coupling.stiffness(springs.map(|spring| spring.stiffness), side),
                damping: Matrix6::from_diagonal(&springs.map(|spring| spring.damping).into()),
            }),
        }
    }
}

/// Pad and roof in the finger frame: origin on the pad's face at the height of
/// the TCP, `side` -1 for the finger at -y, +1 for the one at +y; `shoulder` is
/// the height of the part's shoulder above the TCP, m.
pub fn tip(shoulder: f64, side: f64, friction: &Friction) -> Vec<Geom> {
    use notch::*;
    let roof_z = shoulder + ROOF_GAP;
    let cuboid = |name: &str, y: [f64; 2], z: [f64; 2]| Geom {
        name: name.into(),
        shape: Shape::Box { half: Vector3::new(WIDTH, y[1] - y[0], z[1] - z[0]) / 2.0 },
        pose: Pose::translation(0.0, side * (y[0] + y[1]) / 2.0, (z[0] + z[1]) / 2.0),
        friction: friction.finger_plug,
        patch: friction.finger_torsion / friction.finger_plug.max(f64::MIN_POSITIVE),
    };
    vec![
        cuboid("pad", [0.0, PAD_THICKNESS], [roof_z - PAD_HEIGHT, roof_z]),
        cuboid("roof", [-ROOF_DEPTH, PAD_THICKNESS], [roof_z, roof_z + ROOF_THICKNESS]),
    ]
}

/// Radius of gyration of a finger about its centre of mass, m: that of a rod of
/// the length of a printed finger (70 mm).
const GYRATION: f64 = 20.0 * MM;

/// Mass properties of a finger, in the finger frame. Its centre of mass is put
/// on its axis at the RCC, about the middle of a real finger; at the speed of
/// an insertion 2 g do not matter, but a centre far from the joint would couple
/// the six springs in the engine and slow its convergence.
pub fn inertia(finger: &Finger) -> Inertia {
    Inertia {
        mass: finger.mass,
        centre: Point3::new(0.0, 0.0, -finger.rcc),
        moments: Vector3::repeat(finger.mass * GYRATION * GYRATION),
    }
}
