#!/usr/bin/env bash
# Fuzzes all inputs of the program for MINUTES: scripts/fuzz.sh MINUTES [SEED]
# Prints the outcomes by kind of case, and every failure reduced to the fewest mutations.
# FINGER_OPT_FUZZ_PROGRAM sets an existing program instead of building one.
set -euo pipefail
cd "$(dirname "$0")/.."

minutes=${1:?"missing MINUTES; usage: scripts/fuzz.sh MINUTES [SEED]"}
export FINGER_OPT_FUZZ_SECONDS=$((60 * minutes))
export FINGER_OPT_FUZZ_SEED=${2:-$(date +%s)}
export FINGER_OPT_FUZZ_JOBS=${FINGER_OPT_FUZZ_JOBS:-$(nproc)}
echo "seed $FINGER_OPT_FUZZ_SEED, $minutes minutes, $FINGER_OPT_FUZZ_JOBS at a time"
nice cargo test --release --test all fuzz:: -- --nocapture
