"""What a file itself says that it holds, found without any of the product's code: the other voice in survey.py's comparisons.

Each reader here is short and slow, goes by the format's published description, and looks at nothing but counts, ranges of coordinates and
whatever else is cheap. What it cannot make sense of it calls broken, with the reason.
"""
import dataclasses
import math


@dataclasses.dataclass
class Witness:
    format: str                  # the row of the table
    points: int | None = None    # None: nobody counted
    bounds: tuple | None = None  # ((least x, y, z), (greatest x, y, z)) of the points, those without a place left out
    step: float = 0.0            # how far bounds may be from each other: what the file's numbers can tell apart
    declared: tuple | None = None  # bounds that a header claims: writers are often wrong about them
    intensity: tuple | None = None  # (least, greatest)
    classes: dict | None = None  # class: points
    broken: str = ""             # why the file is not what its format asks for


class Broken(Exception):
    """The file is not what its format asks for: the reason."""


class Range:
    """The least and greatest of finite coordinates."""

    def __init__(self):
        self.least, self.greatest = [math.inf] * 3, [-math.inf] * 3

    def take(self, points):
        """`points`: an iterable of (x, y, z)."""
        points = [p for p in points if all(map(math.isfinite, p))]
        for axis, values in enumerate(zip(*points)):
            self.least[axis] = min(self.least[axis], min(values))
            self.greatest[axis] = max(self.greatest[axis], max(values))

    def bounds(self):
        return (tuple(self.least), tuple(self.greatest)) if self.least[0] <= self.greatest[0] else None
