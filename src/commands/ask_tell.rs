//! `optimize ask-tell`: optimizers for any problem, over JSON lines.

use crate::{Context, Failure, Output, command, terminal};
use ask_tell::protocol::{MAX_LINE_BYTES, Session};
use std::io::{self, BufRead, Read};

/// Optimize anything: JSON lines on standard input and output
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Example: optimize ask-tell < session.jsonl; docs/guide/python.md describes the lines"
)]
pub struct Request {}

impl command::Request for Request {
    const JSON: bool = false;

    /// Answers each line before the next is read, until the input ends.
    fn run(&self, _context: &Context<'_>) -> Result<Output, Failure> {
        let mut session = Session::default();
        let mut input = io::stdin().lock();
        let unreadable = |error| Failure::running(format!("cannot read the input: {error}"));
        loop {
            let mut line = Vec::new();
            let mut limited = (&mut input).take(MAX_LINE_BYTES + 1);
            if limited.read_until(b'\n', &mut line).map_err(unreadable)? == 0 {
                return Ok(String::new().into());
            }
            let answer = if line.len() as u64 <= MAX_LINE_BYTES {
                // Invalid UTF-8 becomes U+FFFD, so that the session can answer with an error.
                session.answer(&String::from_utf8_lossy(&line))
            } else {
                if !line.ends_with(b"\n") {
                    input.skip_until(b'\n').map_err(unreadable)?;
                }
                Err(format!("the line is longer than {MAX_LINE_BYTES} bytes"))
            };
            let error = |error| Some(serde_json::json!({"error": error}).to_string());
            if let Some(answer) = answer.unwrap_or_else(error) {
                terminal::print(&(answer + "\n"))?;
            }
        }
    }
}
