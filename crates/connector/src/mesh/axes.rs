//! Unit and axes of mesh files.

use input::units::MM;
pub use insertion::value_name as value;

/// Unit of length of a mesh file.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum Unit {
    /// Millimetres
    Mm,
    /// Centimetres
    Cm,
    /// Inches
    In,
    /// Metres
    M,
}

impl Unit {
    /// Returns the length of the unit, m.
    pub fn metres(self) -> f64 {
        match self {
            Unit::Mm => MM,
            Unit::Cm => 10.0 * MM,
            Unit::In => 25.4 * MM,
            Unit::M => 1.0,
        }
    }
}

/// Direction in which the plug is inserted, in the axes of the mesh files.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum InsertionAxis {
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

/// Axis of the mesh files along which the jaws close.
#[derive(Debug, Clone, Copy, PartialEq, Eq, clap::ValueEnum)]
pub enum JawAxis {
    /// Along x
    X,
    /// Along y
    Y,
    /// Along z
    Z,
}
