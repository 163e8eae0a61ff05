//! Pictures of a trial: plug, fingertips and socket at the end of each phase,
//! seen along x (compliance-assembly plane) and along y (depth-assembly plane).

use super::{PhaseEnd, Trial};
use crate::finger::Pad;
use crate::outcome::Outcome;
use crate::task::Task;
use crate::task::geometry::convex_outline;
use contact::ContactPoint;
use contact::scene::{Geom, Pose};
use input::units::MM;
use nalgebra::Point2;
use std::fmt::Write;

const SCALE: f64 = 3.2;
const ROOM: f64 = 3.0;
/// Room for the title above and the legend below, pixels.
const HEAD: f64 = 44.0;
const FOOT: f64 = 34.0;
/// Length of an arrow, mm for each newton, and the longest.
const ARROW: (f64, f64) = (0.15, 18.0);
/// Forces that are smaller are not drawn, N.
const LEAST_FORCE: f64 = 0.1;
const SOCKET: &str = "#b8c4d6";
const PLUG: &str = "#e8a33d";
const FINGER: &str = "#5b8c5a";
const FORCE: &str = "#b42318";

/// Extent of a panel: lowest and highest of the horizontal coordinate and of z, mm.
#[derive(Clone, Copy)]
struct View {
    across: [f64; 2],
    up: [f64; 2],
}

impl View {
    fn width(&self) -> f64 {
        self.across[1] - self.across[0]
    }
}

/// One row of panels per view, one column per phase, as a stand-alone SVG; `label` says what was
/// tried. All panels have one scale, and nothing sticks out of them.
pub fn svg(task: &Task, pad: &Pad, trial: &Trial, label: &str) -> String {
    let mut views = [1, 0].map(|axis| (axis, view(task, pad, &trial.phases, axis)));
    let widest = views.iter().map(|(_, view)| view.width()).fold(0.0, f64::max);
    for (_, view) in &mut views {
        let room = (widest - view.width()) / 2.0;
        view.across = [view.across[0] - room, view.across[1] + room];
    }
    let size = |view: &View| [view.across, view.up].map(|[low, high]| (high - low) * SCALE);
    let column = widest * SCALE;
    let columns = trial.phases.len().max(1) as f64;
    let height: f64 = views.iter().map(|(_, view)| size(view)[1]).sum();
    // Wide enough for the title.
    let width = (columns * column).max(560.0);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {:.0}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n\
         <text x=\"8\" y=\"18\" font-size=\"15\">{}</text>\n<text x=\"8\" y=\"36\">{}</text>\n",
        HEAD + height + FOOT,
        escape(label),
        escape(&outcome(trial)),
    );
    let mut y = HEAD;
    for (axis, view) in &views {
        for (i, phase) in trial.phases.iter().enumerate() {
            panel(&mut out, (task, pad), phase, *axis, view, [i as f64 * column, y]);
        }
        y += size(view)[1];
    }
    legend(&mut out, y + 22.0);
    out.push_str("</svg>\n");
    out
}

/// How a trial ended, seen along x, as a stand-alone SVG without words; empty if it did not begin.
pub fn ended(task: &Task, pad: &Pad, trial: &Trial) -> String {
    let Some(phase) = trial.phases.last() else { return String::new() };
    let phase = PhaseEnd { name: String::new(), ..phase.clone() };
    let view = view(task, pad, std::slice::from_ref(&phase), 1);
    let [width, height] = [view.across, view.up].map(|[low, high]| (high - low) * SCALE);
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width:.0} {height:.0}\">\n"
    );
    panel(&mut out, (task, pad), &phase, 1, &view, [0.0, 0.0]);
    out.push_str("</svg>\n");
    out
}

fn outcome(trial: &Trial) -> String {
    let end = match trial.outcome {
        Outcome::Failed(class) => format!("failed: {} (class {})", class.label(), class.number()),
        outcome => outcome.word().to_owned(),
    };
    format!(
        "{end}; depth {:.2} mm, tilt {:.2}\u{b0}, peak force {:.1} N, slip {:.2} mm",
        trial.depth_mm, trial.tilt_deg, trial.peak_force_n, trial.slip_mm
    )
}

/// The bodies at the end of a phase: shapes, pose and colour.
fn bodies(task: &Task, pad: &Pad, phase: &PhaseEnd) -> Vec<(Vec<Geom>, Pose, &'static str)> {
    let shoulder = task.grip.shoulder();
    let [left, right] = phase.poses.fingers;
    let mut bodies = vec![
        (task.socket.iter().map(|part| part.geom()).collect(), Pose::identity(), SOCKET),
        (task.plug.rigid().map(|part| part.geom()).collect(), phase.poses.plug, PLUG),
        (pad.geoms(shoulder, -1.0), left, FINGER),
        (pad.geoms(shoulder, 1.0), right, FINGER),
    ];
    let latch = |pose| (task.plug.sprung().map(|part| part.geom()).collect(), pose, PLUG);
    bodies.extend(phase.poses.latch.map(latch));
    bodies
}

/// Extent that holds every phase, seen along x (axis 1) or y (axis 0).
fn view(task: &Task, pad: &Pad, phases: &[PhaseEnd], axis: usize) -> View {
    let empty = [f64::INFINITY, f64::NEG_INFINITY];
    let mut view = View { across: empty, up: empty };
    let wider = |[low, high]: [f64; 2], at: f64| [low.min(at), high.max(at)];
    for phase in phases {
        for (geoms, body, _) in bodies(task, pad, phase) {
            for point in geoms.iter().flat_map(|geom| projected(geom, &body, axis)) {
                view.across = wider(view.across, point.x);
                view.up = wider(view.up, -point.y);
            }
        }
    }
    if phases.is_empty() {
        return View { across: [-1.0, 1.0], up: [-1.0, 1.0] };
    }
    let room = |[low, high]: [f64; 2], top: f64| [low - ROOM, high + ROOM + top];
    // The name of the phase stands above.
    View { across: room(view.across, 0.0), up: room(view.up, 6.0) }
}

fn panel(
    out: &mut String,
    (task, pad): (&Task, &Pad),
    phase: &PhaseEnd,
    axis: usize,
    view: &View,
    at: [f64; 2],
) {
    let ([left, right], [low, high]) = (view.across, view.up);
    let (width, height) = (right - left, high - low);
    let label = if axis == 1 { "y" } else { "x" };
    // Writing to a String cannot fail.
    let _ = write!(
        out,
        "<svg x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" \
         viewBox=\"{left:.2} {:.2} {width:.2} {height:.2}\">\n\
         <rect x=\"{left:.2}\" y=\"{:.2}\" width=\"{width:.2}\" height=\"{height:.2}\" \
         fill=\"none\" stroke=\"#ccc\" stroke-width=\"0.3\"/>\n",
        at[0],
        at[1],
        width * SCALE,
        height * SCALE,
        -high,
        -high
    );
    for (geoms, pose, fill) in bodies(task, pad, phase) {
        for geom in &geoms {
            polygon(out, geom, &pose, axis, fill);
        }
    }
    phase.contacts.iter().for_each(|contact| arrow(out, contact, axis));
    let _ = write!(
        out,
        "<text x=\"{:.2}\" y=\"{:.2}\" font-size=\"3.6\">{} ({label}, z)</text>\n</svg>\n",
        left + 1.0,
        4.5 - high,
        escape(&phase.name)
    );
}

/// An arrow that ends where the socket presses the plug.
fn arrow(out: &mut String, contact: &ContactPoint, axis: usize) {
    let force = Point2::new(contact.force[axis], -contact.force.z);
    let size = force.coords.norm();
    if size < LEAST_FORCE {
        return;
    }
    let tip = Point2::new(contact.point[axis], -contact.point.z) / MM;
    let along = force.coords / size;
    let length = (size * ARROW.0).min(ARROW.1).max(1.5);
    let (neck, from) = (tip - along, tip - along * length);
    let across = nalgebra::Vector2::new(-along.y, along.x) * 0.6;
    let (a, b) = (neck + across, neck - across);
    let _ = writeln!(
        out,
        "<path d=\"M{:.2} {:.2}L{:.2} {:.2}M{:.2} {:.2}L{:.2} {:.2}L{:.2} {:.2}z\" fill=\"{FORCE}\" \
         stroke=\"{FORCE}\" stroke-width=\"0.4\"/>",
        from.x, from.y, neck.x, neck.y, a.x, a.y, tip.x, tip.y, b.x, b.y
    );
}

/// Colours, a bar of 10 mm, and what an arrow means; its line `y` pixels down.
fn legend(out: &mut String, y: f64) {
    let mut x = 8.0;
    let bar = 10.0 * SCALE;
    let _ = writeln!(
        out,
        "<path d=\"M{x} {y}h{bar}m0 -4v8m-{bar} -8v8\" stroke=\"#333\" fill=\"none\"/>\
         <text x=\"{:.0}\" y=\"{:.0}\">10 mm</text>",
        x + bar + 6.0,
        y + 4.0
    );
    x += bar + 66.0;
    for (fill, name) in [(SOCKET, "socket"), (PLUG, "plug"), (FINGER, "fingertips")] {
        let _ = writeln!(
            out,
            "<rect x=\"{x}\" y=\"{:.0}\" width=\"12\" height=\"12\" fill=\"{fill}\"/>\
             <text x=\"{:.0}\" y=\"{:.0}\">{name}</text>",
            y - 6.0,
            x + 17.0,
            y + 4.0
        );
        x += 84.0;
    }
    let _ = writeln!(
        out,
        "<path d=\"M{x} {y}h{:.1}\" stroke=\"{FORCE}\" stroke-width=\"2\"/>\
         <text x=\"{:.0}\" y=\"{:.0}\">the socket presses the plug, 20 N</text>",
        20.0 * ARROW.0 * SCALE,
        x + 20.0 * ARROW.0 * SCALE + 6.0,
        y + 4.0
    );
}

/// The corners of a geom, mm, projected along x (axis 1) or y (axis 0); z goes up, so y is -z.
fn projected(geom: &Geom, body: &Pose, axis: usize) -> Vec<Point2<f64>> {
    let pose = body * geom.pose;
    let project = |corner: &nalgebra::Point3<f64>| {
        let p = (pose * corner).coords / MM;
        Point2::new(p[axis], -p.z)
    };
    geom.shape.corners().iter().map(project).collect()
}

fn polygon(out: &mut String, geom: &Geom, body: &Pose, axis: usize, fill: &str) {
    let outline = convex_outline(projected(geom, body, axis));
    let text: Vec<_> = outline.iter().map(|p| format!("{:.2},{:.2}", p.x, p.y)).collect();
    let _ = writeln!(
        out,
        "<polygon points=\"{}\" fill=\"{fill}\" fill-opacity=\"0.45\" stroke=\"#333\" \
         stroke-width=\"0.15\"/>",
        text.join(" ")
    );
}

/// A text for XML.
pub fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}
