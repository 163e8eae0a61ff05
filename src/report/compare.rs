//! Studies of the same problem beside each other: optimizers against evaluations.

use super::convergence::best_so_far;
use crate::evaluation::objective::{Aggregate, Constraint};
use crate::study::{StudyConfig, StudyRecord};
use std::collections::BTreeMap;

/// How far below the best known value a study may be to have reached it, mm.
pub const TOLERANCE_MM: f64 = 0.1;
/// Values are multiples of 0.1 mm but for rounding.
const ROUNDING_MM: f64 = 1e-9;

/// Why studies cannot be compared.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CompareError {
    /// None was given.
    #[error("give at least one study to compare")]
    Nothing,
    /// Two studies measure different things.
    #[error(
        "{first} and {second} cannot be compared: the first has the {what} {ours}, the second \
         {theirs}; compare studies of the same {what}"
    )]
    Different {
        /// One study.
        first: String,
        /// The other.
        second: String,
        /// What differs.
        what: String,
        /// Its value in the first.
        ours: String,
        /// Its value in the second.
        theirs: String,
    },
    /// One study twice would count twice.
    #[error("{first} and {second} are the same study ({optimizer}, seed {seed}); give it once")]
    Same {
        /// One study.
        first: String,
        /// The other.
        second: String,
        /// Their optimizer.
        optimizer: String,
        /// Their seed.
        seed: u64,
    },
    /// The target would mean nothing.
    #[error(
        "{name} has the objective {objective}; only studies of one objective in mm that is to be \
         large can be compared: range, centred-range or robust-range"
    )]
    Objective {
        /// The study.
        name: String,
        /// Its objective.
        objective: String,
    },
    /// No study holds a value.
    #[error("no evaluation of these studies has a value: there is nothing to compare")]
    NoValue,
}

/// Lower quartile, median and upper quartile; `None` where it is not known: a value that
/// was not there yet, an evaluation that never came.
pub type Quartiles = [Option<f64>; 3];

/// Studies of one optimizer with different seeds.
#[derive(Debug, Clone, PartialEq)]
pub struct Group {
    /// Name of the optimizer, with its polish.
    pub optimizer: String,
    /// Designs it proposes at a time.
    pub batch: u64,
    /// Number of studies.
    pub studies: usize,
    /// Best value so far (mm) over the studies after 1, 2, .. evaluations, up to the end of the shortest.
    pub best_so_far: Vec<Quartiles>,
    /// Evaluations until the target, one number a study; `None` if it was not reached.
    pub to_target: Vec<Option<u64>>,
}

/// Studies side by side.
#[derive(Debug, Clone, PartialEq)]
pub struct Comparison {
    /// Their task.
    pub task: String,
    /// Their objective.
    pub objective: String,
    /// The best value of them all, mm.
    pub best_known_mm: f64,
    /// By optimizer and batch.
    pub groups: Vec<Group>,
}

impl Group {
    /// Studies that reached the target.
    pub fn reached(&self) -> usize {
        self.to_target.iter().flatten().count()
    }

    /// Quartiles of the evaluations to the target; a study that did not reach it counts as
    /// later than all that did.
    pub fn evaluations_to_target(&self) -> Quartiles {
        quartiles(self.to_target.iter().map(|n| n.map_or(f64::INFINITY, |n| n as f64)).collect())
    }
}

/// Compares studies, each with a name for messages.
///
/// # Errors
/// If they measure different things, or one is given twice, or none has a value.
pub fn compare(studies: &[(String, StudyRecord)]) -> Result<Comparison, CompareError> {
    let (first, _) = studies.split_first().ok_or(CompareError::Nothing)?;
    studies.iter().try_for_each(|study| alike(first, study))?;
    let objective = &first.1.config.objective;
    if !objective.single().is_some_and(|measure| measure.key() == "mm" && measure.sense() > 0.0) {
        let (name, objective) = (first.0.clone(), objective.to_string());
        return Err(CompareError::Objective { name, objective });
    }
    let mut groups: BTreeMap<(String, u64), Vec<&(String, StudyRecord)>> = BTreeMap::new();
    for study in studies {
        let config = &study.1.config;
        let group = groups.entry((config.method(), config.batch)).or_default();
        if let Some(same) = group.iter().find(|other| other.1.config.seed == config.seed) {
            return Err(CompareError::Same {
                first: same.0.clone(),
                second: study.0.clone(),
                optimizer: config.method(),
                seed: config.seed,
            });
        }
        group.push(study);
    }
    let best = studies.iter().filter_map(|(_, record)| record.best()?.value()).reduce(f64::max);
    let best_known_mm = best.ok_or(CompareError::NoValue)?;
    let group =
        |((optimizer, batch), studies): ((String, u64), Vec<&(String, StudyRecord)>)| Group {
            optimizer,
            batch,
            studies: studies.len(),
            best_so_far: band(&studies),
            to_target: studies
                .iter()
                .map(|(_, r)| reached(r, best_known_mm - TOLERANCE_MM))
                .collect(),
        };
    Ok(Comparison {
        task: first.1.config.task_name(),
        objective: objective.to_string(),
        best_known_mm,
        groups: groups.into_iter().map(group).collect(),
    })
}

fn constraints(config: &StudyConfig) -> String {
    let constraints: Vec<String> = config.constraints.iter().map(Constraint::to_string).collect();
    if constraints.is_empty() { "none".to_owned() } else { constraints.join(", ") }
}

/// Whether two studies measure the same.
fn alike(
    (first, ours): &(String, StudyRecord),
    (second, theirs): &(String, StudyRecord),
) -> Result<(), CompareError> {
    let fields = |config: &StudyConfig| {
        let mut fields: Vec<(String, String)> = [
            ("task", config.task_name()),
            ("objective", config.objective.to_string()),
            ("constraints", constraints(config)),
            (
                "aggregate",
                config.aggregate.as_ref().map_or("none".to_owned(), Aggregate::to_string),
            ),
            ("robot", config.robot.clone()),
            ("engine", config.provenance.engine.name.clone()),
        ]
        .map(|(what, value)| (what.to_owned(), value))
        .into();
        fields.push(("space".to_owned(), config.space.name().to_owned()));
        fields
    };
    let (ours, theirs) = (fields(&ours.config), fields(&theirs.config));
    match ours.into_iter().zip(theirs).find(|(ours, theirs)| ours != theirs) {
        None => Ok(()),
        Some(((what, ours), (_, theirs))) => {
            let (first, second) = (first.clone(), second.clone());
            Err(CompareError::Different { first, second, what, ours, theirs })
        }
    }
}

/// Evaluations until a value of at least `target`, mm.
fn reached(record: &StudyRecord, target: f64) -> Option<u64> {
    let values = record.evaluations.iter().map(|r| r.feasible()?.first().copied());
    let place = values.into_iter().position(|v| v.is_some_and(|v| v >= target - ROUNDING_MM));
    place.map(|index| index as u64 + 1)
}

fn band(studies: &[&(String, StudyRecord)]) -> Vec<Quartiles> {
    let shortest = studies.iter().map(|(_, r)| r.evaluations.len()).min().unwrap_or(0);
    let curves: Vec<Vec<f64>> = studies.iter().map(|(_, record)| curve(record)).collect();
    (0..shortest).map(|n| quartiles(curves.iter().map(|curve| curve[n]).collect())).collect()
}

/// Best so far after each evaluation; minus infinity before the first value.
fn curve(record: &StudyRecord) -> Vec<f64> {
    let known = best_so_far(record);
    let none = record.evaluations.len() - known.len();
    let values = known.into_iter().map(|(_, value)| value);
    std::iter::repeat_n(f64::NEG_INFINITY, none).chain(values).collect()
}

/// By linear interpolation between the sorted values; `None` where that meets an infinity.
fn quartiles(mut values: Vec<f64>) -> Quartiles {
    values.sort_by(f64::total_cmp);
    [0.25, 0.5, 0.75].map(|share| {
        let place = share * values.len().checked_sub(1)? as f64;
        let (low, high) = (values[place.floor() as usize], values[place.ceil() as usize]);
        let part = place - place.floor();
        let value = if part == 0.0 { low } else { low + part * (high - low) };
        value.is_finite().then_some(value)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn quartiles_interpolate_and_do_not_invent() {
        let five = vec![5.0, 1.0, 3.0, 2.0, 4.0];
        assert_eq!(quartiles(five), [Some(2.0), Some(3.0), Some(4.0)]);
        assert_eq!(quartiles(vec![1.0, 2.0]), [Some(1.25), Some(1.5), Some(1.75)]);
        assert_eq!(quartiles(vec![7.0, f64::INFINITY]), [None; 3]);
        let late = vec![7.0, 9.0, f64::INFINITY];
        assert_eq!(quartiles(late), [Some(8.0), Some(9.0), None]);
        assert_eq!(quartiles(vec![]), [None; 3]);
    }
}
