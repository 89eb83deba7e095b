#!/usr/bin/python3
"""Compares a device of Scancast's with VTK on the same points, in turn, on this machine.

Two million points of a sphere in random order at 1280 x 720, every point drawn (no level of detail on either side),
from the view to RGBA in memory; encoding is left out on both sides. VTK draws by OpenGL (a software rasteriser where
there is no GPU) under a virtual screen. Prints medians, the ratios that the project promises (on the cpu device point
at least 40 x and 5 px paraboloids at least 15 x; on a software OpenGL driver point at least 6 x), and how far the cpu
device is from this machine's memory bandwidth.

    tests/bench/vs_vtk.py [--backend cpu|egl|osmesa] [--bin build/release/bin] [--json FILE]
                          [--bandwidth build/bench/bench/memory_bandwidth]

Needs Debian's python3-vtk9, python3-numpy, xvfb (deploy/packages/bench.txt).
"""
import argparse
import json
import os
import statistics
import subprocess
import sys
import tempfile
import time

from figures import told

WIDTH, HEIGHT, POINTS, ROUNDS, FRAMES = 1280, 720, 2_000_000, 5, 10
EYE, FOV = (0.0, -3.0, 0.6), 45.0  # the unit sphere fills most of the picture


def read_ply(path):
    """Positions and colours of a binary little-endian PLY, as numpy arrays."""
    import numpy
    types = {"float": "<f4", "double": "<f8", "uchar": "u1", "ushort": "<u2", "int": "<i4", "uint": "<u4"}
    with open(path, "rb") as ply:
        count, fields = 0, []
        while (line := ply.readline().decode("ascii").split()) != ["end_header"]:
            if line[:2] == ["element", "vertex"]:
                count = int(line[2])
            elif line[0] == "property":
                fields.append((line[2], types[line[1]]))
        rows = numpy.frombuffer(ply.read(), dtype=fields, count=count)
    xyz = numpy.stack([rows["x"], rows["y"], rows["z"]], axis=1).astype("f4")
    rgb = numpy.stack([rows["red"], rows["green"], rows["blue"]], axis=1).astype("u1")
    return numpy.ascontiguousarray(xyz), numpy.ascontiguousarray(rgb)


def vtk_frames(path, size):
    """Milliseconds per frame, view to RGBA; run in a process of its own, under a virtual screen."""
    import vtk
    from vtk.util import numpy_support
    xyz, rgb = read_ply(path)
    points = vtk.vtkPoints()
    points.SetData(numpy_support.numpy_to_vtk(xyz))
    cloud = vtk.vtkPolyData()
    cloud.SetPoints(points)
    colors = numpy_support.numpy_to_vtk(rgb)
    colors.SetName("rgb")
    cloud.GetPointData().SetScalars(colors)
    glyphs = vtk.vtkVertexGlyphFilter()
    glyphs.SetInputData(cloud)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(glyphs.GetOutputPort())
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetPointSize(size)
    actor.GetProperty().LightingOff()
    renderer = vtk.vtkRenderer()
    renderer.AddActor(actor)
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(1)
    window.SetMultiSamples(0)
    window.SetSize(WIDTH, HEIGHT)
    window.AddRenderer(renderer)
    camera = renderer.GetActiveCamera()
    camera.SetPosition(*EYE)
    camera.SetFocalPoint(0, 0, 0)
    camera.SetViewUp(0, 0, 1)
    camera.SetViewAngle(FOV)
    renderer.ResetCameraClippingRange()
    pixels = vtk.vtkUnsignedCharArray()
    times = []
    for frame in range(FRAMES + 2):
        camera.Azimuth(0.01)  # nothing may be reused from the frame before
        start = time.perf_counter()
        window.Render()
        window.GetRGBACharPixelData(0, 0, WIDTH - 1, HEIGHT - 1, 0, pixels)
        if frame >= 2:  # the first frames upload and compile
            times.append((time.perf_counter() - start) * 1000)
    return statistics.median(times)


def scancast_frames(binary, path, backend, flags):
    """Milliseconds per frame, view to RGBA: the whole frame without its encoding."""
    answer = subprocess.run(
        [binary, "render", path, "--brute-force", "--backend", backend, "--samples", "1", "--repeat", str(FRAMES + 2),
         "--orbit", "0.01", "--stats", "json", "--width", str(WIDTH), "--height", str(HEIGHT), "--fov", str(FOV),
         "--eye", ",".join(map(str, EYE)), "--target", "0,0,0", "--up", "0,0,1", *flags],
        check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    stats = json.loads(answer.stdout)
    encode = sum(stage["medianMs"] for stage in stats["stages"] if stage["name"] == "encode")
    return stats["medianMs"] - encode, stats


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    root = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..")
    parser.add_argument("--backend", choices=["cpu", "egl", "osmesa"], default="cpu", help="Scancast's device")
    parser.add_argument("--bin", default=os.path.join(root, "build/release/bin"), help="folder of the scancast program")
    parser.add_argument("--bandwidth", default=os.path.join(root, "build/bench/bench/memory_bandwidth"))
    parser.add_argument("--points", type=int, default=POINTS)
    parser.add_argument("--rounds", type=int, default=ROUNDS)
    told.add_option(parser)
    parser.add_argument("--vtk", nargs=2, metavar=("PLY", "SIZE"), help=argparse.SUPPRESS)
    arguments = parser.parse_args()
    if arguments.vtk:
        print(vtk_frames(arguments.vtk[0], float(arguments.vtk[1])))
        return
    scancast, points, rounds, sheet = os.path.join(arguments.bin, "scancast"), arguments.points, arguments.rounds, told.Told()
    on_cpu = arguments.backend == "cpu"
    cases = [("point", 1, ["--method", "point"], 40 if on_cpu else 6),
             ("paraboloid 5 px", 5, ["--method", "paraboloid", "--param", "sizePx=5"], 15 if on_cpu else None)]
    with tempfile.TemporaryDirectory() as folder:
        ply = os.path.join(folder, "sphere.ply")
        subprocess.run([scancast, "generate", "sphere", "--points", str(points), "--order", "random", "-o", ply],
                       check=True, stderr=subprocess.DEVNULL)
        bandwidth = None
        if on_cpu and os.path.exists(arguments.bandwidth):
            bandwidth = float(subprocess.run([arguments.bandwidth], check=True, stdout=subprocess.PIPE).stdout)
        print(f"{arguments.backend}: {points} points, {WIDTH} x {HEIGHT}, {os.cpu_count()} cores, medians of {rounds} "
              "rounds in turn")
        for name, size, flags, promised in cases:
            ours, theirs, ratios = [], [], []
            for _ in range(rounds):
                vtk = float(subprocess.run(["xvfb-run", "-a", sys.executable, __file__, "--vtk", ply, str(size)],
                                           check=True, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL).stdout)
                own, stats = scancast_frames(scancast, ply, arguments.backend, flags)
                theirs.append(vtk)
                ours.append(own)
                ratios.append(vtk / own)
            rate = points / statistics.median(ours) / 1000
            stages = ", ".join(f"{stage['name']} {stage['medianMs']:.2f}" for stage in stats["stages"])
            promise = f"; promised {promised} x" if promised else ""
            print(f"{name}: Scancast {statistics.median(ours):.2f} ms ({rate:.0f} Mpts/s), "
                  f"VTK {statistics.median(theirs):.1f} ms ({points / statistics.median(theirs) / 1000:.1f} Mpts/s): "
                  f"{statistics.median(ratios):.1f} x ({min(ratios):.1f} - {max(ratios):.1f}{promise})")
            print(f"  stages of the last round, ms: {stages}")
            sheet.figure(name, statistics.median(ratios), "x", low=min(ratios), high=max(ratios), least=promised, points=points,
                         reached=statistics.median(ratios) >= promised if promised else None, oursMs=statistics.median(ours),
                         theirsMs=statistics.median(theirs), bandwidth=bandwidth, rate=rate)
            if bandwidth:
                limit = bandwidth * 1000 / 16
                print(f"  {100 * rate / limit:.1f} % of the memory-bandwidth limit "
                      f"({bandwidth:.1f} GB/s read / 16 B a sample = {limit:.0f} Mpts/s)")
    sheet.write(arguments.json)


if __name__ == "__main__":
    main()
