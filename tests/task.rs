//! One's own connector: `optimize task`, and what its check catches.

mod common;

use common::optimize;
use finger_opt::connector::check::problems;
use finger_opt::connector::draft::{Dimensions, draft};
use finger_opt::connector::nominal::explain;
use finger_opt::connector::write::{self, Notes};
use finger_opt::finger::Finger;
use finger_opt::input::robot::Robot;
use finger_opt::input::shipped::{ROBOTS, TASKS};
use finger_opt::input::task::Task;
use finger_opt::outcome::Outcome;
use finger_opt::physics::direct::Direct;
use finger_opt::trial::run::EngineRig;
use finger_opt::trial::{Rig, Trial};
use finger_opt::units::{MM, N_PER_MM};

fn shipped(name: &str) -> &'static str {
    TASKS.iter().find(|file| file.name == name).unwrap().text
}

/// A shipped task with one passage replaced.
fn changed(name: &str, from: &str, to: &str) -> Task {
    let text = shipped(name);
    assert!(text.contains(from), "{name} has no `{from}`");
    Task::parse(&text.replace(from, to), name).unwrap()
}

/// The middle one of the measured fingers.
fn trial(task: &Task) -> Trial {
    let robot = Robot::parse(ROBOTS[0].text, ROBOTS[0].file).unwrap();
    let rig = EngineRig::new(task.clone(), &robot, Box::new(Direct::default())).unwrap();
    rig.grasp(&Finger::new(3.0 * N_PER_MM, 30.0 * N_PER_MM)).trial(0.0)
}

fn drafted(plug: &str, clearance_mm: f64, body: Option<&str>) -> Task {
    let size = Dimensions {
        plug: plug.parse().unwrap(),
        clearance: clearance_mm * MM,
        body: body.map(|body| body.parse().unwrap()),
    };
    draft("mine", &size, None).unwrap()
}

#[test]
fn shipped_tasks_have_no_problems() {
    for file in TASKS {
        let task = Task::parse(file.text, file.file).unwrap();
        assert_eq!(problems(&task), [], "{}", file.name);
    }
}

/// Each fault in a shipped task: the key that is named, a word of what is wrong and one of the remedy.
#[test]
fn each_fault_is_caught_with_its_key_and_what_would_be_right() {
    let shell = "y_mm = [-6.0, 6.0]\nz_mm = [0.0, 12.57]";
    let push = "move_mm = [0.0, 0.0, -20.0]";
    let touch = "move_mm = [0.0, 0.0, -3.0]";
    let approach = "move_mm = [-2.6, 0.0, -8.8]";
    let start = "start_mm = [0.0, -1.2, 51.0]";
    let faces = "faces_y_mm = [-6.2, 6.2]";
    let grip = "tcp_z_mm = 40.6\nshoulder_z_mm = 43.31";
    let opening = "opening_y_mm = [-7.49, 7.51]";
    let neck = "z_mm = [36.2, 39.96]";
    for (from, to, key, problem, remedy) in [
        (
            shell,
            "y_mm = [-7.6, 7.6]\nz_mm = [0.0, 12.57]",
            "\"metal shell\" y_mm",
            "15.2 mm wide",
            "narrower than 15",
        ),
        ("depth_mm = 12.0", "depth_mm = 16.0", "success.depth_mm", "stops 12.57 mm", "at most 12"),
        (
            approach,
            "move_mm = [-2.6, 0.0, -4.0]",
            "\"touch\" move_mm",
            "above the socket",
            "longer",
        ),
        (
            push,
            "move_mm = [0.0, 0.0, -10.0]",
            "\"assembly\" move_mm",
            "success asks for 12",
            "z = -16",
        ),
        (push, "move_mm = [0.0, 0.0, 20.0]", "\"assembly\" move_mm", "goes up", "negative"),
        (touch, "move_mm = [0.0, 0.0, 3.0]", "\"touch\" move_mm", "goes up", "negative"),
        (start, "start_mm = [0.0, -0.0012, 0.051]", "strategy.start_mm", "less than", "metres"),
        (grip, "tcp_z_mm = 1.6\nshoulder_z_mm = 1.7", "grip.tcp_z_mm", "less than", "inches"),
        (faces, "faces_y_mm = [-6.6, 6.6]", "grip.faces_y_mm", "off the plug", "[-6.2, 6.2]"),
        (
            faces,
            "faces_y_mm = [-5.0, 5.0]",
            "grip.faces_y_mm",
            "inside `grip block`",
            "[-6.2, 6.2]",
        ),
        (neck, "z_mm = [37.2, 39.96]", "\"neck\" z_mm", "gap of 1 mm to `taper`", "36.2"),
        (
            opening,
            "opening_y_mm = [-9.0, 7.51]",
            "socket.opening_y_mm",
            "`wall at -y` begins",
            "-7.49",
        ),
        (
            grip,
            "tcp_z_mm = 20\nshoulder_z_mm = 23.31",
            "grip.shoulder_z_mm",
            "plug goes on",
            "43.31",
        ),
        (grip, "tcp_z_mm = 60\nshoulder_z_mm = 63.31", "grip.shoulder_z_mm", "no plug", "43.31"),
        (start, "start_mm = [0.0, -1.2, 35.0]", "strategy.start_mm", "deep in", "z = 46.03"),
        (
            approach,
            "move_mm = [-2.6, 0.0, -12.8]",
            "\"approach\" move_mm",
            "runs into",
            "z = -8.97",
        ),
        (start, "start_mm = [0.0, 22.2, 51.0]", "strategy.start_mm", "in y", "y = -1.13"),
        (start, "start_mm = [22.0, -1.2, 51.0]", "strategy.start_mm", "in x", "x = 0.06"),
        (
            neck,
            "z_mm = [33.2, 39.96]",
            "plug.part \"taper\"",
            "3 mm deep in `neck`",
            "end where they meet",
        ),
        (neck, "z_mm = [36.2, 36.201]", "\"neck\" z_mm", "no mass", "thickness"),
        ("mass_g = 5.0", "mass_g = 0.005", "plug.mass_g", "less than foam", "plastic"),
        (
            "slip_limit_mm = 3.0",
            "slip_limit_mm = 5.0",
            "grip.slip_limit_mm",
            "3.35 mm",
            "at most 3.0",
        ),
    ] {
        let found = problems(&changed("usb", from, to));
        let caught = found.iter().any(|found| {
            found.key.contains(key)
                && found.problem.contains(problem)
                && found.remedy.contains(remedy)
        });
        assert!(caught, "{to}: {found:#?}");
    }
}

/// The file in another unit: nothing but that is said.
#[test]
fn a_file_in_another_unit_is_asked_about() {
    let lengths = in_unit(shipped("usb"));
    for (factor, unit) in [(1e-3, "metres"), (1.0 / 25.4, "inches")] {
        let task = Task::parse(&lengths(factor), "usb").unwrap();
        let found = problems(&task);
        assert!(found.iter().all(|found| found.problem.contains("less than")), "{found:#?}");
        assert!(found.iter().any(|found| found.key == "plug.part" && found.remedy.contains(unit)));
    }
}

/// Every number of a key in mm times a factor.
fn in_unit(text: &str) -> impl Fn(f64) -> String {
    move |factor| {
        let number = |word: &str| word.parse::<f64>().map(|value| format!("{:?}", value * factor));
        let scaled = |line: &str| match line.split_once(" = ") {
            Some((key, value)) if key.ends_with("_mm") => {
                let parts = value.split_inclusive(['[', ']', ',', ' ']).map(|part| {
                    let word = part.trim_end_matches(['[', ']', ',', ' ']);
                    number(word).map_or(part.to_owned(), |new| part.replacen(word, &new, 1))
                });
                format!("{key} = {}\n", parts.collect::<String>())
            }
            _ => format!("{line}\n"),
        };
        text.lines().map(scaled).collect()
    }
}

/// From 3 to 25 mm wide, with and without a body.
#[test]
fn drafted_tasks_insert_at_their_nominal_start() {
    for (plug, clearance_mm, body) in [
        ("8.25x2.4x6.65", 0.1, Some("12x6.5x20")),
        ("3x2x4", 0.1, Some("6x5x15")),
        ("25x15x20", 0.3, Some("30x20x30")),
        ("8x7x50", 0.15, None),
    ] {
        let task = drafted(plug, clearance_mm, body);
        assert_eq!(problems(&task), [], "{plug}");
        let trial = trial(&task);
        assert_eq!(trial.outcome, Outcome::Inserted, "{plug}: {}", explain(&task, &trial));
    }
}

/// What is in the file is what was drafted.
#[test]
fn a_drafted_file_reads_back_without_problems() {
    let task = drafted("14x4.5x11", 0.2, Some("21x11x30"));
    let text = write::task(&task, &Notes::default());
    let read = Task::parse(&text, "mine.toml").unwrap();
    assert_eq!(problems(&read), []);
    assert!((read.success.depth - task.success.depth).abs() < 1e-7);
}

/// A push that is too weak leaves the plug outside, and is called what it is.
#[test]
fn a_failed_nominal_start_is_explained() {
    let mut task = drafted("8.25x2.4x6.65", 0.1, Some("12x6.5x20"));
    task.grip.force = 0.02;
    let trial = trial(&task);
    let text = explain(&task, &trial);
    assert!(matches!(trial.outcome, Outcome::Failed(_)));
    assert!(text.contains("grip.force_n"), "{text}");
}

#[test]
fn a_task_is_made_shown_checked_and_used() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("c.toml");
    let path = file.to_str().unwrap();
    let new = [
        "task",
        "new",
        "c",
        "--plug",
        "8.25x2.4x6.65",
        "--clearance",
        "0.1",
        "--body",
        "12x6.5x20",
        "--engine",
        "fake",
        "--out",
        path,
    ];
    assert!(optimize(&new).succeeds().contains(path));
    optimize(&new).fails(2, &["exists", "--out"]);
    let check = ["task", "check", path, "--engine", "fake"];
    let svg = folder.path().join("c.svg");
    let drawn =
        optimize(&[&check[..], &["--json", "--svg", svg.to_str().unwrap()]].concat()).json();
    assert_eq!(drawn["valid"], true);
    assert_eq!(drawn["problems"], serde_json::json!([]));
    assert_eq!(drawn["nominal"]["outcome"], "inserted");
    let picture = common::read(&svg);
    roxmltree::Document::parse(&picture).unwrap();
    assert!(picture.contains("clearance") && picture.contains("assembly"));
    // What was made has a body that a wider one would not let in.
    let wrong = common::read(&file).replace("y_mm = [-4.125, 4.125]", "y_mm = [-4.6, 4.6]");
    std::fs::write(&file, wrong).unwrap();
    let ran = optimize(&[&check[..], &["--json"]].concat());
    ran.fails(2, &["problem"]);
    let found: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(found["valid"], false);
    assert!(found["problems"][0]["key"].as_str().unwrap().contains("y_mm"), "{found}");
    assert!(found["problems"][0]["remedy"].as_str().unwrap().contains("8.35"), "{found}");
    assert!(found["nominal"].is_null());
}

#[test]
fn a_task_is_copied_like_another_and_shown_as_it_is() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("my-usb.toml");
    let out = path.to_str().unwrap();
    optimize(&["task", "new", "my-usb", "--like", "usb", "--engine", "fake", "--out", out])
        .succeeds();
    let copy = Task::parse(&common::read(&path), out).unwrap();
    let usb = Task::parse(shipped("usb"), "usb").unwrap();
    assert_eq!(copy.name, "my-usb");
    assert_eq!((copy.plug, copy.strategy), (usb.plug, usb.strategy));
    assert_eq!(optimize(&["task", "show", "usb"]).succeeds(), shipped("usb"));
    optimize(&["task", "show", "usc"]).fails(2, &["did you mean `usb`"]);
    assert_eq!(optimize(&["task"]).succeeds(), optimize(&["tasks"]).succeeds());
    optimize(&["task", "new", "a b", "--out", out]).fails(2, &["letters"]);
    optimize(&["task", "new", "a", "--plug", "8x3", "--clearance", "0.1"])
        .fails(2, &["8.25x2.4x6.65"]);
    let short = ["--plug", "8x3x8", "--clearance", "0.1", "--body", "12x8x5"];
    optimize(&[&["task", "new", "a"][..], &short].concat()).fails(2, &["--body", "9.4 mm"]);
}

/// A file that cannot be read is a problem, too, with its key.
#[test]
fn a_check_says_what_a_reader_finds() {
    let folder = tempfile::tempdir().unwrap();
    let file = folder.path().join("bad.toml");
    for (from, to, key) in [
        ("mass_g = 5.0", "mass_g = 0.0", "plug.mass_g"),
        ("mass_g = 5.0", "", "mass_g"),
        ("force_n", "force", "force"),
    ] {
        std::fs::write(&file, shipped("usb").replace(from, to)).unwrap();
        let ran = optimize(&["task", "check", file.to_str().unwrap(), "--json"]);
        ran.fails(2, &["1 problem"]);
        let found: serde_json::Value = serde_json::from_str(&ran.stdout).unwrap();
        assert_eq!(found["problems"][0]["key"], key);
    }
}
