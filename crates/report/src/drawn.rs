//! Which evaluations are drawn one by one.

use study::{Recorded, StudyRecord};

/// Evaluations that the explorer holds, and that a plot has marks of: with all of 100 000 a page would
/// have 100 MB.
pub(super) const LISTED: usize = 5000;
pub(super) const PLOTTED: usize = 1000;

/// At most about so many of `all`, evaluations of the study, in their order: all if they are no more,
/// else a tenth as many of the best and others evenly taken.
pub(super) fn drawn<'a>(
    record: &StudyRecord,
    all: &'a [Recorded],
    most: usize,
) -> Vec<&'a Recorded> {
    let best = most / 10;
    if all.len() <= most {
        return all.iter().collect();
    }
    let sense = record.config.objective.first().sense();
    let merit = |i: usize| all[i].feasible().and_then(|values| Some(sense * values.first()?));
    let mut valued: Vec<(f64, usize)> =
        (0..all.len()).filter_map(|i| Some((merit(i)?, i))).collect();
    valued.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let every = all.len().div_ceil(most - best);
    let mut taken: Vec<bool> = (0..all.len()).map(|i| i % every == 0).collect();
    valued.iter().take(best).for_each(|&(_, i)| taken[i] = true);
    let recommended = record.recommended().map(|best| best.index);
    let wanted = |(one, taken): &(&Recorded, bool)| *taken || Some(one.index) == recommended;
    all.iter().zip(taken).filter(wanted).map(|(one, _)| one).collect()
}

/// Note for a reader of the pictures; nothing where all are drawn.
pub(super) fn note(record: &StudyRecord) -> Option<String> {
    let all = record.evaluations.len();
    (all > PLOTTED).then(|| {
        let [listed, plotted] =
            [LISTED, PLOTTED].map(|most| drawn(record, &record.evaluations, most).len());
        format!(
            "Of {all} evaluations {listed} are listed and {plotted} plotted: the best, and others \
             evenly taken. evaluations.csv has all."
        )
    })
}

/// A line through all of a few points, of many only through those at which it turns.
pub(super) fn turning(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    if points.len() <= PLOTTED {
        return points;
    }
    let last = points.len() - 1;
    let turns = |i: usize| i == 0 || i == last || points[i].1 != points[i - 1].1;
    (0..points.len()).filter(|&i| turns(i)).map(|i| points[i]).collect()
}
