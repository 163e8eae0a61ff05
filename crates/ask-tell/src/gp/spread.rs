//! Some of many, evenly.

/// `count` of `n` places, evenly; all if there are no more.
pub(super) fn spread(n: usize, count: usize) -> impl Iterator<Item = usize> {
    let count = count.min(n);
    (0..count).map(move |k| k * n / count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn places_are_spread_evenly_and_come_once() {
        assert_eq!(spread(10, 3).collect::<Vec<_>>(), [0, 3, 6]);
        assert_eq!(spread(3, 10).collect::<Vec<_>>(), [0, 1, 2]);
    }
}
