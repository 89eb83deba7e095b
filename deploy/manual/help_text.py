"""What a program's --help says, as data: man pages and completions are made of that, so there is nothing that could be
forgotten in them. Reads the layout that CLI11 prints, and the few lines that importers print.
"""
import re
import subprocess
from dataclasses import dataclass, field

DESCRIPTION_COLUMN = 30  # where CLI11 writes what an entry means


@dataclass
class Entry:
    """An option, an argument or a subcommand."""
    names: list  # "-o", "--output"; of arguments and subcommands one
    value: str = ""  # what stands for its value: "FILE"; empty for a flag that takes none
    allowed: str = ""  # "in [0 - 65535]", "{auto,cpu}"
    default: str = ""
    environment: str = ""
    notes: list = field(default_factory=list)  # "required", "excludes --decide"
    lines: list = field(default_factory=list)  # what it means

    @property
    def summary(self):
        return self.lines[0] if self.lines else ""

    def choices(self):
        """The words that its value may be, where there are a few."""
        named = re.search(r"\{(.*)\}", self.allowed)
        words = named.group(1).split(",") if named else self.value.split("|") if "|" in self.value else []
        return [word for word in words if re.fullmatch(r"[a-z0-9][a-z0-9:.]*", word)]

    def is_folder(self):
        return bool(re.search(r"\b(FOLDER|DIR)\b", self.value))

    def is_file(self):
        return self.is_folder() or bool(re.search(r"\b(FILE|VIDEO|PATH)\b", self.value)) or "-o" in self.names


@dataclass
class Help:
    """A program, or one of its subcommands."""
    name: str  # as it is typed: "scancast serve"
    description: str
    usage: str  # what comes behind the name
    groups: dict  # title: entries
    footer: list  # lines
    subcommands: list = field(default_factory=list)  # Help

    @property
    def page(self):
        return self.name.replace(" ", "-")

    @property
    def options(self):
        return [entry for entries in self.groups.values() for entry in entries if entry.names[0].startswith("-")]

    @property
    def arguments(self):
        return self.groups.get("Positionals", [])


def entry_of(head):
    """`head`: what stands left of the meaning, as "--port PORT:INT in [0 - 65535]=8080 (Env:SCANCAST_PORT)"."""
    entry = Entry([])
    def take(pattern):
        nonlocal head
        found = re.search(pattern, head)
        if found:
            head = (head[:found.start()] + " " + head[found.end():]).strip()
        return found
    if found := take(r"\(Env:(\w+)\)"):
        entry.environment = found.group(1)
    for word in ("Excludes", "Needs"):
        if found := take(rf"\b{word}: ((?:--\S+ ?)+)"):
            entry.notes.append(f"{word.lower()} {found.group(1).strip()}")
    if take(r"\bREQUIRED\b"):
        entry.notes.append("required")
    if take(r" \.\.\."):
        entry.notes.append("may be several")
    names, _, value = head.partition(" ")
    entry.names = names.split(",")
    # NAME=PATH is how a value is written; =8080 is a default.
    found = re.fullmatch(r"(.*?)=((?![A-Z]+$).+)", value)
    if found:
        value, entry.default = found.groups()
    found = re.fullmatch(r"([^:{]*?)(?::(?:\w+)?)?\s*(in \[.*\]|\{.*\})?", value)
    if found and ":" in value:
        value, entry.allowed = found.group(1), found.group(2) or ""
    entry.value = value.strip()
    return entry


def entries_of(lines):
    entries = []
    for line, after in zip(lines, lines[1:] + [""]):
        head, meaning = line[:DESCRIPTION_COLUMN], line[DESCRIPTION_COLUMN:]
        if head.startswith("   "):
            entries[-1].lines.append(meaning.rstrip() if head.isspace() else line.strip())
            continue
        # A head that reaches into the column of meanings has its own on the next line; one that ends just before it
        # has not.
        apart = head.endswith("  ") or (head.endswith(" ") and not after.startswith(" " * DESCRIPTION_COLUMN))
        entries.append(entry_of((head if apart else line).strip()))
        if apart and meaning.strip():
            entries[-1].lines.append(meaning.rstrip())
    return entries


def is_group(block):
    title, entries = block[0], block[1:]
    return (re.fullmatch(r"\S.*:", title) and entries and
            (title in ("Positionals:", "Subcommands:") or entries[0].startswith("  -")))


def parse(name, text):
    """`text`: what NAME --help printed."""
    head, found, rest = text.partition("\nUsage: ")
    if not found:
        raise ValueError(f"{name} --help has no line that begins with \"Usage: \":\n{text}")
    usage, _, rest = rest.partition("\n")
    help = Help(name, head.strip(), re.sub(r"^\S+( [a-z-]+)?(?= |$)", "", usage).strip(), {}, [])
    blocks = [block.split("\n") for block in re.split(r"\n{2,}", rest.strip("\n"))]
    while blocks and is_group(blocks[0]):
        title, *lines = blocks.pop(0)
        help.groups[title.rstrip(":")] = entries_of(lines)
    for block in blocks:
        help.footer += ([""] if help.footer else []) + block
    return help


def parse_importer(name, text):
    """An importer's: its usage, and sentences."""
    usage, *sentences = text.strip().split("\n")
    if not usage.startswith(name + " "):
        raise ValueError(f"{name} --help does not begin with its usage:\n{text}")
    prose = " ".join(line for line in sentences if not line.startswith(" "))
    description, _, example = prose.rpartition(". ")
    options = {"Options": [Entry([word]) for word in re.findall(r"\[(--\S+)\]", usage)]}
    help = Help(name, description + ".", usage[len(name) + 1:], options if options["Options"] else {}, [])
    help.footer = [example] + [line for line in sentences if line.startswith(" ")]
    return help


class Missing(Exception):
    """What the program needs to run at all is not installed."""


def ask(program, *words):
    done = subprocess.run([program, *words, "--help"], capture_output=True, text=True, timeout=60)
    if done.returncode == 127:
        raise Missing(f"{program}: {done.stderr.strip()}")
    if done.returncode:
        raise RuntimeError(f"{program} {' '.join(words)} --help ended with {done.returncode}: {done.stderr}")
    return done.stdout


def ask_importer(program):
    """Importers write points to standard output, so one may say on the other what it is for."""
    done = subprocess.run([program, "--help"], capture_output=True, text=True, timeout=60)
    if done.returncode == 127:
        raise Missing(f"{program}: {done.stderr.strip()}")
    return done.stdout or done.stderr


def help_of(program, name):
    """Of the program at that path, and of each of its subcommands."""
    if name.startswith("scancast-import-"):
        return parse_importer(name, ask_importer(program))
    help = parse(name, ask(program))
    for entry in help.groups.get("Subcommands", []):
        word = entry.names[0]
        help.subcommands.append(parse(f"{name} {word}", ask(program, word)))
    return help
