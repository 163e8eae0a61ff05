//! Random draws of the errors of an insertion.

use super::Uncertainty;
use crate::trial::Conditions;
use crate::{Estimate, Finger, Grasp, Prediction};
use ask_tell::normal::StandardNormal;
use ask_tell::stream::stream;
use input::units::{DEG, MM};
use parameters::numbers::{SOCKET_YAW, START_ACROSS, START_TILT};
use parameters::{Parameter, Path};
use rand::RngExt;

/// Random stream of all errors except the shift of the start along x.
const PURPOSE: &str = "errors";
/// Random stream of the shift of the start along x; a separate stream keeps the values of the other errors.
const PURPOSE_ACROSS: &str = "error of the start along x";
/// Path of the downward shift of the part in the gripper; the shift is 0 or above.
const GRASP_LOW: &str = "cell.grasp_low_mm";

/// Random errors of one insertion. They do not depend on the design, so that designs are compared under
/// the same errors (common random numbers).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Draw {
    /// Shift of the start along y, m.
    pub offset: f64,
    /// Deviations of the trial from the task file.
    pub conditions: Conditions,
    /// Standard normal deviates of the stiffness in the compliance and assembly directions.
    stiffness: [f64; 2],
    /// Factor on the standard deviation of the stiffness prediction.
    stiffness_sd_factor: f64,
}

/// Returns `count` draws; draw `i` depends only on the errors, the seed and `i`.
pub fn draws(errors: &Uncertainty, seed: u64, count: u32) -> Vec<Draw> {
    (0..count).map(|i| draw(errors, seed, u64::from(i))).collect()
}

/// Returns one draw. All random numbers are always drawn, so that omitting an error does not change the others.
fn draw(errors: &Uncertainty, seed: u64, index: u64) -> Draw {
    let mut random = stream(seed, index, PURPOSE);
    let [offset, yaw, compliance, assembly, across]: [f64; 5] =
        std::array::from_fn(|_| random.sample(StandardNormal));
    let [finger, socket, clearance] = std::array::from_fn(|_| random.random_range(-1.0..1.0));
    let low = random.random::<f64>();
    let start_across: f64 = stream(seed, index, PURPOSE_ACROSS).sample(StandardNormal);
    let factor = |centred: f64| 1.0 + errors.friction.half_width * centred;
    Draw {
        offset: offset * errors.offset.sd,
        conditions: Conditions {
            yaw: yaw * errors.yaw.sd,
            start_across: start_across * errors.offset.across_sd,
            start_tilt: 0.0,
            friction_finger: factor(finger),
            friction_socket: factor(socket),
            clearance: clearance * errors.clearance.half_width,
            grasp_across: across * errors.grasp.across_sd,
            grasp_low: low * errors.grasp.low_max,
        },
        stiffness: [compliance, assembly],
        stiffness_sd_factor: errors.stiffness.sd_factor,
    }
}

impl Draw {
    /// Returns the draw with the given errors of the cell, each in the unit of its path; all other errors are 0.
    pub fn with<'a>(errors: impl IntoIterator<Item = (&'a str, f64)>) -> Self {
        let (conditions, stiffness) = (Conditions::NOMINAL, [0.0; 2]);
        let mut draw = Draw { offset: 0.0, conditions, stiffness, stiffness_sd_factor: 1.0 };
        for (path, value) in errors {
            let conditions = &mut draw.conditions;
            match path {
                "cell.start_y_mm" => draw.offset = value * MM,
                START_ACROSS => conditions.start_across = value * MM,
                START_TILT => conditions.start_tilt = value * DEG,
                SOCKET_YAW => conditions.yaw = value * DEG,
                "cell.friction_finger_percent" => conditions.friction_finger = 1.0 + value / 100.0,
                "cell.friction_socket_percent" => conditions.friction_socket = 1.0 + value / 100.0,
                "cell.clearance_mm" => conditions.clearance = value * MM,
                "cell.grasp_across_mm" => conditions.grasp_across = value * MM,
                GRASP_LOW => conditions.grasp_low = value * MM,
                "cell.compliance_error_sd" => draw.stiffness[0] = value,
                "cell.assembly_error_sd" => draw.stiffness[1] = value,
                // A test checks that the paths above are those of `parameters::numbers`.
                _ => (),
            }
        }
        draw
    }

    /// Returns the nominal grasp with the errors of this draw; `predicted` is the stiffness of its fingers.
    pub fn grasp<'a>(&self, nominal: Grasp<'a>, predicted: &Prediction) -> Grasp<'a> {
        let finger = self.finger(&nominal.finger, predicted);
        Grasp { finger, conditions: self.conditions, ..nominal }
    }

    /// Returns the nominal finger with the errors of this draw; `predicted` is its stiffness.
    pub fn finger(&self, nominal: &Finger, predicted: &Prediction) -> Finger {
        let [compliance, assembly] = self.stiffness;
        let spread = |estimate: Estimate| self.stiffness_sd_factor * estimate.sd / estimate.mean;
        Finger {
            compliance: nominal.compliance * lognormal(spread(predicted.compliance), compliance),
            assembly: nominal.assembly * lognormal(spread(predicted.assembly), assembly),
            ..*nominal
        }
    }
}

/// Half width of the interval of a normal error, in standard deviations; it covers 95 %.
const NORMAL_WIDTH_SD: f64 = 2.0;

impl Uncertainty {
    /// Returns the errors other than 0 as uniform parameters, normal errors over two standard deviations to either
    /// side. The shift along y is excluded because a window spans it.
    pub fn parameters(&self) -> Vec<Parameter> {
        let normal = |sd: f64, unit: f64| NORMAL_WIDTH_SD * sd / unit;
        let friction = 100.0 * self.friction.half_width;
        let stiffness = NORMAL_WIDTH_SD * self.stiffness.sd_factor;
        let uniform = |(path, half_width): (&str, f64)| {
            let low = if path == GRASP_LOW { 0.0 } else { -half_width };
            let parameter = Parameter::uniform(Path::new(path).ok()?, [low, half_width]);
            Some(parameter).filter(|parameter| parameter.low < parameter.high)
        };
        let half_widths = [
            (SOCKET_YAW, normal(self.yaw.sd, DEG)),
            (START_ACROSS, normal(self.offset.across_sd, MM)),
            ("cell.friction_finger_percent", friction),
            ("cell.friction_socket_percent", friction),
            ("cell.clearance_mm", self.clearance.half_width / MM),
            ("cell.grasp_across_mm", normal(self.grasp.across_sd, MM)),
            (GRASP_LOW, self.grasp.low_max / MM),
            ("cell.compliance_error_sd", stiffness),
            ("cell.assembly_error_sd", stiffness),
        ];
        half_widths.into_iter().filter_map(uniform).collect()
    }
}

/// Returns the lognormal factor with mean 1 and standard deviation `relative` at the standard normal deviate `z`:
/// `exp(s z - s^2 / 2)`, `s^2 = ln(1 + relative^2)`. Unlike a normal factor, it is never negative.
fn lognormal(relative: f64, z: f64) -> f64 {
    let variance = libm::log1p(relative * relative);
    libm::exp(variance.sqrt() * z - variance / 2.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::uncertainty::YawSpread;
    use crate::tests::fixtures::{predicted, typical};
    use ask_tell::statistics::Moments;
    use input::shipped::PRIORS;
    use parameters::numbers::{Kind, paths};

    fn without_errors() -> Uncertainty {
        Uncertainty::parse(PRIORS[0].text, PRIORS[0].file).unwrap()
    }

    fn moments(values: impl Iterator<Item = f64>) -> (f64, f64) {
        let moments = Moments::of(values.collect::<Vec<_>>());
        (moments.mean, moments.sample_deviation())
    }

    fn near((mean, sd): (f64, f64), expected_mean: f64, expected_sd: f64) {
        // 4000 draws: the mean errs by 1.6 % of a standard deviation.
        assert!((mean - expected_mean).abs() < 0.06 * expected_sd, "mean {mean}");
        assert!((sd / expected_sd - 1.0).abs() < 0.06, "standard deviation {sd}");
    }

    #[test]
    fn each_error_has_its_mean_and_spread() {
        let drawn = draws(&typical(), 3, 4000);
        let of = |value: &dyn Fn(&Draw) -> f64| moments(drawn.iter().map(value));
        let uniform = 1.0 / 3f64.sqrt();
        near(of(&|d| d.offset / MM), 0.0, 2.0);
        near(of(&|d| d.conditions.yaw / DEG), 0.0, 1.0);
        near(of(&|d| d.conditions.friction_finger), 1.0, 0.2 * uniform);
        near(of(&|d| d.conditions.friction_socket), 1.0, 0.2 * uniform);
        near(of(&|d| d.conditions.clearance / MM), 0.0, 0.03 * uniform);
        near(of(&|d| d.conditions.grasp_across / MM), 0.0, 0.3);
        near(of(&|d| d.conditions.grasp_low / MM), 0.15, 0.15 * uniform);
    }

    #[test]
    fn a_stiffness_has_the_predicted_mean_and_spread_and_is_never_negative() {
        let predicted = predicted([1.0, 0.4], [50.0, 1.0]);
        let nominal = Finger::new(1000.0, 50e3);
        let fingers: Vec<Finger> =
            draws(&typical(), 0, 4000).iter().map(|d| d.finger(&nominal, &predicted)).collect();
        near(moments(fingers.iter().map(|f| f.compliance)), 1000.0, 400.0);
        near(moments(fingers.iter().map(|f| f.assembly)), 50e3, 1e3);
        assert!(fingers.iter().all(|f| f.compliance > 0.0));
    }

    #[test]
    fn more_draws_and_fewer_errors_leave_the_others_as_they_were() {
        let (few, many) = (draws(&typical(), 1, 5), draws(&typical(), 1, 9));
        assert_eq!(few, many[..5]);
        assert_ne!(few, draws(&typical(), 2, 5));
        assert!(few.iter().all(|draw| draw.conditions.start_across == 0.0));
        let mut changed = typical();
        changed.offset.across_sd = MM;
        let across = draws(&changed, 1, 5);
        for (a, b) in across.iter().zip(&few) {
            assert_ne!(a.conditions.start_across, 0.0);
            let conditions = Conditions { start_across: 0.0, ..a.conditions };
            assert_eq!(Draw { conditions, ..*a }, *b);
        }
        let still = draws(&Uncertainty { yaw: YawSpread::default(), ..typical() }, 1, 5);
        for (a, b) in still.iter().zip(&few) {
            assert_eq!((a.offset, a.conditions.clearance), (b.offset, b.conditions.clearance));
            assert_eq!(a.conditions.yaw, 0.0);
        }
    }

    #[test]
    fn every_error_of_the_table_of_numbers_is_set_by_its_path_alone() {
        let paths = paths(Kind::Error);
        assert_eq!(paths.len(), 11);
        assert_eq!(Draw::with(paths.iter().map(|path| (&**path, 0.0))), Draw::with([]));
        let set: Vec<Draw> = paths.iter().map(|path| Draw::with([(&**path, 1.0)])).collect();
        for (i, draw) in set.iter().enumerate() {
            assert_ne!(*draw, Draw::with([]), "{}", paths[i]);
            assert!(!set[..i].contains(draw), "{}", paths[i]);
        }
    }

    #[test]
    fn what_is_certain_does_not_vary() {
        let varied = Uncertainty { yaw: YawSpread::default(), ..typical() }.parameters();
        assert!(varied.iter().all(|one| one.path != SOCKET_YAW));
        let clearance = varied.iter().find(|one| one.path == "cell.clearance_mm").unwrap();
        assert!((clearance.low + 0.03).abs() < 1e-12 && (clearance.high - 0.03).abs() < 1e-12);
        assert!(without_errors().parameters().is_empty());
    }

    #[test]
    fn without_errors_every_draw_is_the_nominal_trial() {
        let predicted = predicted([1.0, 0.0], [1.0, 0.0]);
        let finger = Finger::new(1e3, 2e4);
        for draw in draws(&without_errors(), 0, 20) {
            assert_eq!((draw.offset, draw.conditions), (0.0, Conditions::NOMINAL));
            assert_eq!(draw.finger(&finger, &predicted), finger);
        }
    }
}
