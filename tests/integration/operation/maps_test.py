"""Maps of a cloud, asked by GDAL: its drivers of WMS and WMTS, gdalwarp, and its own idea of where things are in the world (osr). A plain with marks at
known coordinates is the oracle: each mark must be at its pixel, in the file's coordinates and, by GDAL's projection, in the world's.

    maps_test.py FOLDER_OF_THE_PROGRAMS
"""
import json
import math
import os
import re
import subprocess
import sys
import tempfile
import unittest
import urllib.parse
import xml.etree.ElementTree as xml

import numpy
from osgeo import gdal, osr

ROOT = os.path.join(os.path.dirname(os.path.abspath(__file__)), "..", "..", "..")
sys.path.insert(0, os.path.join(ROOT, "tests", "load"))
import serving

PROGRAMS = os.path.abspath(sys.argv.pop())
gdal.UseExceptions()
gdal.SetConfigOption("GDAL_HTTP_NETRC", "NO")
osr.UseExceptions()

MIDDLE = 389500.0, 5819800.0  # EPSG:25833: Berlin
SIDE, STEP, MARK = 96, 0.5, 4  # m: of the plain, between its points; half a mark's side
MARKS = [(389470.0, 5819830.0), (389520.0, 5819770.0), (389535.0, 5819836.0)]
BOX = 389450, 5819750, 389550, 5819850
SYSTEMS = {  # a place well inside each
    "EPSG:25833": MIDDLE, "EPSG:2263": (981000, 199000),  # New York, US survey feet
    "EPSG:31468": (4468503, 5333317),  # Gauss-Krueger, whose first axis is north, and another datum
    "EPSG:2154": (652381, 6862047),  # Lambert-93
    "EPSG:4326": (13.4, 52.5), "EPSG:3857": (1491000, 6894000),
}


def program(*arguments):
    done = subprocess.run([os.path.join(PROGRAMS, "scancast"), *arguments], stdout=subprocess.PIPE, stderr=subprocess.PIPE, timeout=300)
    if done.returncode != 0:
        raise AssertionError(f"{' '.join(arguments)} ended with {done.returncode}:\n{done.stderr.decode()[-2000:]}")


def system(name):
    known = osr.SpatialReference()
    known.SetFromUserInput(name)
    known.SetAxisMappingStrategy(osr.OAMS_TRADITIONAL_GIS_ORDER)
    return known


def projected(places, source, target):
    """By GDAL."""
    return [p[:2] for p in osr.CoordinateTransformation(system(source), system(target)).TransformPoints([list(p) for p in places])]


def plain():
    """Grey, with red marks."""
    lines = []
    count = int(SIDE / STEP)
    for row in range(count + 1):
        for column in range(count + 1):
            x, y = MIDDLE[0] - SIDE / 2 + column * STEP, MIDDLE[1] - SIDE / 2 + row * STEP
            mark = any(abs(x - a) <= MARK and abs(y - b) <= MARK for a, b in MARKS)
            lines.append(f"{x:.2f} {y:.2f} 35.00 {'220 20 20' if mark else '150 150 150'}")
    return "\n".join(lines) + "\n"


def pixels(raster):
    """Rows of RGBA."""
    return numpy.moveaxis(raster.ReadAsArray(), 0, -1)


def decoded(data, name="/vsimem/picture"):
    gdal.FileFromMemBuffer(name, data)
    try:
        return pixels(gdal.Open(name))
    finally:
        gdal.Unlink(name)


def red(picture):
    return (picture[..., 0].astype(int) - picture[..., 1] > 60) & (picture[..., 0] > 120)


def middle_of_red(picture, near, within):
    """px, of pixels' edges: the centre of the upper left pixel is (0.5, 0.5)."""
    rows, columns = numpy.nonzero(red(picture))
    close = (abs(columns + 0.5 - near[0]) < within) & (abs(rows + 0.5 - near[1]) < within)
    if not close.any():
        return math.inf, math.inf
    return columns[close].mean() + 0.5, rows[close].mean() + 0.5


class Maps(unittest.TestCase):
    @classmethod
    def setUpClass(cls):
        folder = tempfile.TemporaryDirectory()
        cls.addClassCleanup(folder.cleanup)
        gdal.SetConfigOption("GDAL_DEFAULT_WMS_CACHE_PATH", os.path.join(folder.name, "gdalwmscache"))
        cls.folder = folder.name
        with open(cls.path("plain.xyz"), "w") as file:
            file.write(plain())
        program("ingest", cls.path("plain.xyz"), "-q", "--assume-crs", "EPSG:25833", "-o", cls.path("plain.scan"))
        clouds = []
        for number, (name, (x, y)) in enumerate(SYSTEMS.items()):
            scan = cls.path(f"place{number}.xyz")
            with open(scan, "w") as file:
                file.writelines(f"{x + a * 1e-4} {y + b * 1e-4} {a}\n" for a in range(8) for b in range(8))
            clouds.append(cls.path(f"place{number}.scan"))
            program("ingest", scan, "-q", "--assume-crs", name, "-o", clouds[-1])
        with open(cls.path("nowhere.xyz"), "w") as file:
            file.writelines(f"{a} {b} 0\n" for a in range(8) for b in range(8))
        clouds.append(cls.path("nowhere.xyz"))
        log = open(cls.path("serve.log"), "wb")
        cls.addClassCleanup(log.close)
        cls.server = serving.Server(os.path.join(PROGRAMS, "scancast"), cls.path("plain.scan"), 4, log, *clouds)
        cls.addClassCleanup(cls.server.stop)
        cls.cloud = cls.server.url + "/api/v1/clouds/plain"

    @classmethod
    def path(cls, name):
        return os.path.join(cls.folder, name)

    @staticmethod
    def bytes_of(path):
        with open(path, "rb") as file:
            return file.read()

    def get(self, target, status=200, cloud="plain", **headers):
        found, answered, body = self.server.get(f"/api/v1/clouds/{cloud}/{target}", headers=headers)
        self.assertEqual(found, status, body[:500])
        return answered, body

    def map(self, crs, box, width, height, **words):
        query = {"SERVICE": "WMS", "VERSION": "1.3.0", "REQUEST": "GetMap", "LAYERS": "plain", "STYLES": "", "CRS": crs, "BBOX": ",".join(map(repr, box)),
                 "WIDTH": width, "HEIGHT": height, "FORMAT": "image/png", "TRANSPARENT": "TRUE", "method": "circle", "shading": "unlit", **words}
        return self.get("wms?" + urllib.parse.urlencode(query))

    def lonlat(self, points, to="lonlat", cloud="plain", status=200):
        found, _, body = self.server.get(f"/api/v1/clouds/{cloud}/lonlat", method="POST", body=json.dumps({"points": points, "to": to}),
                                         headers={"Content-Type": "application/json"})
        self.assertEqual(found, status, body)
        return json.loads(body).get("points")

    def assert_marks(self, picture, extent, places, off=0.5, metre=1.0):
        """`extent`: left, bottom, right, top of the picture, in the places' coordinates, of which `metre` is about one."""
        left, bottom, right, top = extent
        height, width = picture.shape[:2]
        for x, y in places:
            at = (x - left) / (right - left) * width, (top - y) / (top - bottom) * height
            found = middle_of_red(picture, at, 3 * MARK * metre / (right - left) * width)
            self.assertLess(math.dist(at, found), off, f"{at} {found}")

    # ---- where marks are

    def test_the_files_own_coordinates(self):
        for width, height, box in ((400, 400, BOX), (401, 401, (389449.95, 5819749.9, 389550.2, 5819850.15)), (250, 500, BOX)):
            _, data = self.map("EPSG:25833", box, width, height)
            self.assert_marks(decoded(data), box, MARKS)

    def test_web_mercator_as_gdal_projects_it(self):
        places = projected(MARKS, "EPSG:25833", "EPSG:3857")
        corners = projected([(BOX[0], BOX[1]), (BOX[2], BOX[3])], "EPSG:25833", "EPSG:3857")
        box = [*corners[0], *corners[1]]
        _, data = self.map("EPSG:3857", box, 640, 640)
        self.assert_marks(decoded(data), box, places)

    def test_degrees_have_their_axes_order(self):
        places = projected(MARKS, "EPSG:25833", "EPSG:4326")
        corners = projected([(BOX[0], BOX[1]), (BOX[2], BOX[3])], "EPSG:25833", "EPSG:4326")
        (left, bottom), (right, top) = corners
        pictures = []
        for words in ({"crs": "CRS:84", "box": (left, bottom, right, top)}, {"crs": "EPSG:4326", "box": (bottom, left, top, right)}):
            _, data = self.map(words["crs"], words["box"], 500, 500)
            pictures.append(data)
            self.assert_marks(decoded(data), (left, bottom, right, top), places, metre=1.5e-5)
        self.assertEqual(*pictures)
        query = urllib.parse.urlencode({"VERSION": "1.1.1", "REQUEST": "GetMap", "SRS": "EPSG:4326", "BBOX": f"{left!r},{bottom!r},{right!r},{top!r}",
                                        "WIDTH": 500, "HEIGHT": 500, "TRANSPARENT": "TRUE", "method": "circle", "shading": "unlit"})
        self.assertEqual(self.get("wms?" + query)[1], pictures[0], "WMS 1.1.1 has x, y everywhere")

    def test_a_projected_map_is_what_gdalwarp_makes_of_the_files_own(self):
        _, own = self.map("EPSG:25833", BOX, 500, 500)
        source = gdal.GetDriverByName("MEM").Create("", 500, 500, 4)
        source.WriteRaster(0, 0, 500, 500, numpy.moveaxis(decoded(own), -1, 0).tobytes())
        source.SetProjection(system("EPSG:25833").ExportToWkt())
        source.SetGeoTransform([BOX[0], 0.2, 0, BOX[3], 0, -0.2])
        source.GetRasterBand(4).SetColorInterpretation(gdal.GCI_AlphaBand)
        corners = projected([(389460, 5819765), (389540, 5819840)], "EPSG:25833", "EPSG:3857")
        box = [*corners[0], *corners[1]]
        warped = pixels(gdal.Warp("", source, format="MEM", dstSRS="EPSG:3857", outputBounds=box, width=600, height=560, resampleAlg="bilinear", errorThreshold=0))
        _, data = self.map("EPSG:3857", box, 600, 560)
        ours = decoded(data)
        self.assertGreater(red(ours).sum(), 3000)
        off = numpy.abs(ours.astype(int) - warped).max(axis=-1)
        self.assertLess(off.mean(), 1.0)
        # Where both have marks; what differs are pixels of their edges.
        self.assertLess((red(ours) ^ red(warped)).sum(), 0.03 * red(ours).sum())

    # ---- GDAL's drivers

    def test_gdal_reads_wms(self):
        listed = gdal.Open(f"WMS:{self.cloud}/wms?SERVICE=WMS&VERSION=1.3.0&REQUEST=GetCapabilities&method=circle&shading=unlit").GetMetadata("SUBDATASETS")
        names = [value for key, value in listed.items() if key.endswith("_NAME")]
        self.assertTrue(names)
        for name in names:
            raster = gdal.Open(name)
            self.assertGreater(raster.RasterXSize, 100)
        for crs in ("EPSG:25833", "EPSG:3857"):
            corners = projected([(BOX[0], BOX[1]), (BOX[2], BOX[3])], "EPSG:25833", crs)
            name = (f"WMS:{self.cloud}/wms?SERVICE=WMS&VERSION=1.3.0&REQUEST=GetMap&LAYERS=plain&STYLES=&CRS={crs}&FORMAT=image/png&TRANSPARENT=TRUE"
                    f"&method=circle&shading=unlit&BBOX={','.join(repr(c) for p in corners for c in p)}")
            raster = gdal.Translate("", name, format="MEM", width=500, height=500)
            left, across, _, top, _, down = raster.GetGeoTransform()
            extent = left, top + 500 * down, left + 500 * across, top
            self.assertTrue(osr.SpatialReference(raster.GetProjection()).IsSame(system(crs)))
            self.assert_marks(pixels(raster), extent, projected(MARKS, "EPSG:25833", crs), 1)

    def test_gdal_reads_wmts(self):
        name = f"WMTS:{self.cloud}/wmts/1.0.0/WMTSCapabilities.xml?method=circle&shading=unlit"
        for address in (name, f"WMTS:{self.cloud}/wmts?SERVICE=WMTS&REQUEST=GetCapabilities&method=circle&shading=unlit"):
            for tiles, crs in (("mercator", "EPSG:3857"), ("file", "EPSG:25833")):
                raster = gdal.Open(f"{address},layer=plain,tilematrixset={tiles},style=default")
                self.assertTrue(osr.SpatialReference(raster.GetProjection()).IsSame(system(crs)), crs)
                corners = projected([(BOX[0] + 2, BOX[1] + 2), (BOX[2] - 2, BOX[3] - 2)], "EPSG:25833", crs)
                window = [corners[0][0], corners[1][1], corners[1][0], corners[0][1]]
                part = gdal.Translate("", raster, format="MEM", projWin=window, width=400, height=400)
                left, across, _, top, _, down = part.GetGeoTransform()
                self.assert_marks(pixels(part), (left, top + 400 * down, left + 400 * across, top), projected(MARKS, "EPSG:25833", crs), 1)

    # ---- tiles

    def tile_of(self, z, place):
        half = math.pi * 6378137
        side = 2 * half / 2 ** z
        return int((place[0] + half) / side), int((half - place[1]) / side)

    def test_tiles_fit_and_there_is_nothing_outside(self):
        x, y = self.tile_of(20, projected([MIDDLE], "EPSG:25833", "EPSG:3857")[0])
        words = "?method=circle&shading=unlit"
        whole = [[decoded(self.get(f"tiles/mercator/21/{2 * x + column}/{2 * y + row}.png{words}")[1]) for column in (0, 1)] for row in (0, 1)]
        joined = numpy.concatenate([numpy.concatenate(row, axis=1) for row in whole])
        coarse = decoded(self.get(f"tiles/mercator/20/{x}/{y}.png{words}")[1])
        self.assertEqual(coarse.shape, (256, 256, 4))
        # The four finer tiles, each pixel of 2 x 2, are the coarse one but for edges.
        halved = joined.reshape(256, 2, 256, 2, 4).mean(axis=(1, 3))
        self.assertLess(numpy.abs(halved - coarse)[8:-8, 8:-8].mean(), 3)
        seam = numpy.abs(joined[:, 255].astype(int) - joined[:, 256]).mean()
        self.assertLess(seam, 6, "tiles fit")
        empty = decoded(self.get("tiles/mercator/20/0/0.png")[1])
        self.assertEqual(empty.shape, (256, 256, 4))
        self.assertFalse(empty.any())
        world = decoded(self.get("tiles/mercator/0/0/0.png")[1])
        self.assertEqual(world.shape, (256, 256, 4))
        headers, white = self.get("tiles/mercator/20/0/0.jpg")
        self.assertEqual(headers["Content-Type"], "image/jpeg")
        self.assertTrue((decoded(white) > 250).all())

    def test_the_files_tiles_are_documented_arithmetic(self):
        # The plain's 96 m in one tile of 256 pixels: of 0.375 m, or the next power of two, 0.5 m.
        left, top = math.floor((MIDDLE[0] - SIDE / 2) / 0.5) * 0.5, math.ceil((MIDDLE[1] + SIDE / 2) / 0.5) * 0.5
        tile = decoded(self.get("tiles/file/0/0/0.png?method=circle&shading=unlit")[1])
        self.assert_marks(tile, (left, top - 128, left + 128, top), MARKS)
        tile = decoded(self.get("tiles/file/1/1/0.png?method=circle&shading=unlit")[1])
        self.assert_marks(tile, (left + 64, top - 64, left + 128, top), [MARKS[2]])

    def test_tags_save_the_work(self):
        for target in ("tiles/file/0/0/0.png", "wmts/1.0.0/WMTSCapabilities.xml", "wms?SERVICE=WMS&REQUEST=GetMap&CRS=file&BBOX=0,0,1,1&WIDTH=9&HEIGHT=9"):
            headers, _ = self.get(target)
            self.assertEqual(headers["Cache-Control"], "no-cache")
            again, body = self.get(target, 304, **{"If-None-Match": headers["ETag"]})
            self.assertEqual((again["ETag"], body), (headers["ETag"], b""))

    def test_styles_and_words_of_a_view(self):
        x, y = MARKS[0]
        box = x - 10, y - 10, x + 10, y + 10
        _, plain_map = self.map("file", box, 64, 64)
        _, styled = self.map("file", box, 64, 64, STYLES="elevation")
        _, worded = self.map("file", box, 64, 64, color="elevation")
        self.assertNotEqual(plain_map, styled)
        self.assertEqual(styled, worded)
        _, cut = self.map("file", box, 64, 64, clips=f"box:{x},{y},35,6,6,10")
        self.assertTrue(decoded(cut)[32, 32, 3] and not decoded(cut)[4, 4, 3])
        _, data = self.map("file", (0, 0, 1, 1), 8, 8, TRANSPARENT="FALSE", BGCOLOR="0x102030")
        self.assertEqual(decoded(data)[0, 0].tolist()[:3], [16, 32, 48])
        _, data = self.map("EPSG:3857", projected([MIDDLE], "EPSG:25833", "EPSG:3857")[0] + projected([(MIDDLE[0] + 300, MIDDLE[1] + 300)], "EPSG:25833", "EPSG:3857")[0],
                           64, 64, TRANSPARENT="FALSE", BGCOLOR="0x102030")
        self.assertEqual(decoded(data)[2, 60].tolist()[:3], [16, 32, 48])

    # ---- what is there

    def test_feature_info_is_the_scans_point(self):
        x, y = MARKS[1]
        box = projected([(x - 20, y - 20), (x + 20, y + 20)], "EPSG:25833", "EPSG:3857")
        query = {"SERVICE": "WMS", "VERSION": "1.3.0", "REQUEST": "GetFeatureInfo", "LAYERS": "plain", "QUERY_LAYERS": "plain", "CRS": "EPSG:3857",
                 "BBOX": ",".join(repr(c) for p in box for c in p), "WIDTH": 101, "HEIGHT": 101, "I": 50, "J": 50, "INFO_FORMAT": "application/json"}
        headers, body = self.get("wms?" + urllib.parse.urlencode(query))
        self.assertEqual(headers["Content-Type"], "application/json")
        feature = json.loads(body)["features"][0]
        found = feature["properties"]
        self.assertLess(math.dist((found["x"], found["y"]), (x, y)), 0.5, found)
        self.assertEqual((found["z"], found["red"], found["green"]), (35, 220, 20))
        self.assertLess(math.dist(feature["geometry"]["coordinates"], projected([(x, y)], "EPSG:25833", "EPSG:3857")[0]), 1)
        self.assertIn(b"red = 220\n", self.get("wms?" + urllib.parse.urlencode({**query, "INFO_FORMAT": "text/plain"}))[1])
        self.assertIn(b"<th>red</th><td>220</td>", self.get("wms?" + urllib.parse.urlencode({**query, "INFO_FORMAT": "text/html"}))[1])
        self.assertEqual(len(json.loads(self.get("wms?" + urllib.parse.urlencode({**query, "FEATURE_COUNT": 10}))[1])["features"]), 1)
        self.get("wms?" + urllib.parse.urlencode({**query, "FEATURE_COUNT": 0}), 400)
        away = self.get("wms?" + urllib.parse.urlencode({**query, "BBOX": "0,0,10,10"}))[1]
        self.assertEqual(json.loads(away)["features"], [])

    # ---- longitudes and latitudes

    def test_lonlat_is_what_gdal_says(self):
        for number, (name, (x, y)) in enumerate(SYSTEMS.items()):
            step = 1e-3 if name == "EPSG:4326" else 500
            places = [[x + a * step, y + b * step] for a in range(3) for b in range(3)]
            found = self.lonlat([[*p, 17.5] for p in places], cloud=f"place{number}")
            for ours, gdals in zip(found, projected(places, name, "OGC:CRS84")):
                self.assertLess(math.dist(ours, gdals), 1e-9, f"{name}: {ours} {gdals}")
            for back, place in zip(self.lonlat(found, "file", cloud=f"place{number}"), places):
                self.assertLess(math.dist(back, place), 1e-3)

    def test_what_is_nowhere_says_so(self):
        status, _, body = self.server.get("/api/v1/clouds/nowhere/lonlat", method="POST", body='{"points": [[1, 2]]}', headers={"Content-Type": "application/json"})
        self.assertEqual(status, 422)
        self.assertIn("says nothing of its coordinate reference system", json.loads(body)["detail"])
        self.assertGreater(decoded(self.get("tiles/file/0/0/0.png", cloud="nowhere")[1])[..., 3].sum(), 0)
        _, body = self.get("tiles/mercator/0/0/0.png", 422, cloud="nowhere")
        self.assertIn("file", json.loads(body)["detail"])
        self.assertEqual(self.get("wms?SERVICE=WMS&REQUEST=GetCapabilities", cloud="nowhere")[1].count(b"<CRS>"), 1)
        tiles = gdal.Open(f"WMTS:{self.server.url}/api/v1/clouds/nowhere/wmts/1.0.0/WMTSCapabilities.xml")
        self.assertTrue(osr.SpatialReference(tiles.GetProjection()).IsLocal())
        self.assertGreater(pixels(gdal.Translate("", tiles, format="MEM", width=64, height=64))[..., 3].sum(), 0)

    # ---- what is said

    def test_capabilities(self):
        _, body = self.get("wms?SERVICE=WMS&REQUEST=GetCapabilities&method=ewa&color=elevation")
        names = {"w": "http://www.opengis.net/wms", "x": "http://www.w3.org/1999/xlink"}
        root = xml.fromstring(body)
        layer = root.find("w:Capability/w:Layer/w:Layer", names)
        self.assertEqual([c.text for c in layer.findall("w:CRS", names)], ["EPSG:25833", "EPSG:3857", "EPSG:4326", "CRS:84"])
        self.assertIn("elevation", [s.text for s in layer.findall("w:Style/w:Name", names)])
        self.assertNotIn("intensity", [s.text for s in layer.findall("w:Style/w:Name", names)])
        href = root.find(".//w:GetMap//w:OnlineResource", names).get("{http://www.w3.org/1999/xlink}href")
        self.assertEqual(href, self.cloud + "/wms?method=ewa&color=elevation&")
        box = layer.find("w:EX_GeographicBoundingBox", names)
        west, south = projected([(MIDDLE[0] - SIDE / 2, MIDDLE[1] - SIDE / 2)], "EPSG:25833", "OGC:CRS84")[0]
        self.assertLessEqual(float(box.find("w:westBoundLongitude", names).text), west)
        self.assertAlmostEqual(float(box.find("w:southBoundLatitude", names).text), south, 4)

    def test_what_knows_only_1_1_1_gets_that(self):
        _, body = self.get("wms?SERVICE=WMS&REQUEST=GetCapabilities&VERSION=1.1.1")
        root = xml.fromstring(body)
        self.assertEqual((root.tag, root.get("version")), ("WMT_MS_Capabilities", "1.1.1"))
        layer = root.find("Capability/Layer/Layer")
        self.assertEqual([c.text for c in layer.findall("SRS")], ["EPSG:25833", "EPSG:3857", "EPSG:4326"])
        west, south = projected([(MIDDLE[0] - SIDE / 2, MIDDLE[1] - SIDE / 2)], "EPSG:25833", "OGC:CRS84")[0]
        for box in (layer.find("LatLonBoundingBox"), layer.find("BoundingBox[@SRS='EPSG:4326']")):
            self.assertAlmostEqual(float(box.get("minx")), west, 4)
            self.assertAlmostEqual(float(box.get("miny")), south, 4)
        listed = gdal.Open(f"WMS:{self.cloud}/wms?SERVICE=WMS&VERSION=1.1.1&REQUEST=GetCapabilities").GetMetadata("SUBDATASETS")
        self.assertGreater(gdal.Open(next(v for k, v in listed.items() if k.endswith("_NAME"))).RasterXSize, 100)

    def test_legends(self):
        ramps = json.loads(self.server.get("/api/v1/methods")[2])["ramps"]
        where = "{http://www.w3.org/1999/xlink}href"
        found = {}
        for version in ("1.3.0", "1.1.1"):
            text = self.get(f"wms?SERVICE=WMS&REQUEST=GetCapabilities&VERSION={version}&colormap=turbo", cloud="place0")[1].decode()
            root = xml.fromstring(text.replace(' xmlns="http://www.opengis.net/wms"', ""))
            for style in root.iter("Style"):
                legend = style.find("LegendURL")
                target = legend.find("OnlineResource").get(where)
                self.assertTrue(target.startswith(self.server.url))
                status, headers, data = self.server.get(target[len(self.server.url):])
                self.assertEqual((status, headers["Content-Type"]), (200, legend.find("Format").text), data)
                picture = decoded(data)
                self.assertEqual(picture.shape[:2], (int(legend.get("height")), int(legend.get("width"))), target)
                found.setdefault(style.find("Name").text, []).append(data)
        self.assertIn("elevation", found)
        for name, datas in found.items():
            self.assertEqual(*datas, name)
        # The ramp is the one that is told elsewhere, from its low end to its high one.
        picture = decoded(found["elevation"][0])[..., :3]
        wanted = [[int(c[i:i + 2], 16) for i in (1, 3, 5)] for c in ramps["turbo"]]
        rows = [row for row in picture.tolist() if all(color in row for color in (wanted[0], wanted[-1]))]
        self.assertTrue(rows)
        places = [min(range(len(rows[0])), key=lambda x: math.dist(rows[0][x], color)) for color in wanted]
        self.assertEqual(places, sorted(places))
        for place, color in zip(places, wanted):
            self.assertLess(math.dist(rows[0][place], color), 12)
        # Elsewhere in its picture other ends are written.
        ask = "wms?REQUEST=GetLegendGraphic&LAYER=place0&STYLE=elevation&FORMAT=image/png"
        narrow, wide = (self.get(f"{ask}&range={ends}", cloud="place0")[1] for ends in ("1,2", "1,7"))
        self.assertEqual(decoded(narrow).shape, decoded(wide).shape)
        self.assertNotEqual(narrow, wide)
        headers, data = self.get(ask + "&TRANSPARENT=TRUE", cloud="place0")
        self.assertEqual(decoded(data)[0, 0, 3], 0)
        self.get(ask + "&TRANSPARENT=TRUE", 304, cloud="place0", **{"If-None-Match": headers["ETag"]})
        _, body = self.get("wms?REQUEST=GetLegendGraphic&LAYER=plain&STYLE=gaudy", 400)
        self.assertEqual(xml.fromstring(body).find("{http://www.opengis.net/ogc}ServiceException").get("code"), "StyleNotDefined")
        self.get("wms?REQUEST=GetLegendGraphic&LAYER=plain&STYLE=intensity", 422)

    def test_clients_write_maps_and_legends(self):
        names = self.path("client.png"), self.path("legend.png")
        subprocess.run([os.path.join(PROGRAMS, "scancast-client"), "map", self.server.url, "--cloud", "plain", "--crs", "EPSG:25833", "--bbox", ",".join(map(str, BOX)),
                        "--width", "200", "--height", "200", "--method", "circle", "--shading", "unlit", "--color", "elevation", "--legend", names[1], "-o", names[0]],
                       check=True, stdout=subprocess.PIPE, timeout=120)
        map_there, legend_there = (self.bytes_of(name) for name in names)
        self.assertEqual(map_there, self.map("EPSG:25833", BOX, 200, 200, STYLES="elevation")[1])
        self.assertEqual(legend_there, self.get("wms?REQUEST=GetLegendGraphic&STYLE=elevation&method=circle&shading=unlit")[1])
        sys.path.insert(0, os.path.join(ROOT, "client", "python"))
        import scancast
        self.assertEqual(scancast.Server(self.server.url).cloud("plain").legend(color="elevation").bytes, legend_there)

    def test_errors_are_the_services(self):
        good = {"SERVICE": "WMS", "VERSION": "1.3.0", "REQUEST": "GetMap", "LAYERS": "plain", "CRS": "EPSG:3857", "BBOX": "0,0,1,1", "WIDTH": "8", "HEIGHT": "8"}
        for words, status, code in (({"CRS": "EPSG:25832"}, 400, "InvalidCRS"), ({"LAYERS": "other"}, 400, "LayerNotDefined"), ({"STYLES": "gaudy"}, 400, "StyleNotDefined"),
                                    ({"FORMAT": "image/tiff"}, 400, "InvalidFormat"), ({"REQUEST": "GetLost"}, 400, "OperationNotSupported"), ({"BBOX": "1,1,0,0"}, 400, None),
                                    ({"WIDTH": "16384", "HEIGHT": "16384"}, 413, None), ({"eye": "1,2,3"}, 400, None), ({"TIME": "2019"}, 400, None), ({"colour": "rgb"}, 400, None)):
            headers, body = self.get("wms?" + urllib.parse.urlencode({**good, **words}), status)
            self.assertEqual(headers["Content-Type"], "text/xml; charset=utf-8")
            fault = xml.fromstring(body).find("{http://www.opengis.net/ogc}ServiceException")
            self.assertEqual(fault.get("code"), code, words)
        _, body = self.get("wmts?SERVICE=WMTS&REQUEST=GetTile&LAYER=plain&STYLE=default&FORMAT=image/png&TILEMATRIXSET=mercator&TILEMATRIX=1&TILEROW=2&TILECOL=0", 400)
        self.assertEqual(xml.fromstring(body).find("{http://www.opengis.net/ows/1.1}Exception").get("exceptionCode"), "TileOutOfRange")
        headers, body = self.get("wms?" + urllib.parse.urlencode({**good, "CRS": "EPSG:1", "exceptions": "application/problem+json"}), 400)
        self.assertEqual((headers["Content-Type"], json.loads(body)["errors"][0]["parameter"]), ("application/problem+json", "CRS"))
        self.assertIn(b'"status":400', self.get("tiles/mercator/1/2/0.png", 400)[1])
        self.assertEqual(self.server.get("/api/v1/clouds/none/wms?SERVICE=WMS&REQUEST=GetCapabilities")[0], 404)


if __name__ == "__main__":
    unittest.main()
