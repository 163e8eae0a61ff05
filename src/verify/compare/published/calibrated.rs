//! The measured fingers as a calibration predicts them, each without its own measurement: a further
//! model beside the experiments. Read from what `optimize calibrate --out` wrote.

use crate::input::published::designs;
use crate::input::space::Design;
use crate::input::stiffness::Measurement;
use crate::verify::compare::published::agreement::deviation_percent;
use crate::verify::compare::statistics::{mean, spearman};
use serde::Deserialize;
use serde_json::{Value, json};

/// A measured finger, predicted without its measurement.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct LeftOutFinger {
    /// Name of the task.
    pub task: String,
    infill_density_percent: f64,
    infill_direction_deg: f64,
    /// Measured range, mm.
    pub measured_mm: f64,
    /// Predicted range, mm.
    pub range_mm: f64,
    /// Lower end of the 80 % interval of a further measurement, mm.
    pub low_mm: f64,
    /// Upper end.
    pub high_mm: f64,
}

/// All of them on one task.
#[derive(Debug, Clone, PartialEq)]
pub struct Calibrated {
    /// Name of the task.
    pub task: String,
    /// The fingers.
    pub fingers: Vec<LeftOutFinger>,
}

impl LeftOutFinger {
    /// The fingers of a `leave_one_out.csv`.
    ///
    /// # Errors
    /// The line that is none.
    pub fn parse(text: &str) -> Result<Vec<Self>, String> {
        let rows = csv::Reader::from_reader(text.as_bytes()).into_deserialize();
        let rows: Result<Vec<Self>, csv::Error> = rows.collect();
        let rows = rows.map_err(|error| error.to_string())?;
        let sound = |one: &&Self| {
            [one.measured_mm, one.range_mm, one.low_mm, one.high_mm].iter().all(|mm| mm.is_finite())
        };
        match rows.iter().find(|one| !sound(one)) {
            Some(one) => Err(format!("a range of {} is no number", one.task)),
            None => Ok(rows),
        }
    }

    fn inside(&self) -> bool {
        (self.low_mm..=self.high_mm).contains(&self.measured_mm)
    }

    fn is(&self, m: &Measurement) -> bool {
        Design::infill(self.infill_density_percent, self.infill_direction_deg)
            == Design::infill(m.density_percent, m.direction_deg)
    }
}

impl Calibrated {
    /// How many lie in their intervals.
    pub fn inside(&self) -> usize {
        self.fingers.iter().filter(|one| one.inside()).count()
    }

    fn pairs(&self) -> Vec<(f64, f64)> {
        self.fingers.iter().map(|one| (one.range_mm, one.measured_mm)).collect()
    }

    fn over(&self, measure: impl Fn(f64, f64) -> f64) -> Option<f64> {
        mean(
            &self
                .pairs()
                .into_iter()
                .map(|(range, bench)| measure(range, bench))
                .collect::<Vec<_>>(),
        )
    }

    /// Mean of `|predicted - measured|`, mm.
    pub fn mean_absolute_error_mm(&self) -> Option<f64> {
        self.over(|range, bench| (range - bench).abs())
    }

    /// Mean of that over what was measured, percent.
    pub fn mean_deviation_percent(&self) -> Option<f64> {
        self.over(deviation_percent)
    }

    /// Rank correlation.
    pub fn spearman(&self) -> Option<f64> {
        spearman(&self.pairs())
    }

    /// Predicted ranges of the published designs in their order.
    pub fn ranges_mm(&self) -> Vec<Option<f64>> {
        let range = |m: &Measurement| self.fingers.iter().find(|one| one.is(m));
        designs().iter().map(|m| range(m).map(|one| one.range_mm)).collect()
    }

    /// An entry of the list `agreement`.
    pub fn json(&self) -> Value {
        json!({
            "task": self.task,
            "model": "calibrated",
            "designs": self.fingers.len(),
            "spearman": self.spearman(),
            "mean_absolute_error_mm": self.mean_absolute_error_mm(),
            "mean_deviation_percent": self.mean_deviation_percent(),
            "failure_match_percent": null,
            "coverage_80_percent": 100.0 * self.inside() as f64 / self.fingers.len().max(1) as f64,
            "ranges_mm": self.ranges_mm(),
        })
    }

    /// A line of the table, as [`models_text`](super::models_text) has them.
    pub fn text(&self) -> String {
        let cell = |value: Option<f64>, digits: usize| {
            value.map_or("-".to_owned(), |value| format!("{value:.digits$}"))
        };
        format!(
            "{:<5} {:<21}{:>8}{:>9}{:>9}{:>9}{:>8}{:>8}\n      {} of {} measured ranges in the 80 % interval\n",
            self.task,
            "calibrated",
            self.fingers.len(),
            cell(self.spearman(), 2),
            cell(self.mean_absolute_error_mm(), 2),
            cell(self.mean_deviation_percent(), 0),
            "-",
            "-",
            self.inside(),
            self.fingers.len()
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const CSV: &str = "task,infill_density_percent,infill_direction_deg,measured_mm,range_mm,low_mm,\
                       high_mm,inside\nket8,10,0,8,6,5,7,false\nket8,20,0,5,5.5,4,6,true\n\
                       ket8,25,0,4,4,3,5,true\n";

    #[test]
    fn a_left_out_finger_is_compared_with_its_measurement() {
        let fingers = LeftOutFinger::parse(CSV).unwrap();
        let found = Calibrated { task: "ket8".to_owned(), fingers };
        let deviation = found.mean_deviation_percent().unwrap();
        assert!((deviation - (25.0 + 10.0) / 3.0).abs() < 1e-9, "{deviation}");
        assert_eq!((found.inside(), found.spearman()), (2, Some(1.0)));
        assert_eq!(found.ranges_mm().into_iter().flatten().count(), 3);
        assert_eq!(found.ranges_mm()[0], Some(6.0));
        assert!(LeftOutFinger::parse("task,range_mm\nket8,3\n").is_err());
        assert!(LeftOutFinger::parse(&CSV.replace(",6,5,7", ",NaN,5,7")).is_err());
    }
}
