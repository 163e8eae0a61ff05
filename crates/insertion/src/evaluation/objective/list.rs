//! One objective or several, as written: `range,peak-force`.

use super::Measure;
use serde::{Deserialize, Serialize};
use std::fmt;
use std::str::FromStr;

/// Most objectives: a front of more is no help in choosing.
const MOST: usize = 3;

/// One to three different measures to be optimized, in the order given.
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(into = "String", try_from = "String")]
pub struct Objectives(Vec<Measure>);

impl Objectives {
    /// A single objective.
    pub fn of(measure: Measure) -> Self {
        Objectives(vec![measure])
    }

    /// All objectives, at least one.
    pub fn measures(&self) -> &[Measure] {
        &self.0
    }

    /// The first one: what plots show.
    pub fn first(&self) -> Measure {
        self.0[0]
    }

    /// The only one, `None` if there are several.
    pub fn single(&self) -> Option<Measure> {
        (self.0.len() == 1).then_some(self.0[0])
    }

    /// A key for each in tables and JSON: `objective_mm`; `objective_1_mm`, `objective_2_n`.
    pub fn keys(&self) -> Vec<String> {
        match self.single() {
            Some(measure) => vec![format!("objective_{}", measure.key())],
            None => {
                let numbered = (1..).zip(&self.0);
                numbered.map(|(n, measure)| format!("objective_{n}_{}", measure.key())).collect()
            }
        }
    }

    /// Values with their names and units: `range 4.7 mm, peak-force 5.0 N`.
    pub fn show(&self, values: &[f64]) -> String {
        let shown = self.0.iter().zip(values);
        let words: Vec<String> =
            shown.map(|(measure, &value)| format!("{measure} {}", measure.show(value))).collect();
        words.join(", ")
    }
}

impl fmt::Display for Objectives {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&self.0.iter().map(|measure| measure.name()).collect::<Vec<_>>().join(","))
    }
}

impl FromStr for Objectives {
    type Err = String;
    fn from_str(text: &str) -> Result<Self, String> {
        let all: Vec<Measure> =
            text.split(',').map(|name| name.trim().parse()).collect::<Result<_, _>>()?;
        if let Some(twice) = all.iter().enumerate().find(|(i, measure)| all[..*i].contains(measure))
        {
            return Err(format!("{} is given twice; give each objective once", twice.1));
        }
        match all.len() {
            ..=MOST => Ok(Objectives(all)),
            count => Err(format!("there are {count} objectives; give at most {MOST}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lists_read_back_and_have_keys_with_units() {
        let two: Objectives = "range, peak-force".parse().unwrap();
        assert_eq!((two.first(), two.single()), (Measure::Range, None));
        assert_eq!(two.to_string().parse(), Ok(two.clone()));
        assert_eq!(two.keys(), ["objective_1_mm", "objective_2_n"]);
        assert_eq!(two.show(&[4.0, 5.25]), "range 4.0 mm, peak-force 5.2 N");
        assert_eq!(Objectives::of(Measure::SuccessRate).keys(), ["objective_share"]);
        assert!("range,".parse::<Objectives>().unwrap_err().contains("``"));
    }
}
