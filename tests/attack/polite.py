"""A WebSocket client of a few lines, and a polite viewer on it: moves the camera all the time, acknowledges what it is
shown, and notes when each frame came."""
import base64
import json
import math
import os
import socket
import struct
import threading
import time


class WebSocket:
    """Just enough of RFC 6455 to be polite, and to be rude: frames as they are asked for, masked."""

    def __init__(self, address, path="/api/v1/stream", timeout=30, headers=""):
        self.socket = socket.create_connection(address, timeout)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall((f"GET {path} HTTP/1.1\r\nHost: {address[0]}:{address[1]}\r\nConnection: Upgrade\r\n"
                             f"Upgrade: websocket\r\nSec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {key}\r\n"
                             f"Sec-WebSocket-Protocol: scancast.v1\r\n{headers}\r\n").encode())
        self.buffer = b""
        head = self.until(b"\r\n\r\n")
        self.status = int(head.split(b" ", 2)[1]) if head else 0

    def until(self, end):
        while end not in self.buffer:
            more = self.socket.recv(65536)
            if not more:
                return b""
            self.buffer += more
        head, self.buffer = self.buffer.split(end, 1)
        return head

    def exactly(self, count):
        while len(self.buffer) < count:
            more = self.socket.recv(max(65536, count - len(self.buffer)))
            if not more:
                raise ConnectionError("the server closed the connection")
            self.buffer += more
        taken, self.buffer = self.buffer[:count], self.buffer[count:]
        return taken

    def send(self, opcode, payload, fin=True, masked=True, length=None):
        """`length`: what the frame says, where it shall lie."""
        said = len(payload) if length is None else length
        head = bytes([(0x80 if fin else 0) | opcode])
        mask = 0x80 if masked else 0
        if said < 126:
            head += bytes([mask | said])
        elif said < 65536:
            head += bytes([mask | 126]) + struct.pack(">H", said)
        else:
            head += bytes([mask | 127]) + struct.pack(">Q", said)
        if masked:
            key = os.urandom(4)
            payload = bytes(b ^ key[i % 4] for i, b in enumerate(payload))
            head += key
        self.socket.sendall(head + payload)

    def say(self, **message):
        self.send(1, json.dumps(message).encode())

    def receive(self):
        """(opcode, payload) of the next frame; fragments are not put together."""
        first, second = self.exactly(2)
        size = second & 0x7F
        if size == 126:
            size, = struct.unpack(">H", self.exactly(2))
        elif size == 127:
            size, = struct.unpack(">Q", self.exactly(8))
        return first & 0x0F, self.exactly(size)

    def close(self):
        self.socket.close()


MOVING = 1


def frame_of(payload):
    """(flags, frame id) of a picture; protocol/frame_header.hpp."""
    return payload[9], struct.unpack_from("<Q", payload, 16)[0]


class PoliteViewer:
    """Turns around the cloud's middle, 30 views a second, until it is told to stop."""

    def __init__(self, address, width=960, height=540, samples=None, fps=30):
        self.arrivals, self.failure, self.done = [], None, threading.Event()
        self.address, self.size, self.samples, self.fps = address, (width, height), samples, fps
        self.thread = threading.Thread(target=self.run, daemon=True)
        self.thread.start()

    def run(self):
        try:
            stream = WebSocket(self.address)
            stream.say(type="hello", width=self.size[0], height=self.size[1], fps=self.fps)
            camera = None
            while camera is None:
                opcode, payload = stream.receive()
                if opcode == 1:
                    message = json.loads(payload)
                    if message["type"] == "welcome":
                        camera = message["view"]["camera"]
            mover = threading.Thread(target=self.move, args=(stream, camera), daemon=True)
            mover.start()
            while not self.done.is_set():
                opcode, payload = stream.receive()
                if opcode == 2:
                    flags, frame = frame_of(payload)
                    if flags & MOVING:
                        self.arrivals.append(time.monotonic())
                    stream.say(type="ack", frame=frame)
                elif opcode == 1 and json.loads(payload)["type"] == "problem":
                    self.failure = payload.decode()
            mover.join()
            stream.close()
        except (OSError, ValueError, ConnectionError) as error:
            if not self.done.is_set():
                self.failure = repr(error)

    def move(self, stream, camera):
        (ex, ey, ez), (tx, ty, _) = camera["eye"], camera["target"]
        radius, angle, seq = math.hypot(ex - tx, ey - ty), math.atan2(ey - ty, ex - tx), 0
        while not self.done.is_set():
            seq += 1
            angle += 0.01
            words = {"camera": {"eye": [tx + radius * math.cos(angle), ty + radius * math.sin(angle), ez]}}
            if self.samples and seq == 1:
                words["samples"] = self.samples
            try:
                stream.say(type="view", seq=seq, **words)
            except OSError as error:
                if not self.done.is_set():
                    self.failure = repr(error)
                return
            time.sleep(1 / self.fps)

    def measure(self, seconds):
        """(longest gap in ms, frames a second) over the next while."""
        start = time.monotonic()
        time.sleep(seconds)
        end = time.monotonic()
        came = [start] + [at for at in list(self.arrivals) if start <= at <= end] + [end]
        gap = max(later - earlier for earlier, later in zip(came, came[1:]))
        return gap * 1000, (len(came) - 2) / (end - start)

    def stop(self):
        self.done.set()
        self.thread.join(10)
