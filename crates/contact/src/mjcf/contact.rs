//! Contact pairs: friction, and the compliance of a contact point in MuJoCo's terms.
//!
//! MuJoCo solves for the force `f` and the normal acceleration `a` of a contact point (positive if the surfaces
//! separate) with `R f = -k x - b v - a`: `x` is the gap, `v` its rate, `R = A (1 - d)/d` with the impedance `d`, and
//! `A` the inverse mass that MuJoCo assigns to the pair (Todorov 2014, ICRA; MuJoCo documentation, "Solver
//! parameters"). So a contact is a spring `k/R`, a damper `b/R` and an added mass `1/R`. With one `d` for all pairs, as
//! usual, the same `solref` is a hundred times stiffer on a steel key than on a fingertip. Here the `d` of every pair
//! makes `R`, and so stiffness and damping, the same, whatever the masses.
//!
//! The tangential equations (friction) have `R/impratio` and a `b` of their own, `b_f`: a sticking point creeps under a
//! force `F` at `F R/(impratio b_f)`. A sliding point floats: the convex friction cone lifts it until `k x = mu b_f v`
//! (contact is then intermittent, with the right mean force), so `b_f` must be small. With MuJoCo's choice, `b_f = b`,
//! a plug that slides at 100 mm/s with friction 0.2 would float at 0.055 mm, near a connector's clearance; here at
//! 0.011 mm.

use super::body::margin;
use super::{HEAVY, MjcfSettings, geom_names, xml::Element};
use crate::scene::{
    Body, BodyId, ContactPair, Friction, GeomPair, Inertia, Joint, Motion, Pose, Scene, Spring,
    Springs, Torsion,
};
use nalgebra::{DMatrix, Matrix3, Point3, Vector3, Vector6};

/// Penetration over which an impedance may vary, m (`width` of `solimp`); here it is constant.
const WIDTH: f64 = 1e-3;
/// Smallest and largest impedance in MuJoCo.
const IMPEDANCES: [f64; 2] = [1e-4, 0.9999];

/// Returns the `contact` element with the pairs of geoms that may touch.
pub(super) fn pairs(scene: &Scene, settings: &MjcfSettings) -> Element {
    let names = geom_names(scene).concat();
    let margins: Vec<_> =
        scene.bodies.iter().flat_map(|body| &body.geoms).map(|geom| margin(&geom.shape)).collect();
    let pair = |pair: GeomPair| {
        let ContactPair { first, second, .. } = scene.contacts[pair.bodies];
        let weight = inverse_weight(scene, first) + inverse_weight(scene, second);
        // Solves `R = 1/contact_mass` for `d`: `A/R = d/(1 - d)`.
        let share = settings.contact_mass * weight;
        let impedance = (share / (1.0 + share)).clamp(IMPEDANCES[0], IMPEDANCES[1]);
        // MuJoCo divides both by the impedance.
        let scale = impedance / settings.contact_mass;
        let solref = [settings.contact_stiffness, settings.contact_damping].map(|by| -by * scale);
        // Friction has no gap, so its stiffness has no effect; MuJoCo requires a negative number.
        let friction = [solref[0], -settings.friction_rate * impedance];
        let element = Element::new("pair").with("geom1", &names[pair.first]);
        let margin = margins[pair.first] + margins[pair.second];
        let element = if margin == 0.0 { element } else { element.with("margin", margin) };
        with_friction(element.with("geom2", &names[pair.second]), pair.friction)
            .numbers("solref", solref)
            .numbers("solreffriction", friction)
            .numbers("solimp", [impedance, impedance, WIDTH])
    };
    Element::new("contact").with_children(scene.geom_pairs().into_iter().map(pair))
}

/// Adds the friction of a pair.
fn with_friction(pair: Element, Friction { coefficient, torsion }: Friction) -> Element {
    if coefficient <= 0.0 {
        return pair.with("condim", 1);
    }
    match torsion {
        // A moment about the normal of at most the radius times the friction force.
        Torsion::Radius(radius) if radius > 0.0 => pair
            .with("condim", 4)
            .numbers("friction", [coefficient, coefficient, coefficient * radius]),
        _ => pair.with("condim", 3).numbers("friction", [coefficient; 2]),
    }
}

/// Returns the inverse mass that MuJoCo assigns to a body, 1/kg: the mean over the three axes of the inverse mass at
/// its centre of mass; 0 along a locked axis of its joint, unless the parent is free and not on a joint itself.
pub(super) fn inverse_weight(scene: &Scene, body: BodyId) -> f64 {
    let Body { motion, .. } = &scene.bodies[body.0];
    let inertia = match motion {
        Motion::Fixed | Motion::Mechanism(_) => return 0.0,
        Motion::Driven => return 1.0 / HEAVY,
        Motion::Free(inertia) | Motion::Carried(inertia) => inertia,
    };
    let alone = 1.0 / inertia.mass;
    let joint = scene.joints.iter().find(|joint| joint.child == body);
    let Some(joint) = joint else { return alone };
    let Springs::Axes(axes) = &joint.springs else { return alone };
    let free = axes[..3].iter().flatten().count();
    let parent_is_root = !scene.joints.iter().any(|other| other.child == joint.parent);
    match scene.bodies[joint.parent.0].motion {
        Motion::Free(parent) | Motion::Carried(parent) if free < 3 && parent_is_root => {
            on_free_body(scene, joint, axes, [&parent, inertia])
        }
        _ => free as f64 / 3.0 / inertia.mass,
    }
}

/// Returns the inverse mass of a body on a joint of a free body (a latch on its plug): the mean over the axes of
/// `J M^-1 J^T`, `M` the mass matrix in the velocity of the parent and the rates of the free axes.
fn on_free_body(
    scene: &Scene,
    joint: &Joint,
    axes: &[Option<Spring>; 6],
    [parent, child]: [&Inertia; 2],
) -> f64 {
    let [above, below] = [joint.parent, joint.child].map(|body| scene.bodies[body.0].pose);
    let at = below * child.centre;
    let frame = above * joint.in_parent;
    // Columns: velocity at the child's centre of mass and angular velocity, first for those of the parent, then for the
    // rate of each free axis.
    let free = (0..6).filter(|&i| axes[i].is_some());
    let column = |i: usize| {
        let axis = frame.rotation * Vector3::ith(i % 3, 1.0);
        let arm = at.coords - frame.translation.vector;
        let [linear, angular] =
            if i < 3 { [axis, Vector3::zeros()] } else { [axis.cross(&arm), axis] };
        Vector6::new(linear.x, linear.y, linear.z, angular.x, angular.y, angular.z)
    };
    let moved = (0..6).map(|i| Vector6::ith(i, 1.0));
    let columns: Vec<Vector6<f64>> = moved.chain(free.map(column)).collect();
    let rates = DMatrix::from_fn(6, columns.len(), |row, i| columns[i][row]);
    let mut mass = rates.transpose() * mass_matrix(&below, child, &at) * &rates;
    let own = mass_matrix(&above, parent, &at);
    mass.view_mut((0, 0), (6, 6)).zip_apply(&own, |sum, more| *sum += more);
    let linear = rates.rows(0, 3).transpose();
    // Inertias are positive, so the factorization succeeds.
    let answer = mass.cholesky().map(|factor| factor.solve(&linear));
    answer.map_or(0.0, |answer| (rates.rows(0, 3) * answer).trace() / 3.0)
}

/// Returns the mass matrix of a body for the linear velocity of a point on it and the angular velocity.
fn mass_matrix(pose: &Pose, inertia: &Inertia, at: &Point3<f64>) -> DMatrix<f64> {
    let arm = (pose * inertia.centre - at).cross_matrix();
    let turn = pose.rotation.to_rotation_matrix().into_inner();
    let about = turn * Matrix3::from_diagonal(&inertia.moments) * turn.transpose();
    let mut matrix = DMatrix::zeros(6, 6);
    matrix.view_mut((0, 0), (3, 3)).copy_from(&(Matrix3::identity() * inertia.mass));
    matrix.view_mut((0, 3), (3, 3)).copy_from(&(-arm * inertia.mass));
    matrix.view_mut((3, 0), (3, 3)).copy_from(&(arm * inertia.mass));
    matrix.view_mut((3, 3), (3, 3)).copy_from(&(about - arm * arm * inertia.mass));
    matrix
}
