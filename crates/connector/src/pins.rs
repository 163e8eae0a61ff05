//! Pin header and its housing: square pins on a grid, and a plate with a hole for each.

use super::draft::{Size, block};
use input::units::MM;
use insertion::task::Part;
use parameters::numbers;

/// Largest number of pins of a header.
const MOST: u32 = 100;

/// Pins of a header, m.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Pins {
    /// Number in y, between the jaws, and in x.
    pub count: [u32; 2],
    /// Distance from pin to pin.
    pub pitch: f64,
    /// Side of a pin.
    pub side: f64,
    /// Length of a pin.
    pub length: f64,
}

impl Pins {
    /// Parses the number of pins in y and in x, NxM.
    ///
    /// # Errors
    /// If the text is something else, a number is 0, or their product is above 100.
    pub fn count(text: &str) -> Result<[u32; 2], String> {
        let right = format!("give ROWSxCOLUMNS, at most {MOST} pins, as in 2x5");
        let numbers: Result<Vec<u32>, _> =
            text.split(['x', 'X', '×']).map(|number| number.trim().parse()).collect();
        let count = numbers.ok().and_then(|numbers| <[u32; 2]>::try_from(numbers).ok());
        let usable = |&[rows, columns]: &[u32; 2]| {
            rows > 0 && columns > 0 && rows.saturating_mul(columns) <= MOST
        };
        count.filter(usable).ok_or(right)
    }

    /// Parses the side of a pin, its length or the pitch, mm.
    ///
    /// # Errors
    /// If the text is not a number from 0.1 to 50 mm.
    pub fn length_mm(text: &str) -> Result<f64, String> {
        let mm = text.parse::<f64>().map_err(|_| "give a number of mm, as in 0.64".to_owned())?;
        numbers::problem("connector.pin_mm", mm).map_or(Ok(mm), |problem| Err(problem + " mm"))
    }

    /// Returns the size of the block about all pins.
    pub fn size(&self) -> Size {
        let [width, height] = self.count.map(|count| f64::from(count - 1) * self.pitch + self.side);
        Size { width, height, length: self.length }
    }

    /// Returns the size of the body of the header: a pitch for each pin, and long enough for the pads.
    pub fn body(&self) -> Size {
        let [width, height] = self.count.map(|count| f64::from(count) * self.pitch);
        Size { width, height, length: 20.0 * MM }
    }

    /// Returns the centres of the pins in y or in x.
    fn middles(&self, axis: usize) -> impl Iterator<Item = f64> {
        let (count, pitch) = (self.count[axis], self.pitch);
        (0..count).map(move |i| (f64::from(i) - f64::from(count - 1) / 2.0) * pitch)
    }

    /// Returns the pins from z = 0 upwards.
    pub fn parts(&self) -> Vec<Part> {
        let about = |middle: f64| [middle - self.side / 2.0, middle + self.side / 2.0];
        let pin = |(i, [x, y]): (usize, [f64; 2])| {
            block(&format!("pin {i}"), [about(x), about(y), [0.0, self.length]])
        };
        let places = self.middles(0).flat_map(|y| self.middles(1).map(move |x| [x, y]));
        (1..).zip(places).map(pin).collect()
    }

    /// Returns a plate of an extent in x, y and z with a hole for each pin.
    pub fn plate(&self, clearance: f64, [x, y]: [[f64; 2]; 2], z: [f64; 2]) -> Vec<Part> {
        let half = (self.side + clearance) / 2.0;
        let between = |axis: usize, [low, high]: [f64; 2]| -> Vec<[f64; 2]> {
            let ends = self.middles(axis).map(|at| at - half).chain([high]);
            let begins = [low].into_iter().chain(self.middles(axis).map(|at| at + half));
            begins.zip(ends).map(|(begin, end)| [begin, end]).collect()
        };
        let bars = between(1, x).into_iter().map(|x| [x, y]);
        let webs = self
            .middles(1)
            .flat_map(|at| between(0, y).into_iter().map(move |y| [[at - half, at + half], y]));
        let part = |(i, [x, y]): (usize, [[f64; 2]; 2])| block(&format!("plate {i}"), [x, y, z]);
        (1..).zip(bars.chain(webs)).map(part).collect()
    }
}
