//! Exact cut of a closed surface into convex pieces. Between two neighbouring heights of its
//! corners there is no corner, so every side is flat and the outline keeps its corners.

use super::surface::Surface;
use crate::body::{span, width};
use input::units::MM;
use nalgebra::{Point2, Point3};
use spade::{ConstrainedDelaunayTriangulation, Point2 as Place, Triangulation};
use std::collections::BTreeMap;

/// Largest difference of equal coordinates, m.
const NEAR: f64 = 1e-3 * MM;
/// Most layers of an extruded outline; a curved surface has more.
const MOST_LAYERS: usize = 120;
/// Most pieces of an extruded outline.
const MOST_PIECES: usize = 600;
/// Most levels of y of an outline cut into strips; a curved one is cut into triangles.
const MOST_STRIPS: usize = 24;
/// Least narrowing of a chamfer, both sides together, over its depth.
const SLANTED: f64 = 0.3;
/// Share of the largest hole's size from which on another is as well an opening.
const ALIKE: f64 = 0.2;
/// Largest area of a straight turn, m2.
const STRAIGHT: f64 = 1e-4 * MM * MM;

/// Corner of an outline, at the lower and at the upper end of its layer.
#[derive(Debug, Clone, Copy)]
struct Riser([Point3<f64>; 2]);

/// Closed line of risers, counter-clockwise about solid, clockwise about holes.
type Outline = Vec<Riser>;

impl Riser {
    /// Place at a share of the layer's height.
    fn at(&self, share: f64) -> Point2<f64> {
        let [low, high] = self.0;
        (low + (high - low) * share).xy()
    }

    /// Riser at a share of the way to another.
    fn towards(&self, other: &Riser, share: f64) -> Riser {
        Riser([0, 1].map(|i| self.0[i] + (other.0[i] - self.0[i]) * share))
    }
}

/// Corners of a convex piece, m.
pub type Piece = Vec<Point3<f64>>;

/// Pieces of the surface; `None` if it cannot be cut into few layers.
pub fn pieces(surface: &Surface) -> Option<Vec<Piece>> {
    let heights = levels(surface.points.iter().map(|p| p.z));
    if heights.len() > MOST_LAYERS {
        return None;
    }
    let mut found = Vec::new();
    for pair in heights.windows(2) {
        found.extend(layer_pieces(&layer(surface, [pair[0], pair[1]])?)?);
        if found.len() > MOST_PIECES {
            return None;
        }
    }
    Some(found)
}

/// Opening of a socket; bounding boxes in x and y, m.
pub struct Mouth {
    /// A little below the top.
    pub opening: [[f64; 2]; 2],
    /// Size on the top.
    pub rim: [f64; 2],
    /// Size where the walls are upright.
    pub throat: [f64; 2],
    /// Depth of that place, m.
    pub depth: f64,
}

/// Returns the only large hole in the surface's highest layer, its box taken `below` the top, m.
pub fn mouth(surface: &Surface, below: f64) -> Option<Mouth> {
    let heights = levels(surface.points.iter().map(|p| p.z));
    let &[low, top] = heights.last_chunk::<2>()?;
    let size = |hole: &Outline, share: f64| bounds(hole, share).map(width);
    let holes = |pair: &[f64]| {
        let layer = layer(surface, [pair[0], pair[1]]).unwrap_or_default();
        layer.into_iter().filter(|outline| area(outline, 0.5) < 0.0).collect::<Vec<_>>()
    };
    let large = |hole: &Outline| size(hole, 0.5).iter().product::<f64>();
    let all = holes(&[low, top]);
    let first = all.iter().max_by(|a, b| large(a).total_cmp(&large(b)))?.clone();
    // Of several openings the largest need not be that of the plug's end.
    if all.iter().filter(|hole| large(hole) > ALIKE * large(&first)).count() > 1 {
        return None;
    }
    let opening = bounds(&first, (1.0 - below / (top - low)).max(0.0));
    let middle = opening.map(|[low, high]| (low + high) / 2.0);
    let about = |hole: &Outline| {
        let inside = |axis: usize, [low, high]: [f64; 2]| low < middle[axis] && middle[axis] < high;
        bounds(hole, 1.0).into_iter().enumerate().all(|(axis, range)| inside(axis, range))
    };
    let mut mouth =
        Mouth { opening, rim: size(&first, 1.0), throat: size(&first, 1.0), depth: 0.0 };
    for pair in heights.windows(2).rev() {
        let Some(hole) = holes(pair).into_iter().find(about) else { break };
        let [wide, narrow] = [1.0, 0.0].map(|share| size(&hole, share));
        if (0..2).all(|axis| wide[axis] - narrow[axis] < SLANTED * (pair[1] - pair[0])) {
            break;
        }
        (mouth.throat, mouth.depth) = (narrow, top - pair[0]);
    }
    Some(mouth)
}

/// Bounding box in x and y of an outline at a share of its height.
fn bounds(outline: &Outline, share: f64) -> [[f64; 2]; 2] {
    [0, 1].map(|axis| span(outline.iter().map(|riser| riser.at(share)[axis])))
}

/// Numbers in order, without those that are near to the one before.
fn levels(values: impl Iterator<Item = f64>) -> Vec<f64> {
    let mut levels: Vec<f64> = values.collect();
    levels.sort_by(f64::total_cmp);
    levels.dedup_by(|b, a| *b - *a < NEAR);
    levels
}

/// Outlines of the layer between two neighbouring heights; `None` if the surface touches itself.
fn layer(surface: &Surface, [low, high]: [f64; 2]) -> Option<Vec<Outline>> {
    let mut next: BTreeMap<[usize; 2], [usize; 2]> = BTreeMap::new();
    for face in &surface.faces {
        let Some((from, to)) = crossing(surface, face, [low, high]) else { continue };
        if next.insert(from, to).is_some() {
            return None;
        }
    }
    let mut outlines = Vec::new();
    while let Some((&first, _)) = next.first_key_value() {
        let (mut outline, mut edge) = (Vec::new(), first);
        while let Some(to) = next.remove(&edge) {
            outline.push(riser(surface, edge, [low, high]));
            edge = to;
        }
        if edge != first {
            return None;
        }
        let outline = straightened(outline);
        if outline.len() > 2 {
            outlines.push(outline);
        }
    }
    Some(outlines)
}

/// Edges of a face that cross the layer, in the order that keeps the solid to the left from above.
fn crossing(
    surface: &Surface,
    face: &[usize; 3],
    layer: [f64; 2],
) -> Option<([usize; 2], [usize; 2])> {
    let edges = (0..3).map(|i| {
        let (a, b) = (face[i], face[(i + 1) % 3]);
        [a.min(b), a.max(b)]
    });
    let crosses = |&[a, b]: &[usize; 2]| {
        let (a, b) = (surface.points[a].z, surface.points[b].z);
        a.min(b) < layer[0] + NEAR && a.max(b) > layer[1] - NEAR
    };
    let crossing: Vec<_> = edges.filter(crosses).collect();
    let &[first, second] = crossing.as_slice() else { return None };
    let [a, b, c] = face.map(|corner| surface.points[corner]);
    let normal = (b - a).cross(&(c - a));
    let middle = |edge| riser(surface, edge, layer).at(0.5);
    let along = middle(second) - middle(first);
    // Outward lies to the right.
    match -normal.y * along.x + normal.x * along.y > 0.0 {
        true => Some((first, second)),
        false => Some((second, first)),
    }
}

fn riser(surface: &Surface, [a, b]: [usize; 2], layer: [f64; 2]) -> Riser {
    let (a, b) = (surface.points[a], surface.points[b]);
    Riser(layer.map(|z| a + (b - a) * ((z - a.z) / (b.z - a.z))))
}

/// Outline without the corners at which it goes straight on at every height. (At an end the
/// diagonal of a flat side meets a corner, so the middle counts, too.)
fn straightened(outline: Outline) -> Outline {
    let straight = |three: &[Riser; 3]| {
        [0.0, 0.5, 1.0].into_iter().all(|share| turn(three, share).abs() < STRAIGHT)
    };
    without(outline, 2, straight)
}

/// Returns a closed line of at least `least` corners, without those straight with their neighbours.
pub fn without<T: Copy>(
    mut line: Vec<T>,
    least: usize,
    straight: impl Fn(&[T; 3]) -> bool,
) -> Vec<T> {
    loop {
        let count = line.len();
        let three = |i: usize| [(i + count - 1) % count, i, (i + 1) % count].map(|i| line[i]);
        match (0..count).find(|&i| count > least && straight(&three(i))) {
            Some(i) => line.remove(i),
            None => return line,
        };
    }
}

/// Twice the area of three corners at a share of the height, positive for a left turn.
fn turn([a, b, c]: &[Riser; 3], share: f64) -> f64 {
    let [a, b, c] = [a, b, c].map(|riser| riser.at(share));
    (b - a).perp(&(c - b))
}

fn area(outline: &[Riser], share: f64) -> f64 {
    edges(outline).map(|(a, b)| a.at(share).coords.perp(&b.at(share).coords) / 2.0).sum()
}

/// Convex pieces of the layer; `None` if its outline cannot be meshed.
fn layer_pieces(layer: &[Outline]) -> Option<Vec<Piece>> {
    if let [outline] = layer
        && convex(outline)
    {
        return Some(vec![piece(outline)]);
    }
    let parts = strips(layer).or_else(|| triangles(layer))?;
    Some(merged(parts).iter().map(piece).collect())
}

/// Trapezoids of an upright layer, cut along x at its corners. Seams then run along walls, as in
/// a file written by hand, and none ends askew in a corner of the opening, where plugs catch.
fn strips(layer: &[Outline]) -> Option<Vec<Outline>> {
    let risers = || layer.iter().flatten();
    if risers().any(|riser| (riser.at(1.0) - riser.at(0.0)).norm() > NEAR) {
        return None;
    }
    let levels = levels(risers().map(|riser| riser.at(0.5).y));
    let strips = levels.windows(2).flat_map(|pair| strip(layer, [pair[0], pair[1]]));
    (levels.len() <= MOST_STRIPS).then(|| strips.collect())
}

/// Solid trapezoids between two neighbouring levels of y.
fn strip(layer: &[Outline], [low, high]: [f64; 2]) -> Vec<Outline> {
    let middle = (low + high) / 2.0;
    let mut sides: Vec<[Riser; 2]> = Vec::new();
    for (a, b) in layer.iter().flat_map(|outline| edges(outline)) {
        let (from, to) = (a.at(0.5).y, b.at(0.5).y);
        if (from > middle) != (to > middle) {
            sides.push([low, high].map(|y| a.towards(b, (y - from) / (to - from))));
        }
    }
    let x = |side: &[Riser; 2]| side[0].at(0.5).x + side[1].at(0.5).x;
    sides.sort_by(|a, b| x(a).total_cmp(&x(b)));
    // From outside the first side enters what is solid, the second leaves it.
    let between = |pair: &[[Riser; 2]]| {
        let mut corners = vec![pair[0][0], pair[1][0], pair[1][1], pair[0][1]];
        // A trapezoid may be a triangle.
        corners.dedup_by(|b, a| same(b, a));
        straightened(corners)
    };
    sides.chunks_exact(2).map(between).filter(|outline| outline.len() > 2).collect()
}

/// Triangles of risers, counter-clockwise.
fn triangles(layer: &[Outline]) -> Option<Vec<Outline>> {
    let mut mesh = ConstrainedDelaunayTriangulation::<Place<f64>>::new();
    let mut risers: BTreeMap<usize, Riser> = BTreeMap::new();
    for outline in layer {
        let mut ring = Vec::new();
        for riser in outline {
            // In millimetres: of the size for which the mesher's tolerances are made.
            let place = riser.at(0.5) / MM;
            let handle = mesh.insert(Place::new(place.x, place.y)).ok()?;
            risers.insert(handle.index(), *riser);
            ring.push(handle);
        }
        for i in 0..ring.len() {
            let (a, b) = (ring[i], ring[(i + 1) % ring.len()]);
            if !mesh.can_add_constraint(a, b) {
                return None;
            }
            mesh.add_constraint(a, b);
        }
    }
    // Merging them takes the third power of their number.
    if mesh.num_inner_faces() > MOST_PIECES {
        return None;
    }
    let mut found = Vec::new();
    for face in mesh.inner_faces() {
        let corners = face.vertices().map(|vertex| risers.get(&vertex.fix().index()).copied());
        let &[Some(a), Some(b), Some(c)] = &corners else { return None };
        let middle = (a.at(0.5).coords + b.at(0.5).coords + c.at(0.5).coords) / 3.0;
        if solid_at(layer, &Point2::from(middle)) {
            found.push(vec![a, b, c]);
        }
    }
    Some(found)
}

/// Returns whether a point lies inside, by the even-odd rule.
fn solid_at(layer: &[Outline], p: &Point2<f64>) -> bool {
    let crossed = |(a, b): &(&Riser, &Riser)| {
        let (a, b) = (a.at(0.5), b.at(0.5));
        (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)
    };
    layer.iter().flat_map(|outline| edges(outline)).filter(crossed).count() % 2 == 1
}
fn edges(outline: &[Riser]) -> impl Iterator<Item = (&Riser, &Riser)> {
    outline.iter().zip(outline.iter().cycle().skip(1))
}

fn same(a: &Riser, b: &Riser) -> bool {
    (a.at(0.5) - b.at(0.5)).norm() < NEAR
}

/// Returns whether an outline only turns left, at its lower end, its middle and its upper end.
fn convex(outline: &[Riser]) -> bool {
    let count = outline.len();
    (0..count).all(|i| {
        let three = [i, (i + 1) % count, (i + 2) % count].map(|i| outline[i]);
        [0.0, 0.5, 1.0].into_iter().all(|share| turn(&three, share) > -STRAIGHT)
    })
}

/// Neighbours joined as long as they stay convex (Hertel and Mehlhorn 1983).
fn merged(mut outlines: Vec<Outline>) -> Vec<Outline> {
    let joined = |a: &Outline, b: &Outline| {
        for i in 0..a.len() {
            for j in 0..b.len() {
                let (from, to) = (&a[i], &a[(i + 1) % a.len()]);
                if same(from, &b[(j + 1) % b.len()]) && same(to, &b[j]) {
                    // All of a from `to` round to `from`, then all of b between them.
                    let mut both: Outline = (1..=a.len()).map(|k| a[(i + k) % a.len()]).collect();
                    both.extend((2..b.len()).map(|k| b[(j + k) % b.len()]));
                    return convex(&both).then_some(both);
                }
            }
        }
        None
    };
    'again: loop {
        for i in 0..outlines.len() {
            for j in i + 1..outlines.len() {
                if let Some(both) = joined(&outlines[i], &outlines[j]) {
                    outlines.swap_remove(j);
                    outlines[i] = both;
                    continue 'again;
                }
            }
        }
        return outlines;
    }
}

fn piece(outline: &Outline) -> Piece {
    outline.iter().flat_map(|riser| riser.0).collect()
}
