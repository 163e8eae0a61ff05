#!/usr/bin/env bash
# Regenerates every figure under results/reference from the current sources, and records the hash
# of these sources (scripts/stale.sh). Parts can be selected:
#
#     scripts/reference.sh                          all parts except those of the last line
#     scripts/reference.sh validation               one part
#     scripts/reference.sh landscapes settled peers loop   the parts omitted by default
#
# Landscapes are recorded functions for benchmarking optimizers, not figures of the current
# model: if they change, all of results/reference/optimizers.md must be regenerated. Peers
# needs the Python packages listed there, loop the Python package with the extra mujoco; both take hours. An
# interrupted loop is continued.
set -euo pipefail
cd "$(dirname "$0")/.."

parts="stiffness finger shapes bench levers check windows validation validation-ur5e trials studies pictures answers objectives instructions"
cargo build --release
optimize=${OPTIMIZE:-target/release/optimize}
lab=${LAB:-target/release/lab}
reference=results/reference
# The landscapes for comparing optimizers.
recorded="usb ket8 ket12 rj45 finger6 codesign6"
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

record() { scripts/stale.sh --record "$@"; }
# Plots the tables in a folder.
figures() {
    python3 scripts/figures.py "$1" || echo "skipped: $1/ranges.svg needs Python with matplotlib" >&2
}

stiffness() {
    "$optimize" stiffness --svg "$reference/stiffness.svg" > "$reference/stiffness.txt"
    record windows "$reference"/stiffness.{svg,txt}
}

# Stiffness of the measured designs computed from their ribs, and a drawing of one design.
finger() {
    local folder="$reference/finger" design density direction assembly compliance
    mkdir -p "$folder"
    {
        echo "Computed from the ribs at the modulus of fingers/finray9.toml, nothing fitted; measured beside it."
        echo
        tail -n +2 data/measured_stiffness.csv |
            while IFS=, read -r design density direction assembly compliance; do
                echo "design $design: $density %, $direction deg; measured $compliance and $assembly N/mm"
                "$optimize" finger --density "$density" --direction "$direction" | sed -n '/^the part/,$p'
                echo
            done
    } > "$folder/table.txt"
    "$optimize" finger --density 20 --direction 20 --svg "$folder/finray9.svg" > "$folder/finray9.txt"
    record windows "$folder"/*
}

# Calibration on the published experiments, with leave-one-out predictions.
bench() {
    local folder="$reference/bench" task
    mkdir -p "$folder"
    for task in ket8 ket12 rj45 usb; do
        "$optimize" calibrate --task "$task" --measurements published --quiet --out "$work/$task" |
            sed '/^tables are in/d' > "$folder/$task.txt"
        for table in leave_one_out parameters; do
            cp "$work/$task/$table.csv" "$folder/${table}_$task.csv"
        done
    done
    figures "$folder"
    # The key rotating in the grasp (docs/notes/bench.md): ket8 with the contact patch and twice the preload.
    sed 's/^finger_plug_torsion_mm = .*/finger_plug_torsion_mm = "patch"/' tasks/ket8.toml > "$work/patch.toml"
    "$optimize" trial --task "$work/patch.toml" --robot ur5e_position --density 30 --direction 0 \
        --set task.strategy.phase.touch.preload_mm=0.6 --svg "$folder/ket8_turns_about_y.svg" > /dev/null
    record bench "$folder"/*.{txt,csv,json,svg}
}

# Levers of the finger with the widest range of each task.
levers() {
    local folder="$reference/levers" task density direction
    mkdir -p "$folder"
    while read -r task density direction; do
        /usr/bin/env time -f "$task: %e s wall, %U s processor" -a -o "$work/levers.txt" \
            "$optimize" levers --task "$task" --density "$density" --direction "$direction" \
            --svg "$folder/$task.svg" --json > "$folder/$task.json"
    done << EOF
usb 10 26
ket8 10 0
ket12 10 0
rj45 18 20
EOF
    mv "$work/levers.txt" "$folder/times.txt"
    record levers "$folder"/*
}

check() {
    "$lab" check > "$reference/check.txt"
    "$lab" check --engine rapier > "$reference/check_rapier.txt" || true # T12 and one row of P7
    record checks "$reference"/check{,_rapier}.txt
}

# Half the step against the production step on three fingers, and coarse-to-fine against exhaustive search on all.
windows() {
    "$lab" check --convergence > "$reference/convergence.txt" ||
        echo "a window changes with the step: $reference/convergence.txt" >&2
    "$lab" check --searches --all-fingers > "$reference/window_search.txt" ||
        echo "the searches differ: $reference/window_search.txt" >&2
    record windows "$reference"/{convergence,window_search}.txt
}

validation() {
    scripts/validate.py "$optimize" "$reference/validation"
    figures "$reference/validation"
    cut -d, -f1-4,10,16 "$reference/validation/validation.csv" > data/simulated_ranges.csv
    record windows "$reference"/validation/*.{csv,svg} "$reference/validation/accuracy.md"
}

validation-ur5e() {
    scripts/validate.py "$optimize" "$reference/validation-ur5e" --robot ur5e
    record windows "$reference"/validation-ur5e/*.{csv,svg} "$reference/validation-ur5e/accuracy.md"
}

trials() {
    "$optimize" trial --task usb --density 20 --direction 10 --svg "$reference/trial-usb.svg" \
        > "$reference/trial-usb.txt"
    for task in ket8 ket12 rj45; do
        "$optimize" trial --task "$task" --stiffness-compliance 2.6 --stiffness-assembly 45 \
            --svg "$reference/trial-$task.svg" > /dev/null
    done
    record windows "$reference"/trial-*.{svg,txt}
}

# Study of the finger's shape in addition to its infill.
shapes() {
    local folder="$reference/finger/rj45"
    mkdir -p "$folder"
    /usr/bin/env time -f "%e s wall, %U s processor, %M KiB" -o "$folder/time.txt" \
        "$optimize" --task rj45 --space finger --budget 200 --no-cache --out "$work/shapes" --quiet \
        > "$folder/summary.txt"
    sed -i '/^study /d' "$folder/summary.txt"
    cp "$work/shapes/evaluations.csv" "$folder/"
    record studies "$folder"/*
}

# Keeps the files that `report` and `compare` need to open a study, but not their output.
studies() {
    local task kept
    for task in usb ket8 ket12 rj45; do
        kept="$reference/$task"
        rm -rf "$kept"
        mkdir -p "$kept"
        /usr/bin/env time -f "%e s wall, %U s processor, %M KiB" -o "$reference/$task/time.txt" \
            "$optimize" --task "$task" --budget 200 --no-cache --out "$work/$task" --quiet \
            > "$kept/summary.txt"
        sed -i '/^study /,$d' "$kept/summary.txt"
        cp -r "$work/$task"/{study.toml,inputs,journal.jsonl,walk.json} "$kept/"
        "$optimize" report "$kept" > /dev/null
        rm "$kept/report.html"
        record studies "$kept"/* "$kept"/inputs/*
    done
}

# Images for docs/: a task, and a report with a film on a desktop and on a phone.
pictures() {
    "$optimize" task check usb --svg docs/task-usb.svg > /dev/null
    if ! command -v chromium > /dev/null; then
        echo "skipped: the pictures of pages need Chromium (scripts/tools.sh chromium)" >&2
        return
    fi
    if [ ! -d "$work/usb/replay" ]; then
        "$optimize" --task usb --budget 60 --no-cache --out "$work/usb" --quiet > /dev/null
    fi
    python3 scripts/pictures.py "$work"/usb/{report.html,replay/1-positive.html} docs
}

# Summary of each kind of answer: terminal, JSON, first screen of the page.
answers() {
    local folder="$reference/answers" tilted="$work/tilted.toml" keyed="$work/keyed.toml"
    mkdir -p "$folder"
    # Tilted so far that the plug misses the opening.
    sed -e 's/^name = "usb"/name = "tilted"/' -e '0,/^tilt_deg = .*/s//tilt_deg = 25.0/' tasks/usb.toml > "$tilted"
    "$optimize" task import --plug examples/meshes/keyed-plug.stl --socket examples/meshes/keyed-socket.stl \
        --out "$keyed" > /dev/null 2>&1
    # The start is near the edge of the window.
    sed -i -E 's/^start_mm = \[([^,]*), [^,]*,/start_mm = [\1, 3.5,/' "$keyed"
    answer() {
        # Not in the folders of `studies`, because those studies would be continued.
        local study="$work/answers/$1"
        "$optimize" "${@:2}" --no-cache --out "$study" --quiet > "$folder/$1.txt" || true
        "$optimize" resume "$study" --quiet --json > "$folder/$1.json" || true
        sed -i -e "s,$work/answers,results,g" -e "s,$work,results,g" "$folder/$1".{txt,json}
        python3 scripts/pictures.py "$study/report.html" "$folder/$1.png"
    }
    answer usb --task usb
    answer rj45 --task rj45
    answer nothing-inserts --task "$tilted" --budget 40
    answer own-connector --task "$keyed" --budget 24
    answer ket8-measured --task ket8 --measurements published
    record studies "$folder"/*
}

# Objectives, constraints and tasks for docs/guide/objectives.md.
objectives() {
    local folder="$reference/objectives" few="$work/few.toml"
    mkdir -p "$folder"
    sed -e 's/samples = 12/samples = 6/' -e 's/search = "walk"/search = "strides"/' \
        -e 's/name = "typical"/name = "few"/' uncertainties/typical.toml > "$few"
    study() {
        "$optimize" "${@:2}" --no-cache --out "$work/$1" --quiet > "$folder/$1.txt"
        sed -i -e "/^study /,\$d" -e "s,$work,results," "$folder/$1.txt"
    }
    study front --task usb --objective range,peak-force --budget 60
    cp "$work/front/front.svg" "$folder/"
    study constrained --task usb --constraint 'peak-force<=110' --budget 24
    study none --task usb --constraint 'peak-force<=60' --budget 8
    study robust --task usb --objective robust-range --uncertainty "$few" --budget 12
    study tasks --task ket8,rj45 --budget 12
    "$optimize" evaluate --task rj45 --density 10 --direction 0 --uncertainty typical \
        > "$folder/evaluate.txt"
    record studies "$folder"/*
}

instructions() {
    if ! command -v valgrind > /dev/null; then
        echo "skipped: the count of instructions needs valgrind (scripts/tools.sh valgrind)" >&2
        return
    fi
    scripts/instructions.sh --renew
    record windows "$reference/instructions.txt"
}

# Prints the selected columns of a table without commas in its cells, without the header.
columns() {
    awk -F, -v names="$1" 'BEGIN { n = split(names, name, ",") }
        NR == 1 { for (i = 1; i <= NF; i++) at[$i] = i; next }
        { for (i = 1; i <= n; i++) printf "%s%s", $(at[name[i]]), i < n ? "," : "\n" }'
}

# All designs of each space: the two-parameter spaces on a coarse grid to save processor time, the
# six-parameter spaces on the few levels of the space files next to the tables.
landscapes() {
    local folder="$reference/landscapes" name task space study axes header
    sed 's/step = 1.0/step = 2.0/' spaces/infill.toml > "$work/coarse.toml"
    while read -r name task space; do
        study="$work/landscape-$name"
        "$optimize" --task "$task" --space "$space" --optimizer grid --budget 10000 --no-cache \
            --no-confirm --quiet --out "$study" > /dev/null
        axes=$(head -1 "$study/evaluations.csv" | sed 's/^evaluation,//; s/,objective_mm,.*//')
        header=$axes,range_mm,negative_mm,positive_mm,failure_negative,failure_positive
        echo "$header" > "$folder/$name.csv"
        columns "$header" < "$study/evaluations.csv" |
            LC_ALL=C sort -t, -k1,1n -k2,2n -k3,3g -k4,4g -k5,5g -k6,6g >> "$folder/$name.csv"
    done << EOF
usb usb infill
ket8 ket8 infill
ket12 ket12 $work/coarse.toml
rj45 rj45 $work/coarse.toml
finger6 rj45 $folder/finger6.toml
codesign6 ket8 $folder/codesign6.toml
EOF
    record windows "$folder"/*.csv
}

# Studies without a budget, ten seeds on each task, compared with the best firm range of all designs.
settled() {
    local file="$reference/landscapes/firm/studies.csv" task seed
    echo "task,seed,evaluations,confirmed,walked,trials,firm_range_mm,best_firm_range_mm" > "$file"
    for task in usb ket8 ket12 rj45; do
        for seed in 0 1 2 3 4 5 6 7 8 9; do
            "$optimize" --task "$task" --seed "$seed" --cache "$work/cache" --out "$work/settled-$task-$seed" \
                --quiet --json > "$work/settled.json"
            python3 scripts/settled.py "$work/settled-$task-$seed" "$work/settled.json" \
                "$reference/landscapes/firm/$task.csv" >> "$file"
        done
    done
    record studies "$file"
}

# Gain of the loop of study, print, measurement and identification in hidden cells.
loop() {
    local cells=() seed
    for seed in 1 2 3 4 5 6 7 8; do cells+=("usb:$seed" "ket8:$seed"); done
    python3 scripts/loop.py results/loop "${cells[@]}" rj45:1 rj45:2
    python3 scripts/loop.py results/loop --table > "$reference/bench/loop.md"
    record windows "$reference/bench/loop.md"
}

# All runs of results/reference/optimizers.md except those of Rastrigin, which a test of ask-tell repeats.
peers() {
    local python=${PYTHON:-venv/bin/python} csv="$work/peers.csv" folder="$reference/optimizers"
    local landscapes=() task
    for task in $recorded; do
        landscapes+=("$reference/landscapes/$task.csv")
    done
    "$python" scripts/peers.py run gp cma-es random sobol grid --csv "$work/ours.csv" \
        --landscape "${landscapes[@]}"
    grep '^rastrigin' "$folder/ours.csv" >> "$work/ours.csv"
    mv "$work/ours.csv" "$folder/ours.csv"
    "$python" scripts/peers.py run tpe --csv "$csv" --landscape "${landscapes[@]}"
    "$python" scripts/peers.py run gpsampler botorch --seeds 10 --csv "$csv" \
        --landscape "${landscapes[@]}"
    "$python" scripts/peers.py run pycma --only "rastrigin 2" --seeds 100 --csv "$csv"
    mv "$csv" "$folder/peers.csv"
    record optimizers "$folder"/*.csv
}

for part in ${*:-$parts}; do
    case " $parts landscapes settled peers loop " in
        *" $part "*) echo "== $part" >&2; "$part" ;;
        *) echo "unknown part $part; available: $parts landscapes settled peers loop" >&2; exit 2 ;;
    esac
done
