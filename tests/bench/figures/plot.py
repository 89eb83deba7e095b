"""Line plots as SVG, readable on light and dark pages: axes with units, each line's name at its end, nothing else. Pure.

An SVG that a page shows as a picture follows the reader's colour scheme (prefers-color-scheme), but has a ground of its own, since pages choose
theirs by other means, too.
"""
import math
from xml.sax.saxutils import escape

# Told apart by colour-blind readers, too (Okabe and Ito's hues), darker on light ground and lighter on dark.
COLOURS = [("#0060a0", "#6db9f2"), ("#b84a00", "#ff9a56"), ("#00765a", "#3ccfa5"), ("#a03a78", "#ea9ccb"), ("#7a6200", "#e3c64a"), ("#4a4a4a", "#c4c4c4"),
           ("#5b3fb0", "#b3a2f4"), ("#a02020", "#f58a8a"), ("#2f6f1d", "#93d06f"), ("#006a78", "#63d0dd"), ("#6b4b2a", "#d3ad84")]
# A method has the same colour in every plot.
METHODS = ["point", "square", "circle", "paraboloid", "cone", "sphere", "hqs", "disc", "ewa", "voronoi", "pyramid"]
LEFT, TOP, WIDTH, HEIGHT, RIGHT, BOTTOM = 74, 46, 540, 320, 170, 58


class Axis:
    """Values to places, and where its ticks stand. `low` and `high` of a logarithmic axis are above 0."""

    def __init__(self, label, values, log=False, zero=False):
        self.label, self.log = label, log
        low, high = min(values), max(values)
        if log:
            self.low, self.high = math.log10(low), math.log10(high)
            if self.high - self.low < 1e-9:
                self.low, self.high = self.low - 0.5, self.high + 0.5
        else:
            self.low, self.high = (0 if zero else low), high
            if self.high - self.low < 1e-9:
                self.high = self.low + 1
        if not log and zero:
            self.high = self.ticks()[-1] if self.ticks()[-1] >= high else self.ticks()[-1] + self.step()
        elif log and zero:  # of values, which need air above and below
            room = max(0.06 * (self.high - self.low), 0.05)
            self.low, self.high = self.low - room, self.high + room

    def step(self):
        raw = (self.high - self.low) / 5
        power = 10 ** math.floor(math.log10(raw))
        return next(factor * power for factor in (1, 2, 2.5, 5, 10) if factor * power >= raw * 0.999)

    def ticks(self):
        if not self.log:
            step = self.step()
            first = math.ceil(self.low / step - 1e-9)
            return [n * step for n in range(first, int(math.floor(self.high / step + 1e-9)) + 1)]
        decades = range(math.floor(self.low), math.ceil(self.high) + 1)
        for digits in ((1,), (1, 3), (1, 2, 5), (1, 1.5, 2, 3, 4, 5, 6, 7, 8, 9)):
            found = [d * 10.0**e for e in decades for d in digits if self.low - 1e-9 <= math.log10(d * 10.0**e) <= self.high + 1e-9]
            if len(found) >= 3:
                return found
        return found

    def at(self, value):
        """0 to 1."""
        return ((math.log10(value) if self.log else value) - self.low) / (self.high - self.low)


def plain(value):
    for factor, letter in ((1e9, "G"), (1e6, "M"), (1e3, "k")):
        if value >= factor:
            return f"{value / factor:g}{letter}"
    return f"{value:.6g}"


def apart(places, least):
    """Moves places, in order, so that they are `least` from each other and stay near where they were."""
    order = sorted(range(len(places)), key=lambda i: places[i])
    groups = []  # [indices, middle]
    for i in order:
        groups.append([[i], places[i]])
        while len(groups) > 1:
            (a, at), (b, bt) = groups[-2], groups[-1]
            if bt - at >= least * (len(a) + len(b)) / 2:
                break
            groups[-2:] = [[a + b, (at * len(a) + bt * len(b)) / (len(a) + len(b))]]
    result = list(places)
    for members, middle in groups:
        for n, i in enumerate(members):
            result[i] = middle + least * (n - (len(members) - 1) / 2)
    return result


def colours_of(names):
    """Places in COLOURS: a method's own, and what the methods of this plot leave for the others, from the end."""
    own = [METHODS.index(name) if name in METHODS else None for name in names]
    free = [i for i in reversed(range(len(COLOURS))) if i not in own] or [0]
    others = (free[i % len(free)] for i in range(len(names)))
    return [next(others) if colour is None else colour for colour in own]


def lines(title, x_label, y_label, series, log_x=False, log_y=False, ticks_x=None, name_of=plain):
    """The SVG's text. `series`: [(name, [(x, y), …])], at least one with a point; ticks_x: the places to name, by name_of(x)."""
    series = [(name, sorted(points)) for name, points in series if points]
    if not series:
        raise ValueError(f"'{title}': there is nothing to plot")
    x = Axis(x_label, [p[0] for _, points in series for p in points], log_x)
    y = Axis(y_label, [p[1] for _, points in series for p in points], log_y, zero=True)
    place_x = lambda value: LEFT + WIDTH * x.at(value)
    place_y = lambda value: TOP + HEIGHT * (1 - y.at(value))
    total = LEFT + WIDTH + RIGHT, TOP + HEIGHT + BOTTOM
    pick = lambda which: "".join(f".c{i}{{stroke:{c[which]}}}.f{i}{{fill:{c[which]}}}" for i, c in enumerate(COLOURS))
    out = [f'<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {total[0]} {total[1]}" font-family="system-ui, sans-serif" font-size="13" role="img">',
           f"<title>{escape(title)}</title>",
           f"<style>.g{{fill:#fff}}text{{fill:#333}}.h{{font-weight:600}}.r{{stroke:#ddd}}.a{{stroke:#888}}.l{{fill:none;stroke-width:2}}{pick(0)}",
           f"@media(prefers-color-scheme:dark){{.g{{fill:#15191e}}text{{fill:#ccc}}.r{{stroke:#333a42}}.a{{stroke:#7a828c}}{pick(1)}}}</style>",
           f'<rect class="g" width="{total[0]}" height="{total[1]}"/>', f'<text class="h" x="{LEFT}" y="24">{escape(title)}</text>']
    for value in y.ticks():
        at = place_y(value)
        out.append(f'<path class="r" d="M{LEFT} {at:.1f}h{WIDTH}"/><text x="{LEFT - 8}" y="{at + 4.5:.1f}" text-anchor="end">{plain(value)}</text>')
    for value in ticks_x or x.ticks():
        at = place_x(value)
        out.append(f'<path class="a" d="M{at:.1f} {TOP + HEIGHT}v5"/><text x="{at:.1f}" y="{TOP + HEIGHT + 21}" text-anchor="middle">{escape(name_of(value))}</text>')
    out.append(f'<path class="a" d="M{LEFT} {TOP + HEIGHT}h{WIDTH}"/>')
    out.append(f'<text x="{LEFT + WIDTH / 2}" y="{TOP + HEIGHT + 46}" text-anchor="middle">{escape(x_label)}</text>')
    out.append(f'<text transform="translate(18 {TOP + HEIGHT / 2}) rotate(-90)" text-anchor="middle">{escape(y_label)}</text>')
    names = apart([place_y(points[-1][1]) for _, points in series], 16)
    colours = colours_of([name for name, _ in series])
    for (name, points), name_y, colour in zip(series, names, colours):
        places = [(place_x(a), place_y(b)) for a, b in points]
        out.append(f'<polyline class="l c{colour}" points="{" ".join(f"{a:.1f},{b:.1f}" for a, b in places)}"/>')
        out += [f'<circle class="f{colour}" cx="{a:.1f}" cy="{b:.1f}" r="3"/>' for a, b in places]
        end = places[-1]
        out.append(f'<path class="l c{colour}" style="stroke-width:1" d="M{end[0] + 4:.1f} {end[1]:.1f}L{LEFT + WIDTH + 12} {name_y:.1f}"/>'
                   f'<text class="f{colour}" x="{LEFT + WIDTH + 16}" y="{name_y + 4.5:.1f}">{escape(name)}</text>')
    return "\n".join(out + ["</svg>"]) + "\n"
