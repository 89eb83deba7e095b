"""What README, the notebook and the example script of client/python show is run, against a real server."""
import contextlib
import io
import json
import os
import re
import subprocess
import sys
import unittest

import support

import scancast

PAGE_URL = "http://127.0.0.1:8080/"
#: What a server has to have for a call, where it may be older than that.
ROUTES = {"points": r"\.(?:open|save)?_?points\(", "profile": r"profile(?:_picture)?\(", "measure": r"\.measure\(", "dem.tif": r"dem\(", "ortho.tif": r"\.ortho\("}


def text_of(*path):
    with open(os.path.join(support.ROOT, *path), encoding="utf-8") as file:
        return file.read()


@support.needs("numpy", "PIL")
class Examples(support.Served):
    points = 60_000

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        server = scancast.Server(cls.url, timeout=support.PATIENCE)
        support.wait_until(lambda: server.ready() and not server.pending(), "the cloud is not there")
        cls.paths = set(server.openapi()["paths"])

    def run_block(self, block, names, where):
        """`block` as it stands there; what needs a browser, or a route that this server does not have, is left out."""
        if ".widget(" in block or block.startswith("view."):
            return False
        if any(re.search(call, block) and f"/api/v1/clouds/{{id}}/{route}" not in self.paths for route, call in ROUTES.items()):
            print(f"\nSKIPPED: a block of {where} that this server has no route for", flush=True)
            return False
        said = io.StringIO()
        with contextlib.redirect_stdout(said):
            exec(compile(block.replace(PAGE_URL, self.url + "/"), where, "exec"), names)
        for shown in re.findall(r"print\(.*?\)\s+# (.+: unknown; did you mean .*\?)$", block, re.M):
            self.assertIn(shown, said.getvalue())
        return True

    def test_the_pages_are_true(self):
        before = os.getcwd()
        os.chdir(self.folder)
        try:
            names = {}
            blocks = re.findall(r"(?ms)^```python\n(.*?)^```", text_of("client", "python", "README.md"))
            ran = [self.run_block(block, names, "client/python/README.md") for block in blocks]
            self.assertGreaterEqual(ran.count(True), 3)
            self.assertTrue(os.path.getsize("town.png"))
        finally:
            os.chdir(before)

    def test_the_notebook_runs(self):
        text = text_of("client", "python", "examples", "first_steps.ipynb")
        cells = json.loads(text)["cells"]
        names = {}
        ran = [self.run_block("".join(cell["source"]), names, "first_steps.ipynb") for cell in cells if cell["cell_type"] == "code"]
        self.assertGreaterEqual(ran.count(True), 4)
        self.assertTrue(all(cell.get("outputs", []) == [] for cell in cells), "a notebook is kept without what it showed")

    def test_the_example_makes_its_picture(self):
        output = os.path.join(self.folder, "three.jpg")
        example = os.path.join(support.PACKAGE, "examples", "three_pictures.py")
        done = subprocess.run([sys.executable, example, self.url, "-o", output, "--width", "120", "--height", "90"], capture_output=True, text=True,
                              env={**os.environ, "PYTHONPATH": support.PACKAGE}, timeout=support.PATIENCE)
        self.assertEqual(done.returncode, 0, done.stderr)
        import PIL.Image
        with PIL.Image.open(output) as image:
            self.assertEqual(image.size, (360, 90))


if __name__ == "__main__":
    unittest.main()
