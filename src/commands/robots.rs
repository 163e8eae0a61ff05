//! `optimize robots`: lists robots and their cells.

use crate::command;
use crate::context::Context;
use crate::failure::Failure;
use crate::layout::{lines, wrapped};
use crate::setup::robots::{ForCell, robots};
use serde::Serialize;
use std::fmt;

/// List the shipped robots with the cells that they represent, and an example of a robot file
#[derive(Debug, clap::Args)]
#[command(display_order = 50, after_help = "Example: optimize robots --json")]
pub struct Request {}

/// Shipped robots, and an example of a robot file.
#[derive(Serialize)]
pub struct Listed {
    robots: Vec<ForCell>,
    own_file: &'static str,
}

impl command::Request for Request {
    type Response = Listed;

    fn run(&self, _context: &Context<'_>) -> Result<Listed, Failure> {
        Ok(Listed { robots: robots()?, own_file: include_str!("robot.toml") })
    }
}

impl command::Response for Listed {}

impl fmt::Display for Listed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let list: String = self.robots.iter().map(text).collect();
        writeln!(
            f,
            "--robot       your cell\n{}\n\
             Your own: save this as mine.toml, enter your numbers, and use --robot mine.toml\n\n{}\n\
             kind = \"servo\" has no lag. An arm of six [[joint]] trails its command by\n\
             damping_nms_per_rad / stiffness_nm_per_rad, see robots/ur5e_position.toml.",
            wrapped(&list),
            self.own_file
        )
    }
}

fn text(found: &ForCell) -> String {
    let stiffness = found.stiffness_n_per_mm.map_or("rigid".to_owned(), |[x, y, z]| {
        format!("stiffness {x:.1}, {y:.1}, {z:.1} N/mm along x, y, z at the TCP")
    });
    let felt =
        format!("{stiffness}; lag {:.2} s; stops at {:.0} N", found.lag_s, found.stop_force_n);
    let more = [found.description.clone(), felt, format!("source: {}", found.source)];
    let more = more.into_iter().map(|text| (String::new(), text));
    lines([(found.name.clone(), found.cell.clone())].into_iter().chain(more))
}
