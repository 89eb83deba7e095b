"""What goes wrong around a server while it serves: each fault is done by one function, which undoes it before it returns, and says what it saw."""
import json
import os
import random
import resource
import shutil
import signal
import socket
import struct
import time


def descendants(pid):
    """Processes that come of this one, by id."""
    found = []
    for task in os.listdir(f"/proc/{pid}/task"):
        try:
            with open(f"/proc/{pid}/task/{task}/children") as children:
                for child in map(int, children.read().split()):
                    found += [child, *descendants(child)]
        except OSError:
            pass  # it has just ended
    return found


class Faults:
    """`moving` is a cloud whose file changes; `versions` are the files that it may be, and `admin` the administrator's token."""

    def __init__(self, server, moving, versions, data_root, admin, seed):
        self.server, self.moving, self.versions, self.data_root, self.admin = server, moving, versions, data_root, admin
        self.random, self.half_open, self.unread = random.Random(seed), [], []
        self.all = [self.vanish, self.half_opened, self.slow_reader, self.replaced, self.cut_short, self.importer_killed, self.disk_full, self.hangup]

    def one(self):
        """Does one; (its name, what happened)."""
        fault = self.random.choice(self.all)
        return fault.__name__.replace("_", " "), fault()

    def connect(self, receive_buffer=0):
        connection = socket.socket()
        if receive_buffer:
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        connection.settimeout(20)
        connection.connect(self.server.address)
        return connection

    def ask(self, connection, target):
        connection.sendall(f"GET {target} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n".encode())

    def keep(self, connections, connection, most):
        connections.append(connection)
        while len(connections) > most:
            connections.pop(0).close()

    def vanish(self):
        """Ten clients whose machines die, in the middle of an answer, a stream or a head."""
        for number in range(10):
            connection = self.connect()
            targets = [f"/api/v1/clouds/{self.server.cloud}/stream.mjpg?width=320&height=200",
                       self.server.snapshot(f"width=800&height=600&eye={number},{self.random.random()},400")]
            self.ask(connection, targets[number % 2])
            time.sleep(self.random.random() / 10)
            connection.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))  # a reset, no goodbye
            connection.close()
        return "ten left"

    def half_opened(self):
        """A head that does not end, of a client that stays."""
        connection = self.connect()
        connection.sendall(b"GET /api/v1/clouds HTTP/1.1\r\nHost: 127.0")
        self.keep(self.half_open, connection, 20)
        return f"{len(self.half_open)} hang on"

    def slow_reader(self):
        connection = self.connect(4096)
        self.ask(connection, self.server.snapshot("width=1920&height=1080&quality=100").replace(".jpg", ".png").replace("&quality=100", ""))
        self.keep(self.unread, connection, 4)
        return f"{len(self.unread)} do not read"

    def put(self, version):
        """The moving cloud's file is another one, at once."""
        beside = self.moving.path + ".new"
        shutil.copyfile(self.versions[version], beside)
        os.replace(beside, self.moving.path)

    def shows(self, version, patience=30):
        end = time.monotonic() + patience
        while time.monotonic() < end:
            if self.moving.look() == version:
                return True
            time.sleep(0.3)
        return False

    def replaced(self):
        for version in (1, 0):
            self.put(version)
            if not self.shows(version):
                return f"UNEXPECTED: version {version} of the cloud file was not shown"
        return "and back again"

    def cut_short(self):
        os.truncate(self.moving.path, os.path.getsize(self.moving.path) // 2)
        time.sleep(3)
        self.moving.look()
        self.put(0)
        return "and mended" if self.shows(0) else "UNEXPECTED: the mended cloud file was not shown"

    def administer(self, method, path, body=None):
        headers = {"Authorization": "Bearer " + self.admin}
        if body is not None:
            headers["Content-Type"] = "application/json"
        return self.server.get(path, method=method, body=None if body is None else json.dumps(body), headers=headers)

    def add(self, name):
        status, _, body = self.administer("POST", "/api/v1/clouds", {"file": name, "id": "added"})
        return None if status == 202 else f"UNEXPECTED: adding {name} was answered {status}: {body[:200]}"

    def remove(self, patience=60):
        end = time.monotonic() + patience
        while time.monotonic() < end:
            if self.administer("DELETE", "/api/v1/clouds/added")[0] in (204, 404):
                return None
            time.sleep(0.2)
        return "UNEXPECTED: a cloud that was added cannot be removed"

    def importer_killed(self):
        """SIGKILL, while it reads."""
        if not os.path.exists(os.path.join(self.data_root, "added.ply")):
            return "left out: there is no importer"
        if wrong := self.add("added.ply"):
            return wrong
        end, killed = time.monotonic() + 20, False
        while time.monotonic() < end and not killed:
            for child in descendants(self.server.process.pid):
                os.kill(child, signal.SIGKILL)
                killed = True
            if self.server.get("/api/v1/clouds/added")[0] == 200 and not killed and b'"ready"' in self.server.get("/api/v1/clouds/added")[2]:
                break
        return self.remove() or ("killed" if killed else "it was faster")

    def disk_full(self):
        """No file may grow, as on a disk that is full: what is added is read all the same, or refused."""
        pid = self.server.process.pid
        before = resource.prlimit(pid, resource.RLIMIT_FSIZE)
        resource.prlimit(pid, resource.RLIMIT_FSIZE, (4096, before[1]))
        try:
            if wrong := self.add("added.las"):
                return wrong
            time.sleep(2)
            return self.remove() or "and room again"
        finally:
            resource.prlimit(pid, resource.RLIMIT_FSIZE, before)

    def hangup(self):
        self.server.process.send_signal(signal.SIGHUP)
        return "SIGHUP"

    def close(self):
        for connection in self.half_open + self.unread:
            connection.close()
