//! Messages of a session.

use super::parameter::Parameter;
use crate::OptimizerKind;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use std::collections::BTreeMap;

/// Longest accepted line in bytes; a line of 10000 points is far shorter.
pub const MAX_LINE_BYTES: u64 = 4 << 20;
/// Largest number of points of a batch or an ask.
const MAX_POINTS: usize = 10_000;
/// Largest number of parameter values of a batch or an ask.
const MAX_NUMBERS: usize = 1_000_000;

/// First line: the problem.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Problem {
    pub parameters: Vec<Parameter>,
    optimizer: String,
    pub seed: u64,
    pub direction: Direction,
    /// Number of points per batch; if omitted, every `ask` is a batch.
    pub batch: Option<usize>,
}

/// Direction of optimization.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Direction {
    Minimize,
    Maximize,
}

impl Direction {
    /// Converts an objective value to a merit (larger is better).
    pub fn merit(self, value: f64) -> f64 {
        if matches!(self, Direction::Minimize) { -value } else { value }
    }
}

impl Problem {
    /// Checks the problem and returns its optimizer.
    pub fn check(&self) -> Result<OptimizerKind, String> {
        let count = self.parameters.len();
        if count == 0 {
            return Err("parameters: the list is empty; at least one is required".to_owned());
        }
        for (i, parameter) in self.parameters.iter().enumerate() {
            let name = &parameter.name;
            if self.parameters[..i].iter().any(|other| other.name == *name) {
                return Err(format!("parameter `{name}`: is given twice; names must differ"));
            }
            parameter.check().map_err(|problem| format!("parameter `{name}`: {problem}"))?;
        }
        let kind: OptimizerKind =
            self.optimizer.parse().map_err(|error| format!("optimizer: {error}"))?;
        let most = kind.max_parameters();
        if count > most {
            return Err(format!("parameters: {count} are given; {kind} takes {most} at most"));
        }
        if self.batch == Some(0) {
            return Err(format!("batch: is 0; accepted: 1 to {MAX_POINTS}"));
        }
        check_count("batch", self.batch.unwrap_or(1), count)?;
        Ok(kind)
    }
}

/// Checks the number of points of a batch or an ask.
pub(super) fn check_count(key: &str, points: usize, parameters: usize) -> Result<(), String> {
    if points <= MAX_POINTS && points * parameters <= MAX_NUMBERS {
        return Ok(());
    }
    Err(format!(
        "{key}: {points} points of {parameters} parameters; accepted: up to {MAX_POINTS} points \
         and {MAX_NUMBERS} numbers at once"
    ))
}

/// Result of a proposed point (`id`) or of a point that the client evaluated without a proposal (`values`).
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PointResult {
    pub id: Option<usize>,
    pub values: Option<BTreeMap<String, f64>>,
    /// `null` if the evaluation failed. Required.
    #[serde(deserialize_with = "Option::deserialize")]
    pub value: Option<f64>,
}

/// Best result so far.
#[derive(Serialize)]
pub(super) struct Best {
    /// `None` for a point that was not proposed.
    pub id: Option<usize>,
    pub values: Map<String, Value>,
    pub value: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AskLine {
    ask: usize,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TellLine {
    tell: Vec<PointResult>,
}

/// Parsed message.
pub(super) enum Line {
    Problem(Problem),
    Ask(usize),
    Tell(Vec<PointResult>),
}

impl Line {
    /// Parses a line of JSON.
    pub fn parse(text: &str) -> Result<Line, String> {
        let value: Value =
            serde_json::from_str(text).map_err(|error| format!("not valid JSON: {error}"))?;
        let key = ["parameters", "ask", "tell"].into_iter().find(|key| value.get(key).is_some());
        match key {
            Some("parameters") => read(value, "parameters").map(Line::Problem),
            Some("ask") => read(value, "ask").map(|line: AskLine| Line::Ask(line.ask)),
            Some(_) => read(value, "tell").map(|line: TellLine| Line::Tell(line.tell)),
            None => Err("unknown message; accepted: {\"parameters\":[..],..}, {\"ask\":n} and \
                         {\"tell\":[..]}"
                .to_owned()),
        }
    }
}

fn read<T: DeserializeOwned>(line: Value, key: &str) -> Result<T, String> {
    // Serde would read an array in place of an object field by field.
    if line[key].as_array().is_some_and(|entries| !entries.iter().all(Value::is_object)) {
        return Err(format!("in the `{key}` line: every entry must be an object, in braces"));
    }
    serde_json::from_value(line).map_err(|error| format!("in the `{key}` line: {error}"))
}
