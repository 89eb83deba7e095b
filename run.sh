#!/usr/bin/env bash
# Builds Scancast and serves scans: the one command to see something.
set -euo pipefail
root=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
. "$root/deploy/setup.sh"

usage() {
    cat <<'EOF'
Usage: ./run.sh [--yes|--no-install] [FILE…] [-- OPTIONS OF scancast serve]

Installs what is missing, builds Scancast, and serves your scans (LAS, LAZ, PLY, PCD, EPT, Potree) as a page that you open in a
browser. Without a FILE it generates a small town to look at.

  --yes          install missing Debian packages without asking
  --no-install   never install anything
  --build-only   build, then stop

Examples:
  ./run.sh
  ./run.sh church.las statue.ply
  ./run.sh church.las -- --port 9000
EOF
}

install=auto
build_only=no
files=()
while [ $# -gt 0 ]; do
    case "$1" in
        -h|--help) usage; exit 0 ;;
        --yes) install=yes ;;
        --no-install) install=no ;;
        --build-only) build_only=yes ;;
        --) shift; break ;;
        -*) usage >&2; die "unknown option $1 (options of scancast serve go behind --)" ;;
        *) [ -e "$1" ] || die "there is no file $1"
           files+=("$(realpath "$1")") ;;
    esac
    shift
done

ensure_packages build
build release --target scancast scancast-client scancast-import-pcl scancast-import-e57 scancast-import-laz scancast-import-octree
[ "$build_only" = no ] || exit 0

bin=$root/build/release/bin
if [ ${#files[@]} -eq 0 ]; then
    demo=$root/build/demo/town.las
    if [ ! -e "$demo" ]; then
        as_caller mkdir -p "$(dirname "$demo")"
        say "No scan given: generating a town to look at."
        as_caller "$bin/scancast" generate town --points 5000000 -o "$demo"
    fi
    files=("$demo")
fi
if [ "$(id -u)" = 0 ] && [ -n "${SUDO_USER:-}" ] && [ "$SUDO_USER" != root ]; then
    exec runuser -u "$SUDO_USER" -- "$bin/scancast" serve "${files[@]}" "$@"
fi
exec "$bin/scancast" serve "${files[@]}" "$@"
