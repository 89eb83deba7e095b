"""The connection of a live view: opens it, receives in a thread of its own, and makes it anew when it is lost.

LiveView is what people use of it. What arrives is kept under `_change`, which tells who waits.
"""
from __future__ import annotations

import json
import math
import threading
import time
from typing import Any, Callable, Dict, List, Mapping, Optional, Tuple

from . import errors
from ._http import Transport
from ._rfc6455 import BINARY, CLOSE, WebSocketError
from ._values import as_float
from ._wanted import Wanted
from .frames import Frame, parse_frame
from .websocket import WebSocket

SUBPROTOCOL = "scancast.v1"
MESSAGE_LIMIT = 64 << 20  # bytes of a message; a JPEG of 16384 x 16384 pixels is rarely as large
_LONGEST_PAUSE = 10.0
_LONGEST_STAY = 60.0  # seconds at a server that is about to leave, whatever it says
_MOST_PROBLEMS = 100
_COMES_BACK = (1001, 1006, 1011, 1012, 1013)  # codes after which it is worth trying: the server leaves, or has no place now

Judge = Callable[[errors.InvalidArgument, Mapping[str, Any]], errors.ScancastError]
"""What a refusal means, where words were given that this version does not know."""


def _read_json(text: str) -> Dict[str, Any]:
    try:
        told = json.loads(text)
    except (ValueError, RecursionError):
        raise errors.BadAnswer("a message of the server is no JSON") from None
    if not isinstance(told, dict):
        raise errors.BadAnswer("a message of the server is no object")
    return told


class _Ended(errors.ConnectionFailed):
    """The server said goodbye."""

    def __init__(self, code: int, reason: str) -> None:
        super().__init__(f"the server ended the view: {reason or code}")
        self.code = code


class Session:
    """A session with a server, as far as it is a connection."""

    def __init__(self, transport: Transport, cloud: Optional[str], view: Mapping[str, Any], *, depth: bool = False, fps: Optional[float] = None,
                 reconnect: bool = True, judge: Judge = lambda refusal, given: refusal, given: Mapping[str, Any] = {}) -> None:
        self._transport = transport
        self._reconnect = reconnect
        self._judge = judge
        self._fixed: Dict[str, Any] = {"type": "hello", "depth": bool(depth)}
        if fps is not None:
            self._fixed["fps"] = fps
        if cloud is not None:
            self._fixed["cloud"] = cloud
        self._change = threading.Condition()
        self._frame: Optional[Frame] = None
        self._final: Optional[Frame] = None
        self._taken = 0  # id of the frame that was handed out last
        self._newest = 0  # id of the frame that arrived last
        self._wanted = Wanted()
        self._seq = 0  # of views and picks
        self._unknown: Dict[int, Mapping[str, Any]] = {}  # words of views that this version does not know all of
        self._problems: List[Tuple[Optional[int], errors.ScancastError]] = []
        self._picks: Dict[int, Any] = {}
        self._quality: Optional[Dict[str, Any]] = None
        self._error: Optional[errors.ScancastError] = None
        self._closed = False
        self.stats: Dict[str, Any] = {}
        """What the server said of a frame last: PROTOCOL.md, "stats"."""
        self.skipped = 0
        """Frames that a newer one overtook before anybody took them."""
        self._resume = ""
        self._connected = True
        self._thread = threading.Thread(target=self._run, name="scancast-live", daemon=True)
        wrong: Optional[errors.ScancastError] = None
        try:
            self._socket, self._welcome = self._open({**self._fixed, **_said_first(view)})
        except errors.InvalidArgument as refusal:
            wrong = judge(refusal, given)
        if wrong is not None:
            raise wrong
        self._welcomed()
        self._thread.start()

    def close(self) -> None:
        """Says goodbye and ends the thread. Twice is once."""
        with self._change:
            if self._closed:
                return
            self._closed = True
            self._change.notify_all()
        self._socket.say_close(1000)
        if threading.current_thread() is not self._thread:
            self._thread.join(2.0)
        self._socket.drop()

    def _say(self, message: Mapping[str, Any]) -> None:
        if self._error is not None:
            raise self._error
        if self._closed:
            raise errors.ConnectionFailed("this view has been closed")
        text = json.dumps(message, allow_nan=False)
        try:
            self._socket.send_text(text)
        except errors.ConnectionFailed:
            if not self._reconnect:
                raise  # else what is wanted is said again when it is back

    def _open(self, hello: Mapping[str, Any]) -> "tuple[WebSocket, Dict[str, Any]]":
        transport = self._transport
        socket = WebSocket.connect(transport.address, "/api/v1/stream", subprotocol=SUBPROTOCOL, token=transport.token(),
                                   context=transport.tls, timeout=transport.timeout, limit=MESSAGE_LIMIT)
        try:
            socket.send_text(json.dumps(hello, allow_nan=False))
            until = time.monotonic() + transport.timeout
            while True:
                left = until - time.monotonic()
                message = socket.receive(left) if left > 0 else None  # other messages do not prolong it
                if message is None:
                    raise errors.TimedOut("the server did not welcome the view in time")
                if message.kind == CLOSE:
                    raise _Ended(*message.data)
                if message.kind == BINARY:
                    raise errors.BadAnswer("a frame came before the welcome")
                told = _read_json(str(message.data))
                if told.get("type") == "welcome":
                    return socket, told
                if told.get("type") == "problem":
                    raise _refusal(told)
        except BaseException:
            socket.drop()
            raise

    def _welcomed(self) -> bool:
        """Takes note of it; whether the server has missed what was asked for."""
        told = self._welcome
        view, seq, resume = told.get("view"), told.get("seq"), told.get("resume")
        with self._change:
            self._resume = resume if isinstance(resume, str) else ""
            if told.get("resumed") is not True:  # another session: its frames count from 1
                self._frame = self._final = None
                self._taken = self._newest = 0
            missed = self._wanted.welcome(view if isinstance(view, dict) else {}, seq if isinstance(seq, int) else 0)
            self._seq = max(self._seq, self._wanted.seq)
            self._change.notify_all()
            return missed

    def _run(self) -> None:
        """The thread: receives until the end."""
        why: Optional[errors.ScancastError] = None
        try:
            while why is None:
                try:
                    self._receive()
                    return
                except errors.ScancastError as error:
                    if self._closed or not self._comes_back(error):
                        why = error
        finally:  # whatever happened, nobody waits for this thread any more
            with self._change:
                if not self._closed:
                    self._error = self._error or why or errors.BadAnswer("what the server sent could not be understood")
                self._connected = False
                self._change.notify_all()
            self._socket.drop()

    def _receive(self) -> None:
        """Until this side has closed, or something is wrong."""
        leave_at: Optional[float] = None
        while True:
            left = 0.5 if leave_at is None else min(0.5, leave_at - time.monotonic())
            if left <= 0:
                raise _Ended(1012, "it is about to leave")
            message = self._socket.receive(left)
            if message is None:
                if self._closed:
                    return
                continue
            if message.kind == CLOSE:
                if self._closed:
                    return
                raise _Ended(*message.data)
            if message.kind == BINARY:
                self._take_frame(parse_frame(message.data))  # type: ignore[arg-type]
                continue
            told = _read_json(str(message.data))
            if told.get("type") == "drain":
                after = told.get("afterMilliseconds")
                seconds = as_float(after) / 1000 if isinstance(after, (int, float)) else 0.0
                if not math.isnan(seconds):
                    leave_at = time.monotonic() + min(_LONGEST_STAY, seconds)
            else:
                self._take(told)

    def _take_frame(self, frame: Frame) -> None:
        if not self._closed:
            self._socket.send_text(json.dumps({"type": "ack", "frame": frame.id}))
        with self._change:
            if self._frame is not None and self._frame.id != self._taken:
                self.skipped += 1
            self._frame, self._newest = frame, frame.id
            self._wanted.shown(frame.seq)
            if frame.final:
                self._final = frame
            self._change.notify_all()

    def _take(self, told: Dict[str, Any]) -> None:
        kind, seq = told.get("type"), told.get("seq")
        refusal: Optional[errors.ScancastError] = None
        if kind == "problem":
            refusal = _refusal(told)
            given = self._unknown.pop(seq, None) if isinstance(seq, int) else None
            if given is not None and isinstance(refusal, errors.InvalidArgument):
                refusal = self._judge(refusal, given)
        with self._change:
            if kind == "stats":
                self.stats = told
            elif kind == "picked" and isinstance(seq, int) and seq in self._picks:
                self._picks[seq] = told.get("point")
            elif refusal is not None:
                of = seq if isinstance(seq, int) else None
                if of is not None:
                    self._wanted.refused(of)
                self._problems.append((of, refusal))
                del self._problems[:-_MOST_PROBLEMS]
            self._change.notify_all()

    # ---- coming back

    def _comes_back(self, error: errors.ScancastError) -> bool:
        """Tries to go on with the session, as long as that may help; False where it does not."""
        if not self._reconnect or not isinstance(error, errors.ConnectionFailed) or isinstance(error, WebSocketError):
            return False
        if isinstance(error, _Ended) and error.code not in _COMES_BACK:
            return False
        self._connected = False
        pause = 0.25
        while not self._closed:
            with self._change:
                hello = {**self._fixed, "resume": self._resume, **_said_first(self._wanted.view), "seq": self._wanted.seq, "frame": self._newest}
            try:
                socket, welcome = self._open(hello)
            except (errors.ConnectionFailed, errors.TimedOut, errors.Unavailable, errors.TooManyRequests) as again:
                if isinstance(again, _Ended) and again.code not in _COMES_BACK:
                    return False
                with self._change:
                    self._change.wait_for(lambda: self._closed, max(pause, again.retry_after or 0))
                pause = min(2 * pause, _LONGEST_PAUSE)
                continue
            except errors.ScancastError as final:
                self._error = final
                return False
            with self._change:
                before, self._socket, self._welcome = self._socket, socket, welcome
            before.say_close(1000)
            before.drop()
            missed = self._welcomed()
            self._connected = True
            try:
                if self._quality:
                    self._say(self._quality)
                if missed:
                    self._say({"type": "view", **self._wanted.view, "seq": self._wanted.seq})
            except errors.ScancastError:
                pass  # lost again: the thread finds out
            if self._closed:
                socket.say_close(1000)
            return True
        return False


def _said_first(view: Mapping[str, Any]) -> Dict[str, Any]:
    """Of a hello: what the picture is to be."""
    rest = {name: value for name, value in view.items() if name not in ("width", "height")}
    said: Dict[str, Any] = {"width": view.get("width", 1280), "height": view.get("height", 720)}
    return {**said, "view": rest} if rest else said


def _refusal(told: Mapping[str, Any]) -> errors.Refused:
    problem = told.get("problem")
    return errors.problem(problem if isinstance(problem, dict) else {})
