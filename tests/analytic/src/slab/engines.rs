//! Engines of the comparison, by the stiffness of their contacts.

use contact::Engine;
use contact::direct::Direct;
use contact::rapier::Rapier;

/// Returns the engine of a name with contacts that are stiffer by a factor, and as finer steps as they
/// need; none for an unknown name.
///
/// `direct` and MuJoCo have a stiffness, 0.55 N/um for each contact point. rapier has a natural
/// frequency, so that stiffness scales with its square.
pub fn engine(name: &str, stiffer: f64) -> Option<Box<dyn Engine>> {
    let root = stiffer.sqrt();
    match name {
        "direct" => {
            let usual = Direct::default();
            let contact_stiffness = stiffer * usual.contact_stiffness;
            Some(Box::new(Direct { contact_stiffness, step_s: usual.step_s / root, ..usual }))
        }
        "rapier" => {
            let usual = Rapier::default();
            let contact_hz = root * usual.contact_hz;
            Some(Box::new(Rapier { contact_hz, step_s: usual.step_s / root, ..usual }))
        }
        #[cfg(feature = "mujoco")]
        "mujoco" => {
            let mut engine = contact::mujoco::Mujoco::default();
            engine.settings.contact_stiffness *= stiffer;
            engine.settings.step_s /= root;
            // A slab, which cannot tip, needs no more than one point.
            engine.settings.multiccd = false;
            Some(Box::new(engine))
        }
        _ => None,
    }
}
