//! Selection of the evaluations that are shown individually.

use study::{Recorded, StudyRecord};

/// Largest number of evaluations listed in the explorer, and of those marked in a plot; a page with 100 000 evaluations
/// would have 100 MB.
pub(super) const LISTED: usize = 5000;
pub(super) const PLOTTED: usize = 1000;

/// Selects about `most` of the evaluations `all`, in their order: all if there are no more, otherwise the best (a tenth
/// of `most`), the recommended one, and evaluations at even intervals.
pub(super) fn selected<'a>(
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
    valued.sort_by(|a, b| b.0.total_cmp(&a.0));
    let every = all.len().div_ceil(most - best);
    let mut taken: Vec<bool> = (0..all.len()).map(|i| i % every == 0).collect();
    valued.iter().take(best).for_each(|&(_, i)| taken[i] = true);
    let recommended = record.recommended().map(|best| best.index);
    let wanted = |(found, taken): &(&Recorded, bool)| *taken || Some(found.index) == recommended;
    all.iter().zip(taken).filter(wanted).map(|(found, _)| found).collect()
}

/// Returns a note on the selection; `None` if all evaluations are shown.
pub(super) fn note(record: &StudyRecord) -> Option<String> {
    let all = record.evaluations.len();
    (all > PLOTTED).then(|| {
        let [listed, plotted] =
            [LISTED, PLOTTED].map(|most| selected(record, &record.evaluations, most).len());
        format!(
            "Of {all} evaluations {listed} are listed and {plotted} plotted: the best, and others \
             at even intervals. evaluations.csv has all."
        )
    })
}

/// Reduces a line of more than [`PLOTTED`] points to its ends and the points at which its value changes.
pub(super) fn change_points(points: Vec<(f64, f64)>) -> Vec<(f64, f64)> {
    if points.len() <= PLOTTED {
        return points;
    }
    let last = points.len() - 1;
    let changes = |i: usize| i == 0 || i == last || points[i].1 != points[i - 1].1;
    (0..points.len()).filter(|&i| changes(i)).map(|i| points[i]).collect()
}
