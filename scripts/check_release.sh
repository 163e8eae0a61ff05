#!/usr/bin/env bash
# Tests the packages built by scripts/release.sh as users would, without Rust:
#
#     scripts/check_release.sh [PROGRAM]
#
# The wheel is installed in fresh environments of the oldest and the newest Python available: installation and import
# time, the README's Python example, the command `optimize`. The static program runs in an empty root directory:
# the first study of the README must print the README's block. The same study must give the same journal, except for
# clock times, with PROGRAM (a build from the sources; by default that of `cargo build --release`), with the wheels and
# with the static program.
set -euo pipefail
cd "$(dirname "$0")/.."

program=$(realpath "${1:-${CARGO_TARGET_DIR:-target}/release/optimize}")
readme=$PWD/README.md
wheel=$(realpath dist/*.whl)
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
failed() { echo "scripts/check_release.sh: $1" >&2; exit 1; }
# within SECONDS LABEL COMMAND..: runs the command, prints the elapsed time, and fails if the limit is exceeded.
within() {
    local limit=$1 label=$2 began seconds
    shift 2
    began=$EPOCHREALTIME
    "$@"
    seconds=$(awk -v a="$began" -v b="$EPOCHREALTIME" 'BEGIN { printf "%.2f", b - a }')
    echo "$label: $seconds s (limit $limit s)"
    awk -v s="$seconds" -v l="$limit" 'BEGIN { exit s > l }' || failed "$label takes too long"
}
# Prints the first fenced block of the README that contains this line.
block() { awk -v line="$1" '/^```/ { if (found) exit; text = ""; next } { text = text $0 "\n" }
    index($0, line) { found = 1 } END { printf "%s", text }' "$readme"; }
# study NAME COMMAND..: runs a short study and extracts its journal without clock times.
study() {
    local name=$1
    shift
    (cd "$scratch" && "$@" --task usb --budget 40 --seed 0 --no-cache --quiet --out "$name" > "$name.txt")
    sed -E 's/"(datetime_start|datetime_complete|wall_s)":("[^"]*"|[0-9.e-]+),?//g' \
        "$scratch/$name/journal.jsonl" > "$scratch/$name.jsonl"
    if [ "$name" != sources ]; then
        cmp "$scratch/sources.jsonl" "$scratch/$name.jsonl" ||
            failed "the journal of $name differs from that of $program"
        echo "journal of $name: $(wc -l < "$scratch/$name.jsonl") lines, identical to the build from the sources"
    fi
}

(cd dist && sha256sum --quiet -c SHA256SUMS)
study sources "$program"

# The static program, alone in its root directory.
mkdir "$scratch/alone"
tar xzf dist/finger-opt-*-musl.tar.gz -C "$scratch" --wildcards '*/optimize' --strip-components 1
mv "$scratch/optimize" "$scratch/alone"
root=("$(PATH=$PATH:/usr/sbin command -v chroot)")
if [ "$(id -u)" -ne 0 ]; then root=("$(command -v unshare)" --map-root-user "${root[@]}"); fi
alone() { env -i "${root[@]}" "$scratch/alone" /optimize "$@"; }
if "${root[@]}" "$scratch/alone" /bin/true 2> /dev/null; then failed "the root directory contains /bin/true"; fi
alone --version
read -r _ first < <(block "optimize --task usb")
# shellcheck disable=SC2086
alone $first > "$scratch/first.txt" 2> "$scratch/first.log"
diff <(block "Use 30 %") "$scratch/first.txt" || failed "the output of README's first study differs"
echo "static program in an empty root: optimize $first prints README's block"
static() { (cd "$scratch/alone" && alone "$@") && mv "$scratch/alone/static" "$scratch"; }
study static static

# Wheels. Rust must not be in PATH.
PATH=$(tr : '\n' <<< "$PATH" | grep -v cargo | paste -s -d :)
if command -v cargo rustc; then failed "Rust is in PATH"; fi
pythons=()
for minor in 10 11 12 13 14 15; do
    for python in "$(command -v "python3.$minor" || true)" "$HOME/.pyenv/versions/3.$minor".*/bin/python; do
        if [ -x "$python" ] && "$python" -c 'import venv' 2> /dev/null; then pythons+=("$python"); break; fi
    done
done
[ ${#pythons[@]} -gt 0 ] || failed "no CPython 3.10 or later"
block "import finger_opt as fo" > "$scratch/readme.py"
# Prints the processor time of the import, s: unlike the elapsed time, it does not depend on other load.
import_time() { TIMEFORMAT='%U %S'; { time "$1" -c 'import finger_opt'; } 2>&1 | awk '{ print $1 + $2 }'; }
for python in $(printf '%s\n' "${pythons[0]}" "${pythons[-1]}" | uniq); do
    name=wheel-$("$python" -c 'import sys; print("%d.%d" % sys.version_info[:2])')
    venv=$scratch/venv-$name
    "$python" -m venv "$venv"
    within 20 "$name: pip install" "$venv/bin/pip" install -q "$wheel"
    "$venv/bin/python" -c 'import finger_opt; print("finger_opt", finger_opt.__version__)'
    seconds=$(import_time "$venv/bin/python")
    echo "$name: import: $seconds s (limit 0.3 s)"
    if awk -v s="$seconds" 'BEGIN { exit s <= 0.3 }'; then failed "importing finger_opt takes too long"; fi
    "$venv/bin/pip" install -q "$wheel[pandas]"
    (cd "$scratch" && rm -rf rj45-study && within 300 "$name: README's Python example" "$venv/bin/python" readme.py)
    "$venv/bin/optimize" --version
    study "$name" "$venv/bin/optimize"
done
