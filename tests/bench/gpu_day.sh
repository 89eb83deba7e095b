#!/usr/bin/env bash
# The day on which there is a graphics card, perhaps for an hour: all that is to be measured, in parts of at most eight
# minutes. Needs bash, coreutils and a driver; without arguments it tells its parts. What each part found lies in the
# folder of --out as PART.md (tables), PART.json (the same for programs), PART.log (progress, complaints) and
# pictures/PART/*.png; a part that is done is not done again, so that `gpu_day.sh all` goes on where it was stopped.
#
# No wrong picture is timed: `compare` comes before everything else, and what is below 45 dB from the cpu device's
# picture ends the run; each timed row compares its own picture, too.
#
# Exit codes: 0; 1 a part failed; 2 wrong arguments; 3 no device opened; 4 what opened is no graphics card;
# 5 a picture is wrong.
set -euo pipefail

here=$(cd "$(dirname "${BASH_SOURCE[0]}")" && pwd)
parts=(device compare 10m 10m-direct-sums 100m-points 100m-surfels 796m)

usage() {
  cat <<'END'
gpu_day.sh [options] PART...     runs these parts
gpu_day.sh [options] all         runs all parts that are not done yet, in this order
gpu_day.sh [options] pack        puts everything into a few tar files of at most 15 MB

part           minutes  what it does                                     (on an H100 with 16 cores)
device            0.1   opens the device, tells driver, memory, clocks
compare           0.3   every method's picture of six scenes against the cpu device's
10m               1.5   10 million points, all methods, three sizes
10m-direct-sums   0.5   the same cloud, methods with sums, these not in shared memory first: to be set beside 10m
100m-points       1.5   100 million points without surfels: brute force and the methods that need none
100m-surfels      1.5   100 million points with surfels: disc, ewa, voronoi
796m                3   796 million points without surfels: brute force and a few methods; 57 GB of memory

options
--out FOLDER       where everything is left; gpu_day/ in this folder by default
--quick            tiny clouds and pictures: shows that everything runs, also on a software rasteriser
--software         full sizes on a software rasteriser, too
--again            does parts again that are done
--anyway           goes on where pictures are wrong, and times them
--backend NAME     egl by default; osmesa, cpu
--limit SECONDS    most time of a part, 480 by default
--programs FOLDER  where bench_gpu and compare_devices are; this script's folder, else build/release/bench_gpu

Example: gpu_day.sh --out results device compare && gpu_day.sh --out results all && gpu_day.sh --out results pack
END
}

say() { printf '%s\n' "$*" >&2; }

refuse() {
  say "gpu_day.sh: $*"
  exit 2
}

# shellcheck source=tests/bench/gpu_day_driver.sh
source "$here/gpu_day_driver.sh"

# --- What each part runs ---------------------------------------------------------------------------------------------

# Sets `command` for a part.
command_of() {
  local sizes=1248x768,1920x1080,3840x2160
  local -a checked=(--compare)
  [[ $anyway == no ]] || checked+=(--anyway)
  command=("$programs/bench_gpu" --backend "$backend" --json "$out/$1.json" --pictures "$out/pictures/$1"
    "${checked[@]}")
  if [[ $quick == yes ]]; then
    sizes=192x108,320x192
    command+=(--quick --repeat 2)
  fi
  case $1 in
    device) command+=(--quick --methods point) ;;
    compare)
      command=("$programs/compare_devices" --backends "$backend" --markdown --json "$out/$1.json")
      [[ $quick == no ]] || command+=(--scenes town --points 20000 --width 192 --repeat 1)
      ;;
    10m) command+=(--sizes "$sizes" --points "$(points_of 10M 10k)") ;;
    10m-direct-sums)
      command+=(--sizes "$sizes" --points "$(points_of 10M 10k)" --methods 'hqs,ewa,voronoi' --sum-tiles false)
      ;;
    100m-points) command+=(--sizes "$sizes" --points "$(points_of 100M 20k)" --no-surfels) ;;
    100m-surfels) command+=(--sizes "$sizes" --points "$(points_of 100M 20k)" --methods 'disc,ewa,voronoi') ;;
    796m)
      command+=(--sizes "$sizes" --points "$(points_of 796M 30k)" --no-surfels --methods 'point,paraboloid,hqs,pyramid')
      ;;
  esac
  [[ $software == yes ]] || command+=(--require-hardware)
}

points_of() {
  if [[ $quick == yes ]]; then printf '%s' "$2"; else printf '%s' "$1"; fi
}

# --- Reports ---------------------------------------------------------------------------------------------------------

print_machine() {
  local line model='not told' memory='not told'
  while read -r line; do
    [[ $line == 'model name'* ]] && model=${line#*: } && break
  done <<<"$(cat /proc/cpuinfo 2>/dev/null || true)"
  while read -r line; do
    [[ $line == MemTotal:* ]] && read -r _ memory <<<"$line" && break
  done <<<"$(cat /proc/meminfo 2>/dev/null || true)"
  printf -- '- processor: %s, %s threads; memory: %s; kernel %s\n' "$model" "$(nproc)" "$memory" "$(uname -r)"
  printf -- '- %s\n' "${egl_notes[@]}"
}

print_clocks() {
  local wanted=name,driver_version,pstate,clocks.sm,clocks.mem,clocks.max.sm,clocks.max.mem,power.draw,power.limit
  wanted+=,temperature.gpu,utilization.gpu,memory.used,memory.total
  printf '\nClocks and power %s:\n\n```\n' "$1"
  if ! command -v nvidia-smi >/dev/null; then
    printf 'not told: there is no nvidia-smi here\n'
  elif ! nvidia-smi --query-gpu="$wanted" --format=csv 2>&1; then
    printf 'not told: nvidia-smi failed\n'
  fi
  printf '```\n\n'
}

# A quick run does not stand for a full one.
is_done() {
  [[ -e $out/$1.md && $(tail -n 1 "$out/$1.md") == "Part $1: done, quick: $quick,"* ]]
}

# Runs a command; its output goes to the screen and to PART.md, its complaints and progress to the screen and PART.log.
recorded() {
  local part=$1
  shift
  { "$@" 2>&1 1>&3 3>&- | tee "$out/$part.log" 1>&2 3>&-; } 3>&1 | tee -a "$out/$part.md"
}

run_part() {
  local part=$1 status=0 begin=$SECONDS
  local -a command
  if [[ $again == no ]] && is_done "$part"; then
    say "== $part: done already; --again does it again"
    return 0
  fi
  say "== $part, $(date -u '+%Y-%m-%d %H:%M:%S') UTC"
  mkdir -p "$out/pictures/$part"
  command_of "$part"
  {
    printf '# %s, %s%s\n\n' "$part" "$(date -u '+%Y-%m-%d %H:%M') UTC" "$([[ $quick == no ]] || printf ', quick')"
    print_machine
    print_clocks before
  } >"$out/$part.md"
  # The programs find the libraries beside them by themselves, but not where there is no /proc.
  recorded "$part" timeout --kill-after=10 "$limit" env LD_PRELOAD="$preload" \
    LD_LIBRARY_PATH="${LD_LIBRARY_PATH:+$LD_LIBRARY_PATH:}$programs" "${command[@]}" || status=$?
  rmdir "$out/pictures/$part" 2>/dev/null || true  # where there are none
  print_clocks after >>"$out/$part.md"
  case $status in
    0) printf 'Part %s: done, quick: %s, in %d s\n' "$part" "$quick" $((SECONDS - begin)) ;;
    124 | 137) printf 'Part %s: stopped after %d s; what was measured until then stands above\n' "$part" "$limit" ;;
    *) printf 'Part %s: FAILED with exit code %d; %s.log says why\n' "$part" "$status" "$part" ;;
  esac | tee -a "$out/$part.md"
  return "$status"
}

# Runs parts in turn. Without a device, or with wrong pictures, there is no point in going on; a part that was too slow
# or failed otherwise leaves the others alone.
run_parts() {
  local part status failed=0
  for part in "$@"; do
    status=0
    run_part "$part" || status=$?
    case $status in
      0) ;;
      3 | 4) return "$status" ;;
      5)
        failed=5
        if [[ $anyway == no ]]; then
          say "gpu_day.sh: pictures are wrong ($out/$part.md says which): nothing more is timed. --anyway goes on."
          return 5
        fi
        ;;
      *) failed=1 ;;
    esac
    if [[ $part == compare && $status != 0 && $anyway == no ]]; then
      say "gpu_day.sh: nobody knows yet whether the pictures are right: nothing is timed. --anyway goes on."
      return "$failed"
    fi
  done
  return "$failed"
}

# Tar files of at most 15 MB, tables first.
pack() {
  local most=15000000 number=0 bytes=0 size file
  local -a files=() all=()
  command -v tar >/dev/null || refuse "there is no tar here; copy $out as it is"
  rm -f "$out"/gpu_day-[0-9]*.tar
  cd "$out"
  for file in *.md *.json *.log pictures/*/*.png; do
    [[ -f $file ]] && all+=("$file")
  done
  [[ ${#all[@]} -gt 0 ]] || refuse "there is nothing in $out yet"
  for file in "${all[@]}"; do
    size=$(($(stat -c %s "$file") + 1024))
    if ((bytes > 0 && bytes + size > most)); then
      tar -cf "gpu_day-$((++number)).tar" "${files[@]}"
      files=() bytes=0
    fi
    files+=("$file")
    bytes=$((bytes + size))
  done
  tar -cf "gpu_day-$((++number)).tar" "${files[@]}"
  ls -l gpu_day-*.tar
}

# --- Arguments -------------------------------------------------------------------------------------------------------

out=$here/gpu_day programs='' backend=egl limit=480 preload=
quick=no software=no again=no anyway=no
wanted=() egl_notes=()
while (($# > 0)); do
  case $1 in
    --quick) quick=yes software=yes ;;
    --software) software=yes ;;
    --again) again=yes ;;
    --anyway) anyway=yes ;;
    --out | --backend | --limit | --programs)
      [[ $# -ge 2 ]] || refuse "$1 needs a value"
      printf -v "${1#--}" '%s' "$2"
      shift
      ;;
    --help | -h)
      usage
      exit 0
      ;;
    -*) refuse "there is no option $1; without arguments all are told" ;;
    all) wanted+=("${parts[@]}") ;;
    *)
      [[ " ${parts[*]} pack " == *" $1 "* ]] || refuse "there is no part $1; without arguments all are told"
      wanted+=("$1")
      ;;
  esac
  shift
done
if [[ ${#wanted[@]} == 0 ]]; then
  usage
  exit 0
fi
[[ $limit =~ ^[1-9][0-9]*$ ]] || refuse "--limit: '$limit' is no number of seconds"
for programs in "$programs" "$here" "$here/../../build/release/bench_gpu"; do
  [[ -n $programs && -x $programs/bench_gpu ]] && break
done
mkdir -p "$out"
out=$(cd "$out" && pwd)
[[ ${wanted[*]} != pack ]] || { pack && exit 0; }
[[ -x $programs/bench_gpu && -x $programs/compare_devices ]] ||
  refuse "bench_gpu and compare_devices are not in $here; cmake --build --preset release --target bench_gpu_folder"
programs=$(cd "$programs" && pwd)

prepare_libegl
prepare_nvidia_vendor
prepare_libstdcxx
# Pictures are proved right before any is timed.
[[ " ${wanted[*]} " == *' compare '* || ${wanted[*]} == device ]] || is_done compare || wanted=(compare "${wanted[@]}")
status=0
to_run=()
for part in "${wanted[@]}"; do
  [[ $part == pack ]] || to_run+=("$part")
done
run_parts "${to_run[@]}" || status=$?
[[ " ${wanted[*]} " != *' pack '* ]] || (pack)
exit "$status"
