"""Points, profiles and measurements of a real server against the scan that it was given, by brute force.

SCANCAST_PROGRAMS names the folder of the programs.
"""
import os
import subprocess
import unittest

import support

import scancast
from scancast.point_data import PointReader

try:
    import numpy
except ImportError:
    numpy = None

KEPT = ["x", "y", "z", "intensity", "classification"]


def in_order(points):
    """The same points in an order of their own: rows of numbers."""
    rows = numpy.stack([points[name].astype(float) for name in KEPT], axis=1)
    return rows[numpy.lexsort(rows.T)]


@support.needs("numpy")
class PointsOfAServer(support.Served):
    points = 20000

    @classmethod
    def prepared(cls, scancast_program, scan):
        cloud = os.path.join(cls.folder, "town.scan")
        subprocess.run([scancast_program, "ingest", scan, "-o", cloud, "--exact", "--quiet"], check=True, timeout=support.PATIENCE)
        return cloud

    @classmethod
    def setUpClass(cls):
        super().setUpClass()
        server = scancast.Server(cls.url, timeout=support.PATIENCE)
        support.wait_until(lambda: server.ready() and not server.pending(), "the cloud is not there")
        cls.paths = set(server.openapi()["paths"])
        cls.cloud = server.cloud()
        with open(cls.scan, "rb") as file:
            cls.truth = PointReader(file.read).array()

    def needs_route(self, name):
        if f"/api/v1/clouds/{{id}}/{name}" not in self.paths:
            print(f"\nSKIPPED: this server has no /{name}", flush=True)
            self.skipTest(f"this server has no /{name}")

    def test_all_points_are_those_of_the_scan(self):
        self.needs_route("points")
        points = self.cloud.points()
        self.assertEqual(len(points), self.points)
        self.assertTrue((in_order(points) == in_order(self.truth)).all())

    def test_a_region_has_what_is_in_it(self):
        self.needs_route("points")
        low, high = (389450, 5819750, 30), (389520.5, 5819810, 50)
        truth = self.truth[numpy.isin(self.truth["classification"], [2, 6])]
        for name, least, most in zip("xyz", low, high):
            truth = truth[(truth[name] >= least) & (truth[name] <= most)]
        self.assertGreater(len(truth), 100)
        with self.cloud.open_points(clip=(low, high), classes=[2, 6]) as stream:
            self.assertEqual(stream.count, len(truth))
            points = numpy.concatenate(list(stream))
        self.assertTrue((in_order(points) == in_order(truth)).all())
        path = os.path.join(self.folder, "part.las")
        saved = self.cloud.save_points(path, clip=(low, high), classes=[2, 6])
        self.assertEqual(saved.points, len(truth))
        with open(path, "rb") as file:
            self.assertTrue((in_order(PointReader(file.read).array()) == in_order(truth)).all())
        with self.assertRaises(scancast.Impossible) as caught:
            self.cloud.points(z=(1000, 1001))
        self.assertEqual(caught.exception.type, "empty")
        with self.assertRaisesRegex(scancast.InvalidArgument, "polygn"):
            self.cloud.points(polygn=[(0, 0), (1, 0), (1, 1)])

    def test_a_profile_has_its_corridor(self):
        self.needs_route("profile")
        start, end, width = numpy.array([389420.0, 5819720.0]), numpy.array([389580.0, 5819790.0]), 4.0
        along = (end - start) / numpy.linalg.norm(end - start)
        away = numpy.stack([self.truth["x"], self.truth["y"]], axis=1) - start
        station, offset = away @ along, away @ numpy.array([along[1], -along[0]])
        inside = (station >= 0) & (station <= numpy.linalg.norm(end - start)) & (abs(offset) <= width / 2)
        self.assertGreater(inside.sum(), 100)
        points = self.cloud.profile([start, end], width)
        self.assertEqual(len(points), inside.sum())
        self.assertTrue((in_order(points) == in_order(self.truth[inside])).all())
        self.assertLess(abs(numpy.sort(points["station"]) - numpy.sort(station[inside])).max(), 1e-6)
        self.assertLess(abs(numpy.sort(points["offset"]) - numpy.sort(offset[inside])).max(), 1e-6)
        picture = self.cloud.profile_picture([start, end], width, picture={"width": 300})
        self.assertTrue(picture.bytes.startswith(b"\x89PNG"))
        self.assertAlmostEqual(picture.length, numpy.linalg.norm(end - start), 6)
        self.assertLess(picture.bottom, picture.top)

    def test_rasters_have_what_brute_force_finds(self):
        self.needs_route("dem.tif")
        for value in ("highest", "lowest", "mean", "count"):
            raster = self.cloud.dem(cell=4, value=value, classes=[2, 6], outliers="show")
            cells = raster.array()
            self.assertEqual(cells.shape, (raster.rows, raster.columns))
            truth = self.truth[numpy.isin(self.truth["classification"], [2, 6])]
            column = numpy.floor((truth["x"] - raster.left) / raster.cell).astype(int)
            row = numpy.floor((raster.top - truth["y"]) / raster.cell).astype(int)
            count = numpy.zeros(cells.shape)
            numpy.add.at(count, (row, column), 1)
            if value == "count":
                self.assertTrue((cells == count).all())
                continue
            expected = numpy.full(cells.shape, {"highest": -numpy.inf, "lowest": numpy.inf, "mean": 0.0}[value])
            {"highest": numpy.maximum, "lowest": numpy.minimum, "mean": numpy.add}[value].at(expected, (row, column), truth["z"])
            if value == "mean":
                expected /= numpy.maximum(count, 1)
            self.assertTrue((numpy.isnan(cells) == (count == 0)).all())
            self.assertLess(numpy.nanmax(abs(cells - expected)[count > 0]), 1e-5)
        path = os.path.join(self.folder, "dem.tif")
        self.cloud.save_dem(path, cell=4, compress="deflate")
        self.assertGreater(os.path.getsize(path), 1000)
        photo = self.cloud.ortho(cell=2, color="elevation")
        pixels = photo.array()
        self.assertEqual(pixels.shape, (photo.rows, photo.columns, 4))
        self.assertGreater((pixels[..., 3] > 0).mean(), 0.1)
        with self.assertRaisesRegex(scancast.InvalidArgument, "cell"):
            self.cloud.dem(cell=0)

    def test_measurements(self):
        self.needs_route("measure")
        self.assertEqual(self.cloud.measure("distance", [(389499, 5819799, 34), (389502, 5819803, 34)]).length, 5.0)
        square = [(389499, 5819799, 34), (389509, 5819799, 34), (389509, 5819809, 34), (389499, 5819809, 34)]
        self.assertAlmostEqual(self.cloud.measure("area", square).plan_area, 100.0, 6)
        self.assertGreater(self.cloud.measure("volume", square, base=30.0, cell=2.0).points, 0)
        with self.assertRaises(scancast.ScancastError):
            self.cloud.measure("distanze", square)


if __name__ == "__main__":
    unittest.main()
