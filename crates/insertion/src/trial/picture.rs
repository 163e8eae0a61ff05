//! Pictures of a trial: plug, fingertips and socket at the end of each phase,
//! seen along x (y-z plane: compliance and assembly directions) and along y (x-z plane).

use super::{PhaseEnd, Trial};
use crate::task::geometry::convex_outline;
use crate::{Pad, Part, Task};
use ask_tell::statistics::span;
use contact::ContactPoint;
use contact::scene::{Geom, Pose};
use drawing::{Drawing, Font, Style, View};
use input::units::MM;
use nalgebra::{Point2, Point3, Vector2};

/// Pixels per millimetre.
const SCALE: f64 = 3.2;
/// Margin around the bodies of a panel, mm.
const MARGIN: f64 = 3.0;
const FONT: Font = Font::new(13.0);
/// Height of the title, pixels.
const HEAD: f64 = 44.0;
/// Height of the legend, pixels.
const FOOT: f64 = 34.0;
/// Length of an arrow, mm/N, and its maximum, mm.
const ARROW: (f64, f64) = (0.15, 18.0);
/// Smallest force that is drawn, N.
const MIN_FORCE: f64 = 0.1;
const SOCKET: &str = "#b8c4d6";
const PLUG: &str = "#e8a33d";
const FINGER: &str = "#5b8c5a";
const FORCE: &str = "#b42318";

/// Range of coordinates that a panel shows, mm.
#[derive(Clone, Copy)]
struct Extent {
    /// Horizontal coordinate: 0 is x, 1 is y.
    axis: usize,
    across: [f64; 2],
    up: [f64; 2],
}

impl Extent {
    /// Returns width and height, pixels.
    fn size(&self) -> [f64; 2] {
        [self.across, self.up].map(|[low, high]| (high - low) * SCALE)
    }
}

/// Draws a row of panels for each view, a column for each phase, as a stand-alone SVG; `label`
/// describes the trial. All panels have the same scale and clip their contents.
pub fn svg(task: &Task, pad: &Pad, trial: &Trial, label: &str) -> String {
    let mut rows = [1, 0].map(|axis| extent(task, pad, &trial.phases, axis));
    let [a, b] = rows.map(|row| row.across[1] - row.across[0]);
    for (row, other) in rows.iter_mut().zip([b - a, a - b]) {
        let room = other.max(0.0) / 2.0;
        row.across = [row.across[0] - room, row.across[1] + room];
    }
    let column = rows[0].size()[0];
    // At least the width of the title.
    let width = (trial.phases.len().max(1) as f64 * column).max(560.0);
    let mut drawing = Drawing::default();
    drawing.white_background();
    drawing.text(Point2::new(8.0, 18.0), label, Font::new(15.0));
    drawing.text(Point2::new(8.0, 36.0), &outcome(trial), FONT);
    let mut y = HEAD;
    for row in &rows {
        for (i, phase) in trial.phases.iter().enumerate() {
            let (at, axis) =
                (Point2::new(i as f64 * column, y), if row.axis == 1 { "y" } else { "x" });
            let title = format!("{} ({axis}, z)", phase.name);
            panel(&mut drawing, &bodies(task, pad, phase), (phase, &title), row, at);
        }
        y += row.size()[1];
    }
    legend(&mut drawing, y + 22.0);
    drawing.svg([width, y + FOOT], "")
}

/// Draws the final state of a trial, seen along x, as a stand-alone SVG without text; empty if it has no
/// phases.
pub fn final_state(task: &Task, pad: &Pad, trial: &Trial) -> String {
    let Some(phase) = trial.phases.last() else { return String::new() };
    let extent = extent(task, pad, std::slice::from_ref(phase), 1);
    let mut drawing = Drawing::default();
    panel(&mut drawing, &bodies(task, pad, phase), (phase, ""), &extent, Point2::origin());
    drawing.svg(extent.size(), "")
}

fn outcome(trial: &Trial) -> String {
    format!(
        "{}; depth {:.2} mm, tilt {:.2}\u{b0}, peak force {:.1} N, slip {:.2} mm",
        trial.outcome, trial.depth_mm, trial.tilt_deg, trial.peak_force_n, trial.slip_mm
    )
}

/// Shapes of a body, its pose and colour.
type Body = (Vec<Geom>, Pose, &'static str);

/// Returns the bodies at the end of a phase.
fn bodies(task: &Task, pad: &Pad, phase: &PhaseEnd) -> Vec<Body> {
    let shoulder = task.grip.shoulder();
    let [left, right] = phase.poses.fingers;
    let mut bodies = vec![
        (task.socket.iter().map(Part::geom).collect(), Pose::identity(), SOCKET),
        (task.plug.rigid().map(Part::geom).collect(), phase.poses.plug, PLUG),
        (pad.geoms(shoulder, -1.0), left, FINGER),
        (pad.geoms(shoulder, 1.0), right, FINGER),
    ];
    let latch = |pose| (task.plug.latch_parts().map(Part::geom).collect(), pose, PLUG);
    bodies.extend(phase.poses.latch.map(latch));
    bodies
}

/// Returns the extent that contains the bodies at the end of every phase, seen along x (axis 1) or y (axis 0).
fn extent(task: &Task, pad: &Pad, phases: &[PhaseEnd], axis: usize) -> Extent {
    let bodies = phases.iter().flat_map(|phase| bodies(task, pad, phase));
    let points: Vec<Point2<f64>> = bodies
        .flat_map(|(geoms, body, _)| {
            geoms.iter().flat_map(|geom| projected(geom, &body, axis)).collect::<Vec<_>>()
        })
        .collect();
    let range = |of: fn(&Point2<f64>) -> f64, room: f64| match span(points.iter().map(of)) {
        [low, high] if low <= high => [low - MARGIN, high + MARGIN + room],
        _ => [-1.0, 1.0],
    };
    // Room for the name of the phase above.
    Extent { axis, across: range(|p| p.x, 0.0), up: range(|p| p.y, 6.0) }
}

fn panel(
    drawing: &mut Drawing,
    bodies: &[Body],
    (phase, title): (&PhaseEnd, &str),
    extent: &Extent,
    at: Point2<f64>,
) {
    let ([left, _], [_, high]) = (extent.across, extent.up);
    let view = View { origin: Point2::new(-left, high) * SCALE, scale: SCALE };
    drawing.panel(at, extent.size(), |drawing| {
        for (geoms, pose, fill) in bodies {
            for geom in geoms {
                let outline = convex_outline(projected(geom, pose, extent.axis));
                let style = Style::fill(fill).opacity(0.45).outlined("#333", 0.48);
                drawing.polygon(outline.into_iter().map(|point| view.place(point)), style);
            }
        }
        phase.contacts.iter().for_each(|contact| force(drawing, contact, extent.axis, view));
        drawing.text(Point2::new(3.2, 14.4), title, Font::new(11.5));
    });
}

/// Draws the contact force on the plug as an arrow that ends at the contact point.
fn force(drawing: &mut Drawing, contact: &ContactPoint, axis: usize, view: View) {
    let force = Vector2::new(contact.force[axis], contact.force.z);
    let size = force.norm();
    if size < MIN_FORCE {
        return;
    }
    let tip = Point2::new(contact.point[axis], contact.point.z) / MM;
    let from = tip - force / size * (size * ARROW.0).min(ARROW.1).max(1.5);
    drawing.arrow([from, tip].map(|point| view.place(point)), SCALE, FORCE);
}

/// Draws the legend `y` pixels from the top: a scale bar of 10 mm, the colours and the scale of the arrows.
fn legend(drawing: &mut Drawing, y: f64) {
    drawing.scale_bar(Point2::new(8.0, y), 10.0 * SCALE, "10 mm", 13.0);
    let mut at = Point2::new(106.0, y);
    for (fill, name) in [(SOCKET, "socket"), (PLUG, "plug"), (FINGER, "fingertips")] {
        let corners = [at - Vector2::y() * 6.0, at + Vector2::new(12.0, 6.0)];
        drawing.rectangle(corners, 0.0, Style::fill(fill));
        drawing.text(at + Vector2::new(17.0, 4.0), name, FONT);
        at.x += 84.0;
    }
    let tip = at + Vector2::new(20.0 + 20.0 * ARROW.0 * SCALE, 0.0);
    drawing.arrow([at + Vector2::x() * 20.0, tip], SCALE, FORCE);
    let words = "the socket presses the plug, 20 N";
    drawing.text(tip + Vector2::new(6.0, 4.0), words, FONT);
}

/// Returns the corners of a geom, mm, projected along x (axis 1) or y (axis 0).
fn projected(geom: &Geom, body: &Pose, axis: usize) -> Vec<Point2<f64>> {
    let pose = body * geom.pose;
    let project = |corner: &Point3<f64>| {
        let p = (pose * corner).coords / MM;
        Point2::new(p[axis], p.z)
    };
    geom.shape.corners().iter().map(project).collect()
}
