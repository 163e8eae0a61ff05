//! Connectors as they are drawn: several bodies, thin walls, mates in axes of their own.

mod common;

use common::{Ran, Studies, optimize};
use std::fmt::Write;

/// Box: least and greatest corner, mm.
type Block = [[f64; 3]; 2];

fn block(x: [f64; 2], y: [f64; 2], z: [f64; 2]) -> Block {
    [[x[0], y[0], z[0]], [x[1], y[1], z[1]]]
}

/// Text STL of boxes that may touch, so that it has films between them; each axis goes to the place `to` says.
fn stl(blocks: &[Block], to: [usize; 3]) -> String {
    const SIDES: [[usize; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut text = "solid part\n".to_owned();
    for block in blocks {
        let corner = |number: usize| {
            let mut place = [0.0; 3];
            (0..3).for_each(|axis| place[to[axis]] = block[(number >> axis) & 1][axis]);
            place
        };
        for [a, b, c, d] in SIDES {
            for face in [[a, b, c], [a, c, d]] {
                text += "facet normal 0 0 0\nouter loop\n";
                for [x, y, z] in face.map(corner) {
                    writeln!(text, "vertex {x} {y} {z}").unwrap();
                }
                text += "endloop\nendfacet\n";
            }
        }
    }
    text + "endsolid part\n"
}

/// Frame of four bars about an opening.
fn frame(outer: [f64; 2], inner: [f64; 2], z: [f64; 2]) -> Vec<Block> {
    let ([a, b], [c, d]) = (outer.map(|side| side / 2.0), inner.map(|side| side / 2.0));
    vec![
        block([-a, a], [-b, -d], z),
        block([-a, a], [d, b], z),
        block([-a, -c], [-d, d], z),
        block([c, a], [-d, d], z),
    ]
}

/// Pin header of 2 x 5 pins of 0.64 mm at a pitch of 2.54 mm in a shroud, and its housing. Jaws close along y.
fn header() -> [Vec<Block>; 2] {
    let places = || (0..10).map(|i| [f64::from(i % 2) - 0.5, f64::from(i / 2) - 2.0]);
    let pitch = 2.54;
    let pin = |[i, j]: [f64; 2]| {
        let about = |middle: f64| [middle - 0.32, middle + 0.32];
        block(about(i * pitch), about(j * pitch), [0.0, 6.0])
    };
    let mut socket = frame([10.0, 18.0], [6.4, 14.4], [0.0, 7.0]);
    socket.push(block([-5.0, 5.0], [-9.0, 9.0], [-2.0, 0.0]));
    socket.extend(places().map(pin));
    // A grid of bars leaves holes of 0.9 mm.
    let (hole, ends) = (0.45, [6.2 / 2.0, 14.2 / 2.0]);
    let mut plug = vec![block([-ends[0], ends[0]], [-ends[1], ends[1]], [6.4, 16.0])];
    let rows = [-ends[0], -1.27 - hole, -1.27 + hole, 1.27 - hole, 1.27 + hole, ends[0]];
    for row in rows.chunks(2) {
        plug.push(block([row[0], row[1]], [-ends[1], ends[1]], [0.0, 6.4]));
    }
    for x in [-1.27, 1.27] {
        let mut low = -ends[1];
        for j in 0..=5 {
            let middle = (f64::from(j) - 2.0) * pitch;
            let high = if j == 5 { ends[1] } else { middle - hole };
            plug.push(block([x - hole, x + hole], [low, high], [0.0, 6.4]));
            low = middle + hole;
        }
    }
    [plug, socket]
}

/// Stamped shell of 0.3 mm with a seam and two windows about a tongue, and a plug with a slot for it.
fn shell() -> [Vec<Block>; 2] {
    let z = [0.0, 5.0];
    // The side at +y has a seam of 0.1 mm, the one at -y two windows.
    let mut socket = vec![
        block([-1.95, -1.65], [-4.8, 4.8], z),
        block([1.65, 1.95], [-4.8, -0.05], z),
        block([1.65, 1.95], [0.05, 4.8], z),
        block([-1.65, 1.65], [-4.8, -4.5], [0.0, 1.5]),
        block([-1.65, 1.65], [-4.8, -4.5], [3.0, 5.0]),
        block([-1.65, 1.65], [4.5, 4.8], [0.0, 1.5]),
        block([-1.65, 1.65], [4.5, 4.8], [3.0, 5.0]),
        block([-0.3, 0.3], [-3.3, 3.3], [0.0, 4.5]),
        block([-1.95, 1.95], [-4.8, 4.8], [-1.0, 0.0]),
    ];
    socket.push(block([-3.0, 3.0], [-6.0, 6.0], [-2.0, -1.0]));
    let plug = [
        frame([3.2, 8.9], [0.8, 6.8], [0.0, 4.8]),
        vec![block([-1.6, 1.6], [-4.45, 4.45], [4.8, 12.0])],
        vec![block([-3.0, 3.0], [-5.0, 5.0], [12.0, 24.0])],
    ];
    [plug.concat(), socket]
}

/// Imports a pair of which the plug lies on its side, and returns what the program says.
fn imported(folder: &Studies, name: &str, [plug, socket]: [Vec<Block>; 2]) -> Ran {
    let [plug_file, socket_file] = ["plug", "socket"].map(|part| format!("{name}-{part}.stl"));
    folder.file(&plug_file, stl(&plug, [1, 2, 0]));
    folder.file(&socket_file, stl(&socket, [0, 1, 2]));
    let [plug, socket, out] =
        [plug_file, socket_file, format!("{name}.toml")].map(|file| folder.word(&file));
    optimize(&["task", "import", "--plug", &plug, "--socket", &socket, "--out", &out, "--json"])
}

/// Outcome of a trial with an offset, mm.
fn outcome(folder: &Studies, name: &str, offset_mm: &str) -> String {
    let task = folder.word(&format!("{name}.toml"));
    let more = ["--stiffness-compliance", "3", "--stiffness-assembly", "30", "--json"];
    let ran =
        optimize(&[&["trial", "--task", &*task, "--offset-mm", offset_mm], &more[..]].concat());
    ran.json()["outcome"].as_str().unwrap().to_owned()
}

#[test]
fn a_header_inserts_and_misses_by_one_pitch() {
    let folder = Studies::new();
    let found = imported(&folder, "header", header()).json();
    assert_eq!(found["check"]["nominal"]["outcome"], "inserted", "{found}");
    assert_eq!(found["left_out"], serde_json::json!([]));
    // 0.2 mm in the shroud, 0.26 mm about the pins.
    for axis in ["clearance_x_mm", "clearance_y_mm"] {
        assert!((found[axis].as_f64().unwrap() - 0.2).abs() < 0.03, "{found}");
    }
    assert_eq!(outcome(&folder, "header", "0"), "inserted");
    assert_ne!(outcome(&folder, "header", "2.54"), "inserted");
    assert_ne!(outcome(&folder, "header", "-2.54"), "inserted");
    // The parts lie beside the task, which stays short and counts them by their hash.
    assert!(folder.read("header.toml").lines().count() < 300);
    folder.file("header.parts.toml", folder.read("header.parts.toml").replace("6.0", "6.1"));
    let checked = optimize(&["task", "check", &folder.word("header.toml")]);
    checked.fails(2, &["header.parts.toml"]);
}

#[test]
fn a_shell_with_a_seam_goes_about_its_tongue() {
    let folder = Studies::new();
    let found = imported(&folder, "shell", shell()).json();
    assert_eq!(found["check"]["nominal"]["outcome"], "inserted", "{found}");
    assert_eq!(found["left_out"], serde_json::json!([]));
    let near = |key: &str, mm: f64| (found[key].as_f64().unwrap() - mm).abs() < 0.03;
    assert!(near("clearance_x_mm", 0.1) && near("clearance_y_mm", 0.1), "{found}");
}

#[test]
fn a_depth_that_no_connector_has_is_refused() {
    for depth in ["-1", "0", "1e12", "nan", "inf"] {
        let words = ["task", "import", "--plug", "p.stl", "--socket", "s.stl"];
        let ran = optimize(&[&words[..], &[&format!("--depth-mm={depth}")]].concat());
        ran.fails(2, &["--depth-mm", "0.4 .. 300"]);
    }
}

#[test]
fn what_fits_nowhere_is_refused_and_nothing_is_written() {
    let folder = Studies::new();
    let wide = vec![block([-8.0, 8.0], [-9.0, 9.0], [0.0, 20.0])];
    let [_, socket] = shell();
    imported(&folder, "wide", [wide, socket]).fails(2, &["wide-plug.stl"]);
    assert!(!folder.dir("wide.toml").exists() && !folder.dir("wide.parts.toml").exists());
}
