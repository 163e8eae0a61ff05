//! Exact decomposition of a surface into convex solids.

use super::surface::Surface;
use super::{cut, merge};
use input::units::MM;
use insertion::task::{Part, Solid, geometry};
use nalgebra::Point3;
use parry::math::Vector;
use parry::query::PointQuery;
use parry::shape::{TriMesh, TriMeshFlags};
use rapier3d_f64::parry;

/// Most parts of an exact cut.
pub const MOST_PARTS: usize = 200;
/// Largest relative volume error of an exact cut.
const ALIKE: f64 = 1e-4;
/// Largest overlap of an exact cut's parts, as a share of the volume.
const SHARED: f64 = 0.01;
/// Largest intrusion of an exact cut, m.
const NEAR: f64 = 2e-3 * MM;
/// Convex solids that equal a surface, m.
///
/// # Errors
/// If it is not made of few of them.
pub fn decompose(surface: &Surface) -> Result<Vec<Solid>, String> {
    exact(surface).or_else(|| by_shells(surface)).ok_or_else(|| {
        format!("is no solid of flat sides that up to {MOST_PARTS} convex pieces make")
    })
}

/// Returns the exact cut of fewest parts; of equals the first, across z.
fn exact(surface: &Surface) -> Option<Vec<Solid>> {
    let cuts = (0..3).filter_map(|turns| cut_along(surface, turns));
    cuts.filter(|solids| is_whole(surface, solids)).min_by_key(Vec::len)
}

/// Exact cuts of shells that touch or overlap, each by itself; none if one of them is a hollow.
fn by_shells(surface: &Surface) -> Option<Vec<Solid>> {
    let shells = surface.shells();
    if !(2..=MOST_PARTS).contains(&shells.len()) {
        return None;
    }
    let cut = |shell: &Surface| (shell.volume() > 0.0).then(|| exact(shell)).flatten();
    let solids: Option<Vec<_>> = shells.iter().map(cut).collect();
    solids.map(|solids| solids.concat()).filter(|solids| solids.len() <= MOST_PARTS)
}

/// Exact cut across z, x or y: after 0, 1 or 2 cyclic turns of the axes.
fn cut_along(surface: &Surface, turns: usize) -> Option<Vec<Solid>> {
    let turned =
        |p: &Point3<f64>, by: usize| Point3::from(std::array::from_fn(|i| p[(i + by) % 3]));
    let points = surface.points.iter().map(|p| turned(p, turns)).collect();
    let pieces = cut::pieces(&Surface { points, ..surface.clone() })?;
    let back = |piece: &cut::Piece| piece.iter().map(|p| turned(p, (3 - turns) % 3)).collect();
    Some(merge::solids(&pieces.iter().map(back).collect::<Vec<cut::Piece>>()))
}

/// Returns whether the solids fill the surface and nothing else. Where a slanted wall is cut, two
/// neighbours may share a sliver inside; then none may reach out.
fn is_whole(surface: &Surface, solids: &[Solid]) -> bool {
    let sum: f64 = solids.iter().map(geometry::volume).sum();
    let more = sum / surface.volume() - 1.0;
    if solids.len() > MOST_PARTS || !(-ALIKE..=SHARED).contains(&more) {
        return false;
    }
    more < ALIKE || {
        let part =
            |solid: &Solid| Part { name: String::new(), solid: solid.clone(), friction: None };
        let parts: Vec<_> = solids.iter().map(part).collect();
        intrusion(surface, &parts, |_| true).is_some_and(|(depth, _)| depth < NEAR)
    }
}

/// Spacing of the sample points on parts, m.
const SPACING: f64 = 0.2 * MM;
/// Most sample points along a side of a triangle.
const MOST_SAMPLES: usize = 60;

/// Largest intrusion, m, and its point, m, among the sample points that `counts` accepts.
pub fn intrusion(
    surface: &Surface,
    parts: &[Part],
    counts: impl Fn(&Point3<f64>) -> bool,
) -> Option<(f64, Point3<f64>)> {
    let (points, faces) = surface.in_millimetres();
    let mesh = TriMesh::with_flags(points, faces, TriMeshFlags::ORIENTED).ok()?;
    let outside = |at: Point3<f64>| {
        let point: Vector = (at.coords / MM).into();
        let found = mesh.project_local_point(point, true);
        (if found.is_inside { 0.0 } else { (found.point - point).length() * MM }, at)
    };
    let samples = parts.iter().flat_map(samples).filter(|p| counts(p));
    samples.map(outside).max_by(|a, b| a.0.total_cmp(&b.0))
}

fn samples(part: &Part) -> Vec<Point3<f64>> {
    let Some((corners, faces)) = geometry::hull(&part.solid.corners()) else { return Vec::new() };
    let mut found = Vec::new();
    for face in faces {
        let [a, b, c] = face.map(|corner| corners[corner]);
        let longest = (b - a).norm().max((c - a).norm()).max((c - b).norm());
        let steps = ((longest / SPACING).ceil() as usize).clamp(1, MOST_SAMPLES);
        for i in 0..=steps {
            for j in 0..=steps - i {
                let (u, v) = (i as f64 / steps as f64, j as f64 / steps as f64);
                found.push(a + (b - a) * u + (c - a) * v);
            }
        }
    }
    found
}
