use super::computed::ComputedStiffness;
use super::*;
use crate::stiffness::{Measurement, SurrogateError, parse};
use crate::tests::fixtures::refused;
use ask_tell::statistics::Moments;
use finray::printed::PrintedFinger;
use input::shipped::{FINGERS, STIFFNESS};
use input::units::N_PER_MM;
use std::sync::OnceLock;

fn finray9() -> PrintedFinger {
    let shipped = FINGERS.first().unwrap();
    PrintedFinger::parse(shipped.text, shipped.file).unwrap()
}

/// Returns the computed fingers, each computed once for all tests.
fn computed() -> &'static ComputedStiffness {
    static COMPUTED: OnceLock<ComputedStiffness> = OnceLock::new();
    COMPUTED.get_or_init(|| ComputedStiffness::new(&finray9()))
}

fn shipped() -> Vec<Measurement> {
    parse(STIFFNESS[0].text, STIFFNESS[0].file).unwrap()
}

fn model() -> Model {
    fit(&shipped(), &finray9()).unwrap()
}

fn percent(model: &Model, axis: Axis, kind: ModelKind) -> f64 {
    let row = model.loo.iter().find(|row| row.axis == axis && row.model == kind);
    row.unwrap().mean_absolute_percent
}

#[test]
fn the_linear_model_has_the_published_error_and_the_chosen_model_a_smaller_one() {
    let model = model();
    for (axis, reference) in [(Axis::Assembly, 1.6), (Axis::Compliance, 10.0)] {
        let linear = percent(&model, axis, ModelKind::Linear);
        assert!((linear - reference).abs() < 0.06, "{axis:?}: {linear}");
        let chosen = model.chosen(axis).unwrap();
        assert!(chosen.mean_absolute_percent < 0.93 * reference, "{axis:?}: {chosen:?}");
    }
}

/// The expected values are those of egobox-gp 0.37.1, an independent implementation, for the shipped measurements.
#[test]
fn predictions_agree_with_another_library() {
    let model = model();
    for (infill, expected) in [
        ([10.0, 0.0], [5.2407564e+04, 5.3508625e+02, 1.1803913e+03, 9.8741280e+01]),
        ([10.0, 40.0], [1.6112269e+04, 4.3299436e+02, 2.3883293e+03, 3.2799396e+02]),
        ([15.0, 30.0], [2.9998988e+04, 3.1830368e+02, 2.4311270e+03, 3.3406153e+02]),
        ([17.0, 23.0], [3.8957195e+04, 4.0962629e+02, 2.3136039e+03, 3.0205311e+02]),
        ([20.0, 20.0], [4.4999754e+04, 4.6231767e+02, 2.4605630e+03, 3.4026350e+02]),
        ([22.0, 5.0], [6.2128469e+04, 6.6599275e+02, 2.2879320e+03, 2.9536785e+02]),
        ([30.0, 0.0], [7.4973440e+04, 7.5715896e+02, 2.7586693e+03, 4.3252251e+02]),
        ([30.0, 40.0], [3.5008539e+04, 3.6577085e+02, 3.9575983e+03, 8.9717550e+02]),
    ] {
        let found = model.predict(infill).unwrap();
        let (z, y) = (found.assembly, found.compliance);
        for (found, expected) in [z.mean, z.sd, y.mean, y.sd].iter().zip(expected) {
            assert!((found / expected - 1.0).abs() < 1e-6, "{infill:?}: {found} {expected}");
        }
    }
}

#[test]
fn the_uncertainty_fits_the_errors_on_designs_left_out() {
    let model = model();
    for axis in Axis::ALL {
        let raw = model.chosen(axis).unwrap().standardised_rms;
        let calibrated = raw / model.widening(axis);
        assert!((0.4..=1.0 + 1e-12).contains(&calibrated), "{axis:?}: {raw} -> {calibrated}");
        assert!(raw < 1.5, "{axis:?}: the model is overconfident: {raw}");
    }
}

#[test]
fn stiffness_is_positive_everywhere_and_follows_the_physics() {
    let model = model();
    for density in (5..=60).map(f64::from) {
        for direction in (0..=60).map(f64::from) {
            let found = model.predict([density, direction]).unwrap();
            for axis in Axis::ALL {
                let Estimate { mean, sd } = found.axis(axis);
                assert!(mean > 0.0 && mean.is_finite() && sd > 0.0 && sd.is_finite());
            }
        }
    }
    // Inside the data: denser is stiffer; turning the ribs softens z, stiffens y.
    for density in (10..=30).map(f64::from) {
        for direction in (0..=40).map(f64::from) {
            let here = model.predict([density, direction]).unwrap();
            if density < 30.0 {
                let denser = model.predict([density + 1.0, direction]).unwrap();
                assert!(denser.assembly.mean > here.assembly.mean, "{density} {direction}");
                assert!(denser.compliance.mean > here.compliance.mean, "{density} {direction}");
            }
            if direction < 40.0 {
                let turned = model.predict([density, direction + 1.0]).unwrap();
                assert!(turned.assembly.mean < here.assembly.mean, "{density} {direction}");
                assert!(turned.compliance.mean >= here.compliance.mean, "{density} {direction}");
            }
        }
    }
}

#[test]
fn the_hull_is_that_of_the_measured_designs() {
    let model = model();
    for inside in [[10.0, 10.0], [15.0, 30.0], [20.0, 40.0], [30.0, 0.0], [22.0, 17.0]] {
        assert!(model.predict(inside).unwrap().inside_hull(), "{inside:?}");
    }
    let outside = model.predict([40.0, 20.0]).unwrap();
    assert!((outside.hull_distance - 0.5).abs() < 1e-12);
    assert!(!model.predict([10.0, 40.0]).unwrap().inside_hull());
    // Farther away predictions are less certain.
    let [near, far] = [20.0, 60.0].map(|at| model.predict([at, at]).unwrap().assembly);
    assert!(far.sd / far.mean > near.sd / near.mean);
}

#[test]
fn errors_name_the_line_and_what_is_accepted() {
    let refuses = |from: &str, to: &str, words: &[&str]| {
        let parsed = parse(&STIFFNESS[0].text.replacen(from, to, 1), "mine.csv");
        refused(parsed, &[words, &["mine.csv"]].concat());
    };
    refuses("design,", "Design,", &["line 1", "header must be exactly `design,infill"]);
    for (to, words) in [
        ("4,20,0,65", &["line: 5", "4 fields"][..]),
        ("4,20,0,NaN,1.95", &["line 5", "stiffness_assembly", "must lie in"]),
        ("4,20,0,65,-1", &["line 5", "stiffness_compliance", "must lie in"]),
        ("4,20,0,65,inf", &["line 5", "stiffness_compliance", "must lie in"]),
        ("4,20,0,65,soft", &["line 5", "`soft` is not a number"]),
        ("4,120,0,65,1.95", &["line 5", "density", "1 .. 100"]),
        ("4,20,-5,65,1.95", &["line 5", "direction", "0 .. 90"]),
        ("x,20,0,65,1.95", &["line 5", "design", "whole number"]),
        ("3,20,0,65,1.95", &["line 5", "design 3 is given twice"]),
        ("4,15,30,65,1.95", &["line 5", "same density", "average"]),
    ] {
        refuses("4,20,0,65,1.95", to, words);
    }
    let empty = STIFFNESS[0].text.lines().next().unwrap();
    assert_eq!(parse(empty, "mine.csv"), Err(SurrogateError::Empty));
    // A column in another unit than that of the header.
    for (value, question) in [("1950", "divide by 1000"), ("0.00195", "multiply by 1000")] {
        let one = parse(&format!("{empty}\n1,20,0,65,{value}\n"), "mine.csv");
        refused(one, &["mine.csv", "stiffness_compliance_n_per_mm", question]);
    }
}

#[test]
fn exact_or_one_dimensional_data_give_a_model_or_an_error_but_no_panic() {
    let line = |f: &dyn Fn(f64) -> (f64, f64)| -> Vec<Measurement> {
        (0..8)
            .map(|i| {
                let (density_percent, direction_deg) = f(f64::from(i));
                Measurement {
                    design: i as u32,
                    density_percent,
                    direction_deg,
                    assembly: 20.0 * N_PER_MM,
                    compliance: 2.0 * N_PER_MM,
                }
            })
            .collect()
    };
    for data in [line(&|i| (10.0 + i, 0.0)), line(&|i| (20.0, 5.0 * i)), line(&|i| (10.0 + i, i))] {
        if let Ok(model) = fit(&data, &finray9()) {
            let found = model.predict([20.0, 20.0]).unwrap().assembly;
            assert!(found.mean > 0.0 && found.sd > 0.0, "{found:?}");
        }
    }
}

/// Fingers of a material with half the stiffness: one measurement determines the stiffness of all others.
#[test]
fn one_finger_of_another_material_determines_the_scale() {
    let soft = |design, density_percent, direction_deg| {
        let infill = [density_percent, direction_deg];
        let half = |axis| 0.5 * computed().stiffness(axis, infill).unwrap();
        let (assembly, compliance) = (half(Axis::Assembly), half(Axis::Compliance));
        Measurement { design, density_percent, direction_deg, assembly, compliance }
    };
    let all = [soft(1, 20.0, 20.0), soft(2, 30.0, 40.0), soft(3, 10.0, 0.0)];
    let spread = |count: usize| {
        let model = fit(&all[..count], &finray9()).unwrap();
        let found = model.predict([10.0, 0.0]).unwrap();
        for axis in Axis::ALL {
            let ratio = found.axis(axis).mean / all[2].stiffness(axis);
            assert!((ratio - 1.0).abs() < 1e-9, "{axis:?} from {count}: {ratio}");
        }
        let none = model.loo.iter().all(|row| row.mean_absolute_percent.is_nan());
        assert_eq!(none, count == 1, "one finger leaves no error");
        found.compliance.sd / found.compliance.mean
    };
    let [one, two] = [1, 2].map(spread);
    assert!(one > 0.15 && two < one, "{one} {two}");
}

#[test]
fn a_density_that_cannot_be_printed_is_named() {
    let model = fit(&shipped()[..1], &finray9()).unwrap();
    refused(model.predict([99.0, 0.0]), &["finray9.toml", "density"]);
}

/// The scatter assumed for another material is that of the shipped fingers.
#[test]
fn the_assumed_scatter_is_that_of_the_shipped_fingers() {
    for (axis, assumed) in Axis::ALL.into_iter().zip(super::computed::SCATTER) {
        let shipped = shipped();
        let log = |m: &Measurement| {
            libm::log(m.stiffness(axis) / computed().stiffness(axis, m.infill()).unwrap())
        };
        let logs: Vec<f64> = shipped.iter().map(log).collect();
        let scatter = (Moments::of(&logs).squares / super::computed::DEGREES_OF_FREEDOM).sqrt();
        assert!((scatter - assumed).abs() < 0.005, "{axis:?}: {scatter}");
    }
}
