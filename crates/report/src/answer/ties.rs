//! Designs that tie with the recommended one, and the safe choice among them.

use super::force::ExcessForce;
use super::trust::{MeasuredFinger, range_mm};
use super::unsteady;
use ask_tell::process::distance2;
use ask_tell::statistics::span;
use insertion::evaluation::objective::Measure;
use parameters::label;
use study::{Recorded, StudyRecord};

/// Designs whose first objective is worse than that of the best design by at most the study's indifference (mm),
/// or not at all if the objective is not a length.
#[derive(Debug, Clone)]
pub struct Ties<'a> {
    /// Designs in the order of their evaluation, including the best design, each with its loss against that design, in the
    /// unit of the first objective; negative if it is better.
    pub designs: Vec<(&'a Recorded, f64)>,
    /// Values over these designs of each parameter of the space whose bounds differ.
    pub spread: Vec<Spread<'a>>,
    /// Largest loss of the other designs within that spread; `None` if there are none.
    pub loss_within: Option<f64>,
    /// Distance of the evaluated designs nearest to the recommended one (the largest number of steps by which a parameter
    /// differs) and their smallest loss, mm, if none of them ties: the optimum is narrow.
    pub narrow: Option<(u32, f64)>,
    /// Share of the space that is nearer to a tied design than to any other design, 0 to 1. The number of tied designs
    /// alone is misleading, since a search samples good regions more densely.
    pub share: f64,
    /// The safe choice; `None` if the recommended design has no ties, or all exceed a force limit.
    pub safe: Option<SafeChoice<'a>>,
    /// The design of the smallest loss whose force connector and robot withstand and no repeat of which fails at the
    /// nominal start, with its loss; `None` as for the safe choice.
    pub allowed: Option<(&'a Recorded, f64)>,
}

/// Extent of the values of a parameter over a set of designs.
#[derive(Debug, Clone, PartialEq)]
pub struct Spread<'a> {
    /// Key in the space file.
    pub key: &'a str,
    /// Smallest and largest value, in the unit of the key.
    pub values: [f64; 2],
}

/// Safe choice: of the tied designs that are allowed ([`Ties::allowed`]), the one with the widest range measured on a
/// robot; if none was measured, the one with the least force.
#[derive(Debug, Clone)]
pub struct SafeChoice<'a> {
    /// Design.
    pub design: &'a Recorded,
    /// Its range measured on a robot, mm.
    pub measured_mm: Option<f64>,
    /// Its largest contact force, N, if any trial inserted.
    pub force_n: Option<f64>,
    /// Its loss against the best design, in the unit of the first objective, rounded to 0.1; not negative.
    pub loss: f64,
}

impl SafeChoice<'_> {
    /// Returns the name of the choice: only a measured finger is safe.
    pub fn name(&self) -> &'static str {
        if self.measured_mm.is_some() { "safe choice" } else { "least force" }
    }
}

impl Spread<'_> {
    /// Returns the values in words: `10 to 11 %`.
    pub fn words(&self) -> String {
        let (name, unit) = label(self.key);
        let [low, high] = self.values;
        let short = ["infill density", "infill direction"].contains(&name.as_str());
        let name = if short { String::new() } else { format!("{name} ") };
        let to = if low == high { String::new() } else { format!(" to {high}") };
        format!("{name}{low}{to}{unit}")
    }
}

/// Share of the space near tied designs ([`Ties::share`]) from which on any of them is recommended.
const MIN_SHARE: f64 = 0.5;

impl<'a> Ties<'a> {
    /// Returns whether any of the designs is recommended, by default the safe choice.
    pub(super) fn any(&self) -> bool {
        self.safe.is_some() && self.share >= MIN_SHARE
    }

    pub(super) fn of(record: &'a StudyRecord, index: u64, measured: &[MeasuredFinger]) -> Self {
        let losses = record.losses(index);
        let narrow = narrow(record, index, &losses);
        let (designs, others): (Vec<_>, Vec<_>) =
            losses.into_iter().partition(|(_, loss)| record.is_equivalent(*loss));
        // The walk simulates more starts than the search, and usually finds a larger force.
        let walked = |found: &'a Recorded| {
            let mut walked = record.walked.iter().map(|walked| &walked.recorded);
            walked.find(|walked| walked.index == found.index).unwrap_or(found)
        };
        let force = |r: &'a Recorded| record.measure(walked(r), Measure::PeakForce);
        let tied = if designs.len() < 2 { &[] } else { &designs[..] };
        let allowed = |(r, _): &&(&'a Recorded, f64)| {
            ExcessForce::of(record, &walked(r).tasks()).is_none()
                && unsteady(record, r.index).is_none()
        };
        let safe = |&(design, loss): &(&'a Recorded, f64)| SafeChoice {
            design,
            measured_mm: range_mm(measured, &design.design),
            force_n: force(design),
            loss: (10.0 * loss.max(0.0)).round() / 10.0,
        };
        let eligible = || tied.iter().filter(allowed).map(safe);
        let allowed = tied.iter().filter(allowed).min_by(|a, b| a.1.total_cmp(&b.1)).copied();
        let measured = eligible().filter_map(|safe| Some((safe.measured_mm?, safe)));
        // Reversed, since `max_by` returns the last of equal maxima, and the first evaluated is wanted.
        let widest = measured.rev().max_by(|a, b| a.0.total_cmp(&b.0));
        let simulated = eligible().filter_map(|safe| Some((safe.force_n?, safe)));
        let least_force = simulated.min_by(|a, b| a.0.total_cmp(&b.0));
        let safe = widest.or(least_force).map(|(_, safe)| safe);
        let (spread, share) = (spread(record, &designs), share(record, &designs));
        let loss_within = loss_within(&spread, &others);
        Ties { spread, loss_within, narrow, share, safe, allowed, designs }
    }
}

/// Number of points from which the share of the space is estimated.
const POINTS: u32 = 500;

/// Estimates the share of the unit cube (the space with each parameter scaled to 0 to 1) that is nearer to a design of
/// the set than to any other design, from evenly spread points.
fn share(record: &StudyRecord, set: &[(&Recorded, f64)]) -> f64 {
    let space = &record.config.space;
    let unit = |design: &Recorded| -> Vec<f64> {
        let axes = space.point(&design.design).0.into_iter().zip(space.levels());
        axes.map(|(level, levels)| f64::from(level) / f64::from(levels.max(2) - 1)).collect()
    };
    let is_member = |found: &Recorded| set.iter().any(|(member, _)| member.index == found.index);
    let designs = record.current().iter().map(|found| (unit(found), is_member(found)));
    let designs: Vec<(Vec<f64>, bool)> = designs.collect();
    // Roberts' low-discrepancy sequence in d dimensions, from the root of x^(d + 1) = x + 1.
    let dimension = space.parameters.len() as u32;
    let root = (0..60).fold(1.5_f64, |x, _| libm::pow(1.0 + x, 1.0 / f64::from(dimension + 1)));
    let nearest_is_tied = |&number: &u32| {
        let powers = std::iter::successors(Some(1.0 / root), |power| Some(power / root));
        let point = powers.map(|power| (0.5 + f64::from(number) * power).fract());
        let point: Vec<f64> = point.take(space.parameters.len()).collect();
        let distance = |design: &[f64]| distance2(design, &point);
        let nearest = designs.iter().min_by(|a, b| distance(&a.0).total_cmp(&distance(&b.0)));
        nearest.is_some_and(|(_, member)| *member)
    };
    f64::from((0..POINTS).filter(nearest_is_tied).count() as u32) / f64::from(POINTS)
}

fn spread<'a>(record: &'a StudyRecord, designs: &[(&Recorded, f64)]) -> Vec<Spread<'a>> {
    let free = record.config.space.parameters.iter().filter(|p| p.low < p.high);
    let of = |key: &'a str| {
        let values = designs.iter().filter_map(|(recorded, _)| recorded.design.get(key));
        Spread { key, values: span(values) }
    };
    free.map(|parameter| of(&parameter.key)).collect()
}

/// Returns the largest loss of the designs that do not tie, but whose parameters are within the spread of those that do.
fn loss_within(spread: &[Spread], others: &[(&Recorded, f64)]) -> Option<f64> {
    let is_inside = |(found, _): &&(&Recorded, f64)| {
        spread.iter().all(|Spread { key, values: [low, high] }| {
            found.design.get(key).is_some_and(|value| (*low..=*high).contains(&value))
        })
    };
    others.iter().filter(is_inside).map(|(_, loss)| *loss).reduce(f64::max)
}

/// Returns [`Ties::narrow`], given the losses against the evaluation `index`.
fn narrow(record: &StudyRecord, index: u64, losses: &[(&Recorded, f64)]) -> Option<(u32, f64)> {
    let point = |found: &Recorded| record.config.space.point(&found.design).0;
    let own = losses.iter().find(|(found, _)| found.index == index).map(|(own, _)| point(own))?;
    let apart = |&(found, loss): &(&Recorded, f64)| {
        let steps = point(found).into_iter().zip(&own).map(|(level, own)| level.abs_diff(*own));
        Some((steps.max().filter(|steps| *steps > 0)?, loss))
    };
    let others = losses.iter().filter_map(apart);
    let nearest = others.min_by(|a, b| a.0.cmp(&b.0).then(a.1.total_cmp(&b.1)));
    nearest.filter(|(_, loss)| !record.is_equivalent(*loss))
}

#[cfg(test)]
mod tests {
    use crate::answer::{Answer, SafeChoice, Ties, Verdict, lines};
    use study::StudyRecord;

    fn fixture() -> StudyRecord {
        StudyRecord::load("../../tests/fixtures/study".as_ref()).unwrap()
    }

    #[test]
    fn the_verdict_follows_from_the_indifference() {
        let mut record = fixture();
        record.config.indifference_mm = 0.1;
        let answer = Answer::of(&record);
        let found = answer.recommended.as_ref().and_then(|found| found.ties.as_ref()).unwrap();
        assert!(found.share < 0.5 && matches!(answer.verdict, Verdict::Print(_)), "{found:?}");
        let named = answer.design_to_print().unwrap().index;
        assert!(found.designs.iter().any(|(member, loss)| member.index == named && *loss == 0.0));
        // All designs tie.
        record.config.indifference_mm = 10.0;
        let answer = Answer::of(&record);
        let found = answer.recommended.as_ref().and_then(|found| found.ties.as_ref()).unwrap();
        assert!(found.share > 0.5);
        assert_eq!(found.designs.len(), answer.feasible);
        assert!(matches!(answer.verdict, Verdict::Any { .. }));
        // The safe choice was measured on a robot, or has the least force.
        let safe = found.safe.as_ref().unwrap();
        let gentlest = found.designs.iter().filter_map(|(member, _)| {
            Some(member.tasks.first()?.peak_force_n).filter(|force| force.is_finite())
        });
        let gentlest = gentlest.fold(f64::INFINITY, f64::min);
        assert!(safe.measured_mm.is_some() || safe.force_n == Some(gentlest));
        assert_eq!(answer.verdict.finger(), Some(&safe.design.design));
        let named = |measured_mm| {
            let ties =
                Ties { safe: Some(SafeChoice { measured_mm, ..safe.clone() }), ..found.clone() };
            lines::safe(&ties).unwrap().0
        };
        assert_eq!([named(Some(4.7)), named(None)], ["safe choice", "least force"]);
    }

    #[test]
    fn a_tied_finger_within_the_force_limit_replaces_the_best() {
        let mut record = fixture();
        record.config.indifference_mm = 0.7;
        // Beside the best one, so that not most of the space ties.
        record.evaluations[2].design = insertion::space::Design::infill(12.0, 7.0);
        let named = |record: &StudyRecord| {
            let answer = Answer::of(record);
            let printed = answer.design_to_print().unwrap();
            assert_eq!(answer.verdict, Verdict::Print(&printed.design));
            assert_eq!(answer.recommended.as_ref().unwrap().design.index, printed.index);
            let left_out = answer.left_out.as_ref().map(|left_out| left_out.design.index);
            (printed.index, left_out, answer.force.is_some())
        };
        // 9.8 N; the tied ones have 9.2 and 8.9 N.
        assert_eq!(named(&record), (4, None, false));
        record.limits.connectors = vec![Some(9.0)];
        assert_eq!(named(&record), (9, Some(4), false));
        // Also if another loses more and has less force.
        record.evaluations[0].tasks[0].peak_force_n = 8.0;
        assert_eq!(named(&record), (9, Some(4), false));
        assert_eq!(
            Answer::of(&record).recommended.unwrap().ties.unwrap().safe.unwrap().design.index,
            0
        );
        let (_, text) = lines::left_out(&Answer::of(&record)).unwrap();
        assert!(
            text.contains("6°, 0.6 mm more: up to 10 N on usb in the trials that insert: its connector withstands 9 N"),
            "{text}"
        );
        // No tied finger is gentle enough.
        record.limits.connectors = vec![Some(5.0)];
        assert_eq!(named(&record), (4, None, true));
    }

    #[test]
    fn losses_beside_the_ties_are_told() {
        let mut record = fixture();
        // Beside the recommended design of 6.7 mm, 11 % at 6°.
        record.evaluations[2].design = insertion::space::Design::infill(12.0, 7.0);
        let mut tied = |indifference_mm: f64| {
            record.config.indifference_mm = indifference_mm;
            let answer = Answer::of(&record);
            let found = answer.recommended.as_ref().and_then(|found| found.ties.as_ref());
            crate::answer::lines::tied(&answer, found.unwrap()).1
        };
        let narrow = "narrow: evaluated neighbours lose at least 1.9 mm";
        assert_eq!(tied(0.3), format!("none of 10 designs within 0.3 mm; {narrow}"));
        let wide = tied(0.7);
        let region = "3 of 10 designs within 0.7 mm: 11 to 19 %, 1 to 16°";
        let expected = format!("{region}; others there lose up to 1.9 mm");
        assert!(wide.starts_with(&expected), "{wide}");
        assert!(!tied(1.9).contains("lose"), "it ties");
    }
}
