"""Two builds in turn, and whether the new one became slower. Pure but for `measured`, which calls what measures.

Machines are noisy for minutes at a time, so the two are compared pair by pair: what was measured one after the other. A row is slower where the
median of its pairs is above the limit and all pairs but one are above half of it: one lucky or unlucky round decides nothing. It counts only when the
same happens once more, from the beginning. Less is better everywhere: milliseconds, seconds, bytes.
"""
import statistics
from dataclasses import dataclass, field

LIMIT = 1.10
ROUNDS = 5


@dataclass
class Row:
    name: str
    unit: str = "ms"
    old: list = field(default_factory=list)
    new: list = field(default_factory=list)
    says: str = ""  # why it could not be compared
    first: float = 0  # the ratio of the first time, where it was measured twice

    def ratio(self):
        return ratio(self.old, self.new)


def ratio(old, new):
    return statistics.median(b / a for a, b in zip(old, new))


def verdict(old, new, limit=LIMIT):
    """slower, faster or same."""
    pairs = sorted(b / a for a, b in zip(old, new))
    middle, half = statistics.median(pairs), 1 + (limit - 1) / 2
    if middle > limit and (pairs[1] if len(pairs) > 2 else pairs[0]) > half:
        return "slower"
    if middle < 1 / limit and (pairs[-2] if len(pairs) > 2 else pairs[-1]) < 1 / half:
        return "faster"
    return "same"


def measured(name, unit, old, new, rounds=ROUNDS, limit=LIMIT):
    """A row: both measured in turn, the order changing with each round; once more where the new one seems slower. `old` and `new` give a number, or
    raise Unable with what the program said."""
    row = Row(name, unit)
    for again in (False, True):
        row.old, row.new = [], []
        for number in range(rounds):
            both = [(old, row.old, "the old build"), (new, row.new, "this build")]
            for call, values, who in both if number % 2 == 0 else reversed(both):
                try:
                    values.append(call())
                except Unable as problem:
                    row.says = f"{who} says: {problem}"
                    return row
        if again or verdict(row.old, row.new, limit) != "slower":
            return row
        row.first = row.ratio()
    return row


class Unable(Exception):
    """A build that cannot do what is asked: an old one without a flag, a command, a format."""


def judged(rows, limit=LIMIT):
    """Those that became slower."""
    return [row for row in rows if not row.says and row.old and verdict(row.old, row.new, limit) == "slower"]
