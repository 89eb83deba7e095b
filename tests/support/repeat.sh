#!/usr/bin/env bash
# Runs tests many times while the machine is busy with something else: what fails once in twenty runs is a fault, of the
# test or of the product. Prints what failed, and how often.
set -euo pipefail
usage() {
    cat <<'EOF'
Usage: tests/support/repeat.sh BUILD_FOLDER [TIMES] [ctest options…]

  tests/support/repeat.sh build/release 20 -L '^(unit|net)$'

Beside it as many loops as the machine has processors keep them busy (LOOPS=0 where something else does, a build for one).
Budgets hold: they count the tests' own time.
EOF
}
[ $# -ge 1 ] && [ -d "$1" ] || { usage >&2; exit 2; }
build=$1 times=${2:-20}
shift; [ $# -eq 0 ] || shift
failed=$(mktemp) load=()
trap '[ ${#load[@]} -eq 0 ] || kill "${load[@]}" 2>/dev/null; rm -f "$failed"' EXIT
for ((i = 0; i < ${LOOPS:-$(nproc)}; ++i)); do
    (while :; do :; done) &
    load+=($!)
done
for ((run = 1; run <= times; ++run)); do
    ctest --test-dir "$build" -LE slow --output-on-failure -j "$(nproc)" "$@" >"$build/repeat_$run.log" 2>&1 || true
    sed -n '/^The following tests FAILED:/,$p' "$build/repeat_$run.log" | sed -nE 's/^[^0-9]*[0-9]+ - (.*)$/\1/p' | tee -a "$failed" |
        sed "s/^/run $run: /"
    printf 'run %d of %d: %s\n' "$run" "$times" "$(grep -E 'tests passed' "$build/repeat_$run.log" || echo 'ctest failed')"
done
[ ! -s "$failed" ] || { printf '\nfailed, and how often:\n'; sort "$failed" | uniq -c | sort -rn; exit 1; }
printf '\nnothing failed in %d runs\n' "$times"
