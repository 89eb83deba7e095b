"""A man page (man(7)) of what --help says."""
import re


def text(line):
    """`line` in a page: nothing in it is a command of roff's."""
    line = line.replace("\\", "\\e").replace("-", "\\-").replace("'", "\\(aq")
    return "\\&" + line if line.startswith(".") else line


def head_of(entry):
    names = ", ".join(f"\\fB{text(name)}\\fR" for name in entry.names)
    return f"{names} \\fI{text(entry.value)}\\fR" if entry.value else names


def facts_of(entry):
    facts = []
    if entry.allowed:
        facts.append(entry.allowed if entry.allowed.startswith("in ") else
                     "one of " + ", ".join(entry.allowed.strip("{}").split(",")))
    if entry.default:
        facts.append("default " + entry.default)
    facts += entry.notes
    if entry.environment:
        facts.append("environment " + entry.environment)
    return facts


def section(title, entries):
    lines = [".SH " + text(title.upper())]
    for entry in entries:
        lines += [".TP", head_of(entry)]
        for index, line in enumerate(entry.lines):
            lines += [".br"] * (index > 0) + [text(line.strip())]
        if facts := facts_of(entry):
            lines += [".br"] * bool(entry.lines) + [text("(" + "; ".join(facts) + ")")]
    return lines


def synopsis(help):
    bold = re.sub(r"--[a-z-]+", lambda found: f"\\fB{text(found.group())}\\fR", help.usage)
    return f"\\fB{text(help.name)}\\fR {bold}"


def man_page(help, version, also):
    """`also`: the names of other pages."""
    lines = ['.\\" Made of the program\'s own --help by deploy/manual; changes belong there.',
             f'.TH "{help.page.upper()}" 1 "" "scancast {version}" "User Commands"',
             ".SH NAME", f"{text(help.page)} \\- {text(help.description.split('. ')[0].rstrip('.'))}",
             ".SH SYNOPSIS", synopsis(help), ".SH DESCRIPTION", text(help.description)]
    for title, entries in help.groups.items():
        lines += section({"Positionals": "Arguments"}.get(title, title), entries)
    if help.footer:
        lines += [".SH NOTES", ".nf"] + [text(line) for line in help.footer] + [".fi"]
    lines += [".SH SEE ALSO", ",\n".join(f"\\fB{text(name)}\\fR(1)" for name in also)]
    return "\n".join(lines) + "\n"
