//! Neighbour lists (Verlet 1967, Phys. Rev. 159:98): the geom pairs of two bodies that may touch while the relative
//! displacement of the bodies is below a margin. Only these pairs are tested in a step.

use super::super::body::MovingBody;
use super::{Candidate, Solid, has_stayed};
use crate::scene::{ContactPair, GeomPair, Pose};
use nalgebra::Vector3;
use parry::bounding_volume::{Aabb, BoundingVolume};
use parry::partitioning::{Bvh, BvhBuildStrategy};
use rapier3d_f64::parry;
use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;

/// Relative displacement of two bodies up to which their near pairs are valid, m.
const MARGIN: f64 = 0.5e-3;

/// Relative displacement of two bodies up to which their close pairs ([`NearList::close`]) are valid, m.
const CLOSE: f64 = 0.12e-3;

/// Pair of geoms that may touch.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) struct NearPair {
    /// Number of the geom pair, counted over all body pairs of the scene.
    pub number: usize,
    /// Indices of the geoms of the first and the second body in `Detector::solids`.
    pub solids: [usize; 2],
}

/// Geom pairs of two bodies.
#[derive(Clone)]
pub(super) struct NearList {
    pub bodies: ContactPair,
    /// Pairs that may touch until the bodies have moved by [`MARGIN`].
    pub near: Vec<NearPair>,
    /// Near pairs that may touch within the next steps; the only ones tested if two bodies have many geom pairs.
    pub close: Vec<NearPair>,
    /// Indices of the geoms of the near pairs, ascending.
    pub solids: Vec<usize>,
    /// All pairs that have been near, by their numbers, with their contact points.
    pub candidates: BTreeMap<usize, Candidate>,
    /// Index of the body pair in the scene's contacts.
    number: usize,
    /// Number of the first geom pair.
    from: usize,
    /// Indices of the geoms of each body.
    first: Range<usize>,
    second: Range<usize>,
    /// Bounding volume hierarchy of the first body's geoms in the body frame.
    tree: Arc<Bvh>,
    /// Largest distance of a point of the second body from the origin of the body frame, m.
    reach: f64,
    /// Pose of the second body in the frame of the first for which the near pairs were determined.
    made_at: Option<Pose>,
    /// Pose of the second body in the frame of the first for which the close pairs were selected.
    chosen_at: Option<Pose>,
    /// Prediction distance for which the close pairs were selected, m.
    chosen_for: f64,
}

/// Builds the bounding volume hierarchy of a body's geoms in the body frame.
pub(super) fn tree(solids: &[Solid]) -> Bvh {
    let boxes: Vec<_> = solids.iter().map(|solid| solid.aabb).collect();
    Bvh::from_leaves(BvhBuildStrategy::Binned, &boxes)
}

impl NearList {
    /// Creates the list of a body pair, given with its index in the scene's contacts. `from` is the number of its first
    /// geom pair; the third argument contains the geom indices and the hierarchy of each body.
    pub fn new(
        (number, bodies): (usize, &ContactPair),
        from: usize,
        [(first, tree), (second, _)]: [(Range<usize>, Arc<Bvh>); 2],
        solids: &[Solid],
    ) -> Self {
        let far = |solid: &Solid| solid.frame.translation.vector.norm() + solid.half.norm();
        NearList {
            reach: solids[second.clone()].iter().map(far).fold(0.0, f64::max),
            near: Vec::new(),
            close: Vec::new(),
            solids: Vec::new(),
            candidates: BTreeMap::new(),
            made_at: None,
            chosen_at: None,
            chosen_for: 0.0,
            bodies: *bodies,
            number,
            from,
            first,
            second,
            tree,
        }
    }

    /// Returns the number of geom pairs.
    pub fn pairs(&self) -> usize {
        self.first.len() * self.second.len()
    }

    /// Returns an upper bound of the speed of any point of the second body relative to the first, m/s.
    pub fn speed(&self, bodies: &[MovingBody]) -> f64 {
        let [first, second] = [self.bodies.first, self.bodies.second].map(|body| &bodies[body.0]);
        let own = first.velocity - second.velocity;
        let (linear, angular) = (own.fixed_rows::<3>(0).norm(), own.fixed_rows::<3>(3).norm());
        let apart = (first.centre - second.centre).norm();
        let turned = first.velocity.fixed_rows::<3>(3).norm() * apart;
        // The velocity is that of the centre of mass; `reach` is about the origin of the frame.
        let reach = self.reach + (second.centre - second.pose.translation.vector).coords.norm();
        linear + turned + angular * reach
    }

    /// Determines the near pairs again if the bodies have moved by [`MARGIN`]; `relative` is the pose of the second in
    /// the frame of the first.
    pub fn renew(&mut self, relative: &Pose, solids: &[Solid], prediction: f64) {
        if has_stayed(self.made_at.as_ref(), relative, self.reach, MARGIN) {
            return;
        }
        (self.made_at, self.chosen_at) = (Some(*relative), None);
        self.near.clear();
        for second in self.second.clone() {
            let frame = relative * solids[second].frame;
            let turn = frame.rotation.to_rotation_matrix().into_inner();
            let half = turn.abs() * solids[second].half + Vector3::repeat(prediction + MARGIN);
            let middle = frame.translation.vector;
            let aabb = Aabb::from_half_extents(middle.into(), half.into());
            let ends = self.tree.intersect_aabb(&aabb).map(|leaf| leaf as usize);
            let (wide, own) = (self.second.len(), second - self.second.start);
            self.near.extend(ends.map(|leaf| NearPair {
                number: self.from + leaf * wide + own,
                solids: [self.first.start + leaf, second],
            }));
        }
        self.near.sort_unstable();
        self.solids = self.near.iter().flat_map(|pair| pair.solids).collect();
        self.solids.sort_unstable();
        self.solids.dedup();
        for &NearPair { number, solids: [first, second] } in &self.near {
            self.candidates.entry(number).or_insert_with(|| {
                let own = [first, second].map(|solid| solids[solid].friction);
                let friction = self.bodies.friction.of_geoms(own);
                Candidate::new(GeomPair { bodies: self.number, first, second, friction })
            });
        }
    }

    /// Selects the close pairs again, by the current bounding boxes of the geoms, if the bodies have moved by [`CLOSE`]
    /// or the prediction distance has increased.
    pub fn choose(&mut self, relative: &Pose, solids: &[Solid], prediction: f64) {
        let stayed = has_stayed(self.chosen_at.as_ref(), relative, self.reach, CLOSE);
        if stayed && prediction <= self.chosen_for {
            return;
        }
        // With a margin, since the prediction distance increases with the speed.
        (self.chosen_at, self.chosen_for) = (Some(*relative), 1.5 * prediction);
        let first = self.solids.first().copied().unwrap_or(0);
        let count = self.solids.last().map_or(0, |last| last + 1 - first);
        let mut dense = vec![Aabb::new_invalid(); count];
        // Copied so that they are contiguous in memory: a solid has many other fields.
        self.solids.iter().for_each(|&i| dense[i - first] = solids[i].aabb);
        let margin = self.chosen_for + CLOSE;
        self.close.clear();
        self.close.extend(self.near.iter().filter(|pair| {
            let [own, other] = pair.solids.map(|i| dense[i - first]);
            own.loosened(margin).intersects(&other)
        }));
    }
}
