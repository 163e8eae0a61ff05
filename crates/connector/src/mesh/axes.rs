//! Unit and axes of mesh files.

use clap::ValueEnum;
use input::units::MM;
use nalgebra::{Matrix3, Vector3};

/// Unit of length of a mesh file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Unit {
    /// Millimetres
    Mm,
    /// Inches
    In,
    /// Metres
    M,
}

impl Unit {
    /// Returns its length, m.
    pub fn metres(self) -> f64 {
        match self {
            Unit::Mm => MM,
            Unit::In => 25.4 * MM,
            Unit::M => 1.0,
        }
    }
}

/// Direction of insertion in the axes of the files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Along {
    /// Along x
    #[value(name = "x", alias = "+x")]
    PlusX,
    /// Against x
    #[value(name = "-x")]
    MinusX,
    /// Along y
    #[value(name = "y", alias = "+y")]
    PlusY,
    /// Against y
    #[value(name = "-y")]
    MinusY,
    /// Along z
    #[value(name = "z", alias = "+z")]
    PlusZ,
    /// Against z
    #[value(name = "-z")]
    MinusZ,
}

impl Along {
    fn vector(self) -> Vector3<f64> {
        match self {
            Along::PlusX => Vector3::x(),
            Along::MinusX => -Vector3::x(),
            Along::PlusY => Vector3::y(),
            Along::MinusY => -Vector3::y(),
            Along::PlusZ => Vector3::z(),
            Along::MinusZ => -Vector3::z(),
        }
    }

    /// Axes across this direction along which jaws can close, the preferred one first.
    pub fn across(self) -> [Jaws; 2] {
        match self {
            Along::PlusX | Along::MinusX => [Jaws::Y, Jaws::Z],
            Along::PlusY | Along::MinusY => [Jaws::X, Jaws::Z],
            Along::PlusZ | Along::MinusZ => [Jaws::Y, Jaws::X],
        }
    }

    /// Rotation of this direction to -z, and of the jaws' axis, which lies across it, to y.
    pub fn turn(self, jaws: Jaws) -> Matrix3<f64> {
        let (y, z) = (jaws.vector(), -self.vector());
        Matrix3::from_rows(&[y.cross(&z), y, z].map(|row| row.transpose()))
    }
}

/// Axis of the files along which the jaws close.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Jaws {
    /// Along x
    X,
    /// Along y
    Y,
    /// Along z
    Z,
}

impl Jaws {
    fn vector(self) -> Vector3<f64> {
        match self {
            Jaws::X => Vector3::x(),
            Jaws::Y => Vector3::y(),
            Jaws::Z => Vector3::z(),
        }
    }
}

/// Name of a value on the command line.
pub fn value(of: impl ValueEnum) -> String {
    of.to_possible_value().map_or(String::new(), |value| value.get_name().to_owned())
}
