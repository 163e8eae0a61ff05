//! Checks that commanded motion, measured motion and force of the logs agree with each other and with the task:
//! columns that are mirrored, swapped or in another unit, and two attempts in one log.

use super::check::{Remark, Remarks};
use super::curves::Curves;
use super::formulas::{Friction, explained};
use super::log::{Ended, LogSample, Run};
use input::units::MM;
use insertion::task::{Stage, Task};
use nalgebra::{Vector2, Vector3};

/// Mean distance between two paths below which they agree, m.
const AGREES: f64 = 0.5 * MM;
/// Share of what a correction changes by which the paths have to come nearer to each other.
const CORRECTS: f64 = 0.5;
/// Share of the task's search that a log has to make before its direction is compared.
const COMPLETE: f64 = 0.7;
/// Share of the descent to the touch that a tool rises before another attempt, and least descent, m.
const RISES: (f64, f64) = (0.5, 1.0 * MM);
/// Share of the force along one axis that the springs of the robot have to explain better after a correction.
const EXPLAINS: f64 = 0.5;

/// Correction of a vector.
type Correction = fn(Vector3<f64>) -> Vector3<f64>;
const MIRRORED_X: Correction = |v| Vector3::new(-v.x, v.y, v.z);
const MIRRORED_Y: Correction = |v| Vector3::new(v.x, -v.y, v.z);
const MIRRORED_X_AND_Y: Correction = |v| Vector3::new(-v.x, -v.y, v.z);

/// Mistake in the columns of a vector: its likely cause, and its correction.
type Mistake = (&'static str, Correction);

/// Mistakes that a path over the table shows.
const OVER_TABLE: [Mistake; 4] = [
    ("x looks mirrored", MIRRORED_X),
    ("y looks mirrored", MIRRORED_Y),
    ("x and y look mirrored", MIRRORED_X_AND_Y),
    ("x and y look swapped", |v| v.yxz()),
];
/// Mistakes that change heights.
const IN_HEIGHT: [Mistake; 3] = [
    ("z looks mirrored", |v| Vector3::new(v.x, v.y, -v.z)),
    ("x and z look swapped", |v| v.zyx()),
    ("y and z look swapped", |v| v.xzy()),
];
const METRES: Mistake = ("the commanded positions look like metres; give millimetres", |v| v * 1e3);

/// A place, where it should be, and its weight.
type Pair = (Vector3<f64>, Vector3<f64>, f64);

/// Comparison of places with where they should be.
struct Comparison {
    /// Mean distance, m.
    apart: f64,
    /// The same after the best correction, if that is less.
    left: f64,
    /// Mistake that explains the distance.
    mistake: Option<&'static str>,
}

impl Comparison {
    fn new(mistakes: impl IntoIterator<Item = Mistake>, pairs: &[Pair]) -> Self {
        let all: f64 = pairs.iter().map(|(.., weight)| weight).sum();
        let mean = |distance: &dyn Fn(&Pair) -> Vector3<f64>| {
            pairs.iter().map(|pair| pair.2 * distance(pair).lp_norm(1)).sum::<f64>() / all
        };
        let apart = mean(&|(is, wanted, _)| is - wanted);
        let tried = mistakes.into_iter().map(|(cause, corrected)| {
            let left = mean(&|(is, wanted, _)| corrected(*is) - wanted);
            let change = mean(&|(is, ..)| corrected(*is) - is);
            (left, cause, apart - left > CORRECTS * change && change > AGREES)
        });
        let best = tried.min_by(|a, b| a.0.total_cmp(&b.0));
        Comparison {
            apart,
            left: best.map_or(apart, |(left, ..)| left.min(apart)),
            mistake: best.filter(|best| best.2).map(|(_, cause, _)| cause),
        }
    }
}

/// Returns the likely cause of a first position that is far from the task's start.
pub(super) fn cause(first: Vector3<f64>, start: Vector3<f64>) -> &'static str {
    let all = OVER_TABLE.into_iter().chain(IN_HEIGHT);
    Comparison::new(all, &[(first, start, 1.0)]).mistake.unwrap_or("check frame and units")
}

/// Adds remarks on the motion of one log.
pub(super) fn motion(remarks: &mut Remarks<'_>, run: &Run, task: &Task, touched: Option<usize>) {
    commanded(remarks);
    if run.ended != Ended::Probe {
        search(remarks, task);
        if let Some(touched) = touched {
            twice(remarks, touched);
        }
    }
}

/// Compares commanded with measured motion, both from the first sample.
fn commanded(remarks: &mut Remarks<'_>) {
    let pair = |sample: &LogSample| Some((sample.target?.position, sample.position));
    let samples = &remarks.log.samples;
    let Some((goal, first)) = pair(&samples[0]) else { return };
    let moves: Vec<Pair> =
        samples.iter().filter_map(pair).map(|(to, at)| (to - goal, at - first, 1.0)).collect();
    let all = OVER_TABLE.into_iter().chain(IN_HEIGHT).chain([METRES]);
    let found = Comparison::new(all, &moves);
    if let Some(cause) = found.mistake {
        let text = format!(
            "measured and commanded positions, counted from their first, are {:.1} mm apart on average: \
             {cause}{}",
            found.apart / MM,
            if cause == METRES.0 { "" } else { " in one of the two" }
        );
        remarks.add(true, None, text);
    }
}

/// A path over the table: its length so far and its place, from its beginning.
type Course = Vec<(f64, Vector2<f64>)>;

fn course(places: impl Iterator<Item = Vector3<f64>>) -> Course {
    let (mut length, mut at) = (0.0, Vector2::zeros());
    let step = |place: Vector3<f64>| {
        length += (place.xy() - at).norm();
        at = place.xy();
        (length, at)
    };
    std::iter::once(Vector3::zeros()).chain(places).map(step).collect()
}

/// Returns the place on a course after a length of it.
fn place(course: &Course, length: f64) -> Vector2<f64> {
    let next = course.partition_point(|(at, _)| *at < length).max(1);
    let (from, begin) = course[next - 1];
    let Some((to, end)) = course.get(next) else { return begin };
    begin + (end - begin) * ((length - from) / (to - from).max(f64::MIN_POSITIVE))
}

/// Compares the path over the table with the task's search, from its start or from the end of its approach.
fn search(remarks: &mut Remarks<'_>, task: &Task) {
    let phases = &task.strategy.phases;
    let near = phases.iter().take_while(|phase| phase.stage == Stage::Approach).count();
    let planned = [0, near].map(|skipped| {
        let mut at = Vector3::zeros();
        course(phases.iter().skip(skipped).map(|phase| {
            at += Vector3::from(phase.displacement);
            at
        }))
    });
    let at = |sample: &LogSample| sample.target.map_or(sample.position, |target| target.position);
    let samples = &remarks.log.samples;
    let first = at(&samples[0]);
    let done = course(samples.iter().map(|sample| at(sample) - first));
    let length = |course: &Course| course.last().map_or(0.0, |(length, _)| *length);
    let compared =
        planned.iter().filter(|plan| length(&done) > COMPLETE * length(plan)).map(|plan| {
            let pairs = done.windows(2).map(|pair| {
                let [(before, _), (length, at)] = [pair[0], pair[1]];
                (at.push(0.0), place(plan, length).push(0.0), length - before)
            });
            Comparison::new(OVER_TABLE, &pairs.collect::<Vec<_>>())
        });
    let nearest = compared.min_by(|a, b| a.left.total_cmp(&b.left));
    if let Some(Comparison { apart, mistake: Some(cause), .. }) = nearest {
        let apart = apart / MM;
        let text =
            format!("its search is {apart:.1} mm beside that of the task on average: {cause}");
        remarks.add(true, None, text);
    }
}

/// A second attempt after the first.
fn twice(remarks: &mut Remarks<'_>, touched: usize) {
    let samples = &remarks.log.samples;
    let [first, touch] = [0, touched].map(|at| samples[at].position.z);
    let high = touch + RISES.0 * (first - touch);
    let up = samples[touched..].iter().position(|sample| sample.position.z > high);
    let Some(up) = up.map(|at| at + touched).filter(|_| first - touch > RISES.1) else { return };
    if let Some(down) = samples[up..].iter().position(|sample| sample.position.z <= touch) {
        let text = "the tool rises and goes down to the socket once more: there are two attempts in this \
                    log; cut it into one log for each";
        remarks.add(true, Some([up, up + down]), text);
    }
}

/// Mistakes in the force, or in the positions against it.
const IN_FORCE: [Mistake; 5] = [
    ("along x; x_mm or fx_n looks mirrored", MIRRORED_X),
    ("along y; y_mm or fy_n looks mirrored", MIRRORED_Y),
    ("along x and y; positions look mirrored against the force", MIRRORED_X_AND_Y),
    ("along all axes; measured and commanded positions look swapped, or turn `force_sign`", |v| -v),
    ("along x and y; fx_n and fy_n look swapped", |v| v.yxz()),
];

/// Returns a remark on the direction in which the robot gives way to the force, over all attempts; `file` has
/// the runs.
pub(super) fn springs(file: &str, attempts: &[Curves]) -> Option<Remark> {
    let score = |corrected: Correction| {
        let with = |one: &Curves| {
            let force = one.force.iter().map(|force| corrected(*force)).collect();
            Curves { force, ..one.clone() }
        };
        explained(&attempts.iter().map(with).collect::<Vec<_>>())
    };
    let tried = IN_FORCE.map(|(cause, corrected)| (score(corrected), cause));
    let (best, cause) = tried.into_iter().max_by(|a, b| a.0.total_cmp(&b.0))?;
    let text = format!("the robot does not give way in the direction of the force {cause}");
    let remark = Remark { file: file.to_owned(), lines: None, text, serious: true };
    (best - explained(attempts) > EXPLAINS).then_some(remark)
}

/// Returns a remark on a probe along whose slides the force drives the motion.
pub(super) fn slides((file, found): &(String, Friction)) -> Option<Remark> {
    let friction = found.coefficient.map(|one| one.mean).filter(|mean| *mean < 0.0)?;
    let text = format!(
        "its slides have a friction of {friction:.2}: the force along y drives the motion; fy_n looks mirrored, \
         or swapped with another column"
    );
    Some(Remark { file: file.clone(), lines: None, text, serious: true })
}
