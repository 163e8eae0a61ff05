//! A closed surface of triangles that look outward.

use super::read::Triangle;
use super::{MeshError, mend};
use crate::body::longest_side;
use input::units::MM;
use insertion::task::geometry::surface_moments;
use nalgebra::{Matrix3, Point3, Vector3};
use rapier3d_f64::parry::math::Vector;
use std::collections::{BTreeMap, BTreeSet};

/// Grid on which corners are welded, m: files have 32-bit numbers.
const GRID: f64 = 1e-4 * MM;
/// Least and largest size of a connector, m.
pub const SIZES: [f64; 2] = [3.0 * MM, 300.0 * MM];

/// Closed triangle mesh, m.
#[derive(Debug, Clone, PartialEq)]
pub struct Surface {
    /// Corners, m, on the welding grid.
    pub points: Vec<Point3<f64>>,
    /// Corner indices of the triangles, counter-clockwise from outside.
    pub faces: Vec<[usize; 3]>,
    /// Whether the file had all triangles clockwise.
    pub was_inward: bool,
    /// How many corners of the file missed one another, and by how much at most, m.
    pub mended: (usize, f64),
}

impl Surface {
    /// Surface of triangles given in a unit of `unit` metres; `file` is named in errors.
    ///
    /// # Errors
    /// If the triangles are not watertight, differ in orientation, or have no connector's size.
    pub fn new(triangles: &[Triangle], unit: f64, file: &str) -> Result<Self, MeshError> {
        let (points, mut faces) = weld(triangles, unit);
        let fail = |fault: String| MeshError::File(file.to_owned(), fault);
        size(&points).map_err(fail)?;
        let mended = mend::mend(&points, &mut faces);
        if mended.0 > 0 {
            faces = without_films(faces);
        }
        closed(&points, &faces).map_err(fail)?;
        let volume = surface_moments(&points, &faces).0;
        if volume.abs() < GRID * GRID * GRID {
            return Err(fail("holds no volume".to_owned()));
        }
        let was_inward = volume < 0.0;
        if was_inward {
            faces.iter_mut().for_each(|face| face.swap(1, 2));
        }
        Ok(Surface { points, faces, was_inward, mended })
    }

    /// Returns the surface turned and shifted.
    pub fn moved(mut self, turn: &Matrix3<f64>, by: Vector3<f64>) -> Self {
        for point in &mut self.points {
            *point = Point3::from((turn * point.coords + by).map(snap));
        }
        self
    }

    /// Points, mm, and faces as parry takes them.
    pub fn in_millimetres(&self) -> (Vec<Vector>, Vec<[u32; 3]>) {
        let points = self.points.iter().map(|p| (p.coords / MM).into());
        let faces = self.faces.iter().map(|face| face.map(|corner| corner as u32));
        (points.collect(), faces.collect())
    }

    /// Returns its pieces that meet along no edge of two faces.
    pub fn shells(&self) -> Vec<Surface> {
        let mut about: BTreeMap<[usize; 2], Vec<usize>> = BTreeMap::new();
        for (number, face) in self.faces.iter().enumerate() {
            for i in 0..3 {
                let (a, b) = (face[i], face[(i + 1) % 3]);
                about.entry([a.min(b), a.max(b)]).or_default().push(number);
            }
        }
        let mut next = vec![Vec::new(); self.faces.len()];
        for pair in about.values() {
            if let [a, b] = pair[..] {
                next[a].push(b);
                next[b].push(a);
            }
        }
        let (mut seen, mut shells) = (vec![false; self.faces.len()], Vec::new());
        for first in 0..self.faces.len() {
            let (mut faces, mut todo) = (Vec::new(), vec![first]);
            while let Some(face) = todo.pop() {
                if !std::mem::replace(&mut seen[face], true) {
                    faces.push(self.faces[face]);
                    todo.extend(&next[face]);
                }
            }
            if !faces.is_empty() {
                let corners: BTreeSet<usize> = faces.iter().flatten().copied().collect();
                let number: BTreeMap<usize, usize> = corners.iter().copied().zip(0..).collect();
                let points = corners.iter().map(|&corner| self.points[corner]).collect();
                let faces = faces.iter().map(|face| face.map(|corner| number[&corner])).collect();
                shells.push(Surface { points, faces, ..*self });
            }
        }
        shells
    }

    /// Surface area, m2.
    pub fn area(&self) -> f64 {
        let of = |face: &[usize; 3]| {
            let [a, b, c] = face.map(|corner| self.points[corner]);
            (b - a).cross(&(c - a)).norm() / 2.0
        };
        self.faces.iter().map(of).sum()
    }

    /// Enclosed volume, m3.
    pub fn volume(&self) -> f64 {
        surface_moments(&self.points, &self.faces).0
    }
}

/// Coordinate rounded to the grid.
fn snap(value: f64) -> f64 {
    (value / GRID).round() * GRID
}

/// Welds the corners of triangles given in a unit of `unit` metres, and drops faces without area or with a back.
pub fn weld(triangles: &[Triangle], unit: f64) -> (Vec<Point3<f64>>, Vec<[usize; 3]>) {
    let mut places: BTreeMap<[i64; 3], usize> = BTreeMap::new();
    let mut points = Vec::new();
    let mut index = |p: &Point3<f64>| {
        let p = p * unit;
        let key: [i64; 3] = std::array::from_fn(|axis| (p[axis] / GRID).round() as i64);
        *places.entry(key).or_insert_with(|| {
            points.push(Point3::from(p.coords.map(snap)));
            points.len() - 1
        })
    };
    let mut faces = Vec::with_capacity(triangles.len());
    for triangle in triangles {
        let face = [index(&triangle[0]), index(&triangle[1]), index(&triangle[2])];
        // What has shrunk to a line on the grid holds nothing; its neighbours still meet.
        if face[0] != face[1] && face[1] != face[2] && face[2] != face[0] {
            faces.push(face);
        }
    }
    (points, without_films(faces))
}

/// Without pairs of faces that cover one another back to back: they hold nothing.
fn without_films(faces: Vec<[usize; 3]>) -> Vec<[usize; 3]> {
    // The same face begins with the same corner.
    let turned = |face: [usize; 3]| {
        let first = (0..3).min_by_key(|&i| face[i]).unwrap_or(0);
        [face[first], face[(first + 1) % 3], face[(first + 2) % 3]]
    };
    let mut seen: BTreeMap<[usize; 3], i32> = BTreeMap::new();
    for face in &faces {
        let [a, b, c] = turned(*face);
        *seen.entry([a, b.min(c), b.max(c)]).or_default() += if b < c { 1 } else { -1 };
    }
    let kept = seen.into_iter().filter(|(_, count)| *count != 0);
    kept.map(|([a, b, c], count)| if count > 0 { [a, b, c] } else { [a, c, b] }).collect()
}

fn size(points: &[Point3<f64>]) -> Result<(), String> {
    let largest = longest_side(points);
    let [low, high] = SIZES;
    let hint = match () {
        () if largest > high => "too large; is it in mm and --unit says in or m?",
        () if largest < low => "too small; is it in metres (--unit m) or inches (--unit in)?",
        () => return Ok(()),
    };
    Err(format!("is {:.3} mm long; connectors are 3 to 300 mm: {hint}", largest / MM))
}

/// Checks that every edge runs as often in one direction as in the other.
fn closed(points: &[Point3<f64>], faces: &[[usize; 3]]) -> Result<(), String> {
    let mut ways: BTreeMap<[usize; 2], [u32; 2]> = BTreeMap::new();
    for face in faces {
        for i in 0..3 {
            let (a, b) = (face[i], face[(i + 1) % 3]);
            let edge = ways.entry([a.min(b), a.max(b)]).or_default();
            edge[usize::from(a > b)] += 1;
        }
    }
    let middle = |[a, b]: &[usize; 2]| {
        let middle = nalgebra::center(&points[*a], &points[*b]) / MM;
        [middle.x, middle.y, middle.z].map(|v| (v * 1e3).round() / 1e3)
    };
    let first_of = |wrong: fn(&[u32; 2]) -> bool| {
        let mut edges = ways.iter().filter(|(_, ways)| wrong(ways)).map(|(edge, _)| edge);
        edges.next().map(middle).map(|first| (1 + edges.count(), first))
    };
    if let Some((count, first)) = first_of(|[forth, back]| (forth + back) % 2 == 1) {
        return Err(format!(
            "is not watertight: {count} edges have a face on one side only, the first at {first:?} mm \
             (as in the file, scaled); close the surface in your CAD or with a mesh repair"
        ));
    }
    first_of(|[forth, back]| forth != back).map_or(Ok(()), |(count, first)| {
        Err(format!(
            "{count} edges lie between faces that look to opposite sides, the first at {first:?} mm; \
             let all normals point outward"
        ))
    })
}
