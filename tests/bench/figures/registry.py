"""Every figure of docs/performance.md: what measures it, what that needs, and about how long it takes on two cores. A section's name is that of its
block on the page (page.py). What tests/bench has besides, and where its figures stand, is in NOT_HERE: a test holds both against the folder."""
from dataclasses import dataclass, field
from typing import Callable, Optional

from . import bench as needs
from .sections import before, drawing, formats, growth, once, pictures, scripts


@dataclass(frozen=True)
class Section:
    name: str
    heading: str  # of the page, where its block stands
    command: str  # that measures the same by itself, for readers
    minutes: float
    measure: Callable
    page: Callable
    needs: tuple = ()
    plots: Optional[Callable] = None
    asked: bool = field(default=False)  # only where --only names it: it takes long, or much

    def missing(self, bench):
        """What is not here, and how to get it, or nothing."""
        return "; ".join(filter(None, (need(bench) for need in self.needs)))


def own(name):
    return f"tests/bench/all.py --only {name}"


CLIENT = needs.program("scancast-client")
SECTIONS = [
    Section("vtk", "Against VTK", "tests/bench/vs_vtk.py", 3, scripts.measure_vtk, scripts.vtk_page, (needs.vtk,)),
    Section("town", "A town of 20 million points", "tests/bench/town.py", 2, scripts.measure_town, scripts.plain_page, (CLIENT, needs.numpy)),
    Section("truth", "How near to the truth", "build/bench/bench/compare_methods", 3, pictures.measure_truth, pictures.truth_page, (needs.tools("compare_methods"),)),
    Section("moves", "What moves", "build/bench/bench/bench_stability", 2, pictures.measure_moves, pictures.moves_page,
            (needs.tools("bench_stability"), needs.scans(*pictures.MOVING))),
    Section("fast", "How fast", own("fast"), 3, drawing.measure_fast, drawing.fast_page),
    Section("before", "Beside another build", own("before") + " --before OTHER/BUILD/bin/scancast", 20, before.measure_before, before.before_page, (before.old_build,)),
    Section("papers", "The papers' settings", "tests/bench/methods.py --only papers", 2, drawing.measure_papers, drawing.papers_page,
            (needs.tools("bench_surfel_methods"),), drawing.papers_plots),
    Section("points", "Points", own("points"), 2, growth.measure_points, growth.points_page, (), growth.points_plots),
    Section("pixels", "Pixels", own("pixels"), 4, growth.measure_pixels, growth.pixels_page, (), growth.pixels_plots),
    Section("tau", "Detail", own("tau"), 4, growth.measure_tau, growth.tau_page, (), growth.tau_plots),
    Section("threads", "Threads", own("threads"), 1, growth.measure_threads, growth.threads_page, (), growth.threads_plots),
    Section("clients", "Clients", own("clients"), 2, growth.measure_clients, growth.clients_page, (CLIENT,), growth.clients_plots),
    Section("ingest", "Cloud files", "tests/bench/ingest.py; tests/bench/first_picture.py", 4, scripts.measure_ingest, scripts.ingest_page),
    Section("formats", "Formats", own("formats"), 3, formats.measure_formats, formats.formats_page),
    Section("billion", "A billion points", "tests/bench/ingest.py --large 1G --memory-limit 4G --no-surfels", 12, scripts.measure_billion, scripts.billion_page,
            (CLIENT, needs.room(10**9)), asked=True),
    Section("http", "Points over HTTP", "tests/bench/export/points.py CLOUD.scan", 1, scripts.measure_http, scripts.http_page),
    Section("load", "Streams under load", "tests/load/load.py", 6, scripts.measure_load, scripts.load_page, (CLIENT,)),
    Section("depth", "Depth with every frame", "tests/bench/live/depth.py CLOUD.scan", 1, scripts.measure_depth, scripts.depth_page),
    Section("gl", "Software OpenGL", "tests/bench/vs_vtk.py --backend egl", 3, scripts.measure_gl, scripts.vtk_page, (needs.opengl, needs.vtk)),
    Section("agreement", "Agreement of the devices", "build/release/bench/compare_devices --points 50000 --width 320", 1, pictures.measure_agreement,
            pictures.agreement_page, (needs.opengl, needs.tools("compare_devices"))),
    Section("gpu", "On a graphics card", "tests/bench/gpu_day.sh all", 9, once.measure_gpu, once.gpu_page, (needs.graphics_card,)),
    Section("tests", "A run of all tests", "./test.sh", 0, once.measure_tests, once.tests_page, (once.tests_log,)),
]

# Of the folder, what no section asks, and where what it measures stands.
NOT_HERE = {
    "all.py": "this",
    "columns/columns.py": "docs/decisions/032-columns-before-the-device.md",
    "dolly.py": "a check: whether brightness jumps",
    "first_sight.py": "docs/first-sight.md",
    "light.py": "docs/spec/shading.md",
    "papers.py": "docs/papers",
    "pcl.py": "docs/decisions/014-pcl-reads-and-does-not-estimate.md",
    "png_file.py": "a reader of PNG",
    "pyramid/passes.py": "docs/papers/pyramid.md",
    "ranks/against_one.py": "docs/scaling.md",
    "ranks/model.py": "docs/scaling.md",
    "ranks/shaped_links.py": "docs/scaling.md",
    "rasters/rasters.py": "docs/rasters.md",
    "same_pictures.py": "a check: whether two builds draw the same",
    "sight/camera.py": "a part of first_sight.py",
    "sight/every_method.py": "pictures to look at",
    "sight/label.py": "a part of first_sight.py",
    "sight/measure.py": "a part of first_sight.py",
    "sight/sheet.py": "a part of first_sight.py",
}
# Scripts that sections run or read.
HERE = {"vs_vtk.py", "town.py", "methods.py", "ingest.py", "first_picture.py", "export/points.py", "live/depth.py"}


def named(names):
    """Sections by their names; raises ValueError with what there is."""
    known = {section.name: section for section in SECTIONS}
    if unknown := [name for name in names if name not in known]:
        raise ValueError(f"no figures are called {', '.join(unknown)}; there are {', '.join(known)}")
    return [section for section in SECTIONS if section.name in names]
