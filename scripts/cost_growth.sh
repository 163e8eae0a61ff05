#!/usr/bin/env bash
# How the time of a study grows: with the budget, the number of dimensions and the threads.
# Prints Markdown tables. Close other programs first; about 20 minutes on 2 cores.
set -euo pipefail
cd "$(dirname "$0")/.."

cargo build --release --quiet --features fake-engine
optimize=$PWD/target/release/optimize
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Wall time of a study in s, and its processor time; given up after 10 minutes.
study() {
    /usr/bin/env time -q -f "%e %U" -o "$work/time" timeout 600 "$optimize" "$@" --no-cache --quiet \
        --out "$work/study" > /dev/null || echo "over_600 -" > "$work/time"
    rm -rf "$work/study"
    cat "$work/time"
}

# The first $1 parameters of the co-design space.
space() {
    awk -v n="$1" '/^\[\[parameter\]\]/ { if (++k > n) exit } { print }' spaces/codesign.toml \
        > "$work/space$1.toml"
    echo "$work/space$1.toml"
}

echo "| budget | gp s | cma-es s |"
echo "| --- | --- | --- |"
for budget in 50 100 200 500 1000 2000; do
    row="| $budget"
    for optimizer in gp cma-es; do
        read -r wall _ < <(study --task usb --engine fake --space codesign \
            --optimizer "$optimizer" --budget "$budget")
        row="$row | $wall"
    done
    echo "$row |"
done

echo
echo "| dimensions | overhead s | study of ket12 s |"
echo "| --- | --- | --- |"
for dimensions in 2 3 4 5 6 7 8; do
    file=$(space "$dimensions")
    read -r overhead _ < <(study --task ket12 --engine fake --space "$file" --budget 200)
    read -r wall _ < <(study --task ket12 --space "$file" --budget 50)
    echo "| $dimensions | $overhead | $wall |"
done

echo
echo "| threads | wall s | processor s |"
echo "| --- | --- | --- |"
for threads in 1 2 4; do
    read -r wall processor < <(study --task ket12 --budget 50 --threads "$threads")
    echo "| $threads | $wall | $processor |"
done
