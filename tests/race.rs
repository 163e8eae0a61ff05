//! Races for the success rate: exact, and the same whoever runs them and however often.

use crate::common::{Studies, in_process};
use ::study::StudyRecord;
use ask_tell::{Grid, Optimizer, OptimizerKind, build};
use finger_opt::command::parse;
use finger_opt::commands::study;
use finger_opt::studies::ask_tell::{AskTellStudy, NextStep, perform};
use insertion::evaluation::Evaluation;
use insertion::evaluation::evaluator::{Evaluate, Evaluations};
use insertion::evaluation::robustness::race::{self, Race};
use insertion::evaluation::template::DesignError;
use insertion::evaluation::tolerance::{Search, evaluate};
use insertion::finger::Finger;
use insertion::outcome::{FailureClass, Outcome};
use insertion::space::Design;
use insertion::surrogate::Prediction;
use insertion::tests::fake::FakeRig;
use insertion::trial::NEVER;
use proptest::prelude::*;
use std::sync::atomic::AtomicBool;

const FIXTURE: &str = include_str!("fixtures/study/study.toml");

/// Outcomes of every draw, by the two infill numbers of a design: rows of another length than the
/// space, so that neighbours differ.
#[derive(Debug, Clone)]
struct Table {
    outcomes: Vec<Vec<Outcome>>,
}

impl Table {
    fn of(&self, design: &Design) -> &[Outcome] {
        let number = |key| design.get(key).unwrap_or(0.0) as usize;
        let at = 7 * number("infill_density_percent") + number("infill_direction_deg");
        &self.outcomes[at % self.outcomes.len()]
    }

    fn measured(&self, design: &Design, race: Option<&Race>) -> Evaluations {
        let outcomes = self.of(design);
        let drawn = |draw: u32| outcomes[draw as usize];
        let success = Some(race::run(outcomes.len() as u32, 0.95, race, drawn));
        let window = evaluate(&FakeRig::default(), &Finger::new(3e3, 2e4), Search::Strides);
        let stiffness = Prediction::exact(3e3, 2e4);
        Evaluations { stiffness, tasks: vec![Evaluation { success, ..window }], cached: Vec::new() }
    }
}

impl Evaluate for Table {
    fn evaluate(&self, design: &Design, race: Option<&Race>) -> Result<Evaluations, DesignError> {
        Ok(self.measured(design, race))
    }
}

fn outcome() -> impl Strategy<Value = Outcome> {
    let failed = prop::sample::select(FailureClass::ALL.to_vec()).prop_map(Outcome::Failed);
    prop_oneof![6 => Just(Outcome::Inserted), 3 => failed, 1 => Just(Outcome::Diverged)]
}

fn table() -> impl Strategy<Value = Table> {
    (1..30usize).prop_flat_map(|draws| {
        let rows = prop::collection::vec(prop::collection::vec(outcome(), draws), 5..60);
        rows.prop_map(|outcomes| Table { outcomes })
    })
}

/// A study of 24 evaluations.
struct Racing(Studies);

impl Racing {
    fn new(keys: &str, batch: u32) -> Self {
        let config = FIXTURE.replace("\"range\"", "\"success-rate\"");
        let config =
            config.replace("budget = 10\nbatch = 4", &format!("budget = 24\nbatch = {batch}"));
        let keys = format!("uncertainty = \"typical\"\n{keys}\n[provenance]");
        let studies = Studies::new();
        studies.file("study.toml", config.replacen("[provenance]", &keys, 1));
        Racing(studies)
    }

    fn run(&self, table: &Table, threads: usize) -> StudyRecord {
        let random = |grid: Grid| -> Box<dyn Optimizer> { build(OptimizerKind::Random, grid, 3) };
        in_process::run(self.0.0.path(), table, &random, threads).unwrap().1
    }

    fn journal(&self) -> String {
        self.0.journal(".")
    }
}

fn rates(record: &StudyRecord) -> Vec<Option<f64>> {
    record.evaluations.iter().map(|recorded| recorded.value()).collect()
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(24))]

    /// The designs do not depend on what is told here, so both studies evaluate the same. On one
    /// thread results arrive in the order of their proposals, also those that are told as they come.
    #[test]
    fn the_best_of_a_race_is_the_best_of_full_counts(
        table in table(),
        batch in 1..9u32,
        at in 0.0..1.0f64,
        (keys, threads) in prop::sample::select(vec![("", [2, 4]), ("async = true\n", [1, 1])]),
    ) {
        let racing = Racing::new(&format!("{keys}race = true"), batch);
        let (raced, counted) =
            (racing.run(&table, threads[0]), Racing::new(keys, batch).run(&table, 1));
        prop_assert!(counted.evaluations.iter().all(|recorded| !recorded.raced()));
        let best = |record: &StudyRecord| record.recommended().map(|best| (best.index, best.value()));
        prop_assert_eq!(best(&raced), best(&counted));
        let equals = |record: &StudyRecord| -> Vec<u64> {
            let index = record.recommended().map_or(0, |best| best.index);
            let losses = record.losses(index).into_iter();
            let equal = losses.filter(|(_, loss)| record.is_equivalent(*loss));
            equal.map(|(recorded, _)| recorded.index).collect()
        };
        prop_assert_eq!(equals(&raced), equals(&counted));
        let best = counted.best().and_then(|best| best.value());
        for ((one, bound), rate) in raced.evaluations.iter().zip(rates(&raced)).zip(rates(&counted)) {
            // All of a raced design that was left may have diverged; some of it failed.
            let sound = if one.raced() { rate <= bound && bound < best } else { rate == bound };
            prop_assert!(sound, "{rate:?}, at most {bound:?}, {best:?}");
        }
        // Killed anywhere, gone on with by any number of threads.
        let (expected, whole) = (racing.journal(), racing.0.read("journal.jsonl"));
        racing.0.file("journal.jsonl", &whole[..(at * whole.len() as f64) as usize]);
        racing.run(&table, threads[1]);
        prop_assert_eq!(racing.journal(), expected);
    }
}

/// Errors by another name than the shipped ones, kept with the study.
fn errors(studies: &Studies) -> String {
    let text = include_str!("../uncertainties/typical.toml");
    studies.file("errors.toml", text.replace("\"typical\"", "\"mine\""))
}

/// The journal of a study that is measured by workers.
fn by_workers(studies: &Studies, errors: &str) -> String {
    let line = "--task usb --engine fake --budget 24 --objective success-rate --uncertainty";
    let words = line.split(' ').map(str::to_owned).chain([errors.to_owned()]);
    let mut request: study::Request = parse(words).unwrap();
    request.out = Some(studies.dir("workers"));
    let Ok(mut guided) = request.open(None).and_then(AskTellStudy::new) else { panic!("no study") };
    while let Ok(NextStep::Evaluate(works)) = guided.next_step(&AtomicBool::new(false)) {
        for (proposal, work) in works.into_iter().rev() {
            let result = perform(&work, "a worker", &NEVER).unwrap_or_else(|e| panic!("{e}"));
            assert!(matches!(guided.take(proposal, &result), Ok(true)));
        }
    }
    studies.journal("workers")
}

fn raced(studies: &Studies, name: &str) -> usize {
    let journal = studies.journal(name);
    journal.lines().filter(|line| line.contains("\"success_spared_draws\"")).count()
}

#[test]
fn a_race_leaves_one_journal_whoever_measures_and_whatever_the_cache_holds() {
    let studies = Studies::new();
    let errors = errors(&studies);
    let cache = studies.word("cache");
    let asked = ["--objective", "success-rate", "--uncertainty", &errors];
    studies.study("s", 24, &asked).succeeds();
    let expected = studies.journal("s");
    assert!((3..21).contains(&raced(&studies, "s")), "{} raced", raced(&studies, "s"));
    assert_eq!(by_workers(&studies, &errors), expected);
    // Full counts of the same draws are in the cache, too.
    let limited = ["--constraint", "success-rate>=0.1", "--cache", &cache];
    studies.study("full", 12, &[&asked[..], &limited].concat()).succeeds();
    assert_eq!(raced(&studies, "full"), 0, "a limit needs full counts");
    for (name, threads) in [("1", "1"), ("2", "2"), ("again", "4")] {
        let more = ["--threads", threads, "--cache", &cache];
        studies.study(name, 24, &[&asked[..], &more].concat()).succeeds();
        assert_eq!(studies.journal(name), expected, "{name}");
    }
}

#[test]
fn a_bound_is_said_and_shown_as_one() {
    let studies = Studies::new();
    let errors = errors(&studies);
    let asked = ["--objective", "success-rate", "--uncertainty", &errors, "--verbose"];
    let ran = studies.study("s", 24, &asked);
    let said = format!("{} of 24 designs ended early", raced(&studies, "s"));
    ran.says(&[&said]);
    let page = studies.page("s");
    for said in [&said, "at most 0.", "at most (raced)"] {
        assert!(page.contains(said), "{said}");
    }
    let [rate, share, draws, at_most] =
        ["success_rate", "objective_share", "raced_draws", "success_at_most"]
            .map(|key| studies.column("s", key));
    assert_eq!(rate, share);
    for row in 0..24 {
        assert_ne!(rate[row].is_empty(), draws[row].is_empty());
        assert_eq!(draws[row].is_empty(), at_most[row].is_empty());
    }
    let bounds = draws.iter().filter(|cell| !cell.is_empty()).count();
    assert_eq!(bounds, raced(&studies, "s"));
}
