//! Tree of bodies with their joints and geoms.

use super::xml::Element;
use super::{
    ANCHOR, AXES, FAR, HEAVY, MATING_FORCE, axis_name, driven_axis_name, geom_names, mesh_name,
};
use crate::scene::{
    AxialFriction, Body, BodyId, Geom, Inertia, Joint, Motion, Pose, Scene, Shape, Spring, Springs,
};
use crate::shapes::extended;
use nalgebra::{Point3, Translation3, UnitQuaternion, Vector3};

/// Colours that the bodies take in turn: red, green and blue, 0 to 1.
const COLOURS: [[f64; 3]; 6] = [
    [0.30, 0.45, 0.69],
    [0.87, 0.52, 0.32],
    [0.33, 0.66, 0.41],
    [0.77, 0.31, 0.32],
    [0.51, 0.45, 0.70],
    [0.55, 0.55, 0.55],
];
/// Smallest half thickness of a mesh, m.
const THIN: f64 = 1e-6;
/// Opacity of fixed bodies, 0 to 1.
const SEE_THROUGH: f64 = 0.5;

/// Returns the `worldbody`: a light, and the bodies; the child of a joint is nested in its parent.
pub(super) fn world(scene: &Scene) -> Element {
    let names = geom_names(scene);
    let is_root = |body: &usize| !scene.joints.iter().any(|joint| joint.child.0 == *body);
    let roots = (0..scene.bodies.len()).filter(is_root);
    let light =
        Element::new("light").numbers("pos", [0.1, -0.2, 0.5]).numbers("dir", [-0.2, 0.4, -1.0]);
    let list = roots.map(|body| {
        let root = &scene.bodies[body];
        let placed = body_element(root, &root.pose);
        let rooted = match root.motion {
            // Movable: the simulation of an insertion shifts the socket and removes the plug's stand.
            Motion::Fixed => placed.with("mocap", "true"),
            // Slides and hinges along the axes of its initial pose.
            Motion::Driven => placed.with_children(
                (0..6).map(|i| joint_element(&driven_axis_name(root, i), &Pose::identity(), i)),
            ),
            _ => placed.with_children([Element::new("freejoint")]),
        };
        rooted.with_children(contents(scene, body, &names))
    });
    Element::new("worldbody").with_children([light]).with_children(list)
}

/// Returns the elements of a body after its joints: inertia, geoms, sites and the bodies on its joints.
fn contents(scene: &Scene, body: usize, names: &[Vec<String>]) -> Vec<Element> {
    let mut list: Vec<Element> = inertial(&scene.bodies[body].motion).into_iter().collect();
    let geoms = scene.bodies[body].geoms.iter().zip(&names[body]);
    list.extend(geoms.map(|(geom, name)| geom_element(scene, body, geom, name)));
    list.extend(scene.axial_friction.iter().flat_map(|friction| sites(friction, BodyId(body))));
    for joint in scene.joints.iter().filter(|joint| joint.parent.0 == body) {
        let child = joint.child.0;
        let carried = body_element(&scene.bodies[child], &zero_pose(joint));
        let carried = carried.with_children(joint_elements(joint));
        list.push(carried.with_children(contents(scene, child, names)));
    }
    list
}

/// Returns the attachment points, on a body, of the tendon with the axial friction.
fn sites(friction: &AxialFriction, body: BodyId) -> impl Iterator<Item = Element> {
    let ends = [(friction.parent, ANCHOR, -FAR), (friction.child, MATING_FORCE, 0.0)];
    let own = ends.into_iter().filter(move |(of, ..)| *of == body);
    own.map(|(_, name, z)| Element::new("site").with("name", name).numbers("pos", [0.0, 0.0, z]))
}

/// Returns the pose of the child in the frame of the parent when all coordinates are zero.
fn zero_pose(joint: &Joint) -> Pose {
    joint.in_parent * joint.in_child.inverse()
}

fn body_element(Body { name, motion, .. }: &Body, pose: &Pose) -> Element {
    let element = Element::new("body").with("name", name);
    let compensated = matches!(motion, Motion::Carried(_) | Motion::Driven);
    placed(if compensated { element.with("gravcomp", 1) } else { element }, pose)
}

fn placed(element: Element, pose: &Pose) -> Element {
    let (at, q) = (pose.translation.vector, pose.rotation.coords);
    let placed = element.numbers("pos", [at.x, at.y, at.z]);
    // The identity is omitted.
    if q.xyz() == Vector3::zeros() { placed } else { placed.numbers("quat", [q.w, q.x, q.y, q.z]) }
}

fn inertial(motion: &Motion) -> Option<Element> {
    let inertia = match motion {
        Motion::Fixed | Motion::Mechanism(_) => return None,
        // So heavy that no contact moves it.
        Motion::Driven => {
            Inertia { mass: HEAVY, centre: Point3::origin(), moments: Vector3::repeat(HEAVY) }
        }
        Motion::Free(inertia) | Motion::Carried(inertia) => *inertia,
    };
    let element = Element::new("inertial").numbers("pos", inertia.centre.iter().copied());
    let element = element.with("mass", inertia.mass);
    Some(element.numbers("diaginertia", inertia.moments.iter().copied()))
}

/// Returns the slides and hinges of a joint; the slides come first, so that their axes are those of the parent.
fn joint_elements(joint: &Joint) -> Vec<Element> {
    // `supports` rejects coupled springs.
    let Springs::Axes(axes) = &joint.springs else { return Vec::new() };
    let element = |(i, axis): (usize, &Option<Spring>)| {
        let spring = axis.as_ref()?;
        let element = joint_element(&axis_name(joint, i), &joint.in_child, i);
        // The spring of a servo is written as an actuator.
        if spring.limit.is_finite() {
            return Some(element);
        }
        let element = element.with("stiffness", spring.stiffness).with("damping", spring.damping);
        let rest = spring.target != 0.0;
        Some(if rest { element.with("springref", spring.target) } else { element })
    };
    axes.iter().enumerate().filter_map(element).collect()
}

fn joint_element(name: &str, frame: &Pose, axis: usize) -> Element {
    let along = frame.rotation * Vector3::ith(axis % 3, 1.0);
    let kind = if axis < AXES.len() / 2 { "slide" } else { "hinge" };
    let element = Element::new("joint").with("name", name).with("type", kind);
    let element = element.numbers("axis", along.iter().copied());
    if kind == "slide" {
        return element;
    }
    element.numbers("pos", frame.translation.vector.iter().copied())
}

fn geom_element(scene: &Scene, body: usize, geom: &Geom, name: &str) -> Element {
    let element = placed(Element::new("geom").with("name", name), &(geom.pose * upright(geom)));
    let element = match &geom.shape {
        Shape::Box { half } => element.with("type", "box").numbers("size", half.iter().copied()),
        Shape::Cylinder { half_height, radius } => {
            element.with("type", "cylinder").numbers("size", [*radius, *half_height])
        }
        Shape::RoundBox { core, radius } if mesh_points(&geom.shape).is_none() => {
            let element = element.with("type", if core.max() > 0.0 { "capsule" } else { "sphere" });
            element.numbers("size", [*radius, core.max()])
        }
        Shape::Hull { .. } | Shape::RoundBox { .. } => {
            element.with("type", "mesh").with("mesh", mesh_name(name))
        }
    };
    let [r, g, b] = COLOURS[body % COLOURS.len()];
    let fixed = scene.bodies[body].motion == Motion::Fixed;
    element.numbers("rgba", [r, g, b, if fixed { SEE_THROUGH } else { 1.0 }])
}

/// Returns the rotation of a capsule from MuJoCo's axis, z, to the axis of its core; the identity for other shapes.
fn upright(geom: &Geom) -> Pose {
    let Shape::RoundBox { core, .. } = &geom.shape else { return Pose::identity() };
    let turn = match extended(core)[..] {
        [axis] => UnitQuaternion::rotation_between(&Vector3::z(), &Vector3::ith(axis, 1.0)),
        _ => None,
    };
    Pose::from_parts(Translation3::identity(), turn.unwrap_or_default())
}

/// Returns the points of a shape that is a mesh in MuJoCo; `None` for other shapes.
fn mesh_points(shape: &Shape) -> Option<Vec<Point3<f64>>> {
    match shape {
        Shape::Hull { points } => Some(points.clone()),
        // The core as a mesh, which MuJoCo requires not to be flat. A `box` with a margin has no contacts at its edges.
        Shape::RoundBox { core, .. } if extended(core).len() > 1 => {
            Some(Shape::Box { half: core.map(|half| half.max(THIN)) }.corners())
        }
        _ => None,
    }
}

/// Returns the contact margin of a shape, m: the radius if MuJoCo's mesh is only the core, otherwise 0.
pub(super) fn margin(shape: &Shape) -> f64 {
    let Shape::RoundBox { radius, .. } = shape else { return 0.0 };
    if mesh_points(shape).is_some() { *radius } else { 0.0 }
}

/// Returns the `asset` element with the meshes of hulls and cores.
pub(super) fn assets(scene: &Scene) -> Element {
    let names = geom_names(scene);
    let geoms = scene.bodies.iter().flat_map(|body| &body.geoms).zip(names.iter().flatten());
    let mesh = |(geom, name): (&Geom, &String)| {
        let points = mesh_points(&geom.shape)?;
        let corners = points.iter().flat_map(|point| <[f64; 3]>::from(point.coords));
        Some(Element::new("mesh").with("name", mesh_name(name)).numbers("vertex", corners))
    };
    Element::new("asset").with_children(geoms.filter_map(mesh))
}

/// Returns whether the initial coordinates of a joint are zero, within 1e-9 m and rad.
pub(super) fn at_zero(scene: &Scene, joint: &Joint) -> bool {
    let pose = |body: BodyId| scene.bodies[body.0].pose;
    let off = (pose(joint.parent) * zero_pose(joint)).inv_mul(&pose(joint.child));
    off.translation.vector.norm() < 1e-9 && off.rotation.angle() < 1e-9
}
