//! A task drawn: plug at the start and seated, socket, fingertips, search path, clearances.

use super::body::{ConvexBody, span};
use super::path::{self, Waypoint};
use super::seat::{Seat, Seating, section};
use contact::scene::{Geom, Pose};
use input::units::MM;
use insertion::finger::Pad;
use insertion::task::{Part, Task};
use insertion::trial::picture::{convex_outline, escape};
use nalgebra::{Point2, Point3};
use std::fmt::Write;

/// Side of a panel, pixels.
const PANEL: f64 = 420.0;
/// Around what is drawn, as a share of it.
const MARGIN: f64 = 0.08;
/// Most of the socket that is shown beside the plug, m.
const AROUND: f64 = 8.0 * MM;

/// One view: title, and the axes to the right and up.
struct View {
    title: &'static str,
    right: usize,
    up: usize,
}

const VIEWS: [View; 3] = [
    View { title: "from the side: y to the right, z up", right: 1, up: 2 },
    View { title: "from the front: x to the right, z up", right: 0, up: 2 },
    View { title: "from above: y to the right, x up", right: 1, up: 0 },
];

/// What the views show.
struct Drawing<'a> {
    task: &'a Task,
    way: Vec<Waypoint>,
    start: Pose,
    seat: Seat,
    tip: [[f64; 2]; 2],
}

/// The task as a stand-alone SVG.
pub fn svg(task: &Task) -> String {
    let (plug, socket) = (ConvexBody::plug(&task.plug), ConvexBody::new(&task.socket));
    let way = path::waypoints(task, &plug);
    let seat = Seating::new(task, &plug, &socket).deepest();
    let tip = section(&plug, task.success.depth.min(seat.depth));
    let start = path::plug_pose(task, way[0].tcp);
    let drawing = Drawing { task, way, start, seat, tip };
    let (width, height) = (VIEWS.len() as f64 * PANEL, PANEL + 130.0);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\" \
         font-family=\"sans-serif\" font-size=\"13\" fill=\"#222\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
         <text x=\"10\" y=\"20\" font-size=\"16\">{}: {}</text>\n",
        escape(&task.name),
        escape(&task.description)
    );
    for (column, view) in VIEWS.iter().enumerate() {
        drawing.panel(&mut out, view, column as f64 * PANEL, 34.0);
    }
    drawing.legend(&mut out, PANEL + 60.0);
    out.push_str("</svg>\n");
    out
}

/// A view with its scale: millimetres to pixels.
struct Frame<'a> {
    view: &'a View,
    /// Left and top, m.
    corner: [f64; 2],
    /// Pixels per metre.
    scale: f64,
}

impl Frame<'_> {
    fn at(&self, p: &Point3<f64>) -> Point2<f64> {
        Point2::new(
            (p[self.view.right] - self.corner[0]) * self.scale,
            (self.corner[1] - p[self.view.up]) * self.scale,
        )
    }
}

impl Drawing<'_> {
    fn seated(&self) -> Pose {
        let [x, y] = self.seat.at;
        Pose::translation(x, y, -self.seat.depth)
    }

    /// From, to of what a view must show along an axis, m.
    fn reach(&self, axis: usize) -> [f64; 2] {
        let corners = |pose: Pose| {
            self.task
                .plug
                .parts
                .iter()
                .flat_map(move |part| part.solid.corners())
                .map(move |p| (pose * p)[axis])
        };
        let [low, high] = span(corners(self.start).chain(corners(self.seated())));
        let socket = self.task.socket.iter().flat_map(|part| part.solid.corners());
        let [from, to] = span(socket.map(|p| p[axis]));
        let (low, high) = match self.task.opening.get(axis) {
            Some([a, b]) => (low.min(a - AROUND), high.max(b + AROUND)),
            None => (low.min(from), high),
        };
        let edge = if axis == 2 { low.max(from) } else { low };
        [edge.max(from.min(low)), high.min(to.max(high))]
    }

    fn panel(&self, out: &mut String, view: &View, x: f64, y: f64) {
        let ([left, right], [bottom, top]) = (self.reach(view.right), self.reach(view.up));
        let size = (right - left).max(top - bottom) * (1.0 + 2.0 * MARGIN);
        let corner = [(left + right - size) / 2.0, (bottom + top + size) / 2.0];
        let frame = Frame { view, corner, scale: (PANEL - 10.0) / size };
        let _ = write!(
            out,
            "<text x=\"{:.0}\" y=\"{:.0}\">{}</text>\n<svg x=\"{:.0}\" y=\"{:.0}\" width=\"{:.0}\" \
             height=\"{:.0}\">\n<rect width=\"100%\" height=\"100%\" fill=\"none\" stroke=\"#ccc\"/>\n",
            x + 10.0,
            y + 10.0,
            view.title,
            x + 5.0,
            y + 16.0,
            PANEL - 10.0,
            PANEL - 10.0
        );
        for part in &self.task.socket {
            polygon(
                out,
                &frame,
                &part.geom(),
                &Pose::identity(),
                "fill=\"#b8c4d6\" fill-opacity=\"0.5\" stroke=\"#56657d\"",
            );
        }
        let seated = self.seated();
        for part in self.shown(view) {
            polygon(
                out,
                &frame,
                &part.geom(),
                &self.start,
                "fill=\"#e8a33d\" fill-opacity=\"0.5\" stroke=\"#8a5a10\"",
            );
            polygon(
                out,
                &frame,
                &part.geom(),
                &seated,
                "fill=\"none\" stroke=\"#8a5a10\" stroke-dasharray=\"4 3\"",
            );
        }
        if view.up == 2 {
            self.fingers(out, &frame);
        } else {
            self.opening(out, &frame);
        }
        self.path(out, &frame);
        scale_bar(out, &frame);
        out.push_str("</svg>\n");
    }

    /// From above only what goes into the opening: the rest would hide it.
    fn shown(&self, view: &View) -> Vec<&Part> {
        let bottom = |part: &Part| span(part.solid.corners().iter().map(|p| p.z))[0];
        let parts = self.task.plug.parts.iter();
        parts.filter(|part| view.up == 2 || bottom(part) < self.task.success.depth).collect()
    }

    fn fingers(&self, out: &mut String, frame: &Frame) {
        let grip = &self.task.grip;
        for (side, face) in [-1.0, 1.0].into_iter().zip(grip.faces_y) {
            let pose = self.start * Pose::translation(0.0, face, grip.tcp_z);
            for geom in Pad::PAPER.geoms(grip.shoulder(), side) {
                polygon(
                    out,
                    frame,
                    &geom,
                    &pose,
                    "fill=\"#5b8c5a\" fill-opacity=\"0.5\" stroke=\"#2d4f2c\"",
                );
            }
        }
    }

    fn opening(&self, out: &mut String, frame: &Frame) {
        let [x, y] = self.task.opening;
        let [a, b] =
            [Point3::new(x[0], y[0], 0.0), Point3::new(x[1], y[1], 0.0)].map(|p| frame.at(&p));
        let _ = writeln!(
            out,
            "<rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"none\" stroke=\"#a01818\" \
             stroke-width=\"1.5\"/>",
            a.x,
            b.y,
            b.x - a.x,
            a.y - b.y
        );
    }

    /// The commanded way of the tip's lower edge.
    fn path(&self, out: &mut String, frame: &Frame) {
        let points: Vec<_> = self.way.iter().map(|point| frame.at(&point.edge)).collect();
        let line: Vec<_> = points.iter().map(|p| format!("{:.1},{:.1}", p.x, p.y)).collect();
        let _ = writeln!(
            out,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"#1c5fb0\" stroke-width=\"1.5\"/>",
            line.join(" ")
        );
        // Waypoints that fall together in a view share a label.
        let near = |p: &Point2<f64>, q: &Point2<f64>| (p - q).norm() < 9.0;
        for (first, p) in points.iter().enumerate() {
            if points[..first].iter().any(|q| near(p, q)) {
                continue;
            }
            let here = points.iter().enumerate().filter(|(_, q)| near(p, q));
            let label: Vec<_> = here.map(|(number, _)| number.to_string()).collect();
            let _ = write!(
                out,
                "<circle cx=\"{:.1}\" cy=\"{:.1}\" r=\"2.5\" fill=\"#1c5fb0\"/>\n\
                 <text x=\"{:.1}\" y=\"{:.1}\" font-size=\"11\" fill=\"#1c5fb0\">{}</text>\n",
                p.x,
                p.y,
                p.x + 4.0,
                p.y - 5.0,
                label.join(",")
            );
        }
    }

    fn legend(&self, out: &mut String, y: f64) {
        let task = self.task;
        let width = |[low, high]: [f64; 2]| (high - low) / MM;
        let clearance = |axis: usize| width(task.opening[axis]) - width(self.tip[axis]);
        let steps: Vec<_> = (self.way.iter().enumerate())
            .map(|(number, point)| format!("{number} {}", escape(&point.name)))
            .collect();
        let lines = [
            format!(
                "clearance (opening less plug): {:.2} mm in x, {:.2} mm in y; upright the plug goes {:.2} mm deep \
                 (dashed), success at {:.2} mm",
                clearance(0),
                clearance(1),
                self.seat.depth / MM,
                task.success.depth / MM
            ),
            format!("blue, the tip's lower edge as commanded: {}", steps.join(", ")),
            "orange: plug at the start; green: fingertips; grey: socket; red: opening".to_owned(),
        ];
        for (i, line) in lines.iter().enumerate() {
            let _ = writeln!(out, "<text x=\"10\" y=\"{:.0}\">{line}</text>", y + 20.0 * i as f64);
        }
    }
}

fn polygon(out: &mut String, frame: &Frame, geom: &Geom, body: &Pose, style: &str) {
    let pose = body * geom.pose;
    let corners = geom.shape.corners();
    let outline = convex_outline(corners.iter().map(|p| frame.at(&(pose * p))).collect());
    let text: Vec<_> = outline.iter().map(|p| format!("{:.1},{:.1}", p.x, p.y)).collect();
    let _ = writeln!(out, "<polygon points=\"{}\" {style}/>", text.join(" "));
}

/// A bar of 1, 2 or 5 times a power of ten mm, about a fifth of the panel.
fn scale_bar(out: &mut String, frame: &Frame) {
    let fifth = (PANEL - 10.0) / 5.0 / frame.scale / MM;
    let lengths = [0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0, 20.0, 50.0, 100.0];
    let length = lengths.into_iter().rfind(|&mm| mm <= fifth).unwrap_or(0.1);
    let (x, y) = (12.0, PANEL - 22.0);
    let _ = write!(
        out,
        "<path d=\"M{x} {y}h{:.1}\" stroke=\"#222\" stroke-width=\"2\"/>\n\
         <text x=\"{x}\" y=\"{:.0}\" font-size=\"11\">{length} mm</text>\n",
        length * MM * frame.scale,
        y - 5.0
    );
}
