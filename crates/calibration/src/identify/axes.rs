//! Checks that commanded motion, measured motion and force of the logs agree with each other and with the task: they
//! detect columns that are mirrored, swapped or in another unit, and two attempts in one log.

use super::check::{Remark, Remarks};
use super::curves::Curves;
use super::formulas::{Friction, explained};
use super::log::{LogSample, Run};
use ask_tell::statistics::weighted_mean;
use input::units::MM;
use insertion::{Stage, Task};
use nalgebra::{Vector2, Vector3};

/// Smallest mean change of the positions by a correction, m; a smaller one cannot be told from errors of the motion.
const MIN_CHANGE: f64 = 0.5 * MM;
/// Smallest reduction of the mean distance by a correction, as a fraction of the mean change of the positions.
const MIN_REDUCTION: f64 = 0.5;
/// Smallest length of a recorded path that is compared with the task's path, as a fraction of the task's.
const MIN_LENGTH: f64 = 0.7;
/// Smallest rise that counts as the end of an attempt, as a fraction of the descent to the touch; smallest descent, m,
/// for which this is checked.
const MIN_RISE: (f64, f64) = (0.5, 1.0 * MM);
/// Smallest increase of [`explained`] by a correction.
const MIN_GAIN: f64 = 0.5;

/// Correction of a position or force, with the columns in the right order and sign.
type Correction = fn(Vector3<f64>) -> Vector3<f64>;
const MIRRORED_X: Correction = |v| Vector3::new(-v.x, v.y, v.z);
const MIRRORED_Y: Correction = |v| Vector3::new(v.x, -v.y, v.z);
const MIRRORED_X_AND_Y: Correction = |v| Vector3::new(-v.x, -v.y, v.z);

/// Mistake in the columns of a vector: its likely cause, and its correction.
type Mistake = (&'static str, Correction);

/// Mistakes in the horizontal axes, x and y.
const HORIZONTAL_MISTAKES: [Mistake; 4] = [
    ("x looks mirrored", MIRRORED_X),
    ("y looks mirrored", MIRRORED_Y),
    ("x and y look mirrored", MIRRORED_X_AND_Y),
    ("x and y look swapped", |v| v.yxz()),
];
/// Mistakes that involve the vertical axis, z.
const VERTICAL_MISTAKES: [Mistake; 3] = [
    ("z looks mirrored", |v| Vector3::new(v.x, v.y, -v.z)),
    ("x and z look swapped", |v| v.zyx()),
    ("y and z look swapped", |v| v.xzy()),
];
/// Commanded positions in metres.
const METRES: Mistake = ("the commanded positions look like metres; give millimetres", |v| v * 1e3);

/// Position, its expected value, m, and the weight of the pair in the mean.
type Pair = (Vector3<f64>, Vector3<f64>, f64);

/// Comparison of positions with their expected values.
struct Comparison {
    /// Weighted mean distance in the 1-norm, m.
    distance: f64,
    /// The same after the best correction, if that is smaller, m.
    corrected: f64,
    /// Likely cause of the distance, if a correction reduces it enough.
    mistake: Option<&'static str>,
}

impl Comparison {
    fn new(mistakes: impl IntoIterator<Item = Mistake>, pairs: &[Pair]) -> Self {
        let mean = |difference: &dyn Fn(&Pair) -> Vector3<f64>| {
            weighted_mean(pairs.iter().map(|pair| (difference(pair).lp_norm(1), pair.2)))
        };
        let distance = mean(&|(is, expected, _)| is - expected);
        let tried = mistakes.into_iter().map(|(cause, corrected)| {
            let left = mean(&|(is, expected, _)| corrected(*is) - expected);
            let change = mean(&|(is, ..)| corrected(*is) - is);
            (left, cause, distance - left > MIN_REDUCTION * change && change > MIN_CHANGE)
        });
        let best = tried.min_by(|a, b| a.0.total_cmp(&b.0));
        Comparison {
            distance,
            corrected: best.map_or(distance, |(left, ..)| left.min(distance)),
            mistake: best.filter(|best| best.2).map(|(_, cause, _)| cause),
        }
    }
}

/// Returns the likely cause of a first position that is far from the task's start.
pub(super) fn cause(first: Vector3<f64>, start: Vector3<f64>) -> &'static str {
    let all = HORIZONTAL_MISTAKES.into_iter().chain(VERTICAL_MISTAKES);
    Comparison::new(all, &[(first, start, 1.0)]).mistake.unwrap_or("check frame and units")
}

/// Adds remarks on the motion of one log.
pub(super) fn motion(remarks: &mut Remarks<'_>, run: &Run, task: &Task, touched: Option<usize>) {
    commanded(remarks);
    if run.outcome.is_some() {
        search(remarks, task);
        if let Some(touched) = touched {
            second_attempt(remarks, touched);
        }
    }
}

/// Adds a remark if commanded and measured motion, both relative to the first sample, disagree.
fn commanded(remarks: &mut Remarks<'_>) {
    let pair = |sample: &LogSample| Some((sample.target?.position, sample.tcp.position));
    let samples = &remarks.log.samples;
    let Some((goal, first)) = pair(&samples[0]) else { return };
    let moves: Vec<Pair> =
        samples.iter().filter_map(pair).map(|(to, at)| (to - goal, at - first, 1.0)).collect();
    let all = HORIZONTAL_MISTAKES.into_iter().chain(VERTICAL_MISTAKES).chain([METRES]);
    let found = Comparison::new(all, &moves);
    if let Some(cause) = found.mistake {
        let text = format!(
            "measured and commanded positions, relative to their first, are {:.1} mm apart on average: \
             {cause}{}",
            found.distance / MM,
            if cause == METRES.0 { "" } else { " in one of the two" }
        );
        remarks.add(true, None, text);
    }
}

/// Path in x and y: the arc length up to each point, and its position relative to the first one, m.
type PlanarPath = Vec<(f64, Vector2<f64>)>;

fn planar_path(places: impl Iterator<Item = Vector3<f64>>) -> PlanarPath {
    let (mut length, mut at) = (0.0, Vector2::zeros());
    let step = |place: Vector3<f64>| {
        length += (place.xy() - at).norm();
        at = place.xy();
        (length, at)
    };
    std::iter::once(Vector3::zeros()).chain(places).map(step).collect()
}

/// Returns the position on a path at an arc length, m; at its end beyond it.
fn position_at(path: &PlanarPath, length: f64) -> Vector2<f64> {
    let next = path.partition_point(|(at, _)| *at < length).max(1);
    let (from, begin) = path[next - 1];
    let Some((to, end)) = path.get(next) else { return begin };
    begin + (end - begin) * ((length - from) / (to - from).max(f64::MIN_POSITIVE))
}

/// Adds a remark if the path in x and y disagrees with the path of the task, where the log may begin at the start of
/// the task or after its approach.
fn search(remarks: &mut Remarks<'_>, task: &Task) {
    let phases = &task.strategy.phases;
    let near = phases.iter().take_while(|phase| phase.stage == Stage::Approach).count();
    let planned = [0, near].map(|skipped| {
        let mut at = Vector3::zeros();
        planar_path(phases.iter().skip(skipped).map(|phase| {
            at += Vector3::from(phase.displacement);
            at
        }))
    });
    let at = |sample: &LogSample| sample.target.unwrap_or(sample.tcp).position;
    let samples = &remarks.log.samples;
    let first = at(&samples[0]);
    let done = planar_path(samples.iter().map(|sample| at(sample) - first));
    let length = |path: &PlanarPath| path.last().map_or(0.0, |(length, _)| *length);
    let long = planned.iter().filter(|plan| length(&done) > MIN_LENGTH * length(plan));
    let compared = long.map(|plan| {
        let pairs = done.windows(2).map(|pair| {
            let [(before, _), (length, at)] = [pair[0], pair[1]];
            (at.push(0.0), position_at(plan, length).push(0.0), length - before)
        });
        Comparison::new(HORIZONTAL_MISTAKES, &pairs.collect::<Vec<_>>())
    });
    let nearest = compared.min_by(|a, b| a.corrected.total_cmp(&b.corrected));
    if let Some(Comparison { distance, mistake: Some(cause), .. }) = nearest {
        let off = distance / MM;
        let text = format!("its search differs from the task's by {off:.1} mm on average: {cause}");
        remarks.add(true, None, text);
    }
}

/// Adds a remark if a second attempt follows the first.
fn second_attempt(remarks: &mut Remarks<'_>, touched: usize) {
    let samples = &remarks.log.samples;
    let [first, touch] = [0, touched].map(|at| samples[at].tcp.position.z);
    let high = touch + MIN_RISE.0 * (first - touch);
    let up = samples[touched..].iter().position(|sample| sample.tcp.position.z > high);
    let Some(up) = up.map(|at| at + touched).filter(|_| first - touch > MIN_RISE.1) else { return };
    if let Some(down) = samples[up..].iter().position(|sample| sample.tcp.position.z <= touch) {
        let text = "the tool rises and descends to the socket again: this log contains two attempts; split it \
                    into one log for each";
        remarks.add(true, Some([up, up + down]), text);
    }
}

/// Mistakes in the force, or in the positions relative to it.
const FORCE_MISTAKES: [Mistake; 5] = [
    ("along x; x_mm or fx_n looks mirrored", MIRRORED_X),
    ("along y; y_mm or fy_n looks mirrored", MIRRORED_Y),
    ("along x and y; positions look mirrored against the force", MIRRORED_X_AND_Y),
    ("along all axes; measured and commanded positions look swapped, or turn `force_sign`", |v| -v),
    ("along x and y; fx_n and fy_n look swapped", |v| v.yxz()),
];

/// Returns a remark if the robot does not deflect in the direction of the force; `file` is the table of the runs.
pub(super) fn springs(file: &str, attempts: &[Curves]) -> Option<Remark> {
    let score = |corrected: Correction| {
        let with = |one: &Curves| {
            let force = one.force.iter().map(|force| corrected(*force)).collect();
            Curves { force, ..one.clone() }
        };
        explained(&attempts.iter().map(with).collect::<Vec<_>>())
    };
    let tried = FORCE_MISTAKES.map(|(cause, corrected)| (score(corrected), cause));
    let (best, cause) = tried.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let text = format!("the robot does not give way in the direction of the force {cause}");
    let remark = Remark { file: file.to_owned(), lines: None, text, serious: true };
    (best - explained(attempts) > MIN_GAIN).then_some(remark)
}

/// Returns a remark if the friction of a probe is negative: the force along y then drives the slides.
pub(super) fn slides((file, found): &(String, Friction)) -> Option<Remark> {
    let friction = found.coefficient.map(|one| one.mean).filter(|mean| *mean < 0.0)?;
    let text = format!(
        "its slides have a friction of {friction:.2}: the force along y drives the motion; fy_n looks mirrored, \
         or swapped with another column"
    );
    Some(Remark { file: file.clone(), lines: None, text, serious: true })
}
