"""What a live view has been asked for, as far as it is known here: what to say when its connection is made anew. Pure."""
from __future__ import annotations

from typing import Any, Dict, List, Mapping, Tuple

from . import words

_MOST_CHANGES = 64


class Wanted:
    """The complete view that the server said, and the changes that were asked for since, each by its seq. A change that was refused is none."""

    def __init__(self) -> None:
        self._view: words.View = {}
        self._changes: List[Tuple[int, words.View]] = []
        self.seq = 0
        """Of the change that was asked for last."""

    def welcome(self, view: Mapping[str, Any], seq: int) -> bool:
        """What the server shows as the connection begins; whether it has missed what was asked for since."""
        missed = bool(self._changes) and self._changes[-1][0] > seq
        if not missed:
            self._changes.clear()
        self.shown(seq)
        if not self._view or not missed:
            self._view = dict(view)
        self.seq = max(self.seq, seq)
        return missed

    def ask(self, seq: int, change: words.View) -> None:
        self._changes.append((seq, change))
        self.seq = seq
        while len(self._changes) > _MOST_CHANGES:
            self._settle()

    def shown(self, seq: int) -> None:
        """A frame of that view came: it was not refused."""
        while self._changes and self._changes[0][0] <= seq:
            self._settle()

    def refused(self, seq: int) -> None:
        self._changes = [one for one in self._changes if one[0] != seq]

    def _settle(self) -> None:
        self._view = words.changed(self._view, self._changes.pop(0)[1])

    @property
    def view(self) -> Dict[str, Any]:
        """All of it."""
        view = self._view
        for _, change in self._changes:
            view = words.changed(view, change)
        return {name: value for name, value in view.items() if name != "cloud"}
