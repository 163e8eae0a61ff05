//! How deep a plug goes into its socket upright, whatever the search does.

use super::body::{ConvexBody, clipped, span};
use contact::scene::Pose;
use input::units::MM;
use insertion::task::Task;

/// Overlap that does not count, m: what rounding to 0.01 mm leaves.
const TOLERANCE: f64 = 0.02 * MM;
/// Depths that are tried on the way down, m.
const STEP: f64 = 0.25 * MM;
/// How finely the deepest is found, m.
const FINE: f64 = 0.005 * MM;
/// Overlap of what only touches, m.
const TOUCHING: f64 = 1e-3 * MM;
/// Farthest that a plug is moved aside, m.
const MOST_PLAY: f64 = 10.0 * MM;
/// Places tried along x and along y where the way down is looked for.
const GRID: i32 = 8;
/// How often that grid is drawn in about its best place.
const REFINEMENTS: i32 = 4;

/// The lowest place that an upright plug reaches.
#[derive(Debug, Clone, PartialEq)]
pub struct Seat {
    /// Depth of the tip below the socket's top, m; 0 if it does not enter.
    pub depth: f64,
    /// Where the plug's axis then is, m.
    pub at: [f64; 2],
    /// What stops it there: a plug part and a socket part; none if it falls through.
    pub stopped_by: Option<[usize; 2]>,
}

/// Upright places of a plug over a socket.
pub struct Seating<'a> {
    plug: &'a ConvexBody<'a>,
    socket: &'a ConvexBody<'a>,
    opening: [[f64; 2]; 2],
}

impl<'a> Seating<'a> {
    /// Of this plug in this socket.
    pub fn new(task: &Task, plug: &'a ConvexBody, socket: &'a ConvexBody) -> Self {
        Seating { plug, socket, opening: task.opening }
    }

    /// Lowers the plug as far as it goes.
    pub fn deepest(&self) -> Seat {
        let [bottom, top] = self.plug.extent(2);
        let mut at = self.opening.map(|[low, high]| (low + high) / 2.0);
        let mut free = 0.0;
        let mut depth = STEP;
        while depth < top - bottom {
            match self.place(depth, at) {
                Ok(place) => (free, at) = (depth, place),
                Err(_) => return self.between(free, depth, at),
            }
            depth += STEP;
        }
        Seat { depth: free, at, stopped_by: None }
    }

    /// How far the upright plug can be moved along an axis (0 x, 1 y) at this depth, there and
    /// back, m: what opening and plug really leave, chamfers aside.
    pub fn play(&self, depth: f64, at: [f64; 2], axis: usize) -> f64 {
        // What is found seated may touch walls, so first to the middle between them.
        let mut middle = at;
        for axis in [0, 1, 0, 1] {
            let [back, forth] = self.ways(depth, middle, axis);
            middle[axis] += (forth - back) / 2.0;
        }
        self.ways(depth, middle, axis).iter().sum()
    }

    /// How far the plug can be moved back and forth along an axis, m.
    fn ways(&self, depth: f64, at: [f64; 2], axis: usize) -> [f64; 2] {
        let least = self.overlap(depth, at).0.max(TOUCHING);
        [-1.0, 1.0].map(|sign| {
            let (mut free, mut blocked) = (0.0, MOST_PLAY);
            while blocked - free > TOUCHING {
                let middle = (free + blocked) / 2.0;
                let mut place = at;
                place[axis] += sign * middle;
                let hit = self.overlap(depth, place).0 > least;
                let end = if hit { &mut blocked } else { &mut free };
                *end = middle;
            }
            free
        })
    }

    /// Bisects between a depth that is free and one that is not.
    fn between(&self, mut free: f64, mut blocked: f64, mut at: [f64; 2]) -> Seat {
        let mut stopped_by = None;
        while blocked - free > FINE {
            let middle = (free + blocked) / 2.0;
            match self.place(middle, at) {
                Ok(place) => (free, at) = (middle, place),
                Err(by) => (blocked, stopped_by) = (middle, Some(by)),
            }
        }
        Seat { depth: (free - TOLERANCE).max(0.0), at, stopped_by }
    }

    /// A place at which the plug is free at this depth, near `at` if there is one;
    /// otherwise the two parts in the way at the best place.
    fn place(&self, depth: f64, at: [f64; 2]) -> Result<[f64; 2], [usize; 2]> {
        let mut best = self.overlap(depth, at);
        if best.0 <= TOLERANCE {
            return Ok(at);
        }
        let mut at = at;
        let range = self.room(depth);
        let mut middle = range.map(|[low, high]| (low + high) / 2.0);
        let mut half = range.map(|[low, high]| (high - low).abs() / 2.0);
        for _ in 0..REFINEMENTS {
            for i in 0..=GRID {
                for j in 0..=GRID {
                    let share = |k: i32| f64::from(2 * k - GRID) / f64::from(GRID);
                    let place = [middle[0] + half[0] * share(i), middle[1] + half[1] * share(j)];
                    let found = self.overlap(depth, place);
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

    /// Where the plug's axis may be so that what is below the top lies in the opening.
    fn room(&self, depth: f64) -> [[f64; 2]; 2] {
        let section = section(self.plug, depth);
        [0, 1].map(|axis| {
            let ([low, high], [from, to]) = (self.opening[axis], section[axis]);
            [low - from, high - to]
        })
    }

    fn overlap(&self, depth: f64, [x, y]: [f64; 2]) -> (f64, [usize; 2]) {
        let pose = Pose::translation(x, y, -depth);
        let found = self.plug.overlap(&pose, self.socket, &Pose::identity());
        found.map_or((0.0, [0, 0]), |overlap| (overlap.depth, overlap.parts))
    }
}

/// What the plug needs of the opening to be this deep: from, to in x and y, m.
pub fn section(plug: &ConvexBody, depth: f64) -> [[f64; 2]; 2] {
    let below: Vec<_> = plug
        .parts
        .iter()
        .flat_map(|part| clipped(&part.solid.corners(), 2, [f64::NEG_INFINITY, depth]))
        .collect();
    [0, 1].map(|axis| span(below.iter().map(|p| p[axis])))
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::shipped::TASKS;

    fn seat(name: &str, change: impl Fn(String) -> String) -> (Seat, Task) {
        let file = TASKS.iter().find(|file| file.name == name).unwrap();
        let task = Task::parse(&change(file.text.to_owned()), file.file).unwrap();
        let (plug, socket) = (ConvexBody::plug(&task.plug), ConvexBody::new(&task.socket));
        (Seating::new(&task, &plug, &socket).deepest(), task)
    }

    /// usb: the body's shoulder on the housing; ket12: the floor; rj45: the floor beside its step
    /// and, at the same depth, the guide blocks.
    #[test]
    fn shipped_plugs_end_where_their_drawings_say() {
        for (name, depth_mm, by) in [
            ("usb", 12.57, ["moulded body", "wall at"]),
            ("ket12", 29.0, ["key", "floor"]),
            ("rj45", 12.0, ["", ""]),
        ] {
            let (seat, task) = seat(name, |text| text);
            let [plug, socket] = seat.stopped_by.unwrap();
            let by_names = [&task.plug.parts[plug].name, &task.socket[socket].name];
            assert!((seat.depth / MM - depth_mm).abs() < 0.04, "{name}: {seat:?}");
            assert!(by_names[0].starts_with(by[0]), "{name}: {by_names:?}");
            assert!(by_names[1].starts_with(by[1]), "{name}: {by_names:?}");
        }
    }

    #[test]
    fn the_play_of_a_key_is_its_clearance() {
        let file = TASKS.iter().find(|file| file.name == "ket12").unwrap();
        let task = Task::parse(file.text, file.file).unwrap();
        let (plug, socket) = (ConvexBody::plug(&task.plug), ConvexBody::new(&task.socket));
        let seating = Seating::new(&task, &plug, &socket);
        for (axis, clearance_mm) in [(0, 0.208), (1, 0.195)] {
            let play = seating.play(20.0 * MM, [0.0, 0.0], axis);
            assert!((play / MM - clearance_mm).abs() < 0.005, "{axis}: {play}");
        }
    }

    #[test]
    fn a_plug_wider_than_its_opening_stays_outside() {
        let (seat, _) = seat("ket12", |text| {
            text.replace("[-6.0, 6.0]\nz_mm = [0.0, 50.0]", "[-6.2, 6.2]\nz_mm = [0.0, 50.0]")
        });
        assert!(seat.depth < 0.1 * MM, "{seat:?}");
    }
}
