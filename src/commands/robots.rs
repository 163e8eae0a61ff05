//! `optimize robots`: lists robots and their cells.

use crate::layout::{lines, wrapped};
use crate::setup::robots::{CellRobot, robots};
use crate::{Context, Failure, Output, command};
use serde_json::json;

/// List the shipped robots with the cells that they represent, and an example of a robot file
#[derive(Debug, clap::Args)]
#[command(after_help = "Example: optimize robots --json")]
pub struct Request {}

impl command::Request for Request {
    fn run(&self, _context: &Context<'_>) -> Result<Output, Failure> {
        let (robots, own_file) = (robots()?, include_str!("robot.toml"));
        let list: String = robots.iter().map(text).collect();
        let text = format!(
            "--robot       your cell\n{}\n\
             Your own: save this as mine.toml, enter your numbers, and use --robot mine.toml\n\n{own_file}\n\
             kind = \"servo\" has no lag. An arm of six [[joint]] trails its command by\n\
             damping_nms_per_rad / stiffness_nm_per_rad, see robots/ur5e_position.toml.\n",
            wrapped(&list),
        );
        Ok(Output::new(text, json!({"robots": robots, "own_file": own_file})))
    }
}

fn text(found: &CellRobot) -> String {
    let stiffness = found.stiffness_n_per_mm.map_or("rigid".to_owned(), |[x, y, z]| {
        format!("stiffness {x:.1}, {y:.1}, {z:.1} N/mm along x, y, z at the TCP")
    });
    let felt =
        format!("{stiffness}; lag {:.2} s; stops at {:.0} N", found.lag_s, found.stop_force_n);
    let more = [found.description.clone(), felt, format!("source: {}", found.source)];
    let more = more.into_iter().map(|text| (String::new(), text));
    lines([(found.name.clone(), found.cell.clone())].into_iter().chain(more))
}
