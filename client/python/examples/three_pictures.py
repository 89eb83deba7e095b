#!/usr/bin/env python3
"""A cloud in three pictures side by side: as it is, its depth, and its heights from above. Needs NumPy and Pillow.

    three_pictures.py http://127.0.0.1:8080/ [CLOUD] -o three.jpg
"""
import argparse

import numpy
import PIL.Image

import scancast


def depth_as_grey(depth):
    """Near is bright; where nothing is, it is dark blue."""
    there = numpy.isfinite(depth)
    near, far = numpy.percentile(depth[there], (1, 99))
    grey = 235 - 200 * numpy.clip((depth - near) / max(far - near, 1e-9), 0, 1)
    return numpy.where(there[..., None], grey[..., None], (22, 25, 46)).astype(numpy.uint8)


def from_above(cloud, width, height):
    """All of it in plan, north up."""
    x, y, z = cloud.bounds.center
    across, along, up = cloud.bounds.size
    shown = 1.04 * max(along, across * height / width)
    return cloud.snapshot(projection="orthographic", view_height=shown, eye=(x, y, z + 2 * max(across, along, up)), target=(x, y, z), up=(0, 1, 0),
                          color="elevation", colormap="turbo", light={"occlusion": 0.6}, width=width, height=height)


def main():
    arguments = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    arguments.add_argument("server")
    arguments.add_argument("cloud", nargs="?")
    arguments.add_argument("-o", "--output", default="three.jpg")
    arguments.add_argument("--width", type=int, default=480)
    arguments.add_argument("--height", type=int, default=360)
    given = arguments.parse_args()
    size = {"width": given.width, "height": given.height}

    cloud = scancast.Server(given.server, patience=30).cloud(given.cloud)
    view = cloud.views(**size)[0]
    panels = [cloud.snapshot(view).array(), depth_as_grey(cloud.depth(view)), from_above(cloud, **size).array()]
    PIL.Image.fromarray(numpy.hstack([panel[..., :3] for panel in panels])).save(given.output, quality=88)
    print(f"{given.output}: {cloud.title}, {cloud.point_count:,} points")


if __name__ == "__main__":
    main()
