#!/usr/bin/env bash
# Runs gpu_day.sh where there is nothing: the folder that bench_gpu_folder makes, copied into a root with the C library, bash
# and coreutils, no /proc, no /dev but null, no libEGL. Needs to be root, or user namespaces; leaves nothing behind.
#
#   tests/bench/bare_root.sh [FOLDER]      build/release/bench_gpu by default
#
# All runs are --quick: without a driver (a sentence, exit code 3); without even the libEGL that is carried along (the same);
# on the cpu device (0); with Mesa's rasteriser but the carried libEGL (0); and with Mesa's library under the name and in
# the place of NVIDIA's, where only gpu_day.sh finds it, with and without a vendor file there (0).
set -euo pipefail

folder=${1:-$(cd "$(dirname "${BASH_SOURCE[0]}")/../.." && pwd)/build/release/bench_gpu}
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT

# A file and the libraries that it needs, under the names they have here.
copy() {
  local file
  for file in "$@" $(ldd "$@" 2>/dev/null | while read -r first second third _; do
    if [[ $second == '=>' && $third == /* ]]; then echo "$third"; elif [[ $first == /*.so* && $first != *: ]]; then echo "$first"; fi
  done); do
    [[ -e $root$file ]] || { mkdir -p "$root$(dirname "$file")" && cp -L "$file" "$root$file"; }
  done
}

libraries=/lib/$(uname -m)-linux-gnu
mkdir -p "$root"/{dev,tmp,usr/bin,usr/lib,usr/lib64,usr/sbin}
for folder_link in bin lib lib64 sbin; do ln -s "usr/$folder_link" "$root/$folder_link"; done
for tool in bash cat date dirname env head ls mkdir nproc rm rmdir stat tail tee timeout uname; do
  copy "$(command -v "$tool")"
done
copy "$libraries"/lib{c,m,dl,pthread,rt}.so.[0-9]
: >"$root/dev/null"
chmod 666 "$root/dev/null"
cp -r "$folder" "$root/bench_gpu"

enter=(chroot)
[[ $(id -u) == 0 ]] || enter=(unshare --map-root-user chroot)
failures=0
# expect CODE WORDS...: the script ends with CODE in the bare root.
expect() {
  local wanted=$1 status=0
  shift
  printf '\n--- %s\n' "gpu_day.sh $*"
  rm -rf "$root/results"
  "${enter[@]}" "$root" /usr/bin/env -i PATH=/bin:/usr/bin /bench_gpu/gpu_day.sh --quick --out /results "$@" >"$root/screen" 2>&1 || status=$?
  grep -E '^(Part|- lib|- EGL|Of [0-9]+|egl:|cpu:|dlopen|gpu_day|egl)|libEGL|no EGL' "$root/screen" "$root"/results/*.md -h -s | sort -u |
    cut -c 1-220 || true
  echo "exit code $status, expected $wanted"
  [[ $status == "$wanted" ]] || { failures=$((failures + 1)); cat "$root/screen"; }
}

expect 3 all
mv "$root/bench_gpu/egl" "$root/egl_aside"
expect 3 all
mv "$root/egl_aside" "$root/bench_gpu/egl"
expect 0 --backend cpu all
if [[ -e $libraries/libEGL_mesa.so.0 && -e $libraries/dri/swrast_dri.so ]]; then
  copy "$libraries/libEGL_mesa.so.0" "$libraries/dri/swrast_dri.so"
  vendors=$root/usr/share/glvnd/egl_vendor.d nvidia=$root/usr/local/nvidia
  mkdir -p "$vendors" "$nvidia/lib64" "$nvidia/share/glvnd/egl_vendor.d"
  cp /usr/share/glvnd/egl_vendor.d/*mesa*.json "$vendors"
  rm -f "$root"/usr/lib/*/libEGL.so.1
  expect 0 all
  rm -r "$vendors"
  mv "$root$libraries/libEGL_mesa.so.0" "$nvidia/lib64/libEGL_nvidia.so.0"
  expect 0 device
  mv "$root/results/10_nvidia.json" "$nvidia/share/glvnd/egl_vendor.d"
  expect 0 device
else
  echo "Mesa's rasteriser is not here: not tried"
fi
exit "$((failures > 0))"
