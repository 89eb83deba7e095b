// write_e57 OUT.e57 --points 20000000 --encoding scaled|single|double --scans 5: a large E57 file to measure with, of a terrain
// with colours, intensities and a grid of rows and columns, as scanners export it; each scan has a pose of its own.
//   ingest: /usr/bin/time -v scancast ingest --no-surfels OUT.e57 -o OUT.scan
// write_e57 --seeds FOLDER: small files for tests/fuzz/seeds/fuzz_e57.
#include <CLI/CLI.hpp>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <glm/vec3.hpp>
#include <sstream>
#include <string>

#include "tests/support/e57/e57_writer.hpp"

using scancast::test::E57Field;
using scancast::test::E57Scan;

namespace {

constexpr double step = 0.0001;

glm::dvec3 pointOf(std::uint64_t record, std::uint64_t columns) {
    const double x = static_cast<double>(record % columns) * 0.01,
                 y = static_cast<double>(record / columns) * 0.01;
    return {x, y, 2 * std::sin(x / 3) * std::cos(y / 5) + 0.05 * std::sin(x * 7)};
}

E57Field coordinate(const std::string& name, const std::string& encoding) {
    if (encoding == "single") return E57Field::single(name);
    if (encoding == "double") return E57Field::real(name);
    return E57Field::scaled(name, -(1 << 23), (1 << 23) - 1, step);
}

E57Scan terrain(std::uint64_t points, const std::string& encoding, int number) {
    const auto columns = static_cast<std::uint64_t>(std::ceil(std::sqrt(static_cast<double>(points))));
    E57Scan scan;
    for (const char* name : {"cartesianX", "cartesianY", "cartesianZ"})
        scan.fields.push_back(coordinate(name, encoding));
    scan.fields.push_back(E57Field::scaled("intensity", 0, 32767, 1.0 / 32767));
    for (const char* name : {"colorRed", "colorGreen", "colorBlue"})
        scan.fields.push_back(E57Field::integer(name, 0, 255));
    scan.fields.push_back(E57Field::integer("rowIndex", 0, 65535));
    scan.fields.push_back(E57Field::integer("columnIndex", 0, 65535));
    scan.fields.push_back(E57Field::integer("cartesianInvalidState", 0, 2));
    scan.records = points;
    scan.real = [=](std::uint64_t record, std::size_t field) {
        return pointOf(record, columns)[static_cast<int>(field)];
    };
    scan.raw = [=](std::uint64_t record, std::size_t field) -> std::int64_t {
        if (field < 3) return std::llround(pointOf(record, columns)[static_cast<int>(field)] / step);
        if (field == 3) return static_cast<std::int64_t>(record * 2654435761U % 32768);
        if (field < 7) return static_cast<std::int64_t>((record >> (2 * field)) % 256);
        if (field == 7) return static_cast<std::int64_t>(record / columns);
        if (field == 8) return static_cast<std::int64_t>(record % columns);
        return record % 1000 == 999 ? 2 : 0;
    };
    if (number > 0)
        scan.xml = scancast::test::e57Pose(std::cos(number * 0.1), 0, 0, std::sin(number * 0.1),
                                           number * 30.0, 0, 1);
    return scan;
}

void writeSeeds(const std::filesystem::path& folder) {
    const auto write = [&](const char* name, const std::string& file) {
        std::ofstream(folder / name, std::ios::binary) << file;
    };
    auto organised = terrain(40, "scaled", 0);
    write("organised", scancast::test::e57File({organised}));
    std::stringstream photos(std::ios::in | std::ios::out | std::ios::binary);
    scancast::test::E57Writer writer(photos);
    const auto guid = writer.add(terrain(5, "single", 1));
    const std::string jpeg = "\xff\xd8\xff not much of a picture";
    const auto blob = scancast::test::e57Blob("jpegImage", writer.addBlob(jpeg), jpeg.size());
    const std::string sized =
        "<imageWidth type=\"Integer\">8</imageWidth><imageHeight type=\"Integer\">4</imageHeight>"
        "<pixelWidth type=\"Float\">0.5</pixelWidth><pixelHeight type=\"Float\">0.5</pixelHeight>";
    const auto pose = scancast::test::e57Pose(1, 0, 0, 0, 1, 2, 3);
    writer.finish("<images2D type=\"Vector\">\n" +
                  scancast::test::e57Photo(
                      "sphericalRepresentation", blob, sized,
                      "<associatedData3DGuid type=\"String\">" + guid + "</associatedData3DGuid>" + pose) +
                  scancast::test::e57Photo("pinholeRepresentation", blob,
                                           sized + "<focalLength type=\"Float\">2</focalLength>", pose) +
                  "</images2D>\n");
    write("photos", photos.str());
    auto odd = terrain(60, "single", 1);
    odd.oddPackets = true;
    write("odd_packets", scancast::test::e57File({odd}));
    E57Scan spherical;
    spherical.fields = {E57Field::real("sphericalRange"),
                        E57Field::single("sphericalAzimuth"),
                        E57Field::scaled("sphericalElevation", -1000, 1000, 0.001),
                        E57Field::integer("sphericalInvalidState", 0, 2),
                        E57Field::single("intensity"),
                        E57Field::integer("isIntensityInvalid", 0, 1),
                        E57Field::single("nor:normalX"),
                        E57Field::single("nor:normalY"),
                        E57Field::single("nor:normalZ"),
                        E57Field::integer("las:classification", 0, 31),
                        E57Field::real("timeStamp")};
    spherical.records = 12;
    spherical.real = [](std::uint64_t record, std::size_t field) {
        return static_cast<double>(record + field) / 7;
    };
    spherical.raw = [](std::uint64_t record, std::size_t field) {
        return field == 2 ? 500 : static_cast<std::int64_t>(record % 2);
    };
    write(
        "spherical",
        scancast::test::e57File(
            {spherical, terrain(9, "double", 3)},
            "<coordinateMetadata type=\"String\"><![CDATA[GEOGCS[\"WGS 84\",AUTHORITY[\"EPSG\",\"4326\"]]]]>"
            "</coordinateMetadata>\n<images2D type=\"Vector\"><vectorChild type=\"Structure\">"
            "<sphericalRepresentation type=\"Structure\"><jpegImage type=\"Blob\" fileOffset=\"48\" "
            "length=\"9\"/></sphericalRepresentation></vectorChild></images2D>\n"));
}

}  // namespace

int main(int argc, char** argv) {
    CLI::App app("Writes E57 files to measure with.");
    std::string out, encoding = "scaled", seeds;
    std::uint64_t points = 1'000'000;
    int scans = 1;
    app.add_option("out", out);
    app.add_option("--points", points)->capture_default_str();
    app.add_option("--encoding", encoding)->check(CLI::IsMember({"scaled", "single", "double"}));
    app.add_option("--scans", scans)->check(CLI::Range(1, 1000));
    app.add_option("--seeds", seeds);
    CLI11_PARSE(app, argc, argv);
    if (!seeds.empty()) {
        writeSeeds(seeds);
        return 0;
    }
    std::fstream file(out, std::ios::in | std::ios::out | std::ios::binary | std::ios::trunc);
    scancast::test::E57Writer writer(file);
    for (int i = 0; i < scans; ++i)
        writer.add(terrain(points / static_cast<std::uint64_t>(scans), encoding, scans > 1 ? i + 1 : 0));
    writer.finish();
    if (file) return 0;
    std::fprintf(stderr, "%s cannot be written\n", out.c_str());
    return 1;
}
