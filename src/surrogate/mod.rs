//! From infill to stiffness: models fitted to measured fingers at start-up.

/// A value with its standard deviation, both in the same unit.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Estimate {
    /// Expected value.
    pub mean: f64,
    /// Standard deviation.
    pub sd: f64,
}

/// Predicted stiffness of one finger.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Prediction {
    /// In the compliance direction (y), N/m.
    pub compliance: Estimate,
    /// In the assembly direction (z), N/m.
    pub assembly: Estimate,
    /// Distance to the convex hull of the measured designs, in units of the
    /// measured spans (density span = direction span = 1); 0 inside.
    pub hull_distance: f64,
}

impl Prediction {
    /// Whether the design lies inside the hull of the measured designs.
    pub fn inside_hull(&self) -> bool {
        self.hull_distance == 0.0
    }
}
