"""The project's own text files, as the tests of its structure read them."""
import os

ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
NOT_OURS = {"node_modules", "seeds", "images", "__pycache__"}
TEXT = (".hpp", ".cpp", ".inl", ".comp", ".glsl", ".md", ".txt", ".cmake", ".py", ".mjs", ".js", ".sh", ".html", ".css")


def paths():
    """Of all files but what is built, fetched or a picture's, from the root."""
    for folder, folders, names in os.walk(ROOT):
        folders[:] = [f for f in folders if f not in NOT_OURS and not f.startswith(".")]
        if folder == ROOT:
            folders[:] = [f for f in folders if not f.startswith("build")]
        yield from (os.path.relpath(os.path.join(folder, name), ROOT).replace(os.sep, "/") for name in names)


def files(*endings):
    """{path: text} of all files with these endings, or of all text."""
    found = {}
    for path in paths():
        if path.endswith(endings or TEXT):
            with open(os.path.join(ROOT, path), encoding="utf-8") as file:
                found[path] = file.read()
    return found


def exists(path):
    return os.path.exists(os.path.join(ROOT, path))


def fail_with(test, complaints):
    """Says all of them, one a line, where there are any."""
    if found := sorted(set(complaints)):
        test.fail("\n" + "\n".join(found))
