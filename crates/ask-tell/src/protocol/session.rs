//! A conversation: what has been said, and the answer to the next line.

use super::AskTellError;
use super::batch::Batch;
use super::message::{
    Direction, Header, KnownValue, LARGEST_BATCH, Line, MOST_NUMBERS, PointValue, Told,
};
use super::parameter::Parameter;
use crate::GridPoint;
use crate::{Grid, Observation, Optimizer, OptimizerKind, StopReason, build};
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// The best point told so far.
#[derive(Debug, Clone, PartialEq)]
pub struct Best {
    /// Its id; `None` of one that was never asked.
    pub id: Option<u64>,
    /// The point.
    pub point: GridPoint,
    /// Its value as it was told.
    pub value: f64,
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
        let answer = self.take(line);
        answer
            .unwrap_or_else(|error| Some(json!({"error": error.to_string()})))
            .map(|v| v.to_string())
    }

    /// The answer to a line that is longer than [`LONGEST_LINE`](super::LONGEST_LINE) bytes.
    pub fn too_long() -> String {
        json!({"error": AskTellError::TooLong.to_string()}).to_string()
    }

    fn take(&mut self, line: &str) -> Result<Option<Value>, AskTellError> {
        match (Line::parse(line)?, &mut self.begun) {
            (Line::Header(header), None) => {
                self.begun = Some(Begun::new(&header)?);
                Ok(None)
            }
            (Line::Header(_), Some(_)) => Err(AskTellError::BegunAlready),
            (_, None) => Err(AskTellError::NotBegun),
            (Line::Ask(n), Some(begun)) => begun.ask(n).map(Some),
            (Line::Tell(told), Some(begun)) => begun.tell(&told).map(Some),
        }
    }
}

fn few_enough(points: usize, parameters: usize) -> Result<(), AskTellError> {
    match points.saturating_mul(parameters) {
        numbers if numbers <= MOST_NUMBERS => Ok(()),
        _ => Err(AskTellError::TooManyNumbers { points, parameters }),
    }
}

impl Begun {
    fn new(header: &Header) -> Result<Self, AskTellError> {
        if header.parameters.is_empty() {
            return Err(AskTellError::NoParameters);
        }
        let mut names = BTreeSet::new();
        if let Some(twice) = header.parameters.iter().find(|p| !names.insert(&p.name)) {
            let (name, problem) = (twice.name.clone(), "is given twice; each name may stand once");
            return Err(AskTellError::Parameter { name, problem });
        }
        if let Some(size) = header.batch.filter(|size| !(1..=LARGEST_BATCH).contains(size)) {
            return Err(AskTellError::Batch(size));
        }
        let axes = header.parameters.iter().map(Parameter::new).collect::<Result<Vec<_>, _>>()?;
        let kind: OptimizerKind = header.optimizer.parse()?;
        let (found, most) = (axes.len(), kind.most_parameters());
        if found > most {
            return Err(AskTellError::TooManyParameters { found, optimizer: kind, most });
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

    fn ask(&mut self, n: usize) -> Result<Value, AskTellError> {
        if n > LARGEST_BATCH {
            return Err(AskTellError::AskedTooMany(n));
        }
        few_enough(n, self.axes.len())?;
        let mut asked = self.batch.hand_out(n);
        if asked.is_empty() && n > 0 {
            if !self.batch.complete() {
                return Err(AskTellError::Untold(self.batch.untold()));
            }
            let points = self.optimizer.ask(self.size.unwrap_or(n));
            self.batch = self.batch.next(points);
            self.seen.extend(self.batch.points().map(|(id, point)| (point.clone(), Some(id))));
            asked = self.batch.hand_out(n);
        }
        let one = |(id, point): (u64, GridPoint)| json!({"id": id, "values": self.values(&point)});
        Ok(json!({"asked": asked.into_iter().map(one).collect::<Vec<_>>()}))
    }

    fn tell(&mut self, told: &[Told]) -> Result<Value, AskTellError> {
        let asked = told.iter().filter_map(|told| match told {
            Told::Asked(asked) => Some(asked.clone()),
            Told::Known(_) => None,
        });
        let asked: Vec<PointValue> = asked.collect();
        self.batch.check(&asked)?;
        let known = self.known(told)?;
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
        Ok(json!({"told": told.len(), "best": best, "stop": self.stop()}))
    }

    /// The points told by their values, which must be new.
    fn known(&self, told: &[Told]) -> Result<Vec<(GridPoint, Option<f64>)>, AskTellError> {
        let mut found: BTreeSet<GridPoint> = BTreeSet::new();
        let mut known = Vec::new();
        for entry in told {
            let Told::Known(KnownValue { values, value }) = entry else { continue };
            let point = self.point(values)?;
            match self.seen.get(&point) {
                Some(Some(id)) => {
                    return Err(AskTellError::KnownAlready(format!("is asked as id {id}")));
                }
                None if found.insert(point.clone()) => known.push((point, *value)),
                _ => return Err(AskTellError::KnownAlready("is known".to_owned())),
            }
        }
        Ok(known)
    }

    /// The grid point of values by name.
    fn point(&self, values: &BTreeMap<String, f64>) -> Result<GridPoint, AskTellError> {
        let fail =
            |name: &str, problem| Err(AskTellError::KnownValues { name: name.to_owned(), problem });
        let named = |name: &str| self.axes.iter().any(|axis| axis.name == name);
        if values.len() > self.axes.len()
            && let Some(name) = values.keys().find(|name| !named(name))
        {
            return fail(name, "is no parameter");
        }
        let mut levels = Vec::with_capacity(self.axes.len());
        for axis in &self.axes {
            match values.get(&axis.name).map(|&value| axis.level(value)) {
                None => return fail(&axis.name, "is missing"),
                Some(None) => return fail(&axis.name, "must be low + k step, up to high"),
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
        values.map(|(axis, &level)| (axis.name.clone(), json!(axis.value(level)))).collect()
    }
}
