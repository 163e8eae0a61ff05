//! A closed surface cut into convex pieces, exactly: between two neighbouring heights of its
//! corners it has no corner, so there every side is flat and the outline has the same corners at
//! every height.

use super::surface::Surface;
use input::units::MM;
use nalgebra::{Point2, Point3};
use spade::{ConstrainedDelaunayTriangulation, Point2 as Place, Triangulation};
use std::collections::BTreeMap;

/// Heights that are nearer than this are one, m.
const NEAR: f64 = 1e-3 * MM;
/// More layers than this are no extruded outline, but a curved surface.
const MOST_LAYERS: usize = 120;
/// More pieces than this are no extruded outline either.
const MOST_PIECES: usize = 600;
/// An outline with more levels than this is curved, and triangles do better.
const MOST_STRIPS: usize = 24;
/// Turns of less area are straight, m2.
const STRAIGHT: f64 = 1e-4 * MM * MM;

/// A corner of an outline, at the lower and at the upper end of its layer.
#[derive(Debug, Clone, Copy)]
struct Riser {
    ends: [Point3<f64>; 2],
}

/// A closed line of risers, counter-clockwise about what is solid.
type Outline = Vec<Riser>;

/// The outline of a layer: closed lines, counter-clockwise about solid, clockwise about holes.
pub struct Layer {
    outlines: Vec<Outline>,
}

impl Riser {
    /// At a share of the layer's height.
    fn at(&self, share: f64) -> Point2<f64> {
        let [low, high] = self.ends;
        (low + (high - low) * share).xy()
    }

    /// The riser at a share of the way to another.
    fn towards(&self, other: &Riser, share: f64) -> Riser {
        Riser { ends: [0, 1].map(|i| self.ends[i] + (other.ends[i] - self.ends[i]) * share) }
    }
}

/// Without corners that fall on the one before: a trapezoid may be a triangle.
fn without_doubles(mut outline: Outline) -> Outline {
    outline.dedup_by(|b, a| (b.at(0.5) - a.at(0.5)).norm() < NEAR);
    outline
}

/// Corners of one convex piece.
pub type Piece = Vec<Point3<f64>>;

/// The pieces, if the surface can be cut into few layers.
pub fn pieces(surface: &Surface) -> Option<Vec<Piece>> {
    let heights = heights(surface);
    if heights.len() > MOST_LAYERS {
        return None;
    }
    let mut found = Vec::new();
    for pair in heights.windows(2) {
        found.extend(layer(surface, [pair[0], pair[1]])?.pieces()?);
        if found.len() > MOST_PIECES {
            return None;
        }
    }
    Some(found)
}

/// The holes of the highest layer, a box each at this far below the top: from, to in x and y, m.
pub fn openings(surface: &Surface, below: f64) -> Vec<[[f64; 2]; 2]> {
    let heights = heights(surface);
    let Some(&[low, high]) = heights.last_chunk::<2>() else { return Vec::new() };
    let Some(top) = layer(surface, [low, high]) else { return Vec::new() };
    let share = (1.0 - below / (high - low)).max(0.0);
    let holes = top.outlines.iter().filter(|outline| area(outline, share) < 0.0);
    holes
        .map(|hole| {
            [0, 1].map(|axis| {
                super::super::body::span(hole.iter().map(|riser| riser.at(share)[axis]))
            })
        })
        .collect()
}

fn heights(surface: &Surface) -> Vec<f64> {
    let mut heights: Vec<f64> = surface.points.iter().map(|p| p.z).collect();
    heights.sort_by(f64::total_cmp);
    heights.dedup_by(|b, a| *b - *a < NEAR);
    heights
}

/// The outlines between two neighbouring heights; none if the surface touches itself.
fn layer(surface: &Surface, [low, high]: [f64; 2]) -> Option<Layer> {
    let mut next: BTreeMap<[usize; 2], [usize; 2]> = BTreeMap::new();
    for face in &surface.faces {
        let Some((from, to)) = walk(surface, face, [low, high]) else { continue };
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
    Some(Layer { outlines })
}

/// The two edges of a face that cross the layer, in the order that keeps what is solid to the
/// left, seen from above.
fn walk(surface: &Surface, face: &[usize; 3], layer: [f64; 2]) -> Option<([usize; 2], [usize; 2])> {
    let edges = (0..3).map(|i| {
        let (a, b) = (face[i], face[(i + 1) % 3]);
        [a.min(b), a.max(b)]
    });
    let crossing: Vec<_> = edges.filter(|edge| crosses(surface, edge, layer)).collect();
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

fn crosses(surface: &Surface, &[a, b]: &[usize; 2], [low, high]: [f64; 2]) -> bool {
    let (a, b) = (surface.points[a].z, surface.points[b].z);
    a.min(b) < low + NEAR && a.max(b) > high - NEAR
}

fn riser(surface: &Surface, [a, b]: [usize; 2], layer: [f64; 2]) -> Riser {
    let (a, b) = (surface.points[a], surface.points[b]);
    Riser { ends: layer.map(|z| a + (b - a) * ((z - a.z) / (b.z - a.z))) }
}

/// Without the corners at which the outline goes straight on at every height. (At an end the
/// diagonal of a flat side meets a corner, so the middle is asked, too.)
fn straightened(mut outline: Outline) -> Outline {
    loop {
        let count = outline.len();
        let straight = |i: usize| {
            let three = [(i + count - 1) % count, i, (i + 1) % count].map(|i| outline[i]);
            [0.0, 0.5, 1.0].into_iter().all(|share| turn(&three, share).abs() < STRAIGHT)
        };
        match (0..count).find(|&i| count > 2 && straight(i)) {
            Some(i) => outline.remove(i),
            None => return outline,
        };
    }
}

/// Twice the area of three corners at a height, positive if they turn left.
fn turn([a, b, c]: &[Riser; 3], share: f64) -> f64 {
    let [a, b, c] = [a, b, c].map(|riser| riser.at(share));
    (b - a).perp(&(c - b))
}

fn area(outline: &[Riser], share: f64) -> f64 {
    let next = |i: usize| outline[(i + 1) % outline.len()].at(share);
    (0..outline.len()).map(|i| outline[i].at(share).coords.perp(&next(i).coords) / 2.0).sum()
}

impl Layer {
    /// Convex pieces of the layer; none if its outline cannot be meshed.
    fn pieces(&self) -> Option<Vec<Piece>> {
        if let [outline] = self.outlines.as_slice()
            && convex(outline)
        {
            return Some(vec![piece(outline)]);
        }
        let parts = self.strips().or_else(|| self.triangles())?;
        Some(merged(parts).iter().map(|outline| piece(outline)).collect())
    }

    /// An upright layer cut along x at its corners: trapezoids. Seams then run along walls, as in a
    /// file written by hand, and none ends askew in a corner of the opening, where plugs catch.
    fn strips(&self) -> Option<Vec<Outline>> {
        let risers = || self.outlines.iter().flatten();
        if risers().any(|riser| (riser.at(1.0) - riser.at(0.0)).norm() > NEAR) {
            return None;
        }
        let mut levels: Vec<f64> = risers().map(|riser| riser.at(0.5).y).collect();
        levels.sort_by(f64::total_cmp);
        levels.dedup_by(|b, a| *b - *a < NEAR);
        if levels.len() > MOST_STRIPS {
            return None;
        }
        Some(levels.windows(2).flat_map(|pair| self.strip([pair[0], pair[1]])).collect())
    }

    /// What is solid between two neighbouring levels of y.
    fn strip(&self, [low, high]: [f64; 2]) -> Vec<Outline> {
        let middle = (low + high) / 2.0;
        let mut sides: Vec<[Riser; 2]> = Vec::new();
        for outline in &self.outlines {
            for i in 0..outline.len() {
                let (a, b) = (outline[i], outline[(i + 1) % outline.len()]);
                let (from, to) = (a.at(0.5).y, b.at(0.5).y);
                if (from > middle) != (to > middle) {
                    sides.push([low, high].map(|y| a.towards(&b, (y - from) / (to - from))));
                }
            }
        }
        let x = |side: &[Riser; 2]| side[0].at(0.5).x + side[1].at(0.5).x;
        sides.sort_by(|a, b| x(a).total_cmp(&x(b)));
        // From outside the first side enters what is solid, the second leaves it.
        let between = |pair: &[[Riser; 2]]| {
            let corners = vec![pair[0][0], pair[1][0], pair[1][1], pair[0][1]];
            straightened(without_doubles(corners))
        };
        sides.chunks_exact(2).map(between).filter(|outline| outline.len() > 2).collect()
    }

    /// Triangles of risers, counter-clockwise.
    fn triangles(&self) -> Option<Vec<Outline>> {
        let mut mesh = ConstrainedDelaunayTriangulation::<Place<f64>>::new();
        let mut risers: BTreeMap<usize, Riser> = BTreeMap::new();
        for outline in &self.outlines {
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
            if self.solid_at(&Point2::from(middle)) {
                found.push(vec![a, b, c]);
            }
        }
        Some(found)
    }

    /// Whether a point lies inside: outlines about it, counted evenly and oddly.
    fn solid_at(&self, p: &Point2<f64>) -> bool {
        let crossings = self.outlines.iter().flat_map(|outline| {
            (0..outline.len()).filter(|&i| {
                let (a, b) = (outline[i].at(0.5), outline[(i + 1) % outline.len()].at(0.5));
                (a.y > p.y) != (b.y > p.y) && p.x < a.x + (b.x - a.x) * (p.y - a.y) / (b.y - a.y)
            })
        });
        crossings.count() % 2 == 1
    }
}

/// Whether an outline turns left only, at its lower end, its middle and its upper end.
fn convex(outline: &[Riser]) -> bool {
    let count = outline.len();
    (0..count).all(|i| {
        let three = [i, (i + 1) % count, (i + 2) % count].map(|i| outline[i]);
        [0.0, 0.5, 1.0].into_iter().all(|share| turn(&three, share) > -STRAIGHT)
    })
}

/// Neighbours joined as long as they stay convex (Hertel and Mehlhorn 1983).
fn merged(mut outlines: Vec<Outline>) -> Vec<Outline> {
    let same = |a: &Riser, b: &Riser| (a.at(0.5) - b.at(0.5)).norm() < NEAR;
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

fn piece(outline: &[Riser]) -> Piece {
    outline.iter().flat_map(|riser| riser.ends).collect()
}
