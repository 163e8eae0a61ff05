//! Position of the start in its window.

use super::words::{mm, rounded};
use serde::Serialize;

/// Share of the range that a well-centred start has at least on either side.
const MIN_SHARE: f64 = 0.25;

/// Position of the taught start in the window of a finger.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Start {
    /// Negative end of the window, mm from the start.
    pub negative_mm: f64,
    /// Positive end of the window, mm from the start.
    pub positive_mm: f64,
    /// Whether the window is so small on one side that the start should be taught again.
    pub one_sided: bool,
    /// Distance along y from the start to the middle of the window, mm.
    pub to_middle_mm: f64,
    /// The start to teach instead; `None` if the start is well centred.
    pub advice: Option<String>,
}

impl Start {
    /// Returns the start in this window; `None` if it does not contain the start.
    pub fn of([negative_mm, positive_mm]: [f64; 2]) -> Option<Self> {
        let range_mm = positive_mm - negative_mm;
        if !(negative_mm <= 0.0 && positive_mm >= 0.0 && range_mm > 0.0) {
            return None;
        }
        let one_sided = positive_mm.min(-negative_mm) < MIN_SHARE * range_mm;
        // To micrometres, without the error of adding tenths.
        let to_middle_mm = rounded((negative_mm + positive_mm) / 2.0, 3);
        let side = if to_middle_mm < 0.0 { "-y" } else { "+y" };
        let (by, half) = (mm(to_middle_mm.abs()), mm(range_mm / 2.0));
        let advice = one_sided
            .then(|| format!("teach the start {by} further to {side}: then {half} on either side"));
        Some(Start { negative_mm, positive_mm, one_sided, to_middle_mm, advice })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_start_at_the_edge_of_its_window_is_moved_to_the_middle() {
        let edge = Start::of([-3.2, 0.0]).unwrap();
        let advice = "teach the start 1.6 mm further to -y: then 1.6 mm on either side";
        assert_eq!(edge.advice.as_deref(), Some(advice));
        // Exactly a quarter is enough.
        assert_eq!(Start::of([-3.0, 1.0]).unwrap().advice, None);
        assert!(Start::of([-0.9, 3.1]).unwrap().one_sided);
        assert_eq!(Start::of([0.0, 0.0]), None, "no window");
        // In floating point the half of -3.3 + 0.4 is -1.4500000000000002.
        for (low, high, middle) in [(-33_i8, 4_i8, "-1.45"), (-33, 1, "-1.6"), (-1, 2, "0.05")] {
            let window = [low, high].map(|tenths| f64::from(tenths) * 0.1);
            assert_eq!(Start::of(window).unwrap().to_middle_mm.to_string(), middle);
        }
    }
}
