//! Explanation of the trial at the nominal start, and a warning of a weak grip.

use super::body::ConvexBody;
use input::units::{DEG, MM};
use insertion::outcome::STOP_REMEDY;
use insertion::trial::PhaseEnd;
use insertion::trial::cell::GRAVITY;
use insertion::{FailureClass, Outcome, Stage, Task, Trial};

/// Explains the outcome of a trial in plain words, with advice.
pub fn explain(task: &Task, trial: &Trial) -> String {
    let slip = format!("slip {:.1} mm, allowed {:.1}", trial.slip_mm, task.grip.slip_limit / MM);
    match trial.outcome {
        // Pressed on the rim, which stops a robot, too.
        Outcome::Failed(FailureClass::PlugMissed) => missed(task, trial),
        Outcome::Failed(_) if trial.robot_stopped => format!("the robot stopped: {STOP_REMEDY}"),
        Outcome::Inserted => format!(
            "inserted {:.1} mm deep, {:.1} degrees off; required: {:.1} mm and {:.1} degrees",
            trial.depth_mm,
            trial.tilt_deg,
            task.success.depth / MM,
            task.success.tilt / DEG
        ),
        Outcome::Diverged => {
            "the simulation diverged, with half the time step as well: look for parts that overlap at the \
             start, and for extreme masses"
                .to_owned()
        }
        Outcome::Failed(FailureClass::ContactLossBeforeSearch) => format!(
            "the fingers lost the plug before it reached the socket ({slip}): raise grip.force_n ({} N) \
             or friction.finger_plug, and check grip.faces_y_mm and plug.mass_g",
            task.grip.force
        ),
        Outcome::Failed(FailureClass::Jammed) => jammed(task, trial),
        Outcome::Failed(FailureClass::ContactLossInInsertion) => {
            let phase = trial.phases.last().map_or("the search", |phase| &*phase.name);
            format!(
                "the plug left the grasp during `{phase}` ({slip}): try shorter moves, less preload_mm or \
                 more grip.force_n, or grip a larger face"
            )
        }
    }
}

/// Returns the ends of the search phases of a trial.
fn search<'a>(task: &'a Task, trial: &'a Trial) -> impl Iterator<Item = &'a PhaseEnd> {
    let phases = &task.strategy.phases;
    let of_search = |end: &&PhaseEnd| {
        phases.iter().any(|phase| phase.name == end.name && phase.stage == Stage::Search)
    };
    trial.phases.iter().filter(of_search)
}

/// Returns a warning if the friction of the pads is less than the weight of the plug, or than its friction on the rim in
/// the search of this trial. The roofs transmit the mating force.
pub fn weak_grip(task: &Task, trial: &Trial) -> Option<String> {
    let pressed = search(task, trial).map(|phase| phase.peak_force_n).fold(0.0, f64::max);
    let loads = [
        (task.plug.mass * GRAVITY, "weight of the plug"),
        (task.friction.plug_socket * pressed, "friction of the plug on the rim"),
    ];
    let (load, name) = loads.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let per_newton = 2.0 * task.friction.finger_plug;
    let (force, least) = (task.grip.force, (10.0 * load / per_newton).ceil() / 10.0);
    (per_newton * force < load).then(|| {
        format!(
            "grip.force_n: with {force} N the friction of the two pads is {:.2} N, less than {load:.2} N, \
             the {name}; give at least {least:.1} N",
            per_newton * force
        )
    })
}

/// Explains why the plug missed the opening.
fn missed(task: &Task, trial: &Trial) -> String {
    let plug = ConvexBody::plug(&task.plug);
    // Lowest point of the tip at the end of each search phase, mm.
    let lowest = |phase: &PhaseEnd| {
        let edge = plug.lowest(&phase.poses.plug)?;
        Some((phase.name.clone(), edge.coords / MM))
    };
    let edges: Vec<_> = search(task, trial).filter_map(lowest).collect();
    let [low, high] = task.opening[1].map(|y| y / MM);
    let Some((name, edge)) = edges.last() else {
        return "the plug never entered the opening".to_owned();
    };
    let below = edges.iter().map(|(_, edge)| -edge.z).fold(f64::NEG_INFINITY, f64::max);
    let y = edge.y;
    if (low..=high).contains(&y) {
        return format!(
            "the tip's lower edge was over the opening (y = {y:.1} mm at the end of `{name}`) but only \
             {below:.2} mm below the top: raise preload_mm of the touch, or extend the moves along x to \
             both sides of the opening"
        );
    }
    format!(
        "the tip's lower edge never entered the opening: at the end of `{name}` it is at y = {y:.1} mm, \
         the opening reaches from {low:.1} to {high:.1} mm; move y of strategy.start_mm or the move along y"
    )
}

/// Explains why the plug jammed.
fn jammed(task: &Task, trial: &Trial) -> String {
    let (depth, tilt) = (task.success.depth / MM, task.success.tilt / DEG);
    let at = format!("it stops {:.1} mm deep, {:.1} degrees off", trial.depth_mm, trial.tilt_deg);
    match (trial.depth_mm >= depth, trial.tilt_deg <= tilt) {
        (true, false) => format!(
            "{at}: deep enough, but more than success.tilt_deg = {tilt:.1} degrees; push further \
             (move_mm of the last phase) or raise success.tilt_deg to the tilt that the clearance allows"
        ),
        (true, true) => format!(
            "{at}: deep and upright, but its tip is beside the opening; check \
             socket.opening_x_mm and socket.opening_y_mm"
        ),
        (false, true) => format!(
            "{at}: upright, but {depth:.1} mm are required; the push is too short or blocked: \
             check move_mm of the last phase, and look for an obstacle (--svg)"
        ),
        (false, false) if trial.tilt_deg > tilt + 5.0 => format!(
            "{at} of {depth:.1} mm: it tipped over and jammed; try less overshoot in the moves along y, a \
             smaller strategy.tilt_deg, a softer finger, or more clearance"
        ),
        (false, false) => format!(
            "{at} of {depth:.1} mm: it jammed between the walls; try a smaller strategy.tilt_deg, less \
             friction.plug_socket, or a slower push"
        ),
    }
}
