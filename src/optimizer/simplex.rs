//! One run of argmin's Nelder-Mead, stepped from value to value.

use argmin::core::{CostFunction, Error, IterState, Problem, Solver, State as _};
use argmin::solver::neldermead::NelderMead;
use std::cell::Cell;

type State = IterState<Vec<f64>, (), (), (), (), f64>;

/// What a run wants.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Want {
    /// These vertices of the first simplex that have no value yet.
    Start(Vec<Vec<f64>>),
    /// The value of this one point.
    Value(Vec<f64>),
    /// Nothing: an iteration has ended.
    Iterated,
    /// Nothing: it cannot go on.
    Broken,
}

/// A Nelder-Mead run that **minimises**.
///
/// argmin asks for values by calling a function, and an optimizer here is asked and told. So
/// each iteration works on a copy of the solver with a function that knows the values told
/// so far; at the first point it does not know, the function fails, the copy is thrown away
/// and the point is what the run wants. The iteration is repeated when the value is
/// known. Copies are equal, so the repetition meets the same points.
#[derive(Clone)]
pub(super) struct Simplex {
    solver: NelderMead<Vec<f64>, f64>,
    vertices: Vec<Vec<f64>>,
    state: Option<State>,
}

/// The values known, and the first point that is not.
struct Known<'a, F> {
    value: &'a F,
    missing: &'a Cell<Option<Vec<f64>>>,
}

/// Stops an iteration.
#[derive(Debug, thiserror::Error)]
#[error("the value of a point is not known yet")]
struct NotYet;

impl<F: Fn(&[f64]) -> Option<f64>> CostFunction for Known<'_, F> {
    type Param = Vec<f64>;
    type Output = f64;

    fn cost(&self, x: &Vec<f64>) -> Result<f64, Error> {
        (self.value)(x).ok_or_else(|| {
            self.missing.set(Some(x.clone()));
            Error::new(NotYet)
        })
    }
}

impl Simplex {
    /// A run from these vertices, one more than there are axes.
    pub fn new(vertices: Vec<Vec<f64>>) -> Self {
        Simplex { solver: NelderMead::new(vertices.clone()), vertices, state: None }
    }

    /// Goes on by at most one iteration; `value` gives the values known, larger is worse.
    pub fn advance(&mut self, value: &impl Fn(&[f64]) -> Option<f64>) -> Want {
        // argmin panics at an unknown vertex of the first simplex.
        if self.state.is_none() {
            let unknown = self.vertices.iter().filter(|x| value(x).is_none());
            let unknown: Vec<Vec<f64>> = unknown.cloned().collect();
            if !unknown.is_empty() {
                return Want::Start(unknown);
            }
        }
        let missing = Cell::new(None);
        let mut problem = Problem::new(Known { value, missing: &missing });
        let mut solver = self.solver.clone();
        let done = match self.state.clone() {
            None => solver.init(&mut problem, State::new()),
            Some(state) => solver.next_iter(&mut problem, state),
        };
        match done {
            Ok((state, _)) => {
                self.solver = solver;
                self.state = Some(state);
                Want::Iterated
            }
            Err(_) => missing.take().map_or(Want::Broken, Want::Value),
        }
    }
}
