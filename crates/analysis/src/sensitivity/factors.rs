//! Varied inputs of an insertion: the keys of a space, and the errors of a cell.

use input::units::{DEG, MM};
use insertion::evaluation::Evaluation;
use insertion::evaluation::evaluator::Evaluator;
use insertion::evaluation::template::{Impossible, Template};
use insertion::evaluation::tolerance::{self, Search};
use insertion::evaluation::uncertainty::{Draw, Errors};
use insertion::space::{DENSITY_KEY, DIRECTION_KEY, Design, Space};
use insertion::trial::{Conditions, Grasp};
use std::sync::atomic::AtomicBool;

/// Half width over which a normal error is varied, in standard deviations: 95 % of it.
const NORMAL_WIDTH_SD: f64 = 2.0;

/// Input that is varied uniformly from `low` to `high`, in the unit of its key.
#[derive(Debug, Clone)]
pub struct Factor {
    /// Key of the space, or of a cell's error (`cell.clearance_mm`).
    pub key: String,
    /// Lower bound.
    pub low: f64,
    /// Upper bound.
    pub high: f64,
    /// Setter of conditions and errors of stiffness; `None` for a key of the space.
    sets: Option<Sets>,
}

type Sets = fn(&mut Conditions, &mut [f64; 2], f64);

/// Inputs that are varied together, in the order of the cube's axes.
#[derive(Debug, Clone)]
pub struct Factors(pub Vec<Factor>);

impl Factors {
    /// Every key of the space with its bounds, then every error of the cell that is not 0.
    ///
    /// # Errors
    /// If the space has no infill density or direction.
    pub fn new(space: &Space, errors: Option<&Errors>) -> Result<Self, String> {
        for key in [DENSITY_KEY, DIRECTION_KEY] {
            if !space.parameters.iter().any(|parameter| parameter.key == key) {
                return Err(format!("the space `{}` has no {key}", space.name));
            }
        }
        let of_space = space.parameters.iter().map(|parameter| Factor {
            key: parameter.key.clone(),
            low: parameter.low,
            high: parameter.high,
            sets: None,
        });
        let of_cell = errors.map(cell).unwrap_or_default();
        Ok(Factors(of_space.chain(of_cell).filter(|factor| factor.low < factor.high).collect()))
    }

    /// Evaluation of the insertion at a point of the unit cube, by the coarse-to-fine search; worthless
    /// once `stop` is set.
    ///
    /// # Errors
    /// If the point's design, specimen or rig is impossible.
    pub fn evaluate(
        &self,
        evaluator: &Evaluator,
        template: &Template,
        unit: &[f64],
        stop: &AtomicBool,
    ) -> Result<Evaluation, Impossible> {
        let mut design = Design::default();
        let (mut conditions, mut stiffness) = (Conditions::NOMINAL, [0.0; 2]);
        for (factor, unit) in self.0.iter().zip(unit) {
            let value = factor.low + unit.clamp(0.0, 1.0) * (factor.high - factor.low);
            match factor.sets {
                None => drop(design.0.insert(factor.key.clone(), value)),
                Some(set) => set(&mut conditions, &mut stiffness, value),
            }
        }
        let predicted = evaluator.predict(&design)?;
        let specimen = evaluator.specimen(template, &design, predicted)?;
        let rig = evaluator.rig(&specimen, evaluator.taught(&specimen, stop)?, 1.0)?;
        let finger = Draw::under(conditions, stiffness).finger(&specimen.finger, &predicted);
        let grasp = Grasp { finger, conditions, stop };
        Ok(tolerance::evaluate_in(&*rig, grasp, Search::Strides))
    }
}

/// Errors of a cell, measured from nominal.
fn cell(errors: &Errors) -> Vec<Factor> {
    let factor = |key: &str, low, high, sets: Sets| Factor {
        key: key.to_owned(),
        low,
        high,
        sets: Some(sets),
    };
    let both = |key, half_width: f64, sets| factor(key, -half_width, half_width, sets);
    let percent = 100.0 * errors.friction_half_width;
    let yaw_deg = NORMAL_WIDTH_SD * errors.yaw_sd / DEG;
    let start_mm = NORMAL_WIDTH_SD * errors.across_sd / MM;
    let across_mm = NORMAL_WIDTH_SD * errors.grasp_across_sd / MM;
    let sd = NORMAL_WIDTH_SD * errors.stiffness_sd_factor;
    vec![
        both("cell.socket_yaw_deg", yaw_deg, |c, _, value| c.yaw = value * DEG),
        both("cell.start_across_mm", start_mm, |c, _, value| c.start_across = value * MM),
        both("cell.friction_finger_percent", percent, |c, _, value| {
            c.friction_finger = 1.0 + value / 100.0
        }),
        both("cell.friction_socket_percent", percent, |c, _, value| {
            c.friction_socket = 1.0 + value / 100.0
        }),
        both("cell.clearance_mm", errors.clearance_half_width / MM, |c, _, value| {
            c.clearance = value * MM
        }),
        both("cell.grasp_across_mm", across_mm, |c, _, value| c.grasp_across = value * MM),
        factor("cell.grasp_low_mm", 0.0, errors.grasp_low_max / MM, |c, _, value| {
            c.grasp_low = value * MM
        }),
        both("cell.compliance_error_sd", sd, |_, stiffness, value| stiffness[0] = value),
        both("cell.assembly_error_sd", sd, |_, stiffness, value| stiffness[1] = value),
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::shipped::{SPACES, UNCERTAINTIES};
    use insertion::evaluation::uncertainty::Uncertainty;

    #[test]
    fn a_space_and_a_cell_are_varied_together_and_what_is_certain_is_not() {
        let space = SPACES.iter().find(|space| space.name == "infill").unwrap();
        let space = Space::parse(space.text, space.file).unwrap();
        let mut errors = Uncertainty::parse(UNCERTAINTIES[0].text, "typical").unwrap().errors;
        errors.yaw_sd = 0.0;
        let factors = Factors::new(&space, Some(&errors)).unwrap();
        let keys: Vec<&str> = factors.0.iter().map(|factor| &*factor.key).collect();
        assert_eq!(&keys[..2], [DENSITY_KEY, DIRECTION_KEY]);
        assert!(!keys.contains(&"cell.socket_yaw_deg") && keys.contains(&"cell.clearance_mm"));
        let clearance = factors.0.iter().find(|factor| factor.key == "cell.clearance_mm").unwrap();
        assert!((clearance.low + 0.03).abs() < 1e-12 && (clearance.high - 0.03).abs() < 1e-12);
    }
}
