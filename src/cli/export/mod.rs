//! `optimize export`: what other programs and printers read.

pub mod finger;
mod mjcf;

use super::Failure;
use clap::Subcommand;

/// Write a scene for MuJoCo, or a finger for the printer
#[derive(Debug, Subcommand)]
pub enum Arguments {
    #[command(after_help = "Example: optimize export mjcf --task usb --density 20 \
                            --direction 10 --out scene.xml")]
    Mjcf(mjcf::Arguments),
    #[command(after_help = "Example: optimize export finger results/rj45-gp-seed0 --format stl \
                            --out finger.stl")]
    Finger(finger::Arguments),
}

pub fn run(arguments: &Arguments) -> Result<(), Failure> {
    match arguments {
        Arguments::Mjcf(arguments) => mjcf::run(arguments),
        Arguments::Finger(arguments) => finger::run(arguments),
    }
}
