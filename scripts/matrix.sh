#!/usr/bin/env bash
# Stress tests of studies, with statistics: scripts/matrix.sh [kills] [commands] [threads] [disks] [cache]
# Runs all parts by default. KILLS is the number of kills (443 by default; 200 for
# commands); with ENGINE=direct, the killed studies use the real simulation. OPTIMIZE sets an existing
# program, which needs the feature `fake-engine`. PYTHON sets an interpreter with the
# package, whose `measure_window` is then killed, too.
set -euo pipefail
cd "$(dirname "$0")/.."

if [ -z "${OPTIMIZE:-}" ]; then cargo build --release -q --features fake-engine; fi
optimize=$(realpath "${OPTIMIZE:-${CARGO_TARGET_DIR:-target}/release/optimize}")
root=$PWD
work=$(mktemp -d)
trap 'umount "$work/disk" 2>/dev/null || true; rm -rf "$work"' EXIT
cd "$work"
common=(--task usb --engine "${ENGINE:-fake}" --quiet)

# Prints a journal without clock times.
body() { sed 's/,"datetime_start".*//' "$1/journal.jsonl"; }
same_walk() { [ ! -e "$2/walk.json" ] || cmp -s "$1/walk.json" "$2/walk.json"; }
same() { cmp -s <(body "$1") <(body "$2"); }
fail() { echo "matrix: $*" >&2; exit 1; }

# Studies of several kinds, killed at random times, resumed and killed again, and with truncated
# journals.
kills() {
    local wanted=${KILLS:-443} done=0 truncated=0 studies=0 lengths=() begun kinds=(
        "--budget 22" "--budget 14 --polish 6" "--budget 14 --optimizer sobol --objective range,peak-force")
    if [ "${ENGINE:-fake}" != fake ]; then
        kinds=("--budget 4 --polish 2 --batch 2" "--budget 6 --batch 2 --objective range,peak-force")
    fi
    export FINGER_OPT_FAKE_DELAY_US=100
    for kind in "${!kinds[@]}"; do
        begun=$(date +%s%N)
        # shellcheck disable=SC2086
        "$optimize" "${common[@]}" ${kinds[kind]} --no-cache --threads 2 --out "whole-$kind" >/dev/null
        lengths+=($((($(date +%s%N) - begun) / 1000000)))
    done
    while ((done < wanted)); do
        local kind=$((studies % ${#kinds[@]})) name=killed-$studies ms id
        for _ in 1 2 3 4 5; do
            # shellcheck disable=SC2086
            "$optimize" "${common[@]}" ${kinds[kind]} --no-cache --threads 2 --out "$name" >/dev/null 2>&1 &
            id=$!
            ms=$((RANDOM * RANDOM % lengths[kind]))
            sleep "$((ms / 1000)).$(printf %03d $((ms % 1000)))"
            if kill -KILL "$id" 2>/dev/null; then done=$((done + 1)); fi
            wait "$id" 2>/dev/null || true
            if [ -s "$name/journal.jsonl" ] && ((RANDOM % 3 == 0)); then
                truncate -s "-$((RANDOM % 200))" "$name/journal.jsonl" && truncated=$((truncated + 1))
            fi
        done
        # shellcheck disable=SC2086
        "$optimize" "${common[@]}" ${kinds[kind]} --no-cache --out "$name" >/dev/null
        same "$name" "whole-$kind" || fail "$name differs from whole-$kind"
        same_walk "$name" "whole-$kind" || fail "the confirmation of $name differs from that of whole-$kind"
        rm -rf "$name"
        studies=$((studies + 1))
    done
    echo "kills         $done kills and $truncated truncated journals of $studies studies of ${#kinds[@]}" \
        "kinds: identical journals and confirmations"
}

# Commands that write a file, killed at random times: the file must be absent, unchanged or complete, and running
# the command again must write the same file as without a kill.
commands() {
    local wanted=${KILLS:-200} done=0 count=0 ms id line out log
    local finger="--task usb --density 20 --direction 10"
    printf 'log,infill_density_percent,infill_direction_deg,offset_mm,outcome\nlog.csv,20,10,0,inserted\n' >runs.csv
    # shellcheck disable=SC2086
    "$optimize" trial $finger --log log.csv >/dev/null
    cp "$root/tasks/usb.toml" task.toml
    local lines=("levers $finger --engine direct --svg OUT.svg" "map $finger --engine direct --svg OUT.svg"
        "task tune task.toml --engine fake --out OUT/task.toml" "identify --task usb --runs runs.csv --out OUT.toml")
    for line in "${lines[@]}"; do
        out=${line##* } log=whole-$count
        # A tuned task is named after its file.
        mkdir -p "$log" killed
        # shellcheck disable=SC2086
        ms=$(date +%s%N) && "$optimize" ${line/OUT/$log} >/dev/null 2>&1 && ms=$((($(date +%s%N) - ms) / 1000000))
        for ((i = 0; i < wanted / 4; i++)); do
            # shellcheck disable=SC2086
            "$optimize" ${line/OUT/killed} >/dev/null 2>&1 &
            id=$!
            local at=$((RANDOM * 32768 % (ms + 20)))
            sleep "$((at / 1000)).$(printf %03d $((at % 1000)))"
            if kill -KILL "$id" 2>/dev/null; then done=$((done + 1)); fi
            wait "$id" 2>/dev/null || true
            if [ -e "${out/OUT/killed}" ]; then
                cmp -s "${out/OUT/killed}" "${out/OUT/$log}" || fail "killed: $line leaves a partial file"
                rm "${out/OUT/killed}"
            fi
        done
        # shellcheck disable=SC2086
        "$optimize" ${line/OUT/killed} >/dev/null 2>&1
        cmp -s "${out/OUT/killed}" "${out/OUT/$log}" || fail "after kills: $line writes a different file"
        rm -f "${out/OUT/killed}"
        count=$((count + 1))
    done
    if [ -n "${PYTHON:-}" ]; then
        "$PYTHON" "$root/scripts/killed_windows.py" "$((wanted / 4))" "$work/windows" || fail "measure_window"
        count=$((count + 1)) done=$((done + wanted / 4))
    fi
    echo "commands      $done kills of $count commands: no partial file, the same result afterwards"
}

# Optimizers, tasks, batches and threads: the journal must not depend on the number of threads.
threads() {
    local count=0
    for optimizer in gp cma-es random sobol grid "gp --polish 6"; do
        for tasks in usb usb,rj45; do
            for batch in 1 3 4 7; do
                local reference=
                for threads in 1 2 3 8; do
                    local name="threads-${optimizer// /}-$tasks-$batch-$threads"
                    # shellcheck disable=SC2086
                    "$optimize" --task "$tasks" --engine fake --quiet --budget 18 --optimizer $optimizer \
                        --batch "$batch" --threads "$threads" --no-cache --out "$name" >/dev/null
                    if [ -n "$reference" ]; then same "$name" "$reference" || fail "$name"; else reference=$name; fi
                    count=$((count + 1))
                done
            done
        done
    done
    echo "threads       $count combinations of optimizer, tasks, batch and threads: the same journals"
}

# Full disks, from no space to almost enough, and read-only disks, with every command that writes.
disks() {
    local count=0 code
    "$optimize" "${common[@]}" --budget 22 --no-cache --out whole >/dev/null
    mkdir -p disk
    for kilobytes in 4 16 24 32 48 64 96 128 192 256; do
        mount -t tmpfs -o size=${kilobytes}k none disk || { echo "disks: skipped, mounting is not permitted" >&2; return; }
        code=0
        "$optimize" "${common[@]}" --budget 22 --no-cache --out disk/s >/dev/null 2>error || code=$?
        case $code in
        0) ;;
        1) grep -q . error || fail "a full disk of $kilobytes KB: no error message" ;;
        *) fail "a full disk of $kilobytes KB: exit code $code" ;;
        esac
        if [ -s disk/s/study.toml ]; then
            mkdir moved && cp -r disk/s/. moved/ && rm -f moved/.optimize-*
            "$optimize" resume --quiet moved >/dev/null
            same moved whole || fail "the study saved on $kilobytes KB resumes to a different journal"
            rm -rf moved
        fi
        umount disk
        count=$((count + 1))
    done
    mount -t tmpfs -o size=4k none disk
    head -c 4096 /dev/zero >disk/full
    "$optimize" measure add --task usb --density 20 --direction 10 --range-mm 5 kept.csv >/dev/null
    local one="--task usb --density 20 --direction 10"
    local mesh=$root/examples/meshes/keyed
    for command in "stiffness --svg disk/f.svg" "finger --density 20 --direction 10 --svg disk/f.svg" \
        "export finger --format stl --density 20 --direction 10 --out disk/f.stl" \
        "export finger --format 3mf --density 20 --direction 10 --out disk/f.3mf" \
        "export mjcf --task usb --density 20 --direction 10 --out disk/f.xml" \
        "trial $one --engine fake --svg disk/f.svg" "trial $one --engine direct --record disk/f.html" \
        "trial $one --engine direct --plot disk/f.svg" \
        "task new mine --engine fake --round 8x12 --clearance 0.1 --body 12x12x20 --out disk/f.toml" \
        "task import --engine fake --unit mm --plug $mesh-plug.stl --socket $mesh-socket.stl --out disk/f.toml" \
        "task check usb --engine fake --svg disk/f.svg" \
        "measure add --task usb --density 20 --direction 10 --range-mm 5 disk/f.csv" \
        "calibrate --task usb --engine fake --simulations 16 --samples 20 --no-cache --quiet --measurements published --out disk" \
        "compare whole --svg disk/f.svg"; do
        code=0
        # shellcheck disable=SC2086
        "$optimize" $command >/dev/null 2>error || code=$?
        { [ "$code" = 1 ] && grep -q disk/ error; } || fail "$command: exit code $code: $(cat error)"
        [ "$(ls -A disk)" = full ] || fail "$command leaves $(ls -A disk)"
        count=$((count + 1))
    done
    mount -o remount,ro disk
    code=0
    "$optimize" "${common[@]}" --budget 3 --no-cache --out disk/s >/dev/null 2>error || code=$?
    [ "$code" = 1 ] || fail "a read-only disk: exit code $code"
    umount disk
    echo "disks         $((count + 1)) full or read-only disks: a message, exit code 1, nothing lost"
}

# Concurrent studies that share a cache; then a cache with damaged entries.
cache() {
    "$optimize" "${common[@]}" --budget 22 --no-cache --out alone >/dev/null
    local ids=()
    for i in 1 2 3 4 5 6; do
        "$optimize" "${common[@]}" --budget 22 --cache shared --threads "$i" --out "cached-$i" >/dev/null &
        ids+=($!)
    done
    for id in "${ids[@]}"; do wait "$id"; done
    for i in 1 2 3 4 5 6; do same "cached-$i" alone || fail "cached-$i"; done
    local entries
    entries=$(find shared -name '*.json' | wc -l)
    find shared -name '*.json' | while read -r entry; do
        case $((RANDOM % 3)) in
        0) truncate -s "-$((RANDOM % 300 + 1))" "$entry" ;;
        1) sed -i 's/"trials":\([0-9]\)/"trials":1\1/' "$entry" ;;
        2) : >"$entry" ;;
        esac
    done
    "$optimize" "${common[@]}" --budget 22 --cache shared --out damaged >/dev/null
    same damaged alone || fail "a damaged cache changed a journal"
    echo "cache         6 concurrent studies, then $entries damaged entries: the same journals"
}

for part in "${@:-kills commands threads disks cache}"; do
    for name in $part; do "$name"; done
done
