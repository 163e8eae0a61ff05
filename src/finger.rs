//! One printed finger as the paper models it: six springs about a remote
//! centre of compliance (RCC), Sec. "Stiffness model" and Table "Simulation Inputs".

use crate::units::{GRAM, MM, N_PER_MM};

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
}

impl Finger {
    /// A finger of the given compliance and assembly stiffness (N/m, per
    /// finger), everything else as in the paper.
    pub fn new(compliance: f64, assembly: f64) -> Self {
        Finger {
            compliance,
            assembly,
            depth: 100.0 * N_PER_MM,
            rotation: [1.0, 10.0, 10.0],
            rcc: 21.0 * MM,
            mass: 2.0 * GRAM,
            damping: 10.0,
            rotational_damping: 1.0,
        }
    }
}
