"""Folders: EPT (Entwine, "Entwine Point Tile"), Potree 1 (cloud.js) and 2 (metadata.json): what their nodes sum up to."""
import glob
import json
import os
import struct

from declared import las
from declared.witness import Broken, Witness

POTREE_BYTES = {"POSITION_CARTESIAN": 12, "COLOR_PACKED": 4, "RGBA_PACKED": 4, "RGB_PACKED": 3, "NORMAL_FLOATS": 12,
                "INTENSITY": 2, "CLASSIFICATION": 1, "NORMAL_SPHEREMAPPED": 2, "NORMAL_OCT16": 2, "NORMAL": 12,
                "RETURN_NUMBER": 1, "NUMBER_OF_RETURNS": 1, "SOURCE_ID": 2, "GPS_TIME": 8, "INDICES": 4}


def kind_of(names):
    """Which octree a folder with these files is, or None."""
    if "ept.json" in names:
        return examine_ept
    if "cloud.js" in names:
        return examine_potree1
    return examine_potree2 if {"metadata.json", "octree.bin", "hierarchy.bin"} <= set(names) else None


def load(path):
    with open(path, "rb") as file:
        return json.loads(file.read().decode("utf-8-sig").rstrip("\0\n "))


def examine_ept(folder):
    about = load(os.path.join(folder, "ept.json"))
    nodes = {}
    for page in glob.glob(glob.escape(os.path.join(folder, "ept-hierarchy")) + "/*.json"):
        nodes.update((node, points) for node, points in load(page).items() if points >= 0)
    ending = {"laszip": "laz", "binary": "bin", "zstandard": "zst"}.get(about["dataType"])
    found = Witness("EPT " + about["dataType"], sum(nodes.values()))
    if not nodes:
        raise Broken("no hierarchy")
    conforming = about.get("boundsConforming") or about["bounds"]
    found.declared, found.step = (tuple(conforming[:3]), tuple(conforming[3:])), 0.01  # often in whole metres
    missing = [node for node, points in nodes.items()
               if points and not os.path.exists(os.path.join(folder, "ept-data", f"{node}.{ending}"))]
    if missing:
        found.broken = f"{len(missing)} nodes are not there, {missing[0]} for one"
    elif about.get("points") != found.points:
        found.broken = f"ept.json says {about.get('points')} points, the hierarchy {found.points}"
    return found


def examine_potree1(folder):
    about = load(os.path.join(folder, "cloud.js"))
    data = os.path.join(folder, about["octreeDir"])
    attributes = about["pointAttributes"]
    found = Witness("Potree 1", 0)
    nodes = [path for path in glob.glob(glob.escape(data) + "/**/r*", recursive=True)
             if os.path.isfile(path) and not path.endswith(".hrc")]
    if not nodes:
        raise Broken("no nodes")
    for path in nodes:
        if path.endswith((".las", ".laz")):
            found.points += las.examine(path).points or 0
        elif isinstance(attributes, list):
            width = sum(POTREE_BYTES[a] if isinstance(a, str) else a["size"] for a in attributes)
            found.points += os.path.getsize(path) // width
    return found


def examine_potree2(folder):
    about = load(os.path.join(folder, "metadata.json"))
    with open(os.path.join(folder, "hierarchy.bin"), "rb") as file:
        hierarchy = file.read()
    nodes = struct.iter_unpack("<BBIqq", hierarchy[:len(hierarchy) // 22 * 22])
    found = Witness("Potree 2", sum(points for kind, _, points, _, _ in nodes if kind != 2))  # 2: told in another chunk
    if found.points != about["points"]:
        found.broken = f"metadata.json says {about['points']} points, the hierarchy {found.points}"
    return found
