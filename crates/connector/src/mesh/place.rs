//! Unit of the files and direction of insertion: those that were given, or the only ones in which the
//! plug's end fits a hole of the socket and its body between the jaws.

pub use super::axes::value;
use super::axes::{Along, Unit};
use super::cut::{self, Mouth};
use super::import::{Mesh, few_faces};
use super::read::Triangle;
use super::surface::{SIZES, Surface};
use super::{Files, MeshError};
use crate::body::{extent, span, width};
use crate::check::FACES_MM;
use clap::ValueEnum;
use input::units::MM;
use nalgebra::{Point3, Vector3};

/// Clearances of connectors, m, by which a unit is told: from a press fit to a loose one.
const CLEARANCES: [f64; 2] = [-0.1 * MM, 1.5 * MM];
/// Least depth of what goes in, m.
const LEAST_DEPTH: f64 = 1.0 * MM;

/// Meshes in metres, and where they are in their files.
pub struct Placed {
    /// Plug and socket, in the axes of the files.
    pub meshes: [Mesh; 2],
    /// Unit of the files.
    pub unit: Unit,
    /// Direction of insertion.
    pub along: Along,
    /// Why this unit, if it was found.
    pub why_unit: Option<String>,
    /// Why this direction, if it was found.
    pub why_along: Option<String>,
}

/// Size of the throat and of what goes into it, in x and y, m; clearance, and width of the plug.
struct Fit {
    throat: [f64; 2],
    end: [f64; 2],
    clearance: f64,
    body: f64,
}

/// Plug and socket of these triangles, whose unit and direction are found unless they are given.
///
/// # Errors
/// If a mesh is no closed surface, or if none or several of the units and directions fit.
pub fn placed(
    triangles: [&[Triangle]; 2],
    files: Files,
    unit: Option<Unit>,
    along: Option<Along>,
    say: &dyn Fn(&str),
) -> Result<Placed, MeshError> {
    let meshes = |unit: Unit| {
        let mesh = |i: usize| {
            let surface = Surface::new(triangles[i], unit.metres(), files[i])?;
            few_faces(Mesh { file: files[i].to_owned(), surface })
        };
        let (plug, socket) = rayon::join(|| mesh(0), || mesh(1));
        let [(plug, of_plug), (socket, of_socket)] = [plug?, socket?];
        of_plug.iter().chain(&of_socket).for_each(|reduced| say(reduced));
        Ok::<_, MeshError>([plug, socket])
    };
    if let (Some(unit), Some(along)) = (unit, along) {
        let (why_unit, why_along) = (None, None);
        return Ok(Placed { meshes: meshes(unit)?, unit, along, why_unit, why_along });
    }
    let longest = triangles.map(longest);
    let sized = |unit: &Unit| {
        longest.iter().all(|length| (SIZES[0]..=SIZES[1]).contains(&(length * unit.metres())))
    };
    let units: Vec<Unit> = match unit {
        Some(unit) => vec![unit],
        None => Unit::value_variants().iter().copied().filter(sized).collect(),
    };
    let directions = along.map_or(Along::value_variants().to_vec(), |along| vec![along]);
    let fail = |problem: String| MeshError::File(files.join(", "), problem);
    if units.is_empty() {
        let [plug, socket] = longest;
        return Err(fail(format!(
            "the plug is {plug:.4} long and the socket {socket:.4}: connectors are 3 to 300 mm, and these \
             are not in mm, in or m"
        )));
    }
    let (mut fits, mut misses) = (Vec::new(), Vec::new());
    let mut by_unit = Vec::new();
    for &candidate in &units {
        let meshes = meshes(candidate)?;
        for &direction in &directions {
            let here = format!("{} along {}", value(candidate), value(direction));
            match fit(&meshes, direction, unit.is_none()) {
                Ok(fit) => fits.push((by_unit.len(), direction, fit, here)),
                Err(why) => misses.push(format!("{here}: {why}")),
            }
        }
        by_unit.push(meshes);
    }
    if let [_, _, ..] = fits[..] {
        let several: Vec<_> =
            fits.iter().map(|(.., fit, here)| format!("{here} ({})", fit.text())).collect();
        return Err(fail(format!(
            "several units or directions fit: {}; give --unit and --insert-along",
            several.join("; ")
        )));
    }
    let Some((number, direction, fit, _)) = fits.pop() else {
        misses.sort_by_key(|why| why.contains(NO_HOLE));
        return Err(fail(format!(
            "no unit and direction found in which the plug goes in: {}; give --unit and --insert-along, \
             if both files have the same axes",
            misses.join("; ")
        )));
    };
    let ([low, high], found) = (FACES_MM, units[number]);
    let wide = |unit: &Unit| {
        let times = unit.metres() / found.metres();
        format!("{:.3} mm wide if in {}", fit.body * times / MM, value(*unit))
    };
    let others = Unit::value_variants().iter().filter(|other| **other != found).map(wide);
    let why_unit = format!(
        "the plug is {:.2} mm wide, which jaws hold ({low} to {high} mm), and the clearance that of a \
         connector; it would be {}",
        fit.body / MM,
        others.collect::<Vec<_>>().join(", ")
    );
    Ok(Placed {
        meshes: by_unit.swap_remove(number),
        unit: found,
        along: direction,
        why_unit: unit.is_none().then_some(why_unit),
        why_along: along.is_none().then(|| fit.text()),
    })
}

const NO_HOLE: &str = "no closed hole";

/// Fit of the two if the plug goes in along a direction; or why it does not.
fn fit(meshes: &[Mesh; 2], along: Along, any_unit: bool) -> Result<Fit, String> {
    let turn = along.turn(along.across()[0]);
    let [plug, socket] = [0, 1].map(|i| meshes[i].surface.clone().moved(&turn, Vector3::zeros()));
    let Some(Mouth { throat, .. }) = cut::mouth(&socket, 0.0) else {
        return Err(format!("{NO_HOLE} goes in"));
    };
    let [bottom, top] = extent(&plug.points, 2);
    let enters = |height: f64| {
        let size = end(&plug, bottom + height).map(width);
        (0..2).all(|axis| size[axis] - throat[axis] < -CLEARANCES[0]).then_some(size)
    };
    let (mut length, mut stopped) = (0.0, top - bottom);
    let whole = enters(stopped);
    while whole.is_none() && stopped - length > 0.01 * MM {
        let middle = (length + stopped) / 2.0;
        let end = if enters(middle).is_some() { &mut length } else { &mut stopped };
        *end = middle;
    }
    let fits = |size: [f64; 2]| format!("{:.2} x {:.2} mm", size[0] / MM, size[1] / MM);
    let end = match whole.or_else(|| enters(length)) {
        Some(end) if whole.is_some() || length >= LEAST_DEPTH => end,
        _ => {
            let end = end(&plug, bottom + LEAST_DEPTH).map(width);
            return Err(format!("the hole is {} and the plug's end {}", fits(throat), fits(end)));
        }
    };
    let clearance = (throat[0] - end[0]).min(throat[1] - end[1]);
    let sides = [0, 1].map(|axis| width(extent(&plug.points, axis)));
    let body = sides[0].min(sides[1]);
    let found = Fit { throat, end, clearance, body };
    let [low, high] = FACES_MM;
    match () {
        () if !(low..=high).contains(&(body / MM)) => {
            Err(format!("the plug, {:.2} mm wide, is not held by jaws", body / MM))
        }
        () if any_unit && !(CLEARANCES[0]..=CLEARANCES[1]).contains(&clearance) => {
            let [low, high] = CLEARANCES.map(|clearance| clearance / MM);
            let found = clearance / MM;
            Err(format!(
                "the clearance is {found:.2} mm; it must be within {low:.2} .. {high:.2} mm"
            ))
        }
        () => Ok(found),
    }
}

impl Fit {
    fn text(&self) -> String {
        let [[a, b], [c, d]] = [self.throat, self.end].map(|size| size.map(|v| v / MM));
        format!(
            "a hole of {a:.2} x {b:.2} mm takes the plug's end of {c:.2} x {d:.2} mm, which leaves {:.2} mm",
            self.clearance / MM
        )
    }
}

fn longest(triangles: &[Triangle]) -> f64 {
    (0..3).map(|axis| width(extent(triangles.iter().flatten(), axis))).fold(0.0, f64::max)
}

/// Range in x and in y of all below a height.
fn end(surface: &Surface, height: f64) -> [[f64; 2]; 2] {
    let edges = surface.faces.iter().flat_map(|face| (0..3).map(|i| [face[i], face[(i + 1) % 3]]));
    let below = edges.filter_map(|edge| {
        let [a, b]: [Point3<f64>; 2] = edge.map(|corner| surface.points[corner]);
        match (a.z <= height, b.z <= height) {
            (true, _) => Some(a),
            // The other edge of this face, or this one of its neighbour, has the lower end.
            (false, true) => Some(a + (b - a) * ((height - a.z) / (b.z - a.z))),
            (false, false) => None,
        }
    });
    let below: Vec<_> = below.collect();
    [0, 1].map(|axis| span(below.iter().map(|p| p[axis])))
}
