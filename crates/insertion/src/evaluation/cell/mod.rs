//! Numbers of a cell that a task file cannot know: bounds of them (`priors/bench.toml`), or what was
//! identified from its logs (`cell.toml`), with the robot it was identified with.

mod applied;

use super::{normal_quantile, normal_share};
use crate::finger::file::is_shape;
use crate::robot::Robot;
use crate::space::Scale;
use input::{Check, InputError, read};
use serde::{Deserialize, Serialize};

/// A file of such numbers, as it is read and written.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Priors {
    /// Name of the bounds, or of the cell.
    pub name: String,
    /// One line on it.
    pub description: String,
    /// Task whose rows those with `shared = false` are; `None`: each task has its own.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub task: Option<String>,
    /// Robot file of the cell, whole; checked by [`Priors::checked`], read by [`Priors::robot`].
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub robot: Option<toml::Table>,
    /// The numbers.
    #[serde(rename = "parameter")]
    pub parameters: Vec<Parameter>,
}

/// One uncertain number: drawn evenly between its bounds or, with value and deviation, normally and
/// cut off there.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Parameter {
    /// In words: `friction plug-socket`.
    pub name: String,
    /// The number.
    pub sets: Target,
    /// How it is set.
    #[serde(rename = "as")]
    pub way: Way,
    /// Scale on which it is drawn evenly, or normally.
    pub scale: Scale,
    /// Its median before it is cut off.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub value: Option<f64>,
    /// Its standard deviation; on a log scale `sd / value` is that of the logarithm.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub sd: Option<f64>,
    /// Lower bound.
    pub low: f64,
    /// Upper bound.
    pub high: f64,
    /// Whether it is one number for all tasks.
    pub shared: bool,
    /// Where value or bounds come from.
    pub source: String,
}

/// What a row sets; in files its [`key`](Target::key).
#[derive(Debug, Clone, PartialEq, Eq, Serialize, Deserialize)]
#[serde(try_from = "String", into = "String")]
pub enum Target {
    /// A number of the task file, or of the finger file of computed fingers.
    Number(String),
    /// Added to the width of the socket's opening, mm.
    Clearance,
    /// The radius of the edges that lead in, mm, where the task has them sharp.
    Edges,
    /// The chamfer at the socket's opening, mm, where the task has none.
    Chamfer,
    /// Compliance and assembly stiffness of a finger.
    Stiffness,
    /// Rotational spring of a finger about x, N m/rad.
    Tilting,
    /// Distance of a finger's remote centre, mm.
    Centre,
    /// Stiffness along x of a robot that is a soft flange, N/mm; its others go in proportion.
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

/// What becomes of the number that the task, the finger or the robot file has.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "kebab-case")]
pub enum Way {
    /// It is multiplied.
    Factor,
    /// It is added to.
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

impl From<Target> for String {
    fn from(target: Target) -> String {
        target.key().to_owned()
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
    /// The value that this share of the distribution lies below; `share` in 0 to 1.
    pub fn at(&self, share: f64) -> f64 {
        let Parameter { low, high, .. } = *self;
        match (self.scale, self.value.zip(self.sd)) {
            (Scale::Linear, None) => low + share * (high - low),
            (Scale::Log, None) => low * libm::exp(share * libm::log(high / low)),
            (_, Some((value, 0.0))) => value,
            (Scale::Linear, Some((value, sd))) => {
                let [from, to] = [low, high].map(|bound| (bound - value) / sd);
                (value + sd * cut_normal(share, from, to)).clamp(low, high)
            }
            (Scale::Log, Some((value, sd))) => {
                let sd = sd / value;
                let [from, to] = [low, high].map(|bound| libm::log(bound / value) / sd);
                (value * libm::exp(sd * cut_normal(share, from, to))).clamp(low, high)
            }
        }
    }

    /// The value that it has where it is not drawn: its own, else the middle of its bounds.
    pub fn middle(&self) -> f64 {
        self.value.unwrap_or_else(|| self.at(0.5))
    }

    /// A number under this value of the parameter.
    pub fn applied(&self, number: f64, value: f64) -> f64 {
        match self.way {
            Way::Factor => number * value,
            Way::Shift => number + value,
            Way::Value => value,
        }
    }

    fn check(&self, check: Check<'_>) -> Result<(), InputError> {
        let Parameter { name, low, high, scale, way, .. } = self;
        check.finite(name, *low)?;
        check.finite(name, *high)?;
        if low >= high {
            return check.fail(name, "low must be below high");
        }
        if (*scale == Scale::Log || *way == Way::Factor) && *low <= 0.0 {
            return check.fail(name, "low must be above 0: a factor, or a logarithm");
        }
        let cut = matches!(self.sets, Target::Edges | Target::Chamfer);
        if cut && (*way == Way::Factor || *low < 0.0) {
            return check.fail(name, "must be as = \"shift\" from 0 up: a size in place of none");
        }
        if self.sets == Target::Stiffness && *way != Way::Factor {
            return check.fail(name, "must be as = \"factor\": it sets two stiffnesses");
        }
        let spring = matches!(self.sets, Target::Tilting | Target::Flange);
        if spring && (*way == Way::Shift || *low <= 0.0) {
            return check.fail(name, "must be as = \"factor\" or \"value\", and low above 0");
        }
        if self.source.trim().is_empty() {
            return check.fail(name, "source is empty; say where the bounds come from");
        }
        let (value, sd) = match (self.value, self.sd) {
            (None, None) => return Ok(()),
            (Some(value), Some(sd)) => (value, sd),
            _ => return check.fail(name, "value and sd go together: give both, or neither"),
        };
        check.finite(name, value)?;
        check.not_negative(name, sd)?;
        match (*low..=*high).contains(&value) {
            true => Ok(()),
            false => check.fail(name, format!("value must lie in {low} .. {high}")),
        }
    }
}

/// The standard normal number that this share of those between two others lies below.
fn cut_normal(share: f64, from: f64, to: f64) -> f64 {
    let [below, above] = [from, to].map(normal_share);
    normal_quantile(below + share * (above - below))
}

impl Priors {
    /// Reads and checks such a file; `file` is named in errors.
    ///
    /// # Errors
    /// If the text is not such a file, or as of [`Priors::checked`].
    pub fn parse(text: &str, file: &str) -> Result<Self, InputError> {
        read::<Priors>(text, file)?.checked(file)
    }

    /// The same, if every row and the robot can be used; `file` is named in errors.
    ///
    /// # Errors
    /// If one cannot: with its name and what would be right.
    pub fn checked(self, file: &str) -> Result<Self, InputError> {
        let (all, check) = (&self.parameters, Check { file });
        for (i, parameter) in all.iter().enumerate() {
            let name = &parameter.name;
            parameter.check(check)?;
            if all[..i].iter().any(|other| other.name == *name || other.sets == parameter.sets) {
                return check
                    .fail(name, "is given twice; each name and each number may stand once");
            }
        }
        if let Some(robot) = self.robot(file)? {
            for row in all {
                if !row.shared && !row.sets.key().starts_with("task.") {
                    return check.fail(&row.name, "belongs to no one task: give shared = true");
                }
                if !row.fits(&robot) {
                    return check.fail(&row.name, "goes with a robot of kind = \"servo\"");
                }
            }
        }
        Ok(self)
    }

    /// Its robot as its table has it, if it holds one; `file` is named in errors.
    ///
    /// # Errors
    /// If the table is no robot file.
    pub fn robot(&self, file: &str) -> Result<Option<Robot>, InputError> {
        let robot = |text: String| Robot::parse(&text, &format!("{file}: [robot]"));
        self.robot_text().map(robot).transpose()
    }

    /// The text of its robot's file, if it holds one.
    pub fn robot_text(&self) -> Option<String> {
        self.robot.as_ref().map(toml::Table::to_string)
    }

    /// Its rows that apply to a task.
    pub fn of<'a>(&'a self, task: &'a str) -> impl Iterator<Item = &'a Parameter> {
        let own = self.task.as_ref().is_none_or(|own| own == task);
        self.parameters.iter().filter(move |row| row.shared || own)
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

    /// Quartiles of the normal are 0.674490 deviations from its middle.
    #[test]
    fn value_and_deviation_make_it_normal_within_its_bounds() {
        let bench = Priors::parse(PRIORS[0].text, PRIORS[0].file).unwrap();
        let with = |scale, sd| {
            let row =
                Parameter { scale, value: Some(1.2), sd: Some(sd), ..bench.parameters[0].clone() };
            Priors { parameters: vec![row], ..bench.clone() }
                .checked("p")
                .unwrap()
                .parameters
                .remove(0)
        };
        let (linear, log) = (with(Scale::Linear, 0.03), with(Scale::Log, 0.03));
        assert!((linear.at(0.25) - (1.2 - 0.03 * 0.674_490)).abs() < 1e-6);
        assert!((log.at(0.75) - 1.2 * libm::exp(0.03 / 1.2 * 0.674_490)).abs() < 1e-6);
        for row in
            [linear, log, with(Scale::Linear, 3.0), with(Scale::Log, 3.0), with(Scale::Log, 0.0)]
        {
            let all: Vec<f64> = (0..=20).map(|i| row.at(f64::from(i) / 20.0)).collect();
            assert!(all.is_sorted() && (0.5..=2.0).contains(&all[0]) && all[20] <= 2.0, "{all:?}");
            assert_eq!(row.middle(), 1.2);
        }
        let wide = with(Scale::Linear, 1e6);
        assert!((wide.at(0.25) - 0.875).abs() < 1e-6, "all but even: {}", wide.at(0.25));
    }

    #[test]
    fn a_cell_is_read_as_it_is_written() {
        let servo = input::shipped::ROBOTS.iter().find(|robot| robot.name == "servo").unwrap();
        let bench = Priors::parse(PRIORS[0].text, PRIORS[0].file).unwrap();
        let mut cell = Priors {
            task: Some("usb".to_owned()),
            robot: Some(servo.text.parse().unwrap()),
            ..bench
        };
        (cell.parameters[0].value, cell.parameters[0].sd) = (Some(0.9), Some(0.1));
        let text = toml::to_string(&cell).unwrap();
        assert_eq!(Priors::parse(&text, "cell.toml").unwrap(), cell);
        assert_eq!(cell.robot("cell.toml").unwrap(), Some(crate::fixtures::robot("servo")));
        assert_eq!(cell.of("usb").count(), cell.parameters.len());
        assert!(cell.of("ket8").all(|row| row.shared));
        cell.robot = Some(servo.text.replace("servo\"", "rigid\"").parse().unwrap());
        assert!(cell.checked("c").unwrap_err().to_string().contains("[robot]"));
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
            ("\nlow = 0.5", "\nlow = 0.5\nvalue = 1.0", "go together"),
            ("\nlow = 0.5", "\nlow = 0.5\nvalue = 9.0\nsd = 1.0", "must lie in 0.5 .. 2"),
            ("\nlow = 0.5", "\nlow = 0.5\nvalue = 1.0\nsd = -1.0", "0 or above"),
            ("\nlow = 0.5", "\nlow = 0.5\nvalue = nan\nsd = 1.0", "NaN"),
            ("[[parameter]]", "[robot]\nname = \"r\"\n[[parameter]]", "[robot]"),
        ] {
            let text = good.replacen(from, to, 1);
            let error = Priors::parse(&text, "p.toml").unwrap_err().to_string();
            assert!(error.contains(word) && error.contains("p.toml"), "{error}");
        }
        let text = good.replace("source = \"not", "source = \" \" # ");
        assert!(Priors::parse(&text, "p").unwrap_err().to_string().contains("source is empty"));
    }
}
