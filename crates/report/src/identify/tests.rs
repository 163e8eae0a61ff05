use super::html;
use calibration::identify::check::Remark;
use calibration::identify::curves::Curves;
use calibration::identify::formulas::{Friction, Slide};
use calibration::identify::log::Run;
use calibration::identify::misfit::Validation;
use calibration::identify::question::{Compared, IdentificationResult, Identified};
use calibration::identify::replay::Logged;
use calibration::identify::smoother::Smoothed;
use calibration::identify::tests::fixtures::synthetic;
use calibration::identify::unknown::{Unknown, ValueOrigin};
use input::shipped::{PRIORS, ROBOTS};
use insertion::{Design, Estimate, FailureClass, Outcome, Priors, Robot};

const FILE: &str = "<b>1.csv";

fn attempt() -> Compared {
    let mut log = synthetic(0.5, 1.0);
    log.file = FILE.to_owned();
    let design = Design::infill(10.0, 0.0);
    let outcome = Some(Outcome::Inserted);
    let run = Run { log, design, offset: 0.0022, outcome, line: 2 };
    let logged = Logged::new(&run).unwrap();
    let simulated = |share: f64| {
        let force = logged.curves.force.iter().map(|force| force * share).collect();
        (Curves { force, ..logged.curves.clone() }, Outcome::Inserted)
    };
    Compared { before: simulated(0.2), after: simulated(0.95), logged }
}

/// Returns a result from twelve attempts and a probe: the first parameter is fitted, the others are not identifiable.
fn done() -> IdentificationResult {
    let cell = Priors::parse(PRIORS[0].text, PRIORS[0].file).unwrap();
    let unknown = |(i, prior): (usize, &parameters::Parameter)| Unknown {
        prior: prior.clone(),
        posterior: prior.clone(),
        remaining_sd: Some([0.3, 0.25]),
        from: if i == 0 { ValueOrigin::Fit } else { ValueOrigin::Prior },
        advice: (i > 0).then_some("a probe"),
    };
    let slide = |forth: bool| Slide { forth, ratio: 0.2, rising: !forth };
    let probe = Friction { slides: vec![slide(true), slide(false)], coefficient: None };
    let found = Identified {
        robot: Robot::parse(ROBOTS[0].text, ROBOTS[0].file).unwrap(),
        flange: [None; 3],
        preload: Some(Estimate { mean: 2.5e-4, sd: 1e-5 }),
        probes: vec![("probe.csv".to_owned(), probe)],
        unknowns: cell.parameters.iter().enumerate().map(unknown).collect(),
        smoothed: Smoothed {
            members: Vec::new(),
            expected_sd: Vec::new(),
            misfit: vec![2.0, 0.5],
            compared: 0.9,
        },
        compared: (0..12).map(|_| attempt()).collect(),
        held_out: Some(attempt()),
    };
    let text = "the sensor is saturated".to_owned();
    let remark = Remark { file: FILE.to_owned(), lines: Some([3, 9]), text, serious: true };
    let (file, text) = ("runs.csv".to_owned(), "the tool sinks".to_owned());
    let of_all = Remark { file: file.clone(), lines: None, text, serious: false };
    IdentificationResult {
        task: "usb".to_owned(),
        runs: file,
        remarks: vec![remark, of_all],
        found,
        cell,
    }
}

#[test]
fn a_cell_that_predicts_worse_than_it_explains_is_doubtful() {
    let mut done = done();
    let same = Validation::of(&done.found).unwrap();
    assert!((same.misfit - same.misfit_fitted).abs() < 1e-9 && !same.is_doubtful());
    let held_out = attempt();
    done.found.held_out = Some(Compared { after: held_out.before.clone(), ..held_out });
    let worse = Validation::of(&done.found).unwrap();
    assert!(worse.is_doubtful(), "{worse:?}");
    assert!(html(&done).contains("do not trust predictions of this cell"));
    assert!(super::text(&done).contains("warning: An attempt that was not fitted"));
    done.found.held_out = None;
    assert!(!html(&done).contains("not fitted ("));
}

#[test]
fn an_attempt_that_ends_differently_is_marked() {
    let mut done = done();
    let fewer = "warning: fewer end as measured than before";
    assert!(!super::text(&done).contains(fewer));
    let simulated = &mut done.found.compared[0].after;
    simulated.1 = Outcome::Failed(FailureClass::Jammed);
    simulated.0.force.truncate(100);
    let page = html(&done);
    assert!(page.contains("The identified cell predicts: jammed (class 3)."));
    assert!(page.contains("The blue curve ends at 0.20 s with the simulated attempt: jammed"));
    assert!(page.contains("11 of 12 attempts are simulated to end as measured"));
    assert!(page.contains(" numbers; fewer end as measured than before: do not trust"));
    assert!(super::text(&done).contains(fewer));
    assert!(super::text(&done).contains("\nranges        not validated by these logs"));
    done.found.compared[0].before.1 = Outcome::Failed(FailureClass::Jammed);
    assert!(!super::text(&done).contains(fewer), "as many as before");
}

#[test]
fn the_page_has_every_number_and_curve_and_runs_no_name() {
    let done = done();
    let page = html(&done);
    let has = |text: &str| assert!(page.contains(text), "{text}");
    has("<h1>usb: 1 of ");
    has("From 12 attempts and 1 probe.");
    has("2.00 to 0.50 standard deviations over the iterations; 90 % of the data compared");
    has("12 of 12 attempts are simulated to end as measured; 12 with");
    assert!(page.find("the tool sinks.") < page.find("class=\"warn\""), "the result comes first");
    has("&lt;b&gt;1.csv: lines 3 to 9: the sensor is saturated");
    has("not identifiable: a probe");
    has(
        "not fitted (&lt;b&gt;1.csv, start +2.2 mm): inserted, predicted inserted; misfit of the force ",
    );
    has("0.200 (the part turned)");
    has("10 % infill at 0°, start +2.2 mm: inserted");
    done.found.unknowns.iter().for_each(|one| has(&one.posterior.name));
    assert_eq!(page.matches("force along z (N)").count(), 12);
    assert!(!page.contains(FILE) && !page.contains("://"));
    assert!(page.len() < 1_000_000, "{}", page.len());
}
