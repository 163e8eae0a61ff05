//! SVG of a task: plug at the start and seated, socket, fingertips, search path, clearances.

use super::body::{ConvexBody, extent, span, width};
use super::seat::{self, Seat, Seating, Waypoint, section};
use contact::scene::{Geom, Pose};
use input::units::MM;
use insertion::finger::Pad;
use insertion::task::geometry::convex_outline;
use insertion::task::{Part, Task};
use insertion::trial::picture::escape;
use nalgebra::{Point2, Point3};
use std::fmt::Write;

const PANEL: f64 = 420.0;
const INSIDE: f64 = PANEL - 10.0;
const SOCKET: &str = "fill=\"#b8c4d6\" fill-opacity=\"0.5\" stroke=\"#56657d\"";
const PLUG: &str = "fill=\"#e8a33d\" fill-opacity=\"0.5\" stroke=\"#8a5a10\"";
const SEATED: &str = "fill=\"none\" stroke=\"#8a5a10\" stroke-dasharray=\"4 3\"";
const FINGERS: &str = "fill=\"#5b8c5a\" fill-opacity=\"0.5\" stroke=\"#2d4f2c\"";
/// Margin about a view, as a share of its size.
const MARGIN: f64 = 0.08;
/// Socket shown beside the opening, m.
const AROUND: f64 = 8.0 * MM;

/// Views of the task: title, and the axes to the right and up.
const VIEWS: [(&str, [usize; 2]); 3] = [
    ("from the side: y to the right, z up", [1, 2]),
    ("from the front: x to the right, z up", [0, 2]),
    ("from above: y to the right, x up", [1, 0]),
];

/// The task before a change of its strategy and after it, one below the other.
pub fn both(before: &Task, after: &Task) -> String {
    let (width, height) = (VIEWS.len() as f64 * PANEL, PANEL + 130.0);
    let titled = |(row, title, task): (f64, &str, &Task)| {
        let task = Task { description: format!("{title}: {}", task.description), ..task.clone() };
        let nested = format!("<svg y=\"{}\" height=\"{height}\"", row * height);
        svg(&task).replacen("<svg", &nested, 1)
    };
    let rows: String = [(0.0, "before", before), (1.0, "after", after)].map(titled).concat();
    format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {:.0}\">\n{rows}</svg>\n",
        2.0 * height
    )
}

struct Drawing<'a> {
    task: &'a Task,
    way: Vec<Waypoint>,
    start: Pose,
    seat: Seat,
    tip: [[f64; 2]; 2],
}

/// The task drawn, as SVG.
pub fn svg(task: &Task) -> String {
    let (plug, socket) = (ConvexBody::plug(&task.plug), ConvexBody::new(&task.socket));
    let way = seat::waypoints(task, &plug);
    let seat = Seating::new(task, &plug, &socket).deepest();
    let tip = section(&plug, task.success.depth.min(seat.depth));
    let start = seat::plug_pose(task, way[0].tcp);
    let drawing = Drawing { task, way, start, seat, tip };
    let (width, height) = (VIEWS.len() as f64 * PANEL, PANEL + 130.0);
    let [name, description] = [&task.name, &task.description].map(|text| escape(text));
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" \
         font-family=\"sans-serif\" font-size=\"13\" fill=\"#222\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
         <text x=\"10\" y=\"20\" font-size=\"16\">{name}: {description}</text>\n"
    );
    for (column, (title, axes)) in VIEWS.into_iter().enumerate() {
        drawing.panel(&mut out, title, axes, [column as f64 * PANEL, 34.0]);
    }
    drawing.legend(&mut out, PANEL + 60.0);
    out.push_str("</svg>\n");
    out
}

/// Projection of a view to pixels.
struct Frame {
    /// Axes to the right and up.
    axes: [usize; 2],
    /// Left and top edge, m.
    corner: [f64; 2],
    scale: f64,
}

impl Frame {
    fn at(&self, p: &Point3<f64>) -> Point2<f64> {
        let [right, up] = self.axes;
        Point2::new((p[right] - self.corner[0]) * self.scale, (self.corner[1] - p[up]) * self.scale)
    }
}

impl Drawing<'_> {
    fn seated(&self) -> Pose {
        let [x, y] = self.seat.at;
        Pose::translation(x, y, -self.seat.depth)
    }

    /// Interval that a view shows along an axis, m.
    fn reach(&self, axis: usize) -> [f64; 2] {
        let corners = |parts: &[Part], pose: Pose| {
            let corners = parts.iter().flat_map(|part| part.solid.corners());
            extent(corners.map(|p| pose * p), axis)
        };
        let plug = [self.start, self.seated()].map(|pose| corners(&self.task.plug.parts, pose));
        let [low, high] = span(plug.into_iter().flatten());
        match self.task.opening.get(axis) {
            Some([a, b]) => [low.min(a - AROUND), high.max(b + AROUND)],
            None => [corners(&self.task.socket, Pose::identity())[0], high],
        }
    }

    fn panel(&self, out: &mut String, title: &str, axes: [usize; 2], [x, y]: [f64; 2]) {
        let [[left, right], [bottom, top]] = axes.map(|axis| self.reach(axis));
        let size = (right - left).max(top - bottom) * (1.0 + 2.0 * MARGIN);
        let corner = [(left + right - size) / 2.0, (bottom + top + size) / 2.0];
        let frame = Frame { axes, corner, scale: INSIDE / size };
        let [text_x, text_y, panel_x, panel_y] = [x + 10.0, y + 10.0, x + 5.0, y + 16.0];
        let _ = write!(
            out,
            "<text x=\"{text_x:.0}\" y=\"{text_y:.0}\">{title}</text>\n\
             <svg x=\"{panel_x:.0}\" y=\"{panel_y:.0}\" width=\"{INSIDE:.0}\" height=\"{INSIDE:.0}\">\n\
             <rect width=\"100%\" height=\"100%\" fill=\"none\" stroke=\"#ccc\"/>\n"
        );
        for part in &self.task.socket {
            polygon(out, &frame, &part.geom(), &Pose::identity(), SOCKET);
        }
        let seated = self.seated();
        // From above only the parts that enter the opening, which the rest would hide.
        let enters = |part: &Part| extent(part.solid.corners(), 2)[0] < self.task.success.depth;
        for part in self.task.plug.parts.iter().filter(|part| axes[1] == 2 || enters(part)) {
            polygon(out, &frame, &part.geom(), &self.start, PLUG);
            polygon(out, &frame, &part.geom(), &seated, SEATED);
        }
        match axes[1] {
            2 => self.fingers(out, &frame),
            _ => self.opening(out, &frame),
        }
        self.path(out, &frame);
        scale_bar(out, &frame);
        out.push_str("</svg>\n");
    }

    fn fingers(&self, out: &mut String, frame: &Frame) {
        let grip = &self.task.grip;
        for (side, face) in [-1.0, 1.0].into_iter().zip(grip.faces_y) {
            let pose = self.start * Pose::translation(0.0, face, grip.tcp_z);
            for geom in Pad::PAPER.geoms(grip.shoulder(), side) {
                polygon(out, frame, &geom, &pose, FINGERS);
            }
        }
    }

    fn opening(&self, out: &mut String, frame: &Frame) {
        let [x, y] = self.task.opening;
        let [a, b] = [0, 1].map(|end| frame.at(&Point3::new(x[end], y[end], 0.0)));
        let (x, y, width, height) = (a.x, b.y, b.x - a.x, a.y - b.y);
        let _ = writeln!(
            out,
            "<rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width:.1}\" height=\"{height:.1}\" fill=\"none\" \
             stroke=\"#a01818\" stroke-width=\"1.5\"/>"
        );
    }

    fn path(&self, out: &mut String, frame: &Frame) {
        let points: Vec<_> = self.way.iter().map(|point| frame.at(&point.edge)).collect();
        let line = coordinates(&points);
        let _ = writeln!(
            out,
            "<polyline points=\"{line}\" fill=\"none\" stroke=\"#1c5fb0\" stroke-width=\"1.5\"/>"
        );
        // Waypoints that fall together in a view share a label.
        let near = |p: &Point2<f64>, q: &Point2<f64>| (p - q).norm() < 9.0;
        for (first, p) in points.iter().enumerate() {
            if points[..first].iter().any(|q| near(p, q)) {
                continue;
            }
            let here = points.iter().enumerate().filter(|(_, q)| near(p, q));
            let label = here.map(|(number, _)| number.to_string()).collect::<Vec<_>>().join(",");
            let (x, y, text_x, text_y) = (p.x, p.y, p.x + 4.0, p.y - 5.0);
            let _ = write!(
                out,
                "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"2.5\" fill=\"#1c5fb0\"/>\n\
                 <text x=\"{text_x:.1}\" y=\"{text_y:.1}\" font-size=\"11\" fill=\"#1c5fb0\">{label}</text>\n"
            );
        }
    }

    fn legend(&self, out: &mut String, top: f64) {
        let task = self.task;
        let clearance = |axis: usize| width(task.opening[axis]) / MM - width(self.tip[axis]) / MM;
        let ([x, y], seat, success) =
            ([0, 1].map(clearance), self.seat.depth / MM, task.success.depth / MM);
        let steps = self.way.iter().enumerate();
        let steps = steps.map(|(number, point)| format!("{number} {}", escape(&point.name)));
        let steps = steps.collect::<Vec<_>>().join(", ");
        let lines = [
            format!(
                "clearance (opening less plug): {x:.2} mm in x, {y:.2} mm in y; upright the plug goes \
                 {seat:.2} mm deep (dashed), success at {success:.2} mm"
            ),
            format!("blue, the tip's lower edge as commanded: {steps}"),
            "orange: plug at the start; green: fingertips; grey: socket; red: opening".to_owned(),
        ];
        for (i, line) in lines.iter().enumerate() {
            let _ =
                writeln!(out, "<text x=\"10\" y=\"{:.0}\">{line}</text>", top + 20.0 * i as f64);
        }
    }
}

fn polygon(out: &mut String, frame: &Frame, geom: &Geom, body: &Pose, style: &str) {
    let pose = body * geom.pose;
    let corners = geom.shape.corners();
    let outline = convex_outline(corners.iter().map(|p| frame.at(&(pose * p))).collect());
    let _ = writeln!(out, "<polygon points=\"{}\" {style}/>", coordinates(&outline));
}

fn coordinates(points: &[Point2<f64>]) -> String {
    points.iter().map(|p| format!("{:.1},{:.1}", p.x, p.y)).collect::<Vec<_>>().join(" ")
}

/// Scale bar of 1, 2 or 5 times a power of ten mm, about a fifth of the panel.
fn scale_bar(out: &mut String, frame: &Frame) {
    let fifth = INSIDE / 5.0 / frame.scale / MM;
    let lengths = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0];
    let length = lengths.into_iter().rfind(|&mm| mm <= fifth).unwrap_or(0.1);
    let (x, y, pixels) = (12.0, PANEL - 22.0, length * MM * frame.scale);
    let _ = write!(
        out,
        "<path d=\"M{x} {y}h{pixels:.1}\" stroke=\"#222\" stroke-width=\"2\"/>\n\
         <text x=\"{x}\" y=\"{:.0}\" font-size=\"11\">{length} mm</text>\n",
        y - 5.0
    );
}
