//! A fuzz harness: every file that the program reads, its journals, its conversations and its
//! command lines, mutated by structure, run by the real binary under limits.
//!
//! It runs 10 s from a fixed seed; `scripts/fuzz.sh MINUTES [SEED]` runs it longer. What
//! fails is shrunk to the fewest mutations and printed, and the search goes on.
#![cfg(unix)]

mod mutation;
mod process;
mod subject;

use crate::common::setting;
use mutation::mutations;
use proptest::prelude::*;
use proptest::test_runner::{Config, TestCaseError, TestError, TestRng, TestRunner};
use std::collections::BTreeMap;
use std::sync::Mutex;
use std::time::{Duration, Instant};
use subject::{Base, KINDS};

/// Seconds of a run that nobody has asked to be longer.
const SECONDS: u64 = 10;
/// Failures after which it stops.
const MAX_FAILURES: usize = 20;

/// How many cases of each kind ended how.
type Counts = BTreeMap<(&'static str, &'static str), u64>;

/// Runs cases until the time is over; gives the failures.
fn work(seed: u64, end: Instant, base: &Base, counts: &Mutex<Counts>) -> Vec<String> {
    let mut failures = Vec::new();
    let strategy =
        (prop::sample::select(KINDS.split(' ').collect::<Vec<_>>()), mutations(), any::<u64>());
    for round in 0u8.. {
        let config = Config {
            cases: u32::MAX,
            failure_persistence: None,
            max_shrink_iters: 60,
            max_global_rejects: 1,
            ..Config::default()
        };
        let mut bytes = [0; 32];
        bytes[..8].copy_from_slice(&seed.to_le_bytes());
        bytes[8] = round;
        let random = TestRng::from_seed(prop::test_runner::RngAlgorithm::ChaCha, &bytes);
        let mut runner = TestRunner::new_with_rng(config, random);
        let result = runner.run(&strategy, |(kind, mutations, number)| {
            if Instant::now() > end {
                return Err(TestCaseError::reject("the time is over"));
            }
            let how = subject::run_case(kind, &mutations, number, base)
                .map_err(|error| TestCaseError::fail(format!("{error:#}")))?;
            *counts.lock().unwrap().entry((kind, how)).or_default() += 1;
            Ok(())
        });
        match result {
            Err(TestError::Fail(why, (kind, mutations, number))) => {
                failures.push(format!("{kind} {mutations:?} {number}\n{why}"));
            }
            _ => break,
        }
        if failures.len() >= MAX_FAILURES || Instant::now() > end {
            break;
        }
    }
    failures
}

#[test]
fn nothing_that_is_read_makes_it_panic_hang_or_fill_the_memory() {
    let end = Instant::now() + Duration::from_secs(setting("FINGER_OPT_FUZZ_SECONDS", SECONDS));
    let (seed, workers) = (setting("FINGER_OPT_FUZZ_SEED", 1), setting("FINGER_OPT_FUZZ_JOBS", 2));
    let (base, counts) = (Base::new(), Mutex::new(Counts::new()));
    let failures: Vec<String> = std::thread::scope(|scope| {
        let work = |i| {
            let (base, counts) = (&base, &counts);
            scope.spawn(move || work(seed.wrapping_mul(1000) + i, end, base, counts))
        };
        let workers: Vec<_> = (0..workers).map(work).collect();
        workers.into_iter().flat_map(|worker| worker.join().unwrap()).collect()
    });
    let counts = counts.into_inner().unwrap();
    for ((kind, how), count) in &counts {
        println!("{kind:<14} {how:<9} {count:>7}");
    }
    println!("cases          {:>17}, {} failed", counts.values().sum::<u64>(), failures.len());
    assert!(failures.is_empty(), "{}", failures.join("\n\n"));
}
