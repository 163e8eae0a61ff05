//! The extreme designs of a space, which stand for all of it in checks.

use super::{Design, Parameter};

impl Parameter {
    /// The smallest and the largest value, and the one nearest to zero.
    pub(crate) fn extremes(&self) -> Vec<f64> {
        let last = self.levels() - 1;
        let zero = (-self.low / self.step).round().clamp(0.0, f64::from(last)) as u32;
        let mut levels = vec![0, zero, last];
        levels.sort_unstable();
        levels.dedup();
        levels.into_iter().map(|level| self.value(level)).collect()
    }
}

/// All combinations of extreme values; a parameter that would make them above `most` is left out.
pub(crate) fn corners<'a>(
    parameters: impl IntoIterator<Item = &'a Parameter>,
    most: usize,
) -> Vec<Design> {
    let mut designs = vec![Design::default()];
    for parameter in parameters {
        let values = parameter.extremes();
        if values.len() <= most / designs.len() {
            let with = |mut design: Design, value| {
                design.0.insert(parameter.key.clone(), value);
                design
            };
            let each = |design: &Design| values.iter().map(|&v| with(design.clone(), v)).collect();
            designs = designs.iter().flat_map::<Vec<Design>, _>(each).collect();
        }
    }
    designs
}
