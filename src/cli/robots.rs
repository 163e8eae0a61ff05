//! `optimize robots`: which robot stands for one's own cell.

use super::words::{lines, wrapped};
use super::{Failure, print, print_json};
use crate::session::{DEFAULT_ROBOT, ForCell, robots};
use clap::Args;
use input::shipped::ROBOTS;
use serde_json::json;

/// List robots by the cells that they stand for, and write one's own
#[derive(Debug, Args)]
pub struct Arguments {
    /// Print the list as JSON
    #[arg(long)]
    json: bool,
}

/// Keys of a robot file of kind `servo` that are one's own, and where they come from.
const OWN: [(&str, &str); 5] = [
    ("stiffness_n_per_mm", "at the flange, along x, y, z: push it with 20 N, read the mm"),
    ("rotational_stiffness_nm_per_rad", "the same about x, y, z"),
    ("mass_kg", "wrist and gripper, felt at the TCP"),
    ("damping_ratio", "1: it does not overshoot"),
    ("stop_force_n", "contact force at which your controller stops"),
];

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let robots = robots()?;
    if arguments.json {
        let list: Vec<_> = robots.iter().map(row).collect();
        return print_json(&json!({ "robots": list, "own_file": own_file() }));
    }
    let of = |found: &ForCell| {
        let said = [found.cell.to_owned(), found.robot.description.clone(), felt(found)];
        let source = (!found.source.is_empty()).then(|| format!("source: {}", found.source));
        let said = said.into_iter().chain(source).filter(|text| !text.is_empty()).enumerate();
        let name = |place| if place == 0 { found.robot.name.clone() } else { String::new() };
        lines(said.map(|(place, text)| (name(place), text)))
    };
    let text: String = robots.iter().map(of).collect();
    print(&format!(
        "--robot       your cell\n{}\n\
         Your own: save this as mine.toml, put in what is marked, give --robot mine.toml\n\n{}\n\
         kind = \"servo\" has no lag. An arm of six [[joint]] trails its command by\n\
         damping_nms_per_rad / stiffness_nm_per_rad, as robots/ur5e_position.toml says.\n",
        wrapped(&text),
        own_file()
    ))
}

fn row(found: &ForCell) -> serde_json::Value {
    json!({
        "cell": found.cell,
        "name": found.robot.name,
        "description": found.robot.description,
        "stiffness_n_per_mm": found.felt.stiffness_n_per_mm,
        "lag_s": found.felt.lag_s,
        "stop_force_n": found.robot.stop_force,
        "source": found.source,
    })
}

fn felt(ForCell { robot, felt, .. }: &ForCell) -> String {
    let stiffness = felt.stiffness_n_per_mm.map_or("gives nothing".to_owned(), |[x, y, z]| {
        format!("gives {x:.1}, {y:.1}, {z:.1} N/mm along x, y, z at the TCP")
    });
    format!("{stiffness}; lag {:.2} s; stops at {:.0} N", felt.lag_s, robot.stop_force)
}

/// The shipped compliant flange without its comments, as a file of one's own.
fn own_file() -> String {
    let text = ROBOTS.iter().find(|file| file.name == DEFAULT_ROBOT).map_or("", |file| file.text);
    let line = |line: &str| {
        let key = line.split(" =").next().unwrap_or_default();
        match OWN.iter().find(|(own, _)| *own == key) {
            _ if key == "name" => "name = \"mine\"\n".to_owned(),
            _ if key == "description" => "description = \"our cell\"\n".to_owned(),
            Some((_, how)) => format!("{line}  # {how}\n"),
            None => format!("{line}\n"),
        }
    };
    text.lines().filter(|line| !line.starts_with('#')).map(line).collect()
}
