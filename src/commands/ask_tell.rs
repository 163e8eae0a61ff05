//! `optimize ask-tell`: the optimizers for problems that know nothing of insertions.

use crate::command::{self, Text};
use crate::context::Context;
use crate::failure::Failure;
use crate::terminal;
use ask_tell::protocol::{LONGEST_LINE, Session};
use std::io::{self, BufRead, Read};

/// Optimize anything: JSON lines on standard input and output
#[derive(Debug, clap::Args)]
#[command(
    display_order = 40,
    after_help = "Example: optimize ask-tell < session.jsonl; docs/guide/python.md has the lines"
)]
pub struct Request {}

impl command::Request for Request {
    type Response = Text;
    const JSON: bool = false;

    /// Answers each line before it reads the next, until the input ends.
    fn run(&self, _context: &Context<'_>) -> Result<Text, Failure> {
        let mut session = Session::new();
        let mut input = io::stdin().lock();
        let mut line = Vec::new();
        let unreadable = |error| Failure::running(format!("cannot read the input: {error}"));
        loop {
            line.clear();
            let read = (&mut input).take(LONGEST_LINE + 1).read_until(b'\n', &mut line);
            if read.map_err(unreadable)? == 0 {
                return Ok(Text::default());
            }
            if line.len() as u64 > LONGEST_LINE {
                if !line.ends_with(b"\n") {
                    input.skip_until(b'\n').map_err(unreadable)?;
                }
                terminal::print(&(Session::too_long() + "\n"))?;
                continue;
            }
            // What is not UTF-8 is not JSON either: it is answered with an error.
            if let Some(answer) = session.answer(&String::from_utf8_lossy(&line)) {
                terminal::print(&(answer + "\n"))?;
            }
        }
    }
}
