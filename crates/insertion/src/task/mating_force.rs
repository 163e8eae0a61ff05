//! Mating force: friction of the connector's contact springs along the axis of insertion.

use input::units::MM;
use input::units::read::mm;
use input::{Check, InputError, shown};
use serde::Deserialize;

/// Force of the contact springs on the plug as a function of depth: pairs of depth of the tip, m, ascending, and
/// force, N.
///
/// The force is measured while a connector is mated slowly (EIA-364-13, "Mating and unmating force
/// test procedure for electrical connectors"). Springs press on the plug's sides, so that most of it is friction: it
/// opposes the axial velocity in either direction, and holds a plug at rest (Coulomb; Holm 1967, Electric
/// Contacts). Centring by the springs, and a lower unmating force, are not modelled.
pub type MatingForce = Vec<[f64; 2]>;

/// Table `[mating_force]` of a task file; SI units.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub struct RawMatingForce {
    #[serde(rename = "depth_mm", deserialize_with = "mm")]
    depth: Vec<f64>,
    #[serde(rename = "force_n")]
    force: Vec<f64>,
}

/// Converts the table; checks that there is a force for each depth, and that the depths ascend.
pub fn mating_force(check: Check<'_>, raw: RawMatingForce) -> Result<MatingForce, InputError> {
    let RawMatingForce { depth, force } = raw;
    if depth.is_empty() || depth.len() != force.len() {
        let (values, depths) = (force.len(), depth.len());
        let problem = format!(
            "has {values} values for {depths} depths; there must be one for each, and at least one"
        );
        return check.fail("mating_force.force_n", problem);
    }
    if let Some(pair) = depth.windows(2).find(|pair| pair[0] >= pair[1]) {
        let [upper, lower] = [pair[0], pair[1]].map(|depth| shown(depth / MM));
        let problem = format!("{lower} follows {upper}; depths must ascend");
        return check.fail("mating_force.depth_mm", problem);
    }
    Ok(depth.into_iter().zip(force).map(<[f64; 2]>::from).collect())
}

#[cfg(test)]
mod tests {
    use crate::outcome::{FailureClass, Outcome};
    use crate::task::Task;
    use crate::tests::fixtures::{finger, refused, rig, task, task_file};
    use crate::trial::{Grasp, Rig, Trial};
    use input::InputError;
    use input::units::MM;

    fn parsed(table: &str) -> Result<Task, InputError> {
        Task::parse(&format!("{}\n[mating_force]\n{table}\n", task_file("usb").text), "usb.toml")
    }

    /// Trial of usb with springs of a force, N, in a grasp that bears 1 mm of slip.
    fn pushed(force: f64) -> Trial {
        let mut task = task("usb");
        task.mating_force = Some(vec![[0.0, 0.0], [MM, force]]);
        task.grip.slip_limit = MM;
        rig(task).grasp(Grasp::of(&finger(2.2, 55.0))).trial(0.0)
    }

    #[test]
    fn unknown_keys_unsorted_depths_and_missing_forces_are_refused() {
        assert!(parsed("depth_mm = [0, 2, 6]\nforce_n = [0, 12, 8]").is_ok());
        for (table, key, problem) in [
            ("depth_mm = [0, 6, 2]\nforce_n = [0, 12, 8]", "depth_mm", "2 follows 6"),
            ("depth_mm = [0, 2, 2]\nforce_n = [0, 12, 8]", "depth_mm", "2 follows 2"),
            ("depth_mm = [0, 2]\nforce_n = [0, 12, 8]", "force_n", "3 values for 2 depths"),
            ("depth_mm = []\nforce_n = []", "force_n", "0 values for 0 depths"),
            ("depth_mm = [0, 2]\nforce_n = [0, -12]", "force_n", "-12"),
            ("depth_mm = [0, 2]\nforce_n = [0, 12]\nside_n = 1", "side_n", "unknown"),
        ] {
            refused(parsed(table), &[key, problem, "usb.toml"]);
        }
    }

    #[test]
    fn springs_beyond_the_friction_of_the_pads_push_the_plug_out_of_the_grasp() {
        let [free, light, heavy] = [0.0, 10.0, 40.0].map(pushed);
        assert_eq!([free.outcome, light.outcome], [Outcome::Inserted; 2]);
        assert!(light.peak_force_n > free.peak_force_n, "{light:?}");
        assert!(light.depth_mm < free.depth_mm, "{light:?}");
        assert_eq!(heavy.outcome, Outcome::Failed(FailureClass::ContactLossInInsertion));
    }
}
