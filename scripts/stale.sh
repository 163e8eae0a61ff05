#!/usr/bin/env bash
# Lists the committed figures that are older than their sources.
#
#     scripts/stale.sh                        lists them; never fails, because every edit of a source counts
#     scripts/stale.sh --record SCOPE FILE..  records that these files were generated from the current sources
#
# results/reference/SOURCE contains one line per file: scope, hash of the scope's sources, path.
# The sources of a scope are the folders that affect numbers; tests and reports are excluded.
set -euo pipefail
cd "$(dirname "$0")/.."
export LC_ALL=C
reference=results/reference
record=$reference/SOURCE

# The sources that affect an evaluation, as listed in crates/study/build.rs.
simulation=$(sed -n '/^const SIMULATION/,/^];/s/^ *"\(crates.*\)",$/\1/p' crates/study/build.rs)
# The numerical libraries, pinned in Cargo.toml; other libraries do not affect numbers.
libraries="^name = \"($(sed -n 's/^\([a-z0-9_-]*\) = .*"=[0-9].*/\1/p' Cargo.toml | paste -sd '|'))\""

# Prints the folders and files of a scope.
sources() {
    case $1 in
        windows) paths="$simulation data tasks robots" ;;
        maps) paths="$simulation data tasks robots crates/analysis/src/map" ;;
        studies) paths="$simulation crates/ask-tell crates/study data tasks robots spaces uncertainties" ;;
        checks) paths="$simulation tests/analytic/src robots" ;;
        bench) paths="$simulation crates/ask-tell crates/study crates/calibration data tasks robots spaces priors" ;;
        levers) paths="$simulation crates/calibration crates/connector crates/analysis/src/levers data tasks robots spaces priors" ;;
        optimizers) paths="crates/ask-tell results/reference/landscapes" ;;
        *) echo "scripts/stale.sh: unknown scope $1" >&2; exit 2 ;;
    esac
    echo "$paths"
}

hash_of() {
    local paths
    paths=$(sources "$1")
    # shellcheck disable=SC2086
    {
        find $paths -type f ! -name tests.rs ! -path '*/tests/*' ! -name '*.md' -print0 |
            sort -z | xargs -0 sha256sum
        grep -E -A 1 "$libraries" Cargo.lock
    } | sha256sum | cut -c 1-16
}

if [ "${1:-}" = --record ]; then
    scope=$2
    shift 2
    hash=$(hash_of "$scope")
    touch "$record"
    for file in "$@"; do
        if [ ! -f "$file" ]; then continue; fi
        { grep -v " $file\$" "$record" || true; echo "$scope $hash $file"; } | sort -k 3 > "$record.new"
        mv "$record.new" "$record"
    done
    exit
fi

declare -A present recorded
while read -r scope hash file; do
    recorded[$file]="$scope $hash"
done < <(cat "$record" 2> /dev/null || true)
old=0
while read -r file; do
    if [ -z "${recorded[$file]:-}" ]; then
        echo "unknown sources: $file"
        old=$((old + 1))
        continue
    fi
    read -r scope hash <<< "${recorded[$file]}"
    if [ -z "${present[$scope]:-}" ]; then present[$scope]=$(hash_of "$scope"); fi
    if [ "$hash" != "${present[$scope]}" ]; then
        echo "older than its sources ($scope): $file"
        old=$((old + 1))
    fi
done < <(find "$reference" -type f \( ! -name "*.md" -o -name accuracy.md \) ! -name SOURCE | sort)
echo "$old figures are older than their sources; scripts/reference.sh regenerates them"
