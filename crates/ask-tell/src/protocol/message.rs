//! The lines as they are read.

use super::parameter::ParameterLine;
use serde::Deserialize;
use serde::de::DeserializeOwned;
use serde_json::Value;
use std::collections::BTreeMap;

/// Most points of one batch, and most that can be asked at once.
pub(super) const LARGEST_BATCH: usize = 10_000;

/// The first line.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Header {
    pub parameters: Vec<ParameterLine>,
    pub optimizer: String,
    pub seed: u64,
    pub direction: Direction,
    /// Points the optimizer proposes at a time; `None`: as many as each ask asks for.
    pub batch: Option<usize>,
}

/// Which values are better.
#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
pub(super) enum Direction {
    Minimize,
    Maximize,
}

impl Direction {
    /// A value as the optimizers want it, larger is better; and back again.
    pub fn flip(self, value: f64) -> f64 {
        match self {
            Direction::Minimize => -value,
            Direction::Maximize => value,
        }
    }
}

/// Most bytes of a line: every line of fewer than 10000 points is far shorter.
pub const LONGEST_LINE: u64 = 4 << 20;
/// Most numbers that one ask, or the batch that it is taken from, may have.
pub(super) const MOST_NUMBERS: usize = 1_000_000;

/// The value of a point that was never asked.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct KnownValue {
    pub values: BTreeMap<String, f64>,
    /// Its value; `null` if the evaluation failed. It may not be left out.
    #[serde(deserialize_with = "Option::deserialize")]
    pub value: Option<f64>,
}

/// The value of one point.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct PointValue {
    pub id: u64,
    /// Its value; `null` if the evaluation failed. It may not be left out.
    #[serde(deserialize_with = "Option::deserialize")]
    pub value: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct AskLine {
    ask: usize,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct TellLine {
    tell: Vec<Value>,
}

/// A line that was understood.
pub(super) enum Line {
    Header(Header),
    Ask(usize),
    Tell(Vec<PointValue>, Vec<KnownValue>),
}

impl Line {
    pub fn parse(text: &str) -> Result<Line, String> {
        let value: Value =
            serde_json::from_str(text).map_err(|error| format!("not a line of JSON: {error}"))?;
        let has = |key| value.get(key).is_some();
        if has("parameters") {
            objects(&value, "parameters")?;
            read(value, "parameters").map(Line::Header)
        } else if has("ask") {
            read(value, "ask").map(|line: AskLine| Line::Ask(line.ask))
        } else if has("tell") {
            objects(&value, "tell")?;
            let line: TellLine = read(value, "tell")?;
            let (mut asked, mut known) = (Vec::new(), Vec::new());
            for entry in line.tell {
                match entry.get("values") {
                    None => asked.push(read(entry, "tell")?),
                    Some(_) => known.push(read(entry, "tell")?),
                }
            }
            Ok(Line::Tell(asked, known))
        } else {
            Err("not a known line; a line is {\"parameters\":[..],..}, {\"ask\":n} or \
                 {\"tell\":[..]}"
                .to_owned())
        }
    }
}

/// A list in place of an object would be read field by field.
fn objects(line: &Value, kind: &str) -> Result<(), String> {
    let entries = line.get(kind).and_then(Value::as_array);
    match entries.is_none_or(|entries| entries.iter().all(Value::is_object)) {
        true => Ok(()),
        false => Err(format!("in the `{kind}` line: every entry must be an object, in braces")),
    }
}

fn read<T: DeserializeOwned>(value: Value, kind: &str) -> Result<T, String> {
    serde_json::from_value(value).map_err(|error| format!("in the `{kind}` line: {error}"))
}
