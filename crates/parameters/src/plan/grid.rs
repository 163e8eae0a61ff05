//! Adaptive map of the outcomes of trials under two errors, such as shifts of the start along y and x.
//!
//! A coarse lattice of grid points is extended until its outermost trials fail, then its spacing is halved repeatedly,
//! down to one grid step. A point between two equal outcomes takes that outcome without a trial; a point between two
//! different ones is simulated. The trials are spent in this order: border of the inserting region; probes in uniform
//! areas, to find islands; inferred points beside a trial with another outcome; borders between the other outcomes.

use ask_tell::stream::stream;
use rand::seq::SliceRandom;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Grid steps per millimetre or degree.
pub const STEPS_PER_UNIT: i32 = 4;
/// Largest number of trials of a map.
pub const MAX_TRIALS: usize = 300;
/// Number of those trials reserved for probes in uniform areas.
const PROBES: usize = 60;
/// Spacing of the first lattice, in grid steps; doubled for a large region.
const COARSE: i32 = 4;
/// Number of lattice points above which the spacing is doubled.
const MAX_COARSE: usize = 110;

/// Grid point, in grid steps from zero error along both axes.
pub type Node = [i32; 2];

/// Outcome of a trial, inside or outside the region to trace.
pub trait Traceable: Copy + PartialEq + Send + Sync {
    /// Returns whether the outcome belongs to the traced region: whether the trial inserts.
    fn inside(self) -> bool;
}

/// Outcome at a grid point.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct NodeOutcome<T> {
    /// The outcome.
    pub outcome: T,
    /// Whether the outcome was simulated; otherwise it was inferred from neighbours.
    pub simulated: bool,
}

/// Outcomes at every grid point from `low` to `high`.
pub struct TracedMap<'a, T> {
    /// Lowest corner.
    pub low: Node,
    /// Highest corner.
    pub high: Node,
    /// The outcomes by grid point.
    pub nodes: BTreeMap<Node, NodeOutcome<T>>,
    /// Number of trials simulated.
    pub trials: usize,
    /// Spacing of the initial lattice, grid steps.
    coarse: i32,
    /// Resolution at which the border of the inserting region was traced, grid steps.
    pub step: i32,
    measure: &'a (dyn Fn(Node) -> T + Sync),
}

/// Traces the inserting region around zero error, up to `limit`, in grid steps along each axis (multiples of 8, the
/// largest spacing of the lattice).
pub fn trace<T: Traceable>(limit: Node, measure: &(dyn Fn(Node) -> T + Sync)) -> TracedMap<'_, T> {
    let (low, high) = ([-2 * COARSE, -COARSE], [2 * COARSE, COARSE]);
    let nodes = BTreeMap::new();
    let coarse = COARSE;
    let mut traced = TracedMap { low, high, nodes, trials: 0, coarse, step: coarse, measure };
    traced.extend(limit);
    let mut probed = false;
    loop {
        let most = if probed { MAX_TRIALS } else { MAX_TRIALS - PROBES };
        traced.step = traced.refine(differ, most);
        if probed {
            traced.verify();
        }
        // A new point on the edge may insert although the lattice points beside it do not.
        if traced.extend(limit) {
            continue;
        }
        if probed {
            break;
        }
        // Simulates randomly chosen inferred points whose neighbours are all inferred and equal to them.
        let same = |own: T, other: &NodeOutcome<T>| !other.simulated && !differ(other.outcome, own);
        let mut uniform =
            traced.inferred(|own, beside| beside.iter().all(|other| same(own, other)));
        uniform.shuffle(&mut stream(0, 0, "probes of a capture map"));
        uniform.truncate(PROBES);
        traced.simulate(uniform, MAX_TRIALS);
        probed = true;
    }
    traced.refine(|a, b| a != b, MAX_TRIALS);
    traced
}

fn differ<T: Traceable>(a: T, b: T) -> bool {
    a.inside() != b.inside()
}

impl<T: Traceable> TracedMap<'_, T> {
    /// Simulates the lattice, extended on each side until no trial there inserts or a limit is reached. Returns whether
    /// it has grown.
    fn extend(&mut self, limit: Node) -> bool {
        let first = (self.low, self.high);
        loop {
            let coarse = self.coarse;
            self.simulate(self.lattice(coarse), MAX_TRIALS);
            let before = (self.low, self.high);
            for axis in [0, 1] {
                let inserts = |edge: i32| {
                    self.nodes.iter().any(|(at, found)| at[axis] == edge && found.outcome.inside())
                };
                let [below, above] = [before.0, before.1].map(|end| inserts(end[axis]));
                let (low, high) = (self.low[axis] - coarse, self.high[axis] + coarse);
                if below && -low <= limit[axis] {
                    self.low[axis] = low;
                }
                if above && high <= limit[axis] {
                    self.high[axis] = high;
                }
            }
            if coarse == COARSE && self.lattice(coarse).len() > MAX_COARSE {
                let coarse = 2 * COARSE;
                self.coarse = coarse;
                self.low = self.low.map(|at| at.div_euclid(coarse) * coarse);
                self.high = self.high.map(|at| -(-at).div_euclid(coarse) * coarse);
            }
            let new = self.lattice(self.coarse).into_iter().filter(|&node| !self.simulated(node));
            if self.trials + new.count() > MAX_TRIALS {
                (self.low, self.high) = before;
            }
            if (self.low, self.high) == before {
                return before != first;
            }
        }
    }

    /// Refines the lattice by repeatedly halving its spacing. Points between outcomes that differ according to `differ`
    /// are simulated, up to `most` trials of the map. Returns the finest spacing that was completed, in grid steps.
    fn refine(&mut self, differ: fn(T, T) -> bool, most: usize) -> i32 {
        let (mut half, mut complete, mut traced) = (self.coarse / 2, true, self.coarse);
        while half >= 1 {
            // First the edge midpoints, then the face centres.
            for odd in [1, 2] {
                let mut unsure = Vec::new();
                for node in self.lattice(half) {
                    let between = node.map(|at| at.rem_euclid(2 * half) != 0);
                    if between.iter().filter(|&&is| is).count() != odd || self.simulated(node) {
                        continue;
                    }
                    let around = self.around(node, half, between, differ);
                    let Some(&outcome) = around.first() else { continue };
                    self.nodes.insert(node, NodeOutcome { outcome, simulated: false });
                    if around.iter().any(|&other| differ(other, outcome)) {
                        unsure.push(node);
                    }
                }
                complete &= self.simulate(unsure, most);
            }
            if complete {
                traced = half;
            }
            half /= 2;
        }
        traced
    }

    /// Returns the outcomes of the neighbours at distance `by` along the axes on which the point is a midpoint.
    /// For a face centre with equal neighbours along exactly one axis, only the outcomes along this axis.
    fn around(&self, node: Node, by: i32, between: [bool; 2], differ: fn(T, T) -> bool) -> Vec<T> {
        let pair = |axis: usize| -> Vec<T> {
            let beside = [-by, by].map(|by| moved(node, axis, by));
            beside.iter().filter_map(|at| Some(self.nodes.get(at)?.outcome)).collect()
        };
        let apart = |pair: &[T]| pair.iter().any(|&outcome| differ(outcome, pair[0]));
        let [first, second] = [0, 1].map(|axis| if between[axis] { pair(axis) } else { vec![] });
        match (apart(&first), apart(&second)) {
            (false, true) if !first.is_empty() => first,
            (true, false) if !second.is_empty() => second,
            _ => [first, second].concat(),
        }
    }

    /// Simulates inferred points next to a trial with a different outcome, until none is left or the trials run out.
    fn verify(&mut self) {
        let against =
            |own: T, other: &NodeOutcome<T>| other.simulated && differ(other.outcome, own);
        loop {
            let doubtful =
                self.inferred(|own, beside| beside.iter().any(|other| against(own, other)));
            if doubtful.is_empty() || !self.simulate(doubtful, MAX_TRIALS) {
                return;
            }
        }
    }

    /// Returns the inferred points whose outcome and neighbours meet a condition.
    fn inferred(&self, holds: impl Fn(T, &[NodeOutcome<T>]) -> bool) -> Vec<Node> {
        let fits = |(node, found): &(&Node, &NodeOutcome<T>)| {
            !found.simulated && holds(found.outcome, &self.neighbours(**node))
        };
        self.nodes.iter().filter(fits).map(|(node, _)| *node).collect()
    }

    /// Simulates the points that have not been simulated; an evenly spaced subset if that would exceed `most` trials of
    /// the map. Returns whether all were simulated.
    fn simulate(&mut self, mut wanted: Vec<Node>, most: usize) -> bool {
        wanted.retain(|&node| !self.simulated(node));
        let (all, room) = (wanted.len(), most.saturating_sub(self.trials));
        if all > room {
            wanted = (0..room).map(|i| wanted[i * all / room]).collect();
        }
        let outcomes: Vec<T> = wanted.par_iter().map(|&node| (self.measure)(node)).collect();
        self.trials += wanted.len();
        let found = outcomes.into_iter().map(|outcome| NodeOutcome { outcome, simulated: true });
        self.nodes.extend(wanted.into_iter().zip(found));
        all <= room
    }

    fn simulated(&self, node: Node) -> bool {
        self.nodes.get(&node).is_some_and(|found| found.simulated)
    }

    /// Returns the lattice points at a spacing. They are ordered by the second axis, whose error needs a new grasp, so
    /// that successive trials share one.
    fn lattice(&self, distance: i32) -> Vec<Node> {
        let along = |axis: usize| (self.low[axis]..=self.high[axis]).step_by(distance as usize);
        along(1).flat_map(|other| along(0).map(move |y| [y, other])).collect()
    }

    /// Returns the outcomes of the up to four neighbours on the grid.
    fn neighbours(&self, node: Node) -> Vec<NodeOutcome<T>> {
        let beside = |(axis, by)| self.nodes.get(&moved(node, axis, by)).copied();
        [(0, -1), (0, 1), (1, -1), (1, 1)].into_iter().filter_map(beside).collect()
    }
}

fn moved(mut node: Node, axis: usize, by: i32) -> Node {
    node[axis] += by;
    node
}

#[cfg(test)]
mod tests {
    use super::*;
    use Outcome::{Inserted, Jammed, Missed};

    use std::collections::BTreeSet;
    use std::sync::Mutex;

    #[derive(Debug, Clone, Copy, PartialEq)]
    enum Outcome {
        Inserted,
        Jammed,
        Missed,
    }

    impl Traceable for Outcome {
        fn inside(self) -> bool {
            self == Inserted
        }
    }

    const LIMIT: Node = [64, 32];

    /// Traces a synthetic region (in mm). Returns the numbers of points and trials, the step, and the numbers of points
    /// with a wrong outcome and on the wrong side of the border.
    fn traced(region: &(dyn Fn(f64, f64) -> Outcome + Sync)) -> (usize, usize, i32, [usize; 2]) {
        let of = |node: Node| {
            let [y, x] = node.map(|at| f64::from(at) / f64::from(STEPS_PER_UNIT));
            region(y, x)
        };
        let tried = Mutex::new(BTreeSet::new());
        let measure = |node| {
            assert!(tried.lock().unwrap().insert(node), "{node:?} tried twice");
            of(node)
        };
        let found = trace(LIMIT, &measure);
        let count = |wrong: &dyn Fn(Outcome, Outcome) -> bool| {
            found.nodes.iter().filter(|(node, found)| wrong(found.outcome, of(**node))).count()
        };
        assert_eq!(found.trials, tried.lock().unwrap().len());
        assert!(found.trials <= MAX_TRIALS);
        let [wide, high] = [0, 1].map(|axis| (found.high[axis] - found.low[axis] + 1) as usize);
        assert_eq!(found.nodes.len(), wide * high, "a point without an outcome");
        let wrong = [count(&|a, b| a != b), count(&differ)];
        (found.nodes.len(), found.trials, found.step, wrong)
    }

    fn inserted(is: bool) -> Outcome {
        if is { Inserted } else { Jammed }
    }

    #[test]
    fn a_disc_and_a_slanted_strip_are_traced_to_the_last_point() {
        let disc = |y: f64, x: f64| match libm::hypot(y - 1.0, x) < 3.0 {
            false if y > 2.0 => Missed,
            inserts => inserted(inserts),
        };
        let strip = |y: f64, x: f64| inserted((x - 0.3 * y).abs() < 0.4 && y.abs() < 6.0);
        let (_, trials, step, wrong) = traced(&disc);
        assert!(trials < 250 && (step, wrong) == (1, [0, 0]), "{trials}, {step}, {wrong:?}");
        let (places, trials, step, wrong) = traced(&strip);
        assert!(places > 1000 && (step, wrong) == (1, [0, 0]), "{places}, {trials}, {wrong:?}");
    }

    #[test]
    fn islands_are_found_by_probes_and_followed() {
        let islands = |y: f64, x: f64| {
            let hole = libm::hypot(y - 2.5, x - 0.5) < 0.9;
            let island = libm::hypot(y + 6.0, x + 1.5) < 0.8;
            inserted((y.abs() < 5.0 && x.abs() < 2.2 && !hole) || island)
        };
        let (places, _, step, wrong) = traced(&islands);
        assert!(places > 900 && (step, wrong) == (1, [0, 0]), "{places}, {step}, {wrong:?}");
    }

    #[test]
    fn an_unbounded_region_is_cut_off_and_an_intricate_one_is_traced_coarsely() {
        let (places, _, step, wrong) = traced(&|_, _| Inserted);
        assert_eq!((places, step, wrong), (129 * 65, 1, [0, 0]));
        let (places, trials, ..) = traced(&|_, _| Missed);
        assert_eq!((places, trials), (17 * 9, 15 + PROBES));
        let (_, trials, step, _) =
            traced(&|y, x| inserted(libm::sin(3.1 * y) + libm::cos(2.7 * x) > 0.2));
        assert!(trials == MAX_TRIALS && step > 1, "{trials}, {step}");
    }
}
