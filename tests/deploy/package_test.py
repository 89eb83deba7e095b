"""The Debian packages of a build, in a Debian that has nothing else: what they name is all that they need, what is
installed serves the same bytes as the build, and what is removed is gone.

    package_test.py BUILD_FOLDER

Needs root, debootstrap, and a mirror of the distribution ($SCANCAST_MIRROR, or debootstrap's own); says so and skips
otherwise. $SCANCAST_DEBIAN may name a folder or an archive (.tar) that a debootstrap of before left, which saves a minute.
"""
import glob
import os
import shutil
import subprocess
import sys
import tempfile
import unittest

ROOT = os.path.realpath(os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", ".."))
sys.path.insert(0, os.path.join(ROOT, "tests", "load"))
import serving

BUILD = os.path.abspath(sys.argv.pop())
DATA = os.environ.get("SCANCAST_TEST_DATA", os.path.join(ROOT, "..", "shared", "data"))


def run(*command, **options):
    done = subprocess.run(command, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=900, **options)
    if done.returncode:
        raise AssertionError(f"{' '.join(command)} ended with {done.returncode}:\n{done.stdout[-6000:]}")
    return done.stdout


@unittest.skipUnless(os.geteuid() == 0, "a Debian of its own needs root")
@unittest.skipUnless(shutil.which("debootstrap"), "debootstrap is not installed")
class Packages(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.debian, packages = os.path.join(folder.name, "debian"), os.path.join(folder.name, "packages")
        run("cpack", "-G", "DEB", "--config", os.path.join(BUILD, "CPackConfig.cmake"), "-B", packages)
        os.mkdir(cls.debian)
        before = os.environ.get("SCANCAST_DEBIAN", "")
        if os.path.isdir(before):
            run("cp", "-a", before + "/.", cls.debian)
        elif before:
            run("tar", "-xf", before, "-C", cls.debian)
        else:
            mirror = os.environ.get("SCANCAST_MIRROR")
            run("debootstrap", "--variant=minbase", "bookworm", cls.debian, *([mirror] if mirror else []))
        shutil.copy("/etc/resolv.conf", os.path.join(cls.debian, "etc", "resolv.conf"))
        run("mount", "-t", "proc", "proc", os.path.join(cls.debian, "proc"))
        cls.addClassCleanup(run, "umount", os.path.join(cls.debian, "proc"))
        os.mkdir(os.path.join(cls.debian, "packages"))
        for file in glob.glob(os.path.join(packages, "*.deb")):
            shutil.copy(file, os.path.join(cls.debian, "packages"))
        cls.inside("apt-get", "update", "-qq")
        cls.bare = cls.installed()
        cls.install("scancast")

    @classmethod
    def inside(cls, *command):
        return run("chroot", cls.debian, "env", "DEBIAN_FRONTEND=noninteractive", "LC_ALL=C.UTF-8", *command)

    @classmethod
    def install(cls, *names, simulate=False):
        files = [os.path.basename(found) for name in names
                 for found in glob.glob(os.path.join(cls.debian, "packages", name + "_*.deb"))]
        assert len(files) == len(names), f"{files} for {names}"
        return cls.inside("apt-get", "install", "-y", "--no-install-recommends", *(["--simulate"] if simulate else []),
                          *(f"/packages/{file}" for file in files))

    @classmethod
    def installed(cls):
        return set(cls.inside("dpkg-query", "-W", "-f", "${Package}\n").split())

    def there(self, *path):
        return os.path.exists(os.path.join(self.debian, *path))

    def serve(self, scancast, scan):
        log = open(os.path.join(self.debian, "tmp", "log"), "ab")
        self.addCleanup(log.close)
        server = serving.Server(scancast, scan, 8, log, "--backend", "cpu")
        self.addCleanup(server.process.stdout.close)
        self.addCleanup(server.stop)
        return server

    def test_1_a_server_needs_no_window_system_and_no_pcl(self):
        added = self.installed() - self.bare
        self.assertIn("scancast", added)
        for package in added:
            for word in ("sdl", "x11", "wayland", "pcl", "vtk", "pulse", "llvm", "mesa"):
                self.assertNotIn(word, package)
        print(f"scancast brings {len(added)} packages:", *sorted(added), file=sys.stderr)

    def test_2_it_serves_the_same_bytes_as_the_build(self):
        self.inside("scancast", "generate", "sphere", "--points", "20000", "-o", "/srv/ball.las", "--quiet")
        scan = os.path.join(self.debian, "srv", "ball.las")
        there = os.path.join(self.debian, "tmp", "scancast")
        with open(there, "w") as file:
            file.write(f'#!/bin/sh\nexec chroot --userspec=scancast "{self.debian}" /usr/bin/scancast "$@"\n')
        os.chmod(there, 0o755)
        here = os.path.join(BUILD, "bin", "scancast")
        installed, built = self.serve(there, "/srv/ball.las"), self.serve(here, scan)
        path = "/api/v1/clouds/ball/snapshot.png?width=320&height=240&eye=3,2,1&target=0,0,0"
        status, _, picture = installed.get(path)
        self.assertEqual(status, 200, picture)
        self.assertTrue(picture.startswith(b"\x89PNG"))
        self.assertGreater(len(picture), 5000, "there is something in the picture")
        self.assertEqual(picture, built.get(path)[2])
        self.assertIn(b"<html", installed.get("/")[2], "the page")

    def test_3_what_belongs_to_a_package_is_there(self):
        self.assertIn("scancast:", self.inside("getent", "passwd", "scancast"))
        self.assertIn("/etc/scancast/scancast.env", self.inside("dpkg-query", "-W", "-f", "${Conffiles}", "scancast"))
        for path in ("usr/lib/systemd/system/scancast.service", "usr/lib/sysusers.d/scancast.conf",
                     "usr/share/man/man1/scancast.1.gz", "usr/share/man/man1/scancast-serve.1.gz",
                     "usr/share/bash-completion/completions/scancast", "usr/share/doc/scancast/copyright"):
            self.assertTrue(self.there(path), path)
        self.assertFalse(self.there("etc/systemd/system/multi-user.target.wants/scancast.service"),
                         "nobody has said what to serve")

    def test_4_laz_is_read(self):
        scan = os.path.join(DATA, "laz", "MixedConifer.laz")
        if not os.path.exists(scan):
            self.skipTest(f"{scan} is missing")
        shutil.copy(scan, os.path.join(self.debian, "srv", "scan.laz"))
        self.assertIn("points", self.inside("scancast", "info", "/srv/scan.laz"))

    def test_5_the_others_can_be_installed(self):
        for name in ("scancast-import-pcl", "scancast-client", "scancast-ranks", "scancast-doc"):
            self.assertIn(f"Inst {name} ", self.install(name, simulate=True))
        self.install("libscancast-client0.1", "scancast-dev")
        self.assertIn("libscancast-client.so.0.1", self.inside("ldconfig", "-p"))
        self.install("python3-scancast")
        self.assertEqual("MissingLibrary\n", self.inside("python3", "-c", "import scancast\ntry: scancast.DepthPicture(b'', 0, 0).array()\n"
                                                        "except scancast.MissingLibrary as error: print(type(error).__name__)"))
        self.inside("apt-get", "remove", "-y", "python3-scancast")
        self.assertFalse(self.there("usr/lib/python3/dist-packages/scancast"))

    def test_6_removed_it_leaves_its_settings_and_purged_nothing(self):
        self.inside("mkdir", "-p", "/var/cache/scancast/kept")
        self.inside("apt-get", "remove", "-y", "scancast")
        self.assertFalse(self.there("usr/bin/scancast"))
        self.assertFalse(self.there("usr/bin/scancast-import-laz"))
        self.assertTrue(self.there("etc/scancast/scancast.env"))
        self.inside("apt-get", "purge", "-y", "scancast")
        for path in ("etc/scancast", "var/cache/scancast", "usr/libexec/scancast", "usr/share/doc/scancast/copyright"):
            self.assertFalse(self.there(path), path)


if __name__ == "__main__":
    unittest.main(verbosity=2)
