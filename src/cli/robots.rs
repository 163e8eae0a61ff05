//! `optimize robots`: which robot stands for one's own cell.

use super::words::{lines, wrapped};
use super::{Failure, print, print_json};
use crate::session::{ForCell, robots};
use clap::Args;
use serde_json::{Value, json};

/// List robots by the cells that they stand for, and write one's own
#[derive(Debug, Args)]
pub struct Arguments {
    /// Print the list as JSON
    #[arg(long)]
    json: bool,
}

/// A robot file of one's own to begin with.
const OWN: &str = include_str!("robot.toml");

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    let robots = robots()?;
    if arguments.json {
        return print_json(&self::json(&robots));
    }
    let list: String = robots.iter().map(text).collect();
    print(&format!(
        "--robot       your cell\n{}\n\
         Your own: save this as mine.toml, put in what is yours, give --robot mine.toml\n\n{OWN}\n\
         kind = \"servo\" has no lag. An arm of six [[joint]] trails its command by\n\
         damping_nms_per_rad / stiffness_nm_per_rad, as robots/ur5e_position.toml says.\n",
        wrapped(&list)
    ))
}

/// Output of `--json`.
pub fn json(robots: &[ForCell]) -> Value {
    json!({ "robots": robots, "own_file": OWN })
}

fn text(found: &ForCell) -> String {
    let gives = found.stiffness_n_per_mm.map_or("gives nothing".to_owned(), |[x, y, z]| {
        format!("gives {x:.1}, {y:.1}, {z:.1} N/mm along x, y, z at the TCP")
    });
    let felt = format!("{gives}; lag {:.2} s; stops at {:.0} N", found.lag_s, found.stop_force_n);
    let more = [found.description.clone(), felt, format!("source: {}", found.source)];
    let more = more.into_iter().map(|text| (String::new(), text));
    lines([(found.name.clone(), found.cell.clone())].into_iter().chain(more))
}
