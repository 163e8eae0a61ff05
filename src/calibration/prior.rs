//! Unmeasured numbers of a cell, and their bounds: `priors/bench.toml`.

use input::{Check, InputError, read};
use insertion::finger::file::is_shape;
use insertion::space::Scale;
use serde::Deserialize;

#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Priors {
    pub name: String,
    pub description: String,
    #[serde(rename = "parameter")]
    pub parameters: Vec<Parameter>,
}

/// One uncertain number, drawn evenly between its bounds.
#[derive(Debug, Clone, PartialEq, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parameter {
    pub name: String,
    pub sets: Target,
    #[serde(rename = "as")]
    pub way: Way,
    /// Scale on which it is drawn evenly.
    pub scale: Scale,
    pub low: f64,
    pub high: f64,
    pub shared: bool,
    pub source: String,
}

#[derive(Debug, Clone, PartialEq, Eq, Deserialize)]
#[serde(try_from = "String")]
pub enum Target {
    /// A number of the task file, or of the finger file of computed fingers.
    Number(String),
    /// The width of the socket's opening, mm.
    Clearance,
    /// The radius of the edges that lead in, mm, where the task has them sharp.
    Edges,
    /// The chamfer at the socket's opening, mm, where the task has none.
    Chamfer,
    Stiffness,
    Tilting,
    Centre,
    /// All stiffnesses of a robot that is a soft flange.
    Flange,
}

/// The targets that are no path in a task file.
const NAMED: [(&str, Target); 7] = [
    ("task.clearance_mm", Target::Clearance),
    ("task.edge_radius_mm", Target::Edges),
    ("task.opening_chamfer_mm", Target::Chamfer),
    ("finger.stiffness", Target::Stiffness),
    ("finger.rotation_x_nm_per_rad", Target::Tilting),
    ("finger.rcc_mm", Target::Centre),
    ("robot.stiffness_n_per_mm", Target::Flange),
];

#[derive(Debug, Clone, Copy, PartialEq, Eq, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Way {
    Factor,
    Shift,
    /// The bounds are values of the number itself.
    Value,
}

impl TryFrom<String> for Target {
    type Error = String;
    fn try_from(name: String) -> Result<Self, String> {
        if let Some((_, target)) = NAMED.iter().find(|(known, _)| *known == name) {
            return Ok(target.clone());
        }
        if name.starts_with("task.") || is_shape(&name) {
            return Ok(Target::Number(name));
        }
        let known = NAMED.map(|(name, _)| name);
        Err(format!(
            "`{name}` sets nothing; there are {}, and paths in a task or finger file",
            known.join(", ")
        ))
    }
}

impl Target {
    /// What a row of a file calls it.
    pub fn key(&self) -> &str {
        match self {
            Target::Number(path) => path,
            named => NAMED.iter().find(|(_, target)| target == named).map_or("", |(key, _)| *key),
        }
    }
}

impl Parameter {
    /// The value that this share of the prior lies below; `share` in 0 to 1.
    pub fn at(&self, share: f64) -> f64 {
        match self.scale {
            Scale::Linear => self.low + share * (self.high - self.low),
            Scale::Log => self.low * libm::exp(share * libm::log(self.high / self.low)),
        }
    }

    /// A number under this value of the parameter.
    pub fn applied(&self, number: f64, value: f64) -> f64 {
        match self.way {
            Way::Factor => number * value,
            Way::Shift => number + value,
            Way::Value => value,
        }
    }
}

impl Priors {
    pub fn parse(text: &str, file: &str) -> Result<Self, InputError> {
        let priors: Priors = read(text, file)?;
        let all = &priors.parameters;
        let check = Check { file };
        for (i, parameter) in all.iter().enumerate() {
            let Parameter { name, low, high, scale, way, .. } = parameter;
            check.finite(name, *low)?;
            check.finite(name, *high)?;
            if low >= high {
                return check.fail(name, "low must be below high");
            }
            if (*scale == Scale::Log || *way == Way::Factor) && *low <= 0.0 {
                return check.fail(name, "low must be above 0: a factor, or a logarithm");
            }
            let cut = matches!(parameter.sets, Target::Edges | Target::Chamfer);
            if cut && (*way == Way::Factor || *low < 0.0) {
                return check
                    .fail(name, "must be as = \"shift\" from 0 up: a size in place of none");
            }
            if parameter.source.trim().is_empty() {
                return check.fail(name, "source is empty; say where the bounds come from");
            }
            if all[..i].iter().any(|other| other.name == *name || other.sets == parameter.sets) {
                return check
                    .fail(name, "is given twice; each name and each number may stand once");
            }
        }
        Ok(priors)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::shipped::PRIORS;

    #[test]
    fn every_shipped_row_has_bounds_and_a_source() {
        let file = PRIORS[0];
        let priors = Priors::parse(file.text, file.file).unwrap();
        assert!(priors.parameters.len() >= 8);
        for parameter in &priors.parameters {
            assert!((parameter.at(0.0) - parameter.low).abs() < 1e-12, "{}", parameter.name);
            assert!((parameter.at(1.0) / parameter.high - 1.0).abs() < 1e-12, "{}", parameter.name);
        }
        let friction = &priors.parameters[0];
        assert!((friction.applied(0.2, friction.at(0.5)) - 0.2).abs() < 1e-12);
    }

    #[test]
    fn each_bad_row_is_named() {
        let good = PRIORS[0].text;
        for (from, to, word) in [
            ("low = 0.5", "low = 5.0", "below high"),
            ("low = 0.5", "low = -0.5", "above 0"),
            (
                "sets = \"task.edge_radius_mm\"\nas = \"shift\"",
                "sets = \"task.edge_radius_mm\"\nas = \"factor\"",
                "in place of none",
            ),
            ("sets = \"task.friction.plug_socket\"", "sets = \"friction\"", "sets nothing"),
            ("name = \"friction pad-plug\"", "name = \"friction plug-socket\"", "twice"),
            ("\nscale = \"log\"", "\nscale = \"logg\"", "logg"),
        ] {
            let text = good.replacen(from, to, 1);
            let error = Priors::parse(&text, "p.toml").unwrap_err().to_string();
            assert!(error.contains(word) && error.contains("p.toml"), "{error}");
        }
        let text = good.replace("source = \"not", "source = \" \" # ");
        assert!(Priors::parse(&text, "p").unwrap_err().to_string().contains("source is empty"));
    }
}
