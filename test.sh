#!/usr/bin/env bash
# Installs what is missing, builds, and runs every test: the one command before a commit, and all that CI does.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$root/deploy/setup.sh"

usage() {
    cat <<'EOF'
Usage: ./test.sh [--yes|--no-install] [--quick] [--slow]

Builds and tests: everything in the release build, the unit and network tests again under the address and
undefined-behaviour sanitizers, the scheduler and the stream under the thread sanitizer.

  --quick        the release build only
  --slow         also the tests labelled slow (tens of millions of points)
  --yes          install missing Debian packages without asking
  --no-install   never install anything

Real scans for tests are expected in ../shared/data; tests that need one which is missing say so and are skipped.
EOF
}

install=auto
quick=no
exclude=(-LE slow)
while [ $# -gt 0 ]; do
    case "$1" in
        -h|--help) usage; exit 0 ;;
        --yes) install=yes ;;
        --no-install) install=no ;;
        --quick) quick=yes ;;
        --slow) exclude=() ;;
        *) usage >&2; die "unknown option $1" ;;
    esac
    shift
done

install_all() {
    ensure_packages build test
    npm_modules tests/foreign || die "npm could not install what the tests with another WebSocket library need"
    npm_modules tests/browser || die "npm could not install what the browser tests need"
}

[ -d "$root/../shared/data" ] || say "NOTE: ../shared/data is missing: tests on real scans will be skipped."

# What a run skipped, and why: GoogleTest says it of each test, and CTest only of suites of which nothing ran.
skipped() {
    local log=$root/build/$1/Testing/Temporary/LastTest.log
    grep -a -h -A1 -E '^(.*: Skipped|SKIPPED)' "$log" | grep -vE '^--$' | sort | uniq -c | sort -rn | head -40 >&2 || true
}

# part NAME COMMAND…: runs it, and remembers how long it took, on the clock and in processor time.
parts=()
read_processor_time() {  # into `processor`; `times` tells a subshell nothing
    local file=${TMPDIR:-/tmp}/scancast-times.$$
    times >"$file"
    processor=$(awk 'NR == 2 {split($1, u, "[ms]"); split($2, s, "[ms]"); printf "%d", u[1] * 60 + u[2] + s[1] * 60 + s[2]}' "$file")
    rm -f "$file"
}
part() {
    local name=$1 clock=$SECONDS before
    shift
    read_processor_time; before=$processor
    "$@"
    read_processor_time
    parts+=("$(printf '%-16s %4d s, %4d s of processor time' "$name" $((SECONDS - clock)) $((processor - before)))")
}

run() {
    local preset=$1
    shift
    (cd "$root" && as_caller ctest --preset "$preset" -j "$(nproc)" --no-tests=error "$@") || { skipped "$preset"; exit 1; }
    skipped "$preset"
}

part "installation" install_all
say "== release: every test"
part "release: build" build release
part "release: tests" run release "${exclude[@]}"

if [ "$quick" = no ]; then
    say "== asan: unit and network tests"
    part "asan: build" build asan
    part "asan: tests" run asan -L '^(unit|net|replicas)$'

    say "== tsan: scheduler and stream"
    part "tsan: build" build tsan --target scancast_tsan_tests
    part "tsan: tests" run tsan
fi

say "== all green"
printf '%s\n' "${parts[@]}" >&2
