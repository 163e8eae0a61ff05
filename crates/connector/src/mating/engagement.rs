//! Side walls of the plug that face walls of the socket.

use super::map::{Map, NOWHERE};

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
            sums[strip.side] += f64::from((high.min(faced) - low).max(0.0)) * self.step[1 - strip.side / 2];
        }
        sums
    }
}

/// Volume that both parts fill, from the contact upward, m3.
pub fn common(socket: &Map, plug: &Map, shift: [i32; 2], z: f32) -> f64 {
    let mut sum = 0.0;
    for y in plug.first[1]..plug.first[1] + plug.count[1] as i32 {
        for x in plug.first[0]..plug.first[0] + plug.count[0] as i32 {
            let height = socket.at(x + shift[0], y + shift[1]) - plug.at(x, y) - z;
            sum += f64::from(height.max(0.0));
        }
    }
    sum * plug.step[0] * plug.step[1]
}
