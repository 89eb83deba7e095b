"""Requests to a server: addresses, tokens, TLS, answers of bounded size, and waiting where a server asks for that.

Each request has a connection of its own, so everything here may be used from any thread.
"""
from __future__ import annotations

import contextlib
import http.client
import json
import re
import socket
import ssl
import threading
import time
from typing import Any, Callable, Dict, Iterator, Mapping, NamedTuple, Optional, TypeVar, Union
from urllib.parse import unquote, urlsplit

from . import errors
from ._values import as_float

T = TypeVar("T")
_TOKEN = re.compile(r"[\x21-\x7e]{1,8192}")
_JSON_LIMIT = 16 << 20
_PROBLEM_LIMIT = 256 << 10
_ANSWER_LIMIT = 129 << 20  # a photo may have 128 MiB; who asks for a picture says how large it is
_CHUNK = 1 << 20
_LONGEST_LINE = 1 << 16
_MOST_TRAILERS = 100
_ADVICE = "write something like http://127.0.0.1:8080/"


class Address(NamedTuple):
    """Where a server is."""

    tls: bool
    host: str
    port: int

    @property
    def authority(self) -> str:
        return f"[{self.host}]:{self.port}" if ":" in self.host else f"{self.host}:{self.port}"

    @property
    def url(self) -> str:
        return f"http{'s' if self.tls else ''}://{self.authority}/"


def parse_url(text: str) -> "tuple[Address, Optional[str]]":
    """The address, and a guest's token where it is a guest's link.

    >>> parse_url("https://scans.example.org")[0]
    Address(tls=True, host='scans.example.org', port=443)

    ValueError: no server's URL; a token in it is never repeated.
    """
    shown = text.split("#")[0]
    try:
        parts = urlsplit(text)
        port = parts.port
    except ValueError as error:
        raise ValueError(f"{shown!r} is no server's URL: {error}; {_ADVICE}") from None
    if parts.scheme not in ("http", "https", "ws", "wss"):
        raise ValueError(f"{shown!r} is no server's URL: it does not start with http:// or https://; {_ADVICE}")
    if parts.username is not None or not parts.hostname or not re.fullmatch(r"[A-Za-z0-9._:-]+", parts.hostname):
        raise ValueError(f"a server's URL has a host and nothing before it; {_ADVICE}")
    if parts.path not in ("", "/") or parts.query:
        raise ValueError(f"{shown!r} is no server's URL: nothing but / may follow the host and port; {_ADVICE}")
    tls = parts.scheme in ("https", "wss")
    guest = None
    for part in parts.fragment.split("&"):
        if part.startswith("guest="):
            guest = unquote(part[len("guest="):])
    return Address(tls, parts.hostname, port if port is not None else (443 if tls else 80)), guest


def checked_token(token: str) -> str:
    token = token.strip()
    if not _TOKEN.fullmatch(token):
        raise ValueError("an access token is one word of visible ASCII characters")
    return token


class Headers(Dict[str, str]):
    """By name, in any case; of several of a name, the last."""

    @classmethod
    def of(cls, response: http.client.HTTPResponse) -> "Headers":
        return cls({name.lower(): value for name, value in response.headers.items()})

    def get(self, name: str, default: Optional[str] = None) -> Optional[str]:  # type: ignore[override]
        return super().get(name.lower(), default)

    def text(self, name: str) -> str:
        return self.get(name) or ""


class Answer(NamedTuple):
    status: int
    headers: Headers
    body: bytes


class _Response(http.client.HTTPResponse):
    """Keeps what the standard library reads and throws away: the lines behind a body in chunks."""

    trailers: Optional[Headers] = None

    def _read_and_discard_trailer(self) -> None:
        self.trailers = Headers()
        for _ in range(_MOST_TRAILERS):
            line = self.fp.readline(_LONGEST_LINE + 1)
            if len(line) > _LONGEST_LINE:
                raise http.client.LineTooLong("trailer line")
            if line in (b"\r\n", b"\n", b""):
                return
            name, _colon, value = line.decode("latin-1").partition(":")
            self.trailers[name.strip().lower()] = value.strip()
        raise http.client.HTTPException("more lines behind a body than there can be")


class Body:
    """An answer's body while it comes: ``read(n)`` gives up to n bytes, b"" at its end, and never waits longer than the timeout."""

    def __init__(self, response: http.client.HTTPResponse, where: str) -> None:
        self._response = response
        self._where = where
        self.headers = Headers.of(response)

    def trailers(self) -> Headers:
        """What was said behind the body; nothing before it has been read."""
        return getattr(self._response, "trailers", None) or Headers()

    def read(self, size: int) -> bytes:
        with _told(self._where):
            data = self._response.read(size)
            left = getattr(self._response, "length", None)
            if not data and size > 0 and left:
                raise http.client.IncompleteRead(b"", left)
            return data


@contextlib.contextmanager
def _told(where: str) -> Iterator[None]:
    """Failures of the network as this package tells them."""
    try:
        yield
    except errors.ScancastError:
        raise
    except (socket.timeout, TimeoutError):
        raise errors.TimedOut(f"{where} has not answered in time") from None
    except ssl.SSLCertVerificationError as error:
        raise errors.ConnectionFailed(f"{where} shows a certificate that is not trusted ({error.verify_message}); ca_file names whom to trust") from None
    except http.client.IncompleteRead:
        raise errors.BadAnswer(f"{where} ended its answer early") from None
    except (http.client.HTTPException, ValueError) as error:
        raise errors.BadAnswer(f"{where} answered with what is no HTTP ({type(error).__name__}): is it a Scancast server?") from None
    except OSError as error:
        raise errors.ConnectionFailed(f"{where} cannot be reached: {error.strerror or error}") from None


class Transport:
    """How one server is asked."""

    def __init__(self, url: str, token: Optional[str], timeout: float, ca_file: Optional[str], patience: float) -> None:
        self.address, self._guest = parse_url(url)
        self._token = checked_token(token) if token is not None else None
        self.timeout = timeout
        self.patience = patience
        self.tls = ssl.create_default_context(cafile=ca_file) if self.address.tls else None
        if self.tls:
            self.tls.minimum_version = ssl.TLSVersion.TLSv1_2
        self._lock = threading.Lock()
        self._pass: Optional[str] = None
        self._pass_ends = 0.0

    # ---- who asks

    def token(self) -> Optional[str]:
        """What to show now: the access token, or a guest's pass, had anew where it is about to end."""
        if self._guest is None:
            return self._token
        with self._lock:
            if self._pass is None or time.monotonic() > self._pass_ends:
                told = self._json_of(self._once("POST", "/api/v1/guest-session", {"token": self._guest}, "application/json", None, _JSON_LIMIT))
                if not isinstance(told, dict) or not isinstance(told.get("token"), str):
                    raise errors.BadAnswer(f"{self.address.authority} gave a guest no pass: is it a Scancast server?")
                self._pass = checked_token(told["token"])
                seconds = told.get("expiresInSeconds")
                self._pass_ends = time.monotonic() + 0.8 * (as_float(seconds) if isinstance(seconds, (int, float)) else 60)
            return self._pass

    def _headers(self, body: Optional[bytes], accept: str, token: Optional[str], more: Optional[Mapping[str, str]]) -> Dict[str, str]:
        headers = {"Accept": accept, "Accept-Encoding": "identity", "User-Agent": "scancast-python"}
        if body is not None:
            headers["Content-Type"] = "application/json"
        if token:
            headers["Authorization"] = f"Bearer {token}"
        headers.update(more or {})
        return headers

    # ---- asking

    def json(self, method: str, path: str, body: Any = None) -> Any:
        return self._json_of(self.ask(method, path, body, "application/json", limit=_JSON_LIMIT))

    def _json_of(self, answer: Answer) -> Any:
        try:
            return json.loads(answer.body)
        except (ValueError, RecursionError):
            raise errors.BadAnswer(f"{self.address.authority} answered with what is no JSON: is it a Scancast server?") from None

    def ask(self, method: str, path: str, body: Any = None, accept: str = "*/*", headers: Optional[Mapping[str, str]] = None,
            limit: int = _ANSWER_LIMIT) -> Answer:
        """The answer, 304 included. Refusals are exceptions; those that say when to ask again are waited for, for `patience` seconds in all."""
        return self._patiently(lambda: self._once(method, path, body, accept, headers, limit, self.token()))

    def _patiently(self, ask: Callable[[], T]) -> T:
        end = time.monotonic() + self.patience
        while True:
            try:
                return ask()
            except errors.Refused as refusal:
                wait = refusal.retry_after
                if refusal.status not in (429, 503) or wait is None or time.monotonic() + wait > end:
                    raise
                time.sleep(wait or 0.05)

    def connection(self) -> http.client.HTTPConnection:
        host, port = self.address.host, self.address.port
        if self.tls:
            connection: http.client.HTTPConnection = http.client.HTTPSConnection(host, port, timeout=self.timeout, context=self.tls)
        else:
            connection = http.client.HTTPConnection(host, port, timeout=self.timeout)
        connection.response_class = _Response
        return connection

    @contextlib.contextmanager
    def _response(self, method: str, path: str, body: Any, accept: str, headers: Optional[Mapping[str, str]],
                  token: Optional[str]) -> Iterator[http.client.HTTPResponse]:
        where = self.address.authority
        data = json.dumps(body, allow_nan=False).encode() if body is not None else None
        connection = self.connection()
        try:
            with _told(where):
                connection.request(method, path, body=data, headers=self._headers(data, accept, token, headers))
                response = connection.getresponse()
                refused = self._refusal(response) if response.status >= 400 or response.status in (301, 302, 303, 307, 308) else None
            if refused:
                raise refused
            yield response
        finally:
            connection.close()

    def _refusal(self, response: http.client.HTTPResponse) -> errors.Refused:
        body = _read(response, _PROBLEM_LIMIT, self.address.authority)
        return refusal(self.address, response.status, Headers.of(response), body)

    def _once(self, method: str, path: str, body: Any, accept: str, headers: Optional[Mapping[str, str]], limit: int,
              token: Optional[str] = None) -> Answer:
        with self._response(method, path, body, accept, headers, token) as response:
            with _told(self.address.authority):
                return Answer(response.status, Headers.of(response), _read(response, limit, self.address.authority))

    @contextlib.contextmanager
    def stream(self, method: str, path: str, body: Any, accept: str) -> Iterator[Body]:
        """The answer's body, to be read as it comes."""
        with contextlib.ExitStack() as stack:
            def open_it() -> http.client.HTTPResponse:
                return stack.enter_context(self._response(method, path, body, accept, None, self.token()))
            yield Body(self._patiently(open_it), self.address.authority)


def _read(response: http.client.HTTPResponse, limit: int, where: str) -> bytes:
    """All of it, as it comes: what a head promises allocates nothing."""
    body = bytearray()
    while True:
        data = response.read(min(_CHUNK, limit + 1 - len(body)))
        if not data:
            break
        body += data
        if len(body) > limit:
            raise errors.BadAnswer(f"{where} answers with more than {limit} bytes")
    if getattr(response, "length", None):
        raise http.client.IncompleteRead(bytes(body))
    return bytes(body)


def refusal(address: Address, status: int, headers: Headers, body: Union[bytes, bytearray]) -> errors.Refused:
    """What a server refused with."""
    told: Any = None
    if (headers.get("Content-Type") or "").startswith("application/problem+json"):
        try:
            told = json.loads(bytes(body))
        except (ValueError, RecursionError):
            pass
    if not isinstance(told, dict):
        reason = http.client.responses.get(status, "")
        told = {"detail": f"{address.authority} answered {status} {reason}".rstrip() + ": is it a Scancast server?"}
    return errors.problem(told, status, headers.get("Retry-After"))
