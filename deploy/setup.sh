# Shared by run.sh and test.sh: what is missing on this machine, installing it, building. Sourced, not run.
# The caller sets `root` (the project's folder) and, from its flags, install=auto|yes|no.

say() { printf '%s\n' "$*" >&2; }
die() { say "$0: $*"; exit 1; }

# The user who called, also under sudo: nobody wants a build folder that belongs to root.
as_caller() {
    if [ "$(id -u)" = 0 ] && [ -n "${SUDO_USER:-}" ] && [ "$SUDO_USER" != root ]; then
        runuser -u "$SUDO_USER" -- "$@"
    else
        "$@"
    fi
}

# missing_packages LIST…: prints the packages of deploy/packages/LIST.txt that are not installed.
missing_packages() {
    local list package command
    for list in "$@"; do
        while read -r package command; do
            case "$package" in ''|'#'*) continue ;; esac
            if [ -n "$command" ] && command -v "$command" >/dev/null 2>&1; then continue; fi
            if ! dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null | grep -qx installed; then
                printf '%s\n' "$package"
            fi
        done < "$root/deploy/packages/$list.txt"
    done
}

# ensure_packages LIST…: installs what is missing, asking at most once.
ensure_packages() {
    local missing
    missing=$(missing_packages "$@" | tr '\n' ' ')
    [ -n "${missing// /}" ] || return 0
    say "These Debian packages are missing: $missing"
    if [ "$install" = no ]; then
        die "not installing them (--no-install). To do it yourself: apt-get install --no-install-recommends $missing"
    fi
    command -v apt-get >/dev/null 2>&1 || die "this is not a Debian system: install what corresponds to the packages above, then use --no-install"
    local sudo=()
    if [ "$(id -u)" != 0 ]; then
        command -v sudo >/dev/null 2>&1 || die "run this as root once, or install sudo, to get the packages above"
        sudo=(sudo)
    fi
    # A new machine or container knows no package lists yet.
    if ! apt-cache show ninja-build >/dev/null 2>&1; then
        say "Fetching the package lists…"
        "${sudo[@]}" apt-get update -qq || die "could not fetch the package lists"
    fi
    # shellcheck disable=SC2086
    apt-get install --no-install-recommends --assume-no $missing 2>/dev/null |
        grep -E '^(Need to get|After this operation)' >&2 || true
    if [ "$install" = auto ] && [ "$(id -u)" != 0 ] && [ -z "${CI:-}" ]; then
        [ -t 0 ] || die "not installing without being asked: add --yes to agree"
        local answer
        read -r -p "Install them now? [y/N] " answer
        case "$answer" in y|Y|yes) ;; *) die "nothing was installed" ;; esac
    fi
    # Lists can be older than the mirror: one more try after an update.
    # shellcheck disable=SC2086
    "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends $missing >&2 ||
        { "${sudo[@]}" apt-get update -qq && "${sudo[@]}" env DEBIAN_FRONTEND=noninteractive \
            apt-get install -y -qq --no-install-recommends $missing >&2; } || die "installing packages failed"
}

# npm_modules FOLDER: installs what FOLDER/package-lock.json lists, unless that is there already.
npm_modules() {
    local folder=$root/$1
    [ ! "$folder/node_modules/.package-lock.json" -nt "$folder/package-lock.json" ] || return 0
    (cd "$folder" && as_caller npm ci --ignore-scripts --no-audit --no-fund --loglevel=error >&2)
}

# Compilers that see Boost.Beast or PCL want about 2 GB each.
build_jobs() {
    local cores gigabytes
    cores=$(nproc)
    gigabytes=$(awk '/MemAvailable/ {print int($2 / 2097152)}' /proc/meminfo)
    [ "$gigabytes" -ge 1 ] || gigabytes=1
    [ "$cores" -le "$gigabytes" ] && echo "$cores" || echo "$gigabytes"
}

# build PRESET [cmake --build arguments…]
build() {
    local preset=$1
    shift
    (cd "$root" && as_caller cmake --preset "$preset" >"${TMPDIR:-/tmp}/scancast-configure.$$" 2>&1) || {
        cat "${TMPDIR:-/tmp}/scancast-configure.$$" >&2
        die "configuring the '$preset' build failed (see above)"
    }
    rm -f "${TMPDIR:-/tmp}/scancast-configure.$$"
    (cd "$root" && as_caller cmake --build --preset "$preset" -j "$(build_jobs)" "$@" >&2) || die "building '$preset' failed"
}
