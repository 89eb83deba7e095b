#!/usr/bin/python3
"""What the link costs ranks that draw together (scancast-ranks render): a network of this machine's own, as fast as told, held against the model.

    sudo tests/bench/ranks/shaped_links.py --cloud town.scan --bin build/release/bin [--ranks 4] [--gbit 1,2.5,10] [--methods point,hqs]

Each rank is in a network namespace of its own (ip netns), joined to a bridge by a link that lets through so many Gbit/s each way (tc, token bucket);
mpirun starts them there, and they have nothing but TCP between them. Needs root, iproute2, and a kernel that has namespaces, veth and tbf: where
one is missing that is said, and nothing is measured. Nothing of it is left afterwards, nor does it touch the machine's own network.

For each method and rate it prints a picture's median with the link as wide as this machine makes it (no shaping), the same with the link that narrow,
and how much longer that took beside what it must: what rank 0 sends or gets, whichever is more, over the rate, as the model (model.py) reckons. Only what the narrow link adds is compared, since
ranks on one machine share its cores, and copying by TCP costs them more than a network card would.
"""
import argparse
import json
import os
import shutil
import stat
import subprocess
import sys
import tempfile

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import model

NAME = "scancast-rank"  # of namespaces; a hub and one for each rank
ADDRESS = "10.203.77."


def run(*command):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode != 0:
        raise RuntimeError(f"`{' '.join(command)}`: {done.stdout.strip()}")


class Network:
    """Ranks' namespaces, until the end of a `with`."""

    def __init__(self, ranks):
        self.ranks = ranks

    def __enter__(self):
        self.remove()
        try:
            run("ip", "netns", "add", f"{NAME}-hub")
            run("ip", "-n", f"{NAME}-hub", "link", "add", "bridge", "type", "bridge")
            run("ip", "-n", f"{NAME}-hub", "link", "set", "bridge", "up")
            for rank in range(self.ranks):
                space = f"{NAME}-{rank}"
                run("ip", "netns", "add", space)
                run("ip", "link", "add", "name", "eth", "netns", space, "type", "veth", "peer", "name", f"port{rank}", "netns", f"{NAME}-hub")
                run("ip", "-n", f"{NAME}-hub", "link", "set", f"port{rank}", "master", "bridge", "up")
                run("ip", "-n", space, "address", "add", f"{ADDRESS}{rank + 1}/24", "dev", "eth")
                run("ip", "-n", space, "link", "set", "eth", "up")
                run("ip", "-n", space, "link", "set", "lo", "up")
        except (RuntimeError, OSError):
            self.remove()
            raise
        return self

    def __exit__(self, *_):
        self.remove()

    def remove(self):
        for rank in ["hub", *range(self.ranks)]:
            subprocess.run(["ip", "netns", "delete", f"{NAME}-{rank}"], stderr=subprocess.DEVNULL)

    def shape(self, gbit):
        """Both ways of each rank's link; None: as fast as memory."""
        for rank in range(self.ranks):
            for space, device in ((f"{NAME}-{rank}", "eth"), (f"{NAME}-hub", f"port{rank}")):
                subprocess.run(["tc", "-n", space, "qdisc", "delete", "dev", device, "root"], stderr=subprocess.DEVNULL)
                if gbit:  # the bucket holds what passes in a millisecond: less, and timers make the link slower than it says
                    run("tc", "-n", space, "qdisc", "add", "dev", device, "root", "tbf", "rate", f"{gbit}gbit",
                        "burst", str(max(64_000, int(gbit * model.GBIT / 1000))), "limit", str(8_000_000))

    def mpirun(self, folder):
        """The command up to the program's name: each rank in its own namespace, under a host name of its own."""
        agent = os.path.join(folder, "agent")
        with open(agent, "w") as script:
            script.write(f"#!/bin/sh\n# mpirun's way to another machine: ADDRESS COMMAND…\nrank=$((${{1##*.}} - 1)); shift\n"
                         f"exec ip netns exec {NAME}-$rank unshare --uts sh -c \"hostname rank$rank; $*\"\n")
        os.chmod(agent, stat.S_IRWXU)
        hosts = os.path.join(folder, "hosts")
        with open(hosts, "w") as file:
            file.writelines(f"{ADDRESS}{rank + 1} slots=1\n" for rank in range(self.ranks))
        only = f"{ADDRESS}0/24"
        return ["ip", "netns", "exec", f"{NAME}-0", "unshare", "--uts", "sh", "-c", "hostname rank0; exec \"$@\"", "sh",
                "mpirun", "--allow-run-as-root", "--quiet", "--bind-to", "none", "--hostfile", hosts, "-n", str(self.ranks), "--map-by", "node",
                "--mca", "plm_rsh_agent", agent, "--mca", "btl", "self,tcp", "--mca", "btl_tcp_if_include", only,
                "--mca", "oob_tcp_if_include", only]


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--cloud", required=True)
    parser.add_argument("--bin", required=True, help="the folder with scancast-ranks")
    parser.add_argument("--ranks", type=int, default=4)
    parser.add_argument("--gbit", default="1,2.5,10")
    parser.add_argument("--methods", default="point,hqs,ewa")
    parser.add_argument("--repeat", type=int, default=15)
    parser.add_argument("--rounds", type=int, default=3, help="the best of so many is taken")
    parser.add_argument("--width", type=int, default=1280)
    parser.add_argument("--height", type=int, default=720)
    arguments = parser.parse_args()
    program = os.path.basename(sys.argv[0])
    if os.geteuid() != 0:
        sys.exit(f"{program}: namespaces and their links are root's to make: start it with sudo.")
    if missing := [tool for tool in ("ip", "tc", "unshare", "mpirun") if not shutil.which(tool)]:
        sys.exit(f"{program}: {', '.join(missing)} missing (Debian: iproute2, util-linux, openmpi-bin).")
    size = (arguments.width, arguments.height)
    try:
        with tempfile.TemporaryDirectory() as folder, Network(arguments.ranks) as network:
            ranks = [*network.mpirun(folder), os.path.abspath(os.path.join(arguments.bin, "scancast-ranks")), "render",
                     os.path.abspath(arguments.cloud), "--threads", "1", "--repeat", str(arguments.repeat), "--orbit", "0.01"]

            def best(method):
                runs = [model.rendered(ranks, method, size) for _ in range(arguments.rounds)]
                return min(runs, key=lambda run: run["medianMs"])

            print(f"{arguments.ranks} ranks, {size[0]} x {size[1]}, one sample a pixel; medians in ms\n")
            print("| method | MB of rank 0, the way with more | link | a picture | more than unshaped | the model's bytes over rate |\n|---|---|---|---|---|---|")
            for method in arguments.methods.split(","):
                network.shape(None)
                wide = best(method)
                megabytes = max(wide["bytesSentPerFrame"], wide["bytesReceivedPerFrame"]) / 1e6
                print(f"| `{method}` | {megabytes:.1f} | memory | {wide['medianMs']:.1f} | | |", flush=True)
                for gbit in (float(rate) for rate in arguments.gbit.split(",")):
                    network.shape(gbit)
                    narrow = best(method)
                    reckoned = 1000 * max(wide["bytesSentPerFrame"], wide["bytesReceivedPerFrame"]) / (gbit * model.GBIT)
                    print(f"| `{method}` | {megabytes:.1f} | {gbit:g} Gbit/s | {narrow['medianMs']:.1f} | "
                          f"{narrow['medianMs'] - wide['medianMs']:+.1f} | {reckoned:.1f} |", flush=True)
    except RuntimeError as problem:
        sys.exit(f"{program}: this kernel or its rights do not allow it: {problem}")


if __name__ == "__main__":
    main()
