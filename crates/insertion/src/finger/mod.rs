//! Model of a printed finger: six springs about a remote centre of compliance (RCC), a pad and a roof; as in the paper
//! (Sec. "Stiffness model", Table "Simulation Inputs"), or computed from the ribs of the finger.

pub mod computed;
pub mod file;
pub mod model;

use crate::task::finger::{Coupling, FingerModel, Rcc};
use contact::scene::{Geom, Inertia, Pose, Shape, Spring, Springs};
use input::units::{GRAM, MM, N_PER_MM};
use nalgebra::{Matrix6, Point3, Vector3};
use parameters::numbers::{RCC_KEY, TILTING_KEY};

/// One finger, in SI units; both fingers of a gripper are equal.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Finger {
    /// Stiffness in y at the RCC (compliance direction, in which the jaws close), N/m.
    pub compliance: f64,
    /// Stiffness in z at the RCC (assembly direction), N/m.
    pub assembly: f64,
    /// Stiffness in x, across the finger's width, N/m.
    pub depth: f64,
    /// Rotational stiffness about x, y and z through the RCC, N m/rad.
    pub rotation: [f64; 3],
    /// Distance of the RCC below the TCP, towards the plug's tip, m.
    pub rcc: f64,
    /// Distance of the RCC in front of the pad's face, into the part, m.
    pub ahead: f64,
    /// Pad that presses the part, and roof above it.
    pub pad: Pad,
    /// Mass of one finger, kg.
    pub mass: f64,
    /// Translational damping of the springs, N s/m.
    pub damping: f64,
    /// Rotational damping of the springs, N m s/rad.
    pub rotational_damping: f64,
    /// Coupling of the springs; the paper has none.
    pub coupling: Option<Coupling>,
}

/// Rotational stiffness about x, N m/rad: the upper end of the range in the paper's Table "Simulation
/// Inputs" (0.5 .. 2); the paper used 1. See `docs/notes/calibration.md`.
const TILTING: f64 = 2.0;

impl Finger {
    /// Returns the number with a path (`finger.rcc_mm`) and the SI value of its unit. Compliance and assembly stiffness
    /// have no paths, since the infill determines them.
    pub fn number(&mut self, path: &str) -> Option<(&mut f64, f64)> {
        let [x, y, z] = &mut self.rotation;
        Some(match path {
            RCC_KEY => (&mut self.rcc, MM),
            "finger.depth_n_per_mm" => (&mut self.depth, N_PER_MM),
            TILTING_KEY => (x, 1.0),
            "finger.rotation_y_nm_per_rad" => (y, 1.0),
            "finger.rotation_z_nm_per_rad" => (z, 1.0),
            "finger.mass_g" => (&mut self.mass, GRAM),
            "finger.damping_n_s_per_m" => (&mut self.damping, 1.0),
            "finger.rotational_damping_nm_s_per_rad" => (&mut self.rotational_damping, 1.0),
            _ => return None,
        })
    }

    /// Returns the finger of the paper with the given stiffness in the compliance and assembly directions, N/m.
    pub fn new(compliance: f64, assembly: f64) -> Self {
        Finger {
            compliance,
            assembly,
            depth: 100.0 * N_PER_MM,
            rotation: [TILTING, 10.0, 10.0],
            rcc: Rcc::PUBLISHED_DISTANCE,
            ahead: 0.0,
            pad: Pad::PUBLISHED,
            mass: 2.0 * GRAM,
            damping: 10.0,
            rotational_damping: 0.02,
            coupling: None,
        }
    }

    /// Returns the finger with the finger model of a task file, for an infill in the given direction, degrees.
    pub fn with_model(self, model: &FingerModel, direction_deg: f64) -> Self {
        let rcc = model.rcc.map_or(Rcc::PUBLISHED_DISTANCE, |rcc| rcc.at(direction_deg));
        Finger { rcc, coupling: model.coupling, ..self }
    }

    /// Returns the six springs about the RCC: translations x, y, z, rotations x, y, z.
    pub fn springs(&self) -> [Spring; 6] {
        let translation = |k: f64| Spring::new(k, self.damping);
        let rotation = |k: f64| Spring::new(k, self.rotational_damping);
        let [x, y, z] = [self.depth, self.compliance, self.assembly].map(translation);
        let [rx, ry, rz] = self.rotation.map(rotation);
        [x, y, z, rx, ry, rz]
    }

    /// Returns the position of the RCC in the finger frame, m; `side` as in [`Pad::geoms`].
    pub fn centre(&self, side: f64) -> Point3<f64> {
        Point3::new(0.0, -side * self.ahead, -self.rcc)
    }

    /// Returns the springs between finger and jaw at the RCC; `side` as in [`Pad::geoms`].
    pub fn jaw_springs(&self, side: f64) -> Springs {
        let springs = self.springs();
        let Some(coupling) = &self.coupling else { return Springs::Axes(springs.map(Some)) };
        Springs::Coupled {
            stiffness: coupling.stiffness(springs.map(|spring| spring.stiffness), side),
            damping: Matrix6::from_diagonal(&springs.map(|spring| spring.damping).into()),
        }
    }
}

/// Notch of a finger: a vertical pad that presses the part, and a roof above the pad that rests on the part's shoulder
/// and carries the assembly force. Dimensions in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pad {
    /// Width of pad and roof in x.
    pub width: f64,
    /// Height of the pad, downward from the roof.
    pub height: f64,
    /// Overhang of the roof over the part in y.
    pub roof: f64,
}

impl Pad {
    /// Pad of the published simulation.
    pub const PUBLISHED: Pad = Pad { width: 12.0 * MM, height: 8.4 * MM, roof: 2.5 * MM };

    /// Returns the height of the middle of the pad above the TCP, m; `shoulder` as in [`Pad::geoms`].
    pub fn middle(&self, shoulder: f64) -> f64 {
        shoulder + ROOF_GAP - self.height / 2.0
    }

    /// Returns pad and roof in the finger frame: origin on the pad's face at the height of
    /// the TCP, `side` -1 for the finger at -y, +1 for the one at +y; `shoulder` is
    /// the height of the part's shoulder above the TCP, m.
    pub fn geoms(&self, shoulder: f64, side: f64) -> Vec<Geom> {
        let roof_z = shoulder + ROOF_GAP;
        let cuboid = |name: &str, y: [f64; 2], z: [f64; 2]| Geom {
            name: name.into(),
            shape: Shape::Box { half: Vector3::new(self.width, y[1] - y[0], z[1] - z[0]) / 2.0 },
            pose: Pose::translation(0.0, side * (y[0] + y[1]) / 2.0, (z[0] + z[1]) / 2.0),
            friction: None,
        };
        vec![
            cuboid("pad", [0.0, PAD_THICKNESS], [roof_z - self.height, roof_z]),
            cuboid("roof", [-self.roof, PAD_THICKNESS], [roof_z, roof_z + ROOF_THICKNESS]),
        ]
    }
}

/// Thickness of the pad behind its face, m; the results hardly depend on it.
const PAD_THICKNESS: f64 = 4.0 * MM;
/// Thickness of the roof, m; the results hardly depend on it.
const ROOF_THICKNESS: f64 = 3.0 * MM;
/// Gap between roof and shoulder at the grasp, m; the first push on the part closes it.
pub const ROOF_GAP: f64 = 0.05 * MM;

/// Radius of gyration of a finger about its centre of mass, m: that of a rod of 70 mm.
const GYRATION: f64 = 20.0 * MM;

/// Returns the mass properties of a finger, in its frame. The centre of mass is placed at the RCC: a finger of 2 g has
/// negligible inertia, but a centre of mass far from the joint would couple the springs in the engine and slow its
/// convergence. `side` as in [`Pad::geoms`].
pub fn inertia(finger: &Finger, side: f64) -> Inertia {
    let moments = Vector3::repeat(finger.mass * GYRATION * GYRATION);
    Inertia { mass: finger.mass, centre: finger.centre(side), moments }
}

#[cfg(test)]
mod tests {
    use super::*;
    use contact::scene::{Spring, Springs};

    #[test]
    fn the_default_is_the_papers_finger() {
        let finger = Finger::new(2e3, 4e4).with_model(&FingerModel::default(), f64::NAN);
        assert_eq!(finger, Finger::new(2e3, 4e4));
        assert!(matches!(finger.jaw_springs(1.0), Springs::Axes(_)));
    }

    /// Turned by 180 degrees about z, a push in y that turned about z turns the other way.
    #[test]
    fn the_opposite_finger_is_the_same_part_turned() {
        let coupling = Coupling::new([(1, 2, 0.3), (1, 5, 0.2), (0, 4, 0.1)]).unwrap();
        let springs = [1e5, 2e3, 4e4, 1.0, 10.0, 10.0];
        let [here, there] = [-1.0, 1.0].map(|side| coupling.stiffness(springs, side));
        assert_eq!(here[(1, 2)], 0.3 * (2e3_f64 * 4e4).sqrt());
        assert_eq!((there[(1, 2)], there[(1, 5)]), (-here[(1, 2)], -here[(1, 5)]));
        assert_eq!((there[(0, 4)], there[(1, 1)]), (here[(0, 4)], 2e3));
        assert_eq!(here, here.transpose());
    }

    #[test]
    fn coupling_that_would_push_a_finger_away_is_none() {
        assert_eq!(Coupling::new([(1, 2, 1.0)]), None);
        assert_eq!(Coupling::new([(0, 1, 0.8), (1, 2, 0.8), (0, 2, -0.8)]), None);
        assert!(Coupling::new([(0, 1, 0.8), (1, 2, 0.8), (0, 2, 0.8)]).is_some());
    }

    #[test]
    fn a_coupled_finger_keeps_the_damping_of_its_springs() {
        let coupling = Coupling::new([(1, 3, 0.5)]);
        let finger = Finger { coupling, ..Finger::new(2e3, 4e4) };
        let Springs::Coupled { stiffness, damping: found } = finger.jaw_springs(-1.0) else {
            panic!("coupled")
        };
        let damping = finger.springs().map(|Spring { damping, .. }| damping);
        assert_eq!(found, Matrix6::from_diagonal(&damping.into()));
        assert_eq!(stiffness[(1, 3)], 0.5 * (2e3 * finger.rotation[0]).sqrt());
    }
}
