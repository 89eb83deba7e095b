"""A server under load, and what the system says about it: `scancast serve` as a child, /proc, `scancast-client bench`."""
import http.client
import json
import os
import re
import resource
import selectors
import socket
import subprocess
import sys
import threading
import time

SUPPORT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "support", "serving")
TICKS = os.sysconf("SC_CLK_TCK")


def allow_many_files():
    """Hundreds of sessions are as many sockets, here and in what is started from here."""
    _, most = resource.getrlimit(resource.RLIMIT_NOFILE)
    resource.setrlimit(resource.RLIMIT_NOFILE, (most, most))


def returning_freed_memory():
    """The environment of a program whose memory is measured: the address sanitizer keeps 256 MB of what was freed, or else 8."""
    options = [os.environ.get("ASAN_OPTIONS"), "quarantine_size_mb=8"]
    return {**os.environ, "ASAN_OPTIONS": ":".join(filter(None, options))}


class Server:
    def __init__(self, scancast, cloud, sessions, log, *flags):
        self.process = subprocess.Popen([scancast, "serve", cloud, "--port", "0", "--max-sessions", str(sessions), *flags],
                                        stdout=subprocess.PIPE, stderr=log, text=True, env=returning_freed_memory())
        found = re.search(r"http://([^/:]+):(\d+)", self.process.stdout.readline())
        if not found:
            raise SystemExit("scancast serve said no address; its log tells why")
        self.address = found.group(1), int(found.group(2))
        self.url = "http://%s:%d" % self.address
        self.cloud = self.wait_until_loaded()

    def wait_until_loaded(self):
        while self.process.poll() is None:
            if self.get("/readyz")[0] == 200:
                clouds = json.loads(self.get("/api/v1/clouds")[2])
                if clouds["clouds"] and not clouds.get("pending"):
                    return clouds["clouds"][0]["id"]
            time.sleep(0.1)
        raise SystemExit("scancast serve has ended; its log tells why")

    def connect(self):
        return http.client.HTTPConnection(*self.address, timeout=120)

    def get(self, path, connection=None, method="GET", body=None, headers=None):
        """Status, headers, body."""
        used = connection or self.connect()
        used.request(method, path, body=body, headers=headers or {})
        answer = used.getresponse()
        result = answer.status, dict(answer.headers), answer.read()
        if not connection:
            used.close()
        return result

    def snapshot(self, query):
        return f"/api/v1/clouds/{self.cloud}/snapshot.jpg?{query}"

    def resident(self):
        """Bytes in memory now."""
        with open(f"/proc/{self.process.pid}/status") as status:
            return int(re.search(r"VmRSS:\s+(\d+)", status.read()).group(1)) * 1024

    def cpu_seconds(self):
        with open(f"/proc/{self.process.pid}/stat") as stat:
            fields = stat.read().rsplit(")", 1)[1].split()
        return (int(fields[11]) + int(fields[12])) / TICKS

    def stop(self):
        self.process.terminate()
        try:
            return self.process.wait(30)
        except subprocess.TimeoutExpired:
            self.process.kill()
            raise SystemExit("scancast serve did not end within 30 s of SIGTERM")


class Sampler:
    """Looks at the server's memory while a bench runs; `during` lists (seconds, bytes) from measuring to measured."""

    def __init__(self, server):
        self.server, self.during, self.cpu = server, [], {}
        self.phase, self.done = None, threading.Event()
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def enter(self, phase):
        self.phase = phase
        self.cpu[phase] = time.monotonic(), self.server.cpu_seconds()
        if phase == "measuring":
            self.during.append((time.monotonic(), self.server.resident()))

    def run(self):
        while not self.done.wait(0.1):
            if self.phase == "measuring":
                self.during.append((time.monotonic(), self.server.resident()))

    def stop(self):
        self.done.set()
        self.thread.join()

    def cpu_share(self):
        """Of one core, between the phases."""
        (start, used), (end, then) = self.cpu["measuring"], self.cpu["measured"]
        return (then - used) / (end - start)

    def growth(self):
        """Of the resident memory, from the first third of the time to the last: a share."""
        values = [size for _, size in self.during]
        third = max(1, len(values) // 3)
        return sum(values[-third:]) / sum(values[:third]) - 1


def bench(client, server, *flags, url=None):
    """Runs `scancast-client bench`; returns its report, and what the server used meanwhile. Failed sessions are in
    the report."""
    command = [client, "bench", url or server.url, "--json", "--timeout", "180", *map(str, flags)]
    process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    sampler, report = Sampler(server), []
    reader = threading.Thread(target=lambda: report.append(process.stdout.read()))
    reader.start()
    errors = []
    for line in process.stderr:
        if line.startswith("bench: "):
            sampler.enter(line.split(": ", 1)[1].strip())
        else:
            errors.append(line)
    process.wait()
    reader.join()
    sampler.stop()
    if not report[0]:
        raise SystemExit(f"{' '.join(command)} ended with {process.returncode}: {''.join(errors)}")
    groups = {group["behaviour"]: group for group in json.loads(report[0])["groups"]}
    return groups, sampler


def metrics(server):
    """What /metrics says, by name; of several series of a name, their sum."""
    sums = {}
    for line in server.get("/metrics")[2].decode().splitlines():
        if line and not line.startswith("#"):
            name, value = line.rsplit(" ", 1)
            name = name.split("{")[0]
            sums[name] = sums.get(name, 0) + float(value)
    return sums


class MjpegReaders:
    """Streams as MJPEG that are read as they come; of one thread. Counts pictures."""

    def __init__(self, server):
        self.server, self.selector, self.counts, self.first = server, selectors.DefaultSelector(), [], b""

    def open(self, query):
        line = socket.create_connection(self.server.address, 60)
        host = f"{self.server.address[0]}:{self.server.address[1]}"
        line.sendall(f"GET /api/v1/clouds/{self.server.cloud}/stream.mjpg?{query} HTTP/1.1\r\nHost: {host}\r\n\r\n".encode())
        line.setblocking(False)
        self.selector.register(line, selectors.EVENT_READ, len(self.counts))
        self.counts.append(0)

    def read(self, seconds):
        end = time.monotonic() + seconds
        while (left := end - time.monotonic()) > 0:
            for key, _ in self.selector.select(left):
                piece = key.fileobj.recv(1 << 20)
                if not piece:
                    self.selector.unregister(key.fileobj)
                    key.fileobj.close()
                self.first = self.first or piece
                self.counts[key.data] += piece.count(b"Scancast-Frame:")

    def read_until(self, over):
        while not over.is_set():
            self.read(0.1)

    def session(self):
        """Of the first stream."""
        return re.search(rb"Scancast-Session: (\w+)", self.first).group(1).decode()

    def close(self):
        for key in list(self.selector.get_map().values()):
            key.fileobj.close()


class Stream:
    """A WebSocket of the stream's that writes text and reads nothing: what a client sends that never acknowledges (RFC 6455)."""

    def __init__(self, server):
        self.socket = socket.create_connection(server.address, timeout=60)
        self.socket.sendall(("GET /api/v1/stream HTTP/1.1\r\nHost: %s:%d\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                             "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n"
                             "Sec-WebSocket-Protocol: scancast.v1\r\n\r\n" % server.address).encode())
        answer = self.socket.recv(65536)
        if b" 101 " not in answer.split(b"\r\n", 1)[0]:
            raise SystemExit("no stream was opened: " + answer[:200].decode(errors="replace"))

    @staticmethod
    def frame(message):
        """A text message as it goes over the line; masked by zeros, which changes nothing of it and is a mask all the same."""
        text = json.dumps(message).encode()
        length = bytes([0x80 | len(text)]) if len(text) < 126 else bytes([0x80 | 126]) + len(text).to_bytes(2, "big")
        return b"\x81" + length + bytes(4) + text

    def send(self, *messages):
        self.socket.sendall(b"".join(self.frame(message) for message in messages))

    def read(self, seconds):
        """What comes within that time, thrown away."""
        self.socket.settimeout(seconds)
        try:
            while self.socket.recv(1 << 20):
                pass
        except socket.timeout:
            pass
        self.socket.settimeout(60)

    def close(self):
        self.socket.close()


class Proxy:
    """tests/support/serving/shaping_proxy.py before the server."""

    def __init__(self, server, kbit, delay_ms):
        command = [sys.executable, os.path.join(SUPPORT, "shaping_proxy.py"), "--to", "%s:%d" % server.address,
                   "--kbit", str(kbit), "--delay-ms", str(delay_ms)]
        self.process = subprocess.Popen(command, stdout=subprocess.PIPE, text=True)
        self.url = f"http://127.0.0.1:{int(self.process.stdout.readline())}"

    def stop(self):
        self.process.terminate()
        self.process.wait(30)
