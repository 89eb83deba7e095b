"""docs/performance.md: words that people wrote, and between marks what was measured. Pure.

    <!-- figures: NAME -->
    … replaced as a whole …
    <!-- end of figures: NAME -->

The page is its own template: what stands outside the marks is never touched, and nothing that was measured stands outside them. A block is
written anew each time, with what this commit measured or with why it measured nothing, so no figure of another commit survives a rewriting.
"""
import re

BLOCK = re.compile(r"(?ms)^<!-- figures: ([\w-]+) -->\n(.*?)^<!-- end of figures: \1 -->$")
MARK = re.compile(r"(?m)^<!-- (?:end of )?figures: ([\w-]+) -->$")
COMMIT = re.compile(r"`[0-9a-f]{7,40}`")


def blocks(text):
    """{name: what stands between its marks}, in the page's order. Raises where marks do not go in pairs."""
    found = {}
    for match in BLOCK.finditer(text):
        if match[1] in found:
            raise ValueError(f"the page has two blocks of figures that are called {match[1]}")
        found[match[1]] = match[2]
    for match in MARK.finditer(BLOCK.sub("", text)):
        raise ValueError(f"the page has a mark of figures without its other half: {match[0]}")
    return found


def rewritten(text, figures):
    """The page with these figures ({name: Markdown}) and no others."""
    there = set(blocks(text))
    if unknown := sorted(there - figures.keys()):
        raise ValueError(f"the page has figures that nothing measures: {', '.join(unknown)}")
    if homeless := sorted(figures.keys() - there):
        raise ValueError(f"the page has no place for the figures {', '.join(homeless)}: it needs <!-- figures: NAME --> and <!-- end of figures: NAME -->")
    return BLOCK.sub(lambda m: f"<!-- figures: {m[1]} -->\n{figures[m[1]].strip()}\n<!-- end of figures: {m[1]} -->", text)


def prose(text):
    """What stands outside the marks."""
    return BLOCK.sub("", text)


def headings(text):
    return [m[2] for m in re.finditer(r"(?m)^(#+) (.*)$", re.sub(r"(?ms)^```.*?^```", "", text))]


def anchors(text):
    """As GitHub makes them of headings."""
    return {re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-") for title in headings(text)}
