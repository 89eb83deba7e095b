"""Man pages and completions of programs, from what their --help says.

    make_manual.py VERSION OUTPUT_FOLDER PROGRAM…

PROGRAM: a path; its file's name is the program's. Writes OUTPUT_FOLDER/man1, /bash, /zsh and /fish, the same files
from the same help, and, when no program lacked what it needs to run, OUTPUT_FOLDER/made.
"""
import os
import sys

import completions
from help_text import Missing, help_of
from man_page import man_page


def write(folder, name, text):
    os.makedirs(folder, exist_ok=True)
    with open(os.path.join(folder, name), "w", encoding="utf-8") as file:
        file.write(text)


def make(version, output, program):
    name = os.path.basename(program)
    help = help_of(program, name)
    pages = [help, *help.subcommands]
    family = [page.page for page in pages]
    for page in pages:
        also = [one for one in family if one != page.page] or ["scancast"]
        write(os.path.join(output, "man1"), page.page + ".1", man_page(page, version, also))
    if help.subcommands:  # importers are started by the server
        write(os.path.join(output, "bash"), name, completions.bash(help))
        write(os.path.join(output, "zsh"), "_" + name, completions.zsh(help))
        write(os.path.join(output, "fish"), name + ".fish", completions.fish(help))


def main(version, output, *programs):
    complete = True
    for program in programs:
        try:
            make(version, output, program)
        except Missing as missing:  # Node.js or its modules, which a build can do without
            print(f"No man page of {missing}", file=sys.stderr)
            complete = False
    if complete:
        write(output, "made", "")


if __name__ == "__main__":
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    main(*sys.argv[1:])
