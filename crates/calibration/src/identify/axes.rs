//! Whether commanded motion, measured motion and force of a log go together, and with the task: what
//! columns that are mirrored, swapped or in another unit show.

use super::check::{Remark, Remarks};
use super::curves::Curves;
use super::formulas::{Friction, explained};
use super::log::{Ended, Log, Moment, Run};
use input::units::MM;
use insertion::task::{Stage, Task};
use nalgebra::{Matrix3, Vector2, Vector3};

const AXES: [&str; 3] = ["x", "y", "z"];
/// Motion that tells a direction, m.
const MOVED: f64 = 1.0 * MM;
/// Share of the commanded motion along an axis that is measured against it, or beside it.
const AGAINST: f64 = 0.3;
const BESIDE: f64 = 0.6;
/// Commanded motion over measured one from which it is in metres.
const METRES: f64 = 0.02;
/// Friction below which the slides of a probe do not go against their motion.
const FRICTION: f64 = 0.02;
/// Share of a force that a spring has to explain to tell where the robot gives way.
const GIVES: f64 = 0.3;
/// Share of the way down to the touch that a tool goes up again before another attempt.
const UP_AGAIN: f64 = 0.5;

/// A way in which the columns of a vector may be wrong.
struct Confusion {
    what: &'static str,
    of: fn(Vector3<f64>) -> Vector3<f64>,
}

/// Those that a place or a path can show.
const CONFUSIONS: [Confusion; 7] = [
    Confusion { what: "x and y look swapped", of: |v| Vector3::new(v.y, v.x, v.z) },
    Confusion { what: "x and z look swapped", of: |v| Vector3::new(v.z, v.y, v.x) },
    Confusion { what: "y and z look swapped", of: |v| Vector3::new(v.x, v.z, v.y) },
    Confusion { what: "x looks mirrored", of: |v| Vector3::new(-v.x, v.y, v.z) },
    Confusion { what: "y looks mirrored", of: |v| Vector3::new(v.x, -v.y, v.z) },
    Confusion { what: "z looks mirrored", of: |v| Vector3::new(v.x, v.y, -v.z) },
    Confusion { what: "x and y look mirrored", of: |v| Vector3::new(-v.x, -v.y, v.z) },
];

/// The likely cause of a place that is astray: what would bring it within a quarter of its distance.
pub(super) fn cause(found: Vector3<f64>, wanted: Vector3<f64>) -> &'static str {
    let far = |confusion: &&Confusion| ((confusion.of)(found) - wanted).norm();
    let best = CONFUSIONS.iter().min_by(|a, b| far(a).total_cmp(&far(b)));
    match best.filter(|best| far(best) < 0.25 * (found - wanted).norm()) {
        Some(best) => best.what,
        None => "check frame and units",
    }
}

/// Says what does not go together.
pub(super) fn axes(remarks: &mut Remarks<'_>, run: &Run, task: &Task, touched: Option<usize>) {
    commanded(remarks);
    if run.ended != Ended::Probe {
        search(remarks, task);
    }
    if let Some(touched) = touched.filter(|_| run.ended != Ended::Probe) {
        twice(remarks, touched);
    }
}

/// Measured and commanded place of each moment, from where they begin; none without targets.
fn moves(log: &Log) -> Vec<(Vector3<f64>, Vector3<f64>)> {
    let place = |moment: &Moment| Some((moment.position, moment.target?.position));
    let Some((first, goal)) = log.moments.first().and_then(place) else { return Vec::new() };
    log.moments.iter().filter_map(place).map(|(at, to)| (at - first, to - goal)).collect()
}

/// Commanded against measured motion.
fn commanded(remarks: &mut Remarks<'_>) {
    let moves = moves(remarks.log);
    let reach =
        |of: fn(&(Vector3<f64>, Vector3<f64>)) -> f64| moves.iter().map(of).fold(0.0, f64::max);
    let (measured, wanted) = (reach(|pair| pair.0.norm()), reach(|pair| pair.1.norm()));
    if !moves.is_empty() && measured > MOVED && wanted < METRES * measured {
        let text = format!(
            "the commanded positions move by {:.3} mm while the measured ones move by {:.1} mm: they \
             look like metres; give millimetres",
            wanted / MM,
            measured / MM
        );
        return remarks.say(true, None, text);
    }
    // The measured motion as a matrix times the commanded one; an axis without motion has a row of 0.
    let (mut squares, mut products) = (Matrix3::identity() * 1e-12, Matrix3::zeros());
    for (at, to) in &moves {
        squares += to * to.transpose();
        products += at * to.transpose();
    }
    let Some(inverse) = squares.try_inverse() else { return };
    let follows: Matrix3<f64> = products * inverse;
    let told = [0, 1, 2].map(|axis| moves.iter().any(|(_, to)| to[axis].abs() > MOVED));
    for axis in (0..3).filter(|axis| told[*axis]) {
        let beside = (0..3).find(|other| *other != axis && follows[(*other, axis)].abs() > BESIDE);
        let along = AXES[axis];
        if follows[(axis, axis)] < -AGAINST {
            let text = format!(
                "along {along} the measured position goes against the commanded one: one of the two is \
                 mirrored"
            );
            remarks.say(true, None, text);
        } else if let (Some(other), true) = (beside, follows[(axis, axis)] < AGAINST) {
            let text = format!(
                "what is commanded along {along} is measured along {}: two columns look swapped",
                AXES[other]
            );
            remarks.say(true, None, text);
        }
    }
}

/// The way of a path over the table: how far it has gone along x and y, and where it is.
fn way(path: impl Iterator<Item = Vector3<f64>>) -> Vec<(f64, Vector2<f64>)> {
    let (mut gone, mut at) = (0.0, Vector2::zeros());
    path.map(|place| {
        gone += (place.xy() - at).norm();
        at = place.xy();
        (gone, at)
    })
    .collect()
}

/// The place on a way after so much of it.
fn after(way: &[(f64, Vector2<f64>)], gone: f64) -> Vector2<f64> {
    let next = way.partition_point(|(at, _)| *at < gone);
    let (from, begin) = next.checked_sub(1).map_or((0.0, Vector2::zeros()), |before| way[before]);
    let Some((to, end)) = way.get(next) else { return begin };
    begin + (end - begin) * ((gone - from) / (to - from).max(f64::MIN_POSITIVE))
}

/// The commanded way of the search against that of the task, from its start or from where it has come near.
fn search(remarks: &mut Remarks<'_>, task: &Task) {
    let (moves, phases) = (moves(remarks.log), &task.strategy.phases);
    let near = phases.iter().take_while(|phase| phase.stage == Stage::Approach).count();
    let planned = [0, near].map(|skipped| {
        let mut at = Vector3::zeros();
        way(phases.iter().skip(skipped).map(|phase| {
            at += Vector3::from(phase.displacement);
            at
        }))
    });
    let off = |of: fn(Vector3<f64>) -> Vector3<f64>| {
        let done = way(moves.iter().map(|(_, to)| of(*to)));
        let length = done.last().map_or(1.0, |(gone, _)| gone.max(MOVED));
        let apart = |planned: &Vec<(f64, Vector2<f64>)>| {
            let steps = done.windows(2).map(|pair| {
                let [(before, _), (gone, place)] = [pair[0], pair[1]];
                (gone - before) * (place - after(planned, gone)).norm()
            });
            steps.sum::<f64>() / length
        };
        planned.iter().map(apart).fold(f64::INFINITY, f64::min)
    };
    let plain = off(|place| place);
    let known = CONFUSIONS.iter().filter(|one| !one.what.contains('z'));
    let Some(best) = known.min_by(|a, b| off(a.of).total_cmp(&off(b.of))) else { return };
    if plain > MOVED && off(best.of) < 0.5 * plain {
        let text = format!(
            "its search goes another way than that of the task, {:.1} mm apart on average: {}",
            plain / MM,
            best.what
        );
        remarks.say(true, None, text);
    }
}

/// Forces against how far the robot is off its targets in all attempts: where a force pushes it. `file`
/// has the runs.
pub(super) fn springs(file: &str, attempts: &[Curves]) -> Vec<Remark> {
    let one = |text: String| Remark { file: file.to_owned(), lines: None, text, serious: true };
    let along = |force: usize, motion: usize| explained(attempts, [force, motion]);
    let against: Vec<&str> =
        (0..3).filter(|&axis| along(axis, axis) < -GIVES).map(|axis| AXES[axis]).collect();
    let mirrored = match against[..] {
        [] => None,
        [name] => Some(format!("{name}_mm or f{name}_n is mirrored")),
        _ => Some(
            "measured and commanded positions are swapped, or the sign of the force".to_owned(),
        ),
    };
    let mirrored = mirrored.map(|cause| {
        one(format!(
            "along {} the robot gives way against the force: {cause}",
            against.join(" and ")
        ))
    });
    let [own, other] = [along(0, 0) + along(1, 1), along(0, 1).min(along(1, 0))];
    let text = "along x the robot gives way to the force along y, and along y to that along x: fx_n \
                and fy_n look swapped";
    let swapped = other > GIVES && 2.0 * other > own + GIVES;
    mirrored.into_iter().chain(swapped.then(|| one(text.to_owned()))).collect()
}

/// A probe whose force does not go against its slides.
pub(super) fn slides(probes: &[(String, Friction)]) -> Vec<Remark> {
    let wrong = |(file, found): &(String, Friction)| {
        let mean = found.coefficient.map(|one| one.mean).filter(|mean| *mean < FRICTION)?;
        let text = format!(
            "its slides tell a friction of {mean:.2}: the force along y does not go against the motion; \
             fy_n is mirrored, or swapped with another column"
        );
        Some(Remark { file: file.clone(), lines: None, text, serious: true })
    };
    probes.iter().filter_map(wrong).collect()
}

/// A second attempt after the first.
fn twice(remarks: &mut Remarks<'_>, touched: usize) {
    let moments = &remarks.log.moments;
    let [first, touch] = [0, touched].map(|at| moments[at].position.z);
    let high = touch + UP_AGAIN * (first - touch);
    let up = moments[touched..].iter().position(|moment| moment.position.z > high);
    let Some(up) = up.map(|at| at + touched).filter(|_| first - touch > MOVED) else { return };
    if let Some(down) = moments[up..].iter().position(|moment| moment.position.z <= touch) {
        let text = "the tool goes up and down to the socket once more: there are two attempts in \
                    this log; cut it into one log for each";
        remarks.say(true, Some([up, up + down]), text);
    }
}
