# Part of gpu_day.sh: finds libEGL, the driver's vendor file and the C++ library, wherever installers and containers have
# put them, and tells in egl_notes what it found. Sets LD_LIBRARY_PATH, __EGL_VENDOR_LIBRARY_FILENAMES and preload.
# shellcheck shell=bash disable=SC2034,SC2154  # preload is read, out and programs are set by gpu_day.sh

# What the loader finds by itself; nothing where there is no ldconfig.
loader_cache=$({ ldconfig -p || /sbin/ldconfig -p; } 2>/dev/null || true)

# Prints the folder of a shared library that the loader does not search by itself, or nothing where it does. Fails where
# there is no such library.
folder_of_library() {
  local name=$1 line folder
  local -a searched=()
  while read -r line; do
    # 64-bit libraries are listed as "libEGL.so.1 (libc6,x86-64) => …".
    [[ $line == "$name (libc6,"* ]] && return 0
  done <<<"$loader_cache"
  IFS=: read -r -a searched <<<"${LD_LIBRARY_PATH:-}"
  for folder in "${searched[@]}" /lib/"$(uname -m)"-linux-gnu /usr/lib/"$(uname -m)"-linux-gnu /lib64 /usr/lib64 \
    /usr/lib /usr/local/lib /usr/local/lib64 /usr/local/*/lib64 /usr/local/*/lib /usr/lib/nvidia* \
    /usr/lib/"$(uname -m)"-linux-gnu/nvidia* /opt/*/lib64 /run/opengl-driver/lib; do
    if [[ -n $folder && -e $folder/$name ]]; then
      printf '%s\n' "$folder"
      return 0
    fi
  done
  return 1
}

search_also() {
  [[ -z $1 ]] || export LD_LIBRARY_PATH="$1${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
}

prepare_libegl() {
  local folder
  if folder=$(folder_of_library libEGL.so.1); then
    search_also "$folder"
    egl_notes+=("libEGL: this machine's${folder:+, in $folder}")
  elif [[ -e $programs/egl/libEGL.so.1 ]]; then
    search_also "$programs/egl"
    egl_notes+=("libEGL: this machine has none; the one that was carried along")
  else
    egl_notes+=("libEGL: this machine has none, and none was carried along")
  fi
}

# NVIDIA's driver is found by a file that names its library; installations differ in where, or leave it out.
prepare_nvidia_vendor() {
  local folder file
  if [[ -n ${__EGL_VENDOR_LIBRARY_FILENAMES:-}${__EGL_VENDOR_LIBRARY_DIRS:-} ]]; then
    egl_notes+=("EGL vendor file: as the environment says")
    return
  fi
  if ! folder=$(folder_of_library libEGL_nvidia.so.0); then
    egl_notes+=("EGL vendor file: libEGL_nvidia.so.0 is not on this machine; other drivers only")
    compgen -G '/dev/nvidia[0-9]*' >/dev/null && egl_notes+=("There is an NVIDIA card, but no EGL of its driver: a \
container needs NVIDIA_DRIVER_CAPABILITIES=graphics,utility")
    return 0
  fi
  search_also "$folder"
  for file in /etc/glvnd/egl_vendor.d/*nvidia*.json /usr/share/glvnd/egl_vendor.d/*nvidia*.json; do
    if [[ -e $file ]]; then
      egl_notes+=("EGL vendor file: $file")
      return
    fi
  done
  for file in /usr/local/share/glvnd/egl_vendor.d/*nvidia*.json /usr/local/*/share/glvnd/egl_vendor.d/*nvidia*.json \
    /opt/*/share/glvnd/egl_vendor.d/*nvidia*.json /run/opengl-driver/share/glvnd/egl_vendor.d/*nvidia*.json ''; do
    [[ -e $file ]] && break
  done
  if [[ -z $file ]]; then
    file=$out/10_nvidia.json
    printf '{"file_format_version": "1.0.0", "ICD": {"library_path": "libEGL_nvidia.so.0"}}\n' >"$file"
  fi
  export __EGL_VENDOR_LIBRARY_FILENAMES=$file
  egl_notes+=("EGL vendor file: $file")
}

# The programs bring their own libstdc++, which may be older than what a driver of this machine was built with: where
# they start with this machine's, that one is used.
prepare_libstdcxx() {
  local folder line library=
  folder=$(folder_of_library libstdc++.so.6) || return 0
  [[ -z $folder ]] || library=$folder/libstdc++.so.6
  while read -r line; do
    [[ -z $library && $line == "libstdc++.so.6 (libc6,"* ]] && library=${line##* => }
  done <<<"$loader_cache"
  if [[ -n $library ]] && LD_PRELOAD=$library "$programs/bench_gpu" --help >/dev/null 2>&1; then
    preload=$library
  fi
}
