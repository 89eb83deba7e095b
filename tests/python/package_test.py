"""`pip install ./client/python`, as README says, without a network: what is installed is whole, typed, and runs alone."""
import glob
import os
import re
import shutil
import subprocess
import sys
import tempfile
import unittest

import support


def run(*command, **options):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=300, **options)
    if done.returncode:
        raise AssertionError(f"{' '.join(command)} ended with {done.returncode}:\n{done.stdout[-4000:]}")
    return done.stdout


@support.needs("pip", "setuptools", "wheel", "venv", "ensurepip")
class Package(unittest.TestCase):
    def test_pip_installs_all_of_it_and_it_runs_alone(self):
        with tempfile.TemporaryDirectory() as folder:
            source = os.path.join(folder, "client", "python")  # pip leaves its work beside what it builds
            shutil.copytree(support.PACKAGE, source, ignore=shutil.ignore_patterns("__pycache__", "build", "*.egg-info"))
            # The system's setuptools, since nothing may be fetched; pip is the system's, too.
            run(sys.executable, "-m", "venv", "--system-site-packages", "--without-pip", os.path.join(folder, "env"))
            python = os.path.join(folder, "env", "bin", "python3")
            run(python, "-m", "pip", "install", "--no-index", "--no-build-isolation", "--disable-pip-version-check", "./client/python", cwd=folder)
            installed = glob.glob(os.path.join(folder, "env", "lib", "python3*", "site-packages", "scancast"))[0]
            ours = {name for name in os.listdir(os.path.join(support.PACKAGE, "scancast")) if name != "__pycache__"}
            self.assertEqual({name for name in os.listdir(installed) if name != "__pycache__"}, ours)
            self.assertIn("py.typed", ours)
            said = run(python, "-c", "import sys, scancast\n"
                       "print(scancast.__file__, scancast.Server('http://127.0.0.1:1/'), sorted(set(sys.modules) & {'numpy', 'PIL', 'anywidget'}))", cwd=folder)
            self.assertIn(installed, said)
            self.assertTrue(said.endswith("Server('http://127.0.0.1:1/') []\n"), said)
            with open(glob.glob(installed + "-*.dist-info/METADATA")[0], encoding="utf-8") as file:
                metadata = file.read()
            self.assertIn("Requires-Python: >=3.9", metadata)
            self.assertNotRegex(metadata, r"(?m)^Requires-Dist: (?!.*extra ==)", "nothing is needed")
            import scancast
            self.assertIn(f"\nVersion: {scancast.__version__}\n", metadata)

    def test_its_version_is_the_projects(self):
        with open(os.path.join(support.ROOT, "CMakeLists.txt"), encoding="utf-8") as file:
            project = re.search(r"project\(scancast\s+VERSION\s+([\d.]+)", file.read(), re.I)[1]
        import scancast
        self.assertEqual(scancast.__version__, project)
        with open(os.path.join(support.PACKAGE, "pyproject.toml"), encoding="utf-8") as file:
            self.assertIn(f'version = "{project}"', file.read())


if __name__ == "__main__":
    unittest.main()
