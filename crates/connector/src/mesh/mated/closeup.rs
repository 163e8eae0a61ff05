//! Picture of a point at which convex parts and drawn shape differ.

use super::gaps::Bodies;
use crate::mesh::Triangle;
use crate::picture::{INSIDE, PANEL, VIEWS};
use contact::scene::Pose;
use drawing::{Drawing, Font, Style, View};
use input::units::MM;
use insertion::Part;
use insertion::task::geometry;
use nalgebra::{Point2, Point3};

/// Distance from the point to the sides of a panel, m.
const AROUND: f64 = 1.0 * MM;
const DRAWN: [Style; 2] = [Style::line("#8a5a10", 2.0), Style::line("#56657d", 2.0)];
const PARTS: [Style; 2] =
    [Style::line("#e8a33d", 1.0).dashed(), Style::line("#1c5fb0", 1.0).dashed()];

/// Draws three sections through `place`, task frame, m, as an SVG: drawn faces and convex parts of the socket, and of
/// the plug at `pose`.
pub fn svg(bodies: &Bodies, pose: &Pose, place: Point3<f64>) -> String {
    let mut drawing = Drawing::default();
    drawing.white_background();
    let [x, y, z] = [place.x, place.y, place.z].map(|v| v / MM);
    let title = format!("section at [{x:.2}, {y:.2}, {z:.2}] mm, 2 mm wide");
    drawing.text(Point2::new(10.0, 20.0), &title, Font::new(16.0));
    let moved = |body: usize| if body == 0 { *pose } else { Pose::identity() };
    let faces = |part: &Part| {
        let (corners, faces) = geometry::hull(&part.solid.corners()).unwrap_or_default();
        faces.iter().map(|face| face.map(|corner| corners[corner])).collect::<Vec<_>>()
    };
    for (column, (title, axes)) in VIEWS.into_iter().enumerate() {
        let across = 3 - axes[0] - axes[1];
        let corner = Point2::new(column as f64 * PANEL + 5.0, 50.0);
        drawing.text(corner, title, Font::new(13.0));
        let scale = INSIDE / (2.0 * AROUND);
        let [right, up] = axes.map(|axis| place[axis]);
        let origin = Point2::new(INSIDE / 2.0 - right * scale, INSIDE / 2.0 + up * scale);
        let view = View { origin, scale };
        drawing.panel(corner + nalgebra::Vector2::new(0.0, 8.0), [INSIDE; 2], |drawing| {
            let mut lines = |triangles: &[Triangle], body: usize, style: Style| {
                for face in triangles {
                    let ends = cut(&face.map(|p| moved(body) * p), across, place[across]);
                    if let [a, b] = ends[..] {
                        let at = |p: Point3<f64>| view.place(Point2::new(p[axes[0]], p[axes[1]]));
                        drawing.line([at(a), at(b)], style);
                    }
                }
            };
            for body in [0, 1] {
                lines(bodies.drawn[body], body, DRAWN[body]);
                bodies.parts[body].iter().for_each(|part| lines(&faces(part), body, PARTS[body]));
            }
            drawing.disc(Point2::new(INSIDE / 2.0, INSIDE / 2.0), 4.0, Style::line("#a01818", 1.5));
        });
    }
    let legend = "lines: drawn plug (brown) and socket (grey); dashed: their convex parts; red: the point of the title";
    drawing.text(Point2::new(10.0, PANEL + 75.0), legend, Font::new(13.0));
    drawing.svg([VIEWS.len() as f64 * PANEL, PANEL + 90.0], "")
}

/// Returns the ends of the segment in which a triangle crosses a plane; empty if it does not cross it.
fn cut(face: &Triangle, axis: usize, at: f64) -> Vec<Point3<f64>> {
    let above = |p: &Point3<f64>| p[axis] - at;
    let edge = |i: usize| {
        let (p, q) = (face[i], face[(i + 1) % 3]);
        let (a, b) = (above(&p), above(&q));
        ((a > 0.0) != (b > 0.0)).then(|| p + (q - p) * (a / (a - b)))
    };
    (0..3).filter_map(edge).collect()
}
