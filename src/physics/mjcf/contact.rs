//! Contact pairs: friction, and the give of a contact point in MuJoCo's terms.
//!
//! MuJoCo solves for the acceleration `a` of a contact point (along its normal,
//! apart) and the force `f` with `R f = -k x - b v - a`: `x` is the gap, `v` its
//! rate, `R = A (1 - d)/d` with the impedance `d`, and `A` the inverse mass that
//! MuJoCo itself gives the pair (Todorov 2014, ICRA; MuJoCo documentation,
//! "Solver parameters"). So a contact is a spring `k/R` and a damper `b/R`, and
//! a mass `1/R` that is felt only while the surfaces move against each other.
//! With one `d` for all pairs, as is the custom, the same `solref` is a hundred
//! times stiffer on a steel key than on a fingertip. Here every pair gets the
//! `d` that makes `R` the same, and so the same stiffness and damping, whatever
//! the masses.
//!
//! The friction rows have `R/impratio` and a `b` of their own, `b_f`: a sticking
//! point creeps under a force `F` at `F R/(impratio b_f)`. A sliding one floats:
//! the convex cone lifts it until `k x = mu b_f v` (the surfaces then touch on and
//! off, with the right force on average), so `b_f` must be small. With MuJoCo's
//! choice, `b_f = b`, a plug that slides at 100 mm/s with friction 0.2 would
//! float at 0.055 mm, near a connector's clearance; here at 0.011 mm.

use super::{HEAVY, MjcfSettings, geom_names, xml::Element};
use crate::scene::{
    Body, BodyId, ContactPair, Friction, GeomPair, JointAxis, Motion, Scene, Springs, Torsion,
};

/// Depth over which MuJoCo lets an impedance vary, m; ours does not.
const WIDTH: f64 = 1e-3;
/// The impedances that MuJoCo can represent.
const IMPEDANCES: [f64; 2] = [1e-4, 0.9999];

/// How much harder than the normal a sticking point is held; one number for all pairs.
pub(super) fn impratio(settings: &MjcfSettings) -> f64 {
    settings.stick_damping / (settings.friction_rate * settings.contact_mass)
}

/// All pairs of geoms that may touch.
pub(super) fn pairs(scene: &Scene, settings: &MjcfSettings) -> Element {
    let names = geom_names(scene).concat();
    let pair = |pair: GeomPair| {
        let ContactPair { first, second, .. } = scene.contacts[pair.bodies];
        let weight = inverse_weight(scene, first) + inverse_weight(scene, second);
        let element = Element::new("pair").with("geom1", &names[pair.first]);
        let element = element.with("geom2", &names[pair.second]);
        soft(rough(element, pair.friction), weight, settings)
    };
    Element::new("contact").holding(scene.geom_pairs().into_iter().map(pair))
}

/// A pair with its friction.
fn rough(pair: Element, Friction { coefficient, torsion }: Friction) -> Element {
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

/// Stiffness and damping of two geoms of bodies of this inverse mass, 1/kg.
fn soft(pair: Element, weight: f64, settings: &MjcfSettings) -> Element {
    let share = settings.contact_mass * weight;
    let impedance = (share / (1.0 + share)).clamp(IMPEDANCES[0], IMPEDANCES[1]);
    // MuJoCo divides both by the impedance.
    let scale = impedance / settings.contact_mass;
    let solref = [settings.contact_stiffness, settings.contact_damping].map(|by| -by * scale);
    // Friction knows no gap; its stiffness only has to be negative, too.
    let friction = [solref[0], -settings.friction_rate * impedance];
    pair.numbers("solref", solref)
        .numbers("solreffriction", friction)
        .numbers("solimp", [impedance, impedance, WIDTH])
}

/// The inverse mass that MuJoCo gives a body, 1/kg: the mean over the three
/// axes of the inverse mass at its centre of mass, which an axis that is locked to
/// the parent is taken to have none of.
pub(super) fn inverse_weight(scene: &Scene, body: BodyId) -> f64 {
    let Body { motion, .. } = &scene.bodies[body.0];
    let inertia = match motion {
        Motion::Fixed | Motion::Mechanism(_) => return 0.0,
        Motion::Driven => return 1.0 / HEAVY,
        Motion::Free(inertia) | Motion::Carried(inertia) => inertia,
    };
    let joint = scene.joints.iter().find(|joint| joint.child == body);
    let free = match joint.map(|joint| &joint.springs) {
        Some(Springs::Axes(axes)) => {
            axes[..3].iter().filter(|axis| matches!(axis, JointAxis::Sprung(_))).count()
        }
        Some(Springs::Coupled(_)) | None => 3,
    };
    free as f64 / 3.0 / inertia.mass
}
