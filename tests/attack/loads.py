"""What others ask for, all of it valid, and more of it than is polite. Each load runs until it is told to stop."""
import http.client
import socket
import threading
import time

import malformed
import polite

POSTER = "width=16384&height=3906&samples=64&detail=0.01"
STILL = "width=3840&height=2160&samples=16"


class Load:
    """`clients` threads of `act(self, number)`, again and again."""

    def __init__(self, server, clients, act):
        self.server, self.done, self.outcomes = server, threading.Event(), {}
        self.lock = threading.Lock()
        self.threads = [threading.Thread(target=self.run, args=(act, number), daemon=True) for number in range(clients)]
        for thread in self.threads:
            thread.start()

    def run(self, act, number):
        while not self.done.is_set():
            try:
                outcome = act(self, number)
            except (OSError, http.client.HTTPException) as error:
                outcome = type(error).__name__
            with self.lock:
                self.outcomes[outcome] = self.outcomes.get(outcome, 0) + 1

    def stop(self):
        self.done.set()
        for thread in self.threads:
            thread.join(60)
        return ", ".join(f"{count} x {outcome}" for outcome, count in sorted(self.outcomes.items(), key=str))


def ask(load, path, method="GET", body=None):
    connection = http.client.HTTPConnection(*load.server.address, timeout=60)
    try:
        connection.request(method, path, body=body, headers={"Content-Type": "application/json"} if body else {})
        response = connection.getresponse()
        response.read()
        if response.status in (413, 429, 503):
            time.sleep(0.05)
        return response.status
    finally:
        connection.close()


def snapshots(query, kind="jpg", vary=True):
    def act(load, number):
        turn = f"&eye={number},{time.monotonic() % 100:.6f},400" if vary else ""
        return ask(load, f"/api/v1/clouds/{load.server.cloud}/snapshot.{kind}?{query}{turn}")
    return act


def methods(load, number):
    names = ["ewa", "voronoi", "pyramid", "hqs", "disc", "paraboloid"]
    name = names[int(time.monotonic() * 10 + number) % len(names)]
    return snapshots(f"width=3840&height=2160&method={name}&shading=phong&light.occlusion=1")(load, number)


def large_frames(load, _):
    """A stream that moves over pictures of 4K and wants them all at full size."""
    viewer = polite.PoliteViewer(load.server.address, 3840, 2160)
    load.done.wait()
    viewer.stop()
    return "stream" if viewer.arrivals else "stream without a frame"


def posters_that_leave(load, _):
    with socket.create_connection(load.server.address, 10) as connection:
        path = f"/api/v1/clouds/{load.server.cloud}/snapshot.png?{STILL}&eye=1,{time.monotonic() % 100:.6f},400"
        connection.sendall(f"GET {path} HTTP/1.1\r\nHost: 127.0.0.1\r\n\r\n".encode())
        time.sleep(0.1)
    return "left"


def slow_readers(load, number):
    """Depth of 33 MB, read at a kilobyte now and then."""
    with socket.socket() as connection:
        connection.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        connection.settimeout(30)
        connection.connect(load.server.address)
        body = b'{"width": 3840, "height": 2160, "camera": {"eye": [%d, %.6f, 400]}}' % (number, time.monotonic() % 100)
        connection.sendall(f"POST /api/v1/clouds/{load.server.cloud}/snapshot HTTP/1.1\r\nHost: 127.0.0.1\r\nAccept: application/octet-stream\r\n"
                           f"Content-Type: application/json\r\nContent-Length: {len(body)}\r\n\r\n".encode() + body)
        while not load.done.wait(0.5):
            if not connection.recv(1024):
                return "closed"
    return "read slowly"


def deaf_streams(load, _):
    stream = polite.WebSocket(load.server.address)
    stream.say(type="hello", width=1920, height=1080)
    seq = 0
    while not load.done.wait(0.05):
        seq += 1
        stream.say(type="view", seq=seq, detail=0.5 + seq % 10 / 10)
    stream.close()
    return "deaf"


def picks(load, number):
    body = '{"x": 1000, "y": 600, "view": {"width": 3840, "height": 2160, "camera": {"fov": %.6f}}}' % (30 + number + time.monotonic() % 1)
    return ask(load, f"/api/v1/clouds/{load.server.cloud}/pick", "POST", body)


def connects(load, _):
    socket.create_connection(load.server.address, 10).close()
    return "connected"


def idlers(load, _):
    connections = [socket.create_connection(load.server.address, 10) for _ in range(50)]
    load.done.wait(5)
    for connection in connections:
        connection.close()
    return "50 idle"


def pings(load, _):
    stream = polite.WebSocket(load.server.address)
    stream.say(type="hello", width=64, height=48)
    for _ in range(500):
        stream.send(9, b"ping")
    stream.close()
    return "500 pings"


def malformed_ones(load, number):
    cases = malformed.http_cases(load.server.cloud)
    for case in cases[number::4]:
        if load.done.is_set():
            break
        malformed.answer(load.server.address, case)
    return "all of them"


ALL = {
    "posters": (4, snapshots(POSTER), "64 megapixels of 64 samples, refused or not"),
    "posters within the limit": (4, snapshots("width=16384&height=3906&samples=40"), "64 megapixels of 40 samples"),
    "4K stills": (4, snapshots(STILL), "3840 x 2160 of 16 samples"),
    "4K PNG": (4, snapshots(STILL, "png"), "the same as PNG"),
    "every method": (4, methods, "4K with all light, one method after the other"),
    "large moving frames": (3, large_frames, "streams of 3840 x 2160"),
    "picks": (4, picks, "in pictures of 4K"),
    "asked for and left": (4, posters_that_leave, "4K PNG, given up after 0.1 s"),
    "slow readers": (14, slow_readers, "of depth of 33 MB"),
    "deaf streams": (8, deaf_streams, "streams that never read"),
    "connects": (4, connects, "as fast as they can"),
    "idle connections": (4, idlers, "50 at a time each"),
    "pings": (4, pings, "500 after one another"),
    "malformed": (4, malformed_ones, "six hundred requests that nobody means"),
}
