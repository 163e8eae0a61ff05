//! T3 and T10: peg in two-point contact with a hole.
//!
//! The peg is tilted by t about x: a corner of its tip touches the wall at +y, its flank rests on
//! the rim at -y. With the width d of the peg, D of the hole and l the length of the peg below the
//! rim (Whitney 1982, J. Dyn. Sys. Meas. Control 104:65, from the geometry): D = d cos t + l sin t.
//!
//! The frame of the peg: the middle of its tip, z along it; the hole's rim lies in the plane z = 0.

use super::build::{self, Measured};
use super::{CheckRow, Tolerance};
use contact::scene::{Body, BodyId, Friction, Motion, Pose, Scene};
use contact::{Engine, World};
use input::units::{GRAM, MM};
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};

const LENGTH: f64 = 20.0 * MM;
/// Centre of mass of a peg, m.
const CENTRE: Point3<f64> = Point3::new(0.0, 0.0, LENGTH / 2.0);
/// Width of a peg in x, m.
const DEPTH: f64 = 8.0 * MM;
const WALL: f64 = 10.0 * MM;

/// Peg in a hole that is open along x.
#[derive(Debug, Clone, Copy)]
pub(super) struct Peg {
    /// Width d of the peg, m.
    pub width: f64,
    /// Width D of the hole, m.
    pub hole: f64,
    /// Length l of the peg below the rim, m.
    pub inside: f64,
    pub friction: f64,
    pub mass: f64,
}

pub(super) const REFERENCE: Peg =
    Peg { width: 12.0 * MM, hole: 12.1 * MM, inside: 8.0 * MM, friction: 0.3, mass: 20.0 * GRAM };

impl Peg {
    /// Returns the tilt in two-point contact, rad: the formula above, solved for t.
    pub fn tilt(&self) -> f64 {
        let diagonal = libm::hypot(self.width, self.inside);
        libm::atan2(self.inside, self.width) - libm::acos(self.hole / diagonal)
    }

    pub fn tilted(&self) -> Pose {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), self.tilt());
        // The tip's corner at +y lies on the wall, the rim's point on the flank at z = 0.
        let corner = turn * Vector3::new(0.0, self.width / 2.0, 0.0);
        let rim = turn * Vector3::new(0.0, -self.width / 2.0, self.inside);
        Pose::from_parts(Translation3::new(0.0, self.hole / 2.0 - corner.y, -rim.z), turn)
    }

    pub fn body(&self, pose: Pose) -> Body {
        let size = Vector3::new(DEPTH, self.width, LENGTH);
        let middle = Pose::from(Translation3::from(CENTRE.coords));
        Body {
            name: "peg".into(),
            motion: Motion::Carried(build::box_inertia(self.mass, size, CENTRE)),
            pose,
            geoms: vec![build::cuboid("peg", size, middle)],
        }
    }

    /// Returns the wall at -y or +y, twice as deep as the peg is inside.
    pub fn wall(&self, side: f64) -> Body {
        let size = Vector3::new(2.0 * DEPTH, WALL, 2.0 * self.inside);
        let pose = Pose::translation(0.0, side * (self.hole + WALL) / 2.0, -self.inside);
        let geom = build::cuboid("wall", size, Pose::identity());
        let name = if side < 0.0 { "wall -y" } else { "wall +y" };
        build::fixed(name, pose, vec![geom])
    }

    pub fn scene(&self, pose: Pose) -> (Scene, BodyId) {
        let mut scene = Scene::default();
        let peg = scene.body(self.body(pose));
        for side in [-1.0, 1.0] {
            let wall = scene.body(self.wall(side));
            scene.contact(wall, peg, Friction::hard(self.friction));
        }
        (scene, peg)
    }

    /// Loads the middle of the tip with a force and a moment for a time, s.
    pub fn load(
        &self,
        world: &mut dyn World,
        peg: BodyId,
        load: [Vector3<f64>; 2],
        time: f64,
    ) -> Measured<()> {
        for _ in 0..build::steps(world, time) {
            let tip = world.pose(peg) * Point3::origin();
            build::push(world, peg, CENTRE, tip, load);
            world.step()?;
        }
        Ok(())
    }
}

/// Returns the moment about x, N m, which turns the peg into two-point contact, without a force.
pub(super) fn turning(moment: f64) -> [Vector3<f64>; 2] {
    [Vector3::zeros(), Vector3::new(moment, 0.0, 0.0)]
}

pub fn t3(engine: &dyn Engine) -> Vec<CheckRow> {
    let peg = REFERENCE;
    let measured = settled(engine, &peg);
    // While it turned the peg may have moved: the formula is judged at the length inside at rest.
    let inside = measured.map_or(peg.inside, |(_, inside)| inside);
    let expected = Peg { inside, ..peg }.tilt();
    let tilt = measured.map(|(tilt, _)| tilt / 1e-3);
    let inside = measured.map(|(_, inside)| inside / MM);
    // By no more than the tip's corners rise and sink.
    let little = Tolerance::Absolute(peg.width * peg.tilt() / MM);
    let close = Tolerance::Relative(0.02);
    let hardly = "length inside, which tilting hardly changes";
    vec![
        CheckRow::new("T3", "tilt in two-point contact", expected / 1e-3, tilt, "mrad", close),
        CheckRow::new("T3", hardly, peg.inside / MM, inside, "mm", little),
    ]
}

/// Moment that turns the peg of T3, N m: presses each contact with 0.25 N. The
/// formula is for rigid contacts; so lightly pressed, ours yield next to nothing.
const TURNING: f64 = 0.002;
const RESTING: f64 = 0.05;

fn settled(engine: &dyn Engine, peg: &Peg) -> Measured<(f64, f64)> {
    let (scene, body) = peg.scene(Pose::translation(0.0, 0.0, -peg.inside));
    let mut world = engine.world(&scene);
    peg.load(world.as_mut(), body, turning(TURNING), RESTING)?;
    let pose = world.pose(body);
    let rim = pose.inverse() * Point3::new(0.0, -peg.hole / 2.0, 0.0);
    Ok((pose.rotation.scaled_axis().x, rim.z))
}

/// Mass of the plug of T10, kg: an RJ45 plug.
const LIGHT: f64 = 5.0 * GRAM;
/// Forces on each contact, N; an arm at its limit of 100 N can wedge a plug with the second.
const WEDGING: [f64; 2] = [70.0, 200.0];
/// Largest penetration under the first force, m: less than the clearance of a connector.
const YIELD: f64 = 0.1 * MM;

/// Returns the penetration of a light plug into its walls, T10 rows: little, and in proportion to the force.
pub fn t10(engine: &dyn Engine) -> Vec<CheckRow> {
    let peg = Peg { mass: LIGHT, ..REFERENCE };
    let sunk = WEDGING.map(|force| sinking(engine, &peg, force));
    let [low, high] = WEDGING;
    let rows = ["tip's corner", "rim"].into_iter().enumerate().flat_map(|(i, place)| {
        let [few, many] = sunk.map(|sunk| sunk.map(|depths| depths[i] / MM));
        let linear = few.map_or(f64::NAN, |few| few * high / low);
        let row = |force, expected, measured, allowed| {
            let quantity = format!("5 g plug sinks under {force} N at {place}");
            CheckRow::new("T10", quantity, expected, measured, "mm", allowed)
        };
        let first = row(low, 0.0, few, Tolerance::Absolute(YIELD / MM));
        [first, row(high, linear, many, Tolerance::Relative(0.1))]
    });
    rows.collect()
}

fn sinking(engine: &dyn Engine, peg: &Peg, force: f64) -> Measured<[f64; 2]> {
    let (scene, body) = peg.scene(peg.tilted());
    let mut world = engine.world(&scene);
    peg.load(world.as_mut(), body, turning(force * peg.inside), RESTING)?;
    let pose = world.pose(body);
    let corner = pose * Point3::new(0.0, peg.width / 2.0, 0.0);
    let rim = pose.inverse() * Point3::new(0.0, -peg.hole / 2.0, 0.0);
    Ok([corner.y - peg.hole / 2.0, rim.y + peg.width / 2.0])
}
