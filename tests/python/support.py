"""What the tests of client/python share: the package from the tree, a real server, servers that lie."""
import contextlib
import importlib.util
import os
import re
import socket
import subprocess
import sys
import tempfile
import threading
import time
import unittest

HERE = os.path.dirname(os.path.abspath(__file__))
ROOT = os.path.realpath(os.path.join(HERE, "..", ".."))
PACKAGE = os.path.join(ROOT, "client", "python")
PROGRAMS = os.environ.get("SCANCAST_PROGRAMS", "")
PATIENCE = 60  # seconds; only what hangs takes so long

sys.path.insert(0, PACKAGE)


def has(*modules):
    return all(importlib.util.find_spec(name) for name in modules)


def needs(*modules):
    """A decorator: skipped, and said so, where a library is missing."""
    missing = [name for name in modules if not has(name)]
    if missing:
        print(f"\nSKIPPED: what needs {', '.join(missing)} (Debian: deploy/packages/test.txt has its package)", flush=True)
    return unittest.skipIf(missing, f"{', '.join(missing)} is not installed")


class Served(unittest.TestCase):
    """Tests of a real server, which is started once for a class: `url`."""

    points = 30000

    @classmethod
    def flags(cls):
        """Of scancast serve; files may be made in cls.folder."""
        return []

    @classmethod
    def prepared(cls, scancast, scan):
        """What is served of the scan."""
        return scan

    @classmethod
    def setUpClass(cls):
        if not PROGRAMS:
            print("\nSKIPPED: tests of a real server; SCANCAST_PROGRAMS names no folder of the programs", flush=True)
            raise unittest.SkipTest("SCANCAST_PROGRAMS names no folder of the programs")
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        scancast = os.path.join(PROGRAMS, "scancast")
        scan = os.path.join(folder.name, "town.las")
        subprocess.run([scancast, "generate", "town", "--points", str(cls.points), "-o", scan, "--quiet"], check=True, timeout=PATIENCE)
        cls.scan = scan
        served = cls.prepared(scancast, scan)
        log = open(os.path.join(folder.name, "log"), "w")
        cls.addClassCleanup(log.close)
        process = subprocess.Popen([scancast, "serve", served, "--port", "0", *cls.flags()], stdout=subprocess.PIPE, stderr=log, text=True)
        cls.addClassCleanup(end, process)
        cls.process = process
        line = process.stdout.readline()
        found = re.search(r"https?://[^/: ]+:\d+", line)
        if not found:
            with open(log.name) as file:
                raise AssertionError(f"scancast serve said {line!r}, and in its log:\n{file.read()[-2000:]}")
        cls.url = found.group()


def end(process):
    process.terminate()
    try:
        process.wait(30)
    except subprocess.TimeoutExpired:
        process.kill()
        raise
    finally:
        process.stdout.close()


def wait_until(condition, what):
    until = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > until:
            raise AssertionError(what)
        time.sleep(0.02)


@contextlib.contextmanager
def lying(answer):
    """A server whose every connection is given to `answer(connection)`, one after the other; yields its URL."""
    listener = socket.create_server(("127.0.0.1", 0))
    done = threading.Event()

    def serve():
        while not done.is_set():
            try:
                connection, _ = listener.accept()
            except OSError:
                return
            if done.is_set():
                connection.close()
                return
            with connection:
                connection.settimeout(PATIENCE)
                with contextlib.suppress(OSError):
                    answer(connection)

    thread = threading.Thread(target=serve, daemon=True)
    thread.start()
    try:
        yield f"http://127.0.0.1:{listener.getsockname()[1]}"
    finally:
        done.set()
        with contextlib.suppress(OSError):  # wakes who accepts
            socket.create_connection(listener.getsockname(), 1).close()
        thread.join(PATIENCE)
        listener.close()


def request_head(connection):
    """What a client asks, its body included: who closes a connection with bytes that he has not read resets it."""
    data = b""
    while b"\r\n\r\n" not in data or len(data) < data.index(b"\r\n\r\n") + 4 + _body_bytes(data):
        part = connection.recv(65536)
        if not part:
            return data
        data += part
    return data


def _body_bytes(head):
    found = re.search(rb"(?i)\r\ncontent-length: (\d+)", head)
    return int(found[1]) if found else 0


def mutations(sound, random, count):
    """Bytes that were sound once: cut, changed, put twice, of seeds that make the same ones each time."""
    for _ in range(count):
        data = bytearray(random.choice(sound))
        for _ in range(random.randint(1, 4)):
            kind = random.randrange(5)
            at = random.randrange(len(data) + 1)
            if kind == 0:
                del data[at:]
            elif kind == 1 and data:
                data[at % len(data)] = random.randrange(256)
            elif kind == 2:
                data[at:at] = random.randbytes(random.randint(1, 8))
            elif kind == 3:
                data[at:at + random.randint(1, 16)] = random.choice([b"\0\0\0\0", b"\xff\xff\xff\xff", b"\x7f\xff\xff\xff\xff\xff\xff\xff"])
            else:
                data[at:at] = data[at:at + random.randint(1, 64)]
        yield bytes(data)
