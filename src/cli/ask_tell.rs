//! `optimize ask-tell`: an optimizer on standard input and output.

use super::{Failure, print};
use ask_tell::protocol::{LONGEST_LINE, Session};
use std::io::{self, BufRead, Read};

/// Runs the command: answers each line before it reads the next, until the input ends.
pub fn run() -> Result<(), Failure> {
    let mut session = Session::new();
    let mut input = io::stdin().lock();
    let mut line = Vec::new();
    let unreadable = |error| Failure::running(format!("cannot read the input: {error}"));
    loop {
        line.clear();
        let read = (&mut input).take(LONGEST_LINE + 1).read_until(b'\n', &mut line);
        if read.map_err(unreadable)? == 0 {
            return Ok(());
        }
        if line.len() as u64 > LONGEST_LINE {
            if !line.ends_with(b"\n") {
                input.skip_until(b'\n').map_err(unreadable)?;
            }
            print(&(Session::too_long() + "\n"))?;
            continue;
        }
        // What is not UTF-8 is not JSON either: it is answered with an error.
        if let Some(answer) = session.answer(&String::from_utf8_lossy(&line)) {
            print(&(answer + "\n"))?;
        }
    }
}
