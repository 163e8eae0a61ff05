//! Pin header and its housing: square pins on a grid, and a plate with one hole per pin.

use super::draft::{Size, block, separated_by_x};
use input::units::MM;
use insertion::Part;
use parameters::numbers;

/// Largest number of pins of a header.
const MAX_PINS: u32 = 100;

/// Grid of the pins of a header; lengths in m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pins {
    /// Number of pins in y (rows, between the jaws) and in x (columns).
    pub count: [u32; 2],
    /// Distance from pin to pin.
    pub pitch: f64,
    /// Side of a pin.
    pub side: f64,
    /// Length of a pin.
    pub length: f64,
}

impl Pins {
    /// Parses the number of pins in y and in x, ROWSxCOLUMNS.
    ///
    /// # Errors
    /// If the text has another format, a number is 0, or their product is above 100.
    pub fn count(text: &str) -> Result<[u32; 2], String> {
        let usage = format!("give ROWSxCOLUMNS, at most {MAX_PINS} pins, as in 2x5");
        let usable = |&[rows, columns]: &[u32; 2]| {
            rows > 0 && columns > 0 && rows.saturating_mul(columns) <= MAX_PINS
        };
        separated_by_x::<u32, 2>(text).filter(usable).ok_or(usage)
    }

    /// Parses a dimension in mm: side or length of a pin, or the pitch.
    ///
    /// # Errors
    /// If the text is not a number from 0.1 to 50 mm.
    pub fn length_mm(text: &str) -> Result<f64, String> {
        let mm = text.parse::<f64>().map_err(|_| "give a number of mm, as in 0.64".to_owned())?;
        numbers::problem("connector.pin_mm", mm).map_or(Ok(mm), Err)
    }

    /// Returns the size of the bounding box of all pins.
    pub fn size(&self) -> Size {
        let [width, height] = self.count.map(|count| f64::from(count - 1) * self.pitch + self.side);
        Size { width, height, length: self.length }
    }

    /// Returns the size of the body of the header: one pitch per pin in x and y, and a length sufficient for the pads.
    pub fn body(&self) -> Size {
        let [width, height] = self.count.map(|count| f64::from(count) * self.pitch);
        Size { width, height, length: 20.0 * MM }
    }

    /// Returns the coordinates of the pin centres, m, in y for `axis` 0 and in x for 1, as in `count`.
    fn centres(&self, axis: usize) -> impl Iterator<Item = f64> {
        let (count, pitch) = (self.count[axis], self.pitch);
        (0..count).map(move |i| (f64::from(i) - f64::from(count - 1) / 2.0) * pitch)
    }

    /// Returns the pins from z = 0 upwards.
    pub fn parts(&self) -> Vec<Part> {
        let around = |centre: f64| [centre - self.side / 2.0, centre + self.side / 2.0];
        let pin = |(i, [x, y]): (usize, [f64; 2])| {
            block(&format!("pin {i}"), [around(x), around(y), [0.0, self.length]])
        };
        let places = self.centres(0).flat_map(|y| self.centres(1).map(move |x| [x, y]));
        (1..).zip(places).map(pin).collect()
    }

    /// Returns the parts of a plate with these extents in x, y and z, m, and one square hole per pin; `clearance`
    /// is the width of a hole minus that of a pin, m.
    pub fn plate(&self, clearance: f64, [x, y]: [[f64; 2]; 2], z: [f64; 2]) -> Vec<Part> {
        let half = (self.side + clearance) / 2.0;
        let between = |axis: usize, [low, high]: [f64; 2]| -> Vec<[f64; 2]> {
            let ends = self.centres(axis).map(|at| at - half).chain([high]);
            let begins = [low].into_iter().chain(self.centres(axis).map(|at| at + half));
            begins.zip(ends).map(|(begin, end)| [begin, end]).collect()
        };
        // Bars lie between the columns of holes, webs between the holes of a column.
        let bars = between(1, x).into_iter().map(|x| [x, y]);
        let webs = self
            .centres(1)
            .flat_map(|at| between(0, y).into_iter().map(move |y| [[at - half, at + half], y]));
        let part = |(i, [x, y]): (usize, [[f64; 2]; 2])| block(&format!("plate {i}"), [x, y, z]);
        (1..).zip(bars.chain(webs)).map(part).collect()
    }
}
