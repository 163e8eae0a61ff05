//! Decomposition of a surface into convex solids: an exact cut, else VHACD.

use super::surface::Surface;
use super::{cut, merge};
use crate::body::longest_side;
use input::units::MM;
use insertion::task::{Part, Solid, geometry};
use nalgebra::{Point3, Vector3};
use parry::math::Vector;
use parry::query::PointQuery;
use parry::shape::{TriMesh, TriMeshFlags};
use parry::transformation::vhacd::{VHACD, VHACDParameters};
use rapier3d_f64::parry;

/// Most parts a task may have: exact ones cost a trial less than wrong hulls.
pub const MOST_PARTS: usize = 200;
/// Largest relative volume error of an exact cut.
const ALIKE: f64 = 1e-4;
/// Largest overlap of an exact cut's parts, as a share of the volume.
const SHARED: f64 = 0.01;
/// Largest intrusion of an exact cut, m.
const NEAR: f64 = 2e-3 * MM;
/// Most parts of an approximation while it is cut.
const MOST_HULLS: u32 = 1024;
/// Most voxels times those along the longest side: half a minute of processor time.
const MOST_WORK: f64 = 2e8;
/// Coarsest resolution, voxels along the longest side.
pub const COARSEST: u32 = 8;
/// Largest concavity of a part, a tenth of VHACD's default, since the rest fills the clearance.
const CONCAVITY: f64 = 0.001;

/// Advice on a mesh that is not cut exactly.
const OTHERWISE: &str = "export the mesh with fewer flats (a circle of 32 is exact), begin with \
                         `optimize task new --round`, or write its parts by hand (docs/guide/tasks.md)";

/// Convex solids of a surface, m, and whether they equal it: if no exact cut is found, it is
/// approximated with `resolution` voxels along the longest side. `say` gets progress messages.
pub fn decompose(
    surface: &Surface,
    resolution: u32,
    say: &dyn Fn(&str),
) -> Result<(Vec<Solid>, bool), String> {
    say(&format!("cutting {} faces into convex pieces", surface.faces.len()));
    if let Some(solids) = exact(surface) {
        return Ok((solids, true));
    }
    if let Some(solids) = by_shells(surface) {
        return Ok((solids, true));
    }
    let most = |finest: &u32| voxels(surface, *finest) * f64::from(*finest) <= MOST_WORK;
    if !most(&resolution) {
        let finest = (COARSEST..resolution).rev().find(most).unwrap_or(COARSEST);
        return Err(format!(
            "is no solid of flat sides that up to {MOST_PARTS} convex pieces make, and approximating it \
             with --resolution {resolution} would take minutes: give --resolution {finest} or less, \
             {OTHERWISE}"
        ));
    }
    let thousands = voxels(surface, resolution) / 1e3;
    say(&format!("approximating {thousands:.0} thousand voxels by convex hulls"));
    let solids = approximate(surface, resolution);
    match solids.len() {
        parts if parts > MOST_PARTS => {
            Err(format!("comes to {parts} convex hulls; a task may have {MOST_PARTS}: {OTHERWISE}"))
        }
        _ => Ok((solids, false)),
    }
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

/// Approximate number of voxels in a surface and on it.
fn voxels(surface: &Surface, resolution: u32) -> f64 {
    let side = longest_side(&surface.points) / f64::from(resolution);
    surface.volume() / side.powi(3) + surface.area() / side.powi(2)
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

/// Approximate convex decomposition (VHACD, Mamou 2016): hulls of the surface in sets of voxels.
fn approximate(surface: &Surface, resolution: u32) -> Vec<Solid> {
    let (points, faces) = surface.in_millimetres();
    let parameters = VHACDParameters {
        resolution,
        concavity: CONCAVITY,
        max_convex_hulls: MOST_HULLS,
        convex_hull_approximation: false,
        ..VHACDParameters::default()
    };
    let parts = VHACD::decompose(&parameters, &points, &faces, true);
    let hulls = parts.compute_exact_convex_hulls(&points, &faces);
    let corners = hulls.into_iter().map(|(corners, _)| -> Vec<_> {
        corners.into_iter().map(|v| Point3::from(Vector3::from(v) * MM)).collect()
    });
    let solid = |points: Vec<_>| {
        let (points, _) = geometry::hull(&points)?;
        Some(Solid::Hull { points })
    };
    corners.filter_map(solid).collect()
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
