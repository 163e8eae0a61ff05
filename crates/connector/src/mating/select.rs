//! Choice among refined poses.

use super::frame::{Parts, outs, turns};
use super::refine::Pose;
use super::{Found, Mate, MatingError, search::{LEAST, Scene}};
use input::units::MM;
use nalgebra::{Isometry3, Translation3, Unit, UnitQuaternion, Vector3};

/// Mate of a pose.
fn mate(parts: &Parts, pose: &Pose) -> Mate {
    let socket = outs()[pose.out] * parts.socket.own;
    let plug = turns()[pose.turn] * parts.plug.own;
    let moved = Translation3::new(pose.shift[0], pose.shift[1], pose.z)
        * UnitQuaternion::from_rotation_matrix(&plug);
    let back = socket.inverse();
    Mate {
        pose: Isometry3::from_parts(Translation3::identity(), UnitQuaternion::from_rotation_matrix(&back)) * moved,
        out: Unit::new_normalize(back * Vector3::z()),
        across: [Vector3::x(), Vector3::y()].map(|axis| Unit::new_normalize(back * axis)),
        engaged_m: pose.depth,
        play_m: [0.0; 2],
        yaw_rad: 0.0,
        overlap_m: pose.overlap,
        walls_m2: pose.walls,
        through: pose.through,
    }
}

/// Mates of similar engagement.
pub fn select(parts: &Parts, (_scene, poses): (Scene, Vec<Pose>)) -> Result<Found, MatingError> {
    let mates: Vec<Mate> = poses.iter().map(|pose| mate(parts, pose)).collect();
    match mates.len() {
        0 => Err(MatingError::NoFit { least_mm: LEAST / MM }),
        1 => Ok(Found::One(mates[0].clone())),
        _ => Ok(Found::Ambiguous(mates)),
    }
}
