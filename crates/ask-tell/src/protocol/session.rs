//! A conversation: what has been said, and the answer to the next line.

use super::batch::Batch;
use super::message::{
    Direction, Header, KnownValue, LARGEST_BATCH, LONGEST_LINE, Line, MOST_NUMBERS, PointValue,
};
use super::parameter::Parameter;
use crate::{Grid, GridPoint, Observation, Optimizer, OptimizerKind, StopReason, build};
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// The best point told so far.
struct Best {
    /// `None` of one that was never asked.
    id: Option<u64>,
    point: GridPoint,
    /// As it was told.
    value: f64,
}

/// A conversation with one optimizer, begun or not.
#[derive(Default)]
pub struct Session {
    begun: Option<Begun>,
}

struct Begun {
    axes: Vec<Parameter>,
    direction: Direction,
    /// Points proposed at a time; `None`: as many as are asked.
    size: Option<usize>,
    optimizer: Box<dyn Optimizer + Send>,
    batch: Batch,
    best: Option<Best>,
    /// The points that were asked or are to be, with their ids, and those told by their values.
    seen: BTreeMap<GridPoint, Option<u64>>,
    /// Told by their values while a batch was open: the optimizer learns of them after it.
    waiting: Vec<Observation>,
}

impl Session {
    /// One that waits for its first line.
    pub fn new() -> Self {
        Session::default()
    }

    /// The answer to a line, itself a line of JSON without its end; the first line, if it is
    /// good, has none. A line answered with an `error` has changed nothing.
    pub fn answer(&mut self, line: &str) -> Option<String> {
        let answer = self.take(line).unwrap_or_else(|error| Some(json!({"error": error})));
        answer.map(|answer| answer.to_string())
    }

    /// The answer to a line that is longer than [`LONGEST_LINE`] bytes.
    pub fn too_long() -> String {
        let error = format!("the line is longer than {LONGEST_LINE} bytes, the most of a line");
        json!({"error": error}).to_string()
    }

    fn take(&mut self, line: &str) -> Result<Option<Value>, String> {
        match (Line::parse(line)?, &mut self.begun) {
            (Line::Header(header), None) => {
                self.begun = Some(Begun::new(header)?);
                Ok(None)
            }
            (Line::Header(_), Some(_)) => {
                Err("the parameters are given already; for others start another process".to_owned())
            }
            (_, None) => Err("the first line must be {\"parameters\":[..],\
                \"optimizer\":..,\"seed\":..,\"direction\":..}"
                .to_owned()),
            (Line::Ask(n), Some(begun)) => begun.ask(n).map(Some),
            (Line::Tell(asked, known), Some(begun)) => begun.tell(asked, known).map(Some),
        }
    }
}

fn few_enough(points: usize, parameters: usize) -> Result<(), String> {
    match points.saturating_mul(parameters) {
        numbers if numbers <= MOST_NUMBERS => Ok(()),
        _ => Err(format!(
            "{points} points of {parameters} parameters are more than {MOST_NUMBERS} numbers, the \
             most at once"
        )),
    }
}

impl Begun {
    fn new(header: Header) -> Result<Self, String> {
        if header.parameters.is_empty() {
            return Err("parameters: is empty; there must be at least one".to_owned());
        }
        let mut names = BTreeSet::new();
        if let Some(twice) = header.parameters.iter().find(|p| !names.insert(&p.name)) {
            let name = &twice.name;
            return Err(format!("parameter `{name}`: is given twice; each name may stand once"));
        }
        if let Some(size) = header.batch.filter(|size| !(1..=LARGEST_BATCH).contains(size)) {
            return Err(format!("batch: {size} is not between 1 and {LARGEST_BATCH}"));
        }
        let axes =
            header.parameters.into_iter().map(Parameter::new).collect::<Result<Vec<_>, _>>()?;
        let kind: OptimizerKind =
            header.optimizer.parse().map_err(|error| format!("optimizer: {error}"))?;
        let (found, most) = (axes.len(), kind.most_parameters());
        if found > most {
            return Err(format!("parameters: there are {found}; {kind} takes {most} at most"));
        }
        few_enough(header.batch.unwrap_or(1), found)?;
        let grid = Grid::new(axes.iter().map(Parameter::levels).collect());
        Ok(Begun {
            axes,
            direction: header.direction,
            size: header.batch,
            optimizer: build(kind, grid, header.seed),
            batch: Batch::default(),
            best: None,
            seen: BTreeMap::new(),
            waiting: Vec::new(),
        })
    }

    fn ask(&mut self, n: usize) -> Result<Value, String> {
        if n > LARGEST_BATCH {
            return Err(format!(
                "ask: {n} is more than {LARGEST_BATCH}, the most that can be asked at once"
            ));
        }
        few_enough(n, self.axes.len())?;
        let mut asked = self.batch.hand_out(n);
        if asked.is_empty() && n > 0 {
            if !self.batch.complete() {
                let ids = self.batch.untold();
                return Err(format!(
                    "ask: tell the values of {ids} first (null for one that failed)"
                ));
            }
            let points = self.optimizer.ask(self.size.unwrap_or(n));
            self.batch = self.batch.next(points);
            self.seen.extend(self.batch.points().map(|(id, point)| (point.clone(), Some(id))));
            asked = self.batch.hand_out(n);
        }
        let one = |(id, point): (u64, GridPoint)| json!({"id": id, "values": self.values(&point)});
        Ok(json!({"asked": asked.into_iter().map(one).collect::<Vec<_>>()}))
    }

    fn tell(&mut self, asked: Vec<PointValue>, known: Vec<KnownValue>) -> Result<Value, String> {
        let count = asked.len() + known.len();
        self.batch.check(&asked)?;
        let known = self.known(known)?;
        let was_open = !self.batch.complete();
        for (point, value) in known {
            self.keep_best(None, &point, value);
            self.seen.insert(point.clone(), None);
            let value = value.map(|v| self.direction.flip(v));
            self.waiting.push(Observation::new(point, value));
        }
        for PointValue { id, value } in asked {
            let point = self.batch.keep(id, value.map(|v| self.direction.flip(v))).clone();
            self.keep_best(Some(id), &point, value);
        }
        if was_open && self.batch.complete() {
            self.optimizer.tell(&self.batch.observations());
        }
        if self.batch.complete() && !self.waiting.is_empty() {
            self.optimizer.tell(&std::mem::take(&mut self.waiting));
        }
        let best = self.best.as_ref().map(
            |best| json!({"id": best.id, "values": self.values(&best.point), "value": best.value}),
        );
        Ok(json!({"told": count, "best": best, "stop": self.stop()}))
    }

    /// The points told by their values, which must be new.
    fn known(&self, told: Vec<KnownValue>) -> Result<Vec<(GridPoint, Option<f64>)>, String> {
        let mut found: BTreeSet<GridPoint> = BTreeSet::new();
        let mut known = Vec::new();
        for KnownValue { values, value } in told {
            let point = self.point(&values)?;
            let seen = match self.seen.get(&point) {
                Some(Some(id)) => format!("asked as id {id}"),
                None if found.insert(point.clone()) => {
                    known.push((point, value));
                    continue;
                }
                _ => "known".to_owned(),
            };
            return Err(format!("tell: a point is told by its values though it is {seen}"));
        }
        Ok(known)
    }

    /// The grid point of values by name.
    fn point(&self, values: &BTreeMap<String, f64>) -> Result<GridPoint, String> {
        let fail = |name: &str, problem| Err(format!("tell: `{name}` {problem}"));
        let named = |name: &str| self.axes.iter().any(|axis| axis.line.name == name);
        if values.len() > self.axes.len()
            && let Some(name) = values.keys().find(|name| !named(name))
        {
            return fail(name, "is no parameter");
        }
        let mut levels = Vec::with_capacity(self.axes.len());
        for axis in &self.axes {
            match values.get(&axis.line.name).map(|&value| axis.level(value)) {
                None => return fail(&axis.line.name, "is missing"),
                Some(None) => return fail(&axis.line.name, "must be low + k step, up to high"),
                Some(Some(level)) => levels.push(level),
            }
        }
        Ok(GridPoint(levels))
    }

    /// Keeps the best: of equals the one with the lower id, and one that was there before.
    fn keep_best(&mut self, id: Option<u64>, point: &GridPoint, value: Option<f64>) {
        let Some(value) = value else { return };
        let better = |best: &Best| {
            let earlier = id.zip(best.id).is_some_and(|(id, best)| id < best);
            let (value, known) = (self.direction.flip(value), self.direction.flip(best.value));
            value > known || (value == known && earlier)
        };
        if self.best.as_ref().is_none_or(better) {
            self.best = Some(Best { id, point: point.clone(), value });
        }
    }

    /// Why nothing more can be asked, once all that was asked is told.
    fn stop(&self) -> Option<&'static str> {
        let stop = self.optimizer.stop().filter(|_| self.batch.complete());
        stop.map(|reason| match reason {
            StopReason::GridExhausted => "space_exhausted",
            StopReason::Converged => "converged",
        })
    }

    fn values(&self, point: &GridPoint) -> Map<String, Value> {
        let values = self.axes.iter().zip(&point.0);
        values.map(|(axis, &level)| (axis.line.name.clone(), json!(axis.value(level)))).collect()
    }
}
