//! `optimize evaluate`: simulates the tolerance window of one finger.

use crate::setup::finger::usage;
use crate::setup::measured;
use crate::setup::repeat::{RepeatRequest, bands_text, serialize_bands};
use crate::setup::task::warn_of_weak_grip;
use crate::{
    ChosenFinger, Context, Failure, FingerRequest, Output, Setup, SetupRequest, command, layout,
    not_stopped,
};
use calibration::experiments::Experiment;
use connector::push::{self, ShorterPush};
use insertion::evaluation::robustness::repeat::Bands;
use insertion::evaluation::tolerance::evaluate_grasp;
use insertion::{Evaluation, Grasp, Outcome, Plan, Scenario, Search, Task, grid_mm};
use report::answer::words::{self, mm, number};
use report::answer::{ExcessForce, lines};
use serde::{Serialize, Serializer};
use std::collections::BTreeMap;
use std::sync::atomic::AtomicBool;
use std::time::Instant;
use study::ByRibs;

/// Simulate the tolerance window of one finger
#[derive(Debug, Clone, Default, clap::Args)]
#[command(
    override_usage = usage("evaluate"),
    after_help = "Example: optimize evaluate --task usb --density 20 --direction 10 --walk"
)]
pub struct Request {
    /// One task, robot and finger model.
    #[command(flatten)]
    pub setup: SetupRequest,
    /// The finger.
    #[command(flatten)]
    pub finger: FingerRequest,
    /// Search step by step to the first failure: finds gaps narrower than 0.5 mm in three times the trials
    #[arg(long)]
    pub walk: bool,
    /// Also compute success rate and robust range under these errors: typical, or the path of a file
    #[arg(long, value_name = "NAME")]
    pub uncertainty: Option<String>,
    /// Seed of the drawn errors; the same draws as in a study with this seed
    #[arg(long, value_name = "N", default_value_t = 0, requires = "uncertainty")]
    pub seed: u64,
    /// Repeats at the window's ends.
    #[command(flatten)]
    pub repeat: Option<RepeatRequest>,
    /// Also print the finger's measured ranges from this file: published, or a path
    #[arg(long, value_name = "FILE")]
    pub measurements: Option<String>,
    /// Skip the window with stiffness computed from the ribs
    // Which of the two finger models agrees better with the bench depends on the task (docs/notes/finger.md).
    #[arg(long, hide = true)]
    pub no_ribs: bool,
}

/// Evaluation of a finger.
#[derive(Serialize)]
pub struct Evaluated {
    /// The finger on its task.
    #[serde(flatten)]
    pub chosen: ChosenFinger,
    /// Tolerance window and other simulated values.
    #[serde(flatten)]
    pub evaluation: Evaluation,
    /// Shorter push with which the robot does not stop, if it stops in most insertions and such a push is found.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub shorter_push: Option<ShorterPush>,
    /// Wall-clock duration of the evaluation, s.
    pub wall_s: f64,
    /// Measurements of this finger on the bench.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub measured: Vec<Experiment>,
    /// Bands of offsets at the window's ends in which repeats have different outcomes, with `--repeat`, and the number
    /// of impossible draws that were left out.
    #[serde(serialize_with = "serialize_bands", skip_serializing_if = "Option::is_none")]
    pub bands: Option<(Bands, usize)>,
    /// The same finger with stiffness computed from its ribs.
    #[serde(serialize_with = "computed", skip_serializing_if = "Option::is_none")]
    pub computed: Option<ByRibs>,
}

impl command::Request for Request {
    const PROGRESS: bool = true;

    fn run(&self, context: &Context<'_>) -> Result<Output, Failure> {
        let found = self.evaluated(context)?;
        Ok(Output::new(found.text(self.measurements.as_deref()), found))
    }
}

impl Request {
    /// Simulates the tolerance window of the finger.
    ///
    /// # Errors
    /// If an input cannot be used, or the run is cancelled.
    pub fn evaluated(&self, context: &Context<'_>) -> Result<Evaluated, Failure> {
        let stop = context.stop;
        let (setup, plan) = self.prepared()?;
        let chosen = self.finger.choose(&setup)?;
        let Scenario { task, robot, .. } = &chosen.scenario;
        warn_of_weak_grip(task, robot, setup.evaluator.engine, context)?;
        let busy = context.busy("simulating the finger");
        let measured = self.measured(&chosen)?;
        let clock = Instant::now();
        let evaluation = setup.evaluator.simulate(&chosen.scenario, self.search(), &plan, stop)?;
        not_stopped(stop)?;
        let wall_s = clock.elapsed().as_secs_f64();
        let shorter_push = shorter_push(&setup, &chosen, &evaluation, stop)?;
        let window = &evaluation.window;
        let computed = self.by_ribs(&setup, &chosen, stop)?;
        drop(busy);
        let bands = |repeat: RepeatRequest| {
            let (scenario, taught) = (&chosen.scenario, evaluation.taught);
            let cost = f64::from(repeat.count);
            let progress = |[done, of]: [usize; 2]| {
                let cost = f64::from(done > 0) * cost / of as f64;
                context.part("offsets of the repeats", [done, of], cost);
            };
            context.begin(cost);
            repeat
                .run(&setup, scenario, taught, context, |repeats| repeats.bands(window, &progress))
        };
        let repeat = self.repeat.filter(|_| window.nominal == Outcome::Inserted);
        let bands = repeat.map(bands).transpose()?;
        context.end();
        Ok(Evaluated { chosen, evaluation, shorter_push, bands, computed, wall_s, measured })
    }

    /// Returns the setup, and the plan of the trials under drawn errors.
    pub(crate) fn prepared(&self) -> Result<(Setup, Plan), Failure> {
        let mut setup = self.setup.setup()?;
        if let Some(name) = &self.uncertainty {
            setup = setup.with_named_uncertainty(name)?;
        }
        let plan = setup.plan(self.seed, [setup.uncertainty.is_some(); 2])?;
        Ok((setup, plan))
    }

    /// Returns the lines of the measurement file that have a range of the finger on its task.
    fn measured(&self, chosen: &ChosenFinger) -> Result<Vec<Experiment>, Failure> {
        let Some(name) = &self.measurements else { return Ok(Vec::new()) };
        let task = &chosen.scenario.task.name;
        let mut lines = measured::lines(&measured::file(name)?, &[task])?;
        lines.retain(|line| line.task == *task && line.design == chosen.design);
        lines.retain(|line| line.extent().is_some());
        Ok(lines)
    }

    pub(crate) fn search(&self) -> Search {
        if self.walk { Search::Walk } else { Search::Strides }
    }

    /// Evaluates the finger with stiffness computed from its ribs, from a taught start if the nominal start of the task
    /// fails; `None` if a finger model or a stiffness is given, or if the engine does not support computed fingers.
    fn by_ribs(
        &self,
        setup: &Setup,
        chosen: &ChosenFinger,
        stop: &AtomicBool,
    ) -> Result<Option<ByRibs>, Failure> {
        if self.no_ribs || self.setup.finger_model.kind.is_some() || chosen.given {
            return Ok(None);
        }
        let Some(evaluator) = setup.by_ribs() else { return Ok(None) };
        let chosen = self.finger.choose_with(setup, &evaluator);
        let measured = chosen.and_then(|ChosenFinger { scenario, .. }| {
            evaluator.simulate_or_teach(&scenario, self.search(), stop).map_err(Failure::input)
        });
        not_stopped(stop)?;
        Ok(Some(match measured {
            Ok(evaluation) => ByRibs::Measured(vec![evaluation]),
            Err(failure) => ByRibs::Refused(failure.to_string()),
        }))
    }
}

/// Finds a shorter push for an evaluation, if the robot stops in most of its trials.
fn shorter_push(
    setup: &Setup,
    ChosenFinger { scenario, .. }: &ChosenFinger,
    evaluation: &Evaluation,
    stop: &AtomicBool,
) -> Result<Option<ShorterPush>, Failure> {
    if !evaluation.mostly_stopped() {
        return Ok(None);
    }
    let again = |task: &Task| {
        let scenario = Scenario { task: task.clone(), ..scenario.clone() };
        let rig = setup.evaluator.rig(&scenario, evaluation.taught, 1.0)?;
        let grasp = Grasp { stop, ..Grasp::of(&scenario.finger) };
        let found = evaluate_grasp(&*rig, grasp, Search::default());
        not_stopped(stop).map(|()| found)
    };
    push::shorter_push(&scenario.task, &scenario.robot, again)
}

/// Serializes the evaluation by the ribs, or the reason why there is none.
fn computed<S: Serializer>(by_ribs: &Option<ByRibs>, serializer: S) -> Result<S::Ok, S::Error> {
    match by_ribs {
        None => serializer.serialize_none(),
        Some(ByRibs::Measured(tasks)) => tasks.first().serialize(serializer),
        Some(ByRibs::Refused(why)) => BTreeMap::from([("refused", why)]).serialize(serializer),
    }
}

impl Evaluated {
    /// Returns each measured range, or that the file has none, and advice if the simulated one differs from one by more
    /// than a factor of two.
    fn measured_lines(&self, file: Option<&str>) -> Vec<lines::Line> {
        let extents = self.measured.iter().filter_map(Experiment::extent);
        let line = |(range_mm, at_least): (f64, bool)| {
            let text = if at_least { "or more, on the bench" } else { "on the bench" };
            ("measured".to_owned(), format!("{} {text}", mm(range_mm)))
        };
        let simulated_mm = self.evaluation.window.range_mm();
        let apart = |(range_mm, at_least): (f64, bool)| {
            simulated_mm < 0.5 * range_mm || !at_least && range_mm < 0.5 * simulated_mm
        };
        let advice = extents.clone().any(apart).then(|| {
            let text = "do not trust the simulated range here: `optimize next` and a study with \
                        --measurements correct it by the measured ones";
            ("warning".to_owned(), text.to_owned())
        });
        let file = file.filter(|_| self.measured.is_empty());
        let none = file.map(|file| ("measured".to_owned(), format!("no range of it in {file}")));
        extents.map(line).chain(none).chain(advice).collect()
    }

    /// Returns a remark if no range was measured and those of both finger models differ by more than a factor of two.
    fn disagreement(&self) -> Option<&'static str> {
        let tasks = match &self.computed {
            Some(ByRibs::Measured(tasks)) if self.measured.is_empty() => tasks,
            _ => return None,
        };
        let range_mm = self.evaluation.window.range_mm();
        let apart = |ribs: &Evaluation| {
            let other_mm = ribs.window.range_mm();
            lines::comparable(ribs, &self.evaluation)
                && range_mm.min(other_mm) < 0.5 * range_mm.max(other_mm)
        };
        tasks.iter().any(apart).then_some(
            "the ranges differ by more than a factor of two: measure a finger before you rely on either",
        )
    }

    fn text(&self, file: Option<&str>) -> String {
        let Evaluated { chosen, evaluation, .. } = self;
        let [c1, c2, c3, c4] = evaluation.failure_counts;
        let Scenario { task, robot, .. } = &chosen.scenario;
        let force = ExcessForce::on(&task.name, evaluation, (task.limits.force, Some(robot)));
        // Robot stops are named in the first line.
        let stopped = evaluation.mostly_stopped();
        let force = force.filter(|excess| excess.of_connector || !stopped);
        let force = force.map(|excess| ("force".to_owned(), excess.words(&robot.name)));
        let mut rest: Vec<_> = force.into_iter().collect();
        rest.push(("range".to_owned(), mm(evaluation.window.range_mm())));
        rest.extend(self.measured_lines(file));
        rest.extend(lines::window(evaluation));
        let failures = format!(
            "{c1} of class 1, {c2} of 2, {c3} of 3, {c4} of 4, {} diverged in {} trials",
            evaluation.diverged, evaluation.trials
        );
        rest.push(("failures".to_owned(), failures));
        let peak = match evaluation.peak_force_n.is_nan() {
            true => "none: no trial inserts".to_owned(),
            false => number(evaluation.peak_force_n, 1, "N in the trials that insert"),
        };
        rest.push(("peak force".to_owned(), peak));
        rest.push(("mating force".to_owned(), words::mating_force(task.largest_mating_force())));
        rest.extend(lines::taught(evaluation.taught.map(grid_mm)));
        rest.extend(lines::drawn(evaluation));
        let by_ribs = |computed| lines::by_ribs(computed, (0, evaluation));
        rest.extend(self.computed.as_ref().and_then(by_ribs));
        rest.extend(self.disagreement().map(|remark| (String::new(), remark.to_owned())));
        let not_usable = stopped.then(|| {
            let remedy = push::remedy(self.shorter_push.as_ref());
            format!("{}. {remedy}\n", words::not_usable(evaluation, ""))
        });
        let (chosen, rest) = (not_usable.unwrap_or_default() + &chosen.text(), layout::lines(rest));
        let bands = self.bands.as_ref().map(bands_text).unwrap_or_default();
        layout::wrapped(&format!("{chosen}{rest}{bands}time          {:.1} s\n", self.wall_s))
    }
}
