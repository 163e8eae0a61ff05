//! Mated pose of two connector parts from their triangles.
//!
//! A straight insertion depends on two height maps only: with S the upper envelope of the socket and P
//! the lower envelope of the plug, seen along the axis, the plug shifted by d comes to rest at
//! z(d) = max over x of S(x) - P(x - d). Closed solids are not needed.

mod assembled;
mod cells;
mod engagement;
mod frame;
mod map;
mod precise;
mod refine;
mod search;
mod select;
mod split;
mod symmetry;
#[cfg(test)]
mod tests;

use crate::mesh::Triangle;
pub use assembled::assembled;
use frame::{Part, Parts};
use input::units::MM;
use nalgebra::{Isometry3, Point3, Unit, Vector3};
pub use split::plugs;
use std::sync::atomic::{AtomicBool, Ordering};

/// Limits of the total play of a plug in its seat, m: for connectors, for toys and enlarged models, and for the paper's
/// usb.
const MAX_PLAYS: [f64; 3] = [0.5 * MM, 2.0 * MM, 4.0 * MM];

/// Mated pose of a plug in its socket, with its axis of insertion.
#[derive(Debug, Clone, PartialEq)]
pub struct Mate {
    /// Transform from the frame of the plug file to that of the socket file, m.
    pub pose: Isometry3<f64>,
    /// Direction of withdrawal, in the axes of the socket file.
    pub out: Unit<Vector3<f64>>,
    /// Two lateral directions, in the axes of the socket file, along which the play is measured.
    pub across: [Unit<Vector3<f64>>; 2],
    /// Depth along the axis over which the parts engage, m.
    pub engaged_m: f64,
    /// Length of the part of the plug ahead of that which engages, m, such as a narrower nose; 0 without one.
    pub nose_m: f64,
    /// Total lateral play along each of `across`, m; faces that interfere are ignored.
    pub play_m: [f64; 2],
    /// Whether the hole goes through; the tip of the plug is then placed at the far side of the socket.
    pub through: bool,
    /// Further depth at which more of the walls would engage, m, if something beside the seat stops the plug; else 0.
    pub missed_m: f64,
    /// Whether the plug is only caught on an edge, engaged over less than a twentieth of its length.
    pub caught: bool,
}

/// Result of the search for a mate.
#[derive(Debug, Clone, PartialEq)]
pub struct MatingResult {
    /// Mates of similar engagement, the best first.
    pub mates: Vec<Mate>,
    /// Number of symmetric copies of the only mate, itself included; 1 if there are several mates.
    pub copies: usize,
}

impl MatingResult {
    fn has(&self, test: impl Fn(&Mate) -> bool) -> bool {
        self.mates.iter().any(test)
    }
}

impl Mate {
    fn is_seated(&self) -> bool {
        !self.caught && self.missed_m == 0.0
    }

    /// Returns whether the plug is in its seat, with play.
    fn is_free(&self) -> bool {
        self.is_seated() && self.play_m.iter().all(|play| *play > 0.0)
    }

    /// Returns the depth of the plug's tip below the edge of the socket, m.
    pub fn depth_m(&self) -> f64 {
        self.engaged_m + self.nose_m
    }
}

/// Error of a search for a mate.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum MatingError {
    /// Part without area.
    #[error("the {0} has no triangles with nonzero area")]
    Empty(&'static str),
    /// No seat that encloses the plug on four sides.
    #[error(
        "the plug does not fit into the socket along any of their axes: no pose is at least {} mm deep \
         with walls on four sides at most {} mm away; if the parts do mate, give their assembly in the mated pose",
        search::MIN_DEPTH / MM,
        MAX_PLAYS[2] / MM
    )]
    NoFit,
    /// Assembly whose parts are not mated, or block one another in every direction.
    #[error(
        "no body of the assembly can be withdrawn along an axis between walls on four sides: are the parts mated?"
    )]
    Blocked,
    /// Number of bodies that is out of range for an assembly.
    #[error("has {0} bodies; an assembly must have 2 to {most}", most = split::MAX_BODIES)]
    Bodies(usize),
    /// Cancellation by the caller.
    #[error("stopped")]
    Stopped,
}

/// Returns the mirror image of triangles, with their normals outward.
pub fn mirrored(triangles: &[Triangle]) -> Vec<Triangle> {
    let mirror = |p: Point3<f64>| Point3::new(-p.x, p.y, p.z);
    triangles.iter().map(|[a, b, c]| [a, c, b].map(|p| mirror(*p))).collect()
}

/// Returns an error if the search was cancelled.
fn check_cancelled(stop: &AtomicBool) -> Result<(), MatingError> {
    if stop.load(Ordering::SeqCst) { Err(MatingError::Stopped) } else { Ok(()) }
}

/// Finds the mated poses of two parts, each in its own frame, m.
///
/// # Errors
/// If a part is empty, if no pose fits, or if `stop` is set during the search.
pub fn mates(
    plug: &[Triangle],
    socket: &[Triangle],
    stop: &AtomicBool,
) -> Result<MatingResult, MatingError> {
    let parts = Parts { plug: Part::new(plug, "plug")?, socket: Part::new(socket, "socket")? };
    let mut shallow = None;
    for effort in search::EFFORTS {
        let scene = search::Scene::new(&parts, effort);
        let found = found_with(&parts, &scene, &search::INTERFERENCES, stop)?;
        let inserted = found.as_ref().is_some_and(|found| found.has(|mate| !mate.caught));
        let missed = found.as_ref().is_none_or(|found| !found.has(Mate::is_seated));
        // A stiff spring may hide the seat, or stop the plug beside it.
        if missed && (inserted || effort == search::EFFORTS[1]) {
            let sprung = found_with(&parts, &scene, &[search::STIFF_SPRING], stop)?;
            if let Some(sprung) = sprung.filter(|sprung| sprung.has(Mate::is_free)) {
                return Ok(sprung);
            }
        }
        shallow = if inserted { found } else { shallow.or(found) };
        if inserted {
            break;
        }
    }
    shallow.ok_or(MatingError::NoFit)
}

/// Finds the mates with the interferences, m. The tightest fit is preferred: a looser one is used only if there is none,
/// or if the plug is only caught on an edge.
fn found_with(
    parts: &Parts,
    scene: &search::Scene,
    interferences: &[f64],
    stop: &AtomicBool,
) -> Result<Option<MatingResult>, MatingError> {
    let pairs = symmetry::pairs(scene);
    let seats = search::seats(scene, &pairs, interferences, stop)?;
    let mut shallow = None;
    for (max_play, seats) in MAX_PLAYS.into_iter().zip(seats) {
        let poses = refine::refined(scene, &seats, max_play, stop)?;
        let found = select::select(parts, scene, &poses, &pairs, max_play);
        if found.as_ref().is_some_and(|found| found.has(|mate| !mate.caught)) {
            return Ok(found);
        }
        shallow = shallow.or(found);
    }
    Ok(shallow)
}
