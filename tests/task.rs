//! `optimize task`: drafted, imported and checked tasks of your own connector.

use crate::common::shipped::{finger, rig};
use crate::common::{Ran, Studies, fake, optimize, optimize_line};
use connector::check::problems;
use connector::draft::{Dimensions, Size, draft};
use connector::mesh::{Body, Surface, pick, read};
use connector::nominal::{explain, weak_grip};
use input::shipped::TASKS;
use input::units::MM;
use insertion::outcome::Outcome;
use insertion::task::Task;
use insertion::trial::{Grasp, Rig, Trial};
use nalgebra::Point3;
use serde_json::Value;

const LATCH: &str = include_str!("../tasks/rj45_latch.toml");

const USB: &str = include_str!("../tasks/usb.toml");

/// The program with words separated by blanks, then more.
fn said(words: &str, more: &[&str]) -> Ran {
    optimize(&words.split(' ').chain(more.iter().copied()).collect::<Vec<_>>())
}

/// A task file with its first passage `from` replaced.
fn changed(text: &str, from: &str, to: &str) -> Result<Task, String> {
    assert!(text.contains(from), "no `{from}`");
    Task::parse(&text.replacen(from, to, 1), "t.toml").map_err(|error| error.to_string())
}

/// Nominal trial with the middle one of the measured fingers.
fn trial(task: &Task) -> Trial {
    rig(task.clone(), "servo").grasp(Grasp::of(&finger(3.0, 30.0))).trial(0.0)
}

/// Draft of a plug WxHxL, or of a round one DxL.
fn drafted(plug: &str, clearance_mm: f64, body: Option<&str>) -> Task {
    let round = plug.matches('x').count() == 1;
    let size = Dimensions {
        pins: None,
        plug: if round { Size::round(plug).unwrap() } else { plug.parse().unwrap() },
        round,
        clearance: clearance_mm * MM,
        body: body.map(|body| body.parse().unwrap()),
        key: None,
        chamfer: None,
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

#[test]
fn edges_and_latches_that_mean_nothing_are_refused_by_their_key() {
    assert!(problems(&Task::parse(LATCH, "rj45_latch.toml").unwrap()).is_empty());
    let edge = "{ at = \"-x+z\", chamfer_mm = 0.2 }";
    let twice = "{ at = \"-x+z\", radius_mm = 0.1 }, { at = \"+z\", chamfer_mm = 0.1 }";
    for (from, to, key, problem) in [
        (edge, "{ at = \"-x-x\", chamfer_mm = 0.2 }", "\"wall at +x\" edges", "unknown edge"),
        (edge, "{ at = \"-x+z\" }", "\"wall at +x\" edges", "either chamfer_mm or radius_mm"),
        (edge, "{ at = \"-x+z\", radius_mm = 0.0 }", "edges.radius_mm", "must lie in 0.001"),
        (edge, "{ at = \"-x+z\", chamfer_mm = 3.0 }", "\"wall at +x\" edges", "smaller"),
        (edge, "{ at = \"+z\", radius_mm = 1.3 }", "\"wall at +x\" edges", "smaller"),
        (edge, twice, "\"wall at +x\" edges", "repeats an edge"),
        ("\"latch blade\", ", "\"latch bland\", ", "plug.latch.parts", "the plug has no part"),
        ("\"latch blade\", ", "\"latch arm\", ", "plug.latch.parts", "is given twice"),
        ("\"latch blade\", \"latch shoulder\", \"latch arm\"", "", "plug.latch.parts", "not all"),
        ("axis = \"y\"\nroot_mm", "axis = \"z\"\nroot_mm", "plug.latch.axis", "along the flexure"),
        ("modulus_gpa = 2.35", "modulus_gpa = 0.0", "plug.latch.modulus_gpa", "must lie in 1e-9"),
        (
            "thickness_mm = 0.67",
            "thickness_mm = 3.0",
            "plug.latch.thickness_mm",
            "half the flexure",
        ),
    ] {
        let error = changed(LATCH, from, to).unwrap_err();
        assert!(error.contains(key) && error.contains(problem), "{to}: {error}");
    }
}

#[test]
fn a_latch_that_hangs_on_nothing_or_is_gripped_is_noticed() {
    for (from, to, key) in [
        ("root_mm = [-4.19, 0.0, 3.5]", "root_mm = [-4.19, 0.0, -3.5]", "plug.latch.root_mm"),
        ("end_mm = [-5.07, 0.0, 8.05]", "end_mm = [-9.07, 0.0, 8.05]", "plug.latch.end_mm"),
        ("\"latch arm\"]", "\"latch arm\", \"grip block\"]", "grip."),
    ] {
        let found = problems(&changed(LATCH, from, to).unwrap());
        assert!(found.iter().any(|problem| problem.key.starts_with(key)), "{to}: {found:?}");
    }
}

/// Each fault in a shipped task: key, new value, and parts of the key, the problem and the remedy.
#[test]
fn each_fault_is_caught_with_its_key_and_what_would_be_right() {
    let shell = "y_mm = [-6.0, 6.0]\nz_mm = [0.0, 12.57]";
    let wide = "[-7.6, 7.6]\nz_mm = [0.0, 12.57]";
    let push = "move_mm = [0.0, 0.0, -20.0]";
    let touch = "move_mm = [0.0, 0.0, -3.0]";
    let approach = "move_mm = [-2.6, 0.0, -8.8]";
    let start = "start_mm = [0.0, -1.2, 51.0]";
    let faces = "faces_y_mm = [-6.2, 6.2]";
    let grip = "tcp_z_mm = 40.6\nshoulder_z_mm = 43.31";
    let y = "opening_y_mm = [-7.49, 7.51]";
    let neck = "z_mm = [36.2, 39.96]";
    let slip = "slip_limit_mm = 3.0";
    let (x, tilt, most) = ("x_mm = [-2.29, 2.19]", "tilt_deg = 10.0", "tilt_deg = 4.0");
    let (force, speed) = ("force_n = 5.0", "speed_mm_per_s = 20.0");
    // Wrong units of one number: the only problem.
    let units = [
        (x, "[-0.00229, 0.00219]", "\"metal shell\" x_mm", "0.004 mm wide in x", "by 1000: 4.48"),
        (x, "[-0.09, 0.09]", "\"metal shell\" x_mm", "0.18 mm wide in x", "by 25.4: 4.57 mm"),
        (tilt, "0.17", "strategy.tilt_deg", "radians?", "9.7 degrees"),
        (tilt, "-0.17", "strategy.tilt_deg", "radians?", "-9.7 degrees"),
        (force, "500.0", "grip.force_n", "500 N is outside", "grams-force"),
        (speed, "3000.0", "\"touch\" speed_mm_per_s", "3000 mm/s is outside", "0.2 and 2000 mm/s"),
        (most, "0.05", "success.tilt_deg", "0.05 degrees", "2.9 degrees"),
    ];
    let others = [
        (shell, wide, "\"metal shell\" y_mm", "15.2 mm wide", "narrower than 15"),
        ("depth_mm = 12.0", "16.0", "success.depth_mm", "stops 12.57 mm", "at most 12"),
        (approach, "[-2.6, 0.0, -4.0]", "\"touch\" move_mm", "above the socket", "longer"),
        (push, "[0.0, 0.0, -10.0]", "\"assembly\" move_mm", "success requires 12", "z = -16"),
        (push, "[0.0, 0.0, 20.0]", "\"assembly\" move_mm", "goes up", "negative"),
        (touch, "[0.0, 0.0, 3.0]", "\"touch\" move_mm", "goes up", "negative"),
        (start, "[0.0, -0.0012, 0.051]", "strategy.start_mm", "is outside", "metres"),
        (grip, "1.6\nshoulder_z_mm = 1.7", "grip.tcp_z_mm", "is outside", "inches"),
        (faces, "[-6.6, 6.6]", "grip.faces_y_mm", "outside `grip block`", "[-6.2, 6.2]"),
        (faces, "[-5.0, 5.0]", "grip.faces_y_mm", "inside `grip block`", "[-6.2, 6.2]"),
        (neck, "[37.2, 39.96]", "\"neck\" z_mm", "gap of 1 mm to `taper`", "36.2"),
        (y, "[-9.0, 7.51]", "socket.opening_y_mm", "`wall at -y` begins", "-7.49"),
        (grip, "20\nshoulder_z_mm = 23.31", "grip.shoulder_z_mm", "plug reaches", "43.31"),
        (grip, "60\nshoulder_z_mm = 63.31", "grip.shoulder_z_mm", "no plug", "43.31"),
        (start, "[0.0, -1.2, 35.0]", "strategy.start_mm", "deep in", "z = 46.03"),
        (approach, "[-2.6, 0.0, -12.8]", "\"approach\" move_mm", "runs into", "z = -8.97"),
        (start, "[0.0, 22.2, 51.0]", "strategy.start_mm", "in y", "y = -1.13"),
        (start, "[22.0, -1.2, 51.0]", "strategy.start_mm", "from 19.4 to 24.4 mm in x", "x = 0.1"),
        (neck, "[33.2, 39.96]", "part \"taper\"", "3 mm deep in `neck`", "end where they meet"),
        (neck, "[36.2, 36.2015]", "\"neck\" z_mm", "0.0015 mm is outside", "1.50 mm"),
        ("mass_g = 5.0", "0.005", "plug.mass_g", "less than foam", "plastic"),
        (slip, "5.0", "grip.slip_limit_mm", "3.35 mm", "at most 3.0"),
    ];
    let all =
        units.map(|fault| (fault, true)).into_iter().chain(others.map(|fault| (fault, false)));
    for ((key, to, at, problem, remedy), only) in all {
        let (name, _) = key.split_once(" = ").unwrap();
        let found = problems(&changed(USB, key, &format!("{name} = {to}")).unwrap());
        let caught = found.iter().any(|found| {
            let parts = [(&found.key, at), (&found.problem, problem), (&found.remedy, remedy)];
            parts.iter().all(|(text, part)| text.contains(part))
        });
        assert!(caught && (found.len() == 1 || !only), "{to}: {found:#?}");
    }
    for (from, to) in [(most, "tilt_deg = 0.3"), (x, "x_mm = [-0.25, 0.25]")] {
        assert_eq!(problems(&changed(USB, from, to).unwrap()), [], "{to}");
    }
}

/// The file in another unit: nothing but that is said.
#[test]
fn a_file_in_another_unit_is_asked_about() {
    for (factor, unit) in [(1e-3, "metres"), (1.0 / 25.4, "inches")] {
        let mut file = toml::Value::Table(toml::from_str(USB).unwrap());
        scale(&mut file, factor, false);
        let task = Task::from_table(file.as_table().unwrap().clone(), "usb").unwrap();
        let found = problems(&task);
        assert!(found.iter().all(|found| found.problem.contains("is outside")), "{found:#?}");
        assert!(found.iter().any(|found| found.key == "plug.part" && found.remedy.contains(unit)));
    }
}

/// Scales every number of the keys in mm.
fn scale(value: &mut toml::Value, factor: f64, in_mm: bool) {
    match value {
        toml::Value::Float(number) if in_mm => *number *= factor,
        toml::Value::Integer(number) if in_mm => *value = (*number as f64 * factor).into(),
        toml::Value::Array(items) => items.iter_mut().for_each(|item| scale(item, factor, in_mm)),
        toml::Value::Table(table) => {
            table.iter_mut().for_each(|(key, item)| scale(item, factor, key.ends_with("_mm")));
        }
        _ => {}
    }
}

/// Flat plugs of 3 to 25 mm and round ones of 3 to 20 mm, with and without a body.
#[test]
fn drafted_tasks_insert_at_their_nominal_start() {
    for (plug, clearance_mm, body) in [
        ("8.25x2.4x6.65", 0.1, Some("12x6.5x20")),
        ("3x2x4", 0.1, Some("6x5x15")),
        ("25x15x20", 0.3, Some("30x20x30")),
        ("8x7x50", 0.15, None),
        ("3x6", 0.1, Some("8x6x14")),
        ("8x12", 0.1, Some("12x12x20")),
        ("20x20", 0.2, Some("24x24x25")),
        ("8x50", 0.1, None),
    ] {
        let task = drafted(plug, clearance_mm, body);
        assert_eq!(problems(&task), [], "{plug}");
        let trial = trial(&task);
        assert_eq!(trial.outcome, Outcome::Inserted, "{plug}: {}", explain(&task, &trial));
    }
}

/// The opening is that below the chamfer; one that lies in the wall or in the air is noticed all the same.
#[test]
fn a_chamfered_opening_is_where_its_walls_begin() {
    let plain = drafted("8x4x8", 0.2, Some("12x12x20"));
    for leg_mm in [0.1, 0.3, 0.5, 1.0, 2.0] {
        let task = plain.chamfered(leg_mm * MM);
        assert_eq!(problems(&task), [], "{leg_mm}");
        for off_mm in [-0.3, leg_mm + 0.3] {
            let [x, [low, high]] = task.opening;
            let wrong = [x, [low, high + off_mm * MM]];
            let found = problems(&Task { opening: wrong, ..task.clone() });
            let noticed = found.iter().any(|of| of.key == "socket.opening_y_mm");
            assert!(noticed, "{leg_mm} {off_mm}: {found:?}");
        }
    }
}

/// A part that is hardly held tips over, and is told so with what would help.
#[test]
fn a_failed_nominal_start_is_explained() {
    let mut task = drafted("8.25x2.4x6.65", 0.1, Some("12x6.5x20"));
    task.grip.force = 0.02;
    let trial = trial(&task);
    let text = explain(&task, &trial);
    assert!(matches!(trial.outcome, Outcome::Failed(_)));
    assert!(text.contains("tipped over") && text.contains("strategy.tilt_deg"), "{text}");
}

#[test]
fn a_task_is_made_shown_checked_and_used() {
    let folder = Studies::new();
    let path: &str = &folder.word("c.toml");
    let new =
        "task new c --plug 8.25x2.4x6.65 --clearance 0.1 --body 12x6.5x20 --engine fake --out";
    assert!(said(new, &[path]).succeeds().contains(path));
    said(new, &[path]).fails(2, &["exists", "--out"]);
    let other = folder.word("my rigid.toml");
    let next = format!("next          optimize task tune '{other}' --robot rigid --engine fake\n");
    said(&format!("task new c --like {path} --robot rigit --engine fake --out"), &[&other])
        .fails(2, &["did you mean `rigid`"]);
    let made = said(&new.replace(" --out", " --robot rigid --out"), &[&other]);
    made.says(&["robot         rigid\n", &next]);
    said("task check --engine fake", &[path]).says(&["robot         servo\n"]);
    let check = |more: &[&str]| said("task check --engine fake --json", &[&[path], more].concat());
    let drawn = check(&["--svg", &folder.word("c.svg")]).json();
    assert_eq!(drawn["valid"], true);
    assert_eq!(drawn["problems"], serde_json::json!([]));
    assert_eq!(drawn["nominal"]["outcome"], "inserted");
    let picture = folder.read("c.svg");
    roxmltree::Document::parse(&picture).unwrap();
    assert!(picture.contains("clearance") && picture.contains("assembly"));
    // What was made has a body that a wider one would not let in.
    let made = folder.read("c.toml");
    folder.file("c.toml", made.replace("y_mm = [-4.125, 4.125]", "y_mm = [-4.6, 4.6]"));
    let ran = check(&[]);
    ran.fails(2, &["problem"]);
    let found: Value = serde_json::from_str(&ran.stdout).unwrap();
    assert_eq!(found["valid"], false);
    assert!(found["problems"][0]["key"].as_str().unwrap().contains("y_mm"), "{found}");
    assert!(found["problems"][0]["remedy"].as_str().unwrap().contains("8.35"), "{found}");
    assert!(found["nominal"].is_null());
}

#[test]
fn a_task_is_copied_like_another_and_shown_as_it_is() {
    let folder = Studies::new();
    let out = &folder.word("my-usb.toml");
    said("task new my-usb --like usb --engine fake --out", &[out]).succeeds();
    let copy = Task::parse(&folder.read("my-usb.toml"), out).unwrap();
    let usb = Task::parse(USB, "usb").unwrap();
    assert_eq!(copy.name, "my-usb");
    assert_eq!((copy.plug, copy.strategy), (usb.plug, usb.strategy));
    assert_eq!(said("task show usb", &[]).succeeds(), USB);
    said("task show usc", &[]).fails(2, &["did you mean `usb`"]);
    optimize(&["task", "new", "a b", "--out", out]).fails(2, &["letters"]);
    optimize(&["task", "new", "a", "--out", out]).fails(2, &["--plug, --round or --pins"]);
    said("task new a --plug 8x3 --clearance 0.1", &[]).fails(2, &["8.25x2.4x6.65"]);
    said("task new a --plug 8x3x8 --clearance 0.1 --body 12x8x5", &[])
        .fails(2, &["--body", "9.4 mm"]);
}

/// A file that cannot be read is a problem, too, with its key.
#[test]
fn a_check_says_what_a_reader_finds() {
    let folder = Studies::new();
    let file = folder.file("bad.toml", USB.replace("mass_g = 5.0", "mass_g = 0.0"));
    let ran = said("task check --json", &[&file]);
    ran.fails(2, &["1 problem"]);
    assert!(ran.stdout.contains("\"key\":\"plug.mass_g\""), "{}", ran.stdout);
    // Each fault is a problem; one of a name of which only some are accepted does not end the list.
    let several = USB.replace("mass_g = 5.0", "").replace("force_n", "force");
    let lines = several.lines().filter(|line| !line.starts_with("hold = "));
    let file = folder.file("bad.toml", lines.collect::<Vec<_>>().join("\n"));
    let ran = said("task check --json", &[&file]);
    ran.fails(2, &["3 problems"]);
    let found: Value = serde_json::from_str(&ran.stdout).unwrap();
    let keys: Vec<_> =
        found["problems"].as_array().unwrap().iter().map(|one| &one["key"]).collect();
    assert_eq!((keys.len(), keys[0]), (3, &"grip.force".into()), "{keys:?}");
    for key in ["plug.mass_g", "grip.hold"] {
        assert!(keys.contains(&&key.into()), "{keys:?}");
    }
}

/// A rigid robot stops with the plug on the seat, 6 mm before the end of the push.
#[test]
fn a_robot_stop_at_the_seat_comes_first_with_a_push_that_avoids_it() {
    let check =
        |robot: &str| said("task check usb_a --json --robot", &[robot]).json()["warnings"].take();
    assert_eq!(check("servo"), serde_json::json!([]));
    let warned = check("rigid");
    let warned = warned[0].as_str().expect("a warning");
    assert!(warned.starts_with("the plug is seated, but the robot rigid stops"), "{warned}");
    let evaluate = "evaluate --task usb --robot rigid --density 20 --direction 10 --no-ribs";
    said(evaluate, &[]).says(&["Not usable as it is: the robot stops in 1"]);
    let push = said(evaluate, &["--json"]).json()["shorter_push"].take();
    let set = format!("task.{}={}", push["key"].as_str().expect("a key"), push["value_mm"]);
    let shorter = said(evaluate, &["--json", "--set", &set]).json();
    assert_eq!(shorter["shorter_push"], Value::Null);
    assert_eq!(
        [&shorter["range_mm"], &shorter["peak_force_n"]],
        [&push["range_mm"], &push["peak_force_n"]]
    );
    assert!(shorter["peak_force_n"].as_f64().is_some_and(|force| force < 225.0), "{shorter}");
}

#[test]
fn a_grip_that_carries_neither_weight_nor_drag_is_warned_of() {
    for file in TASKS {
        let task = Task::parse(file.text, file.file).unwrap();
        assert_eq!(weak_grip(&task, &trial(&task)), None, "{}", file.name);
    }
    let task = Task::parse(USB, "usb.toml").unwrap();
    let weak = changed(USB, "force_n = 5.0", "force_n = 0.05").unwrap();
    let warned = weak_grip(&weak, &trial(&task)).unwrap();
    let words = "grip.force_n: with 0.05 N the friction of the two pads is 0.10 N, less than ";
    assert!(warned.starts_with(words), "{warned}");
    assert!(warned.contains("the friction of the plug on the rim; give at least "), "{warned}");
    // 2 kg weigh 19.6 N; two pads with a friction of 1 hold twice the grip force.
    let heavy = changed(USB, "mass_g = 5.0", "mass_g = 2000.0").unwrap();
    let warned = weak_grip(&heavy, &trial(&task)).unwrap();
    assert!(
        warned.ends_with("less than 19.62 N, the weight of the plug; give at least 9.9 N"),
        "{warned}"
    );
    let folder = Studies::new();
    let weak = folder.file("weak.toml", USB.replace("force_n = 5.0", "force_n = 0.02"));
    let tuned = fake(&format!("task tune {weak} --dry-run --budget 60 --max-force-n 200"));
    let limit = "--max-force-n 200, but the robot servo stops at 150 N\n";
    assert!(tuned.stderr.contains(limit), "{}", tuned.stderr);
    for ran in [tuned, fake(&format!("evaluate --density 20 --direction 10 --task {weak}"))] {
        let words = "warning: grip.force_n: with 0.02 N the friction of the two pads is 0.04 N";
        assert!(ran.stderr.contains(words), "{}", ran.stderr);
    }
}

/// Triangles of an example mesh, mm.
fn triangles(name: &str) -> Vec<[Point3<f64>; 3]> {
    let file = format!("{}/examples/meshes/{name}.stl", env!("CARGO_MANIFEST_DIR"));
    let bodies = read(&std::fs::read(file).unwrap(), name).unwrap();
    bodies.into_iter().flat_map(|body| body.triangles).collect()
}

/// The triangles as OBJ, with numbers of normals and of a texture that mean nothing to a solid.
fn obj(triangles: &[[Point3<f64>; 3]]) -> String {
    let corner = |p: &Point3<f64>| format!("v {} {} {}\n", p.x, p.y, p.z);
    let face = |i: usize| format!("f {} {}//1 {}/2\n", 3 * i + 1, 3 * i + 2, 3 * i + 3);
    triangles.iter().flatten().map(corner).chain((0..triangles.len()).map(face)).collect()
}

/// Reads a number of a result.
fn number(found: &Value, key: &str) -> f64 {
    found[key].as_f64().unwrap_or_else(|| panic!("{key} in {found}"))
}

/// A bevelled outline with a rib and a chamfered pocket, in inches and turned, as drawn in mm: its play of 0.2 mm, its
/// depth of 8 mm less the slack of its floor, and its body are found again, and a tilted search that is wider than a
/// sweep.
#[test]
fn an_extruded_pair_is_imported_as_it_was_drawn() {
    let studies = Studies::new();
    let [plug, socket] = ["plug", "socket"].map(|body| {
        let turned = |p: Point3<f64>| Point3::new(p.z, p.x, p.y) / 25.4;
        let turned: Vec<_> =
            triangles(&format!("keyed-{body}")).iter().map(|t| t.map(turned)).collect();
        studies.file(&format!("{body}.obj"), obj(&turned))
    });
    let out = studies.word("keyed.toml");
    let import = "task import --json --unit in --plug";
    let found = optimize_line(&format!("{import} {plug} --socket {socket} --out {out}")).json();
    assert_eq!((found["unit"].as_str(), found["insert_along"].as_str()), (Some("in"), Some("-x")));
    for axis in ["x", "y"] {
        let clearance = number(&found, &format!("clearance_{axis}_mm"));
        assert!((clearance - 0.2).abs() < 0.03, "{clearance} mm along {axis}");
    }
    for (i, drawn) in [12.0, 8.0, 18.0].into_iter().enumerate() {
        assert!((found["body_mm"][i].as_f64().unwrap() - drawn).abs() < 0.2, "{found}");
    }
    // Depths are counted from a height inside the chamfer.
    let inside = "0.13 mm below the socket's top";
    assert!(found["found"].to_string().contains(&format!("z = 0 is {inside}")), "{found}");
    let written = studies.read("keyed.toml");
    for words in [&format!("opening, {inside};"), "`grip` is a block for the pads"] {
        assert!(written.contains(words), "{words} in {written}");
    }
    assert_eq!(found["check"]["problems"].as_array().map(Vec::len), Some(0), "{found}");
    assert!(number(&found["tuned"], "least_range_mm") > 3.0, "{}", found["tuned"]);
}

/// Corners that miss one another by less than 0.1 mm are joined, a corner on an edge is, too.
#[test]
fn small_gaps_are_mended() {
    let mut torn = triangles("keyed-plug");
    let whole = Surface::new(&torn, MM).unwrap();
    torn[0][0].x += 0.04;
    let [a, b, c] = torn.swap_remove(5);
    let middle = nalgebra::center(&a, &b);
    torn.extend([[a, middle, c], [middle, b, c]]);
    let mended = Surface::new(&torn, MM).unwrap();
    assert!((mended.volume() / whole.volume() - 1.0).abs() < 0.01);
}

/// A body of a file by its name or its number; what is left is the other.
#[test]
fn a_file_may_hold_both() {
    let text =
        "o Pin\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\no Box\nv 5 0 0\nv 6 0 0\nv 5 1 0\nf 4 5 6";
    let bodies = read(text.as_bytes(), "both.obj").unwrap();
    let at = |name: &str| {
        pick(&bodies, &[name.to_owned()], "both.obj").map(|[of, rest]| [of[0][0].x, rest[0][0].x])
    };
    assert_eq!((at("Box"), at("1")), (Ok([5.0, 0.0]), Ok([0.0, 5.0])));
    assert!(at("Lid").unwrap_err().to_string().contains("`Pin`, `Box`, shells 1 to 2"));
    // A binary STL names no body.
    let nameless = [Body { name: String::new(), ..bodies[0].clone() }];
    let error = pick(&nameless, &["foo".to_owned()], "one.stl").unwrap_err().to_string();
    assert!(error.ends_with("has no body `foo`; available: shell 1"), "{error}");
}

/// The paper's usb, whose plug has 3 mm of room: its shoulder meets the housing at 12.57 mm, as tasks/usb.toml says.
#[test]
fn a_loose_plug_finds_its_seat() {
    let studies = Studies::new();
    let [plug, socket] = ["plug", "socket"]
        .map(|body| format!("{}/examples/meshes/usb-{body}.stl", env!("CARGO_MANIFEST_DIR")));
    let out = studies.word("loose.toml");
    let slippery = USB.replace("plug_socket = 0.2", "plug_socket = 0.15");
    let like = studies.file("slippery.toml", slippery);
    let line = format!(
        "task import --json --engine fake --plug {plug} --socket {socket} --like {like} --out {out}"
    );
    let found = optimize_line(&line).json();
    let said = found["found"].to_string();
    for words in ["mate 12.57 mm", "z = 0 is on the socket's top"] {
        assert!(said.contains(words), "{words} in {said}");
    }
    assert!((number(&found, "clearance_mm") - 3.0).abs() < 0.1, "{found}");
    // Its mass is that of its own shape; friction is that of the other task.
    let (made, usb) = (studies.read("loose.toml"), Task::parse(USB, "usb").unwrap());
    assert!(made.contains("Weigh yours."), "{made}");
    let made = Task::parse(&made, "loose").unwrap();
    assert_eq!(made.friction.plug_socket, 0.15);
    assert_ne!(made.plug.mass, usb.plug.mass);
    // A mass in kg is noticed in an imported task, too.
    let text = studies.read("loose.toml");
    let line = text.lines().find(|line| line.starts_with("mass_g")).unwrap();
    let light = studies.file("kg.toml", text.replace(line, "mass_g = 0.005"));
    let ran = optimize_line(&format!("task check --json {light}"));
    ran.fails(2, &["problem"]);
    assert!(ran.stdout.contains("plug.mass_g"), "{}", ran.stdout);
}

/// A surface with a hole, faces that look to both sides, or no volume is no solid; one that looks inward is turned.
#[test]
fn a_surface_is_closed_and_looks_outward() {
    let whole = triangles("keyed-plug");
    let volume = Surface::new(&whole, MM).unwrap().volume();
    assert_eq!(Surface::new(&whole[1..], MM), None);
    let mut turned = whole.clone();
    turned[0].swap(1, 2);
    assert_eq!(Surface::new(&turned, MM), None);
    assert_eq!(Surface::new(&whole, 1e-3 * MM), None);
    let inward: Vec<_> = whole.iter().map(|t| [t[0], t[2], t[1]]).collect();
    let mended = Surface::new(&inward, MM).unwrap();
    assert!(mended.was_inward && (mended.volume() / volume - 1.0).abs() < 1e-9);
    assert!(read(b"hello", "p.stl").unwrap_err().to_string().contains("no faces"));
    for (bytes, file) in [(&b"ISO-10303-21;\nHEADER;"[..], "p.obj"), (b"", "p.STP")] {
        assert!(read(bytes, file).unwrap_err().to_string().contains("./python[step]"));
    }
    // The same solid as OBJ.
    let same = &read(obj(&whole).as_bytes(), "p.obj").unwrap()[0].triangles;
    let same = Surface::new(same, MM).unwrap();
    assert!((same.volume() - volume).abs() < 1e-6 * volume);
}

/// Every key that the types know is in docs/guide/tasks.md, and no other.
#[test]
fn the_document_has_every_key_and_no_other() {
    let document = include_str!("../docs/guide/tasks.md");
    let mut documented: Vec<&str> = document
        .lines()
        .filter(|line| line.starts_with("| `"))
        .flat_map(|line| line[2..].split(" | ").next().unwrap_or("").split(", "))
        .map(|key| key.trim_matches('`'))
        .collect();
    documented.sort_unstable();
    let mut known = Vec::new();
    explore("", &mut known);
    known.sort();
    known.dedup();
    assert_eq!(documented, known);
}

/// Asks the reader for the keys below a path, by one that no table has: its answer lists them.
fn explore(path: &str, known: &mut Vec<String>) {
    let lists = ["part", "phase", "coupling", "edges"];
    let keys = |extra: &[(&str, &str)]| -> Result<Vec<String>, String> {
        let mut value = toml::Table::new();
        for (key, word) in extra {
            value.insert((*key).to_owned(), (*word).into());
        }
        value.insert("?".to_owned(), 0.into());
        let mut inner = toml::Value::Table(value);
        for name in path.split('.').filter(|name| !name.is_empty()).rev() {
            if let ("part", Some(part)) = (name, inner.as_table_mut())
                && !part.contains_key("shape")
            {
                // What lies below a part is a box's.
                part.insert("shape".to_owned(), "box".into());
            }
            if lists.contains(&name) {
                inner = vec![inner].into();
            }
            inner = toml::Value::Table([(name.to_owned(), inner)].into_iter().collect());
        }
        let toml::Value::Table(table) = inner else { unreachable!("a table") };
        let message = Task::from_table(table, "t").unwrap_err().to_string();
        let listed = message.split_once("expected").and_then(|(_, after)| after.lines().next());
        match listed {
            Some(listed) => Ok(listed.split('`').skip(1).step_by(2).map(str::to_owned).collect()),
            None => Err(message),
        }
    };
    let short = |key: &str| {
        let path = format!("{path}.{key}");
        path.trim_start_matches('.').replace("plug.part", "part").replace("socket.part", "part")
    };
    let sections =
        "plug plug.latch socket grip friction finger strategy success success.mated limits";
    let sections: Vec<&str> = sections.split(' ').collect();
    let mut below = Vec::new();
    if path.ends_with("part") {
        known.push("part.shape".to_owned());
        for shape in keys(&[("shape", "?")]).unwrap() {
            below.extend(keys(&[("shape", &shape)]).unwrap());
        }
    } else {
        below = keys(&[]).unwrap();
    }
    assert!(!below.is_empty(), "{path}");
    for key in below {
        if !(path.is_empty() && sections.contains(&key.as_str())) {
            known.push(match key.as_str() {
                "part" => format!("{path}.part"),
                _ => short(&key),
            });
        }
        let path = if path.is_empty() { key.clone() } else { format!("{path}.{key}") };
        if sections.contains(&path.as_str()) || lists.contains(&&*key) {
            explore(&path, known);
        }
    }
}

/// A keyed round plug and a chamfered opening; the page that shows a task in three dimensions.
#[test]
fn a_header_of_pins_inserts_and_misses_by_one_pitch() {
    let studies = Studies::new();
    let file = studies.word("header.toml");
    optimize_line(&format!("task new header --pins 2x5 --clearance 0.2 --out {file}"))
        .says(&["no problems", "inserted 6.0 mm deep"]);
    let text = studies.read("header.toml");
    let again = "--pins 2x5 --pitch-mm 2.54 --pin-mm 0.64 --pin-length-mm 6 --clearance 0.2 --body 5.08x12.7x20";
    assert!(text.contains(again), "{text}");
    // Ten pins and their body; six bars, five columns of three webs, and a floor.
    assert_eq!(text.matches("[[plug.part]]").count(), 11);
    assert_eq!(text.matches("[[socket.part]]").count(), 6 + 15 + 1);
    let trial = format!("trial --task {file} --density 20 --direction 20 --offset-mm");
    let of = |offset_mm: &str| optimize_line(&format!("{trial}={offset_mm}"));
    of("0.4").says(&["inserted"]);
    of("2.54").says(&["plug missed"]);
    of("-2.54").says(&["plug missed"]);
    for (words, error) in [
        ("--pins 2x5 --pitch-mm 0.7", "it must be more than a hole, 0.84 mm"),
        ("--pins 2x5 --body 2x2x20", "cover all pins, 3.18 x 10.8 mm"),
        ("--pins 2x0", "ROWSxCOLUMNS"),
        ("--pins 20x20", "at most 100 pins"),
        ("--pins 2x5 --pin-mm 0", "0.1"),
        ("--pins 2x5 --round 8x12", "--round"),
    ] {
        optimize_line(&format!("task new a {words} --clearance 0.2")).fails(2, &[error]);
    }
}

#[test]
fn a_key_and_a_chamfer_are_in_the_file_and_the_task_is_shown() {
    let studies = Studies::new();
    let make = |words: &str, name: &str| {
        let new = format!("task new mine {words} --clearance 0.2 --body 12x12x20 --out");
        let next = "next          optimize task tune";
        optimize_line(&format!("{new} {}", studies.word(name))).says(&["no problems", next]);
        studies.read(name)
    };
    let keyed = make("--round 8x12 --key 2x1", "keyed.toml");
    let made = "Made by: optimize task new mine --round 8x12 --key 2x1 --clearance 0.2";
    assert!(keyed.contains(made), "{keyed}");
    assert!(keyed.contains("name = \"key\"") && keyed.contains("x_mm = [3.8"), "{keyed}");
    let chamfered = make("--plug 8x4x8 --chamfer-mm 0.5", "chamfered.toml");
    assert!(chamfered.contains("shape = \"hull\""), "{chamfered}");
    make("--plug 8.25x2.4x10 --chamfer-mm 0.3", "slight.toml");
    let narrow = studies.word("narrow.toml");
    let new = "task new a --plug 8x4x8 --clearance 0.2 --body 0.6x5x20 --out";
    let ran = optimize_line(&format!("{new} {narrow}"));
    ran.fails(1, &["1 problem"]);
    assert!(!ran.stdout.contains("next  "), "{}", ran.stdout);
    for (words, parts) in [
        ("--plug 8x4x8 --key 2x1", &["--key", "--plug"][..]),
        ("--round 8x12 --chamfer-mm 0.5", &["--chamfer-mm", "--round"]),
        ("--round 8x12 --key 2", &["WIDTHxHEIGHT"]),
        ("--round 8x12 --key 8x1", &["narrower than the plug"]),
        ("--round 8", &["DIAMETERxLENGTH"]),
        ("--round 8x8", &["--round", "8 mm long"]),
    ] {
        optimize_line(&format!("task new a {words} --clearance 0.1")).fails(2, parts);
    }
    let show = |words: &str| optimize_line(&format!("task show {words}"));
    let [chamfered, page] = ["chamfered.toml", "shown.html"].map(|name| studies.word(name));
    show(&format!("{chamfered} --html {page}")).succeeds();
    let page = studies.read("shown.html");
    assert!(page.contains("mine: ") && page.contains("nominal start with servo"));
    assert_eq!(show(&studies.word("keyed.toml")).succeeds(), keyed);
}
