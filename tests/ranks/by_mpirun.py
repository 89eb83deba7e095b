"""Starting ranks, for the tests beside this file."""
import os


def by_ranks(count, *command):
    """As many as asked for, whatever there is; not as one who may not."""
    may = ["--allow-run-as-root"] if os.geteuid() == 0 else []
    return ["mpirun", *may, "--quiet", "--oversubscribe", "--bind-to", "none", "-n", str(count), *command]
