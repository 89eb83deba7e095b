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

ensure_packages build test
npm_modules importers/laz || die "npm could not install what reads LAZ and Potree"
npm_modules tests/foreign || die "npm could not install what the tests with another WebSocket library need"
npm_modules tests/browser || die "npm could not install what the browser tests need"

[ -d "$root/../shared/data" ] || say "NOTE: ../shared/data is missing: tests on real scans will be skipped."

run() { (cd "$root" && as_caller ctest --preset "$@" --no-tests=error); }

say "== release: every test"
build release
run release "${exclude[@]}"

if [ "$quick" = no ]; then
    say "== asan: unit and network tests"
    build asan
    run asan -L '^(unit|net)$'

    say "== tsan: scheduler and stream"
    build tsan --target scancast_tsan_tests
    run tsan
fi
