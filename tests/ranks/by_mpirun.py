"""Starting ranks, for the tests beside this file."""
import os


def by_ranks(count, *command):
    """As many as asked for, whatever there is; not as one who may not."""
    return [*mpirun(), "-n", str(count), *command]


def by_unlike_ranks(commands, folders=()):
    """A rank for each command, each in its folder."""
    ranks = []
    for i, command in enumerate(commands):
        ranks += [":"] * (i > 0) + ["-n", "1"] + (["-wdir", folders[i]] if folders else []) + command
    return [*mpirun(), *ranks]


def mpirun():
    may = ["--allow-run-as-root"] if os.geteuid() == 0 else []
    return ["mpirun", *may, "--quiet", "--oversubscribe", "--bind-to", "none"]
