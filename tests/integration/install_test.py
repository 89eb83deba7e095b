"""What `cmake --install` puts somewhere is all that others need: the installed programs serve and fetch, and a project
that knows find_package(scancast) alone builds against the library and sees a picture.

    install_test.py BUILD_FOLDER
"""
import os
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
sys.path.insert(0, os.path.join(ROOT, "tests", "load"))
import serving

BUILD = os.path.abspath(sys.argv.pop())


def run(*command, cwd=None):
    done = subprocess.run(command, cwd=cwd, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True)
    if done.returncode:
        raise AssertionError(f"{' '.join(command)} ended with {done.returncode}:\n{done.stdout[-4000:]}")
    return done.stdout


class Install(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        cls.folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(cls.folder.cleanup)
        cls.prefix = os.path.join(cls.folder.name, "prefix")
        run("cmake", "--install", BUILD, "--prefix", cls.prefix)
        scan = os.path.join(cls.folder.name, "ball.las")
        run(cls.installed("bin/scancast"), "generate", "sphere", "--points", "20000", "-o", scan)
        with open(os.path.join(cls.folder.name, "log"), "w") as log:
            cls.server = serving.Server(cls.installed("bin/scancast"), scan, 8, log)
        cls.addClassCleanup(cls.server.stop)

    @classmethod
    def installed(cls, name):
        return os.path.join(cls.prefix, name)

    def test_a_project_of_its_own_builds_and_sees_a_picture(self):
        example, build = os.path.join(ROOT, "client", "cpp", "example"), os.path.join(self.folder.name, "example")
        run("cmake", "-S", example, "-B", build, f"-DCMAKE_PREFIX_PATH={self.prefix}")
        run("cmake", "--build", build)
        picture = os.path.join(self.folder.name, "picture.ppm")
        self.assertEqual(run(os.path.join(build, "look"), self.server.url, picture), "ball, 320x240\n")
        with open(picture, "rb") as file:
            self.assertEqual([file.readline() for _ in range(3)], [b"P6\n", b"320 240\n", b"255\n"])
            pixels = file.read()
        self.assertEqual(len(pixels), 320 * 240 * 3)
        self.assertGreater(len(set(pixels)), 50, "there is something in the picture")

    def test_headers_and_package_name_nothing_of_the_source_tree(self):
        for folder in ("include", "lib"):
            for where, _, names in os.walk(self.installed(folder)):
                for name in names:
                    if name.endswith((".hpp", ".cmake")):
                        with open(os.path.join(where, name)) as file:
                            text = file.read()
                        for word in (os.path.realpath(ROOT), "<boost/", "<openssl/", "Boost::", "OpenSSL::"):
                            self.assertNotIn(word, text, f"{where}/{name}")

    def test_programs_importers_page_and_documents_are_there(self):
        self.assertIn("cloud ball", run(self.installed("bin/scancast-client"), "info", self.server.url))
        for name in ("bin/scancast-sandbox", "bin/scancast-import-e57", "bin/scancast-import-laz", "bin/scancast-import-octree", "share/scancast/web/index.html"):
            self.assertTrue(os.path.isfile(self.installed(name)), name)
        documents = [name for _, _, names in os.walk(self.installed("share/doc")) for name in names]
        for name in ("PROTOCOL.md", "README.md", "LICENSE", "look.cpp"):
            self.assertIn(name, documents)


if __name__ == "__main__":
    unittest.main()
