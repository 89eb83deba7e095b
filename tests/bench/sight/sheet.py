"""A contact sheet: small pictures in a grid, a name and a mark under each.

Belongs to first_sight.py and every_method.py. Sizes are in pixels; colours are sRGB bytes, and are averaged as they are.
"""
from itertools import accumulate
from operator import add, sub
from typing import NamedTuple

import png_file
from sight import label

WIDE, HIGH, COLUMNS, GAP = 320, 180, 4, 8
NAME, DETAIL = 2 * label.HIGH, label.HIGH  # heights of the two lines of text
BENEATH = 4 + NAME + 4 + DETAIL + GAP     # all that stands under a picture
BEHIND, TEXT, QUIET = (24, 25, 28), (235, 235, 235), (150, 152, 158)
MARKS = {"pass": (46, 178, 82), "fail": (222, 56, 48)}  # of other words: QUIET


class Entry(NamedTuple):
    name: str
    mark: str      # "pass", "fail", or something else
    detail: str    # a line in small letters
    small: png_file.Picture  # of shrunk()


def shrunk(picture, most_wide=WIDE, most_high=HIGH):
    """RGB of a picture of 3 channels or more, as large as fits, its shape kept; each pixel is the mean of those beneath it."""
    scale = min(most_wide / picture.width, most_high / picture.height, 1)
    wide, high = max(round(picture.width * scale), 1), max(round(picture.height * scale), 1)
    lefts = [x * picture.width // wide for x in range(wide + 1)]
    tops = [y * picture.height // high for y in range(high + 1)]
    done = bytearray(3 * wide * high)
    for channel in range(3):
        values, means = picture.channel(channel), []
        for top, bottom in zip(tops, tops[1:]):
            total = values[top * picture.width:(top + 1) * picture.width]
            for y in range(top + 1, bottom):
                total = map(add, total, values[y * picture.width:(y + 1) * picture.width])
            sums = list(accumulate(total, initial=0))
            edges = [sums[x] for x in lefts]
            rows = bottom - top
            means += [box // ((right - left) * rows) for box, left, right in zip(map(sub, edges[1:], edges), lefts, lefts[1:])]
        done[channel::3] = bytes(means)
    return png_file.Picture(wide, high, 3, bytes(done))


def sheet(entries, wide=WIDE, high=HIGH):
    """The picture of them all, no small one larger than `wide` x `high`; or None of none."""
    if not entries:
        return None
    width = GAP + COLUMNS * (wide + GAP)
    height = GAP + -(-len(entries) // COLUMNS) * (high + BENEATH)
    pixels = bytearray(bytes(BEHIND) * (width * height))
    for number, entry in enumerate(entries):
        x, y = GAP + number % COLUMNS * (wide + GAP), GAP + number // COLUMNS * (high + BENEATH)
        put(pixels, width, x + (wide - entry.small.width) // 2, y + (high - entry.small.height) // 2, entry.small)
        y += high + 4
        label.fill(pixels, width, x, y, NAME, NAME, MARKS.get(entry.mark, QUIET))
        beside, room = x + NAME + 6, wide - NAME - 6
        scale = 2 if label.PITCH * 2 * len(entry.name) <= room else 1
        label.draw(pixels, width, beside, y + (NAME - label.HIGH * scale) // 2, label.fitting(entry.name, room, scale), TEXT, scale)
        label.draw(pixels, width, x, y + NAME + 4, label.fitting(entry.detail, wide, 1), QUIET)
    return png_file.Picture(width, height, 3, bytes(pixels))


def put(pixels, width, x, y, picture):
    wide = 3 * picture.width
    for row in range(picture.height):
        at = 3 * ((y + row) * width + x)
        pixels[at:at + wide] = picture.pixels[row * wide:(row + 1) * wide]
