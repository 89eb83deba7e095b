"""RFC 6455 as a client needs it: frames of a server → messages, messages → frames, the handshake. Pure: bytes in, messages out, whatever comes.

No extension is offered, so none is accepted.
"""
from __future__ import annotations

import base64
import hashlib
import struct
from typing import Dict, List, NamedTuple, Optional, Tuple, Union

from . import errors

CONTINUATION, TEXT, BINARY, CLOSE, PING, PONG = 0x0, 0x1, 0x2, 0x8, 0x9, 0xA
_GUID = b"258EAFA5-E914-47DA-95CA-C5AB0DC85B11"


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
    """Bytes of a server → messages, whichever way they are cut. `limit`: bytes of a message that are taken, `text_limit` of one that is text; more is refused (1009) before
    it is kept. After an error it takes nothing more."""

    def __init__(self, limit: int, text_limit: Optional[int] = None) -> None:
        self._limit = limit
        self._text_limit = limit if text_limit is None else min(limit, text_limit)
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
        limit = self._text_limit if (opcode or self._kind) == TEXT else self._limit
        if opcode < CLOSE and len(self._parts) + length > limit:
            raise WebSocketError(1009, f"a message has more than the {limit} bytes that are taken")
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
