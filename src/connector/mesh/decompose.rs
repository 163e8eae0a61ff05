//! A surface as convex solids: exactly where it can be cut so, else by VHACD.

use super::surface::Surface;
use super::{cut, intrusion, merge};
use contact::shapes;
use input::units::MM;
use insertion::task::{Part, Solid, geometry};
use nalgebra::Point3;
use parry::transformation::vhacd::{VHACD, VHACDParameters};
use rapier3d_f64::parry;

/// Most parts, as many as a task may have: exact ones cost a trial less than hulls that are wrong.
pub const MOST_PARTS: usize = 200;
/// An exact cut has the surface's volume, as a share.
const ALIKE: f64 = 1e-4;
/// What parts of an exact cut may share, as a share of the whole.
const SHARED: f64 = 0.01;
/// What they may reach out, m.
const NEAR: f64 = 2e-3 * MM;
/// Most parts of an approximation while it is cut.
const MOST_HULLS: u32 = 1024;
/// Most voxels of an approximation times those along its longest side, which its time goes with:
/// half a minute of processor.
const MOST_WORK: f64 = 2e8;
/// Coarsest resolution that is asked for.
pub const COARSEST: u32 = 8;
/// How hollow a part may be, as a share: a tenth of VHACD's default, since what it leaves fills
/// the clearance.
const CONCAVITY: f64 = 0.001;

/// A surface as convex solids.
#[derive(Debug, Clone, PartialEq)]
pub struct Decomposed {
    /// The solids.
    pub solids: Vec<Solid>,
    /// Whether they are the surface, not near it.
    pub exact: bool,
}

/// Why a surface has no convex solids.
#[derive(Debug, Clone, PartialEq)]
pub enum Undone {
    /// That would take minutes.
    Long {
        /// The finest resolution that does not.
        finest: u32,
    },
    /// A task may not have so many.
    Many {
        /// How many there would be.
        parts: usize,
    },
}

/// Decomposes; `resolution` is in voxels along the longest side, where it is needed. `say` is told
/// what takes its time.
///
/// # Errors
/// If no task can have the result, or it would take long.
pub fn decompose(
    surface: &Surface,
    resolution: u32,
    say: &dyn Fn(&str),
) -> Result<Decomposed, Undone> {
    say(&format!("cutting {} faces into convex pieces", surface.faces.len()));
    let exact = (0..3).filter_map(|turns| cut_along(surface, turns));
    let whole = exact.filter(|solids| is_whole(surface, solids));
    // The cut of fewest parts; of equals the first, across z.
    if let Some(solids) = whole.min_by_key(Vec::len) {
        return Ok(Decomposed { solids, exact: true });
    }
    let most = |finest: &u32| voxels(surface, *finest) * f64::from(*finest) <= MOST_WORK;
    if !most(&resolution) {
        let finest = (COARSEST..resolution).rev().find(most).unwrap_or(COARSEST);
        return Err(Undone::Long { finest });
    }
    let thousands = voxels(surface, resolution) / 1e3;
    say(&format!("approximating {thousands:.0} thousand voxels by convex hulls"));
    let solids = approximate(surface, resolution);
    match solids.len() {
        parts if parts > MOST_PARTS => Err(Undone::Many { parts }),
        _ => Ok(Decomposed { solids, exact: false }),
    }
}

/// About how many voxels fill a surface and lie on it.
fn voxels(surface: &Surface, resolution: u32) -> f64 {
    let side = surface.longest_side() / f64::from(resolution);
    surface.volume() / side.powi(3) + surface.area() / side.powi(2)
}

/// Cut across z, x or y: after so many turns of the axes.
fn cut_along(surface: &Surface, turns: usize) -> Option<Vec<Solid>> {
    let turned =
        |p: &Point3<f64>, by: usize| Point3::from(std::array::from_fn(|i| p[(i + by) % 3]));
    let points = surface.points.iter().map(|p| turned(p, turns)).collect();
    let pieces = cut::pieces(&Surface { points, ..surface.clone() })?;
    let back = |piece: &cut::Piece| piece.iter().map(|p| turned(p, (3 - turns) % 3)).collect();
    Some(merge::solids(&pieces.iter().map(back).collect::<Vec<cut::Piece>>()))
}

/// Whether the solids fill the surface and nothing beside it. Where a slanted wall is cut, two
/// neighbours may share a sliver inside: then what counts is that none reaches out.
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
        intrusion::largest(surface, &parts, |_| true).is_some_and(|found| found.depth < NEAR)
    }
}

/// Volumetric hierarchical approximate convex decomposition (Mamou 2016), of voxels, each part
/// the hull of the surface within it.
fn approximate(surface: &Surface, resolution: u32) -> Vec<Solid> {
    let points: Vec<_> = surface.points.iter().map(|p| shapes::vector(&(p.coords / MM))).collect();
    let faces: Vec<_> = surface.faces.iter().map(|face| face.map(|corner| corner as u32)).collect();
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
        corners.into_iter().map(|v| Point3::from(shapes::from_vector(v) * MM)).collect()
    });
    let solid = |points: Vec<_>| {
        let (points, _) = geometry::hull(&points)?;
        Some(Solid::Hull { points })
    };
    corners.filter_map(solid).collect()
}
