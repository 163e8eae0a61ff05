//! Dimension lines of a drawing.

use maud::{Markup, html};
use nalgebra::{Point2, Vector2};

/// Overhang of an extension line over its dimension line, and half a tick, mm on paper.
const BEYOND: f64 = 1.5;
/// Gap between the drawn part and its extension line, mm on paper.
const GAP: f64 = 1.0;

/// Placement of a part on paper: millimetres, Y downwards.
#[derive(Debug, Clone, Copy)]
pub(super) struct View {
    /// Position of the part's origin, mm on paper.
    pub origin: Point2<f64>,
    /// Size on paper by the size of the part.
    pub scale: f64,
}

impl View {
    /// Position on paper, mm, of a point of the part, mm with Y upwards.
    pub fn place(&self, point: Point2<f64>) -> Point2<f64> {
        self.origin + self.scale * Vector2::new(point.x, -point.y)
    }

    /// Dimension line from `a` to `b` at a distance (mm on paper) to their left.
    pub fn length(&self, a: Point2<f64>, b: Point2<f64>, distance: f64, text: &str) -> Markup {
        let ends = [self.place(a), self.place(b)];
        let along = (ends[1] - ends[0]).normalize();
        let left = Vector2::new(along.y, -along.x) * distance.signum();
        let shown = ends.map(|end| end + left * distance.abs());
        let tick = (along + left) * BEYOND;
        html! {
            g stroke="#444" stroke-width="0.18" {
                @for (end, at) in ends.into_iter().zip(shown) {
                    (line(end + left * GAP, at + left * BEYOND))
                    (line(at - tick, at + tick))
                }
                (line(shown[0], shown[1]))
            }
            (beside(nalgebra::center(&shown[0], &shown[1]), along, text))
        }
    }
}

/// Straight line on paper.
pub(super) fn line(a: Point2<f64>, b: Point2<f64>) -> Markup {
    let [x1, y1, x2, y2] = [a.x, a.y, b.x, b.y].map(|value| format!("{value:.2}"));
    html! { line x1=(x1) y1=(y1) x2=(x2) y2=(y2) {} }
}

/// Text whose middle stands above a point on paper, along a direction and never upside down.
fn beside(at: Point2<f64>, along: Vector2<f64>, text: &str) -> Markup {
    let along = if along.x < -1e-9 || (along.x < 1e-9 && along.y > 0.0) { -along } else { along };
    let degrees = along.y.atan2(along.x).to_degrees();
    let turn = format!("translate({:.2},{:.2}) rotate({degrees:.2})", at.x, at.y);
    html! { g transform=(turn) { text y="-1.2" text-anchor="middle" { (text) } } }
}
