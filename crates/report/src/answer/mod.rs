//! Answer of a study, computed once from its record for terminal, page, JSON and Python.
//! Lengths in mm, forces in N.

pub mod command;
mod force;
pub mod lines;
mod recommended;
mod robots;
mod start;
mod ties;
mod trust;
mod verdict;
pub mod words;

use calibration::next::BestMeasured;
use calibration::rank_correlation::{Order, RankCorrelation, errors_percent, rank_correlation};
use input::shipped::{STIFFNESS, TASKS};
use insertion::{Design, Evaluation, Measure};
use study::{BenchPrediction, CELL, FINGER, Recorded, StudyConfig, StudyRecord, Volume, Walked};
use study::{sha256_hex, volume};

pub use force::ExcessForce;
use recommended::firm_range_mm;
pub use recommended::{LeftOut, OnTask, Recommended};
pub use robots::RobotWindow;
pub use start::Start;
pub use ties::{SafeChoice, Spread, Ties};
pub use trust::{MeasuredFinger, Trust};
pub use verdict::{Verdict, expectation};

/// Shipped robots that represent the robot of the published measurements, a UR5e.
const PUBLICATION_ROBOTS: [&str; 3] = ["servo", "ur5e", "ur5e_position"];

/// Answer of a study.
#[derive(Debug, Clone)]
pub struct Answer<'a> {
    /// The study.
    pub record: &'a StudyRecord,
    /// Recommended action.
    pub verdict: Verdict<'a>,
    /// Evidence for the recommended action.
    pub trust: Trust,
    /// Number of evaluations with the current settings.
    pub designs: usize,
    /// Number of them that satisfy all constraints and have a value.
    pub feasible: usize,
    /// The recommended design, or the first of a front; `None` if none has a value and satisfies all
    /// constraints.
    pub recommended: Option<Recommended<'a>>,
    /// The best design, if its contact force exceeds a limit and a tied one is recommended in its place.
    pub left_out: Option<LeftOut<'a>>,
    /// Confirmed designs (walked step by step and repeated at their ends), best first, each with
    /// its firm range, mm, aggregated over the tasks.
    pub walked: Vec<(&'a Recorded, f64)>,
    /// Pareto front; `None` for a single objective.
    pub front: Option<Front<'a>>,
    /// Smallest and largest range, mm, of the designs that insert at every nominal start; `None` if none does.
    pub spread_mm: Option<[f64; 2]>,
    /// Fingers measured on a robot: those given to the study, else the published ones; empty for
    /// several tasks.
    pub measured: Vec<MeasuredFinger>,
    /// Contact force of the finger to print, if it exceeds a limit of connector or robot.
    pub force: Option<ExcessForce>,
    /// Rank correlation of simulated and published ranges, for each task with measurements.
    pub rank_correlations: Vec<RankCorrelation>,
}

/// Pareto front: no design dominates another.
#[derive(Debug, Clone)]
pub struct Front<'a> {
    /// The designs, best in the first objective first.
    pub designs: Vec<&'a Recorded>,
    /// Their hypervolume.
    pub volume: Volume,
}

impl<'a> Answer<'a> {
    /// Returns the answer of a study.
    pub fn of(record: &'a StudyRecord) -> Self {
        let (config, current) = (&record.config, record.current());
        let front = || Front { designs: record.front(), volume: volume(&config.goals(), current) };
        let walked = |walked: &'a Walked| (&walked.recorded, firm_range_mm(record, walked));
        let correlation = |task| rank_correlation(config, task);
        let measured = match (&record.on_bench, &config.tasks[..]) {
            (Some(bench), _) => bench.ranges.clone(),
            (None, [task]) => trust::published(task).into_iter().map(|(found, _)| found).collect(),
            (None, _) => Vec::new(),
        };
        let best = record.recommended().map(|best| Recommended::of(record, best, &measured));
        let (recommended, left_out) =
            best.map(|best| best.within_limits(record, &measured)).unzip();
        let mut answer = Answer {
            record,
            verdict: Verdict::NoneFeasible,
            trust: Trust::of(record, None),
            designs: current.len(),
            feasible: current.iter().filter(|recorded| recorded.feasible().is_some()).count(),
            recommended,
            left_out: left_out.flatten(),
            walked: record.walked.iter().map(walked).collect(),
            front: config.objective.single().is_none().then(front),
            spread_mm: record.spread_mm(),
            measured,
            force: None,
            rank_correlations: config.tasks().filter_map(correlation).collect(),
        };
        answer.verdict = Verdict::of(&answer);
        answer.trust = Trust::of(record, answer.design_to_print());
        answer.force =
            answer.finger_and_evaluations().and_then(|(_, tasks)| ExcessForce::of(record, &tasks));
        answer
    }

    /// Returns the first sentence of the answer: the measured finger to use, else the result of the search.
    pub fn headline(&self) -> String {
        let use_now = self.use_now().filter(|_| self.verdict.finger().is_some());
        use_now.map_or_else(|| self.found(), |best| words::use_now(&best))
    }

    /// Returns the result of the search, with the number of evaluations of an unfinished study.
    fn found(&self) -> String {
        let found = self.not_usable().or_else(|| self.simulated());
        found.unwrap_or_else(|| self.verdict.headline()) + &self.unfinished()
    }

    /// Returns the number of evaluations of an unfinished study, in parentheses; else nothing.
    fn unfinished(&self) -> String {
        let StudyRecord { config, evaluations, .. } = self.record;
        match evaluations.len() as u64 >= config.budget {
            _ if !self.record.unfinished() => String::new(),
            true => " (confirmation incomplete)".to_owned(),
            false => format!(" (unfinished, after {})", config.counted(evaluations.len())),
        }
    }

    /// Returns the name of the verdict in JSON.
    pub fn verdict_key(&self) -> &'static str {
        match (self.stopped(), self.unsteady(), self.simulated()) {
            (Some(_), ..) => "robot_stops",
            (_, Some(_), _) => "not_repeatable",
            (.., Some(_)) => "simulated",
            (.., None) => self.verdict.key(),
        }
    }

    /// Returns the index of the first task on which the robot stops in most insertions of the finger to print, and the
    /// evaluation on it; `None` if there is none.
    pub fn stopped(&self) -> Option<(usize, &'a Evaluation)> {
        if let Verdict::NothingInserts { place, nearest, fails, .. } = self.verdict {
            let by_robot = self.record.robot_stop == Some(nearest.index);
            return fails.filter(|_| by_robot).map(|found| (place, found));
        }
        let (_, tasks) = self.finger_and_evaluations()?;
        tasks.into_iter().enumerate().find(|(_, found)| found.mostly_stopped())
    }

    /// Returns the first task on which a repeat of the finger to print fails at the nominal start; `None` if there is
    /// none, and for a front.
    pub fn unsteady(&self) -> Option<&'a str> {
        let simulated = self.front.is_none() && self.record.on_bench.is_none();
        let found = self.design_to_print().filter(|_| simulated)?;
        unsteady(self.record, found.index)
    }

    /// Returns the headline of a finger with which the robot stops in most insertions, or with which repeats fail at the
    /// nominal start.
    fn not_usable(&self) -> Option<String> {
        let config = &self.record.config;
        let why = match self.stopped() {
            Some((place, found)) => {
                let on = words::on(config, config.tasks().nth(place).unwrap_or_default());
                words::not_usable(found, &on)
            }
            None => {
                let on = words::on(config, self.unsteady()?);
                format!(
                    "Not usable as it is: with slightly varied friction, start or time step the nominal start fails{on}"
                )
            }
        };
        let finger = self.verdict.finger().map(words::design);
        Some(why + &finger.map_or(String::new(), |finger| format!("; best finger: {finger}")))
    }

    /// Returns the headline of a finger that no measurement supports: of its task there are none, or a range is optimized,
    /// the finger is not the best measured one, and the simulation ranks the published fingers of no task like the robot.
    fn simulated(&self) -> Option<String> {
        let why = match &self.trust {
            Trust::Simulated { .. } if self.record.config.tasks().nth(1).is_some() => {
                "not measured yet on each task"
            }
            Trust::Simulated { .. } => "not measured yet",
            _ if self.is_refuted() => "not supported by measurements",
            _ => return None,
        };
        let found = match (&self.verdict, self.within_error()) {
            (Verdict::Any { of, .. }, _) => format!("{of} fingers tie in simulation"),
            (Verdict::Print(_), Some(of)) => {
                format!("{of} fingers differ by less than the simulation error")
            }
            (Verdict::Print(_), _) if self.left_out.is_some() => {
                "Best in simulation within the limit of force".to_owned()
            }
            (Verdict::Print(_) | Verdict::Choose { of: 1, .. }, _) => {
                "Best in simulation".to_owned()
            }
            _ => return None,
        };
        Some(format!("{found}, {why}: {}", words::design(self.verdict.finger()?)))
    }

    /// Returns whether measurements do not support the finger of the verdict.
    fn is_refuted(&self) -> bool {
        let of_range = |of: &Measure| {
            matches!(of, Measure::Range | Measure::CentredRange | Measure::RobustRange)
        };
        let unlike = |found: &RankCorrelation| found.order() != Order::Like;
        let best_mm = self.best_measured().map_or(0.0, |(_, mm)| *mm);
        let own_mm = self.verdict.finger().and_then(|finger| self.on_robot(finger));
        matches!(self.trust, Trust::Published { .. })
            && own_mm.is_none_or(|mm| mm < best_mm)
            && self.record.config.objective.measures().iter().any(of_range)
            && !self.rank_correlations.is_empty()
            && self.rank_correlations.iter().all(unlike)
    }

    /// Returns the measured finger with the largest range.
    fn best_measured(&self) -> Option<&MeasuredFinger> {
        self.measured.iter().max_by(|(_, a), (_, b)| a.total_cmp(b))
    }

    /// Returns the best measured finger: that of the user's measurements, else the best published one, if it is better
    /// supported than the best one in simulation.
    pub fn use_now(&self) -> Option<BestMeasured> {
        self.record.on_bench.as_ref().map_or_else(|| self.best_published(), best_on_bench)
    }

    /// Returns the best published finger, if measurements do not support the best one in simulation, with which the robot
    /// does not stop, and only the range matters: the published fingers have no other measured values. `None` for another
    /// task, robot, cell or finger than those of the publication.
    fn best_published(&self) -> Option<BestMeasured> {
        let StudyConfig { robot, objective, constraints, conclusion, provenance, .. } =
            &self.record.config;
        let shipped = |file: &String| TASKS.iter().any(|task| task.file == file);
        let inputs = &provenance.input_sha256;
        let stiffness = sha256_hex(STIFFNESS[0].text.as_bytes());
        let published = conclusion.task_files.iter().all(shipped)
            && PUBLICATION_ROBOTS.contains(&robot.as_str())
            && conclusion.robot_file.is_empty()
            && inputs.get("stiffness").is_none_or(|hash| *hash == stiffness)
            && ![CELL, FINGER].iter().any(|role| inputs.contains_key(*role));
        let by_range = objective.single() == Some(Measure::Range) && constraints.is_empty();
        let applies = published && by_range && self.stopped().is_none() && self.is_refuted();
        let (design, range_mm) = self.best_measured().filter(|_| applies)?;
        let (design, fingers) = (design.clone(), self.measured.len());
        Some(BestMeasured { design, range_mm: *range_mm, at_least: false, fingers })
    }

    /// Returns the number of feasible designs that insert, if the range is optimized and their ranges differ by less than the
    /// smallest error of the simulation on the published tasks.
    fn within_error(&self) -> Option<usize> {
        let range = self.record.config.objective.single() == Some(Measure::Range);
        let [low, high] = self.spread_mm.filter(|_| range)?;
        let inserts = |design: &&Recorded| design.feasible().is_some() && design.inserts_on_all();
        let of = self.record.current().iter().filter(inserts).count();
        (of > 1 && high - low < errors_percent()[0] / 100.0 * high).then_some(of)
    }

    /// Returns the evaluation of the design to print according to simulation alone; `None` if there is none.
    pub fn design_to_print(&self) -> Option<&'a Recorded> {
        let found = self.recommended.as_ref()?;
        match (&self.verdict, &found.ties) {
            (Verdict::NothingInserts { .. } | Verdict::NoneFeasible, _) => None,
            (Verdict::Any { .. }, Some(Ties { safe: Some(safe), .. })) => Some(safe.design),
            _ => Some(found.design),
        }
    }

    /// Returns the range of a finger on a robot, mm, if it was measured.
    pub fn on_robot(&self, finger: &Design) -> Option<f64> {
        trust::range_mm(&self.measured, finger)
    }

    /// Returns the finger to print and its simulated evaluation on each task; `None` if there is none.
    pub fn finger_and_evaluations(&self) -> Option<(&'a Design, Vec<&'a Evaluation>)> {
        let finger = self.verdict.finger()?;
        match &self.record.on_bench {
            Some(bench) => Some((finger, vec![&bench.simulated])),
            None => self.design_to_print().map(|design| (finger, design.tasks())),
        }
    }
}

/// Returns the first task on which a repeat of a design fails at the nominal start; `None` if there is none, or if the
/// design was not repeated.
fn unsteady(record: &StudyRecord, index: u64) -> Option<&str> {
    let walked = record.walked.iter().find(|walked| walked.recorded.index == index)?;
    let mut firm = record.config.tasks().zip(&walked.firm);
    firm.find(|(_, firm)| firm.window.is_none()).map(|(task, _)| task)
}

/// Returns the finger with the largest range, or lower bound of it, of the user's measurements.
fn best_on_bench(bench: &BenchPrediction) -> Option<BestMeasured> {
    let ranges = bench.ranges.iter().map(|(design, mm)| (design, *mm, false));
    let bounds = bench.bounds.iter().filter_map(|(design, mm)| Some((design, (*mm)?, true)));
    BestMeasured::of(ranges.chain(bounds))
}
