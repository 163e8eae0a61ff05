#!/usr/bin/env bash
# Makes the outputs under results/reference that the documents quote. A few minutes on 2 cores.
set -euo pipefail
cd "$(dirname "$0")/.."

cargo build --release
optimize=target/release/optimize
reference=results/reference
studies=$(mktemp -d)
trap 'rm -rf "$studies"' EXIT

"$optimize" stiffness --svg "$reference/stiffness.svg" > "$reference/stiffness.txt"
"$optimize" check > "$reference/check.txt"
"$optimize" check --convergence > "$reference/convergence.txt" ||
    echo "a window moves with the step: $reference/convergence.txt" >&2
"$optimize" trial --task usb --density 20 --direction 10 --svg "$reference/trial-usb.svg" \
    > "$reference/trial-usb.txt"
for task in ket8 ket12 rj45; do
    "$optimize" trial --task "$task" --stiffness-compliance 2.6 --stiffness-assembly 45 \
        --svg "$reference/trial-$task.svg" > /dev/null
done
for task in usb ket8 ket12 rj45; do
    mkdir -p "$reference/$task"
    /usr/bin/env time -f "%e s wall, %U s processor, %M KiB" -o "$reference/$task/time.txt" \
        "$optimize" --task "$task" --budget 200 --no-cache --out "$studies/$task" --quiet \
        > "$reference/$task/summary.txt"
    sed -i '/^study /d' "$reference/$task/summary.txt"
    for file in report.html convergence.svg evaluations.csv study.toml; do
        cp "$studies/$task/$file" "$reference/$task/"
    done
done

# Objectives, constraints and tasks of docs/objectives.md.
objectives="$reference/objectives"
mkdir -p "$objectives"
few="$studies/few.toml"
sed -e 's/samples = 12/samples = 6/' -e 's/search = "walk"/search = "strides"/' \
    -e 's/name = "typical"/name = "few"/' uncertainties/typical.toml > "$few"
run() {
    "$optimize" "${@:2}" --no-cache --out "$studies/$1" --quiet > "$objectives/$1.txt"
    sed -i '/^study /d' "$objectives/$1.txt"
}
run front --task usb --objective range,peak-force --budget 60
cp "$studies/front/front.svg" "$objectives/"
run constrained --task usb --constraint 'peak-force<=110' --budget 24
run none --task usb --constraint 'peak-force<=60' --budget 8
run robust --task usb --objective robust-range --uncertainty "$few" --budget 12
run tasks --task ket8,rj45 --budget 12
"$optimize" evaluate --task rj45 --density 10 --direction 0 --uncertainty typical \
    > "$objectives/evaluate.txt"
