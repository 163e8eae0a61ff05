//! Tracing of outcomes over a plane: no simulation, only where to look next.
//!
//! On a coarse lattice, which grows until its border fails, then at half the distance and again: a
//! place between two that end alike is taken over from them, one between two that differ is tried.
//! First the border of the inserting region; then probes where all seemed alike, since islands hide
//! there; then what was taken over beside that border; with what is left the other borders.

use ask_tell::stream::stream;
use insertion::outcome::Outcome;
use rand::seq::SliceRandom;
use rayon::prelude::*;
use std::collections::BTreeMap;

/// Steps of the grid to a millimetre or a degree.
pub const STEPS_PER_UNIT: i32 = 4;
/// Most trials of a map.
pub const MOST_TRIALS: usize = 300;
/// Trials of them where all seems alike.
const PROBES: usize = 60;
/// Distance of the first lattice, in steps of the grid; of a large region it is doubled.
const COARSE: i32 = 4;
/// Places of a lattice from which on it is doubled.
const MOST_COARSE: usize = 110;

/// Place on the grid: steps along both axes, from no error.
pub type Node = [i32; 2];

/// Outcome at a place.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Found {
    pub outcome: Outcome,
    /// If not it is taken over from its neighbours.
    pub simulated: bool,
}

/// Outcomes at every place from `low` to `high`.
pub struct Traced<'a> {
    pub low: Node,
    pub high: Node,
    pub nodes: BTreeMap<Node, Found>,
    pub trials: usize,
    /// Distance within which the border of the inserting region was looked for, steps of the grid.
    pub step: i32,
    measure: &'a (dyn Fn(Node) -> Outcome + Sync),
}

/// Traces the region that inserts around no error, up to `limit`, a multiple of 8, along either axis.
pub fn trace(limit: Node, measure: &(dyn Fn(Node) -> Outcome + Sync)) -> Traced<'_> {
    let (low, high) = ([-2 * COARSE, -COARSE], [2 * COARSE, COARSE]);
    let nodes = BTreeMap::new();
    let mut traced = Traced { low, high, nodes, trials: 0, step: COARSE, measure };
    let coarse = traced.extend(limit);
    traced.step = traced.refine(coarse, insert_differently, MOST_TRIALS - PROBES);
    traced.probe();
    traced.verify();
    traced.refine(coarse, |a, b| a != b, MOST_TRIALS);
    traced
}

fn insert_differently(a: Outcome, b: Outcome) -> bool {
    (a == Outcome::Inserted) != (b == Outcome::Inserted)
}

impl Traced<'_> {
    /// Simulates a lattice that grows on each side until that fails; gives its distance.
    fn extend(&mut self, limit: Node) -> i32 {
        let mut coarse = COARSE;
        loop {
            let new = self.lattice(coarse);
            self.simulate(new, MOST_TRIALS);
            let before = (self.low, self.high);
            for axis in [0, 1] {
                let inserts = |edge: i32| {
                    self.nodes.iter().any(|(node, found)| {
                        node[axis] == edge && found.outcome == Outcome::Inserted
                    })
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
            if (self.low, self.high) == before {
                return coarse;
            }
            if coarse == COARSE && self.lattice(coarse).len() > MOST_COARSE {
                coarse *= 2;
                self.low = self.low.map(|at| at.div_euclid(coarse) * coarse);
                self.high = self.high.map(|at| -(-at).div_euclid(coarse) * coarse);
            }
        }
    }

    /// Fills the grid from a lattice on, at half its distance and again; tries what lies between
    /// outcomes that differ in the sense given, as long as there are no more trials than `most`. Gives
    /// the last distance at which that was all.
    fn refine(&mut self, coarse: i32, differ: fn(Outcome, Outcome) -> bool, most: usize) -> i32 {
        let (mut half, mut complete, mut traced) = (coarse / 2, true, coarse);
        while half >= 1 {
            // First the middles of edges, then those of faces.
            for odd in [1, 2] {
                let mut unsure = Vec::new();
                for node in self.lattice(half) {
                    let between = node.map(|at| at.rem_euclid(2 * half) != 0);
                    if between.iter().filter(|&&is| is).count() != odd || self.simulated(node) {
                        continue;
                    }
                    let around = self.around(node, half, between, differ);
                    let Some(&outcome) = around.first() else { continue };
                    self.nodes.insert(node, Found { outcome, simulated: false });
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

    /// Outcomes at this distance from a place along the axes on which it lies between two; of a face's
    /// middle along the one axis on which they are alike, if there is one.
    fn around(
        &self,
        node: Node,
        by: i32,
        between: [bool; 2],
        differ: fn(Outcome, Outcome) -> bool,
    ) -> Vec<Outcome> {
        let pair = |axis: usize| -> Vec<Outcome> {
            let beside = [-by, by].map(|by| moved(node, axis, by));
            beside.iter().filter_map(|at| Some(self.nodes.get(at)?.outcome)).collect()
        };
        let apart = |pair: &[Outcome]| pair.iter().any(|&outcome| differ(outcome, pair[0]));
        let [first, second] = [0, 1].map(|axis| if between[axis] { pair(axis) } else { vec![] });
        match (apart(&first), apart(&second)) {
            (false, true) if !first.is_empty() => first,
            (true, false) if !second.is_empty() => second,
            _ => [first, second].concat(),
        }
    }

    /// Tries places amid taken over ones that all insert, or all do not.
    fn probe(&mut self) {
        let alike = |(node, found): &(&Node, &Found)| {
            let same = |beside: Node| {
                let other = self.nodes[&beside];
                !other.simulated && !insert_differently(other.outcome, found.outcome)
            };
            !found.simulated && self.beside(**node).all(same)
        };
        let mut uniform: Vec<Node> =
            self.nodes.iter().filter(alike).map(|(node, _)| *node).collect();
        uniform.shuffle(&mut stream(0, 0, "probes of a capture map"));
        uniform.truncate(PROBES);
        self.simulate(uniform, MOST_TRIALS);
    }

    /// Tries what was taken over beside a trial that ended otherwise, until nothing is.
    fn verify(&mut self) {
        loop {
            let doubtful = |(node, found): &(&Node, &Found)| {
                let against = |beside: Node| {
                    let other = self.nodes[&beside];
                    other.simulated && insert_differently(other.outcome, found.outcome)
                };
                !found.simulated && self.beside(**node).any(against)
            };
            let doubtful: Vec<Node> =
                self.nodes.iter().filter(doubtful).map(|(node, _)| *node).collect();
            if doubtful.is_empty() || !self.simulate(doubtful, MOST_TRIALS) {
                return;
            }
        }
    }

    /// Tries those places that were not yet; if that were more trials than `most`, evenly taken ones of
    /// them. Whether it was all.
    fn simulate(&mut self, mut wanted: Vec<Node>, most: usize) -> bool {
        wanted.retain(|&node| !self.simulated(node));
        let (all, room) = (wanted.len(), most.saturating_sub(self.trials));
        if all > room {
            wanted = (0..room).map(|i| wanted[i * all / room]).collect();
        }
        let outcomes: Vec<Outcome> = wanted.par_iter().map(|&node| (self.measure)(node)).collect();
        self.trials += wanted.len();
        let found = outcomes.into_iter().map(|outcome| Found { outcome, simulated: true });
        self.nodes.extend(wanted.into_iter().zip(found));
        all <= room
    }

    fn simulated(&self, node: Node) -> bool {
        self.nodes.get(&node).is_some_and(|found| found.simulated)
    }

    /// Places at this distance from one another; by the second axis, so that neighbours share a grasp.
    fn lattice(&self, distance: i32) -> Vec<Node> {
        let along = |axis: usize| (self.low[axis]..=self.high[axis]).step_by(distance as usize);
        along(1).flat_map(|other| along(0).map(move |y| [y, other])).collect()
    }

    /// Up to four neighbours on the grid.
    fn beside(&self, node: Node) -> impl Iterator<Item = Node> {
        let all = [(0, -1), (0, 1), (1, -1), (1, 1)];
        let beside = all.into_iter().map(move |(axis, by)| moved(node, axis, by));
        beside.filter(|at| self.nodes.contains_key(at))
    }
}

fn moved(mut node: Node, axis: usize, by: i32) -> Node {
    node[axis] += by;
    node
}
