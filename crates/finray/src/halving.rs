//! Nested dissection of a mesh: an order of its triangles by recursive cuts across few nodes.

use super::mesh::Mesh;
use nalgebra::Point2;

/// Largest number of triangles of a part that is not halved.
pub(super) const LEAF: usize = 8;

/// Halves a mesh recursively into parts of at most [`LEAF`] triangles. Returns an order of the triangles in which each
/// part is contiguous, and the number of triangles before each cut, in pre-order: the cut of the whole, the cuts of
/// its first part, the cuts of its second part.
pub(super) fn halve(mesh: &Mesh) -> (Vec<u32>, Vec<usize>) {
    let centre = |t| mesh.corners(t).iter().fold(Point2::origin(), |sum, p| sum + p.coords / 3.0);
    let centres: Vec<_> = (0..mesh.triangles.len()).map(centre).collect();
    let mut halving = Halving {
        corners: mesh.triangles.iter().map(|&[a, b, c, ..]| [a, b, c]).collect(),
        ranks: DIRECTIONS.map(|direction| ranks(&centres, direction)),
        centres,
        stamps: vec![0; mesh.nodes.len()],
        cuts: Vec::new(),
    };
    let mut order: Vec<u32> = (0..mesh.triangles.len() as u32).collect();
    halving.sort(&mut order);
    (order, halving.cuts)
}

/// Returns the rank of each triangle along a direction, each rank once.
fn ranks(centres: &[Point2<f64>], [x, y]: [f64; 2]) -> Vec<u32> {
    let places: Vec<f64> = centres.iter().map(|centre| x * centre.x + y * centre.y).collect();
    let mut sorted: Vec<u32> = (0..centres.len() as u32).collect();
    sorted.sort_by(|&a, &b| places[a as usize].total_cmp(&places[b as usize]));
    let mut ranks = vec![0; centres.len()];
    for (rank, t) in sorted.into_iter().enumerate() {
        ranks[t as usize] = rank as u32;
    }
    ranks
}

/// Recursive halving of the triangles, so that the parts share few nodes.
struct Halving {
    corners: Vec<[u32; 3]>,
    centres: Vec<Point2<f64>>,
    /// Ranks of the triangles along each direction.
    ranks: [Vec<u32>; 4],
    /// Scratch of [`Halving::shared`].
    stamps: Vec<u8>,
    /// See [`halve`].
    cuts: Vec<usize>,
}

/// Directions along which a set of triangles may be halved.
const DIRECTIONS: [[f64; 2]; 4] = [[1.0, 0.0], [0.0, 1.0], [0.7, 0.7], [0.7, -0.7]];
/// Fractions of the triangles that may lie before a cut.
const CUT_FRACTIONS: [f64; 3] = [0.5, 0.4, 0.6];
/// Number of triangles below which only the cut into halves along x or y is tried.
const FEW: usize = 30;

/// Direction, and number of the triangles that lie first along it.
type Cut = (usize, usize);

impl Halving {
    fn sort(&mut self, order: &mut [u32]) {
        if order.len() <= LEAF {
            order.sort_unstable();
            return;
        }
        let cut = if order.len() < FEW { self.halves(order) } else { self.best(order) };
        self.cut(order, cut);
        self.cuts.push(cut.1);
        let (first, second) = order.split_at_mut(cut.1);
        self.sort(first);
        self.sort(second);
    }

    /// Moves the triangles that lie first along a direction to the start.
    fn cut(&self, order: &mut [u32], (direction, first): Cut) {
        let ranks = &self.ranks[direction];
        order.select_nth_unstable_by_key(first, |&t| ranks[t as usize]);
    }

    /// Returns the cut into halves along x or y, whichever is longer.
    fn halves(&self, order: &[u32]) -> Cut {
        let extent = |of: fn(&Point2<f64>) -> f64| {
            let places = order.iter().map(|&t| of(&self.centres[t as usize]));
            let (low, high) =
                places.fold((f64::MAX, f64::MIN), |(low, high), p| (low.min(p), high.max(p)));
            high - low
        };
        // The first two directions are x and y.
        let direction = usize::from(extent(|p| p.x) <= extent(|p| p.y));
        (direction, order.len() / 2)
    }

    /// Returns the cut across which the fewest corners are shared.
    fn best(&mut self, order: &mut [u32]) -> Cut {
        let firsts = CUT_FRACTIONS.map(|share| (order.len() as f64 * share) as usize);
        let cuts =
            (0..DIRECTIONS.len()).flat_map(|direction| firsts.map(|first| (direction, first)));
        let shared = |&cut: &Cut| {
            self.cut(order, cut);
            self.shared(order, cut.1)
        };
        cuts.min_by_key(shared).unwrap_or_default()
    }

    /// Returns the number of corners in both parts of an order.
    fn shared(&mut self, order: &[u32], first: usize) -> usize {
        let of = |t: &u32| self.corners[*t as usize];
        let (first, second) = order.split_at(first);
        for corner in second.iter().flat_map(of) {
            self.stamps[corner as usize] = 0;
        }
        for corner in first.iter().flat_map(of) {
            self.stamps[corner as usize] = 1;
        }
        let mut take = |corner| usize::from(std::mem::take(&mut self.stamps[corner as usize]));
        second.iter().flat_map(of).map(&mut take).sum()
    }
}
