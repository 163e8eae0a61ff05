//! The range that is left under errors.

use crate::evaluation::RobustRange;
use crate::evaluation::tolerance;
use crate::evaluation::uncertainty::{Draw, RobustSettings, Statistic};
use crate::finger::Finger;
use crate::outcome::Outcome;
use crate::trial::Rig;
use rayon::prelude::*;

/// Measures the window of each finger and draw. The draw's offset is left out:
/// the window spans the offsets.
pub fn measure(rig: &dyn Rig, drawn: &[(Finger, Draw)], settings: &RobustSettings) -> RobustRange {
    let window = |(finger, draw): &(Finger, Draw)| {
        let found = tolerance::evaluate_in(rig, finger, &draw.conditions, settings.search);
        let diverged = found.window.nominal == Outcome::Diverged;
        ((!diverged).then(|| found.window.range_mm()), found.trials)
    };
    let found: Vec<(Option<f64>, u32)> = drawn.par_iter().map(window).collect();
    let ranges_mm: Vec<f64> = found.iter().filter_map(|(range, _)| *range).collect();
    let mut robust = RobustRange {
        diverged: (found.len() - ranges_mm.len()) as u32,
        ranges_mm,
        value_mm: None,
        trials: found.iter().map(|(_, trials)| trials).sum(),
    };
    robust.value_mm = value(&robust, settings.statistic);
    robust
}

/// The statistic, mm; `None` with fewer than two ranges.
fn value(robust: &RobustRange, statistic: Statistic) -> Option<f64> {
    let count = robust.ranges_mm.len();
    if count < 2 {
        return None;
    }
    Some(match statistic {
        Statistic::MeanMinusSd(factor) => robust.mean_mm() - factor * robust.sd_mm(),
        Statistic::LowerTail(share) => {
            let mut sorted = robust.ranges_mm.clone();
            sorted.sort_by(f64::total_cmp);
            let tail = &sorted[..((share * count as f64).round() as usize).max(1)];
            tail.iter().sum::<f64>() / tail.len() as f64
        }
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::evaluation::grid_mm;
    use crate::evaluation::robustness::tests::drawn;
    use crate::evaluation::tolerance::Search;
    use crate::trial::fake::{FakeRig, window_in_mm};

    fn ranges(ranges_mm: Vec<f64>) -> RobustRange {
        RobustRange { ranges_mm, diverged: 0, value_mm: None, trials: 0 }
    }

    #[test]
    fn the_statistics_worked_by_hand() {
        let three = ranges(vec![7.0, 3.0, 5.0]);
        assert_eq!(value(&three, Statistic::MeanMinusSd(1.5)), Some(2.0));
        assert_eq!(value(&three, Statistic::LowerTail(0.1)), Some(3.0));
        assert_eq!(value(&three, Statistic::LowerTail(0.67)), Some(4.0));
        assert_eq!(value(&ranges(vec![7.0]), Statistic::LowerTail(0.1)), None);
    }

    #[test]
    fn each_range_is_that_of_its_own_window() {
        let (typical, drawn) = drawn(60.0, 12);
        let settings = RobustSettings { search: Search::Strides, ..typical.robust };
        let found = measure(&FakeRig::default(), &drawn, &settings);
        let expected: Vec<f64> = drawn
            .iter()
            .map(|(finger, draw)| {
                let (low, high) = window_in_mm(finger, &draw.conditions);
                if low > 0.0 || high < 0.0 {
                    return 0.0;
                }
                grid_mm((high * 10.0).floor() as i32 - (low * 10.0).ceil() as i32)
            })
            .collect();
        assert_eq!(found.ranges_mm, expected);
        assert!(found.sd_mm() > 0.3, "{found:?}");
        assert_eq!(found.value_mm, Some(found.mean_mm() - found.sd_mm()));
    }
}
