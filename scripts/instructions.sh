#!/usr/bin/env bash
# Counts the instructions of one trial and compares them with the committed count. Unlike
# time, the count does not depend on machine load.
#
#     scripts/instructions.sh [PROGRAM]          exit 1 if the count exceeds the margin
#     scripts/instructions.sh [PROGRAM] --renew  replaces the committed count
#
# PROGRAM is the program built by `cargo test`; it is built here if omitted.
set -euo pipefail
cd "$(dirname "$0")/.."

committed=results/reference/instructions.txt
# Percent. Linking order and minor compiler changes affect the count by about 1 %.
margin=5
program=${CARGO_TARGET_DIR:-target}/release/optimize
if [ -n "${1:-}" ] && [ "$1" != --renew ]; then
    program=$1
    shift
else
    cargo build --release --quiet --features fake-engine
fi
out=$(mktemp)
trap 'rm -f "$out"' EXIT

if ! command -v valgrind > /dev/null; then
    echo "valgrind is missing: install the package valgrind" >&2
    exit 1
fi
if ! valgrind --tool=callgrind --callgrind-out-file=/dev/null "$program" trial --task usb \
    --stiffness-compliance 2.6 --stiffness-assembly 45 > "$out" 2>&1; then
    cat "$out" >&2
    exit 1
fi
count=$(awk '/Collected/ { print $NF }' "$out")
compiler=$(rustc --version)

if [ "${1:-}" = --renew ]; then
    printf 'instructions %s\ncompiler %s\n' "$count" "$compiler" > "$committed"
    cat "$committed"
    exit
fi
expected=$(awk '/^instructions/ { print $2 }' "$committed")
change=$(awk -v a="$count" -v b="$expected" 'BEGIN { printf "%+.2f", 100 * (a / b - 1) }')
echo "one usb trial: $count instructions, committed $expected, $change % (margin $margin %)"
echo "compiled by $compiler; the committed count by $(sed -n 's/^compiler //p' "$committed")"
# outside SIGN: tests whether the change is outside the margin, above (1) or below (-1).
outside() { awk -v c="$change" -v m="$margin" -v s="$1" 'BEGIN { exit !(s * c > m) }'; }
if outside -1; then
    echo "the trial takes fewer instructions: run scripts/instructions.sh --renew to detect a later regression"
fi
if outside 1; then
    echo "the trial takes more instructions than committed; if this is intended," \
        "run scripts/instructions.sh --renew and give the reason in the commit message" >&2
    exit 1
fi
