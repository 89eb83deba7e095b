#!/usr/bin/python3
"""Pictures by ranks beside one process' with as many threads, in turn on this machine: the table "Against one process" of docs/scaling.md.

    tests/bench/ranks/against_one.py --cloud autzen.scan --bin build/release/bin [--ranks 2] [--methods point,hqs,ewa] [--before "chrt -r 5"]

Each round draws by one process and by the ranks, one thread each, the same views, and looks whether the last picture is the same bytes. Of the rounds'
medians the best counts: others use this machine, too. --before is put before both commands: with `chrt -r 5`, as root, others wait meanwhile, and the
figures are those of a quiet machine.
"""
import argparse
import filecmp
import os
import shlex
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import model


def drawn(command, arguments, method, output, more):
    stats = model.rendered([*shlex.split(arguments.before), *command], method, (arguments.width, arguments.height),
                           ("--repeat", str(arguments.repeat), "--orbit", "0.01", *more, "-o", output))
    stages = {stage["name"]: stage["medianMs"] for stage in stats["stages"]}
    # One process tells the time of its encoding, too.
    return stats["medianMs"] - stages.pop("encode", 0), stages, stats


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cloud", required=True, help="a cloud file")
    parser.add_argument("--bin", default="build/release/bin", help="folder of the programs")
    parser.add_argument("--methods", default="point,paraboloid,hqs,ewa,pyramid")
    parser.add_argument("--ranks", type=int, default=2)
    parser.add_argument("--width", type=int, default=1280)
    parser.add_argument("--height", type=int, default=720)
    parser.add_argument("--repeat", type=int, default=25, help="pictures of a run, whose median counts")
    parser.add_argument("--rounds", type=int, default=5)
    parser.add_argument("--before", default="", help="a command that starts the others")
    parser.add_argument("--mpirun", default="mpirun --oversubscribe --bind-to none")
    arguments = parser.parse_args()
    one = [os.path.join(arguments.bin, "scancast"), "render", arguments.cloud, "--backend", "cpu"]
    ranks = [*shlex.split(arguments.mpirun), "-n", str(arguments.ranks), os.path.join(arguments.bin, "scancast-ranks"), "render", arguments.cloud]
    print(f"load {os.getloadavg()[0]:.1f}, {arguments.width} x {arguments.height}, one sample a pixel, best of {arguments.rounds} medians of {arguments.repeat}\n")
    print(f"| | one process, {arguments.ranks} threads, ms | {arguments.ranks} ranks, ms | ranks over one | of it waiting | exchanging | collecting | "
          "MB sent by a rank |\n|---|---|---|---|---|---|---|---|")
    with tempfile.TemporaryDirectory() as folder:
        alone, together = os.path.join(folder, "alone.png"), os.path.join(folder, "together.png")
        for method in arguments.methods.split(","):
            rounds = []
            for _ in range(arguments.rounds):
                single = drawn(one, arguments, method, alone, ("--threads", str(arguments.ranks)))
                shared = drawn(ranks, arguments, method, together, ("--threads", "1"))
                if not filecmp.cmp(alone, together, shallow=False):
                    sys.exit(f"{method}: the pictures differ")
                rounds.append((single, shared))
            single = min((single for single, _ in rounds), key=lambda found: found[0])
            shared = min((shared for _, shared in rounds), key=lambda found: found[0])
            stages = shared[1]
            print(f"| `{method}` | {single[0]:.1f} | {shared[0]:.1f} | {shared[0] / single[0]:.2f} | {stages.get('wait', 0):.1f} | "
                  f"{stages.get('reduce', 0):.1f} | {stages.get('collect', 0):.1f} | {shared[2]['bytesSentPerFrame'] / 1e6:.2f} |", flush=True)


if __name__ == "__main__":
    main()
