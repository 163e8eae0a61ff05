//! A second, independent engine: MuJoCo. The only file that knows it.
//!
//! The scene is written as MJCF ([`crate::physics::mjcf`]) and read by MuJoCo itself. What a
//! trial does besides goes into the model's numbers: the force that drives a driven
//! body is set before each step, a servo's gains where its spring is replaced.

use super::{ContactForce, Diverged, Engine, Unsupported, World};
use crate::physics::mjcf::{self, HEAVY, Settings, axis_name, driven_axis_name, geom_names, servo};
use crate::scene::{Axis, BodyId, Joint, JointId, Motion, Pose, Scene, Spring, Springs};
use mujoco_rs::prelude::{MjData, MjModel, MjtObjBase};
use nalgebra::{Matrix3, Quaternion, Rotation3, Translation3, UnitQuaternion, Vector3};
use std::sync::Arc;

/// The engine; see [`Settings`].
#[derive(Debug, Clone, Copy, Default)]
pub struct Mujoco {
    /// How finely and how stiffly it simulates.
    pub settings: Settings,
}

impl Engine for Mujoco {
    fn version(&self) -> String {
        format!("mujoco {}", mujoco_rs::mujoco_version())
    }

    fn supports(&self, scene: &Scene) -> Result<(), Unsupported> {
        mjcf::supports(scene).map_err(|error| Unsupported {
            engine: self.version(),
            part: error.part,
            lacking: error.lacking,
        })
    }

    /// # Panics
    /// On a scene that it does not support, and if MuJoCo refuses the model.
    fn world(&self, scene: &Scene) -> Box<dyn World> {
        let text = mjcf::write(scene, "scene", &self.settings);
        let text = text.unwrap_or_else(|error| panic!("{error}"));
        let model = MjModel::from_xml_string(&text);
        let model = model.unwrap_or_else(|error| panic!("MuJoCo refuses the model: {error}"));
        Box::new(MujocoWorld::new(scene, model))
    }

    fn halved(&self) -> Box<dyn Engine> {
        let step_s = 0.5 * self.settings.step_s;
        Box::new(Mujoco { settings: Settings { step_s, ..self.settings } })
    }
}

const NO_FORCE: ContactForce = ContactForce { net: Vector3::new(0.0, 0.0, 0.0), normal_sum: 0.0 };
/// A speed or coordinate beyond this, SI, has left the finite numbers.
const HUGE: f64 = 1e6;

#[derive(Clone)]
struct MujocoWorld {
    /// State and model; the model is shared by snapshots until a spring is replaced.
    data: MjData<Arc<MjModel>>,
    bodies: Vec<Body>,
    joints: Vec<[Handle; 6]>,
    /// Body of the scene that a geom belongs to.
    owners: Vec<usize>,
    pairs: Vec<(usize, usize)>,
    /// Their forces over the last step.
    forces: Vec<ContactForce>,
}

/// A body's places in MuJoCo's arrays.
#[derive(Clone)]
struct Body {
    id: usize,
    mocap: Option<usize>,
    driven: Option<Driven>,
}

/// A driven body's coordinates, from its first pose.
#[derive(Clone)]
struct Driven {
    start: Pose,
    /// Of its six joints in MuJoCo's positions and velocities.
    position: [usize; 6],
    velocity: [usize; 6],
    now: [f64; 6],
    next: [f64; 6],
}

/// One axis of a joint in MuJoCo's arrays.
#[derive(Clone, Copy)]
enum Handle {
    Locked,
    /// A spring of the joint itself.
    Passive {
        joint: usize,
        position: usize,
        velocity: usize,
    },
    /// An actuator, and its gain, which stays as it is.
    Servo {
        actuator: usize,
        gain: f64,
        spring: Spring,
    },
}

impl MujocoWorld {
    fn new(scene: &Scene, mut model: MjModel) -> Self {
        // The sliders' ranges are for people.
        model.actuator_ctrllimited_mut().fill(false);
        // So are the driven bodies' actuators: here they go where they are told.
        for body in scene.bodies.iter().filter(|body| body.motion == Motion::Driven) {
            for axis in 0..6 {
                let name = driven_axis_name(body, axis);
                let actuator = id(&model, MjtObjBase::mjOBJ_ACTUATOR, &name);
                model.actuator_biasprm_mut()[actuator].fill(0.0);
            }
        }
        let bodies = scene.bodies.iter().map(|body| new_body(&model, body)).collect();
        let joints = scene
            .joints
            .iter()
            .map(|joint| std::array::from_fn(|axis| new_handle(&model, joint, axis)))
            .collect();
        let mut owners = vec![usize::MAX; model.geom_bodyid().len()];
        for (body, names) in geom_names(scene).iter().enumerate() {
            for name in names {
                owners[id(&model, MjtObjBase::mjOBJ_GEOM, name)] = body;
            }
        }
        let mut data = MjData::new(Arc::new(model));
        data.kinematics();
        MujocoWorld {
            data,
            bodies,
            joints,
            owners,
            pairs: scene.contacts.iter().map(|&(a, b)| (a.0, b.0)).collect(),
            forces: vec![NO_FORCE; scene.contacts.len()],
        }
    }

    /// Sends the driven bodies on their way. MuJoCo's coordinates are relative: a velocity
    /// that is merely set takes along all that hangs on the body, as if it weighed nothing.
    /// So a force brings it to its velocity, against a mass beside which the rest is light.
    fn steer(&mut self) {
        let step = self.step_s();
        for driven in self.bodies.iter().filter_map(|body| body.driven.as_ref()) {
            for axis in 0..6 {
                let rate = (driven.next[axis] - driven.now[axis]) / step;
                let dof = driven.velocity[axis];
                let push = HEAVY * (rate - self.data.qvel()[dof]) / step;
                self.data.qfrc_applied_mut()[dof] = push;
            }
        }
    }

    /// Takes the rounding out of where the driven bodies have come.
    fn arrive(&mut self) {
        for driven in self.bodies.iter_mut().filter_map(|body| body.driven.as_mut()) {
            driven.now = driven.next;
            for axis in 0..6 {
                self.data.qpos_mut()[driven.position[axis]] = driven.now[axis];
            }
        }
    }

    fn add_forces(&mut self) {
        self.forces.fill(NO_FORCE);
        for (i, contact) in self.data.contact().iter().enumerate() {
            // MuJoCo's normal points from the first geom to the second.
            let [from, to] = contact.geom.map(|geom| self.owners[geom as usize]);
            let place =
                self.pairs.iter().position(|&(a, b)| (a, b) == (from, to) || (a, b) == (to, from));
            let Some(place) = place else { continue };
            let [normal, first, second, ..] = self.data.contact_force(i);
            let axes = Matrix3::from_column_slice(&contact.frame);
            let sign = if self.pairs[place] == (from, to) { 1.0 } else { -1.0 };
            self.forces[place].net += axes * Vector3::new(normal, first, second) * sign;
            self.forces[place].normal_sum += normal;
        }
    }

    fn is_finite(&self) -> bool {
        // Written so that a NaN is outside.
        self.data.qpos().iter().chain(self.data.qvel()).all(|value| value.abs() < HUGE)
    }

    /// Changes the model; snapshots keep the one they have.
    fn change(&mut self, change: impl FnOnce(&mut MjModel)) {
        let mut model = self.data.model().clone();
        change(&mut model);
        self.data.swap_model(Arc::new(model));
    }
}

impl World for MujocoWorld {
    fn step(&mut self) -> Result<(), Diverged> {
        self.steer();
        self.data.step();
        self.add_forces();
        self.arrive();
        // Poses of the end of the step, where MuJoCo's are of its start.
        self.data.kinematics();
        if self.is_finite() { Ok(()) } else { Err(Diverged) }
    }

    fn step_s(&self) -> f64 {
        self.data.model().opt().timestep
    }

    fn pose(&self, body: BodyId) -> Pose {
        let id = self.bodies[body.0].id;
        let [w, i, j, k] = self.data.xquat()[id];
        let turn = UnitQuaternion::new_unchecked(Quaternion::new(w, i, j, k));
        Pose::from_parts(Translation3::from(self.data.xpos()[id]), turn)
    }

    fn drive(&mut self, body: BodyId, pose: Pose) {
        if let Some(driven) = &mut self.bodies[body.0].driven {
            driven.next = coordinates(&driven.start.inv_mul(&pose));
        }
    }

    fn place(&mut self, body: BodyId, pose: Pose) {
        let Some(mocap) = self.bodies[body.0].mocap else { return };
        let q = pose.rotation.coords;
        self.data.mocap_pos_mut()[mocap] = pose.translation.vector.into();
        self.data.mocap_quat_mut()[mocap] = [q.w, q.x, q.y, q.z];
        self.data.kinematics();
    }

    /// # Panics
    /// If a plain spring, without a limit from the start, is given one.
    fn set_spring(&mut self, joint: JointId, axis: usize, spring: Spring) {
        match self.joints[joint.0][axis] {
            Handle::Locked => {}
            Handle::Passive { joint, position, velocity } => {
                assert!(spring.limit.is_infinite(), "a plain spring has no limit");
                self.change(|model| {
                    model.jnt_stiffness_mut()[joint] = spring.stiffness;
                    model.dof_damping_mut()[velocity] = spring.damping;
                    model.qpos_spring_mut()[position] = spring.target;
                });
            }
            Handle::Servo { actuator, gain, spring: old } => {
                if (Spring { target: old.target, ..spring }) != old {
                    self.change(|model| {
                        let bias = &mut model.actuator_biasprm_mut()[actuator];
                        (bias[1], bias[2]) = (-spring.stiffness, -spring.damping);
                        model.actuator_forcerange_mut()[actuator] = [-spring.limit, spring.limit];
                        model.actuator_forcelimited_mut()[actuator] = spring.limit.is_finite();
                    });
                    self.joints[joint.0][axis] = Handle::Servo { actuator, gain, spring };
                }
                // force = gain * control - stiffness * position - damping * rate
                self.data.ctrl_mut()[actuator] = spring.stiffness / gain * spring.target;
            }
        }
    }

    fn push(&mut self, body: BodyId, force: Vector3<f64>, moment: Vector3<f64>) {
        let (f, m) = (force, moment);
        self.data.xfrc_applied_mut()[self.bodies[body.0].id] = [f.x, f.y, f.z, m.x, m.y, m.z];
    }

    fn contact(&self, first: BodyId, second: BodyId) -> ContactForce {
        let ends = (first.0, second.0);
        for (&pair, &force) in self.pairs.iter().zip(&self.forces) {
            if pair == ends {
                return force;
            }
            if pair == (ends.1, ends.0) {
                return ContactForce { net: -force.net, ..force };
            }
        }
        NO_FORCE
    }

    fn snapshot(&self) -> Box<dyn World> {
        Box::new(self.clone())
    }
}

/// # Panics
/// If there is none: the model was written from the scene.
fn id(model: &MjModel, kind: MjtObjBase, name: &str) -> usize {
    model.name_to_id(kind, name).unwrap_or_else(|| panic!("the model has no `{name}`"))
}

fn new_body(model: &MjModel, body: &crate::scene::Body) -> Body {
    let index = id(model, MjtObjBase::mjOBJ_BODY, &body.name);
    let driven = (body.motion == Motion::Driven).then(|| {
        let name = |axis| driven_axis_name(body, axis);
        let joint = |axis| id(model, MjtObjBase::mjOBJ_JOINT, &name(axis));
        let joints: [usize; 6] = std::array::from_fn(joint);
        Driven {
            start: body.pose,
            position: joints.map(|joint| model.jnt_qposadr()[joint] as usize),
            velocity: joints.map(|joint| model.jnt_dofadr()[joint] as usize),
            now: [0.0; 6],
            next: [0.0; 6],
        }
    });
    Body { id: index, mocap: usize::try_from(model.body_mocapid()[index]).ok(), driven }
}

fn new_handle(model: &MjModel, joint: &Joint, axis: usize) -> Handle {
    let Springs::Axes(axes) = &joint.springs else { return Handle::Locked };
    let Axis::Sprung(_) = axes[axis] else { return Handle::Locked };
    let name = axis_name(joint, axis);
    if let Some(&spring) = servo(joint, axis) {
        let actuator = id(model, MjtObjBase::mjOBJ_ACTUATOR, &name);
        return Handle::Servo { actuator, gain: model.actuator_gainprm()[actuator][0], spring };
    }
    let joint = id(model, MjtObjBase::mjOBJ_JOINT, &name);
    Handle::Passive {
        joint,
        position: model.jnt_qposadr()[joint] as usize,
        velocity: model.jnt_dofadr()[joint] as usize,
    }
}

/// Translations, and the angles of turns about x, then y, then z.
fn coordinates(pose: &Pose) -> [f64; 6] {
    let at = pose.translation.vector;
    let turn: Rotation3<f64> = pose.rotation.to_rotation_matrix();
    let about_x = f64::atan2(-turn[(1, 2)], turn[(2, 2)]);
    let about_y = turn[(0, 2)].clamp(-1.0, 1.0).asin();
    let about_z = f64::atan2(-turn[(0, 1)], turn[(0, 0)]);
    [at.x, at.y, at.z, about_x, about_y, about_z]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::input::robot::{Flange, Servo};
    use crate::scene::{Body as SceneBody, Inertia};
    use crate::trial::cell;
    use nalgebra::Point3;

    /// A body of 0.1 kg on a servo of 1000 N/m and 5 N along y.
    fn servo_scene() -> (Scene, BodyId, JointId) {
        let mut scene = Scene::default();
        let inertia =
            Inertia { mass: 0.1, centre: Point3::origin(), moments: Vector3::repeat(1e-4) };
        let body = |name: &str, motion| SceneBody {
            name: name.into(),
            motion,
            pose: Pose::identity(),
            geoms: Vec::new(),
        };
        let base = scene.body(body("base", Motion::Fixed));
        let jaw = scene.body(body("jaw", Motion::Carried(inertia)));
        let mut axes = [Axis::Locked; 6];
        axes[1] = Axis::Sprung(Spring { limit: 5.0, ..Spring::new(1000.0, 30.0) });
        let slide = scene.joint(Joint {
            name: "slide".into(),
            parent: base,
            child: jaw,
            in_parent: Pose::identity(),
            in_child: Pose::identity(),
            springs: Springs::Axes(axes),
        });
        (scene, jaw, slide)
    }

    fn advance(world: &mut dyn World, time: f64) {
        for _ in 0..(time / world.step_s()).round() as usize {
            world.step().unwrap();
        }
    }

    #[test]
    fn a_servo_pushes_to_its_limit_and_can_be_made_to_hold() {
        let (scene, jaw, slide) = servo_scene();
        let mut world = Mujoco::default().world(&scene);
        let at = |world: &dyn World| world.pose(jaw).translation.y;
        world.push(jaw, Vector3::new(0.0, 3.0, 0.0), Vector3::zeros());
        advance(&mut *world, 0.5);
        assert!((at(&*world) - 3e-3).abs() < 1e-6, "{}", at(&*world));
        let mut snapshot = world.snapshot();
        // Beyond the limit it gives way.
        world.push(jaw, Vector3::new(0.0, 6.0, 0.0), Vector3::zeros());
        advance(&mut *world, 0.5);
        assert!(at(&*world) > 0.1, "{}", at(&*world));
        // Held, it does not; and the model of one world is not that of the other.
        snapshot.set_spring(slide, 1, cell::holding(3e-3));
        snapshot.push(jaw, Vector3::new(0.0, 6.0, 0.0), Vector3::zeros());
        advance(&mut *snapshot, 0.5);
        assert!((at(&*snapshot) - 3e-3).abs() < 1e-6, "{}", at(&*snapshot));
    }

    /// Damper and spring act between command and flange, so at a steady speed the
    /// flange does not trail.
    #[test]
    fn a_driven_body_carries_the_flange_along_and_turns_it() {
        let servo = Servo {
            stiffness: [1e4; 3],
            rotational_stiffness: [400.0; 3],
            mass: 2.0,
            inertia: 0.01,
            damping_ratio: 1.0,
        };
        let mut scene = Scene::default();
        let (command, flange) = cell::flange(&mut scene, &Flange::Servo(servo), Pose::identity());
        let mut world = Mujoco::default().world(&scene);
        let step = world.step_s();
        for i in 1..=8000 {
            let time = f64::from(i) * step;
            let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), 0.5 * time);
            world.drive(command, Pose::from_parts(Translation3::new(0.0, 0.1 * time, 0.0), turn));
            world.step().unwrap();
        }
        let off = world.pose(command).inv_mul(&world.pose(flange));
        assert!((world.pose(command).translation.y - 0.04).abs() < 1e-9);
        assert!((world.pose(command).rotation.angle() - 0.2).abs() < 1e-9);
        assert!(off.translation.vector.norm() < 1e-5 && off.rotation.angle() < 1e-5, "{off}");
    }

    #[test]
    fn the_arm_is_refused_by_name() {
        let (mut scene, ..) = servo_scene();
        scene.bodies[1].motion = Motion::Mechanism(nalgebra::Matrix6::identity());
        let refused = Mujoco::default().supports(&scene).unwrap_err();
        assert_eq!((refused.part.as_str(), refused.engine.as_str()), ("jaw", "mujoco 3.17.0"));
    }
}
