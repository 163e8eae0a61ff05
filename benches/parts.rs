//! Times of the parts that a study is made of: `cargo bench`.

use ask_tell::{Grid, Observation, OptimizerKind, build};
use contact::Engine;
use contact::direct::Direct;
use criterion::{Criterion, criterion_group, criterion_main};
use finger_opt::study::{
    FileStore, IfChanged, Inputs, JOURNAL_FILE, Journal, Provenance, Runner, Simulated, Study,
    StudyConfig,
};
use finray::printed::PrintedFinger;
use input::shipped::{FINGERS, ROBOTS, SPACES, STIFFNESS, TASKS};
use input::units::N_PER_MM;
use insertion::evaluation::evaluator::Evaluator;
use insertion::evaluation::objective::{Measure, Objectives};
use insertion::evaluation::robustness::Plan;
use insertion::evaluation::template::Template;
use insertion::evaluation::tolerance::{self, Search};
use insertion::finger::Finger;
use insertion::finger::model::{FingerModelKind, FingerSource};
use insertion::robot::Robot;
use insertion::space::Space;
use insertion::stiffness;
use insertion::surrogate::{self, Model};
use insertion::task::Task;
use insertion::trial::engine::EngineKind;
use insertion::trial::run::EngineRig;
use insertion::trial::{Rig, cell};
use std::collections::BTreeMap;
use std::hint::black_box;
use std::path::Path;
use std::sync::atomic::AtomicBool;

fn task() -> Task {
    let usb = TASKS.iter().find(|task| task.name == "usb").expect("shipped");
    Task::parse(usb.text, usb.file).expect("valid")
}

fn robot() -> Robot {
    Robot::parse(ROBOTS[0].text, ROBOTS[0].file).expect("valid")
}

fn space() -> Space {
    Space::parse(SPACES[0].text, SPACES[0].file).expect("valid")
}

fn model() -> Model {
    let data = stiffness::parse(STIFFNESS[0].text, STIFFNESS[0].file).expect("valid");
    let finger = PrintedFinger::parse(FINGERS[0].text, FINGERS[0].file).expect("valid");
    surrogate::fit(&data, &finger).expect("fits")
}

fn simulation(c: &mut Criterion) {
    let finger = Finger::new(2.6 * N_PER_MM, 45.0 * N_PER_MM);
    let mounted = robot().mount(0.0, 0.0).expect("in reach");
    let mut world = Direct::default().world(&cell::build(&task(), &mounted, &finger).scene);
    c.bench_function("step", |b| b.iter(|| world.step()));
    let rig = EngineRig::new(task(), &robot(), Box::new(Direct::default())).expect("fits");
    let grasped = rig.grasp(&finger);
    c.bench_function("trial", |b| b.iter(|| grasped.trial(0.0)));
    c.bench_function("evaluation", |b| {
        b.iter(|| tolerance::evaluate(&rig, &finger, Search::default()));
    });
}

fn proposals(c: &mut Criterion) {
    let model = model();
    c.bench_function("surrogate", |b| b.iter(|| model.predict(black_box(17.0), black_box(23.0))));
    // As many designs known as in the middle of a study of 100.
    let mut gp = build(OptimizerKind::Gp, Grid::new(space().levels()), 0);
    for _ in 0..12 {
        let observed = |point: ask_tell::GridPoint| {
            let value = space().design(&point).get("infill_density_percent");
            Observation::new(point, value)
        };
        let told: Vec<Observation> = gp.ask(4).into_iter().map(observed).collect();
        gp.tell(&told);
    }
    c.bench_function("suggestion of 4, gp, 48 known", |b| b.iter(|| gp.ask(4)));
}

fn config(budget: u64) -> StudyConfig {
    StudyConfig {
        tasks: vec!["usb".into()],
        robot: "servo".into(),
        optimizer: "random".into(),
        objective: Objectives::of(Measure::Range),
        constraints: Vec::new(),
        aggregate: None,
        uncertainty: None,
        seed: 0,
        budget,
        polish: 0,
        finger_model: FingerModelKind::Paper,
        batch: 4,
        asynchronous: false,
        provenance: Provenance::new(EngineKind::Fake, BTreeMap::new()),
        space: space(),
    }
}

fn evaluator() -> Evaluator {
    let usb = TASKS.iter().find(|task| task.name == "usb").expect("shipped");
    Evaluator {
        surrogate: model().into(),
        fingers: FingerSource::Paper,
        templates: vec![Template::parse(usb.text, usb.file).expect("valid")],
        robot: robot(),
        engine: EngineKind::Fake,
    }
}

/// A study of 100 random designs on the fake engine.
fn study(dir: &Path, evaluator: &Evaluator) -> Study {
    let (config, inputs) = (config(100), Inputs::new());
    let mut study =
        Study::create_or_continue(dir, &config, &inputs, IfChanged::Refuse).expect("a new study");
    let stop = AtomicBool::new(false);
    let pool = rayon::ThreadPoolBuilder::new().num_threads(1).build().expect("a thread");
    let runner = Runner {
        evaluator: &Simulated {
            evaluator,
            search: Search::default(),
            plan: &Plan::WINDOW,
            cache: None,
            stop: &stop,
        },
        pool: &pool,
        stop: &stop,
    };
    let mut random = build(OptimizerKind::Random, Grid::new(space().levels()), 0);
    runner.run(&mut study, &mut *random, &mut |_| ()).expect("runs");
    study
}

fn studies(c: &mut Criterion) {
    let evaluator = evaluator();
    c.bench_function("study of 100, fake engine", |b| {
        b.iter(|| study(tempfile::tempdir().expect("a folder").path(), &evaluator));
    });
    let dir = tempfile::tempdir().expect("a folder");
    let recorded = study(dir.path(), &evaluator).evaluations.remove(0);
    let path = dir.path().join(format!("other-{JOURNAL_FILE}"));
    let store = Box::new(FileStore::open(&path).expect("a file"));
    let (mut journal, _) = Journal::open(store, &path, &config(100)).expect("a journal");
    c.bench_function("journal append", |b| b.iter(|| journal.append(&recorded)));
}

criterion_group! {
    name = benches;
    config = Criterion::default().sample_size(10)
        .warm_up_time(std::time::Duration::from_millis(300))
        .measurement_time(std::time::Duration::from_secs(2));
    targets = simulation, proposals, studies
}
criterion_main!(benches);
