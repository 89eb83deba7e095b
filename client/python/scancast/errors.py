"""What can go wrong, as exceptions. All of them are ScancastError, whose text is a sentence for people.

What a server refuses comes as one of the classes by status (PROTOCOL.md, "Errors"), with all that the server said of it.
"""
from __future__ import annotations

from typing import Any, Dict, List, Mapping, NamedTuple, Optional, Type

from ._values import as_float, shown, snake
from ._view_words import PLACES

_PREFIX = "urn:scancast:problem:"
# The protocol's names of words, where Python's are others: sentences of a server use the former.
_RESPELLED = {place[-1]: word for word, place in PLACES.items() if place[-1] != word and word != "projection"}


def _as_python_says(text: str) -> str:
    for theirs, ours in _RESPELLED.items():
        text = text.replace(theirs, ours)
    return text


class FieldError(NamedTuple):
    """What is wrong with one word."""

    parameter: str
    """Its name, as Python has it: ``view_height``, or a path, ``camera.fov``."""
    detail: str


class ScancastError(Exception):
    """Anything that went wrong with a server."""

    status: int = 0
    """Of HTTP; 0 where the server did not get to answer."""
    type: str = ""
    """What kind of problem, in the protocol's words: ``invalid-argument``, ``resource-limit``, …; may be empty."""
    title: str = ""
    errors: List[FieldError]
    """Of each word that is wrong."""
    nearest: Dict[str, Any]
    """Words that would have to change for the picture to be drawn: ``cloud.snapshot(**{**words, **error.nearest})``."""
    price: Optional[float] = None
    """Of the picture, in milliseconds of a core, where that is the reason; ``limit``, what it may be."""
    limit: Optional[float] = None
    retry_after: Optional[float] = None
    """Seconds, after which it is worth asking again."""
    request_id: str = ""
    """By which the server's log knows the request."""

    def __init__(self, detail: str) -> None:
        detail = shown(detail)
        super().__init__(detail)
        self.detail = detail
        self.errors = []
        self.nearest = {}

    def _spell(self, theirs: str, ours: str) -> None:
        """Names a word as whoever wrote it did."""
        self.detail = self.detail.replace(theirs, ours)
        self.args = (self.detail,)
        self.errors = [FieldError(one.parameter, one.detail.replace(theirs, ours)) for one in self.errors]


class ConnectionFailed(ScancastError, ConnectionError):
    """There is no connection, or it broke."""


class TimedOut(ScancastError, TimeoutError):
    """The server said nothing for as long as ``timeout`` allows."""


class BadAnswer(ScancastError, ValueError):
    """What came is not what a Scancast server answers, or ended early."""


class MissingLibrary(ScancastError, ImportError):
    """An optional library is needed for this; the text says which, and how to get it."""


class Refused(ScancastError):
    """The server's answer is a problem."""


class InvalidArgument(Refused, ValueError):
    """400: a word that there is not, or a value out of its range."""


class Unauthorized(Refused, PermissionError):
    """401: the access token is missing or wrong."""


class Forbidden(Refused, PermissionError):
    """403: not for this client."""


class NotFound(Refused, LookupError):
    """404: no such cloud, photo, session."""


class Conflict(Refused):
    """409: not in this state."""


class TooLarge(Refused):
    """413: costs more than the server allows; ``nearest`` says what it would draw."""


class Impossible(Refused, ValueError):
    """422: a view that there cannot be, or something that this cloud lacks."""


class TooManyRequests(Refused):
    """429: later, ``retry_after`` says when."""


class ServerFault(Refused):
    """500: a fault of the server."""


class Unavailable(Refused):
    """503: later, ``retry_after`` says when."""


class DeadlineExceeded(Refused):
    """504: took too long."""


_BY_STATUS: Dict[int, Type[Refused]] = {
    400: InvalidArgument, 401: Unauthorized, 403: Forbidden, 404: NotFound, 409: Conflict, 413: TooLarge, 422: Impossible,
    429: TooManyRequests, 500: ServerFault, 503: Unavailable, 504: DeadlineExceeded,
}


def _number(value: Any) -> Optional[float]:
    return as_float(value) if isinstance(value, (int, float)) and not isinstance(value, bool) else None


def _seconds(text: Optional[str]) -> Optional[float]:
    return float(text) if text and text.isascii() and text.isdigit() and len(text) < 7 else None


def problem(told: Mapping[str, Any], status: int = 0, retry_after: Optional[str] = None) -> Refused:
    """The exception for a problem (RFC 9457) that a server told; nothing in it is taken for granted."""
    said = told.get("status")
    status = status or (said if isinstance(said, int) else 0)
    detail = str(told.get("detail") or told.get("title") or f"the server answered {status}")
    error = _BY_STATUS.get(status, Refused)(_as_python_says(detail))
    error.status = status
    error.type = shown(str(told.get("type") or ""))
    if error.type.startswith(_PREFIX):
        error.type = error.type[len(_PREFIX):]
    error.title = shown(str(told.get("title") or ""))
    error.request_id = shown(str(told.get("requestId") or ""))
    error.price, error.limit = _number(told.get("price")), _number(told.get("limit"))
    error.retry_after = _seconds(retry_after)
    wrong = told.get("errors")
    for one in wrong if isinstance(wrong, list) else ():
        if isinstance(one, dict):
            error.errors.append(FieldError(snake(shown(str(one.get("parameter", "")))), shown(_as_python_says(str(one.get("detail", ""))))))
    nearest = told.get("nearest")
    if isinstance(nearest, dict):
        error.nearest = {snake(str(word)): int(value) if isinstance(value, float) and value.is_integer() else value
                         for word, value in nearest.items()}
    return error


def needed(library: str, package: str, why: str) -> MissingLibrary:
    """For what needs a library that is not installed."""
    return MissingLibrary(f"{why} needs {library}, which is not installed here: pip install {package}, or, of Debian, "
                          f"apt-get install python3-{'pil' if package == 'pillow' else package}")
