"""A WebSocket connection of a client, in the standard library alone, which threads may share. What travels over it is _rfc6455.py's."""
from __future__ import annotations

import base64
import os
import select
import socket
import ssl
import struct
import threading
import time
from typing import List, Mapping, Optional

from . import errors
from ._http import Address, Headers, _told, refusal
from ._rfc6455 import (CLOSE, PING, PONG, TEXT, FrameReader, Head, Message, WebSocketError, check_upgrade, frame, parse_head,
                       token_subprotocol)

_HEAD_LIMIT = 64 << 10
_REFUSAL_LIMIT = 1 << 20
_REFUSAL_SECONDS = 5.0
_READ = 256 << 10


class WebSocket:
    """A connection. One thread receives; any may send and close. Every wait ends after `timeout` seconds at most, or as `receive` says.

    The socket never blocks: who waits holds no lock, and a TLS connection is used by one thread at a time."""

    def __init__(self, connected: socket.socket, where: str, timeout: float, limit: int, text_limit: int, early: bytes = b"") -> None:
        self._socket = connected
        self._socket.setblocking(False)
        self._where = where
        self._timeout = timeout
        self._reader = FrameReader(limit, text_limit)
        self._use = threading.Lock()  # of the socket, for one call that does not wait
        self._turn = threading.Lock()  # of whose frame is being sent
        self._waiting: List[Message] = []
        self._error: Optional[WebSocketError] = None
        self._early = early
        self._said_close = False
        self._gone = False

    @classmethod
    def connect(cls, address: Address, path: str, *, subprotocol: str, token: Optional[str], context: Optional[ssl.SSLContext], timeout: float,
                limit: int, text_limit: int = 1 << 20, headers: Mapping[str, str] = {}, token_as_subprotocol: bool = False) -> "WebSocket":
        """Connects and agrees on the subprotocol. What the server refuses is an exception as of any request."""
        where = address.authority
        key = base64.b64encode(os.urandom(16)).decode()
        offered = [subprotocol]
        lines = [f"GET {path} HTTP/1.1", f"Host: {where}", "Upgrade: websocket", "Connection: Upgrade", f"Sec-WebSocket-Key: {key}",
                 "Sec-WebSocket-Version: 13", "User-Agent: scancast-python", "Accept: application/json"]
        if token and token_as_subprotocol:
            offered.append(token_subprotocol(token))
        elif token:
            lines.append(f"Authorization: Bearer {token}")
        lines.append(f"Sec-WebSocket-Protocol: {', '.join(offered)}")
        lines += [f"{name}: {value}" for name, value in headers.items()]
        with _told(where):
            connected = socket.create_connection((address.host, address.port), timeout)
            try:
                connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                if context is not None:
                    connected = context.wrap_socket(connected, server_hostname=address.host)
                connected.sendall("\r\n".join(lines).encode("ascii") + b"\r\n\r\n")
                data = bytearray()
                end = time.monotonic() + timeout
                while b"\r\n\r\n" not in data:
                    if len(data) > _HEAD_LIMIT:
                        raise errors.BadAnswer(f"{where} answers with a head of more than {_HEAD_LIMIT} bytes")
                    part = connected.recv(_READ) if time.monotonic() < end else None
                    if part is None:
                        raise TimeoutError
                    if not part:
                        raise errors.BadAnswer(f"{where} closed the connection before it answered")
                    data += part
                text, _, rest = bytes(data).partition(b"\r\n\r\n")
                head = parse_head(text)
                if head.status != 101:
                    raise refusal(address, head.status, Headers(head.headers), _refusal_body(connected, head, rest, timeout))
                check_upgrade(head, key, subprotocol)
                return cls(connected, where, timeout, limit, text_limit, rest)
            except BaseException:
                connected.close()
                raise

    # ---- the socket

    def _wait(self, to_read: bool, until: Optional[float]) -> bool:
        """Until the socket may be used again, for half a second at most; False when the time is over."""
        left = 0.5 if until is None else min(0.5, until - time.monotonic())
        if left <= 0:
            return False
        number = self._socket.fileno()
        if number < 0:
            raise errors.ConnectionFailed(f"the connection to {self._where} is closed")
        if hasattr(select, "poll"):
            poll = select.poll()
            poll.register(number, select.POLLIN if to_read else select.POLLOUT)
            poll.poll(left * 1000)
        else:  # pragma: no cover - Windows
            select.select([number] if to_read else [], [] if to_read else [number], [], left)
        return True

    def _send(self, data: bytes) -> None:
        until = time.monotonic() + self._timeout
        view = memoryview(data)
        with self._turn, _told(self._where):
            while view:
                to_read = False
                try:
                    with self._use:
                        sent = self._socket.send(view)
                    view = view[sent:]
                    continue
                except ssl.SSLWantReadError:
                    to_read = True
                except (ssl.SSLWantWriteError, BlockingIOError):
                    pass
                if not self._wait(to_read, until):
                    self.drop()  # half a frame is no frame: nothing can follow it
                    raise TimeoutError

    def _read(self, until: Optional[float]) -> Optional[bytes]:
        """What has come; b"" at the end, None when the time is over first."""
        if self._early:
            early, self._early = self._early, b""
            return early
        with _told(self._where):
            while True:
                to_read = True
                try:
                    with self._use:
                        return self._socket.recv(_READ)
                except ssl.SSLWantWriteError:
                    to_read = False
                except (ssl.SSLWantReadError, BlockingIOError):
                    pass
                except ssl.SSLEOFError:
                    return b""
                if not self._wait(to_read, until):
                    return None

    # ---- messages

    def send_text(self, text: str) -> None:
        self._send(frame(TEXT, text.encode("utf-8"), os.urandom(4)))

    def receive(self, wait: Optional[float] = None) -> Optional[Message]:
        """The next TEXT, BINARY or CLOSE; pings are answered. None when nothing came for `wait` seconds. ConnectionFailed where the
        connection broke; WebSocketError where the other side broke the protocol, which is closed for that."""
        until = None if wait is None else time.monotonic() + wait
        while True:
            while self._waiting:
                message = self._waiting.pop(0)
                if message.kind == PING:
                    self._send(frame(PONG, bytes(message.data), os.urandom(4)))  # type: ignore[arg-type]
                elif message.kind != PONG:
                    if message.kind == CLOSE:
                        self._gone = True
                        code = message.data[0]
                        self._say_close(1000 if code == 1005 else int(code), "")
                    return message
            if self._error is not None:
                error, self._error = self._error, None
                self._gone = True
                self._say_close(error.code, str(error)[:100])
                raise error
            if self._gone:
                raise errors.ConnectionFailed(f"the connection to {self._where} is closed")
            if until is not None and time.monotonic() > until + 0.001:  # pings, and messages in pieces, do not prolong it
                return None
            data = self._read(until)
            if data is None:
                return None
            if data == b"":
                self._gone = True
                raise errors.ConnectionFailed(f"{self._where} closed the connection without a word")
            try:
                self._waiting += self._reader.feed(data)
            except WebSocketError as error:
                self._waiting += getattr(error, "before", [])
                self._error = error

    def _say_close(self, code: int, reason: str) -> None:
        if self._said_close:
            return
        self._said_close = True
        try:
            self._send(frame(CLOSE, struct.pack(">H", code) + reason.encode("utf-8")[:123], os.urandom(4)))
        except errors.ScancastError:
            pass  # who is gone needs no goodbye

    def say_close(self, code: int = 1000, reason: str = "") -> None:
        """Asks for the end; the other side's CLOSE is received next, or soon."""
        self._say_close(code, reason)

    def drop(self) -> None:
        """Ends the connection at once. Who receives meanwhile is told that it is closed."""
        self._gone = True
        try:
            self._socket.shutdown(socket.SHUT_RDWR)
        except OSError:
            pass
        with self._use:
            self._socket.close()


def _refusal_body(connected: socket.socket, head: Head, begun: bytes, timeout: float) -> bytes:
    """As much of it as there is in some seconds, of a plain body that says how long it is."""
    end = time.monotonic() + min(timeout, _REFUSAL_SECONDS)
    text = head.headers.get("content-length", "")
    size = min(int(text), _REFUSAL_LIMIT) if text.isascii() and text.isdigit() and len(text) < 12 else 0
    body = bytearray(begun[:size])
    try:
        while len(body) < size:
            left = end - time.monotonic()
            if left <= 0:
                break
            connected.settimeout(left)
            part = connected.recv(min(_READ, size - len(body)))
            if not part:
                break
            body += part
    except OSError:
        pass
    return bytes(body)
