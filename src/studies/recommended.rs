//! The recommendation of a study and its advice, for other programs.

use insertion::evaluation::Evaluation;
use insertion::evaluation::objective::Measure;
use insertion::outcome::FailureClass;
use insertion::space::Design;
use report::answer::{Answer, AsGood, Recommended, Trust, command, expectation};
use serde::Serialize;
use std::collections::BTreeMap;
use std::path::Path;
use study::{ByRibs, OnBench, StudyRecord};

/// Design that a study recommends, and how many are as good.
#[derive(Serialize)]
pub struct Recommendation<'a> {
    /// The design; of measured fingers the one predicted to be the best on the bench.
    pub recommended: Option<Recommends<'a>>,
    #[serde(flatten)]
    bench: Option<WithBench<'a>>,
    equivalent_designs: Option<usize>,
    spread_mm: Option<f64>,
}

#[derive(Serialize)]
struct WithBench<'a> {
    recommended_by_simulation: Option<Recommends<'a>>,
    bench: Bench<'a>,
}

/// A recommended design.
#[derive(Serialize)]
#[serde(untagged)]
pub enum Recommends<'a> {
    /// By simulation.
    Simulated(Simulated<'a>),
    /// On the bench.
    OnBench(Predicted<'a>),
    /// The first design of a front.
    First(First<'a>),
}

/// A design recommended by simulation.
#[derive(Serialize)]
pub struct Simulated<'a> {
    values: &'a Design,
    evaluation: u64,
    firm_range_mm: Option<f64>,
    range_mm: Option<f64>,
    negative_mm: Option<f64>,
    positive_mm: Option<f64>,
    firm_negative_mm: Option<f64>,
    firm_positive_mm: Option<f64>,
    peak_force_n: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    computed: Option<Computed<'a>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    tasks: Option<&'a [String]>,
}

/// The design with springs computed from its ribs, task by task.
#[derive(Serialize)]
#[serde(rename_all = "lowercase")]
enum Computed<'a> {
    Tasks(&'a [Evaluation]),
    Refused(&'a str),
}

/// The finger that is predicted to be the best on the bench; the numbers without `bench` are simulated.
#[derive(Serialize)]
pub struct Predicted<'a> {
    values: &'a Design,
    evaluation: Option<u64>,
    range_mm: Option<f64>,
    negative_mm: Option<f64>,
    positive_mm: Option<f64>,
    peak_force_n: Option<f64>,
    bench: OfFinger,
}

#[derive(Serialize)]
struct OfFinger {
    range_mm: f64,
    low_mm: f64,
    high_mm: f64,
    probability_best: f64,
    failure_negative: Option<FailureClass>,
    failure_positive: Option<FailureClass>,
}

/// How the prediction for the bench came about, and how far it is to be trusted.
#[derive(Serialize)]
struct Bench<'a> {
    measured: usize,
    designs: usize,
    simulations: u16,
    samples: u16,
    emulator_error_mm: f64,
    loo_mean_deviation_percent: Option<f64>,
    loo_spearman: Option<f64>,
    loo_inside: usize,
    loo_designs: usize,
    warnings: &'a [String],
}

/// The first design of a front.
#[derive(Serialize)]
pub struct First<'a> {
    values: &'a Design,
    evaluation: u64,
    objectives: BTreeMap<String, f64>,
}

impl<'a> Recommendation<'a> {
    /// Returns what a study recommends.
    pub fn of(answer: &'a Answer<'a>) -> Self {
        let record = answer.record;
        let one = answer.recommended.as_ref().filter(|_| answer.front.is_none());
        let simulated = one.filter(|_| answer.verdict.key() != "nothing_inserts");
        let simulated = simulated.map(|found| Simulated::of(record, found));
        let simulated = simulated.map(Recommends::Simulated);
        let (recommended, bench) = match &record.on_bench {
            None => (simulated, None),
            Some(found) => {
                let predicted = Predicted::of(record, found).map(Recommends::OnBench);
                let bench = Bench::from(found);
                (predicted, Some(WithBench { recommended_by_simulation: simulated, bench }))
            }
        };
        let as_good = one.and_then(|found| found.as_good.as_ref());
        // One decimal, without the noise of the subtraction.
        let spread = answer.spread_mm.map(|[low, high]| ((high - low) * 1e6).round() / 1e6);
        Recommendation {
            recommended,
            bench,
            equivalent_designs: as_good.map(|as_good| as_good.designs.len()),
            spread_mm: spread,
        }
    }

    /// Returns the recommended design; of several objectives the first of the front. `None` while there is none.
    pub fn best(answer: &'a Answer<'a>) -> Option<Recommends<'a>> {
        let record = answer.record;
        let first = || {
            let first = answer.front.as_ref()?.designs.first().copied()?;
            let score = first.score.iter().flat_map(|score| score.values.iter().copied());
            let keys = record.config.objective.keys().into_iter().map(|key| key.to_string());
            let (values, evaluation) = (&first.design, first.index);
            Some(Recommends::First(First {
                values,
                evaluation,
                objectives: keys.zip(score).collect(),
            }))
        };
        Recommendation::of(answer).recommended.or_else(first)
    }
}

impl<'a> Simulated<'a> {
    fn of(record: &'a StudyRecord, found: &'a Recommended<'a>) -> Self {
        let window = found.range_mm.map(|_| found.window_mm);
        Simulated {
            values: &found.design.design,
            evaluation: found.design.index,
            firm_range_mm: found.firm_range_mm,
            range_mm: found.range_mm,
            negative_mm: window.map(|[negative, _]| negative),
            positive_mm: window.map(|[_, positive]| positive),
            firm_negative_mm: found.firm_window_mm.map(|[negative, _]| negative),
            firm_positive_mm: found.firm_window_mm.map(|[_, positive]| positive),
            peak_force_n: found.peak_force_n,
            computed: found.by_ribs.map(|by_ribs| match by_ribs {
                ByRibs::Measured(tasks) => Computed::Tasks(tasks),
                ByRibs::Refused(why) => Computed::Refused(why),
            }),
            tasks: record.config.several_tasks().then_some(&record.config.tasks[..]),
        }
    }
}

impl<'a> Predicted<'a> {
    fn of(record: &StudyRecord, found: &'a OnBench) -> Option<Self> {
        let best = found.best.first()?;
        let evaluated = record.current().iter().find(|recorded| recorded.design == best.design);
        let (range, window) = (Measure::Range.value(&found.simulated), &found.simulated.window);
        Some(Predicted {
            values: &best.design,
            evaluation: evaluated.map(|recorded| recorded.index),
            range_mm: range,
            negative_mm: range.map(|_| window.negative_mm()),
            positive_mm: range.map(|_| window.positive_mm()),
            peak_force_n: Measure::PeakForce.value(&found.simulated),
            bench: OfFinger {
                range_mm: best.range_mm,
                low_mm: best.low_mm,
                high_mm: best.high_mm,
                probability_best: best.probability_best,
                failure_negative: best.failures[0],
                failure_positive: best.failures[1],
            },
        })
    }
}

impl<'a> From<&'a OnBench> for Bench<'a> {
    fn from(found: &'a OnBench) -> Self {
        Bench {
            measured: found.measured,
            designs: found.fingers,
            simulations: found.effort.simulations,
            samples: found.effort.samples,
            emulator_error_mm: found.trust.emulator_error_mm,
            loo_mean_deviation_percent: found.trust.mean_deviation_percent,
            loo_spearman: found.trust.spearman,
            loo_inside: found.trust.inside,
            loo_designs: found.trust.fingers,
            warnings: &found.warnings,
        }
    }
}

/// The answer: what to do, what to expect, how far to trust it.
#[derive(Serialize)]
pub struct Advice<'a> {
    verdict: &'a str,
    headline: String,
    expectation: String,
    finger: Option<&'a Design>,
    trust: OfTrust<'a>,
    start: Option<Start>,
    as_good: Option<Set<'a>>,
    next: Next,
}

#[derive(Serialize)]
struct Next {
    command: String,
    why: String,
}

#[derive(Serialize)]
struct Start {
    negative_mm: f64,
    positive_mm: f64,
    one_sided: bool,
    to_middle_mm: f64,
    advice: Option<String>,
}

#[derive(Serialize)]
struct OfTrust<'a> {
    level: &'a str,
    label: String,
    reason: String,
    #[serde(flatten)]
    by: By<'a>,
}

#[derive(Serialize)]
#[serde(untagged)]
enum By<'a> {
    Calibrated { measured: usize, loo_mean_deviation_percent: Option<f64> },
    Published { nearest_measured: Vec<Nearest<'a>> },
    Simulated { error_percent_on_shipped_tasks: [f64; 2] },
}

#[derive(Serialize)]
struct Nearest<'a> {
    task: &'a str,
    values: &'a Design,
    range_mm: f64,
}

/// Designs that are as good as the recommended one.
#[derive(Serialize)]
struct Set<'a> {
    within_mm: f64,
    designs: usize,
    of: usize,
    share_of_space: f64,
    evaluations: Vec<u64>,
    spread: serde_json::Map<String, serde_json::Value>,
    safe: Option<Safe<'a>>,
}

#[derive(Serialize)]
struct Safe<'a> {
    values: &'a Design,
    evaluation: u64,
    measured_range_mm: Option<f64>,
    peak_force_n: Option<f64>,
    loss_mm: Option<f64>,
}

impl<'a> Advice<'a> {
    /// Returns the answer of the study in `dir`.
    pub fn of(answer: &'a Answer<'a>, dir: &Path) -> Self {
        let one = answer.recommended.as_ref().filter(|_| answer.verdict.finger().is_some());
        // Of fingers predicted for a bench the simulated set and window say nothing.
        let one = one.filter(|_| answer.record.on_bench.is_none());
        let as_good = one.and_then(|found| found.as_good.as_ref());
        let (command, why) = command::next(answer, dir);
        Advice {
            verdict: answer.verdict.key(),
            headline: answer.verdict.headline(),
            expectation: expectation(answer),
            finger: answer.verdict.finger(),
            trust: OfTrust::from(&answer.trust),
            start: one.and_then(|found| found.start).map(|start| Start {
                negative_mm: start.window_mm[0],
                positive_mm: start.window_mm[1],
                one_sided: start.one_sided(),
                to_middle_mm: start.to_middle_mm,
                advice: start.advice(),
            }),
            as_good: as_good.map(|as_good| Set::of(answer, as_good)),
            next: Next { command, why: why.to_string() },
        }
    }
}

impl<'a> From<&'a Trust> for OfTrust<'a> {
    fn from(trust: &'a Trust) -> Self {
        let by = match trust {
            Trust::Calibrated { fingers, error_percent } => {
                By::Calibrated { measured: *fingers, loo_mean_deviation_percent: *error_percent }
            }
            Trust::Published { nearest, .. } => {
                let of_task = nearest.iter().flat_map(|(task, fingers)| {
                    fingers.iter().map(move |finger| Nearest {
                        task,
                        values: &finger.design,
                        range_mm: finger.range_mm,
                    })
                });
                By::Published { nearest_measured: of_task.collect() }
            }
            Trust::Simulated { error_percent } => {
                By::Simulated { error_percent_on_shipped_tasks: *error_percent }
            }
        };
        OfTrust {
            level: trust.key(),
            label: trust.label().to_string(),
            reason: trust.reason().to_string(),
            by,
        }
    }
}

impl<'a> Set<'a> {
    fn of(answer: &Answer<'_>, as_good: &'a AsGood<'a>) -> Self {
        let in_mm = answer.record.config.objective.first().unit() == "mm";
        let spread = as_good.spread.iter();
        let spread = spread.map(|spread| (spread.key.to_owned(), spread.values.to_vec().into()));
        Set {
            within_mm: answer.record.config.indifference_mm,
            designs: as_good.designs.len(),
            of: answer.designs,
            share_of_space: as_good.share,
            evaluations: as_good.designs.iter().map(|(found, _)| found.index).collect(),
            spread: spread.collect(),
            safe: as_good.safe.as_ref().map(|safe| Safe {
                values: &safe.design.design,
                evaluation: safe.design.index,
                measured_range_mm: safe.measured_mm,
                peak_force_n: safe.force_n,
                // What is not in mm is as good only where it loses nothing.
                loss_mm: in_mm.then_some(safe.loss),
            }),
        }
    }
}
