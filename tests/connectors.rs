//! Connectors as they are drawn: several bodies, thin walls, mates in axes of their own.

use crate::common::{Ran, Studies, optimize};

/// Box: least and greatest corner, mm.
type Block = [[f64; 3]; 2];

fn block(x: [f64; 2], y: [f64; 2], z: [f64; 2]) -> Block {
    [[x[0], y[0], z[0]], [x[1], y[1], z[1]]]
}

/// Text STL of boxes that may touch, so that it has films between them; each axis goes to the place `to` says.
fn stl(blocks: &[Block], to: [usize; 3]) -> String {
    solid("part", blocks, to)
}

/// A triangle of such a file.
fn facet(corners: [[f64; 3]; 3]) -> String {
    let vertex = |[x, y, z]: [f64; 3]| format!("vertex {x} {y} {z}\n");
    format!("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", corners.map(vertex).concat())
}

/// A `solid` of such a file.
fn solid(name: &str, blocks: &[Block], to: [usize; 3]) -> String {
    const SIDES: [[usize; 4]; 6] =
        [[0, 2, 3, 1], [4, 5, 7, 6], [0, 1, 5, 4], [2, 6, 7, 3], [0, 4, 6, 2], [1, 3, 7, 5]];
    let mut text = format!("solid {name}\n");
    for block in blocks {
        let corner = |number: usize| {
            let mut place = [0.0; 3];
            (0..3).for_each(|axis| place[to[axis]] = block[(number >> axis) & 1][axis]);
            place
        };
        for [a, b, c, d] in SIDES {
            text += &facet([a, b, c].map(corner));
            text += &facet([a, c, d].map(corner));
        }
    }
    text + &format!("endsolid {name}\n")
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

/// Block of a size in x and y with rows, at these x, of holes at these y, of this half width.
fn sieve(size: [f64; 2], rows: &[(f64, &[f64])], hole: f64, z: [f64; 2]) -> Vec<Block> {
    let ([x, y], mut low_x, mut blocks) = (size.map(|side| side / 2.0), -size[0] / 2.0, Vec::new());
    for &(middle, holes) in rows {
        blocks.push(block([low_x, middle - hole], [-y, y], z));
        low_x = middle + hole;
        let mut low = -y;
        for high in holes.iter().map(|at| at - hole).chain([y]) {
            blocks.push(block([middle - hole, middle + hole], [low, high], z));
            low = high + 2.0 * hole;
        }
    }
    blocks.push(block([low_x, x], [-y, y], z));
    blocks
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
    let mut plug = vec![block([-3.1, 3.1], [-7.1, 7.1], [6.4, 16.0])];
    let row: Vec<f64> = (0..5).map(|j| (f64::from(j) - 2.0) * pitch).collect();
    plug.extend(sieve([6.2, 14.2], &[(-1.27, &row[..]), (1.27, &row[..])], 0.45, [0.0, 6.4]));
    [plug, socket]
}

/// Stamped shell of 0.3 mm with a seam and two windows about a tongue, and a plug with a slot for it, whose cable boot is
/// narrower than its body.
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
        vec![block([-2.0, 2.0], [-1.2, 1.2], [24.0, 34.0])],
    ];
    [plug.concat(), socket]
}

/// Nine pins, five and four, in a shell of 0.4 mm, and their block in another shell.
fn d_sub() -> [Vec<Block>; 2] {
    let rows: [(f64, Vec<f64>); 2] = [(-1.42, 5), (1.42, 4)].map(|(x, count)| {
        (x, (0..count).map(|j| (f64::from(j) - f64::from(count - 1) / 2.0) * 2.76).collect())
    });
    let pins = rows.iter().flat_map(|(x, ys)| ys.iter().map(|y| (*x, *y)));
    let pin = |(x, y): (f64, f64)| block([x - 0.5, x + 0.5], [y - 0.5, y + 0.5], [0.6, 6.0]);
    let mut plug = frame([9.0, 18.0], [8.2, 17.2], [0.0, 6.0]);
    plug.extend(pins.map(pin));
    plug.push(block([-6.0, 6.0], [-15.0, 15.0], [6.0, 20.0]));
    let rows = [0, 1].map(|i| (rows[i].0, &rows[i].1[..]));
    let mut socket = sieve([8.0, 17.0], &rows, 0.65, [-6.0, 0.0]);
    socket.push(block([-6.0, 6.0], [-15.0, 15.0], [-8.0, -6.0]));
    [plug, socket]
}

/// Plug with a bore, and the post that it goes about.
fn post() -> [Vec<Block>; 2] {
    let mut plug = frame([8.0, 9.0], [3.16, 4.2], [0.0, 6.0]);
    plug.push(block([-4.0, 4.0], [-4.5, 4.5], [6.0, 20.0]));
    let socket = vec![
        block([-1.5, 1.5], [-2.0, 2.0], [-5.0, 0.0]),
        block([-6.0, 6.0], [-7.0, 7.0], [-7.0, -5.0]),
    ];
    [plug, socket]
}

/// Plate with a hole and a bar that goes through.
fn through() -> [Vec<Block>; 2] {
    let plug = vec![block([-2.0, 2.0], [-4.0, 4.0], [0.0, 30.0])];
    [plug, frame([14.0, 18.0], [4.2, 8.2], [-5.0, 0.0])]
}

/// Prongs in as many holes, or a shell with a seam about a tongue, by a number; clearance, mm, in x and in y.
fn random(number: u64) -> ([Vec<Block>; 2], [f64; 2]) {
    let mut state = number.wrapping_add(17).wrapping_mul(0x9e37_79b9_7f4a_7c15);
    let mut random = |low: f64, high: f64| {
        state =
            state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        // Hundredths of a millimetre, as drawings have them.
        let value = low + (high - low) * (state >> 11) as f64 / (1_u64 << 53) as f64;
        (value * 100.0).round() / 100.0
    };
    let clearance = [random(0.05, 0.3), random(0.05, 0.3)];
    let (deep, wide) = (random(3.0, 6.0), random(2.0, 4.0));
    let about = |middle: f64, width: f64| [middle - width / 2.0, middle + width / 2.0];
    let (mut plug, mut socket) = (Vec::new(), Vec::new());
    let half;
    if number.is_multiple_of(3) {
        let (long, sheet) = (random(8.0, 12.0), random(0.2, 0.4));
        let inner = [wide + 1.4 + clearance[0], long + clearance[1]];
        let outer = inner.map(|side| side + 2.0 * sheet);
        half = outer.map(|side| side / 2.0);
        socket = frame(outer, inner, [-deep, 0.0]);
        // The second bar has a seam.
        let [[x, y, z], [u, v, w]] = socket[1];
        let at = random(-3.0, 3.0).clamp(x + 0.3, u - 0.3);
        socket[1] = block([x, at - 0.05], [y, v], [z, w]);
        socket.push(block([at + 0.05, u], [y, v], [z, w]));
        let tongue = [0.6, long - 3.0];
        socket.push(block(about(0.0, tongue[0]), about(0.0, tongue[1]), [-deep, -0.5]));
        let slot = [tongue[0] + clearance[0] + 0.1, tongue[1] + clearance[1] + 0.1];
        plug.extend(frame([wide + 1.4, long], slot, [0.0, deep]));
    } else {
        let count = 1 + number % 3 + number / 3 % 2;
        half = [wide / 2.0 + 1.5, 2.5 * count as f64];
        let mut low = -half[1];
        for i in 0..count {
            let (y, thick) = (5.0 * (i as f64 - (count - 1) as f64 / 2.0), 1.5 + 0.4 * i as f64);
            plug.push(block(about(0.0, wide), about(y, thick), [0.0, deep]));
            let [from, to] = about(y, thick + clearance[1]);
            socket.push(block([-half[0], half[0]], [low, from], [-deep, 0.0]));
            for side in [-1.0, 1.0] {
                let inner = side * (wide + clearance[0]) / 2.0;
                let x = [inner.min(side * half[0]), inner.max(side * half[0])];
                socket.push(block(x, [from, to], [-deep, 0.0]));
            }
            low = to;
        }
        socket.push(block([-half[0], half[0]], [low, half[1]], [-deep, 0.0]));
    }
    socket.push(block(
        [-half[0] - 1.0, half[0] + 1.0],
        [-half[1] - 1.0, half[1] + 1.0],
        [-deep - 2.0, -deep],
    ));
    plug.push(block([-half[0], half[0]], [-half[1], half[1]], [deep, deep + 14.0]));
    ([plug, socket], clearance)
}

/// Imports a pair of text STL files, and returns what the program says.
fn import(folder: &Studies, name: &str, [plug, socket]: [&str; 2]) -> Ran {
    let [plug, socket] = [("plug", plug), ("socket", socket)]
        .map(|(part, text)| folder.file(&format!("{name}-{part}.stl"), text));
    let out = folder.word(&format!("{name}.toml"));
    optimize(&["task", "import", "--plug", &plug, "--socket", &socket, "--out", &out, "--json"])
}

/// The same of a pair of which the plug lies on its side.
fn imported(folder: &Studies, name: &str, [plug, socket]: [Vec<Block>; 2]) -> Ran {
    import(folder, name, [&stl(&plug, [1, 2, 0]), &stl(&socket, [0, 1, 2])])
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
    // 0.2 mm in the shroud, 0.26 mm about the pins.
    inserts(&folder, "header", header(), [0.2, 0.2]);
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
    let found = inserts(&Studies::new(), "shell", shell(), [0.1, 0.1]);
    // Held by its body, across the second axis: the boot leaves no room for the roofs beside the wider faces.
    assert_eq!(found["jaws"], "y", "{found}");
    let held = [0, 1].map(|side| found["body_mm"][side].as_f64().unwrap());
    assert!((held[0] - 10.0).abs() < 1e-6 && (held[1] - 6.0).abs() < 1e-6, "{found}");
    assert!(found["found"].to_string().contains("not held larger faces 6.0 mm apart"), "{found}");
}

/// File of bodies that are called by their number, from 1.
fn assembly(bodies: &[Vec<Block>], to: [usize; 3]) -> String {
    (1..).zip(bodies).map(|(i, body)| solid(&format!("body {i}"), body, to)).collect()
}

/// Clearance in the task's x and y of one in those of the file, mm: jaws close along y.
fn in_task(found: &serde_json::Value, [x, y]: [f64; 2]) -> [(&'static str, f64); 2] {
    let turned = found["jaws"] == "x";
    [("clearance_x_mm", if turned { y } else { x }), ("clearance_y_mm", if turned { x } else { y })]
}

/// Asserts a pair's clearance in x and in y, mm.
fn assert_clearance(found: &serde_json::Value, clearance_mm: [f64; 2]) {
    for (axis, clearance) in in_task(found, clearance_mm) {
        let play = found[axis].as_f64().unwrap();
        assert!((play - clearance).abs() < 0.03, "{axis} {clearance} {found}");
    }
}

/// Asserts that a pair inserts, and its clearance, nothing of it left out.
fn inserts(
    folder: &Studies,
    name: &str,
    pair: [Vec<Block>; 2],
    clearance_mm: [f64; 2],
) -> serde_json::Value {
    let found = imported(folder, name, pair).json();
    assert_eq!(found["check"]["nominal"]["outcome"], "inserted", "{name}: {found}");
    assert_eq!(found["left_out"], serde_json::json!([]), "{name}");
    assert_clearance(&found, clearance_mm);
    found
}

/// A body of 9 x 14 mm, drawn in cm, whose wider faces reach beyond the pads.
#[test]
fn unit_and_axis_of_the_jaws_are_as_requested() {
    let folder = Studies::new();
    let body = block([-4.5, 4.5], [-7.0, 7.0], [8.0, 28.0]);
    let plug = [block([-3.0, 3.0], [-2.0, 2.0], [0.0, 8.0]), body];
    let mut socket = frame([24.0, 24.0], [6.2, 4.2], [-8.0, 0.0]);
    socket.push(block([-12.0, 12.0], [-12.0, 12.0], [-10.0, -8.0]));
    let in_cm = |of: &[Block]| of.iter().map(|of| of.map(|p| p.map(|mm| mm / 10.0))).collect();
    let in_mm = folder.file("socket-mm.stl", stl(&socket, [0, 1, 2]));
    let [plug, socket] = [("plug.stl", &plug[..]), ("socket.stl", &socket)].map(|(name, of)| {
        let scaled: Vec<Block> = in_cm(of);
        folder.file(name, stl(&scaled, [0, 1, 2]))
    });
    // What is found in the meshes needs no simulation.
    let import = |out: &str, more: &[&str]| {
        let words = ["task", "import", "--plug", &plug, "--socket", &socket, "--engine", "fake"];
        optimize(&[&words[..], &["--out", &folder.word(out)], more].concat())
    };
    for (jaws, apart) in [("x", 9.0), ("y", 14.0)] {
        let given = ["--unit", "cm", "--jaws", jaws, "--json"];
        let found = import(&format!("{jaws}.toml"), &given).json();
        assert_eq!((&found["unit"], &found["jaws"]), (&"cm".into(), &jaws.into()), "{found}");
        assert!((found["body_mm"][0].as_f64().unwrap() - apart).abs() < 0.01, "{found}");
    }
    let guessed = import("guessed.toml", &[]).stdout;
    assert!(guessed.starts_with("unit          in, guessed from the size (--unit)"), "{guessed}");
    assert!(folder.read("guessed.toml").contains("unit `in`, inserted along -z"));
    import("inch.toml", &["--unit", "inch"]).fails(2, &["possible values: mm, cm, in, m", "'in'"]);
    // 28 mm in cm fit no socket of 24 mm; as 28 and 240 mm, both are connectors.
    let mixed = ["task", "import", "--plug", &plug, "--socket", &in_mm];
    let sizes = "every side of the socket is 9 to 17 times that of the plug";
    optimize(&mixed).fails(2, &[sizes, "export both in one unit"]);
    let flat = folder.file("flat.stl", stl(&[block([0.0, 0.3], [0.0, 0.3], [0.0; 2])], [0, 1, 2]));
    let flat = ["task", "import", "--plug", &flat, "--socket", &in_mm];
    optimize(&flat).fails(2, &["flat.stl: the plug is flat; export a solid"]);
}

/// The boot is in the way across the first axis.
#[test]
fn a_requested_axis_that_cannot_be_held_is_refused() {
    let folder = Studies::new();
    let wide = block([-6.0, 6.0], [-55.0, 55.0], [0.0, 20.0]);
    let plug = [block([-2.0, 2.0], [-5.0, 5.0], [-8.0, 0.0]), wide];
    let mut socket = frame([18.0, 18.0], [4.2, 10.2], [-8.0, 0.0]);
    socket.push(block([-9.0, 9.0], [-9.0, 9.0], [-10.0, -8.0]));
    let plug = folder.file("plug.stl", stl(&plug, [0, 1, 2]));
    let socket = folder.file("socket.stl", stl(&socket, [0, 1, 2]));
    let out = folder.word("x.toml");
    let words = ["task", "import", "--plug", &plug, "--socket", &socket, "--jaws", "y"];
    let far = "--jaws y: the plug's faces 110.0 mm apart: they are too close or too far apart";
    optimize(&[&words[..], &["--out", &out]].concat()).fails(2, &[far, "--body"]);
    assert!(!folder.dir("x.toml").exists());
}

#[test]
fn a_shell_with_nine_pins_goes_about_their_block() {
    inserts(&Studies::new(), "d-sub", d_sub(), [0.2, 0.2]);
}

#[test]
fn a_bar_goes_through_a_plate() {
    let folder = Studies::new();
    let found = inserts(&folder, "through", through(), [0.2, 0.2]);
    assert!(found["found"].to_string().contains("nothing stops the plug: 5.00 mm"), "{found}");
    // No more of it can be below the top than there is.
    let again = ["--plug", &folder.word("through-plug.stl"), "--depth-mm", "300"];
    let [socket, out] = ["through-socket.stl", "deep.toml"].map(|name| folder.word(name));
    optimize(&[&["task", "import"], &again[..], &["--socket", &socket, "--out", &out]].concat())
        .fails(2, &["--depth-mm 300: plug and socket", "for at most 30 mm"]);
    assert!(!folder.dir("deep.toml").exists() && !folder.dir("deep.place.svg").exists());
}

/// A narrower nose of 3 mm ahead of the body, which guides the plug.
#[test]
fn depths_count_from_the_opening_of_a_plug_with_a_nose() {
    let folder = Studies::new();
    let plug = vec![
        block([-2.5, 2.5], [-6.0, 6.0], [0.0, 3.0]),
        block([-3.5, 3.5], [-8.0, 8.0], [3.0, 12.0]),
        block([-5.0, 5.0], [-9.5, 9.5], [12.0, 30.0]),
    ];
    let mut socket = frame([14.0, 24.0], [7.2, 16.2], [-16.0, 0.0]);
    socket.push(block([-7.0, 7.0], [-12.0, 12.0], [-18.0, -16.0]));
    let found = inserts(&folder, "nosed", [plug, socket], [0.2, 0.2]);
    assert!(
        found["found"]
            .to_string()
            .contains("9.00 mm of the plug's 30.00 mm engage, behind a nose of 3.00 mm"),
        "{found}"
    );
    assert!(found["found"].to_string().contains("z = 0 is on the socket's top"), "{found}");
    for offset_mm in ["-0.7", "0.7"] {
        assert_eq!(outcome(&folder, "nosed", offset_mm), "inserted", "{offset_mm}");
    }
    begins_inside(&folder, "nosed", 3.0);
    let [plug, socket] = ["nosed-plug.stl", "nosed-socket.stl"].map(|name| folder.read(name));
    import(&folder, "swapped", [&socket, &plug]).fails(2, &["are plug and socket swapped?"]);
}

/// Asserts that a start this much lower, mm, lets the approach end inside of the socket, and that the check names the
/// lowest start above it, as imported.
fn begins_inside(folder: &Studies, name: &str, lower_mm: f64) {
    let text = folder.read(&format!("{name}.toml"));
    let at = text.find("start_mm = [").unwrap();
    let start = text[at..].lines().next().unwrap();
    let z: f64 = start.trim_end_matches(']').rsplit(", ").next().unwrap().parse().unwrap();
    let low = start.replace(&format!("{z:.1}]"), &format!("{:.1}]", z - lower_mm));
    let inside = folder.file("inside.toml", text.replace(start, &low));
    let checked = optimize(&["task", "check", &inside]);
    checked.fails(2, &["1 problem"]);
    let right = format!("right: z = {z} mm at least");
    for words in ["`approach` ends inside of the socket", &right] {
        assert!(checked.stdout.contains(words), "{words}: {}", checked.stdout);
    }
}

/// A recess of 2 mm: the plug is guided below it, and starts above all of the socket.
#[test]
fn a_plug_starts_above_a_deep_lead_in() {
    let folder = Studies::new();
    let plug = vec![
        block([-3.5, 3.5], [-8.0, 8.0], [0.0, 16.0]),
        block([-5.0, 5.0], [-9.5, 9.5], [16.0, 34.0]),
    ];
    let mut socket = frame([14.0, 24.0], [7.2, 16.2], [-12.0, 0.0]);
    socket.extend(frame([14.0, 24.0], [11.2, 20.2], [0.0, 2.0]));
    socket.push(block([-7.0, 7.0], [-12.0, 12.0], [-14.0, -12.0]));
    let found = inserts(&folder, "recess", [plug, socket], [0.2, 0.2]);
    assert!(found["found"].to_string().contains("2.00 mm below the socket's top"), "{found}");
    assert_eq!(outcome(&folder, "recess", "0.7"), "inserted");
    begins_inside(&folder, "recess", 4.0);
    // A sheet counts depths from the top, which can be measured.
    let text = folder.read("recess.toml");
    let depth = text.split("[success]").nth(1).and_then(|rest| rest.split("depth_mm = ").nth(1));
    let depth: f64 = depth.unwrap().lines().next().unwrap().parse().unwrap();
    let [task, sheet] = ["recess.toml", "sheet.html"].map(|name| folder.word(name));
    optimize(&["measure", "sheet", "--task", &task, "--finger", "10,0", "--out", &sheet])
        .succeeds();
    let inserted = format!("at least {:.1} mm below the socket's top", depth + 2.0);
    // The plug cannot slide on the face in the recess.
    let plate = "a flat plate of the socket's material, ";
    let page = folder.read("sheet.html");
    assert!(page.contains(&inserted) && page.contains(plate), "{inserted}");
}

/// A key without a slot in the socket stops the plug after 2 mm; one with a slot on the other side, of a mirrored file.
#[test]
fn a_plug_that_stops_early_is_refused() {
    let folder = Studies::new();
    let key = |low: f64| block([3.5, 4.5], [3.0, 5.0], [low, 12.0]);
    let plug = |key: Block| {
        let body = block([-3.5, 3.5], [-8.0, 8.0], [0.0, 12.0]);
        vec![body, key, block([-5.0, 5.0], [-9.5, 9.5], [12.0, 30.0])]
    };
    // The well is deeper than the plug, whose flange ends on its edge.
    let floor = block([-7.0, 7.0], [-12.0, 12.0], [-32.0, -30.0]);
    let mut socket = frame([14.0, 24.0], [7.2, 16.2], [-30.0, 0.0]);
    socket.push(floor);
    let refused = imported(&folder, "keyed", [plug(key(2.0)), socket.clone()]);
    let stops = "the plug stops after 2.00 of 12.00 mm, beside its seat";
    refused.fails(2, &["keyed-plug.stl", stops, "--depth-mm 2.00"]);
    assert!(!folder.dir("keyed.toml").exists());
    let [file, other, out] =
        ["keyed-plug.stl", "keyed-socket.stl", "keyed.toml"].map(|name| folder.word(name));
    let given = ["--plug", &file, "--socket", &other, "--depth-mm", "2", "--out", &out, "--json"];
    let found = optimize(&[&["task", "import"], &given[..]].concat()).json();
    assert!(found["found"].to_string().contains(stops), "{found}");
    // The wall at +x begins at 3.6 mm, but for the slot.
    socket.retain(|[low, _]| low[0] < 3.0);
    let z = [-30.0, 0.0];
    socket.push(block([3.6, 7.0], [-8.1, -5.1], z));
    socket.push(block([3.6, 7.0], [-2.9, 8.1], z));
    socket.push(block([4.6, 7.0], [-5.1, -2.9], z));
    for (name, low, problem) in [
        ("mirrored", 8.0, "the plug stops after 8.00 of 12.00 mm"),
        ("flush", 0.0, "the plug does not fit into the socket"),
    ] {
        let refused = imported(&folder, name, [plug(key(low)), socket.clone()]);
        refused.fails(2, &[problem, "mirrored, it engages over 12.00 mm"]);
    }
}

/// A spring that the plug would push aside is listed, drawn, and out of the way.
#[test]
fn a_contact_spring_is_drawn_and_touches_nothing() {
    let folder = Studies::new();
    let [plug, mut socket] = header();
    socket.push(block([2.9, 3.2], [-1.0, 1.0], [3.0, 5.0]));
    let found = imported(&folder, "sprung", [plug, socket]).json();
    assert_clearance(&found, [0.2, 0.2]);
    let left_out = found["left_out"].as_array().unwrap();
    assert_eq!((left_out.len(), &left_out[0]["body"]), (1, &"socket".into()), "{found}");
    assert!(found["found"].to_string().contains("[mating_force]"), "{found}");
    assert_eq!(found["check"]["nominal"]["outcome"], "inserted", "{found}");
    let task = folder.word("sprung.toml");
    let page = folder.word("sprung.html");
    optimize(&["task", "show", &task, "--html", &page]).succeeds();
    assert!(folder.read("sprung.html").contains(r#""kind":"spring""#));
}

/// Plate with two slots for a bar, the second 0.1 mm deeper.
fn slots() -> [Vec<Block>; 2] {
    let z = [-8.1, 0.0];
    let across = [[-9.0, -4.1], [4.1, 15.9], [24.1, 29.0]].map(|y| block([-2.1, 2.1], y, z));
    let along = [[-7.0, -2.1], [2.1, 7.0]].map(|x| block(x, [-9.0, 29.0], z));
    let floor = block([-7.0, 7.0], [-9.0, 29.0], [-12.0, -8.1]);
    let step = block([-2.1, 2.1], [-4.1, 4.1], [-8.1, -8.0]);
    let [plug, _] = through();
    [plug, [&across[..], &along[..], &[floor, step]].concat()]
}

#[test]
fn another_of_several_poses_can_be_taken() {
    let folder = Studies::new();
    let [plug, socket] = slots();
    let plug = folder.file("plug.stl", stl(&plug, [0, 1, 2]));
    let socket = folder.file("socket.stl", stl(&socket, [0, 1, 2]));
    let out = folder.word("second.toml");
    let take = |pose: &str| {
        let words = ["task", "import", "--json", "--plug", &plug, "--socket", &socket];
        optimize(&[&words[..], &["--engine", "fake", "--out", &out, "--pose", pose]].concat())
    };
    for pose in ["0", "3"] {
        take(pose).fails(2, &["--pose", "between 1 and 2"]);
    }
    let found = take("2").json();
    let pose = |i: usize, key: &str| found["poses"][i][key].as_f64().unwrap();
    let depths = [0, 1].map(|i| pose(i, "depth_mm"));
    assert!((depths[0] - 8.1).abs() < 0.03 && (depths[1] - 8.0).abs() < 0.03, "{found}");
    assert_eq!(found["poses"][1]["insert_along"], "-z");
    assert!(found["poses"][0]["origin_mm"] != found["poses"][1]["origin_mm"], "{found}");
    let said = found["found"].to_string();
    for words in ["2 is taken (--pose): 1 along -z, 8.1", "; 2 along -z, 8.0", "mate 8.0"] {
        assert!(said.contains(words), "{words} in {said}");
    }
}

/// One shape as drawn, and with triangles missing where nothing touches it.
#[test]
fn an_open_mesh_is_the_same_shape() {
    let folder = Studies::new();
    let [plug, socket] = post().map(|blocks| stl(&blocks, [0, 1, 2]));
    let found = |name: &str, pair: [&str; 2]| import(&folder, name, pair).json();
    let drawn = found("drawn", [&plug, &socket]);
    assert_clearance(&drawn, [0.16, 0.2]);
    assert_eq!(drawn["left_out"], serde_json::json!([]));
    // The last facet of the plug is one of its handle, that of the socket one of its base.
    let open = [&plug, &socket]
        .map(|text| text[..text.rfind("facet normal").unwrap()].to_owned() + "endsolid part\n");
    let open = found("open", [&open[0], &open[1]]);
    for mesh in [&drawn, &open] {
        assert_eq!(mesh["check"]["nominal"]["outcome"], "inserted", "{mesh}");
    }
    for key in ["clearance_x_mm", "clearance_y_mm"] {
        let [a, b] = [&drawn, &open].map(|found| found[key].as_f64().unwrap());
        assert!((a - b).abs() < 0.02, "{key}: {a} {b}");
    }
}

/// Returns the random pairs of these numbers that do not insert with their clearance.
fn failing(numbers: std::ops::Range<u64>) -> Vec<String> {
    let folder = Studies::new();
    let fault = |number: u64| {
        let (pair, clearance) = random(number);
        let name = format!("random-{number}");
        let ran = imported(&folder, &name, pair);
        if ran.code != Some(0) {
            return Some(format!("{name}: {}", ran.stderr));
        }
        let found = ran.json();
        let off = in_task(&found, clearance)
            .into_iter()
            .any(|(axis, clearance)| (found[axis].as_f64().unwrap() - clearance).abs() > 0.03);
        let ended = &found["check"]["nominal"]["outcome"];
        (off || ended != "inserted").then(|| format!("{name}: {clearance:?} {ended} {found}"))
    };
    numbers.filter_map(fault).collect()
}

#[test]
fn random_sockets_insert() {
    let failing = failing(0..2);
    assert!(failing.is_empty(), "{failing:#?}");
}

#[test]
#[ignore = "takes minutes"]
fn of_50_random_sockets_48_insert() {
    let failing = failing(0..50);
    assert!(failing.len() <= 2, "{failing:#?}");
}

#[test]
fn an_assembly_is_taken_apart() {
    let folder = Studies::new();
    let [plug, socket] = shell();
    // Of several bodies those that are in contact stay together.
    let (tip, grip) = plug.split_at(5);
    let bodies = [&socket[..7], &socket[7..8], &socket[8..], tip, grip].map(<[Block]>::to_vec);
    let file = folder.file("lying.stl", assembly(&bodies, [1, 2, 0]));
    let out = folder.word("lying.toml");
    let found = optimize(&["task", "import", &file, "--out", &out, "--json"]).json();
    assert_eq!(found["check"]["nominal"]["outcome"], "inserted", "{found}");
    assert_eq!(found["insert_along"], "-x", "{found}");
    assert_clearance(&found, [0.1, 0.1]);
    let said = found["found"].to_string();
    assert!(said.contains("plug's bodies `body 4`, `body 5`;"), "{said}");
    // What is not mated cannot be withdrawn.
    let apart = tip.iter().map(|of| of.map(|[x, y, z]| [x + 30.0, y, z])).collect();
    let file = folder.file("apart.stl", assembly(&[socket, apart], [0, 1, 2]));
    optimize(&["task", "import", &file]).fails(2, &["apart.stl", "body 2", "--plug-body"]);
}

#[test]
fn a_depth_that_no_connector_has_and_a_handle_that_no_pads_can_hold_are_refused() {
    for depth in ["-1", "0", "1e12", "nan", "inf"] {
        let words = ["task", "import", "--plug", "p.stl", "--socket", "s.stl"];
        let ran = optimize(&[&words[..], &[&format!("--depth-mm={depth}")]].concat());
        ran.fails(2, &["--depth-mm", "between 0.4 and 300"]);
    }
    for size in ["10x12x2.9", "10x0.9x20", "101x12x20"] {
        let ran = optimize(&["task", "import", "p.stl", "--body", size]);
        ran.fails(2, &["--body: the pads need 1 to 100 mm", "a length of at least 3 mm"]);
    }
}

#[test]
fn what_names_no_plug_is_told_how() {
    optimize(&["task", "import"]).fails(2, &["ASSEMBLY", "--plug <P.stl>"]);
    let folder = Studies::new();
    let [plug, _] = through();
    // The name of the only body tells nothing about its shells.
    let one = folder.file(
        "one.stl",
        solid("", &[plug[0], plug[0].map(|[x, y, z]| [x + 9.0, y, z])], [0, 1, 2]),
    );
    optimize(&["task", "import", "--plug", &one]).fails(2, &["has the bodies `1`, `2`: give"]);
}

/// The pose is right, the depth is not.
#[test]
fn a_plug_is_not_pushed_below_its_seat() {
    let folder = Studies::new();
    let [plug, socket] = ["plug", "socket"]
        .map(|body| format!("{}/examples/meshes/keyed-{body}.stl", env!("CARGO_MANIFEST_DIR")));
    let out = folder.word("deep.toml");
    let pair = ["--plug", &plug, "--socket", &socket, "--out", &out, "--depth-mm", "12"];
    let ran = optimize(&[&["task", "import"], &pair[..]].concat());
    ran.fails(2, &["the plug stops 7.", "give at most that as --depth-mm"]);
    assert!(!folder.dir("deep.toml").exists());
}

#[test]
fn what_fits_nowhere_is_refused_and_nothing_is_written() {
    let folder = Studies::new();
    let wide = vec![block([-8.0, 8.0], [-9.0, 9.0], [0.0, 20.0])];
    let [_, socket] = shell();
    imported(&folder, "wide", [wide, socket]).fails(2, &["wide-plug.stl"]);
    assert!(!folder.dir("wide.toml").exists() && !folder.dir("wide.parts.toml").exists());
}
