//! The contact simulation on the four shipped tasks: does the physics hold, not the code.

use crate::common::shipped::{finger, rig, robot, task};
use crate::common::{read, root};
use contact::direct::Direct;
use contact::rapier::Rapier;
use contact::scene::{
    Body, BodyId, Friction, Geom, Inertia, Joint, Motion, Pose, Scene, Shape, Springs,
};
use contact::{Engine, World};
use finger_opt::command::parse;
use finger_opt::commands::evaluate;
use finger_opt::context::Context;
use finray::printed::PrintedFinger;
use input::shipped::{FINGERS, STIFFNESS, Shipped, TASKS, UNCERTAINTIES};
use input::units::{DEG, MM};
use insertion::evaluation::robustness::{self, Plan};
use insertion::evaluation::tolerance::{Search, evaluate};
use insertion::evaluation::uncertainty::Uncertainty;
use insertion::finger::Finger;
use insertion::finger::file::FingerFile;
use insertion::finger::model::{ComputedFingers, FingerSource};
use insertion::outcome::{FailureClass, Outcome};
use insertion::space::Design;
use insertion::stiffness;
use insertion::surrogate::{self, Prediction};
use insertion::task::finger::Coupling;
use insertion::task::{PadTorsion, Task};
use insertion::trial::cell;
use insertion::trial::run::EngineRig;
use insertion::trial::{Conditions, Grasp, NEVER, PhaseEnd, Rig, Trial, picture};
use nalgebra::Vector3;
use rayon::prelude::*;

/// A shipped task on the robot `servo` in the engine `direct`.
fn direct(name: &str) -> EngineRig {
    rig(task(name), "servo")
}

/// The end of a trial's phase of that name.
fn phase<'a>(trial: &'a Trial, name: &str) -> &'a PhaseEnd {
    trial.phases.iter().find(|phase| phase.name == name).unwrap()
}

fn trial(rig: &EngineRig, finger: &Finger, offset_mm: f64) -> Trial {
    rig.grasp(Grasp::of(finger)).trial(offset_mm * MM)
}

/// Whole steps through the impacts on the rim hold the key in the grasp; it then turns on the rim and jams.
#[test]
fn a_round_key_that_meets_the_rim_at_speed_inserts_whatever_the_step() {
    for step_s in [5e-4, 6.25e-5] {
        let engine = Box::new(Direct { step_s, ..Direct::default() });
        let task = task("ket8").rounded(0.3 * MM);
        let rig = EngineRig::new(task, &robot("servo"), engine).unwrap();
        for offset_mm in [1.6, 1.9, 2.2] {
            let end = trial(&rig, &finger(1.67, 25.0), offset_mm).outcome;
            assert_eq!(end, Outcome::Inserted, "{offset_mm} mm, {step_s} s");
        }
    }
}

/// Windows of three fingers on each task; `scripts/reference.sh validation` simulates all 44.
#[test]
fn the_windows_are_the_committed_ones() {
    let table = read(&root("results/reference/validation/validation.csv"));
    let lines: Vec<&str> = table.lines().skip(1).collect();
    let designs = stiffness::representative_designs().into_iter();
    let designs: Vec<String> = designs.map(|design| design.design.to_string()).collect();
    let changed: Vec<String> = lines
        .into_par_iter()
        .filter(|line| designs.iter().any(|design| line.split(',').nth(1) == Some(design)))
        .filter_map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            let [task, _, density, direction, assembly, compliance, ..] = cells[..] else {
                panic!("{line}")
            };
            let finger = ["--density", density, "--direction", direction];
            let stiffness =
                ["--stiffness-assembly", assembly, "--stiffness-compliance", compliance];
            let words = ["--task", task, "--walk", "--no-ribs"];
            let request: evaluate::Request =
                parse([&words[..], &finger, &stiffness].concat()).ok().unwrap();
            let window =
                request.evaluated(&Context::silent(&NEVER)).ok().unwrap().evaluation.window;
            let [below, above] = [window.end_negative, window.end_positive]
                .map(|end| end.unwrap().failure().unwrap());
            let (low, high, range) =
                (window.negative_mm(), window.positive_mm(), window.range_mm());
            let found =
                format!("{},{low},{high},{range:.1},{below},{above}", window.nominal.word());
            (found != cells[6..12].join(",")).then(|| format!("{line}: now {found}"))
        })
        .collect();
    assert!(
        changed.is_empty(),
        "if physics was changed on purpose: scripts/reference.sh validation, mend \
         docs/notes/calibration.md, and say in the commit what moved them.\n{}",
        changed.join("\n")
    );
}

#[test]
fn all_measured_fingers_insert_at_each_nominal_start() {
    let measured = stiffness::parse(STIFFNESS[0].text, STIFFNESS[0].file).unwrap();
    for file in TASKS {
        let rig = direct(file.name);
        let inserts = |m: &&stiffness::Measurement| {
            let finger = Finger::new(m.compliance, m.assembly);
            trial(&rig, &finger, 0.0).outcome == Outcome::Inserted
        };
        let count = measured.iter().filter(inserts).count();
        assert_eq!(count, measured.len(), "{}", file.name);
    }
}

#[test]
fn the_arm_and_rapier_insert_all_four_plugs() {
    for Shipped { name, .. } in TASKS {
        let arm = rig(task(name), "ur5e");
        for finger in [finger(1.2, 52.4), finger(2.6, 45.0), finger(3.84, 35.0)] {
            let outcome = trial(&arm, &finger, 0.0).outcome;
            assert_eq!(outcome, Outcome::Inserted, "{name} {finger:?}");
        }
        let rapier = EngineRig::new(task(name), &robot("servo"), Box::<Rapier>::default()).unwrap();
        assert_eq!(trial(&rapier, &finger(1.2, 52.4), 0.0).outcome, Outcome::Inserted, "{name}");
    }
}

/// A flange that gives nothing meets a higher force for the same motion.
#[test]
fn a_rigid_flange_inserts_with_more_force_than_a_soft_one() {
    let peak = |robot| {
        let trial = trial(&rig(task("ket12"), robot), &finger(2.6, 45.0), 0.0);
        assert_eq!(trial.outcome, Outcome::Inserted, "{robot}");
        trial.peak_force_n
    };
    let peaks = [peak("servo"), peak("rigid")];
    assert!(peaks[1] > peaks[0] + 5.0, "{peaks:?} N");
}

#[test]
fn an_inserted_key_is_deep_upright_and_held() {
    let trial = trial(&direct("ket12"), &finger(1.2, 52.4), 0.0);
    assert_eq!(trial.outcome, Outcome::Inserted);
    assert!(trial.depth_mm > 25.0 && trial.tilt_deg < 5.0 && trial.slip_mm < 1.0, "{trial:?}");
    let names: Vec<_> = trial.phases.iter().map(|phase| phase.name.as_str()).collect();
    let order = ["grasp", "carry", "approach", "touch", "back", "front", "side", "assembly"];
    assert_eq!(names, order);
    // 5 degrees of commanded tilt, bent a little by its own weight.
    assert!((trial.phases[2].tilt_deg - 5.0).abs() < 0.1, "{:?}", trial.phases[2]);
    assert!(trial.phases.windows(2).all(|pair| pair[0].time_s < pair[1].time_s));
}

#[test]
fn each_phase_of_a_shifted_trial_ends_at_the_shifted_place() {
    let at = |offset_mm| trial(&direct("usb"), &finger(1.2, 52.4), offset_mm).phases;
    for (nominal, shifted) in at(0.0).iter().zip(&at(3.0)).take(3) {
        let y = |end: &PhaseEnd| [end.tip_mm[1], end.poses.plug.translation.y / MM];
        for (from, to) in y(nominal).into_iter().zip(y(shifted)) {
            assert!((to - from - 3.0).abs() < 1e-9, "{}: {from} to {to} mm", shifted.name);
        }
    }
}

#[test]
fn far_outside_every_task_fails_and_never_diverges() {
    for file in TASKS {
        let rig = direct(file.name);
        let grasped = rig.grasp(Grasp::of(&finger(3.0, 30.0)));
        for offset_mm in [-12.0, 12.0] {
            let outcome = grasped.trial(offset_mm * MM).outcome;
            let Outcome::Failed(class) = outcome else { panic!("{}: {outcome:?}", file.name) };
            // A key set down beside its slot is missed.
            assert!((file.name, offset_mm) != ("ket8", 12.0) || class == FailureClass::PlugMissed);
        }
    }
}

#[test]
fn jaws_without_force_lose_the_part_before_the_search() {
    let mut rig = direct("ket12");
    rig.task.grip.force = 0.05;
    let outcome = trial(&rig, &finger(1.2, 52.4), 0.0).outcome;
    assert_eq!(outcome, Outcome::Failed(FailureClass::ContactLossBeforeSearch));
}

#[test]
fn a_socket_that_is_too_narrow_is_not_entered() {
    let mut rig = direct("ket8");
    // The key grows by 0.3 mm in y; the slot has 0.15 mm to spare.
    for part in &mut rig.task.plug.parts {
        if let insertion::task::Solid::Box { min, max } = &mut part.solid {
            min.y -= 0.15 * MM;
            max.y += 0.15 * MM;
        }
    }
    let outcome = trial(&rig, &finger(1.2, 52.4), 0.0).outcome;
    assert!(matches!(outcome, Outcome::Failed(_)), "{outcome:?}");
}

/// Why usb loses range with stiffness: the more the start is shifted to the negative side,
/// the farther the seated plug stands aside of the gripper. One finger follows it by no
/// more than the grasp force has bent it, F/k; beyond that only the other pushes. So a
/// stiffer finger lets go earlier, and a firmer grasp makes up for it.
#[test]
fn a_stiffer_finger_lets_go_earlier_and_a_firmer_grasp_holds_on() {
    let mut rig = direct("usb");
    let (soft, stiff) = (finger(1.2, 75.0), finger(3.0, 75.0));
    let at = |rig: &EngineRig, finger| trial(rig, finger, -1.5).outcome;
    assert_eq!(at(&rig, &soft), Outcome::Inserted);
    assert_eq!(at(&rig, &stiff), Outcome::Failed(FailureClass::ContactLossInInsertion));
    let range = |finger| evaluate(&rig, finger, Search::Strides).window.range_mm();
    assert!(range(&soft) > range(&stiff) + 1.0, "{} and {} mm", range(&soft), range(&stiff));
    rig.task.grip.force *= 2.0;
    assert_eq!(at(&rig, &stiff), Outcome::Inserted);
}

/// Why ket8 loses range with infill direction, which lowers the assembly stiffness: a
/// softer spring presses the key less deep into its slot, so the push begins with its edge
/// at the rim, and jams it there.
#[test]
fn a_finger_soft_in_assembly_presses_the_key_less_deep_and_tolerates_less() {
    let rig = direct("ket8");
    let (soft, stiff) = (finger(2.6, 25.0), finger(2.6, 75.0));
    let trials = |offset_mm: f64| [&soft, &stiff].map(|finger| trial(&rig, finger, offset_mm));
    let deep = |trial: &Trial| -phase(trial, "side").tip_mm[2];
    let inside = trials(-1.5);
    assert!(inside.iter().all(|trial| trial.outcome == Outcome::Inserted));
    let outside = trials(-2.5);
    for [soft, stiff] in [&inside, &outside].map(|[soft, stiff]| [deep(soft), deep(stiff)]) {
        assert!(soft < stiff - 0.05, "{soft} and {stiff} mm deep");
    }
    let [soft, stiff] = outside;
    assert_eq!(soft.outcome, Outcome::Failed(FailureClass::Jammed));
    // Near the rim, pushed until the robot stops.
    assert!(soft.depth_mm < 3.0 && soft.peak_force_n > 140.0, "{soft:?}");
    assert_eq!(stiff.outcome, Outcome::Inserted);
}

#[test]
fn yaw_turns_the_socket_about_its_middle_and_too_much_of_it_keeps_a_key_out() {
    let rig = direct("ket8");
    let soft = finger(1.2, 52.4);
    let at = |yaw_deg: f64| {
        let conditions = Conditions { yaw: yaw_deg * DEG, ..Conditions::NOMINAL };
        rig.grasp(Grasp { conditions, ..Grasp::of(&soft) }).trial(0.3 * MM)
    };
    assert_eq!(at(0.0), rig.grasp(Grasp::of(&soft)).trial(0.3 * MM));
    let (half, ten) = (at(0.5), at(10.0));
    assert_eq!(half.outcome, Outcome::Inserted);
    assert!(matches!(ten.outcome, Outcome::Failed(_)), "{ten:?}");
}

#[test]
fn a_part_low_in_the_gripper_is_touched_that_much_earlier() {
    let rig = direct("ket12");
    let soft = finger(1.2, 52.4);
    let touch = |grasp_low: f64| {
        let conditions = Conditions { grasp_low, ..Conditions::NOMINAL };
        phase(&rig.grasp(Grasp { conditions, ..Grasp::of(&soft) }).trial(0.0), "approach").tip_mm[2]
    };
    let lower = touch(0.0) - touch(0.3 * MM);
    assert!((lower - 0.3).abs() < 0.05, "{lower} mm");
}

/// Under drawn errors the finger with the wider window inserts more often.
#[test]
fn the_success_rate_follows_the_window() {
    let mut typical = Uncertainty::parse(UNCERTAINTIES[0].text, "typical").unwrap();
    typical.success.trials = 40;
    let plan = Plan::new(&typical, 0, true, false);
    let rig = direct("usb");
    let rate = |compliance: f64| {
        let finger = finger(compliance, 52.4);
        let predicted = Prediction::exact(finger.compliance, finger.assembly);
        let found =
            robustness::evaluate(&rig, Grasp::of(&finger), &predicted, Search::Strides, &plan, &[]);
        let success = found.success.unwrap();
        assert_eq!(success.diverged, 0);
        (found.window.range_mm(), success.rate().unwrap())
    };
    let (soft, stiff) = (rate(1.2), rate(3.84));
    assert!(soft.0 > stiff.0 + 1.0 && soft.1 > stiff.1 + 0.05, "{soft:?} and {stiff:?}");
}

/// Errors cost range: a robust range lies below the range without them, where the ends of the
/// window are firm (those of usb are not: `docs/notes/simulation.md`).
#[test]
fn a_robust_range_is_smaller_than_the_range() {
    let mut typical = Uncertainty::parse(UNCERTAINTIES[0].text, "typical").unwrap();
    typical.robust.samples = 6;
    typical.robust.search = Search::Strides;
    let plan = Plan::new(&typical, 0, false, true);
    let measured = stiffness::parse(STIFFNESS[0].text, "measured").unwrap();
    let printed = PrintedFinger::parse(FINGERS[0].text, FINGERS[0].file).unwrap();
    let predicted = surrogate::fit(&measured, &printed).unwrap().predict([20.0, 10.0]).unwrap();
    let finger = Finger::new(predicted.compliance.mean, predicted.assembly.mean);
    let (rig, grasp) = (direct("ket12"), Grasp::of(&finger));
    let found = robustness::evaluate(&rig, grasp, &predicted, Search::Strides, &plan, &[]);
    let robust = found.robust.unwrap();
    assert_eq!((robust.ranges_mm.len(), robust.diverged), (6, 0));
    assert!(robust.sd_mm() > 0.0);
    let value = robust.value_mm.unwrap();
    assert!(value > 0.0 && value < found.window.range_mm(), "{value} of {:?}", found.window);
}

#[test]
fn a_picture_shows_each_phase_twice() {
    let (rig, finger) = (direct("rj45"), finger(2.0, 50.0));
    let trial = trial(&rig, &finger, 0.0);
    let svg = picture::svg(&rig.task, &finger.pad, &trial, "a <trial>");
    assert_eq!(svg.matches("(y, z)").count(), trial.phases.len());
    assert_eq!(svg.matches("(x, z)").count(), trial.phases.len());
    assert!(svg.contains("a &lt;trial&gt;") && svg.contains("10 mm"));
}

/// The finger of 20 %, 20 degrees as computed, as stiff at its pad as measured.
fn computed() -> Finger {
    let printed = FingerFile::parse(FINGERS[0].text, FINGERS[0].file).unwrap();
    let fingers = ComputedFingers::new(printed);
    let fingers = FingerSource::Computed(Box::new(fingers));
    let at_pad = Prediction::exact(2.6e3, 45e3);
    fingers.make(&at_pad, &Design::infill(20.0, 20.0), &direct("rj45").task).unwrap()
}

/// A finger on its springs at a jaw that stands still, the springs at rest with the pad so far inward.
fn mounted(scene: &mut Scene, finger: &Finger, side: f64, inward: f64, geoms: Vec<Geom>) -> BodyId {
    let jaw = Body {
        name: "jaw".into(),
        motion: Motion::Fixed,
        pose: Pose::translation(0.0, -side * inward, 0.0),
        geoms: Vec::new(),
    };
    let motion = Motion::Free(insertion::finger::inertia(finger, side));
    let body = Body { motion, geoms, pose: Pose::identity(), name: "finger".into() };
    let (jaw, body) = (scene.body(jaw), scene.body(body));
    let centre = Pose::translation(0.0, finger.centre(side).y, finger.centre(side).z);
    scene.joint(Joint {
        name: "springs".into(),
        parent: jaw,
        child: body,
        in_parent: centre,
        in_child: centre,
        springs: finger.jaw_springs(side),
    });
    body
}

/// A part that is pushed up in the grasp is gripped harder, by as much as the springs pull at one another:
/// the pads would move inward, and the part is in their way.
#[test]
fn pushed_up_a_part_is_gripped_harder_by_coupled_fingers() {
    let mut finger = computed();
    // y and z pull at one another: pushed up, its pad moves towards the part.
    finger.coupling = Some(Coupling::new([(1, 2, -0.3)]).unwrap());
    // So high that it stays flat on the part.
    finger.pad.height = 80.0 * MM;
    let shoulder = finger.pad.height / 2.0;
    let mut scene = Scene::default();
    let fingers = [-1.0, 1.0].map(|side| {
        let pad = finger.pad.geoms(shoulder, side).remove(0);
        mounted(&mut scene, &finger, side, 2.0 * MM, vec![pad])
    });
    // The pads' faces meet in the middle: the part is a thin plate between them.
    let half = Vector3::new(6.0, 1e-3, 60.0) * MM;
    let (shape, pose) = (Shape::Box { half }, Pose::identity());
    let plate = Geom { name: "part".into(), shape, pose, friction: None };
    let inertia =
        Inertia { mass: 5e-3, centre: Default::default(), moments: Vector3::repeat(1e-5) };
    let motion = Motion::Free(inertia);
    let part = scene.body(Body { name: "part".into(), motion, pose, geoms: vec![plate] });
    for body in fingers {
        scene.contact(body, part, Friction::hard(1.0));
    }
    let up = 2.0;
    let grip = |force: f64| {
        let mut world = Direct::default().world(&scene);
        for step in 0..8000 {
            if step == 4000 {
                world.push(part, Vector3::z() * force, Vector3::zeros());
            }
            world.step().unwrap();
        }
        fingers.map(|body| world.contact(body, part).net.y.abs())
    };
    let Springs::Coupled { stiffness: k, .. } = finger.jaw_springs(-1.0) else { panic!("coupled") };
    let expected = -k[(1, 2)] / k[(2, 2)] * up / 2.0;
    assert!(expected > 0.05);
    for (pressed, still) in grip(up).into_iter().zip(grip(0.0)) {
        let found = pressed - still;
        assert!((found / expected - 1.0).abs() < 0.02, "{found} {expected}, of {still}");
    }
}

/// The moment about the pads' normal, N m, at which a key held by two such fingers begins to turn.
fn moment_that_turns(task: &Task, finger: &Finger) -> f64 {
    let robot = robot("rigid").mount(0.0, 0.0).unwrap();
    let mut cell = cell::build(task, &robot, finger);
    cell.scene.gravity = Vector3::zeros();
    let mut world = Direct::default().world(&cell.scene);
    let close = |world: &mut dyn World, time: f64| {
        for (side, hand) in cell.hands.iter().enumerate() {
            world.set_spring(hand.slide, 1, cell::closing(side, task.grip.force, time));
        }
        world.step().unwrap();
    };
    let step = world.step_s();
    (1..=1000).for_each(|k| close(world.as_mut(), k as f64 * step));
    world.place(cell.stand, Pose::translation(0.0, 0.0, -1.0));
    let turned = |world: &dyn World| {
        let finger = world.pose(cell.hands[0].finger);
        (finger.inverse() * world.pose(cell.plug)).rotation.scaled_axis().y
    };
    // 20 N mm each second; the key is taken to turn at 0.2 degrees against its pad.
    let from = turned(world.as_ref());
    for k in 1.. {
        let moment = 0.02 * f64::from(k) * step;
        world.push(cell.plug, Vector3::zeros(), Vector3::y() * moment);
        close(world.as_mut(), 1.0);
        if (turned(world.as_ref()) - from).abs() > 0.2 * DEG {
            return moment;
        }
    }
    unreachable!("a moment that grows turns it in the end")
}

/// Two pads press a key of 7 mm over 8.4 mm with 5 N each. Flush, on springs that sit behind the pad's
/// middle, the mean lever of that patch is 2.95 mm; its corners, at which the contacts are, lie 5.5 mm
/// from its middle, and the published radius is 30 mm. Springs that sit 21 mm below tip the pad, which
/// then presses along its lower edge, 7 mm long: a quarter of that.
#[test]
fn a_held_key_turns_at_the_moment_of_its_pressed_patch() {
    let mut task = task("ket8");
    let [a, b] = [3.5f64, 4.2];
    let part = |a: f64, b: f64| a * a / (6.0 * b) * libm::asinh(b / a);
    let lever = libm::hypot(a, b) / 3.0 + part(a, b) + part(b, a);
    let limit = 2.0 * task.friction.finger_plug * task.grip.force;
    let tipped = finger(2.6, 45.0);
    let flush = Finger { rcc: -tipped.pad.middle(task.grip.shoulder()), ..tipped };
    let radius = moment_that_turns(&task, &flush) / limit / MM;
    assert!((radius / libm::hypot(30.0, libm::hypot(a, b)) - 1.0).abs() < 0.03, "{radius} mm");
    task.friction.finger_torsion = PadTorsion::Patch;
    for (finger, lever) in [(flush, lever), (tipped, 7.0 / 4.0)] {
        let found = moment_that_turns(&task, &finger) / limit / MM;
        assert!((found / lever - 1.0).abs() < 0.03, "{found} mm, not {lever}");
    }
}

/// A touch that is felt late presses harder: at a threshold of force, and after some latency more so.
#[test]
fn a_touch_felt_at_a_force_and_late_presses_harder() {
    let file = TASKS.iter().find(|file| file.name == "ket12").unwrap();
    let with = |keys: &str, motion: &str| {
        let from = format!("motion = \"{motion}\"\n");
        Task::parse(&file.text.replacen(&from, &format!("{from}{keys}\n"), 1), file.file)
    };
    let peak = |keys: &str| {
        let rig = rig(with(keys, "touch").unwrap(), "rigid");
        phase(&trial(&rig, &finger(2.6, 45.0), 0.0), "touch").peak_force_n
    };
    let at = ["", "touch_force_n = 5.0", "touch_force_n = 5.0\nlatency_s = 0.01"].map(peak);
    assert!(at[0] + 2.0 < at[1] && at[1] + 2.0 < at[2], "{at:?} N");
    for (keys, motion, problem) in [
        ("touch_force_n = 5.0", "duration", "is valid only with motion = \"touch\""),
        ("latency_s = 0.1", "tolerance", "is valid only with motion = \"touch\""),
        ("latency_s = -0.1", "touch", "latency_s"),
        ("latency_s = 60.0", "touch", "at most 60 s is accepted"),
    ] {
        let error = with(keys, motion).unwrap_err().to_string();
        assert!(error.contains(problem), "{error}");
    }
}

/// An RJ45 plug's latch bends under the lips of its jack as far as they force it to, and snaps
/// back behind them.
#[test]
fn a_latch_snaps_behind_its_lips() {
    let task = Task::parse(include_str!("../tasks/rj45_latch.toml"), "rj45_latch.toml").unwrap();
    let hinge = task.plug.latch.as_ref().unwrap().hinge;
    for robot in ["servo", "ur5e_position"] {
        let rig = rig(task.clone(), robot);
        let recording = rig.record(Grasp::of(&finger(2.6, 45.0)), 0.0).unwrap();
        assert_eq!(recording.trial.outcome, Outcome::Inserted, "{:?}", recording.trial);
        let turns = recording.frames.iter().map(|frame| {
            let bent = frame.poses.plug.inverse() * frame.poses.latch.unwrap();
            let moved = (bent * hinge - hinge).norm();
            (moved, bent.rotation.scaled_axis().y.abs())
        });
        let (moved, turns): (Vec<f64>, Vec<f64>) = turns.unzip();
        // It snaps by 0.2 rad within a step or two; a step follows the tangent of that turn.
        assert!(moved.iter().all(|&moved| moved < 0.1 * MM), "the hinge gave");
        assert!(moved.last().unwrap() / MM < 1e-3, "the hinge gave and did not come back");
        // The shoulder's edge, 3.9 mm along the plug from the hinge, has to give way by 0.89 mm with
        // the plug in the middle of its play, and by 0.17 mm more or less at its ends.
        let most = turns.iter().copied().fold(0.0, f64::max);
        assert!((0.68 / 3.9..1.1 / 3.9).contains(&most), "{most} rad");
        let last = turns.last().unwrap();
        assert!(*last < 0.02, "still bent by {last} rad");
    }
}

/// A USB-A plug finds its receptacle and goes on over the tongue from the task file's own start.
#[test]
fn a_usb_a_plug_goes_over_its_tongue() {
    let task = Task::parse(include_str!("../tasks/usb_a.toml"), "usb_a.toml").unwrap();
    for robot in ["servo", "ur5e_position"] {
        let rig = rig(task.clone(), robot);
        let trial = trial(&rig, &finger(2.6, 45.0), 0.0);
        assert_eq!(trial.outcome, Outcome::Inserted, "{trial:?}");
    }
}
