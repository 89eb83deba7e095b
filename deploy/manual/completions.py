"""Completions for bash, zsh and fish of what --help says."""
import re


def quoted(word):
    """For every one of the three shells."""
    return "'" + word.replace("'", "") + "'"


def commands(help):
    """("", the program) and (subcommand, its help)."""
    return [("", help)] + [(one.name.split()[-1], one) for one in help.subcommands]


def function_of(help):
    return "_" + help.name.replace("-", "_")


def bash(help):
    lines = [f"# {help.name} in bash; made of its --help by deploy/manual.", f"{function_of(help)}() {{",
             "    local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} command= flags",
             "    [ \"$COMP_CWORD\" -gt 1 ] && command=${COMP_WORDS[1]}", "    case \"$command $before\" in"]
    for command, one in commands(help):
        for option in one.options:
            if not option.value:
                continue
            where = "|".join(quoted(f"{command} {name}") for name in option.names)
            if choices := option.choices():
                lines.append(f"        {where}) COMPREPLY=($(compgen -W {quoted(' '.join(choices))} -- \"$word\")); return ;;")
            elif option.is_folder() and not option.value.count("|"):
                lines.append(f"        {where}) compopt -o filenames; COMPREPLY=($(compgen -d -- \"$word\")); return ;;")
            elif option.is_file():
                lines.append(f"        {where}) compopt -o filenames; COMPREPLY=($(compgen -f -- \"$word\")); return ;;")
            else:
                lines.append(f"        {where}) COMPREPLY=(); return ;;")
    lines += ["    esac", "    case \"$command\" in"]
    for command, one in commands(help):
        flags = [name for option in one.options for name in option.names]
        words = " ".join(flags + [entry.names[0] for entry in one.groups.get("Subcommands", [])])
        pattern = quoted(command) if command else "''"
        lines.append(f"        {pattern}) flags={quoted(words)} ;;")
    lines += ["        *) flags= ;;", "    esac",
              "    if [ -z \"$command\" ] || [ \"${word#-}\" != \"$word\" ]; then",
              "        COMPREPLY=($(compgen -W \"$flags\" -- \"$word\"))", "    else",
              "        compopt -o filenames", "        COMPREPLY=($(compgen -f -- \"$word\"))", "    fi", "}",
              f"complete -F {function_of(help)} {help.name}"]
    return "\n".join(lines) + "\n"


def zsh_text(line):
    return re.sub(r"([\[\]:\\])", r"\\\1", line).replace("'", "’")


def zsh_specs(one):
    specs = []
    for option in one.options:
        value = ""
        if option.value:
            choices = option.choices()
            action = ("(" + " ".join(word.replace(":", "\\:") for word in choices) + ")" if choices else
                      "_files -/" if option.is_folder() and "|" not in option.value else
                      "_files" if option.is_file() else "")
            value = f":{zsh_text(option.value)}:{action}"
        for name in option.names:
            specs.append(f"'*{name}[{zsh_text(option.summary)}]{value}'")
    return specs + ["'*:file:_files'"]


def zsh(help):
    lines = [f"#compdef {help.name}", f"# {help.name} in zsh; made of its --help by deploy/manual.",
             "local -a commands=("]
    lines += [f"    '{entry.names[0]}:{zsh_text(entry.summary)}'" for entry in help.groups.get("Subcommands", [])]
    lines += [")", "if (( CURRENT == 2 )); then", "    _describe command commands"]
    lines += [f"    _arguments {' '.join(zsh_specs(help)[:-1])}", "    return", "fi", "case $words[2] in"]
    for command, one in commands(help)[1:]:
        lines += [f"    {command})", "        shift words", "        (( CURRENT-- ))",
                  "        _arguments \\"]
        lines.append(" \\\n".join("            " + spec for spec in zsh_specs(one)) + " ;;")
    return "\n".join(lines + ["esac"]) + "\n"


def fish(help):
    lines = [f"# {help.name} in fish; made of its --help by deploy/manual."]
    words = " ".join(command for command, _ in commands(help)[1:])
    for entry in help.groups.get("Subcommands", []):
        lines.append(f"complete -c {help.name} -n 'not __fish_seen_subcommand_from {words}' -f -a {entry.names[0]} "
                     f"-d {quoted(entry.summary)}")
    for command, one in commands(help):
        where = f"__fish_seen_subcommand_from {command}" if command else f"not __fish_seen_subcommand_from {words}"
        for option in one.options:
            names = " ".join(f"-l {name[2:]}" if name.startswith("--") else f"-s {name[1:]}" for name in option.names)
            value = ""
            if option.value:
                choices = option.choices()
                value = f" -x -a {quoted(' '.join(choices))}" if choices else " -r" if option.is_file() else " -x"
            lines.append(f"complete -c {help.name} -n '{where}' {names}{value} -d {quoted(option.summary)}")
    return "\n".join(lines) + "\n"
