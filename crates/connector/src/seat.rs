//! Seat of the upright plug in its socket (its deepest pose without an overlap), and waypoints of the commanded path,
//! as if nothing yielded.

use super::body::{ConvexBody, clipped, extent};
use contact::scene::Pose;
use input::units::{DEG, MM};
use insertion::task::Mated;
use insertion::{Ending, Part, Stage, Task};
use nalgebra::{Point3, UnitQuaternion, Vector3};

/// Overlap that is ignored, m: faces that touch can overlap after lengths are rounded to 0.01 mm.
const TOLERANCE: f64 = 0.02 * MM;
/// Step of the depth on the way down, m.
const STEP: f64 = 0.25 * MM;
/// Resolution of the depth of the seat, m.
const FINE: f64 = 0.005 * MM;
/// Distance beyond the lateral tolerance at which a plug counts as beside its seat, m.
const ASIDE: f64 = 0.2 * MM;
/// Overlap of bodies that only touch, m.
const TOUCHING: f64 = 1e-3 * MM;
/// Largest lateral play that is measured, m.
const MAX_PLAY: f64 = 10.0 * MM;
/// Rotation to either side up to which the play about the axis is measured, rad.
const MAX_TURN: f64 = 45.0 * DEG;
/// Resolution of this play, rad.
const TURN_RESOLUTION: f64 = 0.01 * DEG;
/// Intervals of the grid of places along x and along y.
const GRID: i32 = 8;
/// Refinements of that grid about its best place.
const REFINEMENTS: i32 = 4;

/// Returns the total play in x and in y of the upright plug, m, at the success depth or at the seat if that is higher.
pub fn clearance(task: &Task) -> [f64; 2] {
    let bodies = TaskBodies::new(task);
    let seat = bodies.deepest();
    [0, 1].map(|axis| bodies.play(task.success.depth.min(seat.depth), seat.at, axis))
}

/// Play of the upright plug in rotation about its axis.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct RotationalPlay {
    /// Total angle, rad.
    pub angle: f64,
    /// Its arc at the inserted corner of the plug that is farthest from the axis, such as that of a key, m.
    pub arc: f64,
}

/// Returns the play in rotation, at the depth of [`clearance`]; `None` if it is at least 45 degrees.
pub fn rotational_play(task: &Task) -> Option<RotationalPlay> {
    let bodies = TaskBodies::new(task);
    let seat = bodies.deepest();
    let depth = task.success.depth.min(seat.depth);
    let [x, y] = bodies.centred(depth, seat.at);
    let overlap = |angle: f64| {
        let turn = UnitQuaternion::from_axis_angle(&Vector3::z_axis(), angle);
        bodies.overlap(&Pose::from_parts(Vector3::new(x, y, -depth).into(), turn)).0
    };
    let least = overlap(0.0).max(TOUCHING);
    let [back, forth] = [-1.0, 1.0]
        .map(|sign| largest_free(MAX_TURN, TURN_RESOLUTION, |angle| overlap(sign * angle) > least));
    let angle = back + forth;
    let inserted = |part: &Part| clipped(&part.solid.corners(), 2, [f64::NEG_INFINITY, depth]);
    let corners = bodies.plug.parts.iter().flat_map(inserted);
    let farthest = corners.map(|p| libm::hypot(p.x, p.y)).fold(0.0, f64::max);
    (angle < MAX_TURN).then_some(RotationalPlay { angle, arc: angle * farthest })
}

/// Returns the largest value from 0 to `most`, to a resolution, that is not blocked.
fn largest_free(most: f64, resolution: f64, blocked: impl Fn(f64) -> bool) -> f64 {
    let (mut free, mut beyond) = (0.0, most);
    while beyond - free > resolution {
        let middle = (free + beyond) / 2.0;
        let end = if blocked(middle) { &mut beyond } else { &mut free };
        *end = middle;
    }
    free
}

/// Deepest pose of the upright plug.
#[derive(Debug, Clone, PartialEq)]
pub struct Seat {
    /// Depth of the tip below the socket's top, m; 0 if the plug does not enter.
    pub depth: f64,
    /// x and y of the plug's axis at this depth, m.
    pub at: [f64; 2],
    /// Indices of the plug part and the socket part that meet; `None` if the plug is mated or falls through.
    pub stopped_by: Option<[usize; 2]>,
}

/// Task with its two bodies.
pub struct TaskBodies<'a> {
    /// The task.
    pub task: &'a Task,
    /// Plug with its latch.
    pub plug: ConvexBody<'a>,
    /// Socket.
    pub socket: ConvexBody<'a>,
}

impl<'a> TaskBodies<'a> {
    pub fn new(task: &'a Task) -> Self {
        let (plug, socket) = (ConvexBody::plug(&task.plug), ConvexBody::new(&task.socket));
        TaskBodies { task, plug, socket }
    }

    /// Returns the deepest pose that the upright plug reaches from above, or the mated pose if it is known.
    pub fn deepest(&self) -> Seat {
        if let Some(Mated { tip: [x, y, z], .. }) = self.task.success.mated {
            return Seat { depth: -z, at: [x, y], stopped_by: None };
        }
        let [bottom, top] = self.plug.extent(2);
        let mut at = self.task.opening.map(|[low, high]| (low + high) / 2.0);
        let mut free = 0.0;
        let mut depth = STEP;
        while depth < top - bottom {
            match self.free_place(depth, at) {
                Ok(place) => (free, at) = (depth, place),
                Err(_) => return self.bisected(free, depth, at),
            }
            depth += STEP;
        }
        Seat { depth: free, at, stopped_by: None }
    }

    /// Returns the length of a mated plug's tip that enters without being guided, m: the depth down to which the plug can
    /// be to one side of its seat.
    pub fn nose(&self) -> f64 {
        let Some(Mated { tip: [x, y, z], lateral }) = self.task.success.mated else { return 0.0 };
        let aside = lateral + ASIDE;
        let free = |depth: &f64| {
            let at = [[x - aside, y], [x + aside, y], [x, y - aside], [x, y + aside]];
            at.into_iter().any(|at| self.overlap_at(*depth, at).0 <= TOLERANCE)
        };
        let depths = (0..).map(|i| f64::from(i) * STEP).take_while(|depth| *depth < -z);
        depths.take_while(free).last().unwrap_or(0.0)
    }

    /// Returns the total play of the upright plug at a depth along an axis (0 x, 1 y), m.
    pub fn play(&self, depth: f64, at: [f64; 2], axis: usize) -> f64 {
        self.free_distances(depth, self.centred(depth, at), axis).iter().sum()
    }

    /// Returns the place of the upright plug centred between the walls at a depth, m: a seated plug may touch them.
    fn centred(&self, depth: f64, mut at: [f64; 2]) -> [f64; 2] {
        for axis in [0, 1, 0, 1] {
            let [back, forth] = self.free_distances(depth, at, axis);
            at[axis] += (forth - back) / 2.0;
        }
        at
    }

    /// Returns the free distances in both directions along an axis, m: those up to a larger overlap than that at `at`.
    fn free_distances(&self, depth: f64, at: [f64; 2], axis: usize) -> [f64; 2] {
        let least = self.overlap_at(depth, at).0.max(TOUCHING);
        [-1.0, 1.0].map(|sign| {
            largest_free(MAX_PLAY, TOUCHING, |by| {
                let mut place = at;
                place[axis] += sign * by;
                self.overlap_at(depth, place).0 > least
            })
        })
    }

    /// Finds the deepest free place between a free depth and a blocked one by bisection; the ignored overlap is
    /// subtracted from its depth.
    fn bisected(&self, mut free: f64, mut blocked: f64, mut at: [f64; 2]) -> Seat {
        let mut stopped_by = None;
        while blocked - free > FINE {
            let middle = (free + blocked) / 2.0;
            match self.free_place(middle, at) {
                Ok(place) => (free, at) = (middle, place),
                Err(by) => (blocked, stopped_by) = (middle, Some(by)),
            }
        }
        Seat { depth: (free - TOLERANCE).max(0.0), at, stopped_by }
    }

    /// Finds a free place at this depth, near `at` if possible; otherwise returns the two parts that collide.
    fn free_place(&self, depth: f64, mut at: [f64; 2]) -> Result<[f64; 2], [usize; 2]> {
        let mut best = self.overlap_at(depth, at);
        if best.0 <= TOLERANCE {
            return Ok(at);
        }
        // Range of the plug's axis in which all of the plug below the top is inside the opening.
        let section = section(&self.plug, depth);
        let range = [0, 1].map(|axis| {
            let ([low, high], [from, to]) = (self.task.opening[axis], section[axis]);
            [low - from, high - to]
        });
        let mut middle = range.map(|[low, high]| (low + high) / 2.0);
        let mut half = range.map(|[low, high]| (high - low).abs() / 2.0);
        for _ in 0..REFINEMENTS {
            for i in 0..=GRID {
                for j in 0..=GRID {
                    let share = |k: i32| f64::from(2 * k - GRID) / f64::from(GRID);
                    let place = [middle[0] + half[0] * share(i), middle[1] + half[1] * share(j)];
                    let found = self.overlap_at(depth, place);
                    if found.0 < best.0 {
                        (best, at) = (found, place);
                    }
                    if found.0 <= TOLERANCE {
                        return Ok(place);
                    }
                }
            }
            (middle, half) = (at, half.map(|half| half * 2.0 / f64::from(GRID)));
        }
        Err(best.1)
    }

    /// Returns the deepest overlap of the upright plug, m, and the indices of its plug part and its socket part.
    fn overlap_at(&self, depth: f64, [x, y]: [f64; 2]) -> (f64, [usize; 2]) {
        self.overlap(&Pose::translation(x, y, -depth))
    }

    /// Returns the deepest overlap of the plug at a pose; the rest as [`Self::overlap_at`].
    fn overlap(&self, pose: &Pose) -> (f64, [usize; 2]) {
        let found = self.plug.overlap(pose, &self.socket);
        found.map_or((0.0, [0, 0]), |found| (found.depth, found.parts))
    }
}

/// Returns the extent in x and y of the section of the plug that is below the socket's top at a depth, m.
pub fn section(plug: &ConvexBody, depth: f64) -> [[f64; 2]; 2] {
    let below = |part: &Part| clipped(&part.solid.corners(), 2, [f64::NEG_INFINITY, depth]);
    let below: Vec<_> = plug.parts.iter().flat_map(below).collect();
    [0, 1].map(|axis| extent(&below, axis))
}

/// End of a phase on the commanded path.
#[derive(Debug, Clone, PartialEq)]
pub struct Waypoint {
    /// Name of the phase that ends here; "start" for the first.
    pub name: String,
    pub stage: Stage,
    /// Grasp point (TCP), task frame, m.
    pub tcp: Vector3<f64>,
    /// Lowest point of the tip, task frame, m.
    pub edge: Point3<f64>,
    /// Height above the socket's top at which the stroke of a touch ends, if it does not reach the socket, m.
    pub short_by: Option<f64>,
}

/// Returns the pose of the plug at the tilt of the strategy with the TCP at `tcp`, task frame, m.
pub fn plug_pose(task: &Task, tcp: Vector3<f64>) -> Pose {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), task.strategy.tilt);
    Pose::from_parts(tcp.into(), turn) * Pose::translation(0.0, 0.0, -task.grip.tcp_z)
}

/// Returns the start and the ends of the phases; a touch ends at its preload below z = 0.
pub fn waypoints(task: &Task, plug: &ConvexBody) -> Vec<Waypoint> {
    let start = Vector3::from(task.strategy.start);
    let lowest = plug.lowest(&plug_pose(task, start));
    let edge = lowest.unwrap_or_else(Point3::origin) - start;
    let mut found = vec![Waypoint {
        name: "start".to_owned(),
        stage: Stage::Approach,
        tcp: start,
        edge: Point3::from(start + edge.coords),
        short_by: None,
    }];
    for (i, phase) in task.strategy.phases.iter().enumerate() {
        let (tcp, edge) = (found[i].tcp, found[i].edge);
        let mut by = Vector3::from(phase.displacement);
        let mut short_by = None;
        if let Ending::Touch { preload, .. } = phase.ending {
            let end = edge.z + by.z;
            if end > 0.0 || by.z >= 0.0 {
                short_by = Some(end);
            } else {
                // Straight down to the surface, and on by the preload.
                by *= (edge.z.max(0.0) + preload) / -by.z;
            }
        }
        let (name, stage) = (phase.name.clone(), phase.stage);
        found.push(Waypoint { name, stage, tcp: tcp + by, edge: edge + by, short_by });
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::shipped::TASKS;

    /// Returns a shipped task with one passage replaced.
    fn changed(name: &str, from: &str, to: &str) -> Task {
        let file = TASKS.iter().find(|file| file.name == name).unwrap();
        Task::parse(&file.text.replace(from, to), file.file).unwrap()
    }

    /// usb: shoulder on the housing; ket12: floor; rj45: floor and guide blocks at one depth.
    #[test]
    fn shipped_plugs_end_where_their_drawings_say() {
        for (name, depth_mm, by) in [
            ("usb", 12.57, ["moulded body", "wall at"]),
            ("ket12", 29.0, ["key", "floor"]),
            ("rj45", 12.0, ["", ""]),
        ] {
            let task = changed(name, "", "");
            let seat = TaskBodies::new(&task).deepest();
            let [plug, socket] = seat.stopped_by.unwrap();
            let names = [&task.plug.parts[plug].name, &task.socket[socket].name];
            assert!((seat.depth / MM - depth_mm).abs() < 0.04, "{name}: {seat:?}");
            assert!((0..2).all(|i| names[i].starts_with(by[i])), "{name}: {names:?}");
        }
    }

    /// usb: the lower edge over the opening's middle, touch to 0.3 mm below the top.
    #[test]
    fn the_commanded_edge_starts_over_the_opening_and_ends_below() {
        let task = changed("usb", "", "");
        let plug = ConvexBody::plug(&task.plug);
        let way = waypoints(&task, &plug);
        assert!(way[0].edge.y.abs() < 0.1 * MM, "{way:?}");
        let touch = way.iter().find(|point| point.name == "touch").unwrap();
        assert!((touch.edge.z + 0.3 * MM).abs() < 1e-12 && touch.short_by.is_none());
        assert!(task.grip.tcp_z - way.last().unwrap().tcp.z > task.success.depth);
    }
}
