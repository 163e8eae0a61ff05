#!/usr/bin/env bash
# Mutates everything that the program reads for MINUTES: scripts/fuzz.sh MINUTES [SEED]
# Prints the cases by kind and how they ended, and every failure with its fewest mutations.
# FINGER_OPT_FUZZ_PROGRAM names a program in place of the one that is built.
set -euo pipefail
cd "$(dirname "$0")/.."

minutes=${1:?"how many minutes? usage: scripts/fuzz.sh MINUTES [SEED]"}
export FINGER_OPT_FUZZ_SECONDS=$((60 * minutes))
export FINGER_OPT_FUZZ_SEED=${2:-$(date +%s)}
export FINGER_OPT_FUZZ_JOBS=${FINGER_OPT_FUZZ_JOBS:-$(nproc)}
echo "seed $FINGER_OPT_FUZZ_SEED, $minutes minutes, $FINGER_OPT_FUZZ_JOBS at a time"
nice cargo test --release --test fuzz -- --nocapture
