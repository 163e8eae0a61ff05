//! Dimension lines, scale bars and arrows.

use super::{Drawing, Font, Style, escape, rounded};
use nalgebra::{Point2, Vector2, center};

/// Length of an extension line beyond its dimension line, and extent of half a tick along either line, mm.
const BEYOND: f64 = 1.5;
/// Gap between the drawn part and its extension line, mm.
const GAP: f64 = 1.0;
/// Style of dimension and extension lines, width in mm.
const LINE: Style = Style::line("#444", 0.18);

impl Drawing {
    /// Draws a dimension line for two points of a part, with a text above its middle. `distance` is its distance from
    /// the points, positive to the left of the direction from the first to the second. For drawings in mm.
    pub fn dimension(&mut self, ends: [Point2<f64>; 2], distance: f64, words: &str) {
        let along = (ends[1] - ends[0]).normalize();
        let left = Vector2::new(along.y, -along.x) * distance.signum();
        let shown = ends.map(|end| end + left * distance.abs());
        let tick = (along + left) * BEYOND;
        for (end, at) in ends.into_iter().zip(shown) {
            self.line([end + left * GAP, at + left * BEYOND], LINE);
            self.line([at - tick, at + tick], LINE);
        }
        self.line(shown, LINE);
        let (at, along) = (center(&shown[0], &shown[1]), shown[1] - shown[0]);
        // The text reads from below or from the right, not upside down.
        let back = along.x < -1e-9 || (along.x < 1e-9 && along.y > 0.0);
        let along = if back { -along } else { along };
        let [x, y, turn] = [at.x, at.y, libm::atan2(along.y, along.x).to_degrees()].map(rounded);
        let font = Font::new(3.2).middle().fitting(words, along.norm(), 2.0);
        self.element(&format!(
            "<text transform=\"translate({x},{y}) rotate({turn})\" y=\"-1.2\"{font}>{}</text>",
            escape(words)
        ));
    }

    /// Draws a horizontal scale bar from a point, with ticks at its ends and a text beside it; `size` is the font size.
    pub fn scale_bar(&mut self, at: Point2<f64>, length: f64, words: &str, size: f64) {
        let (end, tick) = (at + Vector2::x() * length, Vector2::y() * 0.3 * size);
        let style = Style::line("#333", 0.09 * size);
        [[at, end], [at - tick, at + tick], [end - tick, end + tick]]
            .into_iter()
            .for_each(|ends| self.line(ends, style));
        self.text(end + Vector2::new(0.5, 0.35) * size, words, Font::new(size));
    }

    /// Draws an arrow from a point to its tip; `head` is the length of its head.
    pub fn arrow(&mut self, [from, tip]: [Point2<f64>; 2], head: f64, colour: &'static str) {
        let along = (tip - from).normalize() * head;
        let (neck, across) = (tip - along, Vector2::new(-along.y, along.x) * 0.6);
        let style = Style::fill(colour).outlined(colour, 0.4 * head);
        self.line([from, neck], style);
        self.polygon([neck + across, tip, neck - across], style);
    }
}
