//! World of the engine `mujoco`.

use crate::mjcf::{HEAVY, MATING_FORCE, axis_name, driven_axis_name, geom_names, servo};
use crate::scene::{
    AxialFriction, Body, BodyId, ContactPair, Joint, JointId, Motion, Pose, Scene, Spring,
};
use crate::{ContactForce, Diverged, World};
use mujoco_rs::prelude::{MjData, MjModel, MjtObjBase};
use nalgebra::{Matrix3, Quaternion, Rotation3, Translation3, UnitQuaternion, Vector3};
use std::sync::Arc;

/// Largest speed or coordinate, SI, of a state that has not diverged.
const MAX_STATE: f64 = 1e6;

/// Scene simulated by MuJoCo.
#[derive(Clone)]
pub(super) struct MujocoWorld {
    /// State and model; snapshots share the model until it is changed.
    data: MjData<Arc<MjModel>>,
    bodies: Vec<BodyIndices>,
    /// Servo of each axis of each joint.
    servos: Vec<[Option<Servo>; 6]>,
    /// Body to which each geom of the model belongs.
    owners: Vec<BodyId>,
    pairs: Vec<ContactPair>,
    /// Forces of the pairs over the last step.
    forces: Vec<ContactForce>,
    axial_friction: Option<MatingForce>,
}

/// Axial friction ([`AxialFriction`]), simulated as the friction of a tendon.
#[derive(Clone)]
struct MatingForce {
    friction: AxialFriction,
    tendon: usize,
    /// Index of the first component of the child's linear velocity.
    velocity: usize,
    /// Sign with which the force of each pair acts on the child and the bodies attached to it; 0 if it does not.
    signs: Vec<f64>,
}

/// Indices of a body in MuJoCo's arrays.
#[derive(Clone)]
struct BodyIndices {
    id: usize,
    mocap: Option<usize>,
    driven: Option<Driven>,
}

/// Coordinates of a driven body, relative to its initial pose.
#[derive(Clone)]
struct Driven {
    start: Pose,
    /// Indices of its six joints in MuJoCo's positions and velocities.
    position: [usize; 6],
    velocity: [usize; 6],
    /// Positions at the end of the next step.
    next: [f64; 6],
}

/// Actuator of a servo, with its constant gain.
#[derive(Clone, Copy)]
struct Servo {
    actuator: usize,
    gain: f64,
    spring: Spring,
}

impl MujocoWorld {
    pub fn new(scene: &Scene, mut model: MjModel) -> Self {
        // The control limits are the ranges of the viewer's sliders.
        model.actuator_ctrllimited_mut().fill(false);
        // The position control of driven bodies is for the viewer, too; see `push_driven`.
        for body in scene.bodies.iter().filter(|body| body.motion == Motion::Driven) {
            for axis in 0..6 {
                let name = driven_axis_name(body, axis);
                let actuator = id(&model, MjtObjBase::mjOBJ_ACTUATOR, &name);
                model.actuator_biasprm_mut()[actuator].fill(0.0);
            }
        }
        let bodies = scene.bodies.iter().map(|body| body_indices(&model, body)).collect();
        let servos = |joint| std::array::from_fn(|axis| servo_of(&model, joint, axis));
        let servos = scene.joints.iter().map(servos).collect();
        let mut owners = vec![BodyId(usize::MAX); model.geom_bodyid().len()];
        for (body, names) in geom_names(scene).iter().enumerate() {
            for name in names {
                owners[id(&model, MjtObjBase::mjOBJ_GEOM, name)] = BodyId(body);
            }
        }
        let axial_friction = scene.axial_friction.clone().map(|friction| {
            let child = id(&model, MjtObjBase::mjOBJ_BODY, &scene.bodies[friction.child.0].name);
            let tendon = id(&model, MjtObjBase::mjOBJ_TENDON, MATING_FORCE);
            let velocity = model.body_dofadr()[child] as usize;
            let hangs = |joint: &Joint, body| joint.parent == friction.child && joint.child == body;
            let own = |body| body == friction.child || scene.joints.iter().any(|j| hangs(j, body));
            let sign = |body| f64::from(u8::from(own(body)));
            let signs = scene.contacts.iter().map(|pair| sign(pair.second) - sign(pair.first));
            MatingForce { tendon, velocity, signs: signs.collect(), friction }
        });
        let mut data = MjData::new(Arc::new(model));
        data.kinematics();
        let forces = vec![ContactForce::default(); scene.contacts.len()];
        let pairs = scene.contacts.clone();
        MujocoWorld { data, bodies, servos, owners, pairs, forces, axial_friction }
    }

    /// Sets the limit of the axial friction for the current poses.
    fn update_axial_friction(&mut self) {
        let Some(MatingForce { friction, tendon, .. }) = &self.axial_friction else { return };
        let limit = friction.limit(&self.pose(friction.parent), &self.pose(friction.child));
        let tendon = *tendon;
        if self.data.model().tendon_frictionloss()[tendon] != limit {
            self.change(|model| model.tendon_frictionloss_mut()[tendon] = limit);
        }
    }

    /// Adds the axial friction to the forces of its pair: the constraint force of the child less the contact forces on
    /// the child and on the bodies attached to it.
    fn add_axial_friction(&mut self) {
        let Some(MatingForce { friction, tendon, velocity, signs }) = &self.axial_friction else {
            return;
        };
        if self.data.model().tendon_frictionloss()[*tendon] == 0.0 {
            return;
        }
        let axis = self.pose(friction.parent).rotation * Vector3::z();
        let mut net =
            Vector3::from_column_slice(&self.data.qfrc_constraint()[*velocity..velocity + 3]);
        for (sign, force) in signs.iter().zip(&self.forces) {
            net -= force.net * *sign;
        }
        let net = axis * net.dot(&axis);
        for (pair, force) in self.pairs.iter().zip(&mut self.forces) {
            force.net += net * pair.sign(friction.parent, friction.child).unwrap_or(0.0);
        }
    }

    /// Applies the forces that bring the driven bodies to their velocities. MuJoCo's coordinates are relative: to set
    /// a velocity would also set that of all attached bodies, as if they had no mass. So a force accelerates the
    /// driven body, whose mass is large compared to theirs.
    fn push_driven(&mut self) {
        let step = self.step_s();
        for driven in self.bodies.iter().filter_map(|body| body.driven.as_ref()) {
            for axis in 0..6 {
                let now = self.data.qpos()[driven.position[axis]];
                let rate = (driven.next[axis] - now) / step;
                let dof = driven.velocity[axis];
                let push = HEAVY * (rate - self.data.qvel()[dof]) / step;
                self.data.qfrc_applied_mut()[dof] = push;
            }
        }
    }

    /// Moves the driven bodies exactly to their commanded poses.
    fn place_driven(&mut self) {
        for driven in self.bodies.iter().filter_map(|body| body.driven.as_ref()) {
            for (position, next) in driven.position.into_iter().zip(driven.next) {
                self.data.qpos_mut()[position] = next;
            }
        }
    }

    /// Sums the contact forces of each pair.
    fn sum_forces(&mut self) {
        self.forces.fill(ContactForce::default());
        for (i, contact) in self.data.contact().iter().enumerate() {
            // MuJoCo's normal points from the first geom to the second.
            let [from, to] = contact.geom.map(|geom| self.owners[geom as usize]);
            let signed = |(i, pair): (usize, &ContactPair)| Some((i, pair.sign(from, to)?));
            let found = self.pairs.iter().enumerate().find_map(signed);
            let Some((pair, sign)) = found else { continue };
            let [normal, first, second, ..] = self.data.contact_force(i);
            let axes = Matrix3::from_column_slice(&contact.frame);
            self.forces[pair].net += axes * Vector3::new(normal, first, second) * sign;
            self.forces[pair].normal_sum += normal;
        }
    }

    fn is_finite(&self) -> bool {
        // A NaN fails the comparison.
        self.data.qpos().iter().chain(self.data.qvel()).all(|value| value.abs() < MAX_STATE)
    }

    /// Changes a copy of the model; snapshots keep the old one.
    fn change(&mut self, change: impl FnOnce(&mut MjModel)) {
        let mut model = self.data.model().clone();
        change(&mut model);
        self.data.swap_model(Arc::new(model));
    }
}

impl World for MujocoWorld {
    fn step(&mut self) -> Result<(), Diverged> {
        self.push_driven();
        self.update_axial_friction();
        self.data.step();
        self.sum_forces();
        self.add_axial_friction();
        self.place_driven();
        // After a step, MuJoCo's poses are those at its start.
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
    /// If the axis is not a servo.
    fn set_spring(&mut self, joint: JointId, axis: usize, spring: Spring) {
        let Some(Servo { actuator, gain, spring: old }) = self.servos[joint.0][axis] else {
            panic!("axis {axis} of joint {} is not a servo", joint.0)
        };
        if (Spring { target: old.target, ..spring }) != old {
            self.change(|model| {
                let bias = &mut model.actuator_biasprm_mut()[actuator];
                (bias[1], bias[2]) = (-spring.stiffness, -spring.damping);
                model.actuator_forcerange_mut()[actuator] = [-spring.limit, spring.limit];
                model.actuator_forcelimited_mut()[actuator] = spring.limit.is_finite();
            });
            self.servos[joint.0][axis] = Some(Servo { actuator, gain, spring });
        }
        // force = gain * control - stiffness * position - damping * rate
        self.data.ctrl_mut()[actuator] = spring.stiffness / gain * spring.target;
    }

    fn push(&mut self, body: BodyId, force: Vector3<f64>, moment: Vector3<f64>) {
        let (f, m) = (force, moment);
        self.data.xfrc_applied_mut()[self.bodies[body.0].id] = [f.x, f.y, f.z, m.x, m.y, m.z];
    }

    fn contact(&self, first: BodyId, second: BodyId) -> ContactForce {
        let signed = |(pair, force): (&ContactPair, &ContactForce)| {
            Some(ContactForce { net: force.net * pair.sign(first, second)?, ..*force })
        };
        self.pairs.iter().zip(&self.forces).find_map(signed).unwrap_or_default()
    }

    fn snapshot(&self) -> Box<dyn World> {
        Box::new(self.clone())
    }
}

/// Returns the index of a named object of the model.
///
/// # Panics
/// If there is no such object: the model was generated from the scene.
pub(super) fn id(model: &MjModel, kind: MjtObjBase, name: &str) -> usize {
    model.name_to_id(kind, name).unwrap_or_else(|| panic!("the model has no `{name}`"))
}

fn body_indices(model: &MjModel, body: &Body) -> BodyIndices {
    let index = id(model, MjtObjBase::mjOBJ_BODY, &body.name);
    let driven = (body.motion == Motion::Driven).then(|| {
        let name = |axis| driven_axis_name(body, axis);
        let joint = |axis| id(model, MjtObjBase::mjOBJ_JOINT, &name(axis));
        let joints: [usize; 6] = std::array::from_fn(joint);
        Driven {
            start: body.pose,
            position: joints.map(|joint| model.jnt_qposadr()[joint] as usize),
            velocity: joints.map(|joint| model.jnt_dofadr()[joint] as usize),
            next: [0.0; 6],
        }
    });
    BodyIndices { id: index, mocap: usize::try_from(model.body_mocapid()[index]).ok(), driven }
}

fn servo_of(model: &MjModel, joint: &Joint, axis: usize) -> Option<Servo> {
    let spring = *servo(joint, axis)?;
    let actuator = id(model, MjtObjBase::mjOBJ_ACTUATOR, &axis_name(joint, axis));
    Some(Servo { actuator, gain: model.actuator_gainprm()[actuator][0], spring })
}

/// Returns the translations, and the angles of successive rotations about x, y and z of the rotated frame.
fn coordinates(pose: &Pose) -> [f64; 6] {
    let at = pose.translation.vector;
    let turn: Rotation3<f64> = pose.rotation.to_rotation_matrix();
    let about_x = libm::atan2(-turn[(1, 2)], turn[(2, 2)]);
    let about_y = libm::asin(turn[(0, 2)].clamp(-1.0, 1.0));
    let about_z = libm::atan2(-turn[(0, 1)], turn[(0, 0)]);
    [at.x, at.y, at.z, about_x, about_y, about_z]
}
