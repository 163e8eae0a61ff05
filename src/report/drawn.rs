//! Which evaluations are drawn one by one: a page with all of 100 000 would have 100 MB.

use crate::study::{Recorded, StudyRecord};

/// Evaluations up to which all are drawn.
const MOST: usize = 5000;
/// Of more, so many of the best are drawn, and others evenly taken.
const BEST: usize = 500;

/// Those of `all`, evaluations of the study, that are drawn, in their order.
pub(super) fn drawn<'a>(record: &StudyRecord, all: &'a [Recorded]) -> Vec<&'a Recorded> {
    if all.len() <= MOST {
        return all.iter().collect();
    }
    let sense = record.config.objective.first().sense();
    let merit = |i: usize| all[i].feasible().and_then(|values| Some(sense * values.first()?));
    let mut valued: Vec<(f64, usize)> =
        (0..all.len()).filter_map(|i| Some((merit(i)?, i))).collect();
    valued.sort_by(|a, b| b.0.total_cmp(&a.0).then(a.1.cmp(&b.1)));
    let every = all.len().div_ceil(MOST - BEST);
    let mut taken: Vec<bool> = (0..all.len()).map(|i| i % every == 0).collect();
    valued.iter().take(BEST).for_each(|&(_, i)| taken[i] = true);
    let recommended = record.recommended().map(|best| best.index);
    let wanted = |(one, taken): &(&Recorded, bool)| *taken || Some(one.index) == recommended;
    all.iter().zip(taken).filter(wanted).map(|(one, _)| one).collect()
}

/// Note for a reader of the pictures; nothing where all are drawn.
pub(super) fn note(record: &StudyRecord) -> Option<String> {
    let (all, some) = (record.evaluations.len(), drawn(record, &record.evaluations).len());
    (some < all).then(|| {
        format!("Of them {some} are drawn: the {BEST} best, and others evenly taken. evaluations.csv has all.")
    })
}

/// A line through all of a few points, of many only through those at which it turns.
pub(super) fn turning(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    if points.len() <= MOST {
        return points;
    }
    let last = points.len() - 1;
    let turns = |i: usize| i == 0 || i == last || points[i].1 != points[i - 1].1;
    (0..points.len()).filter(|&i| turns(i)).map(|i| points[i]).collect()
}
