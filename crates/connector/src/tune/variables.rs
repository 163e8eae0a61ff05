//! Variables of the search for a strategy.

use crate::body::ConvexBody;
use crate::seat;
use input::InputError;
use input::shipped::{LEVERS, PRIORS};
use input::units::{DEG, MM};
use insertion::{Ending, Priors, Stage, Strategy, Task};
use parameters::Parameter;

/// Number of levels of a variable; odd, so that the current value is one of them.
pub const LEVELS: u32 = 31;
/// Largest tilt, degrees: the larger published tilt plus the shift that `priors/levers.toml` allows.
const MAX_TILT_DEG: f64 = 15.0;

/// Variable of the search; its range is scaled so that the current value is in the middle.
pub struct SearchVariable {
    target: Target,
    /// Parameter of `priors/` that bounds the variable.
    prior: Parameter,
}

/// Quantity of a strategy that a variable sets; the number is the index of its phase.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Target {
    Tilt,
    Preload(usize),
    /// Lateral displacement of a phase.
    Stroke(usize),
    Push(usize),
}

/// Returns the variables of a strategy with their bounds.
pub fn variables(strategy: &Strategy) -> Result<Vec<SearchVariable>, InputError> {
    let mut parameters = Priors::parse(LEVERS[0].text, LEVERS[0].file)?.parameters;
    parameters.extend(Priors::parse(PRIORS[0].text, PRIORS[0].file)?.parameters);
    let of = |(i, phase): (usize, &insertion::task::Phase)| {
        let [x, y, _] = phase.displacement;
        match (phase.stage, phase.ending) {
            (Stage::Search, Ending::Touch { .. }) => Some((Target::Preload(i), "preload")),
            (Stage::Search, _) if y != 0.0 => Some((Target::Stroke(i), "stroke to the side")),
            (Stage::Search, _) if x != 0.0 => Some((Target::Stroke(i), "stroke to the front")),
            (Stage::Assembly, _) => Some((Target::Push(i), "push speed")),
            _ => None,
        }
    };
    let found = strategy.phases.iter().enumerate().filter_map(of);
    let all = std::iter::once((Target::Tilt, "tilt")).chain(found);
    let with = |(target, name): (Target, &str)| {
        let prior = parameters.iter().find(|parameter| parameter.name == name)?.clone();
        Some(SearchVariable { target, prior })
    };
    Ok(all.filter_map(with).collect())
}

impl SearchVariable {
    /// Returns the value at a share of the range, in the unit of the prior, rounded to a multiple of `step`.
    fn at(&self, current: f64, share: f64, step: f64) -> f64 {
        let bound = |value: f64| self.prior.applied(current, value);
        let [low, high] = [bound(self.prior.low).min(current), bound(self.prior.high).max(current)];
        let value = match share < 0.5 {
            true => low + 2.0 * share * (current - low),
            false => current + (2.0 * share - 1.0) * (high - current),
        };
        rounded(value, step)
    }
}

/// Returns the task's strategy with its variables at these shares of their ranges, rounded as in files, and the changed
/// values as text. The tip's lower edge keeps its position at the start.
pub fn strategy_at(task: &Task, variables: &[SearchVariable], unit: &[f64]) -> (Strategy, String) {
    let mut strategy = task.strategy.clone();
    let mut changes = Vec::new();
    for (variable, &share) in variables.iter().zip(unit).filter(|(_, share)| **share != 0.5) {
        let phases = &mut strategy.phases;
        match variable.target {
            Target::Tilt => {
                let tilt = variable.at(strategy.tilt / DEG, share, 0.1).clamp(0.0, MAX_TILT_DEG);
                strategy.tilt = tilt * DEG;
                changes.push(format!("tilt {tilt:.1}°"));
            }
            Target::Preload(i) => {
                if let Ending::Touch { preload, .. } = &mut phases[i].ending {
                    *preload = variable.at(*preload / MM, share, 0.01) * MM;
                    changes.push(format!("preload {:.2} mm", *preload / MM));
                }
            }
            Target::Stroke(i) => {
                let by = &mut phases[i].displacement;
                let longest = if by[1] == 0.0 { by[0] } else { by[1] };
                let factor = variable.at(1.0, share, 1e-3);
                by[..2].iter_mut().for_each(|by| *by = rounded(*by * factor, 0.01 * MM));
                changes.push(format!("{} {:.2} mm", phases[i].name, longest * factor / MM));
            }
            Target::Push(i) => {
                let most = task.limits.speed.unwrap_or(f64::INFINITY);
                phases[i].speed = (variable.at(phases[i].speed / MM, share, 1.0) * MM).min(most);
                changes.push(format!("push {:.0} mm/s", phases[i].speed / MM));
            }
        }
    }
    let plug = ConvexBody::plug(&task.plug);
    let edge = |strategy: &Strategy| {
        let changed = Task { strategy: strategy.clone(), ..task.clone() };
        seat::waypoints(&changed, &plug)[0].edge
    };
    let off = edge(&task.strategy) - edge(&strategy);
    strategy.start[1] = rounded(strategy.start[1] + off.y, 0.01 * MM);
    strategy.start[2] = rounded(strategy.start[2] + off.z, 0.01 * MM);
    (strategy, changes.join(", "))
}

fn rounded(value: f64, step: f64) -> f64 {
    (value / step).round() * step
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::shipped::TASKS;

    #[test]
    fn a_changed_tilt_keeps_the_edge_and_every_variable_has_a_bound() {
        for file in TASKS {
            let task = Task::parse(file.text, file.file).unwrap();
            let variables = variables(&task.strategy).unwrap();
            assert_eq!(variables.len(), 6, "{}", file.name);
            let plug = ConvexBody::plug(&task.plug);
            let edge = |task: &Task| seat::waypoints(task, &plug)[0].edge;
            for share in [0.0, 0.5, 1.0] {
                let (strategy, changes) = strategy_at(&task, &variables, &[share; 6]);
                let moved = Task { strategy, ..task.clone() };
                let off = (edge(&moved) - edge(&task)).norm();
                assert!(off < 0.011 * MM, "{}: {off} {changes}", file.name);
            }
        }
    }
}
