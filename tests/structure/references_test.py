"""Every reference leads somewhere: to a section of docs/spec, to a source that docs/spec/README.md lists, to a file.

What the fixed forms are says docs/spec/README.md, section 1.
"""
import os
import posixpath
import re
import unittest

import tree

CODE = (".hpp", ".cpp", ".inl", ".comp", ".glsl")
INDEX = "docs/spec/README.md"
SECTION = r"(?:§|section )(\d+(?:\.\d+)*)"
AUTHORS = r"(?:[A-ZÉÖÜ][\w-]+(?: et al\.|(?:, [A-Z][\w-]+)* and [A-Z][\w-]+)?)"
TITLE = r'"([A-Z][^"]{7,200})"'
YEAR = r"(\d{4}|undated)"
GONE = [  # what references once looked like
    (r"(?<![\w/(])methods\.md", "names a specification that is not in the tree; docs/methods.md is the gallery"),
    (r"methods\.md(?:'s)?,? ?(?:§|section )", "names a section of the gallery, which has none"),
    (r"\b\d{3}_[0-9a-f]{16}\b", "names a paper by a file's hash"),
    (r"(?:\bpaper 00\d\b|\(00\d\)|\b(?:in|of|after|by) 00\d\b(?![-.,]\d)|\b00\d(?:'s)? §|\b00\d,? (?:Fig|Eq|section))",
     "names a paper by a number"),
]


def prose(path, text):
    """Text in one line: of code its comments only, of anything else all, without the marks of comments."""
    if path.endswith(CODE):
        text = "\n".join(line.split("//", 1)[1].lstrip("/<") for line in text.splitlines() if "//" in line)
    else:
        text = re.sub(r"(?m)^[ \t]*#+(?= )", "", text)
    return re.sub(r"\s+", " ", text)


def headings(text):
    return [(m[1], m[2]) for m in re.finditer(r"(?m)^(#+) (.*)$", without_fences(text))]


def without_fences(text):
    return re.sub(r"(?ms)^[ \t]*```.*?^[ \t]*```", "", text)


def sections(text):
    """Numbers of the numbered headings."""
    return {m[1] for _, title in headings(text) if (m := re.match(r"(\d+(?:\.\d+)*)\.? ", title))}


def anchors(text):
    """As GitHub makes them of headings."""
    return {re.sub(r"[^\w -]", "", title.lower()).replace(" ", "-") for _, title in headings(text)}


def sources(index):
    """{title: (authors, year)} of the index' table of sources."""
    cited = re.compile(r"(?m)^\| (%s), %s, %s \|" % (AUTHORS, TITLE, YEAR))
    return {m[2]: (m[1], m[3]) for m in cited.finditer(index)}


def spec_complaints(path, text, files):
    at_home = re.compile(r"\]\((?:\.\./)*(?:docs/)?(?:spec/)?(\w+)\.md\),? " + SECTION)
    found = [(m[1], m[2]) for m in re.finditer(r"docs/spec/(\w+)\.md(?: " + SECTION + ")?", text)]
    if path.startswith("docs/"):
        found += [(m[1], m[2]) for m in at_home.finditer(text)]
    for page, section in found:
        name = f"docs/spec/{page}.md"
        if name not in files:
            yield f"{path}: there is no {name}"
        elif section and section not in sections(files[name]):
            yield f"{path}: {name} has no section {section}"


def source_complaints(path, text, known):
    for m in re.finditer(rf"({AUTHORS}), {TITLE}, {YEAR}\b", text):
        if m[2] not in known:
            yield f'{path}: "{m[2]}" is not in the list of {INDEX}'
    for title, (authors, year) in known.items():
        for m in re.finditer(re.escape(f'"{title}"'), text):
            before, after = text[: m.start()], text[m.end():]
            if not (before.endswith(f"{authors}, ") and after.startswith(f", {year}")):
                yield f'{path}: cite as {authors}, "{title}", {year}'


def link_complaints(path, text, files, exists):
    for m in re.finditer(r"\]\(([^)\s]+)\)", without_fences(text)):
        target, _, anchor = m[1].partition("#")
        if re.match(r"\w+:", target):
            continue
        full = posixpath.normpath(posixpath.join(posixpath.dirname(path), target)) if target else path
        if not exists(full):
            yield f"{path}: the link to {m[1]} leads nowhere"
        elif anchor and full in files and anchor not in anchors(files[full]):
            yield f"{path}: {full} has no heading #{anchor}"


def complaints(files, exists):
    """Of a tree {path: text}; what it says of other files than these, exists(path) knows."""
    known = sources(files.get(INDEX, ""))
    cited = set()
    for path, whole in files.items():
        text = prose(path, whole)
        yield from (f"{path}: {m[0]!r} {why}" for form, why in GONE for m in re.finditer(form, unlinked(path, text)))
        yield from spec_complaints(path, text, files)
        if path == INDEX:
            text = text.split("3. Sources")[0]
        yield from source_complaints(path, text, known)
        cited |= {title for title in known if f'"{title}"' in text}
        if path.endswith(".md"):
            yield from link_complaints(path, whole, files, exists)
    yield from (f'{INDEX}: nobody cites "{title}"' for title in known.keys() - cited)


def unlinked(path, text):
    """Within docs/ a link to the gallery needs no folder."""
    return re.sub(r"\]\(methods\.md[^)]*\)", "", text) if path.startswith("docs/") else text


class TheTree(unittest.TestCase):
    def test_every_reference_leads_somewhere(self):
        files = {path: text for path, text in tree.files().items() if not path.startswith("tests/structure/")}
        self.assertGreater(len(files), 500)
        self.assertIn(INDEX, files)
        tree.fail_with(self, complaints(files, tree.exists))


class ComplaintsAreMade(unittest.TestCase):
    INDEX_TEXT = '# I\n\n## 3. Sources\n\n| cited as |\n|---|\n| Ross and Bee, "On Splats of Any Size", 2001 | x |\n'
    CITED = '// Ross and Bee, "On Splats of Any Size", 2001, §4.\n'

    def of(self, **more):
        files = {INDEX: self.INDEX_TEXT, "docs/spec/discs.md": "## 1. One\n### 1.2 Two\n", "a.hpp": self.CITED}
        files.update({path.replace("__", "/").replace("_hpp", ".hpp").replace("_md", ".md"): text
                      for path, text in more.items()})
        return list(complaints(files, files.__contains__))

    def test_of_nothing_where_all_is_well(self):
        self.assertEqual([], self.of(b_hpp="// docs/spec/discs.md §1.2; docs/spec/discs.md\n// §1.\nint x = 1;",
                                     README_md="[i](docs/spec/README.md#3-sources), [d](docs/spec/discs.md)"))

    def test_of_sections_and_pages_that_are_not_there(self):
        self.assertEqual(["b.hpp: docs/spec/discs.md has no section 3"], self.of(b_hpp="/// docs/spec/discs.md\n/// §3."))
        self.assertEqual(["b.hpp: docs/spec/discs.md has no section 3"], self.of(b_hpp="// docs/spec/discs.md section 3."))
        self.assertEqual(["b.hpp: there is no docs/spec/cubes.md"], self.of(b_hpp="// docs/spec/cubes.md §1."))
        self.assertEqual(["docs/b.md: docs/spec/discs.md has no section 9"],
                         self.of(docs__b_md="[d](spec/discs.md) §9"))

    def test_of_what_references_once_looked_like(self):
        for old in ("methods.md §3", "design methods.md\n// §3", "docs/methods.md section 3", "001_c3e54385a9f0e90c",
                    "paper 004", "after 004 §3.1", "(003)", "Fig. 8 in 000", "004, Fig. 4"):
            self.assertTrue(self.of(b_hpp=f"// As {old}."), old)
        self.assertEqual([], self.of(b_hpp="// docs/methods.md, 50,000 points, in 000.5 s", docs__methods_md=""))

    def test_of_sources_that_are_not_listed_or_cited_otherwise(self):
        self.assertEqual([f'b.hpp: "On Discs of Any Size" is not in the list of {INDEX}'],
                         self.of(b_hpp='// Ross et al., "On Discs of Any Size",\n// 2001'))
        for wrong in ('"On Splats of Any Size", 2001', 'Bee, "On Splats of Any Size", 2001',
                      'Ross and Bee, "On Splats of Any Size"'):
            self.assertEqual(['b.hpp: cite as Ross and Bee, "On Splats of Any Size", 2001'], self.of(b_hpp=f"// {wrong}."))

    def test_of_sources_that_nobody_cites(self):
        self.assertEqual([f'{INDEX}: nobody cites "On Splats of Any Size"'], self.of(a_hpp=""))

    def test_of_links_that_lead_nowhere(self):
        self.assertEqual(["README.md: the link to docs/no.md leads nowhere"], self.of(README_md="[i](docs/no.md)"))
        self.assertEqual(["README.md: docs/spec/discs.md has no heading #2-two"],
                         self.of(README_md="[i](docs/spec/discs.md#2-two)"))
        self.assertEqual([], self.of(README_md="```\n[i](docs/no.md)\n```\n[i](https://a.b/c) [j](#top)\n# Top"))


if __name__ == "__main__":
    unittest.main()
