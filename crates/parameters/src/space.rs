//! Search spaces of discrete design variables, and the designs in them.

pub use crate::numbers::{DENSITY as DENSITY_KEY, DIRECTION as DIRECTION_KEY};
use crate::numbers::{Kind, out_of_bounds};
use crate::{Parameter, Path, Scale};
use ask_tell::GridPoint;
use input::{Check, InputError, read};
use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;

fn is_linear(scale: &Scale) -> bool {
    *scale == Scale::Linear
}

/// Design variable with discrete values: level `k`, from 0, is `low + k * step`, on a log scale `low * step^k`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Variable {
    /// Path of the number that it sets (`infill_density_percent`).
    pub key: Path,
    /// Smallest value, in the unit of the key.
    pub low: f64,
    /// Largest value, in the unit of the key.
    pub high: f64,
    /// Difference between neighbouring values; on a log scale their ratio.
    pub step: f64,
    /// Spacing of the values.
    #[serde(default, skip_serializing_if = "is_linear")]
    pub scale: Scale,
    /// Source of the bounds; may be empty.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub source: String,
}

impl Variable {
    fn problem(&self) -> Option<String> {
        let Variable { low, high, step, .. } = *self;
        let (linear, steps) = (is_linear(&self.scale), self.steps());
        let wide = linear && high > low && step > (high - low) * (1.0 + 1e-9);
        let uneven = (steps - steps.round()).abs() > 1e-6 || steps > 1e6;
        let finite = [low, high, step].iter().all(|v| v.is_finite());
        let outside = [low, high]
            .into_iter()
            .find_map(|bound| out_of_bounds(&self.key, bound, self.key.bounds()));
        let log = "on a log scale step must be above 1 and low above 0";
        let settable = matches!(self.key.kind(), Kind::Infill | Kind::File | Kind::Finger);
        let unset =
            "cannot be set by a design; accepted are numbers of infill, task file and finger";
        let problems = [
            (!settable, unset),
            (!finite, "low, high and step must be finite numbers"),
            (low > high, "low must not be above high"),
            (linear && step <= 0.0, "step must be above 0"),
            (!linear && (step <= 1.0 || low <= 0.0), log),
            (outside.is_some(), outside.as_deref().unwrap_or_default()),
            (step < FINEST_STEP, "step must be 1e-6 or more"),
            (wide, "step must not be larger than high - low"),
            (uneven, "high - low must be a whole number of steps, at most 1e6"),
        ];
        problems.into_iter().find(|(wrong, _)| *wrong).map(|(_, problem)| problem.to_owned())
    }

    /// Returns the number of levels.
    pub fn levels(&self) -> u32 {
        self.steps().round() as u32 + 1
    }

    fn steps(&self) -> f64 {
        self.steps_to(self.high)
    }

    fn steps_to(&self, value: f64) -> f64 {
        match self.scale {
            Scale::Linear => (value - self.low) / self.step,
            Scale::Log => libm::log(value / self.low) / libm::log(self.step),
        }
    }

    /// Returns the relative position of a value between the bounds, 0 to 1, linear on either scale; 0.5 if the bounds
    /// are equal.
    pub fn share(&self, value: f64) -> f64 {
        let span = self.high - self.low;
        if span > 0.0 { (value - self.low) / span } else { 0.5 }
    }

    /// Returns the level with the nearest value, on a log scale the nearest in ratio.
    pub fn nearest(&self, value: f64) -> u32 {
        self.steps_to(value).round().clamp(0.0, f64::from(self.levels() - 1)) as u32
    }

    /// Returns the value of a level, rounded to 9 decimals, on a log scale to 4 significant digits, so that it prints
    /// as written in the file.
    pub fn value(&self, level: u32) -> f64 {
        match self.scale {
            Scale::Linear => ((self.low + f64::from(level) * self.step) * 1e9).round() / 1e9,
            Scale::Log => {
                let share = f64::from(level) / self.steps().round().max(1.0);
                let value = self.low * libm::pow(self.high / self.low, share);
                format!("{value:.3e}").parse().unwrap_or(value)
            }
        }
    }

    /// Converts to a parameter with a uniform distribution between the bounds, even if the variable has a log scale.
    pub fn parameter(&self) -> Parameter {
        let source = self.source.clone();
        Parameter { source, ..Parameter::uniform(self.key.clone(), [self.low, self.high]) }
    }

    /// Returns the smallest value, the one nearest to zero and the largest, without duplicates.
    pub fn extremes(&self) -> Vec<f64> {
        let last = self.levels() - 1;
        let zero = (-self.low / self.step).round().clamp(0.0, f64::from(last)) as u32;
        let mut levels = vec![0, zero, last];
        levels.dedup();
        levels.into_iter().map(|level| self.value(level)).collect()
    }
}

/// Returns the designs with all combinations of [`Variable::extremes`]. A variable that would make them more than
/// `most` is left out.
pub fn corners<'a>(parameters: impl IntoIterator<Item = &'a Variable>, most: usize) -> Vec<Design> {
    let mut designs = vec![Design::default()];
    for parameter in parameters {
        let values = parameter.extremes();
        if values.len() <= most / designs.len() {
            let pairs = designs.iter().flat_map(|design| values.iter().map(move |v| (design, *v)));
            designs = pairs.map(|(design, value)| design.with(&parameter.key, value)).collect();
        }
    }
    designs
}

/// Validated search space.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Space {
    /// Name, as recorded in study folders.
    pub name: String,
    /// One-line description for lists.
    pub description: String,
    /// The variables in file order, which is the order of the axes of the unit cube.
    #[serde(rename = "parameter")]
    pub parameters: Vec<Variable>,
}

/// Design: values by key, in the units of the keys.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Design(pub BTreeMap<String, f64>);

/// Returns whether a path is that of a number of the task, which can change without printing a new finger.
pub fn is_of_task(path: &str) -> bool {
    path.starts_with("task.")
}

impl Design {
    /// Returns whether the design sets numbers of the task.
    pub fn changes_task(&self) -> bool {
        self.0.keys().any(|key| is_of_task(key))
    }

    /// Returns a design with infill density (percent) and direction (degrees).
    pub fn infill(density_percent: f64, direction_deg: f64) -> Self {
        Design::default().with(DENSITY_KEY, density_percent).with(DIRECTION_KEY, direction_deg)
    }

    /// Returns the design with a key set to a value, in the unit of the key.
    pub fn with(&self, key: &str, value: f64) -> Self {
        let mut design = self.clone();
        design.0.insert(key.to_owned(), value);
        design
    }

    /// Returns the value of a key, in the unit of the key.
    pub fn get(&self, key: &str) -> Option<f64> {
        self.0.get(key).copied()
    }

    /// Formats the design for display: `infill density 20 %, infill direction 10°`.
    pub fn labelled(&self) -> String {
        let value = |(key, value): (&String, &f64)| {
            let (name, unit) = crate::label(key);
            format!("{name} {value}{unit}")
        };
        self.0.iter().map(value).collect::<Vec<_>>().join(", ")
    }
}

impl std::fmt::Display for Design {
    /// `infill_density_percent = 20, infill_direction_deg = 10`
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let values: Vec<String> = self.0.iter().map(|(k, v)| format!("{k} = {v}")).collect();
        f.write_str(&values.join(", "))
    }
}

const MAX_PARAMETERS: usize = 100;
/// Smallest step: a thousand times the rounding of values.
const FINEST_STEP: f64 = 1e-6;

impl Space {
    /// Returns whether its designs set numbers of the task.
    pub fn changes_task(&self) -> bool {
        self.parameters.iter().any(|parameter| is_of_task(&parameter.key))
    }

    /// Returns the position of a design in the unit cube; a value that it lacks counts as the smallest.
    pub fn shares(&self, design: &Design) -> Vec<f64> {
        let share = |p: &Variable| p.share(design.get(&p.key).unwrap_or(p.low));
        self.parameters.iter().map(share).collect()
    }

    /// Parses and checks a space; `file` is named in errors.
    ///
    /// # Errors
    /// If the text cannot be parsed, or a value is invalid.
    pub fn parse(text: &str, file: &str) -> Result<Self, InputError> {
        let space: Space = read(text, file)?;
        space.check(file)?;
        Ok(space)
    }

    /// Checks a space that was read as a table of a file; `file` is named in errors.
    ///
    /// # Errors
    /// If a value is invalid.
    pub fn check(&self, file: &str) -> Result<(), InputError> {
        let fail = |key: &str, problem: &str| Check { file }.fail(key, problem);
        if !(1..=MAX_PARAMETERS).contains(&self.parameters.len()) {
            let problem = format!("a space needs 1 to {MAX_PARAMETERS} tables [[parameter]]");
            return fail("parameter", &problem);
        }
        for (i, parameter) in self.parameters.iter().enumerate() {
            let key = &parameter.key;
            if self.parameters[..i].iter().any(|other| other.key == *key) {
                return fail(key, "is given twice; give each key once");
            }
            if let Some(problem) = parameter.problem() {
                return fail(key, &problem);
            }
        }
        Ok(())
    }

    /// Returns the number of levels per axis, which define the optimizer's grid.
    pub fn levels(&self) -> Vec<u32> {
        self.parameters.iter().map(Variable::levels).collect()
    }

    /// Returns the grid point nearest to a design.
    pub fn point(&self, design: &Design) -> GridPoint {
        let level = |p: &Variable| p.nearest(design.get(&p.key).unwrap_or(p.low));
        GridPoint(self.parameters.iter().map(level).collect())
    }

    /// Returns the design at a grid point (one valid level per parameter).
    pub fn design(&self, point: &GridPoint) -> Design {
        let values = self.parameters.iter().zip(&point.0);
        Design(values.map(|(p, &level)| (p.key.to_string(), p.value(level))).collect())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    const GOOD: &str = r#"
name = "s"
description = "d"
[[parameter]]
key = "infill_density_percent"
low = 10.0
high = 30.0
step = 1.0
source = "paper"
"#;

    #[test]
    fn a_linear_scale_holds_its_ends_and_finds_the_nearest_level() {
        // A source is not needed.
        let space = Space::parse(&GOOD.replace("source = \"paper\"\n", ""), "s.toml").unwrap();
        assert_eq!(space.levels(), vec![21]);
        assert_eq!(space.design(&GridPoint(vec![20])).get(DENSITY_KEY), Some(30.0));
        let parameter = &space.parameters[0];
        assert_eq!([0.0, 12.4, 30.0].map(|value| parameter.nearest(value)), [0, 2, 20]);
    }

    #[test]
    fn a_log_scale_has_equal_factors_and_holds_its_ends() {
        let text = GOOD.replace("infill_density_percent", "task.grip.force_n");
        let text = text.replace("low = 10.0", "low = 0.5").replace("high = 30.0", "high = 4.0");
        let text = text.replace("step = 1.0", "step = 1.189207115\nscale = 'log'");
        let space = Space::parse(&text, "s.toml").unwrap();
        let parameter = &space.parameters[0];
        assert_eq!(parameter.levels(), 13);
        let values = [0, 1, 4, 8, 12].map(|level| parameter.value(level));
        assert_eq!(values, [0.5, 0.5946, 1.0, 2.0, 4.0]);
        assert_eq!([0.1, 1.03, 2.0, 9.0].map(|value| parameter.nearest(value)), [0, 4, 8, 12]);
        let error = Space::parse(&text.replace("low = 0.5", "low = 0.0"), "s.toml").unwrap_err();
        assert!(error.to_string().contains("log scale"), "{error}");
        let again: Space = toml::from_str(&toml::to_string(&space).unwrap()).unwrap();
        assert_eq!(again, space);
    }

    #[test]
    fn keys_that_no_design_sets_are_rejected_and_an_unknown_key_names_the_nearest() {
        for (key, words) in [
            ("task.friction.plug_sokcet", "line 5, column 7"),
            ("task.friction.plug_sokcet", "did you mean `task.friction.plug_socket`?"),
            ("robot.mass_kg", "s.toml: robot.mass_kg: cannot be set by a design"),
            ("task.clearance_mm", "cannot be set by a design"),
        ] {
            let error = Space::parse(&GOOD.replace(DENSITY_KEY, key), "s.toml").unwrap_err();
            assert!(error.to_string().contains(words), "{error}");
        }
    }

    proptest! {
        /// Each accepted variable has a limited number of levels, and each level is the nearest to its value.
        #[test]
        fn accepted_levels_are_few_and_found_again(
            low in -1e3..1e3f64,
            span in 0..9u32,
            exponent in -7..7i32,
            log in any::<bool>(),
            share in 0.0..=1.0f64,
        ) {
            let step = libm::pow(10.0, f64::from(exponent)) + f64::from(u32::from(log));
            let high = if log { low * libm::pow(step, f64::from(span)) } else { low + f64::from(span) * step };
            let (scale, source) = (if log { Scale::Log } else { Scale::Linear }, String::new());
            let key = Path::new("task.strategy.start_mm.x").unwrap();
            let parameter = Variable { key, low, high, step, scale, source };
            let (name, description) = (String::new(), String::new());
            let space = Space { name, description, parameters: vec![parameter] };
            if space.check("s.toml").is_ok() {
                let parameter = &space.parameters[0];
                prop_assert!((1..=1_000_001).contains(&parameter.levels()));
                let level = (share * f64::from(parameter.levels() - 1)) as u32;
                // Values are rounded to nine decimals, on a log scale to four digits.
                let nearest = parameter.nearest(parameter.value(level));
                prop_assert!(log || nearest == level);
                prop_assert!(nearest < parameter.levels());
            }
        }
    }

    #[test]
    fn each_bad_field_is_named() {
        for (from, to, word) in [
            ("low = 10.0", "low = nan", "finite"),
            ("low = 10.0", "low = 40.0", "above high"),
            ("step = 1.0", "step = -1.0", "above 0"),
            ("step = 1.0", "step = 3.0", "whole number"),
            ("step = 1.0", "step = 1e9", "larger than high - low"),
            ("step = 1.0", "step = 1e-7", "1e-6 or more"),
            ("low = 10.0", "low = 0.0", "must lie in 1 .. 100"),
            ("low = 10.0", "low = -1000.0", "must lie in 1 .. 100"),
            ("high = 30.0", "high = 900.0", "must lie in 1 .. 100"),
            ("step = 1.0", "stepp = 1.0", "stepp"),
        ] {
            let error = Space::parse(&GOOD.replace(from, to), "s.toml").unwrap_err().to_string();
            assert!(error.contains(word) && error.contains("s.toml"), "{error}");
        }
    }
}
