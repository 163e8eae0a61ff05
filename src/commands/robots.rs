//! `optimize robots`: robot models to choose from for one's own cell.

use crate::command;
use crate::context::Context;
use crate::failure::Failure;
use crate::layout::{lines, wrapped};
use crate::setup::robots::{ForCell, robots};
use serde::Serialize;
use std::fmt;

/// List robots by the cells that they stand for, and write one's own
#[derive(Debug, clap::Args)]
#[command(display_order = 50, after_help = "Example: optimize robots --json")]
pub struct Request {}

/// Shipped robots, and a template for a user's own robot file.
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
             Your own: save this as mine.toml, put in what is yours, give --robot mine.toml\n\n{}\n\
             kind = \"servo\" has no lag. An arm of six [[joint]] trails its command by\n\
             damping_nms_per_rad / stiffness_nm_per_rad, as robots/ur5e_position.toml says.",
            wrapped(&list),
            self.own_file
        )
    }
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
