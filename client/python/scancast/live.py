"""A live view: views go to the server, frames come back as they are drawn.

A thread of its own receives: it acknowledges each frame when it has arrived, answers the server's pings, keeps the newest frame, and comes back when
the connection is lost - the session goes on then, at this server or at another that has its keys. Everything else may be called from any thread.
"""
from __future__ import annotations

import time
from typing import TYPE_CHECKING, Any, Callable, Iterator, Optional

from . import errors, words
from ._decode import decode
from ._session import Session
from .facts import PickedPoint
from .frames import Frame
from .words import AnyView, view_json

if TYPE_CHECKING:
    from typing_extensions import Unpack

    from ._view_words import ViewWords


class LiveView(Session):
    """A session with a server. ``cloud.live(…)`` opens it; ``with`` closes it.

    >>> with cloud.live(width=640, height=360) as live:          # doctest: +SKIP
    ...     live.still(eye=(10, 0, 2)).array()                    # that view, in full quality
    ...     live.view(eye=(12, 0, 2))                             # asks, and does not wait
    ...     for frame in live:                                    # the newest frame, whenever there is a newer one
    ...         print(frame.seq, frame.final)

    What the server refuses - a word that is none - is raised where a frame is waited for, and leaves the view as it was. So is the end of the
    connection, where the view cannot come back.
    """

    def __repr__(self) -> str:
        return f"<LiveView of {self._welcome.get('cloud')!r} at {self._transport.address.url}>"

    def __enter__(self) -> "LiveView":
        return self

    def __exit__(self, *_: Any) -> None:
        self.close()

    # ---- what it is

    @property
    def session(self) -> str:
        """Its id: who knows it may follow and drive this session."""
        return str(self._welcome.get("session", ""))

    @property
    def connected(self) -> bool:
        """False while the connection is lost and is being made anew."""
        return self._connected and not self._closed

    # ---- asking

    def view(self, view: AnyView = None, **given: "Unpack[ViewWords]") -> int:
        """Asks for another view, and does not wait: of all that are asked for, the newest is drawn. What is not given stays.
        The result is the ``seq`` of frames that show it."""
        change = view_json(view, given)
        with self._change:
            self._seq += 1
            seq = self._seq
            self._wanted.ask(seq, change)
            if words.unknown(given):
                self._unknown = {**dict(list(self._unknown.items())[-8:]), seq: dict(given)}
        self._say({"type": "view", **change, "seq": seq})
        return seq

    def quality(self, *, fps: Optional[float] = None, min_resolution: Optional[float] = None, max_detail: Optional[float] = None,
                min_quality: Optional[int] = None) -> None:
        """How far quality may fall while the view moves."""
        given = {"fps": fps, "minResolution": min_resolution, "maxDetail": max_detail, "minQuality": min_quality}
        self._quality = {"type": "quality", **{name: value for name, value in given.items() if value is not None}}
        self._say(self._quality)

    def still(self, view: AnyView = None, *, timeout: Optional[float] = None, **given: "Unpack[ViewWords]") -> Frame:
        """A view's frame in full quality. Without a view, that of the one that was asked for last. TimedOut after `timeout` seconds, by default
        the server's; what the server refuses."""
        seq = self.view(view, **given) if view is not None or given else self._wanted.seq
        with self._change:
            def there() -> bool:
                return self._final is not None and self._final.seq >= seq
            self._await(there, timeout, "a picture in full quality", seq)
            final = self._final
            assert final is not None
            self._taken = max(self._taken, final.id)
            return final

    def frame(self, timeout: Optional[float] = None) -> Frame:
        """The newest frame, as soon as there is a newer one than that which was taken last. TimedOut where nothing came for `timeout` seconds: nothing
        comes where nothing changes."""
        with self._change:
            self._await(lambda: self._frame is not None and self._frame.id != self._taken, timeout, "a frame", None)
            frame = self._frame
            assert frame is not None
            self._taken = frame.id
            return frame

    def __iter__(self) -> Iterator[Frame]:
        """The newest frame, again and again, until the view is closed. Waits as long as nothing changes."""
        while True:
            with self._change:
                self._await(lambda: self._closed or (self._frame is not None and self._frame.id != self._taken), float("inf"), "a frame", None)
                if self._closed:
                    return
                frame = self._frame
                assert frame is not None
                self._taken = frame.id
            yield frame

    def pick(self, x: float, y: float, *, timeout: Optional[float] = None) -> Optional[PickedPoint]:
        """The scan's point under a pixel of the view that was asked for last, at its full size; None for background."""
        with self._change:
            self._seq += 1
            seq = self._seq
            self._picks[seq] = self._picks  # nothing yet
        try:
            self._say({"type": "pick", "seq": seq, "x": x, "y": y})
            with self._change:
                self._await(lambda: self._picks[seq] is not self._picks, timeout, "a picked point", seq)
                told = self._picks[seq]
        finally:
            with self._change:
                del self._picks[seq]
        return None if told is None else decode(PickedPoint, told, "point")

    def _await(self, there: Callable[[], bool], timeout: Optional[float], what: str, seq: Optional[int]) -> None:
        """Waits, with the lock; raises a problem - of `seq` only, where that is said -, or the end."""
        until = time.monotonic() + (self._transport.timeout if timeout is None else timeout)
        while True:
            for i, (of, problem) in enumerate(self._problems):
                if seq is None or of is None or of == seq:
                    del self._problems[i]
                    raise problem
            if there():
                return
            if self._error is not None:
                raise self._error
            if self._closed:
                raise errors.ConnectionFailed("this view has been closed")
            left = until - time.monotonic()
            if left <= 0:
                raise errors.TimedOut(f"{what} did not come in time")
            self._change.wait(min(left, 3600.0))
