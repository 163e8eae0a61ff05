//! A conversation: what has been said, and the answer to the next line.

use super::AskTellError;
use super::batch::Batch;
use super::message::{Direction, Header, LARGEST_BATCH, Line, PointValue};
use super::parameter::Parameter;
use crate::input::space::GridPoint;
use crate::optimizer::{Grid, Optimizer, OptimizerKind, StopReason, build};
use serde_json::{Map, Value, json};

/// The best point told so far.
#[derive(Debug, Clone, PartialEq)]
pub struct Best {
    /// Its id.
    pub id: u64,
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

impl Begun {
    fn new(header: &Header) -> Result<Self, AskTellError> {
        if header.parameters.is_empty() {
            return Err(AskTellError::NoParameters);
        }
        for (i, p) in header.parameters.iter().enumerate() {
            if header.parameters[..i].iter().any(|other| other.name == p.name) {
                let (name, problem) = (p.name.clone(), "is given twice; each name may stand once");
                return Err(AskTellError::Parameter { name, problem });
            }
        }
        if let Some(size) = header.batch.filter(|size| !(1..=LARGEST_BATCH).contains(size)) {
            return Err(AskTellError::Batch(size));
        }
        let axes = header.parameters.iter().map(Parameter::new).collect::<Result<Vec<_>, _>>()?;
        let kind: OptimizerKind = header.optimizer.parse()?;
        let grid = Grid::new(axes.iter().map(Parameter::levels).collect());
        Ok(Begun {
            axes,
            direction: header.direction,
            size: header.batch,
            optimizer: build(kind, grid, header.seed),
            batch: Batch::default(),
            best: None,
        })
    }

    fn ask(&mut self, n: usize) -> Result<Value, AskTellError> {
        if n > LARGEST_BATCH {
            return Err(AskTellError::AskedTooMany(n));
        }
        let mut asked = self.batch.hand_out(n);
        if asked.is_empty() && n > 0 {
            if !self.batch.complete() {
                return Err(AskTellError::Untold(self.batch.untold()));
            }
            let points = self.optimizer.ask(self.size.unwrap_or(n));
            self.batch = self.batch.next(points);
            asked = self.batch.hand_out(n);
        }
        let one = |(id, point): (u64, GridPoint)| json!({"id": id, "values": self.values(&point)});
        Ok(json!({"asked": asked.into_iter().map(one).collect::<Vec<_>>()}))
    }

    fn tell(&mut self, told: &[PointValue]) -> Result<Value, AskTellError> {
        self.batch.check(told)?;
        let was_open = !self.batch.complete();
        for &PointValue { id, value } in told {
            let point = self.batch.keep(id, value.map(|v| self.direction.flip(v)));
            let better = |value: f64, best: &Best| {
                let (value, best_value) =
                    (self.direction.flip(value), self.direction.flip(best.value));
                value > best_value || (value == best_value && id < best.id)
            };
            if let Some(value) = value
                && self.best.as_ref().is_none_or(|best| better(value, best))
            {
                self.best = Some(Best { id, point: point.clone(), value });
            }
        }
        if was_open && self.batch.complete() {
            self.optimizer.tell(&self.batch.observations());
        }
        let best = self.best.as_ref().map(
            |best| json!({"id": best.id, "values": self.values(&best.point), "value": best.value}),
        );
        Ok(json!({"told": told.len(), "best": best, "stop": self.stop()}))
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
