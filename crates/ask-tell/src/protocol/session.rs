//! Ask-and-tell session with one optimizer.

use super::message::{Best, Line, PointResult, Problem, check_count};
use super::parameter::Parameter;
use crate::{Grid, GridPoint, Observation, Optimizer, build};
use serde_json::{Map, Value, json};
use std::collections::{BTreeMap, BTreeSet};

/// Ask-and-tell session. The first line defines the problem.
#[derive(Default)]
pub struct Session {
    search: Option<Search>,
}

struct Search {
    problem: Problem,
    optimizer: Box<dyn Optimizer + Send>,
    /// All proposed points by id.
    proposals: Vec<Proposal>,
    /// First id of the current batch. The optimizer learns from whole batches, in order.
    first: usize,
    /// Number of proposals sent to the client.
    asked: usize,
    /// Points that the client evaluated without a proposal.
    known: BTreeSet<GridPoint>,
    /// Results of such points, to be passed to the optimizer after the current batch.
    waiting: Vec<Observation>,
    best: Option<Best>,
}

struct Proposal {
    point: GridPoint,
    /// Result, larger is better: `Some(None)` if the evaluation failed.
    merit: Option<Option<f64>>,
}

impl Session {
    /// Returns the answer to a line as JSON without a line break; a valid problem has no answer.
    ///
    /// # Errors
    /// If the line is not accepted. The session is then unchanged.
    pub fn answer(&mut self, line: &str) -> Result<Option<String>, String> {
        match (Line::parse(line)?, &mut self.search) {
            (Line::Problem(problem), None) => {
                self.search = Some(Search::new(problem)?);
                Ok(None)
            }
            (Line::Problem(_), Some(_)) => {
                Err("the problem is already defined; start another process for another".to_owned())
            }
            (_, None) => Err("the first line must be {\"parameters\":[..],\"optimizer\":..,\
                              \"seed\":..,\"direction\":..}"
                .to_owned()),
            (Line::Ask(n), Some(search)) => Ok(Some(json!({"asked": search.ask(n)?}).to_string())),
            (Line::Tell(results), Some(search)) => Ok(Some(search.tell(results)?.to_string())),
        }
    }
}

impl Search {
    fn new(problem: Problem) -> Result<Self, String> {
        let kind = problem.check()?;
        let grid = Grid::new(problem.parameters.iter().map(Parameter::levels).collect());
        Ok(Search {
            optimizer: build(kind, grid, problem.seed),
            problem,
            proposals: Vec::new(),
            first: 0,
            asked: 0,
            known: BTreeSet::new(),
            waiting: Vec::new(),
            best: None,
        })
    }

    fn ask(&mut self, n: usize) -> Result<Vec<Value>, String> {
        check_count("ask", n, self.problem.parameters.len())?;
        if n > 0 && self.asked == self.proposals.len() {
            const SHOWN: usize = 8;
            let open = (self.first..self.asked).filter(|&id| self.proposals[id].merit.is_none());
            let ids: Vec<String> = open.map(|id| id.to_string()).collect();
            if !ids.is_empty() {
                let shown = ids[..ids.len().min(SHOWN)].join(", ");
                let more = if ids.len() > SHOWN { ", .." } else { "" };
                return Err(format!(
                    "ask: tell the values of ids {shown}{more} first (null for a failed evaluation)"
                ));
            }
            let points = self.optimizer.ask(self.problem.batch.unwrap_or(n)).into_iter();
            self.proposals.extend(points.map(|point| Proposal { point, merit: None }));
        }
        let end = self.proposals.len().min(self.asked + n);
        let ids = std::mem::replace(&mut self.asked, end)..end;
        let asked = |id: usize| json!({"id": id, "values": self.values(&self.proposals[id].point)});
        Ok(ids.map(asked).collect())
    }

    /// Returns the number of results, the best result so far, and the stop reason if the search has ended.
    fn tell(&mut self, results: Vec<PointResult>) -> Result<Value, String> {
        let told = results.len();
        let (mut points, mut checked) = (BTreeSet::new(), Vec::new());
        for PointResult { id, values, value } in results {
            let point = self.point(id, values)?;
            if !points.insert(point.clone()) {
                let which = id.map_or("a known point".to_owned(), |id| format!("id {id}"));
                return Err(format!("tell: {which} is told twice; each point is told once"));
            }
            checked.push((id, point, value));
        }
        for (id, point, value) in checked {
            self.update_best(id, &point, value);
            let merit = value.map(|value| self.problem.direction.merit(value));
            match id {
                Some(id) => self.proposals[id].merit = Some(merit),
                None => {
                    self.known.insert(point.clone());
                    self.waiting.push(Observation::new(point, merit));
                }
            }
        }
        let stop = self.learn();
        Ok(json!({"told": told, "best": self.best, "stop": stop}))
    }

    /// Passes the results to the optimizer once the batch is complete. Returns the stop reason if
    /// the search has ended.
    fn learn(&mut self) -> Option<crate::StopReason> {
        let batch = &self.proposals[self.first..];
        let result = |p: &Proposal| Some(Observation::new(p.point.clone(), p.merit?));
        let results = batch.iter().map(result).collect::<Option<Vec<_>>>()?;
        for results in [results, std::mem::take(&mut self.waiting)] {
            if !results.is_empty() {
                self.optimizer.tell(&results);
            }
        }
        self.first = self.proposals.len();
        self.optimizer.stop()
    }

    /// Returns the point of a result, which must be a pending proposal or a new point.
    fn point(
        &self,
        id: Option<usize>,
        values: Option<BTreeMap<String, f64>>,
    ) -> Result<GridPoint, String> {
        let problem = match (id, values) {
            (Some(id), None) => match self.proposals[..self.asked].get(id) {
                None => format!("id {id} was not asked"),
                Some(Proposal { merit: Some(_), .. }) => {
                    format!("id {id} is told twice; each point is told once")
                }
                Some(proposal) => return Ok(proposal.point.clone()),
            },
            (None, Some(values)) => {
                let point = self.grid_point(&values).map_err(|error| format!("tell: {error}"))?;
                match self.proposals.iter().position(|proposal| proposal.point == point) {
                    Some(id) => format!("these values were asked as id {id}; give the id"),
                    None if self.known.contains(&point) => "these values are told twice".into(),
                    None => return Ok(point),
                }
            }
            _ => "an entry must have either `id` or `values`".to_owned(),
        };
        Err(format!("tell: {problem}"))
    }

    fn grid_point(&self, values: &BTreeMap<String, f64>) -> Result<GridPoint, String> {
        let names: Vec<&str> =
            self.problem.parameters.iter().map(|one| one.name.as_str()).collect();
        let fail = |problem: String| Err(format!("{problem}; accepted: {}", names.join(", ")));
        if let Some(name) = values.keys().find(|name| !names.contains(&name.as_str())) {
            return fail(format!("unknown parameter `{name}`"));
        }
        if let Some(name) = names.iter().find(|name| !values.contains_key(**name)) {
            return fail(format!("parameter `{name}` is missing"));
        }
        let level = |parameter: &Parameter| parameter.level(values[&parameter.name]);
        Ok(GridPoint(self.problem.parameters.iter().map(level).collect::<Result<_, _>>()?))
    }

    /// Updates the best result; of equal results, the lower id or the earlier one is kept.
    fn update_best(&mut self, id: Option<usize>, point: &GridPoint, value: Option<f64>) {
        let Some(value) = value else { return };
        let merit = |value| self.problem.direction.merit(value);
        let worse = |best: &Best| {
            let earlier = id.zip(best.id).is_some_and(|(id, best)| id < best);
            merit(value) < merit(best.value) || value == best.value && !earlier
        };
        if !self.best.as_ref().is_some_and(worse) {
            self.best = Some(Best { id, values: self.values(point), value });
        }
    }

    fn values(&self, point: &GridPoint) -> Map<String, Value> {
        let value = |(parameter, &level): (&Parameter, &u32)| {
            (parameter.name.clone(), json!(parameter.value(level)))
        };
        self.problem.parameters.iter().zip(&point.0).map(value).collect()
    }
}
