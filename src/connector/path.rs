//! Commanded search path: places of the plug if nothing gave way.

use super::body::ConvexBody;
use contact::scene::Pose;
use insertion::task::{Ending, Stage, Task};
use nalgebra::{Point3, UnitQuaternion, Vector3};

#[derive(Debug, Clone, PartialEq)]
pub struct Waypoint {
    /// Name of the phase that ends here; "start" for the first.
    pub name: String,
    pub stage: Stage,
    /// Grasp point (TCP), task frame, m.
    pub tcp: Vector3<f64>,
    /// Lowest point of the tip, task frame, m.
    pub edge: Point3<f64>,
    /// Height above the socket's top at which a touch's stroke ends without reaching it, m.
    pub short_by: Option<f64>,
}

/// Pose of the plug, tilted as the task says, with the TCP at `tcp`, task frame, m.
pub fn plug_pose(task: &Task, tcp: Vector3<f64>) -> Pose {
    let turn = UnitQuaternion::from_axis_angle(&Vector3::x_axis(), task.strategy.tilt);
    Pose::from_parts(tcp.into(), turn) * Pose::translation(0.0, 0.0, -task.grip.tcp_z)
}

pub fn waypoints(task: &Task, plug: &ConvexBody) -> Vec<Waypoint> {
    let start = Vector3::from(task.strategy.start);
    let lowest = plug.lowest(&plug_pose(task, start));
    let edge = lowest.unwrap_or_else(Point3::origin) - start;
    let mut at = Waypoint {
        name: "start".to_owned(),
        stage: Stage::Approach,
        tcp: start,
        edge: Point3::from(start + edge.coords),
        short_by: None,
    };
    let mut found = vec![at.clone()];
    for phase in &task.strategy.phases {
        let mut by = Vector3::from(phase.displacement);
        let mut short_by = None;
        if let Ending::Touch { preload, .. } = phase.ending {
            let end = at.edge.z + by.z;
            if end > 0.0 || by.z >= 0.0 {
                short_by = Some(end);
            } else {
                // Straight down to the surface, and on by the preload.
                by *= (at.edge.z.max(0.0) + preload) / -by.z;
            }
        }
        at = Waypoint {
            name: phase.name.clone(),
            stage: phase.stage,
            tcp: at.tcp + by,
            edge: at.edge + by,
            short_by,
        };
        found.push(at.clone());
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use input::shipped::TASKS;
    use input::units::MM;

    /// usb: the lower edge over the opening's middle, touch to 0.3 mm below the top.
    #[test]
    fn the_commanded_edge_starts_over_the_opening_and_ends_below() {
        let file = TASKS.iter().find(|file| file.name == "usb").unwrap();
        let task = Task::parse(file.text, file.file).unwrap();
        let plug = ConvexBody::plug(&task.plug);
        let way = waypoints(&task, &plug);
        assert!(way[0].edge.y.abs() < 0.1 * MM, "{way:?}");
        let touch = way.iter().find(|point| point.name == "touch").unwrap();
        assert!((touch.edge.z + 0.3 * MM).abs() < 1e-12 && touch.short_by.is_none());
        assert!(task.grip.tcp_z - way.last().unwrap().tcp.z > task.success.depth);
    }
}
