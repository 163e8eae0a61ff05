//! Side walls of the plug that face walls of the socket.

use super::map::{Map, NOWHERE};

/// Width of a ledge all round that stops a plug, m: it costs as much as a square plug's walls gain.
const LEDGE: f64 = 0.125e-3;

/// Area of the plug's walls that look along +x, -x, +y and -y and face a wall of the socket, m2.
pub type Walls = [f64; 4];

/// Area on the weaker of two opposite sides, the mean of both cross axes, m2.
pub fn score(walls: &Walls) -> f64 {
    (walls[0].min(walls[1]) * walls[2].min(walls[3])).sqrt()
}

/// Directions of the four sides.
pub const SIDES: [[i32; 2]; 4] = [[1, 0], [-1, 0], [0, 1], [0, -1]];

/// Strip of a side wall of the plug, one cell wide.
#[derive(Debug, Clone, Copy)]
struct Strip {
    /// Cell of which it is a side.
    cell: [i32; 2],
    side: usize,
    low: f32,
    high: f32,
}

/// Side walls of a plug.
#[derive(Debug, Clone)]
pub struct Sides {
    strips: Vec<Strip>,
    step: [f64; 2],
}

impl Sides {
    /// Side walls in a map, steeper than 45 degrees.
    pub fn new(plug: &Map) -> Self {
        let mut strips = Vec::new();
        for y in plug.first[1]..plug.first[1] + plug.count[1] as i32 {
            for x in plug.first[0]..plug.first[0] + plug.count[0] as i32 {
                let low = plug.at(x, y);
                if low > NOWHERE / 2.0 {
                    continue;
                }
                for (side, [dx, dy]) in SIDES.into_iter().enumerate() {
                    // The neighbour ends higher: between both heights the plug has a wall to its side.
                    let high = plug.at(x + dx, y + dy);
                    if high - low > plug.step[side / 2] as f32 {
                        strips.push(Strip { cell: [x, y], side, low, high });
                    }
                }
            }
        }
        Sides { strips, step: plug.step }
    }

    /// Walls of the plug shifted by whole cells, at a height, with a socket's wall within `reach` of
    /// them that does not go deeper into the plug than `tolerance`, m.
    pub fn facing(
        &self,
        socket: &Map,
        (shift, z): ([i32; 2], f32),
        [reach, tolerance]: [f64; 2],
    ) -> Walls {
        let mut sums = [0.0; 4];
        for strip in &self.strips {
            let [dx, dy] = SIDES[strip.side];
            let step = self.step[strip.side / 2];
            let (reach, into) = ((reach / step).ceil() as i32, (tolerance / step).ceil() as i32);
            let [x, y] = [strip.cell[0] + shift[0], strip.cell[1] + shift[1]];
            let (low, high) = (strip.low + z, strip.high + z);
            // The socket goes through the wall: a spring or a latch, no guide.
            if socket.at(x - (into + 1) * dx, y - (into + 1) * dy) > low + tolerance as f32 {
                continue;
            }
            let mut faced = -NOWHERE;
            for k in -into..=reach {
                faced = faced.max(socket.at(x + k * dx, y + k * dy));
                if faced >= high {
                    break;
                }
            }
            sums[strip.side] +=
                f64::from((high.min(faced) - low).max(0.0)) * self.step[1 - strip.side / 2];
        }
        sums
    }
}

/// Socket and plug in contact.
pub struct Contact<'a> {
    /// Upper envelope of the socket.
    pub socket: &'a Map,
    /// Lower envelope of the plug, without the tolerance.
    pub plug: &'a Map,
    /// Side walls of the plug.
    pub sides: &'a Sides,
    /// Distance within which walls face one another, and depth of harmless interference, m.
    pub limits: [f64; 2],
}

impl Contact<'_> {
    /// Facing walls on the weaker sides, and what both parts fill as an area, m2.
    pub fn areas(&self, shift: [i32; 2], z: f32) -> [f64; 2] {
        let walls = score(&self.sides.facing(self.socket, (shift, z), self.limits));
        let mut volume = 0.0;
        self.each(shift, |_, rest| volume += f64::from((rest - z).max(0.0)));
        [walls, volume * self.plug.step[0] * self.plug.step[1] / LEDGE]
    }

    /// Cells of the plug that the socket fills, too.
    pub fn shared(&self, shift: [i32; 2], z: f32) -> Vec<[i32; 2]> {
        let mut cells = Vec::new();
        self.each(shift, |cell, rest| {
            if rest > z {
                cells.push(cell);
            }
        });
        cells
    }

    fn rest(&self, [x, y]: [i32; 2], shift: [i32; 2]) -> f32 {
        self.socket.at(x + shift[0], y + shift[1]) - self.plug.at(x, y)
    }

    fn each(&self, shift: [i32; 2], mut see: impl FnMut([i32; 2], f32)) {
        let [nx, ny] = self.plug.count.map(|count| count as i32);
        for y in self.plug.first[1]..self.plug.first[1] + ny {
            for x in self.plug.first[0]..self.plug.first[0] + nx {
                see([x, y], self.rest([x, y], shift));
            }
        }
    }
}
