//! Side walls of the plug that face walls of the socket.

use super::map::{Map, NOWHERE};

/// Area of the plug's walls that look along +x, -x, +y and -y and face a wall of the socket, m2.
pub type Walls = [f64; 4];

/// Area on the weaker of two opposite sides, the mean of both cross axes, m2.
pub fn score(walls: &Walls) -> f64 {
    (walls[0].min(walls[1]) * walls[2].min(walls[3])).sqrt()
}

/// Walls of a plug shifted by whole cells, at a height, with a socket's wall within `reach` cells.
pub fn walls(socket: &Map, plug: &Map, shift: [i32; 2], z: f32, reach: usize) -> Walls {
    let [nx, ny] = plug.count;
    let at = |x: i32, y: i32| plug.at(x + plug.first[0], y + plug.first[1]);
    let far = |x: i32, y: i32| {
        socket.at(x + plug.first[0] + shift[0], y + plug.first[1] + shift[1])
    };
    let mut sums = [0.0; 4];
    for y in 0..ny as i32 {
        for x in 0..nx as i32 {
            let low = at(x, y) + z;
            if low > NOWHERE / 2.0 {
                continue;
            }
            for (side, [dx, dy]) in [[1, 0], [-1, 0], [0, 1], [0, -1]].into_iter().enumerate() {
                // The neighbour ends higher: between both heights the plug has a wall to its side.
                let high = at(x + dx, y + dy) + z;
                if high <= low {
                    continue;
                }
                let faced = (0..=reach as i32).map(|k| far(x + k * dx, y + k * dy));
                let faced = faced.fold(-NOWHERE, |a, b| if b > a { b } else { a });
                let height = high.min(faced) - low;
                if height > 0.0 {
                    sums[side] += f64::from(height) * plug.step[usize::from(side < 2)];
                }
            }
        }
    }
    sums
}
