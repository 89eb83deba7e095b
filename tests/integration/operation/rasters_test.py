"""`dem` and `ortho` as people run them, of both programs and over HTTP, read back by GDAL, which knows nothing of ours; a generated town, ingested
exactly, is the oracle: elevations by brute force over its points, orthophotos by snapshots of the same view.

    rasters_test.py FOLDER_OF_THE_PROGRAMS
"""
import json
import os
import subprocess
import sys
import tempfile
import unittest

import numpy
from osgeo import gdal, osr

from point_files import read_las

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..")
sys.path.insert(0, os.path.join(ROOT, "tests", "load"))
import serving

gdal.UseExceptions()
PROGRAMS = os.path.abspath(sys.argv.pop())
POINTS = 60000
NOTHING = -3.4028234663852886e+38


def program(name, *arguments, fails=False):
    done = subprocess.run([os.path.join(PROGRAMS, name), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300)
    if (done.returncode != 0) != fails:
        raise AssertionError(f"{' '.join(arguments)} ended with {done.returncode}:\n{done.stderr.decode()[-2000:]}")
    return done


class Rasters(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        cls.folder = folder.name
        program("scancast", "generate", "town", "--points", str(POINTS), "-q", "-o", cls.path("town.las"))
        program("scancast", "ingest", cls.path("town.las"), "-q", "--exact", "--assume-crs", "EPSG:25833", "-o", cls.path("town.scan"))
        with open(cls.path("town.las"), "rb") as file:
            header, points = read_las(file.read())
        cls.xyz = numpy.array([p[:3] for p in points], float) * header["scale"] + header["offset"]
        cls.classes = numpy.array([p.classification for p in points])
        log = open(cls.path("serve.log"), "wb")
        cls.addClassCleanup(log.close)
        cls.server = serving.Server(os.path.join(PROGRAMS, "scancast"), cls.path("town.scan"), 4, log, "--memory-limit", "256M",
                                    "--backend", "cpu")
        cls.addClassCleanup(cls.server.stop)

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    def got(self, name, address):
        status, headers, body = self.server.get(f"/api/v1/clouds/{self.server.cloud}/{address}")
        self.assertEqual(status, 200, body[:300])
        with open(self.path(name), "wb") as file:
            file.write(body)
        return headers

    def cells_by_brute_force(self, data, value, wanted):
        left, cell, _, top, _, down = data.GetGeoTransform()
        self.assertEqual(down, -cell)
        x, y, z = self.xyz[wanted].T
        column, row = numpy.floor((x - left) / cell).astype(int), numpy.floor((top - y) / cell).astype(int)
        shape = data.RasterYSize, data.RasterXSize
        inside = (column >= 0) & (row >= 0) & (column < shape[1]) & (row < shape[0])
        at, z = (row[inside], column[inside]), z[inside]
        count = numpy.zeros(shape, int)
        numpy.add.at(count, at, 1)
        if value == "count":
            return count, count > 0
        found = numpy.full(shape, {"highest": -numpy.inf, "lowest": numpy.inf, "mean": 0.0}[value])
        {"highest": numpy.maximum, "lowest": numpy.minimum, "mean": numpy.add}[value].at(found, at, z)
        return found / numpy.maximum(count, 1) if value == "mean" else found, count > 0

    def expect_elevations(self, name, value, wanted):
        data = gdal.Open(self.path(name))
        band = data.GetRasterBand(1)
        truth, known = self.cells_by_brute_force(data, value, wanted)
        cells = band.ReadAsArray()
        if value == "count":
            self.assertTrue((cells == truth).all())
            return data
        self.assertEqual(band.GetNoDataValue(), NOTHING)
        self.assertEqual(band.GetUnitType(), "metre")
        self.assertEqual(band.GetDescription(), value)
        self.assertTrue(((cells != numpy.float32(NOTHING)) == known).all())
        self.assertLess(abs(cells - truth)[known].max(), 1e-5)
        return data

    def test_elevations_are_what_brute_force_finds(self):
        every = numpy.ones(POINTS, bool)
        for value in ("highest", "lowest", "mean", "count"):
            program("scancast", "dem", self.path("town.scan"), "-q", "--cell", "0.8", "--value", value, "--outliers", "show", "-o", self.path(f"{value}.tif"))
            data = self.expect_elevations(f"{value}.tif", value, every)
            self.assertEqual(data.GetMetadataItem("AREA_OR_POINT"), "Area")
            self.assertEqual(osr.SpatialReference(data.GetProjection()).GetAuthorityCode(None), "25833")
            if value == "count":
                self.assertEqual(data.GetRasterBand(1).ReadAsArray().sum(), POINTS)
        self.got("part.tif", "dem.tif?cell=1.25&outliers=show&value=mean&classes=2,6&bbox=389440,5819740,389560,5819830")
        data = self.expect_elevations("part.tif", "mean", numpy.isin(self.classes, [2, 6]))
        self.assertEqual(data.GetGeoTransform(), (389440, 1.25, 0, 5819830, 0, -1.25))
        self.assertEqual((data.RasterXSize, data.RasterYSize), (96, 72))
        self.got("clipped.tif", "dem.tif?cell=2&outliers=show&clip=389450,5819750,36,389520,5819800,44&value=lowest")
        low, high = numpy.array([389450, 5819750, 36]), numpy.array([389520, 5819800, 44])
        self.expect_elevations("clipped.tif", "lowest", ((self.xyz >= low) & (self.xyz <= high)).all(axis=1))
        self.got("filtered.tif", "dem.tif?cell=2&outliers=show&filter=classification:6..6")
        self.expect_elevations("filtered.tif", "highest", self.classes == 6)

    def test_a_system_without_a_number_is_read_as_what_it_is(self):
        degrees = ('GEOGCS["NAD83",DATUM["North_American_Datum_1983",SPHEROID["GRS 1980",6378137,298.257222101]],PRIMEM["Greenwich",0],'
                   'UNIT["degree",0.0174532925199433]]')
        foot, metre = 'UNIT["US survey foot",0.304800609601219]', 'UNIT["metre",1]'
        for name, method, parameters, unit in (
                ("tm", "Transverse_Mercator", {"latitude_of_origin": 51.5, "central_meridian": 13.25, "scale_factor": 0.99995, "false_easting": 4000, "false_northing": 1000}, foot),
                ("lcc2", "Lambert_Conformal_Conic_2SP", {"standard_parallel_1": 51, "standard_parallel_2": 53.5, "latitude_of_origin": 50, "central_meridian": 11, "false_easting": 2500, "false_northing": 70}, foot),
                ("lcc1", "Lambert_Conformal_Conic_1SP", {"latitude_of_origin": 50, "central_meridian": 11, "scale_factor": 0.9999, "false_easting": 2500, "false_northing": 70}, metre),
                ("laea", "Lambert_Azimuthal_Equal_Area", {"latitude_of_center": 51, "longitude_of_center": 11, "false_easting": 2500, "false_northing": 70}, metre),
                ("albers", "Albers_Conic_Equal_Area", {"standard_parallel_1": 49, "standard_parallel_2": 54, "latitude_of_center": 50, "longitude_of_center": 11, "false_easting": 2500, "false_northing": 70}, metre)):
            said = ",".join(f'PARAMETER["{key}",{value}]' for key, value in parameters.items())
            wkt = f'PROJCS["Site {name}",{degrees},PROJECTION["{method}"],{said},{unit}]'
            program("scancast", "ingest", self.path("town.las"), "-q", "--assume-crs", wkt, "-o", self.path(f"{name}.scan"))
            program("scancast", "dem", self.path(f"{name}.scan"), "-q", "--cell", "2", "-o", self.path(f"{name}.tif"))
            read, meant = osr.SpatialReference(gdal.Open(self.path(f"{name}.tif")).GetProjection()), osr.SpatialReference(wkt)
            to_degrees = []
            for crs in (read, meant):
                crs.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
                self.assertTrue(crs.IsProjected(), crs.ExportToWkt())
                to_degrees.append(osr.CoordinateTransformation(crs, crs.CloneGeogCS()).TransformPoint(389500.0, 719780.0)[:2])
            self.assertAlmostEqual(to_degrees[0][0], to_degrees[1][0], 9, (read.ExportToWkt(), wkt))
            self.assertAlmostEqual(to_degrees[0][1], to_degrees[1][1], 9)

    def test_packed_or_not_over_http_or_not_the_cells_are_the_same(self):
        words = "cell=0.3&value=mean&fill=5"
        self.got("packed.tif", f"dem.tif?{words}")
        self.got("plain.tif", f"dem.tif?{words}&compress=none&tile=512")
        flags = ("--cell", "0.3", "--value", "mean", "--fill", "5")
        program("scancast", "dem", self.path("town.scan"), "-q", "-o", self.path("own.tif"), "--threads", "1", *flags)
        program("scancast-client", "dem", self.server.url, "-o", self.path("client.tif"), "--compress", "none", *flags)
        subprocess.run(["gdal_translate", "-q", self.path("packed.tif"), self.path("again.tif")], check=True)
        sums = set()
        for name in ("packed", "plain", "own", "client", "again"):
            told = json.loads(subprocess.run(["gdalinfo", "-json", "-checksum", self.path(f"{name}.tif")], stdout=subprocess.PIPE, check=True).stdout)
            sums.add((told["bands"][0]["checksum"], tuple(told["size"]), tuple(told["geoTransform"])))
        self.assertEqual(len(sums), 1, sums)
        with open(self.path("packed.tif"), "rb") as packed, open(self.path("own.tif"), "rb") as own:
            self.assertEqual(packed.read(), own.read(), "the same bytes, whoever makes them")
        self.assertGreater(max(sums)[1][0], 512, "several tiles")
        self.assertLess(os.path.getsize(self.path("packed.tif")), 0.6 * os.path.getsize(self.path("plain.tif")))

    def test_an_orthophoto_is_the_snapshot_of_its_view(self):
        left, bottom, right, top = 389420, 5819720, 389580, 5819820
        low, high = self.xyz[:, 2].min(), self.xyz[:, 2].max()
        above = high + max(1, high - low)  # where eye-dome lighting, which goes by depth, looks from (renderer/raster/ortho_view.cpp)
        for style in ("color=rgb&method=point&samples=1", "color=elevation&method=disc&shading=eyedome", "color=classification&method=hqs&light.occlusion=0.5"):
            self.got("ortho.tif", f"ortho.tif?bbox={left},{bottom},{right},{top}&cell=0.25&{style}")
            self.got("same.png", f"snapshot.png?projection=orthographic&eye={(left + right) / 2},{(bottom + top) / 2},{above}&target={(left + right) / 2},"
                                 f"{(bottom + top) / 2},{low}&up=0,1,0&viewHeight={top - bottom}&width=640&height=400&background=transparent&{style}")
            ortho, same = gdal.Open(self.path("ortho.tif")), gdal.Open(self.path("same.png"))
            self.assertEqual(ortho.GetGeoTransform(), (left, 0.25, 0, top, 0, -0.25))
            pixels, expected = ortho.ReadAsArray(), same.ReadAsArray()
            self.assertTrue((pixels[3] == expected[3]).all(), style)
            seen = expected[3] > 0
            self.assertGreater(seen.mean(), 0.05, "60,000 points on 256,000 pixels")
            self.assertLess((abs(pixels.astype(int) - expected)[:, seen] > 2).any(axis=0).mean(), 0.002, style)
            self.assertEqual(ortho.GetRasterBand(4).GetColorInterpretation(), gdal.GCI_AlphaBand)
        program("scancast", "ortho", self.path("town.scan"), "-q", "--backend", "cpu", "--cell", "0.25", "--bbox", f"{left},{bottom},{right},{top}",
                "--color", "rgb", "--method", "point", "--samples", "1", "-o", self.path("own-ortho.tif"))
        self.got("ortho.tif", f"ortho.tif?bbox={left},{bottom},{right},{top}&cell=0.25&color=rgb&method=point&samples=1")
        self.assertTrue((gdal.Open(self.path("own-ortho.tif")).ReadAsArray() == gdal.Open(self.path("ortho.tif")).ReadAsArray()).all())

    def test_large_ones_stream_within_the_memory_limit(self):
        before = self.server.resident()
        connection = self.server.connect()
        connection.request("GET", f"/api/v1/clouds/{self.server.cloud}/dem.tif?cell=0.03&compress=none")
        answer = connection.getresponse()
        facts = json.loads(answer.headers["Scancast-Raster"])
        size, most = 0, 0
        while True:
            piece = answer.read(1 << 22)
            if not piece:
                break
            size += len(piece)
            most = max(most, self.server.resident())
        self.assertGreater(size, 4 * facts["columns"] * facts["rows"])
        self.assertGreater(size, 80 << 20)
        self.assertLess(most - before, 120 << 20, "bytes more than before")

    def test_what_is_wrong_is_told_and_leaves_nothing(self):
        for arguments, words in ((["--cell", "0"], "cell"), (["--bbox", "1,2,3,4"], "beside the cloud"), (["--fill", "99"], "64"),
                                 (["--classes", "x"], "classes"), (["--cell", "0.0000001"], "with cell=")):
            done = program("scancast", "dem", self.path("town.scan"), "-o", self.path("none.tif"), *arguments, fails=True)
            self.assertIn(words, done.stderr.decode())
            self.assertFalse(os.path.exists(self.path("none.tif")))
        done = program("scancast-client", "dem", self.server.url, "-o", self.path("none.tif"), "--cell", "0.0001", fails=True)
        self.assertIn("with cell=", done.stderr.decode())


if __name__ == "__main__":
    unittest.main()
