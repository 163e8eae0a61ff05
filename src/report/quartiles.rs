//! Quartiles over the seeds of an optimizer.

use serde::Serialize;

/// Quartiles of studies; `None` where one is not known: a value that was not there yet, an
/// evaluation that never came.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct Quartiles {
    /// Lower quartile.
    pub q25: Option<f64>,
    /// Median.
    pub median: Option<f64>,
    /// Upper quartile.
    pub q75: Option<f64>,
}

impl Quartiles {
    /// By linear interpolation between the sorted values; `None` where that meets an infinity.
    pub(super) fn of(mut values: Vec<f64>) -> Self {
        values.sort_by(f64::total_cmp);
        let quantile = |share: f64| {
            let place = share * values.len().checked_sub(1)? as f64;
            let (low, high) = (values[place.floor() as usize], values[place.ceil() as usize]);
            let part = place - place.floor();
            let value = if part == 0.0 { low } else { low + part * (high - low) };
            value.is_finite().then_some(value)
        };
        Quartiles { q25: quantile(0.25), median: quantile(0.5), q75: quantile(0.75) }
    }

    /// Lower quartile, median and upper quartile.
    pub fn all(&self) -> [Option<f64>; 3] {
        [self.q25, self.median, self.q75]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_interpolate_and_do_not_invent() {
        let five = vec![5.0, 1.0, 3.0, 2.0, 4.0];
        let quartiles = |values| Quartiles::of(values).all();
        assert_eq!(quartiles(five), [Some(2.0), Some(3.0), Some(4.0)]);
        assert_eq!(quartiles(vec![1.0, 2.0]), [Some(1.25), Some(1.5), Some(1.75)]);
        assert_eq!(quartiles(vec![7.0, f64::INFINITY]), [None; 3]);
        let late = vec![7.0, 9.0, f64::INFINITY];
        assert_eq!(quartiles(late), [Some(8.0), Some(9.0), None]);
        assert_eq!(quartiles(vec![]), [None; 3]);
    }
}
