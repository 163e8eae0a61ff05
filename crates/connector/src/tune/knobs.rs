//! Numbers of a strategy that are searched over.

use crate::body::ConvexBody;
use crate::seat;
use input::InputError;
use input::shipped::{LEVERS, PRIORS};
use input::units::{DEG, MM};
use insertion::evaluation::cell::Priors;
use insertion::task::{Ending, Stage, Strategy, Task};
use parameters::Parameter;

/// Values of a knob: an odd number, so that the present one is among them.
pub const LEVELS: u32 = 31;
/// Largest tilt, degrees: the larger published tilt plus the shift that `priors/levers.toml` allows.
const MOST_TILT_DEG: f64 = 15.0;

/// Number of a strategy, with the row of `priors/` that bounds it: from its lower bound by the present
/// value, which lies in the middle, to the upper one.
pub struct Knob {
    sets: Sets,
    row: Parameter,
}

/// Number that a knob sets.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Sets {
    Tilt,
    Preload(usize),
    /// The move of a phase to the side.
    Stroke(usize),
    Push(usize),
}

/// Returns the knobs of a strategy, each with its bounds' source.
pub fn knobs(strategy: &Strategy) -> Result<Vec<Knob>, InputError> {
    let mut rows = Priors::parse(LEVERS[0].text, LEVERS[0].file)?.parameters;
    rows.extend(Priors::parse(PRIORS[0].text, PRIORS[0].file)?.parameters);
    let of = |(i, phase): (usize, &insertion::task::Phase)| {
        let [x, y, _] = phase.displacement;
        match (phase.stage, phase.ending) {
            (Stage::Search, Ending::Touch { .. }) => Some((Sets::Preload(i), "preload")),
            (Stage::Search, _) if y != 0.0 => Some((Sets::Stroke(i), "stroke to the side")),
            (Stage::Search, _) if x != 0.0 => Some((Sets::Stroke(i), "stroke to the front")),
            (Stage::Assembly, _) => Some((Sets::Push(i), "push speed")),
            _ => None,
        }
    };
    let found = strategy.phases.iter().enumerate().filter_map(of);
    let all = std::iter::once((Sets::Tilt, "tilt")).chain(found);
    let with = |(sets, name): (Sets, &str)| {
        let row = rows.iter().find(|row| row.name == name)?.clone();
        Some(Knob { sets, row })
    };
    Ok(all.filter_map(with).collect())
}

impl Knob {
    /// Returns the value at a share of the range, in the unit of the row, rounded to whole steps.
    fn at(&self, present: f64, share: f64, step: f64) -> f64 {
        let bound = |value: f64| self.row.applied(present, value);
        let [low, high] = [bound(self.row.low).min(present), bound(self.row.high).max(present)];
        let value = match share < 0.5 {
            true => low + 2.0 * share * (present - low),
            false => present + (2.0 * share - 1.0) * (high - present),
        };
        if share == 0.5 { present } else { (value / step).round() * step }
    }
}

/// Returns the task's strategy with its knobs at these shares of their ranges, rounded as files have
/// them; and what they are set to, if that is new. The tip's lower edge stays where it was at the start.
pub fn turned(task: &Task, knobs: &[Knob], unit: &[f64]) -> (Strategy, String) {
    let mut strategy = task.strategy.clone();
    let mut said = Vec::new();
    for (knob, &share) in knobs.iter().zip(unit).filter(|(_, share)| **share != 0.5) {
        let phases = &mut strategy.phases;
        match knob.sets {
            Sets::Tilt => {
                let degrees = knob.at(strategy.tilt / DEG, share, 0.1).clamp(0.0, MOST_TILT_DEG);
                strategy.tilt = degrees * DEG;
                said.push(format!("tilt {degrees:.1}°"));
            }
            Sets::Preload(i) => {
                if let Ending::Touch { preload, .. } = &mut phases[i].ending {
                    *preload = knob.at(*preload / MM, share, 0.01) * MM;
                    said.push(format!("preload {:.2} mm", *preload / MM));
                }
            }
            Sets::Stroke(i) => {
                let by = &mut phases[i].displacement;
                let longest = if by[1] == 0.0 { by[0] } else { by[1] };
                let factor = knob.at(1.0, share, 1e-3);
                by[..2].iter_mut().for_each(|by| *by = rounded(*by * factor, 0.01 * MM));
                said.push(format!("{} {:.2} mm", phases[i].name, longest * factor / MM));
            }
            Sets::Push(i) => {
                let most = task.limits.speed.unwrap_or(f64::INFINITY);
                phases[i].speed = (knob.at(phases[i].speed / MM, share, 1.0) * MM).min(most);
                said.push(format!("push {:.0} mm/s", phases[i].speed / MM));
            }
        }
    }
    let plug = ConvexBody::plug(&task.plug);
    let edge = |strategy: &Strategy| {
        let turned = Task { strategy: strategy.clone(), ..task.clone() };
        seat::waypoints(&turned, &plug)[0].edge
    };
    let off = edge(&task.strategy) - edge(&strategy);
    strategy.start[1] = rounded(strategy.start[1] + off.y, 0.01 * MM);
    strategy.start[2] = rounded(strategy.start[2] + off.z, 0.01 * MM);
    (strategy, said.join(", "))
}

fn rounded(value: f64, step: f64) -> f64 {
    (value / step).round() * step
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::shipped::TASKS;

    #[test]
    fn turning_the_tilt_keeps_the_edge_and_every_knob_has_a_bound() {
        for file in TASKS {
            let task = Task::parse(file.text, file.file).unwrap();
            let knobs = knobs(&task.strategy).unwrap();
            assert_eq!(knobs.len(), 6, "{}", file.name);
            let plug = ConvexBody::plug(&task.plug);
            let edge = |task: &Task| seat::waypoints(task, &plug)[0].edge;
            for share in [0.0, 0.5, 1.0] {
                let (strategy, said) = turned(&task, &knobs, &[share; 6]);
                let moved = Task { strategy, ..task.clone() };
                let off = (edge(&moved) - edge(&task)).norm();
                assert!(off < 0.011 * MM, "{}: {off} {said}", file.name);
            }
        }
    }
}
