//! T6: the force of crossing a chamfer.
//!
//! A plug on a lateral spring K slides down a chamfer at the angle a to the direction of insertion.
//! With the normal force N its balance is K x = N (cos a - mu sin a) across and F = N (sin a + mu cos
//! a) along the insertion, hence F = K x tan(a + atan mu), x being its way aside (Whitney 1982, J.
//! Dyn. Sys. Meas. Control 104:65, for a support that does not turn). The chamfer is a turned block;
//! at 45 degrees also what a task's `edges` make of a block's edge.

use super::build;
use super::{CheckRow, Tolerance};
use contact::scene::{Body, Friction, Motion, Pose, Scene};
use contact::{Diverged, Engine};
use input::units::{DEG, GRAM, MM, N_PER_MM};
use insertion::finger::Finger;
use insertion::task::{Part, Solid};
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};

/// Angles of the chamfer, degrees from the direction of insertion.
const ANGLES: [f64; 2] = [30.0, 45.0];
const FRICTION: f64 = 0.2;
/// Speed of insertion, m/s: so slow that the springs' dampers carry nothing.
const SPEED: f64 = 2.0 * MM;
/// Way of insertion, m.
const WAY: f64 = 0.6 * MM;
/// The plug, kg and m.
const MASS: f64 = 20.0 * GRAM;
const SIZE: [f64; 3] = [8.0 * MM, 12.0 * MM, 20.0 * MM];
/// Rotational stiffness, N m/rad: the support turns by less than a milliradian.
const UPRIGHT: f64 = 100.0;

pub fn t6(engine: &dyn Engine) -> Vec<CheckRow> {
    let turned = ANGLES.map(|angle| (angle, "chamfer", Some(chamfer(-SIZE[1] / 2.0, angle * DEG))));
    let cut = [(45.0, "cut edge", cut_edge(-SIZE[1] / 2.0))];
    let rows = turned.into_iter().chain(cut).map(|(angle, name, socket)| {
        let quantity = format!("Fz/(K x) on a {name} of {angle} deg, mu {FRICTION}");
        let expected = libm::tan(angle * DEG + libm::atan(FRICTION));
        let measured = socket.map_or(Err(Diverged), |socket| force_ratio(engine, socket));
        CheckRow::new("T6", quantity, expected, measured, "-", Tolerance::Relative(0.02))
    });
    rows.collect()
}

fn force_ratio(engine: &dyn Engine, socket: Body) -> Result<f64, Diverged> {
    let support = Finger { rotation: [UPRIGHT; 3], ..Finger::new(5.0 * N_PER_MM, 40.0 * N_PER_MM) };
    let size = Vector3::from(SIZE);
    let mut scene = Scene::default();
    let flange = scene.body(build::driven("flange", Pose::identity(), Vec::new()));
    // The plug's frame is the middle of its tip; its corner at -y starts on the chamfer.
    let centre = Point3::new(0.0, 0.0, size.z / 2.0);
    let middle = Pose::from_parts(Translation3::from(centre.coords), UnitQuaternion::identity());
    let plug = scene.body(Body {
        name: "plug".into(),
        motion: Motion::Carried(build::box_inertia(MASS, size, centre)),
        pose: Pose::identity(),
        geoms: vec![build::cuboid("plug", size, middle)],
    });
    let springs = support.springs().map(Some);
    build::joint(&mut scene, "springs", [flange, plug], [middle; 2], springs);
    let socket = scene.body(socket);
    scene.contact(socket, plug, Friction::hard(FRICTION));

    let mut world = engine.world(&scene);
    for step in 1..=build::steps(world.as_ref(), WAY / SPEED) {
        let down = SPEED * world.step_s() * step as f64;
        world.drive(flange, Pose::translation(0.0, 0.0, -down));
        world.step()?;
    }
    let moved = world.pose(flange).inverse() * world.pose(plug);
    let across = support.compliance * moved.translation.y;
    let along = support.assembly * moved.translation.z;
    Ok(along / across)
}

/// Returns a block whose face goes through the line y, z = 0, looking to +y and up by `angle`.
fn chamfer(y: f64, angle: f64) -> Body {
    let size = Vector3::new(20.0 * MM, 10.0 * MM, 10.0 * MM);
    // The block's face at +y, turned about x so that its normal rises by the angle.
    let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), angle);
    let normal = turn * Vector3::y();
    let pose = Pose::from_parts(Translation3::from(Vector3::y() * y - normal * size.y / 2.0), turn);
    build::fixed("chamfer", pose, vec![build::cuboid("chamfer", size, Pose::identity())])
}

/// Returns a block whose edge is cut at 45 degrees, the chamfer's middle being the line y, z = 0.
fn cut_edge(y: f64) -> Option<Body> {
    let leg = 2.0 * MM;
    let max = Vector3::new(10.0 * MM, y + leg / 2.0, leg / 2.0);
    let solid = Solid::chamfered(&(max - Vector3::repeat(20.0 * MM)), &max, "+y+z", leg)?;
    let part = Part { name: "cut edge".into(), solid, friction: None };
    Some(build::fixed("cut edge", Pose::identity(), vec![part.geom()]))
}
