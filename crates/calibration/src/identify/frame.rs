//! `frame.toml`: pose of the task's frame in the robot's base, and convention of the recorded force.

use input::units::MM;
use input::{Check, InputError, read};
use insertion::Tcp;
use nalgebra::{Isometry3, Translation3, UnitQuaternion, Vector3};
use serde::Deserialize;
use std::f64::consts::{PI, TAU};

/// Standard gravity, m/s^2.
const GRAVITY: f64 = 9.80665;
/// Distance from the base, mm, below which the unit is taken to be metres.
const MIN_DISTANCE_MM: f64 = 10.0;
/// Largest rotation of the TCP out of its upright orientation about y and z, rad; the model only has a tilt about x.
const MAX_ROTATION: f64 = 0.5;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    origin_mm: [f64; 3],
    axis_angle_rad: [f64; 3],
    upright_axis_angle_rad: Option<[f64; 3]>,
    force_sign: Option<f64>,
    #[serde(default)]
    tool_mass_kg: f64,
    #[serde(default)]
    tool_centre_mm: [f64; 3],
    gravity_compensated: Option<bool>,
}

/// Frame of the task in the base of the robot, whose z axis is vertical, and convention of the recorded force.
#[derive(Debug, Clone, PartialEq)]
pub struct Frame {
    /// Pose of the task's frame in the base, m.
    pub(super) base: Isometry3<f64>,
    /// Orientation of the upright TCP in the task's frame.
    upright: UnitQuaternion<f64>,
    /// 1 if the recorded force is that on the tool, -1 if it is the reaction, exerted by the tool.
    sign: f64,
    /// Mass below the force sensor, kg.
    pub tool_mass: f64,
    /// Whether the weight of the tool is already subtracted from the recorded force.
    compensated: bool,
}

impl Frame {
    /// Reads and checks a frame; `file` is named in errors.
    ///
    /// # Errors
    /// If the text cannot be parsed, or a value is invalid or looks like one in another unit.
    pub fn parse(text: &str, file: &str) -> Result<Self, InputError> {
        let (raw, check): (Raw, _) = (read(text, file)?, Check { file });
        let turn = |key: &str, turn: [f64; 3]| {
            let turn = Vector3::from(check.each(key, turn, Check::finite)?);
            let must = "be at most 6.2832 (rad); degrees must be multiplied by 0.017453";
            check.require(key, turn.norm(), turn.norm() <= TAU + 1e-3, must)?;
            Ok(UnitQuaternion::from_scaled_axis(turn))
        };
        let origin = Vector3::from(check.each("origin_mm", raw.origin_mm, Check::finite)?);
        let (far, fits) = (origin.norm(), (MIN_DISTANCE_MM..=1e4).contains(&origin.norm()));
        let must = "lie 10 .. 10000 from the base (mm); metres must be multiplied by 1000";
        check.require("origin_mm", far, fits, must)?;
        let rotation = turn("axis_angle_rad", raw.axis_angle_rad)?;
        let upright = match raw.upright_axis_angle_rad {
            Some(upright) => rotation.inverse() * turn("upright_axis_angle_rad", upright)?,
            None => UnitQuaternion::from_axis_angle(&Vector3::x_axis(), PI),
        };
        let sign = raw.force_sign.unwrap_or(1.0);
        let must = "be 1 (force on the tool) or -1 (force of the tool)";
        check.require("force_sign", sign, sign.abs() == 1.0, must)?;
        let mass = raw.tool_mass_kg;
        let must = "lie in 0 .. 50 (kg); grams must be divided by 1000";
        check.require("tool_mass_kg", mass, (0.0..=50.0).contains(&mass), must)?;
        let compensated = raw.gravity_compensated.unwrap_or(true);
        if mass == 0.0 && !compensated {
            let problem = "is required if `gravity_compensated` is false; give the mass of \
                           everything below the sensor";
            return check.fail("tool_mass_kg", problem);
        }
        // Robots state the centre of mass beside the mass, so it is accepted; forces do not depend on it.
        check.each("tool_centre_mm", raw.tool_centre_mm, Check::distance)?;
        let base = Isometry3::from_parts(Translation3::from(origin * MM), rotation);
        Ok(Frame { base, upright, sign, tool_mass: mass, compensated })
    }

    /// Converts a pose in the base (m; axis-angle, rad) to the task's frame.
    ///
    /// # Errors
    /// If the TCP is rotated out of its upright orientation about y or z, or by more than 90 degrees about x.
    pub(super) fn pose(&self, place: Vector3<f64>, turn: Vector3<f64>) -> Result<Tcp, String> {
        let position = self.base.inverse_transform_point(&place.into()).coords;
        let rotation = UnitQuaternion::from_scaled_axis(turn);
        let tilt = self.base.rotation.inverse() * rotation * self.upright.inverse();
        let turned = tilt.scaled_axis();
        if turned.yz().norm() > MAX_ROTATION || turned.x.abs() > PI / 2.0 {
            let [x, y, z]: [f64; 3] = turned.map(f64::to_degrees).into();
            return Err(format!(
                "the tool is rotated by ({x:.0}, {y:.0}, {z:.0}) degrees about the task's axes from \
                 its upright orientation; give `upright_axis_angle_rad` in the frame file, or correct it"
            ));
        }
        Ok(Tcp { position, tilt: turned.x })
    }

    /// Converts a recorded force in the task's frame to the force on the tool, N.
    pub(super) fn force(&self, force: Vector3<f64>) -> Vector3<f64> {
        let weight =
            self.base.rotation.inverse() * Vector3::new(0.0, 0.0, -self.tool_mass * GRAVITY);
        self.sign * force - if self.compensated { Vector3::zeros() } else { weight }
    }
}
