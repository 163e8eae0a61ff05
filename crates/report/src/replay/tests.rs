//! Page and plot of synthetic recordings.

use super::*;
use ask_tell::statistics::span;
use contact::ContactPoint;
use contact::scene::Pose;
use input::shipped::TASKS;
use input::units::MM;
use insertion::task::Solid;
use insertion::trial::record::Frame;
use insertion::trial::{PhaseEnd, Poses};
use insertion::{FailureClass, Outcome, Stage, Trial};
use nalgebra::{Point3, Vector3};

pub fn task() -> Task {
    Task::parse(TASKS[0].text, TASKS[0].file).unwrap()
}

/// Returns a recording of a plug that sinks by 10 mm in a second under a force that grows to 20 N.
pub fn recording() -> Recording {
    let frame = |i: u32| {
        let time_s = f64::from(i) * 1e-3;
        let plug = Pose::translation(0.0, 0.0, -10.0 * MM * time_s);
        let force = Vector3::new(0.0, 0.0, 20.0 * time_s);
        Frame {
            time_s,
            stage: Stage::Assembly,
            poses: Poses { plug, latch: None, fingers: [plug; 2] },
            jaws: [plug * Pose::translation(0.0, 0.5 * MM, 0.0); 2],
            force,
            slip: 0.0,
            contacts: vec![ContactPoint { point: Point3::origin(), force }],
            grips: Vec::new(),
        }
    };
    let frames: Vec<Frame> = (0..=1000).map(frame).collect();
    let end = PhaseEnd {
        name: "</script><script>alert(1)</script>".to_owned(),
        time_s: 1.0,
        tip_mm: [0.0, 0.0, -10.0],
        tilt_deg: 0.0,
        slip_mm: 0.0,
        peak_force_n: 20.0,
        poses: frames[0].poses,
        contacts: Vec::new(),
    };
    let trial = Trial {
        outcome: Outcome::Failed(FailureClass::Jammed),
        margin: -0.1,
        depth_mm: 10.0,
        tilt_deg: 0.0,
        peak_force_n: 20.0,
        slip_mm: 0.0,
        robot_stopped: true,
        phases: vec![end],
        simulated_s: 1.0,
        retried: false,
    };
    Recording { trial, frames, decided_s: 1.0 }
}

fn film<'a>(label: &'a str, task: &'a Task, recording: &'a Recording) -> Film<'a> {
    Film { label, task, pad: &Pad::PUBLISHED, recording }
}

#[test]
fn a_page_contains_its_films_and_loads_nothing() {
    let (task, recording) = (task(), recording());
    let film = film("</title><script>", &task, &recording);
    let page = page("\"</title><script>alert(1)</script>", &[film, film]);
    assert_eq!(page.matches("<script").count(), 2, "the data and the viewer");
    assert_eq!(page.matches("\"label\":").count(), 2);
    assert_eq!(data(&page).map(|data| data.matches("\"label\":").count()), Some(2));
    assert!(
        page.contains("failed: jammed (class 3), robot stop at a limit")
            && page.contains("default-src 'none'")
    );
    assert!(page.len() < 600_000, "{} bytes", page.len());
}

/// The slider ends at the last frame, whose rounded time must not be before that of the outcome.
#[test]
fn the_last_frame_has_the_outcome() {
    let (task, mut recording) = (task(), recording());
    recording.decided_s = 1.000_04;
    recording.frames.last_mut().unwrap().time_s = recording.decided_s;
    let json = film::data(&film("a", &task, &recording));
    let times = json["time"].as_array().unwrap();
    assert!(times[times.len() - 1].as_f64() >= json["decided_s"].as_f64(), "{json}");
}

#[test]
fn the_axes_of_the_plot_have_units() {
    let (task, recording) = (task(), recording());
    let svg = curve_svg(&film("a", &task, &recording)).unwrap();
    assert!(svg.contains("force plug to socket (N)") && svg.contains("top (mm)"));
}

/// The shipped plugs have no gap along z.
#[test]
fn a_gap_between_the_parts_of_a_plug_is_drawn_as_a_link() {
    let (mut task, recording) = (task(), recording());
    let links = |task: &Task| -> Vec<serde_json::Value> {
        let json = film::data(&film("a", task, &recording));
        let bodies = json["bodies"].as_array().unwrap().iter();
        bodies.filter(|body| body["kind"] == "link").map(|body| body["points"].clone()).collect()
    };
    assert!(links(&task).is_empty());
    let part = |name: &str, min: [f64; 3], max: [f64; 3]| insertion::Part {
        name: name.to_owned(),
        solid: Solid::Box { min: Vector3::from(min) * MM, max: Vector3::from(max) * MM },
        friction: None,
    };
    let grip = part("grip", [-2.0, -6.0, 40.0], [2.0, 6.0, 43.0]);
    task.plug.parts = vec![grip, part("body", [-3.0, -4.0, 0.0], [1.0, 8.0, 32.0])];
    task.plug.latch = None;
    let links = links(&task);
    let points: Vec<f64> =
        links[0].as_array().unwrap().iter().map(|mm| mm.as_f64().unwrap()).collect();
    let along = |axis: usize| span(points.iter().skip(axis).step_by(3));
    assert_eq!((links.len(), [0, 1, 2].map(along)), (1, [[-2.0, 1.0], [-4.0, 6.0], [32.0, 40.0]]));
}
