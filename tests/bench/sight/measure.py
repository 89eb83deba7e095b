"""What makes a first picture of a scan a good one, in numbers: of its covered pixels, and of the frame.

Belongs to first_sight.py; pure functions of pictures (png_file.Picture), no files, no processes. Three pictures of one view:
  seen     the picture as people get it, RGB over its own background. Everything but the noise is measured here, so that points
           too thin to be seen through the background count as what they look like;
  cut_out  the same with a transparent background, RGBA, straight alpha. A pixel is covered where alpha > 0;
  points   the same view with --color rgb --method point --shading unlit, transparent too, or None.
Noise compares the colours of `cut_out` and `points`: those of the scan alone, so that a hole between two points is no noise
of their colours.

Luminance is 0.2126 R + 0.7152 G + 0.0722 B of sRGB bytes / 255: weights of Rec. 709, no gamma taken out. Inside it is a
whole number, 0 to 2,550,000. Percentiles are nearest ranks.
"""
from collections import Counter
from itertools import accumulate, compress
from operator import ne

FILL = 0.75           # least share of the width or of the height that the 1-99 % box takes
MIDDLE = 0.08         # the most that the box's middle is off the picture's, of the width and of the height
TOUCHED = 0.02        # most of the outermost pixels that an object may cover
TOUCHED_AROUND = 0.60 # the same where the picture is a landscape or is seen from inside
SPREAD = 0.25         # least distance of the 5th and 95th percentile of luminance
DARKEST, BRIGHTEST = 0.12, 0.85  # for the median of luminance
ONE_COLOUR = 0.35     # most that one colour of 4 bits a channel takes of the covered pixels
EDGES = 0.03          # least share of covered pixels where luminance changes by more than
STEEP = 0.08          # this much a pixel
NOISE = 0.004         # by so much - one step of a byte - local noise may be above that of the points

LUMINANCE_ONE = 2_550_000
RED = [2126 * byte for byte in range(256)]
GREEN = [7152 * byte for byte in range(256)]
BLUE = [722 * byte for byte in range(256)]
COVERED = b"\0" + b"\1" * 255     # alpha to a mask
FOUR_BITS = bytes(byte >> 4 for byte in range(256))
NOTHING = -1                      # in place of the luminance of a pixel that is not covered
MANY = 5                          # of nine pixels: where fewer are covered there is no neighbourhood to speak of
ENOUGH = 200                      # pixels with a neighbourhood; a median of fewer is not one

AROUND = {"airborne", "street", "indoor", "depth-frame"}  # kinds of scans that go on beyond the picture


def touched_allowed(look, unknown_as="object"):
    """How much of the border may be covered: `look` is that member of `scancast info --json FILE`, or None."""
    kind = look.get("kind") if isinstance(look, dict) else None
    if isinstance(look, dict) and look.get("inside"):
        return TOUCHED_AROUND
    if kind is None:
        return TOUCHED_AROUND if unknown_as == "landscape" else TOUCHED
    return TOUCHED_AROUND if kind in AROUND else TOUCHED


def measured(seen, cut_out, points=None):
    """{name: number}; only `covered`, 0, where nothing is covered. Shares are of 1, luminances too."""
    if (seen.width, seen.height) != (cut_out.width, cut_out.height):
        raise ValueError("the pictures are not of one size")
    mask = cut_out.channel(3).translate(COVERED)
    count = mask.count(1)
    numbers = {"covered": count / len(mask)}
    if not count:
        return numbers
    luminance = luminances(seen)
    numbers.update(box(mask, seen.width, seen.height))
    numbers["touched"] = border(mask, seen.width, seen.height)
    ordered = sorted(compress(luminance, mask))
    numbers["median"] = ranked(ordered, 0.5) / LUMINANCE_ONE
    numbers["spread"] = (ranked(ordered, 0.95) - ranked(ordered, 0.05)) / LUMINANCE_ONE
    colour, most = Counter(compress(zip(*(seen.channel(c).translate(FOUR_BITS) for c in range(3))), mask)).most_common(1)[0]
    numbers["one_colour"] = most / count
    numbers["colour"] = "#" + "".join(f"{level:x}" for level in colour)
    numbers["edges"] = steep(luminance, mask, seen.width) / count
    numbers["unlike"] = unlike(seen, cut_out) / count
    if points:
        numbers["noise"] = noise(cut_out)
        numbers["points_noise"] = noise(points)
    return numbers


def failed(numbers, touched):
    """[(criterion, sentence)] of what is not as it should be; `touched` is what touched_allowed() says."""
    if not numbers["covered"]:
        return [("empty", "nothing is covered")]
    wrong = []

    def check(criterion, good, sentence):
        if not good:
            wrong.append((criterion, sentence))

    width, height = numbers["fill"]
    check("fill", max(width, height) >= FILL, f"{width:.2f} x {height:.2f} < {FILL}")
    right, down = numbers["middle"]
    check("middle", max(abs(right), abs(down)) <= MIDDLE, f"{right:+.3f} {down:+.3f}, not within {MIDDLE}")
    check("border", numbers["touched"] <= touched, f"{numbers['touched']:.3f} > {touched}")
    check("spread", numbers["spread"] >= SPREAD, f"{numbers['spread']:.3f} < {SPREAD}")
    check("median", DARKEST <= numbers["median"] <= BRIGHTEST, f"{numbers['median']:.3f}, not {DARKEST} to {BRIGHTEST}")
    check("colour", numbers["one_colour"] <= ONE_COLOUR, f"{numbers['one_colour']:.3f} of {numbers['colour']} > {ONE_COLOUR}")
    check("edges", numbers["edges"] >= EDGES, f"{numbers['edges']:.4f} < {EDGES}")
    ours, theirs = numbers.get("noise"), numbers.get("points_noise")
    if ours is not None and theirs is not None:
        check("noise", ours <= theirs + NOISE, f"{ours:.4f} > {theirs:.4f} + {NOISE}")
    return wrong


def luminances(picture):
    red, green, blue = (picture.channel(c) for c in range(3))
    return [RED[r] + GREEN[g] + BLUE[b] for r, g, b in zip(red, green, blue)]


def ranked(ordered, share):
    return ordered[max(-int(-share * len(ordered) // 1) - 1, 0)]


def box(mask, width, height):
    """Of the 1st to 99th percentile of covered columns and rows: its share of both, and how far its middle is off, right and down."""
    columns = [mask[x::width].count(1) for x in range(width)]
    rows = [mask[y * width:(y + 1) * width].count(1) for y in range(height)]
    fill, middle = [], []
    for counts in (columns, rows):
        least, most = (spot(counts, percent) for percent in (1, 99))
        fill.append((most + 1 - least) / len(counts))
        middle.append((least + most + 1) / 2 / len(counts) - 0.5)
    return {"fill": fill, "middle": middle}


def spot(counts, percent):
    """The first place up to which so many are."""
    wanted = percent * sum(counts)
    return next(at for at, sofar in enumerate(accumulate(counts)) if 100 * sofar >= wanted)


def border(mask, width, height):
    pixels = mask[:width] + mask[width:-width:width] + mask[2 * width - 1:-width:width] + mask[(height - 1) * width:]
    return pixels.count(1) / len(pixels)


def rows_around(luminance, mask, width):
    """Rows of luminances, NOTHING where nothing is covered, with a ring of NOTHING around them."""
    values = [value if covered else NOTHING for value, covered in zip(luminance, mask)]
    empty = [NOTHING] * (width + 2)
    rows = [[NOTHING, *values[at:at + width], NOTHING] for at in range(0, len(values), width)]
    return [empty, *rows, empty]


def steep(luminance, mask, width):
    """How many covered pixels lie where luminance changes by more than STEEP a pixel. Differences are central, over two pixels;
    a neighbour that is not covered stands aside, so that the silhouette is no edge."""
    rows, limit, found = rows_around(luminance, mask, width), (2 * STEEP * LUMINANCE_ONE) ** 2, 0
    for above, row, below in zip(rows, rows[1:], rows[2:]):
        for left, here, right, up, down in zip(row, row[1:], row[2:], above[1:], below[1:]):
            if here < 0:
                continue
            # Twice the change a pixel: of two pixels' distance, or of one's where one neighbour is missing.
            if left < 0 or right < 0:
                across = 2 * (right - here) if right >= 0 else 2 * (here - left) if left >= 0 else 0
            else:
                across = right - left
            if up < 0 or down < 0:
                along = 2 * (down - here) if down >= 0 else 2 * (here - up) if up >= 0 else 0
            else:
                along = down - up
            if across * across + along * along > limit:
                found += 1
    return found


def noise(picture):
    """Median distance of a covered pixel's luminance from the median of the covered ones among the nine around it; None where
    too few pixels have a neighbourhood. Of an even number the upper of the two in the middle is the median."""
    mask = picture.channel(3).translate(COVERED)
    rows, distances = rows_around(luminances(picture), mask, picture.width), []
    for a, b, c in zip(rows, rows[1:], rows[2:]):
        for nine in zip(a, a[1:], a[2:], b, b[1:], b[2:], c, c[1:], c[2:]):
            here = nine[4]
            if here < 0:
                continue
            missing = nine.count(NOTHING)
            if missing <= 9 - MANY:
                distances.append(abs(here - sorted(nine)[(9 + missing) // 2]))
    return ranked(sorted(distances), 0.5) / LUMINANCE_ONE if len(distances) >= ENOUGH else None


def unlike(seen, cut_out):
    """How many opaque pixels the two pictures do not share: if there are many, the one says nothing of the other."""
    opaque = cut_out.channel(3).translate(bytes(255) + b"\1")
    differ = [map(ne, seen.channel(c), cut_out.channel(c)) for c in range(3)]
    return sum(compress(map(any, zip(*differ)), opaque))
