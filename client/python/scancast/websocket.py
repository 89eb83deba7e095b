"""A WebSocket of a client (RFC 6455), in the standard library alone: handshake, frames, and a connection that threads may share.

`FrameReader` and the functions are pure: bytes in, messages out, whatever comes. `WebSocket` has the socket. No extension is offered,
so none is accepted.
"""
from __future__ import annotations

import base64
import hashlib
import os
import select
import socket
import ssl
import struct
import threading
import time
from typing import Dict, List, Mapping, NamedTuple, Optional, Tuple, Union

from . import errors
from ._http import Address, Headers, _told, refusal

CONTINUATION, TEXT, BINARY, CLOSE, PING, PONG = 0x0, 0x1, 0x2, 0x8, 0x9, 0xA
_GUID = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"
_HEAD_LIMIT = 64 << 10
_REFUSAL_LIMIT = 1 << 20
_READ = 256 << 10


class WebSocketError(errors.BadAnswer):
    """The other side broke the protocol; `code` is that with which the connection is closed for it."""

    def __init__(self, code: int, detail: str) -> None:
        super().__init__(detail)
        self.code = code


class Message(NamedTuple):
    """A whole message, or a control frame. `data` of TEXT is text, of CLOSE (code, reason) - 1005 where none was given -, else bytes."""

    kind: int
    data: Union[str, bytes, Tuple[int, str]]


def close_code_is_sound(code: int) -> bool:
    return code in (1000, 1001, 1002, 1003, 1007, 1008, 1009, 1010, 1011, 1012, 1013, 1014) or 3000 <= code <= 4999


class FrameReader:
    """Bytes of a server → messages, whichever way they are cut. `limit`: bytes of a message that are taken; more is refused (1009) before
    it is kept. After an error it takes nothing more."""

    def __init__(self, limit: int) -> None:
        self._limit = limit
        self._buffer = bytearray()
        self._kind = 0  # of the message that is under way; 0: none
        self._parts = bytearray()
        self._closed = False
        self._broken = False

    def feed(self, data: Union[bytes, bytearray, memoryview]) -> List[Message]:
        if self._broken:
            raise WebSocketError(1002, "the connection is broken already")
        self._buffer += data
        found: List[Message] = []
        at = 0
        try:
            while not self._closed:
                frame = self._frame_at(at)
                if frame is None:
                    break
                final, opcode, begin, at = frame
                message = self._take(final, opcode, bytes(self._buffer[begin:at]))
                if message is not None:
                    found.append(message)
        except WebSocketError as error:
            self._broken = True
            error.before = found  # type: ignore[attr-defined]  # what was sound comes first
            raise
        finally:
            if at:
                del self._buffer[:at]
        if self._closed:
            self._buffer.clear()
        return found

    def _frame_at(self, at: int) -> Optional[Tuple[bool, int, int, int]]:
        """(final, opcode, where its payload begins, where it ends); None while it is not all there."""
        buffer, size = self._buffer, len(self._buffer) - at
        if size < 2:
            return None
        first, second = buffer[at], buffer[at + 1]
        final, opcode = bool(first & 0x80), first & 0x0F
        if first & 0x70:
            raise WebSocketError(1002, "a frame uses an extension that nobody asked for")
        if opcode not in (CONTINUATION, TEXT, BINARY, CLOSE, PING, PONG):
            raise WebSocketError(1002, f"a frame has the unknown opcode {opcode}")
        if second & 0x80:
            raise WebSocketError(1002, "a server's frame is masked")
        length, head = second & 0x7F, 2
        if opcode >= CLOSE and (not final or length > 125):
            raise WebSocketError(1002, "a control frame is long or in pieces")
        if opcode == CONTINUATION and not self._kind:
            raise WebSocketError(1002, "a message goes on that has not begun")
        if opcode in (TEXT, BINARY) and self._kind:
            raise WebSocketError(1002, "a message begins within another one")
        if length == 126:
            if size < 4:
                return None
            length, head = struct.unpack_from(">H", buffer, at + 2)[0], 4
            if length < 126:
                raise WebSocketError(1002, "a length is written longer than it is")
        elif length == 127:
            if size < 10:
                return None
            length, head = struct.unpack_from(">Q", buffer, at + 2)[0], 10
            if length < 1 << 16 or length >> 63:
                raise WebSocketError(1002, "a length is written longer than it is, or is none")
        if opcode < CLOSE and len(self._parts) + length > self._limit:
            raise WebSocketError(1009, f"a message has more than the {self._limit} bytes that are taken")
        if size < head + length:
            return None
        return final, opcode, at + head, at + head + length

    def _take(self, final: bool, opcode: int, payload: bytes) -> Optional[Message]:
        if opcode in (PING, PONG):
            return Message(opcode, payload)
        if opcode == CLOSE:
            self._closed = True
            return Message(CLOSE, _close_of(payload))
        kind = opcode or self._kind
        if not final:
            self._kind = kind
            self._parts += payload
            return None
        data = bytes(self._parts) + payload if self._parts else payload
        self._kind = 0
        self._parts = bytearray()
        if kind == BINARY:
            return Message(BINARY, data)
        try:
            return Message(TEXT, data.decode("utf-8"))
        except UnicodeDecodeError:
            raise WebSocketError(1007, "a text message is no UTF-8") from None


def _close_of(payload: bytes) -> Tuple[int, str]:
    if not payload:
        return 1005, ""
    if len(payload) == 1:
        raise WebSocketError(1002, "a close frame has half a code")
    code = struct.unpack_from(">H", payload)[0]
    if not close_code_is_sound(code):
        raise WebSocketError(1002, f"a close frame has the code {code}")
    try:
        return code, payload[2:].decode("utf-8")
    except UnicodeDecodeError:
        raise WebSocketError(1007, "the reason of a close frame is no UTF-8") from None


def masked(data: bytes, mask: bytes) -> bytes:
    """Every byte XOR its byte of the mask, by one number as long as the data."""
    size = len(data)
    if not size:
        return b""
    pattern = (mask * (size // 4 + 1))[:size]
    return (int.from_bytes(data, "little") ^ int.from_bytes(pattern, "little")).to_bytes(size, "little")


def frame(opcode: int, data: bytes, mask: bytes) -> bytes:
    """A client's frame, whole.

    >>> frame(TEXT, b"Hello", bytes.fromhex("37fa213d")).hex()      # RFC 6455, section 5.7
    '818537fa213d7f9f4d5158'
    """
    size = len(data)
    if size < 126:
        head = bytes((0x80 | opcode, 0x80 | size))
    elif size < 1 << 16:
        head = struct.pack(">BBH", 0x80 | opcode, 0x80 | 126, size)
    else:
        head = struct.pack(">BBQ", 0x80 | opcode, 0x80 | 127, size)
    return head + mask + masked(data, mask)


def accept_key(key: str) -> str:
    """What a server says to a key.

    >>> accept_key("dGhlIHNhbXBsZSBub25jZQ==")
    's3pPLMBiTxaQ9kYGzzhZRbK+xOo='
    """
    return base64.b64encode(hashlib.sha1(key.encode() + _GUID).digest()).decode()


def token_subprotocol(token: str) -> str:
    """An access token as a page in a browser offers it."""
    return "base64url.bearer.authorization." + base64.urlsafe_b64encode(token.encode()).decode().rstrip("=")


class Head(NamedTuple):
    status: int
    headers: Dict[str, str]  # by lower-case name; of several, the last


def parse_head(data: bytes) -> Head:
    """The head of an answer, without the blank line behind it. BadAnswer for what is none."""
    lines = data.decode("latin-1").split("\r\n")
    parts = lines[0].split(" ", 2)
    if len(parts) < 2 or not parts[0].startswith("HTTP/1.") or len(parts[1]) != 3 or not (parts[1].isascii() and parts[1].isdigit()):
        raise errors.BadAnswer("the answer is no HTTP: is it a Scancast server?")
    headers: Dict[str, str] = {}
    for line in lines[1:]:
        name, colon, value = line.partition(":")
        if not colon or not name or name != name.strip():
            raise errors.BadAnswer("the head of the answer is malformed")
        headers[name.lower()] = value.strip()
    return Head(int(parts[1]), headers)


def check_upgrade(head: Head, key: str, subprotocol: str) -> None:
    """BadAnswer where the answer agrees to something else than what was asked for."""
    said = head.headers
    if (said.get("upgrade", "").lower() != "websocket" or "upgrade" not in [one.strip().lower() for one in said.get("connection", "").split(",")]
            or said.get("sec-websocket-accept") != accept_key(key)):
        raise errors.BadAnswer("the server agreed to a WebSocket, but not to this one")
    if said.get("sec-websocket-protocol") != subprotocol or "sec-websocket-extensions" in said:
        raise errors.BadAnswer(f"the server speaks another protocol than {subprotocol}: is it a Scancast server?")


class WebSocket:
    """A connection. One thread receives; any may send and close. Every wait ends after `timeout` seconds at most, or as `receive` says.

    The socket never blocks: who waits holds no lock, and a TLS connection is used by one thread at a time."""

    def __init__(self, connected: socket.socket, where: str, timeout: float, limit: int, early: bytes = b"") -> None:
        self._socket = connected
        self._socket.setblocking(False)
        self._where = where
        self._timeout = timeout
        self._reader = FrameReader(limit)
        self._use = threading.Lock()  # of the socket, for one call that does not wait
        self._turn = threading.Lock()  # of whose frame is being sent
        self._waiting: List[Message] = []
        self._error: Optional[WebSocketError] = None
        self._early = early
        self._said_close = False
        self._gone = False

    @classmethod
    def connect(cls, address: Address, path: str, *, subprotocol: str, token: Optional[str], context: Optional[ssl.SSLContext], timeout: float,
                limit: int, headers: Mapping[str, str] = {}, token_as_subprotocol: bool = False) -> "WebSocket":
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
                    raise refusal(address, head.status, Headers(head.headers), _refusal_body(connected, head, rest))
                check_upgrade(head, key, subprotocol)
                return cls(connected, where, timeout, limit, rest)
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


def _refusal_body(connected: socket.socket, head: Head, begun: bytes) -> bytes:
    """As much of it as there is, of a plain body that says how long it is; nothing waits for long."""
    text = head.headers.get("content-length", "")
    size = min(int(text), _REFUSAL_LIMIT) if text.isascii() and text.isdigit() and len(text) < 12 else 0
    body = bytearray(begun[:size])
    try:
        while len(body) < size:
            part = connected.recv(min(_READ, size - len(body)))
            if not part:
                break
            body += part
    except OSError:
        pass
    return bytes(body)
