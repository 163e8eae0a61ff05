//! Triangles of STL (binary and text) and OBJ files.

use super::root;
use earcut::Earcut;
use earcut::utils3d::project3d_to_2d;
use input::{InputError, Place};
use nalgebra::{Point3, Vector3};
use std::collections::BTreeMap;
use std::ffi::OsStr;
use std::path::Path;
use std::str::SplitWhitespace;

/// Corners of a triangle: in the unit of the file as read here, in m everywhere else.
pub type Triangle = [Point3<f64>; 3];

/// Body of a file: `solid` of a text STL, `o` or `g` of an OBJ.
#[derive(Debug, Clone, PartialEq)]
pub struct Body {
    /// Name in the file; may be empty.
    pub name: String,
    /// Triangles.
    pub triangles: Vec<Triangle>,
}

/// Bytes before the triangles of a binary STL.
const HEADER: usize = 84;
/// Bytes of each triangle of a binary STL.
const RECORD: usize = 50;

/// Message for STEP files, which the Python package reads.
const STEP: &str = "is a STEP file, which the Python package reads: pip install './python[step]' in the project's \
     folder; or export STL";

/// Returns whether a file is STEP, by its content or its name.
pub fn is_step(bytes: &[u8], file: &str) -> bool {
    let named = Path::new(file).extension().and_then(OsStr::to_str).map(str::to_ascii_lowercase);
    bytes.trim_ascii_start().starts_with(b"ISO-10303-21")
        || named.is_some_and(|named| ["step", "stp"].contains(&named.as_str()))
}

/// Reads the bodies of a file whose format follows from its content; `file` is its name in errors.
///
/// # Errors
/// If the bytes are neither STL nor OBJ, or contain no finite triangles.
pub fn read(bytes: &[u8], file: &str) -> Result<Vec<Body>, InputError> {
    let step = is_step(bytes, file);
    let fail = |problem: &str| {
        let neither = || format!("is neither an STL nor an OBJ file: {problem}");
        Place::file(file).fault(if step { STEP.to_owned() } else { neither() })
    };
    // A binary STL can begin with "solid" too, so its length decides.
    let bodies = match binary(bytes) {
        Some(triangles) => vec![Body { name: String::new(), triangles }],
        None => {
            let text = std::str::from_utf8(bytes);
            let text = text.map_err(|_| {
                fail("a binary file whose length does not match its number of triangles")
            })?;
            let stl = text.trim_start().starts_with("solid");
            parse(text, stl).map_err(|problem| fail(&problem))?
        }
    };
    let mut corners = bodies.iter().flat_map(|body| body.triangles.iter().flatten()).peekable();
    if corners.peek().is_none() {
        return Err(fail("no faces"));
    }
    if corners.any(|p| !p.iter().all(|v| v.is_finite())) {
        return Err(fail("a coordinate is not a finite number"));
    }
    Ok(bodies)
}

/// Returns the triangles of a binary STL; `None` if the length of the file does not match their number.
fn binary(bytes: &[u8]) -> Option<Vec<Triangle>> {
    let count = u32::from_le_bytes(bytes.get(80..HEADER)?.try_into().ok()?) as usize;
    let records = &bytes[HEADER..];
    if count.checked_mul(RECORD)? != records.len() {
        return None;
    }
    let number = |bytes: &[u8; 4]| f64::from(f32::from_le_bytes(*bytes));
    let triangle = |record: &[u8]| {
        // The first three numbers are the normal, which also follows from the order of the corners.
        let values: Vec<f64> = record[12..48].as_chunks().0.iter().map(number).collect();
        std::array::from_fn(|i| Point3::new(values[3 * i], values[3 * i + 1], values[3 * i + 2]))
    };
    Some(records.chunks_exact(RECORD).map(triangle).collect())
}

/// Parses the three coordinates on a line.
fn coordinates(mut words: SplitWhitespace, line: usize) -> Result<Point3<f64>, String> {
    let mut next = || words.next().and_then(|word| word.parse::<f64>().ok());
    match (next(), next(), next()) {
        (Some(x), Some(y), Some(z)) => Ok(Point3::new(x, y, z)),
        _ => Err(format!("line {line}: three numbers are needed")),
    }
}

/// Parses the bodies of a text file, STL if `stl`, else OBJ; bodies of the same name are joined.
fn parse(text: &str, stl: bool) -> Result<Vec<Body>, String> {
    let mut points = Vec::new();
    let mut bodies: Vec<Body> = Vec::new();
    let mut triangles = Vec::new();
    let mut name = String::new();
    let mut add = |name: &str, triangles: Vec<Triangle>| match bodies
        .iter_mut()
        .find(|body| body.name == name)
    {
        Some(body) => body.triangles.extend(triangles),
        None if triangles.is_empty() => {}
        None => bodies.push(Body { name: name.to_owned(), triangles }),
    };
    for (number, line) in (1..).zip(text.lines()) {
        let mut words = line.split_whitespace();
        match (stl, words.next()) {
            (true, Some("vertex")) | (false, Some("v")) => points.push(coordinates(words, number)?),
            (true, Some("endfacet")) => {
                let three = Triangle::try_from(std::mem::take(&mut points));
                let three = three.map_err(|_| format!("line {number}: a facet has three vertices"));
                triangles.push(three?);
            }
            (false, Some("f")) => {
                let face: Option<Vec<_>> = words.map(|word| vertex(word, &points)).collect();
                let missing =
                    || format!("line {number}: a face refers to a vertex that does not exist");
                let face = face.ok_or_else(missing)?;
                triangles.extend(polygon(&face));
            }
            (true, Some("solid")) | (false, Some("o" | "g")) => {
                add(&name, std::mem::take(&mut triangles));
                name = words.collect::<Vec<_>>().join(" ");
            }
            _ => {}
        }
    }
    add(&name, triangles);
    Ok(bodies)
}

/// Triangulates a polygon: as a fan, as viewers do, or by ear clipping if it is concave.
fn polygon(corners: &[Point3<f64>]) -> Vec<Triangle> {
    let fan: Vec<Triangle> =
        (2..corners.len()).map(|i| [corners[0], corners[i - 1], corners[i]]).collect();
    let normal = |[a, b, c]: &Triangle| (b - a).cross(&(c - a));
    let whole: Vector3<f64> = fan.iter().map(normal).sum();
    let (mut flat, mut ears) = (Vec::new(), Vec::<usize>::new());
    let places: Vec<[f64; 3]> = corners.iter().map(|p| [p.x, p.y, p.z]).collect();
    if fan.iter().all(|triangle| normal(triangle).dot(&whole) >= 0.0)
        || !project3d_to_2d(&places, places.len(), &mut flat)
    {
        return fan;
    }
    Earcut::new().earcut(flat, &[], &mut ears);
    let ears = ears.chunks_exact(3).map(|ear| [0, 1, 2].map(|i| corners[ear[i]]));
    let outward = |ear: Triangle| match normal(&ear).dot(&whole) < 0.0 {
        true => [ear[0], ear[2], ear[1]],
        false => ear,
    };
    ears.map(outward).collect()
}

/// Returns the triangles of the selected bodies, and those of all others. If any of `names` is not the name of a body,
/// all are numbers of shells, counted from 1.
///
/// # Errors
/// If the file lacks one of them; the message lists the available ones.
pub fn pick(
    bodies: &[Body],
    names: &[String],
    file: &str,
) -> Result<[Vec<Triangle>; 2], InputError> {
    let named = |name: &String| bodies.iter().any(|body| body.name == *name);
    let of = if names.iter().all(named) { bodies.to_vec() } else { shells(bodies) };
    let mut picked = [Vec::new(), Vec::new()];
    if let Some(name) = names.iter().find(|name| of.iter().all(|body| body.name != **name)) {
        let names = bodies.iter().map(|body| &body.name).filter(|name| !name.is_empty());
        let known: String = names.map(|name| format!("`{name}`, ")).collect();
        let shells =
            if of.len() > 1 { format!("shells 1 to {}", of.len()) } else { "shell 1".into() };
        let problem = format!("has no body `{name}`; available: {known}{shells}");
        return Err(Place::file(file).fault(problem));
    }
    for body in of {
        picked[usize::from(!names.contains(&body.name))].extend(body.triangles);
    }
    Ok(picked)
}

/// Returns the shells (connected components: triangles that share corners) in the order of the file, named by their
/// number from 1.
pub fn shells(bodies: &[Body]) -> Vec<Body> {
    let triangles: Vec<_> = bodies.iter().flat_map(|body| body.triangles.iter().copied()).collect();
    let mut at: BTreeMap<[u64; 3], usize> = BTreeMap::new();
    let mut parent: Vec<usize> = (0..triangles.len()).collect();
    for (i, corner) in triangles.iter().enumerate().flat_map(|(i, t)| t.map(|p| (i, p))) {
        let first =
            *at.entry([corner.x, corner.y, corner.z].map(|v| (v + 0.0).to_bits())).or_insert(i);
        let [a, b] = [first, i].map(|i| root(&mut parent, i));
        parent[a.max(b)] = a.min(b);
    }
    let mut found: BTreeMap<usize, Vec<Triangle>> = BTreeMap::new();
    for (i, triangle) in triangles.into_iter().enumerate() {
        found.entry(root(&mut parent, i)).or_default().push(triangle);
    }
    let named = |(number, triangles): (usize, _)| Body { name: number.to_string(), triangles };
    (1..).zip(found.into_values()).map(named).collect()
}

/// Returns the vertex that a corner of an OBJ face refers to: `7`, `7/1` or `7//3`, counted from 1, or from the end if
/// negative.
fn vertex(word: &str, points: &[Point3<f64>]) -> Option<Point3<f64>> {
    let number: i64 = word.split('/').next()?.parse().ok()?;
    let count = i64::try_from(points.len()).ok()?;
    let index = if number < 0 { count + number } else { number - 1 };
    points.get(usize::try_from(index).ok()?).copied()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Both senses, with each corner as the first: a fan from most corners would cover the notch.
    #[test]
    fn a_concave_polygon_keeps_its_notch() {
        let corners = [[0, 0], [4, 0], [4, 4], [2, 1], [0, 4]]
            .map(|[x, y]| Point3::new(f64::from(x), f64::from(y), 1.0));
        for first in 0..5 {
            for sense in [1.0, -1.0] {
                let mut turned = corners.to_vec();
                turned.rotate_left(first);
                if sense < 0.0 {
                    turned.reverse();
                }
                let areas: Vec<f64> = polygon(&turned)
                    .iter()
                    .map(|[a, b, c]| sense * (b - a).cross(&(c - a)).z / 2.0)
                    .collect();
                assert!(areas.iter().all(|area| *area > 0.0), "{areas:?}");
                assert!((areas.iter().sum::<f64>() - 10.0).abs() < 1e-12, "{areas:?}");
            }
        }
    }
}
