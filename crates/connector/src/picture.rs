//! SVG of a task: plug at the start and seated, socket, fingertips, search path, clearances.

use super::body::{extent, span, width};
use super::seat::{self, Seat, TaskBodies, Waypoint, section};
use contact::scene::{Geom, Pose};
use drawing::{Drawing, Font, Style, View};
use input::units::MM;
use insertion::task::geometry::convex_outline;
use insertion::{Pad, Part, Task};
use nalgebra::{Point2, Point3, Vector2};

/// Size of a panel with the gap to the next one, pixels.
pub(crate) const PANEL: f64 = 420.0;
/// Size of a panel without the gap, pixels.
pub(crate) const INSIDE: f64 = PANEL - 10.0;
/// Width and height of the drawing of a task, pixels.
const SIZE: [f64; 2] = [VIEWS.len() as f64 * PANEL, PANEL + 130.0];
const SOCKET: Style = Style::fill("#b8c4d6").opacity(0.5).outlined("#56657d", 1.0);
const PLUG: Style = Style::fill("#e8a33d").opacity(0.5).outlined("#8a5a10", 1.0);
const SEATED: Style = Style::line("#8a5a10", 1.0).dashed();
const FINGERS: Style = Style::fill("#5b8c5a").opacity(0.5).outlined("#2d4f2c", 1.0);
const PATH: &str = "#1c5fb0";
const FONT: Font = Font::new(13.0);
/// Margin around a view, as a share of its size.
const MARGIN: f64 = 0.08;
/// Width of the socket shown beside the opening, m.
const SOCKET_MARGIN: f64 = 8.0 * MM;

/// Views of the task: title, and the axes to the right and up.
pub(crate) const VIEWS: [(&str, [usize; 2]); 3] = [
    ("from the side: y to the right, z up", [1, 2]),
    ("from the front: x to the right, z up", [0, 2]),
    ("from above: y to the right, x up", [1, 0]),
];

/// Draws the task as an SVG.
pub fn svg(task: &Task) -> String {
    stacked(&[("", task)])
}

/// Draws tasks one below the other, each with a prefix of its description.
pub fn stacked(tasks: &[(&str, &Task)]) -> String {
    let mut drawing = Drawing::default();
    drawing.white_background();
    for (row, (prefix, task)) in tasks.iter().enumerate() {
        Picture::new(task).draw(&mut drawing, prefix, row as f64 * SIZE[1]);
    }
    drawing.svg([SIZE[0], tasks.len() as f64 * SIZE[1]], "")
}

/// Drawing of a task: its waypoints, its start, its deepest seat and the section of its tip.
struct Picture<'a> {
    task: &'a Task,
    waypoints: Vec<Waypoint>,
    start: Pose,
    seat: Seat,
    tip: [[f64; 2]; 2],
}

/// Projection of a view to pixels of its panel.
struct Frame {
    /// Axes to the right and up.
    axes: [usize; 2],
    view: View,
}

impl Frame {
    fn at(&self, p: &Point3<f64>) -> Point2<f64> {
        let [right, up] = self.axes;
        self.view.place(Point2::new(p[right], p[up]))
    }

    fn polygon(&self, drawing: &mut Drawing, geom: &Geom, body: &Pose, style: Style) {
        let pose = body * geom.pose;
        let corners = geom.shape.corners();
        let outline = convex_outline(corners.iter().map(|p| self.at(&(pose * p))).collect());
        drawing.polygon(outline, style);
    }

    /// Draws a scale bar of 1, 2 or 5 times a power of ten mm, about a fifth of the panel.
    fn scale_bar(&self, drawing: &mut Drawing) {
        let fifth = INSIDE / 5.0 / self.view.scale / MM;
        let lengths = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0];
        let length = lengths.into_iter().rfind(|&mm| mm <= fifth).unwrap_or(0.1);
        let at = Point2::new(12.0, INSIDE - 12.0);
        drawing.scale_bar(at, length * MM * self.view.scale, &format!("{length} mm"), 11.0);
    }
}

impl<'a> Picture<'a> {
    fn new(task: &'a Task) -> Self {
        let bodies = TaskBodies::new(task);
        let waypoints = seat::waypoints(task, &bodies.plug);
        let seat = bodies.deepest();
        let tip = section(&bodies.plug, task.success.depth.min(seat.depth));
        let start = seat::plug_pose(task, waypoints[0].tcp);
        Picture { task, waypoints, start, seat, tip }
    }

    fn draw(&self, drawing: &mut Drawing, prefix: &str, top: f64) {
        let title = format!("{}: {prefix}{}", self.task.name, self.task.description);
        drawing.text(Point2::new(10.0, top + 20.0), &title, Font::new(16.0));
        for (column, (title, axes)) in VIEWS.into_iter().enumerate() {
            let corner = Point2::new(column as f64 * PANEL + 5.0, top + 50.0);
            drawing.text(corner + Vector2::new(5.0, -6.0), title, FONT);
            let frame = self.frame(axes);
            drawing.panel(corner, [INSIDE; 2], |drawing| self.view(drawing, &frame));
        }
        self.legend(drawing, top + PANEL + 60.0);
    }

    fn seated(&self) -> Pose {
        let [x, y] = self.seat.at;
        Pose::translation(x, y, -self.seat.depth)
    }

    /// Returns the interval that a view shows along an axis, m.
    fn reach(&self, axis: usize) -> [f64; 2] {
        let corners = |parts: &[Part], pose: Pose| {
            let corners = parts.iter().flat_map(|part| part.solid.corners());
            extent(corners.map(|p| pose * p), axis)
        };
        let plug = [self.start, self.seated()].map(|pose| corners(&self.task.plug.parts, pose));
        let [low, high] = span(plug.into_iter().flatten());
        match self.task.opening.get(axis) {
            Some([a, b]) => [low.min(a - SOCKET_MARGIN), high.max(b + SOCKET_MARGIN)],
            None => [corners(&self.task.socket, Pose::identity())[0], high],
        }
    }

    fn frame(&self, axes: [usize; 2]) -> Frame {
        let [[left, right], [bottom, top]] = axes.map(|axis| self.reach(axis));
        let size = (right - left).max(top - bottom) * (1.0 + 2.0 * MARGIN);
        let scale = INSIDE / size;
        let origin = Point2::new(size - left - right, bottom + top + size) * (scale / 2.0);
        Frame { axes, view: View { origin, scale } }
    }

    fn view(&self, drawing: &mut Drawing, frame: &Frame) {
        let from_above = frame.axes[1] != 2;
        for part in &self.task.socket {
            frame.polygon(drawing, &part.geom(), &Pose::identity(), SOCKET);
        }
        let seated = self.seated();
        // From above only the parts that enter the opening are drawn: the rest would hide them.
        let enters = |part: &Part| extent(part.solid.corners(), 2)[0] < self.task.success.depth;
        for part in self.task.plug.parts.iter().filter(|part| !from_above || enters(part)) {
            frame.polygon(drawing, &part.geom(), &self.start, PLUG);
            frame.polygon(drawing, &part.geom(), &seated, SEATED);
        }
        if from_above {
            let [x, y] = self.task.opening;
            let corners = [0, 1].map(|end| frame.at(&Point3::new(x[end], y[end], 0.0)));
            drawing.rectangle(corners, 0.0, Style::line("#a01818", 1.5));
        } else {
            let grip = &self.task.grip;
            for (side, face) in [-1.0, 1.0].into_iter().zip(grip.faces_y) {
                let pose = self.start * Pose::translation(0.0, face, grip.tcp_z);
                for geom in Pad::PUBLISHED.geoms(grip.shoulder(), side) {
                    frame.polygon(drawing, &geom, &pose, FINGERS);
                }
            }
        }
        self.path(drawing, frame);
        frame.scale_bar(drawing);
    }

    fn path(&self, drawing: &mut Drawing, frame: &Frame) {
        let points: Vec<_> = self.waypoints.iter().map(|point| frame.at(&point.edge)).collect();
        drawing.line(points.iter().copied(), Style::line(PATH, 1.5));
        // Waypoints that coincide in a view share a label.
        let near = |p: &Point2<f64>, q: &Point2<f64>| (p - q).norm() < 9.0;
        let mut labels: Vec<(Point2<f64>, f64)> = Vec::new();
        for (first, p) in points.iter().enumerate() {
            if points[..first].iter().any(|q| near(p, q)) {
                continue;
            }
            let here = points.iter().enumerate().filter(|(_, q)| near(p, q));
            let label = here.map(|(number, _)| number.to_string()).collect::<Vec<_>>().join(",");
            drawing.disc(*p, 2.5, Style::fill(PATH));
            // Above or below the point, where no other label is.
            let wide = 6.5 * label.len() as f64;
            let places = [-5.0, 14.0, -17.0].map(|dy| p + Vector2::new(4.0, dy));
            let free = |at: &&Point2<f64>| {
                let apart = |(q, w): &(Point2<f64>, f64)| {
                    (at.y - q.y).abs() > 11.0 || at.x > q.x + w || q.x > at.x + wide
                };
                labels.iter().all(apart)
            };
            let at = *places.iter().find(free).unwrap_or(&places[0]);
            labels.push((at, wide));
            drawing.text(at, &label, Font::new(11.0).colour(PATH));
        }
    }

    fn legend(&self, drawing: &mut Drawing, top: f64) {
        let task = self.task;
        let clearance = |axis: usize| width(task.opening[axis]) / MM - width(self.tip[axis]) / MM;
        let ([x, y], seat, success) =
            ([0, 1].map(clearance), self.seat.depth / MM, task.success.depth / MM);
        let steps = self.waypoints.iter().enumerate();
        let steps = steps.map(|(number, point)| format!("{number} {}", point.name));
        let steps = steps.collect::<Vec<_>>().join(", ");
        let lines = [
            format!(
                "clearance (opening minus plug): {x:.3} mm in x, {y:.3} mm in y; upright the plug goes \
                 {seat:.2} mm deep (dashed), success at {success:.2} mm"
            ),
            format!("blue: commanded path of the tip's lower edge: {steps}"),
            "orange: plug at the start; green: fingertips; grey: socket; red: opening".to_owned(),
        ];
        for (i, line) in lines.iter().enumerate() {
            drawing.text(Point2::new(10.0, top + 20.0 * i as f64), line, FONT);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::shipped::TASKS;

    #[test]
    fn clearances_are_written_to_a_micrometre() {
        let usb = TASKS.iter().find(|file| file.name == "usb").unwrap();
        let svg = svg(&Task::parse(usb.text, usb.file).unwrap());
        assert!(svg.contains("3.070 mm in x, 3.000 mm in y"), "{svg}");
    }
}
