//! Shapes with a known mate, in frames turned and shifted at random.

use super::frame::turns;
use super::*;
use nalgebra::{Translation3, UnitQuaternion};

static NEVER: AtomicBool = AtomicBool::new(false);

/// Position known within, m.
const CLOSE: f64 = 0.02e-3;
/// Play known within, m: half a cell of the map, whose multiples all plays are here.
const PLAY_CLOSE: f64 = 0.0025e-3;

type Mesh = Vec<Triangle>;

fn mm(x: f64, y: f64, z: f64) -> Point3<f64> {
    Point3::new(x * MM, y * MM, z * MM)
}

/// Solid between two closed lines of as many corners, mm: the outer and the inner one.
fn ring(outer: &[[f64; 2]], inner: &[[f64; 2]], [low, high]: [f64; 2]) -> Mesh {
    let mut mesh = Vec::new();
    for i in 0..outer.len() {
        let j = (i + 1) % outer.len();
        let at = |p: [f64; 2], z: f64| mm(p[0], p[1], z);
        let mut quad = |[a, b, c, d]: [Point3<f64>; 4]| mesh.extend([[a, b, c], [a, c, d]]);
        let ([oi, oj], [ii, ij]) = ([outer[i], outer[j]], [inner[i], inner[j]]);
        quad([at(oi, low), at(oj, low), at(oj, high), at(oi, high)]);
        quad([at(ij, low), at(ii, low), at(ii, high), at(ij, high)]);
        quad([at(oi, high), at(oj, high), at(ij, high), at(ii, high)]);
        quad([at(oj, low), at(oi, low), at(ii, low), at(ij, low)]);
    }
    mesh
}

/// Solid of a line that is seen whole from its middle, mm.
fn solid(line: &[[f64; 2]], range: [f64; 2]) -> Mesh {
    let middle = [0, 1].map(|a| line.iter().map(|p| p[a]).sum::<f64>() / line.len() as f64);
    ring(line, &vec![middle; line.len()], range)
}

fn rectangle([x, y]: [f64; 2], [a, b]: [f64; 2]) -> Vec<[f64; 2]> {
    let (a, b) = (a / 2.0, b / 2.0);
    vec![[x - a, y - b], [x + a, y - b], [x + a, y + b], [x - a, y + b]]
}

/// Walls about an opening, mm.
fn tube(at: [f64; 2], outer: [f64; 2], inner: [f64; 2], range: [f64; 2]) -> Mesh {
    ring(&rectangle(at, outer), &rectangle(at, inner), range)
}

fn block(at: [f64; 2], size: [f64; 2], range: [f64; 2]) -> Mesh {
    solid(&rectangle(at, size), range)
}

/// Sides and lower end of a tapered block with these sizes at its ends, mm.
fn taper([low, high]: [[f64; 2]; 2], [bottom, top]: [f64; 2]) -> Mesh {
    let at = |line: Vec<[f64; 2]>, z: f64| -> Vec<_> {
        line.into_iter().map(|[x, y]| mm(x, y, z)).collect()
    };
    let (a, b) = (at(rectangle([0.0; 2], low), bottom), at(rectangle([0.0; 2], high), top));
    let side = |i: usize| {
        let j = (i + 1) % 4;
        [[a[i], a[j], b[j]], [a[i], b[j], b[i]]]
    };
    let end = [[a[0], a[2], a[1]], [a[0], a[3], a[2]]];
    (0..4).flat_map(side).chain(end).collect()
}

/// Mesh in another frame, and the pose of that frame in its own.
fn hidden(mesh: &Mesh, number: usize) -> (Mesh, Isometry3<f64>) {
    let turn = UnitQuaternion::from_rotation_matrix(&turns()[number % 24]);
    let shift = [number as f64 * 1.37, 3.1 - number as f64, 0.77].map(|v| v * MM);
    let pose = Isometry3::from_parts(Translation3::from(shift), turn);
    (mesh.iter().map(|t| t.map(|p| pose * p)).collect(), pose)
}

/// Mate of parts that are drawn mated, each in a frame of its own, in the frame drawn; and how many
/// are equal.
fn found(plug: &Mesh, socket: &Mesh, number: usize) -> (Mate, usize) {
    let ((plug, p), (socket, s)) = (hidden(plug, number), hidden(socket, 3 * number + 1));
    let MatingResult { mut mates, copies } = mates(&plug, &socket, &NEVER).expect("mates");
    assert_eq!(mates.len(), 1, "ambiguous: {mates:#?}");
    let mate = mates.remove(0);
    let back = s.inverse();
    let out = Unit::new_normalize(back * mate.out.into_inner());
    let across = mate.across.map(|axis| Unit::new_normalize(back * axis.into_inner()));
    (Mate { pose: back * mate.pose * p, out, across, ..mate }, copies)
}

/// Asserts that the mate leaves a point of the plug, mm, where it was drawn, and its play, mm.
fn close(mate: &Mate, at: [f64; 3], play: [f64; 2]) {
    let point = mm(at[0], at[1], at[2]);
    let off = (mate.pose * point - point).norm();
    assert!(off < CLOSE, "off by {off}: {mate:?}");
    assert!((mate.out.z - 1.0).abs() < 1e-6, "{mate:?}");
    for (axis, measured) in mate.across.iter().zip(mate.play_m) {
        let expected = MM * if axis.x.abs() > 0.5 { play[0] } else { play[1] };
        assert!((measured - expected).abs() < PLAY_CLOSE, "{expected} {mate:?}");
    }
}

fn peg(size: [f64; 2]) -> Mesh {
    [block([0.0; 2], size, [0.0, 6.0]), block([0.0; 2], [size[0] + 2.0, size[1] + 1.5], [4.0, 9.0])]
        .concat()
}

fn hole(outer: [f64; 2], inner: [f64; 2], depth: f64) -> Mesh {
    let walls = tube([0.0; 2], outer, inner, [4.0 - depth, 4.0]);
    [walls, block([0.0; 2], outer, [-3.0, 4.0 - depth])].concat()
}

#[test]
fn peg_rests_in_its_hole() {
    let (mate, count) = found(&peg([3.0, 2.0]), &hole([6.0, 5.0], [3.1, 2.16], 4.0), 5);
    close(&mate, [0.0, 0.0, 2.0], [0.1, 0.16]);
    assert_eq!(count, 2);
    assert!((mate.engaged_m - 4.0 * MM).abs() < CLOSE, "{mate:?}");
    assert!(!mate.through, "{mate:?}");
    // The tip is on the floor and the body 0.3 mm above the socket.
    let (mate, _) = found(&peg([3.0, 2.0]), &hole([6.0, 5.0], [3.1, 2.16], 3.7), 5);
    assert_eq!(mate.missed_m, 0.0, "{mate:?}");
}

/// A nose of 3 mm, with 2 mm of play, ahead of the body.
/// Plays that are no multiples of a cell.
#[test]
fn a_play_between_two_cells_is_known_within_one() {
    let (mate, _) = found(&peg([3.0, 2.0]), &hole([6.0, 5.0], [3.213, 2.147], 4.0), 3);
    let mut play = mate.play_m;
    play.sort_by(f64::total_cmp);
    for (measured, drawn) in play.into_iter().zip([0.147, 0.213]) {
        assert!((measured - drawn * MM).abs() < 2.0 * PLAY_CLOSE, "{mate:?}");
    }
}

#[test]
fn a_narrower_nose_is_ahead_of_the_part_that_engages() {
    let nose = block([0.0; 2], [12.0, 5.0], [-12.0, -9.0]);
    let body = block([0.0; 2], [16.0, 7.0], [-9.0, 10.0]);
    let plug = [nose, body, block([0.0; 2], [20.0, 11.0], [10.0, 14.0])].concat();
    let socket = tube([0.0; 2], [24.0, 14.0], [16.2, 7.3], [-12.0, 4.0]);
    let floor = block([0.0; 2], [24.0, 14.0], [-14.0, -12.0]);
    let (mate, _) = found(&plug, &[socket, floor].concat(), 4);
    close(&mate, [0.0, 0.0, -12.0], [0.2, 0.3]);
    assert!((mate.nose_m - 3.0 * MM).abs() < CLOSE, "{mate:?}");
    assert!((mate.depth_m() - 16.0 * MM).abs() < CLOSE, "{mate:?}");
    let (mate, _) = found(&peg([3.0, 2.0]), &hole([6.0, 5.0], [3.1, 2.16], 4.0), 5);
    assert!(mate.nose_m < CLOSE, "{mate:?}");
}

/// Tip with a chamfer 0.4 mm high.
#[test]
fn a_chamfer_of_the_tip_adds_nothing_to_the_depth() {
    let narrower = |p: Point3<f64>| match p.z > 0.0 {
        true => p,
        false => Point3::new(0.8 * p.x, 0.8 * p.y, p.z),
    };
    let tip = block([0.0; 2], [3.0, 2.0], [0.0, 0.4]).iter().map(|t| t.map(narrower)).collect();
    let body = block([0.0; 2], [3.0, 2.0], [0.4, 6.0]);
    let plug = [tip, body, block([0.0; 2], [5.0, 3.5], [4.0, 9.0])].concat();
    let (mate, _) = found(&plug, &hole([6.0, 5.0], [3.1, 2.16], 4.0), 5);
    close(&mate, [0.0; 3], [0.1, 0.16]);
    assert!((mate.depth_m() - 4.0 * MM).abs() < 1e-3 * MM, "{mate:?}");
}

/// A key on one side, at a corner, and the slot for it or for its mirror image.
#[test]
fn a_key_beside_its_slot_stops_the_plug_early() {
    let keyed = |low: f64| {
        let key = block([3.95, 4.0], [1.1, 2.0], [low, 12.0]);
        let flange = block([0.0; 2], [10.0, 19.0], [12.0, 30.0]);
        [block([0.0; 2], [7.0, 16.0], [0.0, 12.0]), key, flange].concat()
    };
    let walls = [
        tube([0.0; 2], [18.0, 28.0], [9.2, 24.0], [0.0, 12.0]),
        block([0.0, 10.05], [9.2, 3.9], [0.0, 12.0]),
        block([0.0, -10.05], [9.2, 3.9], [0.0, 12.0]),
        block([-4.1, 0.0], [1.0, 16.2], [0.0, 12.0]),
        // The slot is between these two.
        block([4.1, 6.6], [1.0, 3.0], [0.0, 12.0]),
        block([4.1, -2.6], [1.0, 11.0], [0.0, 12.0]),
        block([0.0; 2], [18.0, 28.0], [-2.0, 0.0]),
    ];
    let socket = walls.concat();
    let (mate, _) = found(&keyed(2.0), &socket, 4);
    assert_eq!(mate.missed_m, 0.0, "{mate:?}");
    assert!((mate.engaged_m - 12.0 * MM).abs() < CLOSE, "{mate:?}");
    for low in [2.0, 8.0] {
        let (mate, _) = found(&mirrored(&keyed(low)), &socket, 4);
        assert!((mate.engaged_m - low * MM).abs() < CLOSE, "{mate:?}");
        assert!((mate.missed_m - (12.0 - low) * MM).abs() < 0.2 * MM, "{mate:?}");
    }
    assert_eq!(mates(&mirrored(&keyed(0.0)), &socket, &NEVER), Err(MatingError::NoFit));
}

/// The spring overlaps the plug by 0.2 mm, more than the plug can move.
#[test]
fn a_spring_on_one_side_is_left_out_of_the_play() {
    let spring = block([1.45, 0.0], [0.3, 0.6], [1.0, 2.0]);
    let socket = [hole([6.0, 5.0], [3.2, 2.2], 4.0), spring].concat();
    close(&found(&peg([3.0, 2.0]), &socket, 5).0, [0.0, 0.0, 2.0], [0.2, 0.2]);
}

/// The key has the play of the plug, and the spring, which overlaps the plug by 0.3 mm, is on another side. The taper lets
/// the plug rest deepest in a corner, where it overlaps less of the spring.
#[test]
fn a_spring_beside_a_key_is_left_out_of_the_play() {
    let tip = taper([[9.2, 3.2], [10.0, 4.0]], [-8.0, -6.8]);
    let blade = block([0.0; 2], [10.0, 4.0], [-6.8, 0.0]);
    let key = block([5.4, 0.0], [0.8, 1.5], [-5.0, 0.0]);
    let plug = [tip, blade, key, block([0.0; 2], [14.0, 9.0], [0.0, 18.0])].concat();
    let socket = [
        tube([0.0; 2], [18.0, 12.0], [11.9, 4.2], [-8.0, 0.0]),
        block([-5.525, 0.0], [0.85, 4.2], [-8.0, 0.0]),
        block([5.525, 1.475], [0.85, 1.25], [-8.0, 0.0]),
        block([5.525, -1.475], [0.85, 1.25], [-8.0, 0.0]),
        block([0.0, 1.9], [2.0, 0.4], [-6.0, -3.5]),
        block([0.0; 2], [18.0, 12.0], [-10.0, -8.0]),
    ];
    // Frames in which the search ends in a corner or, in the last one, without the pass for stiff springs, on the key.
    for number in [0, 8, 12, 13, 16, 1] {
        close(&found(&plug, &socket.concat(), number).0, [0.0; 3], [0.2, 0.2]);
    }
}

/// The tongue lies behind the walls of the shell, nearer than the distance up to which walls are sought. Springs in the
/// socket overlap the shell on one, two or three sides.
#[test]
fn a_tongue_in_a_shell_is_no_wall_outside_of_it() {
    let shell = tube([0.0; 2], [8.2, 2.4], [7.4, 1.7], [0.0, 6.0]);
    let plug = [shell, block([0.0; 2], [10.0, 4.0], [6.0, 10.0])].concat();
    let socket = [
        tube([0.0; 2], [10.0, 4.0], [8.4, 2.6], [0.0, 5.0]),
        block([0.0; 2], [6.6, 0.7], [0.0, 5.0]),
        block([0.0; 2], [10.0, 4.0], [-2.0, 0.0]),
    ];
    // In the last one, two poses at different springs have one seat.
    let cases = [(0.05, 1, 11), (0.05, 2, 5), (0.25, 3, 0), (0.25, 2, 17), (0.05, 3, 8)];
    for (overlap, sides, number) in cases {
        let height = overlap + 0.2;
        let along_y =
            |x: f64, side: f64| block([x, side * (1.3 - height / 2.0)], [0.8, height], [1.0, 3.0]);
        let along_x = block([4.2 - height / 2.0, 0.3], [height, 0.6], [1.0, 3.0]);
        let springs = [along_y(-2.0, 1.0), along_y(2.0, 1.0), along_x, along_y(0.0, -1.0)];
        let socket = [socket.concat(), springs[..=sides].concat()].concat();
        close(&found(&plug, &socket, number).0, [0.0; 3], [0.2, 0.2]);
    }
}

/// The springs overlap the card by most of its thickness, the cover is thinner than they are wide, and walls would face
/// the card below the bar that stops it.
#[test]
fn a_card_rests_on_a_bar_behind_springs_below_a_thin_cover() {
    let plug =
        [block([0.0, 0.65], [10.0, 1.2], [0.0, 5.5]), block([0.0, 0.65], [12.0, 1.2], [5.5, 15.0])];
    let mut socket = [
        block([0.0, -0.3], [12.0, 0.6], [-0.5, 5.0]),
        block([0.0, 1.4], [12.0, 0.2], [-0.5, 5.0]),
        block([-5.525, 0.65], [0.95, 1.3], [-0.5, 5.0]),
        block([5.525, 0.65], [0.95, 1.3], [-0.5, 5.0]),
        block([0.0, 0.65], [9.0, 0.8], [-0.5, 0.0]),
        // Legs: the bar is far above the lowest point.
        block([-5.5, -0.4], [0.8, 0.4], [-9.0, -0.5]),
        block([5.5, -0.4], [0.8, 0.4], [-9.0, -0.5]),
    ]
    .concat();
    for x in [-4.0, -2.5, -1.0, 1.0, 2.5, 4.0] {
        socket.extend(block([x, 0.45], [0.4, 0.9], [1.5, 2.5]));
    }
    for number in [5, 12] {
        let (mate, _) = found(&plug.concat(), &socket, number);
        close(&mate, [0.0, 0.65, 0.0], [0.1, 0.1]);
        assert!((mate.depth_m() - 5.0 * MM).abs() < CLOSE, "{mate:?}");
        assert_eq!(mate.missed_m, 0.0, "{mate:?}");
    }
}

/// A press fit has no walls that could be springs.
#[test]
fn a_press_fit_has_little_play() {
    let (mate, _) = found(&peg([3.0, 2.0]), &hole([6.0, 5.0], [2.92, 2.2], 4.0), 5);
    assert!(mate.play_m.iter().all(|play| *play < 0.5 * MM), "{mate:?}");
}

#[test]
fn plug_goes_round_a_post() {
    let socket =
        [block([0.0; 2], [8.0, 7.0], [-2.0, 0.0]), block([0.0; 2], [3.0, 2.0], [0.0, 5.0])];
    let plug = tube([0.0; 2], [5.0, 4.2], [3.12, 2.08], [0.0, 4.0]);
    let plug = [plug, block([0.0; 2], [5.0, 4.2], [5.5, 8.0])].concat();
    let (mate, _) = found(&plug, &socket.concat(), 7);
    close(&mate, [0.0, 0.0, 1.0], [0.12, 0.08]);
}

/// A washer on a rod four times as long, square, so that one mate of eight is as good as any.
#[test]
fn ring_goes_round_a_post_longer_than_itself() {
    let plug = tube([0.0; 2], [9.0, 8.0], [4.2, 3.3], [0.0, 5.0]);
    let mut socket = block([0.0; 2], [16.0, 16.0], [-4.0, 0.0]);
    socket.extend(block([0.0; 2], [4.0, 3.0], [0.0, 20.0]));
    let (mate, count) = found(&plug, &socket, 3);
    assert_eq!(count, 4, "{mate:?}");
    assert!((mate.engaged_m - 20.0 * MM).abs() < CLOSE, "{mate:?}");
}

/// A peg in a deep bore with 2.4 mm of play, beside a recess of 1.2 mm that it fits.
#[test]
fn deep_bore_counts_more_than_a_tight_recess() {
    let (bore, recess) = ([0.0; 2], [8.0, 0.0]);
    let socket = [
        tube(bore, [8.0, 8.0], [5.4, 4.4], [-30.0, 0.0]),
        block(bore, [8.0, 8.0], [-34.0, -30.0]),
        tube(recess, [8.0, 8.0], [3.2, 2.2], [-1.2, 0.0]),
        block(recess, [8.0, 8.0], [-34.0, -1.2]),
    ];
    let (mate, _) = found(&block(bore, [3.0, 2.0], [-30.0, 10.0]), &socket.concat(), 5);
    assert!((mate.engaged_m - 30.0 * MM).abs() < CLOSE, "{mate:?}");
}

#[test]
fn a_through_hole_has_no_stop() {
    let socket = tube([0.0; 2], [7.0, 6.0], [3.1, 2.1], [0.0, 4.0]);
    let (mate, _) = found(&block([0.0; 2], [3.0, 2.0], [0.0, 12.0]), &socket, 2);
    assert!(mate.through, "{mate:?}");
    // Either side is as good.
    assert!((mate.out.z.abs() - 1.0).abs() < 1e-6);
    assert!((mate.engaged_m - 4.0 * MM).abs() < CLOSE, "{mate:?}");
}

#[test]
fn header_mates_by_its_shroud_and_not_a_pitch_beside_it() {
    let places = || (0..5).flat_map(|i| [-1.27, 1.27].map(|y| [2.54 * f64::from(i) - 5.08, y]));
    let mut socket = tube([0.0; 2], [16.0, 9.0], [13.2, 5.6], [0.0, 8.0]);
    socket.extend(block([0.0; 2], [16.0, 9.0], [-2.0, 0.0]));
    places().for_each(|at| socket.extend(block(at, [0.64; 2], [0.0, 6.0])));
    // The housing is a grid of bars about its holes.
    let mut plug = block([0.0; 2], [13.0, 5.4], [7.5, 14.0]);
    let xs: Vec<f64> = (0..5).map(|i| 2.54 * f64::from(i) - 5.08).collect();
    for pair in [vec![-6.9], xs.clone(), vec![6.9]].concat().windows(2) {
        let [low, high] = [(pair[0] + 0.4).max(-6.5), (pair[1] - 0.4).min(6.5)];
        plug.extend(block([(low + high) / 2.0, 0.0], [high - low, 5.4], [0.0, 7.5]));
    }
    for x in xs {
        for (y, width) in [(-2.185, 1.03), (0.0, 1.74), (2.185, 1.03)] {
            plug.extend(block([x, y], [0.8, width], [0.0, 7.5]));
        }
    }
    let (mate, count) = found(&plug, &socket, 4);
    close(&mate, [0.0, 0.0, 0.0], [0.16, 0.16]);
    assert_eq!(count, 2);
}

/// Of two rows of eight pins 45 seats are as deep: all pins engage in one alone.
#[test]
fn pins_without_a_shroud_mate_with_all_their_holes() {
    let xs: Vec<f64> = (0..8).map(|i| 2.54 * f64::from(i) - 8.89).collect();
    let mut plug = block([0.0; 2], [20.3, 5.0], [6.0, 8.5]);
    let mut socket = block([0.0; 2], [20.8, 5.4], [-2.0, -0.2]);
    for x in &xs {
        for y in [-1.27, 1.27] {
            plug.extend(block([*x, y], [0.64; 2], [0.0, 6.0]));
        }
        for (y, width) in [(-2.21, 0.98), (0.0, 1.64), (2.21, 0.98)] {
            socket.extend(block([*x, y], [0.9, width], [-0.2, 6.0]));
        }
    }
    for pair in [vec![-10.85], xs, vec![10.85]].concat().windows(2) {
        let [low, high] = [pair[0] + 0.45, pair[1] - 0.45];
        socket.extend(block([(low + high) / 2.0, 0.0], [high - low, 5.4], [-0.2, 6.0]));
    }
    let (mate, count) = found(&plug, &socket, 2);
    close(&mate, [0.0; 3], [0.26, 0.26]);
    assert_eq!(count, 2);
}

#[test]
fn stamped_shell_with_seam_and_windows_mates_round_a_tongue() {
    // Shell of 0.3 mm sheet with a seam below and two windows above, about a tongue.
    let mut socket = block([0.0; 2], [9.6, 3.6], [-1.0, 0.0]);
    socket.extend(block([0.0; 2], [6.6, 0.7], [0.0, 4.4]));
    for x in [-4.65, 4.65] {
        socket.extend(block([x, 0.0], [0.3, 3.2], [0.0, 5.0]));
    }
    for x in [-2.3, 2.3] {
        socket.extend(block([x, -1.45], [4.4, 0.3], [0.0, 5.0]));
    }
    socket.extend(block([0.0, 1.45], [9.0, 0.3], [0.0, 2.0]));
    socket.extend(block([0.0, 1.45], [9.0, 0.3], [3.5, 5.0]));
    for x in [-4.2, 0.0, 4.2] {
        socket.extend(block([x, 1.45], [0.6, 0.3], [2.0, 3.5]));
    }
    let mut plug = tube([0.0; 2], [8.9, 2.5], [6.9, 0.9], [0.0, 5.0]);
    plug.extend(block([0.0; 2], [8.9, 2.5], [5.0, 9.0]));
    let (mate, count) = found(&plug, &socket, 9);
    close(&mate, [0.0, 0.0, 0.0], [0.1, 0.1]);
    assert_eq!(count, 2);
}

fn spline(grow: f64) -> Vec<[f64; 2]> {
    let corner = |i: i32| {
        let angle = std::f64::consts::TAU * f64::from(i) / 24.0;
        let radius = if i % 4 < 2 { 3.0 } else { 2.3 } + grow;
        [radius * libm::cos(angle), radius * libm::sin(angle)]
    };
    (0..24).map(corner).collect()
}

#[test]
fn spline_mates_in_its_teeth() {
    let outer: Vec<_> =
        spline(0.0).iter().map(|p| p.map(|v| 5.0 * v / libm::hypot(p[0], p[1]))).collect();
    let socket = [ring(&outer, &spline(0.06), [0.0, 4.0]), solid(&outer, [-2.0, 0.0])].concat();
    let plug = [solid(&spline(0.0), [0.0, 5.0]), block([0.0; 2], [8.0, 9.0], [5.0, 9.0])].concat();
    let (mate, _) = found(&plug, &socket, 6);
    let off = (mate.pose * mm(0.0, 0.0, 0.0) - mm(0.0, 0.0, 0.0)).norm();
    assert!(off < CLOSE, "{off} {mate:?}");
}

#[test]
fn interfering_springs_do_not_count_as_play() {
    let mut socket = hole([7.0, 6.0], [4.1, 3.1], 4.0);
    for x in [-1.0, 1.0] {
        socket.extend(block([x, 1.45], [0.4, 0.4], [1.0, 2.0]));
    }
    let (mate, _) = found(&peg([4.0, 3.0]), &socket, 8);
    close(&mate, [0.0, 0.0, 2.0], [0.1, 0.1]);
}

#[test]
fn assembled_plug_leaves_upward() {
    let mate = assembled(&peg([3.0, 2.0]), &hole([6.0, 5.0], [3.1, 2.1], 4.0)).expect("leaves");
    assert!((mate.out.z - 1.0).abs() < 1e-6, "{mate:?}");
    close(&mate, [0.0, 0.0, 1.0], [0.1, 0.1]);
}

/// Five bodies of a plug, a label and three of a socket, in contact with one another within each and at the seat.
/// Its depth is that of the seat into which it is moved.
#[test]
fn assembled_plug_above_its_seat_has_the_depth_of_the_seat() {
    let above: Mesh =
        peg([3.0, 2.0]).iter().map(|t| t.map(|p| mm(0.0, 0.0, 0.05) + p.coords)).collect();
    let mate = assembled(&above, &hole([6.0, 5.0], [3.1, 2.1], 4.0)).expect("leaves");
    assert!((mate.pose.translation.z + 0.05 * MM).abs() < 1e-3 * MM, "{mate:?}");
    assert!((mate.depth_m() - 4.0 * MM).abs() < 1e-3 * MM, "{mate:?}");
}

#[test]
fn bodies_of_a_plug_are_told_from_those_of_its_socket() {
    let holed = |low: f64, high: f64| tube([0.0; 2], [3.0, 2.0], [1.0, 0.8], [low, high]);
    let socket = [
        tube([0.0; 2], [6.0, 5.0], [3.1, 2.1], [0.0, 4.0]),
        block([0.0; 2], [6.0, 5.0], [-1.0, 0.0]),
        block([0.0; 2], [9.0, 8.0], [-2.5, -1.0]),
    ];
    let plug = [
        holed(0.0, 3.0),
        holed(3.0, 6.0),
        // A pin pressed into both.
        block([0.0; 2], [1.0, 0.8], [0.5, 7.0]),
        block([0.0; 2], [5.0, 4.0], [7.0, 10.0]),
        block([0.0, 2.1], [2.0, 0.2], [7.5, 8.5]),
    ];
    for turn in [0, 7, 13] {
        let bodies: Vec<Mesh> =
            socket.iter().chain(&plug).map(|body| hidden(body, turn).0).collect();
        assert_eq!(plugs(&bodies), Ok(vec![vec![3, 4, 5, 6, 7]]));
    }
    let apart =
        [block([0.0; 2], [3.0, 2.0], [0.0, 4.0]), block([9.0, 0.0], [3.0, 2.0], [0.0, 4.0])];
    assert_eq!(plugs(&apart), Err(MatingError::Blocked));
    assert_eq!(plugs(&apart[..1]), Err(MatingError::Bodies(1)));
}

#[test]
fn parts_that_do_not_fit_are_refused() {
    let [plug, socket] =
        [([5.0, 4.0], 6.0), ([6.0; 2], 3.0)].map(|(size, high)| block([0.0; 2], size, [0.0, high]));
    assert_eq!(mates(&plug, &socket, &NEVER), Err(MatingError::NoFit));
    assert_eq!(mates(&[], &peg([2.0; 2]), &NEVER), Err(MatingError::Empty("plug")));
    let stop = AtomicBool::new(true);
    let stopped = mates(&peg([2.0; 2]), &hole([5.0; 2], [2.1; 2], 4.0), &stop);
    assert_eq!(stopped, Err(MatingError::Stopped));
}

#[test]
fn random_sockets_of_one_to_three_holes() {
    let mut seed = 7_u64;
    let mut random = |low: f64, high: f64| {
        seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * (seed >> 11) as f64 / (1_u64 << 53) as f64
    };
    let mut missed = Vec::new();
    for number in 0..6 {
        let clearance = [random(0.05, 0.3), random(0.05, 0.3)];
        let (width, depth) = (random(2.0, 3.0), random(1.5, 3.0));
        let (mut plug, mut socket) = (Vec::new(), Vec::new());
        let count = 1 + number % 3;
        for i in 0..count {
            // Prongs of different size, so that there is one order.
            let (x, size) = (4.5 * i as f64, [1.4 + 0.5 * i as f64, width]);
            plug.extend(block([x, 0.0], size, [-depth, 0.0]));
            let inner = [0, 1].map(|axis| size[axis] + clearance[axis]);
            socket.extend(tube([x, 0.0], [4.5, 5.0], inner, [-depth, 0.0]));
        }
        let middle = 2.25 * (count - 1) as f64;
        plug.extend(block([middle, 0.0], [4.5 * count as f64 + 1.0, 5.5], [0.0, 3.0]));
        socket.extend(block([middle, 0.0], [4.5 * count as f64, 5.0], [-depth - 1.0, -depth]));
        let ((moved, p), (other, s)) = (hidden(&plug, number), hidden(&socket, 5 * number + 2));
        let found = mates(&moved, &other, &NEVER);
        let Ok([mate]) = found.as_ref().map(|found| &found.mates[..]) else {
            missed.push(format!("{number}: {found:?}"));
            continue;
        };
        let off =
            (s.inverse() * mate.pose * p * mm(middle, 0.0, 0.0) - mm(middle, 0.0, 0.0)).norm();
        let wrong = mate.across.iter().zip(mate.play_m).any(|(axis, play)| {
            let along = s.inverse() * axis.into_inner();
            (play - MM * clearance[usize::from(along.x.abs() < 0.5)]).abs() > CLOSE
        });
        if off > CLOSE || wrong {
            missed.push(format!("{number}: off {off} clearance {clearance:?} {mate:?}"));
        }
    }
    assert!(missed.is_empty(), "{} missed: {missed:#?}", missed.len());
}

/// Its maps are empty where it is seen from its edge.
#[test]
fn a_plate_thinner_than_a_cell_fits_no_block() {
    let (plate, socket) =
        (block([0.0; 2], [5.0; 2], [0.0, 0.2]), block([0.0; 2], [20.0; 2], [-8.0, 0.0]));
    assert!(matches!(mates(&plate, &socket, &NEVER), Err(MatingError::NoFit)));
}
