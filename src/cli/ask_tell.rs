//! `optimize ask-tell`: an optimizer on standard input and output.

use super::{Failure, print};
use crate::optimizer::ask_tell::Session;
use clap::Args;
use std::io::{self, BufRead};

/// Optimize anything: JSON lines on standard input and output, see docs/ask-tell.md.
#[derive(Debug, Args)]
pub struct Arguments {}

/// Runs the command: answers each line before it reads the next, until the input ends.
pub fn run(_: &Arguments) -> Result<(), Failure> {
    let mut session = Session::new();
    let mut input = io::stdin().lock();
    let mut line = Vec::new();
    loop {
        line.clear();
        let read = input.read_until(b'\n', &mut line);
        if read.map_err(|error| Failure::running(format!("cannot read the input: {error}")))? == 0 {
            return Ok(());
        }
        // What is not UTF-8 is not JSON either: it is answered with an error.
        if let Some(answer) = session.answer(&String::from_utf8_lossy(&line)) {
            print(&(answer + "\n"))?;
        }
    }
}
