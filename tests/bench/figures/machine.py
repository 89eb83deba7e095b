"""What was measured on, and what was measured: processor, memory, GPU, compiler, libraries, commit, date."""
import datetime
import hashlib
import os
import re
import shutil
import subprocess

ROOT = os.path.normpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", ".."))
PRODUCT = ["CMakeLists.txt", "CMakePresets.json", "cmake", "protocol", "files", "threads", "remote", "transport", "renderer", "simulator", "server", "client/cpp",
           "importers", "ranks"]
LIBRARIES = ("tbb", "turbojpeg", "jpeg", "spng", "zstd", "z", "xxhash", "curl", "ssl", "proj", "tiff", "geotiff", "EGL", "stdc++", "c")


def said(*command):
    """What it prints, or nothing where it cannot."""
    try:
        return subprocess.run(command, check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, timeout=60).stdout.strip()
    except (OSError, subprocess.SubprocessError):
        return ""


def read(path):
    try:
        with open(path, encoding="utf-8", errors="replace") as file:
            return file.read()
    except OSError:
        return ""


def processor(cpuinfo):
    """Of /proc/cpuinfo: its name, and how wide its vectors are, which is what the kernels choose by."""
    field = lambda name: (re.search(rf"(?m)^{name}\s*: (.*)$", cpuinfo) or ("", ""))[1].strip()
    flags = field("flags").split()
    wide = "AVX-512" if "avx512f" in flags else "AVX2" if "avx2" in flags else ""
    family = ", family {} model {}".format(field("cpu family"), field("model")) if field("cpu family") else ""
    return (field("model name") or os.uname().machine) + family + (f", {wide}" if wide else "")


def gpus(scancast):
    """Graphics cards as the program sees them; software drivers are none."""
    text = said(scancast, "--list-backends")
    found = []
    for block in re.split(r"(?m)^(?=--backend=)", text):
        if block.startswith("--backend=egl") and "software" not in block:
            found.append(re.sub(r"\s+", " ", block.split(None, 2)[-1]).strip())
    return found


def machine(scancast):
    kilobytes = int((re.search(r"MemTotal:\s+(\d+)", read("/proc/meminfo")) or (0, 0))[1])
    system = re.search(r'(?m)^PRETTY_NAME="(.*)"', read("/etc/os-release"))
    return {"cpu": processor(read("/proc/cpuinfo")), "cores": len(os.sched_getaffinity(0)), "memoryGB": round(kilobytes / 1e6, 1), "gpus": gpus(scancast),
            "virtual": "hypervisor" in read("/proc/cpuinfo"), "system": f"{system[1] if system else os.uname().sysname}, kernel {os.uname().release}"}


def compiler(build):
    cached = read(os.path.join(build, "CMakeCache.txt"))
    name = re.search(r"(?m)^CMAKE_CXX_COMPILER:\w+=(.*)$", cached)
    kind = re.search(r"(?m)^CMAKE_BUILD_TYPE:\w+=(.*)$", cached)
    if not name:
        return "not told: no CMakeCache.txt beside the programs"
    return said(name[1], "--version").split("\n")[0] + (f", {kind[1]}" if kind else "")


def libraries(scancast):
    """Versions of the shared libraries that the program uses, by their packages where those are known, else by their files' names."""
    files = {}
    for name, path in re.findall(r"lib([\w+]+?)(?:-[\d.]+)?\.so[.\d]* => (\S+)", said("ldd", scancast)):
        if name in LIBRARIES:
            files[name] = os.path.realpath(path)
    owners = owners_of(list(files.values()))
    versions = dict(line.split("\t") for line in said("dpkg-query", "-W", "-f", "${binary:Package}\\t${source:Upstream-Version}\\n", *set(owners.values())).splitlines()) \
        if owners else {}
    return {name: versions.get(owners.get(path)) or re.sub(r".*\.so\.?", "", path) or "?" for name, path in files.items()}


def owners_of(paths):
    """{path: Debian package}. Files beneath /usr/lib are known as /lib where packages are from before both became one."""
    names = [name for path in paths for name in (path, path.removeprefix("/usr"))]
    try:
        text = subprocess.run(["dpkg-query", "-S", *names], stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True, timeout=60, check=False).stdout
    except (OSError, subprocess.SubprocessError):
        return {}
    found = {}
    for line in text.splitlines():
        package, _, path = line.rpartition(": ")
        found[path] = package.split(", ")[0]
    return {path: found.get(path) or found[path.removeprefix("/usr")] for path in paths if path in found or path.removeprefix("/usr") in found}


def commit(root=ROOT):
    """What stands checked out: its hash, its day, and a key that tells changes to the product which are in no commit. Without git: unknown."""
    hash_ = said("git", "-C", root, "rev-parse", "--short=8", "HEAD")
    if not hash_:
        return {"hash": "unknown", "day": "", "key": "unknown", "changed": False}
    changes = said("git", "-C", root, "diff", "HEAD", "--", *PRODUCT)
    key = hash_ + ("+" + hashlib.sha256(changes.encode()).hexdigest()[:8] if changes else "")
    return {"hash": hash_, "day": said("git", "-C", root, "show", "-s", "--format=%cs", "HEAD"), "key": key, "changed": bool(changes)}


def stale(build, targets=("scancast", "scancast-client")):
    """Why the programs of a build folder are not those of this tree, or nothing. The build system knows."""
    rules = os.path.join(os.path.abspath(build), "build.ninja")
    if not os.path.exists(rules) or not shutil.which("ninja"):
        return ""
    # By its whole path: CMake's rules that make build.ninja itself, which look for new files each time, are then none of what is asked.
    text = said("ninja", "-C", build, "-f", rules, "-n", *targets)
    return "" if not text or "no work to do" in text else f"the programs in {build} are not those of this tree: build first (./run.sh --build-only)"


def today():
    return datetime.date.today().isoformat()


def words(about, dates):
    """The page's words for all of it. `dates`: of the sections, first and last."""
    m, c = about["machine"], about["commit"]
    when = dates[0] if dates and dates[0] == dates[-1] else " to ".join((dates[0], dates[-1])) if dates else today()
    cards = "; ".join(m["gpus"]) or "no graphics card"
    libs = ", ".join(f"{name} {version}" for name, version in sorted(about["libraries"].items()))
    made = f"`{c['hash']}`" + (", with changes that are in no commit" if c["changed"] else "")
    return "\n".join([
        "| | |", "|---|---|",
        f"| commit | {made} |",
        f"| measured | {when} |",
        f"| processor | {m['cpu']}; {m['cores']} core{'s' if m['cores'] != 1 else ''}{', a virtual machine' if m['virtual'] else ''} |",
        f"| memory | {m['memoryGB']:g} GB |",
        f"| graphics | {cards} |",
        f"| system | {m['system']} |",
        f"| compiler | {about['compiler']} |",
        f"| libraries | {libs or 'not told'} |"])
