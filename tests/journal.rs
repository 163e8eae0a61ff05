//! The journal's lines and files: round trips, damage, failing writes, old versions.

use crate::common::{Studies, in_process, lines, read, sealed, strip_times};
use ask_tell::GridPoint;
use ask_tell::{Grid, Observation, Optimizer, StopReason};
use insertion::evaluation::evaluator::{Evaluate, Evaluations};
use insertion::evaluation::objective::Score;
use insertion::evaluation::robustness::race::Race;
use insertion::evaluation::template::{DesignError, Template};
use insertion::evaluation::tolerance::{Search, evaluate};
use insertion::evaluation::{Evaluation, RobustRange, SuccessRate, Window};
use insertion::finger::Finger;
use insertion::finger::model::FingerSource;
use insertion::outcome::{FailureClass, Outcome};
use insertion::space::{Design, Space};
use insertion::surrogate::{Estimate, Prediction};
use insertion::tests::fake::FakeRig;
use proptest::prelude::*;
use std::panic::{AssertUnwindSafe, catch_unwind};
use std::path::{Path, PathBuf};
use study::{Ending, Recorded, StudyError, StudyRecord, Timing, decode, encode};

const FIXTURE: &str = concat!(env!("CARGO_MANIFEST_DIR"), "/tests/fixtures/study");

fn space() -> Space {
    Space::parse(include_str!("../spaces/infill.toml"), "infill.toml").unwrap()
}

fn outcome() -> impl Strategy<Value = Outcome> {
    prop_oneof![
        Just(Outcome::Inserted),
        Just(Outcome::Diverged),
        prop::sample::select(FailureClass::ALL.to_vec()).prop_map(Outcome::Failed),
    ]
}

fn finite() -> impl Strategy<Value = f64> {
    any::<f64>().prop_filter("finite", |value| value.is_finite())
}

fn success() -> impl Strategy<Value = SuccessRate> {
    let counts = (0..1000u32, [0..1000u32, 0..1000, 0..1000, 0..1000], any::<u32>(), any::<u32>());
    let draws = prop::collection::vec(any::<u32>(), 0..20);
    (counts, 0.01..0.99f64, draws).prop_map(|(counts, confidence, failed_draws)| {
        let (inserted, failure_counts, diverged, skipped) = counts;
        SuccessRate { inserted, failure_counts, diverged, confidence, failed_draws, skipped }
    })
}

fn robust() -> impl Strategy<Value = RobustRange> {
    let ranges = prop::collection::vec(finite(), 0..20);
    (ranges, any::<u32>(), prop::option::of(finite()), any::<u32>()).prop_map(
        |(ranges_mm, diverged, value_mm, trials)| RobustRange {
            ranges_mm,
            diverged,
            value_mm,
            trials,
        },
    )
}

fn evaluation() -> impl Strategy<Value = Evaluation> {
    let drawn = (prop::option::of(success()), prop::option::of(robust()));
    let ends = (prop::option::of(outcome()), prop::option::of(outcome()));
    let window = (outcome(), -150..=0i32, 0..=150i32, ends);
    let counts = (any::<[u32; 4]>(), any::<u32>(), any::<u32>());
    let shares = [finite(), finite()];
    let measured = ([finite(), finite(), finite()], shares);
    (window, counts, measured, drawn).prop_map(|(window, counts, measured, (success, robust))| {
        let (nominal, negative_steps, positive_steps, (mut end_negative, end_positive)) = window;
        // An empty window ends as its nominal start does.
        if matches!(nominal, Outcome::Failed(_)) {
            end_negative = Some(nominal);
        }
        let (failure_counts, diverged, trials) = counts;
        let ([peak_force_n, slip_mm, simulated_s], end_shares) = measured;
        Evaluation {
            window: Window { nominal, negative_steps, positive_steps, end_negative, end_positive },
            failure_counts,
            diverged,
            robot_stops: trials % 2,
            trials,
            peak_force_n,
            slip_mm,
            simulated_s,
            end_shares,
            taught: None,
            success,
            robust,
        }
    })
}

fn score() -> impl Strategy<Value = Score> {
    let numbers = |least| prop::collection::vec(finite(), least..4);
    (numbers(1), numbers(0)).prop_map(|(values, violations)| Score { values, violations })
}

fn recorded() -> impl Strategy<Value = Recorded> {
    let design = [finite(), finite()];
    let k = 1.0..1e9f64;
    let stiffness = (k.clone(), k.clone(), k.clone(), k, finite());
    let tasks = prop::collection::vec(evaluation(), 1..4);
    (any::<u64>(), design, prop::option::of(score()), stiffness, tasks, 0.0..1e9f64).prop_map(
        |(index, [density, direction], score, k, tasks, wall_s)| Recorded {
            index,
            proposal: (index % 2 == 0).then_some(index / 3),
            design: Design::infill(density, direction),
            score,
            stiffness: Prediction {
                compliance: Estimate { mean: k.0, sd: k.1 },
                assembly: Estimate { mean: k.2, sd: k.3 },
                hull_distance: k.4,
            },
            tasks,
            timing: Timing {
                datetime_start: "2026-01-02T03:04:05.678901".to_owned(),
                datetime_complete: "2026-01-02T03:04:06.000000".to_owned(),
                wall_s,
                cached: Vec::new(),
            },
        },
    )
}

proptest! {
    #[test]
    fn a_line_reads_back_to_the_bit(recorded in recorded()) {
        let line = encode(&recorded, &space()).unwrap();
        prop_assert!(line.ends_with('\n') && line.lines().count() == 1);
        let read = decode(line.trim_end(), recorded.index).unwrap();
        // The stiffness is written to six decimals of a N/mm: 0.5e-3 N/m.
        let (a, b) = (read.stiffness, recorded.stiffness);
        prop_assert!((a.compliance.mean - b.compliance.mean).abs() < 1e-3);
        prop_assert!((a.assembly.sd - b.assembly.sd).abs() < 1e-3);
        prop_assert_eq!(encode(&read, &space()).unwrap(), line);
        prop_assert_eq!(Recorded { stiffness: b, ..read }, recorded);
    }

    #[test]
    fn a_changed_byte_is_noticed_or_concerns_only_the_times(
        recorded in recorded(),
        at in any::<prop::sample::Index>(),
        to in 0x20u8..0x7f,
    ) {
        let line = encode(&recorded, &space()).unwrap();
        let mut bytes = line.trim_end().as_bytes().to_vec();
        let at = at.index(bytes.len());
        prop_assume!(bytes[at] != to);
        bytes[at] = to;
        let damaged = String::from_utf8(bytes).unwrap();
        if let Ok(read) = decode(&damaged, recorded.index) {
            prop_assert_eq!(strip_times(&damaged), strip_times(&line));
            let Recorded { timing, stiffness, .. } = recorded.clone();
            prop_assert_eq!(Recorded { timing, stiffness, ..read }, recorded);
        }
    }
}

/// Walks the grid by strides that depend on what it was told.
struct Walk {
    grid: Grid,
    at: u32,
    stride: u32,
}

impl Optimizer for Walk {
    fn ask(&mut self, n: usize) -> Vec<GridPoint> {
        let (columns, rows) = (self.grid.levels()[0], self.grid.levels()[1]);
        let mut next = || {
            self.at = (self.at + self.stride) % (columns * rows);
            GridPoint(vec![self.at % columns, self.at / columns])
        };
        (0..n).map(|_| next()).collect()
    }

    fn tell(&mut self, observations: &[Observation]) {
        let values = observations.iter().filter_map(Observation::value);
        self.stride = 1 + (values.sum::<f64>() * 10.0) as u32 % 7;
    }

    fn stop(&self) -> Option<StopReason> {
        None
    }
}

/// The closed form for a finger whose stiffness follows from its infill.
struct ClosedForm;

impl Evaluate for ClosedForm {
    fn evaluate(&self, design: &Design, _: Option<&Race>) -> Result<Evaluations, DesignError> {
        let of = |key| Estimate { mean: 1e3 * design.get(key).unwrap_or(0.0) + 1e3, sd: 1.0 };
        let [compliance, assembly] = ["infill_direction_deg", "infill_density_percent"].map(of);
        let finger = Finger::new(compliance.mean, assembly.mean);
        Ok(Evaluations {
            stiffness: Prediction { compliance, assembly, hull_distance: 0.0 },
            tasks: vec![evaluate(&FakeRig::default(), &finger, Search::Strides)],
            cached: Vec::new(),
        })
    }
}

/// A folder of the fixture's configuration.
fn folder(studies: &Studies) -> PathBuf {
    std::fs::create_dir(studies.dir("s")).unwrap();
    std::fs::copy(format!("{FIXTURE}/study.toml"), studies.dir("s/study.toml")).unwrap();
    studies.dir("s")
}

fn walk(grid: Grid) -> Box<dyn Optimizer> {
    Box::new(Walk { grid, at: 0, stride: 1 })
}

/// Runs the study in a folder on two threads.
fn run(dir: &Path) -> Result<Ending, StudyError> {
    Ok(in_process::run(dir, &ClosedForm, &walk, 2)?.0)
}

/// Cannot evaluate a density of 3 levels above the lowest.
struct NotAll;

impl Evaluate for NotAll {
    fn evaluate(&self, design: &Design, _: Option<&Race>) -> Result<Evaluations, DesignError> {
        let usb = include_str!("../tasks/usb.toml");
        let template = Template::parse(usb, "usb.toml").unwrap();
        let tilt = (design.get("infill_density_percent") == Some(13.0)).then_some(90.0);
        let set = tilt.map(|tilt| ("task.strategy.tilt_deg".to_owned(), tilt));
        let at_pad = Prediction::exact(3e3, 2e4);
        let design = Design(set.into_iter().collect());
        let (_, finger) = template.apply(&design, &FingerSource::Paper, &at_pad)?;
        let one = Estimate { mean: 1e3, sd: 1.0 };
        Ok(Evaluations {
            stiffness: Prediction { compliance: one, assembly: one, hull_distance: 0.0 },
            tasks: vec![evaluate(&FakeRig::default(), &finger, Search::Walk)],
            cached: Vec::new(),
        })
    }
}

#[test]
fn a_design_that_cannot_be_stops_the_study_and_is_named() {
    let studies = Studies::new();
    let error = in_process::run(&folder(&studies), &NotAll, &walk, 1).unwrap_err();
    assert!(error.is_bad_input());
    let error = error.to_string();
    assert!(error.contains("evaluation 2 of infill_density_percent = 13"), "{error}");
    assert!(error.contains("strategy.tilt_deg: is 90; it must lie"), "{error}");
    assert_eq!(lines(&studies.dir("s/journal.jsonl")), 2 + 2);
}

struct Panics;

impl Evaluate for Panics {
    fn evaluate(&self, _: &Design, _: Option<&Race>) -> Result<Evaluations, DesignError> {
        panic!("a defect")
    }
}

#[test]
fn a_panic_in_a_measuring_thread_ends_the_study() {
    let studies = Studies::new();
    let dir = folder(&studies);
    let panics = AssertUnwindSafe(|| in_process::run(&dir, &Panics, &walk, 2));
    assert!(catch_unwind(panics).is_err());
    assert_eq!(run(&dir).unwrap(), Ending::BudgetSpent, "journal and lock are as they should be");
}

#[test]
fn a_journal_of_other_proposals_is_refused() {
    let studies = Studies::new();
    let dir = folder(&studies);
    std::fs::copy(format!("{FIXTURE}/journal.jsonl"), dir.join("journal.jsonl")).unwrap();
    let error = run(&dir).unwrap_err();
    let said = error.to_string();
    assert!(error.is_bad_input() && said.contains("evaluation 0 is of"), "{error}");
    assert!(said.contains("another version"), "{error}");
}

/// From the release of this format on, later versions must read this fixture as it stands.
#[test]
fn a_study_of_the_present_format_is_read() {
    let record = StudyRecord::load(Path::new(FIXTURE)).unwrap();
    assert_eq!((record.config.task_name().as_str(), record.config.budget), ("usb", 10));
    assert_eq!(record.evaluations.len(), 10);
    let best = record.best().unwrap();
    assert_eq!((best.index, best.value()), (4, Some(6.7)));
    assert_eq!(best.design, Design::infill(11.0, 6.0));
    assert_eq!(best.tasks[0].window.negative_mm(), -4.8);
    assert_eq!(best.tasks[0].failure_counts, [0, 1, 1, 0]);
    let stiffness = best.stiffness;
    assert_eq!((stiffness.compliance.mean, stiffness.assembly.sd), (1410.0, 2000.0));
    let diverged = &record.evaluations[6];
    assert_eq!((diverged.value(), diverged.tasks[0].diverged), (None, 1));
    assert_eq!(diverged.tasks[0].window.nominal, Outcome::Diverged);
    assert!(diverged.tasks[0].peak_force_n.is_nan());
}

#[test]
fn another_schema_version_is_refused() {
    let studies = Studies::new();
    std::fs::create_dir(studies.dir("new")).unwrap();
    for file in ["study.toml", "journal.jsonl"] {
        let text = read(&Path::new(FIXTURE).join(file));
        let text = text.replace("\"schema_version\":2,", "\"schema_version\":3,");
        std::fs::write(studies.dir("new").join(file), sealed(&text)).unwrap();
    }
    let error = StudyRecord::load(&studies.dir("new")).unwrap_err().to_string();
    assert!(error.contains("schema version is 3"), "{error}");
}
