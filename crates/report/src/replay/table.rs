//! CSV table of a recording: one line per frame, about a millisecond apart; units in the header. `bend` is the
//! deflection of a finger.

use input::units::MM;
use insertion::Recording;
use insertion::trial::record::Frame;

const HEADER: &str = "time_s,phase,force_n,force_x_n,force_y_n,force_z_n,depth_mm,tilt_deg,slip_mm,\
    tip_x_mm,tip_y_mm,tip_z_mm,finger_minus_y_bend_y_mm,finger_minus_y_bend_z_mm,\
    finger_plus_y_bend_y_mm,finger_plus_y_bend_z_mm,contact_points";

/// Returns the recording as CSV.
pub fn csv(recording: &Recording) -> String {
    let row = |frame: &Frame| {
        let phase = phase(recording, frame.time_s).replace(['"', ',', '\n'], " ");
        let (f, tip) = (frame.force, frame.poses.plug.translation.vector / MM);
        let [[_, ly, lz], [_, ry, rz]] = [0, 1].map(|finger| frame.deflection_mm(finger));
        let (depth, tilt, slip) = (frame.depth_mm(), frame.tilt_deg(), frame.slip / MM);
        let numbers = [f.norm(), f.x, f.y, f.z, depth, tilt, slip, tip.x, tip.y, tip.z];
        let numbers = [&numbers[..], &[ly, lz, ry, rz]].concat();
        let numbers: String = numbers.iter().map(|number| format!("{number:.4},")).collect();
        format!("{:.4},{phase},{numbers}{}\n", frame.time_s, frame.contacts.len())
    };
    HEADER.to_owned() + "\n" + &recording.frames.iter().map(row).collect::<String>()
}

/// Returns the name of the phase at a time; after the last phase, its name.
fn phase(recording: &Recording, time_s: f64) -> &str {
    let phases = &recording.trial.phases;
    let now = phases.iter().find(|phase| time_s <= phase.time_s + 1e-9).or(phases.last());
    now.map_or("", |phase| &phase.name)
}
