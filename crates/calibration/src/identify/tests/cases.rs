use super::fixtures::synthetic;
use crate::identify::check::{self, Remark};
use crate::identify::curves::{Curves, STEP_S};
use crate::identify::frame::Frame;
use crate::identify::log::{Log, LogSample, Run};
use crate::identify::touch::{bias, touch};
use crate::identify::{read, runs};
use input::shipped::{ROBOTS, TASKS};
use input::units::{MM, N_PER_MM};
use insertion::{Design, EngineKind, Finger, Grasp, Outcome, Robot, Task, Tcp};
use nalgebra::{Isometry3, UnitQuaternion, Vector3};

fn usb() -> Task {
    let file = TASKS.iter().find(|task| task.name == "usb").unwrap();
    Task::parse(file.text, file.file).unwrap()
}

fn said(log: Log) -> Vec<Remark> {
    let (design, outcome) = (Design::infill(20.0, 10.0), Some(Outcome::Inserted));
    check::remarks("runs.csv", &[Run { log, design, offset: 0.0, outcome, line: 2 }], &usb())
}

fn said_of(change: impl FnMut((usize, &mut LogSample))) -> String {
    let mut log = synthetic(0.5, 1.0);
    log.samples.iter_mut().enumerate().for_each(change);
    said(log).iter().map(|remark| format!("{:?} {}\n", remark.lines, remark.text)).collect()
}

#[test]
fn a_log_reads_back_as_it_was_written() {
    let text = synthetic(0.5, 1.0).csv();
    let log = read::parse(&text, "a.csv", None).unwrap();
    assert_eq!(log.csv(), text);
    let spread = text.replace(',', " , ").replace('\n', "\r\n");
    let again = read::parse(&format!("\u{feff}# made\n{spread}"), "a.csv", None).unwrap();
    let same = |(a, b): (&LogSample, &LogSample)| {
        LogSample { line: a.line, ..*b } == *a && b.line == a.line + 1
    };
    assert!(log.samples.iter().zip(&again.samples).all(same));
    assert_eq!(log.samples[9].line, 11);
}

const FRAME: &str = "origin_mm = [400, -120, 35]\naxis_angle_rad = [0.02, -0.01, 0.7]\n";

/// Returns the log as recorded by a UR robot with the task's frame of `FRAME`; `blank` separates the cells.
fn rtde(log: &Log, blank: &str) -> String {
    let turn = UnitQuaternion::from_scaled_axis(Vector3::new(0.02, -0.01, 0.7));
    let base = Isometry3::from_parts((Vector3::new(400.0, -120.0, 35.0) * MM).into(), turn);
    let pose = |Tcp { position, tilt }: Tcp| -> Vec<f64> {
        let turn =
            turn * UnitQuaternion::from_scaled_axis(Vector3::x() * (tilt + std::f64::consts::PI));
        let (place, turn) = (base * nalgebra::Point3::from(position), turn.scaled_axis());
        place.coords.iter().chain(&turn).copied().collect()
    };
    let names = ["actual_TCP_pose", "actual_TCP_force", "target_TCP_pose"];
    let names = names.iter().flat_map(|name| (0..6).map(move |i| format!("{name}_{i}")));
    let mut text =
        ["timestamp".to_owned()].into_iter().chain(names).collect::<Vec<_>>().join(blank);
    for sample in &log.samples {
        let target = sample.target.unwrap();
        let (tcp, goal) = (pose(sample.tcp), pose(target));
        let force = turn * -sample.force;
        let all = [sample.time_s].into_iter().chain(tcp).chain(force.iter().copied());
        let cells: Vec<String> = all.chain([0.0; 3]).chain(goal).map(|v| v.to_string()).collect();
        text += &format!("\n{}", cells.join(blank));
    }
    text
}

#[test]
fn both_formats_give_the_same_log() {
    let log = synthetic(0.5, 0.0);
    let frame = Frame::parse(&format!("{FRAME}force_sign = -1"), "frame.toml").unwrap();
    for blank in [" ", ","] {
        let found = read::parse(&rtde(&log, blank), "a.csv", Some(&frame)).unwrap();
        for (a, b) in log.samples.iter().zip(&found.samples) {
            let (goal, other) = (a.target.unwrap(), b.target.unwrap());
            let near = |a: Tcp, b: Tcp| {
                (a.position - b.position).norm() < 1e-9 && (a.tilt - b.tilt).abs() < 1e-9
            };
            assert!(near(a.tcp, b.tcp) && near(goal, other));
            assert!((a.force - b.force).norm() < 1e-9 && a.time_s == b.time_s && a.line == b.line);
        }
    }
    let error = read::parse(&rtde(&log, " "), "a.csv", None).unwrap_err().to_string();
    assert!(error.contains("--frame frame.toml"), "{error}");
    // The weight of a tool of 1 kg, not compensated by the sensor, is subtracted.
    let heavy = "origin_mm = [400, 0, 0]\naxis_angle_rad = [0, 0, 1]\ntool_mass_kg = 1\ngravity_compensated = false";
    let heavy = Frame::parse(heavy, "frame.toml").unwrap();
    let found = read::parse(&log.csv(), "a.csv", Some(&heavy)).unwrap();
    assert!((found.samples[0].force.z - log.samples[0].force.z - 9.80665).abs() < 1e-4);
}

#[test]
fn what_cannot_be_read_is_told_with_its_line() {
    let good = synthetic(0.5, 1.0).csv();
    let line = |at: usize| good.lines().nth(at - 1).unwrap().to_owned();
    let changed = |at: usize, to: &str| good.replace(&line(at), to);
    let cell = |at: usize, column: usize, to: &str| {
        let line = line(at);
        let mut cells: Vec<&str> = line.split(',').collect();
        cells[column] = to;
        changed(at, &cells.join(","))
    };
    let frame = Frame::parse(FRAME, "frame.toml").unwrap();
    let ur = rtde(&synthetic(0.5, 0.0), " ");
    let scaled = |column: usize, factor: f64| {
        let line = ur.lines().nth(8).unwrap();
        let mut cells: Vec<String> = line.split(' ').map(str::to_owned).collect();
        cells[column] = (cells[column].parse::<f64>().unwrap() * factor).to_string();
        ur.replace(line, &cells.join(" "))
    };
    let short: String = good.lines().take(40).map(|line| format!("{line}\n")).collect();
    let mut metres = synthetic(0.0, 0.0);
    metres.samples.iter_mut().for_each(|sample| sample.tcp.position *= MM);
    for (text, words) in [
        (cell(9, 7, "nan"), "a.csv: line 9: fz_n: `nan` is not a finite number"),
        (cell(9, 2, ""), "a.csv: line 9: y_mm: is empty"),
        (cell(9, 1, "2e4"), "line 9: a coordinate of 20000 looks like micrometres"),
        (cell(9, 0, "6.9"), "line 9: time goes from 7.012 s in line 8 to 6.9 s"),
        (changed(9, &line(8)), "line 9: time goes from 7.012 s in line 8 to 7.012 s"),
        (changed(9, "7.014,1"), "line 9: has 2 cells where the header has 11"),
        (good.replace("fz_n", "fz"), "line 1: the header lacks fz_n"),
        (good.replace("target_y_mm", "y_target"), "line 1: the header lacks target_y_mm"),
        (good.replace(',', ";"), "line 1: its columns are separated by `;`"),
        (good.lines().skip(1).collect::<Vec<_>>().join("\n"), "line 1: is not the header of a log"),
        (short, "has 39 samples; it must have 50"),
        (String::new(), "a.csv: is empty"),
        (metres.csv(), "look like metres; give millimetres"),
        (scaled(1, 1e3), "looks like millimetres; RTDE records metres"),
        (scaled(4, 57.3), "looks like degrees; RTDE records axis-angle in rad"),
        (scaled(4, 0.5), "`upright_axis_angle_rad`"),
    ] {
        let error = read::parse(&text, "a.csv", Some(&frame)).unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
    for (text, words) in [
        ("origin_mm = [0.4, 0, 0]\naxis_angle_rad = [0, 0, 0]", "origin_mm: is 0.4; it must"),
        (
            "origin_mm = [400, 0, 0]\naxis_angle_rad = [180, 0, 0]",
            "axis_angle_rad: is 180; it must",
        ),
        (&format!("{FRAME}gravity_compensated = false"), "tool_mass_kg: is required"),
        (&format!("{FRAME}force_sign = 2"), "force_sign: is 2; it must be 1"),
    ] {
        let error = Frame::parse(text, "frame.toml").unwrap_err().to_string();
        assert!(error.contains(words), "{error}");
    }
}

#[test]
fn the_touch_is_found_in_noise_and_drift() {
    for (noise, drift) in [(0.0, 0.0), (0.5, 1.0), (0.5, -1.0)] {
        let log = synthetic(noise, drift);
        let at = log.samples[touch(&log).unwrap()].time_s - 7.3;
        assert!(at.abs() < 0.01, "{noise} {drift}: {at}");
        let error = bias(&log) - Vector3::new(0.3, -0.2, 0.8 + drift * 0.15 / 1.2);
        assert!(error.amax() < 0.15, "{error}");
    }
    assert!(said(synthetic(0.5, 1.0)).is_empty(), "{:?}", said(synthetic(0.5, 1.0)));
}

#[test]
fn remarks_say_what_is_wrong_and_where() {
    for (found, words) in [
        (said_of(|(i, m)| m.time_s = i as f64 * 0.02), "recorded at 50 Hz"),
        (
            said_of(|(i, m)| m.time_s += if i < 400 { 0.0 } else { 0.1 }),
            "Some([401, 402]) the clock steps by 102 ms",
        ),
        (said_of(|(_, m)| m.force = -m.force), "invert `force_sign`"),
        (said_of(|(_, m)| m.force = m.force.zxy()), "the force is along x"),
        (said_of(|(_, m)| m.force *= 0.0), "no contact"),
        (said_of(|(_, m)| m.force.z = m.force.z.min(15.0)), "fz stays at its extreme value 15.0 N"),
        (said_of(|(_, m)| m.force.x += 9.0), "the force in the air is (9.3"),
        (said_of(|(_, m)| m.target = None), "stiffness cannot be identified"),
        (said_of(|(_, m)| m.tcp.tilt *= -1.0), "-10.0 degrees, but in the task by 10.0: its sign"),
        (
            said_of(|(_, m)| m.tcp.position.x += 0.1),
            "(100.0, -1.2, 51.0) mm, 100 mm from the start",
        ),
        (
            said_of(|(_, m)| m.tcp.position.z = m.tcp.position.z.max(0.0446)),
            "the tip is never deeper",
        ),
        (said_of(|(i, m)| m.tcp.position.z += if i > 590 { 0.03 } else { 0.0 }), "ends in the air"),
        (said_of(|(_, m)| m.tcp.position = Vector3::new(0.0, -1.2, 51.0) * MM), "stands still"),
    ] {
        assert!(found.contains(words), "{words}: {found}");
    }
}

#[test]
fn a_frame_is_rotated_if_it_looks_so_in_most_logs() {
    let run = |sideways: bool| {
        let mut log = synthetic(0.5, 1.0);
        let turn = |sample: &mut LogSample| sample.force = sample.force.zxy();
        log.samples.iter_mut().filter(|_| sideways).for_each(turn);
        let (design, outcome) = (Design::infill(20.0, 10.0), Some(Outcome::Inserted));
        Run { log, design, offset: 0.0, outcome, line: 2 }
    };
    let found = |runs: &[Run]| {
        let remarks = check::remarks("runs.csv", runs, &usb()).into_iter();
        remarks.filter(|one| one.text.contains("looks rotated")).collect::<Vec<_>>()
    };
    assert_eq!(found(&[run(true), run(false)]), []);
    let [one] = &found(&[run(true), run(false), run(true)])[..] else { panic!("one remark") };
    assert!(one.text.contains("along x and not along z in 2 of 3 logs"), "{one}");
}

#[test]
fn a_table_of_runs_names_logs_beside_it() {
    let folder = tempfile::tempdir().unwrap();
    let (path, log) = (folder.path().join("runs.csv"), folder.path().join("a.csv"));
    std::fs::write(&log, synthetic(0.5, 1.0).csv()).unwrap();
    std::fs::copy(&log, folder.path().join("p.csv")).unwrap();
    let of = |lines: &str| {
        let head = "log,infill_density_percent,infill_direction_deg,offset_mm,outcome";
        std::fs::write(&path, format!("# usb\n{head}\n{lines}\n")).unwrap();
        runs::read(&path, None, read::text).map_err(|error| error.to_string())
    };
    let found = of("a.csv,20,10,1.5,3\np.csv,20,10,,probe").unwrap();
    assert_eq!((found[0].offset, found[0].line, found[1].outcome), (1.5 * MM, 3, None));
    assert_eq!(found[0].outcome, Some(Outcome::Failed(3_u8.try_into().unwrap())));
    for (lines, words) in [
        ("a.csv,20,10,1.5,5", "line 3: outcome: unknown failure class `5`"),
        ("a.csv,20,10,,inserted", "line 3: offset_mm: `` is not a number"),
        ("a.csv,20,10,0.001,inserted", "looks like metres"),
        ("a.csv,20,10,1,inserted\na.csv,20,10,2,3", "line 4: log: same log as in line 3"),
        ("\"a.csv,20,10,1,3\np.csv,20,10,,probe", "line 3: a quoted cell runs over the end"),
        ("p.csv,20,10,,probe", "has no attempt"),
        ("b.csv,20,10,0,inserted", "b.csv: cannot be read"),
    ] {
        let error = of(lines).unwrap_err();
        assert!(error.contains(words), "{error}");
    }
    std::fs::File::create(&log).unwrap().set_len(1 << 30).unwrap();
    let error = of("a.csv,20,10,0,inserted").unwrap_err();
    assert!(error.contains("longer than 67108864 bytes"), "{error}");
}

/// The commanded path contains the reaction to the touch, so that replaying it gives the same attempt.
#[test]
fn an_attempt_along_its_own_path_is_the_same_attempt() {
    let file = ROBOTS.iter().find(|robot| robot.name == "servo").unwrap();
    let (task, robot) = (usb(), Robot::parse(file.text, file.file).unwrap());
    let finger = Finger::new(2.0 * N_PER_MM, 10.0 * N_PER_MM).with_model(&task.finger, 0.0);
    let rig = EngineKind::Direct.rig(&task, &robot, &finger, 1.0).unwrap();
    for offset in [0.0, 8.0 * MM] {
        let (trial, samples) = rig.grasp(Grasp::of(&finger)).run(offset, Some(STEP_S), 0.0);
        let measured = Curves::of_samples(&samples, 0.0);
        let trajectory = measured.trajectory().unwrap();
        let push = trajectory.push_start();
        assert!(push > 0.1 && push < trajectory.duration(), "{push}");
        let mut followed = rig.follow(Grasp::of(&finger), &[&trajectory]);
        let (again, samples) = followed.remove(0);
        assert_eq!(again.outcome, trial.outcome);
        let replayed = Curves::of_samples(&samples, 0.0);
        let each = measured.force.iter().zip(&replayed.force);
        let apart = each.map(|(a, b)| (a - b).norm()).fold(0.0, f64::max);
        assert!(apart < 1.0, "{offset}: {apart} N");
    }
}
