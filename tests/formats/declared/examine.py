"""Which of the readers here a file or folder is for, by its content as far as that says anything."""
import os
import struct
import xml.etree.ElementTree

from declared import e57, las, octrees, pcd, ply, text
from declared.witness import Broken, Witness

TEXTS = (".xyz", ".txt", ".csv", ".asc", ".pts", ".ptx", ".neu", ".xyb", ".xyzn", ".xyzi", ".xyzrgb", ".xyzc", ".pwn")
TROUBLE = (Broken, ValueError, KeyError, IndexError, TypeError, AttributeError, struct.error, OSError,
           xml.etree.ElementTree.ParseError)


def reader_of(path):
    """(row of the table, function), or (row, None) for what nobody here reads."""
    if os.path.isdir(path):
        return "octree", octrees.kind_of(os.listdir(path))
    with open(path, "rb") as file:
        start = file.read(4096)
    ending = os.path.splitext(path)[1].lower()
    if start.startswith(b"LASF"):
        return "LAS", las.examine
    if start.startswith(b"ASTM-E57"):
        return "E57", e57.examine
    if start[:4].rstrip(b"\r\n \t") == b"ply":
        return "PLY", ply.examine
    if ending == ".pcd":
        return "PCD", pcd.examine
    if ending == ".obj":
        return "OBJ", text.examine_obj
    if ending in TEXTS:
        return "PTS" if ending == ".pts" else "PTX" if ending == ".ptx" else "text", text.examine
    of_its_ending = {".las": "LAS", ".laz": "LAZ", ".e57": "E57", ".ply": "PLY"}.get(ending)
    return of_its_ending or "other", None


def examine(path):
    """Never raises for what a file holds."""
    row, reader = reader_of(path)
    if reader is None:
        return Witness(row, broken="" if row == "other" else "its content is of something else")
    try:
        return reader(path)
    except TROUBLE as fault:
        return Witness(row, broken=str(fault) or type(fault).__name__)
