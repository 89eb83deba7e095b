"""A server: what clouds it has, how it draws, what it says of itself."""
from __future__ import annotations

import os
from typing import Any, Dict, List, Optional, Union

from . import errors
from ._decode import decode, decode_list
from ._http import Transport
from .cloud import Cloud
from .facts import CloudFacts, Methods, PendingCloud


class Server:
    """A Scancast server.

    >>> server = Server("http://127.0.0.1:8080/")           # doctest: +SKIP
    >>> [cloud.id for cloud in server.clouds()]              # doctest: +SKIP
    ['town']

    `url`: such as ``http://127.0.0.1:8080/``, or a guest's link, with all behind its ``#``. `token`: the access token, where the server wants one;
    `token_file`: a file that holds it, which keeps it out of notebooks. `timeout`: seconds that the server may be silent.
    `ca_file`: whom to trust to sign certificates, in PEM; the system's without. `patience`: seconds that a request may wait in all where the
    server says "ask again in …" (429, 503 with Retry-After); 0 raises at once.

    Nothing is connected before something is asked for; all calls may be made from any thread.
    """

    def __init__(self, url: str, token: Optional[str] = None, *, token_file: "Union[str, os.PathLike[str], None]" = None,
                 timeout: float = 60.0, ca_file: Optional[str] = None, patience: float = 0.0) -> None:
        if token is not None and token_file is not None:
            raise ValueError("token and token_file say the same thing; give one of them")
        if token_file is not None:
            with open(token_file, encoding="utf-8") as file:
                token = file.read(16384)
        self._transport = Transport(url, token, timeout, ca_file, patience)

    def __repr__(self) -> str:
        return f"Server({self.url!r})"

    @property
    def url(self) -> str:
        """Its address, without anything secret."""
        return self._transport.address.url

    def clouds(self) -> List[Cloud]:
        """All clouds that can be looked at."""
        return [Cloud(self._transport, facts) for facts in decode_list(CloudFacts, self._clouds(), "clouds")]

    def pending(self) -> List[PendingCloud]:
        """Clouds that cannot be looked at: not yet, or never; each says why."""
        return decode_list(PendingCloud, self._clouds(), "pending")

    def _clouds(self) -> Any:
        return self._transport.json("GET", "/api/v1/clouds")

    def cloud(self, id: Optional[str] = None) -> Cloud:
        """The cloud of that id; without one, the server's first. NotFound where there is none."""
        if id is not None:
            return Cloud(self._transport, Cloud.ask(self._transport, id))
        clouds = self.clouds()
        if not clouds:
            raise errors.NotFound("this server has no cloud to look at")
        return clouds[0]

    def methods(self) -> Methods:
        """All rendering methods with their parameters: ``server.methods()["ewa"].parameters``."""
        return decode(Methods, self._transport.json("GET", "/api/v1/methods"), "methods")

    def openapi(self) -> Dict[str, Any]:
        """The API as the server describes it for programs."""
        told = self._transport.json("GET", "/openapi.json")
        if not isinstance(told, dict):
            raise errors.BadAnswer("the server's /openapi.json is no object")
        return told

    def ready(self) -> bool:
        """Whether it takes requests: its device is up and its clouds are loaded."""
        try:
            return self._transport.ask("GET", "/readyz").status == 200
        except errors.Unavailable:
            return False
