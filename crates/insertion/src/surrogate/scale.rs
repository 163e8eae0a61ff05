//! The computed stiffness times one number: all that one measured finger can say.

use super::{Estimate, Fitted, Measured};
use crate::stiffness::{Axis, Infill};

/// How the logarithms of measured / computed stiffness scatter over the eleven shipped designs:
/// what is expected of another material before its own scatter is known.
pub(super) const SCATTER: [(Axis, f64); 2] = [(Axis::Compliance, 0.17), (Axis::Assembly, 0.30)];
pub(super) const FREEDOM: f64 = 10.0;

#[derive(Debug)]
pub(super) struct Scale {
    log: f64,
    sd: f64,
    count: f64,
}

/// Fits ratios of measured and computed stiffness; `None` without any.
pub(super) fn fit(axis: Axis, ratios: &Measured) -> Option<Scale> {
    let logs = ratios.targets().mapv(f64::ln);
    let log = logs.mean()?;
    let (_, scatter) = SCATTER.into_iter().find(|(of, _)| *of == axis)?;
    let count = logs.len() as f64;
    let squares = logs.mapv(|each| (each - log).powi(2)).sum() + FREEDOM * scatter * scatter;
    Some(Scale { log, sd: (squares / (FREEDOM + count - 1.0)).sqrt(), count })
}

impl Fitted for Scale {
    fn predict(&self, _: Infill) -> Estimate {
        let mean = self.log.exp();
        Estimate { mean, sd: mean * self.sd * (1.0 + 1.0 / self.count).sqrt() }
    }

    fn describe(&self) -> String {
        let error_percent = 100.0 * self.sd / self.count.sqrt();
        format!("computed stiffness x {:.3}, ± {error_percent:.0} %", self.log.exp())
    }
}
