//! Pictures of a trial: plug, fingertips and socket at the end of each phase,
//! seen along x (compliance-assembly plane) and along y (depth-assembly plane).

use super::{Poses, Trial};
use crate::finger::Pad;
use crate::input::task::Task;
use crate::scene::{Geom, Pose};
use crate::units::MM;
use nalgebra::Point2;
use std::fmt::Write;

/// Pixels per millimetre.
const SCALE: f64 = 3.2;
/// Window shown, mm: half its width, lowest and highest z.
const VIEW_MM: (f64, f64, f64) = (22.0, -34.0, 66.0);

/// One row of panels per view, one column per phase, as a stand-alone SVG.
pub fn svg(task: &Task, pad: &Pad, trial: &Trial) -> String {
    let (half, low, high) = VIEW_MM;
    let (width, height) = (2.0 * half * SCALE, (high - low) * SCALE);
    let columns = trial.phases.len().max(1) as f64;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {:.0} {:.0}\" \
         font-family=\"sans-serif\" font-size=\"13\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"#fff\"/>\n",
        columns * width,
        2.0 * height + 40.0
    );
    for (column, phase) in trial.phases.iter().enumerate() {
        for (row, axis) in [1, 0].into_iter().enumerate() {
            let (x, y) = (column as f64 * width, row as f64 * (height + 20.0));
            let label = ["y", "x"][row];
            let _ = write!(
                out,
                "<svg x=\"{x:.0}\" y=\"{y:.0}\" width=\"{width:.0}\" height=\"{height:.0}\" \
                 viewBox=\"{:.1} {:.1} {:.1} {:.1}\">\n\
                 <rect x=\"{:.1}\" y=\"{:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"none\" \
                 stroke=\"#ccc\" stroke-width=\"0.3\"/>\n",
                -half,
                -high,
                2.0 * half,
                high - low,
                -half,
                -high,
                2.0 * half,
                high - low
            );
            panel(&mut out, task, pad, &phase.poses, axis);
            let _ = write!(
                out,
                "<text x=\"{:.1}\" y=\"{:.1}\" font-size=\"3.6\">{} ({label}, z)</text>\n</svg>\n",
                1.0 - half,
                4.5 - high,
                escape(&phase.name)
            );
        }
    }
    out.push_str("</svg>\n");
    out
}

fn panel(out: &mut String, task: &Task, pad: &Pad, poses: &Poses, axis: usize) {
    for part in &task.socket {
        polygon(out, &part.geom(), &Pose::identity(), axis, "#b8c4d6");
    }
    for part in &task.plug.parts {
        polygon(out, &part.geom(), &poses.plug, axis, "#e8a33d");
    }
    for (pose, side) in poses.fingers.iter().zip([-1.0, 1.0]) {
        for geom in pad.geoms(task.grip.shoulder(), side) {
            polygon(out, &geom, pose, axis, "#5b8c5a");
        }
    }
}

/// The outline of a convex geom, projected along x (axis 1) or y (axis 0).
fn polygon(out: &mut String, geom: &Geom, body: &Pose, axis: usize, fill: &str) {
    let pose = body * geom.pose;
    let points: Vec<_> = geom
        .shape
        .corners()
        .iter()
        .map(|corner| {
            let p = (pose * corner).coords / MM;
            Point2::new(p[axis], -p.z)
        })
        .collect();
    let outline = convex_outline(points);
    let text: Vec<_> = outline.iter().map(|p| format!("{:.2},{:.2}", p.x, p.y)).collect();
    let _ = writeln!(
        out,
        "<polygon points=\"{}\" fill=\"{fill}\" fill-opacity=\"0.45\" stroke=\"#333\" \
         stroke-width=\"0.15\"/>",
        text.join(" ")
    );
}

/// Convex hull of points in the plane (Andrew's monotone chain).
pub(crate) fn convex_outline(mut points: Vec<Point2<f64>>) -> Vec<Point2<f64>> {
    points.sort_by(|a, b| a.x.total_cmp(&b.x).then(a.y.total_cmp(&b.y)));
    let turn = |a: &Point2<f64>, b: &Point2<f64>, c: &Point2<f64>| (b - a).perp(&(c - b));
    let half = |points: &mut dyn Iterator<Item = Point2<f64>>| {
        let mut chain: Vec<Point2<f64>> = Vec::new();
        for p in points {
            while chain.len() > 1
                && turn(&chain[chain.len() - 2], &chain[chain.len() - 1], &p) <= 0.0
            {
                chain.pop();
            }
            chain.push(p);
        }
        chain.pop();
        chain
    };
    let mut lower = half(&mut points.iter().copied());
    lower.extend(half(&mut points.iter().rev().copied()));
    lower
}

pub(crate) fn escape(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_outline_of_a_square_with_a_point_inside_is_the_square() {
        let points = [(0.0, 0.0), (1.0, 1.0), (0.5, 0.5), (0.0, 1.0), (1.0, 0.0)];
        let outline = convex_outline(points.iter().map(|&(x, y)| Point2::new(x, y)).collect());
        assert_eq!(outline.len(), 4);
        assert!(!outline.contains(&Point2::new(0.5, 0.5)));
    }
}
