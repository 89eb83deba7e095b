#!/usr/bin/python3
"""Makes the pictures and tables of docs/papers: runs every command that its pages show, and puts in place what they print.

    tests/bench/papers.py [--bin build/release/bin] [--bench build/bench/bench] [--scans ../shared/data]
                          [--work FOLDER] [--only voronoi.md,…] [--pictures-only] [--check]

A page's commands are its ```sh blocks, run by one shell from the first to the last, after those of README.md, which make
the clouds. What a block prints takes the place of what stands between "<!-- what it printed -->" and "<!-- end -->" behind
it. --work keeps the clouds for the next time; --pictures-only leaves out blocks that print. A page that fails, because a
scan is missing or anything else, is named, keeps its old pictures and tables, and the end is 1.
--check runs nothing: each page's pictures are all there and named by a command, and each picture belongs to a page.
"""
import argparse
import os
import pathlib
import re
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
PAGES = ROOT / "docs" / "papers"
PICTURES = ROOT / "docs" / "images" / "papers"
BLOCK = re.compile(r"```sh\n(.*?)```\n(?:\n<!-- what it printed -->\n(.*?)<!-- end -->\n)?", re.S)
SHOWN = re.compile(r"\]\(\.\./images/papers/([^)]+)\)")
WRITTEN = re.compile(r"\$pictures/([^\"\s]+)")
LARGEST = 60_000  # bytes of a picture
QUALITIES = (82, 70, 55, 40)


def script(text, work, number, pictures_only):
    """All blocks of a page; what each prints, in a file of its own."""
    lines = ["set -eu -o pipefail"]
    for i, block in enumerate(BLOCK.finditer(text)):
        if pictures_only and block.group(2) is not None:
            continue
        lines += ["{", block.group(1).rstrip(), f"}} > {work}/printed-{number}-{i}"]
    return "\n".join(lines)


def with_output(text, work, number):
    """The page with what its blocks printed."""
    count = iter(range(len(BLOCK.findall(text))))

    def placed(block):
        i = next(count)
        file = pathlib.Path(work) / f"printed-{number}-{i}"
        if block.group(2) is None or not file.exists():
            return block.group(0)
        printed = file.read_text().strip()
        if not printed.startswith("|"):
            printed = "```\n" + printed + "\n```"
        return f"```sh\n{block.group(1)}```\n\n<!-- what it printed -->\n{printed}\n<!-- end -->\n"

    return BLOCK.sub(placed, text)


def smaller(work):
    """Prepended to the path as `scancast`: pictures at the first quality that is small enough for a page."""
    wrapper = pathlib.Path(work) / "bin" / "scancast"
    wrapper.parent.mkdir(exist_ok=True)
    wrapper.write_text(f"""#!/usr/bin/env bash
set -eu
if [ "$1" != render ] || [[ " $* " != *" -o "* ]]; then exec "$SCANCAST" "$@"; fi
while [ $# -gt 0 ]; do
    args+=("$1")
    if [ "$1" = -o ]; then file=$2; fi
    shift
done
for quality in {' '.join(map(str, QUALITIES))}; do
    "$SCANCAST" "${{args[@]}}" --quality "$quality"
    if [ "$(wc -c < "$file")" -le {LARGEST} ]; then break; fi
done
""")
    wrapper.chmod(0o755)
    return wrapper.parent


def run(options, work, setting, page, number):
    """None, or why not."""
    text = page.read_text()
    done = subprocess.run(["bash", "-c", script(text, work, number, options.pictures_only)], cwd=work, env=setting, check=False,
                          stderr=subprocess.PIPE, text=True)
    if done.returncode != 0:
        return (done.stderr.strip().splitlines() or [f"it ended with {done.returncode}"])[-1]
    page.write_text(with_output(text, work, number))
    return None


def check(pages):
    """What is wrong with the pages, in lines."""
    wrong, all_shown = [], set()
    for page in pages:
        text = page.read_text()
        commands = "".join(block.group(1) for block in BLOCK.finditer(text))
        # "$pictures/shape-$method.jpg" writes whatever begins and ends like it.
        written = [re.compile(re.sub(r"\\\$\\?\{?\w+\\?\}?", ".+", re.escape(name)) + "$") for name in WRITTEN.findall(commands)]
        for name in SHOWN.findall(text):
            all_shown.add(name)
            if not (PICTURES / name).exists():
                wrong.append(f"{page.name}: there is no picture {name}")
            if not any(pattern.match(name) for pattern in written):
                wrong.append(f"{page.name}: no command makes {name}")
        for block in BLOCK.finditer(text):
            if block.group(2) is not None and not block.group(2).strip():
                wrong.append(f"{page.name}: nothing stands where a command's output belongs: {block.group(1).splitlines()[0]}")
    for name in sorted(p.name for p in PICTURES.iterdir()) if PICTURES.exists() else []:
        if name not in all_shown:
            wrong.append(f"{name}: no page shows this picture")
    return wrong


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--bin", type=pathlib.Path, default=ROOT / "build/release/bin")
    parser.add_argument("--bench", type=pathlib.Path, default=ROOT / "build/bench/bench")
    parser.add_argument("--scans", type=pathlib.Path, default=ROOT / "../shared/data")
    parser.add_argument("--work", type=pathlib.Path)
    parser.add_argument("--only", default="")
    parser.add_argument("--pictures-only", action="store_true")
    parser.add_argument("--check", action="store_true")
    options = parser.parse_args()
    pages = sorted(page for page in PAGES.glob("*.md") if page.name != "README.md")
    if options.check:
        wrong = check(pages)
        print("\n".join(wrong) or f"{len(pages)} pages, whose pictures are all there")
        return 1 if wrong else 0
    wanted = [name for name in options.only.split(",") if name]
    if unknown := set(wanted) - {page.name for page in pages}:
        sys.exit(f"papers.py: no such page: {', '.join(sorted(unknown))}")
    failed = 0
    with tempfile.TemporaryDirectory() as own:
        work = options.work.resolve() if options.work else pathlib.Path(own)
        work.mkdir(parents=True, exist_ok=True)
        PICTURES.mkdir(parents=True, exist_ok=True)
        path = [smaller(work), options.bin.resolve(), options.bench.resolve(), os.environ["PATH"]]
        setting = {**os.environ, "PATH": ":".join(map(str, path)), "SCANCAST": str(options.bin.resolve() / "scancast"),
                   "scans": str(options.scans.resolve()), "pictures": str(PICTURES)}
        clouds = PAGES / "README.md"
        if not (work / "clouds-are-made").exists():
            if why := run(options, work, setting, clouds, 0):
                sys.exit(f"papers.py: the clouds cannot be made: {why}")
            (work / "clouds-are-made").touch()
        for number, page in enumerate(pages, 1):
            if wanted and page.name not in wanted:
                continue
            print(page.name, file=sys.stderr, flush=True)
            if why := run(options, work, setting, page, number):
                print(f"papers.py: {page.name} stays as it was: {why}", file=sys.stderr)
                failed = 1
    return failed


if __name__ == "__main__":
    sys.exit(main())
