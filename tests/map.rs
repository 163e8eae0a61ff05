//! Capture maps of the contact simulation: against the window and their mirror images.

use crate::common::shipped::{self, rig, task};
use analysis::map::{Axes, CaptureMap, Plane};
use insertion::evaluation::tolerance::{Search, evaluate};
use insertion::finger::Finger;
use insertion::outcome::Outcome;
use insertion::space::Design;
use insertion::task::{Solid, Task};
use insertion::trial::Grasp;
use insertion::trial::run::EngineRig;

fn finger() -> Finger {
    shipped::finger(1.2, 52.4)
}

fn map(rig: &EngineRig) -> CaptureMap {
    let plane = Plane::new(rig, Grasp::of(&finger()), Axes::YX);
    CaptureMap::trace(&rig.task.name, Design::default(), &plane, &|| ())
}

fn inserts(map: &CaptureMap, [y, x]: [f64; 2]) -> bool {
    // Beyond the map nothing inserts.
    let place = |value: f64, axis: usize| {
        let axis = &map.axes[axis];
        let within = (axis.low..=axis.high).contains(&value);
        within.then(|| ((value - axis.low) / axis.step).round() as usize)
    };
    let mark = place(y, 0).zip(place(x, 1)).map(|(y, x)| map.outcomes[x][y]);
    mark.is_some_and(|mark| mark.0 == Outcome::Inserted)
}

/// Everything on the other side of x = 0 or y = 0.
fn mirrored(mut task: Task, axis: usize) -> Task {
    let turned = |[low, high]: [f64; 2]| [-high, -low];
    for part in task.plug.parts.iter_mut().chain(&mut task.socket) {
        let Solid::Box { min, max } = &mut part.solid else { panic!("not a box") };
        [min[axis], max[axis]] = turned([min[axis], max[axis]]);
    }
    task.opening[axis] = turned(task.opening[axis]);
    task.strategy.start[axis] *= -1.0;
    for phase in &mut task.strategy.phases {
        phase.displacement[axis] *= -1.0;
    }
    if axis == 1 {
        task.grip.faces_y = turned(task.grip.faces_y);
        task.strategy.tilt *= -1.0;
    }
    task
}

/// The stretch along y holds the window, and a mirrored task has the mirrored map.
#[test]
fn a_map_holds_the_window_and_its_mirror_image_is_that_of_the_mirrored_task() {
    let task = task("ket8");
    let rig_of_it = rig(task.clone(), "servo");
    let original = map(&rig_of_it);
    let window = evaluate(&rig_of_it, &finger(), Search::Walk).window;
    let [low, high] = original.window_mm().unwrap();
    let off = [low - window.negative_mm(), high - window.positive_mm()];
    assert!(off.iter().all(|off| off.abs() <= 0.25), "{off:?} mm of {window:?}");
    for axis in [0, 1] {
        let other = map(&rig(mirrored(task.clone(), axis), "servo"));
        let mut differ = 0;
        for y in -40..=40 {
            for x in -20..=20 {
                let at = [y, x].map(|step| f64::from(step) * 0.25);
                let mut across = at;
                across[1 - axis] *= -1.0;
                differ += usize::from(inserts(&original, at) != inserts(&other, across));
            }
        }
        // Rounding is not mirrored.
        assert!(differ <= 4, "mirrored along {axis}: {differ} places differ");
    }
}
