"""Numbers and tables as the page has them."""


def number(value):
    """Three digits that count: 0.0123, 1.23, 12.3, 123, 12,345."""
    if isinstance(value, bool):
        return "yes" if value else "**no**"
    if value is None:
        return "-"
    if isinstance(value, str):
        return value
    size = abs(value)
    if size >= 1000 or value == int(value):
        return f"{value:,.0f}"
    digits = 0 if size >= 100 else 1 if size >= 10 else 2 if size >= 0.1 else 3 if size >= 0.01 else 4
    return f"{value:.{digits}f}"


def with_unit(value, unit=""):
    return f"{number(value)} {unit}".rstrip()


def spread(row):
    """A row's value, and in brackets between what its rounds lay."""
    text = with_unit(row["value"], row.get("unit", ""))
    if "low" in row and "high" in row:
        text += f" ({number(row['low'])} - {number(row['high'])})"
    return text


def table(head, rows):
    """Markdown."""
    lines = ["| " + " | ".join(head) + " |", "|" + "---|" * len(head)]
    lines += ["| " + " | ".join(number(cell) for cell in row) + " |" for row in rows]
    return "\n".join(lines)


def told_table(rows, head=("", "measured")):
    """Rows of told.py, one a line; with what was wanted where some of them say it."""
    marks = any(row.get("most") is not None or row.get("least") is not None for row in rows)
    lines = []
    for row in rows:
        line = [row["name"], spread(row)]
        if marks:
            most, least = row.get("most"), row.get("least")
            wanted = "" if most is None and least is None else f"at most {number(most)}" if most is not None else f"at least {number(least)}"
            line.append(wanted + (": **missed**" if row.get("reached") is False and wanted else ""))
        lines.append(line)
    return table([*head, *(["wanted"] if marks else [])], lines)


def count(text):
    """20M, 500k, 1G as a number."""
    factors = {"k": 1e3, "M": 1e6, "G": 1e9}
    try:
        return int(float(str(text).rstrip("kMG")) * factors.get(str(text)[-1:], 1))
    except ValueError:
        raise ValueError(f"'{text}' is no number of points; examples: 500k, 20M, 1G") from None


def short(points):
    """The other way round."""
    for factor, letter in ((10**9, "G"), (10**6, "M"), (10**3, "k")):
        if points >= factor:
            return f"{points / factor:g}{letter}"
    return str(points)


def power(points):
    """10⁵ for 100,000, else 2 · 10⁷."""
    exponent = len(str(int(points))) - 1
    first = points / 10**exponent
    raised = "10" + "".join("⁰¹²³⁴⁵⁶⁷⁸⁹"[int(digit)] for digit in str(exponent))
    return raised if first == 1 else f"{first:g} · {raised}"
