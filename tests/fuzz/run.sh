#!/usr/bin/env bash
# Fuzzes every parser of outside bytes for a time: builds the targets with clang, runs them side by side, and prints what each did.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)

usage() {
    cat <<'EOF'
Usage: tests/fuzz/run.sh [--minutes N] [--jobs N] [--build FOLDER] [--keep] [TARGET…]

Builds the fuzz targets with clang, coverage and the address sanitizer, and runs them for N minutes in all (5), some at
a time (as many as there are cores). Prints executions, coverage and inputs of each; ends with 1 where one found something.

  --build FOLDER  where to build, and where what was found and learned is kept (build/fuzz)
  --keep          take what is worth keeping into tests/fuzz/seeds: inputs that reach what the seeds do not, as few and
                  as small as do
  TARGET…         fuzz_las, fuzz_message …; all without it

Example: tests/fuzz/run.sh --minutes 60
Needs clang 16 or later (earlier ones lack parts of C++20) and its runtime: apt-get install clang-19 libclang-rt-19-dev
EOF
}

minutes=5 jobs=$(nproc) build=$root/build/fuzz keep=no targets=()
while [ $# -gt 0 ]; do
    case "$1" in
        -h|--help) usage; exit 0 ;;
        --minutes) minutes=${2:?--minutes: how many?}; shift ;;
        --jobs) jobs=${2:?--jobs: how many?}; shift ;;
        --build) build=${2:?--build: which folder?}; shift ;;
        --keep) keep=yes ;;
        fuzz_*) targets+=("$1") ;;
        *) usage >&2; echo "$0: unknown option $1" >&2; exit 2 ;;
    esac
    shift
done
for number in "$minutes" "$jobs"; do
    [[ $number =~ ^[1-9][0-9]*$ ]] || { echo "$0: $number is no whole number above 0" >&2; exit 2; }
done
if [ ${#targets[@]} = 0 ]; then
    while read -r source; do targets+=("$(basename "$source" .cpp)"); done < <(find "$root/tests/fuzz" -name "fuzz_*.cpp" | sort)
fi
for suffix in "" -22 -21 -20 -19 -18 -17 -16 none; do
    version=$(clang++$suffix -dumpversion 2>/dev/null) && [ "${version%%.*}" -ge 16 ] && break
done
[ "$suffix" != none ] || { echo "$0: clang 16 or later is missing: apt-get install clang-19 libclang-rt-19-dev" >&2; exit 2; }

echo "== building ${#targets[@]} targets in $build" >&2
CC=clang$suffix CXX=clang++$suffix cmake -S "$root" -B "$build" -G Ninja -DCMAKE_BUILD_TYPE=RelWithDebInfo -DSCANCAST_FUZZ=ON >"$build.log" 2>&1 ||
    { cat "$build.log" >&2; exit 2; }
cmake --build "$build" --target "${targets[@]}" >"$build.log" 2>&1 || { tail -40 "$build.log" >&2; exit 2; }

# Real scans that are at hand are seeds, too.
data=$root/../shared/data
seeds_of() {
    local name=$1 folder
    printf '%s\n' "$root/tests/fuzz/seeds/$name"
    case "$name" in
        fuzz_las) set -- las bad ;;
        fuzz_text) set -- text bad ;;
        fuzz_ptx) set -- text ;;
        fuzz_scan_headers) set -- ply pcd bad ;;
        *) set -- ;;
    esac
    for folder in "$@"; do [ ! -d "$data/$folder" ] || printf '%s\n' "$data/$folder"; done
}

seconds=$((minutes * 60 * jobs / ${#targets[@]}))
[ "$seconds" -gt 0 ] || seconds=1
fuzz() {
    local name=$1 corpus=$build/corpus/$1 words=$root/tests/fuzz/$1.dict seeds
    mkdir -p "$corpus" "$build/found"
    mapfile -t seeds < <(seeds_of "$name")
    local words_given=()
    [ ! -f "$words" ] || words_given=(-dict="$words")
    # What is larger than a message or the head of a file is reached by smaller inputs, too, and a thousand times as fast.
    "$build/tests/$name" -max_total_time="$seconds" -max_len=16384 -rss_limit_mb=4096 -timeout=20 -print_final_stats=1 \
        -artifact_prefix="$build/found/$name-" ${words_given[@]+"${words_given[@]}"} "$corpus" "${seeds[@]}" >"$build/$name.log" 2>&1 || echo failed >>"$build/$name.log"
}
export -f fuzz seeds_of
export build root data seconds
echo "== $seconds s of each target, $jobs at a time" >&2
printf '%s\n' "${targets[@]}" | xargs -P "$jobs" -I{} bash -c 'fuzz {}'

status=0 all=0
printf '| %-20s | %12s | %8s | %8s | %-8s |\n|---|---|---|---|---|\n' target executions edges inputs found
for name in "${targets[@]}"; do
    log=$build/$name.log
    executions=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log" | tail -1)
    edges=$(sed -n 's/.* cov: \([0-9]*\) .*/\1/p' "$log" | tail -1)
    found=$(ls "$build/found" | grep -c "^$name-" || true)
    if [ "$(tail -1 "$log")" = failed ] || [ "$found" != 0 ]; then status=1; fi
    all=$((all + ${executions:-0}))
    printf '| %-20s | %12s | %8s | %8s | %-8s |\n' "$name" "${executions:-?}" "${edges:-?}" "$(ls "$build/corpus/$name" | wc -l)" "$found"
done
echo "$all executions in all"
[ "$status" = 0 ] || echo "Something was found: $build/found has the inputs, $build/TARGET.log what they did. Again: $build/tests/TARGET FILE" >&2

if [ "$keep" = yes ]; then
    for name in "${targets[@]}"; do
        # Adds to the first folder only what the others reach and it does not: lines of code, not how often (-use_counters).
        "$build/tests/$name" -set_cover_merge=1 -use_counters=0 -max_len=4096 "$root/tests/fuzz/seeds/$name" "$build/corpus/$name" >"$build/$name.merge.log" 2>&1 ||
            { echo "$name: what it learned could not be merged, see $build/$name.merge.log" >&2; status=1; }
        echo "$name: $(ls "$root/tests/fuzz/seeds/$name" | wc -l) seeds" >&2
    done
fi
exit $status
